"""Meshes from other tools, through meshio: gmsh's .msh, VTU, or a `meshio.Mesh` at hand.

Cells of the highest dimension become elements; cells one dimension lower become surfaces of their
groups, never elements. A physical group gives a set of its own name. meshio's Abaqus reader is not
used: decks are read by Lopin's own parser.
"""
from __future__ import annotations

import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..errors import ModelError, ResourceError, UsageError
from .cells import CELLS
from .mesh import Mesh
from .shapes import smallest_jacobian
from .with_wedges import meshio_module

#: Full Lagrange cells lose their inner nodes.
_SERENDIPITY = {"quad9": ("quad8", 8), "hexahedron27": ("hexahedron20", 20),
                "wedge18": ("wedge15", 15)}
_NDIM = {"vertex": 0} | {name: cell.ndim for name, cell in CELLS.items()}


#: Files of geometry, which Gmsh meshes.
_GEOMETRY = (".geo", ".step", ".stp", ".iges", ".igs", ".brep")


def read_mesh(path: str | Path) -> Mesh:
    """Read a mesh file by meshio.

    Raises
    ------
    ResourceError : the file does not exist or cannot be read.
    UsageError : the file is a deck.
    """
    path = Path(path)
    if path.suffix.lower() == ".inp":
        raise UsageError(f"{path} is a deck: give it to lopin.run or lopin.Deck.read",
                         help="meshio's Abaqus reader loses sets and element types")
    if not path.is_file():
        raise ResourceError(f"no file {path}")
    if path.suffix.lower() in _GEOMETRY:
        raise ResourceError(f"{path} is a geometry without a mesh",
                            help=f"mesh it first: gmsh -2 (or -3) {path} -o {path.stem}.msh; then "
                            f"give {path.stem}.msh")
    meshio = meshio_module()
    try:
        return from_meshio(meshio.read(path))
    except (SystemExit, meshio.ReadError, KeyError, ValueError) as problem:
        reason = f"it is no {path.suffix} file" if isinstance(problem, SystemExit) else \
            repr(problem)
        raise ResourceError(f"meshio cannot read {path}: {reason}",
                            help="meshes: .msh, .vtu, .vtk, .mesh, .med and others that meshio "
                            "knows") from problem


def from_meshio(source) -> Mesh:
    """A `Mesh` from a `meshio.Mesh`: blocks, groups, flipped cells, no points left over."""
    blocks, origin = [], []
    for k, block in enumerate(source.cells):
        name, data = block.type, np.asarray(block.data)
        if name in _SERENDIPITY:
            name, count = _SERENDIPITY[name]
            data = data[:, :count]
        if name not in _NDIM:
            raise ModelError(f"cells of type '{name}' have no element in Lopin",
                             help=f"known cells: {', '.join(CELLS)}")
        blocks.append((name, data))
        origin.append(k)
    top = max((_NDIM[name] for name, _ in blocks), default=0)
    if top < 2:
        raise ModelError("the mesh has neither surface nor solid cells")
    points = np.asarray(source.points, float)
    if top == 2 and points.shape[1] == 3:
        if np.ptp(points[:, 2]) > 1e-9*np.ptp(points, axis=0).max():
            raise ModelError("a mesh of surface cells must lie in a plane z = constant")
        points = points[:, :2]
    solids = [(k, name, data) for (name, data), k in zip(blocks, origin) if _NDIM[name] == top]
    used = np.unique(np.concatenate([data.ravel() for _, _, data in solids]))
    new = np.full(len(points), -1)
    new[used] = np.arange(len(used))
    mesh = Mesh(np.ascontiguousarray(points[used]),
                [(name, _righted(name, new[data], points[used])) for _, name, data in solids])
    return _with_groups(mesh, source, blocks, solids, new, top)


def _with_groups(mesh: Mesh, source, blocks, solids, new, top) -> Mesh:
    """Translate the physical groups of every dimension."""
    start = dict(zip([k for k, _, _ in solids],
                     np.cumsum([0, *(len(d) for _, _, d in solids)]).tolist()))
    elements = {"ALL": np.arange(mesh.n_element)}
    sets: dict[str, NDArray] = {}
    surfaces: dict[str, NDArray] = {}
    parents = None
    for group, members in _groups(source).items():
        name = clean_name(group)
        if name in sets:
            raise ModelError(f"two groups are named '{name}' once blanks and case are made equal")
        nodes, rows, inside = [], [], []
        for k, (cell, data) in enumerate(blocks):
            chosen = members.get(k, np.empty(0, int))
            nodes.append(new[data[chosen]].ravel())
            if _NDIM[cell] == top:
                inside.append(start[k] + chosen)
            elif _NDIM[cell] == top - 1 and len(chosen):
                parents = parents or _parents(mesh)
                corners = CELLS[cell].n_corner
                rows += [_one_parent(parents, new[facet[:corners]], group)
                         for facet in data[chosen]]
        members_new = np.unique(np.concatenate(nodes))
        sets[name] = members_new[members_new >= 0]
        if any(len(i) for i in inside):
            elements[name] = np.concatenate(inside)
        if rows:
            surfaces[name] = np.array(rows)
    return mesh.replaced(point_sets=sets, element_sets=elements, surfaces=surfaces)


def _groups(source) -> dict[str, dict[int, NDArray]]:
    """Members of each group by block: from cell_sets, or gmsh's physical numbers and names."""
    groups: dict[str, dict[int, NDArray]] = {}
    for name, members in (source.cell_sets or {}).items():
        if not name.startswith("gmsh:"):
            groups[name] = {k: np.asarray(m, int) for k, m in enumerate(members) if m is not None}
    numbers = source.cell_data.get("gmsh:physical")
    for name, (number, ndim) in (source.field_data or {}).items() if numbers is not None else ():
        if name not in groups:
            groups[name] = {k: np.flatnonzero(np.asarray(numbers[k]) == number)
                            for k, block in enumerate(source.cells) if block.dim == ndim}
    return groups


def _parents(mesh: Mesh) -> dict[frozenset, list[tuple[int, int]]]:
    """Elements and face numbers by the corners of the face."""
    found: dict[frozenset, list[tuple[int, int]]] = {}
    element = 0
    for name, cells in mesh.blocks:
        cell = CELLS[name]
        faces = [[n for n in f if n < cell.n_corner] for f in cell.faces]
        for nodes in cells:
            for k, face in enumerate(faces):
                found.setdefault(frozenset(nodes[face]), []).append((element, k + 1))
            element += 1
    return found


def _one_parent(parents, corners: NDArray, group: str) -> tuple[int, int]:
    found = parents.get(frozenset(corners.tolist()), [])
    if len(found) == 1:
        return found[0]
    where = "belongs to no element" if not found else "lies between two elements"
    raise ModelError(f"a facet of group '{group}' {where}: nodes {sorted(corners.tolist())}",
                     help="make the group of boundary facets, or separate the two bodies")


def _righted(name: str, cells: NDArray, points: NDArray) -> NDArray:
    """The cells with positive Jacobians: 2D cells listed clockwise are turned round."""
    cell = CELLS[name]
    if cell.ndim != 2:
        return cells
    n = cell.n_corner
    order = [0, *range(n - 1, 0, -1)]
    if cell.is_quadratic:
        order += [2*n - 1 - k for k in range(n)]
    wrong = [smallest_jacobian(name, points[c]) < 0.0 for c in cells]
    return np.where(np.array(wrong)[:, None], cells[:, order], cells)


def clean_name(name: str) -> str:
    """A label that decks accept: upper case, odd characters to underscores, 80 characters.

    >>> clean_name("die top (left)")
    'DIE_TOP_LEFT'
    """
    return re.sub(r"[^A-Z0-9_.-]+", "_", name.upper()).strip("_")[:80]
