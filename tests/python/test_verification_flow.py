"""Plastic and viscous flow against closed forms: benchmarks E0, E4 and E6."""
import math

import numpy as np
import pytest

from flow_scenes import norton, orders, upset

AREA = math.pi*100.0


def force(result, row=-1):
    return abs(result.history["PLATE.rf2"][row])


def uniaxial(k, m, rate):
    return k*math.sqrt(3.0)**(m + 1.0)*rate**m


def compressed(young, poisson, yield_stress, slope, reduction):
    """E0: Kirchhoff and Cauchy stress, plastic strain and J of a bar of linear hardening."""
    strain = -math.log(1.0 - reduction)
    tau = (yield_stress + slope*strain)/(1.0 + slope/young)
    j = math.exp(-(1.0 - 2.0*poisson)*tau/young)
    return strain, tau, tau/j, strain - tau/young, j


@pytest.mark.parametrize("word", ["CAX4", "CAX8", "CAX8R"])
@pytest.mark.parametrize("hardening", ["*PLASTIC, HARDENING=LINEAR\n700., 300.",
                                       "*PLASTIC\n700., 0.\n1300., 2."])
def test_compression_to_60_percent(solve, sheet, word, hardening):
    deck = upset("*ELASTIC\n200000., 0.3\n" + hardening, height=15.0, word=word, speed=9.0,
                 time=1.0, increments=10, nlgeom=True)
    result = solve(deck)
    strain, tau, cauchy, plastic, j = compressed(200e3, 0.3, 700.0, 300.0, 0.6)
    assert tau == pytest.approx(973.42708, rel=1e-8) and j == pytest.approx(0.9980550, rel=1e-7)
    case, what = "E0 one element, 60 %", f"{word}, {hardening.splitlines()[0]}: "
    sheet.compare(case, what + "logarithmic strain", -math.log(1.0 + result["U"][:, 1].min()/15.0),
                  strain, 1e-6)
    sheet.compare(case, what + "Cauchy stress", -result["S"][0, 1], cauchy, 1e-6)
    sheet.compare(case, what + "plastic strain", result["PEEQ"].ravel()[0], plastic, 1e-6)
    sheet.compare(case, what + "force", force(result), cauchy*AREA*j/0.4, 1e-6)


@pytest.mark.parametrize("rigid", [True, False], ids=["rigid", "elastic"])
@pytest.mark.parametrize("m", [0.1, 0.2, 0.5, 1.0])
def test_a_disc_without_friction(solve, sheet, rigid, m):
    """The force is that of the rate, twice the speed multiplies it by 2^m; at finite strain after
    any history."""
    case, what = "E4 disc of Norton and Hoff", f"m = {m:g}, {'rigid' if rigid else 'stiff elastic'}: "
    once = force(solve(upset(norton(m=m, rigid=rigid), nx=3, nz=2, increments=2)))
    sheet.compare(case, what + "force", once, uniaxial(100.0, m, 0.1)*AREA, 1e-6)
    twice = force(solve(upset(norton(m=m, rigid=rigid), nx=3, nz=2, increments=2, speed=1.0)))
    sheet.compare(case, what + "twice the speed", twice/once, 2.0**m, 1e-6)


@pytest.mark.parametrize("rigid", [True, False], ids=["rigid", "elastic"])
def test_a_disc_at_finite_strain_has_the_rate_of_its_increment(solve, sheet, rigid):
    """Backward Euler: the mean logarithmic rate of the last increment, on the present area."""
    result = solve(upset(norton(rigid=rigid), nx=2, nz=2, speed=0.5, time=4.0, increments=8,
                         nlgeom=True))
    rate = math.log(3.25/3.0)/0.5
    sheet.compare("E4 disc of Norton and Hoff",
                  f"{'rigid' if rigid else 'stiff elastic'}: force at 40 %", force(result),
                  uniaxial(100.0, 0.2, rate)*AREA*5.0/3.0, 1e-6)


@pytest.mark.parametrize(("q", "m"), [(0.2, 0.2), (1.0, 1.0)])
@pytest.mark.parametrize("rigid", [True, False], ids=["rigid", "elastic"])
def test_friction_adds_its_power(solve, sheet, rigid, q, m):
    """dF/dalpha at small alpha: 4 pi/(q + 3) (v/2h)^(q+1) R^(q+3)/v."""
    alpha = 0.02
    options = {"nx": 16, "nz": 4, "increments": 2}
    bare = force(solve(upset(norton(m=m, rigid=rigid), **options)))
    rubbed = force(solve(upset(norton(m=m, rigid=rigid),
                               friction=f"*FRICTION, LAW=NORTON-HOFF\n{alpha}, {q}", **options)))
    slope = 4.0*math.pi/(q + 3.0)*0.05**(q + 1.0)*10.0**(q + 3.0)
    sheet.compare("E4 disc of Norton and Hoff",
                  f"m = q = {q:g}, {'rigid' if rigid else 'stiff elastic'}: slope with friction",
                  (rubbed - bare)/alpha, slope, 5e-3)


def test_a_film_that_sticks_does_not_lock(solve, sheet):
    """Stefan: 3 pi eta R^4 v/(2 h^3), exact for thin films to O(h/R)."""
    deck = upset(norton(k=100.0, m=1.0), height=0.25, nx=60, nz=4, speed=0.05, time=0.1,
                 increments=2, friction="*FRICTION, ROUGH")
    sheet.compare("E4 Stefan's film", "h/R = 1/20: force", force(solve(deck)),
                  1.5*math.pi*100.0*1e4*0.1/0.125, 0.05)


MATERIALS = {
    "J2, table": "*ELASTIC\n200000., 0.3\n*PLASTIC\n200., 0.\n300., 0.5\n400., 2.",
    "J2, Voce": "*ELASTIC\n200000., 0.3\n*PLASTIC, HARDENING=VOCE\n400., 200., 5., 20.",
    "J2, power law of the rate": "*ELASTIC\n200000., 0.3\n*PLASTIC\n200., 0.\n400., 2.\n*RATE DEPENDENT\n40., 5.",
    "Norton-Hoff with threshold": "*ELASTIC\n200000., 0.3\n*PLASTIC\n200., 0.\n400., 2.\n*VISCOPLASTIC\n100., 0.3",
    "Norton-Hoff, rigid": norton(m=0.3),
}


@pytest.mark.parametrize("material", MATERIALS)
def test_newton_converges_in_second_order(solve, sheet, material):
    """A rough plate: the order of the last three residuals, the middle of all increments.

    Without an elastic deviator the volume is kept to the square of the increment only at the first
    step: it is shorter, and a later one starts so near to its end that its third residual is
    rounding. So first increments of several lengths are looked at, and corrections, in which the
    volume weighs no more than the flow.
    """
    way = {"nx": 6, "nz": 4, "speed": 0.5, "nlgeom": True, "friction": "*FRICTION, ROUGH"}
    if "rigid" in material:
        found = [order for time in np.geomspace(0.02, 0.05, 5) for order in orders(
            solve(upset(MATERIALS[material], time=float(time), **way)), corrections=True)]
    else:
        found = orders(solve(upset(MATERIALS[material], time=1.5, increments=6, **way)))
    assert len(found) >= 3
    sheet.compare("Quadratic convergence", f"{material}: order of Newton", float(np.median(found)),
                  1.8, 0.0, source="at least 1.8", at_least=True)


RING = {"radius": 15.0, "inner": 7.5, "height": 5.0, "nx": 8, "nz": 5, "speed": 1.0, "time": 1.0,
        "increments": 20, "nlgeom": True, "direct": False}
PERFECT = "*ELASTIC\n200000., 0.3\n*PLASTIC\n200., 0."
SHEAR = 200.0/math.sqrt(3.0)


def bore(result):
    """Change of the inner diameter at mid-height in percent."""
    points = result.to_meshio(0).points
    first = np.argmin(np.hypot(points[:, 0] - 7.5, points[:, 1]))
    return 100.0*result["U"][first, 0]/7.5


@pytest.mark.parametrize("m", [0.1, 0.4])
def test_laws_of_friction_agree_where_they_say_the_same(solve, sheet, m):
    """E6: a ring at yield; Tresca, Cristescu, Orowan far above its switch, Norton-Hoff of exponent
    0."""
    laws = {"TRESCA": f"LAW=TRESCA\n{m}", "CRISTESCU": f"LAW=CRISTESCU\n{m}",
            "COULOMB-OROWAN": f"LAW=COULOMB-OROWAN\n0.577, {m}",
            "NORTON-HOFF": f"LAW=NORTON-HOFF\n{m*SHEAR!r}, 0."}
    runs = {law: solve(upset(PERFECT, friction="*FRICTION, " + card, **RING))
            for law, card in laws.items()}
    for law in list(laws)[1:]:
        sheet.compare("E6 laws that say the same", f"m = {m:g}, {law} and TRESCA: bore in percent",
                      bore(runs[law]), bore(runs["TRESCA"]), 0.3, source="Tresca", absolute=True)
        sheet.compare("E6 laws that say the same", f"m = {m:g}, {law} and TRESCA: force",
                      force(runs[law]), force(runs["TRESCA"]), 5e-3, source="Tresca")


def test_friction_reads_the_present_flow_stress(solve):
    hard = "*ELASTIC\n200000., 0.3\n*PLASTIC, HARDENING=LINEAR\n200., 400."
    result = solve(upset(hard, friction="*FRICTION, LAW=TRESCA\n0.1", **RING))
    contact = result.contact(0).last
    peeq = result["PEEQ"].ravel()
    points = result.to_meshio(0).points[:, :2] + result["U"][:, :2]
    place = np.asarray(contact.x)[:, :2] + np.asarray(contact["U"])[:, :2]
    order = np.argsort(place[:, 0])
    top = [np.argmin(np.hypot(*(points - x).T)) for x in place[order]]
    area = np.asarray(contact["WEIGHT"])[order]
    bound = 0.1*(200.0 + 400.0*peeq[top])/math.sqrt(3.0)*area
    shear = np.linalg.norm(np.atleast_2d(np.asarray(contact["R_t"])[order].T), axis=0)
    sliding = shear > 0.5*bound
    assert sliding.sum() >= 6 and peeq[top].min() > 0.1
    np.testing.assert_allclose(shear[sliding], bound[sliding], rtol=1e-6)
