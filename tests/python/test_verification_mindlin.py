"""A8: two equal spheres pressed, then sheared to and fro (Mindlin 1949, Mindlin and Deresiewicz
1953)."""
import sys
from pathlib import Path

import lopin
import numpy as np
import pytest

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
*RIGID BODY, NSET=UP.FAR, REF NODE=900001
*SURFACE INTERACTION, NAME=DRY
*SURFACE BEHAVIOR, DIRECT
*FRICTION
0.3,
*CONTACT PAIR, INTERACTION=DRY, SMALL SLIDING
UP.NEAR, LOW.NEAR
*BOUNDARY
LOW.FAR, 1, 3
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


#: By rings of elements in the ring that slips (a - c): energy of a cycle, within; the rest falls with h^2.
ENERGY = {2: 0.15, 4: 0.04}


def build(rings):
    from friction_meshes import mindlin
    return DECK.format(mesh=mindlin(rings).text().strip())


@pytest.fixture(scope="module")
def exact():
    from lopin.closed_form import mindlin_point
    return mindlin_point(1000.0, 0.3, 10.0, 210e3, 0.3)


@pytest.mark.parametrize("rings", ENERGY)
def test_the_loop_of_mindlin(solve, sheet, exact, rings):
    case, name = "A8 Mindlin: two spheres in 3D, sheared to and fro", f"{rings} rings: "
    result = solve(lopin.Deck.parse(build(rings), "mindlin"))
    steps, h = result.summary["steps"], result.history
    sheet.compare(case, name + "factorisations in 51 increments",
                  sum(s["factorisations"] for s in steps), 1, 0.0)
    assert sum(s["increments"] for s in steps) == 51
    time, along = np.asarray(h["time"]), np.asarray(h["UP.FAR.u1"])
    turn = int(np.argmin(abs(time - 2.0)))
    contact = result.contact().at(int(np.argmin(abs(np.asarray(result.times) - 2.0))))
    weight, status = np.asarray(contact["WEIGHT"]).ravel(), np.asarray(contact.status).ravel()
    # Stick is found to a ring of elements.
    for what, chosen, expected, within in (
            ("contact", np.asarray(contact.pressure).ravel() > 0.0, exact.normal.a, 0.01),
            ("stick", status == 1, exact.stick_radius(100.0), 0.03)):
        sheet.compare(case, f"{name}radius of {what}, by area",
                      np.sqrt(2.0/np.pi*weight[chosen].sum()), expected, within)
    sheet.compare(case, name + "displacement at Q = 100", along[turn] - along[0],
                  exact.displacement(100.0), 0.003)
    shear = 50.0*np.interp(time[turn:], [2.0, 4.0, 6.0], [1.0, -1.0, 1.0])
    done = 2.0*np.sum(0.5*(shear[1:] + shear[:-1])*np.diff(along[turn:]))
    # Half of the bodies is there.
    moved = {key: 2.0*(h[f"energy.{key}"][-1] - h[f"energy.{key}"][turn])
             for key in ("external", "strain", "friction", "friction_mean")}
    sheet.compare(case, name + "energy of a cycle", done, exact.loop_energy(100.0), ENERGY[rings])
    # The shear's work, and what the pressing force does as the bodies settle a little in the first
    # cycle.
    sheet.compare(case,
                  name
                  + "work of all forces - stored - dissipated, by one rule, over the energy of a cycle",
                  (moved["external"] - moved["strain"] - moved["friction_mean"])/done, 0.0, 1e-6,
                  "energy", absolute=True)
    sheet.compare(case, name + "dissipated over work of the shear", moved["friction_mean"]/done,
                  1.0, 2e-4, "energy")
    sheet.compare(case, name + "by tractions at the increments' ends, over the same",
                  moved["friction"]/done, 1.0, 0.005, "energy")
    sheet.compare(case, name + "stored over the cycle/work", moved["strain"]/done, 0.0, 5e-4,
                  "energy", absolute=True)
    open_ = np.diff(h["energy.external"] - h["energy.strain"] - h["energy.friction_mean"])[1:]
    sheet.compare(case, name + "largest open energy of an increment over dissipated",
                  np.abs(open_).max()/h["energy.friction"][-1], 0.0, 1e-6, "energy", absolute=True)
    assert min(np.diff(h["energy.friction"])) >= -1e-12
