"""Map 2 of the atlas: pure Uzawa, p <- max(0, p - rho g), a method for teaching and for this map.

Its bound rho < 2/lambda_max is taken over all points that may touch. Beside it the augmented
Lagrangian of the code with the same rho: its spring inside removes the bound.
"""
from __future__ import annotations

import json
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .._bridge import probe_contact
from ..errors import NotConvergedError
from ..files import whole_file
from ..reference.contact import contact_oracle
from .cells import Outcome
from .scenes import PLAIN, Frame

POINTS, PASSES, SETTLED = 16, 1000, 1e-8


@cache
def compliance(condition: float) -> NDArray:
    """A symmetric matrix of this condition, largest eigenvalue 1, always the same."""
    rng = np.random.default_rng([2, POINTS])
    q, _ = np.linalg.qr(rng.normal(size=(POINTS, POINTS)))
    s = (q*np.logspace(0.0, -np.log10(condition), POINTS)) @ q.T
    return 0.5*(s + s.T)


@cache
def gaps(held: bool) -> NDArray:
    """Gaps without forces: all pressed, or about half."""
    rng = np.random.default_rng([2, 7])
    return rng.normal(size=POINTS) - (0.0 if held else 0.3)


@cache
def exact(condition: float, held: bool) -> NDArray:
    """The forces that Uzawa should find."""
    s, g = compliance(condition), gaps(held)
    return np.linalg.solve(s, -g) if held else contact_oracle(s, g)


def uzawa(s: NDArray, g: NDArray, rho: float, held: bool) -> tuple[str, NDArray, int]:
    """Class, forces and passes."""
    p, change, before = np.zeros(len(g)), np.zeros(len(g)), np.zeros(len(g))
    first = np.abs(g).max()
    for k in range(1, PASSES + 1):
        before, new = change, p - rho*(g + s @ p)
        new = new if held else np.maximum(new, 0.0)
        change, p = new - p, new
        gap = g + s @ p
        left = np.abs(gap if held else np.minimum(gap, p)).max()
        if not left < 1e8*first:
            return "F4", p, k
        if left < SETTLED*first*s.diagonal().min():
            return "F0", p, k
    if left > 2.0*first:
        return "F4", p, PASSES
    return ("F3" if change @ before < 0.0 else "F2"), p, PASSES


class UzawaMap:
    """rho lambda_max by the condition of S."""

    number, name = 2, "uzawa"
    title = "Map 2: pure Uzawa (teaching only) beside the augmented Lagrangian"
    labels = (r"$\rho\,\lambda_{max}(S)$", r"$\kappa(S)$")
    colour = "passes"
    panels = ("Uzawa, all points held", "Uzawa, contact", "augmented, contact")

    def grid(self, panel: str, small: bool) -> tuple[NDArray, NDArray]:
        """The values of x and y."""
        if small:
            return np.array([0.5, 1.98, 2.02, 20.0]), np.array([1.0, 1e2, 1e6])
        x = np.concatenate([10.0**np.arange(-2.0, 0.21, 0.1), [1.8, 1.9, 1.98, 2.02, 2.1, 2.3],
                            10.0**np.arange(0.4, 3.1, 0.2)])
        return x, 10.0**np.arange(0.0, 6.1, 0.5)

    def solve(self, panel: str, x: float, y: float, frame: Frame = PLAIN) -> Outcome:
        """What happens in a cell; a frame changes the order of the points and the units."""
        method, where = panel.split(", ")
        held = where == "all points held"
        order = np.arange(POINTS)
        if frame != PLAIN:
            order = np.random.default_rng([2, 3]).permutation(POINTS)
        unit = frame.length/frame.stress
        s = unit*compliance(y)[np.ix_(order, order)]
        g = frame.length*gaps(held)[order]
        if method == "Uzawa":
            kind, force, passes = uzawa(s/unit, g/frame.length, x, held)
        else:
            try:
                force, passes = probe_contact(s, g, "augmented", x/unit)
                kind, force = "F0", force/frame.stress
            except NotConvergedError:
                return Outcome("F2")
        right = exact(y, held)[order]
        error = float(np.linalg.norm(force - right)/np.linalg.norm(right))
        if kind == "F0" and not error < 0.05:
            kind = "F1"
        return Outcome(kind, error, passes)

    def write(self, panel: str, x: float, y: float, path: Path) -> Path:
        """The problem of a cell: there is no deck of a method that only this map has."""
        held = panel.endswith("held")
        with whole_file(path) as part:
            part.write_text(json.dumps({"panel": panel, "rho": x, "condition": y, "gap":
                                        gaps(held).tolist(), "compliance": compliance(y).tolist()},
                                       indent=1), encoding="utf-8")
        return path

    def theory(self, panel: str) -> list[tuple[str, NDArray, NDArray]]:
        """The bound, and where the passes do not suffice."""
        y = 10.0**np.linspace(-0.5, 6.5, 50)
        if panel.startswith("augmented"):
            return []
        return [(r"$2/\lambda_{max}$", np.full(50, 2.0), y),
                (f"{PASSES} passes", -np.log(SETTLED)/PASSES*y, y)]
