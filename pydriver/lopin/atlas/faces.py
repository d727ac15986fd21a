"""Map 15 of the atlas: faces. Element word of the slave by what it meets and by the facets.

A uniform pressure and a uniform shear (see `atlas_blocks`) are what every face must pass on. A cell
is wrong if any node, or the drag, is off by more than 5 % and no warning speaks of it.
"""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..charts.run import WRONG
from ..deck import Deck
from ..errors import LopinError
from ..run import run
from .blocks import PRESSURE, SHEAR, Scene, pressed_deck, rotation
from .cells import Cell, Outcome, refusal
from .scenes import PLAIN, Frame

#: Facets of slave and master along the slide.
FACETS = ((7, 4), (4, 3), (3, 3), (3, 4), (5, 7), (10, 15), (4, 7))
#: Slaves, each with a word of other order or shape as its other master.
WORDS = {"CPE3": "CPE8", "CPE4": "CPE6", "CPE6": "CPE4", "CPE8": "CPE3", "CPS4": "CPS8",
         "CPS8": "CPS4", "CAX3": "CAX8", "CAX4": "CAX6", "CAX6": "CAX4", "CAX8": "CAX3",
         "C3D4": "C3D20", "C3D6": "C3D10", "C3D8": "C3D15", "C3D10": "C3D8", "C3D15": "C3D4",
         "C3D20": "C3D10", "C3D20R": "C3D6"}
#: What a slave meets: name, master (own or other word), surface to surface (None: not told),
#: friction of Coulomb, and by what the master is wider at either end.
MASTERS = (("tool", "", True, False, 0.0), ("own, nodes", "own", False, False, 0.0),
           ("own, surface", "own", True, False, 0.0), ("own, Coulomb", "own", True, True, 0.0),
           ("wider, nodes", "own", False, False, 0.2), ("wider, surface", "own", True, False, 0.2),
           ("other, surface", "other", True, False, 0.2),
           ("own, as it comes", "own", None, False, 0.0),
           ("wider, as it comes", "own", None, False, 0.2))
LEVELS = [(f"{name}{', NLGEOM' if finite else ''}", *rest, finite)
          for name, *rest in MASTERS for finite in (False, True)]
#: Under NLGEOM these meet the tool and their own word, surface to surface, only: seconds a solve.
SLOW = ("C3D10", "C3D15", "C3D20", "C3D20R")
#: Warnings that say that a pressure or a force of contact is off.
SPEAK = ("W0333",)


@dataclass
class FaceCell(Cell):
    """With the error of the tangential force; `error` is that of the worst node's pressure."""

    drag: float = np.nan


@dataclass
class FaceOutcome(Outcome):
    """The error of the tangential force besides."""

    drag: float = np.nan


class FaceMap:
    """Facets of slave and master by what the slave meets; a panel an element word."""

    number, name = 15, "faces"
    title = "Map 15: faces; uniform pressure and uniform shear are the exact solution"
    labels = ("facets of slave : master", "")
    colour, across, linear, cell = "faces", 3, True, FaceCell
    panels = tuple(WORDS)
    ticks = ([f"{n}:{m}" for n, m in FACETS], [level[0] for level in LEVELS])

    def grid(self, panel: str, small: bool) -> tuple[NDArray, NDArray]:
        """The values of x and y: places in FACETS and LEVELS."""
        x, y = np.arange(len(FACETS)), np.arange(len(LEVELS))
        if panel in SLOW:
            y = np.array([k for k in y if not LEVELS[k][-1] or k in (1, 5)])
        if small and panel in SLOW:
            return x[[3]], y[[1, 2, 3, 8]]
        return (x[[3]], y[[1, 2, 4, 13]]) if small else (x, y)

    def frame(self, rng: np.random.Generator) -> Frame:
        """Any angle, in very small or very large units."""
        return Frame(float(rng.uniform(-180.0, 180.0)), float(rng.choice([1e-3, 1e3])),
                     float(rng.choice([1e-6, 1e6])))

    def scene(self, panel: str, x: float, y: float) -> Scene:
        """Of a cell."""
        _, master, to_surface, coulomb, margin, finite = LEVELS[round(y)]
        word = {"": "", "own": panel, "other": WORDS[panel]}[master]
        return Scene(panel, word, FACETS[round(x)], to_surface, finite, coulomb,
                     margin)

    def deck(self, panel: str, x: float, y: float, frame: Frame = PLAIN) -> Deck:
        """The deck of a cell."""
        return pressed_deck(self.scene(panel, x, y), frame)

    def solve(self, panel: str, x: float, y: float, frame: Frame = PLAIN) -> FaceOutcome:
        """What happens in a cell."""
        scene = self.scene(panel, x, y)
        try:
            result = run(pressed_deck(scene, frame))
        except LopinError as problem:
            result = getattr(problem, "result", None)
            if problem.id != "E0504" or result is None:
                return FaceOutcome(refusal(problem.id), said=problem.id)
        verdict = result.summary["certificate"]["verdict"]
        said = list(dict.fromkeys(w.partition(":")[0] for w in result.warnings))
        pressure, drag = errors(result, scene, frame)
        kind = "F0"
        if not np.isfinite(pressure):
            kind = "F4"
        elif verdict != "PASS":
            kind = "W"
        elif max(pressure, drag if scene.dragged else 0.0) > WRONG:
            kind = "W" if any(code in said for code in SPEAK) else "F1"
        iterations = sum(step["iterations"] for step in result.summary["steps"])
        return FaceOutcome(kind, pressure, iterations, " ".join([verdict, *said]), drag)

    def theory(self, panel: str) -> list[tuple[str, NDArray, NDArray]]:
        """Nothing: every cell should be exact."""
        return []


def errors(result, scene: Scene, frame: Frame) -> tuple[float, float]:
    """Of the worst node's pressure at the ends of both steps, and of the force of the drag."""
    history, d = result.contact(0), scene.ndim
    ends = [history.last, *([history.at(0)] if scene.dragged else [])]
    pressure = max(float(np.abs(end.pressure/(PRESSURE*frame.stress) - 1.0).max()) for end in ends)
    if not scene.dragged:
        return pressure, np.nan
    name = f"UPSBOTTOM-{'LOWSTOP' if scene.master else 'TOOL'}.force"
    force = np.array([result.history[f"{name}{k + 1}"][-1] for k in range(d)])
    force = rotation(frame, d).T @ force/(SHEAR*frame.stress*scene.area()*frame.length**2)
    wanted = np.zeros(d - 1)
    wanted[0] = 1.0
    return pressure, float(np.linalg.norm(np.abs(force[:-1]) - wanted))
