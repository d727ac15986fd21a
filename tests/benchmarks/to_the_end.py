"""Sheets, billets, belts and rings to the end of their way by default settings.

    python tests/benchmarks/to_the_end.py [WORD ...] [--keep FOLDER] [--print]

Runs every scene whose name holds one of the words (all of them: some 15 minutes) with no word on
increments, methods or solvers, and writes increments, iterations, the force or moment at the end
of the forming and what was said into the page. A folder to keep rows in lets the script go on
where it was broken off.
"""
from __future__ import annotations

import json
import os
import re
import sys
from collections.abc import Callable, Iterator
from math import exp, radians
from pathlib import Path

import numpy as np
from page_tables import put_table, scene_words

ROOT = Path(__file__).resolve().parents[2]
os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")
os.environ.setdefault("LOPIN_EXECUTABLE", str(ROOT/"build"/"lopin"))
sys.path[:0] = [str(ROOT/"decks"/"make"), str(ROOT/"tests"/"python")]

import sheets  # noqa: E402
import sliding  # noqa: E402
import square_cup  # noqa: E402
import test_belts as belts  # noqa: E402

import lopin  # noqa: E402
from lopin.atlas.forming_scenes import billet  # noqa: E402

PAGE, BEGIN, END = ROOT/"docs"/"release.md", "<!-- to the end -->", "<!-- end of to the end -->"
LAWS = [(law, m) for law in ("TRESCA", "CRISTESCU") for m in (0.1, 0.2, 0.4)]
SWIFT = "*PLASTIC, HARDENING=SWIFT\n550., 0.006, 0.22"


def default(text: str) -> str:
    """No increments, and room for as many as it takes."""
    text = re.sub(r"(\*STATIC[^\n]*)\n[^*\n]+\n", r"\1\n", text)
    return re.sub(r", INC=\d+", ", INC=2000", text)


def with_law(text: str, law: str, m: float) -> str:
    """All friction by another law."""
    return re.sub(r"\*FRICTION[^\n]*\n[^\n]*", f"*FRICTION, LAW={law}\n{m:g}", text)


def oiled(mu: float, *pairs: str) -> list[str]:
    """Pairs and their friction; none for 0."""
    lines = sheets.interaction("OILED", mu, *pairs)
    return lines if mu else [line for line in lines if line not in ("*FRICTION", "0")]


def u_bend(radius: float = 5.0, gap: float = 0.2, cells: tuple[int, int] = (60, 2), mu: float = 0.1,
           metal: str = SWIFT, first: float | None = None, stroke: float = 30.0) -> str:
    """A sheet of 1 mm drawn into a U of 40 mm without a pad under the punch."""
    half, wall = 60.0, 20.0
    lines = sheets.sheet("CPE4I", [half*i/cells[0] for i in range(cells[0] + 1)], 1.0, cells[1])
    lines += ["*MATERIAL, NAME=METAL", "*ELASTIC", "210e3, 0.3", metal,
              "*SOLID SECTION, ELSET=SHEET, MATERIAL=METAL", "1.,"]
    edge = wall + 1.0 + gap
    lines += sheets.tool("PUNCH", 90001, (0.0, 1.0), [
        f"START, {wall:g}, 60.", f"LINE, {wall:g}, {1.0 + radius:g}",
        f"CIRCL, {wall - radius:g}, 1., {wall - radius:g}, {1.0 + radius:g}", "LINE, -5., 1."])
    lines += sheets.tool("DIE", 90002, (edge + radius, 0.0), [
        f"START, {edge:g}, -60.", f"LINE, {edge:g}, {-radius:g}",
        f"CIRCL, {edge + radius:g}, 0., {edge + radius:g}, {-radius:g}", "LINE, 90., 0."])
    lines += sheets.interaction("OILED", mu, "TOP, PUNCH", "BOTTOM, DIE")
    start = f"{first:g}, 1.\n" if first else ""
    return "\n".join(["*HEADING", "U-bend", *lines, "*BOUNDARY", "MIDDLE, 1", "PUNCH_REF, 1",
                      "PUNCH_REF, 6", "DIE_REF, 1, 2", "DIE_REF, 6", "*STEP, NLGEOM, INC=2000",
                      f"*STATIC\n{start}*BOUNDARY", f"PUNCH_REF, 2, 2, {-stroke:g}", "*END STEP", ""])


def three_points(layers: int, mu: float) -> str:
    """A strip of 2 mm on two rollers of 8 mm, pressed between them by a third: half of it."""
    lines = sheets.sheet("CPE4I", [60.0*i/80 for i in range(81)], 2.0, layers)
    lines += sheets.material([(300.0, 0.0), (1300.0, 2.0)], 210e3)
    for name, node, x, y, turn in (("ROLLER", 90001, 0.0, 10.0, -1.0), ("SUPPORT", 90002, 30.0, -8.0, 1.0)):
        lines += sheets.tool(name, node, (x, y), [
            f"START, {x - 8.0*turn:g}, {y:g}", f"CIRCL, {x:g}, {y + 8.0*turn:g}, {x:g}, {y:g}",
            f"CIRCL, {x + 8.0*turn:g}, {y:g}, {x:g}, {y:g}"])
    lines += oiled(mu, "TOP, ROLLER", "BOTTOM, SUPPORT")
    return "\n".join(["*HEADING", "Three points", *lines, "*BOUNDARY", "MIDDLE, 1", "ROLLER_REF, 1",
                      "ROLLER_REF, 6", "SUPPORT_REF, 1, 2", "SUPPORT_REF, 6",
                      "*STEP, NLGEOM, INC=2000", "*STATIC", "*BOUNDARY", "ROLLER_REF, 2, 2, -36.",
                      "*END STEP", "*STEP, NLGEOM, INC=2000", "*STATIC", "*BOUNDARY",
                      "ROLLER_REF, 2, 2, -20.", "*END STEP", ""])


def lifted(mu: float) -> str:
    """A flat sheet, pressed on a flat die by a pressure that goes, then its middle is lifted."""
    lines = sheets.sheet("CPE4I", [40.0*i/80 for i in range(81)], 1.0, 2)
    lines += sheets.material([(300.0, 0.0), (1300.0, 2.0)], 210e3)
    lines += sheets.tool("DIE", 90002, (0.0, 0.0), ["START, -5., 0.", "LINE, 90., 0."])
    lines += oiled(mu, "BOTTOM, DIE")
    return "\n".join(["*HEADING", "Lifted", *lines, "*BOUNDARY", "MIDDLE, 1", "DIE_REF, 1, 2",
                      "DIE_REF, 6", "*STEP, NLGEOM", "*STATIC", "*DSLOAD", "TOP, P, 5.", "*END STEP",
                      "*STEP, NLGEOM", "*STATIC", "*DSLOAD", "TOP, P, 0.01", "*BOUNDARY",
                      "MIDDLE, 2, 2, 3.", "*END STEP", ""])


def scenes() -> Iterator[tuple[str, Callable[[], lopin.Deck]]]:
    """Names, and what makes their decks."""
    def of(text: Callable[[], str]) -> Callable[[], lopin.Deck]:
        return lambda: lopin.Deck.parse(default(text()), "scene")

    for word, changes in [
            ("", {}), (", first increment 0.01", {"first": 0.01}),
            (", first increment 0.002", {"first": 0.002}), (", μ = 1e-4", {"mu": 1e-4}),
            (", radii 3", {"radius": 3.0}), (", radii 8", {"radius": 8.0}),
            (", gap 0.1", {"gap": 0.1}), (", gap 0.5", {"gap": 0.5}), (", gap 0.8", {"gap": 0.8}),
            (", 90 x 3 cells", {"cells": (90, 3)}), (", 120 x 2 cells", {"cells": (120, 2)}),
            (", 60 x 1 cells", {"cells": (60, 1)}),
            (", from 300 MPa", {"metal": "*PLASTIC\n300., 0.\n1300., 2."}),
            (", from 900 MPa", {"metal": "*PLASTIC\n900., 0.\n1900., 2."})]:
        yield "U-bend without a pad" + word, (
            lambda changes=changes: lopin.Deck.parse(u_bend(**changes), "scene"))
    for law, m in LAWS:
        yield f"V-bend, {law} {m:g}", of(lambda law=law, m=m: with_law(sheets.v_bending(), law, m))
    for law, m in LAWS:
        yield f"billet by 60 %, {law} {m:g}", (
            lambda law=law, m=m: billet("CAX4", [f"*FRICTION, LAW={law}", f"{m:g}"])[0].deck())
    for method in ("DIRECT", "PENALTY", "PERTURBED LAGRANGE", "AUGMENTED LAGRANGE"):
        yield f"strip wrapped by 90°, let go, {method}", of(
            lambda method=method: sheets.wrapped_strip(method=method))
    for layers, mu in ((4, 0.1), (4, 0.0), (1, 0.1)):
        yield f"three-point bending to 72°, {layers} layers, μ = {mu:g}", of(
            lambda layers=layers, mu=mu: three_points(layers, mu))
    for mu in (0.1, 0.0):
        yield f"flat sheet lifted off a flat die, μ = {mu:g}", of(lambda mu=mu: lifted(mu))
    yield "cup, 60 x 3", of(sheets.cup)
    yield "cup, 180 x 3", of(lambda: sheets.cup(180))
    yield "cup, 120 x 3, TRESCA 0.1", of(lambda: with_law(sheets.cup(120), "TRESCA", 0.1))
    yield "square cup, 40 mm, 24 cells", of(lambda: square_cup.square_cup(24, 40.0))
    for angle in (90, 180, 225):
        yield f"belt over {angle}°", lambda angle=angle: belts.belt(angle)
    for facets in (16, 24, 32, 48, 60):
        yield f"ironing by a die of {facets} facets", of(
            lambda facets=facets: sliding.ironing(around=facets))
    for mu in (0.0, 0.2):
        yield f"rings turned by 60° in their fit, μ = {mu:g}", of(
            lambda mu=mu: sliding.rotating_rings(mu=mu, turn=60.0).replace("*STATIC, DIRECT", "*STATIC"))


def driving_force(history: dict[str, np.ndarray]) -> np.ndarray:
    """Force of the tool that moves farthest, in the direction in which it does; without one, that
    of the pair that presses most."""
    ways = {k: np.abs(v).max() for k, v in history.items() if re.search(r"\.u[1-3]$", k)}
    pairs = {k: np.abs(v).max() for k, v in history.items() if re.search(r"\.force[1-3]$", k)}
    pairs = pairs if max(pairs.values()) > 1e-6 else {   # rings in a fit press all round
        k: 1.0 for k in history if k.endswith(".max_pressure")}
    far = max(ways, key=ways.__getitem__, default="")
    if far and ways[far] > 0.0:
        return history[far.replace(".u", ".rf")]
    return history[max(pairs, key=pairs.__getitem__)]


def row_of(name: str, deck: lopin.Deck) -> dict:
    """Run it: what it took, its largest driving force at the end of the forming, what it said."""
    try:
        result = lopin.run(deck)
    except lopin.LopinError as stopped:
        return {"scene": name, "ends": str(stopped).split("\n")[0][:120]}
    steps = result.summary["steps"]
    history = {k: np.asarray(v, float) for k, v in result.history.items()}
    force = driving_force(history)
    ends = np.flatnonzero(np.diff(np.append(history["step"], np.inf)) > 0.0)   # of the steps
    pressed = [k for k in ends if abs(force[k]) > 1e-9*np.abs(force).max()]
    last = pressed[-1] if pressed else -1
    said = sorted({str(d["code"]) for d in result.diagnostics if str(d["code"])[0] == "W"
                   or d["code"] in ("N0517", "N0561")})
    row = {"scene": name, "increments": sum(s["increments"] for s in steps),
           "iterations": sum(s["iterations"] for s in steps), "verdict": result.verdict,
           "largest": float(np.abs(force).max()), "end": float(abs(force[last])),
           "said": " ".join(said)}
    if name.startswith("belt"):
        pull = abs(history["START.rf2"][-1])
        angle = int(re.search(r"(\d+)°", name).group(1))
        row["exact"] = pull/(belts.TENSION*exp(belts.MU*radians(angle))) - 1.0
    return row


def line_of(row: dict) -> str:
    """A row of the table."""
    if "ends" in row:
        return f"| {row['scene']} | | | | stops: {row['ends']} |"
    off = f", {100.0*row['exact']:+.2f} % of Euler and Eytelwein" if "exact" in row else ""
    forces = f"{row['largest']:.4g} | {row['end']:.4g}{off}" if row["largest"] else "|"
    return f"| {row['scene']} | {row['increments']}, {row['iterations']} | {forces} | {row['said']} |"


def write(rows: list[dict]) -> None:
    """The table into the page."""
    head = ["| scene | increments, iterations | largest force [N] | at the end of the forming | said |",
            "| --- | --- | --- | --- | --- |"]
    put_table(PAGE, BEGIN, END, "\n".join([*head, *map(line_of, rows)]))


def main() -> None:
    """Run what is not kept, print, and write the page."""
    given = scene_words(__doc__.splitlines()[0])
    rows = []
    for name, make in scenes():
        if given.words and not any(w in name for w in given.words):
            continue
        kept = given.keep/(re.sub(r"\W+", "_", name) + ".json") if given.keep else None
        if kept and kept.exists():
            row = json.loads(kept.read_text(encoding="utf-8"))
        else:
            row = row_of(name, make())
            if kept:
                kept.parent.mkdir(parents=True, exist_ok=True)
                kept.write_text(json.dumps(row), encoding="utf-8")
        rows.append(row)
        print(line_of(row), flush=True)
    if not (given.words or given.only_print):
        write(rows)


if __name__ == "__main__":
    main()
