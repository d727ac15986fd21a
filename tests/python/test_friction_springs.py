"""Friction of one node on springs, solved by hand: cycles, paths, laws and methods."""
import numpy as np
import pytest

from friction_scenes import KT, METHODS, slider

COULOMB = "*FRICTION\n0.3,"
PRESSED = [(0.0, 0.0), (1.0, 0.1), (9.0, 0.1)]          # N = 100
SAW = [(0.0, 0.0), (1.0, 0.0), (2.0, 0.1), (4.0, -0.1), (6.0, 0.1), (8.0, -0.1), (9.0, 0.0)]


@pytest.fixture
def pull(solve):
    """Tangential force that drags the node, normal force, time and the result of a deck."""
    from lopin import Deck

    def run(*arguments, **options):
        result = solve(Deck.parse(slider(*arguments, **options), name="slider"))
        h = result.history
        return h["FLOOR.rf1"], h["FLOOR.rf2"], h["time"], result

    return run


def test_cycles_of_stick_and_slip_repeat_and_dissipate(pull, sheet):
    t, n, time, result = pull(COULOMB, PRESSED, SAW, 0.1)
    case = "C6 stick-slip cycles"
    at = {round(v, 6): i for i, v in enumerate(time)}
    work = result.history["energy.friction"]
    sheet.compare(case, "energy of a cycle", work[at[7.0]] - work[at[3.0]], 8.4, 1e-10)
    first, second = slice(at[3.0], at[5.0] + 1), slice(at[7.0], at[9.0] + 1)
    sheet.compare(case, "two cycles: largest difference of the force",
                  max(abs(t[first] - t[second])), 0.0, 1e-12*30.0, absolute=True)
    sheet.compare(case, "largest force", max(abs(t)), 30.0, 1e-12)
    assert n[at[9.0]] == pytest.approx(100.0, rel=1e-12) and (np.diff(work) >= 0.0).all()
    # F13: just after the turn the node sticks, along the spring.
    t, n, time, result = pull(COULOMB, [(0.0, 0.0), (1.0, 0.1), (5.0, 0.1)],
                              [(0.0, 0.0), (1.0, 0.0), (2.0, 0.1), (3.0, 0.099), (4.0, 0.1),
                               (5.0, 0.099)], 1.0)
    sheet.compare("F13 friction reversal", "force after 0.001 back", abs(t[2]), 29.0, 1e-12)


def test_the_path_decides_the_force(pull, sheet):
    """C7: the same end (0.1, 0.02) by three ways."""
    still, pressed = (0.0, 0.0), 0.1
    ways = {"normal, then tangential": ([still, (1.0, pressed), (3.0, pressed)],
                                        [still, (1.0, 0.0), (2.0, 0.02), (3.0, 0.02)], 20.0),
            "tangential, then normal": ([still, (1.0, 0.0), (2.0, pressed), (3.0, pressed)],
                                        [still, (1.0, 0.02), (3.0, 0.02)], 0.0),
            "unloaded to half": ([still, (1.0, pressed), (2.0, pressed), (3.0, 0.05),
                                  (4.0, pressed)],
                                 [still, (1.0, 0.0), (2.0, 0.02), (4.0, 0.02)], 15.0)}
    for name, (push, drag, force) in ways.items():
        height = 0.001 if name.startswith("tangential") else 0.0
        t, n, time, result = pull(COULOMB, [(a, b + height*(b > 0)) for a, b in push], drag, 0.25,
                                  height=height)
        sheet.compare("C7 path dependence", name, abs(t[-1]), force, 1e-12, absolute=force == 0.0)
        assert n[-1] == pytest.approx(100.0, rel=1e-12)


# C9: p = 100; the node slides at v = 2 after the spring is stretched, and holds tau.
YIELD = "*PLASTIC, ONLY=FRICTION\n200., 0.\n"
LAWS = {"coulomb": ("*FRICTION\n0.3,", 30.0), "tresca": ("*FRICTION, LAW=TRESCA\n0.2,",
                                                         23.0940107675850),
        "orowan": ("*FRICTION, LAW=COULOMB-OROWAN\n0.3, 0.2", 23.0940107675850),
        "cristescu": ("*FRICTION, LAW=CRISTESCU\n0.2,", 0.2*100.0/3.0**0.5),
        "norton-hoff": ("*FRICTION, LAW=NORTON-HOFF\n5., 0.2", 5.74349177498517),
        "arctan": ("*FRICTION, REGULARIZATION=ARCTAN, V0=2.\n0.3,", 15.0),
        "rough": ("*FRICTION, ROUGH", None)}


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("law", LAWS)
def test_every_law_by_every_method(pull, sheet, method, law):
    card, tau = LAWS[law]
    slope = None if method == "DIRECT" else 1e6
    depth = 0.1 + (100.0/slope if method in METHODS[1:3]
                   else 0.0)   # what penetrates is pushed deeper
    push = [(0.0, 0.0), (1.0, depth), (2.0, depth)]
    t, n, time, result = pull(card, push, [(0.0, 0.0), (1.0, 0.0), (2.0, 2.0)], 0.05, method=method,
                              slope=slope, plastic=YIELD if law in ("tresca", "orowan") else "")
    assert n[-1] == pytest.approx(100.0, rel=1e-9)
    if tau is None:
        assert abs(t[-1]) == pytest.approx(KT*2.0, rel=1e-2)
    else:
        sheet.compare("C9 laws and methods", f"{law}, {method.lower()}", abs(t[-1]), tau, 1e-9)
    assert (np.diff(result.history["energy.friction"]) >= -1e-12).all()


@pytest.mark.parametrize("share", [0.5, 0.9, 0.99])
def test_a_regularised_law_creeps_by_its_formula(pull, sheet, share):
    """F12: the tip of the spring is moved so that T = share*mu*N when the node has crept."""
    u0 = 1e-3
    creep = u0*float(np.tan(0.5*np.pi*share))
    for steps in (1, 7):
        t, n, time, result = pull(f"*FRICTION, REGULARIZATION=ARCTAN, ELASTIC SLIP={u0!r}\n0.3,",
                                  [(0.0, 0.0), (1.0, 0.1), (2.0, 0.1)],
                                  [(0.0, 0.0), (1.0, 0.0), (2.0, 30.0*share/KT + creep)], 1.0/steps)
        sheet.compare("F12 creep of the arctangent",
                      f"T/(mu N) = {share}, {steps} increments: slip",
                      30.0*share/KT + creep - abs(t[-1])/KT, creep, 1e-9)


@pytest.mark.parametrize("friction, method, slope, steps", [
    ("*FRICTION\n0.3,", "PENALTY", 1e5, 1e-5), ("*FRICTION\n0.3, 2000.", "DIRECT", None, 1e-12),
    ("*FRICTION, REGULARIZATION=TANH, ELASTIC SLIP=0.02\n0.3,", "DIRECT", None, 1e-4)])
def test_elastic_stick_stores_what_the_springs_do_not(solve, friction, method, slope, steps):
    """Work done is stored in bodies and contact or lost: what elastic stick and regularised laws
    hold is not missing."""
    from lopin import Deck

    deck = slider(friction, [(0.0, 0.0), (1.0, 0.1), (2.0, 0.1)],
                  [(0.0, 0.0), (1.0, 0.0), (2.0, 0.06)], 0.01, method, slope)
    energy = solve(Deck.parse(deck, name="slider")).summary["energy"]
    assert energy["contact"] > 0.2
    assert energy["strain"] + energy["contact"] + energy["friction"] == pytest.approx(energy["external"], rel=10.0*steps)
