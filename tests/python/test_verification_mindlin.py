"""A8: two equal spheres pressed, then sheared to and fro (Mindlin 1949, Mindlin and Deresiewicz 1953)."""
import sys
from pathlib import Path

import numpy as np
import pytest

lopin = pytest.importorskip("lopin")
sys.path.insert(0, str(Path(__file__).resolve().parents[2]/"decks"/"make"))

DECK = """*HEADING
Two spheres, half of them, N mm
{mesh}
*NODE, NSET=HANDLE
900001, 0., 0., 40.
*MATERIAL, NAME=STEEL
*ELASTIC
210000., 0.3
*SOLID SECTION, ELSET=UP, MATERIAL=STEEL
*SOLID SECTION, ELSET=LOW, MATERIAL=STEEL
*RIGID BODY, NSET=UP.TOP, REF NODE=900001
*SURFACE INTERACTION, NAME=DRY
*SURFACE BEHAVIOR, DIRECT
*FRICTION
0.3,
*CONTACT PAIR, INTERACTION=DRY, SMALL SLIDING
UP.NEAR, LOW.NEAR
*BOUNDARY
LOW.BOTTOM, 1, 3
UP.FRONT, 2
LOW.FRONT, 2
HANDLE, 2
HANDLE, 4, 6
*AMPLITUDE, NAME=TOFRO
0., 0., 1., 1., 3., -1., 5., 1.
*STEP, INC=100
*STATIC, DIRECT
1., 1.
*CLOAD
HANDLE, 3, -500.
*END STEP
*STEP, INC=200
*STATIC, DIRECT
0.1, 5.
*CLOAD, AMPLITUDE=TOFRO
HANDLE, 1, 50.
*CONTACT FILE, FREQUENCY=10
CDIS, CSTR
*END STEP
"""


def build():
    from friction_meshes import mindlin
    return DECK.format(mesh=mindlin().text().strip())


@pytest.fixture(scope="module")
def exact():
    from lopin.closed_form import mindlin_point
    return mindlin_point(1000.0, 0.3, 10.0, 210e3, 0.3)


def test_the_loop_of_mindlin(solve, sheet, exact):
    """Six and a half elements in the radius of contact; the slip ring is one of them wide."""
    case = "A8 Mindlin: two spheres in 3D, sheared to and fro"
    result = solve(lopin.Deck.parse(build(), "mindlin"))
    steps, h = result.summary["steps"], result.history
    sheet.compare(case, "factorisations in 51 increments", sum(s["factorisations"] for s in steps), 1, 0.0)
    assert sum(s["increments"] for s in steps) == 51
    time, along = np.asarray(h["time"]), np.asarray(h["UP.TOP.u1"])
    turn = int(np.argmin(abs(time - 2.0)))
    contact = result.contact().at(int(np.argmin(abs(np.asarray(result.times) - 2.0))))
    weight, status = np.asarray(contact["WEIGHT"]).ravel(), np.asarray(contact.status).ravel()
    radius = [np.sqrt(2.0/np.pi*weight[chosen].sum()) for chosen in (np.asarray(contact.pressure).ravel() > 0.0, status == 1)]
    sheet.compare(case, "radius of contact, by area", radius[0], exact.normal.a, 0.05)
    sheet.compare(case, "radius of stick, by area", radius[1], exact.stick_radius(100.0), 0.03)
    sheet.compare(case, "displacement at Q = 100", along[turn] - along[0], exact.displacement(100.0), 0.01)
    shear = 50.0*np.interp(time[turn:], [2.0, 4.0, 6.0], [1.0, -1.0, 1.0])
    done = 2.0*np.sum(0.5*(shear[1:] + shear[:-1])*np.diff(along[turn:]))
    lost = 2.0*(h["energy.friction"][-1] - h["energy.friction"][turn])
    stored = 2.0*(h["energy.strain"][-1] - h["energy.strain"][turn])
    # Coarse here: +15 %; with 9.5 elements in the radius +8 %.
    sheet.compare(case, "energy of a cycle", done, exact.loop_energy(100.0), 0.2)
    sheet.compare(case, "energy dissipated over work of the forces", lost/done, 1.0, 0.005)
    sheet.compare(case, "stored over the cycle/work", stored/done, 0.0, 1e-3, absolute=True)
    assert min(np.diff(h["energy.friction"])) >= -1e-12
