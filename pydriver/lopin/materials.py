"""Materials: frozen, each law knows its lines in the deck; `Material` joins several."""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from .deck import Deck
from .errors import UsageError


def _positive(what: str, value: float) -> None:
    if not value > 0.0:
        raise UsageError(f"{what} must be positive, not {value:g}")


def _not_negative(what: str, value: float) -> None:
    if not value >= 0.0:
        raise UsageError(f"{what} must not be negative, not {value:g}")


@dataclass(frozen=True)
class Elastic:
    """Isotropic elasticity: Hooke's law; Hencky's under NLGEOM.

    `strain`: what the law is linear in under NLGEOM, "logarithmic", or "green" (St Venant and
    Kirchhoff, as CalculiX has it).
    """

    young: float                   #: > 0 [stress]
    poisson: float                 #: in (-1, 1/2) [-]
    density: float = 0.0           #: for gravity [mass/length^3]
    strain: str = "logarithmic"    #: or "green"

    def __post_init__(self):
        _positive("Young's modulus", self.young)
        if not -1.0 < self.poisson < 0.5:
            raise UsageError(f"Poisson's ratio must lie in (-1, 0.5), not {self.poisson:g}")
        if self.strain not in ("logarithmic", "green"):
            raise UsageError(f"strain is 'logarithmic' or 'green', not '{self.strain}'")

    def add_to(self, deck: Deck) -> None:
        """Append the cards of the law."""
        deck.add("ELASTIC", [[self.young, self.poisson]],
                 strain="GREEN" if self.strain == "green" else None)
        _add_density(deck, self.density)


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
        """Append the cards of the law."""
        deck.add("HYPERELASTIC", [[self.c10, self.d1]], neo_hooke=True)
        _add_density(deck, self.density)


@dataclass(frozen=True)
class Hardening:
    """A flow curve of von Mises plasticity with isotropic hardening; made as one of its kinds.

    `only_friction`: the body stays elastic, and laws of friction alone read the flow stress at
    plastic strain 0.
    """

    def data(self) -> list[list[float]]:
        """Data lines of *PLASTIC."""
        raise UsageError("a flow curve is a Plastic, Swift, Voce, Hollomon or LinearHardening")

    def add_to(self, deck: Deck) -> None:
        """Append the cards of the law."""
        deck.add("PLASTIC", self.data(), hardening=getattr(self, "word", None),
                 only="FRICTION" if self.only_friction else None)


@dataclass(frozen=True)
class Plastic(Hardening):
    """Flow curve from a table of (true stress > 0 [stress], logarithmic plastic strain [-]).

    The strains increase from 0; beyond the last line the stress stays. One number is a perfectly
    plastic metal.

    >>> Plastic(200.0).table, Plastic([(700.0, 0.0), (1300.0, 2.0)]).table[1]
    (((200.0, 0.0),), (1300.0, 2.0))
    """

    table: float | Sequence[Sequence[float]]
    only_friction: bool = False

    def __post_init__(self):
        table = self.table
        rows = [(table, 0.0)] if isinstance(table, (int, float)) else list(table)
        rows = tuple((float(s), float(e)) for s, e in rows)
        object.__setattr__(self, "table", rows)
        strains = [e for _, e in rows]
        if not rows or strains[0] != 0.0 or any(b <= a for a, b in zip(strains, strains[1:])):
            raise UsageError("plastic strains of a flow curve must increase from 0")
        _positive("a yield stress", min(s for s, _ in rows))

    def data(self) -> list[list[float]]:
        """Data lines of *PLASTIC."""
        return [list(row) for row in self.table]


@dataclass(frozen=True)
class Swift(Hardening):
    """Flow stress k (e0 + e)^n of the plastic strain e."""

    k: float     #: > 0 [stress]
    e0: float    #: > 0 [-]
    n: float     #: >= 0 [-]
    only_friction: bool = False
    word = "SWIFT"

    def __post_init__(self):
        _positive("K of Swift's law", self.k)
        _positive("e0 of Swift's law", self.e0)
        _not_negative("the exponent of Swift's law", self.n)

    def data(self) -> list[list[float]]:
        """Data lines of *PLASTIC."""
        return [[self.k, self.e0, self.n]]


@dataclass(frozen=True)
class Voce(Hardening):
    """Flow stress s - (s - y) exp(-d e) + h e of the plastic strain e."""

    s: float          #: saturation, > 0 [stress]
    y: float          #: yield stress, > 0 [stress]
    d: float          #: decay, >= 0 [-]
    h: float = 0.0    #: last slope [stress]
    only_friction: bool = False
    word = "VOCE"

    def __post_init__(self):
        _positive("the saturation stress", self.s)
        _positive("the yield stress", self.y)
        _not_negative("the decay of Voce's law", self.d)

    def data(self) -> list[list[float]]:
        """Data lines of *PLASTIC."""
        return [[self.s, self.y, self.d, self.h]]


@dataclass(frozen=True)
class Hollomon(Hardening):
    """Flow stress k e^n of the total strain e, from yield on.

    Without `y` the curve begins where it leaves the line of Young's modulus.
    """

    k: float                  #: > 0 [stress]
    n: float                  #: in (0, 1) [-]
    y: float | None = None    #: yield stress, > 0 [stress]
    only_friction: bool = False
    word = "HOLLOMON"

    def __post_init__(self):
        _positive("K of Hollomon's law", self.k)
        _positive("the exponent of Hollomon's law", self.n)
        if self.y is not None:
            _positive("the yield stress", self.y)

    def data(self) -> list[list[float]]:
        """Data lines of *PLASTIC."""
        return [[self.k, self.n] + ([] if self.y is None else [self.y])]


@dataclass(frozen=True)
class LinearHardening(Hardening):
    """Flow stress y + h e of the plastic strain e."""

    y: float          #: yield stress, > 0 [stress]
    h: float = 0.0    #: slope [stress]
    only_friction: bool = False
    word = "LINEAR"

    def __post_init__(self):
        _positive("the yield stress", self.y)

    def data(self) -> list[list[float]]:
        """Data lines of *PLASTIC."""
        return [[self.y, self.h]]


@dataclass(frozen=True)
class CowperSymonds:
    """Factor 1 + (rate/d)^(1/p) on the flow curve; needs steps with a period."""

    d: float    #: > 0 [1/time]
    p: float    #: > 0 [-]

    def __post_init__(self):
        _positive("D of Cowper and Symonds", self.d)
        _positive("p of Cowper and Symonds", self.p)

    def add_to(self, deck: Deck) -> None:
        """Append the cards of the law."""
        deck.add("RATE DEPENDENT", [[self.d, self.p]])


@dataclass(frozen=True)
class NortonHoff:
    """Viscoplastic flow: the flow stress is k sqrt(3)^(m+1) rate^m in uniaxial tension.

    With a flow curve it is added to that curve, which becomes a threshold. Needs steps with a
    period. `rigid`: no elastic deviator, and `Elastic` is not needed.
    """

    k: float               #: > 0 [stress time^m]
    m: float               #: in [0, 1] [-]
    rigid: bool = False

    def __post_init__(self):
        _positive("K of Norton and Hoff", self.k)
        if not 0.0 <= self.m <= 1.0:
            raise UsageError(f"m of Norton and Hoff must lie in [0, 1], not {self.m:g}")

    def add_to(self, deck: Deck) -> None:
        """Append the cards of the law."""
        deck.add("VISCOPLASTIC", [[self.k, self.m]], law="NORTON-HOFF", rigid=self.rigid)


class Material:
    """Several laws of one material, such as ``Material(Elastic(2e5, 0.3), Plastic(200.0))``.

    Parameters
    ----------
    laws : at most one of each kind: `Elastic` or `NeoHooke`, a flow curve, `CowperSymonds`,
        `NortonHoff`
    name : what the deck calls it; M1, M2... unless given
    density : for gravity, >= 0 [mass/length^3]
    expansion : coefficient of thermal expansion [1/temperature]

    >>> steel = Material(Elastic(2e5, 0.3), Swift(550.0, 0.01, 0.2), name="STEEL")
    >>> steel == Material(Elastic(2e5, 0.3), Swift(550.0, 0.01, 0.2), name="STEEL")
    True
    """

    def __init__(self, *laws, name: str = "", density: float = 0.0, expansion: float = 0.0):
        kinds = [_kind(law) for law in laws]
        if not laws or len(set(kinds)) < len(kinds):
            raise UsageError("a material has at least one law, and one of each kind, not "
                             + (", ".join(type(law).__name__ for law in laws) or "none"))
        _not_negative("a density", density)
        self._all = (laws, name, float(density), float(expansion))

    @property
    def laws(self) -> tuple:
        """The laws as they were given."""
        return self._all[0]

    @property
    def name(self) -> str:
        """Name in the deck, or nothing."""
        return self._all[1]

    def add_to(self, deck: Deck) -> None:
        """Append the cards of all laws."""
        laws, _, density, expansion = self._all
        for law in laws:
            law.add_to(deck)
        _add_density(deck, density)
        if expansion:
            deck.add("EXPANSION", [[expansion]])

    def __eq__(self, other) -> bool:
        return isinstance(other, Material) and self._all == other._all

    def __hash__(self) -> int:
        return hash(self._all)

    def __repr__(self) -> str:
        return f"Material({', '.join(map(repr, self.laws))}, name={self.name!r})"


def _kind(law) -> type:
    """What there can be one of."""
    if not hasattr(law, "add_to"):
        raise UsageError(f"{law!r} is not a law of a material")
    for kind in (Hardening, (Elastic, NeoHooke)):
        if isinstance(law, kind):
            return kind
    return type(law)


def _add_density(deck: Deck, density: float) -> None:
    if density:
        deck.add("DENSITY", [[density]])
