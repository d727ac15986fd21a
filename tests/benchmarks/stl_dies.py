"""A cross and a connecting rod between dies of STL files, on one mesh, by the four methods: to the
stroke at which it folds.

    python tests/benchmarks/stl_dies.py

Writes the table between its marks in docs/forming.md: stroke reached and force of the moving die
there, what the run said of folding, increments, CPU seconds of one thread.
"""
from __future__ import annotations

import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from page_tables import put_table

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT/"docs"/"forming.md"
BEGIN, END = "<!-- stl dies -->", "<!-- end of stl dies -->"
sys.path.insert(0, str(ROOT/"decks"/"make"))
import die_forging  # noqa: E402

import lopin  # noqa: E402

METHODS = ("DIRECT", "PENALTY", "PERTURBED LAGRANGE", "AUGMENTED LAGRANGE")
SCENES = {
    "cross, 216 hexahedra": ("cross", {"way": 18.0}),
    "cross, 1 296 tetrahedra": ("cross", {"way": 20.0, "tets": True}),
    "cross between both dies, 432 hexahedra": ("cross", {"way": 17.0, "whole": True}),
    "rod, 810 hexahedra": ("rod", {"way": 5.0, "cells": (3, 30)}),
    "rod, 4 860 tetrahedra": ("rod", {"way": 6.0, "cells": (3, 30), "tets": True}),
}


def cell(make: str, given: dict, method: str) -> str:
    """One run, as a cell of the table."""
    with TemporaryDirectory() as folder:
        text = getattr(die_forging, make)(Path(folder), method=method, **given)
        (Path(folder)/"scene.inp").write_text(text)
        deck = lopin.Deck.read(Path(folder)/"scene.inp")
        began = time.process_time()
        try:
            result, ended = lopin.run(deck), ""
        except lopin.LopinError as stopped:
            result, ended = stopped.result, str(stopped).split(":")[0]
        seconds = time.process_time() - began
    history = {k: np.asarray(v, float) for k, v in result.history.items()}
    way = np.abs(history["UPPER.u3"][-1])
    force = np.abs(history["UPPER.rf3"])
    said = {str(d["code"]) for d in result.diagnostics}
    folds = ", ".join(filter(None, ["W0531" if "W0531" in said else "", ended]))
    print(make, given, method, way, force.max(), folds, len(force), seconds, flush=True)
    reached = f"{way:.2f} of {given['way']:g}" + (f" ({folds})" if folds else "")
    return f"{reached}; {force[-1]/1e3:.1f} kN; {len(force)}, {seconds:.1f} s"


def main() -> None:
    """The table, into the page."""
    rows = ["| mm reached; force there; increments, seconds | " + " | ".join(
        m.lower().split()[0] for m in METHODS) + " |", "| --- "*(len(METHODS) + 1) + "|"]
    for name, (make, given) in SCENES.items():
        rows.append(f"| {name} | " + " | ".join(cell(make, given, m) for m in METHODS) + " |")
    put_table(PAGE, BEGIN, END, "\n".join(rows))


if __name__ == "__main__":
    main()
