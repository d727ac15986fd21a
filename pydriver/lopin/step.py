"""Step: what a model is made to do. Values are reached at the end of the step, linearly."""
from __future__ import annotations

from typing import TYPE_CHECKING

from .errors import ModelError, UsageError

if TYPE_CHECKING:
    from .model import Model, Tool

_DIRECTIONS = {"x": 1, "y": 2, "z": 3, "rx": 4, "ry": 5, "rz": 6}


def direction(name: str | int, kind: str) -> int:
    """Number of a direction in a scene of some kind.

    >>> direction("z", "axisymmetric"), direction("z", "3d"), direction("rz", "plane strain")
    (2, 3, 6)
    """
    known = {"r": 1, "z": 2, "rz": 6} if kind == "axisymmetric" else dict(_DIRECTIONS)
    if kind.startswith("plane"):
        known = {k: v for k, v in known.items() if v in (1, 2, 6)}
    if isinstance(name, int) and name in known.values():
        return name
    if name not in known:
        raise UsageError(f"no direction '{name}' in a scene that is {kind}; "
                         f"known: {', '.join(known)}")
    return known[name]


class Step:
    """Made by `Model.step`; every method returns the step."""

    def __init__(self, model: Model, increments: int, time: float, nlgeom: bool = False):
        if increments < 1 or time <= 0.0:
            raise UsageError(
                f"a step needs increments >= 1 and time > 0, not {increments} and {time}")
        self.model, self.increments, self.time = model, increments, time
        self.nlgeom = nlgeom
        self.moves: list[tuple[str, int, float]] = []
        self.forces: list[tuple[str, int, float]] = []
        self.pressures: list[tuple[str, float]] = []
        self.body: list[tuple[str, float, tuple[float, ...]]] = []

    def move(self, points: str | Tool, **values: float) -> Step:
        """Prescribe displacements [length] or rotations [rad]: ``move(die, y=-1.0)``."""
        name = self.model.point_set(points)
        self.moves += [(name, self.model.dof(d), float(v)) for d, v in values.items()]
        return self

    def force(self, points: str | Tool, **values: float) -> Step:
        """A force [force] on a tool or a set of one point; full circumference if axisymmetric."""
        name = self.model.point_set(points)
        if isinstance(points, str) and len(self.model.mesh.point_sets[points]) != 1:
            raise ModelError(f"set '{points}' has several points: a force on each is rarely meant",
                             help="use pressure() on a surface, or a set of one point")
        self.forces += [(name, self.model.dof(d), float(v)) for d, v in values.items()]
        return self

    def pressure(self, surface: str, value: float) -> Step:
        """A pressure on a surface, positive into the body [stress]."""
        self.model.mesh.surface_points(surface)
        self.pressures.append((surface, float(value)))
        return self

    def gravity(self, elements: str, value: float, towards: tuple[float, ...]) -> Step:
        """Gravity of a magnitude [length/time^2] in a direction; the material needs a density."""
        self.body.append((elements, float(value), tuple(map(float, towards))))
        return self
