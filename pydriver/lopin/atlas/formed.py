"""Cells of forming scenes: run to the end or not, and judged beside the same scene in small steps.

The reference of a cell is the exact method in increments of a fiftieth, on the same mesh and tools;
where that does not end, a penalty. Compared are the forces of the tools that are driven, as means
over the last fifth of each step (nodes that pass an edge make them ripple), the shapes at the ends
of all steps, and what a body springs back by where its tools let go.
"""
from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ..charts.run import WRONG
from ..deck import Deck
from ..errors import LopinError
from ..result import Result
from ..run import run
from .cells import Cell, Outcome
from .metal import Metal
from .scenes import Frame

#: Increments of a reference, first and largest.
FINE = (0.02, 0.02)
#: Warnings that say that a force or a shape may be off, beside the certificate's verdict.
SPEAK = ("W0327", "W0340", "W0349", "W0514", "W0515", "W0517", "W0518", "W0519", "W0522", "W0530",
         "W0531", "W0552", "W0553", "W0560", "W0561", "W0562", "W0563", "W0565")
#: What the codes of runs that stop mean; others: the linear solver.
_CODES = {"E0501": "F3", "E0502": "F2", "E0503": "F2", "E0504": "W", "E0505": "F2", "E0510": "F2",
          "E0512": "F4", "E0513": "F4", "E0514": "F4", "E0520": "F3", "E0550": "F2",
          "E0551": "F2", "E0553": "F2"}


@dataclass
class FormingCell(Cell):
    """With what the run took, and how much of its way it went."""

    reached: float = np.nan       #: share of all steps [-]
    increments: int = 0
    seconds: float = np.nan       #: of the cell as it is, CPU


@dataclass
class FormingOutcome(Outcome):
    """With what the run took, and how much of its way it went."""

    reached: float = np.nan
    increments: int = 0
    seconds: float = np.nan


@dataclass
class Formed:
    """A run in the units of the plain frame; forces and shapes at the ends of its steps."""

    code: str = ""                #: of what stopped it
    verdict: str = ""
    warned: list[str] = field(default_factory=list)
    iterations: int = 0
    increments: int = 0
    reached: float = 0.0
    seconds: float = 0.0
    #: Of tools along the ways they go, mean over the last fifth of a step.
    forces: list[NDArray] = field(default_factory=list)
    shapes: list[NDArray] = field(default_factory=list)   #: displacements of the body


def formed(scene: Metal, body: int, steps: int) -> Formed:
    """Run a scene with a body of so many nodes."""
    deck, begin = scene.deck(), time.process_time()
    try:
        result, code = run(deck), ""
    except LopinError as problem:
        result, code = getattr(problem, "result", None), problem.id or type(problem).__name__
    found = Formed(code, seconds=time.process_time() - begin)
    if result is None:
        return found
    found.verdict = result.verdict
    found.warned = sorted({w.partition(":")[0] for w in result.warnings})
    for step in result.summary.get("steps", []):
        found.iterations += step["iterations"]
        found.increments += step["increments"]
    if len(result.times):
        found.reached = float(result.times[-1])/steps
        _measure(found, result, scene, body)
    return found


def _measure(found: Formed, result: Result, scene: Metal, body: int) -> None:
    """Forces and shapes at the ends of the steps, as the plain frame has them."""
    frame, history = scene.frame, result.history
    unit = frame.stress*frame.length**2
    steps = np.asarray(history["step"]).astype(int)
    for step in np.unique(steps):
        at = int(np.flatnonzero(steps == step)[-1])
        mine = np.flatnonzero(steps == step)
        mine = np.concatenate([mine[:1] - 1, mine]) if mine[0] else mine
        found.forces.append(np.array([_late(history, tool, k, mine, step, scene)/unit
                                      for tool, k in sorted(scene.driven)]))
        moved = np.asarray(result.at(at)["U"])[:body, :scene.ndim]
        found.shapes.append(moved @ scene.turn/frame.length)


def _late(history: dict, tool: str, axis: int, rows: NDArray, step: int, scene: Metal) -> float:
    """Mean force on a tool along an axis over the last fifth of a step of length 1."""
    time = np.asarray(history["time"])[rows]
    force = np.array([history[f"{tool}.rf{k + 1}"][rows] for k in range(scene.ndim)])
    along = scene.turn[:, axis] @ force
    span = np.linspace(step - 0.2, step, 101)
    return float(np.interp(span, time, along).mean())


def difference(one: Formed, other: Formed, springback: bool) -> float:
    """Largest relative difference of forces, shapes and, at the last step, what springs back."""
    if len(one.shapes) != len(other.shapes):
        return np.nan
    found = 0.0
    largest = max(np.abs(f).max() for f in other.forces)
    pressing = slice(0, -1) if springback else slice(None)
    for a, b in zip(one.forces[pressing], other.forces[pressing]):
        found = max(found, float(np.abs(a - b).max()/largest))
    for a, b in zip(one.shapes, other.shapes):
        found = max(found, _apart(a, b))
    if springback:
        (a, b), (c, d) = one.shapes[-2:], other.shapes[-2:]
        found = max(found, _apart(_in_place(b - a), _in_place(d - c)))
    return found


def _in_place(moved: NDArray) -> NDArray:
    """Without the mean motion along the last axis, which nothing holds."""
    moved = moved.copy()
    moved[:, -1] -= moved[:, -1].mean()
    return moved


def _apart(a: NDArray, b: NDArray) -> float:
    return float(np.linalg.norm(a - b)/np.linalg.norm(b))


def judged(found: Formed, right: Formed | None, springback: bool = False) -> FormingOutcome:
    """The class of a run beside its reference; without one it stays unjudged (no error)."""
    said = " ".join([found.code or found.verdict, *found.warned])
    error = np.nan
    if right is not None and not (found.code and found.code != "E0504"):
        error = difference(found, right, springback)
    if found.code:
        kind = _CODES.get(found.code, "F5")
    elif found.verdict != "PASS":
        kind = "W"
    elif error > WRONG:
        kind = "W" if any(code in said for code in SPEAK) else "F1"
    else:
        kind = "F0"
    return FormingOutcome(kind, error, found.iterations, said, found.reached, found.increments,
                          found.seconds)


class FormingMap:
    """What the maps of forming scenes share: `scene` writes a cell, `reference` its reference."""

    linear, cell = True, FormingCell
    colour, across = "increments", 4
    #: Scenes whose last step is a release.
    released: tuple[str, ...] = ()

    def __init__(self):
        self._references: dict[tuple, Formed | None] = {}

    def frame(self, rng: np.random.Generator) -> Frame:
        """Any angle; small and large units."""
        return Frame(float(rng.uniform(-180.0, 180.0)), float(10.0**rng.uniform(-3.0, 3.0)),
                     float(10.0**rng.uniform(-3.0, 6.0)))

    def deck(self, panel: str, x: float, y: float, folder=None) -> Deck:
        """The deck of a cell."""
        return self.scene(panel, x, y, Frame(), folder)[0].deck()

    def solve(self, panel: str, x: float, y: float, frame: Frame = Frame()) -> FormingOutcome:
        """What happens in a cell."""
        scene, body, steps = self.scene(panel, x, y, frame)
        key = self.reference_key(panel, x, y)
        if key not in self._references:
            self._references[key] = self._reference(key)
        return judged(formed(scene, body, steps), self._references[key], self.is_released(panel))

    def is_released(self, panel: str) -> bool:
        """Whether the last step lets go."""
        return any(panel.startswith(name) for name in self.released)

    def _reference(self, key: tuple) -> Formed | None:
        for way in self.ways_of(key):
            scene, body, steps = self.reference(key, way)
            found = formed(scene, body, steps)
            if not found.code:
                return found
        return None

    def ways_of(self, key: tuple) -> tuple:
        """How a reference is tried: methods and increments."""
        return self.reference_ways

    #: The same, of maps whose scenes are alike in it.
    reference_ways: tuple = (("lagrange", FINE), ("penalty", FINE), ("lagrange", (0.005, 0.005)),
                             ("lagrange", ()))

    def theory(self, panel: str) -> list[tuple[str, NDArray, NDArray]]:
        """Nothing is known beforehand."""
        return []


Builder = Callable[..., tuple[Metal, int, int]]
