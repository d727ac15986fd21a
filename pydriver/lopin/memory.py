"""Results of a run in this process: copies of what the Fortran session keeps.

Names in the session: TIME; a word of the deck for fields at the points (U, RF, S, Mises, LABEL);
"PAIR:WORD" for a field of the slave points; "history.NAME"; "MESH.points" (point, ndim) and
"MESH.<cell>" (cell, node), 1-based, for each cell present.
"""
from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ._bridge import Session
from .mesh.with_wedges import meshio_module


class Memory:
    """A finished run in memory."""

    def __init__(self, session: Session):
        self.session, self.diagnostics = session, session.diagnostics
        self.summary = session.summary()
        self._names = [n for n in session.names() if n]
        self._history: tuple[int, dict[str, NDArray]] = (-1, {})   # of so many increments

    @property
    def times(self) -> NDArray:
        return self.session.field("TIME") if "TIME" in self._names else np.empty(0)

    def names(self) -> list[str]:
        return [n for n in self._names if ":" not in n and "." not in n and n != "TIME"
                and not n.startswith("MESH")]

    def pairs(self) -> list[str]:
        return list(dict.fromkeys(n.rpartition(":")[0] for n in self._names if ":" in n))

    def field(self, name: str, index: int) -> NDArray:
        return self.session.field(name, index)

    def contact(self, pair: str, index: int) -> dict[str, NDArray]:
        words = [n.rpartition(":")[2] for n in self._names if n.rpartition(":")[0] == pair]
        return {w: self.session.field(f"{pair}:{w}", index) for w in words}

    def history(self) -> dict[str, NDArray]:
        prefix, count = "history.", len(self.times)
        if self._history[0] != count:
            self._history = count, {n.removeprefix(prefix): self.session.field(n)
                                    for n in self._names if n.startswith(prefix)}
        return dict(self._history[1])

    def mesh(self, index: int):
        """The mesh of the deck with the fields of one increment."""
        meshio = meshio_module()
        points = self.session.field("MESH.points")
        cells = [(n.removeprefix("MESH.").replace("line2", "line"), self.session.field(n) - 1)
                 for n in self._names if n.startswith("MESH.") and n != "MESH.points"]
        data = {n: _in_space(self.field(n, index)) for n in self.names()}
        return meshio.Mesh(_in_space(points), cells, data)


def _in_space(values: NDArray) -> NDArray:
    """Plane vectors with a third component, 0, as VTK wants them."""
    plane = values.ndim == 2 and values.shape[1] == 2
    return np.pad(values, ((0, 0), (0, 1))) if plane else values
