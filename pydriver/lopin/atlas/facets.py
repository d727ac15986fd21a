"""Map 10 of the atlas: facets of a tool by friction, for tools that bulge, hollow ones and STL.

The reference is the same polygon, exact and in small increments: what a polygon is off its circle
is no failure of the run.
"""
from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .forming_scenes import Built, ball, indented, nested
from .formed import FormingMap
from .scenes import PLAIN, Frame

#: Facets of the tool per facet of the slave, and friction.
FACETS = (0.25, 0.5, 1.0, 2.0, 4.0, 8.0)
FRICTION = (0.0, 0.05, 0.1, 0.2, 0.4)
TOOLS = ("convex", "hollow", "STL", "STL, SMOOTH=NO")


class FacetMap(FormingMap):
    """Facets of the tool per slave facet by friction; a panel a tool and a method."""

    number, name = 10, "facets"
    title = "Map 10: faceted tools pressed into metal and drawn along it"
    labels = ("facets of the tool per facet of the slave", "friction")
    panels = tuple(f"{tool}, {method}" for tool in TOOLS
                   for method in ("lagrange", "penalty", "perturbed", "augmented")
                   if "STL" not in tool or method in ("lagrange", "penalty"))
    ticks = ([f"{x:g}" for x in FACETS], [f"{mu:g}" for mu in FRICTION])

    def grid(self, panel: str, small: bool) -> tuple[NDArray, NDArray]:
        """The values of x and y: places in FACETS and FRICTION."""
        if small:
            few = panel in ("convex, lagrange", "hollow, lagrange", "hollow, penalty")
            return np.array([1, 3])[:2*few], np.array([3])
        return np.arange(len(FACETS)), np.arange(len(FRICTION))[::3 if "STL" in panel else 1]

    def scene(self, panel: str, x: float, y: float, frame: Frame = PLAIN, folder=None) -> Built:
        """Of a cell."""
        tool, _, method = panel.rpartition(", ")
        return self._built(tool, round(x), round(y), method, (), frame, folder)

    def reference_key(self, panel: str, x: float, y: float) -> tuple:
        """All methods have one reference."""
        return panel.rpartition(", ")[0], round(x), round(y)

    def reference(self, key: tuple, way: tuple) -> Built:
        """The scene of a reference."""
        return self._built(*key, *way)

    def _built(self, tool: str, x: int, y: int, method: str, increments, frame: Frame = PLAIN,
               folder=None) -> Built:
        facets, mu = FACETS[x], FRICTION[y]
        if tool.startswith("STL"):
            return ball(facets, mu, method, increments, frame, tool == "STL", folder)
        build = indented if tool == "convex" else nested
        return build(facets, mu, method, increments, frame)
