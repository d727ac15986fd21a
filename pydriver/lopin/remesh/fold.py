"""A fold that closes: sides of one outline that lie on each other, and a mesher's way between."""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .masters import normals_of
from .seat import NEAR, TOUCHES, kept_in

#: Sides face each other where the cosine of their normals is below this.
FACING = -0.2
#: Deeper than this, by the size, is the other face of a wall.
DEEP = 0.25
#: A mesher sees sides that are this near, by the size, drawn apart by as much.
APART = 0.05


@dataclass
class Fold:
    """Where an outline lies on itself.

    Attributes
    ----------
    x : places (n, 2) [length]
    seated : nodes that were put on the other side (n,)
    met : nodes that lie on it, and those that they lie on (n,)
    farthest : how far one was moved [length]
    """

    x: NDArray
    seated: NDArray
    met: NDArray
    farthest: float = 0.0


def close_fold(x: NDArray, edges: NDArray, pressed: NDArray, size: NDArray,
               planes: list[NDArray]) -> Fold:
    """Put nodes of a surface that meets itself on its other side: those that were pressed, then
    those that are inside. Nodes of edges on which others lie stay.

    Parameters
    ----------
    edges : of the surface, rows of their ends, the body on the left (edge, 2)
    pressed : whether the old nodes around bore a traction of the surface against itself (n,)
    size : of the new mesh (n,) [length]
    planes : normals of the lines that each node stays on (n,) of (k, 2)
    """
    fold = Fold(x.copy(), np.zeros(len(x), bool), np.zeros(len(x), bool))
    lain_upon = np.zeros(len(x), bool)
    own = np.unique(edges)
    for node in [*own[pressed[own]], *own[~pressed[own]]]:
        if lain_upon[node]:
            continue
        edge, gap, foot = opposite(fold.x, edges, node, size[node])
        if edge < 0 or gap > (NEAR if pressed[node] else TOUCHES)*size[node]:
            continue
        step = kept_in(foot - fold.x[node], planes[node])
        fold.farthest = max(fold.farthest, float(np.linalg.norm(step)))
        fold.x[node] += step
        fold.seated[node] = True
        lain_upon[edges[edge]] = True
    fold.met = fold.seated | lain_upon
    return fold


def opposite(x: NDArray, edges: NDArray, node: int, size: float) -> tuple[int, float, NDArray]:
    """The nearest edge that faces a node across its fold, its gap and the foot; -1 without one."""
    around = (edges == node).any(axis=1)
    a, b = x[edges[:, 0]], x[edges[:, 1]]
    normal = normals_of(np.stack([a, b], axis=1))
    normal /= np.maximum(np.linalg.norm(normal, axis=1), np.finfo(float).tiny)[:, None]
    mean = normal[around].sum(axis=0)
    along = b - a
    s = ((x[node] - a)*along).sum(axis=1)/np.maximum((along**2).sum(axis=1), np.finfo(float).tiny)
    foot = a + np.clip(s, 0.0, 1.0)[:, None]*along
    arm = x[node] - foot
    far, gap = np.linalg.norm(arm, axis=1), (arm*normal).sum(axis=1)
    faces = ~around & (normal @ mean < FACING*np.linalg.norm(mean)) & (far < size) \
        & (gap > -DEEP*size)
    # Beyond its ends an edge is met only if it is the next one's end too: nearly straight on.
    faces &= far < np.abs(gap) + NEAR*size
    if not faces.any():
        return -1, np.inf, x[node]
    k = int(np.argmin(np.where(faces, far, np.inf)))
    return k, float(gap[k]), foot[k]


def drawn_apart(x: NDArray, edges: NDArray, normals: NDArray, size: NDArray,
                planes: list[NDArray]) -> NDArray:
    """Places for a mesher: sides that lie on each other, or nearly, go inward."""
    apart = x.copy()
    for node in np.unique(edges):
        edge, gap, _ = opposite(x, edges, node, size[node])
        if edge < 0 or gap > APART*size[node]:
            continue
        for near in (node, *edges[edge]):
            apart[near] = x[near] + kept_in(-APART*size[near]*normals[near], planes[near])
    return apart


def deepest_inside(x: NDArray, edges: NDArray, size: NDArray) -> float:
    """How far a node is inside the other side of its fold, by the size there."""
    most = 0.0
    for node in np.unique(edges):
        edge, gap, _ = opposite(x, edges, node, size[node])
        if edge >= 0:
            most = max(most, -gap/size[node])
    return most
