"""Scenes of the stability atlas: small, in any units, turned by any angle.

A `Frame` is what no answer may depend on: an angle, a unit of length and a unit of stress. Supports
and motions prescribe both components of a displacement, so that every scene can be turned.
"""
from __future__ import annotations

from dataclasses import dataclass
from math import cos, radians, sin

import numpy as np
from numpy.typing import NDArray

from ..charts.run import light
from ..deck import Deck
from ..laws import Elastic
from ..mesh import make as mesh_make
from ..mesh.mesh import Mesh, together
from ..model import Model


@dataclass(frozen=True)
class Frame:
    """How a scene is written down: turned, and in which units."""

    angle: float = 0.0      #: [degrees]
    length: float = 1.0     #: the unit of length, in that of the deck
    stress: float = 1.0     #: the unit of stress, in that of the deck

    @classmethod
    def random(cls, rng: np.random.Generator) -> Frame:
        """Any angle, lengths from 1e-3 to 1e3, stresses from 1e-3 to 1e6."""
        return cls(float(rng.uniform(-180.0, 180.0)), float(10.0**rng.uniform(-3.0, 3.0)),
                   float(10.0**rng.uniform(-3.0, 6.0)))

    def turn(self) -> NDArray:
        """The rotation, (2, 2)."""
        c, s = cos(radians(self.angle)), sin(radians(self.angle))
        return np.array([[c, -s], [s, c]])

    def place(self, mesh: Mesh) -> Mesh:
        """A mesh seen from here."""
        return mesh.mapped(lambda x: self.length*(x @ self.turn().T))

    def motion(self, x: float, y: float) -> dict[str, float]:
        """A displacement seen from here."""
        turned = self.length*(self.turn() @ np.array([x, y]))
        return {"x": float(turned[0]), "y": float(turned[1])}


PLAIN = Frame()


def crown(ratio: float, frame: Frame = PLAIN, cells: int = 10, mortar: bool = False,
          depth: float = 0.02) -> Deck:
    """A crowned block of modulus 1 pressed on a block of modulus `ratio`; facets of 2/cells.

    Plane strain, Poisson's ratio 0.3; the crown (radius 10) is the slave.
    """
    upper = _named(mesh_make.block((2.0, 1.0), (cells, cells//2), origin=(-1.0, 0.0)))
    upper = upper.mapped(lambda x: np.column_stack(
        [x[:, 0], x[:, 1] + (1.0 - x[:, 1])*x[:, 0]**2/20.0]))
    lower = _named(mesh_make.block((3.0, 1.0), (cells + 3, cells//2), origin=(-1.5, -1.0)))
    return _pressed("crown", upper, lower, ratio, frame, mortar, depth)


def flat(slave: int, master: int, ratio: float, frame: Frame = PLAIN, mortar: bool | None = False,
         depth: float = 0.02) -> Deck:
    """Two blocks face to face, 1 wide, with so many facets; free sides, no Poisson effect: the
    pressure is uniform, depth/(1 + 1/ratio). `mortar`: None leaves it to the plan."""
    upper = _named(mesh_make.block((1.0, 0.5), (slave, max(2, slave//2))))
    lower = _named(mesh_make.block((1.0, 0.5), (master, max(2, master//2)), origin=(0.0, -0.5)))
    return _pressed("flat", upper, lower, ratio, frame, mortar, depth, poisson=0.0)


def _pressed(name: str, upper: Mesh, lower: Mesh, ratio: float, frame: Frame, mortar: bool | None,
             depth: float, poisson: float = 0.3) -> Deck:
    """The top of the upper body moves down on the lower, whose bottom is held."""
    model = Model(name, frame.place(together(UP=upper, LOW=lower)), kind="plane strain")
    model.section("UP", Elastic(frame.stress, poisson))
    model.section("LOW", Elastic(frame.stress*ratio, poisson))
    model.contact("UP.BOTTOM", "LOW.TOP", surface_to_surface=mortar)
    model.fix("LOW.BOTTOM", "x", "y")
    model.step().move("UP.TOP", **frame.motion(0.0, -depth))
    return light(model.to_deck())


def _named(mesh: Mesh) -> Mesh:
    """TOP and BOTTOM only."""
    kept = ("TOP", "BOTTOM")
    return mesh.replaced(surfaces={k: mesh.surfaces[k] for k in kept},
                         point_sets={k: mesh.point_sets[k] for k in kept})
