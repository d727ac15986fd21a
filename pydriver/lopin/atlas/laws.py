"""Map 17 of the atlas: laws of friction by their coefficient, in scenes of forming."""
from __future__ import annotations

from math import sqrt

import numpy as np
from numpy.typing import NDArray

from .formed import FormingMap
from .forming_scenes import Built, air_bend, billet, cavity
from .scenes import PLAIN, Frame

#: Share m of the shear yield stress of 300 MPa/sqrt(3) that friction may reach, or m/sqrt(3) of
#: the pressure.
SHARES = (0.05, 0.1, 0.2, 0.3, 0.4, 0.6, 0.8, 1.0)
SHEAR, SPEED, POWER = 300.0/sqrt(3.0), 0.4, 0.15


def _lines(words: str, *data: float) -> list[str]:
    return [f"*FRICTION{words}", ", ".join(repr(float(v)) for v in data) + ","]


def _viscous(m: float, frame: Frame) -> list[str]:
    """All of the share at a speed of 0.4 (the way of the press in a time of 1)."""
    return _lines(", LAW=NORTON-HOFF", m*SHEAR*frame.stress/(SPEED*frame.length)**POWER, POWER)


#: Lines of *FRICTION by law, of the share and the frame.
LAWS = {
    "Coulomb": lambda m, f: _lines("", m/sqrt(3.0)),
    "Tresca": lambda m, f: _lines(", LAW=TRESCA", m),
    "Cristescu": lambda m, f: _lines(", LAW=CRISTESCU", m),
    "Orowan": lambda m, f: _lines(", LAW=COULOMB-OROWAN", 0.3, m),
    "Norton-Hoff": _viscous,
    "TAUMAX": lambda m, f: _lines(f", TAUMAX={m*SHEAR*f.stress!r}", 0.3),
    "arctan": lambda m, f: _lines(f", REGULARIZATION=ARCTAN, ELASTIC SLIP={1e-3*f.length!r}",
                                  m/sqrt(3.0)),
    "decay": lambda m, f: _lines(", EXPONENTIAL DECAY", m/sqrt(3.0), 0.5*m/sqrt(3.0),
                                 2.0/f.length),
}
SCENES = ("billet, CAX4", "billet, CPE4", "ring, CAX4", "closed die, CAX4", "billet, C3D8",
          "billet, C3D4", "air bend, CPE8R", "billet, CAX8R")


class LawMap(FormingMap):
    """The coefficient by the law; a panel a scene."""

    number, name = 17, "laws"
    title = "Map 17: laws of friction in forming"
    labels = (r"share $m$ of the shear yield stress; Coulomb: $\mu = m/\sqrt{3}$", "")
    panels = SCENES
    released = ("air bend",)
    ticks = ([f"{m:g}" for m in SHARES], list(LAWS))
    #: Friction that clings to what springs back remembers its way: at m = 0.4 of Tresca half as
    #: much comes free in increments of 0.02 as in those of 0.005 and 0.002, which are alike.
    bent = (("lagrange", (0.005, 0.005)), ("lagrange", (0.01, 0.01)), ("penalty", (0.005, 0.005)))

    def grid(self, panel: str, small: bool) -> tuple[NDArray, NDArray]:
        """The values of x and y: places in SHARES and LAWS."""
        if small:
            return np.array([2]), np.array([1, 3])[:0 if "bend" in panel or "8R" in panel else 2]
        return np.arange(len(SHARES)), np.arange(len(LAWS))

    def scene(self, panel: str, x: float, y: float, frame: Frame = PLAIN, folder=None) -> Built:
        """Of a cell."""
        return self._built(panel, round(x), round(y), "lagrange", (), frame)

    def reference_key(self, panel: str, x: float, y: float) -> tuple:
        """Each cell has its own."""
        return panel, round(x), round(y)

    def ways_of(self, key: tuple) -> tuple:
        """Of bends in air by short increments."""
        return self.bent if self.is_released(key[0]) else self.reference_ways

    def reference(self, key: tuple, way: tuple) -> Built:
        """The scene of a reference."""
        return self._built(*key, *way)

    def _built(self, panel: str, x: int, y: int, method: str, increments,
               frame: Frame = PLAIN) -> Built:
        what, word = panel.split(", ")
        friction = LAWS[self.ticks[1][y]](SHARES[x], frame)
        if what == "air bend":
            return air_bend(word, 1.0, 0.0, increments, method, frame=frame, friction=friction)
        if what == "closed die":
            return cavity(friction, increments, method, frame)
        return billet(word, friction, increments, method, frame=frame, hollow=what == "ring")
