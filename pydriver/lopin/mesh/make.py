"""Mesh generators: blocks, crowned blocks, discs, rings, cylinders; linear or quadratic, 2D or 3D.

Every generator names its boundary: TOP is the largest, BOTTOM the smallest last coordinate; LEFT
and RIGHT belong to x; FRONT and BACK to y in 3D; curved faces are ARC, INNER, OUTER. A name is both
a surface and a point set. ALL is the set of all elements.
"""
from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import UsageError
from .cells import CELLS
from .mesh import Mesh

_SIDES = {2: ("LEFT", "RIGHT", "BOTTOM", "TOP"),
          3: ("LEFT", "RIGHT", "FRONT", "BACK", "BOTTOM", "TOP")}


def graded(n: int, ratio: float = 1.0) -> NDArray:
    """n intervals of [0, 1] in geometric progression: last length = ratio times first.

    >>> graded(2, 3.0)
    array([0.  , 0.25, 1.  ])
    """
    steps = np.asarray(ratio, float)**(np.arange(n)/max(n - 1, 1))
    x = np.concatenate([[0.0], np.cumsum(steps)])
    return x/x[-1]


def block(size: Sequence[float], cells: Sequence[int], *, origin: Sequence[float] | None = None,
          grading: Sequence[float | ArrayLike] | None = None, quadratic: bool = False) -> Mesh:
    """A rectangle (two sizes) or a box (three).

    Parameters
    ----------
    size : lengths of the sides [length]
    cells : number of cells along each
    origin : smallest coordinates; 0 by default
    grading : per direction, the ratio of last to first cell, or the n+1 coordinates in [0, 1]

    >>> block((2.0, 1.0), (4, 2))
    Mesh(15 points, 8 quad, surfaces ['BOTTOM', 'LEFT', 'RIGHT', 'TOP'])
    """
    ndim = len(size)
    if ndim not in (2, 3) or len(cells) != ndim:
        raise UsageError(f"a block has 2 or 3 sizes and as many cells, not {size} and {cells}")
    ticks = [graded(n, g) if np.ndim(g) == 0 else np.asarray(g, float)
             for n, g in zip(cells, grading or [1.0]*ndim)]
    mesh = _unit_grid(ticks)
    if quadratic:
        mesh = mesh.quadratic()
    start = np.zeros(ndim) if origin is None else np.asarray(origin, float)
    return mesh.mapped(lambda x: start + x*np.asarray(size, float))


def crowned_block(size: Sequence[float], cells: Sequence[int], radius: float, *,
                  grading=None, quadratic: bool = False) -> Mesh:
    """A block whose bottom bulges to a cylinder (2D) or sphere (3D, and 2D axisymmetric).

    The lowest point is the origin; the bottom follows R - sqrt(R^2 - x^2 - y^2), the top is flat.
    """
    mesh = block(size, cells, grading=grading, quadratic=quadratic)
    height = size[-1]

    def crown(x: NDArray) -> NDArray:
        reach = (x[:, :-1]**2).sum(axis=1)
        if reach.max() >= radius**2:
            far = reach.max()**0.5
            raise UsageError(f"the block reaches {far:g}, beyond the radius {radius:g}")
        x = x.copy()
        x[:, -1] += (radius - np.sqrt(radius**2 - reach))*(1.0 - x[:, -1]/height)
        return x

    return mesh.mapped(crown)


def ring(inner: float, outer: float, cells: Sequence[int], *, angles: Sequence[float] = (0.0, 90.0),
         quadratic: bool = False) -> Mesh:
    """A sector of a ring between two angles in degrees; cells = (radial, around).

    Sides: INNER, OUTER, START, END; a full turn is closed and has neither START nor END.
    """
    mesh = _renamed(_unit_grid([graded(n) for n in cells]), START="BOTTOM", END="TOP",
                    INNER="LEFT", OUTER="RIGHT")
    if quadratic:
        mesh = mesh.quadratic()
    first, last = np.radians(angles)

    def bend(x: NDArray) -> NDArray:
        r, t = inner + (outer - inner)*x[:, 0], first + (last - first)*x[:, 1]
        return np.stack([r*np.cos(t), r*np.sin(t)], axis=1)

    mesh = mesh.mapped(bend)
    return merged(mesh, without=("START", "END")) if abs(last - first) > 6.283 else mesh


def disc(radius: float, cells: int, *, part: str = "full", quadratic: bool = False) -> Mesh:
    """A disc around the origin, or its lower half, or the quarter x >= 0, y <= 0, without a pole.

    `cells`: along the side of the core square of a quarter; a quarter has 3*cells^2 quads.
    Sides: ARC; TOP (y = 0) of half and quarter; LEFT (x = 0) of the quarter.
    """
    quarters = {"quarter": (3,), "half": (2, 3), "full": (0, 1, 2, 3)}
    if part not in quarters:
        raise UsageError(f"part is one of {', '.join(quarters)}, not '{part}'")
    pieces = [_quarter(radius, cells, quadratic).mapped(lambda x, k=k: x @ _turn(k).T)
              for k in quarters[part]]
    mesh = merged(_joined(pieces))
    small = 1e-9*radius

    def flat(x: NDArray) -> NDArray:
        return np.abs(x[:, 1]) < small

    def axis(x: NDArray) -> NDArray:
        return np.abs(x[:, 0]) < small

    if part == "full":
        return mesh.with_surface("ARC", lambda x: np.full(len(x), True))
    if part == "half":
        return mesh.with_surface("ARC", lambda x: ~flat(x)).with_surface("TOP", flat)
    mesh = mesh.with_surface("ARC", lambda x: ~flat(x) & ~axis(x))
    return mesh.with_surface("TOP", flat).with_surface("LEFT", axis)


def extruded(mesh: Mesh, height: float, cells: int, *, grading: float = 1.0) -> Mesh:
    """A linear 2D mesh swept along z: quads become hexahedra, triangles wedges.

    Sides keep their names, but TOP and BOTTOM of the plane become BACK and FRONT; the ends are
    BOTTOM and TOP.
    """
    z, n = height*graded(cells, grading), mesh.n_point
    points = np.vstack([np.column_stack([mesh.points, np.full(n, level)]) for level in z])
    solid = {"quad": "hexahedron", "triangle": "wedge"}
    blocks, order, start = [], np.empty((cells, mesh.n_element), int), 0
    plane_start = 0
    for name, flat in mesh.blocks:
        layers = [np.hstack([flat + k*n, flat + (k + 1)*n]) for k in range(cells)]
        blocks.append((solid[name], np.vstack(layers)))
        for k in range(cells):
            layer = start + k*len(flat) + np.arange(len(flat))
            order[k, plane_start:plane_start + len(flat)] = layer
        start += cells*len(flat)
        plane_start += len(flat)
    rename = {"TOP": "BACK", "BOTTOM": "FRONT"}
    new = Mesh(points, blocks, {}, {"ALL": np.arange(start)}, {})
    for name, rows in mesh.surfaces.items():
        swept = [(order[k, e], f + 2) for k in range(cells) for e, f in rows]
        new = _with_rows(new, rename.get(name, name), np.array(swept))
    new = _with_rows(new, "BOTTOM", np.column_stack([order[0], np.full(mesh.n_element, 1)]))
    return _with_rows(new, "TOP", np.column_stack([order[-1], np.full(mesh.n_element, 2)]))


def cylinder(radius: float, height: float, cells: Sequence[int], *, part: str = "full") -> Mesh:
    """A cylinder along z from z = 0; cells = (core side of a quarter, along z).

    Sides as `disc`, extruded.
    """
    return extruded(disc(radius, cells[0], part=part), height, cells[1])


def simplices(mesh: Mesh) -> Mesh:
    """Linear quads cut into 2 triangles, hexahedra into 6 tetrahedra; sides keep their names."""
    cuts = {"quad": ("triangle", [(0, 1, 2), (0, 2, 3)]),
            "hexahedron": ("tetra", [(0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6),
                                     (0, 4, 5, 6), (0, 5, 1, 6)])}
    blocks = [(cuts[name][0], cells[:, cuts[name][1]].reshape(-1, len(cuts[name][1][0])))
              for name, cells in mesh.blocks]
    n = {name: len(cuts[name][1]) for name, _ in mesh.blocks}
    parent = np.repeat(np.arange(mesh.n_element), np.concatenate(
        [np.full(len(c), n[name]) for name, c in mesh.blocks]))
    new = Mesh(mesh.points, blocks, mesh.point_sets,
               {k: np.flatnonzero(np.isin(parent, v)) for k, v in mesh.element_sets.items()}, {})
    boundary = [(e, f, set(new.face_nodes(e, f))) for e, f in new.boundary()]
    surfaces = {}
    for name, rows in mesh.surfaces.items():
        old: dict[int, list[set]] = {}
        for e, f in rows:
            old.setdefault(e, []).append(set(mesh.face_nodes(e, f)))
        surfaces[name] = np.array([(e, f) for e, f, nodes in boundary
                                   if any(nodes <= o for o in old.get(parent[e], ()))])
    return new.replaced(surfaces=surfaces)


def merged(mesh: Mesh, *, tolerance: float = 1e-9, without: Sequence[str] = ()) -> Mesh:
    """Make points one that lie within `tolerance` times the size of the mesh; drop some sets."""
    size = np.ptp(mesh.points, axis=0).max()
    # The shift keeps coordinates at simple fractions of the size away from where rounding changes.
    keys = np.round((mesh.points - mesh.points.min(axis=0))/(size*tolerance) + 0.3)
    _, first, inverse = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    inverse = inverse.ravel()
    return Mesh(mesh.points[first], [(n, inverse[c]) for n, c in mesh.blocks],
                {k: np.unique(inverse[v]) for k, v in mesh.point_sets.items() if k not in without},
                mesh.element_sets,
                {k: v for k, v in mesh.surfaces.items() if k not in without})


def _unit_grid(ticks: list[NDArray]) -> Mesh:
    """Linear grid on the unit square or cube, with its sides."""
    ndim, shape = len(ticks), [len(t) for t in ticks]
    points = np.stack([g.ravel(order="F") for g in np.meshgrid(*ticks, indexing="ij")], axis=1)
    number = np.arange(len(points)).reshape(shape, order="F")
    name = "quad" if ndim == 2 else "hexahedron"
    corners = ((CELLS[name].xi + 1.0)/2.0).astype(int)
    cells = np.stack([number[tuple(slice(o, o + m - 1) for o, m in zip(c, shape))].ravel(order="F")
                      for c in corners], axis=1)
    mesh = Mesh(points, [(name, cells)], {}, {"ALL": np.arange(len(cells))}, {})
    faces = {2: (4, 2, 1, 3), 3: (6, 4, 3, 5, 1, 2)}[ndim]
    element = np.arange(len(cells)).reshape([m - 1 for m in shape], order="F")
    for k, (side, face) in enumerate(zip(_SIDES[ndim], faces)):
        rows = np.take(element, 0 if k % 2 == 0 else -1, axis=k//2).ravel(order="F")
        mesh = _with_rows(mesh, side, np.column_stack([rows, np.full(len(rows), face)]))
    return mesh


def _with_rows(mesh: Mesh, name: str, rows: NDArray) -> Mesh:
    new = mesh.replaced(surfaces=mesh.surfaces | {name: rows})
    return new.replaced(point_sets=new.point_sets | {name: new.surface_points(name)})


def _renamed(mesh: Mesh, **new_from_old: str) -> Mesh:
    return mesh.replaced(
        surfaces={new: mesh.surfaces[old] for new, old in new_from_old.items()},
        point_sets={new: mesh.point_sets[old] for new, old in new_from_old.items()})


def _turn(quarters: int) -> NDArray:
    return np.linalg.matrix_power(np.array([[0.0, -1.0], [1.0, 0.0]]), quarters)


def _joined(pieces: list[Mesh]) -> Mesh:
    shift = np.cumsum([0, *(p.n_point for p in pieces)])
    cells = np.vstack([c + s for p, s in zip(pieces, shift) for _, c in p.blocks])
    return Mesh(np.vstack([p.points for p in pieces]), [(pieces[0].blocks[0][0], cells)], {},
                {"ALL": np.arange(len(cells))}, {})


def _quarter(radius: float, n: int, quadratic: bool) -> Mesh:
    """The quarter x, y >= 0 of a disc: a core with bulged corner and two patches up to the arc."""
    side, corner = 0.5*radius, 0.43*radius
    grid = _unit_grid([graded(n), graded(n)])
    if quadratic:
        grid = grid.quadratic()

    def edge(t: NDArray) -> NDArray:
        """The core's right edge, from (side, 0) to the corner."""
        return np.stack([side + (corner - side)*t, corner*t], axis=1)

    def core(x: NDArray) -> NDArray:
        s, t = x.T
        mixed = s*t
        return np.stack([side*s + (corner - side)*mixed, side*t + (corner - side)*mixed], axis=1)

    def outer(x: NDArray) -> NDArray:
        s, t = x.T
        arc = radius*np.stack([np.cos(0.25*np.pi*t), np.sin(0.25*np.pi*t)], axis=1)
        return edge(t)*(1.0 - s[:, None]) + arc*s[:, None]

    return _joined([grid.mapped(core), grid.mapped(outer),
                    grid.mapped(lambda x: outer(x[:, ::-1])[:, ::-1])])
