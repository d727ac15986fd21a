"""Wheels that are turned, pulled or pushed roll without slip: friction alone holds them."""
import re
from random import Random

import pytest

import lopin


def wheel(drive="turn", angle=-0.4, mu=0.3, static="0.05, 1.", words=", NLGEOM", load=50.0,
          scale=1.0, turned=False, radius=5.0, wheels=(0.0,), nx=80):
    """Rigid wheels, pressed on a block by a force in a first step, driven in a second one."""
    ny = 6

    def at(x, y):
        x, y = (-y, x) if turned else (x, y)
        return f"{x*scale:.9e}, {y*scale:.9e}"

    def number(i, j):
        return 1 + i + (nx + 1)*j

    along, down, sign = (2, 1, -1.0) if turned else (1, 2, 1.0)
    nodes = "\n".join(f"{number(i, j)}, {at(-10.0 + 20.0*i/nx, -5.0 + 5.0*j/ny)}"
                      for j in range(ny + 1) for i in range(nx + 1))
    elements = "\n".join(f"{1 + i + nx*j}, {number(i, j)}, {number(i + 1, j)}, "
                         f"{number(i + 1, j + 1)}, {number(i, j + 1)}"
                         for j in range(ny) for i in range(nx))
    top = "\n".join(f"{1 + i + nx*(ny - 1)}, S3" for i in range(nx))
    bottom = "\n".join(str(number(i, 0)) for i in range(nx + 1))
    tools = pairs = press = go = ""
    for k, x in enumerate(wheels):
        ref, r = 9001 + k, radius
        tools += (f"*NODE\n{ref}, {at(x, r)}\n*SURFACE, NAME=W{k}, TYPE=SEGMENTS\n"
                  f"START, {at(x + r, r)}\nCIRCL, {at(x, 0.0)}, {at(x, r)}\n"
                  f"CIRCL, {at(x - r, r)}, {at(x, r)}\n"
                  f"*RIGID BODY, ANALYTICAL SURFACE=W{k}, REF NODE={ref}\n")
        pairs += f"*CONTACT PAIR, INTERACTION=I\nFACE, W{k}\n"
        press += (f"*BOUNDARY\n{ref}, {along}, {along}, 0.\n{ref}, 6, 6, 0.\n"
                  f"*CLOAD\n{ref}, {down}, {-sign*load*scale!r}\n")
        go += (f"{ref}, 6, 6, {angle!r}\n" if drive == "turn" else
               f"{ref}, {along}, {along}, {-angle*radius*scale!r}\n")
    return lopin.Deck.parse(f"""*HEADING
Wheels on a block
*NODE, NSET=ALL
{nodes}
*ELEMENT, TYPE=CPE4, ELSET=BLOCK
{elements}
*NSET, NSET=BOTTOM
{bottom}
*SURFACE, NAME=FACE
{top}
*MATERIAL, NAME=M
*ELASTIC
20000., 0.3
*SOLID SECTION, ELSET=BLOCK, MATERIAL=M
1.,
{tools}*SURFACE INTERACTION, NAME=I
*FRICTION
{mu!r},
{pairs}*BOUNDARY
BOTTOM, 1, 2
*STEP, INC=1000{words}
*STATIC
0.2, 1.
{press}*END STEP
*STEP, INC=1000{words}
*STATIC
{static}
*BOUNDARY, OP=NEW
BOTTOM, 1, 2
{go}*END STEP
""", "wheel")


@pytest.mark.parametrize("more", [
    {}, {"static": "1., 1."}, {"words": ""}, {"mu": 0.05, "nx": 40}, {"turned": True}, {"scale": 1e3},
    {"angle": 0.4}, {"wheels": (-5.0, 4.0)}, {"radius": 50.0, "angle": -0.04}],
    ids=["default", "one increment", "linear", "little friction", "up a wall", "large", "back",
         "two", "great"])
def test_a_wheel_that_is_turned_rolls(solve, more):
    history = solve(wheel(**more)).history
    way = -more.get("angle", -0.4)*more.get("radius", 5.0)*more.get("scale", 1.0)
    for k in range(len(more.get("wheels", [0]))):
        travel = history[f"W{k}.u2" if more.get("turned") else f"W{k}.u1"][-1]
        assert travel == pytest.approx(way, rel=0.015)


@pytest.mark.parametrize("mu", [0.3, 0.05])
def test_a_wheel_that_is_pulled_turns(solve, mu):
    history = solve(wheel("pull", mu=mu, nx=40)).history
    assert history["W0.u6"][-1] == pytest.approx(-0.4, rel=0.01)


@pytest.mark.parametrize("mu", [0.3, 0.1])
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_a_wheel_that_lifts_off_in_an_iteration_lands_softly(solve, mu, seed):
    """Turned by 0.04 and more in one increment it leaves the block for an iteration. What rounding
    does to nodes decides nothing: it once sank by two lengths of an element and crushed them."""
    text, rounding = wheel(mu=mu, nx=40, static="0.1, 1.").text(), Random(seed)
    if seed:
        text = re.sub(r"^(\d+, )(\S+e[-+]\d+)(?=, \S+e[-+]\d+$)", lambda found: found[1] + repr(
            float(found[2]) + 1e-12*rounding.uniform(-1.0, 1.0)), text, flags=re.MULTILINE)
    history = solve(lopin.Deck.parse(text, "wheel")).history
    assert history["W0.u1"][-1] == pytest.approx(2.0, rel=2e-3)
    assert sum(history["iterations"]) <= 60
