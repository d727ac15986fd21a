"""Scenes that slide far, turn far or deform far: benchmarks D and their kin under finite sliding."""
import numpy as np
import pytest

from lopin import mesh_make
from lopin.mesh import together
from sliding_rings import FIT, PRESSURE, pressures_and_torques, rings
from sliding_scenes import LAGRANGE, deck, material, pair, sections, step

BEHAVIOURS = (LAGRANGE, "*SURFACE BEHAVIOR, PENALTY\n1.e6", "*SURFACE BEHAVIOR, PERTURBED LAGRANGE\n1.e6",
              "*SURFACE BEHAVIOR, AUGMENTED LAGRANGE\n1.e5")
MORTAR = ", TYPE=SURFACE TO SURFACE"


def slid_block(*, graded, poisson, behaviour=LAGRANGE, words="", facets=40, increments=40, friction=0.0):
    """A block of 4 by 2 under a pressure of 10 slides over a fixed flat mesh of facets."""
    ratio = 10.0 if graded else 1.0
    low = mesh_make.block((44.0, 1.0), (facets + 4, 1), origin=(-2.0, -1.0), grading=[ratio, 1.0])
    up = mesh_make.block((4.0, 2.0), (4, 2))
    up = up.with_points("PIN", lambda x: (x[:, 1] > 1.999) & (x[:, 0] < 1e-9))
    mesh = together(UP=up, LOW=low)
    cards = (material(1e4, poisson) + sections({"UP": "M", "LOW": "M"})
             + pair("UP.BOTTOM", "LOW.TOP", behaviour=behaviour, words=words, friction=friction)
             + "*BOUNDARY\nLOW.BOTTOM, 1, 2\nLOW.TOP, 1, 2\nUP.PIN, 1\n"
             + step("1., 1.", "*DSLOAD\nUP.TOP, P, 10.\n")
             + step(f"{1.0/increments!r}, 1.", "*BOUNDARY\nUP.PIN, 1, 1, 36.\n", direct=True))
    return deck(mesh, cards)


@pytest.mark.parametrize("words", ["", MORTAR])
@pytest.mark.parametrize("behaviour", BEHAVIOURS)
@pytest.mark.parametrize("graded", [False, True])
def test_a_block_slides_over_joints(solve, sheet, graded, behaviour, words):
    """D6: where facets are even, every increment, by mortar every tenth, puts all slave nodes
    on joints."""
    result = solve(slid_block(graded=graded, poisson=0.3 if graded else 0.0, behaviour=behaviour, words=words,
                              increments=40 if graded or words else 36))
    head = "UP.BOTTOM-LOW.TOP."
    drag, force, area, largest, closed = (result.history[head + w] for w in (
        "force1", "force2", "area", "max_pressure", "closed"))
    assert len(force) == len(result.times) and (closed == 5).all()
    name = (f"{'graded 1:10' if graded else 'joints at slave nodes'}, "
            f"{behaviour.split(', ')[1].split(chr(10))[0].lower()}, {'mortar' if words else 'node to segment'}")
    for what, worst in (("drift of the force", np.abs(force/force[0] - 1.0).max()),
                        ("largest pressure over the mean - 1", np.abs(largest*area/force - 1.0).max()),
                        ("drift of the pressure", np.abs(largest/largest[0] - 1.0).max()),
                        ("drag over force", np.abs(drag/force).max())):
        sheet.compare("D6 sliding over 40 facets", f"{name}: {what}", worst, 0.0, 1e-10, "exact", absolute=True)


@pytest.mark.parametrize("name, options", [
    ("smoothed facets", {"words": ", SMOOTH=YES"}),
    ("smoothed facets, penalty", {"words": ", SMOOTH=YES", "behaviour": "*SURFACE BEHAVIOR, PENALTY"}),
    ("smoothed facets, hub as slave", {"words": ", SMOOTH=YES", "slave": "hub"}),
    ("mortar", {"words": MORTAR, "layers": 3})])
def test_a_shaft_turns_in_its_hub(solve, sheet, name, options):
    """D5: 48 linear facets on both sides; 12 degrees in 12 increments, more than a facet."""
    result = solve(rings(angle=12.0, increments=12, start=1.3, **options))
    p, torque, times = pressures_and_torques(result)
    assert len(times) == 13
    case = "D5 rotating rings"
    for what, value in (("smallest", p[:, 0].min()), ("largest", p[:, 1].max())):
        sheet.compare(case, f"{name}: {what} pressure of any node and increment", value, PRESSURE, 0.02, "Lame")
    sheet.compare(case, f"{name}: torque over p R^2", np.abs(torque).max()/(PRESSURE*FIT**2), 0.0, 1e-3, "no friction",
                  absolute=True)


def test_a_shaft_in_straight_chords(solve, sheet):
    """What smoothing is for: chords of 48 facets stand off the circle by 6 interferences."""
    p, _, _ = pressures_and_torques(solve(rings(angle=6.0, increments=6, start=1.3)))
    sheet.compare("D5 rotating rings", "straight facets, node to segment: largest pressure over the exact one",
                  p[:, 1].max()/PRESSURE, 2.0, 0.0, "a property of the method", at_least=True)


@pytest.mark.parametrize("mu", [0.1, 0.3])
def test_a_shaft_slips_in_its_hub(solve, sheet, mu):
    """D5 with friction: once all of it slips, the torque is 2 pi mu p R^2."""
    result = solve(rings(angle=2.0, increments=8, start=1.3, words=", SMOOTH=YES", friction=mu))
    p, torque, _ = pressures_and_torques(result)
    assert (result.contact(0).last.status == 2).all()
    sheet.compare("D5 rotating rings", f"mu = {mu}: torque over 2 pi mu p R^2, p as computed",
                  abs(torque[-1])/(2.0*np.pi*mu*p[-1, 2]*FIT**2), 1.0, 2e-3, "closed form")
    sheet.compare("D5 rotating rings", f"mu = {mu}: torque over 2 pi mu p R^2", abs(torque[-1]),
                  2.0*np.pi*mu*PRESSURE*FIT**2, 0.02, "Lame, Coulomb")
