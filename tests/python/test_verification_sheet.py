"""Sheets that are bent, released and drawn, against closed forms (Hill 1950) and workshop
practice."""
import doctest
from math import atan2, cos, degrees, radians, sin

import pytest

import lopin
from lopin import closed_form as cf
from lopin.closed_form import sheet as closed_sheet

YOUNG, POISSON, FLOW = 210e3, 0.3, 300.0


def test_examples_in_docstrings():
    result = doctest.testmod(closed_sheet)
    assert result.attempted >= 4
    assert result.failed == 0


def test_bent_sheet_has_the_published_numbers():
    """x = 2 flow radius/(modulus t): R/R' = 1 - 1.5 x + 0.5 x^3."""
    for radius, ratio in ((5.0, 0.9774850), (20.0, 0.9100416), (100.0, 0.5631968)):
        assert radius/cf.bent_sheet(YOUNG, POISSON, FLOW, 1.0, radius).radius == \
            pytest.approx(ratio, rel=1e-6)


def bending(radius: float, layers: int, length: float) -> str:
    """A piece of a strip: its end slides on a face that turns, so that nothing but a moment
    acts."""
    columns = 2
    lines = ["*NODE, NSET=ALL"]
    n = layers + 1
    lines += [f"{1 + i*n + j}, {length*i/columns!r}, {j/layers - 0.5!r}"
              for i in range(columns + 1) for j in range(n)]
    lines.append("*ELEMENT, TYPE=CPE4I, ELSET=STRIP")
    for i in range(columns):
        lines += [f"{1 + i*layers + j}, {1 + i*n + j}, {1 + (i + 1)*n + j}, {2 + (i + 1)*n + j}, "
                  f"{2 + i*n + j}" for j in range(layers)]
    lines += ["*NSET, NSET=LEFT", *(str(1 + j) for j in range(n)), "*SURFACE, NAME=END"]
    lines += [f"{1 + (columns - 1)*layers + j}, S2" for j in range(layers)]
    held = ["LEFT, 1", f"{1 + layers//2}, 2", "9001, 2"]
    return "\n".join([
        *lines, "*NODE", f"9001, {length}, 0.", "*SURFACE, NAME=GRIP, TYPE=SEGMENTS",
        f"START, {length}, -3.", f"LINE, {length}, 3.",
        "*RIGID BODY, ANALYTICAL SURFACE=GRIP, REF NODE=9001", "*SURFACE INTERACTION, NAME=SLIDE",
        "*SURFACE BEHAVIOR, DIRECT, NO SEPARATION", "*CONTACT PAIR, INTERACTION=SLIDE", "END, GRIP",
        "*MATERIAL, NAME=STEEL", "*ELASTIC", f"{YOUNG}, {POISSON}", "*PLASTIC", f"{FLOW}, 0.",
        f"{FLOW}, 10.", "*SOLID SECTION, ELSET=STRIP, MATERIAL=STEEL", "*BOUNDARY", *held,
        "*STEP, NLGEOM", "*STATIC", "0.05, 1.", "*BOUNDARY", f"9001, 6, 6, {length/radius!r}",
        "*END STEP", "*STEP, NLGEOM", "*STATIC", "0.1, 1.", "*BOUNDARY, OP=NEW", *held,
        "*END STEP", ""])


@pytest.mark.parametrize("radius, length", [(5.0, 0.25), (20.0, 1.0), (100.0, 1.0)])
def test_a_strip_springs_back_to_its_radius(solve, sheet, radius, length):
    """Bent by a moment, released in a step: 12 elements through the thickness."""
    result = solve(lopin.Deck.parse(bending(radius, 12, length), "strip"))
    time = result.history["time"]
    moment = abs(result.history["GRIP.rf6"][time <= 1.0][-1])
    left = abs(length/result.history["GRIP.u6"][-1])
    exact = cf.bent_sheet(YOUNG, POISSON, FLOW, 1.0, radius)
    sheet.compare("E7 bent strip", f"moment at R = {radius:g}", moment, exact.moment, 1e-2,
                  "Hill 1950")
    sheet.compare("E7 bent strip", f"radius after release, R = {radius:g}", left,
                  exact.radius, 1e-2, "Hill 1950")


@pytest.mark.parametrize("layers, tolerance", [(4, 6e-3), (8, 2e-3), (16, 1e-3)])
def test_the_moment_converges_with_the_elements_through_the_thickness(solve, layers, tolerance):
    result = solve(lopin.Deck.parse(bending(20.0, layers, 1.0), "strip"))
    moment = abs(result.history["GRIP.rf6"][result.history["time"] <= 1.0][-1])
    assert moment == pytest.approx(cf.bent_sheet(YOUNG, POISSON, FLOW, 1.0, 20.0).moment,
                                   rel=tolerance)


def test_a_v_is_bent_by_the_workshop_s_force_and_springs_back(solve, sheet):
    """The leg unbends by the moment, linear along it, over E' I."""
    result = solve("v_bending")
    time = result.history["time"]
    force = -2.0*result.history["PUNCH.rf2"]
    expected = cf.air_bending_force(cf.considere_strength(300.0, 500.0), 2.0, 50.0)
    sheet.compare("E12 bending in a V", "largest force per width", force.max(), expected, 0.15,
                  "workshop practice")
    bent, free = leg_angle(result, 1.0), leg_angle(result, time[-1])
    angle = radians(bent)
    way = (25.0 - 4.0*sin(angle))/cos(angle)
    moment = 0.5*force[time <= 1.0][-1]/cos(angle)*(way - 5.0*sin(angle)/cos(angle))
    stiffness = YOUNG/(1.0 - POISSON**2)*2.0**3/12.0
    sheet.compare("E12 bending in a V", "springback of a leg in degrees", bent - free,
                  degrees(0.5*moment*way/stiffness), 0.20, "a beam")


def leg_angle(result, time: float) -> float:
    """Slope of the leg in degrees, by the two nodes of the set LEG."""
    index = max(k for k, t in enumerate(result.times) if t <= time + 1e-9)
    piece = result.to_meshio(index)
    x = piece.points[:, :2] + piece.point_data["U"][:, :2]
    at = piece.points[:, :2]
    legs = [int(abs(at - [s, 1.0]).sum(axis=1).argmin())
            for s in (12.0 + 28.0*18/26, 12.0 + 28.0*24/26)]
    way = x[legs[1]] - x[legs[0]]
    return degrees(atan2(way[1], way[0]))
