"""Constraints, tools and supports of small decks against exact answers."""
import math

import numpy as np
import pytest
from pytest import approx

from feature_scene import E, H, K, Scene, W, bar, two_blocks

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
