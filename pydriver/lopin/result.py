"""Result: everything a run produced, by name."""
from __future__ import annotations

from dataclasses import dataclass, field
from html import escape

import numpy as np
from numpy.typing import NDArray

from .errors import UsageError, optional
from .units import Units, units_of

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
    frame: Frame | None = field(default=None, repr=False)   #: of the whole mesh, for `place`

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
    def place(self) -> NDArray:
        """(point, ndim) coordinates of the slave points after deformation [length]."""
        if self.frame is None or not {"U", "LABEL"} <= set(self.frame.result.names):
            return self.x
        labels, own = self.frame["LABEL"].ravel(), self["LABEL"].ravel()
        order = np.argsort(labels)
        return self.x + self.frame["U"][order[np.searchsorted(labels, own, sorter=order)]]

    @property
    def units(self) -> Units:
        """What the scene is measured in, as far as its heading says."""
        return self.frame.result.units if self.frame else Units()

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
        index = self.result._index(index)
        fields = self.result.source.contact(self.pair, index)
        return Contact(self.pair, fields, Frame(self.result, index))


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

    def to_dataframe(self, what: str = "history", index: int = -1):
        """A `pandas.DataFrame`.

        Parameters
        ----------
        what : "history" (a row an increment), "points" (a row a point of the mesh, indexed by its
            label), or the name of a contact pair (a row a slave point)
        index : which increment, for points and pairs

        Raises
        ------
        MissingPackageError : pandas is not installed: ``pip install 'lopin[table]'``.
        UsageError : there is no such pair or increment.
        """
        pandas = optional("pandas", "a table")
        if what == "history":
            return pandas.DataFrame(dict(self.history))
        fields = self.contact(what).at(index).fields if what != "points" else \
            {name: self.at(index)[name] for name in self.names}
        labels = fields.get("LABEL")
        columns = {column: values for name, field in fields.items() if name != "LABEL"
                   for column, values in _columns(name, field)}
        return pandas.DataFrame(columns, index=None if labels is None
                                else pandas.Index(labels.ravel().astype(int), name="label"))

    def to_pyvista(self, index: int = -1, *, scale: float = 1.0):
        """A `pyvista.UnstructuredGrid` of the deformed mesh and its fields at one increment.

        `scale`: factor on the displacements; 0 leaves the mesh where it began.

        Raises
        ------
        MissingPackageError : pyvista is not installed: ``pip install 'lopin[3d]'``.
        """
        pyvista = optional("pyvista", "a 3D view")
        mesh = self.to_meshio(index)
        if "U" in mesh.point_data:
            mesh.points = mesh.points + scale*mesh.point_data["U"]
        return pyvista.from_meshio(mesh)

    @property
    def units(self) -> Units:
        """What the scene is measured in, as far as its heading says, such as "..., N mm s"."""
        heading = self.summary.get("heading") or ""
        if self.deck is not None and "*HEADING" in self.deck:
            heading = " ".join(map(str, self.deck["*HEADING"].lines))
        return units_of(str(heading))

    @property
    def verdict(self) -> str:
        """Verdict of the certificate: PASS, WARN or FAIL; nothing if there is none."""
        return str((self.summary.get("certificate") or {}).get("verdict", ""))

    def _repr_html_(self) -> str:
        """A table for notebooks: what was run, its verdict, contacts, warnings."""
        rows = [("increments", len(self.times)), ("certificate", self.verdict)]
        if len(self.times):
            rows.insert(1, (self.units.label("time", "time"), f"{self.times[-1]:g}"))
            for pair in self.pairs:
                contact = self.contact(pair).last
                most = contact.pressure.max(initial=0.0)
                rows.append((pair, f"{int((contact.status > 0).sum())} of {len(contact.status)} "
                             f"points closed, {self.units.label(f'{most:.4g}', 'stress')}"))
        rows += [("warning", text) for text in self.warnings]
        lines = "".join(f"<tr><th>{escape(str(k))}</th><td>{escape(str(v))}</td></tr>"
                        for k, v in rows)
        return f"<table><caption>{escape(self.name)}</caption>{lines}</table>"

    @property
    def name(self) -> str:
        """Name of the deck."""
        return self.deck.name if self.deck else str(getattr(self.source, "name", ""))

    @property
    def warnings(self) -> list[str]:
        """What the run warned of."""
        return [f"{d.get('code', '')}: {d.get('message', '')}" for d in self.diagnostics
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
        last = f", time {self.times[-1]:g}" if len(self.times) else ""
        return (f"Result({self.name!r}, {len(self.times)} increments{last}, pairs {self.pairs}, "
                f"{len(self.warnings)} warnings)")


def refuse_meshes(result, why: str) -> None:
    """A run whose mesh was made anew has other points in each part."""
    parts = getattr(result, "summary", {}).get("parts", 1)
    if parts > 1:
        raise UsageError(f"the run has {parts} meshes (*REMESH): {why}",
                         help="run it without *REMESH")


def _columns(name: str, values: NDArray) -> list[tuple[str, NDArray]]:
    """Columns of a table: one for a scalar, one for each component of a vector."""
    if values.ndim == 1 or values.shape[1] == 1:
        return [(name, values.ravel())]
    return [(f"{name}{k}", values[:, k - 1]) for k in range(1, values.shape[1] + 1)]
