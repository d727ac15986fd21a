"""Half a billet upset by a rigid plate, as a deck: by element, mesh, increments, method and
friction."""
from __future__ import annotations

import numpy as np

import lopin
from lopin import mesh_make
from lopin.model import Model
from lopin.model_deck import mesh_deck

ELASTIC = "*MATERIAL, NAME=STEEL\n*ELASTIC\n200000., 0.3\n"
PLASTIC = "*PLASTIC\n700., 0.\n1300., 2.\n"
UPSET = """*SOLID SECTION, ELSET=ALL, MATERIAL=STEEL
*NODE, NSET=DIE_REF
900001, 0., 20.
*SURFACE, NAME=DIE, TYPE=SEGMENTS
START, 40., 15.
LINE, -1., 15.
*RIGID BODY, ANALYTICAL SURFACE=DIE, REF NODE=DIE_REF
*SURFACE INTERACTION, NAME=OIL
*SURFACE BEHAVIOR, {method}
*FRICTION
{mu},
*CONTACT PAIR, INTERACTION=OIL
SKIN, DIE
*BOUNDARY
LEFT, 1
BOTTOM, 2
DIE_REF, 1
DIE_REF, 6
*STEP, NLGEOM, INC=1000
*STATIC{direct}
{first!r}, 1.
*BOUNDARY
DIE_REF, 2, 2, {way!r}
*END STEP
"""


def billet(increments: int, *, mu: float = 0.0, share: float = 0.3, cells=(4, 6),
           direct: bool = True,
           word: str = "CAX4", method: str = "DIRECT", metal: bool = True) -> lopin.Deck:
    """Half a billet of radius 10 and height 30, pressed by a share of it."""
    mesh = mesh_make.block((10.0, 15.0), cells, quadratic=word.startswith("CAX8"))
    if word == "CAX3":
        mesh = mesh_make.simplices(mesh)
    skin = np.concatenate([mesh.surfaces["TOP"], mesh.surfaces["RIGHT"]])
    sets = {k: mesh.point_sets[k] for k in ("LEFT", "BOTTOM")}
    mesh = mesh.replaced(surfaces={"SKIN": skin}, point_sets=sets)
    head = mesh_deck(Model("mesh", mesh, kind="axisymmetric")).text()
    rest = UPSET.format(mu=mu, first=1.0/increments, way=-15.0*share, method=method,
                        direct=", DIRECT" if direct else "")
    head = head.replace("TYPE=CAX8", f"TYPE={word}").replace("TYPE=CAX4", f"TYPE={word}")
    text = head + ELASTIC + PLASTIC*metal + rest
    if mu == 0.0:
        text = text.replace("*FRICTION\n0.0,\n", "")
    return lopin.Deck.parse(text, "billet")
