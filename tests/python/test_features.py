"""Pairs of small decks against exact answers: both ways, gaps at the start, soft contact."""
import math

import numpy as np
import pytest
from pytest import approx

from feature_scene import E, H, K, Scene, W, bar, two_blocks

# Bilateral pairs
# ------------------------------------------------------------------------------------------

def test_no_separation_pulls_and_slides(go):
    s = two_blocks(behavior="*SURFACE BEHAVIOR, NO SEPARATION")
    s.add("*BOUNDARY\nLOW_BOTTOM, 2\n1, 1")
    s.step("*BOUNDARY\nUP_TOP, 2, 2, 0.01\nUP_LEFT, 1, 1, 0.05")
    r = go(s)
    assert r.code == 0, r.output
    force = E*W*0.01/(2*H)
    assert r.summary["contact"][0]["force"] == approx([0.0, -force], abs=1e-10*force)
    assert r.contact()["CPRESS"] == approx(-force/W, rel=1e-10)
    assert r.contact()["COPEN"] == approx(0.0, abs=1e-15)
    assert r.contact()["u_t"][:, 0] == approx(0.05, rel=1e-3)


def test_no_separation_waits_until_it_has_touched(go):
    s = bar(0.01, "*SURFACE BEHAVIOR, NO SEPARATION")
    s.step("*CLOAD\n1, 2, -10.\n3, 2, -20.\n5, 2, -10.")
    s.step("*CLOAD\n1, 2, 10.\n3, 2, 20.\n5, 2, 10.")
    r = go(s)
    assert r.code == 0, r.output
    h = r.history
    assert h["FLOOR.rf2"] == approx([40 - K*0.01, -(40 + K*0.01)], rel=1e-10)


@pytest.mark.parametrize("words, behavior",
                         [("TIED", ""), ("", "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TIED")])
@pytest.mark.parametrize("mesh", [(2, 2), (3, 3)])
def test_tied_blocks_stretch_as_one(go, words, behavior, mesh):
    s = two_blocks(*mesh, behavior, words)
    s.add("*BOUNDARY\nLOW_BOTTOM, 2\n1, 1")
    s.step("*BOUNDARY\nUP_TOP, 2, 2, 0.02")
    r = go(s)
    assert r.code == 0, r.output
    assert r.field("S")[:, 1] == approx(E*0.01, rel=1e-6)
    assert np.abs(r.field("S")[:, [0, 3]]).max() < 1e-6*E*0.01
    assert r.summary["contact"][0]["force"] == approx([0.0, -E*0.01*W], rel=1e-10, abs=1e-10)


def test_tied_blocks_shear_as_one(go):
    s = two_blocks(2, 2, words="TIED")
    g = 0.01
    lines = []
    for label, (x, y) in s.nodes.items():
        if (x in (0.0, W) or y in (0.0, 2*H)) and not (label > 6 and y == H):
            lines += [f"{label}, 1, 1, {float(g*y)!r}", f"{label}, 2, 2, 0."]
    s.step("*BOUNDARY\n" + "\n".join(lines))
    r = go(s)
    assert r.code == 0, r.output
    shear = E/2.6*g
    assert r.field("S")[:, 3] == approx(shear, rel=1e-6)
    for label, (x, y) in s.nodes.items():
        assert r.u(label)[:2] == approx([g*y, 0.0], abs=1e-9)


def test_tied_to_a_tool_follows_it(go):
    s = bar(words="TIED")
    s.head[s.head.index("B, 1"):s.head.index("B, 1") + 1] = ["B_TOP, 1"]
    s.head.remove("FLOOR_REF, 1, 2")
    s.step("*BOUNDARY\nFLOOR_REF, 1, 1, 0.02\nFLOOR_REF, 2, 2, 0.01")
    r = go(s)
    assert r.code == 0, r.output
    for label in (1, 3, 5):
        assert r.u(label)[:2] == approx([0.02, 0.01], rel=1e-6)
    assert r.history["FLOOR.rf2"][0] == approx(K*0.01, rel=1e-10)
    assert r.history["FLOOR.rf1"][0] == approx(K/2*0.02, rel=1e-10)


# Initial gaps
# ---------------------------------------------------------------------------------------------

def test_clearance_replaces_the_gap_of_the_mesh(go):
    s = bar(0.3, extra="*CLEARANCE, SLAVE=B_BOTTOM, MASTER=FLOOR, VALUE=0.1", load=400.0)
    r = go(s)
    assert r.code == 0, r.output
    assert r.history["FLOOR.rf2"][0] == approx(400 - K*0.1, rel=1e-10)


@pytest.mark.parametrize("adjust, reaction", [("0.05", 40.0), ("0.01", 0.0), ("YES", 0.0),
                                              ("B_BOTTOM", 40.0)])
def test_adjust_closes_gaps_without_strain(go, adjust, reaction):
    r = go(bar(0.02, words=f"ADJUST={adjust}", load=40.0))
    assert r.code == 0, r.output
    # The rest of the gap: F/k = 0.02 exactly grazes.
    assert r.history["FLOOR.rf2"][0] == approx(reaction, abs=1e-9)
    assert ("N0316" in r.ids()) == (reaction > 0)


def test_tiny_overclosure_is_adjusted_with_a_note(go):
    r = go(bar(-0.9e-3, load=40.0))
    assert r.code == 0, r.output
    assert "N0316" in r.ids() and "W0311" not in r.ids()
    assert r.history["FLOOR.rf2"][0] == approx(40.0, rel=1e-10)


def test_touching_exactly_says_nothing(go):
    r = go(bar(0.0, load=40.0))
    assert r.code == 0 and r.ids() == []


@pytest.mark.parametrize("method", ["", "*SURFACE BEHAVIOR, AUGMENTED LAGRANGE"])
def test_interference_is_ramped_in_with_a_warning(go, method):
    delta, one, two = 0.02, E*W/H, E*W/H
    s = two_blocks(3, 3, method, gap=-delta, poisson=0.0)
    s.add("*BOUNDARY\nLOW, 1\nUP, 1\nLOW_BOTTOM, 2\nUP_TOP, 2")
    s.step("", "0.25, 1.", ", DIRECT")
    r = go(s)
    assert r.code == 0, r.output
    force = delta/(1/one + 1/two)
    assert r.history["UP_BOTTOM-LOW_TOP.force2"] == approx(force*np.array([0.25, 0.5, 0.75, 1.0]),
                                                           rel=1e-9)
    assert "W0311" in r.ids() and "node" in r.message("W0311")
    assert r.history["certificate"] == approx(0.0)


def test_overclosure_that_is_meant_warns_no_more(go):
    r = go(bar(-0.02, extra="*CONTACT CONTROLS, INITIAL=INTERFERENCE", load=0.0))
    assert r.code == 0, r.output
    assert "W0311" not in r.ids()
    assert r.history["FLOOR.rf2"][0] == approx(K*0.02, rel=1e-10)


@pytest.mark.parametrize("gap, words", [(-0.6, "INITIAL=AUTO"), (-0.02, "INITIAL=ERROR")])
def test_deep_or_unwanted_overclosure_is_refused(go, gap, words):
    r = go(bar(gap, extra=f"*CONTACT CONTROLS, {words}" if "ERROR" in words else "", load=40.0))
    assert r.code == 1 and "E0311" in r.output


def test_initial_adjust_removes_overclosure(go):
    r = go(bar(-0.02, extra="*CONTACT CONTROLS, INITIAL=ADJUST", load=40.0))
    assert r.code == 0 and r.history["FLOOR.rf2"][0] == approx(40.0, rel=1e-10)


# Soft contact
# ---------------------------------------------------------------------------------------------

def overclosure_of(law, load, gap):
    """Overclosure where law(overclosure)*W balances what the block leaves of the load."""
    low, high = -gap - 1.0, 1.0
    for _ in range(200):
        mid = 0.5*(low + high)
        low, high = (mid, high) if law(mid)*W < load - K*(mid + gap) else (low, mid)
    return mid


def exponential(c0, p0):
    return lambda d: 0.0 if d <= -c0 else p0/(math.e - 1)*(d/c0 + 1)*(math.exp(d/c0 + 1) - 1)


def table(rows):
    p, d = zip(*rows)

    def law(x):
        if x <= d[0]:
            return 0.0
        i = max(1, min(len(d) - 1, int(np.searchsorted(d, x))))
        return p[i - 1] + (p[i] - p[i - 1])/(d[i] - d[i - 1])*(x - d[i - 1])
    return law


SOFT = {
    "linear": ("PRESSURE-OVERCLOSURE=LINEAR\n5000.", lambda d: max(0.0, 5000.0*d)),
    "penalty": ("PENALTY\n5000., 0.002, 2.", lambda d: max(0.0, 1e4*(d + 0.002))),
    "exponential": ("PRESSURE-OVERCLOSURE=EXPONENTIAL\n0.004, 10.", exponential(0.004, 10.0)),
    "hardening table": ("PRESSURE-OVERCLOSURE=TABULAR\n0., -0.002\n5., 0.\n30., 0.001",
                        table([(0, -0.002), (5, 0), (30, 0.001)])),
    "softening table": ("PRESSURE-OVERCLOSURE=TABULAR\n0., 0.\n20., 0.0005\n25., 0.02",
                        table([(0, 0), (20, 0.0005), (25, 0.02)])),
}


@pytest.mark.parametrize("name", SOFT)
@pytest.mark.parametrize("gap", [0.0, 0.003, 0.1])
def test_soft_contact_balances_one_spring(go, name, gap):
    behavior, law = SOFT[name]
    load = 60.0
    r = go(bar(gap, f"*SURFACE BEHAVIOR, {behavior}", load=load))
    assert r.code == 0, r.output
    d = overclosure_of(law, load, gap)
    assert r.history["FLOOR.rf2"][0] == approx(law(d)*W, rel=1e-9, abs=1e-9)
    assert r.contact()["COPEN"] == approx(-d, rel=1e-9, abs=1e-12)
    assert list(r.contact()["CSTATUS"]) == [2 if law(d) > 0 else 0]*3


@pytest.mark.parametrize("name", SOFT)
def test_soft_contact_holds_a_free_block(go, name):
    behavior, law = SOFT[name]
    load, s = 40.0, Scene(E)
    s.block("B", (0, 0), (W, H), (2, 1))
    s.tool("FLOOR", (0, -1), [(-3, -0.01), (5, -0.01)])
    s.pair("B_BOTTOM", "FLOOR", f"*SURFACE BEHAVIOR, {behavior}")
    s.add("*BOUNDARY\nB_LEFT, 1\nFLOOR_REF, 1, 2\nFLOOR_REF, 6")
    s.step(f"*DSLOAD\nB_TOP, P, {load/W}")
    r = go(s)
    assert r.code == 0, r.output
    assert r.history["FLOOR.rf2"][0] == approx(load, rel=1e-9)
    gap = np.ravel(r.contact()["COPEN"])
    assert [law(-float(g)) for g in gap] == approx([load/W]*3, rel=1e-4)


def test_a_law_closes_only_where_it_presses(go):
    behavior, law = SOFT["exponential"]
    s = Scene(E)
    s.block("B", (0, 0), (W, H), (2, 1))
    s.tool("FLOOR", (0, -1), [(-3, -0.01), (0.5, -0.01), (0.9, -0.2), (5, -0.2)])
    s.pair("B_BOTTOM", "FLOOR", f"*SURFACE BEHAVIOR, {behavior}")
    s.add("*BOUNDARY\nB, 1\nFLOOR_REF, 1, 2\nFLOOR_REF, 6")
    s.step("*DSLOAD\nB_TOP, P, 5.")
    r = go(s)
    assert r.code == 0, r.output
    assert list(np.ravel(r.contact()["CSTATUS"])) == [2, 0, 0]
    assert r.history["FLOOR.rf2"][0] == approx(10.0, rel=1e-9)


def test_augmentation_stops_at_the_tolerance(go):
    s = bar(0.0, "*SURFACE BEHAVIOR, AUGMENTED LAGRANGE\n1000.",
            extra="*CONTACT CONTROLS, RELATIVE PENETRATION TOLERANCE=0.005", load=40.0)
    r = go(s)
    assert r.code == 0, r.output
    n = int(r.history["augmentations"][0])
    depth = r.history["B_BOTTOM-FLOOR.max_penetration"][0]
    # k = a: the penetration halves with every pass, from F/(k + a) on; a facet is 1 long.
    assert depth == approx(40.0/(2*K)*0.5**(n - 1), rel=1e-9) and 0.0025 <= depth <= 0.005
    assert r.summary["certificate"]["penetration"] == approx(depth, rel=1e-9)


def test_too_few_augmentations_end_the_run(go):
    s = bar(0.0, "*SURFACE BEHAVIOR, AUGMENTED LAGRANGE\n10.",
            extra="*CONTACT CONTROLS, MAX AUGMENTATIONS=3", load=40.0)
    r = go(s)
    assert r.code == 3 and "E0502" in r.output


@pytest.mark.parametrize("behavior", ["PENALTY\n1e6", "AUGMENTED LAGRANGE\n1e7", "DIRECT",
                                      "PRESSURE-OVERCLOSURE=EXPONENTIAL\n0.004, 10."])
def test_continuation_gives_the_same_answer(go, behavior):
    answers = []
    for card in ("", "*LOPIN, CONTINUATION=4"):
        s = bar(0.01, f"*SURFACE BEHAVIOR, {behavior}", load=60.0)
        if card:
            s.head.insert(2, card)
        r = go(s)
        assert r.code == 0, r.output
        answers.append(r.history["FLOOR.rf2"][0])
    assert answers[1] == approx(answers[0], rel=1e-9)


@pytest.mark.parametrize("target", [0.1, 0.01, 0.001])
def test_automatic_penalty_meets_its_target(go, target):
    s = bar(0.01, "*SURFACE BEHAVIOR, PENALTY", load=60.0)
    s.head.insert(2, f"*LOPIN, TARGET ERROR={target}")
    r = go(s)
    exact = 60.0 - K*0.01
    error = abs(r.history["FLOOR.rf2"][0] - exact)/exact
    assert 0.02*target < error <= target*(1 + 1e-9)
    assert r.summary["certificate"]["pressure_error"] == approx(error, rel=0.2)
    assert "N0317" in r.ids()
