"""Decks of blanking: `python decks/make/blanking.py name > deck.inp`.

A disc is cut from a sheet: punch, die and holder are rings with small edges, the metal between
their edges is sheared. Each function returns the text of a whole deck.
"""
from __future__ import annotations

import sys
from math import exp, sqrt

import numpy as np
from deck_text import lean, text
from forging import segments

from lopin import mesh_make
from lopin.mesh import together


def flow_stress(strain: float) -> float:
    """X30Cr13 [MPa]: Goijaerts, Govaert, Baaijens, J. Manuf. Sci. Eng. 122 (2000) 476."""
    return 420.0 + 133.0*(1.0 - exp(-strain/0.0567)) + 406.0*sqrt(strain) + 70.7*strain


def graded(centre: float, cell: float, half: float, growth: float, end: float) -> np.ndarray:
    """Places from 0 to `end`: cells of one size within `half` of `centre`, growing away from it."""
    def away(distance):
        steps, at = [], cell
        while sum(steps) < distance:
            at *= growth
            steps.append(at)
        return np.cumsum(steps)*distance/sum(steps)

    middle = np.linspace(centre - half, centre + half, round(2.0*half/cell) + 1)
    return np.concatenate([middle[0] - away(middle[0])[::-1], middle,
                           middle[-1] + away(end - middle[-1])])


def cut(comment: str, kind: str, cell: float, clearance: float, stroke: float, card: str) -> str:
    """A sheet of 1 mm between a punch of radius (half width) 5 and a die, edges of 0.05."""
    radius, edge, end = 5.0, 0.05, 8.0
    r = graded(radius + clearance/2.0, cell, 0.35, 1.25, end)
    sheet = mesh_make.block((1.0, 1.0), (len(r) - 1, round(1.0/cell)))
    points = sheet.points.copy()
    points[:, 0] = r[np.round(points[:, 0]*(len(r) - 1)).astype(int)]
    mesh = together(SHEET=lean(sheet.replaced(points=points), "TOP BOTTOM", "LEFT"))
    punch = segments("PUNCH", [(radius, 4.0, 0.0), (radius, 1.0, edge), (-1.0, 1.0, 0.0)])
    die = segments("DIE", [(radius + clearance, -3.0, 0.0), (radius + clearance, 0.0, edge),
                           (end + 2.0, 0.0, 0.0)])
    holder = segments("HOLDER", [(end + 2.0, 1.0, 0.0), (radius + 0.1, 1.0, edge),
                                 (radius + 0.1, 4.0, 0.0)])
    curve = "\n".join(f"{flow_stress(e):.6g}, {e:.6g}" for e in
                      (0.0, 0.002, 0.005, 0.01, 0.02, 0.04, 0.07, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5,
                       0.7, 1.0, 1.5, 2.0, 3.0, 5.0))
    tools = "".join(f"*NODE, NSET={name}_REF\n{label}, 0., {z}\n{shape}*RIGID BODY, "
                    f"ANALYTICAL SURFACE={name}, REF NODE={name}_REF\n"
                    for name, label, z, shape in (("PUNCH", 900001, 4.0, punch),
                                                  ("DIE", 900002, -3.0, die),
                                                  ("HOLDER", 900003, 4.0, holder)))
    return text(mesh, comment, f"""*MATERIAL, NAME=STEEL
*ELASTIC
210000., 0.3
*PLASTIC
{curve}
*DAMAGE, CRITERION=OYANE, WIDTH=0.05
3.9
*DAMAGE, CRITERION=RICE-TRACEY, WIDTH=0.05
*DAMAGE, CRITERION=COCKCROFT-LATHAM, WIDTH=0.05
*SOLID SECTION, ELSET=SHEET, MATERIAL=STEEL
{tools}*SURFACE INTERACTION, NAME=RUBS
*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD
*FRICTION
0.1
*CONTACT PAIR, INTERACTION=RUBS
SHEET.TOP, PUNCH
SHEET.BOTTOM, DIE
SHEET.TOP, HOLDER
*BOUNDARY
SHEET.LEFT, 1
PUNCH_REF, 1
PUNCH_REF, 6
DIE_REF, 1, 2
DIE_REF, 6
HOLDER_REF, 1, 2
HOLDER_REF, 6
{card}*STEP, NAME=CUT, NLGEOM, INC=2000
*STATIC
0.005, 1., 1.E-7, 0.02
*BOUNDARY
PUNCH_REF, 2, 2, {-stroke:g}
*OUTPUT, FIELD, FREQUENCY=20
*ELEMENT OUTPUT
S, PEEQ, DAMAGE
*END STEP
""", kind)


def blanking(cell: float = 0.05, clearance: float = 0.05, stroke: float = 0.2, card: str = "") -> str:
    """A disc cut from a sheet."""
    return cut("""
A disc is cut from a sheet of 1 mm: punch of 10 mm across, clearance 0.05 mm, edges of 0.05 mm.

X30Cr13 (flow curve of Goijaerts, Govaert, Baaijens, 2000), mu = 0.1, held by a ring above the die. The metal between
the edges is sheared; how near it is to fracture is told by three criteria, their means over 0.05 mm. The slab
estimate of the force, pi d t sigma/sqrt 3, is 16 kN. The press stops at 0.2 mm; from 0.24 on a corner of the mesh at
an edge turns inside out, and *REMESH goes on (docs/damage.md). Cells of half the size give 14.8 kN, .32 and .76.

expect: certificate.verdict = PASS
expect: history.PUNCH.rf2 = -14.8e3 +- 3 %
expect: history.damage.OYANE = 0.32 +- 10 %
expect: history.damage.RICE-TRACEY = 0.76 +- 20 %
""", "axisymmetric", cell, clearance, stroke, card)


def shearing(cell: float = 0.05, clearance: float = 0.05, stroke: float = 0.2, card: str = "") -> str:
    """A long strip cut from the same sheet: plane strain."""
    return cut("""
A long strip of 10 mm is cut from a sheet of 1 mm: the disc of blanking in plane strain, one half of it.

Punch, clearance of 0.05 mm, edges of 0.05 mm and metal are those of blanking. The force is that of one edge and 1 mm of
its length: 463 N, beside 510 N of the slab, t sigma/sqrt 3, and 481 N of the disc, 15.2 kN/(2 pi 5.025). Cells of half the
size give 455 N at 0.185 mm, where a corner at an edge turns inside out.

expect: certificate.verdict = PASS
expect: history.PUNCH.rf2 = -463. +- 3 %
""", "plane strain", cell, clearance, stroke, card)


SCENES = {f.__name__: f for f in (blanking, shearing)}


if __name__ == "__main__":
    print(SCENES[sys.argv[1]](), end="")
