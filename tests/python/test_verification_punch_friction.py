"""Punches with friction: a flat one, whose stick does not depend on the load, and NAFEMS' with a
rounded edge."""
import sys
from pathlib import Path

import lopin
import numpy as np
import pytest

from test_friction_blocks import field

sys.path.insert(0, str(Path(__file__).resolve().parents[2]/"decks"/"make"))

#: Boundary elements with the full coupling of pressure and shear, extrapolated.
STICK = {0.2: 0.3604, 0.3: 0.6891, 0.5: 0.9411}


@pytest.mark.parametrize("mu", STICK)
def test_the_stick_under_a_flat_punch_does_not_depend_on_the_load(solve, sheet, root, mu):
    text = (root/"decks"/"rough_punch.inp").read_text(encoding="utf-8")
    result = solve(lopin.Deck.parse(text.replace("*FRICTION\n0.3,", f"*FRICTION\n{mu},"), "punch",
                                    root/"decks"))
    case, start = "A9 Spence: flat punch with friction", f"mu = {mu}: "
    edges, shares = [], []
    for increment in range(len(result.times)):
        x, status, q, p = field(result, increment)
        last = np.flatnonzero(status == 1)[-1]
        edges.append(0.05*(x[last] + x[last + 1]))
        shares.append(q[:last]/p[:last])
    sheet.compare(case, start + "stick over half width, last load", edges[-1], STICK[mu], 0.02,
                  "boundary elements", absolute=True)
    sheet.compare(case, start + "its spread over ten loads", max(edges) - min(edges), 0.0, 0.0,
                  absolute=True)
    sheet.compare(case, start + "largest change of q/p over ten loads",
                  max(abs(s - shares[0]).max() for s in shares), 0.0, 1e-5, absolute=True)
    assert sum(s["factorisations"] for s in result.summary["steps"]) == 1


#: Depth of the block's surface, CalculiX 2.20 on the same mesh, mu = 0, penalty 2e7 MPa/mm.
BESIDE = {24.1823: 0.1318213, 32.2768: 0.1304848, 38.5: 0.1291959, 44.5: 0.09491971,
          51.6538: 0.07679436}


def test_a_punch_with_a_rounded_edge(solve, sheet, root):
    case = "C2 NAFEMS 2: punch with a rounded edge"
    text = (root/"decks"/"nafems_punch.inp").read_text(encoding="utf-8")
    result = lopin.run(lopin.Deck.parse(text, "punch", root/"decks"))
    x, status, q, p = field(result)
    sheet.compare(case, "mu = 0.1: stress in the middle", result["S"][2585, 1], -88.66524, 0.03,
                  "code_aster")
    assert (abs(q) <= 0.1*p + 1e-9*p.max()).all() and (status == 2).any() and (status == 1).any()
    smooth = solve(lopin.Deck.parse(text.replace("*FRICTION\n0.1,\n", ""), "smooth", root/"decks"))
    top = np.loadtxt([line
                      for line in (root/"decks"/"nafems_punch.mesh").read_text().split("*NODE\n")[1].split("*")[0]
                      .splitlines()], delimiter=",")
    for r, depth in BESIDE.items():
        node = np.argmin(np.hypot(top[2000:, 1] - r, top[2000:, 2])) + 2000
        sheet.compare(case, f"mu = 0: depth at r = {r:.4g}", -smooth["U"][node, 1], depth, 0.005,
                      "CalculiX, same mesh")


#: Depth of the middle that code_aster and MARC found, by friction; and on the finest of our meshes.
PUBLISHED = {0.0: 0.13073410, 0.1: 0.12858018}


def depth(solve, text, mesh, mu, full):
    """Of the middle of the block's surface, on another mesh; `full`: elements integrated fully,
    without B-bar."""
    text = text.replace("*INCLUDE, INPUT=nafems_punch.mesh", mesh.text().strip())
    if mu == 0.0:
        text = text.replace("*FRICTION\n0.1,\n", "")
    if full:
        text = text.replace("*SOLID SECTION, ", "*SOLID SECTION, CONTROLS=FULL, ") \
            .replace("*MATERIAL, NAME=STEEL",
                     "*SECTION CONTROLS, NAME=FULL, FORMULATION=FULL\n*MATERIAL, NAME=STEEL")
    result = solve(lopin.Deck.parse(text, "punch"))
    nodes = result.to_meshio().points
    down = np.asarray(result["U"])[np.hypot(nodes[:, 0], nodes[:, 1]) < 1e-9, 1]
    return -down.min()


@pytest.mark.parametrize("mu", PUBLISHED)
def test_the_published_depth_is_that_of_a_coarse_mesh(solve, sheet, root, mu):
    """2.4 % less than what meshes converge to; even squares of 6.67 mm, fully integrated, give it
    for both mu."""
    from friction_meshes import coarse_punch, nafems_punch
    case, name = "C2 NAFEMS 2: punch with a rounded edge", f"mu = {mu:g}: "
    text = (root/"decks"/"nafems_punch.inp").read_text(encoding="utf-8")
    coarse = {cells: depth(solve, text, coarse_punch(cells), mu, True) for cells in (4, 6, 8, 16)}
    fine = {what: depth(solve, text, nafems_punch(*mesh), mu, False)
            for what, mesh in (("size 0.5 at the edge", (0.5,)), ("size 1", (1.0,)),
                               ("quadratic, size 2", (2.0, True)))}
    assert coarse[4] < PUBLISHED[mu] < coarse[8] < coarse[16] < min(fine.values())
    sheet.compare(case, name + "depth of the middle, even squares of 6.67 mm", coarse[6],
                  PUBLISHED[mu], 0.005, "MARC, code_aster")
    sheet.compare(case, name + "even squares of 2.5 mm", coarse[16], fine["size 0.5 at the edge"],
                  0.01, "size 0.5 at the edge")
    for what in list(fine)[1:]:
        sheet.compare(case, name + what, fine[what], fine["size 0.5 at the edge"], 0.002,
                      "size 0.5 at the edge")
