"""What SMOOTH=YES makes of sheets that roll on the radii of profiles.

    python tests/benchmarks/curved_slave.py [--picture]

Prints the tables of docs/release.md ("Facets that stand for a curve") and draws
docs/pictures/curved_slave.png: force of the punch of a U-bend by flat and by curved facets, and on
four times as many.
"""
from __future__ import annotations

import os
import re
import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")
os.environ.setdefault("LOPIN_EXECUTABLE", str(ROOT/"build"/"lopin"))
sys.path[:0] = [str(ROOT/"tests"/"python"), str(ROOT/"tests"/"benchmarks"), str(ROOT/"decks"/"make")]

from test_curved_slave import flange, force_over_way, smooth  # noqa: E402
from to_the_end import u_bend  # noqa: E402

import lopin  # noqa: E402


def wave(result: lopin.Result) -> str:
    """The highest wave that is told [%]."""
    found = [re.search(r"falls and rises by ([\d.]+) %", d["message"]) for d in result.diagnostics]
    return next((match.group(1) for match in found if match), "-")


def flanges() -> None:
    """Waves, and forces beside those on facets of 0.125 mm [% of the largest]."""
    for thickness in (1.0, 0.5):
        right = force_over_way(lopin.run(flange(thickness=thickness, times=8)))
        for times in (1, 2, 4):
            row = [f"{thickness:g}", f"{1/times:g}"]
            flat = flange(thickness=thickness, times=times)
            for deck in (flat, smooth(flat)):
                result = lopin.run(deck)
                off = 100.0*np.abs(force_over_way(result) - right)/right.max()
                row.append(f"{wave(result)} %; {np.sqrt((off**2).mean()):.1f}, {off.max():.0f} %")
            print("| " + " | ".join(row) + " |", flush=True)


def bends() -> None:
    """Increments and waves of U-bends without a pad."""
    for name, changes in (("radii 5", {}), ("radii 3", {"radius": 3.0}), ("gap 0.8", {"gap": 0.8}),
                          ("first increment 0.002", {"first": 0.002}), ("120 x 2 cells", {"cells": (120, 2)})):
        row = [name]
        for change in (lambda deck: deck, smooth):
            result = lopin.run(change(lopin.Deck.parse(u_bend(**changes), "scene")))
            row.append(f"{len(result.history['step'])}; {wave(result)} %")
        print("| " + " | ".join(row) + " |", flush=True)


def picture() -> None:
    """Force of the punch over its way."""
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(figsize=(8.0, 4.0), layout="constrained")
    for cells, change, label, colour in (
            ((60, 2), lambda deck: deck, "facets of 1 mm, flat", "tab:red"), ((60, 2), smooth, "facets of 1 mm, SMOOTH=YES", "tab:blue"),
            ((240, 4), lambda deck: deck, "facets of 0.25 mm, flat", "black")):
        history = lopin.run(change(lopin.Deck.parse(u_bend(cells=cells), "scene"))).history
        axes.plot(*(np.abs(np.asarray(history[f"PUNCH.{name}2"])) for name in ("u", "rf")), color=colour, label=label,
                  linewidth=0.8 if colour == "black" else 1.4)
    axes.set(xlabel="way of the punch [mm]", ylabel="force of half the punch [N/mm]")
    axes.legend()
    figure.savefig(ROOT/"docs"/"pictures"/"curved_slave.png", dpi=110)


if __name__ == "__main__":
    if "--picture" in sys.argv:
        picture()
    else:
        flanges()
        bends()
