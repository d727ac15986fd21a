"""Map 5 of the atlas: Coulomb's law by Tresca's fixed point, mu by Poisson's ratio.

The bounds of friction are those of the pressures found last; with bounds given the problem is
convex. The passes contract below some coefficient and swing above it. Lopin's own Newton knows
that the bounds follow the pressure, and has the fixed point as its last resort alone.
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
from .friction import DEPTH, RADIUS, compliance
from .scenes import PLAIN, Frame

#: Drag beside mu times the depth: most points slip.
DRAG, MOST, SETTLED = 0.9, 100, 1e-10


def gaps(mu: float, x: NDArray) -> NDArray:
    """Without forces: pressed, and drawn."""
    return np.concatenate([x**2/(2.0*RADIUS) - DEPTH, np.full(len(x), -DRAG*mu*DEPTH)])


def bounded(s: NDArray, gap: NDArray, bound: NDArray, force: NDArray) -> NDArray | None:
    """Forces where the shears have bounds of their own: Newton on its projections."""
    n = len(bound)
    scale = 1.0/np.linalg.eigvalsh(s)[-1]
    for _ in range(60):
        trial = force - scale*(gap + s @ force)
        held = np.concatenate([trial[:n] > 0.0, np.abs(trial[n:]) < bound])
        fixed = np.concatenate([np.zeros(n), np.clip(trial[n:], -bound, bound)])
        new = np.where(held, 0.0, fixed)
        if held.any():
            right = -(gap + s @ new)[held]
            new[held] = np.linalg.solve(s[np.ix_(held, held)], right)
        if np.abs(new - force).max() <= 1e-13*np.abs(new).max():
            return new
        force = new
    return None


class TrescaMap:
    """Coefficient of friction by Poisson's ratio."""

    number, name = 5, "tresca"
    title = "Map 5: Coulomb's law by Tresca's fixed point; the code as shipped beside it"
    labels = (r"$\mu$", r"$\nu$")
    colour, linear, even = "passes", True, True
    panels = ("fixed point", "fixed point, half steps", "as shipped")

    def grid(self, panel: str, small: bool) -> tuple[NDArray, NDArray]:
        """The values of x and y."""
        if small:
            return np.array([0.2, 1.0]), np.array([0.0, 0.4])
        return np.concatenate([np.arange(0.1, 1.0, 0.1), np.arange(1.0, 6.1, 0.5)]), \
            np.array([0.0, 0.1, 0.2, 0.3, 0.4, 0.45, 0.49])

    def solve(self, panel: str, x: float, y: float, frame: Frame = PLAIN) -> Outcome:
        """What happens in a cell."""
        s, places = compliance(float(y))
        gap, n = gaps(x, places), len(places)
        order, sign = np.arange(2*n), np.ones(2*n)
        if frame != PLAIN:
            order = np.concatenate([np.arange(n)[::-1], n + np.arange(n)[::-1]])
            sign[n:] = -1.0
        s = (sign[:, None]*s*sign)[np.ix_(order, order)]*frame.length/frame.stress
        gap = frame.length*(sign*gap)[order]
        force, _, said = probe_friction_increment(s, gap, x, np.zeros(2*n), np.zeros(2*n))
        several = said["wedging"] > 0 or said["sign"] < 0
        if panel == "as shipped":
            return Outcome("F3" if said["code"] else "F7" if several else "F0",
                           iterations=said["iterations"], error=0.0)
        return _passes(s, gap, x, force, 0.5 if "half" in panel else 1.0)

    def write(self, panel: str, x: float, y: float, path: Path) -> Path:
        """The problem of a cell."""
        s, places = compliance(float(y))
        with whole_file(path) as part:
            part.write_text(json.dumps({"mu": x, "nu": y, "gap": gaps(x, places).tolist(),
                                        "compliance": s.tolist()}, indent=1), encoding="utf-8")
        return path

    def theory(self, panel: str) -> list[tuple[str, NDArray, NDArray]]:
        """No border in a closed form."""
        return []


def _passes(s: NDArray, gap: NDArray, mu: float, right: NDArray, share: float) -> Outcome:
    """Bounds from the last pressures, until they stay."""
    n = len(gap)//2
    force, bound, moved = np.zeros(2*n), np.zeros(n), []
    for count in range(1, MOST + 1):
        new = bounded(s, gap, bound, force)
        if new is None:
            return Outcome("F3", iterations=count, said="with bounds given")
        force = new
        change = mu*np.maximum(force[:n], 0.0) - bound
        bound = bound + share*change
        moved.append(float(np.abs(change).max()/np.abs(force).max()))
        if moved[-1] <= SETTLED:
            error = float(np.linalg.norm(force - right)/np.linalg.norm(right))
            return Outcome("F0" if error <= WRONG else "F7", error, count)
        if not np.isfinite(moved[-1]) or moved[-1] > 1e6:
            return Outcome("F4", iterations=count)
    swings = min(moved[-20:]) > 0.5*max(moved[-20:])
    return Outcome("F3" if swings else "F2", iterations=MOST, said=f"{moved[-1]:.1e}")
