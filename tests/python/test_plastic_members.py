"""Yield surfaces, hardening that moves, curves of temperature, plane stress: closed forms on one
element."""
import math

import numpy as np
import pytest

import lopin
from lopin import Deck
from test_checkpoint import billet

YOUNG, POISSON = 210000.0, 0.3
CORNER = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
LINEAR = "*PLASTIC\n200., 0.\n300., 0.5\n"
LANKFORD = (1.8, 1.2, 2.1)
SHEET = LINEAR + "*POTENTIAL, DEFINITION=LANKFORD\n1.8, 1.2, 2.1\n"
CYCLES = ("*PLASTIC, HARDENING=COMBINED, DATA TYPE=PARAMETERS, NUMBER BACKSTRESSES=2\n"
          "200., 20000., 150., 900., 4.\n*CYCLIC HARDENING, PARAMETERS\n200., 80., 5.\n")


def pulled(cards, ends, *, word="C3D8", nlgeom=True, angle=0.0, increments=10, extra="", heat="",
           unit=1.0, more=""):
    """A cube or square drawn to each of the ends along x, free to shear and to grow narrow."""
    d = 3 if word.startswith("C3D") else 2
    corner = CORNER[:2**d]
    side = [k + 1 for k, c in enumerate(corner) if c[0] == 1]
    fixed = "".join(f"{k + 1}, 1\n" for k, c in enumerate(corner) if c[0] == 0) + "1, 2\n"
    if d == 3:
        fixed += "".join(f"{k + 1}, 3\n" for k, c in enumerate(corner) if c[2] == 0)
    text = "*NODE, NSET=ALL\n" + "".join(f"{k + 1}, " + ", ".join(f"{float(v)}" for v in c[:d]) + "\n"
                                         for k, c in enumerate(corner))
    text += (f"*ELEMENT, TYPE={word}, ELSET=BODY\n1, " + ", ".join(map(str, range(1, 2**d + 1)))
             + f"\n*MATERIAL, NAME=M\n*ELASTIC\n{YOUNG*unit!r}, {POISSON}\n{cards}"
             "*ORIENTATION, NAME=ROLLED\n1., 0., 0., 0., 1., 0.\n"
             f"3, {angle!r}\n*SOLID SECTION, ELSET=BODY, MATERIAL=M, ORIENTATION=ROLLED\n1.,\n"
             f"{extra}*BOUNDARY\n{fixed}")
    for end in ends:
        text += (f"*STEP{', NLGEOM' if nlgeom else ''}, INC=1000\n*STATIC, DIRECT\n"
                 f"{1.0/increments!r}, 1.\n*BOUNDARY\n"
                 + "".join(f"{k}, 1, 1, {end!r}\n" for k in side) + more
                 + f"{heat}*NODE FILE\nU, RF\n*EL FILE\nS, E, PEEQ\n*END STEP\n")
    return Deck.parse(text, name="pulled")


def state(result, increment=-1, nlgeom=True):
    """Mean stress (Kirchhoff at finite strain), strain, plastic strain and PEEQ of one element; the
    strain across a sheet is that of a plastic flow that keeps its volume."""
    at = result.at(increment) if increment >= 0 else result
    u = np.asarray(at["U"])
    plane = len(u) == 4
    stress = np.asarray(at["S"]).mean(axis=0)
    h = np.zeros((3, 3))
    for k, axis in ((1, 0), (3, 1), (4, 2)):
        if k < len(u):
            h[:u.shape[1], axis] = (u[k] - u[0])[:3]
    strain = 0.5*(h + h.T)
    if nlgeom:
        value, axes = np.linalg.eigh((np.eye(3) + h)@(np.eye(3) + h).T)
        strain = axes@np.diag(0.5*np.log(value))@axes.T
    strain = strain[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
    for _ in range(20 if nlgeom else 1):
        tau = stress*(math.exp(strain[:3].sum()) if nlgeom else 1.0)
        elastic = ((1 + POISSON)*tau - POISSON*np.r_[np.ones(3), np.zeros(3)]*tau[:3].sum())/YOUNG
        if plane:
            strain[2] = elastic[:3].sum() - strain[0] - strain[1]
    return tau, strain, strain - elastic, float(np.asarray(at["PEEQ"]).mean())


@pytest.mark.parametrize("word", ["C3D8", "CPS4"])
@pytest.mark.parametrize(("angle", "r", "nlgeom"),
                         [(0.0, LANKFORD[0], False), (45.0, LANKFORD[1], False),
                          (90.0, LANKFORD[2], False), (0.0, LANKFORD[0], True),
                          (90.0, LANKFORD[2], True)])
def test_lankford_of_a_tension_test(word, angle, r, nlgeom):
    """Along 45 degrees a strip shears, and at finite strain its axes turn: small strain there."""
    stress, strain, plastic, peeq = state(lopin.run(pulled(SHEET, [0.1], word=word, angle=-angle,
                                                           nlgeom=nlgeom)), nlgeom=nlgeom)
    assert plastic[1]/-(plastic[0] + plastic[1]) == pytest.approx(r, rel=1e-6)
    assert plastic[2] == pytest.approx(-plastic[0] - plastic[1], rel=1e-6)
    # The work of the flow curve is that of the test: stress times strain along x.
    assert stress[0]*plastic[0] == pytest.approx((200.0 + 200.0*peeq)*peeq, rel=1e-6)
    assert np.abs(stress[1:]).max() < 1e-6*stress[0]
    if angle == 0.0:
        assert peeq == pytest.approx(plastic[0], rel=1e-6)


@pytest.mark.parametrize("word", ["C3D8", "CPS4", "CPS4I", "C3D8I"])
@pytest.mark.parametrize("increments", [1, 12])
def test_a_loop_of_tension_and_compression(word, increments):
    """Armstrong and Frederick's equation, integrated branch by branch; increments of any length."""
    ends = [0.03, -0.02, 0.05]
    result = lopin.run(pulled(CYCLES, ends, word=word, increments=increments))
    c, gamma = np.array([20000.0, 900.0]), np.array([150.0, 4.0])
    alpha, p, plastic, total = np.zeros(2), 0.0, 0.0, 0.0
    for branch, end in enumerate(ends):
        target = math.log(1.0 + end)
        sign = math.copysign(1.0, target - total)
        low, high = 0.0, 0.2
        for _ in range(200):
            dp = 0.5*(low + high)
            back = sign*c/gamma + (alpha - sign*c/gamma)*np.exp(-gamma*dp)
            stress = back.sum() + sign*(200.0 + 80.0*(1.0 - math.exp(-5.0*(p + dp))))
            if sign*(YOUNG*(target - plastic - sign*dp) - stress) > 0.0:
                low = dp
            else:
                high = dp
        alpha, p, plastic, total = back, p + dp, plastic + sign*dp, target
        found, _, _, peeq = state(result, increments*(branch + 1) - 1)
        assert found[0] == pytest.approx(stress, rel=1e-6)
        assert peeq == pytest.approx(p, rel=1e-6)


def test_linear_kinematic_hardening_keeps_the_size():
    result = lopin.run(pulled("*PLASTIC, HARDENING=KINEMATIC\n200., 0.\n300., 0.5\n", [0.03, -0.03],
                              nlgeom=False))
    stress, _, plastic, _ = state(result, 9, nlgeom=False)
    assert stress[0] == pytest.approx(200.0 + 200.0*plastic[0], rel=1e-6)
    stress, _, plastic, _ = state(result, nlgeom=False)
    assert stress[0] == pytest.approx(-200.0 + 200.0*plastic[0], rel=1e-6)


@pytest.mark.parametrize("nlgeom", [True, False], ids=["finite", "small"])
@pytest.mark.parametrize("word", ["CPS4", "CPS4I"])
def test_a_sheet_drawn_both_ways(word, nlgeom):
    """tau = Y + H p on both axes, e = p/2 + (1 - nu) tau/E."""
    result = lopin.run(pulled(LINEAR, [0.1], word=word, nlgeom=nlgeom,
                              more="1, 2, 2, 0.\n2, 2, 2, 0.\n3, 2, 2, 0.1\n4, 2, 2, 0.1\n"))
    stress, _, _, peeq = state(result, nlgeom=nlgeom)
    end = math.log(1.1) if nlgeom else 0.1
    p = (end - (1 - POISSON)*200.0/YOUNG)/(0.5 + (1 - POISSON)*200.0/YOUNG)
    assert peeq == pytest.approx(p, rel=1e-6)
    assert stress[:2] == pytest.approx([200.0 + 200.0*p]*2, rel=1e-6)
    assert abs(stress[2]) < 1e-6*stress[0]


@pytest.mark.parametrize("nlgeom", [True, False], ids=["finite", "small"])
@pytest.mark.parametrize("surface", ["", "*POTENTIAL\n1., 1.2, 0.9, 1., 1., 1.\n"])
def test_a_curve_between_two_temperatures(nlgeom, surface):
    """Half way between them at the start, at the hotter one at the end."""
    hot = ("*PLASTIC\n200., 0., 20.\n300., 0.5, 20.\n100., 0., 120.\n140., 0.1, 120.\n" + surface)
    cold = "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nALL, 70.\n"
    result = lopin.run(pulled(hot, [0.05], nlgeom=nlgeom, extra=cold))
    stress, _, plastic, peeq = state(result, nlgeom=nlgeom)
    assert stress[0] == pytest.approx(150.0 + 300.0*peeq, rel=1e-6)
    result = lopin.run(pulled(hot, [0.05], nlgeom=nlgeom, extra=cold,
                              heat="*TEMPERATURE\nALL, 150.\n"))
    stress, _, plastic, peeq = state(result, nlgeom=nlgeom)
    assert stress[0] == pytest.approx(100.0 + 400.0*peeq, rel=1e-6)
    stress, _, plastic, peeq = state(result, 3, nlgeom=nlgeom)
    share = (70.0 + 0.4*80.0 - 20.0)/100.0
    assert stress[0] == pytest.approx((1 - share)*(200.0 + 200.0*peeq)
                                      + share*(100.0 + 400.0*peeq), rel=1e-6)


def test_a_rate_on_a_surface_of_its_own():
    result = lopin.run(pulled(SHEET + "*RATE DEPENDENT\n40., 5.\n", [0.1], nlgeom=False))
    before, after = (state(result, k, nlgeom=False) for k in (8, 9))
    rate = (after[3] - before[3])/0.1
    assert after[0][0] == pytest.approx((200.0 + 200.0*after[3])*(1 + (rate/40.0)**0.2), rel=1e-5)


SURFACES = {"sheet": SHEET, "cycles": CYCLES,
            "both": CYCLES + "*POTENTIAL\n1., 1.2, 0.9, 1., 1.1, 0.9\n"}


def carried(cards, q, unit=1.0):
    """A brick whose nodes all are led through two deformations with shear, turned by q."""
    x = np.array(CORNER, float)
    axes = np.array([[math.cos(0.4), math.sin(0.4), 0.0], [-math.sin(0.4), math.cos(0.4), 0.0]])@q.T
    text = "*NODE, NSET=ALL\n" + "".join(f"{k + 1}, " + ", ".join(repr(float(v)) for v in p) + "\n"
                                         for k, p in enumerate(x@q.T))
    text += ("*ELEMENT, TYPE=C3D8, ELSET=BODY\n1, 1, 2, 3, 4, 5, 6, 7, 8\n*MATERIAL, NAME=M\n"
             f"*ELASTIC\n{YOUNG*unit!r}, {POISSON}\n{cards}*ORIENTATION, NAME=O\n"
             + ", ".join(repr(float(v)) for v in axes.ravel())
             + "\n*SOLID SECTION, ELSET=BODY, MATERIAL=M, ORIENTATION=O\n")
    for h in ([[0.05, 0.04, 0.0], [0.0, -0.02, 0.01], [0.03, 0.0, -0.02]],
              [[0.02, -0.06, 0.05], [0.1, 0.03, 0.0], [0.0, -0.04, -0.04]]):
        u = x@np.array(h).T@q.T
        text += ("*STEP, NLGEOM\n*STATIC, DIRECT\n0.2, 1.\n*BOUNDARY\n"
                 + "".join(f"{k + 1}, {i + 1}, {i + 1}, {float(u[k, i])!r}\n" for k in range(8)
                           for i in range(3)) + "*EL FILE\nS, E, PEEQ\n*END STEP\n")
    result = lopin.run(Deck.parse(text, name="carried"))
    s = np.asarray(result["S"]).mean(axis=0)/unit
    full = np.array([[s[0], s[3], s[4]], [s[3], s[1], s[5]], [s[4], s[5], s[2]]])
    return q.T@full@q, float(np.asarray(result["PEEQ"]).mean())


@pytest.mark.parametrize("name", SURFACES)
def test_a_turned_scene_has_the_turned_answer(name):
    """Units and directions of the scene do not matter."""
    stress, peeq = carried(SURFACES[name], np.eye(3))
    assert peeq > 0.05
    c, s = math.cos(1.1), math.sin(1.1)
    q = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]])@np.array([[1.0, 0, 0], [0, c, -s], [0, s, c]])
    other, same = carried(SURFACES[name], q)
    np.testing.assert_allclose(other, stress, atol=3e-7*np.abs(stress).max())
    assert same == pytest.approx(peeq, rel=1e-6)


def test_another_unit_of_stress():
    cards = SHEET.replace("200.,", "200.E6,").replace("300.,", "300.E6,")
    stress, peeq = carried(SHEET, np.eye(3))
    other, same = carried(cards, np.eye(3), unit=1e6)
    np.testing.assert_allclose(other, stress, atol=3e-7*np.abs(stress).max())
    assert same == pytest.approx(peeq, rel=1e-6)


@pytest.mark.parametrize("nlgeom", ["", ", NLGEOM"])
def test_unit_ratios_are_von_mises(nlgeom):
    """A scene of contact and friction, by the two ways to compute the same solid."""
    words = "*PLASTIC\n5., 0.\n8., 0.1\n20., 1.\n"
    one = lopin.run(Deck.parse(billet(words, nlgeom=nlgeom, changes=False), name="one"))
    two = lopin.run(Deck.parse(billet(words + "*POTENTIAL\n1., 1., 1., 1., 1., 1.\n", nlgeom=nlgeom,
                                      changes=False), name="two"))
    scale = np.abs(one["U"]).max()
    np.testing.assert_allclose(two["U"], one["U"], atol=1e-6*scale)
