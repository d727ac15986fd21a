"""Map 9 of the atlas: facets of slave and master of other lengths, at the nodes and by mortar.

Two blocks carry a uniform pressure that every mesh can represent: it is the exact solution.
"""
from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from ..charts.run import Setting
from ..deck import Deck
from .cells import Outcome, outcome
from .scenes import PLAIN, Frame, flat

#: Facets of slave and master, by h_slave/h_master; no two meshes are nested but 10/10.
FACETS = {m/s: (s, m) for s, m in ((30, 3), (29, 5), (25, 6), (20, 9), (15, 9), (14, 11), (10, 10),
                                   (11, 14), (9, 15), (9, 20), (6, 25), (5, 29), (3, 30))}
APPROACH = 0.002


@cache
def blocks(ratio: float, stiffness: float, mortar: bool | None, frame: Frame) -> Deck:
    return flat(*FACETS[ratio], stiffness, frame, mortar, APPROACH)


class MeshMap:
    """h_slave/h_master by E_master/E_slave."""

    number, name = 9, "mesh_ratio"
    title = "Map 9: meshes that do not match; uniform pressure is the exact solution"
    labels = (r"$h_s/h_m$", r"$E_m/E_s$")
    colour, across = "error", 4
    panels = tuple(f"{method}, {where}" for where in ("nodes", "mortar", "finite",
                                                           "as it comes")
                   for method in ("lagrange", "penalty", "perturbed", "augmented"))

    def grid(self, panel: str, small: bool) -> tuple[NDArray, NDArray]:
        """The values of x and y."""
        x = np.array(sorted(FACETS))
        if small:
            return x[[1, 5, 9]], np.array([1e-3, 1.0])
        return x, 10.0**np.arange(-3.0, 4.0)

    def deck(self, panel: str, x: float, y: float, frame: Frame = PLAIN) -> Deck:
        """The deck of a cell."""
        method, where = panel.split(", ")
        path = "finite" if where == "finite" else "condensed"
        ratio = min(FACETS, key=lambda known: abs(known - x))
        mortar = None if where == "as it comes" else where == "mortar"
        return Setting(method, path).deck(blocks(ratio, y, mortar, frame), 1.0)

    def solve(self, panel: str, x: float, y: float, frame: Frame = PLAIN) -> Outcome:
        """What happens in a cell."""
        ratio = min(FACETS, key=lambda known: abs(known - x))
        exact = np.full(FACETS[ratio][0] + 1, APPROACH/(0.5 + 0.5/y))
        return outcome(self.deck(panel, x, y, frame), exact, frame.stress)

    def theory(self, panel: str) -> list[tuple[str, NDArray, NDArray]]:
        """Where the slave becomes the coarser side."""
        return [("equal facets", np.array([1.0, 1.0]), np.array([1e-4, 1e4]))]
