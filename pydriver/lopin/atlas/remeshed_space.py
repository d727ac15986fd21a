"""The closed die of map 14 in space: a quarter of the disc, of tetrahedra that are made anew.

The reference is the axisymmetric disc on one fine mesh, to the stroke at which flash begins. The
first mesh has the volume of the round disc: chords of 16 to the quarter lack 0.16 % of it, and as
the die closes a force grows by 1 % in 3 micrometres of stroke.
"""
from __future__ import annotations

import numpy as np

from ..deck import Deck
from ..mesh import make as mesh_make
from ..mesh.mesh import Mesh, together
from ..model import Model
from ..model_deck import mesh_deck
from .remeshed import Pressed, RemeshedOutcome, disc, hot, judged, press, pressed, profile
from .scenes import PLAIN, Frame

#: Cells inside (next to the die they may be a quarter), and the strain since the last mesh that
#: asks for a new one; none: one mesh.
CELLS = ((3.2, 0.25), (2.13, 0.25), (3.2, 0.5), (2.13, 0.5), (1.6, 0.5), (3.2, 0.7), (2.13, 0.7),
         (1.6, 0.7), (3.2, None), (2.13, None), (1.6, None))
#: Cells of the reference, strokes at which forces are compared.
FINE, STROKES = 0.25, (2.0, 3.5, 4.0, 4.4)
RADIUS, HEIGHT = 15.0, 12.0


def round_quarter(size: float) -> Mesh:
    """A quarter of a cylinder of tetrahedra with the volume of the round one; sides SKIN, X0, Y0
    and Z0."""
    cells = (round(12.8/size), max(2, round(9.6/size)))
    mesh = mesh_make.simplices(mesh_make.cylinder(RADIUS, HEIGHT, cells, part="quarter"))
    turned = mesh.points @ np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    corner = turned[mesh.blocks[0][1]]
    volume = np.abs(np.linalg.det(corner[:, 1:] - corner[:, :1])).sum()/6.0
    wider = np.sqrt(0.25*np.pi*RADIUS**2*HEIGHT/volume)
    mesh = mesh.replaced(points=turned*[wider, wider, 1.0], surfaces={}, point_sets={
        name: np.flatnonzero(np.abs(turned[:, k]) < 1e-9)
        for k, name in enumerate(("X0", "Y0", "Z0"))})
    return mesh.with_surface("SKIN", lambda x: (np.abs(x) > 1e-9).all(axis=1))


def quarter(size: float, trigger: float | None, frame: Frame = PLAIN) -> Deck:
    """A quarter of the hot disc under the closed die; without a trigger on one mesh."""
    unit = frame.length
    card = "" if trigger is None else (f"*REMESH, ELSET=BILLET, SIZE={size*unit:.12g}, "
                                       f"SMALLEST={0.25*size*unit:.12g}, STRAIN={trigger:g}\n")
    billet = together(BILLET=round_quarter(size).mapped(lambda x: x*unit))
    mesh = mesh_deck(Model("quarter", billet, kind="3d")).text()
    # In space a profile ends on its axis.
    lines = profile(unit).replace(f"LINE, {-unit:.12g},", "LINE, 0,")
    return Deck.parse(f"""{mesh}{hot(frame.stress)}*NODE, NSET=DIE_REF
900001, 0., 0., {20.0*unit:.12g}
*SURFACE, NAME=DIE, TYPE=REVOLUTION
0., 0., 0., 0., 0., {unit:.12g}
{lines}*RIGID BODY, ANALYTICAL SURFACE=DIE, REF NODE=DIE_REF
*SURFACE INTERACTION, NAME=GRAPHITE
*SURFACE BEHAVIOR, DIRECT
*FRICTION
0.1,
*CONTACT PAIR, INTERACTION=GRAPHITE
BILLET.SKIN, DIE
*BOUNDARY
BILLET.X0, 1
BILLET.Y0, 2
BILLET.Z0, 3
DIE_REF, 1, 2
DIE_REF, 4, 6
{card}{press(3, unit, STROKES[-1])}""", name="quarter")


def fine() -> Pressed:
    """The axisymmetric reference."""
    return pressed(disc(FINE, None, end=STROKES[-1]), strokes=STROKES)


def in_space(size: float, trigger: float | None, right: Pressed) -> RemeshedOutcome:
    """A quarter disc beside the reference."""
    return judged(pressed(quarter(size, trigger), strokes=STROKES), right)
