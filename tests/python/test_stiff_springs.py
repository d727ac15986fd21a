"""Springs of contact that are stiff beside what the body opposes to slip of all points together."""
import numpy as np
import pytest

R, H = 10.0, 6.0


def billet(n: int, stiffness: float, unit: float = 1.0, method: str = "NODE TO SURFACE") -> str:
    """A billet under a plate of elements, n facets by springs of so many moduli over a facet."""
    m, layers, e = n + 3, max(n//5, 4), 200e3/unit**2
    x = np.linspace(0.0, R*unit, n + 1).tolist()
    z = np.linspace(0.0, H*unit, layers + 1).tolist()
    nodes = [f"{1 + i + (n + 1)*k}, {x[i]!r}, {z[k]!r}" for k in range(layers + 1)
             for i in range(n + 1)]
    cells = [f"{1 + i + n*k}, " + ", ".join(str(1 + i + a + (n + 1)*(k + b)) for a, b in
                                            ((0, 0), (1, 0), (1, 1), (0, 1)))
             for k in range(layers) for i in range(n)]
    plate = [f"{90000 + i + (m + 1)*k}, {2*R*unit*i/m!r}, {(H + 2*k)*unit!r}" for k in range(2)
             for i in range(m + 1)]
    plates = [f"{80000 + i}, " + ", ".join(str(90000 + i + a + (m + 1)*b) for a, b in
                                           ((0, 0), (1, 0), (1, 1), (0, 1))) for i in range(m)]
    top = [f"{1 + i + n*(layers - 1)}, S3" for i in range(n)]
    lines = ["*NODE", *nodes, "*NODE, NSET=PLATE", *plate, "*ELEMENT, TYPE=CAX4, ELSET=B", *cells,
             "*ELEMENT, TYPE=CAX4, ELSET=P", *plates, "*SURFACE, NAME=SKIN", *top,
             "*SURFACE, NAME=DIE", *[f"{80000 + i}, S1" for i in range(m)],
             "*NSET, NSET=AXIS", *[f"{1 + (n + 1)*k}," for k in range(layers + 1)],
             "*NSET, NSET=FLOOR", *[f"{1 + i}," for i in range(n + 1)],
             "*MATERIAL, NAME=T", "*ELASTIC", f"{10*e!r}, 0.3", "*SOLID SECTION, ELSET=P, MATERIAL=T",
             "*MATERIAL, NAME=M", "*ELASTIC", f"{e!r}, 0.3", "*PLASTIC", f"{e/285!r}, 0.",
             f"{e/150!r}, 2.", "*SOLID SECTION, ELSET=B, MATERIAL=M",
             "*SURFACE INTERACTION, NAME=I", "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR",
             f"{stiffness*e*n/R/unit!r},", "*FRICTION", "0.1,",
             f"*CONTACT PAIR, INTERACTION=I, TYPE={method}", "SKIN, DIE", "*BOUNDARY",
             "AXIS, 1, 1", "FLOOR, 2, 2", "PLATE, 1, 1", "*STEP, NLGEOM, INC=100", "*STATIC",
             "1., 2., 0.25, 1.", "*BOUNDARY", f"PLATE, 2, 2, {-4e-4*unit!r}",
             "*NODE PRINT, NSET=PLATE, TOTALS=ONLY", "RF", "*END STEP"]
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize("stiffness", [8.0, 19.0, 21.0])
def test_first_touch_takes_few_iterations_on_fine_meshes(solve, stiffness):
    """Beside the modulus over a facet springs may be soft; beside that over the contact they are not,
    and the first touch hopped between stick and slip (80 iterations and three cuts for 8)."""
    from lopin import Deck

    run = solve(Deck.parse(billet(100, stiffness), name="billet"))
    assert max(run.history["iterations"]) <= 10
    metres = solve(Deck.parse(billet(100, stiffness, 1e-3), name="metres"))
    assert list(metres.history["iterations"]) == list(run.history["iterations"])


def test_the_form_of_springs_leaves_the_answer(solve):
    """Forces on both sides of the limit between forms lie on one line of the stiffness."""
    from lopin import Deck

    force = [solve(Deck.parse(billet(36, s), name="billet")).history["SKIN-DIE.force2"][-1]
             for s in (10.0, 10.5, 11.0, 11.5)]
    assert force[1] - force[0] == pytest.approx(force[2] - force[1], rel=0.2)
    assert force[2] - force[1] == pytest.approx(force[3] - force[2], rel=0.2)
