"""Motions that metal which flows leaves open, where equilibrium does not decide a shape (W0523)."""
import re

import pytest

from lopin.deck import Deck
from lopin.mesh_make import block


def bent(moment, hardening, metre=1.0):
    """A strip of 20 x 1 mm, held at one end and bent by a moment at the other; forces stay newtons."""
    mesh = block((20.0, 1.0), (6, 2))
    nodes = [f"{i}, {x*metre!r}, {y*metre!r}" for i, (x, y) in enumerate(mesh.points.tolist(), 1)]
    cells = [f"{i}, " + ", ".join(str(n + 1) for n in row)
             for i, row in enumerate(mesh.blocks[0][1].tolist(), 1)]
    ends = {side: [f"{n + 1}," for n in mesh.point_sets[side].tolist()] for side in ("LEFT", "RIGHT")}
    stress = metre**-2
    text = ["*NODE", *nodes, "*NODE, NSET=GRIP", f"900, {20.0*metre!r}, {0.5*metre!r}",
            "*ELEMENT, TYPE=CPE4I, ELSET=STRIP", *cells, "*NSET, NSET=FIXED", *ends["LEFT"],
            "*NSET, NSET=END", *ends["RIGHT"], "*RIGID BODY, NSET=END, REF NODE=900",
            "*MATERIAL, NAME=M", "*ELASTIC", f"{210e3*stress!r}, .3", "*PLASTIC",
            f"{300.0*stress!r}, 0.", f"{(300.0 + hardening)*stress!r}, 1.",
            "*SOLID SECTION, ELSET=STRIP, MATERIAL=M", f"{metre!r},", "*BOUNDARY", "FIXED, 1, 2",
            "*STEP, NLGEOM, INC=500", "*STATIC", "*CLOAD", f"GRIP, 6, {moment*metre!r}", "*END STEP"]
    return Deck.parse("\n".join(text) + "\n", name="bent")


def told(result):
    """Times softer than the elastic body, and the way of a hundredth of the forces."""
    words = [w["message"] for w in result.diagnostics if w["code"] == "W0523"]
    return [tuple(float(x) for x in re.search(r"a motion (\S+) times .* moves it by (\S+)", w).groups())
            for w in words]


@pytest.mark.parametrize("hardening, moment", [(300.0, 82.0), (20.0, 84.0)])
def test_it_is_told_alike_in_metres_and_millimetres(solve, hardening, moment):
    """In metres the motion was 7 000 times as soft, and told in strips that are not."""
    (times, way), = told(solve(bent(moment, hardening)))
    (in_metres, metres), = told(solve(bent(moment, hardening, metre=1e-3)))
    assert in_metres == times and metres == pytest.approx(1e-3*way, rel=0.1)


def test_a_moment_that_the_strip_hardens_against_is_not_told(solve):
    assert not told(solve(bent(75.0, 2000.0))) and not told(solve(bent(75.0, 2000.0, metre=1e-3)))
