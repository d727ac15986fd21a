"""Punches with friction: a flat one, whose stick does not depend on the load, and NAFEMS' with a rounded edge."""
import numpy as np
import pytest

from test_friction_blocks import field

lopin = pytest.importorskip("lopin")

#: Boundary elements with the full coupling of pressure and shear, extrapolated.
STICK = {0.2: 0.3604, 0.3: 0.6891, 0.5: 0.9411}


@pytest.mark.parametrize("mu", STICK)
def test_the_stick_under_a_flat_punch_does_not_depend_on_the_load(solve, sheet, root, mu):
    text = (root/"decks"/"rough_punch.inp").read_text(encoding="utf-8")
    result = solve(lopin.Deck.parse(text.replace("*FRICTION\n0.3,", f"*FRICTION\n{mu},"), "punch", root/"decks"))
    case, start = "A9 Spence: flat punch with friction", f"mu = {mu}: "
    edges, shares = [], []
    for increment in range(len(result.times)):
        x, status, q, p = field(result, increment)
        last = np.flatnonzero(status == 1)[-1]
        edges.append(0.05*(x[last] + x[last + 1]))
        shares.append(q[:last]/p[:last])
    sheet.compare(case, start + "stick over half width, last load", edges[-1], STICK[mu], 0.02,
                  "boundary elements", absolute=True)
    sheet.compare(case, start + "its spread over ten loads", max(edges) - min(edges), 0.0, 0.0, absolute=True)
    sheet.compare(case, start + "largest change of q/p over ten loads", max(abs(s - shares[0]).max() for s in shares), 0.0,
                  1e-5, absolute=True)
    assert sum(s["factorisations"] for s in result.summary["steps"]) == 1


#: Depth of the block's surface, CalculiX 2.20 on the same mesh, mu = 0, penalty 2e7 MPa/mm.
BESIDE = {24.1823: 0.1318213, 32.2768: 0.1304848, 38.5: 0.1291959, 44.5: 0.09491971, 51.6538: 0.07679436}


def test_a_punch_with_a_rounded_edge(solve, sheet, root):
    case = "C2 NAFEMS 2: punch with a rounded edge"
    text = (root/"decks"/"nafems_punch.inp").read_text(encoding="utf-8")
    result = solve(lopin.Deck.parse(text, "punch", root/"decks"))
    x, status, q, p = field(result)
    sheet.compare(case, "mu = 0.1: stress in the middle", result["S"][2585, 1], -88.66524, 0.03, "code_aster")
    assert (abs(q) <= 0.1*p + 1e-9*p.max()).all() and (status == 2).any() and (status == 1).any()
    smooth = solve(lopin.Deck.parse(text.replace("*FRICTION\n0.1,\n", ""), "smooth", root/"decks"))
    top = np.loadtxt([line for line in (root/"decks"/"nafems_punch.mesh").read_text().split("*NODE\n")[1].split("*")[0]
                      .splitlines()], delimiter=",")
    for r, depth in BESIDE.items():
        node = np.argmin(np.hypot(top[2000:, 1] - r, top[2000:, 2])) + 2000
        sheet.compare(case, f"mu = 0: depth at r = {r:.4g}", -smooth["U"][node, 1], depth, 0.005, "CalculiX, same mesh")
