"""Fields of integration points from one mesh to another: limited linear fields, taken in the mean.

Every old element holds the mean of its points and a slope by least squares over its neighbours,
made smaller where it would leave the range of their means (Barth and Jespersen, AIAA 89-0366). The
value of a new point is the mean of that over the part of its element that belongs to it: integrals
are kept but for the sampling, and no extreme is passed. Fields are logarithms of strains and
numbers that may be averaged (docs/remeshing.md).
"""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import optional
from ..points import Points

#: Samples to a side of what belongs to a point: of a triangle, of a quarter of a quad, and of the
#: cube that is folded to a tetrahedron.
TRIANGLE, QUARTER, TETRA = 6, 4, 3
#: Elements whose slopes are found at once.
RUN = 2048
#: Barycentric coordinates of places on an edge.
ON_EDGE = 1e-9
#: Columns of a table of fields: strain (6), ln J, ln V/V0, plastic strain, flow stress, work,
#: damage (4).
STRAIN, DILATATION, RATIO, PLASTIC, FLOW, WORK, DAMAGE = slice(0, 6), 6, 7, 8, 9, 10, slice(11, 15)


@dataclass
class CellFields:
    """Linear fields in the elements of a mesh.

    Attributes
    ----------
    centre : (element, ndim) of the points' volumes [length]
    mean : (element, field)
    slope : (element, ndim, field) [1/length]
    low, high : (element, field) range of the neighbours' means
    """

    centre: NDArray
    mean: NDArray
    slope: NDArray
    low: NDArray
    high: NDArray

    def at(self, places: NDArray, element: NDArray) -> NDArray:
        """Values at places (n, ndim) of the fields of these elements (n,)."""
        value = self.mean[element] + np.einsum("nd,ndf->nf", places - self.centre[element],
                                               self.slope[element])
        return np.clip(value, self.low[element], self.high[element])


def fields_of(points: Points) -> NDArray:
    """A row a point of the columns above."""
    return np.column_stack([points.strain, points.dilatation, points.ratio, points.plastic,
                            points.flow_stress, points.work, points.damage])


def cell_fields(x: NDArray, cells: list[NDArray], values: NDArray, owner: NDArray,
                place: NDArray, volume: NDArray) -> CellFields:
    """Linear fields of points. `owner`: element of each point, counted through `cells`."""
    n = sum(len(c) for c in cells)
    total = np.bincount(owner, volume, n)

    def mean_of(rows):
        return np.stack([np.bincount(owner, volume*r, n)/total for r in rows.T], axis=1)

    mean, centre = mean_of(values), mean_of(place)
    first, near = neighbours(cells, len(x))
    count = np.diff(first)
    low, high = mean.copy(), mean.copy()
    slope = np.empty((n, x.shape[1], mean.shape[1]))
    for at in range(0, n, RUN):   # arms and steps of all elements at once would fill the memory
        rows = slice(at, min(at + RUN, n))
        begin = first[at:rows.stop + 1] - first[at]
        other = near[first[at]:first[rows.stop]]
        own = np.repeat(np.arange(at, rows.stop), count[rows])
        arm, step = centre[other] - centre[own], mean[other] - mean[own]
        square = _sum(begin, arm[:, :, None]*arm[:, None, :])
        right = _sum(begin, arm[:, :, None]*step[:, None, :])
        scale = np.einsum("ndd->n", square)[:, None, None]
        ridge = 1e-9*np.maximum(scale, np.finfo(float).tiny)*np.eye(x.shape[1])
        slope[rows] = np.linalg.solve(square + ridge, right)
        np.minimum.at(low, own, mean[other])
        np.maximum.at(high, own, mean[other])
    factor = np.ones_like(mean)
    start = 0
    for group in cells:
        rows = slice(start, start + len(group))
        reach = x[group] - centre[rows, None, :]
        change = np.einsum("nkd,ndf->nkf", reach, slope[rows])
        room = np.where(change > 0.0, (high - mean)[rows, None, :], (low - mean)[rows, None, :])
        with np.errstate(divide="ignore", invalid="ignore"):
            share = np.where(np.abs(change) > 0.0, room/change, 1.0)
        factor[rows] = np.clip(share, 0.0, 1.0).min(axis=1)
        start += len(group)
    return CellFields(centre, mean, slope*factor[:, None, :], low, high)


def quartered(x: NDArray, cells: list[NDArray]) -> tuple[NDArray, list[NDArray]]:
    """Quads cut in four, a part for each of their points and in their order; others as they are.

    The points of a quad differ by more than those of neighbours where it bends: each keeps its own.
    """
    quads = [g for g in cells if g.shape[1] == 4 and x.shape[1] == 2]
    if not quads:
        return x, cells
    edges = np.sort(np.vstack([np.stack([g, np.roll(g, -1, axis=1)], axis=2).reshape(-1, 2)
                               for g in quads]), axis=1)
    ends, inverse = np.unique(edges, axis=0, return_inverse=True)
    inverse = inverse.ravel() + len(x)
    new, at, at_centre, found = [x, x[ends].mean(axis=1)], 0, len(x) + len(ends), []
    for group in cells:
        if group.shape[1] != 4:
            found.append(group)
            continue
        n = len(group)
        middle = inverse[at:at + 4*n].reshape(n, 4)
        centre = np.arange(at_centre, at_centre + n)
        new.append(x[group].mean(axis=1))
        at, at_centre = at + 4*n, at_centre + n
        parts = [np.stack([group[:, k], middle[:, k], centre, middle[:, k - 1]], axis=1)
                 for k in (0, 1, 3, 2)]   # corners in the order of the points
        found.append(np.stack(parts, axis=1).reshape(-1, 4))
    return np.vstack(new), found


def neighbours(cells: list[NDArray], n_node: int) -> tuple[NDArray, NDArray]:
    """Elements that share a node with each: `near[first[e]:first[e + 1]]`."""
    sparse = optional("scipy.sparse", "new meshes")
    row = np.concatenate([c.ravel() for c in cells])
    sizes = np.concatenate([np.full(len(c), c.shape[1]) for c in cells])
    column = np.repeat(np.arange(len(sizes)), sizes)
    touch = sparse.csr_matrix((np.ones(len(row)), (row, column)), (n_node, len(sizes)))
    both = (touch.T @ touch).tocsr()
    both.setdiag(0.0)
    both.eliminate_zeros()
    both.sort_indices()
    return both.indptr, both.indices


def _sum(first: NDArray, rows: NDArray) -> NDArray:
    """Sums of runs of rows; none of a run is zero."""
    total = np.concatenate([np.zeros((1, *rows.shape[1:])), np.cumsum(rows, axis=0)])
    return total[first[1:]] - total[first[:-1]]


class Locator:
    """Which element of a mesh holds a place; the nearest for places outside."""

    def __init__(self, x: NDArray, cells: list[NDArray]):
        tree = optional("scipy.spatial", "new meshes").cKDTree
        simplices, owner, start = [], [], 0
        for group in cells:
            numbers = np.arange(len(group)) + start
            parts = [group] if group.shape[1] == x.shape[1] + 1 else \
                [group[:, [0, 1, 2]], group[:, [0, 2, 3]]]
            simplices += parts
            owner += [numbers]*len(parts)
            start += len(group)
        self.simplices, self.owner = np.vstack(simplices), np.concatenate(owner)
        corner = x[self.simplices]
        self.origin = corner[:, 0]
        self.inverse = np.linalg.pinv(np.swapaxes(corner[:, 1:] - corner[:, :1], 1, 2))
        self.centre = corner.mean(axis=1)
        self.reach = np.linalg.norm(corner - self.centre[:, None], axis=2).max(axis=1)
        self.tree = tree(self.centre)

    def __call__(self, places: NDArray, most: int = 64) -> NDArray:
        """Elements (n,)."""
        found = np.full(len(places), -1)
        best = np.full(len(places), -np.inf)
        left, count = np.arange(len(places)), 6
        while len(left):
            count = min(count, len(self.centre))
            _, near = self.tree.query(places[left], count)
            near = near.reshape(len(left), -1)
            inside = self._inside(places[left], near)
            most_inside = inside.max(axis=1)
            # Of those that share an edge with the place on it the first, whatever rounding says.
            alike = inside >= most_inside[:, None] - ON_EDGE
            k = np.where(alike, near, len(self.centre)).argmin(axis=1)
            better = most_inside > best[left]
            found[left[better]] = near[better, k[better]]
            best[left] = np.maximum(best[left], most_inside)
            if count >= min(most, len(self.centre)):
                break
            left, count = left[best[left] < -1e-12], 4*count
        return self.owner[found]

    def _inside(self, places: NDArray, near: NDArray) -> NDArray:
        """Least barycentric coordinate of each place in each simplex, >= 0 inside; how far
        outside it is otherwise, by the size of the simplex."""
        arm = places[:, None, :] - self.origin[near]
        bary = np.einsum("nkij,nkj->nki", self.inverse[near], arm)
        return np.minimum(bary.min(axis=2), 1.0 - bary.sum(axis=2))


def samples_of(x: NDArray, group: NDArray) -> tuple[NDArray, NDArray]:
    """Places and weights that cover the part of each point of each element.

    Returns
    -------
    places : (element, point, sample, ndim)
    weights : (element, point, sample) area or volume of each
    """
    corners = x[group]
    if group.shape[1] == x.shape[1] + 1:
        bary = _simplex_grid(x.shape[1], TRIANGLE if x.shape[1] == 2 else TETRA)
        places = np.einsum("sk,ekd->esd", bary, corners)
        size = np.abs(np.linalg.det(corners[:, 1:] - corners[:, :1]))
        part = size/(len(bary)*(2.0 if x.shape[1] == 2 else 6.0))
        weights = np.repeat(part[:, None], len(bary), axis=1)
        return places[:, None], weights[:, None]
    line = (np.arange(QUARTER) + 0.5)/QUARTER
    places, weights = [], []
    # Integration points of quads in the order of the core: xi runs first.
    for eta0, xi0 in ((-1.0, -1.0), (-1.0, 0.0), (0.0, -1.0), (0.0, 0.0)):
        xi, eta = (g.ravel() for g in np.meshgrid(xi0 + line, eta0 + line))
        shape, slopes = _quad(xi, eta)
        places.append(np.einsum("sk,ekd->esd", shape, corners))
        jacobian = np.einsum("skp,ekd->esdp", slopes, corners)
        weights.append(np.abs(np.linalg.det(jacobian))/QUARTER**2)
    return np.stack(places, axis=1), np.stack(weights, axis=1)


def _quad(xi: NDArray, eta: NDArray) -> tuple[NDArray, NDArray]:
    """Shape functions (sample, 4) of a quad and their slopes (sample, 4, 2)."""
    sx, sy = np.array([-1, 1, 1, -1]), np.array([-1, -1, 1, 1])
    fx, fy = 1.0 + xi[:, None]*sx, 1.0 + eta[:, None]*sy
    return 0.25*fx*fy, 0.25*np.stack([sx*fy, fx*sy], axis=2)


def _simplex_grid(ndim: int, n: int) -> NDArray:
    """Barycentric coordinates of the centres of parts of equal size of a simplex."""
    if ndim == 2:
        up = [((i + 1/3)/n, (j + 1/3)/n) for i in range(n) for j in range(n - i)]
        down = [((i + 2/3)/n, (j + 2/3)/n) for i in range(n - 1) for j in range(n - 1 - i)]
        inner = np.array(up + down)
    else:
        grid = (np.arange(n) + 0.5)/n
        # Kuhn's map of a cube onto a tetrahedron keeps equal volumes.
        inner = -np.diff(np.sort(np.stack(np.meshgrid(grid, grid, grid), -1).reshape(-1, 3),
                                 axis=1)[:, ::-1], axis=1, append=0.0)
    return np.column_stack([1.0 - inner.sum(axis=1), inner])


def transfer(fields: CellFields, locate: Locator, x: NDArray, cells: list[NDArray],
             axisymmetric: bool) -> tuple[list[NDArray], list[NDArray]]:
    """Values (element, point, field) of a new mesh, and the weights (element, point) of them."""
    values, volumes = [], []
    for group in cells:
        places, weights = samples_of(x, group)
        if axisymmetric:
            weights = weights*places[..., 0]
        flat = places.reshape(-1, x.shape[1])
        sampled = fields.at(flat, locate(flat)).reshape(*weights.shape, -1)
        volume = weights.sum(axis=2)
        values.append((sampled*weights[..., None]).sum(axis=2)/volume[..., None])
        volumes.append(volume)
    return values, volumes


def admissible(values: NDArray, highest: float) -> tuple[NDArray, NDArray]:
    """Elastic strains taken back to the yield surface where means have left it, never up.

    `highest`: equivalent elastic strain over flow stress on that surface. Returns the values and
    by how much each strain was taken back, relative.
    """
    values = values.copy()
    values[..., PLASTIC] = np.maximum(values[..., PLASTIC], 0.0)
    size = equivalent(values[..., STRAIN])
    bound = highest*values[..., FLOW]
    over = (size > bound) & (values[..., FLOW] > 0.0)
    factor = np.where(over, bound/np.maximum(size, np.finfo(float).tiny), 1.0)
    values[..., STRAIN] *= factor[..., None]
    return values, 1.0 - factor


def equivalent(strain: NDArray) -> NDArray:
    """Norm of deviators (..., 6) of tensor components xx yy zz xy xz yz."""
    return np.sqrt((strain[..., :3]**2).sum(axis=-1) + 2.0*(strain[..., 3:]**2).sum(axis=-1))


def highest_strain(points: Points) -> float:
    """Equivalent elastic strain over flow stress of points that flow; none does: infinite."""
    flows = points.flow_stress > 0.0
    if not flows.any():
        return np.inf
    return float((equivalent(points.strain[flows])/points.flow_stress[flows]).max())
