"""Forces that act on the skin of a body, from the stresses inside, and on another mesh of it."""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import optional
from .body import Body
from .masters import closest_on_edges
from .part import NewMesh
from .space import closest_on_facets
from .state import Snapshot
from .tools import Tools, nodes_within

#: Nodes this near to a tool lie on it, by the size of the body.
TOUCHES = 1e-9
#: A traction presses a face that it meets by more than this, by its size.
PRESSING = 0.2
#: Forces of nodes below this share of the largest are rounding.
NOTHING = 1e-7
#: Forces inside above this share of the largest tell that the state is not one of balance.
AT_REST = 1e-3
#: Shares of forces that fade by which their resultants, and the sums of their sizes, may differ on
#: a new skin: those that pull at it are no tractions that press.
GONE, ASTRAY = 1e-3, 0.1


@dataclass
class Samples:
    """Places of a skin where tractions are looked at.

    Attributes
    ----------
    place, outward : (facet, sample, ndim) [length]; unit normal of the facet
    weight : area of each, all round an axis (facet, sample) [length^(ndim-1)]
    shape : of the corners of the facet (sample, corner)
    """

    place: NDArray
    outward: NDArray
    weight: NDArray
    shape: NDArray

    @classmethod
    def of(cls, x: NDArray, facets: NDArray, axisymmetric: bool) -> Samples:
        """Of edges or triangles: linear tractions are integrated exactly."""
        corner = x[facets]
        edge = corner[:, 1] - corner[:, 0]
        if x.shape[1] == 2:
            far = 0.5/np.sqrt(3.0)
            shape = np.array([[0.5 + far, 0.5 - far], [0.5 - far, 0.5 + far]])
            wide = np.stack([edge[:, 1], -edge[:, 0]], axis=1)
            size = np.linalg.norm(wide, axis=1)
        else:
            shape = np.full((3, 3), 1.0/6.0) + 0.5*np.eye(3)
            wide = np.cross(edge, corner[:, 2] - corner[:, 0])
            size = 0.5*np.linalg.norm(wide, axis=1)
        place = np.einsum("sk,fkd->fsd", shape, corner)
        weight = np.repeat(size[:, None]/len(shape), len(shape), axis=1)
        if axisymmetric:
            weight = weight*2.0*np.pi*place[..., 0]
        long = np.maximum(np.linalg.norm(wide, axis=1), np.finfo(float).tiny)
        outward = np.broadcast_to((wide/long[:, None])[:, None, :], place.shape)
        return cls(place, outward, weight, shape)

    def forces(self, traction: NDArray) -> NDArray:
        """Forces (facet, sample, ndim) of tractions there; none on faces that these do not press,
        beside the rim of a tool."""
        pressing = (traction*self.outward).sum(axis=2) < -PRESSING*np.linalg.norm(traction, axis=2)
        return traction*(self.weight*pressing)[..., None]


def loads_of(body: Body, mesh: NewMesh, last: Snapshot, held: NDArray, tools: Tools,
             left: float = 0.0) -> NDArray | None:
    """Forces that act on the skin of the new mesh (node, ndim): those of the old one, as tractions
    along it, with their resultants; None where nothing acts. `held`: degrees of freedom of the old
    nodes that supports hold. `left`: share that still acts of what the step has let go of."""
    force = last.forces_on(body)
    inside = np.setdiff1d(np.arange(len(force)), body.facets)
    if np.abs(force[inside]).max(initial=0.0) > AT_REST*np.abs(force).max():
        return None   # the stresses are not all that acts inside
    fades = left*fading(body, mesh, last)
    if fades.any():
        force = force - left*last.fading_on(body)
        force[np.abs(force) < NOTHING*np.abs(fades).max()] = 0.0
    force[held] = 0.0
    found = carried(force, body, mesh, last)
    if found is None:
        return fades if fades.any() else None
    return _on_the_tools(found, body, mesh, tools) + fades


def fading(body: Body, mesh: NewMesh, last: Snapshot) -> NDArray:
    """What the step has let go of and fades over it, as it was where the step began, on the nodes
    of the new mesh (node, ndim)."""
    force = last.fading_on(body)
    if not force.any():
        return np.zeros_like(mesh.x)
    found, size = carried(force, body, mesh, last), float(np.abs(force).sum())
    if found is None or np.abs(found.sum(axis=0) - force.sum(axis=0)).max() > GONE*size or \
            abs(float(np.abs(found).sum()) - size) > ASTRAY*size:
        return _by_nodes(force, last.x, mesh)
    return found


def _by_nodes(force: NDArray, x: NDArray, mesh: NewMesh) -> NDArray:
    """Forces of old nodes at x, by the nodes of the new facets that these are on (node, ndim)."""
    acts = np.flatnonzero(np.abs(force).any(axis=1))
    closest = closest_on_facets if x.shape[1] == 3 else closest_on_edges
    facet, share = closest(x[acts], mesh.x, mesh.facets)
    found = np.zeros_like(mesh.x)
    np.add.at(found, mesh.facets[facet], share[:, :, None]*force[acts][:, None, :])
    return found


def carried(force: NDArray, body: Body, mesh: NewMesh, last: Snapshot) -> NDArray | None:
    """Forces that press the skin (node, ndim) on the new one, as tractions along it with their
    resultants; None where nothing acts."""
    force = force.copy()
    force[np.setdiff1d(np.arange(len(force)), body.facets)] = 0.0
    force[np.abs(force).max(axis=1) < NOTHING*np.abs(force).max()] = 0.0
    old, new = body.facets, mesh.facets   # a tool may press a face that a support holds along it
    if not force.any():
        return None
    before = Samples.of(last.x, old, body.axisymmetric)
    traction = _tractions(force, before, old)
    bore = before.forces(np.einsum("sk,fkd->fsd", before.shape, traction[old]))
    now = Samples.of(mesh.x, new, body.axisymmetric)
    place = now.place.reshape(-1, body.ndim)
    facet, share = _closest(place, now.outward.reshape(place.shape), last.x, old)
    acts = now.forces(np.einsum("nk,nkd->nd", share, traction[old[facet]])
                      .reshape(now.place.shape)).reshape(place.shape)
    piece = _pieces(old, np.abs(force).any(axis=1))
    for k in np.unique(piece[piece >= 0]):
        own = piece[facet] == k
        acts[own] = _with_resultant(acts[own], bore[piece == k].sum(axis=(0, 1)))
    found = np.zeros_like(mesh.x)
    _add(found, new, np.einsum("fsd,sk->fkd", acts.reshape(now.place.shape), now.shape))
    return found


def _tractions(force: NDArray, skin: Samples, facets: NDArray) -> NDArray:
    """Forces of nodes by the areas of the faces around that they press (node, ndim)."""
    area = _pressed_areas(force, skin, facets)
    return force/np.where(area > 0.0, area, np.inf)[:, None]


def _pressed_areas(force: NDArray, skin: Samples, facets: NDArray) -> NDArray:
    """Shares of nodes in the areas of the faces around that their forces press (node,)."""
    area = np.zeros(len(force))
    size = np.linalg.norm(force, axis=1)
    for k in range(facets.shape[1]):
        own = np.einsum("fs,s->f", skin.weight, skin.shape[:, k])
        node = facets[:, k]
        presses = (force[node]*skin.outward[:, 0]).sum(axis=1) < -PRESSING*size[node]
        np.add.at(area, node, own*presses)
    return area


def _pieces(facets: NDArray, acts: NDArray) -> NDArray:
    """Number of the connected piece of the skin with forces that each facet is part of, or -1."""
    sparse = optional("scipy.sparse", "new meshes")
    graph = optional("scipy.sparse.csgraph", "new meshes")
    some = acts[facets].any(axis=1)
    row = np.repeat(np.flatnonzero(some), facets.shape[1])
    node = facets[some].ravel()
    bears = acts[node]
    touch = sparse.csr_matrix((np.ones(int(bears.sum())), (row[bears], node[bears])),
                              (len(facets), len(acts)))
    _, label = graph.connected_components(touch @ touch.T, directed=False)
    return np.where(some, label, -1)


def _on_the_tools(force: NDArray, body: Body, mesh: NewMesh, tools: Tools) -> NDArray:
    """Forces (node, ndim), those of nodes in the air taken by the nearest one that is on a tool.

    Where a surface of the body meets bodies or itself, they stay where they are.
    """
    meets = np.zeros(len(mesh.x), bool)
    on = meets.copy()
    near = TOUCHES*np.ptp(mesh.x, axis=0).max()
    for number, slave in tools.pairs:
        if tools.meets_metal(number):
            continue
        nodes = nodes_within(mesh.facets, mesh.tags, slave)
        feet = tools.closest(number, mesh.x[nodes]) if len(nodes) else None
        if feet is not None:
            meets[nodes] = True
            on[nodes[(np.abs(feet[:, 0]) <= near) & ~(feet[:, 1] > 0.0)]] = True
    for number, slave in tools.pairs:
        if tools.meets_metal(number):
            meets[nodes_within(mesh.facets, mesh.tags, slave)] = False
    air = np.flatnonzero(meets & ~on & np.abs(force).any(axis=1))
    if not on.any() or not len(air):
        return force
    there = np.flatnonzero(on)
    nearest = there[optional("scipy.spatial", "new meshes").cKDTree(mesh.x[there])
                    .query(mesh.x[air])[1]]
    force = force.copy()
    np.add.at(force, nearest, force[air])
    force[air] = 0.0
    return force


def _closest(places: NDArray, outward: NDArray, x: NDArray, facets: NDArray
             ) -> tuple[NDArray, NDArray]:
    """Facet that is closest to each place and looks the same way, and the shares of its corners:
    the two sides of a fold lie on each other."""
    closest = closest_on_facets if x.shape[1] == 3 else closest_on_edges
    normal = Samples.of(x, facets, False).outward[:, 0]
    facet, share = closest(places, x, facets)
    for k in np.flatnonzero((normal[facet]*outward).sum(axis=1) <= 0.0):
        side = np.flatnonzero(normal @ outward[k] > 0.0)
        if len(side):
            near, own = closest(places[k][None], x, facets[side])
            facet[k], share[k] = side[near[0]], own[0]
    return facet, share


def _with_resultant(force: NDArray, wanted: NDArray) -> NDArray:
    """Forces (n, ndim) whose sum is this, by the least change where they act."""
    size = np.linalg.norm(force, axis=1)
    total = size.sum()
    if not total > 0.0:
        return force
    return force + size[..., None]*((wanted - force.sum(axis=0))/total)


def _add(found: NDArray, facets: NDArray, force: NDArray) -> None:
    """Add forces of the corners of facets (facet, corner, ndim) to those of the nodes."""
    for k in range(facets.shape[1]):
        np.add.at(found, facets[:, k], force[:, k])
