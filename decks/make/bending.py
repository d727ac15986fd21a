"""The deck of a sheet bent freely and let go: `python decks/make/bending.py > deck.inp`.

NUMISHEET 2002 (benchmark 3 of NAFEMS): half of an aluminium sheet by symmetry, plane strain; x
along it, y against the way of the punch.
"""
from __future__ import annotations

import sys

from deck_text import lean, text
from square_cup import swift

from lopin import mesh_make
from lopin.mesh import together

PUNCH, SHOULDER, CENTRE, THICK, HALF = 23.5, 4.0, 29.0, 1.0, 60.0   #: radii, of a shoulder's centre, sheet [mm]
STRENGTH, EXPONENT, FLOW = 550.4, 0.223, 194.0                      #: of aluminium


def free_bending(cells: tuple[int, int] = (120, 4), mu: float = 0.1348,
                 stroke: float = 28.5) -> str:
    """Bending, then the release of all tools; the middle of the sheet stays where it is.

    Away from the shoulder the die falls by 1 in 50: a sheet flat on a flat table comes loose of it
    node by node, in hundreds of iterations.
    """
    p, s, c, t = PUNCH, SHOULDER, CENTRE, THICK
    sheet = mesh_make.block((HALF, t), cells)
    sheet = sheet.with_points("MIDDLE", lambda x: (x[:, 0] < 1e-9) & (x[:, 1] < 1e-9))
    mesh = together(SHEET=lean(sheet, "TOP BOTTOM", "LEFT MIDDLE"))
    rubs = f"*FRICTION\n{mu:g},\n" if mu else ""
    deck = text(mesh, """
An aluminium sheet bent freely round a cylinder, and its springback: NUMISHEET 2002, half of it.

expect: certificate.verdict = PASS
""", f"""*MATERIAL, NAME=METAL
*ELASTIC
70500., 0.342
*PLASTIC
{swift(STRENGTH, (FLOW/STRENGTH)**(1.0/EXPONENT), EXPONENT)}
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
LINE, {c + HALF:g}, {-0.02*HALF:g}
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
PUNCH_REF, 2, 2, {-stroke:g}
*OUTPUT, FIELD, FREQUENCY=10
*NODE OUTPUT
U
*ELEMENT OUTPUT
S, PEEQ
*END STEP
*STEP, NAME=RELEASE, NLGEOM, INC=1000
*STATIC
0.1, 1., 1.E-6, 0.2
*MODEL CHANGE, TYPE=CONTACT PAIR, REMOVE
SHEET.TOP, PUNCH
SHEET.BOTTOM, DIE
*BOUNDARY, FIXED
SHEET.MIDDLE, 2
*END STEP
""")
    return deck.replace("TYPE=CPE4,", "TYPE=CPE4I,")


if __name__ == "__main__":
    print(free_bending(mu=float(sys.argv[1]) if len(sys.argv) > 1 else 0.1348), end="")
