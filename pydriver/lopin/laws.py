"""Materials and contact methods: frozen, keyword-like, each knows its lines in the deck."""
from __future__ import annotations

from dataclasses import dataclass

from .deck import Deck, Row
from .errors import UsageError


@dataclass(frozen=True)
class Elastic:
    """Isotropic linear elasticity."""

    young: float            #: > 0 [stress]
    poisson: float          #: in (-1, 1/2) [-]
    density: float = 0.0    #: for gravity [mass/length^3]

    def __post_init__(self):
        if not self.young > 0.0:
            raise UsageError(f"Young's modulus must be positive, not {self.young:g}")
        if not -1.0 < self.poisson < 0.5:
            raise UsageError(f"Poisson's ratio must lie in (-1, 0.5), not {self.poisson:g}")

    def add_to(self, deck: Deck) -> None:
        deck.add("ELASTIC", [[self.young, self.poisson]])
        if self.density:
            deck.add("DENSITY", [[self.density]])


@dataclass(frozen=True)
class NeoHooke:
    """Rubber: W = c10 (I1bar - 3) + (J - 1)^2/d1; needs ``step(nlgeom=True)``.

    >>> round(NeoHooke(0.5, 0.02).poisson, 4)
    0.495
    """

    c10: float              #: half the shear modulus, > 0 [stress]
    d1: float               #: twice the inverse of the bulk modulus, > 0 [1/stress]
    density: float = 0.0    #: for gravity [mass/length^3]

    def __post_init__(self):
        if not self.c10 > 0.0 or not self.d1 > 0.0:
            raise UsageError(f"C10 and D1 must be positive, not {self.c10:g} and {self.d1:g}")

    @property
    def poisson(self) -> float:
        """Poisson's ratio of small strains."""
        ratio = self.c10*self.d1        # shear over bulk modulus
        return (3.0 - 2.0*ratio)/(6.0 + 2.0*ratio)

    def add_to(self, deck: Deck) -> None:
        deck.add("HYPERELASTIC", [[self.c10, self.d1]], neo_hooke=True)
        if self.density:
            deck.add("DENSITY", [[self.density]])


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

    max_augmentations: int | None = None
    penetration: float | None = None   #: allowed, as a fraction of a facet [-]
    word = "AUGMENTED LAGRANGE"

    def controls(self) -> dict[str, float]:
        words = {"relative penetration tolerance": self.penetration,
                 "max augmentations": self.max_augmentations}
        return {k: v for k, v in words.items() if v is not None}


#: Methods by the words people use.
METHODS = {"lagrange": Lagrange, "penalty": Penalty, "perturbed": Perturbed, "augmented": Augmented}


def method_of(method: str | Lagrange) -> Lagrange:
    """A method from its word, or as it is.

    >>> method_of("augmented")
    Augmented(slope=None, max_augmentations=None, penetration=None)
    """
    if isinstance(method, Lagrange):
        return method
    if method not in METHODS:
        raise UsageError(f"no contact method '{method}'; methods: {', '.join(METHODS)}")
    return METHODS[method]()
