"""Forces out of balance fade (*START, RELEASE): a stretched bar that nothing holds any more."""
import numpy as np
import pytest

import lopin

#: Stress [MPa], modulus, length and width of the bar.
STRESS, MODULUS, LENGTH = 100.0, 200e3, 10.0


def bar(release, increments=0.05):
    """One element of a bar in plane strain without lateral contraction, pulled by STRESS in x; its
    far end is free from the start on, a tool stands aside."""
    e = STRESS/MODULUS
    third = e/3.0
    return lopin.Deck.parse(f"""*NODE
1, 0., 0.
2, {LENGTH}, 0.
3, {LENGTH}, 1.
4, 0., 1.
*NODE, NSET=PIN
9, 0., 50.
*ELEMENT, TYPE=CPE4, ELSET=BAR
1, 1, 2, 3, 4
*NSET, NSET=FIXED
1, 4
*NSET, NSET=FREE
2, 3
*SURFACE, NAME=SKIN
BAR, S3
*SURFACE, NAME=TOOL, TYPE=SEGMENTS
START, 40., 50.
LINE, -40., 50.
*RIGID BODY, ANALYTICAL SURFACE=TOOL, REF NODE=PIN
*MATERIAL, NAME=METAL
*ELASTIC
{MODULUS}, 0.
*PLASTIC
1000., 0.
1000., 1.
*SOLID SECTION, ELSET=BAR, MATERIAL=METAL
*SURFACE INTERACTION, NAME=NONE
*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD
*CONTACT PAIR, INTERACTION=NONE
SKIN, TOOL
*BOUNDARY
FIXED, 1, 2
FREE, 2
PIN, 1, 2
PIN, 6
*INITIAL CONDITIONS, TYPE=STATE
1, 0, {2*third}, {-third}, {-third}, 0., 0., 0., {e}, 0., 0., 0., 0.
*START, STEP=1, TIME=0.2, REST=1e-8, INCREMENT={increments}, RELEASE={release}
*STEP, NLGEOM, INC=100
*STATIC
{increments}, 1., 1e-6, {increments}
*NODE PRINT, NSET=FREE
U
*END STEP
""", name="bar")


def ends(deck):
    """Time and displacement of the free end after each increment."""
    rows = []
    with lopin.open(deck) as job:
        for frame in job:
            label = frame["LABEL"].ravel().astype(int)
            rows.append((frame.result.times[frame.index], frame["U"][label == 2][0, 0]))
    return np.array(rows)


def test_what_is_out_of_balance_fades_evenly(core):
    time, u = ends(bar(0.4)).T
    whole = -LENGTH*(1.0 - np.exp(-STRESS/MODULUS))
    gone = np.clip((time - 0.2)/0.4, 0.0, 1.0)
    assert u[0] == pytest.approx(0.0, abs=1e-9*abs(whole))
    assert u == pytest.approx(gone*whole, abs=1e-3*abs(whole))
    assert ((gone > 0.1) & (gone < 0.9)).sum() >= 5 and u[-1] == pytest.approx(whole, rel=1e-6)


def test_the_answer_is_that_of_letting_go_at_once(core):
    at_once, fading = (ends(bar(r)) for r in (0.0, 0.4))
    assert at_once[0, 1] == pytest.approx(at_once[-1, 1], rel=1e-9)
    assert fading[-1, 1] == pytest.approx(at_once[-1, 1], rel=1e-9)


def test_the_step_ends_in_balance(core):
    late = ends(bar(5.0))
    assert late[-1, 1] == pytest.approx(ends(bar(0.0))[-1, 1], rel=1e-9)
