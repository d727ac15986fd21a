"""Materials: frozen, each law knows its lines in the deck; `Material` joins several."""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from .deck import Deck
from .errors import UsageError
from .flow_curves import Hardening, not_negative, positive


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
        positive("Young's modulus", self.young)
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
class CowperSymonds:
    """Factor 1 + (rate/d)^(1/p) on the flow curve; needs steps with a period."""

    d: float    #: > 0 [1/time]
    p: float    #: > 0 [-]

    def __post_init__(self):
        positive("D of Cowper and Symonds", self.d)
        positive("p of Cowper and Symonds", self.p)

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
        positive("K of Norton and Hoff", self.k)
        if not 0.0 <= self.m <= 1.0:
            raise UsageError(f"m of Norton and Hoff must lie in [0, 1], not {self.m:g}")

    def add_to(self, deck: Deck) -> None:
        """Append the cards of the law."""
        deck.add("VISCOPLASTIC", [[self.k, self.m]], law="NORTON-HOFF", rigid=self.rigid)


@dataclass(frozen=True)
class Hill48:
    """Hill's yield surface of 1948, on the axes that `Model.section` is given.

    `ratios`: R11, R22, R33, R12, R13, R23, yield stresses by the flow stress, each > 0 [-].
    `Hill48.lankford` makes it from r-values.
    """

    ratios: Sequence[float]
    definition: str = "RATIOS"

    def __post_init__(self):
        ratios = tuple(map(float, self.ratios))
        if len(ratios) != (6 if self.definition == "RATIOS" else 3) or not min(ratios) > 0.0:
            raise UsageError("Hill's surface has six ratios or three r-values, each above 0, not "
                             f"{self.ratios}")
        object.__setattr__(self, "ratios", ratios)

    @classmethod
    def lankford(cls, r0: float, r45: float, r90: float) -> Hill48:
        """From the r-values of a sheet whose normal is axis 3; tension along axis 1 is the curve.

        >>> Hill48.lankford(1.8, 1.3, 2.1).definition
        'LANKFORD'
        """
        return cls((r0, r45, r90), "LANKFORD")

    def add_to(self, deck: Deck) -> None:
        """Append the cards of the law."""
        deck.add("POTENTIAL", [self.ratios],
                 definition=None if self.definition == "RATIOS" else self.definition)


@dataclass(frozen=True)
class Orientation:
    """Axes of a material, which turn with it: `a` on axis 1, `b` in the plane of axes 1 and 2."""

    a: Sequence[float] = (1.0, 0.0, 0.0)    #: [length]
    b: Sequence[float] = (0.0, 1.0, 0.0)    #: [length]
    angle: float = 0.0                      #: by which the axes turn about `axis` [degrees]
    axis: int = 3

    def __post_init__(self):
        for name in ("a", "b"):
            point = tuple(map(float, getattr(self, name)))
            if len(point) != 3:
                raise UsageError(f"{name} of an orientation has three coordinates, not {point}")
            object.__setattr__(self, name, point)
        if self.axis not in (1, 2, 3):
            raise UsageError(f"axis is 1, 2 or 3, not {self.axis}")

    def add_to(self, deck: Deck, name: str) -> None:
        """Append the card of the axes."""
        turned = [[self.axis, float(self.angle)]] if self.angle else []
        deck.add("ORIENTATION", [[*self.a, *self.b], *turned], name=name)


class Material:
    """Several laws of one material, such as ``Material(Elastic(2e5, 0.3), Plastic(200.0))``.

    Parameters
    ----------
    laws : at most one of each kind: `Elastic` or `NeoHooke`, a flow curve such as `Plastic` or
        `Swift`, `Hill48`, `CowperSymonds`, `NortonHoff`
    name : what the deck calls it; M1, M2... unless given
    density : for gravity, >= 0 [mass/length^3]
    expansion : coefficient of thermal expansion [1/temperature]

    >>> steel = Material(Elastic(2e5, 0.3), NortonHoff(100.0, 0.2), name="STEEL")
    >>> steel == Material(Elastic(2e5, 0.3), NortonHoff(100.0, 0.2), name="STEEL")
    True
    """

    def __init__(self, *laws, name: str = "", density: float = 0.0, expansion: float = 0.0):
        kinds = [_kind(law) for law in laws]
        if not laws or len(set(kinds)) < len(kinds):
            raise UsageError("a material has at least one law, and one of each kind, not "
                             + (", ".join(type(law).__name__ for law in laws) or "none"))
        not_negative("a density", density)
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
