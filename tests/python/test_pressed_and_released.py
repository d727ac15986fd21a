"""Blocks pressed flat between two tools and let go of in three ways, in any frame and units: without
friction the force and the height that is left are closed forms."""
from math import exp, log, pi

import numpy as np
import pytest
from tool_patches import Lines, family, is_quadratic, is_solid, numbers, turned

from lopin.deck import Deck
from lopin.mesh_make import block, extruded, simplices

YOUNG, FLOW, HARDENING = 2e5, 200.0, 200.0
WIDTH, HEIGHT, PRESSED = 10.0, 15.0, 9.0


def block_of(word):
    """Two cells a side."""
    mesh = block((WIDTH, WIDTH if is_solid(word) else HEIGHT), (2, 2))
    if is_solid(word):
        mesh = extruded(mesh, HEIGHT, 2)
    if family(word) in ("triangle", "tetra"):
        mesh = simplices(mesh)
    return mesh.quadratic() if is_quadratic(word) else mesh


def plane(lines, name, number, at, q, outside):
    """A plane across the last axis turned by q, its outside along it (1) or against it (-1)."""
    d, far = len(q), float(5.0*np.linalg.norm(at) + 50.0*lines.unit)
    lines.add(f"*NODE, NSET={name}_REF", f"{number}, {numbers(at)}")
    if d == 2:
        lines.add(f"*SURFACE, NAME={name}, TYPE=SEGMENTS", f"START, {numbers(at - outside*far*q[:, 0])}",
                  f"LINE, {numbers(at + outside*far*q[:, 0])}")
    else:
        lines.add(f"*SURFACE, NAME={name}, TYPE=CYLINDER", numbers([*at, *(at + outside*q[:, 0])]),
                  numbers(at - q[:, 1]), f"START, {-far!r}, 0.", f"LINE, {far!r}, 0.")
    lines.add(f"*RIGID BODY, ANALYTICAL SURFACE={name}, REF NODE={number}")


def pressed(word, way, rotation, unit=1.0, stress=1.0):
    """From 15 to 9 high, then both tools are removed, or the upper one is, or goes back, or its load
    comes off."""
    d, round_ = (3 if is_solid(word) else 2), word.startswith("CAX")
    q, lines = turned(rotation), Lines()
    lines.unit = unit
    lines.mesh(block_of(word).mapped(lambda x: unit*x @ q.T), word, "B")
    lines.add("*MATERIAL, NAME=M", "*ELASTIC", f"{YOUNG*stress!r}, 0.3", "*PLASTIC",
              f"{FLOW*stress!r}, 0.", f"{(FLOW + HARDENING)*stress!r}, 1.",
              "*SOLID SECTION, ELSET=BE, MATERIAL=M", *([] if d == 3 or round_ else [f"{unit!r},"]))
    plane(lines, "UPPER", 90001, unit*HEIGHT*q[:, -1], q, -1)
    plane(lines, "LOWER", 90002, np.zeros(d), q, 1)
    turns = "6" if d == 2 else "4, 6"
    held = [f"LOWER_REF, 1, {d}", f"LOWER_REF, {turns}", f"UPPER_REF, {turns}",
            *(["BLEFT, 1"] if round_ else [])]
    pairs = ["BSTOP, UPPER", "BSBOTTOM, LOWER"]
    prints = ["*NODE PRINT, NSET=BN", "U", "*CONTACT FILE", "CDIS, CSTR", "*NODE FILE", "U", "*END STEP"]

    def move(to):
        way = unit*(to - HEIGHT)*q[:, -1]
        return ["*BOUNDARY", *(f"UPPER_REF, {k + 1}, {k + 1}, {float(way[k])!r}" for k in range(d))]

    lines.add("*SURFACE INTERACTION, NAME=I", "*SURFACE BEHAVIOR, DIRECT", "*CONTACT PAIR, INTERACTION=I",
              *pairs, "*BOUNDARY", *held, "*STEP, NLGEOM", "*STATIC", *move(PRESSED), *prints,
              "*STEP, NLGEOM", "*STATIC")
    lines.add(*{"removed": ["*MODEL CHANGE, TYPE=CONTACT PAIR, REMOVE", *pairs],
                "one removed": ["*MODEL CHANGE, TYPE=CONTACT PAIR, REMOVE", pairs[0]],
                "withdrawn": move(12.0),
                "unloaded": ["*BOUNDARY, OP=NEW", *held, f"UPPER_REF, 1, {d - 1}"]}[way], *prints)
    return Deck.parse("\n".join(lines.text) + "\n", name="pressed"), q


def plastic():
    """Plastic strain at the end of the stroke: its hardening less the elastic part."""
    strain = -log(PRESSED/HEIGHT)
    return (strain - FLOW/YOUNG)/(1.0 + HARDENING/YOUNG)


SPACE = [(0.4, -1.1, 0.7), (-0.9, 0.2, 2.1), (1.3, 1.2, -0.5)]
CASES = [("CAX4", 0.0), ("CAX8R", 0.0), ("CPS4", 2.3), ("CPS8R", 0.6), *(("C3D8I", r) for r in SPACE),
         ("C3D8", SPACE[0]), ("C3D4", SPACE[1]), ("C3D10", SPACE[2]), ("C3D8", (0.0, 0.0, 0.0))]


#: Supports of what is unloaded are along the axes; one word turns every way, in one way each.
WAYS = [(word, rotation, way) for word, rotation in CASES
        for way in ("removed", "one removed", "withdrawn", "unloaded")
        if not (way == "unloaded" and np.any(rotation)) and (word, way) not in
        (("C3D8I", "one removed"), ("C3D8I", "withdrawn")) or (rotation, way) in
        ((SPACE[0], "one removed"), (SPACE[1], "withdrawn"))]


@pytest.mark.parametrize("word, rotation, way", WAYS)
def test_force_and_springback_are_the_closed_form_s(solve, word, rotation, way):
    unit, stress = (1e-3, 1e6) if way == "withdrawn" else (1.0, 1.0)
    deck, q = pressed(word, way, rotation, unit, stress)
    result = solve(deck)
    d, strain = len(q), plastic()
    assert result.verdict == "PASS"
    at = np.flatnonzero(result.history["time"] <= 1.0 + 1e-9)[-1]
    force = np.linalg.norm([result.history[f"UPPER.rf{k + 1}"][at] for k in range(d)])
    volume = {"CAX": pi*WIDTH**2*HEIGHT, "C3D": WIDTH**2*HEIGHT}.get(word[:3], WIDTH*HEIGHT)
    flow = FLOW + HARDENING*strain     # bounds the stress of the undeformed volume
    assert force/(stress*unit**2) == pytest.approx(flow*volume/PRESSED, rel=1e-6)
    grid = result.to_meshio(-1)
    used = np.unique(np.concatenate([b.data.ravel() for b in grid.cells if len(b.data[0]) > 2]))
    up = (grid.points + np.asarray(grid.point_data["U"]))[used][:, :d] @ q[:, -1]
    start = grid.points[used][:, :d] @ q[:, -1]
    top = start > (HEIGHT - 1e-6)*unit
    left = up[top].mean() - up[start < 1e-6*unit].mean()
    back = HEIGHT*exp(-strain) - PRESSED
    assert left/unit - PRESSED == pytest.approx(back, rel=1e-4)


@pytest.mark.parametrize("overlap", [1e-4, 1e-3])
def test_a_pair_that_is_added_over_an_overlap_takes_one_increment(solve, overlap):
    """Two unit blocks between fixed ends: E/2 times the overlap, once, in a linear scene."""
    rows = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
    nodes = [(k + 1, x, y) for k, (x, y) in enumerate(rows)] + [
        (k + 5, x, y + 1.0 - overlap) for k, (x, y) in enumerate(rows)]
    text = "*NODE\n" + "".join(f"{n}, {x}, {y!r}\n" for n, x, y in nodes) + f"""*ELEMENT, TYPE=CPS4, ELSET=LOW
1, 1, 2, 3, 4
*ELEMENT, TYPE=CPS4, ELSET=UP
2, 5, 6, 7, 8
*ELSET, ELSET=ALL
LOW, UP
*SURFACE, NAME=FLOOR
LOW, S3
*SURFACE, NAME=FACE
UP, S1
*MATERIAL, NAME=M
*ELASTIC
1000., 0.
*SOLID SECTION, ELSET=ALL, MATERIAL=M
*SURFACE INTERACTION, NAME=I
*CONTACT PAIR, INTERACTION=I
FACE, FLOOR
*BOUNDARY
1, 1, 2
2, 1, 2
7, 1, 2
8, 1, 2
*STEP
*STATIC
*MODEL CHANGE, TYPE=CONTACT PAIR, REMOVE
FACE, FLOOR
*END STEP
*STEP, INC=5
*STATIC
*MODEL CHANGE, TYPE=CONTACT PAIR, ADD
FACE, FLOOR
*END STEP
"""
    result = solve(Deck.parse(text, "added"))
    assert [step["increments"] for step in result.summary["steps"]] == [1, 1]
    assert abs(result.history["FACE-FLOOR.force2"][-1]) == pytest.approx(500.0*overlap, rel=1e-6)
