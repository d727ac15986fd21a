"""Sixteen decks that model more than their scenes need, beside what the advice makes of each.

`twins()` gives name, what is advised, the heavy deck, the light one, the force of the heavy one
over that of the light one, and by how much the force on the tool may differ, with the reason (1e-6:
files are in single precision).
"""
import re
from pathlib import Path

import numpy as np
from test_advice import pressed as slab
from test_advice import rounded_block, two_blocks
from test_advice_symmetry import billet, meridian, pressed
from tool_patches import Lines

from lopin.deck import Deck
from lopin.mesh_make import block, extruded, ring
from lopin.refine import of_second_order

DECKS = Path(__file__).resolve().parents[2]/"decks"


def of_collection(name, increments=""):
    """A deck of the collection, its steps in so many increments."""
    text = (DECKS/f"{name}.inp").read_text(encoding="utf-8")
    if increments:
        text = re.sub(r"(?m)^\*STATIC\n[^*\n]*\n", f"*STATIC\n{increments}\n", text)
    return Deck.parse(text, name, DECKS)


def upset(mesh, word, hold, tools, down, levels=()):
    """Metal pressed by rigid plates: (name, axis height, +1 if it looks up, way) a plate."""
    solid = word.startswith("C3D")
    up = 3 if solid else 2
    lines = Lines()
    lines.add("*HEADING", "upset", "*MATERIAL, NAME=M", "*ELASTIC", "200000., 0.3", "*PLASTIC",
              "200., 0.", "500., 1.")
    lines.mesh(mesh, word, "B")
    lines.add("*SOLID SECTION, ELSET=BE, MATERIAL=M", "*SURFACE INTERACTION, NAME=I", "*FRICTION",
              "0.1")
    for name, height, side, _ in tools:
        lines.node += 1
        lines.add(f"*NODE, NSET={name}", f"{lines.node}, 0., {'0., ' if solid else ''}{height}")
        if solid:
            lines.add(f"*SURFACE, NAME=T{name}, TYPE=CYLINDER",
                      f"0., 0., {height}, 1., 0., {height}", f"0., 1., {height}")
        else:
            lines.add(f"*SURFACE, NAME=T{name}, TYPE=SEGMENTS")
        left, right = (-60.0, 60.0) if side > 0 else (60.0, -60.0)
        if solid:
            left, right = right, left
        base = 0.0 if solid else height
        lines.add(f"START, {left}, {base}", f"LINE, {right}, {base}",
                  f"*RIGID BODY, ANALYTICAL SURFACE=T{name}, REF NODE={lines.node}")
    for name, _, side, _ in tools:
        face = "BOTTOM" if side > 0 else "TOP"
        lines.add("*CONTACT PAIR, INTERACTION=I", f"BS{face}, T{name}")
    lines.add("*BOUNDARY", *hold, *levels)
    for name, _, _, way in tools:
        lines.add(f"{name}, 1, {up - 1}", f"{name}, 4, 6" if solid else f"{name}, 6, 6",
                  f"{name}, {up}, {up}, {way}")
    lines.add("*STEP, NLGEOM, INC=100", "*STATIC", f"{down}, 1., 1e-5, {down}", "*END STEP")
    return Deck.parse("\n".join(lines.text) + "\n", name="upset")


def ring_in_space():
    mesh = extruded(ring(6.0, 12.0, (6, 10)), 8.0, 6)
    hold = ("BSTART, 2", "BEND, 1", "BBOTTOM, 3")
    return upset(mesh, "C3D8", hold, [("DIE", 8.0, -1, -0.8)], 0.1)


def ring_meridian():
    mesh = block((6.0, 8.0), (6, 6), origin=(6.0, 0.0))
    return upset(mesh, "CAX4", ("BBOTTOM, 2",), [("DIE", 8.0, -1, -0.8)], 0.1)


def ring_on_mandrel(half):
    """A ring that a pressure outside presses on a rigid mandrel, whole or its upper half."""
    lines = Lines()
    height, cells, foot = (5.0, 8, 0.0) if half else (10.0, 16, -5.0)
    mesh = block((6.0, height), (14, cells), origin=(10.0, foot))
    mesh.point_sets["MIDDLE"] = np.flatnonzero(np.abs(mesh.points[:, 1]) < 1e-9)
    lines.add("*HEADING", "mandrel", "*MATERIAL, NAME=M", "*ELASTIC", "200000., 0.3")
    lines.mesh(mesh, "CAX4", "B")
    lines.node += 1
    lines.add("*SOLID SECTION, ELSET=BE, MATERIAL=M", f"*NODE, NSET=P\n{lines.node}, 0., 0.",
              "*SURFACE, NAME=T, TYPE=SEGMENTS", "START, 10., 40.", "LINE, 10., -40.",
              f"*RIGID BODY, ANALYTICAL SURFACE=T, REF NODE={lines.node}",
              "*SURFACE INTERACTION, NAME=I", "*FRICTION", "0.1", "*CONTACT PAIR, INTERACTION=I",
              "BSLEFT, T", "*BOUNDARY", "BMIDDLE, 2", "P, 1, 2", "P, 6", "*STEP", "*STATIC",
              "*DSLOAD", "BSRIGHT, P, 50.", "*END STEP")
    return Deck.parse("\n".join(lines.text) + "\n", name="mandrel")


def square_billet(quarter):
    """A square bar in space on its foot, whole or a quarter."""
    if quarter:
        mesh = block((10.0, 10.0, 10.0), (5, 5, 6))
        return upset(mesh, "C3D8", ("BLEFT, 1", "BFRONT, 2", "BBOTTOM, 3"),
                     [("DIE", 10.0, -1, -0.5)], 0.2)
    mesh = block((20.0, 20.0, 10.0), (10, 10, 6), origin=(-10.0, -10.0, 0.0))
    for name, axis in (("MIDX", 0), ("MIDY", 1)):
        mesh.point_sets[name] = np.flatnonzero(np.abs(mesh.points[:, axis]) < 1e-9)
    hold = ("BBOTTOM, 3", "BMIDX, 1", "BMIDY, 2")
    return upset(mesh, "C3D8", hold, [("DIE", 10.0, -1, -0.5)], 0.2)


def bar_on_cylinder(facets):
    """A slab on a rigid cylinder: of straight elements, or an arc."""
    lines = Lines()
    lines.add("*HEADING", "cylinder", "*MATERIAL, NAME=M", "*ELASTIC", "1000., 0.3")
    lines.mesh(block((20.0, 8.0), (40, 16)).moved(-9.0, 0.0), "CPE4", "B")
    lines.add("*SOLID SECTION, ELSET=BE, MATERIAL=M", "*SURFACE INTERACTION, NAME=I")
    radius, first = 20.0, lines.node + 1
    if facets:
        angle = np.radians(np.linspace(140.0, 40.0, facets + 1))
        places = zip(radius*np.cos(angle), radius*np.sin(angle) - radius)
        lines.add("*NODE", *(f"{first + i}, {float(x)!r}, {float(y)!r}"
                             for i, (x, y) in enumerate(places)))
        lines.add("*ELEMENT, TYPE=R2D2, ELSET=ROUND", *(
            f"{9001 + i}, {first + i}, {first + i + 1}" for i in range(facets)))
        lines.node += facets + 1
    lines.node += 1
    lines.add(f"*NODE, NSET=P\n{lines.node}, 0., {-radius}")
    if facets:
        lines.add(f"*RIGID BODY, ELSET=ROUND, REF NODE={lines.node}",
                  "*SURFACE, NAME=T, TYPE=ELEMENT", "ROUND, SPOS")
    else:
        end = [radius*np.sin(np.radians(50.0)), radius*(np.cos(np.radians(50.0)) - 1.0)]
        lines.add("*SURFACE, NAME=T, TYPE=SEGMENTS", f"START, {-end[0]}, {end[1]}",
                  f"CIRCL, {end[0]}, {end[1]}, 0., {-radius}",
                  f"*RIGID BODY, ANALYTICAL SURFACE=T, REF NODE={lines.node}")
    lines.add("*CONTACT PAIR, INTERACTION=I, SMALL SLIDING", "BSBOTTOM, T", "*BOUNDARY", "BTOP, 1",
              "BTOP, 2, 2, -0.3", "P, 1, 2", "P, 6", "*STEP", "*STATIC", "*END STEP")
    return Deck.parse("\n".join(lines.text) + "\n", name="round")


def rigid_lower():
    """The stiff lower block of `two_blocks` as a rigid line."""
    lines = Lines()
    lines.add("*HEADING", "one", "*MATERIAL, NAME=SOFT", "*ELASTIC", "1000., 0.3")
    lines.mesh(block((10.0, 5.0), (20, 10)), "CPE4", "B")
    lines.node += 1
    lines.add("*SOLID SECTION, ELSET=BE, MATERIAL=SOFT", f"*NODE, NSET=P\n{lines.node}, 0., 0.",
              "*SURFACE, NAME=T, TYPE=SEGMENTS", "START, -5., 0.", "LINE, 15., 0.",
              f"*RIGID BODY, ANALYTICAL SURFACE=T, REF NODE={lines.node}",
              "*SURFACE INTERACTION, NAME=I", "*CONTACT PAIR, INTERACTION=I", "BSBOTTOM, T",
              "*BOUNDARY", "BTOP, 2, 2, -0.1", "BLEFT, 1", "P, 1, 2", "P, 6", "*STEP", "*STATIC",
              "*END STEP")
    return Deck.parse("\n".join(lines.text) + "\n", name="one")


def between_dies(half):
    """A billet that two dies press from both sides, whole or above the plane between them."""
    mesh = block((10.0, 5.0), (16, 8)) if half else block((10.0, 10.0), (16, 16)).moved(0.0, -5.0)
    upper = ("DIE", 5.0, -1, -0.5)
    if half:
        return upset(mesh, "CPE4", ("BLEFT, 1", "BBOTTOM, 2"), [upper], 0.2)
    return upset(mesh, "CPE4", ("BLEFT, 1",), [upper, ("BASE", -5.0, 1, 0.5)], 0.2)


def pressed_less(nlgeom):
    """The slab pressed by half of its way: strains of 0.4 %."""
    text = slab(False, nlgeom=nlgeom).text()
    return Deck.parse(text.replace("BTOP, 2, 2, -0.1", "BTOP, 2, 2, -0.05"), name="less")


def twins():
    """Name, code, heavy, light, share of the light one, tolerance of the force."""
    yield "slab in space", "N0361", slab(True), slab(False), 1, 1e-6
    yield "slab in space, friction", "N0361", slab(True, friction=True), \
        slab(False, friction=True), 1, 1e-6
    yield "elastic billet in space", "N0365", billet(), meridian(), 0.25, 0.01     # chords
    yield "ring in space", "N0365", ring_in_space(), ring_meridian(), 0.25, 0.01  # chords
    yield "whole block", "N0364", pressed(), pressed("half"), 2, 1e-6
    yield "whole ring on a mandrel", "N0364", ring_on_mandrel(False), ring_on_mandrel(True), 2, 1e-6
    yield "whole square bar", "N0364", square_billet(False), square_billet(True), 4, 1e-5
    yield "billet between two dies", "N0364", between_dies(False), between_dies(True), 1, 1e-5
    yield "slave of small facets", "N0367", rounded_block(64, 16), rounded_block(16, 16), 1, 0.01
    yield "stiff block below", "N0362", two_blocks(500.0), rigid_lower(), 1, 0.004  # 2/500
    yield "round tool of 40 lines", "N0366", bar_on_cylinder(40), bar_on_cylinder(0), 1, 0.05
    yield "ball of an STL file", "N0366", of_collection("ball_of_facets"), \
        of_collection("hertz_sphere_3d"), 1, 0.05
    yield "second order", "N0368", of_second_order(slab(False)).deck, slab(False), 1, 1e-6
    yield "slab on a finite path", "N0369", pressed_less(", NLGEOM"), pressed_less(""), 1, 0.006
    yield "Signorini in increments", "N0363", of_collection("signorini", "0.05, 1."), \
        of_collection("signorini"), 1, 1e-6
    yield "NAFEMS cylinder in increments", "N0363", of_collection("nafems_cylinder", "0.05, 1."), \
        of_collection("nafems_cylinder"), 1, 1e-6
