"""Write the decks of decks/handbook: `python decks/make/handbook.py [name ...]`.

Problems of textbooks and handbooks, as an engineer writes them who has read the documentation. A
deck says at its head where its problem is from and what the answer is:

    ** source: Johnson (1985), section 5.6
    ** exact: -0.005
"""
from __future__ import annotations

import sys
from pathlib import Path
from textwrap import fill

import handbook_beams
import handbook_elastic
import handbook_metal
import handbook_more
import handbook_rubbing

FOLDER = Path(__file__).resolve().parents[1]/"handbook"
MODULES = (handbook_elastic, handbook_beams, handbook_rubbing, handbook_metal, handbook_more)
PROBLEMS = {f.__name__: f for module in MODULES for f in module.PROBLEMS}


def deck(name: str) -> str:
    """Text of a deck."""
    comment, source, quantity, where, component, exact, cards = PROBLEMS[name]()
    title, _, words = (" ".join(part.split()) for part in comment.partition("\n\n"))
    head = f"** {title}\n**\n{fill(words, 100, initial_indent='** ', subsequent_indent='** ')}\n"
    head += f"**\n** source: {source}\n** exact: {exact:.12g}\n*HEADING\n{title}\n"
    ask = f"*LOPIN, QUANTITY={quantity}, TARGET ERROR=0.01"
    ask += f", SET={where}" if where else ""
    ask += f", COMPONENT={component}" if component else ""
    return f"{head}{ask}\n{cards}"


def main(names: list[str]) -> None:
    """Write these decks, or all."""
    FOLDER.mkdir(exist_ok=True)
    for name in names or PROBLEMS:
        (FOLDER/f"{name}.inp").write_text(deck(name), encoding="utf-8")
        print(f"{name}.inp: {(FOLDER/f'{name}.inp').stat().st_size/1000:.0f} kB")


if __name__ == "__main__":
    main(sys.argv[1:])
