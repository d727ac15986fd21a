"""A new mesh of a plane or axisymmetric body in its present shape."""
from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .body import Body, boundary_facets, refuse_no_mesh, refused
from .card import RemeshCard
from .fold import close_fold, deepest_inside, drawn_apart
from .outline import Outline, loops_of, new_outline, volume_of
from .part import NewMesh, SkinOrigin
from .plane import crossings, fill, place_of_worst, worst_corner
from .seat import keep_volume, seat
from .sizes import Sizes, of_curvature, of_fracture, of_gradient, of_thickness
from .state import Snapshot
from .tools import Tools
from .transfer import CellFields, PLASTIC


#: A mesh whose worst corner is better is taken; else others are tried, of sizes times these.
WELL, FACTORS = 0.3, (1.0, 0.93, 1.06, 0.87, 0.8)
#: An outline that crosses itself is drawn again nearer to the old one by this.
CLOSER = 0.3


def remesh_plane(body: Body, state: Snapshot, card: RemeshCard, tools: Tools,
                 fields: CellFields) -> tuple[NewMesh, dict[str, float], SkinOrigin]:
    """A new mesh, what it changed (volumes, largest moves), where its skin lies on the old one."""
    sizes = sizes_of(body, state, card, tools, fields)
    required = set(np.concatenate([rows for rows in body.named.values()
                                   if len(rows) < len(body.x)] or [[]]).astype(int).tolist())
    quads, best, near = body.cells[0].shape[1] == 4, None, card.hausdorff
    for factor in FACTORS:
        finer = sizes.scaled(factor)
        outline = new_outline(state.x, body.facets, body.tags,
                              required & set(body.facets.ravel()), finer, near, quads)
        moved = seat_outline(body, state, outline, finer, tools)
        ends, _ = edges_of(outline)
        apart = outline_apart(body, outline, finer, tools)
        cross = outline.x[ends[crossings(apart, ends)[:1, 0]]].mean(axis=1)
        if len(cross):   # closer to the old outline, whose narrow slots it has to follow
            near *= CLOSER
            continue
        x, cells = fill(outline, finer.with_edges(outline.x, ends), quads, apart)
        refuse_no_mesh(x, cells)
        worst = worst_corner(x, cells) - (len(cells) > 1)
        if best is None or worst > best[0]:
            best = worst, outline, moved, x, cells
        if worst > WELL:
            break
    if best is None:
        raise refused("the outline of the body crosses itself near ({:.4g}, {:.4g})".format(
            *cross[0]), "two sides of a fold or of a cut have met there: a *CONTACT PAIR of the "
            "surface with itself for a fold, or cells of a smaller size")
    _, outline, moved, x, cells = best
    if worst_corner(x, cells) <= 0.0:
        raise refused("a new cell is turned over at ({})".format(", ".join(
            f"{v:.4g}" for v in place_of_worst(x, cells))), "another SIZE, or a smaller SMALLEST")
    facets, _ = boundary_facets(cells, 2)
    if len(facets) != len(outline.tags):
        raise refused("the mesher leaves a hole", "another SIZE, or a smaller SMALLEST")
    tags = [outline.tags[a] for a in facets[:, 0]]
    mesh = NewMesh(x, cells, facets, tags)
    mesh.named = named_nodes(body, state.x, outline, x)
    weight = np.stack([1.0 - outline.share, outline.share], axis=1)
    return mesh, moved, SkinOrigin(np.arange(len(outline.x)), outline.ends, weight)


def sizes_of(body: Body, state: Snapshot, card: RemeshCard, tools: Tools,
             fields: CellFields) -> Sizes:
    """What shape, tools and strain ask for."""
    x, facets = state.x, body.facets
    edge = x[facets[:, 1]] - x[facets[:, 0]]
    length = np.linalg.norm(edge, axis=1)
    normals = np.stack([edge[:, 1], -edge[:, 0]], axis=1)/length[:, None]
    asked = [of_thickness(x, facets, normals),
             of_gradient(fields.centre, np.linalg.norm(fields.slope[:, :, PLASTIC], axis=1))]
    asked += [of_curvature(*arcs) for arcs in tools.arcs(x, facets, body.tags,
                                                         2.0*card.size)]
    asked += of_fracture(state.points.place[:, :2], state.points.damage_mean, card.cuts)
    return Sizes.of(card.size, card.smallest, card.growth, asked, 2)


def seat_outline(body: Body, state: Snapshot, outline: Outline, sizes: Sizes,
                 tools: Tools) -> dict[str, float]:
    """Put the outline on the tools, then give it the volume it had."""
    axisymmetric = body.axisymmetric
    rows = _in_order(body)
    before = volume_of(state.x, [body.facets[r, 0] for r in rows], axisymmetric)
    load = tools.pressed(body, state)
    pressed = load[outline.ends].all(axis=1)
    planes = _planes(outline, body.held)
    edges, tags = edges_of(outline)
    met = list(tools.feet_of_nodes(body, outline.x, edges, tags))
    done = seat(outline.x, pressed, sizes(outline.x), met, planes)
    free = ~done.seated & np.array([len(p) == 0 for p in planes])
    met = 0
    for number, tag in tools.folds:
        bore = tools.pressed_on_itself(number, body, state)[outline.ends].all(axis=1)
        fold = close_fold(done.x, folding(outline, tag), bore, sizes(done.x), planes)
        done.x, met = fold.x, met + int(fold.met.sum())
        free &= ~fold.met
    x, way = keep_volume(done.x, free, _normals(done.x, outline), before,
                         lambda p: volume_of(p, outline.loops, axisymmetric))
    after = volume_of(x, outline.loops, axisymmetric)
    outline.x = x
    told = {"volume": before, "volume_change": after/before - 1.0, "seated": done.farthest,
            "offset": abs(way), "nodes_seated": int(done.seated.sum())}
    if met:
        told |= {"folded": met, "fold_depth": max(
            deepest_inside(x, folding(outline, tag), sizes(x)) for _, tag in tools.folds)}
    return told


def folding(outline: Outline, tag: frozenset) -> NDArray:
    """Ends of the edges of a surface that meets itself."""
    edges, tags = edges_of(outline)
    return edges[[bool(t & tag) for t in tags]]


def outline_apart(body: Body, outline: Outline, sizes: Sizes, tools: Tools) -> NDArray:
    """Places of an outline for a mesher: the sides of a closed fold drawn apart."""
    x = outline.x
    for _, tag in tools.folds:
        x = drawn_apart(x, folding(outline, tag), _normals(x, outline), sizes(x),
                        _planes(outline, body.held))
    return x


def edges_of(outline: Outline) -> tuple[NDArray, list[frozenset]]:
    """Ends and names of all edges of an outline."""
    edges = np.concatenate([np.stack([r, np.roll(r, -1)], axis=1) for r in outline.loops])
    return edges, [outline.tags[a] for a in edges[:, 0]]


def _in_order(body: Body) -> list[NDArray]:
    return loops_of(body.facets)


def _planes(outline: Outline, held: frozenset) -> list[NDArray]:
    """Normals of the straight lines that each node stays on: those of facets that supports hold."""
    found: list[list[NDArray]] = [[] for _ in outline.x]
    for loop in outline.loops:
        after = np.roll(loop, -1)
        for a, b in zip(loop, after):
            if outline.tags[a] & held:
                edge = outline.x[b] - outline.x[a]
                normal = np.array([edge[1], -edge[0]])/np.linalg.norm(edge)
                for node in (a, b):
                    if all(abs(normal @ n) < 1.0 - 1e-9 for n in found[node]):
                        found[node].append(normal)
    return [np.array(p).reshape(-1, 2) for p in found]


def _normals(x: NDArray, outline: Outline) -> NDArray:
    """Outward normals of nodes: means of those of the edges that meet there."""
    normals = np.zeros_like(x)
    for loop in outline.loops:
        edge = x[np.roll(loop, -1)] - x[loop]
        own = np.stack([edge[:, 1], -edge[:, 0]], axis=1)
        own /= np.linalg.norm(own, axis=1)[:, None]
        normals[loop] += own + np.roll(own, 1, axis=0)
    long = np.linalg.norm(normals, axis=1)
    return normals/np.maximum(long, np.finfo(float).tiny)[:, None]


def named_nodes(body: Body, old: NDArray, outline: Outline, x: NDArray) -> dict[str, NDArray]:
    """Nodes of the sets that facets do not account for: those that stayed, else the nearest."""
    at = {int(k): row for row, k in enumerate(outline.kept) if k >= 0}
    named = {}
    for name, rows in body.named.items():
        if len(rows) == len(old):
            named[name] = np.arange(len(x))
            continue
        named[name] = np.unique([at[int(r)] if int(r) in at else
                                 int(np.argmin(np.linalg.norm(x - old[r], axis=1)))
                                 for r in rows])
    return named
