"""Where points of the metal go: tracers and flow lines, over meshes that are made anew, too.

A tracer is a material point. It keeps its place within its element from output to output, as long
as the mesh lives; at a new mesh it goes on in the element that its place lies in. A flow line is a
row of tracers that began on a line, as the fibres of a rolled bar do.
"""
from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import UsageError, optional
from .files import reading
from .vtu import read_vtu

#: Simplices that cells are cut into, for the place of a point: exact in simplices.
_CUT = {"triangle": [(0, 1, 2)], "quad": [(0, 1, 2), (0, 2, 3)], "tetra": [(0, 1, 2, 3)],
        "hexahedron": [(0, 1, 3, 4), (1, 2, 3, 6), (1, 3, 4, 6), (1, 4, 5, 6), (3, 4, 6, 7)]}
#: A tracer outside the metal belongs to the closest simplex; told beyond this share of its size.
_OUTSIDE = 0.05


@dataclass(frozen=True)
class Tracks:
    """Places of tracers.

    Attributes
    ----------
    times : of the outputs (time,)
    places : (time, tracer, ndim) [length]
    outside : the farthest that a tracer was taken from outside into a mesh [size of its element]
    """

    times: NDArray
    places: NDArray
    outside: float

    def lines(self) -> str:
        """A table: time, number of the tracer from 1, place."""
        axes = ",".join("xyz"[:self.places.shape[2]])
        return f"time,tracer,{axes}\n" + "".join(
            ",".join([repr(float(t)), str(k + 1), *(repr(float(v)) for v in p)]) + "\n"
            for t, now in zip(self.times, self.places) for k, p in enumerate(now))

    def line(self) -> str:
        """For a terminal."""
        way = np.linalg.norm(self.places[-1] - self.places[0], axis=1)
        told = (f"{self.places.shape[1]} tracers over {len(self.times)} outputs, the farthest "
                f"{way.max():.4g} from where it began")
        return told if self.outside <= _OUTSIDE else \
            told + f"; one was {self.outside:.2g} of an element outside the metal"


def outputs(folder: Path, name: str) -> list[tuple[float, Path]]:
    """Times and files of the body's outputs, of all parts of a run."""
    path = folder/f"{name}.pvd"
    with reading(path):
        found = re.findall(r'timestep="([^"]+)"[^>]*name="solid"[^>]*file="([^"]+)"',
                           path.read_text())
    body = [(float(time), folder/file) for time, file in found]
    if not body:
        raise UsageError(f"'{path}' names no outputs of a body",
                         help="ask for them: *OUTPUT, FIELD and *NODE OUTPUT with U")
    return sorted(body, key=lambda row: row[0])


def read_starts(text: str) -> NDArray:
    """Places, a line each, `#` before remarks.

    >>> read_starts("# r, z\\n1, 2\\n3, 4\\n").tolist()
    [[1.0, 2.0], [3.0, 4.0]]
    """
    rows = [line.split("#")[0].split(",") for line in text.splitlines()]
    try:
        places = np.array([[float(v) for v in row] for row in rows if any(v.strip() for v in row)])
    except ValueError as problem:
        raise UsageError(f"the places of tracers cannot be read: {problem}",
                         help="a line for each tracer: its coordinates") from problem
    return _checked(places)


def _checked(places: NDArray) -> NDArray:
    """Places of tracers that are some."""
    if places.ndim != 2 or places.shape[1] not in (2, 3) or len(places) == 0:
        raise UsageError("a tracer has two or three coordinates, the same number in every line")
    lost = np.flatnonzero(~np.isfinite(places).all(axis=1))
    if len(lost):
        raise UsageError(f"tracer {lost[0] + 1} has a coordinate that is no finite number: "
                         + ", ".join(f"{v:g}" for v in places[lost[0]]))
    return places


def simplices(mesh, ndim: int) -> NDArray:
    """Nodes of the simplices of all cells of that many dimensions, corners only."""
    solid = {2: ("triangle", "quad"), 3: ("tetra", "hexahedron")}[ndim]
    found = [np.asarray(block.data)[:, list(rows)] for block in mesh.cells
             for kind in solid if block.type.startswith(kind) for rows in _CUT[kind]]
    flat = {name: any(block.type.startswith(kinds) for block in mesh.cells) for name, kinds in
            ((2, ("triangle", "quad")), (3, ("tetra", "hexahedron", "wedge")))}
    if not found and flat[5 - ndim]:
        raise UsageError(f"tracers have {ndim} coordinates, the run has {5 - ndim}",
                         help=f"{'xyz'[:5 - ndim]} in every line" if ndim == 2 else
                         "two in every line: x, y, or r, z around an axis")
    if not found:
        raise UsageError("tracers run in triangles, quads, tetrahedra and hexahedra")
    return np.vstack(found)


def within(x: NDArray, cells: NDArray, places: NDArray) -> tuple[NDArray, NDArray, float]:
    """For each place its simplex and the shares of its corners; the farthest one outside."""
    corner = x[cells]
    shape = np.swapaxes(corner[:, 1:] - corner[:, :1], 1, 2)
    size = np.abs(np.linalg.det(shape))
    upright = size > 1e-14*size.max()
    inverse = np.zeros_like(shape)
    inverse[upright] = np.linalg.inv(shape[upright])
    tree = optional("scipy.spatial", "tracers").cKDTree(corner[upright].mean(axis=1))
    rows = np.flatnonzero(upright)
    near = rows[tree.query(places, min(64, len(rows)))[1].reshape(len(places), -1)]
    share = np.einsum("ckij,ckj->cki", inverse[near], places[:, None] - corner[near, 0])
    share = np.concatenate([1.0 - share.sum(axis=2, keepdims=True), share], axis=2)
    best = share.min(axis=2).argmax(axis=1)
    at = np.arange(len(places)), best
    return near[at], share[at], float(max(0.0, -share[at].min()))


def tracks(folder: str | Path, name: str, starts: ArrayLike) -> Tracks:
    """Follow tracers through the outputs of a run.

    Parameters
    ----------
    folder, name : of the results: folder/name.pvd
    starts : places of the tracers before the run (tracer, ndim) [length]
    """
    here = _checked(np.atleast_2d(np.asarray(starts, float)))
    times, found, outside, mesh, known = [0.0], [here], 0.0, None, None
    for time, path in outputs(Path(folder), name):
        now = read_vtu(path)
        x = np.asarray(now.points, float)[:, :here.shape[1]]
        if mesh is None or x.shape != mesh.shape or not np.array_equal(x, mesh):
            mesh, cells = x, simplices(now, here.shape[1])
            owner, share, off = within(x, cells, here)
            known, outside = (cells[owner], share), max(outside, off)
        if "U" not in now.point_data:
            raise UsageError(f"'{path}' has no displacements", help="ask for them: *NODE OUTPUT, U")
        moved = x + np.asarray(now.point_data["U"], float)[:, :here.shape[1]]
        here = np.einsum("tk,tkd->td", known[1], moved[known[0]])
        times.append(time)
        found.append(here)
    return Tracks(np.array(times), np.array(found), outside)
