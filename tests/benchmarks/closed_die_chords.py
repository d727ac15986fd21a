"""The closed die as an STL file at three chordal errors, beside the same die as an analytic tool.

    python tests/benchmarks/closed_die_chords.py

Writes the table between its marks in docs/forming.md: a quarter of `closed_die` in space, forces at
three strokes beside those of the analytic tool, increments, what was said of folding.
"""
from __future__ import annotations

import math
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from page_tables import put_table

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT/"docs"/"forming.md"
BEGIN, END = "<!-- closed die by chords -->", "<!-- end of closed die by chords -->"
sys.path.insert(0, str(ROOT/"decks"/"make"))
from forging import CLOSED_DIE, segments  # noqa: E402
from tools import binary  # noqa: E402

import lopin  # noqa: E402
from lopin import Elastic, Material, NortonHoff, mesh_make, profile  # noqa: E402
from lopin.model import Model  # noqa: E402

SPEED, STOP, STROKE = 50.0, 4.95, 5.0    #: [mm/s], [mm], [mm] until the dies meet
ERRORS = (0.0125, 0.05, 0.2)             #: of chords [mm]
AT = (4.5, 4.9, 4.95)                    #: strokes at which forces are compared [mm]


def rows_of_die() -> list[list[float]]:
    """The upper die where it starts: ends of lines (r, z), and of arcs with their centres
    (r, z, r, z)."""
    lines = segments("DIE", [(max(r, 0.0), z + STROKE, f) for r, z, f in CLOSED_DIE]).splitlines()
    return [[float(v) for v in line.split(",")[1:]] for line in lines[1:]]


def chords(error: float) -> np.ndarray:
    """The profile as a polygon no farther than `error` from it."""
    points: list = []
    for r, z, *centre in rows_of_die():
        if not centre:
            points.append((r, z))
            continue
        ends = np.array([points[-1], (r, z)]) - centre
        radius = np.hypot(*ends[0])
        first, last = np.arctan2(ends[:, 1], ends[:, 0])
        turn = (last - first + math.pi) % (2.0*math.pi) - math.pi
        n = max(1, math.ceil(abs(turn)/(2.0*math.acos(1.0 - min(error/radius, 1.0)))))
        points += [np.array(centre) + radius*np.array([math.cos(a), math.sin(a)])
                   for a in first + turn*np.linspace(0.0, 1.0, n + 1)[1:]]
    return np.array(points, float)


def turned(points: np.ndarray, error: float) -> np.ndarray:
    """The polygon turned about z, beyond the quarter on both sides, its triangles downward."""
    steps = math.ceil(math.radians(110.0)/(2.0*math.acos(1.0 - error/points[:, 0].max())))
    angles = np.radians(np.linspace(-100.0, 10.0, steps + 1))
    facets = []
    for (r, z), (q, w) in zip(points, points[1:]):
        for a, b in zip(angles, angles[1:]):
            corners = [(s*math.cos(t), s*math.sin(t), h)
                       for s, t, h in ((r, a, z), (r, b, z), (q, b, w), (q, a, w))]
            # Seen from below; at the axis one of the two has no area.
            facets += [[corners[k] for k in three] for three in ((0, 3, 2), (0, 2, 1))]
    facets = np.array(facets)
    area = np.linalg.norm(np.cross(facets[:, 1] - facets[:, 0], facets[:, 2] - facets[:, 0]),
                          axis=1)
    return facets[area > 1e-9]


def forged(cells: tuple[int, int], error: float, folder: Path) -> dict:
    """One run; error 0: the analytic die. Strokes, forces [kN, of the whole disc], increments."""
    model = Model("die", mesh_make.cylinder(15.0, 12.0, cells, part="quarter"), kind="3d")
    model.section("ALL", Material(Elastic(150000.0, 0.3), NortonHoff(50.0, 0.15)))
    if error:
        (folder/"die.stl").write_bytes(binary(turned(chords(error), error)))
        shape = profile.stl(folder/"die.stl", is_open=True)
    else:
        first, *rows = rows_of_die()
        shape = profile.start(*first)
        for r, z, *centre in rows:
            shape = shape.arc_to(r, z, tuple(centre)) if centre else shape.line_to(r, z)
        shape = shape.revolved((0.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    die = model.rigid_tool("DIE", shape, ref=(0.0, 0.0, 20.0))
    for side in ("TOP", "ARC"):
        model.contact(side, die, friction=0.1)
    model.fix("LEFT", "x")
    model.fix("BACK", "y")
    model.fix("BOTTOM", "z")
    model.step(time=STOP/SPEED, first=0.001, smallest=1e-6, largest=0.002, most=1000,
               nlgeom=True).move(die, z=-SPEED, velocity=True)
    try:
        result, ended = lopin.run(model.to_deck()), ""
    except lopin.LopinError as stopped:
        result, ended = stopped.result, str(stopped).split(":")[0]
    history = {k: np.abs(np.asarray(v, float)) for k, v in result.history.items()}
    said = {d["code"] for d in result.diagnostics}
    return {"way": history["DIE.u3"], "force": 4e-3*history["DIE.rf3"], "ended": ended,
            "folds": "W0531" in said}


def row(name: str, run: dict, beside: dict | None) -> str:
    cells = [name]
    for at in AT:
        if run["way"][-1] < at - 1e-9:
            cells.append("not reached")
            continue
        force = float(np.interp(at, run["way"], run["force"]))
        than = "" if beside is None or beside["way"][-1] < at - 1e-9 else \
            f" ({100.0*(force/np.interp(at, beside['way'], beside['force']) - 1.0):+.1f} %)"
        cells.append(f"{force:.1f}{than}")
    more = "" if beside is None else f" ({len(run['way'])/len(beside['way']):.2f})"
    cells.append(f"{len(run['way'])}{more}")
    cells.append(", ".join(filter(None, ["W0531" if run["folds"] else "", run["ended"]])) or "-")
    return "| " + " | ".join(cells) + " |"


def main() -> None:
    """The table, into the page."""
    rows = ["| cells; chordal error [mm] | " + " | ".join(f"{at:g} mm [kN]" for at in AT)
            + " | increments | said |", "| --- "*(len(AT) + 3) + "|"]
    for cells in ((5, 6), (8, 10)):
        with TemporaryDirectory() as folder:
            analytic = forged(cells, 0.0, Path(folder))
            rows.append(row(f"{cells[0]} x {cells[1]}; analytic", analytic, None))
            print(rows[-1], flush=True)
            for error in ERRORS:
                rows.append(row(f"{cells[0]} x {cells[1]}; {error:g}",
                                forged(cells, error, Path(folder)), analytic))
                print(rows[-1], flush=True)
    put_table(PAGE, BEGIN, END, "\n".join(rows))


if __name__ == "__main__":
    main()
