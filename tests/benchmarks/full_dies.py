"""A cross and a connecting rod forged to the full die, their meshes made anew, by laws and methods.

    python tests/benchmarks/full_dies.py [WORD ...] [--keep FOLDER] [--print]

Runs every scene whose name holds all of the words (all of them: some 1.5 hours), measures how full
the die is (decks/make/die_filling.py) and writes the table between its marks in docs/forming.md.
A folder to keep runs and figures in lets the script go on where it was broken off: a run that was
stopped is resumed from its last part.
"""
from __future__ import annotations

import json
import os
import re
import resource
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from page_tables import put_table, scene_words

ROOT = Path(__file__).resolve().parents[2]
PAGE, BEGIN, END = ROOT/"docs"/"forming.md", "<!-- full dies -->", "<!-- end of full dies -->"
sys.path.insert(0, str(ROOT/"decks"/"make"))
import die_filling  # noqa: E402
import die_forging  # noqa: E402

#: Strokes of a die at which forces stand side by side [mm].
STROKES = {"full_cross": (10.0, 15.0, 18.0, 20.0, 21.0), "full_rod": (5.0, 6.0, 7.0, 8.0, 8.5, 9.0)}
#: Load of the slab estimate, flash and all [N].
SLAB = {"full_cross": 1.0e6, "full_rod": 1.8e6}
#: The whole beside the eighth or quarter that is run: how often its die presses.
WHOLE = {"full_cross": 4, "full_rod": 2}
CROSS = {"fine": 1.6, "deviation": 0.1}
ROD = {"fine": 1.6, "deviation": 0.05, "over": 1.15, "more": (1.0, 1.07), "way": 9.3}
LAWS = {"Coulomb 0.15": "0.15", "Tresca 0.3": "TRESCA 0.3"}
METHODS = {"exact": "DIRECT", "penalty": "PENALTY"}
SCENES = {f"{piece}, coarse, {law}, {method}":
          (scene, {**given, "friction": LAWS[law], "method": METHODS[method]})
          for piece, scene, given in (("cross", "full_cross", CROSS), ("rod", "full_rod", ROD))
          for law in LAWS for method in METHODS}
SCENES |= {
    "cross, fine, Tresca 0.3, exact": ("full_cross", {"fine": 1.0, "deviation": 0.02,
                                                      "friction": "TRESCA 0.3"}),
    "rod, fine, Coulomb 0.15, exact": ("full_rod", {**ROD, "fine": 1.3, "deviation": 0.02,
                                                    "way": 9.2})}


def forged(scene: str, given: dict, folder: Path) -> dict:
    """One run, or the rest of one, and its figures."""
    folder.mkdir(parents=True, exist_ok=True)
    deck, out = folder/f"{scene}.inp", folder/"out"
    if not deck.exists():
        deck.write_text(getattr(die_forging, scene)(folder, **given))
    command = [str(Path(sys.executable).with_name("lopin")), "run", str(deck), "-o", str(out)]
    if list(out.glob("*.p001.inp")):
        command.append("--resume")
    threads = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    with (folder/"run.log").open("a") as log:
        ended = subprocess.run(command, stdout=log, stderr=log, env={**os.environ, **threads})
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    said = re.findall(r"\b[WE]\d{4}\b", (folder/"run.log").read_text())
    table, _ = die_filling.history(out, die_filling.parts(out, scene))
    forces = np.interp(STROKES[scene], die_forging.SPEED*table[:, 0], -table[:, 1])
    return {"status": ended.returncode, "cpu": spent, "said": sorted(set(said)),
            "forces": forces.tolist(), **die_filling.figures(scene, out)}


def line_of(name: str, row: dict) -> str:
    """A row of the table."""
    scene = SCENES[name][0]
    force = WHOLE[scene]*row["force"]
    load = force/SLAB[scene] - 1.0
    phase = row["phases"]
    minutes = ", ".join(f"{phase[k]/60.0:.1f}" for k in
                        ("assemble", "factorise", "solve", "contact", "search"))
    first, *others = [*row["jumps"], 0.0]
    worst = max(map(abs, others), default=0.0)
    volume = row["volumes"][1]/row["volumes"][0] - 1.0
    fold = "none" if row["slot"] > 1.9 else f"air of {row['slot']:.2f} mm"
    return (f"| {name} | {row['stroke']:.2f} | {force/1e3:.0f}, {load:+.0%} | "
            f"{row['gap_mean']:.3f}, {row['gap']:.2f}, {row['gap_above']:.1%} | "
            f"{row['flash'][0]:.1f}, {row['flash'][1]:.1f} | {volume:+.2%} | {fold} | "
            f"{abs(first):.1%}, {worst:.1%} | {row['meshes']}, {row['increments']}, "
            f"{row['iterations']}; {row['cells']} | {row['cpu']/60.0:.1f}: {minutes}; "
            f"{row['remeshing']/60.0:.1f} | {phase['memory']:.0f} | "
            f"{', '.join(row['said']) or '-'} |")


HEAD = ("| scene | stroke [mm] | force [kN], beside the slab's | gap inside the land [mm]: mean, "
        "most, share above 0.05 | flash beyond the cavity [mm] | volume | fold | force at new "
        "meshes: first, others | meshes, increments, iterations; cells | CPU [min]: elements, "
        "factors, solves, contact, search (by the clock); remeshes | MiB | said |\n"
        + "| --- "*12 + "|")


def forces_of(rows: dict[str, dict]) -> list[str]:
    """A table for each piece: scenes down, strokes across, forces on the whole [kN]."""
    lines = []
    for scene, strokes in STROKES.items():
        lines += ["", f"| force [kN] of the {scene[5:]}; stroke [mm] | "
                  + " | ".join(f"{s:g}" for s in strokes) + " |", "| --- "*(len(strokes) + 1) + "|"]
        lines += [f"| {name} | " + " | ".join(f"{WHOLE[scene]*f/1e3:.1f}" for f in row["forces"])
                  + " |" for name, row in rows.items() if SCENES[name][0] == scene]
    return lines


def write(rows: dict[str, dict]) -> None:
    """The tables into the page."""
    put_table(PAGE, BEGIN, END, "\n".join([HEAD, *(line_of(*row) for row in rows.items()),
                                           *forces_of(rows)]))


def main() -> None:
    """Run what is not kept, print, and write the page."""
    given = scene_words(__doc__.splitlines()[0])
    rows: dict[str, dict] = {}
    with TemporaryDirectory() as scratch:
        for name, (scene, how) in SCENES.items():
            if not all(word in name for word in given.words):
                continue
            folder = (given.keep or Path(scratch)).resolve()/re.sub(r"\W+", "_", name)
            kept = folder/"figures.json"
            if not kept.exists():
                row = forged(scene, how, folder)
                kept.write_text(json.dumps(row), encoding="utf-8")
            rows[name] = json.loads(kept.read_text(encoding="utf-8"))
            print(line_of(name, rows[name]), rows[name]["forces"], flush=True)
    if not (given.words or given.only_print):
        write(rows)


if __name__ == "__main__":
    main()
