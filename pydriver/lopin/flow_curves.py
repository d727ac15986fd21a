"""Flow curves of plasticity: frozen, each knows its lines in the deck."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from .deck import Deck
from .errors import UsageError

Table = Sequence[Sequence[float]]


def positive(what: str, value: float) -> None:
    """Raise `UsageError` unless a number is above 0."""
    if not value > 0.0:
        raise UsageError(f"{what} must be positive, not {value:g}")


def not_negative(what: str, value: float) -> None:
    """Raise `UsageError` if a number is below 0."""
    if not value >= 0.0:
        raise UsageError(f"{what} must not be negative, not {value:g}")


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


def _table(rows: Table) -> tuple[tuple[float, float], ...]:
    """Rows of (stress, plastic strain) that a flow curve can have."""
    found = tuple((float(s), float(e)) for s, e in rows)
    strains = [e for _, e in found]
    if not found or strains[0] != 0.0 or any(b <= a for a, b in zip(strains, strains[1:])):
        raise UsageError("plastic strains of a flow curve must increase from 0")
    positive("a yield stress", min(s for s, _ in found))
    return found


@dataclass(frozen=True)
class Plastic(Hardening):
    """Flow curve from a table of (true stress > 0 [stress], logarithmic plastic strain [-]).

    The strains increase from 0; beyond the last line the stress stays. One number is a perfectly
    plastic metal. Tables by temperature, such as ``{20.0: [...], 500.0: [...]}``, are joined
    linearly.

    >>> Plastic(200.0).table, Plastic([(700.0, 0.0), (1300.0, 2.0)]).table[1]
    (((200.0, 0.0),), (1300.0, 2.0))
    >>> Plastic({20.0: [(200.0, 0.0)], 500.0: [(100.0, 0.0)]}).data()
    [[200.0, 0.0, 20.0], [100.0, 0.0, 500.0]]
    """

    table: float | Table | Mapping[float, Table]
    only_friction: bool = False

    def __post_init__(self):
        table = self.table
        if isinstance(table, tuple) and table and isinstance(table[0][1], tuple):
            table = dict(table)     # as it was stored, for dataclasses.replace
        if isinstance(table, Mapping):
            rows = tuple((float(t), _table(table[t])) for t in sorted(table))
            if not rows:
                raise UsageError("a flow curve needs a table")
        else:
            rows = _table([(table, 0.0)] if isinstance(table, (int, float)) else table)
        object.__setattr__(self, "table", rows)

    @property
    def depends_on_temperature(self) -> bool:
        """Whether there are tables of several temperatures."""
        return isinstance(self.table[0][1], tuple)

    def data(self) -> list[list[float]]:
        """Data lines of *PLASTIC."""
        if self.depends_on_temperature:
            return [[*row, t] for t, table in self.table for row in table]
        return [list(row) for row in self.table]


@dataclass(frozen=True)
class Kinematic(Hardening):
    """The yield surface moves along a straight line and keeps its size.

    `table`: two lines of (stress > 0 [stress], plastic strain [-]), the first at plastic strain 0.
    """

    table: Table
    only_friction: bool = False
    word = "KINEMATIC"

    def __post_init__(self):
        object.__setattr__(self, "table", _table(self.table))
        if len(self.table) != 2:
            raise UsageError("kinematic hardening is a straight line: two lines of a table")

    def data(self) -> list[list[float]]:
        """Data lines of *PLASTIC."""
        return [list(row) for row in self.table]


@dataclass(frozen=True)
class Chaboche(Hardening):
    """The yield surface moves as Armstrong, Frederick and Chaboche say, and may grow.

    Each part of the backstress: d alpha = c (s - alpha)/y de - gamma alpha de. `growth`: (q, b) for
    a size y + q (1 - exp(-b e)), or a table of (stress, plastic strain).
    """

    y: float                                          #: yield stress, > 0 [stress]
    backstresses: Sequence[tuple[float, float]]       #: (c >= 0 [stress], gamma >= 0 [-])
    growth: tuple[float, float] | Table | None = None
    only_friction: bool = False
    word = "COMBINED"

    def __post_init__(self):
        positive("the yield stress", self.y)
        pairs = tuple((float(c), float(g)) for c, g in self.backstresses)
        if not pairs or min(min(pair) for pair in pairs) < 0.0:
            raise UsageError("backstresses are pairs of c and gamma, none negative")
        object.__setattr__(self, "backstresses", pairs)
        if self.growth is not None:
            numbers = isinstance(self.growth[0], (int, float))
            growth = tuple(map(float, self.growth)) if numbers else _table(self.growth)
            object.__setattr__(self, "growth", growth)

    def data(self) -> list[list[float]]:
        """Data lines of *PLASTIC."""
        return [[self.y, *(value for pair in self.backstresses for value in pair)]]

    def add_to(self, deck: Deck) -> None:
        """Append the cards of the law."""
        super().add_to(deck)
        deck.blocks[-1].parameters |= {"DATA TYPE": "PARAMETERS",
                                       "NUMBER BACKSTRESSES": len(self.backstresses)}
        if self.growth is None:
            return
        if isinstance(self.growth[0], float):
            deck.add("CYCLIC HARDENING", [[self.y, *self.growth]], parameters=True)
        else:
            deck.add("CYCLIC HARDENING", self.growth)


@dataclass(frozen=True)
class Swift(Hardening):
    """Flow stress k (e0 + e)^n of the plastic strain e."""

    k: float     #: > 0 [stress]
    e0: float    #: > 0 [-]
    n: float     #: >= 0 [-]
    only_friction: bool = False
    word = "SWIFT"

    def __post_init__(self):
        positive("K of Swift's law", self.k)
        positive("e0 of Swift's law", self.e0)
        not_negative("the exponent of Swift's law", self.n)

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
        positive("the saturation stress", self.s)
        positive("the yield stress", self.y)
        not_negative("the decay of Voce's law", self.d)

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
        positive("K of Hollomon's law", self.k)
        positive("the exponent of Hollomon's law", self.n)
        if self.y is not None:
            positive("the yield stress", self.y)

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
        positive("the yield stress", self.y)

    def data(self) -> list[list[float]]:
        """Data lines of *PLASTIC."""
        return [[self.y, self.h]]
