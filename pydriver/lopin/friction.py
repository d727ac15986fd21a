"""Laws of friction: frozen, each knows its lines in the deck; what bounds the shear of a contact.

Every law takes the same options by name:

`regularization`
    "linear" returns to the disc, "none" does so without elastic slip; "arctan", "tanh" and "sqrt"
    have no stick: the shear is a function of slip/`elastic_slip` or of speed/`v0`.
`elastic_slip`
    slip before sliding, or u0 of a regularisation, > 0 [length]
`slip_tolerance`
    elastic slip as a fraction of a facet, > 0 [-]
`v0`
    speed of slip of a regularisation, > 0 [length/time]
`tau_max`
    largest shear, whatever the law, > 0 [stress]
`exact_stick`
    no elastic slip also with a penalty method

A value out of its range raises `UsageError`.
"""
from __future__ import annotations

from dataclasses import dataclass

from ._bridge import keywords
from .deck import Deck
from .errors import UsageError

REGULARIZATIONS = ("linear", "none", "arctan", "tanh", "sqrt")


@dataclass(frozen=True, kw_only=True)
class Friction:
    """What all laws share; see the module. Use one of the laws below."""

    regularization: str = "linear"
    elastic_slip: float | None = None
    slip_tolerance: float | None = None
    v0: float | None = None
    tau_max: float | None = None
    exact_stick: bool = False

    law = None       # word of LAW=, not written for Coulomb's
    flags = ()       # parameters without a value

    def __post_init__(self):
        if self.regularization not in REGULARIZATIONS:
            raise UsageError(f"no regularization '{self.regularization}'; known: "
                             f"{', '.join(REGULARIZATIONS)}")
        for name in ("elastic_slip", "slip_tolerance", "v0", "tau_max"):
            value = getattr(self, name)
            if value is not None and not value > 0.0:
                raise UsageError(f"{name} must be positive, not {value:g}")

    def data(self) -> list[list[float]]:
        """Data lines of *FRICTION."""
        raise UsageError("a law of friction is "
                         + ", ".join(kind.__name__ for kind in Friction.__subclasses__()))

    def add_to(self, deck: Deck) -> None:
        """Append the card of the law."""
        smooth = None if self.regularization == "linear" else self.regularization.upper()
        flags = {flag: True for flag in self.flags}
        deck.add("FRICTION", self.data(), law=self.law, regularization=smooth, **flags,
                 taumax=self.tau_max, elastic_slip=self.elastic_slip,
                 slip_tolerance=self.slip_tolerance, v0=self.v0, lagrange=self.exact_stick)

    def _within(self, **shares: float) -> None:
        for name, value in shares.items():
            if not 0.0 <= value <= 1.0:
                raise UsageError(f"{name} must lie in [0, 1], not {value:g}")

    def _not_negative(self, **values: float) -> None:
        for name, value in values.items():
            if not value >= 0.0:
                raise UsageError(f"{name} must not be negative, not {value:g}")


@dataclass(frozen=True)
class Coulomb(Friction):
    """Shear up to mu times the pressure.

    >>> deck = Deck()
    >>> Coulomb(0.2, regularization="arctan", elastic_slip=1e-3).add_to(deck)
    >>> print(deck.text(), end="")
    *FRICTION, REGULARIZATION=ARCTAN, ELASTIC SLIP=0.001
    0.2
    """

    mu: float                            #: >= 0 [-]
    stick_slope: float | None = None     #: of the elastic slip, > 0 [stress/length]

    def __post_init__(self):
        super().__post_init__()
        self._not_negative(mu=self.mu)

    def data(self) -> list[list[float]]:
        """Data lines of *FRICTION."""
        return [[self.mu] + ([] if self.stick_slope is None else [self.stick_slope])]


@dataclass(frozen=True)
class StaticKinetic(Friction):
    """Coulomb's law with mu = kinetic + (static - kinetic) exp(-decay speed of slip)."""

    static: float     #: >= kinetic [-]
    kinetic: float    #: >= 0 [-]
    decay: float      #: >= 0 [time/length]
    flags = ("exponential_decay",)

    def __post_init__(self):
        super().__post_init__()
        self._not_negative(static=self.static, kinetic=self.kinetic, decay=self.decay)

    def data(self) -> list[list[float]]:
        """Data lines of *FRICTION."""
        return [[self.static, self.kinetic, self.decay]]


@dataclass(frozen=True)
class Tresca(Friction):
    """Shear up to m times the shear yield stress of the slave; `m` may be left to `tau_max`."""

    m: float | None = None    #: shear factor, 0 to 1 [-]
    law = "TRESCA"

    def __post_init__(self):
        super().__post_init__()
        if self.m is None and self.tau_max is None:
            raise UsageError("Tresca's friction needs m or tau_max")
        self._within(m=self.m or 0.0)

    def data(self) -> list[list[float]]:
        """Data lines of *FRICTION."""
        return [] if self.m is None else [[self.m]]


@dataclass(frozen=True)
class Cristescu(Friction):
    """Shear up to m/sqrt(3) times the von Mises stress of the slave."""

    m: float    #: shear factor, 0 to 1 [-]
    law = "CRISTESCU"

    def __post_init__(self):
        super().__post_init__()
        self._within(m=self.m)

    def data(self) -> list[list[float]]:
        """Data lines of *FRICTION."""
        return [[self.m]]


@dataclass(frozen=True)
class Orowan(Friction):
    """Coulomb's law up to the shear m times the shear yield stress of the slave."""

    mu: float    #: >= 0 [-]
    m: float     #: shear factor, 0 to 1 [-]
    law = "COULOMB-OROWAN"

    def __post_init__(self):
        super().__post_init__()
        self._not_negative(mu=self.mu)
        self._within(m=self.m)

    def data(self) -> list[list[float]]:
        """Data lines of *FRICTION."""
        return [[self.mu, self.m]]


@dataclass(frozen=True)
class NortonHoffFriction(Friction):
    """Shear alpha times the speed of slip to the power q; needs steps with a period."""

    alpha: float    #: >= 0 [stress (time/length)^q]
    q: float        #: 0 to 1 [-]
    law = "NORTON-HOFF"

    def __post_init__(self):
        super().__post_init__()
        self._not_negative(alpha=self.alpha)
        self._within(q=self.q)

    def data(self) -> list[list[float]]:
        """Data lines of *FRICTION."""
        return [[self.alpha, self.q]]


@dataclass(frozen=True)
class AutoFriction(Friction):
    """The law that suits the slave's material: Coulomb, Tresca, Cristescu or Norton and Hoff.

    Give what the law chosen needs; the run refuses one that misses something.
    """

    mu: float | None = None       #: >= 0 [-]
    m: float | None = None        #: shear factor, 0 to 1 [-]
    alpha: float | None = None    #: >= 0 [stress (time/length)^q]
    q: float | None = None        #: 0 to 1 [-]
    law = "AUTO"

    def __post_init__(self):
        super().__post_init__()
        self._not_negative(mu=self.mu or 0.0, alpha=self.alpha or 0.0)
        self._within(m=self.m or 0.0, q=self.q or 0.0)

    def data(self) -> list[list[float]]:
        """Data lines of *FRICTION."""
        row = [self.mu, self.m, self.alpha, self.q]
        while row and row[-1] is None:
            row.pop()
        return [row]


@dataclass(frozen=True)
class Rough(Friction):
    """No slip at all while the surfaces press."""

    flags = ("rough",)

    def data(self) -> list[list[float]]:
        """Data lines of *FRICTION."""
        return []


@dataclass(frozen=True)
class FrictionLaw(Friction):
    """A law by the deck's word and its numbers in the deck's order, if it has no class above.

    >>> FrictionLaw("NORTON-HOFF", (10.0, 0.3)).data()
    [[10.0, 0.3]]
    """

    word: str                      #: one of `law_words()`
    values: tuple[float, ...]      #: those that `law_words()` names

    def __post_init__(self):
        super().__post_init__()
        known = law_words()
        if self.word not in known:
            raise UsageError(f"no law of friction '{self.word}'; known: {', '.join(known)}")
        if len(self.values) != len(known[self.word]):
            raise UsageError(f"{self.word} takes {', '.join(known[self.word])}, not "
                             f"{len(self.values)} numbers")

    @property
    def law(self) -> str:
        """Word of LAW=."""
        return self.word

    def data(self) -> list[list[float]]:
        """Data lines of *FRICTION."""
        return [list(self.values)]


def law_words() -> dict[str, tuple[str, ...]]:
    """All laws of the core by the deck's word, with the names of their data.

    >>> law_words()["COULOMB-OROWAN"]
    ('mu', 'm')
    """
    card = _card()
    choices = next(p for p in card["parameters"] if p["name"] == "LAW")["choices"].split(",")
    # A datum with a default ends what must be given.
    return {word: tuple(field["name"] for k, field in enumerate(data["fields"])
                        if k == 0 or not data["fields"][0]["default"])
            for word in choices if word != "AUTO"
            for data in card["data"] if data["condition"] == f"LAW={word}"}


def law_of(word: str, values: list[float], **options) -> Friction:
    """The law of a word of the deck, other spellings included."""
    kinds = {kind.law: kind for kind in Friction.__subclasses__() if isinstance(kind.law, str)}
    kinds["COULOMB"] = Coulomb
    if word not in kinds:
        respelt = next(p for p in _card()["parameters"] if p["name"] == "LAW")["respelt"]
        word = dict(pair.split("=") for pair in respelt.split(",")).get(word, word)
    if word in kinds:
        return kinds[word](*values, **options)
    return FrictionLaw(word, tuple(values), **options)


def _card() -> dict:
    return next(row for row in keywords() if row["name"] == "FRICTION")


def friction_of(friction: float | Friction | None) -> Friction | None:
    """A law from a coefficient of Coulomb's, or as it is; None for none.

    >>> friction_of(0.1).mu
    0.1
    """
    if friction is None or isinstance(friction, Friction):
        return friction
    if isinstance(friction, (int, float)):
        return Coulomb(float(friction))
    raise UsageError(f"friction is a coefficient or a law, not {friction!r}")
