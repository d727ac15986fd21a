"""Polynomials of a field on patches of cells: superconvergent recovery (Zienkiewicz and Zhu, 1992).

Around each corner of the mesh a polynomial is fitted to the samples of the field in the cells that
meet there; where they are few, as on a boundary, in the cells that meet at the corners of these.
The recovered field blends the polynomials of the corners of a cell by its linear shape functions.
"""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

#: Part of the mean square of a monomial that a patch which cannot tell it is held by.
HELD = 1e-8
#: Mean way to the cells of a corner, beside their mean distance, where they lie on one side.
ONE_SIDED = 0.35


@dataclass
class Samples:
    """A field where it is best known within cells.

    Attributes
    ----------
    x : places (cell, sample, ndim)
    values : (cell, sample, component)
    corners : numbers of the corners of each cell, -1 beyond its own (cell, corner)
    order : of the polynomials
    """

    x: NDArray
    values: NDArray
    corners: NDArray
    order: int


@dataclass
class Patches:
    """Polynomials about corners: centre and size (corner), coefficients (corner, term, component).
    """

    centre: NDArray
    size: NDArray
    coefficients: NDArray
    order: int

    @classmethod
    def of(cls, samples: Samples, places: NDArray) -> Patches:
        """Fitted to samples; `places`: of all corners (corner, ndim)."""
        node, cell = _members(samples, places)
        centre, terms = places, n_terms(samples.order, places.shape[1])
        far = np.linalg.norm(samples.x[cell] - centre[node][:, None], axis=2).max(axis=1)
        size = np.full(len(places), 1e-300)
        np.maximum.at(size, node, far)
        p = _monomials((samples.x[cell] - centre[node][:, None])/size[node][:, None, None],
                       samples.order)
        square = _gathered(np.einsum("kst,ksu->ktu", p, p), node, len(places))
        right = _gathered(np.einsum("kst,ksc->ktc", p, samples.values[cell]), node, len(places))
        held = HELD*np.maximum(square[:, 0, 0], 1.0)
        square[:, range(terms), range(terms)] += held[:, None]
        return cls(centre, size, np.linalg.solve(square, right), samples.order)

    def at(self, x: NDArray, corners: NDArray, share: NDArray) -> NDArray:
        """The blend at places of cells (cell, point, component).

        `x`: (cell, point, ndim); `corners`: (cell, corner); `share`: of the corners (point, corner)
        """
        found = 0.0
        for k in range(corners.shape[1]):
            own = corners[:, k]
            p = _monomials((x - self.centre[own][:, None])/self.size[own][:, None, None],
                           self.order)
            found = found + share[None, :, k, None]*(p @ self.coefficients[own])
        return found


def n_terms(order: int, ndim: int) -> int:
    """Monomials of a polynomial.

    >>> n_terms(1, 2), n_terms(2, 2), n_terms(2, 3)
    (3, 6, 10)
    """
    return ndim + 1 if order == 1 else (ndim + 1)*(ndim + 2)//2


def _monomials(x: NDArray, order: int) -> NDArray:
    """1, x, y(, z), and their products where the order is 2 (..., term)."""
    parts = [np.ones((*x.shape[:-1], 1)), x]
    if order == 2:
        rows, columns = np.triu_indices(x.shape[-1])
        parts.append(x[..., rows]*x[..., columns])
    return np.concatenate(parts, axis=-1)


def _gathered(values: NDArray, node: NDArray, count: int) -> NDArray:
    """Sums by node (count, ...)."""
    flat = values.reshape(len(values), -1)
    found = np.stack([np.bincount(node, column, count) for column in flat.T], axis=1)
    return found.reshape(count, *values.shape[1:])


def _poor(samples: Samples, places: NDArray, node: NDArray, cell: NDArray) -> NDArray:
    """Corners whose cells tell too little: hardly more samples than terms, or all on one side."""
    count = np.bincount(node, minlength=len(places))
    way = samples.x[cell].mean(axis=1) - places[node]
    one_sided = np.linalg.norm(_gathered(way, node, len(places)), axis=1)
    reach = np.bincount(node, np.linalg.norm(way, axis=1), len(places))
    least = n_terms(samples.order, places.shape[1]) + 1
    few = count*samples.x.shape[1] < least
    return np.flatnonzero((count > 0) & (few | (one_sided > ONE_SIDED*reach)))


def _members(samples: Samples, places: NDArray) -> tuple[NDArray, NDArray]:
    """Which cells are in which patches: pairs of corner and cell."""
    cell, column = np.nonzero(samples.corners >= 0)
    node = samples.corners[cell, column]
    poor = _poor(samples, places, node, cell)
    if not len(poor):
        return node, cell
    order = np.argsort(node, kind="stable")
    start = np.searchsorted(node[order], np.arange(len(places) + 1))
    around = cell[order]
    extra_node, extra_cell = [], []
    for n in poor.tolist():
        own = around[start[n]:start[n + 1]]
        ring = np.unique(samples.corners[own])
        ring = ring[ring >= 0]
        more = np.unique(np.concatenate([around[start[m]:start[m + 1]] for m in ring]))
        more = np.setdiff1d(more, own, assume_unique=False)
        extra_node.append(np.full(len(more), n))
        extra_cell.append(more)
    return np.concatenate([node, *extra_node]), np.concatenate([cell, *extra_cell])
