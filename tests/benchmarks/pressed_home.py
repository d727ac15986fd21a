"""Sheets pressed home in a V: what W0562 tells beside what facets on the radius make of the force.

    python tests/benchmarks/pressed_home.py [--picture]

Prints the first rows of the table of docs/release.md ("Pressed home") and draws
docs/pictures/pressed_home.png: the sheet on 20 cells at the end, and the force over the last way of
the punch on four meshes, with what is told of its end as a bar.
"""
from __future__ import annotations

import os
import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")
sys.path.insert(0, str(ROOT/"tests"/"python"))

from test_facet_sag import pressed_home, rise  # noqa: E402

import lopin  # noqa: E402

#: Radius [mm], word, cells on 20 mm; the last is the reference.
ROWS = ((3.0, "CPE4I", (14, 20, 40, 100, 200)), (3.0, "CPE8R", (10, 14, 20, 28, 56)))


def table() -> None:
    """Rows: told, and off by, of the own force [%]."""
    for radius, word, cells in ROWS:
        found = [rise(pressed_home(word, radius, n)) for n in cells]
        right = found[-1][1]
        told = ", ".join(f"{figure:g}" for (_, figure), _ in found[:-1])
        off = ", ".join(f"{100.0*(1.0 - right/force):.0f}" for _, force in found[:-1])
        meshes = ", ".join(map(str, cells[:-1]))
        print(f"| {radius:g} | {word} | {meshes} ({cells[-1]}) | {told} % | {off} % |", flush=True)


def shape_of(result: lopin.Result) -> tuple[np.ndarray, np.ndarray]:
    """Places of the nodes at the end, and the corners of the cells."""
    mesh = result.to_meshio()
    cells = next(block.data for block in mesh.cells if block.type == "quad")
    return (mesh.points + mesh.point_data["U"])[:, :2], cells


def picture() -> None:
    """Shape and forces."""
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    from matplotlib.collections import PolyCollection

    figure, (left, right) = plt.subplots(1, 2, figsize=(9.5, 4.0), layout="constrained")
    for cells, colour in ((20, "tab:red"), (40, "tab:orange"), (80, "tab:green"), (200, "black")):
        deck = pressed_home("CPE4I", 3.0, cells)
        (_, told), _ = rise(deck)
        result = lopin.run(deck)
        way, force = (np.abs(np.asarray(result.history[f"PUNCH.{k}2"])) for k in ("u", "rf"))
        right.plot(way[-1] - way, force, color=colour, label=f"{cells} cells of {20/cells:g} mm")
        if told:
            right.errorbar([0.0], [force[-1]], yerr=[[0.01*told*force[-1]], [0.0]], color=colour,
                           capsize=4)
        if cells == 20:
            x, corners = shape_of(result)
            left.add_collection(PolyCollection(x[corners], facecolor="0.85", edgecolor="0.2"))
            arc = np.radians(np.linspace(-45.0, 45.0, 60))
            low = -way[-1] + 1.0
            for radius, name in ((3.0, "tab:blue"), (4.0, "tab:blue")):
                left.plot(radius*np.sin(arc), low + 3.0 - radius*np.cos(arc), color=name)
    left.set(xlim=(-0.2, 4.5), ylim=(low - 1.3, low + 3.2), aspect="equal", xlabel="x [mm]",
             ylabel="y [mm]", title="20 cells, at the end; arcs of the tools")
    right.set(xlim=(0.1, -0.003), ylim=(0.0, None), xlabel="way left [mm]",
              ylabel="force of the punch [N]", title="bars: what W0562 tells")
    right.legend(frameon=False)
    figure.savefig(ROOT/"docs"/"pictures"/"pressed_home.png", dpi=110)


if __name__ == "__main__":
    if "--picture" in sys.argv[1:]:
        picture()
    else:
        table()
