"""Picture of a run in parts: the mesh of some of its parts, about the cut.

    python decks/make/separation.py FOLDER NAME PART [PART ...]

draws docs/pictures/separation.png from the decks NAME.pNNN.inp that a run with *REMESH has left in
FOLDER; a part's deck holds its mesh in the shape that it begins with.
"""
import sys
from pathlib import Path

import matplotlib
import numpy as np

import lopin
from lopin.remesh.body import DeckParts

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

#: About the edges of decks/blanking.inp [mm].
WINDOW = (4.6, 5.5), (-0.5, 1.15)


def draw(folder: Path, name: str, parts: list[int]) -> None:
    figure, axes = plt.subplots(1, len(parts), figsize=(3.2*len(parts), 5.6))
    for axis, part in zip(np.atleast_1d(axes), parts):
        deck = lopin.Deck.read(folder/f"{name}.p{part:03d}.inp")
        cards = DeckParts.of(deck).cards
        for _, nodes in cards.elements.values():
            x = np.array([cards.nodes[n][:2] for n in nodes])
            axis.fill(*x.T, facecolor="lightsteelblue", edgecolor="0.2", linewidth=0.4)
        time = float(deck["START"].parameters["TIME"]) if "START" in deck else 0.0
        axis.set(xlim=WINDOW[0], ylim=WINDOW[1], aspect="equal", title=f"time {time:.2f}")
    figure.tight_layout()
    figure.savefig(Path(__file__).resolve().parents[2]/"docs"/"pictures"/"separation.png", dpi=80)


if __name__ == "__main__":
    draw(Path(sys.argv[1]), sys.argv[2], [int(word) for word in sys.argv[3:]])
