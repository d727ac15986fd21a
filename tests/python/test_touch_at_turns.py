"""A node that lifts at the edge of a block closes in the increment in which the tool turns round:
slip counts from the way that the increment leads to, on which what slid sticks or slides back."""
import numpy as np
import pytest
from sliding_scenes import deck, rotation, turned

from lopin.charts.cases import with_elements
from lopin.mesh import make as mesh_make

SAW = [(0.0, 0.0), (0.1, 1.0), (0.3, -1.0), (0.5, 1.0), (0.7, -1.0), (0.9, 1.0), (1.0, 0.0)]
PRESS, SPAN = -0.1, 0.2


def cycle(folder, word="CPE4", cells=(8, 8), mu=0.5, static="0.05, 1.", angle=0.0, way=1.0,
          behaviour=""):
    """Pressed in a first step, moved to and fro in the second; `way` is the side that is first."""
    mesh = turned(mesh_make.block((10.0, 10.0), cells), angle)
    turn = rotation(angle)
    (a, b), (c, d) = ((turn @ np.array(p)).tolist() for p in ((20.0, 10.0), (-20.0, 10.0)))
    points = [(t, (turn @ np.array([way*SPAN*v, PRESS])).tolist()) for t, v in SAW]
    rows = ["\n".join(f"{t!r}, {u[k]!r}" for t, u in points) for k in (0, 1)]
    cards = f"""*NODE, NSET=P
9001, 0., 0.
*MATERIAL, NAME=M
*ELASTIC
1000., 0.
*SOLID SECTION, ELSET=ALL, MATERIAL=M
1.,
*SURFACE, NAME=TOOL, TYPE=SEGMENTS
START, {a!r}, {b!r}
LINE, {c!r}, {d!r}
*RIGID BODY, ANALYTICAL SURFACE=TOOL, REF NODE=9001
*SURFACE INTERACTION, NAME=I
{behaviour}
*FRICTION
{mu!r},
*CONTACT PAIR, INTERACTION=I
TOP, TOOL
*BOUNDARY
BOTTOM, 1, 2
9001, 6, 6
*AMPLITUDE, NAME=X, VALUE=ABSOLUTE
{rows[0]}
*AMPLITUDE, NAME=Y, VALUE=ABSOLUTE
{rows[1]}
*STEP, INC=2000, NLGEOM
*STATIC, DIRECT
1., 1.
*BOUNDARY
9001, 1, 1, {points[0][1][0]!r}
9001, 2, 2, {points[0][1][1]!r}
*END STEP
*STEP, INC=2000, NLGEOM
*STATIC{", DIRECT" if "direct" in static else ""}
{static.removesuffix(" direct")}
*BOUNDARY, AMPLITUDE=X
9001, 1, 1, 1.
*BOUNDARY, AMPLITUDE=Y
9001, 2, 2, 1.
*END STEP
""".replace("\n\n", "\n")
    made = deck(mesh, cards, folder)
    return made if word == "CPE4" else with_elements(made, word)


def shears(solve, folder, angle=0.0, way=1.0, **options):
    """Shear of the tool at the last turns and at the end, towards the side that is first."""
    run = solve(cycle(folder, angle=angle, way=way, **options))
    along = rotation(angle)[:, 0]*way
    shear = run.history["TOOL.rf1"]*along[0] + run.history["TOOL.rf2"]*along[1]
    return np.array([shear[np.argmin(abs(np.asarray(run.times) - 1.0 - t))] for t, _ in SAW[1:]])


FAMILY = [("CPE4", (8, 8), 0.5), ("CPE8", (4, 4), 0.3),
          ("CPE8R", (4, 4), 0.5), ("CPE4I", (8, 8), 0.3)]


@pytest.mark.parametrize("word, cells, mu", FAMILY)
def test_increments_of_any_length_end_with_the_shear_of_fine_ones(solve, tmp_path, word, cells, mu):
    """An increment a leg, or several: -24.1 came for -10.3, and -13.0 in one a leg."""
    options = {"word": word, "cells": cells, "mu": mu}
    fine = shears(solve, tmp_path, static="0.005, 1. direct", **options)
    assert fine[-1] > -0.99*mu*102.0   # friction sticks in part at the end: the history is read
    for static in ("0.05, 1.", "1., 1.", "0.1, 1. direct"):
        assert shears(solve, tmp_path, static=static, **options) == pytest.approx(fine, rel=0.015)


@pytest.mark.parametrize("word, cells, mu", FAMILY)
def test_the_history_of_friction_does_not_depend_on_axes(solve, tmp_path, word, cells, mu):
    options = {"word": word, "cells": cells, "mu": mu}
    straight = shears(solve, tmp_path, **options)
    for angle, way in ((0.0, -1.0), (31.7, 1.0), (45.0, -1.0), (90.0, 1.0)):
        assert shears(solve, tmp_path, angle, way, **options) == pytest.approx(straight, rel=1e-5)


@pytest.mark.parametrize("behaviour", ["*SURFACE BEHAVIOR, AUGMENTED LAGRANGE"])
def test_methods_agree(solve, tmp_path, behaviour):
    exact = shears(solve, tmp_path)
    assert shears(solve, tmp_path, behaviour=behaviour) == pytest.approx(exact, rel=0.01)
