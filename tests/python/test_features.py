"""Features of the solver against answers that are exact, one small deck each."""
import math

import numpy as np
import pytest
from pytest import approx

from feature_scene import Scene, run

pytest.importorskip("lopin")

E, W, H = 1000.0, 2.0, 1.0
K = E*W/H                                  # stiffness of a block without Poisson's effect


@pytest.fixture
def go(executable, tmp_path):
    count = iter(range(1000))
    return lambda scene: run(executable, tmp_path/f"run{next(count)}", scene)


def bar(gap=0.0, behavior="", words="", extra="", load=None, **step):
    """A block over a fixed tool, held at its top edge's spring side: the bottom row moves freely in
    y.

    The top is fixed; forces on the bottom row push it down onto the floor at a distance `gap`.
    """
    s = Scene(E)
    s.block("B", (0, 0), (W, H), (2, 1))
    s.tool("FLOOR", (0, -1), [(-3, -gap), (5, -gap)])
    s.pair("B_BOTTOM", "FLOOR", behavior, words)
    s.add("*BOUNDARY\nB, 1\nB_TOP, 2\nFLOOR_REF, 1, 2\nFLOOR_REF, 6")
    if extra:
        s.add(extra)
    if load is not None:
        s.step(f"*CLOAD\n1, 2, {-load/4}\n3, 2, {-load/2}\n5, 2, {-load/4}", **step)
    return s


def two_blocks(low=2, up=2, behavior="", words="", gap=0.0, poisson=0.3, shift=0.0, extra=""):
    s = Scene(E, poisson)
    s.block("LOW", (0, 0), (W, H), (low, 1))
    s.block("UP", (shift, H + gap), (W + shift, 2*H + gap), (up, 1))
    s.pair("UP_BOTTOM", "LOW_TOP", behavior, words)
    if extra:
        s.add(extra)
    return s


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


# Constraints
# ----------------------------------------------------------------------------------------------

def test_pulley(go):
    """u(left) + u(right) = 0 over a pulley: each bar stretches by what the other shortens."""
    s = Scene(E)
    s.block("A", (0, 0), (W, H), (1, 1))
    s.block("B", (5, 0), (5 + W, 2*H), (1, 1))
    s.add("*BOUNDARY\nA, 1\nB, 1\nA_BOTTOM, 2\nB_BOTTOM, 2")
    s.add("*EQUATION\n2\n2, 2, 1., 6, 2, 1.\n2\n4, 2, 1., 6, 2, 1.\n2\n8, 2, 1., 6, 2, -1.")
    s.step("*CLOAD\n2, 2, 30.")
    r = go(s)
    assert r.code == 0, r.output
    stretch = 30.0/(K + K/2)
    assert r.u(2)[1] == approx(stretch, rel=1e-6) and r.u(8)[1] == approx(-stretch, rel=1e-6)
    assert r.history["energy.strain"][0] == approx(0.5*30.0*stretch, rel=1e-10)


def press(turn, transform):
    """A block pressed on a floor, all of it turned; supports in local axes."""
    s = Scene(E, 0.3)
    s.block("B", (0, 0), (W, H), (4, 2), turn=turn)
    c, n = math.cos(turn), math.sin(turn)
    s.tool("FLOOR", (c, n), [(-3*c + 0.05*n, -3*n - 0.05*c), (5*c + 0.05*n, 5*n - 0.05*c)])
    s.pair("B_BOTTOM", "FLOOR")
    s.add("*BOUNDARY\nFLOOR_REF, 1, 2\nFLOOR_REF, 6")
    if transform:
        s.add(f"*TRANSFORM, NSET=B\n{c!r}, {n!r}, 0., {-n!r}, {c!r}, 0.")
    s.step("*BOUNDARY\nB_TOP, 2, 2, -0.1\nB_LEFT, 1\n*CLOAD\nB_RIGHT, 1, 7.", "0.5, 1.", ", DIRECT")
    return s


def test_a_turned_block_on_local_supports_is_the_same_block(go):
    flat, turned = go(press(0.0, False)), go(press(math.radians(37.0), True))
    assert flat.code == turned.code == 0, turned.output
    a, b = flat.history, turned.history
    assert b["energy.strain"] == approx(a["energy.strain"], rel=1e-10)
    assert b["energy.external"] == approx(a["energy.external"], rel=1e-10)
    size = np.hypot(b["B_BOTTOM-FLOOR.force1"], b["B_BOTTOM-FLOOR.force2"])
    assert size == approx(a["B_BOTTOM-FLOOR.force2"], rel=1e-10)
    assert b["B_BOTTOM-FLOOR.max_pressure"] == approx(a["B_BOTTOM-FLOOR.max_pressure"], rel=1e-10)
    assert list(a["iterations"]) == list(b["iterations"])


@pytest.mark.parametrize("local", [None, "row", "reference"])
@pytest.mark.parametrize("rotation_node", [False, True])
def test_rigid_row_of_nodes_carries_force_and_moment_to_its_reference(go, local, rotation_node):
    s = Scene(E)
    s.block("B", (0, 0), (W, H), (2, 1))
    ref = s.node((3.0, 2.0), "REF")
    words, turn = "", "REF, 6"
    if rotation_node:
        s.node((9.0, 9.0), "ROT")
        words, turn = ", ROT NODE=ROT", "ROT, 3"
    s.add(f"*RIGID BODY, NSET=B_TOP, REF NODE=REF{words}")
    s.add("*BOUNDARY\nB_BOTTOM, 1, 2")
    c, n = math.cos(0.3), math.sin(0.3)
    move = (0.01, -0.02)
    if local:
        s.add(f"*TRANSFORM, NSET={'REF' if local == 'reference' else 'B_TOP'}\n{c!r}, {n!r}, 0., {-n!r}, {c!r}, 0.")
    if local == "reference":
        move = (c*move[0] + n*move[1], -n*move[0] + c*move[1])
    first = turn.split(",")
    s.step(f"*BOUNDARY\nREF, 1, 1, {move[0]!r}\nREF, 2, 2, {move[1]!r}\n{first[0]}, {first[1]}, {first[1]}, 0.003")
    s.add("")
    r = go(s)
    assert r.code == 0, r.output
    # u = u_ref + theta x (x - x_ref)
    for label, x in ((2, 0.0), (4, 1.0), (6, 2.0)):
        assert r.u(label)[:2] == approx([0.01 - 0.003*(H - 2.0), -0.02 + 0.003*(x - 3.0)], rel=1e-5)
    rf = r.field("RF")
    below = rf[[0, 2, 4]].astype(float)
    assert rf[ref - 1][:2] == approx(-below[:, :2].sum(axis=0), rel=1e-5)
    # Moments about the reference vanish in sum: what the supports make, the reference takes.
    name = next(k for k in r.history if k.endswith(".rf1")).rpartition(".")[0]
    moment = r.history.get(f"{name}.rm3", r.history.get(f"{name}.rf6"))
    arms = np.array([s.nodes[k] for k in (1, 3, 5)]) - (3.0, 2.0)
    assert moment is not None, list(r.history)
    assert moment[0] == approx(-(arms[:, 0]*below[:, 1] - arms[:, 1]*below[:, 0]).sum(), rel=1e-5)


# Tools
# ----------------------------------------------------------------------------------------------------

def punch(how):
    s = Scene(E, 0.3)
    s.block("B", (0, 0), (4.0, 2.0), (8, 4))
    s.tool("PUNCH", (2.0, 5.0), [(3.0, 4.0), (2.6, 2.6), (2.0, 2.0), (1.4, 2.6), (1.0, 4.0)])
    s.pair("B_TOP", "PUNCH")
    s.add("*BOUNDARY\nB_BOTTOM, 1, 2\nPUNCH_REF, 1\nPUNCH_REF, 6")
    s.step(how)
    return s


def test_driven_by_force_or_by_displacement_is_the_same(go):
    one = go(punch("*BOUNDARY\nPUNCH_REF, 2, 2, -0.2"))
    assert one.code == 0, one.output
    force = one.history["PUNCH.rf2"][0]
    assert force < 0 and one.history["PUNCH.u2"][0] == approx(-0.2)
    two = go(punch(f"*CLOAD\nPUNCH_REF, 2, {float(force)!r}"))
    assert two.code == 0, two.output
    # The corner of the punch slides over no node, so that small sliding is the same in both.
    assert two.history["PUNCH.u2"][0] == approx(-0.2, rel=1e-8)
    assert two.history["B_TOP-PUNCH.force2"][0] == approx(one.history["B_TOP-PUNCH.force2"][0],
                                                          rel=1e-9)


@pytest.mark.parametrize("flat", [True])
def test_flat_punch_by_force_and_by_displacement_to_the_last_digit(go, flat):
    def scene(how):
        s = Scene(E, 0.3)
        s.block("B", (0, 0), (4.0, 2.0), (8, 4))
        s.tool("PUNCH", (2.0, 5.0), [(5.0, 2.1), (-1.0, 2.1)])
        s.pair("B_TOP", "PUNCH")
        s.add("*BOUNDARY\nB_BOTTOM, 1, 2\nPUNCH_REF, 1\nPUNCH_REF, 6")
        s.step(how, "0.5, 1.", ", DIRECT")
        return s
    one = go(scene("*BOUNDARY\nPUNCH_REF, 2, 2, -0.2"))
    two = go(scene(f"*CLOAD\nPUNCH_REF, 2, {float(one.history['PUNCH.rf2'][-1])!r}"))
    assert two.code == 0, two.output
    assert two.history["PUNCH.u2"][-1] == approx(-0.2, rel=1e-10)
    assert two.history["energy.strain"][-1] == approx(one.history["energy.strain"][-1], rel=1e-10)


@pytest.mark.parametrize("reference", [(1.0, 0.0), (-4.0, 0.0), (1.0, -7.0)])
def test_a_turning_plane_is_a_cam(go, reference):
    """Floor y = 0 turned by t about the reference: its height over x is (x - x_ref) tan t there."""
    t = 0.01
    s = Scene(E)
    s.block("B", (0, 0), (W, H), (2, 1))
    s.tool("FLOOR", reference, [(-9, 0), (9, 0)])
    s.pair("B_BOTTOM", "FLOOR")
    s.add("*BOUNDARY\nB, 1\nB_TOP, 2\nFLOOR_REF, 1, 2")
    s.step(f"*BOUNDARY\nFLOOR_REF, 6, 6, {t}", "0.25, 1.", ", DIRECT")
    r = go(s)
    assert r.code == 0, r.output
    for label, x in ((1, 0.0), (3, 1.0), (5, 2.0)):
        y = reference[1]
        exact = (x - reference[0])*math.tan(t) + y - y/math.cos(t)
        got = r.u(label)[1]
        if exact > 0 or reference[0] < 0:
            assert got == approx(exact, abs=1e-6)
    assert np.ravel(r.contact()["COPEN"]).min() > -1e-12


def test_a_turning_plane_slides_the_block_sideways(go):
    """On a free side the turned normal also pushes along x: equations that the flat normal never
    touched."""
    t, s = 0.1, Scene(E)
    s.block("B", (0, 0), (W, H), (2, 1))
    s.tool("FLOOR", (1.0, 0.0), [(-9, 0), (9, 0)])
    s.pair("B_BOTTOM", "FLOOR")
    s.add("*BOUNDARY\nB_TOP, 1, 2\nFLOOR_REF, 1, 2")
    s.step(f"*BOUNDARY\nFLOOR_REF, 6, 6, {t}")
    r = go(s)
    assert r.code == 0, r.output
    h = r.history
    force = np.array([h["B_BOTTOM-FLOOR.force1"][0], h["B_BOTTOM-FLOOR.force2"][0]])
    assert force[0]/force[1] == approx(-math.tan(t), rel=1e-9)
    # The supports take exactly this, sideways too.
    top = r.field("RF")[[1, 3, 5]].astype(float).sum(axis=0)[:2]
    assert top == approx(-force, rel=1e-5)


def test_concave_corner_splits_the_force(go):
    """Benchmark F8: F = (3, 4) into a right corner gives R = (3, 4) by two rows on one node."""
    s = Scene(E)
    s.block("B", (0, 0), (1, 1), (1, 1))
    s.tool("CORNER", (4.0, 4.0), [(1, -3), (1, 1), (-3, 1)])
    s.add("*SURFACE, NAME=TIP, TYPE=NODE\n4,")
    s.pair("TIP", "CORNER")
    s.add("*BOUNDARY\n1, 1, 2\nCORNER_REF, 1, 2\nCORNER_REF, 6")
    s.add("*BOUNDARY\n2, 1, 2\n3, 1, 2")
    s.step("*CLOAD\n4, 1, 3.\n4, 2, 4.")
    r = go(s)
    assert r.code == 0, r.output
    assert [r.history["CORNER.rf1"][0], r.history["CORNER.rf2"][0]] == approx([-3.0, -4.0],
                                                                              rel=1e-10)
    assert np.abs(r.u(4)[:2]).max() < 1e-12


def test_one_surface_against_two_tools(go):
    s = Scene(E)
    s.block("B", (0, 0), (1, 1), (1, 1))
    s.tool("WALL", (4.0, 4.0), [(1, -3), (1, 3)])
    s.tool("ROOF", (4.0, 4.0), [(3, 1), (-3, 1)])
    s.add("*SURFACE, NAME=TIP, TYPE=NODE\n4,")
    s.pair("TIP", "WALL")
    s.pair("TIP", "ROOF")
    s.add("*BOUNDARY\n1, 1, 2\n2, 1, 2\n3, 1, 2\nWALL_REF, 1, 2\nWALL_REF, 6\nROOF_REF, 1, 2\nROOF_REF, 6")
    s.step("*CLOAD\n4, 1, 3.\n4, 2, 4.")
    r = go(s)
    assert r.code == 0, r.output
    assert [r.history["WALL.rf1"][0], r.history["ROOF.rf2"][0]] == approx([-3.0, -4.0], rel=1e-10)


def test_a_tool_that_comes_with_a_concave_corner(go):
    """The corner starts far from the node and arrives with the tool: both walls must then push."""
    s = Scene(E)
    s.block("B", (0, 0), (1, 1), (1, 1))
    s.tool("CORNER", (9.0, 9.0), [(6, -9), (6, 6), (-9, 6)])
    s.add("*SURFACE, NAME=SIDES\n1, S2\n1, S3")
    s.pair("SIDES", "CORNER")
    s.add("*BOUNDARY\n1, 1, 2\n2, 1\n3, 2\nCORNER_REF, 6")
    s.step("*BOUNDARY\nCORNER_REF, 1, 1, -5.02\nCORNER_REF, 2, 2, -5.01", "0.5, 1.", ", DIRECT")
    r = go(s)
    assert r.code == 0, r.output
    assert r.u(4)[:2] == approx([-0.02, -0.01], rel=1e-5)
    # Every wall takes what the block needs to be as wide and as high as it now is.
    assert [r.history["CORNER.rf1"][-1], r.history["CORNER.rf2"][-1]] == approx([-20.0, -10.0],
                                                                                rel=1e-9)


def test_two_methods_in_one_deck(go):
    s = Scene(E)
    s.block("A", (0, 0), (W, H), (2, 1))
    s.block("B", (5, 0), (5 + W, H), (2, 1))
    s.tool("FLOOR", (0, -1), [(-3, -0.01), (9, -0.01)])
    s.pair("A_BOTTOM", "FLOOR", "*SURFACE BEHAVIOR, PENALTY\n5000.")
    s.pair("B_BOTTOM", "FLOOR")
    s.add("*BOUNDARY\nA, 1\nB, 1\nA_TOP, 2\nB_TOP, 2\nFLOOR_REF, 1, 2\nFLOOR_REF, 6")
    s.step("*DSLOAD\nA_BOTTOM, P, -30.\nB_BOTTOM, P, -30.")
    r = go(s)
    h = r.history
    exact = 60.0 - K*0.01
    assert h["B_BOTTOM-FLOOR.force2"][0] == approx(exact, rel=1e-10)
    assert h["A_BOTTOM-FLOOR.force2"][0] == approx(exact*5000*W/(5000*W + K), rel=1e-10)
    assert r.code in (0, 3)


# Supports and contact on one node
# -------------------------------------------------------------------------

def test_slave_node_on_a_symmetry_plane_with_a_slanted_tool(go):
    """The row loses its fixed component: n_y R = F for the free one, n_x R goes to the support."""
    s = Scene(E)
    s.block("B", (0, 0), (1, 1), (1, 1))
    s.tool("RAMP", (0, -5), [(-4, 2), (4, -2)])
    s.add("*SURFACE, NAME=TIP, TYPE=NODE\n1,")
    s.pair("TIP", "RAMP")
    s.add("*BOUNDARY\nB_LEFT, 1\n3, 1, 2\n2, 2\n4, 1, 2\nRAMP_REF, 1, 2\nRAMP_REF, 6")
    s.step("*CLOAD\n1, 2, -8.")
    r = go(s)
    assert r.code == 0, r.output
    assert [r.history["RAMP.rf1"][0], r.history["RAMP.rf2"][0]] == approx([4.0, 8.0], rel=1e-10)
    assert r.field("RF")[0][0] == approx(-4.0, rel=1e-5)


def test_slave_node_that_cannot_move_at_all(go):
    """Contact along a fixed direction: harmless while open, said while it is not."""
    s = bar(0.0, load=40.0)
    s.add("")
    at = s.head.index("B_TOP, 2")
    s.head.insert(at, "1, 2")
    r = go(s)
    assert r.code == 0, r.output
    assert r.history["FLOOR.rf2"][0] + r.field("RF")[0][1] == approx(40.0, rel=1e-6)


def test_tie_support_and_contact_on_the_same_nodes(go):
    """Benchmark F15: the supports carry, the redundant rows are counted, nothing is said to be
    open."""
    s = two_blocks(2, 2, words="TIED")
    s.tool("FLOOR", (0, -9), [(-3, 0), (5, 0)])
    s.pair("LOW_BOTTOM", "FLOOR")
    s.add("*BOUNDARY\nFLOOR_REF, 1, 2\nFLOOR_REF, 6\nLOW_BOTTOM, 2\nLOW_LEFT, 1\nUP_LEFT, 1")
    s.step("*DSLOAD\nUP_TOP, P, 5.")
    r = go(s)
    assert r.code == 0 and r.ids() == ["W0409"], r.output
    assert "node 1 of pair (LOW_BOTTOM, FLOOR)" in r.message("W0409") and "(and 2 more)" in r.message("W0409")
    assert r.history["UP_BOTTOM-LOW_TOP.force2"][0] == approx(10.0, rel=1e-10)
    assert r.field("S")[:12, 1] == approx(-5.0, rel=1e-6)


def test_a_tool_cannot_be_driven_through_what_is_fixed(go):
    """No dof can close the penetration: the run must not call that finished."""
    s = Scene(E)
    s.block("B", (0, 0), (W, H), (2, 1))
    s.tool("FLOOR", (0, -1), [(-3, 0), (5, 0)])
    s.pair("B_BOTTOM", "FLOOR")
    s.add("*BOUNDARY\nB, 1, 2\nFLOOR_REF, 1\nFLOOR_REF, 6")
    s.step("*BOUNDARY\nFLOOR_REF, 2, 2, 0.05")
    r = go(s)
    assert r.code == 3 and "complementarity" in r.output and "W0409" in r.ids()
    assert "E0506" in r.output and "node 1 of pair (B_BOTTOM, FLOOR)" in r.output and "by 0.05" in r.output


def test_a_tied_node_that_another_pair_holds_as_well_is_named(go):
    """The lower face of the upper block is tied to the lower block and touches the same face
    again."""
    s = two_blocks(2, 2, words="TIED")
    s.add("*SURFACE INTERACTION, NAME=AGAIN\n*SURFACE BEHAVIOR, DIRECT\n"
          "*CONTACT PAIR, INTERACTION=AGAIN, TYPE=NODE TO SURFACE\nUP_SAME, LOW_TOP")
    s.add("*SURFACE, NAME=UP_SAME\nUP, S1")
    s.add("*BOUNDARY\nLOW_BOTTOM, 2\nLOW_LEFT, 1\nUP_LEFT, 1")
    s.step("*DSLOAD\nUP_TOP, P, 5.")
    r = go(s)
    assert r.code == 0 and r.ids().count("W0409") == 1 and "W0403" not in r.ids(), r.output
    assert "is tied by pair (UP_BOTTOM, LOW_TOP) and touches by pair (UP_SAME, LOW_TOP)" in r.message("W0409")
    assert r.field("S")[:, 1] == approx(-5.0, rel=1e-6)


def test_slave_node_on_two_symmetry_planes_in_3d(go):
    s = Scene(E)
    s.block("B", (0, 0, 0), (1, 1, 1), (2, 2, 2))
    ref = s.node((0, 0, -1), "REF")
    s.add("*SURFACE, NAME=FLOOR, TYPE=CYLINDER\n0.,0.,0., 1.,0.,0.\n0.,0.,1.\nSTART, -3., 0.\nLINE, 3., 0."
          if False else "")
    s.head += ["*NODE, NSET=G", "9001, -5., -5., -0.01", "9002, 5., -5., -0.01",
               "9003, 5., 5., -0.01", "9004, -5., 5., -0.01", "*ELEMENT, TYPE=R3D4, ELSET=GROUND",
               "9001, 9001, 9002, 9003, 9004",
               "*SURFACE, NAME=FLOOR", "GROUND, SPOS", "*RIGID BODY, ELSET=GROUND, REF NODE=REF"]
    s.pair("B_BACK", "FLOOR")
    s.add("*BOUNDARY\nB_LEFT, 1\nB_BOTTOM, 2\nREF, 1, 6")
    s.step("*DSLOAD\nB_FRONT, P, 5.")
    r = go(s)
    assert r.code == 0, r.output
    pair = "B_BACK-FLOOR"
    assert r.history[f"{pair}.force3"][0] == approx(5.0, rel=1e-10)
    assert np.ravel(r.contact()["CPRESS"]) == approx(5.0, rel=1e-6)
    assert ref > 0 and r.u(1)[2] == approx(-0.01, rel=1e-6)


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
    # Step 3: the old 80 N goes down in a ramp while the amplitude starts again from zero.
    assert r.history["FLOOR.rf2"] == approx([20, 40, 60, 80, 60, 40, 20, 0], rel=1e-10, abs=1e-10)


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
