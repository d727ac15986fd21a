"""Reference cells: nodes, edges and faces, in meshio's names and Abaqus' numbers (0-based here).

The nodes of a face are listed so that its normal points out of the cell: right-hand rule in 3D, to
the right of the way from first to last corner in 2D.
"""
from __future__ import annotations

from dataclasses import dataclass, field
from itertools import product

import numpy as np
from numpy.typing import NDArray

_RING3 = ((0, 1), (1, 2), (2, 0))
_RING4 = ((0, 1), (1, 2), (2, 3), (3, 0))


def _shift(edges, by):
    return tuple((a + by, b + by) for a, b in edges)


_EDGES = {
    "line": ((0, 1),),
    "triangle": _RING3,
    "quad": _RING4,
    "tetra": _RING3 + ((0, 3), (1, 3), (2, 3)),
    "wedge": _RING3 + _shift(_RING3, 3) + ((0, 3), (1, 4), (2, 5)),
    "hexahedron": _RING4 + _shift(_RING4, 4) + ((0, 4), (1, 5), (2, 6), (3, 7)),
}
_FACES = {
    "line": (),
    "triangle": _RING3,
    "quad": _RING4,
    "tetra": ((0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)),
    "wedge": ((0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)),
    "hexahedron": ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6),
                   (3, 0, 4, 7)),
}
_SIMPLEX = ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))
_SQUARE = ((-1, -1), (1, -1), (1, 1), (-1, 1))
_CORNERS = {
    "line": ((-1,), (1,)),
    "triangle": tuple(p[:2] for p in _SIMPLEX[:3]),
    "quad": _SQUARE,
    "tetra": _SIMPLEX,
    "wedge": tuple((*p[:2], t) for t, p in product((-1, 1), _SIMPLEX[:3])),
    "hexahedron": tuple((*p, t) for t, p in product((-1, 1), _SQUARE)),
}
QUADRATIC = {"line": "line3", "triangle": "triangle6", "quad": "quad8", "tetra": "tetra10",
             "wedge": "wedge15", "hexahedron": "hexahedron20"}


@dataclass(frozen=True)
class Cell:
    """One reference cell."""

    name: str
    family: str                            #: the linear cell with the same corners
    ndim: int
    xi: NDArray = field(repr=False)        #: (node, ndim) parametric coordinates
    edges: tuple[tuple[int, int], ...]     #: ends; the k-th node behind the corners is on edge k
    faces: tuple[tuple[int, ...], ...]     #: nodes, corners first; face k is Abaqus' S(k+1)

    @property
    def n_node(self) -> int:
        return len(self.xi)

    @property
    def n_corner(self) -> int:
        return len(_CORNERS[self.family])

    @property
    def is_quadratic(self) -> bool:
        return self.n_node > self.n_corner


def _build(family: str, quadratic: bool) -> Cell:
    corners = np.array(_CORNERS[family], float)
    edges, faces, xi = _EDGES[family], _FACES[family], corners
    if quadratic:
        xi = np.vstack([corners, [corners[list(e)].mean(axis=0) for e in edges]])
        where = {frozenset(e): len(corners) + k for k, e in enumerate(edges)}
        faces = tuple(
            f + tuple(where[frozenset(pair)] for pair in zip(f, f[1:] + f[:1])
                      )[:1 if len(f) == 2 else None] for f in faces)
    name = QUADRATIC[family] if quadratic else family
    return Cell(name, family, corners.shape[1], xi, edges, faces)


#: All twelve cells by meshio's name.
CELLS: dict[str, Cell] = {
    cell.name: cell for cell in (_build(f, q) for f, q in product(_EDGES, (False, True)))}
