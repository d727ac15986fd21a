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
    sheet.compare(case, "two cycles: largest difference of the force", max(abs(t[first] - t[second])), 0.0,
                  1e-12*30.0, absolute=True)
    sheet.compare(case, "largest force", max(abs(t)), 30.0, 1e-12)
    assert n[at[9.0]] == pytest.approx(100.0, rel=1e-12) and (np.diff(work) >= 0.0).all()
    # F13: just after the turn the node sticks, along the spring.
    t, n, time, result = pull(COULOMB, [(0.0, 0.0), (1.0, 0.1), (5.0, 0.1)],
                              [(0.0, 0.0), (1.0, 0.0), (2.0, 0.1), (3.0, 0.099), (4.0, 0.1), (5.0, 0.099)], 1.0)
    sheet.compare("F13 friction reversal", "force after 0.001 back", abs(t[2]), 29.0, 1e-12)
