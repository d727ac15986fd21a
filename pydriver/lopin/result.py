"""Result: everything a run produced, by name."""
from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from .errors import UsageError

#: Full words for the words of the deck; both are understood.
WORDS = {"displacement": "U", "reaction": "RF", "stress": "S", "mises": "Mises",
         "pressure": "CPRESS", "gap": "COPEN", "status": "CSTATUS", "force": "FORCE",
         "normal_force": "R_n", "tangential_force": "R_t", "slip_path": "SLIP_PATH",
         "friction_work": "FRICTION_WORK",
         "normal": "NORMAL", "weight": "WEIGHT", "normal_displacement": "u_n",
         "tangential_displacement": "u_t", "x": "X"}
OPEN, STICK, SLIP, TIED = 0, 1, 2, 3


@dataclass(frozen=True)
class Frame:
    """One accepted increment."""

    result: Result
    index: int

    def __getitem__(self, name: str) -> NDArray:
        return self.result._field(name, self.index)


@dataclass(frozen=True)
class Contact:
    """One pair at one increment; an entry per slave point."""

    pair: str
    fields: dict[str, NDArray] = field(repr=False)

    def __getitem__(self, name: str) -> NDArray:
        word = WORDS.get(name, name)
        if word not in self.fields:
            raise UsageError(f"no contact result '{name}'; known: {', '.join(sorted(self.fields))}")
        return self.fields[word]

    @property
    def x(self) -> NDArray:
        """(point, ndim) coordinates of the slave points before deformation [length]."""
        return self["X"]

    @property
    def r(self) -> NDArray:
        """First coordinate: the radius in an axisymmetric scene [length]."""
        return self["X"][:, 0]

    @property
    def pressure(self) -> NDArray:
        """>= 0 pressing [stress]."""
        return self["CPRESS"]

    @property
    def gap(self) -> NDArray:
        """>= 0 open, < 0 penetrating [length]."""
        return self["COPEN"]

    @property
    def status(self) -> NDArray:
        """0 open, 1 closed, 2 tied, -1 nothing opposite."""
        return self["CSTATUS"]

    @property
    def force(self) -> NDArray:
        """(point, ndim) force of the master on the slave [force]."""
        return self["FORCE"]


@dataclass(frozen=True)
class PairHistory:
    """One pair through the run."""

    result: Result
    pair: str

    @property
    def last(self) -> Contact:
        return self.at(-1)

    def at(self, index: int) -> Contact:
        """The pair at one increment, counted from 0; -1 is the last."""
        source = self.result.source
        return Contact(self.pair, source.contact(self.pair, self.result._index(index)))


class Result:
    """Arrays of a run; ``result["displacement"]`` is of the last increment, `at` gives others.

    Attributes
    ----------
    source
        Where arrays come from: the session in memory, or the folder of the executable.
    deck : Deck or None
        What was run.
    diagnostics : list of dict
        Warnings and notes.
    summary : dict
        Status, plan, times, files.
    """

    def __init__(self, source, deck=None):
        self.source, self.deck = source, deck
        self.diagnostics: list[dict] = source.diagnostics
        self.summary: dict = getattr(source, "summary", {})

    @property
    def times(self) -> NDArray:
        """Total time of each increment that was kept."""
        return self.source.times

    @property
    def names(self) -> list[str]:
        """Words of the fields at the points."""
        return self.source.names()

    @property
    def history(self) -> dict[str, NDArray]:
        """Columns by name (``"BALL.rf2"``), a value per increment."""
        return self.source.history()

    @property
    def pairs(self) -> list[str]:
        """Contact pairs, SLAVE-MASTER."""
        return self.source.pairs()

    def __getitem__(self, name: str) -> NDArray:
        return self._field(name, -1)

    def at(self, index: int) -> Frame:
        """One increment, counted from 0; negative from the end."""
        return Frame(self, self._index(index))

    def contact(self, name: str | int = 0) -> PairHistory:
        """A pair by number, by name, or by its slave surface."""
        pairs = self.pairs
        if isinstance(name, int):
            found = pairs[name:name + 1]
        else:
            found = [p for p in pairs if p == name or p.startswith(f"{name}-")]
        if not found:
            raise UsageError(f"no contact pair '{name}'; pairs: {', '.join(pairs) or 'none'}")
        return PairHistory(self, found[0])

    def to_meshio(self, index: int = -1):
        """The mesh and the fields of one increment as a `meshio.Mesh`."""
        return self.source.mesh(self._index(index))

    @property
    def warnings(self) -> list[str]:
        """What the run warned of."""
        return [f"{d.get('code', '')}: {d['message']}" for d in self.diagnostics
                if d.get("severity") == "warning"]

    def _index(self, index: int) -> int:
        n = len(self.times)
        if not -n <= index < n:
            raise UsageError(f"increment {index} does not exist: the result has {n}")
        return index % n

    def _field(self, name: str, index: int) -> NDArray:
        word = WORDS.get(name, name)
        if word not in self.names:
            raise UsageError(f"no result '{name}'; known: {', '.join(self.names)}")
        return np.asarray(self.source.field(word, self._index(index)))

    def __repr__(self) -> str:
        name = self.deck.name if self.deck else getattr(self.source, "name", "")
        last = f", time {self.times[-1]:g}" if len(self.times) else ""
        return (f"Result({name!r}, {len(self.times)} increments{last}, pairs {self.pairs}, "
                f"{len(self.warnings)} warnings)")
