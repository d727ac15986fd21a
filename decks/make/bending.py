"""Decks of sheets bent freely and let go: `python decks/make/bending.py name > deck.inp`.

Half of the sheet by symmetry, plane strain: x along it, y against the way of the punch.
"""
from __future__ import annotations

import sys
from dataclasses import dataclass
from math import pi, tan

import numpy as np
from sliding import lean, text
from square_cup import swift

from lopin import mesh_make
from lopin.mesh import together


@dataclass(frozen=True)
class Bend:
    """A punch with a round tip presses a sheet between two round shoulders."""

    punch: float       #: radius of the tip [mm]
    shoulder: float    #: radius of a shoulder [mm]
    centre: float      #: of a shoulder, from the middle [mm]
    thick: float       #: of the sheet [mm]
    length: float      #: half of the sheet's [mm]
    stroke: float      #: [mm]
    elastic: str       #: data line of *ELASTIC
    flow: str          #: data lines of *PLASTIC
    mu: float = 0.0

    def stroke_of(self, angle: float) -> float:
        """Way of the punch that turns straight legs, tangent to both tools, by an angle [rad]."""
        return self.centre*tan(angle) - (self.punch + self.thick + self.shoulder)*(
            np.sqrt(1.0 + tan(angle)**2) - 1.0)


V_SHOULDER = 3.0
#: The V die: 50 mm between the edges that its shoulders round.
V = Bend(5.0, V_SHOULDER, 25.0 + V_SHOULDER*tan(pi/8.0), 2.0, 45.0, 22.0, "210000., 0.3", "300., 0.\n800., 1.")
#: NUMISHEET 2002, NAFEMS benchmark 3: aluminium, Hollomon.
FREE = Bend(23.5, 4.0, 29.0, 1.0, 60.0, 28.5, "70500., 0.342", swift(550.4, (194.0/550.4)**(1.0/0.223), 0.223))


def bent(bend: Bend, comment: str, cells: tuple[int, int], grading: float = 1.0) -> str:
    """Bending, then the release of all tools; the middle of the sheet stays where it is.

    Away from the shoulder the die falls by 1 in 50: a sheet flat on a flat table comes loose of it
    node by node, in hundreds of iterations.
   """
    p, s, c, t, size = bend.punch, bend.shoulder, bend.centre, bend.thick, bend.length
    sheet = mesh_make.block((size, t), cells, grading=(grading, 1.0))
    sheet = sheet.with_points("MIDDLE", lambda x: (x[:, 0] < 1e-9) & (x[:, 1] > t - 1e-9))
    mesh = together(SHEET=lean(sheet, "TOP BOTTOM", "LEFT MIDDLE"))
    rubs = f"*FRICTION\n{bend.mu:g},\n" if bend.mu else ""
    deck = text(mesh, comment, f"""*MATERIAL, NAME=METAL
*ELASTIC
{bend.elastic}
*PLASTIC
{bend.flow}
*SOLID SECTION, ELSET=SHEET, MATERIAL=METAL
1.,
*NODE, NSET=PUNCH_REF
900001, 0., {t + p:g}
*SURFACE, NAME=PUNCH, TYPE=SEGMENTS
START, {p:g}, {t + p + 60:g}
LINE, {p:g}, {t + p:g}
CIRCL, 0., {t:g}, 0., {t + p:g}
CIRCL, {-p:g}, {t + p:g}, 0., {t + p:g}
*RIGID BODY, ANALYTICAL SURFACE=PUNCH, REF NODE=PUNCH_REF
*NODE, NSET=DIE_REF
900002, {c:.9g}, -50.
*SURFACE, NAME=DIE, TYPE=SEGMENTS
START, {c - s:.9g}, -60.
LINE, {c - s:.9g}, {-s:g}
CIRCL, {c:.9g}, 0., {c:.9g}, {-s:g}
LINE, {c + size:.9g}, {-0.02*size:g}
*RIGID BODY, ANALYTICAL SURFACE=DIE, REF NODE=DIE_REF
*SURFACE INTERACTION, NAME=TOOLS
*SURFACE BEHAVIOR, DIRECT
{rubs}*CONTACT PAIR, INTERACTION=TOOLS
SHEET.TOP, PUNCH
*CONTACT PAIR, INTERACTION=TOOLS
SHEET.BOTTOM, DIE
*BOUNDARY
SHEET.LEFT, 1
DIE_REF, 1, 2
DIE_REF, 6
PUNCH_REF, 1
PUNCH_REF, 6
*STEP, NAME=BEND, NLGEOM, INC=1000
*STATIC
0.005, 1., 1.E-6, 0.02
*BOUNDARY
PUNCH_REF, 2, 2, {-bend.stroke:g}
*OUTPUT, FIELD, FREQUENCY=10
*NODE OUTPUT
U
*ELEMENT OUTPUT
S, PEEQ
*END STEP
*STEP, NAME=RELEASE, NLGEOM, INC=1000
*STATIC
1., 1.
*MODEL CHANGE, TYPE=CONTACT PAIR, REMOVE
SHEET.TOP, PUNCH
SHEET.BOTTOM, DIE
*BOUNDARY, FIXED
SHEET.MIDDLE, 2
*END STEP
""")
    return deck.replace("TYPE=CPE4,", "TYPE=CPE4I,")


def v_bending(cells: tuple[int, int] = (90, 6)) -> str:
    """Air bending of a steel sheet in a V die."""
    return bent(V, """
A steel sheet is bent in the air between the shoulders of a V die, and springs back.

expect: certificate.verdict = PASS
""", cells)


def free_bending(cells: tuple[int, int] = (120, 4), mu: float = 0.0) -> str:
    """The free bending of NUMISHEET 2002."""
    return bent(Bend(**{**FREE.__dict__, "mu": mu}), """
Free bending of an aluminium sheet round a cylinder, and its springback: NUMISHEET 2002.

expect: certificate.verdict = PASS
""", cells)


SCENES = {f.__name__: f for f in (v_bending, free_bending)}


if __name__ == "__main__":
    for scene in sys.argv[1:]:
        print(SCENES[scene](), end="")
