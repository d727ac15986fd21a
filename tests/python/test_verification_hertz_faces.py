"""Hertz under a rigid sphere by every kind of face: linear and quadratic meshes with as many nodes."""
import numpy as np
import pytest
from tool_patches import Lines, family, is_quadratic, numbers

from lopin.deck import Deck
from lopin.mesh_make import block, extruded, simplices

YOUNG, NU, RADIUS, DEPTH, FAR = 1000.0, 0.3, 50.0, 0.05, 12.0
#: Word, element at the middle, limits of the peak and of the L2 error of pressure beside p0.
KINDS = [("CAX4", 0.4, 0.06, 0.08), ("CAX8", 0.8, 0.02, 0.08), ("CAX8R", 0.8, 0.02, 0.08),
         ("CAX4", 0.2, 0.03, 0.08), ("CAX8", 0.4, 0.02, 0.05), ("CAX8R", 0.4, 0.02, 0.05),
         ("C3D8", 0.4, 0.03, 0.08), ("C3D20R", 0.8, 0.10, 0.15), ("C3D20", 0.8, 0.10, 0.15),
         ("C3D8", 0.3, 0.03, 0.08), ("C3D10", 0.8, 0.10, 0.15), ("C3D15", 0.8, 0.10, 0.20)]


def ticks(fine, zone):
    """Coordinates from 0 to FAR, equal in the zone, then growing."""
    x, h = list(np.arange(0.0, zone + 0.5*fine, fine)), fine
    while x[-1] < FAR:
        h *= 1.35
        x.append(x[-1] + h)
    return np.array(x)/x[-1]


def ball_deck(word, fine) -> tuple[Deck, int]:
    """A quarter of a block, or a cylinder, under a sphere, and the number of its nodes."""
    cell, across, down = family(word), ticks(fine, 2.4), 1.0 - ticks(fine, 1.2)[::-1]
    solid = word.startswith("C3D")
    n = len(across) - 1
    if solid:
        mesh = block((FAR, FAR), (n, n), grading=(across, across))
        if cell == "wedge":
            mesh = simplices(mesh)
        mesh = extruded(mesh, 1.0, len(down) - 1)
        levels = np.linspace(0.0, 1.0, len(down))
        mesh = mesh.mapped(lambda x: np.column_stack([x[:, :2], FAR*np.interp(x[:, 2], levels,
                                                                             down)]))
        if cell == "tetra":
            mesh = simplices(mesh)
    else:
        mesh = block((FAR, FAR), (n, len(down) - 1), grading=(across, down))
        if cell == "triangle":
            mesh = simplices(mesh)
    if is_quadratic(word):
        mesh = mesh.quadratic()
    up = np.zeros(mesh.ndim)
    up[-1] = FAR
    mesh = mesh.mapped(lambda x: x - up)
    lines = Lines()
    lines.add("*HEADING", f"A rigid sphere on {word}", "*MATERIAL, NAME=M", "*ELASTIC",
              f"{YOUNG!r}, {NU!r}")
    lines.mesh(mesh, word, "B")
    lines.node += 1
    end = np.sin(0.3)*RADIUS, RADIUS*(1.0 - np.cos(0.3))
    arc = [f"START, {numbers(end)}", f"CIRCL, {numbers((0.0, 0.0, 0.0, RADIUS))}"]
    lines.add("*SOLID SECTION, ELSET=BE, MATERIAL=M", "*NODE, NSET=P",
              f"{lines.node}, {numbers(np.zeros(mesh.ndim))}")
    if solid:
        lines.add("*SURFACE, NAME=BALL, TYPE=REVOLUTION", "0., 0., 0., 0., 0., 1.")
    else:
        lines.add("*SURFACE, NAME=BALL, TYPE=SEGMENTS")
    held = ["BLEFT, 1", "BFRONT, 2", "BBOTTOM, 3", "P, 1, 2", "P, 4, 6"] if solid else \
        ["BLEFT, 1", "BBOTTOM, 2", "P, 1", "P, 6"]
    axis = mesh.ndim
    lines.add(*arc, f"*RIGID BODY, ANALYTICAL SURFACE=BALL, REF NODE={lines.node}",
              "*SURFACE INTERACTION, NAME=I", "*CONTACT PAIR, INTERACTION=I", "BSTOP, BALL",
              "*BOUNDARY", *held, "*STEP", "*STATIC, DIRECT", "1., 1.", "*BOUNDARY",
              f"P, {axis}, {axis}, {-DEPTH!r}", "*CONTACT FILE", "CDIS, CSTR", "*END STEP")
    return Deck.parse("\n".join(lines.text) + "\n", name=f"ball_{word.lower()}"), mesh.n_point


def figures(result, word):
    """Force, peak over p0, pressure on the axis over p0, L2 error over p0 on the disc."""
    solid = word.startswith("C3D")
    contact = result.contact(0).last
    force = abs(result.history["BALL.rf3" if solid else "BALL.rf2"][-1])*(4.0 if solid else 1.0)
    stiff = YOUNG/(1.0 - NU**2)
    a = (0.75*force*RADIUS/stiff)**(1.0/3.0)
    p0 = 1.5*force/(np.pi*a*a)
    r = np.linalg.norm(contact.x[:, :2], axis=1) if solid else contact.x[:, 0]
    p, weight = contact.pressure.ravel(), contact["WEIGHT"].ravel()
    wanted = p0*np.sqrt(np.maximum(1.0 - (r/a)**2, 0.0))
    l2 = np.sqrt((weight*(p - wanted)**2).sum()/(weight*wanted**2).sum())
    return (force, p.max()/p0, p[r.argmin()]/p0, l2)


@pytest.mark.parametrize(("word", "fine", "peak", "l2"), KINDS)
def test_hertz_by_faces(solve, sheet, word, fine, peak, l2):
    deck, nodes = ball_deck(word, fine)
    force, top, centre, error = figures(solve(deck), word)
    case, start = "A4 Hertz: rigid sphere by faces", f"{word}, element {fine:g}, {nodes} nodes: "
    sheet.compare(case, start + "largest pressure over p0 of the force", top, 1.0, peak, "Hertz")
    sheet.compare(case, start + "pressure on the axis over p0", centre, 1.0, peak, "Hertz")
    sheet.compare(case, start + "L2 error of pressure over that of Hertz", error, 0.0, l2, "Hertz",
                  absolute=True)
    stiff = YOUNG/(1.0 - NU**2)
    sheet.compare(case, start + "force", force, 4.0/3.0*stiff*np.sqrt(RADIUS*DEPTH**3), 0.15,
                  "half-space; the block is 12 deep")
