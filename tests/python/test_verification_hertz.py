"""Contact of curved and flat bodies against closed forms of half-spaces."""
import numpy as np
import pytest

from lopin import Deck
from lopin.closed_form import (
    contact_modulus,
    flat_punch_2d,
    flat_punch_axisymmetric,
    flat_punch_axisymmetric_pressure,
    hertz_line,
    hertz_point_approach,
)

BALL = hertz_point_approach(0.02, 50.0, contact_modulus(20e3, 0.3))
SOFT = {"DIRECT": "", "PENALTY": "\n1.e8", "PERTURBED LAGRANGE": "\n1.e8",
        "AUGMENTED LAGRANGE": ""}


def with_method(root, name, method, slope=""):
    """A deck of the collection with another method."""
    path = root/"decks"/f"{name}.inp"
    text = path.read_text(encoding="utf-8")
    line = "*SURFACE BEHAVIOR, DIRECT\n"
    assert line in text
    return Deck.parse(text.replace(line, f"*SURFACE BEHAVIOR, {method}{slope}\n"), name=name,
                      folder=path.parent)


@pytest.mark.parametrize("method", SOFT)
def test_a_sphere_presses_as_hertz_says(root, solve, sheet, method):
    result = solve(with_method(root, "hertz_sphere", method, SOFT[method]))
    case, start = "A4 Hertz: rigid sphere, axisymmetric", f"{method.lower()}: "
    contact = result.contact(0).last
    order = np.argsort(contact.r)
    r, p = contact.r[order], contact.pressure.ravel()[order]
    sheet.compare(case, start + "force", -result.history["BALL.rf2"][-1], BALL.force, 0.005)
    sheet.compare(case, start + "pressure in the middle", p[0], BALL.p0, 0.01)
    sheet.compare(case, start + "largest pressure", p.max(), BALL.p0, 0.01)
    inside = r < 0.9
    sheet.compare(case, start + "pressure, r < 0.9 a, worst over p0",
                  abs(p - BALL.pressure(r))[inside].max()/BALL.p0, 0.0, 0.01, absolute=True)
    sheet.compare(case, start + "contact radius", 0.5*(r[p > 0.0].max() + r[p == 0.0].min()),
                  BALL.a, 0.03)


@pytest.mark.parametrize("method", SOFT)
def test_a_sphere_in_three_dimensions(root, solve, sheet, method):
    result = solve(with_method(root, "hertz_sphere_3d", method, SOFT[method]))
    case, start = "A4 Hertz: rigid sphere, a quarter in 3D", f"{method.lower()}: "
    sheet.compare(case, start + "force", -4.0*result.history["BALL.rf3"][-1], BALL.force, 0.02)
    sheet.compare(case, start + "largest pressure", result.history["NEAR-BALL.max_pressure"][-1],
                  BALL.p0, 0.02)


def test_the_excess_of_force_is_the_slope_of_the_sphere(root, solve, sheet):
    """Hertz is the limit of a small contact: ten times flatter, the excess goes."""
    deck = with_method(root, "hertz_sphere", "DIRECT")
    text = deck.text().replace("900001, 0., 50.", "900001, 0., 500.") \
        .replace("START, 50., 50.", "START, 500., 500.") \
        .replace("CIRCL, 0., 0., 0., 50.", "CIRCL, 0., 0., 0., 500.") \
        .replace("BALL_REF, 2, 2, -0.02", "BALL_REF, 2, 2, -0.002")
    # The far sides go a tenth as far, too.
    far = (root/"decks"/"hertz_sphere.mesh").read_text(encoding="utf-8")
    head, rows = far.split("*BOUNDARY\n")
    rows = [row.split(",") for row in rows.split("\n") if row.strip()]
    rows = [f"{a},{b},{c}, {0.1*float(d)!r}" for a, b, c, d in rows]
    text = text.replace("*INCLUDE, INPUT=hertz_sphere.mesh",
                        head + "*BOUNDARY\n" + "\n".join(rows))
    flat = hertz_point_approach(0.002, 500.0, contact_modulus(20e3, 0.3))
    result = solve(Deck.parse(text, name="flatter"))
    sheet.compare("A4 Hertz: rigid sphere, axisymmetric", "lagrange, R = 500: force",
                  -result.history["BALL.rf2"][-1], flat.force, 0.002)


@pytest.mark.parametrize("method", ["DIRECT", "AUGMENTED LAGRANGE"])
def test_the_cylinder_of_nafems(root, solve, sheet, method):
    result = solve(with_method(root, "nafems_cylinder", method))
    case, start = "A3 Hertz: NAFEMS R0094-1, cylinder on block", f"{method.lower()}: "
    line = hertz_line(35e3, 50.0, contact_modulus(210e3, 0.3, 70e3, 0.3))
    contact = result.contact(0).last
    x, p = contact.x[:, 0], contact.pressure.ravel()
    point = np.flatnonzero(result.source.mesh(-1).point_data["LABEL"].ravel() == 2161)
    down = float(result["displacement"][point, 1][0])
    sheet.compare(case, start + "largest pressure", p.max(), line.p0, 0.01)
    sheet.compare(case, start + "half width, from the load and p0", 4.0*17500.0/(np.pi*p.max()),
                  line.a, 0.01)
    sheet.compare(case, start + "displacement of B", down, -1.279, 0.01,
                  "small-strain finite elements")
    inside = x < 0.85*line.a
    sheet.compare(case, start + "pressure, x < 0.85 a, worst over p0",
                  abs(p - line.pressure(x))[inside].max()/line.p0, 0.0, 0.01, absolute=True)


@pytest.mark.parametrize("method", ["DIRECT", "AUGMENTED LAGRANGE"])
def test_a_cylinder_held_by_nothing_but_contact(root, solve, sheet, method):
    result = solve(with_method(root, "cylinder_on_plane", method))
    case, start = "A3 Hertz: floating cylinder on a rigid plane", f"{method.lower()}: "
    line = hertz_line(1000.0, 100.0, contact_modulus(210e3, 0.3))
    contact = result.contact(0).last
    x, p = contact.x[:, 0], contact.pressure.ravel()
    sheet.compare(case, start + "reaction of the plane", result.history["FLOOR.rf2"][-1], 500.0,
                  1e-9)
    sheet.compare(case, start + "largest pressure", p.max(), line.p0, 0.01)
    inside = x < 0.85*line.a
    sheet.compare(case, start + "pressure, x < 0.85 a, worst over p0",
                  abs(p - line.pressure(x))[inside].max()/line.p0, 0.0, 0.01, absolute=True)


@pytest.mark.parametrize("gap", [1e-6, 1e-3, 1.0])
def test_a_body_that_hangs_in_the_air_at_first(root, solve, sheet, gap):
    """The gap is closed in the first increment; nothing depends on it, and it needs no springs."""
    deck = with_method(root, "cylinder_on_plane", "DIRECT")
    text = deck.text().replace("START, -5., 0.", f"START, -5., {-gap!r}") \
        .replace("LINE, 5., 0.", f"LINE, 5., {-gap!r}")
    hanging = solve(Deck.parse(text, name="hanging", folder=deck.folder))
    resting = solve(deck)
    case, name = "F9 floating body under a force", f"gap {gap:g}: "
    for what, column in (("largest pressure", "ARC-FLOOR.max_pressure"),
                         ("strain energy", "energy.strain")):
        sheet.compare(case, name + what, hanging.history[column][-1], resting.history[column][-1],
                      1e-6, "no gap")
    sheet.compare(case, name + "iterations", hanging.history["iterations"][-1], 0.0, 20.0,
                  "at most 20", absolute=True)
    sheet.compare(case, name + "force of artificial supports over all forces",
                  hanging.summary["certificate"]["support"], 0.0, 1e-9, "none", absolute=True)


@pytest.mark.parametrize("method", ["DIRECT", "AUGMENTED LAGRANGE"])
def test_a_flat_punch_pressed_by_a_force(root, solve, sheet, method):
    result = solve(with_method(root, "flat_punch", method))
    case, start = "A5 flat punch, axisymmetric", f"{method.lower()}: "
    modulus = contact_modulus(210e3, 0.3)
    contact = result.contact(0).last
    r, p = contact.r, contact.pressure.ravel()
    exact = flat_punch_axisymmetric_pressure(1000.0, 10.0, r)
    inside = r <= 8.0
    sheet.compare(case, start + "depth", -result.history["PUNCH.u2"][-1],
                  flat_punch_axisymmetric(1000.0, 10.0, modulus), 0.005)
    sheet.compare(case, start + "force", -result.history["NEAR-PUNCH.force2"][-1], 1000.0, 1e-9)
    sheet.compare(case, start + "pressure, r <= 0.8 a, worst",
                  abs(p[inside]/exact[inside] - 1.0).max(), 0.0, 0.02, absolute=True)
    assert p.min() >= 0.0


def test_a_node_on_the_corner_of_a_punch(root, solve, sheet):
    """The punch is cut to the radius of a node: it must meet the flat side, not the corner's
    middle."""
    deck = with_method(root, "flat_punch", "DIRECT")
    text = deck.text().replace("START, 10., 10.", "START, 9.98, 10.") \
        .replace("LINE, 10., 0.", "LINE, 9.98, 0.")
    result = solve(Deck.parse(text, name="cut", folder=deck.folder))
    case = "A5 flat punch, axisymmetric"
    sheet.compare(case, "node on the corner: depth", -result.history["PUNCH.u2"][-1],
                  flat_punch_axisymmetric(1000.0, 9.98, contact_modulus(210e3, 0.3)), 0.005)
    sheet.compare(case, "node on the corner: radial force over axial",
                  result.history["NEAR-PUNCH.force1"][-1]/1000.0, 0.0, 1e-9, absolute=True)


@pytest.mark.parametrize("method", ["DIRECT", "AUGMENTED LAGRANGE"])
def test_a_flat_punch_in_plane_strain(root, solve, sheet, method):
    """The same grid in plane strain: half of 1000 N/mm; the sides far away carry the load as a
    half-space does (u from the stress of the line load is not single-valued: they are fixed)."""
    mesh = (root/"decks"/"flat_punch.mesh").read_text(encoding="utf-8")
    mesh, far = mesh.split("** The far sides move")[0], mesh.split("*BOUNDARY\n")[1]
    held = "".join(f"{node}, 1, 2\n" for node in
                   dict.fromkeys(row.split(",")[0] for row in far.splitlines() if row.strip()))
    text = with_method(root, "flat_punch", method).text()
    text = text.replace("*INCLUDE, INPUT=flat_punch.mesh",
                        mesh.replace("CAX4", "CPE4") + "*BOUNDARY\n" + held.rstrip()) \
        .replace("PUNCH_REF, 2, -1000.", "PUNCH_REF, 2, -500.")
    result = solve(Deck.parse(text, name="plane"))
    case, start = "A5 flat punch, plane strain", f"{method.lower()}: "
    contact = result.contact(0).last
    x, p = contact.x[:, 0], contact.pressure.ravel()
    exact = flat_punch_2d(1000.0, 10.0, x[x <= 8.0])
    sheet.compare(case, start + "force", -result.history["NEAR-PUNCH.force2"][-1], 500.0, 1e-9)
    sheet.compare(case, start + "pressure in the middle", p[np.argmin(x)], 31.8310, 0.02)
    sheet.compare(case, start + "pressure, x <= 0.8 a, worst", abs(p[x <= 8.0]/exact - 1.0).max(),
                  0.0, 0.02, absolute=True)
    assert p.min() >= 0.0
