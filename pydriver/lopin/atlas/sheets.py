"""Map 16 of the atlas: sheets that are bent, by their thickness and the size of increments."""
from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .forming_scenes import Built, air_bend, flanged
from .formed import FormingMap
from .scenes import PLAIN, Frame

#: Thickness over the radius of the tools (5), and the largest increment; none: as the code has it.
THICKNESS = (0.02, 0.05, 0.1, 0.2, 0.4, 0.6)
INCREMENTS = ((), (0.3, 0.3), (0.1, 0.1), (0.05, 0.05), (0.02, 0.02))
RADIUS = 5.0


class SheetMap(FormingMap):
    """Thickness over radius by the size of increments; a panel a scene and an element word."""

    number, name = 16, "sheets"
    title = "Map 16: strips bent over radii and let go"
    labels = ("thickness / radius of the tools", "increments")
    panels = ("air bend, CPE8R, 0", "air bend, CPE8R, 0.1", "flange, CPE8R, 0",
              "flange, CPE8R, 0.1", "air bend, CPE4I, 0.1", "flange, CPE4I, 0.1")
    released, across = ("air bend", "flange"), 3
    ticks = ([f"{x:g}" for x in THICKNESS], [f"{y[0]:g}" if y else "default" for y in INCREMENTS])
    #: Facets that leave a radius one by one need short increments; bends in air do not.
    ways = {"air bend": (("lagrange", (0.01, 0.01)), ("penalty", (0.01, 0.01)),
                         ("lagrange", (0.005, 0.005))),
            "flange": (("lagrange", (0.0025, 0.0025)), ("lagrange", (0.005, 0.005)),
                       ("penalty", (0.005, 0.005)))}

    def grid(self, panel: str, small: bool) -> tuple[NDArray, NDArray]:
        """The values of x and y: places in THICKNESS and INCREMENTS."""
        if small:
            return np.array([3])[:panel == "air bend, CPE8R, 0.1"], np.array([0])
        return np.arange(len(THICKNESS)), np.arange(len(INCREMENTS))

    def scene(self, panel: str, x: float, y: float, frame: Frame = PLAIN, folder=None) -> Built:
        """Of a cell."""
        return self._built(panel, round(x), "lagrange", INCREMENTS[round(y)], frame)

    def reference_key(self, panel: str, x: float, y: float) -> tuple:
        """All increments have one reference."""
        return panel, round(x)

    def ways_of(self, key: tuple) -> tuple:
        """Of the scene."""
        return self.ways[key[0].partition(",")[0]]

    def reference(self, key: tuple, way: tuple) -> Built:
        """The scene of a reference."""
        return self._built(*key, *way)

    def _built(self, panel: str, x: int, method: str, increments, frame: Frame = PLAIN) -> Built:
        what, word, mu = panel.split(", ")
        build = air_bend if what == "air bend" else flanged
        return build(word, RADIUS*THICKNESS[x], float(mu), increments, method, frame=frame)
