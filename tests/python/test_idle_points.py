"""Slave points whose gap has no slope in any displacement that is solved for have no pressure."""
from math import cos, radians, sin

import numpy as np
import pytest

import lopin
from lopin import mesh_make
from lopin.mesh import together

SOFT = lopin.laws.Elastic(1000.0, 0.3)
BOTH = pytest.mark.parametrize("mu", [0.0, 0.2])


def friction(mu):
    return lopin.Coulomb(mu) if mu else None


def told(result):
    return "N0409" in [d["code"] for d in result.diagnostics]


@BOTH
@pytest.mark.parametrize("push, angle", [(1e-12, 0.0), (1e-8, 0.0), (1e-8, 30.0)])
def test_a_plane_of_symmetry_that_is_a_tool_too(solve, mu, push, angle):
    """Pressures on the wall were 1e7 to 1e25 with PASS; turned, supports stand in local axes."""
    c, s = cos(radians(angle)), sin(radians(angle))
    turn = np.array([[c, s], [-s, c]])
    mesh = mesh_make.block((4.0, 3.0), (8, 6)).mapped(lambda x: x @ turn)
    model = lopin.Model("wall", mesh, kind="plane strain")
    model.section("ALL", SOFT)
    (a, b), (d, e) = np.array([[0.0, 9.0], [0.0, -9.0]]) @ turn
    model.contact("LEFT", model.rigid_tool("TOOL", lopin.profile.start(a, b).line_to(d, e)),
                  friction=friction(mu))
    model.fix("BOTTOM", "y")
    step = model.step(nlgeom=True)
    step.move("LEFT", x=-push)
    step.move("TOP", y=-0.03)
    text = model.to_deck().text()
    place = text.index("*BOUNDARY")
    axes = "".join(f"*TRANSFORM, NSET={n}\n{c!r}, {s!r}, 0., {-s!r}, {c!r}, 0.\n"
                   for n in ("LEFT", "BOTTOM", "TOP"))
    result = solve(lopin.Deck.parse(text[:place] + axes + text[place:], "wall"))
    assert result.verdict == "PASS" and told(result)
    assert result.contact(0).last.pressure.max() == 0.0


@BOTH
@pytest.mark.parametrize("faces", [False, True])
@pytest.mark.parametrize("push", [0.0, 1e-12, 1e-8, 1e-3])
def test_a_meshed_master_that_is_held(solve, mu, faces, push):
    """The last nodes of the slave are held along the normal: the others press as without them."""
    low = mesh_make.block((6.0, 1.0), (7, 2), origin=(-1.0, -1.0))
    up = mesh_make.block((4.0, 2.0), (8, 4))
    up = up.with_points("GUIDE", lambda x: (abs(x[:, 1]) < 1e-9) & (x[:, 0] < 1.1))
    model = lopin.Model("held", together(LOW=low, UP=up), kind="plane strain")
    for part in ("LOW", "UP"):
        model.section(part, SOFT)
    model.contact("UP.BOTTOM", "LOW.TOP", friction=friction(mu), surface_to_surface=faces)
    model.fix("LOW.BOTTOM", "x", "y")
    model.fix("LOW.TOP", "y")
    model.fix("UP.LEFT", "x")
    step = model.step(nlgeom=True)
    step.move("UP.GUIDE", y=-push)
    step.move("UP.TOP", y=-0.02)
    if push > 1e-6:
        with pytest.raises(lopin.LopinError, match="E0506.*overconstrained"):
            solve(model.to_deck())
        return
    result = solve(model.to_deck())
    assert result.verdict == "PASS" and told(result)
    contact = result.contact(0).last
    pressure = np.asarray(contact.pressure, dtype=float)[np.argsort(contact.x[:, 0])]
    assert pressure.max() < 16.0 and pressure[-3:].min() > 9.0
    assert pressure[:2].max() == 0.0
