"""Blanking by five clearances, on cells of half the size, and through the sheet.

    python tests/benchmarks/cut_sheets.py [--print]

Writes the tables between their marks in docs/damage.md. Critical values are those of a crack that
begins at 0.2 mm with a clearance of 5 %; the other clearances are predicted by them. Some 15
minutes.
"""
from __future__ import annotations

import json
import os
import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from page_tables import put_table

ROOT = Path(__file__).resolve().parents[2]
PAGE, BEGIN, END = ROOT/"docs"/"damage.md", "<!-- clearances -->", "<!-- end of clearances -->"
THROUGH, THROUGH_END = "<!-- through the sheet -->", "<!-- end of through the sheet -->"
os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")
sys.path.insert(0, str(ROOT/"decks"/"make"))
import blanking  # noqa: E402

import lopin  # noqa: E402
from lopin.remesh.driver import Runner  # noqa: E402
from lopin.remesh.report import columns  # noqa: E402

CRITERIA = ("COCKCROFT-LATHAM", "OYANE", "RICE-TRACEY")
CLEARANCES = (0.01, 0.03, 0.05, 0.10, 0.15)
#: Where the crack of the clearance of 5 % is taken to begin [mm].
ONSET, REFERENCE = 0.2, (0.05, 0.025)


def cut(deck: lopin.Deck, folder: str) -> tuple[dict[str, np.ndarray], Runner, str]:
    """History of a run, the run, what ended it."""
    run, ended = Runner(deck, folder, say=lambda _: None), ""
    try:
        run.run()
    except lopin.LopinError as stopped:
        ended = stopped.id or type(stopped).__name__
    return columns(Path(folder)/f"{deck.name}_history.csv"), run, ended


def punched(clearance: float, cell: float) -> dict[str, np.ndarray]:
    """Stroke [mm], force [kN] and largest means of a sheet of which nothing is taken out."""
    card = f"*REMESH, ELSET=SHEET, SIZE=0.5, SMALLEST={0.8*cell:g}, STRAIN=0.4, MOST=400\n"
    deck = lopin.Deck.parse(blanking.blanking(cell, clearance, 0.3, card), name="sheet")
    with TemporaryDirectory() as folder:
        history, _, ended = cut(deck, folder)
    found = {"stroke": -history["PUNCH.u2"], "force": -history["PUNCH.rf2"]/1e3}
    found |= {c: history[f"damage.{c}"] for c in CRITERIA}
    print(clearance, cell, f"to {found['stroke'][-1]:.3f} mm {ended}", flush=True)
    return found


def row_of(clearance: float, cell: float, found: dict, critical: dict[str, float]) -> str:
    """Greatest force, and where each criterion says that the crack begins."""
    onset = [np.interp(critical[c], np.maximum.accumulate(found[c]), found["stroke"], right=np.nan)
             for c in CRITERIA]
    means = [np.interp(ONSET, found["stroke"], found[c]) for c in CRITERIA]
    return (f"| {clearance:.2f} | {cell:g} | {found['force'].max():.2f} | "
            + " | ".join(f"{s:.3f}" for s in onset) + " | "
            + " | ".join(f"{m:.3f}" for m in means) + " |")


def clearances() -> list[str]:
    """The first table."""
    runs = {(c, cell): punched(c, cell) for cell in (0.025, 0.0125) for c in CLEARANCES
            if cell == 0.025 or c in (0.05, 0.15)}
    standard = runs[REFERENCE]
    critical = {c: float(np.interp(ONSET, standard["stroke"], standard[c])) for c in CRITERIA}
    named = [f"{c}: crack at [mm] ({critical[c]:.2f})" for c in CRITERIA]
    return [f"| clearance [mm] | cells [mm] | greatest force [kN] | {' | '.join(named)} | "
            + " | ".join(f"{c} at {ONSET:g} mm" for c in CRITERIA) + " |", "| --- "*9 + "|",
            *(row_of(*where, found, critical) for where, found in runs.items())]


def through() -> list[str]:
    """The second: a disc cut off, its volume and energy."""
    card = "*REMESH, ELSET=SHEET, SIZE=0.5, SMALLEST=0.02, STRAIN=0.4, MOST=400\n"
    text = blanking.blanking(0.05, 0.05, 0.5, card)
    text = text.replace("CRITERION=OYANE, WIDTH=0.05", "CRITERION=OYANE, WIDTH=0.05, CRITICAL=0.3")
    began = time.process_time()
    with TemporaryDirectory() as folder:
        history, run, ended = cut(lopin.Deck.parse(text, name="sheet"), folder)
        report = json.loads((Path(folder)/"sheet.parts.json").read_text())
    stroke, force = -history["PUNCH.u2"], -history["PUNCH.rf2"]/1e3
    print(json.dumps(report.get("balance")), ended)
    most = int(np.argmax(force))
    seconds = time.process_time() - began
    lines = ["| | |", "| --- | --- |",
             f"| greatest force | {force[most]:.2f} kN at {stroke[most]:.3f} mm |",
             f"| end | {stroke[-1]:.3f} mm, {force[-1]:.2f} kN {ended} |",
             f"| parts, increments, minutes of CPU | {len(run.report.parts)}, {len(stroke)}, "
             f"{seconds/60.0:.1f} |"]
    return lines + [f"| {name} | {value:.5g} |" for name, value in report["balance"].items()]


def main() -> None:
    """Both tables, printed and into the page."""
    tables = (BEGIN, END, clearances()), (THROUGH, THROUGH_END, through())
    for _, _, lines in tables:
        print("\n".join(lines))
    if "--print" not in sys.argv:
        for mark, other, lines in tables:
            put_table(PAGE, mark, other, "\n".join(lines))


if __name__ == "__main__":
    main()
