"""Meshes of plane outlines, by gmsh: triangles, or quads with few triangles left."""
from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..errors import LopinError, ResourceError, optional
from .body import refused
from .outline import Outline
from .sizes import Sizes, on_grid

#: gmsh's numbers: frontal Delaunay for both; blossom joins triangles to quads.
_FRONTAL, _BLOSSOM, _QUAD, _TRIANGLE = 6, 1, 3, 2
#: Cells whose worst corner is better are left as they are.
GOOD = 0.5


def fill(outline: Outline, size: Sizes, quads: bool, apart: NDArray | None = None
         ) -> tuple[NDArray, list[NDArray]]:
    """Nodes, those of the outline first, and cells counter-clockwise: quads, triangles.

    gmsh reads places and sizes in smallest cells, without their last bits. `apart`: where it is to
    see the outline, if not where it is.
    """
    cell = size.least
    at = on_grid((outline.x if apart is None else apart)/cell)
    gmsh = load_gmsh()
    started = not gmsh.isInitialized()
    if started:
        gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("General.NumThreads", 1)
        gmsh.option.setNumber("Mesh.Algorithm", _FRONTAL)
        gmsh.option.setNumber("Mesh.RecombinationAlgorithm", _BLOSSOM)
        gmsh.option.setNumber("Mesh.MeshSizeExtendFromBoundary", 0)
        gmsh.model.add("body")
        _draw(gmsh, outline, at, quads)
        gmsh.model.mesh.setSizeCallback(
            lambda dim, tag, x, y, z, lc: float(on_grid(size(cell*np.array([[x, y]]))[0]/cell)))
        gmsh.model.mesh.generate(2)
        x, cells = _read(gmsh, len(outline.x))
        gmsh.model.mesh.removeSizeCallback()
        gmsh.model.remove()
    except LopinError:
        raise
    except Exception as problem:   # gmsh knows no other
        raise refused(f"gmsh cannot mesh the body: {problem}",
                      "see that its outline does not meet itself; another SIZE") from problem
    finally:
        if started:
            gmsh.finalize()
    if not cells:
        raise refused("gmsh made no mesh inside the outline of the body")
    x[:len(at)] = at
    x = cell*improved(x, cells, len(at))
    x[:len(at)] = outline.x
    return x, cells


def load_gmsh():
    """gmsh, or what is missing for it."""
    try:
        return optional("gmsh", "new meshes", "remesh", "E0620")
    except OSError as problem:   # a library of the system
        raise ResourceError(f"gmsh cannot be loaded: {problem}",
                            help="on Debian: apt-get install libglu1-mesa libxft2 libxcursor1 "
                            "libxinerama1") from problem


def _draw(gmsh, outline: Outline, at: NDArray, quads: bool) -> None:
    """The outline, its nodes at places (n, 2), as lines of one edge each."""
    geo = gmsh.model.geo
    points = [geo.addPoint(*p, 0.0) for p in at.tolist()]
    curves = []
    for loop in outline.loops:
        lines = [geo.addLine(points[a], points[b]) for a, b in zip(loop, np.roll(loop, -1))]
        curves.append((lines, geo.addCurveLoop(lines)))
    surfaces = [geo.addPlaneSurface([curves[k][1] for k in own]) for own in pieces_of(outline)]
    geo.synchronize()
    for lines, _ in curves:
        for line in lines:
            gmsh.model.mesh.setTransfiniteCurve(line, 2)
    if quads:
        for surface in surfaces:
            gmsh.model.mesh.setRecombine(2, surface)


def pieces_of(outline: Outline) -> list[list[int]]:
    """Loops of each piece: the one around it, then those of its holes."""
    def twice_area(loop):
        p, q = outline.x[loop], outline.x[np.roll(loop, -1)]
        return float((p[:, 0]*q[:, 1] - q[:, 0]*p[:, 1]).sum())

    area = [twice_area(loop) for loop in outline.loops]
    outer = sorted((k for k in range(len(area)) if area[k] > 0.0), key=lambda k: area[k])
    found = {k: [k] for k in outer}
    for k in range(len(area)):
        if area[k] > 0.0:
            continue
        at = outline.x[outline.loops[k][0]]
        # The smallest loop around it.
        around = next((m for m in outer if encloses(outline.x[outline.loops[m]], at)), outer[-1])
        found[around].append(k)
    return [found[k] for k in reversed(outer)]


def encloses(polygon: NDArray, at: NDArray) -> bool:
    """Whether a point is inside a closed polygon (n, 2).

    >>> encloses(np.array([[0., 0.], [1., 0.], [1., 1.], [0., 1.]]), np.array([.5, .5]))
    True
    """
    a, b = polygon - at, np.roll(polygon, -1, axis=0) - at
    across = (a[:, 1] > 0.0) != (b[:, 1] > 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        x = a[:, 0] - a[:, 1]*(b[:, 0] - a[:, 0])/(b[:, 1] - a[:, 1])
    return bool((across & (x > 0.0)).sum() % 2)


def crossings(x: NDArray, ends: NDArray) -> NDArray:
    """Pairs of edges that cross (pair, 2). `ends`: rows of the nodes of each edge (edge, 2)."""
    a, b = x[ends[:, 0]], x[ends[:, 1]]
    found = []
    low, high = np.minimum(a, b), np.maximum(a, b)

    def side(p, q, r):
        return (q[..., 0] - p[..., 0])*(r[..., 1] - p[..., 1]) \
            - (q[..., 1] - p[..., 1])*(r[..., 0] - p[..., 0])

    for k in range(len(ends) - 1):
        near = np.flatnonzero((low[k + 1:] <= high[k]).all(axis=1)
                              & (high[k + 1:] >= low[k]).all(axis=1)) + k + 1
        near = near[~np.isin(ends[near], ends[k]).any(axis=1)]
        cross = (side(a[k], b[k], a[near])*side(a[k], b[k], b[near]) < 0.0) \
            & (side(a[near], b[near], a[k])*side(a[near], b[near], b[k]) < 0.0)
        found += [(k, int(m)) for m in near[cross]]
    return np.array(found, int).reshape(-1, 2)


def _read(gmsh, n_outline: int) -> tuple[NDArray, list[NDArray]]:
    """Nodes in the order of gmsh's tags (those of points come first), cells turned upright."""
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    order = np.argsort(tags)
    x = coordinates.reshape(-1, 3)[order, :2].copy()
    number = {int(t): k for k, t in enumerate(tags[order])}
    kinds, _, nodes = gmsh.model.mesh.getElements(2)
    cells = []
    for kind, corners in ((_QUAD, 4), (_TRIANGLE, 3)):
        for found, rows in zip(kinds, nodes):
            if found == kind and len(rows):
                cells.append(upright(x, np.array([number[int(t)] for t in rows])
                                     .reshape(-1, corners)))
    return x, cells


def upright(x: NDArray, cells: NDArray) -> NDArray:
    """Cells turned counter-clockwise where they are not."""
    p = x[cells]
    q = np.roll(p, -1, axis=1)
    area = (p[..., 0]*q[..., 1] - q[..., 0]*p[..., 1]).sum(axis=1)
    return np.where((area < 0.0)[:, None], cells[:, ::-1], cells)


def improved(x: NDArray, cells: list[NDArray], fixed: int) -> NDArray:
    """Inner nodes of bad cells moved where that makes the worst corner around them better.

    `fixed`: the first nodes, which stay.
    """
    x = x.copy()
    around: dict[int, list[tuple[int, int]]] = {}
    for g, group in enumerate(cells):
        for e, nodes in enumerate(group.tolist()):
            for n in nodes:
                around.setdefault(n, []).append((g, e))

    def worst_at(node):
        own = [cells[g][e] for g, e in around[node]]
        return min(float(corner_quality(x, np.array([c])).min()) for c in own)

    turns = np.arange(8)*(0.25*np.pi)
    directions = np.stack([np.cos(turns), np.sin(turns)], axis=1)
    for share in (0.3, 0.15, 0.3, 0.15, 0.07):
        bad = {int(n) for group in cells
               for n in group[corner_quality(x, group) < GOOD].ravel() if n >= fixed}
        for node in sorted(bad):
            edges = np.concatenate([x[cells[g][e]] - x[node] for g, e in around[node]])
            step = share*np.linalg.norm(edges, axis=1).max()
            best, place = worst_at(node), x[node].copy()
            for way in directions:
                old = x[node].copy()
                x[node] = old + step*way
                found = worst_at(node)
                if found > best:
                    best, place = found, x[node].copy()
                x[node] = old
            x[node] = place
    return x


def worst_corner(x: NDArray, cells: list[NDArray]) -> float:
    """Least scaled Jacobian of all corners: 1 for right angles, or equal sides of simplices."""
    worst = 1.0
    for group in cells:
        worst = min(worst, float(corner_quality(x, group).min()))
    return worst


def place_of_worst(x: NDArray, cells: list[NDArray]) -> NDArray:
    """Centre of the cell with the worst corner (ndim,)."""
    group = min(cells, key=lambda g: float(corner_quality(x, g).min()))
    return x[group[np.argmin(corner_quality(x, group))]].mean(axis=0)


def corner_quality(x: NDArray, cells: NDArray) -> NDArray:
    """Least scaled Jacobian of the corners of each cell (cell,)."""
    p = x[cells]
    if x.shape[1] == 3:
        return _tetra_quality(p)
    after, before = np.roll(p, -1, axis=1) - p, np.roll(p, 1, axis=1) - p
    sine = after[..., 0]*before[..., 1] - after[..., 1]*before[..., 0]
    lengths = np.linalg.norm(after, axis=2)*np.linalg.norm(before, axis=2)
    full = 1.0 if cells.shape[1] == 4 else np.sin(np.pi/3.0)
    return (sine/np.maximum(lengths, np.finfo(float).tiny)).min(axis=1)/full


def _tetra_quality(p: NDArray) -> NDArray:
    """Of tetrahedra: least over corners of the volume over the lengths of its three edges."""
    worst = np.full(len(p), np.inf)
    for corner, (a, b, c) in enumerate(((1, 2, 3), (0, 3, 2), (0, 1, 3), (0, 2, 1))):
        e = p[:, [a, b, c]] - p[:, [corner]]
        lengths = np.linalg.norm(e, axis=2).prod(axis=1)
        worst = np.minimum(worst, np.linalg.det(e)/np.maximum(lengths, np.finfo(float).tiny))
    return worst*np.sqrt(2.0)
