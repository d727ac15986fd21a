"""Mesh: points, blocks of cells, and named sets of points, elements and element faces.

Elements are counted from 0 through the blocks in order. A surface is an array of (element, face)
rows with Abaqus' face numbers (1 for S1). Meshes are values: every operation returns a new one.
"""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import ModelError, UsageError
from .cells import CELLS, QUADRATIC
from .shapes import smallest_jacobian
from .with_wedges import meshio_module


@dataclass(frozen=True)
class Mesh:
    """See the module; make one by `lopin.mesh_make` or `lopin.read_mesh`."""

    points: NDArray                                                  #: (point, ndim) [length]
    blocks: list[tuple[str, NDArray]]                                #: (cell name, (cell, node))
    point_sets: dict[str, NDArray] = field(default_factory=dict)     #: point indices
    element_sets: dict[str, NDArray] = field(default_factory=dict)   #: element indices
    surfaces: dict[str, NDArray] = field(default_factory=dict)       #: (n, 2) element, face

    @property
    def ndim(self) -> int:
        return self.points.shape[1]

    @property
    def n_point(self) -> int:
        return len(self.points)

    @property
    def n_element(self) -> int:
        return sum(len(cells) for _, cells in self.blocks)

    def __repr__(self) -> str:
        blocks = ", ".join(f"{len(c)} {name}" for name, c in self.blocks)
        return f"Mesh({self.n_point} points, {blocks}, surfaces {sorted(self.surfaces)})"

    def replaced(self, **changes) -> Mesh:
        """A copy with some fields replaced."""
        old = {k: getattr(self, k) for k in self.__dataclass_fields__}
        return Mesh(**(old | changes))

    def element(self, index: int) -> tuple[str, NDArray]:
        """Cell name and nodes of one element."""
        for name, cells in self.blocks:
            if index < len(cells):
                return name, cells[index]
            index -= len(cells)
        raise UsageError(f"element {index} does not exist: the mesh has {self.n_element}")

    def face_nodes(self, element: int, face: int) -> NDArray:
        """Point indices of one face, corners first, outward."""
        name, nodes = self.element(element)
        return nodes[list(CELLS[name].faces[face - 1])]

    def surface_points(self, name: str) -> NDArray:
        """Sorted point indices of a surface."""
        if name not in self.surfaces:
            raise ModelError(f"no surface '{name}'; surfaces: {', '.join(sorted(self.surfaces))}")
        nodes = [self.face_nodes(e, f) for e, f in self.surfaces[name]]
        return np.unique(np.concatenate(nodes)) if nodes else np.empty(0, int)

    def boundary(self) -> NDArray:
        """(n, 2) element and face numbers of the faces with one element only."""
        keys, faces, start = [], [], 0
        for name, cells in self.blocks:
            cell, count = CELLS[name], np.arange(len(cells))
            for k, nodes in enumerate(cell.faces):
                corners = [n for n in nodes if n < cell.n_corner]
                key = np.full((len(cells), 4), -1)
                key[:, :len(corners)] = np.sort(cells[:, corners], axis=1)
                keys.append(key)
                faces.append(np.stack([count + start, np.full(len(cells), k + 1)], axis=1))
            start += len(cells)
        _, inverse, count = np.unique(np.vstack(keys), axis=0, return_inverse=True,
                                      return_counts=True)
        rows = np.vstack(faces)[count[inverse.ravel()] == 1]
        return rows[np.lexsort(rows.T[::-1])]

    def with_surface(self, name: str, where: Callable[[NDArray], ArrayLike]) -> Mesh:
        """Add a surface and a point set of one name: boundary faces whose centres satisfy `where`.

        `where` receives (n, ndim) centres of faces and returns n booleans.
        """
        rows = self.boundary()
        centres = np.array([self.points[self.face_nodes(e, f)].mean(axis=0) for e, f in rows])
        surfaces = self.surfaces | {name: rows[np.asarray(where(centres), bool)]}
        new = self.replaced(surfaces=surfaces)
        return new.replaced(point_sets=self.point_sets | {name: new.surface_points(name)})

    def with_points(self, name: str, where: Callable[[NDArray], ArrayLike]) -> Mesh:
        """Add a point set: the points whose coordinates satisfy `where`."""
        chosen = np.flatnonzero(where(self.points))
        return self.replaced(point_sets=self.point_sets | {name: chosen})

    def mapped(self, function: Callable[[NDArray], NDArray]) -> Mesh:
        """The same mesh with points moved by a function of (n, ndim) coordinates."""
        return self.replaced(points=np.ascontiguousarray(function(self.points), float))

    def moved(self, *shift: float) -> Mesh:
        """The same mesh, shifted."""
        return self.mapped(lambda x: x + np.array(shift, float))

    def quadratic(self) -> Mesh:
        """The same mesh with a node in the middle of every edge; point sets follow the surfaces."""
        ends = np.vstack([cells[:, list(e)] for name, cells in self.blocks
                          for e in CELLS[name].edges])
        unique, inverse = np.unique(np.sort(ends, axis=1), axis=0, return_inverse=True)
        inverse, at, blocks = inverse.ravel() + self.n_point, 0, []
        for name, cells in self.blocks:
            n = len(CELLS[name].edges)*len(cells)
            middle = inverse[at:at + n].reshape(-1, len(cells)).T
            blocks.append((QUADRATIC[name], np.hstack([cells, middle])))
            at += n
        points = np.vstack([self.points, self.points[unique].mean(axis=1)])
        sets = {}
        for name, members in self.point_sets.items():
            between = np.flatnonzero(np.isin(unique, members).all(axis=1))
            sets[name] = np.concatenate([members, self.n_point + between])
        new = self.replaced(points=points, blocks=blocks, point_sets=sets)
        return new.replaced(point_sets=sets | {k: new.surface_points(k) for k in self.surfaces})

    def smallest_jacobian(self) -> float:
        """Smallest Jacobian determinant at the nodes of all cells; positive in a sound mesh."""
        return min(smallest_jacobian(name, self.points[cells]) for name, cells in self.blocks)

    def to_meshio(self):
        """A `meshio.Mesh` with the same points, cells and sets."""
        meshio = meshio_module()
        points = self.points if self.ndim == 3 else np.pad(self.points, ((0, 0), (0, 1)))
        return meshio.Mesh(points, list(self.blocks), point_sets=dict(self.point_sets))


def together(**bodies: Mesh) -> Mesh:
    """Several bodies in one mesh: sets become "BODY.SET", all elements of a body the set "BODY".

    >>> from .make import block
    >>> sorted(together(UP=block((1, 1), (1, 1)), LOW=block((1, 1), (2, 1))).element_sets)
    ['LOW', 'LOW.ALL', 'UP', 'UP.ALL']
    """
    points, blocks, sets = [], [], ({}, {}, {})
    n_point = n_element = 0
    for body, mesh in bodies.items():
        points.append(mesh.points)
        blocks += [(name, cells + n_point) for name, cells in mesh.blocks]
        sets[0].update({f"{body}.{k}": v + n_point for k, v in mesh.point_sets.items()})
        sets[1].update({f"{body}.{k}": v + n_element for k, v in mesh.element_sets.items()})
        sets[1][body] = np.arange(mesh.n_element) + n_element
        sets[2].update({f"{body}.{k}": v + [n_element, 0] for k, v in mesh.surfaces.items()})
        n_point += mesh.n_point
        n_element += mesh.n_element
    return Mesh(np.vstack(points), blocks, *sets)
