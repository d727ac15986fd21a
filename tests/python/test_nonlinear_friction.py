"""Friction of one node on springs, on the finite path: cycles, energies, laws that change, pairs
that go and come."""
import numpy as np
import pytest

from friction_scenes import METHODS, slider
from test_friction_springs import COULOMB, PRESSED, SAW


@pytest.fixture
def pull(solve):
    """Tangential force that drags the node, normal force, time and the result of a deck."""
    from lopin import Deck

    def run(*arguments, change=None, **options):
        text = slider(*arguments, **options)
        if change:
            assert change[0] in text
            text = text.replace(*change)
        result = solve(Deck.parse("*LOPIN, PATH=FINITE\n" + text, name="slider"))
        h = result.history
        return h["FLOOR.rf1"], h["FLOOR.rf2"], h["time"], result

    return run


def test_cycles_dissipate_and_repeat(pull, sheet):
    t, n, time, result = pull(COULOMB, PRESSED, SAW, 0.1)
    at = {round(v, 6): i for i, v in enumerate(time)}
    work = result.history["energy.friction"]
    case = "C6 stick-slip cycles, finite path"
    h = result.history
    stored = h["energy.strain"] + h["energy.contact"]
    sheet.compare(case, "energy balance beside the work",
                  max(abs(h["energy.external"] - stored - work)), 0.0, 1e-9*work[-1], absolute=True)
    sheet.compare(case, "energy of a cycle", work[at[7.0]] - work[at[3.0]], 8.4, 1e-9)
    first, second = slice(at[3.0], at[5.0] + 1), slice(at[7.0], at[9.0] + 1)
    sheet.compare(case, "two cycles: largest difference of the force",
                  max(abs(t[first] - t[second])), 0.0, 30.0e-9, absolute=True)
    assert (np.diff(work) >= -1e-12).all()


@pytest.mark.parametrize("method", ["PENALTY", "PERTURBED LAGRANGE"])
def test_elastic_slip_is_stored_not_dissipated(pull, sheet, method):
    """C6 with a tangential spring of the pair: 4 mu N (U - mu N/k_eff), and what leaves comes
    back."""
    stick = 4000.0
    t, n, time, result = pull(f"*FRICTION\n0.3, {stick!r}", PRESSED, SAW, 0.05, method=method,
                              slope=1e6)
    h = result.history
    at = {round(v, 6): i for i, v in enumerate(h["time"])}
    work, most = h["energy.friction"], max(abs(t))
    expected = 4.0*most*(0.1 - most*(1.0/1000.0 + 1.0/stick))
    sheet.compare("C6 stick-slip cycles, finite path",
                  f"energy of a cycle, {method.lower()} with stick slope",
                  work[at[7.0]] - work[at[3.0]], expected, 1e-9)
    assert (np.diff(work) >= -1e-10).all()


def step(words: str, pushed: float = -0.1, dragged: float = 0.1, increments: int = 2) -> str:
    return f"""*STEP
*STATIC, DIRECT
{1.0/increments!r}, 1.
{words}*BOUNDARY
PUSHED, 2, 2, {pushed!r}
*BOUNDARY
DRAGGED, 1, 1, {dragged!r}
*NODE FILE
U, RF
*CONTACT FILE
CDIS, CSTR
*END STEP
"""


DRAGGED = [(0.0, 0.0), (1.0, 0.0), (2.0, 0.1)]
PUSH = [(0.0, 0.0), (1.0, 0.1), (2.0, 0.1)]
REMOVE = "*MODEL CHANGE, TYPE=CONTACT PAIR, REMOVE\nFOOT, FLOOR\n"


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("card, tau", [("0.1,", 10.0), ("0.5,", 30.0),
                                       (", TAUMAX=12.\n0.5,", 12.0)])
def test_friction_that_changes_in_a_step(pull, method, card, tau):
    """Less friction lets the spring relax to the new bound; more leaves it where it was."""
    words = "*CHANGE FRICTION, INTERACTION=I\n*FRICTION" + ("" if card[0] == ","
                                                            else "\n") + card + "\n"
    t, n, time, result = pull(COULOMB, PUSH, DRAGGED, 0.25, method=method, slope=None
                              if method == "DIRECT" else 1e6, steps=step(words))
    assert abs(t[time <= 2.0 + 1e-9][-1]) == pytest.approx(0.3*abs(n[-1]), rel=1e-6)
    assert abs(t[-1]) == pytest.approx(tau, rel=2e-3 if method in METHODS[1:3] else 1e-8)
    assert (np.diff(result.history["energy.friction"]) >= -1e-12).all()


@pytest.mark.parametrize("method", METHODS)
def test_a_pair_that_is_removed_holds_nothing_and_comes_back(pull, method):
    back = "*MODEL CHANGE, TYPE=CONTACT PAIR, ADD\nFOOT, FLOOR\n"
    steps = step(REMOVE) + step(back, pushed=0.0) + step("")
    t, n, time, result = pull(COULOMB, PUSH, DRAGGED, 0.25, method=method, slope=None
                              if method == "DIRECT" else 1e6, steps=steps)
    at = {round(v, 6): i for i, v in enumerate(time)}
    assert t[at[3.0]] == 0.0 and n[at[3.0]] == 0.0
    assert abs(n[at[5.0]]) == pytest.approx(100.0, rel=2e-3)
    assert abs(t[at[5.0]]) <= 30.0*(1.0 + 1e-9)


@pytest.mark.parametrize("method", METHODS)
def test_no_separation_pulls_without_friction_and_warns_once(pull, method):
    """The bound is that of max(p, 0): under tension the node slides freely."""
    slope = None if method == "DIRECT" else 1e6
    behavior = f"*SURFACE BEHAVIOR, {method}"
    t, n, time, result = pull(COULOMB, PUSH, DRAGGED, 0.25, method=method, slope=slope,
                              change=(behavior, behavior + ", NO SEPARATION"),
                              steps=step("", pushed=0.05, increments=4))
    assert n[time <= 2.0 + 1e-9][-1]*n[-1] < 0.0 and abs(n[-1]) == pytest.approx(50.0, rel=2e-3)
    assert abs(t[-1]) <= 1e-8*abs(n[-1])
    assert sum("W0521" in m for m in result.warnings) == 1


@pytest.mark.parametrize("method", METHODS)
def test_rough_sticks(pull, method):
    t, n, time, result = pull("*FRICTION, ROUGH", PUSH, DRAGGED, 0.25, method=method, slope=None
                              if method == "DIRECT" else 1e6)
    assert abs(t[-1]) == pytest.approx(100.0, rel=1e-2 if method in METHODS[1:3] else 1e-8)


def test_a_block_lifted_with_a_breath_along_has_no_friction(pull):
    """F14: as the pressure goes to nothing so does the shear; nothing is not a number."""
    lift = [(0.0, 0.0), (1.0, 0.1), (2.0, 0.0), (3.0, -0.1)]
    t, n, time, result = pull(COULOMB, lift, [(0.0, 0.0), (1.0, 0.0), (3.0, 1e-11)], 0.25)
    assert np.isfinite(t).all() and np.isfinite(n).all() and t[-1] == 0.0 and n[-1] == 0.0
    assert abs(t[0]) <= 1e-12*abs(n[0])
