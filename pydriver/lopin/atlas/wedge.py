"""Map 6 of the atlas: one point with Coulomb friction whose two compliances are coupled.

Klarbring's example (Ing.-Arch. 60, 1990, 529): a point on two springs that do not stand along and
across the wall. One increment from rest; open, stick and the two slips are tried one by one on
paper, so that the number of answers is known.
"""
from __future__ import annotations

import json
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .._bridge import probe_friction_increment
from ..charts.run import WRONG
from ..files import whole_file
from .cells import Outcome
from .scenes import PLAIN, Frame

#: Gaps without forces (across, along) by panel.
LOADS = {"pressed": (-1.0, 0.0), "pressed, drawn forward": (-1.0, 1.0),
         "pressed, drawn back": (-1.0, -1.0), "lifted, drawn forward": (0.2, 1.0),
         "lifted, drawn back": (0.2, -1.0)}
#: Beside the size of the terms: an answer on the border of two states counts for both.
BORDER = 1e-9


def compliance(coupling: float) -> NDArray:
    """Of a point with K_nn = K_tt = 1 and K_tn = coupling."""
    return np.linalg.inv(np.array([[1.0, coupling], [coupling, 1.0]]))


def answers(s: NDArray, gap: NDArray, mu: float) -> list[NDArray]:
    """Forces (across, along) of all answers; one that is on a border comes once."""
    found: list[NDArray] = []

    def take(force: NDArray) -> None:
        if not any(np.allclose(force, other, atol=1e-7) for other in found):
            found.append(force)

    if gap[0] >= -BORDER:
        take(np.zeros(2))
    stick = -np.linalg.solve(s, gap)
    if stick[0] >= -BORDER and abs(stick[1]) <= mu*stick[0] + BORDER:
        take(stick)
    for sign in (1.0, -1.0):
        yields = s[0, 0] - sign*mu*s[0, 1]
        if abs(yields) < BORDER:
            continue
        press = -gap[0]/yields
        force = press*np.array([1.0, -sign*mu])
        if press > BORDER and sign*(gap[1] + s[1] @ force) >= -BORDER:
            take(force)
    return found


class WedgeMap:
    """Coefficient of friction by K_tn/K_tt."""

    number, name = 6, "wedge"
    title = "Map 6: a point on springs that are coupled; one, several answers or none"
    labels = (r"$K_{tn}/K_{tt}$", r"$\mu$")
    colour, across, linear, even = "iterations", 5, True, True
    panels = tuple(LOADS)

    def grid(self, panel: str, small: bool) -> tuple[NDArray, NDArray]:
        """The values of x and y."""
        if small:
            return np.array([-0.82, -0.31, 0.31, 0.82]), np.array([0.0, 0.55, 2.05])
        return np.linspace(-0.93, 0.93, 32), np.concatenate([[0.0], 0.05 + np.arange(30)*0.1])

    def solve(self, panel: str, x: float, y: float, frame: Frame = PLAIN) -> Outcome:
        """What happens in a cell."""
        gap, s = np.array(LOADS[panel]), compliance(x)
        right = answers(s, gap, y)
        side = np.array([1.0, 1.0 if frame == PLAIN else -1.0])     # seen from behind
        force, _, said = probe_friction_increment(
            frame.length/frame.stress*s*np.outer(side, side), frame.length*gap*side, y,
            np.zeros(2), np.zeros(2))
        if said["code"]:
            return Outcome("F7" if len(right) != 1 else "F3", iterations=said["iterations"],
                           said=f"refused; {len(right)} answers")
        force = force*side/frame.stress
        size = max(1.0, np.abs(force).max())
        error = min((float(np.abs(force - other).max())/size for other in right),
                    default=float("inf"))
        told = said["wedging"] > 0 or said["sign"] < 0
        kind = "F1" if error > WRONG else "F7" if told else "F0"
        return Outcome(kind, error, said["iterations"], f"{len(right)} answers")

    def write(self, panel: str, x: float, y: float, path: Path) -> Path:
        """The problem of a cell."""
        with whole_file(path) as part:
            part.write_text(json.dumps({"compliance": compliance(x).tolist(), "mu": y,
                                        "gap": LOADS[panel]}, indent=1), encoding="utf-8")
        return path

    def theory(self, panel: str) -> list[tuple[str, NDArray, NDArray]]:
        """Where slip that presses harder wedges: mu K_tn = K_tt."""
        x = np.linspace(0.05, 0.95, 40)
        return [(r"$\mu|K_{tn}| = K_{tt}$", np.concatenate([-x[::-1], x]),
                 1.0/np.concatenate([x[::-1], x]))]
