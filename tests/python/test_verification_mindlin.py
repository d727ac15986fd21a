"""A8: two equal spheres pressed, then sheared to and fro (Mindlin 1949, Mindlin and Deresiewicz 1953)."""
import sys
from pathlib import Path

import numpy as np
import pytest

lopin = pytest.importorskip("lopin")
sys.path.insert(0, str(Path(__file__).resolve().parents[2]/"decks"/"make"))

DECK = """*HEADING
Two spheres, half of them, N mm
{mesh}
*NODE, NSET=HANDLE
900001, 0., 0., 40.
*MATERIAL, NAME=STEEL
*ELASTIC
210000., 0.3
*SOLID SECTION, ELSET=UP, MATERIAL=STEEL
*SOLID SECTION, ELSET=LOW, MATERIAL=STEEL
*RIGID BODY, NSET=UP.TOP, REF NODE=900001
*SURFACE INTERACTION, NAME=DRY
*SURFACE BEHAVIOR, DIRECT
*FRICTION
0.3,
*CONTACT PAIR, INTERACTION=DRY, SMALL SLIDING
UP.NEAR, LOW.NEAR
*BOUNDARY
LOW.BOTTOM, 1, 3
UP.FRONT, 2
LOW.FRONT, 2
HANDLE, 2
HANDLE, 4, 6
*AMPLITUDE, NAME=TOFRO
0., 0., 1., 1., 3., -1., 5., 1.
*STEP, INC=100
*STATIC, DIRECT
0.1, 1.
*CLOAD
HANDLE, 3, -500.
*END STEP
*STEP, INC=200
*STATIC, DIRECT
0.1, 5.
*CLOAD, AMPLITUDE=TOFRO
HANDLE, 1, 50.
*NODE PRINT, NSET=HANDLE
U
*CONTACT FILE
CDIS, CSTR
*END STEP
"""


def build():
    from friction_meshes import mindlin
    return DECK.format(mesh=mindlin().text().strip())
