"""Picture of a run in parts: the mesh of some of its parts, about the cut, and the load curve.

    python decks/make/separation.py FOLDER NAME PART [PART ...]

draws docs/pictures/separation.png from the decks NAME.pNNN.inp that a run with *REMESH has left in
FOLDER; a part's deck holds its mesh in the shape that it begins with.
"""
import csv
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
#: Label of its punch.
PUNCH = 900001


def draw(folder: Path, name: str, parts: list[int]) -> None:
    figure, axes = plt.subplots(1, len(parts) + 1, figsize=(3.2*len(parts) + 3.6, 5.6))
    load_curve(axes[-1], folder/f"{name}_history.csv")
    for axis, part in zip(axes, parts):
        deck = lopin.Deck.read(folder/f"{name}.p{part:03d}.inp")
        cards = DeckParts.of(deck).cards
        for _, nodes in cards.elements.values():
            x = np.array([cards.nodes[n][:2] for n in nodes])
            axis.fill(*x.T, facecolor="lightsteelblue", edgecolor="0.2", linewidth=0.4)
        stroke = next((-float(row[2]) for row in deck["START"].data
                       if row[0] == PUNCH and row[1] == 2), 0.0) if "START" in deck else 0.0
        axis.set(xlim=WINDOW[0], ylim=WINDOW[1], aspect="equal", title=f"{stroke:.3f} mm")
    figure.tight_layout()
    figure.savefig(Path(__file__).resolve().parents[2]/"docs"/"pictures"/"separation.png", dpi=60)


def load_curve(axis, path: Path) -> None:
    """Force of the punch over its stroke."""
    with path.open(newline="") as file:
        head, *rows = list(csv.reader(file))
    column = {word.partition(" ")[0]: k for k, word in enumerate(head)}
    table = np.array([[float(row[column[n]]) for n in ("PUNCH.u2", "PUNCH.rf2")] for row in rows])
    axis.plot(*(-table.T*np.array([[1.0], [1e-3]])), color="0.1", linewidth=1.0)
    axis.set(xlabel="stroke [mm]", ylabel="force of the punch [kN]", xlim=(0, None), ylim=(0, None))


if __name__ == "__main__":
    draw(Path(sys.argv[1]), sys.argv[2], [int(word) for word in sys.argv[3:]])
