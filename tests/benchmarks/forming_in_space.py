"""Forming in space, phase by phase, for one executable or two in turns: a table of Markdown.

    python tests/benchmarks/forming_in_space.py [--bodies billet:12 ring:8 cup:6] [--repeat 2]
                                                [--before EXECUTABLE] [--share 1.0]

`billet:n`: a quarter of a square billet 20 x 20 x 30 mm, n x n x 1.5 n bricks; `ring:n`: a quarter
of a ring of radii 7.5 and 15 and half height 5 mm, n x 3 n x 1.5 n bricks; both upset to 40 % in
fifty increments under a stiff meshed plate, mu = 0.1, node to surface. `cup:n`: the deck of
decks/make/square_cup.py with n cells. `--share`: only this part of the way. CPU seconds of one
thread, least of the runs, phases by their share of the wall; the force is the last one printed, of
the cup that of the punch.
"""
from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT/"decks"/"make"))
from lopin import mesh_make  # noqa: E402
from lopin.mesh import together  # noqa: E402
from lopin.model import Model  # noqa: E402
from lopin.model_deck import mesh_deck  # noqa: E402

LOPIN = os.environ.get("LOPIN_EXECUTABLE", str(ROOT/"build"/"lopin"))
PHASES = ("factorise", "solve", "assemble", "contact", "search", "analyse", "output")


def upset(kind: str, n: int, share: float) -> str:
    """A billet or a ring under a plate, pressed to 60 % of its height times `share`."""
    if kind == "billet":
        high = 15.0
        body = mesh_make.block((10.0, 10.0, high), (n, n, 3*n//2))
        skin = [body.surfaces[side] for side in ("TOP", "RIGHT", "BACK")]
        held = {"LEFT": ("LEFT", 1), "FRONT": ("FRONT", 2), "BOTTOM": ("BOTTOM", 3)}
    else:
        high = 5.0
        flat = mesh_make.ring(7.5, 15.0, (n, 3*n))
        body = mesh_make.extruded(flat, high, 3*n//2)
        skin = [body.surfaces[side] for side in ("TOP", "INNER", "OUTER")]
        held = {"LEFT": ("END", 1), "FRONT": ("START", 2), "BOTTOM": ("BOTTOM", 3)}
    body = body.replaced(surfaces={"SKIN": np.vstack(skin)},
                         point_sets={name: body.point_sets[of] for name, (of, _) in held.items()})
    plate = mesh_make.block((26.0, 26.0, 2.0), (6, 6, 1), origin=(-1.0, -1.0, high))
    plate = plate.replaced(surfaces={"FACE": plate.surfaces["BOTTOM"]},
                           point_sets={"NODES": np.arange(plate.n_point)})
    fixed = "".join(f"BODY.{name}, {axis}, {axis}\n" for name, (_, axis) in held.items())
    return mesh_deck(Model("body", together(BODY=body, PLATE=plate), kind="3d")).text() + (
        "*MATERIAL, NAME=METAL\n*ELASTIC\n200000., 0.3\n*PLASTIC\n700., 0.\n1300., 2.\n"
        "*SOLID SECTION, ELSET=BODY.ALL, MATERIAL=METAL\n"
        "*MATERIAL, NAME=HARD\n*ELASTIC\n2000000., 0.3\n"
        "*SOLID SECTION, ELSET=PLATE.ALL, MATERIAL=HARD\n*SURFACE INTERACTION, NAME=I\n"
        "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n1e7,\n*FRICTION\n0.1, 1e6\n"
        "*CONTACT PAIR, INTERACTION=I, TYPE=NODE TO SURFACE\nBODY.SKIN, PLATE.FACE\n"
        f"*BOUNDARY\n{fixed}PLATE.NODES, 1, 2\n*STEP, NLGEOM, INC=5000\n*STATIC\n"
        f"{0.02/share}, 1., 1e-6, {0.02/share}\n*BOUNDARY\nPLATE.NODES, 3, 3, {-0.4*share*high}\n"
        "*NODE PRINT, NSET=PLATE.NODES, TOTALS=ONLY, FREQUENCY=1\nRF\n*END STEP\n")


def deck(kind: str, n: int, share: float) -> str:
    """The text of a scene."""
    if kind in ("billet", "ring"):
        return upset(kind, n, share)
    from square_cup import square_cup
    printed = "*NODE PRINT, NSET=BLANK.TIP\nU\n"
    text = square_cup(cells=n, stroke=15.0*share)
    assert printed in text
    return text.replace(printed, "*NODE PRINT, NSET=PUNCH_REF\nRF\n")


def run(program: str, folder: Path) -> dict:
    """CPU seconds, memory, summary and last force of one run."""
    environment = os.environ | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    with subprocess.Popen([program, "run", "body.inp", "-o", "out", "--overwrite", "--quiet"],
                          cwd=folder, env=environment, stdout=subprocess.DEVNULL,
                          stderr=subprocess.PIPE) as process:
        told = process.stderr.read().decode()
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise RuntimeError(told.strip().splitlines()[0] if told else "it stopped")
    said = json.loads((folder/"out"/"body.json").read_text())
    lines = [line.split() for line in (folder/"out"/"body.dat").read_text().splitlines()]
    numbers = [line for line in lines if len(line) >= 3 and all(
        part[-1].isdigit() for part in line)]
    force = numbers[-1][2 if len(numbers[-1]) == 3 else 3] if numbers else "nan"
    return {"cpu": used.ru_utime + used.ru_stime, "mib": used.ru_maxrss/1024.0, "force": force,
            "said": said}


def row(body: str, name: str, runs: list[dict]) -> str:
    """The fastest of the runs as a row."""
    best = min(runs, key=lambda r: r["cpu"])
    said, timing = best["said"], best["said"]["timing"]
    wall = sum(timing.get(phase, 0.0) for phase in (*PHASES, "model"))
    counts = [sum(step[field] for step in said["steps"])
              for field in ("increments", "iterations", "factorisations", "back_solves")]
    return "| " + " | ".join([
        body, str(said["equations"]), name, f"{best['cpu']:.2f}", f"{best['mib']:.0f}",
        *map(str, counts), *(f"{best['cpu']*timing.get(p, 0.0)/wall:.2f}" for p in PHASES),
        best["force"]]) + " |"


def main() -> None:
    """Each scene by each executable."""
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bodies", nargs="+", default=["billet:12", "billet:18", "ring:8"])
    parser.add_argument("--repeat", type=int, default=2)
    parser.add_argument("--before", help="another executable, run in turns")
    parser.add_argument("--share", type=float, default=1.0)
    options = parser.parse_args()
    programs = {"now": LOPIN} | ({"before": options.before} if options.before else {})
    heads = ("body", "equations", "program", "CPU s", "MiB", "increments", "iterations",
             "factorisations", "back-solves", *PHASES, "force")
    print("| " + " | ".join(heads) + " |\n" + "| --- "*len(heads) + "|")
    for body in options.bodies:
        kind, n = body.split(":")
        with tempfile.TemporaryDirectory() as place:
            (Path(place)/"body.inp").write_text(deck(kind, int(n), options.share))
            runs = {name: [] for name in programs}
            for _ in range(options.repeat):
                for name, program in programs.items():
                    try:
                        runs[name].append(run(program, Path(place)))
                    except RuntimeError as trouble:
                        print(f"{body}, {name}: {trouble}", flush=True)
        for name, mine in runs.items():
            if mine:
                print(row(body, name, mine), flush=True)


if __name__ == "__main__":
    main()
