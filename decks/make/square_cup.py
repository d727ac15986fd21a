"""Decks of a square cup drawn from sheet: `python decks/make/square_cup.py > deck.inp`.

NUMISHEET'93: a blank of 150 x 150 x 0.78 mm, a punch of 70 x 70 mm (edge 8, corners 10 mm), a die
of 74 x 74 mm (edge 5, corners 12 mm), blank holder 19.6 kN. One quarter; z is the way of the punch.
"""
from __future__ import annotations

import sys

import numpy as np
from deck_text import lean, text

from lopin import mesh_make
from lopin.mesh import together

THICK, CORE = 0.78, 25.0   #: of the blank; from the middle to the centres of the corners [mm]


EXPECT = """\
expect: certificate.verdict = PASS
expect: history.PUNCH.rf3 at 2 = -14131 +- 3 %
expect: history.BLANK.TOP-HOLDER.force3 at 2 = -4900 +- 0.1 %
expect: node.15.u1 = -4.95 +- 3 %
expect: node.225.u1 = -2.00 +- 3 %
expect: contact.0.max_penetration < 1e-4"""


def swift(strength: float, strain: float, exponent: float, last: float = 2.0,
          rows: int = 60) -> str:
    """A table of strength*(strain + eps)**exponent, dense where it bends."""
    eps = last*(np.arange(rows)/(rows - 1.0))**2
    return "\n".join(f"{strength*(strain + e)**exponent:.7g}, {e:.7g}" for e in eps)


def led_around(name: str, rows: str) -> str:
    """A rigid tool whose profile (r, z) runs around the square with the centres of the corners."""
    return (f"*SURFACE, NAME={name}, TYPE=REVOLUTION\n0., 0., 0., 0., 0., 1.\n{CORE:g}, 0., 0., 0., {CORE:g}, 0.\n"
            f"{rows.strip()}\n*RIGID BODY, ANALYTICAL SURFACE={name}, REF NODE={name}_REF\n")


def section(lankford: tuple[float, float, float] | None) -> str:
    """The section of the blank, rolled along x if it has values of Lankford."""
    if lankford is None:
        return "*SOLID SECTION, ELSET=BLANK, MATERIAL=STEEL"
    return (f"*POTENTIAL, DEFINITION=LANKFORD\n{', '.join(f'{r:g}' for r in lankford)}\n"
            "*ORIENTATION, NAME=ROLLED\n1., 0., 0., 0., 1., 0.\n"
            "*SOLID SECTION, ELSET=BLANK, MATERIAL=STEEL, ORIENTATION=ROLLED")


def along_side(cells: int, size: float, fine: float = 56.0) -> np.ndarray:
    """Shorter cells where the blank runs over the edges of punch and die, from 28 to `fine` mm.

    Half as long as the others; a third if they reach the edge of the blank.
    """
    shorter = 2.0 if fine < size else 3.0
    ways = np.array([28.0, shorter*(fine - 28.0), size - fine])
    first, last = (round(cells*way/ways.sum()) for way in ways[[0, 2]])
    counts = (max(1, first), cells - max(1, first) - last, last)
    ends = (0.0, 28.0, fine, size)
    return np.concatenate([[0.0]] + [np.linspace(a, b, n + 1)[1:]
                                     for a, b, n in zip(ends, ends[1:], counts)])/size


def square_cup(cells: int = 14, stroke: float = 15.0, layers: int = 1, *, holder: float = 19600.0,
               mu: float = 0.144, kind: str = "C3D8I",
               lankford: tuple[float, float, float] | None = None) -> str:
    """The quarter; `cells` along a side, short ones as far as the stroke draws the blank over
    the die's edge. `lankford`: r at 0, 45, 90 degrees from x, the rolling direction (Hill 1948);
    without it the sheet is isotropic."""
    side = along_side(cells, 75.0, 56.0 if stroke <= 15.0 else 75.0)
    blank = mesh_make.block((75.0, 75.0, THICK), (cells, cells, layers), grading=(side, side, 1.0))
    blank = blank.with_points("SIDE",
                              lambda x: (x[:, 0] > 74.999) & (x[:, 1] < 1e-9) & (x[:, 2] < 1e-9))
    blank = blank.with_points("TIP", lambda x: (x[:, :2].min(axis=1) > 74.999) & (x[:, 2] < 1e-9))
    mesh = together(BLANK=lean(blank, "TOP BOTTOM", "LEFT FRONT SIDE TIP"))
    deck = text(mesh, f"""
A square cup drawn {stroke:g} mm deep from mild steel, a quarter of it, in space: NUMISHEET'93.

  y |________               Blank 150 x 150 x 0.78 mm, punch 70 x 70 (edge 8, corners 10), die 74 x 74
    |  die   |              (edge 5, corners 12); the holder presses with 19.6 kN. mu = 0.144,
    |___     | blank        sigma = 565.32 (0.007117 + eps)^0.2589 MPa.
    |   \\    |
    |punch|  |              Recalled from the conference: at 15 mm the edge has moved in by 6.2 mm
    |_____|__|___ x         in the middle of a side, by 3.2 at the corner. {cells} cells along a side
                            are few.
The tools are profiles that run around a square. The holder is held by its force alone.

{EXPECT if (cells, stroke) == (14, 15.0) else ""}
""", f"""*MATERIAL, NAME=STEEL
*ELASTIC
206000., 0.3
*PLASTIC
{swift(565.32, 0.007117, 0.2589)}
{section(lankford)}
*NODE, NSET=PUNCH_REF
900001, 0., 0., 20.
*NODE, NSET=DIE_REF
900002, 0., 0., -20.
*NODE, NSET=HOLDER_REF
900003, 0., 0., 20.
{led_around("PUNCH", f'''
START, 10., 60.
LINE, 10., {THICK + 8.0:g}
CIRCL, 2., {THICK:g}, 2., {THICK + 8.0:g}
LINE, 0., {THICK:g}''')}{led_around("DIE", '''
START, 12., -60.
LINE, 12., -5.
CIRCL, 17., 0., 17., -5.
LINE, 90., 0.''')}{led_around("HOLDER", f'''
START, 90., {THICK:g}
LINE, 17., {THICK:g}
CIRCL, 16., {THICK + 1.0:g}, 17., {THICK + 1.0:g}
LINE, 16., 20.''')}*SURFACE INTERACTION, NAME=OILED
*SURFACE BEHAVIOR, DIRECT
*FRICTION
{mu:g},
*CONTACT PAIR, INTERACTION=OILED
BLANK.TOP, PUNCH
*CONTACT PAIR, INTERACTION=OILED
BLANK.BOTTOM, DIE
*CONTACT PAIR, INTERACTION=OILED
BLANK.TOP, HOLDER
*BOUNDARY
BLANK.LEFT, 1
BLANK.FRONT, 2
DIE_REF, 1, 6
PUNCH_REF, 1, 2
PUNCH_REF, 4, 6
HOLDER_REF, 1, 2
HOLDER_REF, 4, 6
*STEP, NAME=HOLD, NLGEOM
*STATIC
1., 1.
*BOUNDARY
PUNCH_REF, 3, 3, 0.
*CLOAD
HOLDER_REF, 3, {-0.25*holder:g}
*END STEP
*STEP, NAME=DRAW, NLGEOM, INC=2000
*STATIC
0.002, 1., 1.E-6, 0.02
*BOUNDARY
PUNCH_REF, 3, 3, {-stroke:g}
*OUTPUT, FIELD, FREQUENCY=10
*NODE OUTPUT
U
*ELEMENT OUTPUT
S, PEEQ
*NODE PRINT, NSET=BLANK.SIDE
U
*NODE PRINT, NSET=BLANK.TIP
U
*END STEP
""", "3d")
    return deck.replace("TYPE=C3D8,", f"TYPE={kind},")


if __name__ == "__main__":
    print(square_cup(*(int(a) for a in sys.argv[1:2]), *(float(a) for a in sys.argv[2:3])), end="")
