"""The deck of a ball pressed into metal: `python decks/make/indenting.py > deck.inp`."""
from __future__ import annotations

import sys

import numpy as np
from deck_text import lean, text

from lopin import mesh_make
from lopin.mesh import together


def ticks(fine: int, part: float, coarse: int) -> np.ndarray:
    """fine equal intervals up to `part` of 1, then growing ones that begin as long."""
    rest, first = 1.0 - part, part/fine
    low, high = 1.0, 100.0
    for _ in range(200):
        ratio = 0.5*(low + high)
        low, high = (ratio, high) if first*sum(ratio**np.arange(coarse)) < rest else (low, ratio)
    steps = first*low**np.arange(coarse)
    return np.concatenate([np.linspace(0.0, part, fine + 1),
                           part + np.cumsum(steps)*rest/steps.sum()])


def ball_in_metal(fine: int = 36, depth: float = 100.0, size: float = 3000.0, *,
                  kind: str = "CAX4") -> str:
    """SSNV506 of code_aster: R = 500 mm, perfectly plastic, up to 100 mm deep."""
    part = 1.3*(2.0*500.0*depth)**0.5/size
    across, down = ticks(fine, part, fine//3), ticks(fine, part, fine//3)
    block = mesh_make.block((size, size), (len(across) - 1, len(down) - 1),
                            grading=(across, 1.0 - down[::-1]))
    block = block.moved(0.0, -size)
    mesh = together(BLOCK=lean(block, "TOP", "LEFT BOTTOM"))
    deck = text(mesh, """
A rigid ball pressed into a block that flows without hardening: SSNV506 of code_aster.

expect: certificate.verdict = PASS
""", f"""*MATERIAL, NAME=METAL
*ELASTIC
210000., 0.3
*PLASTIC
50., 0.
*SOLID SECTION, ELSET=BLOCK, MATERIAL=METAL
*NODE, NSET=BALL_REF
900001, 0., 500.
*SURFACE, NAME=BALL, TYPE=SEGMENTS
START, 500., 500.
CIRCL, 0., 0., 0., 500.
CIRCL, -500., 500., 0., 500.
*RIGID BODY, ANALYTICAL SURFACE=BALL, REF NODE=BALL_REF
*SURFACE INTERACTION, NAME=SMOOTH
*SURFACE BEHAVIOR, DIRECT
*CONTACT PAIR, INTERACTION=SMOOTH
BLOCK.TOP, BALL
*BOUNDARY
BLOCK.LEFT, 1
BLOCK.BOTTOM, 2
BALL_REF, 1
BALL_REF, 6
*STEP, NAME=PRESS, NLGEOM, INC=1000
*STATIC
0.01, 1., 1.E-6, 0.02
*BOUNDARY
BALL_REF, 2, 2, {-depth:g}
*OUTPUT, FIELD, FREQUENCY=10
*NODE OUTPUT
U
*ELEMENT OUTPUT
S, PEEQ
*END STEP
""", "axisymmetric")
    return deck.replace("TYPE=CAX4,", f"TYPE={kind},")


if __name__ == "__main__":
    print(ball_in_metal(*(int(a) for a in sys.argv[1:2])), end="")
