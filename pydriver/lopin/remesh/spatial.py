"""A new mesh of tetrahedra of a body in its present shape."""
from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .body import Body, boundary_facets, refuse_no_mesh, refused
from .card import RemeshCard
from .part import NewMesh, SkinOrigin
from .plane import corner_quality
from .seat import keep_volume, seat
from .sizes import Sizes, of_curvature, of_fracture, of_gradient
from .space import closest_on_facets, narrowest_slot, remesh_tetrahedra, volume_inside
from .state import Snapshot
from .tools import Tools
from .transfer import PLASTIC, CellFields


#: Share of the quality of its corners that a cell keeps as its nodes are put on the tools, and the
#: quality from which on it may lose more.
KEPT, ENOUGH = 0.3, 0.2
#: Around cells of worse corners pressed and free faces have one reference.
SPOILT = 0.1
#: How often nodes of a cell that would lose more go back by half of their way; then all of it.
HALVINGS = 4


def remesh_space(body: Body, state: Snapshot, card: RemeshCard, tools: Tools,
                 fields: CellFields) -> tuple[NewMesh, dict[str, float], SkinOrigin]:
    """A new mesh, what it changed (volumes, largest moves), where its skin lies on the old one."""
    sizes = _sizes(body, state, card, tools, fields)
    pressed = tools.pressed(body, state)
    marks, reference = references(body, state.x, pressed)
    x, cells, told, of = remesh_tetrahedra(state.x, body.cells[0], body.facets, reference,
                                       sizes(state.x), (card.smallest, card.size, card.hausdorff),
                                       card.growth)
    refuse_no_mesh(x, [cells])
    used = np.unique(cells)
    x, cells = x[used], np.searchsorted(used, cells)
    facets, _ = boundary_facets([cells], 3)
    number = references_of_facets(facets, np.searchsorted(used, told), of)
    lost = np.flatnonzero(number < 0)
    if len(lost):
        facet, _ = closest_on_facets(x[facets[lost]].mean(axis=1), state.x, body.facets)
        number[lost] = reference[facet]
    tags = [marks[k][0] for k in number]
    skin = np.unique(facets)
    near, share = closest_on_facets(x[skin], state.x, body.facets)
    origin = SkinOrigin(skin, body.facets[near], share)
    press = np.zeros(len(x), bool)
    press[facets[[marks[k][1] for k in number]].ravel()] = True
    x, moved = _seat(body, state, NewMesh(x, [cells], facets, tags), press, sizes, tools)
    slot, place = narrowest_slot(x, facets, card.smallest)
    if np.isfinite(slot):
        moved |= {"slot": slot, "slot_at": [float(v) for v in place]}
    mesh = NewMesh(x, [cells], facets, tags)
    mesh.named = {name: np.arange(len(x)) if len(rows) == len(state.x) else
                  np.unique([int(np.argmin(np.linalg.norm(x - state.x[r], axis=1))) for r in rows])
                  for name, rows in body.named.items()}
    return mesh, moved, origin


def references_of_facets(facets: NDArray, told: NDArray, of: NDArray) -> NDArray:
    """The references of facets that the mesher tells with its triangles; -1 for others.

    The closest old facet would do but where two meet at a sharp edge: a node that is taken for one
    of a plane of symmetry is drawn onto it, and its cells turn over.
    """
    known = {tuple(row): int(k) for row, k in zip(np.sort(told, axis=1).tolist(), of.tolist())}
    return np.array([known.get(tuple(row), -1) for row in np.sort(facets, axis=1).tolist()])


def _sizes(body: Body, state: Snapshot, card: RemeshCard, tools: Tools, fields: CellFields
           ) -> Sizes:
    """What tools, thickness and strain ask for."""
    asked = [of_gradient(fields.centre, np.linalg.norm(fields.slope[:, :, PLASTIC], axis=1)),
             thickness(state.x, body.facets)]
    asked += [of_curvature(*arcs) for arcs in tools.arcs(state.x, body.facets, body.tags,
                                                         2.0*card.size)]
    asked += of_fracture(state.points.place[:, :3], state.points.damage_mean, card.cuts)
    return Sizes.of(card.size, card.smallest, card.growth, asked, 3)


def thickness(x: NDArray, facets: NDArray) -> tuple[NDArray, NDArray]:
    """Two cells across the body: straight inward from the middle of each facet to the next one."""
    from ..errors import optional

    tree = optional("scipy.spatial", "new meshes").cKDTree
    corner = x[facets]
    middle = corner.mean(axis=1)
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1), np.finfo(float).tiny)[:, None]
    length = np.linalg.norm(corner - np.roll(corner, 1, axis=1), axis=2).max(axis=1)
    # Opposite facets nearby that look the other way: farther ones ask for nothing small.
    far, near = tree(middle).query(middle, min(24, len(middle)))
    arm = middle[near] - middle[:, None, :]
    depth = -(arm*normal[:, None, :]).sum(axis=2)
    side = np.sqrt(np.maximum(far**2 - depth**2, 0.0))
    faces = (normal[near]*normal[:, None, :]).sum(axis=2) < -0.5
    meets = faces & (depth > 1e-9*length[:, None]) & (side < 0.7*length[near])
    across = np.where(meets, depth, np.inf).min(axis=1)
    found = np.isfinite(across)
    return middle[found], 0.5*across[found]


def references(body: Body, x: NDArray, pressed: NDArray) -> tuple[list, NDArray]:
    """Names and whether a tool presses, for each reference; the reference of each facet.

    Pressed faces have references of their own: without one they would bulge. Not so around a spoilt
    cell: where a lip folds in behind the rim of contact, of a fraction of a cell, the line of the
    rim would keep it in each new mesh.
    """
    cells = body.cells[0]
    spoilt = np.unique(cells[corner_quality(x, cells) < SPOILT])
    pushed = pressed[body.facets].all(axis=1) & ~np.isin(body.facets, spoilt).any(axis=1)
    marks, number = [], {}
    reference = np.zeros(len(body.facets), int)
    for k, (tag, push) in enumerate(zip(body.tags, pushed.tolist())):
        key = (tag, push)
        if key not in number:
            number[key] = len(marks)
            marks.append(key)
        reference[k] = number[key]
    return marks, reference


def _seat(body: Body, state: Snapshot, mesh: NewMesh, press: NDArray, sizes: Sizes, tools: Tools
          ) -> tuple[NDArray, dict[str, float]]:
    """Planes exact, pressed nodes on the tools, the volume that it was."""
    x = mesh.x.copy()
    normals = held_planes(body, state.x, mesh, x)
    met = list(tools.feet_of_nodes(body, x, mesh.facets, mesh.tags))
    done = seat(x, press, sizes(x), met, normals)
    free = np.zeros(len(x), bool)
    free[mesh.facets] = True
    free &= ~done.seated & np.array([len(n) == 0 for n in normals])
    before = volume_inside(state.x, body.facets)
    moved, way, back = upright_moves(x, done.x, mesh, free, before)
    return moved, {"volume": before,
                   "volume_change": volume_inside(moved, mesh.facets)/before - 1.0,
                   "seated": done.farthest, "offset": abs(way),
                   "nodes_seated": int(done.seated.sum()), "nodes_put_back": back}


def upright_moves(x: NDArray, seated: NDArray, mesh: NewMesh, free: NDArray, volume: float
                  ) -> tuple[NDArray, float, int]:
    """Nodes on the tools and the volume restored, where no cell turns over or is spoilt.

    A cell that would lose more than it may has its nodes go back by halves, to where the mesher
    had them at last; what they are inside a tool then, contact gives way in the increment at rest.
    Returns the places, how far the free skin went [length], and how many nodes went back.
    """
    cells = mesh.cells[0]
    least = KEPT*np.minimum(corner_quality(x, cells), ENOUGH)
    share, free = np.ones(len(x)), free.copy()
    for k in range(2*HALVINGS + 1):
        start = x + share[:, None]*(seated - x)
        moved, way = keep_volume(start, free, node_normals(start, mesh.facets), volume,
                                 lambda p: volume_inside(p, mesh.facets))
        spoilt = corner_quality(moved, cells) < least
        if not spoilt.any():
            break
        nodes = np.unique(cells[spoilt])
        share[nodes] *= 0.5 if k < HALVINGS else 0.0
        free[nodes] &= k < HALVINGS
    if (corner_quality(moved, cells) <= 0.0).any():
        place = moved[cells[np.argmin(corner_quality(moved, cells))]].mean(axis=0)
        raise refused("a new tetrahedron is turned over at ({})".format(
            ", ".join(f"{v:.4g}" for v in place)), "a smaller SMALLEST, where metal is thin")
    return moved, way, int((share < 1.0).sum())


def held_planes(body: Body, old: NDArray, mesh: NewMesh, x: NDArray) -> list[NDArray]:
    """Normals of the planes that supports hold, of each node; nodes are put on them exactly."""
    found: list[list[NDArray]] = [[] for _ in x]
    planes: dict[frozenset, list] = {}
    for tag, facet in zip(body.tags, body.facets):
        if tag & body.held:
            planes.setdefault(tag & body.held, []).append(facet)
    for tag, own in planes.items():
        corner = old[np.array(own)]
        normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
        unit = normal/np.linalg.norm(normal, axis=1)[:, None]
        flat = (unit @ unit[0] > 1.0 - 1e-9).all()
        nodes = np.unique([f for f, t in zip(mesh.facets, mesh.tags) if t & body.held == tag])
        if not flat or len(nodes) == 0:
            continue
        mean = normal.sum(axis=0)
        mean /= np.linalg.norm(mean)
        axis = int(np.argmax(np.abs(mean)))
        if abs(mean[axis]) > 1.0 - 1e-12:
            x[nodes, axis] = old[np.unique(np.array(own)), axis].mean() \
                if np.ptp(old[np.unique(np.array(own)), axis]) > 0.0 else old[own[0][0], axis]
            mean = np.eye(3)[axis]
        else:
            level = (corner.reshape(-1, 3) @ mean).mean()
            x[nodes] -= ((x[nodes] @ mean) - level)[:, None]*mean
        for node in nodes:
            found[node].append(mean)
    return [np.array(n).reshape(-1, 3) for n in found]


def node_normals(x: NDArray, facets: NDArray) -> NDArray:
    """Outward normals of the nodes of a skin, weighted by the areas around."""
    corner = x[facets]
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    total = np.zeros_like(x)
    for k in range(3):
        np.add.at(total, facets[:, k], normal)
    long = np.linalg.norm(total, axis=1)
    return total/np.maximum(long, np.finfo(float).tiny)[:, None]
