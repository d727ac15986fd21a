"""Step: what a model is made to do. Values are reached at the end of the step, linearly."""
from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .errors import ModelError, UsageError
from .friction import Friction, friction_of

if TYPE_CHECKING:
    from .model import Model
    from .model_parts import Pair, Tool

#: What names points: a set, a tool, or 0-based indices of mesh points.
Points = "str | Tool | int | Sequence[int]"
_DIRECTIONS = {"x": 1, "y": 2, "z": 3, "rx": 4, "ry": 5, "rz": 6}
_REPLACED = ("supports", "forces", "pressures", "body forces", "temperatures")


class Load(NamedTuple):
    """A prescribed value or a force at points."""

    target: str | int       #: node set, or number of a node
    dof: int
    value: float
    amplitude: str = ""
    velocity: bool = False


class Request(NamedTuple):
    """A card that asks for output."""

    keyword: str
    words: tuple[str, ...]
    parameters: dict


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
    """Made by `Model.step`, which tells its arguments; every method returns the step."""

    def __init__(self, model: Model, increments: int, time: float, nlgeom: bool = False, *,
                 name: str = "", first: float | None = None, smallest: float | None = None,
                 largest: float | None = None, most: int | None = None, fixed: bool = False,
                 at_once: bool = False):
        if increments < 1 or not time > 0.0:
            raise UsageError(
                f"a step needs increments >= 1 and time > 0, not {increments} and {time}")
        for word, value in (("first", first), ("smallest", smallest), ("largest", largest),
                            ("most", most)):
            if value is not None and not value > 0:
                raise UsageError(f"{word} must be positive, not {value:g}")
        self.model, self.increments, self.time = model, increments, time
        self.nlgeom, self.name, self.fixed, self.at_once = nlgeom, name, fixed, at_once
        size = time/increments
        self.first = size if first is None else first
        self.smallest = 1e-6*time if smallest is None else smallest
        self.largest = max(size, self.first) if largest is None else largest
        self.most = max(100, 20*increments) if most is None else most
        self.moves: list[Load] = []
        self.forces: list[Load] = []
        self.pressures: list[tuple[str, str, list[float], str]] = []
        self.body: list[tuple[str, str, list[float], str]] = []
        self.temperatures: list[tuple[str | int, float, str]] = []
        self.removed: list[Pair] = []
        self.added: list[Pair] = []
        self.frictions: list[tuple[Pair, Friction]] = []
        self.replaced: set[str] = set()
        self.checkpoints: int | None = None
        self.outputs: list[Request] | None = None   # None: the usual ones
        self.prints: list[Request] = []

    def move(self, points: Points, *, amplitude: str = "", velocity: bool = False,
             **values: float | ArrayLike) -> Step:
        """Prescribe displacements [length] or rotations [rad]: ``move(die, y=-1.0)``.

        Parameters
        ----------
        points : a point set, a tool, or 0-based indices of mesh points
        amplitude : name from `Model.amplitude`; unless given, the value grows linearly
        velocity : the values are speeds [length/time], which go on from where the step finds them
        values : by direction, "x", "y", "z", "r", "rx"...; an array has an entry a point

        Raises
        ------
        ModelError : no such set or amplitude; UsageError : no such direction.
        """
        amplitude = self.model.known_amplitude(amplitude)
        self.moves += [load._replace(amplitude=amplitude, velocity=velocity)
                       for load in self.model.loads(points, values)]
        return self

    def fix(self, points: Points, *directions: str | int) -> Step:
        """Hold points where they began, from this step on."""
        self.moves += self.model.loads(points, {d: 0.0 for d in directions})
        return self

    def force(self, points: Points, *, each: bool = False, amplitude: str = "",
              **values: float | ArrayLike) -> Step:
        """A force [force] on a tool or a point; full circumference if axisymmetric.

        `each`: the set has several points, and each takes the force. Other arguments as in `move`.
        """
        several = isinstance(points, str) and len(self.model.mesh.point_sets.get(points, [0])) != 1
        if several and not each:
            raise ModelError(f"set '{points}' has several points: a force on each is rarely meant",
                             help="use pressure() on a surface, or a set of one point")
        amplitude = self.model.known_amplitude(amplitude)
        self.forces += [load._replace(amplitude=amplitude)
                        for load in self.model.loads(points, values)]
        return self

    def pressure(self, surface: str, value: float, *, amplitude: str = "") -> Step:
        """A pressure on a surface, positive into the body [stress]; it follows under NLGEOM."""
        return self._on_surface(surface, "P", [float(value)], amplitude)

    def traction(self, surface: str, value: float, towards: Sequence[float], *,
                 amplitude: str = "") -> Step:
        """A traction [stress] on a surface along a direction that stays."""
        return self._on_surface(surface, "TRVEC", [float(value), *map(float, towards)], amplitude)

    def gravity(self, elements: str, value: float, towards: Sequence[float], *,
                amplitude: str = "") -> Step:
        """Gravity of a magnitude [length/time^2] in a direction; the material needs a density."""
        return self._on_elements(elements, "GRAV", [float(value), *map(float, towards)], amplitude)

    def body_force(self, elements: str, *, amplitude: str = "", **values: float) -> Step:
        """Forces per volume [force/length^3] by direction: ``body_force("ALL", y=-2.0)``."""
        for name, value in values.items():
            word = "B" + "XYZ"[self.model.dof(name) - 1]
            self._on_elements(elements, word, [float(value)], amplitude)
        return self

    def temperature(self, points: Points, value: float | ArrayLike, *,
                    amplitude: str = "") -> Step:
        """Temperature at the end of the step; the material needs an expansion to feel it."""
        amplitude = self.model.known_amplitude(amplitude)
        self.temperatures += [(target, number, amplitude)
                              for target, number in self.model.valued(points, value)]
        return self

    def replace(self, *what: str) -> Step:
        """Forget what the model and earlier steps said; what this step says is all.

        `what`: of "supports" (prescribed displacements; tools stay held where nothing drives
        them), "forces", "pressures" (and tractions), "body forces" (and gravity), "temperatures".
        """
        for word in what:
            if word not in _REPLACED:
                raise UsageError(f"nothing to replace is called '{word}'; "
                                 f"known: {', '.join(_REPLACED)}")
        self.replaced |= set(what)
        return self

    def remove_contact(self, *pairs: Pair | tuple[str, str]) -> Step:
        """Take pairs (from `Model.contact`, or slave and master) out, from this step on."""
        self.removed += [self.model.known_pair(pair) for pair in pairs]
        return self

    def add_contact(self, *pairs: Pair | tuple[str, str]) -> Step:
        """Put pairs back that an earlier step took out."""
        self.added += [self.model.known_pair(pair) for pair in pairs]
        return self

    def change_friction(self, pair: Pair | tuple[str, str], friction: float | Friction) -> Step:
        """Another law of friction for a pair, from this step on."""
        self.frictions.append((self.model.known_pair(pair), friction_of(friction)))
        return self

    def output(self, points: Sequence[str] = ("U", "RF"), elements: Sequence[str] = ("S",),
               contact: Sequence[str] = ("CDIS", "CSTR"), *, every: int = 1) -> Step:
        """Fields in the result files, after every so many increments and the last one.

        Once called, only what it asks for is written; a kind left empty goes on as the step before
        had it. Words are those of the deck: U, RF; S, E, PEEQ; CDIS, CSTR, CF.
        """
        kinds = {"NODE FILE": points, "EL FILE": elements, "CONTACT FILE": contact}
        frequency = {} if every == 1 else {"frequency": every}
        self.outputs = [*(self.outputs or []), *(Request(k, tuple(w), frequency)
                                                 for k, w in kinds.items() if w)]
        return self

    def table(self, what: str | Tool | Pair, *words: str, of: str = "points", every: int = 1,
              totals: str = "no") -> Step:
        """A table in the .dat file, and columns in the history.

        Parameters
        ----------
        what : a point set or a tool (U, RF), a pair (CDIS, CSTR, CF...), or an element set with
            ``of="elements"`` (S, E)
        every : after every so many increments and the last one, >= 1; 0: never
        totals : "no", "yes" (sums follow the table) or "only"
        """
        if totals not in ("no", "yes", "only"):
            raise UsageError(f"totals is 'no', 'yes' or 'only', not '{totals}'")
        more = {} if every == 1 else {"frequency": every}
        more |= {} if totals == "no" else {"totals": totals.upper()}
        if hasattr(what, "slave"):
            request = Request("CONTACT PRINT", words, {"slave": what.slave,
                                                       "master": what.master, **more})
        elif of == "elements":
            self.model.known(what, "element")
            request = Request("EL PRINT", words, {"elset": what, **more})
        else:
            request = Request("NODE PRINT", words, {"nset": self.model.point_set(what), **more})
        self.prints.append(request)
        return self

    def checkpoint(self, every: int) -> Step:
        """Keep the state for `resume` after every so many increments; 0: where it is broken off."""
        if every < 0:
            raise UsageError(f"a checkpoint comes after 0 or more increments, not {every}")
        self.checkpoints = every
        return self

    def _on_surface(self, surface, word, data, amplitude) -> Step:
        self.model.known(surface, "surface")
        self.pressures.append((surface, word, data, self.model.known_amplitude(amplitude)))
        return self

    def _on_elements(self, elements, word, data, amplitude) -> Step:
        self.model.known(elements, "element")
        self.body.append((elements, word, data, self.model.known_amplitude(amplitude)))
        return self

    def __repr__(self) -> str:
        name = f"{self.name!r}, " if self.name else ""
        values = np.unique([load.target for load in self.moves + self.forces]).tolist()
        return f"Step({name}time {self.time:g}, drives {', '.join(map(str, values)) or 'nothing'})"
