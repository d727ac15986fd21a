"""Ties of the nonlinear path whose slave nodes the factor does without, against the same as rows.

A slave node with local axes keeps its rows, so the same deck with `*TRANSFORM` on the slave surface
is solved with rows: displacements, stresses, reactions, tractions and forces of ties are equal to
the tolerance of Newton. The plan says what is eliminated and what stays.
"""
import re

import numpy as np
import pytest
from test_tied_rings import rings
from tool_patches import Lines, family, is_quadratic

from lopin.deck import Deck
from lopin.mesh_make import block, extruded, simplices

WORDS = [("CPE4", "CPE4"), ("CPS8R", "CPE4"), ("CPE6", "CPE8"), ("CAX4", "CAX4"),
         ("C3D8", "C3D8"), ("C3D20R", "C3D8"), ("C3D10", "C3D10"), ("C3D6", "C3D8")]
FLOW = ("*PLASTIC", "6., 0.", "30., 0.1")


def counts(result):
    """Displacements eliminated and rows that stay, from the plan."""
    found = re.search(r"ties: (\w+) displacements of slave nodes eliminated(, (\d+) rows stay)?",
                      result.summary["plan"])
    if found is None:
        return 0, 0
    return 0 if found[1] == "no" else int(found[1]), int(found[3] or 0)


def beam(words, bend=0.0, steps=("*STEP, NLGEOM",), flow=(), axes=False, wall=None):
    """Two blocks side by side, meshes that do not match, the seam bent; clamped on the left, pressed
    on the right and below."""
    lines = Lines()
    lines.add("*MATERIAL, NAME=M", "*ELASTIC", "1000., 0.3", *flow)
    d = 3 if words[0].startswith("C3D") else 2
    low = 1.0 if words[0].startswith("CAX") else 0.0
    for name, word, start, cells in (("I", words[0], 1.0, (3, 2)), ("O", words[1], 0.0, (2, 2))):
        cell = family(word)
        mesh = block((1.0, 1.0), cells)
        if cell in ("triangle", "wedge"):
            mesh = simplices(mesh)
        if d == 3:
            mesh = extruded(mesh, 1.0, cells[0])
            mesh = simplices(mesh) if cell == "tetra" else mesh
        mesh = mesh.quadratic() if is_quadratic(word) else mesh
        lines.mesh(mesh.mapped(lambda x, start=start: np.column_stack(
            [x[:, 0] + start + bend*x[:, 1]**2 + low, x[:, 1:]])), word, name)
        lines.add(f"*SOLID SECTION, ELSET={name}E, MATERIAL=M")
    if axes:
        lines.add("*TRANSFORM, NSET=ILEFT",
                  "0.8, 0.6, 0., -0.36, 0.48, 0.8" if d == 3 else "0.8, 0.6, 0., -0.6, 0.8, 0.")
    lines.add("*TIE, NAME=T", "ISLEFT, OSRIGHT")
    if wall:
        lines.mesh(block((1.0, 1.0), (2, 2)).mapped(lambda x: x + [1.0 + 0.9*bend, 1.0]), "CPE4", "W")
        penalty = ("*SURFACE BEHAVIOR, PENALTY",) if wall[1] == "penalty" else ()
        friction = ("*FRICTION", repr(wall[0])) if wall[0] else ()
        lines.add("*SOLID SECTION, ELSET=WE, MATERIAL=M", "*SURFACE INTERACTION, NAME=F", *penalty,
                  *friction, "*CONTACT PAIR, INTERACTION=F", "ISTOP, WSBOTTOM")
    lines.add("*BOUNDARY", f"OLEFT, 1, {d}", *(["WTOP, 1, 2"] if wall else []))
    for step in steps:
        lines.add(step, "*STATIC", "0.5, 1.", "*DSLOAD", "ISRIGHT, P, 6.", "ISBOTTOM, P, 1.",
                  "*NODE FILE", "U, RF", "*EL FILE", "S", "*CONTACT FILE", "CSTRESS, CDISP",
                  "*END STEP")
    return "\n".join(lines.text) + "\n"


def distance(one, other):
    """Largest difference of all fields and of what ties bear, relative."""
    worst = 0.0
    for name in ("U", "RF", "S"):
        a, b = np.asarray(one[name]), np.asarray(other[name])
        worst = max(worst, np.abs(a - b).max()/np.abs(b).max())
    for name in ("force", "pressure"):
        a, b = (np.concatenate([np.ravel(getattr(r.contact(p).last, name)) for p in r.pairs])
                for r in (one, other))
        worst = max(worst, np.abs(a - b).max()/np.abs(b).max())
    return worst


def both(solve, build, **kw):
    """With slave nodes eliminated, and with all rows."""
    found = [solve(Deck.parse(build(axes=axes, **kw), name=f"axes{axes:d}"))
             for axes in (False, True)]
    assert counts(found[0])[0] > 0 and counts(found[1])[0] == 0
    assert counts(found[1])[1] == sum(counts(found[0]))
    return found


@pytest.mark.parametrize("words, step, bend", [
    (words, step, bend) for k, words in enumerate(WORDS) for step in ("*STEP", "*STEP, NLGEOM")
    for bend in (0.0, 0.2) if k % 2 == 0 or (step == "*STEP") == (bend == 0.0)])
def test_they_are_those_of_rows(solve, words, step, bend):
    """Elements of the plane, of rings and of space, small and finite strain, seams that fit and
    seams across which the facets leave an arm."""
    flow = FLOW if step == "*STEP" else ()
    one, other = both(solve, lambda **k: beam(words, bend, (step,), flow, **k))
    assert distance(one, other) < 1e-8


@pytest.mark.parametrize("words", [("CPE4", "CPE4"), ("C3D8", "C3D8")], ids="/".join)
def test_metal_that_flows_at_finite_strain(solve, words):
    one, other = both(solve, lambda **k: beam(words, 0.0, ("*STEP, NLGEOM",)*2, FLOW, **k))
    assert distance(one, other) < 1e-8


@pytest.mark.parametrize("tie", ["tie", "penalty"])
@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_contact_on_another_face(solve, friction, tie):
    """The slave body is pressed on a third one beside it: the node at the end of the seam is slave
    of both pairs. Contact exact and by penalties."""
    one, other = both(solve, lambda **k: beam(("CPE4", "CPE4"), 0.1, wall=(friction, tie), **k))
    assert np.max(one.contact(one.pairs[-1]).last.pressure) > 1.0
    assert distance(one, other) < 1e-8


def test_patches_stay_uniform(solve):
    """A seam of unlike meshes under uniform pressure: uniform stress, planes of symmetry
    at both ends."""
    text = beam(("C3D8", "C3D8"), 0.0).replace("OLEFT, 1, 3", "OLEFT, 1\nOFRONT, 2\nIFRONT, 2\n"
                                              "OBOTTOM, 3\nIBOTTOM, 3").replace("ISBOTTOM, P, 1.\n", "")
    result = solve(Deck.parse(text, name="patch"))
    assert counts(result)[0] > 0
    pressure = result.contact(result.pairs[0]).last.pressure
    assert np.ptp(pressure) < 1e-9*np.max(pressure)


@pytest.mark.parametrize("cells", [(3, 2), (3, 3)])
def test_ties_between_supports_hide_no_load(solve, cells):
    """Slave and master held alike on planes of symmetry: what the tie gives the supports there may be
    any force, and is nothing beside which a body is in balance. The second pull went unnoticed."""
    lines = Lines()
    lines.add("*MATERIAL, NAME=M", "*ELASTIC", "1.e5, 0.")
    for name, word, start, n in (("L", "C3D20", 0.0, (1, 2)), ("U", "C3D8", 0.7, cells)):
        mesh = extruded(block((2.0, 1.6), n), 0.7, 1)
        mesh = mesh.quadratic() if is_quadratic(word) else mesh
        lines.mesh(mesh.mapped(lambda x, start=start: x + [0.0, 0.0, start]), word, name)
        lines.add(f"*SOLID SECTION, ELSET={name}E, MATERIAL=M", "*BOUNDARY", f"{name}LEFT, 1",
                  f"{name}FRONT, 2")
    lines.add("*TIE, NAME=T", "USBOTTOM, LSTOP", "*BOUNDARY", "LBOTTOM, 3")
    pulls = 30.0, 60.0
    for pull in pulls:
        lines.add("*STEP, NLGEOM", "*STATIC", "1., 1.", "*DSLOAD", f"USTOP, P, {-pull}",
                  "*NODE FILE", "U", "*CONTACT FILE", "CDIS, CSTR", "*END STEP")
    result = solve(Deck.parse("\n".join(lines.text) + "\n", name="between_supports"))
    for step, pull in enumerate(pulls):
        stretch = 1.0
        for _ in range(9):
            stretch = np.exp(pull/1e5*stretch)   # Kirchhoff's stress E ln l is the pull times l
        assert np.max(result.at(step)["U"][:, 2]) == pytest.approx(1.4*(stretch - 1.0), rel=1e-6)
        forces = np.abs(result.contact().at(step)["R_t"]).max(), 1e3*3.2*pull
        assert forces[0] < forces[1] or any(w["code"] == "W0346" for w in result.diagnostics)


def test_local_axes_on_symmetry_planes(solve):
    """Quarter rings turned by .6: slave nodes at the ends have local axes, and their rows stay."""
    deck, _ = rings(("CPE4", "CPE4"), "finite", [("8:6", "tie", 0.6)])
    gone, stay = counts(solve(deck))
    assert gone == 2*(9 - 2) and stay > 0
