"""Meshes of tetrahedra, by MMG: skin, edges and planes are kept, sizes are given at nodes."""
from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..errors import optional
from .body import refused
from .sizes import on_grid

#: Edges of the skin where it turns by more stay edges [degrees].
RIDGE = 40.0


def remesh_tetrahedra(x: NDArray, cells: NDArray, facets: NDArray, reference: NDArray,
                      size: NDArray, limits: tuple[float, float, float], growth: float
                      ) -> tuple[NDArray, NDArray, NDArray, NDArray]:
    """Nodes, tetrahedra, triangles of the skin, and their references, of a new mesh.

    MMG reads places and sizes in smallest cells, without their last bits (`on_grid`).

    Parameters
    ----------
    x, cells, facets : of the old mesh
    reference : number of each facet (facet,); the lines between different ones stay
    size : lengths asked for at the nodes (node,)
    limits : smallest and largest size, distance of the old and the new skin [length]
    growth : ratio of the sizes of neighbours
    """
    mmg = optional("mmgpy", "new meshes")
    mesh = mmg.MmgMesh3D()
    mesh.set_mesh_size(vertices=len(x), tetrahedra=len(cells), triangles=len(facets))
    least, most, hausdorff = limits
    given = on_grid(x/least)
    mesh.set_vertices(np.ascontiguousarray(given))
    mesh.set_tetrahedra(np.ascontiguousarray(cells, np.int32))
    mesh.set_triangles(np.ascontiguousarray(facets, np.int32),
                       np.ascontiguousarray(reference, np.int64))
    mesh.set_field("metric", np.ascontiguousarray(on_grid(size/least)).reshape(-1, 1))
    try:
        mesh.remesh(hausd=float(on_grid(hausdorff/least)), hmin=1.0,
                    hmax=float(on_grid(most/least)), hgrad=growth, ar=RIDGE, verbose=-1)
    except Exception as problem:   # of whatever kind mmgpy has
        raise refused(f"MMG cannot mesh the body: {problem}",
                      "see that its tetrahedra share whole faces, and that its skin does not meet "
                      "itself") from problem
    new, found = np.array(mesh.get_vertices()), np.array(mesh.get_tetrahedra())
    skin, of = mesh.get_triangles_with_refs()
    first = int(found.min())
    # What was taken from places of the skin it gets back.
    on_skin = np.unique(np.array(skin) - first)
    near, share = closest_on_facets(new[on_skin], given, facets)
    new[on_skin] += np.einsum("nk,nkd->nd", share, (x/least - given)[facets[near]])
    return least*new, upright(new, found - first), np.array(skin) - first, np.array(of)


def upright(x: NDArray, cells: NDArray) -> NDArray:
    """Tetrahedra whose last node lies on the positive side of the first three."""
    e = x[cells[:, 1:]] - x[cells[:, :1]]
    turned = cells.copy()
    wrong = np.linalg.det(e) < 0.0
    turned[wrong] = cells[wrong][:, [0, 2, 1, 3]]
    return turned


def volume_inside(x: NDArray, facets: NDArray) -> float:
    """Volume inside a closed skin of triangles that look outward [length^3]."""
    return float(np.linalg.det(x[facets]).sum()/6.0)


def narrowest_slot(x: NDArray, facets: NDArray, reach: float) -> tuple[float, NDArray]:
    """Least distance below `reach` between facets that face each other across air, and where.

    A fold is such a slot while it closes; its two sides do not see each other as contact does. The
    distance is infinite where there is none.
    """
    tree = optional("scipy.spatial", "new meshes").cKDTree
    corner = x[facets]
    middle = corner.mean(axis=1)
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1), np.finfo(float).tiny)[:, None]
    one, other = tree(middle).query_pairs(reach, output_type="ndarray").T
    arm = middle[other] - middle[one]
    far = np.linalg.norm(arm, axis=1)
    facing = ((normal[one]*normal[other]).sum(axis=1) < -0.7) & \
        ((arm*normal[one]).sum(axis=1) > 0.7*far)
    if not facing.any():
        return np.inf, np.full(3, np.nan)
    k = np.flatnonzero(facing)[np.argmin(far[facing])]
    return float(far[k]), 0.5*(middle[one[k]] + middle[other[k]])


def closest_on_facets(places: NDArray, x: NDArray, facets: NDArray, among: int = 12
                      ) -> tuple[NDArray, NDArray]:
    """Facet that is closest to each place, and the shares of its corners there."""
    tree = optional("scipy.spatial", "new meshes").cKDTree
    _, near = tree(x[facets].mean(axis=1)).query(places, min(among, len(facets)))
    near = near.reshape(len(places), -1)
    near_enough = 1e-12*np.ptp(x, axis=0).max()
    best = np.full(len(places), np.inf)
    facet = np.zeros(len(places), int)
    share = np.zeros((len(places), 3))
    for column in near.T:
        own = closest_share(places, x[facets[column]])
        far = np.linalg.norm(np.einsum("nk,nkd->nd", own, x[facets[column]]) - places, axis=1)
        closer = far < best - near_enough
        best[closer], facet[closer], share[closer] = far[closer], column[closer], own[closer]
    return facet, share


def closest_share(places: NDArray, corners: NDArray) -> NDArray:
    """Shares of the corners (n, 3, 3) of triangles at the points closest to places (n, 3)."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    normal = np.cross(b - a, c - a)
    area = np.maximum((normal**2).sum(axis=1), np.finfo(float).tiny)
    arm = places - a
    second = (np.cross(arm, c - a)*normal).sum(axis=1)/area
    third = (np.cross(b - a, arm)*normal).sum(axis=1)/area
    inside = np.stack([1.0 - second - third, second, third], axis=1)
    best, far = inside, np.where((inside >= 0.0).all(axis=1), 0.0, np.inf)
    for i, j in ((0, 1), (1, 2), (2, 0)):
        edge = corners[:, j] - corners[:, i]
        s = ((places - corners[:, i])*edge).sum(axis=1)
        s = np.clip(s/np.maximum((edge**2).sum(axis=1), np.finfo(float).tiny), 0.0, 1.0)
        off = np.linalg.norm(corners[:, i] + s[:, None]*edge - places, axis=1)
        own = np.zeros_like(inside)
        own[:, i], own[:, j] = 1.0 - s, s
        closer = off < far
        best, far = np.where(closer[:, None], own, best), np.where(closer, off, far)
    return best
