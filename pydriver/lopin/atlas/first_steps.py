"""Map 18 of the atlas: the first increment by the strain at which metal yields."""
from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .formed import FormingMap
from .forming_scenes import Built, air_bend, billet, coulomb
from .metal import YOUNG
from .scenes import PLAIN, Frame

#: First increment of each step, and yield stress over Young's modulus; none: as the code has it.
FIRST = ((), (1e-4, 1.0), (1e-3, 1.0), (1e-2, 1.0), (0.03, 1.0), (0.1, 1.0), (0.3, 1.0),
         (1.0, 1.0))
STRAINS = (1e-5, 1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2)


class FirstMap(FormingMap):
    """First increment by yield strain; a panel a scene."""

    number, name = 18, "first_increment"
    title = "Map 18: size of the first increment and strain of first yield"
    labels = ("first increment", "yield stress / Young's modulus")
    panels = ("billet, CAX4", "billet, CAX8R", "billet, CPE4", "billet, C3D8", "billet, C3D4",
              "air bend, CPE8R")
    released = ("air bend",)
    ticks = ([f"{x[0]:g}" if x else "default" for x in FIRST], [f"{y:g}" for y in STRAINS])

    def grid(self, panel: str, small: bool) -> tuple[NDArray, NDArray]:
        """The values of x and y: places in FIRST and STRAINS."""
        if small:
            return np.array([0, 5])[:0 if "bend" in panel else 2], np.array([3])
        return np.arange(len(FIRST)), np.arange(len(STRAINS))

    def scene(self, panel: str, x: float, y: float, frame: Frame = PLAIN, folder=None) -> Built:
        """Of a cell."""
        return self._built(panel, round(y), "lagrange", FIRST[round(x)], frame)

    def reference_key(self, panel: str, x: float, y: float) -> tuple:
        """All first increments have one reference."""
        return panel, round(y)

    def reference(self, key: tuple, way: tuple) -> Built:
        """The scene of a reference."""
        return self._built(*key, *way)

    def _built(self, panel: str, y: int, method: str, increments, frame: Frame = PLAIN) -> Built:
        what, word = panel.split(", ")
        yielding = YOUNG*STRAINS[y]
        if what == "air bend":
            return air_bend(word, 1.0, 0.1, increments, method, yielding, frame)
        return billet(word, coulomb(0.1), increments, method, yielding, frame=frame)
