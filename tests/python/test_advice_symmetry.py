"""Advice on planes of symmetry and axes that a mesh does not use: due ones, none that is not, and
the answer is what the advice says."""
from pathlib import Path

import numpy as np
import pytest
from tool_patches import Lines

import lopin
from lopin.deck import Deck
from lopin.mesh_make import block, cylinder

PLANE = ("*SURFACE, NAME=T, TYPE=SEGMENTS", "START, -30., 0.", "LINE, 30., 0.")


def said(deck, code):
    return [n for n in lopin.check(deck) if n["code"] == code]


def pressed(part="full", nlgeom=True, extra=(), tool=PLANE, middle=0.0, more=()):
    """A block of twice 10 x 8 whose clamped top goes down on a rigid line; the right half of it."""
    lines = Lines()
    mesh = block((20.0, 8.0), (24, 10)).moved(-10.0 + middle, 0.0) if part == "full" else \
        block((10.0, 8.0), (12, 10))
    lines.add("*HEADING", "pressed", "*MATERIAL, NAME=M", "*ELASTIC", "1000., 0.3")
    lines.mesh(mesh, "CPE4", "B")
    lines.node += 1
    lines.add("*SOLID SECTION, ELSET=BE, MATERIAL=M", f"*NODE, NSET=P\n{lines.node}, 0., 0.", *tool,
              f"*RIGID BODY, ANALYTICAL SURFACE=T, REF NODE={lines.node}", *more,
              "*SURFACE INTERACTION, NAME=I", "*FRICTION", "0.1", "*CONTACT PAIR, INTERACTION=I",
              "BSBOTTOM, T", "*BOUNDARY", "BTOP, 1", "BTOP, 2, 2, -0.4", "P, 1, 2", "P, 6")
    if part != "full":
        lines.add("BLEFT, 1")
    lines.add(f"*STEP{', NLGEOM' if nlgeom else ''}", "*STATIC", *extra, "*END STEP")
    return Deck.parse("\n".join(lines.text) + "\n", name="pressed")


def test_a_plane_of_symmetry_is_told():
    [note] = said(pressed(), "N0364")
    assert "x = 0" in note["message"] and "120 of 240" in note["help"]
    [note] = said(pressed(middle=3.0), "N0364")
    assert "x = 3" in note["message"]


@pytest.mark.parametrize("changes", [
    {"part": "half"},
    {"extra": ("*CLOAD", "40, 1, 1.")},
    {"extra": ("*CLOAD", "1, 2, -1.")},
    {"extra": ("*DLOAD", "1, P4, 1.")},
    {"extra": ("*DLOAD", "BE, BX, 1.")},
    {"extra": ("*BOUNDARY", "1, 1")},
    {"extra": ("*BOUNDARY", "BTOP, 1, 1, 0.1")},
    {"tool": ("*SURFACE, NAME=T, TYPE=SEGMENTS", "START, -30., -1.", "LINE, 30., 1.")},
    {"tool": ("*SURFACE, NAME=T, TYPE=SEGMENTS", "START, -30., 0.", "LINE, 5., 0.",
              "LINE, 30., -9.")},
    {"more": ("*MATERIAL, NAME=N", "*ELASTIC", "900., 0.3", "*ELSET, ELSET=ONE", "7,",
              "*SOLID SECTION, ELSET=ONE, MATERIAL=N")},
    {"more": ("*SPRING, ELSET=SP", "1, 1", "10.", "*ELEMENT, TYPE=SPRING1, ELSET=SP", "9001, 1")}])
def test_what_is_not_symmetric_is_not_told(changes):
    assert not said(pressed(**changes), "N0364")


@pytest.mark.parametrize("changes", [
    {"extra": ("*DLOAD", "BE, BY, -0.1")}, {"extra": ("*CLOAD", "BTOP, 2, -1.")},
    {"tool": ("*SURFACE, NAME=T, TYPE=SEGMENTS", "START, -30., -9.", "LINE, -5., 0.",
              "LINE, 5., 0.", "LINE, 30., -9.")}])
def test_what_is_symmetric_is_told(changes):
    assert said(pressed(**changes), "N0364")


def test_the_half_has_the_same_answer(solve):
    whole, half = solve(pressed()), solve(pressed("half"))
    forces = [np.sum(r.contact(0).last.force, axis=0)[1] for r in (whole, half)]
    assert np.isclose(forces[0], 2.0*forces[1], rtol=1e-6)   # of files in single precision
    assert half.summary["equations"] < 0.55*whole.summary["equations"]


def between(lower=("START, -30., -4.", "LINE, 30., -4."), way=0.2, meshed=False, friction=0.1):
    """A block between two rigid dies, or elastic ones (6 x 2 cells each) that are moved."""
    lines = Lines()
    lines.add("*HEADING", "between", "*MATERIAL, NAME=M", "*ELASTIC", "1000., 0.3")
    lines.mesh(block((10.0, 8.0), (16, 16)).moved(0.0, -4.0), "CPE4", "B")
    names = [("U", 4.0, -0.2), ("L", -4.0, way)]
    sections = ["BE"]
    if meshed:
        for name, at, _ in names:
            lines.mesh(block((14.0, 3.0), (24, 4)).moved(0.0, at - (3.0 if name == "L" else 0.0)),
                       "CPE4", name)
            sections.append(f"{name}E")
    lines.add(*(f"*SOLID SECTION, ELSET={s}, MATERIAL=M" for s in sections))
    lines.add("*SURFACE INTERACTION, NAME=I", "*FRICTION", "0.1", "*SURFACE INTERACTION, NAME=J",
              "*FRICTION", f"{friction}")
    move = []
    shapes = (("START, 30., 4.", "LINE, -30., 4."), lower)
    laws = "II" if friction == 0.1 else "IJ"
    for (name, _, down), shape, face, law in zip(names, shapes, ("TOP", "BOTTOM"), laws):
        if meshed:
            other = "BOTTOM" if name == "U" else "TOP"
            lines.add(f"*CONTACT PAIR, INTERACTION={law}", f"BS{face}, {name}S{other}")
            move += [f"{name}{face}, 2, 2, {down}", f"{name}LEFT, 1"]
            continue
        lines.node += 1
        lines.add(f"*NODE, NSET=P{name}\n{lines.node}, 0., 0.",
                  f"*SURFACE, NAME=T{name}, TYPE=SEGMENTS", *shape,
                  f"*RIGID BODY, ANALYTICAL SURFACE=T{name}, REF NODE={lines.node}",
                  f"*CONTACT PAIR, INTERACTION={law}", f"BS{face}, T{name}")
        move += [f"P{name}, 1", f"P{name}, 2, 2, {down}", f"P{name}, 6"]
    lines.add("*BOUNDARY", "BLEFT, 1", *move, "*STEP", "*STATIC", "*END STEP")
    return Deck.parse("\n".join(lines.text) + "\n", name="between")


@pytest.mark.parametrize("changes, due", [
    ({}, True), ({"meshed": True}, True), ({"way": 0.1}, False), ({"way": -0.2}, False),
    ({"lower": ("START, -30., -4.5", "LINE, 30., -3.5")}, False), ({"friction": 0.2}, False),
    ({"meshed": True, "way": 0.1}, False), ({"meshed": True, "friction": 0.2}, False)])
def test_two_dies_may_be_images_of_each_other(changes, due):
    """Rigid or meshed, with their pairs and ways."""
    told = said(between(**changes), "N0364")
    assert bool(told) == due
    assert not due or "y = 0" in told[0]["message"]


def billet(part="quarter", layers=6, extra=(), friction=0.1, solid="C3D8", shape=None, tool=None,
           hold=True):
    """A quarter, half or whole billet of a round section pressed on a rigid plane."""
    lines = Lines()
    mesh = shape if shape is not None else cylinder(10.0, 12.0, (4, layers), part=part)
    lines.add("*HEADING", "billet", "*MATERIAL, NAME=M", "*ELASTIC", "1000., 0.3")
    lines.mesh(mesh, solid, "B")
    lines.node += 1
    lines.add("*SOLID SECTION, ELSET=BE, MATERIAL=M", f"*NODE, NSET=P\n{lines.node}, 0., 0., 0.",
              *(tool or ("*SURFACE, NAME=T, TYPE=CYLINDER", "0., 0., 0., 1., 0., 0.", "0., 1., 0.",
                         "START, 30., 0.", "LINE, -30., 0.")),
              f"*RIGID BODY, ANALYTICAL SURFACE=T, REF NODE={lines.node}",
              "*SURFACE INTERACTION, NAME=I", "*FRICTION", f"{friction}",
              "*CONTACT PAIR, INTERACTION=I", "BSBOTTOM, T", "*BOUNDARY", "BTOP, 3, 3, -0.2",
              "P, 1, 6")
    if hold and part == "quarter":
        lines.add("BBACK, 2", "BLEFT, 1")
    if part == "full":
        lines.add("BTOP, 1, 2")
    lines.add("*STEP", "*STATIC", *extra, "*END STEP")
    return Deck.parse("\n".join(lines.text) + "\n", name="billet")


def test_a_billet_of_revolution_is_told():
    [note] = said(billet(), "N0365")
    assert "about the z axis through 0, 0, 0" in note["message"] and "48 elements" in note["help"]
    assert said(billet("full"), "N0365")
    # What is of revolution has planes of symmetry too: one line is enough.
    assert not said(billet("full"), "N0364")


@pytest.mark.parametrize("changes", [
    {"hold": False}, {"shape": block((10.0, 10.0, 12.0), (6, 6, 6)).moved(0.0, -10.0, 0.0)},
    {"extra": ("*CLOAD", "20, 3, -1.")}, {"extra": ("*BOUNDARY", "BBOTTOM, 1")},
    {"extra": ("*BOUNDARY", "30, 3")}, {"extra": ("*DLOAD", "1, P1, 1.")},
    {"tool": ("*SURFACE, NAME=T, TYPE=CYLINDER", "0., 0., 0., 1., 0., 0.", "0., 1., 0.",
              "START, 30., -1.", "LINE, -30., 1.")}])
def test_what_is_not_of_revolution_is_not_told(changes):
    assert not said(billet(**changes), "N0365")


def meridian():
    """The same billet on an axisymmetric mesh."""
    lines = Lines()
    lines.add("*HEADING", "meridian", "*MATERIAL, NAME=M", "*ELASTIC", "1000., 0.3")
    lines.mesh(block((10.0, 12.0), (8, 6)), "CAX4", "B")
    lines.node += 1
    lines.add("*SOLID SECTION, ELSET=BE, MATERIAL=M", f"*NODE, NSET=P\n{lines.node}, 0., 0.",
              "*SURFACE, NAME=T, TYPE=SEGMENTS", "START, 0., 0.", "LINE, 30., 0.",
              f"*RIGID BODY, ANALYTICAL SURFACE=T, REF NODE={lines.node}",
              "*SURFACE INTERACTION, NAME=I", "*FRICTION", "0.1", "*CONTACT PAIR, INTERACTION=I",
              "BSBOTTOM, T", "*BOUNDARY", "BTOP, 2, 2, -0.2", "BLEFT, 1", "P, 1, 2", "P, 6",
              "*STEP", "*STATIC", "*END STEP")
    return Deck.parse("\n".join(lines.text) + "\n", name="meridian")


def test_the_axisymmetric_deck_has_the_same_answer(solve):
    """Within what the chords of the circle lack of it: 12 to the quarter leave out 0.3 %."""
    solid, plane = solve(billet()), solve(meridian())
    forces = [np.sum(r.contact(0).last.force, axis=0)[-1] for r in (solid, plane)]
    assert np.isclose(4.0*forces[0], forces[1], rtol=0.01)
    assert plane.summary["equations"] < 0.2*solid.summary["equations"]


def decks():
    folder = Path(__file__).resolve().parents[2]/"decks"
    return sorted(folder.glob("*.inp"), key=lambda p: p.stem)


#: Decks that keep what they could leave out: a picture of the whole strip, balls that show facets.
KEPT = {"folded_strip": {"N0364"}, "ball_of_facets": {"N0366"}, "sliding_ball": {"N0366"}}


@pytest.mark.parametrize("path", decks(), ids=lambda p: p.stem)
def test_decks_of_the_collection(path):
    deck = Deck.read(path)
    told = {n["code"] for n in lopin.check(deck)} & {"N0361", "N0362", "N0364", "N0365", "N0366",
                                              "N0367"}
    assert told == KEPT.get(path.stem, set())


def test_the_folded_strip_is_symmetric(solve):
    """As the advice says: nodes at z and 6 - z move alike, but for who is slave in self-contact."""
    mesh = solve("folded_strip").to_meshio()
    x, u = mesh.points, mesh.point_data["U"]
    order = np.lexsort(np.round(x.T, 6))
    image = x*[1.0, 1.0, -1.0] + [0.0, 0.0, 6.0]
    pairs = dict(zip(order, np.lexsort(np.round(image.T, 6))))
    partner = np.array([pairs[i] for i in range(len(x))])
    assert np.allclose(x[partner], image, atol=1e-6)
    assert np.allclose(u[partner]*[1.0, 1.0, -1.0], u, atol=1e-3*np.abs(u).max())
