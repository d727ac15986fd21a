"""Error against cost of a billet upset in space, Lopin and CalculiX on one chart: writes
docs/charts/billet_3d.csv and billet_3d.png.

    python tests/benchmarks/billet_in_space.py [--cells 2 3 4] [--limit 900]

A quarter of a billet of radius 10 and half height 15 mm, first-order bricks, pressed to 60 % of its
height with mu = 0.1. `tool`: a rigid plane, all four methods, increments left to the code. `plate`:
the stiff meshed plate of forming_decks.py, pressure 1e7 times the penetration, increments of 1/50:
the same deck for both programs. The error is that of the force over the time beside an axisymmetric
mesh of 40 x 60 in 100 increments; the cost is CPU seconds of the process, one thread.
"""
from __future__ import annotations

import argparse
import csv
import os
import re
import resource
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT/"tests"/"python")]
ONE = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "CCX_NPROC_STIFFNESS": "1"}
os.environ.update(ONE)
LOPIN = os.environ.setdefault("LOPIN_EXECUTABLE", str(ROOT/"build"/"lopin"))

from upset_billet import billet  # noqa: E402

import lopin  # noqa: E402
from lopin import mesh_make  # noqa: E402
from lopin.mesh import together  # noqa: E402
from lopin.model import Model  # noqa: E402
from lopin.model_deck import mesh_deck  # noqa: E402

METHODS = {"lagrange": "DIRECT", "penalty": "PENALTY", "perturbed": "PERTURBED LAGRANGE",
           "augmented": "AUGMENTED LAGRANGE"}
STROKE = 6.0   #: [mm]


def deck(cells: int, method: str | None) -> str:
    """With a rigid tool and a method, or (None) with a plate that both programs read."""
    body = mesh_make.cylinder(10.0, 15.0, (cells, 3*cells), part="quarter")
    skin = np.vstack([body.surfaces["TOP"], body.surfaces["ARC"]])
    body = body.replaced(surfaces={"SKIN": skin}, point_sets={
        k: body.point_sets[k] for k in ("LEFT", "BACK", "BOTTOM")})
    parts = {"BODY": body}
    if method is None:
        plate = mesh_make.block((24.0, 24.0, 2.0), (6, 6, 1), origin=(0.0, -24.0, 15.0))
        parts["PLATE"] = plate.replaced(surfaces={"FACE": plate.surfaces["BOTTOM"]}, point_sets={
            "NODES": np.arange(plate.n_point)})
    text = mesh_deck(Model("billet", together(**parts), kind="3d")).text()
    text += ("*MATERIAL, NAME=METAL\n*ELASTIC\n200000., 0.3\n*PLASTIC\n700., 0.\n1300., 2.\n"
             "*SOLID SECTION, ELSET=BODY.ALL, MATERIAL=METAL\n")
    held = "*BOUNDARY\nBODY.LEFT, 1, 1\nBODY.BACK, 2, 2\nBODY.BOTTOM, 3, 3\n"
    step = "*STEP, NLGEOM, INC=5000\n*STATIC\n"
    if method is None:
        return text + (
            "*MATERIAL, NAME=HARD\n*ELASTIC\n2000000., 0.3\n"
            "*SOLID SECTION, ELSET=PLATE.ALL, MATERIAL=HARD\n*SURFACE INTERACTION, NAME=I\n"
            "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n1e7,\n*FRICTION\n0.1, 1e6\n"
            "*CONTACT PAIR, INTERACTION=I, TYPE=NODE TO SURFACE\nBODY.SKIN, PLATE.FACE\n"
            f"{held}PLATE.NODES, 1, 2\n{step}0.02, 1., 1e-6, 0.02\n*BOUNDARY\n"
            f"PLATE.NODES, 3, 3, {-STROKE}\n"
            "*NODE PRINT, NSET=PLATE.NODES, TOTALS=ONLY, FREQUENCY=1\nRF\n*END STEP\n")
    return text + (
        "*NODE, NSET=DIEP\n900001, 0., 0., 20.\n*SURFACE, NAME=DIE, TYPE=CYLINDER\n"
        "0., 0., 0., 1., 0., 0.\n0., -1., 0.\nSTART, 60., 15.\nLINE, -60., 15.\n"
        "*RIGID BODY, ANALYTICAL SURFACE=DIE, REF NODE=DIEP\n*SURFACE INTERACTION, NAME=I\n"
        f"*SURFACE BEHAVIOR, {METHODS[method]}\n*FRICTION\n0.1,\n*CONTACT PAIR, INTERACTION=I\n"
        f"BODY.SKIN, DIE\n{held}DIEP, 1, 2\nDIEP, 4, 6\n{step}*BOUNDARY\nDIEP, 3, 3, {-STROKE}\n"
        "*NODE PRINT, NSET=DIEP, TOTALS=ONLY, FREQUENCY=1\nRF\n*END STEP\n")


def totals(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Times and total forces along the press of a .dat file."""
    times, forces = [0.0], [0.0]
    lines = path.read_text().splitlines()
    for k, line in enumerate(lines):
        found = re.search(r"total force.*time\s+(\S+)", line)
        if not found:
            continue
        row = next(text.split() for text in lines[k + 1:] if text.split())
        times.append(float(found[1]))
        forces.append(abs(float(row[2])))
    return np.array(times), np.array(forces)


def measure(program: str, cells: int, method: str | None, limit: float, right) -> dict:
    """One run: CPU seconds and the error of the force."""
    row = {"program": program, "cells": cells, "tool": "plate" if method is None else "tool",
           "method": method or "linear penalty"}
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        (folder/"billet.inp").write_text(deck(cells, method))
        command = ["ccx", "billet"] if program == "ccx" else \
            [LOPIN, "run", "billet.inp", "-o", ".", "--overwrite", "--quiet"]
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        try:
            done = subprocess.run(command, cwd=folder, timeout=limit, capture_output=True,
                                  check=False)
        except subprocess.TimeoutExpired:
            return row | {"stopped": f"not done in {limit:g} s"}
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        times, forces = totals(folder/"billet.dat")
        if done.returncode or times[-1] < 0.999:
            return row | {"stopped": f"at time {times[-1]:.3g}"}
    exact = np.interp(times, *right)
    dt = np.diff(times)
    error = np.sqrt((dt*(4.0*forces - exact)[1:]**2).sum()/(dt*exact[1:]**2).sum())
    return row | {"increments": len(times) - 1, "force_kN": 4e-3*forces[-1],
                  "cpu_s": after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime,
                  "error": float(error)}


def reference() -> tuple[np.ndarray, np.ndarray]:
    """Times and forces of a fine axisymmetric mesh."""
    history = lopin.run(billet(100, mu=0.1, share=STROKE/15.0, cells=(40, 60)),
                        executable=True).history
    return np.r_[0.0, history["time"]], np.r_[0.0, np.abs(history["DIE.rf2"])]


def draw(rows: list[dict], path: Path) -> None:
    """Error against CPU seconds, mesh after mesh."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    fig, ax = plt.subplots(figsize=(6.6, 4.4), layout="constrained")
    for program, tool, method in dict.fromkeys((r["program"], r["tool"], r["method"])
                                               for r in rows):
        mine = [r for r in rows if (r["program"], r["tool"], r["method"]) == (program, tool, method)
                and "error" in r]
        name = "CalculiX 2.20" if program == "ccx" else "Lopin"
        ax.loglog([r["cpu_s"] for r in mine], [100.0*r["error"] for r in mine],
                  "s--" if program == "ccx" else "o-" if tool == "tool" else "^-",
                  label=f"{name}, {tool}, {method}", ms=6)
    ax.set(xlabel="CPU time [s]; finer meshes to the right", ylabel="error of the force [%]")
    ax.grid(True, color="#dddddd", lw=0.6)
    ax.legend(frameon=False, fontsize=8)
    fig.savefig(path, dpi=110)


def main() -> None:
    """Run all and write both files."""
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cells", type=int, nargs="+", default=[2, 3, 4])
    parser.add_argument("--limit", type=float, default=900.0)
    parser.add_argument("-o", "--output", type=Path, default=ROOT/"docs"/"charts")
    options = parser.parse_args()
    right, rows = reference(), []
    runs = [("lopin", method) for method in METHODS] + [("lopin", None)]
    runs += [("ccx", None)] if shutil.which("ccx") else []
    for cells in options.cells:
        for program, method in runs:
            rows.append(measure(program, cells, method, options.limit, right))
            print(rows[-1], flush=True)
    with (options.output/"billet_3d.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, ("program", "cells", "tool", "method", "increments",
                                       "force_kN", "cpu_s", "error", "stopped"),
                                lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    draw(rows, options.output/"billet_3d.png")


if __name__ == "__main__":
    main()
