"""The closed die pressed on into a thin flash: cells halved, another mesher, another start.

    python tests/benchmarks/full_flash.py [--print]

Writes the table between its marks in docs/remeshing.md: force and work of decks/full_flash.inp by
strokes, with cells of half the size, with gmsh's Delaunay mesher for its frontal one, from finer
cells, and on one mesh while that lives; then the run to 5.7 mm. Some ten minutes.
"""
from __future__ import annotations

import json
import os
import re
import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from page_tables import put_table

ROOT = Path(__file__).resolve().parents[2]
PAGE, BEGIN, END = ROOT/"docs"/"remeshing.md", "<!-- full flash -->", "<!-- end of full flash -->"
os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")
sys.path.insert(0, str(ROOT/"decks"/"make"))
import forging  # noqa: E402

import lopin  # noqa: E402
from lopin.remesh import plane  # noqa: E402
from lopin.remesh.driver import Runner  # noqa: E402
from lopin.remesh.report import columns  # noqa: E402

STROKES = (4.0, 4.4, 4.8, 4.95, 5.0, 5.3, 5.7)
CARD = "SIZE=0.8, SMALLEST=0.15"
HALF = "SIZE=0.4, SMALLEST=0.075"
DELAUNAY = 5   #: gmsh's number


def pressed(cells: int, stop: float = 5.3, size: str = CARD, one_mesh: bool = False) -> dict:
    """Forces [kN] at the strokes, work [J], jumps, meshes, increments, seconds of CPU."""
    text = forging.full_flash(cells, stop).replace(CARD, size)
    if one_mesh:
        text = re.sub(r"\*REMESH.*\n", "", text)
    deck, began = lopin.Deck.parse(text, name="disc"), time.process_time()
    ended, jumps, meshes = "", [], 1
    with TemporaryDirectory() as folder:
        try:
            if one_mesh:
                lopin.run(deck, folder)
            else:
                run = Runner(deck, folder, say=lambda _: None)
                run.run()
        except lopin.LopinError as stopped:
            ended = stopped.id or type(stopped).__name__
        if not one_mesh:
            told = json.loads((Path(folder)/"disc.parts.json").read_text())["remeshes"]
            jumps, meshes = [abs(r["force_change"] or 0.0) for r in told], len(run.report.parts)
        table = columns(Path(folder)/"disc_history.csv")
    way, force = -table["DIE.u2"], -table["DIE.rf2"]/1e3
    forces = np.interp(STROKES, way, force)
    forces[np.array(STROKES) > way[-1] + 1e-9] = np.nan
    upto = np.append(way[way < 4.95], 4.95)
    work = np.trapezoid(np.interp(upto, way, force), upto)
    return {"forces": forces, "work": work, "jumps": jumps, "meshes": meshes, "ended": ended,
            "increments": len(way), "seconds": time.process_time() - began}


def scenes():
    """Names and runs."""
    yield "decks/full_flash.inp", lambda: pressed(16)
    yield "cells halved, start of 0.47 mm", lambda: pressed(32, 5.3, HALF)
    yield "Delaunay mesher", delaunay
    yield "start of 0.75 mm", lambda: pressed(20)
    yield "one mesh of 0.35 mm", lambda: pressed(43, 5.0, one_mesh=True)
    yield "on to 5.7 mm", lambda: pressed(16, 5.7)


def delaunay() -> dict:
    """The same with another mesher."""
    was, plane._FRONTAL = plane._FRONTAL, DELAUNAY
    try:
        return pressed(16)
    finally:
        plane._FRONTAL = was


def line_of(name: str, row: dict, first: dict) -> str:
    """A row of the table."""
    off = 100.0*(row["forces"]/first["forces"] - 1.0)
    beside = ["" if row is first or np.isnan(d) else f" ({d:+.1f} %)" for d in off]
    cells = ["" if np.isnan(f) else f"{f:.1f}{d}" for f, d in zip(row["forces"], beside)]
    first_jump, *others = [*row["jumps"], 0.0]
    return (f"| {name} | " + " | ".join(cells) + f" | {row['work']:.0f} | "
            f"{first_jump:.1%}, {max(others, default=0.0):.1%} | {row['meshes']}, "
            f"{row['increments']} | {row['seconds']:.0f} | {row['ended']} |")


def main() -> None:
    """The table, printed and into the page."""
    lines = ["| force [kN] at a stroke [mm] of | " + " | ".join(f"{s:g}" for s in STROKES)
             + " | work to 4.95 [J] | force at new meshes: first, others | meshes, increments "
             "| CPU [s] | stops |", "| --- "*(len(STROKES) + 6) + "|"]
    first: dict = {}
    for name, run in scenes():
        row = run()
        first = first or row
        lines.append(line_of(name, row, first))
        print(lines[-1], flush=True)
    if "--print" not in sys.argv:
        put_table(PAGE, BEGIN, END, "\n".join(lines))


if __name__ == "__main__":
    main()
