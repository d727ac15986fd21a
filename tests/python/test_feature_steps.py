"""Steps of small decks against exact answers, and what their ends say."""

import numpy as np
import pytest
from pytest import approx

from feature_scene import E, H, Scene, W, bar, two_blocks

# Steps
# ----------------------------------------------------------------------------------------------------

def test_supports_that_change_cost_one_more_factor(go):
    s = bar(0.01)
    s.step("*CLOAD\n1, 2, -10.\n3, 2, -20.\n5, 2, -10.", "0.5, 1.", ", DIRECT")
    s.step("", "0.5, 1.", ", DIRECT")
    s.step("*BOUNDARY, OP=NEW\nB, 1\nB_TOP, 2\n3, 2\nFLOOR_REF, 1, 2\nFLOOR_REF, 6\n"
           "*CLOAD, OP=NEW", "0.5, 1.", ", DIRECT")
    s.step("*BOUNDARY, OP=NEW\nB, 1\nB_TOP, 2\nFLOOR_REF, 1, 2\nFLOOR_REF, 6", "0.5, 1.",
           ", DIRECT")
    r = go(s)
    assert r.code == 0, r.output
    assert [step["factorisations"] for step in r.summary["steps"]] == [1, 0, 1, 1]
    # Step 3 holds the middle node at zero... where it is prescribed to; step 4 lets it go: nothing
    # is left.
    assert r.history["energy.strain"][-1] == approx(0.0, abs=1e-20)
    assert r.history["FLOOR.rf2"][-1] == 0.0


@pytest.mark.parametrize("driven", ["force", "tool"])
def test_loading_and_unloading_leaves_nothing(go, driven):
    s = Scene(E, 0.3)
    s.block("B", (0, 0), (4.0, 2.0), (8, 4))
    s.tool("PUNCH", (2.0, 5.0), [(3.0, 4.0), (2.6, 2.6), (2.0, 2.1), (1.4, 2.6), (1.0, 4.0)])
    s.pair("B_TOP", "PUNCH")
    s.add("*AMPLITUDE, NAME=TENT\n0., 0., 0.5, 1., 1., 0.")
    s.add("*BOUNDARY\nB_BOTTOM, 1, 2\nPUNCH_REF, 1\nPUNCH_REF, 6")
    if driven == "tool":
        s.step("*BOUNDARY, AMPLITUDE=TENT\nPUNCH_REF, 2, 2, -0.3", "0.125, 1.", ", DIRECT")
    else:
        s.step("*BOUNDARY\nPUNCH_REF, 2\n*DSLOAD, AMPLITUDE=TENT\nB_RIGHT, P, 300.", "0.125, 1.",
               ", DIRECT")
    r = go(s)
    assert r.code == 0, r.output
    h = r.history
    energy = h["energy.strain"]
    assert energy[3] > 0 and energy[-1] <= 1e-24*energy[3]
    assert energy[4] == approx(energy[2], rel=1e-10) and energy[5] == approx(energy[1], rel=1e-10)
    assert h["closed" if "closed" in h else "B_TOP-PUNCH.closed"][-1] == 0


def test_amplitude_step_is_at_once(go):
    s = bar(0.0)
    s.step("*CLOAD\n3, 2, -40.", "0.25, 1.", ", DIRECT", ", AMPLITUDE=STEP")
    r = go(s)
    assert r.history["FLOOR.rf2"] == approx([40.0]*4, rel=1e-10)


def test_a_second_step_goes_on_from_the_first(go):
    s = bar(0.0)
    s.step("*CLOAD\n3, 2, -40.", "0.5, 1.", ", DIRECT")
    s.step("*CLOAD\n3, 2, -80.\n1, 2, -8.", "0.5, 1.", ", DIRECT")
    s.step("*CLOAD, OP=NEW\n3, 2, -20.", "0.5, 1.", ", DIRECT")
    r = go(s)
    assert r.history["FLOOR.rf2"] == approx([20, 40, 64, 88, 54, 20], rel=1e-10)


def test_a_load_with_amplitude_hands_over_what_it_was(go):
    """A load that followed an amplitude and is then given without one goes on from its last
    value."""
    s = bar(0.0)
    s.add("*AMPLITUDE, NAME=UP\n0., 0., 1., 0.5")
    s.step("*CLOAD, AMPLITUDE=UP\n3, 2, -80.", "0.5, 1.", ", DIRECT")
    s.step("*CLOAD\n3, 2, -80.", "0.5, 1.", ", DIRECT")
    s.step("*CLOAD, OP=NEW, AMPLITUDE=UP\n3, 2, -80.", "0.5, 1.", ", DIRECT")
    s.step("*CLOAD, OP=NEW", "0.5, 1.", ", DIRECT")
    r = go(s)
    # Step 3: the load given again is 80 N times the amplitude; nothing is left of the old one.
    assert r.history["FLOOR.rf2"] == approx([20, 40, 60, 80, 20, 40, 20, 0], rel=1e-10, abs=1e-10)


def test_many_increments_are_one(go):
    ends = []
    for first in ("1., 1.", "0.5, 1.", "0.1, 1."):
        s = two_blocks(5, 3, gap=0.02)
        s.add("*BOUNDARY\nLOW_BOTTOM, 1, 2\nUP_TOP, 1")
        s.step("*BOUNDARY\nUP_TOP, 2, 2, -0.06", first, ", DIRECT")
        r = go(s)
        assert r.code == 0, r.output
        ends.append([r.history[k][-1] for k in r.history if "energy.strain" in k or "force2" in k])
    assert ends[1] == approx(ends[0], rel=1e-8) and ends[2] == approx(ends[0], rel=1e-8)


def test_a_far_pair_adds_nothing(go):
    answers = []
    for far in (False, True):
        s = bar(0.01, load=60.0) if not far else bar(0.01)
        if far:
            s.tool("FAR", (0, -90), [(-3, -80), (5, -80)])
            s.pair("B_BOTTOM", "FAR")
            s.add("*BOUNDARY\nFAR_REF, 1, 2\nFAR_REF, 6")
            s.step("*CLOAD\n1, 2, -15.\n3, 2, -30.\n5, 2, -15.")
        r = go(s)
        answers.append((r.history["FLOOR.rf2"][0], r.history["energy.strain"][0],
                        r.history["iterations"][0]))
    assert answers[0] == answers[1]
    assert "W0314" in r.ids() and "FAR" in r.message("W0314") and "79.9" in r.message("W0314")


def test_double_pass_is_solved_with_a_warning(go):
    s = two_blocks(3, 4, poisson=0.3)
    s.pair("LOW_TOP", "UP_BOTTOM")
    s.add("*BOUNDARY\nLOW_BOTTOM, 2\n1, 1\nUP_LEFT, 1")
    s.step("*DSLOAD\nUP_TOP, P, 5.", "0.25, 1.", ", DIRECT")
    r = go(s)
    assert r.code == 0, r.output
    assert r.ids().count("W0403") == 1
    total = r.history["UP_BOTTOM-LOW_TOP.force2"] - r.history["LOW_TOP-UP_BOTTOM.force2"]
    assert total == approx(5.0*W*np.array([0.25, 0.5, 0.75, 1.0]), rel=1e-9)
    assert r.field("S")[:, 1] == approx(-5.0, rel=1e-5)


def test_nothing_opposite_warns(go):
    s = bar(0.01, load=10.0)
    s.tool("ASIDE", (99, 0), [(90, -1), (95, -1)])
    at = next(i for i, line in enumerate(s.head) if line.startswith("*STEP"))
    tail, s.head = s.head[at:], s.head[:at]
    s.pair("B_BOTTOM", "ASIDE")
    s.add("*BOUNDARY\nASIDE_REF, 1, 2\nASIDE_REF, 6")
    s.head += tail
    r = go(s)
    assert r.code == 0 and "W0315" in r.ids(), r.output


# What the end of a step says
# ------------------------------------------------------------------------------

def test_sliding_far_is_told(go):
    def run(extra):
        s = two_blocks(3, 3, shift=0.1)
        s.head = [line.replace("*CONTACT PAIR", "*CONTACT PAIR" + extra) for line in s.head]
        s.add("*BOUNDARY\nLOW_BOTTOM, 1, 2\nUP_TOP, 2, 2, -0.001")
        s.step("*BOUNDARY\nUP_TOP, 1, 1, 0.3\nUP_LEFT, 1, 1, 0.3\nUP_TOP, 2, 2, -0.01", "0.5, 1.",
               ", DIRECT")
        return go(s)

    r = run(", SMALL SLIDING")
    assert r.ids().count("W0505") == 1, r.output
    assert "45 %" in r.message("W0505") and "W0506" not in r.ids()
    # Where the deck does not ask for small sliding, the path changes and follows the slave.
    r = run("")
    assert "W0505" not in r.ids() and "path finite" in r.output and "quarter of its facet" in r.output


def test_turning_far_is_told(go):
    s = Scene(E)
    s.block("B", (0, 0), (W, H), (2, 1))
    s.step("*BOUNDARY\n1, 1, 2\n5, 2, 2, 0.2")
    r = go(s)
    assert r.code == 0 and r.ids() == ["W0506"], r.output
    assert "0.1 rad" in r.message("W0506")


def test_straining_far_is_told(go):
    s = Scene(E)
    s.block("B", (0, 0), (W, H), (2, 1))
    s.step("*BOUNDARY\nB, 1\nB_BOTTOM, 2\nB_TOP, 2, 2, 0.06")
    r = go(s)
    assert r.code == 0 and r.ids() == ["W0507"], r.output
    assert "element" in r.message("W0507") and "6 %" in r.message("W0507")
    s = Scene(E)
    s.block("B", (0, 0), (W, H), (2, 1))
    s.step("*BOUNDARY\nB, 1\nB_BOTTOM, 2\nB_TOP, 2, 2, 0.04")
    assert go(s).ids() == []


@pytest.mark.parametrize("held, told", [("B, 1\nB_BOTTOM, 2", "6 %"), ("1, 1, 2", "0.1 rad")],
                         ids=["strain", "rotation"])
def test_what_goes_too_far_and_comes_back_is_told(go, held, told):
    """The end of the step is free of it: the increments between are looked at, said once."""
    s = Scene(E)
    s.block("B", (0, 0), (W, H), (2, 1))
    s.add("*AMPLITUDE, NAME=A\n0., 0., 0.5, 1., 1., 0.")
    moved = "B_TOP, 2, 2, 0.06" if "B" in held else "5, 2, 2, 0.2"
    s.step(f"*BOUNDARY\n{held}\n*BOUNDARY, AMPLITUDE=A\n{moved}", "0.25, 1.", ", DIRECT")
    s.step(f"*BOUNDARY\n{held}")
    r = go(s)
    assert r.code == 0 and len(r.ids()) == 1, r.output
    assert told in r.message("W0507" if "%" in told else "W0506")
    assert np.abs(r.history["energy.strain"][-1]) < 1e-12


def test_a_rigid_motion_to_the_touch_is_no_trouble(go):
    """All forces are rounding: nothing may be judged beside them."""
    s = two_blocks(4, 3, gap=0.02)
    s.add("*BOUNDARY\nLOW_BOTTOM, 1, 2\nUP_TOP, 1")
    s.step("*BOUNDARY\nUP_TOP, 2, 2, -0.02", "0.1, 1.", ", DIRECT")
    r = go(s)
    assert r.code == 0 and r.history["certificate"].max() == 0, r.output
    assert np.abs(r.history["UP_BOTTOM-LOW_TOP.force2"]).max() < 1e-12
    assert r.history["iterations"].max() <= 4


@pytest.mark.parametrize("unit, force", [(1e-3, 1.0), (1.0, 1e9), (1.0, 1e-9), (25.4, 4.448)])
def test_units_change_nothing(go, unit, force):
    """Benchmark F18: the same numbers without dimension, the same counts (a thickness of 1
    throughout)."""
    def scene(unit, force):
        s = Scene(E*force/unit**2, 0.3)
        s.block("LOW", (0, 0), (3*unit, unit), (6, 2))
        s.block("UP", (unit, 1.02*unit), (2*unit, 2*unit), (3, 2))
        s.pair("UP_BOTTOM", "LOW_TOP", "*SURFACE BEHAVIOR, AUGMENTED LAGRANGE")
        s.add("*BOUNDARY\nLOW_BOTTOM, 1, 2\nUP_TOP, 1")
        s.step(f"*BOUNDARY\nUP_TOP, 2, 2, {-0.05*unit!r}", "0.5, 1.", ", DIRECT")
        return go(s)
    one, other = scene(1.0, 1.0), scene(unit, force)
    assert other.code == 0, other.output
    a, b = one.history, other.history
    assert b["UP_BOTTOM-LOW_TOP.force2"]/(force/unit) == approx(a["UP_BOTTOM-LOW_TOP.force2"],
                                                                rel=1e-10)
    assert b["energy.strain"]/force == approx(a["energy.strain"], rel=1e-10)
    assert list(a["iterations"]) == list(b["iterations"])
    assert list(a["augmentations"]) == list(b["augmentations"])
    assert other.summary["certificate"]["penetration"] == approx(
        one.summary["certificate"]["penetration"], abs=1e-10)
