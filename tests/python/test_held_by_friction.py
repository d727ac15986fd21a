"""A block that friction alone holds on a plane: what its cone can bear is borne, what it cannot is
refused, by every method, near the angle of friction and far from it."""
from math import cos, radians, sin, tan

import pytest
from blocks_2d import Block, ticks
from friction_scenes import METHODS

import lopin


def on_a_plane(kind, cells, size, degrees, share, behaviour="", step="*STEP"):
    """Weight at an angle to the plane's normal, a coefficient of `share` times its tangent."""
    body = Block(kind, ticks(0.0, size[0], cells[0]), ticks(0.0, size[1], cells[1]), 0, "BODY")
    a = radians(degrees)
    text = "*NODE\n" + "".join(f"{1 + i}, {x:.12g}, {y:.12g}\n" for i, (x, y) in enumerate(body.x))
    text += f"*ELEMENT, TYPE={kind}, ELSET=BODY\n"
    text += "".join(f"{1 + i}, {', '.join(map(str, nodes))}\n"
                    for i, nodes in enumerate(body.elements))
    text += "*SURFACE, NAME=FOOT\n" + "".join(f"{e}, S{s}\n" for e, s in body.bottom)
    return lopin.Deck.parse(text + f"""*NODE, NSET=REF
99999, 0., -1.
*SURFACE, NAME=PLANE, TYPE=SEGMENTS
START, -10., 0.
LINE, 20., 0.
*RIGID BODY, ANALYTICAL SURFACE=PLANE, REF NODE=99999
*MATERIAL, NAME=SOFT
*ELASTIC
1000., 0.3
*DENSITY
1e-3
*SOLID SECTION, ELSET=BODY, MATERIAL=SOFT
*SURFACE INTERACTION, NAME=RUB
{behaviour}*FRICTION
{share*tan(a)!r}
*CONTACT PAIR, INTERACTION=RUB
FOOT, PLANE
*BOUNDARY
99999, 1, 6
{step}
*STATIC
*DLOAD
BODY, GRAV, 1., {sin(a)!r}, {-cos(a)!r}
*END STEP
""", name="on_a_plane")


def held(result, size, degrees):
    """The plane bears the weight."""
    weight = 1e-3*size[0]*size[1]
    force = [result.history[f"PLANE.rf{i}"][-1] for i in (1, 2)]
    a = radians(degrees)
    assert [abs(f) for f in force] == pytest.approx([weight*sin(a), weight*cos(a)], rel=1e-8)
    assert result.summary["certificate"]["verdict"] == "PASS"


#: Newton finds no sets, and what follows coefficients down does.
HARD = [("CPE8", (2, 1), (2, 1), 1.05), ("CPE8", (6, 2), (2, 1), 1.01),
        ("CPE8", (8, 4), (4, 1), 1.01), ("CPE4", (11, 5), (1, 1), 1.01),
        ("CPE3", (6, 2), (1, 1), 1.2), ("CPE3", (8, 4), (1, 1), 1.01),
        ("CPE6", (6, 2), (4, 1), 1.01), ("CPE6", (1, 1), (1, 1), 1.05)]


@pytest.mark.parametrize("kind, cells, size, share", HARD)
def test_what_the_cone_bears_is_borne(solve, kind, cells, size, share):
    held(solve(on_a_plane(kind, cells, size, 10.0, share)), size, 10.0)


@pytest.mark.parametrize("share", [1.01, 1.1])
@pytest.mark.parametrize("degrees", [10.0, 25.0])
@pytest.mark.parametrize("method", METHODS)
def test_every_method_holds_it(solve, method, degrees, share):
    deck = on_a_plane("CPE3", (3, 2), (1, 1), degrees, share, f"*SURFACE BEHAVIOR, {method}\n")
    held(solve(deck), (1, 1), degrees)


@pytest.mark.parametrize("method", METHODS)
def test_what_the_cone_does_not_bear_is_refused(solve, method):
    with pytest.raises(lopin.LopinError, match="E0310.*move along x"):
        solve(on_a_plane("CPE3", (3, 2), (1, 1), 10.0, 0.98, f"*SURFACE BEHAVIOR, {method}\n"))
