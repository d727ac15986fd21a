"""Friction of elastic bodies: Cattaneo, the plate of SSNV128, blocks that stick and slide."""
import numpy as np
import pytest

lopin = pytest.importorskip("lopin")


def field(result, index=-1):
    """Place, status, shear and pressure of the slave points of the first pair, in order of x."""
    c = result.contact().at(index)
    order = np.argsort(c.x[:, 0])
    n, w = np.asarray(c["NORMAL"])[order], np.asarray(c["WEIGHT"]).ravel()[order]
    f = np.asarray(c["force"])[order]/w[:, None]
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
    sheet.compare(case, "factorisations in 50 increments", sum(s["factorisations"] for s in steps), 1, 0.0)
    assert sum(s["increments"] for s in steps) == 50
    assert (np.diff(result.history["energy.friction"]) >= -1e-12).all()
    assert (abs(q) <= 0.3*p + 1e-9*p.max()).all()


def test_mu_zero_is_the_frictionless_kernel_bit_by_bit(solve, root):
    text = (root/"decks"/"cattaneo.inp").read_text(encoding="utf-8").split("*STEP, NAME=SHEAR")[0]
    text = text.replace("HANDLE, 6", "HANDLE, 6\nHANDLE, 1")
    with_zero = solve(lopin.Deck.parse(text.replace("0.3,\n*CONTACT PAIR", "0.,\n*CONTACT PAIR"), "zero", root/"decks"))
    without = solve(lopin.Deck.parse(text.replace("*FRICTION\n0.3,\n", ""), "none", root/"decks"))
    assert with_zero.summary["checksum"] == without.summary["checksum"]


def plate(n=32, friction="*FRICTION\n1.,", increments=10):
    """SSNV128: half of a plate of 40 by 40 on a rigid plane, pressed on top and on its side [mm, MPa]."""
    nodes = "\n".join(f"{j*(n + 1) + i + 1}, {40.0*i/n!r}, {40.0*j/n!r}" for j in range(n + 1) for i in range(n + 1))
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
    for at, reference in ((0.0, 2.86e-2), (1.25, 2.72e-2), (5.0, 2.28e-2), (7.5, 1.98e-2), (11.25, 1.50e-2)):
        sheet.compare("C1 SSNV128", f"u_x at {at} mm", np.interp(at, x[order], u[order]), reference, 0.05,
                      source="mean of several codes (SSNV128, v6.04.128)")
