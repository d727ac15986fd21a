"""Advice that would be false is held back, and its due neighbour is still given."""
import pytest
from test_advice import pressed, said, two_blocks
from test_advice_symmetry import billet
from test_advice_symmetry import pressed as mirrored
from test_needless_finite_path import held_beam, told
from tool_patches import Lines

from lopin.accuracy.increments import depends_on_path
from lopin.deck import Deck
from lopin.mesh_make import block


def line(first, last):
    return "*SURFACE, NAME=T, TYPE=SEGMENTS", f"START, {first}, 0.", f"LINE, {last}, 0."


@pytest.mark.parametrize("first, last, due", [(-6.0, 6.0, True), (-6.0, 30.0, False),
                                              (-30.0, 4.0, False), (-60.0, 60.0, True)])
def test_a_flat_tool_must_end_alike_on_both_sides(first, last, due):
    assert bool(said(mirrored(tool=line(first, last)), "N0364")) == due


def punches(last, more="", right="-0.1"):
    """A block pressed by two flat punches on one line; `more`: a second step."""
    lines = Lines()
    lines.add("*HEADING", "punches", "*MATERIAL, NAME=M", "*ELASTIC", "1000., 0.3")
    lines.mesh(block((8.0, 2.0), (32, 8)).moved(-4.0, 0.0), "CPE4", "B")
    lines.add("*SOLID SECTION, ELSET=BE, MATERIAL=M")
    for name, side in (("L", -1), ("R", 1)):
        lines.node += 1
        ends = sorted((side, 3*side), reverse=True)
        columns = range(16) if side < 0 else range(16, 32)
        lines.add(f"*ELSET, ELSET={name}E", *(f"{1 + 224 + i}," for i in columns),
                  f"*SURFACE, NAME={name}S", f"{name}E, S3",
                  f"*NODE, NSET=P{name}\n{lines.node}, {2*side}., 9.",
                  f"*SURFACE, NAME=T{name}, TYPE=SEGMENTS", f"START, {ends[0]}., 2.",
                  f"LINE, {ends[1]}., 2.",
                  f"*RIGID BODY, ANALYTICAL SURFACE=T{name}, REF NODE={lines.node}")
    lines.add("*SURFACE INTERACTION, NAME=I", "*CONTACT PAIR, INTERACTION=I", "LS, TL", "RS, TR",
              "*BOUNDARY", "BBOTTOM, 1, 2", "PL, 1", "PL, 6", "PR, 1", "PR, 6", "*STEP", "*STATIC",
              *last.split("|"), "*END STEP")
    if more:
        lines.add("*STEP", "*STATIC", *more.split("|"), "*END STEP")
    return Deck.parse("\n".join(lines.text) + "\n", name="punches")


ALIKE = "*BOUNDARY|PL, 2, 2, -0.1|PR, 2, 2, -0.1"
AWAY = "*MODEL CHANGE, TYPE=CONTACT PAIR, REMOVE|"


@pytest.mark.parametrize("last, more, due", [
    (ALIKE, "", True), ("*BOUNDARY|PL, 2, 2, -0.1|PR, 2, 2, -0.05", "", False),
    ("*CLOAD|PL, 2, -100.|PR, 2, -100.", "", True),
    ("*CLOAD|PL, 2, -100.|PR, 2, -10.", "", False),
    ("*CLOAD|PL, 2, -100.|*BOUNDARY|PR, 2, 2, -0.1", "", False),
    (ALIKE, AWAY + "LS, TL", False), (ALIKE, AWAY + "LS, TL|RS, TR", True)])
def test_punches_on_one_line_are_two(last, more, due):
    """Moved, loaded and taken away alike, or not."""
    assert bool(said(punches(last, more), "N0364")) == due


def profile(first, last):
    return ("*SURFACE, NAME=T, TYPE=CYLINDER", "0., 0., 0., 1., 0., 0.", "0., 1., 0.",
            f"START, {first}., 0.", f"LINE, {last}., 0.")


@pytest.mark.parametrize("first, last, due", [(2, -2, False), (9, 0, False), (30, -30, True)])
def test_a_strip_is_not_of_revolution(first, last, due):
    assert bool(said(billet("full", tool=profile(first, last)), "N0365")) == due


def slab(layers=2, slant=0.0, ball=False, soft=False, load=""):
    """A slab pressed on a rigid plane or ball, all of its nodes held across the section."""
    lines = Lines()
    mesh = block((20.0, 2.0, 14.0), (20, layers, 12))
    mesh.points[:, 2] *= 1.0 - slant*mesh.points[:, 1]/2.0
    lines.add("*HEADING", "slab", "*MATERIAL, NAME=M", "*ELASTIC", "1000., 0.3")
    lines.mesh(mesh, "C3D8", "B")
    middle = mesh.points[mesh.blocks[0][1]].mean(axis=1)
    first = lines.node
    lines.node += 1
    lines.add("*SOLID SECTION, ELSET=BE, MATERIAL=M", f"*NSET, NSET=ALL, GENERATE\n1, {first}, 1",
              f"*NODE, NSET=P\n{lines.node}, 0., 0., 0.")
    if soft:
        front = [1 + i for i in range(len(middle)) if middle[i, 1] < 1.0]
        lines.add("*MATERIAL, NAME=N", "*ELASTIC", "100., 0.3", "*ELSET, ELSET=F",
                  *(f"{i}," for i in front), "*SOLID SECTION, ELSET=F, MATERIAL=N")
    if ball:
        lines.add("*SURFACE, NAME=T, TYPE=REVOLUTION", "10., 1., 0., 10., 1., 1.",
                  "START, 0., 0.", "CIRCL, 30., -30., 0., -30.")
    else:
        lines.add(*profile(30, -30))
    lines.add(f"*RIGID BODY, ANALYTICAL SURFACE=T, REF NODE={lines.node}",
              "*SURFACE INTERACTION, NAME=I", "*CONTACT PAIR, INTERACTION=I", "BSBOTTOM, T",
              "*BOUNDARY", "BTOP, 3, 3, -0.1", "BLEFT, 1", "ALL, 2", "P, 1, 6", "*STEP", "*STATIC",
              *load.split("|"), "*END STEP")
    return Deck.parse("\n".join(r for r in lines.text if r) + "\n", name="slab")


@pytest.mark.parametrize("changes, due", [
    ({}, True), ({"layers": 1}, True), ({"layers": 3}, True),
    ({"load": "*DLOAD|BE, BX, 1."}, True), ({"load": "*DLOAD|5, BX, 1."}, False),
    ({"load": "*DSLOAD|BSRIGHT, P, 1."}, True), ({"load": "*DLOAD|20, P4, 1."}, False),
    ({"load": "*BOUNDARY|30, 1"}, False), ({"load": "*CLOAD|30, 1, 1."}, False),
    ({"load": "*BOUNDARY|P, 2, 2, 1."}, False), ({"slant": 0.1}, False), ({"ball": True}, False),
    ({"soft": True}, False)])
def test_nothing_may_vary_along_plane_strain(changes, due):
    assert bool(said(slab(**changes), "N0361")) == due


def held(deck, old, new):
    text = deck.text()
    assert old in text
    return Deck.parse(text.replace(old, new), name="held")


def test_a_master_that_bends_is_not_rigid():
    deck = two_blocks(500.0)
    assert not said(held(deck, "TBOTTOM, 1, 2", "TLEFT, 1, 2"), "N0362")
    assert said(held(deck, "TBOTTOM, 1, 2", "TBOTTOM, 1, 1\nTBOTTOM, 2, 2, 0.1"), "N0362")
    # Soft behind its skin.
    skin = "*ELSET, ELSET=SKIN, GENERATE\n381, 440, 1\n*ELSET, ELSET=FOAM, GENERATE\n201, 380, 1\n" \
        "*MATERIAL, NAME=F\n*ELASTIC\n10., 0.3\n*SOLID SECTION, ELSET=FOAM, MATERIAL=F\n" \
        "*SURFACE INTERACTION, NAME=I"
    assert not said(held(deck, "*SURFACE INTERACTION, NAME=I", skin), "N0362")


def on_plate(wide=10.0, hole=False):
    """A block of 8 x 8 on a rigid plate of facets."""
    lines = Lines()
    lines.add("*HEADING", "plate", "*MATERIAL, NAME=M", "*ELASTIC", "1000., 0.3")
    lines.mesh(block((8.0, 8.0, 2.0), (4, 4, 2)).moved(-4.0, -4.0, 0.0), "C3D8", "B")
    lines.mesh(block((2*wide, 2*wide, 1.0), (10, 10, 1)).moved(-wide, -wide, -1.0), "C3D8", "P")
    lines.node += 1
    lines.add("*SOLID SECTION, ELSET=BE, MATERIAL=M", f"*NODE, NSET=R\n{lines.node}, 0., 0., -3.",
              f"*RIGID BODY, ELSET=PE, REF NODE={lines.node}", "*ELSET, ELSET=UP",
              *(f"{33 + i}," for i in range(100) if not (hole and i in (44, 45, 54, 55))),
              "*SURFACE, NAME=UPS", "UP, S2", "*SURFACE INTERACTION, NAME=I",
              "*CONTACT PAIR, INTERACTION=I", "BSBOTTOM, UPS", "*BOUNDARY", "R, 1, 6", "BTOP, 1, 2",
              "BTOP, 3, 3, -0.1", "*STEP", "*STATIC", "*END STEP")
    return Deck.parse("\n".join(lines.text) + "\n", name="plate")


@pytest.mark.parametrize("changes, due", [({}, True), ({"hole": True}, False),
                                          ({"wide": 3.0}, False)])
def test_a_plate_that_ends_under_the_block_is_no_plane(changes, due):
    notes = said(on_plate(**changes), "N0366")
    assert bool(notes) == due and all("a plane" in n["message"] for n in notes)


@pytest.mark.parametrize("down, due", [(0.5, False), (0.005, True)])
def test_a_finite_path_there_and_back(down, due, solve):
    """A beam that is bent in the middle of the step, and straight again at its end."""
    deck = held(Deck.parse(held_beam(down), name="beam"), "*STATIC\n*BOUNDARY\n",
                "*STATIC\n0.25, 1., 1e-5, 0.25\n*BOUNDARY, AMPLITUDE=A\n")
    deck = held(deck, "*STEP", "*AMPLITUDE, NAME=A\n0., 0., 0.5, 1., 1., 0.\n*STEP")
    assert bool(told(solve(deck))) == due


def test_no_separation_remembers():
    deck = pressed(False, static="0.1, 1.")
    kept = held(deck, "*SURFACE INTERACTION, NAME=I",
                "*SURFACE INTERACTION, NAME=I\n*SURFACE BEHAVIOR, NO SEPARATION, DIRECT")
    assert said(deck, "N0363") and not said(kept, "N0363")
    assert depends_on_path(kept) and not depends_on_path(deck)
