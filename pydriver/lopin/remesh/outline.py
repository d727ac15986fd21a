"""The outline of a plane body: closed loops of facets, cut where names or directions change."""
from __future__ import annotations

from dataclasses import dataclass
from math import ceil

import numpy as np
from numpy.typing import NDArray

from .body import refused
from .sizes import on_grid

#: An old node where the outline turns by more stays a node [rad].
CORNER = np.deg2rad(20.0)*(1.0 + 1e-9)


@dataclass
class Chain:
    """A piece of the outline between two nodes that stay, in the direction of the outline.

    Attributes
    ----------
    nodes : rows of the old nodes on it (m + 1,)
    tag : names that hold all its facets
    """

    nodes: NDArray
    tag: frozenset


@dataclass
class Outline:
    """New nodes on an outline, in order, one closed loop after the other.

    Attributes
    ----------
    x : places (n, 2) [length]
    facet : old facet that each lies on (n,): row of `chains` order of the old outline
    share : how far along it (n,)
    tags : names of the new edge that begins at each node (n,)
    loops : rows of each loop
    fixed : nodes of the old mesh that stay in their place (n,)
    """

    x: NDArray
    ends: NDArray       #: (n, 2) rows of the old nodes of the facet that each lies on
    share: NDArray      #: how far along it, 0 to 1
    tags: list[frozenset]
    loops: list[NDArray]
    kept: NDArray       #: (n,) row of the old node that stays here, or -1


def loops_of(facets: NDArray) -> list[NDArray]:
    """Closed loops: rows of facets in order; the body lies on the left of each."""
    after: dict[int, int] = {}
    for k, (a, _) in enumerate(facets.tolist()):
        if a in after:
            raise refused("the outline of the body touches itself at a node")
        after[a] = k
    found, left = [], dict(after)
    while left:
        start, k = next(iter(left.items()))
        loop = []
        node = start
        while node in left:
            k = left.pop(node)
            loop.append(k)
            node = int(facets[k, 1])
        found.append(np.array(loop))
    return found


def chains_of(x: NDArray, facets: NDArray, tags: list[frozenset], loop: NDArray,
              required: set[int]) -> list[Chain]:
    """The chains of one loop: cut at corners, where names change, and at required nodes."""
    nodes = facets[loop, 0]
    step = x[facets[loop, 1]] - x[nodes]
    before = np.roll(step, 1, axis=0)
    angle = np.abs(np.arctan2(before[:, 0]*step[:, 1] - before[:, 1]*step[:, 0],
                              (before*step).sum(axis=1)))
    cut = [k for k in range(len(loop)) if angle[k] > CORNER or int(nodes[k]) in required
           or tags[loop[k]] != tags[loop[k - 1]]]
    if not cut:
        cut = [0]
    chains = []
    for k, first in enumerate(cut):
        last = cut[k + 1] if k + 1 < len(cut) else cut[0] + len(loop)
        rows = np.arange(first, last + 1) % len(loop)
        chains.append(Chain(nodes[rows], tags[loop[first]]))
    return chains


def resample(points: NDArray, size, hausdorff: float, more: int = 0) -> NDArray:
    """Places along a polyline, as lengths from its start: cells of the size asked for, smaller
    where an old point would be farther than `hausdorff` from the new line.

    `size`: of places (n, 2), the lengths wanted there; its `least` and `growth` hold here too.
    `more`: cells more than that.
    """
    length = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))]
    fine = np.linspace(0.0, length[-1], max(16, 8*len(points)))
    wanted = size(at_length(points, length, fine))
    for _ in range(20):
        places = _spread(fine, wanted, more)
        far = _distances(points, length, places)
        cell = np.clip(np.searchsorted(places, length, side="right") - 1, 0, len(places) - 2)
        off = np.unique(cell[far > hausdorff])
        if len(off) == 0:
            break
        low, high = places[off], places[off + 1]
        inside = ((fine[:, None] >= low) & (fine[:, None] <= high)).any(axis=1)
        smaller = np.where(inside, np.maximum(0.8*wanted, size.least), wanted)
        smaller = _graded(fine, smaller, size.growth - 1.0)
        if np.array_equal(smaller, wanted):
            break
        wanted = smaller
    return places


def _spread(fine: NDArray, wanted: NDArray, more: int) -> NDArray:
    """Places whose distances follow the sizes wanted at fine steps."""
    count = np.r_[0.0, np.cumsum(np.diff(fine)*0.5*(1.0/wanted[1:] + 1.0/wanted[:-1]))]
    n = max(1, ceil(count[-1] - 0.5 - 1e-6)) + more   # of a half the less, whatever rounding says
    places = np.interp(np.linspace(0.0, count[-1], n + 1), count, fine)
    places[0], places[-1] = 0.0, fine[-1]
    return places


def _graded(s: NDArray, size: NDArray, slope: float) -> NDArray:
    """Sizes that change by no more than a slope along a line."""
    down = np.minimum.accumulate(size - slope*s) + slope*s
    up = np.minimum.accumulate((size + slope*s)[::-1])[::-1] - slope*s
    return np.minimum(down, up)


def at_length(points: NDArray, length: NDArray, places: NDArray) -> NDArray:
    """Points of a polyline at lengths from its start."""
    return np.stack([np.interp(places, length, points[:, k]) for k in range(2)], axis=1)


def _distances(points: NDArray, length: NDArray, places: NDArray) -> NDArray:
    """Of the old points from the new line (point,) [length]."""
    new = at_length(points, length, places)
    k = np.clip(np.searchsorted(places, length, side="right") - 1, 0, len(places) - 2)
    along, arm = new[k + 1] - new[k], points - new[k]
    long = np.maximum(np.linalg.norm(along, axis=1), np.finfo(float).tiny)
    return np.abs(along[:, 0]*arm[:, 1] - along[:, 1]*arm[:, 0])/long


def new_outline(x: NDArray, facets: NDArray, tags: list[frozenset], required: set[int], size,
                hausdorff: float, even: bool) -> Outline:
    """A new outline of the old one; `even`: an even number of nodes on each loop (quads)."""
    places, ends, share, names, loops, kept = [], [], [], [], [], []
    for loop in loops_of(facets):
        chains = chains_of(x, facets, tags, loop, required)
        lines = [resample(x[c.nodes], size, hausdorff) for c in chains]
        if even and sum(len(s) - 1 for s in lines) % 2:
            k = int(np.argmax([len(s) for s in lines]))
            lines[k] = resample(x[chains[k].nodes], size, hausdorff, more=1)
            if sum(len(s) - 1 for s in lines) % 2:
                lines[k] = _split_longest(lines[k])
        first = len(places)
        for chain, line in zip(chains, lines):
            points = x[chain.nodes]
            length = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))]
            k = np.clip(np.searchsorted(length, line[:-1], side="right") - 1, 0, len(points) - 2)
            s = (line[:-1] - length[k])/(length[k + 1] - length[k])
            ends += list(zip(chain.nodes[k], chain.nodes[k + 1]))
            share += list(s)
            places += list((1.0 - s)[:, None]*points[k] + s[:, None]*points[k + 1])
            names += [chain.tag]*(len(line) - 1)
            kept += [int(chain.nodes[0])] + [-1]*(len(line) - 2)
        loops.append(np.arange(first, len(places)))
    return Outline(np.array(places), np.array(ends), np.array(share), names, loops,
                   np.array(kept))


def _split_longest(line: NDArray) -> NDArray:
    """One place more, in the middle of the longest piece."""
    piece = np.diff(line)
    k = int(np.argmax(on_grid(piece/piece.max())))
    return np.insert(line, k + 1, 0.5*(line[k] + line[k + 1]))


def volume_of(x: NDArray, loops: list[NDArray], axisymmetric: bool) -> float:
    """Area inside loops [length^2], or the volume that it sweeps about the axis [length^3]."""
    total = 0.0
    for loop in loops:
        p, q = x[loop], x[np.roll(loop, -1)]
        twice = p[:, 0]*q[:, 1] - q[:, 0]*p[:, 1]
        total += (twice*(p[:, 0] + q[:, 0])).sum()*np.pi/3.0 if axisymmetric \
            else 0.5*twice.sum()
    return float(total)
