"""Strains of a sheet, and how near they are to a forming limit curve that the user gives.

The strains are those of circles printed on the blank: principal logarithmic strains within the
plane of the sheet, from the total deformation. The curve says how large the major one may be at
each minor one; it is measured, for a metal and a thickness, on paths that keep their direction:
where the path of an element turns, the reading is no proof.
"""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import UsageError
from .mesh.cells import CELLS
from .mesh.mesh import Mesh
from .result import refuse_meshes

#: Corners of the cells that a sheet may be made of, by the first letters of meshio's names.
_CORNERS = {"triangle": 3, "quad": 4, "tetra": 4, "wedge": 6, "hexahedron": 8}
#: Cosines to the normal of a blank: of its faces (not its rim), of faces that are flat.
_FACE, _FLAT = 0.7, 0.999
#: Share of the faces that may be bent beside that, as rounded edges are, and of the layer from its
#: lowest to its highest place that a flat blank fills at least.
_BENT, _FILLED = 0.05, 0.5


@dataclass(frozen=True)
class SheetStrains:
    """Strains of a sheet, an entry a cell.

    Attributes
    ----------
    place : of the middle at the end (cell, ndim)
    major, minor : principal logarithmic strains in the plane of the sheet
    limit : major strain that the curve allows there; nan outside its minor strains, or without one
    remark : on the normal of the blank, where nobody gave it and it is no axis
    """

    place: NDArray
    major: NDArray
    minor: NDArray
    limit: NDArray
    remark: str = ""

    @property
    def share(self) -> NDArray:
        """Major strain by its limit: 1 on the curve."""
        return self.major/self.limit

    def lines(self) -> str:
        """A table: place, strains, limit."""
        axes = ",".join("xyz"[:self.place.shape[1]])
        table = np.column_stack([self.place, self.major, self.minor, self.limit])
        return "\n".join([f"{axes},major,minor,limit",
                          *(",".join(repr(float(v)) for v in row) for row in table)]) + "\n"

    def line(self) -> str:
        """For a terminal."""
        return f"{self._told()}; {self.remark}" if self.remark else self._told()

    def _told(self) -> str:
        judged = np.isfinite(self.limit)
        where = np.nanargmax(self.share) if judged.any() else int(np.argmax(self.major))
        at = ", ".join(f"{v:.4g}" for v in self.place[where])
        strains = f"major {self.major[where]:.4g}, minor {self.minor[where]:.4g} at ({at})"
        if not judged.any():
            return f"largest strains: {strains}; no element is judged by a curve"
        beyond = int((self.share[judged] >= 1.0).sum())
        told = (f"nearest to the limit: {strains}, {100*self.share[where]:.3g} % of "
                f"{self.limit[where]:.4g}; {beyond} of {judged.sum()} elements are beyond the "
                "curve")
        outside = int((~judged).sum())
        return told + (f"; {outside} have minor strains that it does not reach" if outside else "")


def read_curve(text: str) -> NDArray:
    """Points (minor, major) of a curve: a line each, `#` before remarks; rising minor strains.

    >>> read_curve("# true strains\\n-0.3, 0.6\\n0, 0.3\\n0.3, 0.4\\n").tolist()
    [[-0.3, 0.6], [0.0, 0.3], [0.3, 0.4]]
    """
    rows = [line.split("#")[0].replace(";", ",").split(",") for line in text.splitlines()]
    rows = [row for row in rows if any(word.strip() for word in row)]
    try:
        points = np.array([[float(word) for word in row] for row in rows])
    except ValueError as problem:
        raise UsageError(f"the forming limit curve cannot be read: {problem}",
                         help="a line for each point: minor strain, major strain") from problem
    if points.ndim != 2 or points.shape[1:] != (2,) or len(points) < 2 or \
            not (np.diff(points[:, 0]) > 0.0).all() or not (points[:, 1] > 0.0).all():
        raise UsageError("a forming limit curve has at least two points (minor, major), minor "
                         "strains that rise and positive major ones")
    return points


def strains_of(result, curve: ArrayLike | None = None, *, axisymmetric: bool = False,
               normal: ArrayLike | None = None) -> SheetStrains:
    """Strains in the plane of a sheet at the end of a run, by the kind of its model.

    Parameters
    ----------
    result : of `lopin.run` or `lopin.open_result`
    curve : points (minor, major)
    axisymmetric : the kind of a run that has no summary
    normal : of the blank before it was formed; default: z in plane stress, else that of its faces
        (`normal_of`)
    """
    refuse_meshes(result, "strains count from the mesh of the start, and the last mesh is another")
    kind = (result.summary.get("model") or {}).get("kind", "")
    if axisymmetric and kind not in ("", "axisymmetric"):
        raise UsageError(f"the run is {kind}, not axisymmetric", help="leave --axisymmetric out")
    shape = result.to_meshio()
    if "U" not in shape.point_data:
        raise UsageError("the run has no displacements at its nodes",
                         help="ask for them: *NODE FILE with U, or *OUTPUT, FIELD, "
                              "VARIABLE=PRESELECT")
    if kind == "plane stress":
        normal = [0.0, 0.0, 1.0] if normal is None else normal
        if np.any(np.asarray(normal, float)[:2]):
            raise UsageError("in plane stress a sheet lies in the plane of its mesh: its normal is "
                             "0 0 1", help="leave --normal out")
    return sheet_strains(shape, shape.point_data["U"], curve, normal=normal,
                         axisymmetric=axisymmetric or kind == "axisymmetric")


def sheet_strains(mesh, displacement: ArrayLike, curve: ArrayLike | None = None, *,
                  axisymmetric: bool = False, normal: ArrayLike | None = None) -> SheetStrains:
    """Strains in the plane of a sheet, of all its cells.

    Parameters
    ----------
    mesh : as it was, with `points` and `cells` (blocks with `type` and `data`)
    displacement : of its points (point, ndim)
    curve : points (minor, major)
    axisymmetric : the plane is (r, z): the third strain is that of the hoop
    normal : of the blank before it was formed; default: that of its faces (`normal_of`).
        Across the plane of a mesh (0, 0, 1): both strains are those of the plane
    """
    blocks = [(c.type, np.asarray(c.data)) for c in mesh.cells if _corners(c.type)]
    flat = all(name.startswith(("triangle", "quad")) for name, _ in blocks)
    d = 2 if flat else 3
    x = np.asarray(mesh.points, float)[:, :d]
    u = np.asarray(displacement, float)[:, :d]
    remark = ""
    if normal is None:
        normal, remark = normal_of(x, blocks)
    unit = _unit(normal, d)
    places, strains = [], []
    for name, cells in blocks:
        corner = cells[:, :_corners(name)]
        before, after = x[corner], x[corner] + u[corner]
        metric = np.zeros((len(cells), 3, 3))
        f = mean_gradient(before, after)
        metric[:, :d, :d] = np.swapaxes(f, 1, 2) @ f
        if flat:
            hoop = after[:, :, 0].mean(axis=1)/before[:, :, 0].mean(axis=1) if axisymmetric else 1.0
            metric[:, 2, 2] = hoop**2
        places.append(after.mean(axis=1))
        strains.append(0.5*np.log(in_plane(metric, unit)))
    place, strain = np.vstack(places), np.vstack(strains)
    limit = np.full(len(strain), np.nan)
    if curve is not None:
        points = np.asarray(curve, float)
        limit = np.interp(strain[:, 0], *points.T, left=np.nan, right=np.nan)
    return SheetStrains(place, strain[:, 1], strain[:, 0], limit, remark)


def normal_of(x: NDArray, blocks: list[tuple[str, NDArray]]) -> tuple[NDArray, str]:
    """The normal of a flat blank, however it lies, and a remark if it is no axis.

    The skin of a flat blank has most of its area across the normal, whatever its rim is like. A
    blank that is bent at the start has no one normal: the axis along which it is thinnest stands
    for it, and the remark says so.
    """
    area, volume = _skin_of(x, blocks)
    size = np.linalg.norm(area, axis=1)
    used = np.unique(np.concatenate([c.ravel() for _, c in blocks]))
    axis = np.eye(x.shape[1])[int(np.argmin(np.ptp(x[used], axis=0)))]
    spread = area.T @ (area/size[:, None])
    values, directions = np.linalg.eigh(spread)
    # Cubes have faces across every axis.
    normal = directions[:, -1] if axis @ spread @ axis < (1.0 - 1e-9)*values[-1] else axis
    for _ in range(2):   # the rim left out: exact where the faces are planes
        cosine = area @ normal/size
        faces = np.abs(cosine) > _FACE
        mean = (area*np.sign(cosine)[:, None])[faces].sum(axis=0)
        normal = mean/np.linalg.norm(mean)
    cosine = np.abs(area @ normal)/size
    bent = size[(cosine > _FACE) & (cosine < _FLAT)].sum() > _BENT*size[cosine > _FACE].sum()
    layer = 0.5*np.abs(area @ normal).sum()*np.ptp(x[used] @ normal)
    if bent or volume < _FILLED*layer:
        return axis, ("the blank is bent at the start: its strains are across "
                      f"{_components(axis)}, the axis along which it is thinnest; --normal says "
                      "another")
    if np.abs(normal @ axis) > 1.0 - 1e-9:
        return axis, ""
    normal = normal*np.sign(normal[np.argmax(np.abs(normal))])
    return normal, f"the normal of the blank is {_components(normal)}"


def _skin_of(x: NDArray, blocks: list[tuple[str, NDArray]]) -> tuple[NDArray, float]:
    """Areas of the faces of the skin along their normals (face, d), and the volume within; lengths
    and the area in a plane."""
    family = {name: next(kind for kind in _CORNERS if name.startswith(kind)) for name, _ in blocks}
    mesh = Mesh(x, [(family[name], cells[:, :_corners(name)]) for name, cells in blocks])
    element, face = mesh.boundary().T
    areas, volume, start = [], 0.0, 0
    for name, cells in mesh.blocks:
        own = (element >= start) & (element < start + len(cells))
        for k, nodes in enumerate(CELLS[name].faces):
            cell = cells[element[own & (face == k + 1)] - start]
            corner = x[cell[:, list(nodes)]]
            if x.shape[1] == 2:
                way = corner[:, 1] - corner[:, 0]
                area = np.stack([way[:, 1], -way[:, 0]], axis=1)
            else:   # of triangles and of quads: by diagonals
                area = 0.5*np.cross(corner[:, -2] - corner[:, 0], corner[:, -1] - corner[:, 1])
            middle = corner.mean(axis=1)
            outward = np.sign((area*(middle - x[cell].mean(axis=1))).sum(axis=1))
            volume += (outward*((middle - x[0])*area).sum(axis=1)).sum()/x.shape[1]
            areas.append(area)
        start += len(cells)
    area = np.concatenate(areas)
    return area[np.linalg.norm(area, axis=1) > 0.0], float(volume)


def _components(direction: NDArray) -> str:
    return ", ".join(f"{v:.4g}" for v in direction)


def _unit(normal: ArrayLike, d: int) -> NDArray:
    """A direction in space, of length 1."""
    given = np.atleast_1d(np.asarray(normal, float))
    length = np.linalg.norm(given)
    if given.shape not in ((d,), (3,)) or not 0.0 < length < np.inf:
        raise UsageError(f"{', '.join(f'{v:g}' for v in given)} is no normal",
                         help="its components in space, not all 0: 0 0 1")
    return np.r_[given/length, np.zeros(3 - len(given))]


def _corners(name: str) -> int:
    """Number of corners of a cell; 0 for lines and points."""
    return next((n for kind, n in _CORNERS.items() if name.startswith(kind)), 0)


def mean_gradient(before: NDArray, after: NDArray) -> NDArray:
    """The deformation of cells (cell, corner, d) by least squares: exact where it is uniform."""
    a = before - before.mean(axis=1, keepdims=True)
    b = after - after.mean(axis=1, keepdims=True)
    return np.swapaxes(np.linalg.solve(np.swapaxes(a, 1, 2) @ a, np.swapaxes(a, 1, 2) @ b), 1, 2)


def in_plane(metric: NDArray, normal: NDArray) -> NDArray:
    """Squares of the stretches of lines across `normal`, the smaller one first (cell, 2).

    `metric`: F^T F (cell, 3, 3).
    """
    basis = np.linalg.svd(normal[None])[2][1:]
    return np.linalg.eigvalsh(basis @ metric @ basis.T)
