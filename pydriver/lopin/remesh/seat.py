"""The new skin on the tools, and the volume that it had."""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

#: New nodes where the old ones pressed lie on the tool if they are this near, by the size.
NEAR = 0.05
#: Farther from the tool than this, by the size, they are not on it: what just touches is.
TOUCHES = 1e-6


@dataclass
class Seat:
    """What seating did.

    Attributes
    ----------
    x : places (n, ndim) [length]
    seated : nodes that were put on a tool (n,)
    farthest : how far [length]
    """

    x: NDArray
    seated: NDArray
    farthest: float


def seat(x: NDArray, pressed: NDArray, size: NDArray, on_tool: list[tuple[NDArray, NDArray]],
         planes: list[NDArray]) -> Seat:
    """Put nodes of the skin on the tools: those that were pressed, and those that are inside.

    Parameters
    ----------
    pressed : whether the old nodes around were (n,)
    size : of the new mesh there (n,) [length]
    on_tool : for each tool the nodes that may meet it, and the closest points: a row each of gap,
        overhang, point, normal
    planes : normals of the planes that each node stays in (n,) of (k, ndim)
    """
    x = x.copy()
    seated, farthest = np.zeros(len(x), bool), 0.0
    for nodes, feet in on_tool:
        d = x.shape[1]
        gap, beyond, foot = feet[:, 0], feet[:, 1] > 0.0, feet[:, 2:2 + d]
        wanted = ((pressed[nodes] & (np.abs(gap) < NEAR*size[nodes])) |
                  ((gap < TOUCHES*size[nodes]) & (gap > -size[nodes]))) & ~beyond
        for node, place in zip(nodes[wanted], foot[wanted]):
            step = kept_in(place - x[node], planes[node])
            farthest = max(farthest, float(np.linalg.norm(step)))
            x[node] += step
        seated[nodes[wanted]] = True
    return Seat(x, seated, farthest)


def kept_in(step: NDArray, normals: NDArray) -> NDArray:
    """What a step (ndim,) has along the planes of these unit normals (k, ndim).

    >>> kept_in(np.array([3.0, 4.0]), np.array([[0.0, 1.0]]))
    array([3., 0.])
    """
    for normal in normals:
        step = step - (step @ normal)*normal
    return step


def keep_volume(x: NDArray, free: NDArray, normals: NDArray, wanted: float, volume_of,
                ) -> tuple[NDArray, float]:
    """Move free nodes along their normals, all by the same way, until the volume is right.

    `volume_of`: of places (n, ndim). Returns the places and the way [length]; without free nodes
    nothing moves.
    """
    if not free.any():
        return x, 0.0
    way, moved = 0.0, x
    for _ in range(30):
        missing = wanted - volume_of(moved)
        if abs(missing) <= 1e-14*wanted:
            break
        step = 1e-6*np.ptp(x, axis=0).max()
        slope = (volume_of(_offset(x, free, normals, way + step)) - volume_of(moved))/step
        if not slope > 0.0:
            break
        way += missing/slope
        moved = _offset(x, free, normals, way)
    return moved, way


def _offset(x: NDArray, free: NDArray, normals: NDArray, way: float) -> NDArray:
    moved = x.copy()
    moved[free] += way*normals[free]
    return moved
