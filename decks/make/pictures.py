"""Draw the picture of every deck, or of those named: `python decks/make/pictures.py [name ...]`.

Pictures go to docs/pictures. Needs the executable and matplotlib.
"""
from __future__ import annotations

import sys

import pictures_forming
import pictures_friction
import pictures_hertz
import pictures_large
import pictures_metals
from drawing import PICTURES, ROOT

MODULES = (pictures_hertz, pictures_friction, pictures_large, pictures_forming,
           pictures_metals)
DRAWN = {deck.stem: getattr(module, deck.stem) for deck in sorted((ROOT/"decks").glob("*.inp"))
         for module in MODULES if hasattr(module, deck.stem)}


def main(names: list[str]) -> None:
    """Draw the pictures of these decks, or all."""
    for name in names or DRAWN:
        DRAWN[name]()
        print(f"{name}.png: {(PICTURES/f'{name}.png').stat().st_size//1000} kB")


if __name__ == "__main__":
    main(sys.argv[1:])
