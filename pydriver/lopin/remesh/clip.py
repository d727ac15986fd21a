"""Cells divided along a surface: simplices split at the edges that it crosses.

An edge that the surface crosses is split at the crossing, in every simplex that has it, one edge
after another in the order of their nodes: neighbours agree, and no volume is lost or won. New edges
end on the surface and are not crossed again. A quad that is crossed becomes two triangles first.
"""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .body import boundary_facets

#: Share of an edge within which a crossing is at its node.
NEAR = 1e-3


@dataclass
class Clipped:
    """Cells of which none is on both sides.

    Attributes
    ----------
    x : places of the nodes, new ones behind the old (node, ndim) [length]
    ends : nodes of the edge that each node lies on; an old node twice (node, 2)
    cells : nodes of quads that are whole, if there were any, and of simplices (n, k)
    parent : number of the old cell of each, by group
    beyond : which lie where the level is positive, by group
    """

    x: NDArray
    ends: NDArray
    cells: list[NDArray]
    parent: list[NDArray]
    beyond: list[NDArray]


def clip(x: NDArray, cells: list[NDArray], level) -> Clipped:
    """Divide cells where `level`, told places, is 0."""
    value = np.asarray(level(x), float)
    whole, simple, owner, start = [], [], [], 0
    for group in cells:
        number = np.arange(start, start + len(group))
        start += len(group)
        if len(group[0]) == x.shape[1] + 1:
            simple.append(group)
            owner.append(number)
            continue
        crossed = (value[group].min(axis=1) < 0.0) & (value[group].max(axis=1) > 0.0)
        whole.append((group[~crossed], number[~crossed]))
        for corners in ([0, 1, 2], [0, 2, 3]):
            simple.append(group[crossed][:, corners])
            owner.append(number[crossed])
    simplex, number = np.vstack(simple), np.concatenate(owner)
    x, ends, value, edge = _crossings(x, simplex, value, level)
    simplex, number = _split(simplex, number, edge)
    groups = [g for g in whole if len(g[0])] + ([(simplex, number)] if len(simplex) else [])
    found = Clipped(x, ends, [g[0] for g in groups], [g[1] for g in groups], [])
    found.beyond = [value[g].sum(axis=1) > 0.0 for g in found.cells]
    return found


def _crossings(x, simplex, value, level):
    """Nodes where edges are crossed, and each of them by its edge."""
    k = simplex.shape[1]
    pairs = np.vstack([simplex[:, [i, j]] for i in range(k) for j in range(i + 1, k)]) \
        if len(simplex) else np.zeros((0, 2), int)
    pairs = np.unique(np.sort(pairs, axis=1), axis=0)
    pairs = pairs[value[pairs[:, 0]]*value[pairs[:, 1]] < 0.0]
    low, high = np.zeros(len(pairs)), np.ones(len(pairs))
    for _ in range(60 if len(pairs) else 0):
        share = 0.5*(low + high)
        here = np.asarray(level(_between(x, pairs, share)), float)
        same = here*value[pairs[:, 0]] > 0.0
        low, high = np.where(same, share, low), np.where(same, high, share)
    share = 0.5*(low + high)
    value = value.copy()
    for end, close in ((0, share < NEAR), (1, share > 1.0 - NEAR)):
        value[pairs[close, end]] = 0.0
    crossed = value[pairs[:, 0]]*value[pairs[:, 1]] < 0.0
    pairs, share = pairs[crossed], share[crossed]
    old = np.arange(len(x))
    edge = {tuple(p): len(x) + i for i, p in enumerate(pairs.tolist())}
    return np.vstack([x, _between(x, pairs, share)]), np.vstack([np.stack([old, old], 1), pairs]), \
        np.concatenate([value, np.zeros(len(pairs))]), edge


def _between(x: NDArray, pairs: NDArray, share: NDArray) -> NDArray:
    return x[pairs[:, 0]] + share[:, None]*(x[pairs[:, 1]] - x[pairs[:, 0]])


def _split(simplex: NDArray, number: NDArray, edge: dict) -> tuple[NDArray, NDArray]:
    """Simplices, each at its crossed edges, in the order of these."""
    done, todo = [], [(tuple(c), n) for c, n in zip(simplex.tolist(), number.tolist())]
    while todo:
        cell, own = todo.pop()
        crossed = [(a, b) for a in cell for b in cell if (a, b) in edge]
        if not crossed:
            done.append((own, cell))
            continue
        a, b = min(crossed)
        for end in (a, b):
            todo.append((tuple(edge[a, b] if c == end else c for c in cell), own))
    done.sort()
    return np.array([c for _, c in done], int).reshape(-1, simplex.shape[1]), \
        np.array([n for n, _ in done], int)


def facets_of(clipped: Clipped, facets: NDArray, tags: list[frozenset], ndim: int):
    """The skin of the divided cells, and the names of the old facets that its facets lie in."""
    known = {tuple(sorted(f)): tag for f, tag in zip(facets.tolist(), tags)}
    new, _ = boundary_facets(clipped.cells, ndim)
    return new, [known[tuple(sorted(set(clipped.ends[f].ravel().tolist())))] for f in new]
