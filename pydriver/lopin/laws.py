"""Contact methods: frozen, keyword-like, each knows its lines in the deck."""
from __future__ import annotations

from dataclasses import dataclass

from .deck import Deck, Row
from .errors import UsageError
from .materials import Elastic, NeoHooke

__all__ = ["METHODS", "Augmented", "Elastic", "Exponential", "Lagrange", "NeoHooke", "Penalty",
           "Perturbed", "Tabular", "method_of"]


@dataclass(frozen=True)
class Lagrange:
    """Exact contact: multipliers are unknowns, nothing penetrates."""

    word = "DIRECT"

    def add_to(self, deck: Deck, **flags: bool) -> None:
        deck.add("SURFACE BEHAVIOR", **{self.word: True}, **flags)

    def controls(self) -> dict[str, float]:
        return {}


@dataclass(frozen=True)
class Penalty(Lagrange):
    """Pressure = slope times penetration."""

    slope: float | None = None   #: None: chosen from the elements behind [stress/length]
    word = "PENALTY"

    def add_to(self, deck: Deck, **flags: bool) -> None:
        block = deck.add("SURFACE BEHAVIOR", **{self.word: True}, **flags)
        if self.slope is not None:
            block.lines.append(Row([float(self.slope)]))


@dataclass(frozen=True)
class Perturbed(Penalty):
    """Perturbed Lagrangian: a multiplier with compliance 1/slope; the same answer as penalty."""

    word = "PERTURBED LAGRANGE"


@dataclass(frozen=True)
class Augmented(Penalty):
    """Augmented Lagrangian: penalty whose multipliers take the load over, pass by pass."""

    max_augmentations: int | None = None   #: most passes of an increment; None: 50
    penetration: float | None = None   #: allowed, as a fraction of a facet [-]
    depth: float | None = None         #: penetration allowed [length]
    word = "AUGMENTED LAGRANGE"

    def controls(self) -> dict[str, float]:
        words = {"relative penetration tolerance": self.penetration,
                 "absolute penetration tolerance": self.depth,
                 "max augmentations": self.max_augmentations}
        return {k: v for k, v in words.items() if v is not None}


@dataclass(frozen=True)
class Exponential(Lagrange):
    """Pressure that grows exponentially: `p0` at gap 0, none at gap `c0`."""

    c0: float = 0.0    #: > 0 [length]
    p0: float = 0.0    #: > 0 [stress]

    def __post_init__(self):
        if not self.c0 > 0.0 or not self.p0 > 0.0:
            raise UsageError(f"c0 and p0 must be positive, not {self.c0:g} and {self.p0:g}")

    def add_to(self, deck: Deck, **flags: bool) -> None:
        deck.add("SURFACE BEHAVIOR", [[self.c0, self.p0]],
                 **{"pressure-overclosure": "EXPONENTIAL"}, **flags)


@dataclass(frozen=True)
class Tabular(Lagrange):
    """Pressure from a table of (pressure [stress], overclosure [length]), both increasing."""

    points: tuple[tuple[float, float], ...] = ()

    def __post_init__(self):
        points = tuple((float(p), float(c)) for p, c in self.points)
        object.__setattr__(self, "points", points)
        if len(points) < 2 or any(b <= a for p, q in zip(points, points[1:])
                                  for a, b in zip(p, q)):
            raise UsageError("a table of pressures has two lines or more, and both columns grow")

    def add_to(self, deck: Deck, **flags: bool) -> None:
        deck.add("SURFACE BEHAVIOR", self.points, **{"pressure-overclosure": "TABULAR"}, **flags)


#: Methods by the words people use.
METHODS = {"lagrange": Lagrange, "penalty": Penalty, "perturbed": Perturbed, "augmented": Augmented}


def method_of(method: str | Lagrange) -> Lagrange:
    """A method from its word, or as it is.

    >>> method_of("augmented")
    Augmented(slope=None, max_augmentations=None, penetration=None, depth=None)
    """
    if isinstance(method, Lagrange):
        return method
    if method not in METHODS:
        raise UsageError(f"no contact method '{method}'; methods: {', '.join(METHODS)}")
    return METHODS[method]()
