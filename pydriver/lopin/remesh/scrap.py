"""Pieces that nothing holds once metal has separated: scrap, told and taken out."""
from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from .body import Body, DeckParts, faces_of_cell, supports
from .state import Snapshot

#: A piece is loose whose tools push it one way: their forces add up to more than this share of
#: what they would if all pointed there.
ONE_WAY = 0.9


def joined(count: int, pairs: NDArray) -> NDArray:
    """The group of each of `count` things that pairs join, named by its first.

    >>> joined(4, np.array([[0, 2], [2, 3]])).tolist()
    [0, 1, 0, 0]
    """
    root = np.arange(count)
    while len(pairs):
        low = np.minimum(root[pairs[:, 0]], root[pairs[:, 1]])
        before = root.copy()
        np.minimum.at(root, pairs[:, 0], low)
        np.minimum.at(root, pairs[:, 1], low)
        root = root[root]
        if (root == before).all():
            break
    return root


def bodies(cells: list[NDArray], n_node: int) -> NDArray:
    """The body of each node: named by its first node."""
    return joined(n_node, np.vstack([np.stack([g[:, 0], g[:, k]], axis=1) for g in cells
                                     for k in range(1, g.shape[1])]))


def split(cells: list[NDArray], ndim: int) -> tuple[list[NDArray], NDArray]:
    """Nodes at which parts of a mesh only touch become one for each part.

    Corners of elements belong together where these share a facet. Returns the cells and the old
    row of each node.
    """
    first = np.cumsum([0, *(g.size for g in cells)])
    node = np.concatenate([g.ravel() for g in cells])
    corner = [np.arange(g.size).reshape(g.shape) + at for g, at in zip(cells, first)]
    facets = []
    for group, own in zip(cells, corner):
        for face in faces_of_cell(ndim, group.shape[1]):
            face = list(face)
            order = np.argsort(group[:, face], axis=1)
            facets.append(np.hstack([np.take_along_axis(group[:, face], order, 1),
                                     np.take_along_axis(own[:, face], order, 1)]))
    facets = np.vstack(facets)
    facets = facets[np.lexsort(facets[:, :ndim].T)]
    same = (facets[1:, :ndim] == facets[:-1, :ndim]).all(axis=1)
    pairs = np.stack([facets[:-1][same, ndim:].ravel(), facets[1:][same, ndim:].ravel()], axis=1)
    groups, number = np.unique(joined(len(node), pairs), return_inverse=True)
    order = np.argsort(node[groups], kind="stable")
    rank = np.empty(len(groups), int)
    rank[order] = np.arange(len(groups))
    number = rank[number.ravel()]
    return [number[own] for own in corner], node[groups][order]


def by_group(body: Body, values: NDArray) -> list[NDArray]:
    """Values of the elements of the body (element, ...), cut as `body.cells` is."""
    return np.split(values, np.cumsum([len(group) for group in body.cells])[:-1])


def pieces(body: Body, gone: NDArray) -> Iterator[NDArray]:
    """Elements of each piece that is left (element,), the largest first."""
    kept = [g[~out] for g, out in zip(body.cells, by_group(body, gone))]
    kept = [g for g in kept if len(g)]
    if not kept:
        return
    apart, old = split(kept, body.ndim)
    of_node = bodies(apart, len(old))
    of_element = np.concatenate([of_node[g[:, 0]] for g in apart])
    names, count = np.unique(of_element, return_counts=True)
    for name in names[np.argsort(-count, kind="stable")]:
        own = np.zeros(len(gone), bool)
        own[np.flatnonzero(~gone)[of_element == name]] = True
        yield own


def forces(body: Body, last: Snapshot) -> NDArray:
    """Forces of the tools on the nodes of the body (node, ndim), by the areas around them."""
    x, f = last.x, body.facets
    if body.ndim == 2:
        area = np.linalg.norm(x[f[:, 1]] - x[f[:, 0]], axis=1)
        if body.axisymmetric:
            area = area*x[f, 0].mean(axis=1)
    else:
        area = np.linalg.norm(np.cross(x[f[:, 1]] - x[f[:, 0]], x[f[:, 2]] - x[f[:, 0]]), axis=1)
    of_node = np.bincount(f.ravel(), np.repeat(area, f.shape[1]), len(x))
    force = np.zeros((len(x), body.ndim))
    t = last.tractions
    if t is not None:
        at = {int(label): k for k, label in enumerate(body.labels)}
        row = np.array([at.get(int(label), -1) for label in t.node], int)
        own = row >= 0
        np.add.at(force, row[own], t.traction[own, :body.ndim])
    return force*of_node[:, None]


def loose(parts: DeckParts, body: Body, last: Snapshot, gone: NDArray) -> list[NDArray]:
    """Pieces that neither supports nor tools hold, once the elements `gone` are out (element,).

    A piece may move where no support of it says no; there it is held by tools that push it from
    more than one side.
    """
    cell_of = np.concatenate([np.repeat(np.arange(len(g)) + at, g.shape[1]) for g, at in zip(
        body.cells, np.cumsum([0, *(len(g) for g in body.cells)]))])
    node_of = np.concatenate([g.ravel() for g in body.cells])
    held, force = supports(parts, body, last.clock.step), forces(body, last)
    found = []
    for own in pieces(body, gone):
        nodes = np.unique(node_of[own[cell_of]])
        ways = ~held[nodes].any(axis=0)
        if body.axisymmetric:
            ways[0] = False
        push = force[nodes][:, ways]
        whole = np.linalg.norm(push, axis=1).sum()
        if ways.any() and np.linalg.norm(push.sum(axis=0)) >= ONE_WAY*whole:
            found.append(own)
    return found
