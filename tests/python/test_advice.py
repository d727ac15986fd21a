"""Advice on decks that model more than their scene needs: given where it is due, and true."""
import numpy as np
import pytest
from tool_patches import Lines

import lopin
from lopin.deck import Deck
from lopin.mesh_make import block


def said(deck, code):
    return [n for n in lopin.check(deck) if n["code"] == code]


def pressed(solid, cells=(20, 14), static="", hold=True, nlgeom="", plastic=False, friction=False):
    """A block pressed in its middle on a rigid plane, in the plane or one layer deep in space."""
    size = (20.0, 14.0)
    lines = Lines()
    lines.add("*HEADING", "twin", "*MATERIAL, NAME=M", "*ELASTIC", "1000., 0.3")
    if plastic:
        lines.add("*PLASTIC", "5., 0.", "8., 1.")
    mesh = block(size, cells) if not solid else block((20.0, 1.0, 14.0), (cells[0], 1, cells[1]))
    lines.mesh(mesh, "C3D8" if solid else "CPE4", "B")
    lines.node += 1
    along, up = ("3", 2) if not solid else ("3", 3)
    origin = "0., 0." if not solid else "0., 0., 0."
    lines.add("*SOLID SECTION, ELSET=BE, MATERIAL=M", f"*NODE, NSET=P\n{lines.node}, {origin}")
    if solid:
        lines.add("*SURFACE, NAME=T, TYPE=CYLINDER", "0., 0., 0., 1., 0., 0.", "0., 1., 0.",
                  "START, 30., 0.", "LINE, -30., 0.")
    else:
        lines.add("*SURFACE, NAME=T, TYPE=SEGMENTS", "START, -30., 0.", "LINE, 30., 0.")
    lines.add(f"*RIGID BODY, ANALYTICAL SURFACE=T, REF NODE={lines.node}",
              "*SURFACE INTERACTION, NAME=I")
    if friction:
        lines.add("*FRICTION", "0.1")
    lines.add("*CONTACT PAIR, INTERACTION=I", "BSBOTTOM, T", "*BOUNDARY",
              f"BTOP, {up}, {up}, -0.1", "BLEFT, 1")
    if solid:
        lines.add("BFRONT, 2", *(["BBACK, 2"] if hold else []), "P, 1, 6")
    else:
        lines.add("P, 1, 2", "P, 6")
    lines.add(f"*STEP{nlgeom}", "*STATIC", *([static] if static else []), "*END STEP")
    text = "\n".join(lines.text) + "\n"
    return Deck.parse(text, name="twin")


def test_plane_strain_in_space_is_told():
    assert said(pressed(True), "N0361")
    assert not said(pressed(True, hold=False), "N0361")
    assert not said(pressed(False), "N0361")


def test_the_plane_deck_has_the_same_answer(solve):
    solid, plane = solve(pressed(True)), solve(pressed(False))
    forces = [np.abs(np.sum(r.contact(0).last.force, axis=0)).max() for r in (solid, plane)]
    assert np.isclose(*forces, rtol=1e-9)
    assert plane.summary["equations"] < 0.6*solid.summary["equations"]


@pytest.mark.parametrize("changes, due", [
    ({"static": "0.1, 1."}, True), ({"static": "0.1, 1., 1e-5, 0.1"}, True), ({}, False),
    ({"static": "1., 1."}, False), ({"static": "0.1, 1.", "nlgeom": ", NLGEOM"}, False),
    ({"static": "0.1, 1.", "plastic": True}, False),
    ({"static": "0.1, 1.", "friction": True}, False)])
def test_increments_that_change_nothing(changes, due):
    assert bool(said(pressed(False, **changes), "N0363")) == due


def test_one_increment_has_the_same_end(solve):
    many, one = solve(pressed(False, static="0.1, 1.")), solve(pressed(False))
    assert len(many.history["time"]) > 3 and len(one.history["time"]) == 1
    assert np.allclose(many["U"], one["U"], rtol=1e-9, atol=1e-12)


def two_blocks(ratio, master_cells=(20, 12)):
    lines = Lines()
    lines.add("*HEADING", "two", "*MATERIAL, NAME=SOFT", "*ELASTIC", "1000., 0.3",
              "*MATERIAL, NAME=STIFF", "*ELASTIC", f"{1000.0*ratio!r}, 0.3")
    lines.mesh(block((10.0, 5.0), (20, 10)), "CPE4", "B")
    lines.mesh(block((20.0, 8.0), master_cells).moved(-5.0, -8.0), "CPE4", "T")
    lines.add("*SOLID SECTION, ELSET=BE, MATERIAL=SOFT", "*SOLID SECTION, ELSET=TE, MATERIAL=STIFF",
              "*SURFACE INTERACTION, NAME=I", "*CONTACT PAIR, INTERACTION=I", "BSBOTTOM, TSTOP",
              "*BOUNDARY", "BTOP, 2, 2, -0.1", "BLEFT, 1", "TBOTTOM, 1, 2", "*STEP", "*STATIC",
              "*END STEP")
    return Deck.parse("\n".join(lines.text) + "\n", name="two")


@pytest.mark.parametrize("ratio, cells, due", [(500.0, (20, 12), True), (50.0, (20, 12), False),
                                               (1.0, (20, 12), False), (500.0, (4, 2), False)])
def test_a_master_that_is_all_but_rigid(ratio, cells, due):
    found = said(two_blocks(ratio, cells), "N0362")
    assert bool(found) == due
    if due:
        assert "500 times" in found[0]["message"] and "240 of 440" in found[0]["help"]


def test_the_rigid_master_has_nearly_the_same_answer(solve):
    """The advice says by how much the approach changes: a stiffer one still shows it."""
    soft, stiff = solve(two_blocks(500.0)), solve(two_blocks(5e6))
    forces = [np.sum(r.contact(0).last.force, axis=0)[1] for r in (soft, stiff)]
    assert abs(forces[1]/forces[0] - 1.0) < 2.0/500.0


NODES = ", TYPE=NODE TO SURFACE"


def rounded_block(lower, upper, kind=""):
    """A block of so many cells on a rounded one of so many, both elastic."""
    lines = Lines()
    lines.add("*HEADING", "rounded", "*MATERIAL, NAME=M", "*ELASTIC", "1000., 0.3")
    lines.mesh(block((10.0, 6.0), (lower, 3*lower//5)).moved(0.0, -6.0), "CPE4", "A")
    mesh = block((10.0, 6.0), (upper, 3*upper//5))
    x, y = mesh.points[:, 0], mesh.points[:, 1].copy()
    mesh.points[:, 1] = y + x**2/40.0*(1.0 - y/6.0)
    lines.mesh(mesh, "CPE4", "B")
    lines.add("*SOLID SECTION, ELSET=AE, MATERIAL=M", "*SOLID SECTION, ELSET=BE, MATERIAL=M",
              "*SURFACE INTERACTION, NAME=I", "*CONTACT PAIR, INTERACTION=I" + kind,
              "ASTOP, BSBOTTOM", "*BOUNDARY", "ALEFT, 1", "BLEFT, 1", "ABOTTOM, 2", "BTOP, 2, 2, -0.3", "*STEP",
              "*STATIC", "*END STEP")
    return Deck.parse("\n".join(lines.text) + "\n", name="rounded")


@pytest.mark.parametrize("lower, upper, due, kind", [
    (64, 16, "small", ""), (40, 16, "", ""), (16, 16, "", ""), (20, 24, "", NODES),
    (12, 24, "large", NODES), (12, 24, "", ""), (6, 24, "large", "")])
def test_slaves_much_finer_or_coarser_than_their_masters(lower, upper, due, kind):
    """Surface to surface, which a pair that says nothing is here, may be twice as coarse."""
    notes = said(rounded_block(lower, upper, kind), "N0367")
    assert len(notes) == bool(due) and all(f"times as {due} as" in n["message"] for n in notes)


def test_a_coarse_slave_misses_force_that_its_exchange_has(solve):
    """As the advice says: 12 facets on 24 are 5 % off at the nodes where 24 on 12 are within 1.5,
    and within .5 % where the deck leaves it open."""
    forces = [np.abs(np.sum(solve(deck).contact(0).last.force, axis=0)).max() for deck in (
        rounded_block(12, 24, NODES), exchanged(rounded_block(12, 24, NODES)),
        rounded_block(12, 24), rounded_block(48, 48))]
    errors = np.abs(np.array(forces[:3])/forces[3] - 1.0)
    assert errors[0] > 0.03 and errors[1] < 0.02 and errors[2] < 0.005


def exchanged(deck):
    return Deck.parse(deck.text().replace("ASTOP, BSBOTTOM", "BSBOTTOM, ASTOP"), name="exchanged")
