"""How fine a new mesh is: the least of what shape, tools and fields ask for, graded."""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import optional

#: Cells to a quarter turn of an arc, and across a gap.
CELLS_OF_ARC, CELLS_ACROSS = 8, 2
#: Share of the critical damage from which on metal has the cells of a cut; its longest cells there
#: by these, before it is meshed anew.
NEAR_FRACTURE, COARSER = 0.5, 1.6
#: Change of plastic strain across one cell.
STRAIN_STEP = 0.2
#: What a mesher reads is rounded to this share of a smallest cell: it decides by comparing, often
#: what is equal, and what rounding leaves of places would lay the cells in another way.
GRID = 2.0**-12


def on_grid(value: NDArray | float) -> NDArray:
    """Numbers, in smallest cells, without what rounding leaves of them."""
    return np.round(np.asarray(value)/GRID)*GRID


@dataclass
class Sizes:
    """Sizes that grow with the distance from the places that ask for small ones.

    Attributes
    ----------
    base, least : largest and smallest size [length]
    growth : ratio of the sizes of neighbours, > 1
    x, h : places and the sizes asked for there
    """

    base: float
    least: float
    growth: float
    x: NDArray
    h: NDArray

    @classmethod
    def of(cls, base: float, least: float, growth: float, asked: list[tuple[NDArray, NDArray]],
           ndim: int) -> Sizes:
        """From lists of places and sizes; what asks for no less than the base is left out."""
        x = np.vstack([a[0] for a in asked] or [np.empty((0, ndim))])
        h = np.concatenate([a[1] for a in asked] or [np.empty(0)])
        small = h < base
        x, h = x[small], np.maximum(h[small], least)
        return cls(base, least, growth, *_needed(x, h, growth - 1.0))

    def with_edges(self, x: NDArray, ends: NDArray) -> Sizes:
        """With the edges of an outline that is there: inside, sizes grow from theirs."""
        a, b = x[ends[:, 0]], x[ends[:, 1]]
        asked = [(self.x, self.h), (0.5*(a + b), np.linalg.norm(b - a, axis=1))]
        return Sizes.of(self.base, self.least, self.growth, asked, x.shape[1])

    def scaled(self, factor: float) -> Sizes:
        """All sizes times a factor."""
        return Sizes(self.base*factor, self.least, self.growth, self.x, self.h*factor)

    def __call__(self, places: NDArray) -> NDArray:
        """Sizes at places (n, ndim)."""
        places = np.atleast_2d(places)
        size = np.full(len(places), self.base)
        if len(self.h) == 0:
            return size
        distances = optional("scipy.spatial.distance", "new meshes").cdist
        run = max(1, 4_000_000//len(self.h))
        for start in range(0, len(places), run):
            part = slice(start, start + run)
            asked = distances(places[part], self.x)
            asked *= self.growth - 1.0
            asked += self.h
            size[part] = np.minimum(size[part], asked.min(axis=1))
        return size


def _needed(x: NDArray, h: NDArray, slope: float) -> tuple[NDArray, NDArray]:
    """Without the places whose neighbours ask for as little: from the smallest on."""
    order = np.argsort(on_grid(h/h.min(initial=np.inf)), kind="stable")   # equal ones as they come
    x, h = x[order], h[order]
    keep = np.ones(len(h), bool)
    for k in range(len(h)):
        if not keep[k]:
            continue
        far = np.linalg.norm(x[k + 1:] - x[k], axis=1)
        keep[k + 1:] &= h[k + 1:] < h[k] + slope*far - 0.05*h[k + 1:]
    return x[keep], h[keep]


def of_curvature(x: NDArray, radius: NDArray) -> tuple[NDArray, NDArray]:
    """Cells along arcs of these radii."""
    return x, radius*(0.5*np.pi/CELLS_OF_ARC)


def of_thickness(x: NDArray, ends: NDArray, normals: NDArray) -> tuple[NDArray, NDArray]:
    """Cells across the body, straight inward from the middle of each edge of a plane outline.

    `ends`: rows of the nodes of each edge; `normals`: outward.
    """
    a, b = x[ends[:, 0]], x[ends[:, 1]]
    middle, edge = 0.5*(a + b), b - a
    across = np.full(len(middle), np.inf)
    for k, (m, n) in enumerate(zip(middle, -normals)):
        turned = n[0]*edge[:, 1] - n[1]*edge[:, 0]
        arm = a - m
        with np.errstate(divide="ignore", invalid="ignore"):
            t = (arm[:, 0]*edge[:, 1] - arm[:, 1]*edge[:, 0])/turned
            s = (arm[:, 0]*n[1] - arm[:, 1]*n[0])/turned
        # Through a node it meets both edges there.
        meets = (t > 1e-9*np.linalg.norm(edge[k])) & (s >= -1e-9) & (s <= 1.0 + 1e-9)
        meets[k] = False
        if meets.any():
            across[k] = t[meets].min()
    found = np.isfinite(across)
    return middle[found], across[found]/CELLS_ACROSS


def of_gradient(x: NDArray, slope: NDArray) -> tuple[NDArray, NDArray]:
    """Cells across which a plastic strain of these gradients changes by `STRAIN_STEP`."""
    with np.errstate(divide="ignore"):
        return x, STRAIN_STEP/slope


def of_fracture(x: NDArray, damage: NDArray, cuts) -> list[tuple[NDArray, NDArray]]:
    """Cells of a cut where damage (point, criterion) comes near a critical value."""
    found = []
    for column, critical, cell in cuts:
        near = damage[:, column] >= NEAR_FRACTURE*critical
        found.append((x[near], np.full(int(near.sum()), cell)))
    return found
