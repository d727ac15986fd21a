"""Halves of reference cells: the cells that each cell becomes when its edges are cut in half."""
from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from ..mesh.cells import CELLS, QUADRATIC
from ..mesh.shapes import shape_functions

#: A tetrahedron in eight: four at the corners, and the octahedron between them cut along the
#: diagonal from edge 0-2 to edge 1-3, so that all further cuts make no new shapes
#: (Bey, Computing 55 (1995) 355, for these numbers of the middles).
_TETRA = ("0 01 02 03", "01 1 12 13", "02 12 2 23", "03 13 23 3",
          "01 02 03 13", "01 02 13 12", "02 03 13 23", "02 12 23 13")
_TRIANGLE = ("0 01 02", "01 1 12", "02 12 2", "01 12 02")

_CELL = {"2": {3: "triangle", 6: "triangle6", 4: "quad", 8: "quad8"},
         "3": {4: "tetra", 10: "tetra10", 6: "wedge", 15: "wedge15", 8: "hexahedron",
               20: "hexahedron20"}}
_SOLID = re.compile(r"(CPE|CPS|CAX|C3D|CSS)(\d+)", re.I)


def cell_of(word: str) -> str | None:
    """Name of the cell of a solid element; None for what is no solid.

    >>> cell_of("CAX8R"), cell_of("CSS8"), cell_of("SPRINGA")
    ('quad8', 'hexahedron', None)
    """
    match = _SOLID.match(word)
    if not match:
        return None
    return _CELL["3" if match[1].upper() in ("C3D", "CSS") else "2"].get(int(match[2]))


@dataclass(frozen=True)
class Children:
    """How one cell is cut.

    Attributes
    ----------
    xi : parametric places of all nodes of the children in the parent (point, ndim)
    cells : points of each child, in the order of its own nodes (child, node)
    shape : values of the parent's shape functions at the points (point, node of the parent)
    corner : values of the multilinear shape functions of its corners (point, corner)
    faces : for each face of the parent, (child, face) pairs from 0 that lie on it
    """

    xi: NDArray
    cells: NDArray
    shape: NDArray
    corner: NDArray
    faces: list[list[tuple[int, int]]]


@cache
def upgraded(name: str) -> Children:
    """A linear cell as one of second order: the same cell, with nodes in the middle of edges."""
    cell = CELLS[QUADRATIC[name]]
    shape = np.array([shape_functions(name, x)[0] for x in cell.xi])
    faces = [[(0, k)] for k in range(len(cell.faces))]
    return Children(cell.xi, np.arange(cell.n_node)[None], shape, shape, faces)


@cache
def children(name: str) -> Children:
    """The children of a cell, of its own kind."""
    cell = CELLS[name]
    linear = CELLS[cell.family]
    places = []
    for corners in _corners(cell.family):
        # A node of a child lies in it where the same node of the parent lies in the parent.
        weights = np.array([shape_functions(cell.family, xi)[0] for xi in cell.xi])
        places.append(weights @ corners)
    every = np.concatenate(places)
    xi, inverse = np.unique(np.round(every, 9), axis=0, return_inverse=True)
    cells = inverse.reshape(len(places), cell.n_node)
    shape = np.array([shape_functions(name, x)[0] for x in xi])
    corner = np.array([shape_functions(cell.family, x)[0] for x in xi])
    faces = []
    for nodes in linear.faces:
        on = np.isclose(corner[:, list(nodes)].sum(axis=1), 1.0)
        faces.append([(c, f) for c in range(len(cells)) for f, own in enumerate(linear.faces)
                      if on[cells[c, list(own)]].all()])
    return Children(xi, cells, shape, corner, faces)


def _corners(family: str) -> list[NDArray]:
    """Parametric places of the corners of each child of a linear cell."""
    xi = CELLS[family].xi
    if family in ("triangle", "tetra"):
        return [_places(xi, text) for text in (_TRIANGLE if family == "triangle" else _TETRA)]
    if family == "wedge":
        base = [_places(xi[:3, :2], text) for text in _TRIANGLE]
        return [np.vstack([np.column_stack([b, np.full(3, t)]) for t in ends])
                for ends in ((-1.0, 0.0), (0.0, 1.0)) for b in base]
    # Squares and bricks: the cell, halved, beside each of its corners.
    return [0.5*(xi + corner) for corner in xi]


def _places(xi: NDArray, text: str) -> NDArray:
    """Places of corners ("0") and middles of edges ("01")."""
    return np.array([xi[[int(c) for c in word]].mean(axis=0) for word in text.split()])


def boundary(groups, inner: set[tuple]) -> list[NDArray]:
    """Corners of the faces with one cell only, outward, by the number of their corners; without
    those of `inner`."""
    found: dict[int, list[NDArray]] = {}
    for _, name, _, nodes, *_ in groups:
        for face in CELLS[name].faces:
            found.setdefault(len(face), []).append(nodes[:, list(face)])
    alone = []
    for parts in found.values():
        rows = np.vstack(parts)
        _, first, count = np.unique(np.sort(rows, axis=1), axis=0, return_index=True,
                                    return_counts=True)
        alone.append(rows[np.sort(first[count == 1])])
        if inner:
            keep = [tuple(sorted(row)) not in inner for row in alone[-1].tolist()]
            alone[-1] = alone[-1][np.array(keep, bool)]
    return [rows for rows in alone if len(rows)]
