"""Viscous metal under loads that change: its rate is given, and an increment flows as fast as its
end says (W0567).

A cylinder of Norton and Hoff's metal between plates without friction: stress F/A, rate of strain
(F/(A sqrt(3)^(m+1) K))^(1/m), integrated here by Runge and Kutta.
"""
import re
from math import pi, sqrt

import numpy as np
import pytest

import lopin

K, HEIGHT, RADIUS = 41.0, 10.0, 10.0


def deck(m, force, static, shape=(0.0, 1.0), tool=True, law=None, unit=1.0):
    """One element, pressed by a plate or by a pressure on its top; `shape`: share of the force at
    equal times from 0 to 1."""
    law = law or f"*VISCOPLASTIC, LAW=NORTON-HOFF\n{K*unit**-2:.12g}, {m}"
    r, h, area = RADIUS*unit, HEIGHT*unit, pi*(RADIUS*unit)**2
    plate = f"""*NODE, NSET=PLATE
9, 0., {h}
*SURFACE, NAME=FLAT, TYPE=SEGMENTS
START, {3*r}, {h}
LINE, {-0.1*r}, {h}
*RIGID BODY, ANALYTICAL SURFACE=FLAT, REF NODE=PLATE
*SURFACE INTERACTION, NAME=SLIPS
*CONTACT PAIR, INTERACTION=SLIPS
TOP, FLAT
*BOUNDARY
PLATE, 1
PLATE, 6
"""
    table = ", ".join(f"{t:g}, {s:g}" for t, s in zip(np.linspace(0.0, 1.0, len(shape)), shape))
    load = (f"*CLOAD, AMPLITUDE=SHAPE\nPLATE, 2, {-force}" if tool
            else f"*DSLOAD, AMPLITUDE=SHAPE\nTOP, P, {force/area:.12g}")
    return lopin.Deck.parse(f"""*NODE
1, 0., 0.
2, {r}, 0.
3, {r}, {h}
4, 0., {h}
*ELEMENT, TYPE=CAX4, ELSET=BLOCK
1, 1, 2, 3, 4
*SURFACE, NAME=TOP
1, S3
*MATERIAL, NAME=HOT
*ELASTIC
{100000.0*unit**-2}, 0.3
{law}
*SOLID SECTION, ELSET=BLOCK, MATERIAL=HOT
{plate if tool else ""}*BOUNDARY
1, 1, 2
2, 2
4, 1
*AMPLITUDE, NAME=SHAPE
{table}
*STEP, NLGEOM, INC=1000
*STATIC
{static}
{load}
*END STEP
""".replace("*STATIC\n" + static, static), name="block")


def pressed(*given, **more):
    """Stroke of the top, increments, and what W0567 tells [%], with its sign."""
    result = lopin.run(deck(*given, **more))
    told = 0.0
    for message in result.diagnostics:
        if message["code"] == "W0567":
            share, word = re.search(r"up to ([\d.e+-]+) % too (\w+)", message["message"]).groups()
            told = float(share)*(1.0 if word == "far" else -1.0)
    return -result["U"][3, 1], result.summary["steps"][0]["increments"], told


def exact(m, force, shape=(0.0, 1.0), tool=True):
    """Stroke by Runge and Kutta; under a pressure the area counts that is there."""
    n, h, area = 4000, HEIGHT, pi*RADIUS**2

    def rate(t, h):
        now = force*np.interp(t, np.linspace(0.0, 1.0, len(shape)), shape)
        stress = now/area if not tool else now/(area*HEIGHT/h)
        return -h*(stress/(sqrt(3.0)**(m + 1.0)*K))**(1.0/m)
    for k in range(n):
        t, dt = k/n, 1.0/n
        a = rate(t, h)
        b = rate(t + dt/2, h + dt/2*a)
        c = rate(t + dt/2, h + dt/2*b)
        h += dt/6*(a + 2*b + 2*c + rate(t + dt, h + dt*c))
    return HEIGHT - h


FREE = "*STATIC\n, 1."
SCENES = {
    "m = .145": (0.145, 30000.0, {}),
    "m = .5": (0.5, 12000.0, {}),
    "Newton's": (1.0, 6000.0, {}),
    "pressure": (0.145, 25000.0, {"tool": False}),
    "at once": (0.145, 25000.0, {"shape": (1.0, 1.0)}),
    "held": (0.145, 25000.0, {"shape": (0.0, 1.0, 1.0, 1.0)}),
    "off again": (0.145, 28000.0, {"shape": (0.0, 1.0, 0.0)}),
}


@pytest.mark.parametrize("name", SCENES)
def test_default_increments_follow_the_loads(name):
    m, force, how = SCENES[name]
    stroke, increments, told = pressed(m, force, FREE, **how)
    assert stroke == pytest.approx(exact(m, force, **how), rel=0.05) and told == 0.0
    assert increments < 200


@pytest.mark.parametrize("name", ["m = .145", "m = .5", "Newton's", "at once"])
def test_few_increments_are_told(name):
    """What is told is at most six times what is off, and no less; the shape says on which side."""
    m, force, how = SCENES[name]
    stroke, _, told = pressed(m, force, "*STATIC, DIRECT\n0.2, 1.", **how)
    off = 100.0*(stroke/exact(m, force, **how) - 1.0)
    assert abs(off) > 4.0 and 0.9 < told/off < 6.0


def test_metal_without_rate_is_not_asked():
    law = "*PLASTIC\n200., 0.\n600., 1."
    few, many = (pressed(0.0, 150000.0, s, law=law) for s in (FREE, "*STATIC, DIRECT\n0.02, 1."))
    assert few[0] == pytest.approx(many[0], rel=1e-6) and few[1] < 10 and few[2] == many[2] == 0.0


def test_units_do_not_matter():
    stroke, increments, _ = pressed(0.145, 30000.0, FREE)
    other, same, _ = pressed(0.145, 30000.0, FREE, unit=1e-3)
    assert other == pytest.approx(1e-3*stroke, rel=1e-6) and same == increments
