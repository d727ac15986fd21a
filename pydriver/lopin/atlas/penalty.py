"""Map 1 of the atlas, stiffness of the penalty, and map 3, augmentations; both on all paths."""
from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from ..charts.run import Setting, answer, least_compliance
from ..deck import Block, Deck
from .cells import Outcome, exact_pressures, outcome
from .scenes import PLAIN, Frame, crown

PATHS = ("condensed", "newton", "finite")
#: Length of a slave facet of the scene, whose upper modulus is 1.
FACET = 0.2
#: Rounding of the penalty matrix: digits lost to r, as the chart measures them.
ROUNDING = 1e-14
#: Pressures settle to this between two augmentations.
SETTLED = 1e-10


@cache
def scene(ratio: float, frame: Frame = PLAIN) -> Deck:
    """The crowned block on a block of another modulus."""
    return crown(ratio, frame)


@cache
def exact(ratio: float, path: str) -> NDArray:
    """Pressures by Lagrange multipliers; both small-sliding paths share them."""
    shared = "finite" if path == "finite" else "condensed"
    return exact_pressures(Setting("lagrange", shared).deck(scene(ratio), 1.0))


@cache
def least(ratio: float) -> float:
    """The least compliance per area s_min of the contact."""
    result, _ = answer(Setting("penalty").deck(scene(ratio), 1.0))
    return least_compliance(result)


class PenaltyMap:
    """r = slope h/E1 by E2/E1, h the slave facet, E1 the modulus behind it."""

    number, name = 1, "penalty"
    title = "Map 1: stiffness of the penalty and ratio of the moduli"
    labels = (r"$r=\varepsilon h/E_1$", r"$E_2/E_1$ (master/slave)")
    colour, across = "error", 4
    panels = tuple(f"{method}, {path}" for path in PATHS
                   for method in ("penalty", "perturbed", "augmented", "lagrange"))

    def grid(self, panel: str, small: bool) -> tuple[NDArray, NDArray]:
        """The values of x and y."""
        if small:
            x = [1.0] if panel.startswith("lagrange") else [1e-2, 1e2, 1e8, 1e12]
            return np.array(x), np.array([1e-3, 1e6])
        dear = panel == "augmented, finite"
        x = [1.0] if panel.startswith("lagrange") else 10.0**np.arange(-2, 13, 2 if dear else 1)
        return np.asarray(x), 10.0**np.arange(-3, 7, 3 if dear else 1)

    def deck(self, panel: str, x: float, y: float, frame: Frame = PLAIN) -> Deck:
        """The deck of a cell."""
        method, path = panel.split(", ")
        r = None if method == "lagrange" else x
        return Setting(method, path, r).deck(scene(y, frame), FACET*frame.length/frame.stress)

    def solve(self, panel: str, x: float, y: float, frame: Frame = PLAIN) -> Outcome:
        """What happens in a cell."""
        deck = self.deck(panel, x, y, frame)
        return outcome(deck, exact(y, panel.split(", ")[1]), frame.stress)

    def theory(self, panel: str) -> list[tuple[str, NDArray, NDArray]]:
        """Boundaries: named curves (x, y)."""
        y = 10.0**np.linspace(-3.0, 6.0, 10)
        compliance = np.array([least(v) for v in y])/FACET
        method, path = panel.split(", ")
        curves = []
        if method in ("penalty", "perturbed"):
            curves.append(("$1/(1+\\varepsilon s_{min})$ = 2 %", 49.0/compliance, y))
            curves.append(("rule of the code", 99.0/compliance, y))
        if method == "augmented" or (method == "penalty" and path != "finite"):
            loose = 1e-5 if method == "penalty" else 1e-6
            curves.append((f"rounding {loose:.0e}", loose/ROUNDING*np.minimum(1.0, y), y))
        return curves


class AugmentedMap:
    """r = slope h/E by the augmentations that the run may take."""

    number, name = 3, "augmented"
    title = "Map 3: stiffness and augmentations of the augmented Lagrangian"
    labels = (r"$r=\varepsilon h/E$", "augmentations allowed")
    colour = "error"
    panels = tuple(f"augmented, {path}" for path in PATHS)

    def grid(self, panel: str, small: bool) -> tuple[NDArray, NDArray]:
        if small:
            return np.array([1.0, 1e2, 1e4]), np.array([2, 40])
        step = 2 if "finite" in panel else 1
        return 10.0**np.arange(-1.0, 9.0, 0.5*step), np.unique(np.round(
            10.0**np.arange(0.0, 2.41, 0.15*step)))

    def deck(self, panel: str, x: float, y: float, frame: Frame = PLAIN) -> Deck:
        path = panel.split(", ")[1]
        deck = Setting("augmented", path, x).deck(scene(1.0, frame),
                                                  FACET*frame.length/frame.stress)
        step = deck.blocks.index(deck["*STEP"])
        deck.blocks.insert(step, Block("CONTACT CONTROLS", {"MAX AUGMENTATIONS": int(y)}))
        return deck

    def solve(self, panel: str, x: float, y: float, frame: Frame = PLAIN) -> Outcome:
        deck = self.deck(panel, x, y, frame)
        return outcome(deck, exact(1.0, panel.split(", ")[1]), frame.stress)

    def theory(self, panel: str) -> list[tuple[str, NDArray, NDArray]]:
        r = 10.0**np.linspace(-1.0, 8.5, 200)
        rate = 1.0/(1.0 + r*least(1.0)/FACET)
        return [(f"$\\beta^n$ = {SETTLED:.0e}", r, np.log(SETTLED)/np.log(rate))]
