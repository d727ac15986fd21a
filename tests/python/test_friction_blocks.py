"""Friction of elastic bodies: Cattaneo, the plate of SSNV128, blocks that stick and slide."""
import re

import lopin
import numpy as np
import pytest
from pressed_block import block, step


def field(result, index=-1):
    """Place, status, shear and pressure of the slave points of the first pair, in order of x."""
    c = result.contact().at(index)
    order = np.argsort(c.x[:, 0])
    n, w = np.asarray(c["NORMAL"])[order], np.asarray(c["WEIGHT"]).ravel()[order]
    f = np.asarray(c["force"])[order]/np.where(w > 0.0, w, np.inf)[:, None]
    p = (f*n).sum(axis=1)
    return c.x[order, 0], np.asarray(c.status).ravel()[order], (f - p[:, None]*n)[:, 0], p


def test_cattaneo(solve, sheet):
    case = "A7 Cattaneo and Mindlin"
    result = solve("cattaneo")
    x, status, q, p = field(result)
    stick = np.flatnonzero(status == 1)
    # The edge of the stick lies between the last node that sticks and the first that slips.
    edge = 0.25*(x[stick[-1]] + x[stick[-1] + 1] - x[stick[0]] - x[stick[0] - 1])
    sheet.compare(case, "half width of the stick", edge, 0.742790, 0.03)
    sheet.compare(case, "shear at the middle", abs(q[np.argmin(abs(x))]), 53.2512, 0.05)
    sheet.compare(case, "largest shear", abs(q).max(), 128.5598, 0.05)
    sheet.compare(case, "largest pressure", p.max(), 606.037, 0.01)
    steps = result.summary["steps"]
    sheet.compare(case, "factorisations in 50 increments", sum(s["factorisations"] for s in steps),
                  1, 0.0)
    assert sum(s["increments"] for s in steps) == 50
    assert (np.diff(result.history["energy.friction"]) >= -1e-12).all()
    assert (abs(q) <= 0.3*p + 1e-9*p.max()).all()


def test_mu_zero_is_the_frictionless_kernel_bit_by_bit(solve, root):
    text = (root/"decks"/"cattaneo.inp").read_text(encoding="utf-8").split("*STEP, NAME=SHEAR")[0]
    text = text.replace("HANDLE, 6", "HANDLE, 6\nHANDLE, 1")
    with_zero = solve(lopin.Deck.parse(text.replace("0.3,\n*CONTACT PAIR", "0.,\n*CONTACT PAIR"),
                                       "zero", root/"decks"))
    without = solve(lopin.Deck.parse(text.replace("*FRICTION\n0.3,\n", ""), "none", root/"decks"))
    assert with_zero.summary["checksum"] == without.summary["checksum"]


def plate(n=32, friction="*FRICTION\n1.,", increments=10):
    """SSNV128: half of a plate of 40 by 40 on a rigid plane, pressed on top and on its side [mm,
    MPa]."""
    nodes = "\n".join(f"{j*(n + 1) + i + 1}, {40.0*i/n!r}, {40.0*j/n!r}" for j in range(n + 1)
                      for i in range(n + 1))
    cells = "\n".join(f"{j*n + i + 1}, {j*(n + 1) + i + 1}, {j*(n + 1) + i + 2}, {(j + 1)*(n + 1) + i + 2}, {(j + 1)*(n + 1) + i + 1}"
                      for j in range(n) for i in range(n))
    right = ", 1\n".join(str(j*(n + 1) + n + 1) for j in range(n + 1)) + ", 1"
    return f"""*HEADING
SSNV128
*NODE
{nodes}
99999, 0., 0.
*ELEMENT, TYPE=CPE4, ELSET=ALL
{cells}
*ELSET, ELSET=LOW, GENERATE
1, {n}, 1
*ELSET, ELSET=HIGH, GENERATE
{n*(n - 1) + 1}, {n*n}, 1
*ELSET, ELSET=SIDE, GENERATE
1, {n*(n - 1) + 1}, {n}
*MATERIAL, NAME=M
*ELASTIC
130000., 0.2
*SOLID SECTION, ELSET=ALL, MATERIAL=M
1.,
*SURFACE, NAME=SOLE
LOW, S1
*SURFACE, NAME=FLOOR, TYPE=SEGMENTS
START, -100., 0.
LINE, 100., 0.
*RIGID BODY, ANALYTICAL SURFACE=FLOOR, REF NODE=99999
*SURFACE INTERACTION, NAME=I
*SURFACE BEHAVIOR, DIRECT
{friction}
*CONTACT PAIR, INTERACTION=I, SMALL SLIDING
SOLE, FLOOR
*BOUNDARY
{right}
99999, 1, 2
99999, 6
*STEP, INC=200
*STATIC, DIRECT
{1.0/increments!r}, 1.
*DLOAD
HIGH, P3, 50.
SIDE, P4, 150.
*NODE FILE
U
*CONTACT FILE
CDIS, CSTR
*END STEP
"""


def test_plate_on_a_rigid_plane(solve, sheet):
    result = solve(lopin.Deck.parse(plate(), name="plate"))
    c = result.contact().last
    x, u = c.x[:, 0], np.asarray(c["U"])[:, 0]
    order = np.argsort(x)
    for at, reference in ((0.0, 2.86e-2), (1.25, 2.72e-2), (5.0, 2.28e-2), (7.5, 1.98e-2),
                          (11.25, 1.50e-2)):
        sheet.compare("C1 SSNV128", f"u_x at {at} mm", np.interp(at, x[order], u[order]), reference,
                      0.05, source="mean of several codes (SSNV128, v6.04.128)")


def test_a_load_that_turns_drags_the_node_behind(solve, sheet):
    """C8: the lag and the energy of a turn; the error of backward steps is linear in their size."""
    from friction_scenes import rotating
    case, energy, lag = "C8 rotating load", [], []
    for steps in (180, 360):
        h = solve(lopin.Deck.parse(rotating(steps, 2), name="rotating")).history
        at = [int(np.argmin(abs(h["time"] - t))) for t in (3.0, 4.0)]
        energy.append(float(np.diff(h["energy.friction"][at])[0]))
        lag.append(180.0 + np.degrees(np.arctan2(h["FLOOR.rf2"][-1], h["FLOOR.rf1"][-1])))
        sheet.compare(case, f"{steps} increments a turn: size of the force",
                      np.hypot(h["FLOOR.rf1"][-1], h["FLOOR.rf2"][-1]), 30.0, 1e-12)
        assert max(h["iterations"]) <= 6
    sheet.compare(case, "energy of a turn, 360 increments", energy[1], 37.2726, 3e-3)
    sheet.compare(case, "energy of a turn, extrapolated", 2*energy[1] - energy[0], 37.2726, 1e-4)
    sheet.compare(case, "lag in degrees, extrapolated", 2*lag[1] - lag[0],
                  np.degrees(np.arccos(0.15)), 1e-3)


def element(friction, kind="CPE3"):
    """C4: one triangle whose free node stands on a floor; nearly incompressible and sheared."""
    return f"""*HEADING
One element
*NODE
1, 0., 0.
2, 1., 0.
3, -6., 1.
9, 0., 0.
*ELEMENT, TYPE={kind}, ELSET=ALL
1, 1, 2, 3
*MATERIAL, NAME=M
*ELASTIC
1000., 0.49
*SOLID SECTION, ELSET=ALL, MATERIAL=M
1.,
*SURFACE, NAME=FOOT, TYPE=NODE
1, 1.
*SURFACE, NAME=FLOOR, TYPE=SEGMENTS
START, -10., 0.
LINE, 10., 0.
*RIGID BODY, ANALYTICAL SURFACE=FLOOR, REF NODE=9
*SURFACE INTERACTION, NAME=I
*SURFACE BEHAVIOR, DIRECT
*FRICTION
{friction}
*CONTACT PAIR, INTERACTION=I, SMALL SLIDING
FOOT, FLOOR
*BOUNDARY
2, 1, 2
3, 1, 2
9, 1, 2
9, 6
*STEP
*STATIC
1., 1.
*CLOAD
1, 2, -1.
1, 1, 0.1
*CONTACT FILE
CDIS
*END STEP
"""


@pytest.mark.parametrize("mu", [0.2, 0.3])
def test_wedging_is_said_with_its_critical_coefficient(solve, sheet, mu):
    result = solve(lopin.Deck.parse(element(f"{mu},"), name="element"))
    said = [d for d in result.summary["diagnostics"] if d["code"] == "W0520"]
    assert len(said) == (mu > 0.2857)
    if said:
        assert "node 1 " in said[0]["message"]
        sheet.compare("C4 one element", "critical coefficient as said",
                      float(said[0]["message"].split()[-1]), 0.285714, 1e-5)


def wedge(mu):
    """C5: half of a wedge of 10 degrees on a wall; a weak spring would lift it."""
    s, c = (float(f(np.radians(10.0))) for f in (np.sin, np.cos))
    links = "".join(f"*EQUATION\n2\n{n}, 2, 1., 2, 2, -1.\n" for n in (1, 3, 4))
    return f"""*HEADING
A wedge
*NODE
1, 0., 0.
2, 1., 0.
3, 1., 1.
4, 0., 1.
5, 0., 5.
6, 1., 5.
7, 1., 6.
8, 0., 6.
9, 1., 0.
*ELEMENT, TYPE=CPS4, ELSET=BODY
1, 1, 2, 3, 4
*ELEMENT, TYPE=CPS4, ELSET=SPRING
2, 5, 6, 7, 8
*MATERIAL, NAME=M
*ELASTIC
1000., 0.
*SOLID SECTION, ELSET=BODY, MATERIAL=M
1.,
*MATERIAL, NAME=W
*ELASTIC
0.01, 0.
*SOLID SECTION, ELSET=SPRING, MATERIAL=W
1.,
{links}*EQUATION
2
3, 1, 1., 2, 1, -1.
*EQUATION
2
5, 2, 1., 2, 2, -1.
*EQUATION
2
6, 2, 1., 2, 2, -1.
*SURFACE, NAME=FOOT, TYPE=NODE
2, 1.
*SURFACE, NAME=WALL, TYPE=SEGMENTS
START, {1 - s!r}, {-c!r}
LINE, {1 + s!r}, {c!r}
*RIGID BODY, ANALYTICAL SURFACE=WALL, REF NODE=9
*SURFACE INTERACTION, NAME=I
*SURFACE BEHAVIOR, DIRECT
*FRICTION
{mu},
*CONTACT PAIR, INTERACTION=I, SMALL SLIDING
FOOT, WALL
*AMPLITUDE, NAME=PUSH
0., 0., 1., 1., 2., 0.
*BOUNDARY
1, 1
4, 1
5, 1
6, 1
7, 1, 2
8, 1, 2
9, 1, 2
9, 6
*STEP, INC=100
*STATIC, DIRECT
0.1, 2.
*CLOAD, AMPLITUDE=PUSH
2, 2, -20.
*CONTACT FILE
CDIS
*END STEP
"""


@pytest.mark.parametrize("mu", [0.17, 0.2])
def test_a_wedge_stays_where_its_angle_is_below_that_of_friction(solve, sheet, mu):
    result = solve(lopin.Deck.parse(wedge(mu), name="wedge"))
    h = result.history
    pressed = h["FOOT-WALL.max_pressure"]
    assert pressed.max() > 10.0
    if mu > np.tan(np.radians(10.0)):
        assert pressed[-1] > 10.0
    else:
        sheet.compare("C5 wedge", "tan 10 > mu: pressure left", pressed[-1]/pressed.max(), 0.0,
                      1e-3, absolute=True)


def test_a_block_dragged_by_its_sole_slips_under_mu_p(core, sheet):
    """B3: displacements along the floor are prescribed at all slave nodes: nothing there
    deforms."""
    text = plate(4, "*FRICTION\n0.3,", increments=4)
    text = text[:text.index("*BOUNDARY\n5, 1")] + "*BOUNDARY\n99999, 1, 2\n99999, 6\n*STEP\n*STATIC, DIRECT\n0.25, 1.\n" \
        "*BOUNDARY\nSOLE, 1, 1, 0.01\n*DLOAD\nHIGH, P3, 50.\n*NODE FILE\nU\n*CONTACT FILE\nCDIS\n*END STEP\n"
    text = text.replace("*MATERIAL, NAME=M", "*NSET, NSET=SOLE\n1, 2, 3, 4, 5\n*MATERIAL, NAME=M")
    result = lopin.run(lopin.Deck.parse(text, name="dragged"))   # in memory: double precision
    x, status, q, p = field(result)
    sheet.compare("B3 friction patch", "dragged: largest | |t|/(mu p) - 1 |",
                  abs(abs(q)/(0.3*p) - 1).max(), 0.0, 1e-10, absolute=True)
    assert (status == 2).all()


def test_a_patch_that_sticks_carries_uniform_shear(core, sheet):
    """B3: a block that sticks under tau = 0.5 mu p on all its outer faces: sigma_xy is uniform."""
    n, p, tau = 4, 50.0, 7.5
    size = 40.0/n
    force = {}
    for i in range(n):
        for a, b in ((i, i + 1),):
            for k in (a, b):
                force[n*(n + 1) + k + 1, 1] = force.get((n*(n + 1) + k + 1, 1), 0.0) + 0.5*size*tau
                force[k*(n + 1) + n + 1, 2] = force.get((k*(n + 1) + n + 1, 2), 0.0) + 0.5*size*tau
                force[k*(n + 1) + 1, 2] = force.get((k*(n + 1) + 1, 2), 0.0) - 0.5*size*tau
    loads = "\n".join(f"{node}, {d}, {v!r}" for (node, d), v in force.items())
    text = plate(n, "*FRICTION\n0.3,", increments=1)
    head = text[:text.index("*BOUNDARY\n5, 1")] + "*BOUNDARY\n99999, 1, 2\n99999, 6\n"
    head = head.replace("130000., 0.2", "130000., 0.")
    steps = "*STEP\n*STATIC\n1., 1.\n*DLOAD\nHIGH, P3, 50.\n*END STEP\n*STEP\n*STATIC, DIRECT\n0.5, 1.\n*CLOAD\n" + loads \
        + "\n*NODE FILE\nU\n*EL FILE\nS\n*CONTACT FILE\nCDIS\n*END STEP\n"
    result = lopin.run(lopin.Deck.parse(head + steps, name="patch"))
    x, status, q, pressure = field(result)
    assert (status == 1).all()
    sheet.compare("B3 friction patch", "stuck: largest error of the shear",
                  abs(abs(q) - tau).max()/tau, 0.0, 1e-10, absolute=True)
    slip = np.asarray(result.contact().last["SLIP_PATH"]).ravel()
    sheet.compare("B3 friction patch", "stuck: largest slip [mm]", slip.max(), 0.0, 1e-10,
                  absolute=True)


def pushed(share, behaviour="DIRECT", friction="*FRICTION\n0.3,"):
    """A block that only a floor and its friction hold, pressed by 2000 N and pushed by a share of
    it."""
    n = 8
    text = plate(n, friction, increments=4)
    text = text[:text.index("*BOUNDARY\n9, 1")] + "*BOUNDARY\n99999, 1, 2\n99999, 6\n"
    text = text.replace("*SURFACE BEHAVIOR, DIRECT", f"*SURFACE BEHAVIOR, {behaviour}")
    return lopin.Deck.parse(text + f"""*STEP
*STATIC
1., 1.
*DLOAD
HIGH, P3, 50.
*END STEP
*STEP, INC=100
*STATIC, DIRECT
0.25, 1.
*CLOAD
1, 1, {share*2000.0!r}
*CONTACT FILE
CDIS
*END STEP
""", name="pushed")


@pytest.mark.parametrize("behaviour", ["DIRECT", "PENALTY", "PERTURBED LAGRANGE",
                                       "AUGMENTED LAGRANGE", "NO SEPARATION",
                                       "PRESSURE-OVERCLOSURE=EXPONENTIAL\n1e-3, 10."])
def test_friction_alone_holds_a_block(solve, behaviour):
    h = solve(pushed(0.2, behaviour)).history
    assert abs(h["FLOOR.rf1"][-1]) == pytest.approx(400.0, rel=1e-9)
    assert abs(h["FLOOR.rf2"][-1]) == pytest.approx(2000.0, rel=1e-9)
    assert max(h["iterations"]) <= 16


def test_a_block_pushed_beyond_friction_is_not_held(solve):
    with pytest.raises(lopin.LopinError, match="E0310.*move along x"):
        solve(pushed(0.31))
    assert abs(solve(pushed(0.29)).history["FLOOR.rf1"][-1]) == pytest.approx(580.0, rel=1e-9)


def test_perturbed_is_penalty(solve):
    one, two = (solve(pushed(0.2, f"{word}\n1e6,")).history
                for word in ("PENALTY", "PERTURBED LAGRANGE"))
    for name in ("FLOOR.rf1", "energy.strain", "energy.friction", "SOLE-FLOOR.max_pressure"):
        assert one[name] == pytest.approx(two[name], rel=1e-11, abs=1e-12)


@pytest.mark.parametrize("leg", [0.05, 0.1, 1.0])
@pytest.mark.parametrize("nlgeom", ["", ", NLGEOM"])
@pytest.mark.parametrize("side", [10.0, 0.01])
def test_friction_that_turns_round_late_by_its_elastic_slip_is_told(solve, leg, nlgeom, side):
    """Pressed, dragged and drawn back by a part of the way that turns it, with a penalty: where springs take up a share of what the
    body does, which the deck left open, they are told; on the nonlinear path they are stiffer, and it is right."""
    way, pressed = 0.01*side, f"9001, 2, 2, {-0.01*side!r}"
    steps = "".join(step(f"*BOUNDARY\n9001, 1, 1, {u!r}\n{pressed}", static, words=nlgeom) for u, static in (
        (0.0, "1., 1."), (way, "0.1, 1."), (way*(1.0 - leg), "0.1, 1.")))
    turned, told = {}, []
    for method in ("DIRECT", "PENALTY"):
        result = solve(block(steps, side=side, behaviour=f"*SURFACE BEHAVIOR, {method}"))
        told = [re.search(r"took up ([\d.]+) %", d["message"]) for d in result.diagnostics if d["code"] == "W0568"]
        history = result.history
        turned[method] = history["TOOL.rf1"][-1] - history["TOOL.rf1"][list(history["time"]).index(2.0)]
    off = abs(turned["PENALTY"]/turned["DIRECT"] - 1.0)
    assert bool(told) == (not nlgeom)
    assert off < 0.01 if nlgeom else float(told[-1][1]) == pytest.approx(100.0*max(off, 0.1), abs=5.0)
