"""Pictures with matplotlib; every function draws on an axes and returns it.

Results are drawn where they are after deformation. Axes say the unit that the heading of the deck
names ("..., N mm s"), or the quantity.
"""
from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from .errors import UsageError, optional
from .mesh.cells import CELLS
from .mesh.mesh import Mesh
from .result import WORDS
from .units import Units, quantity_of


def new_axes(ax=None):
    """The given axes, or new ones."""
    if ax is not None:
        return ax
    return optional("matplotlib.pyplot", "pictures").subplots(layout="constrained")[1]


def pressure(contact, exact: Callable[[np.ndarray], np.ndarray] | None = None, *, axis: int = 0,
             ax=None, unit: str = "", deformed: bool = True):
    """Contact pressure against one coordinate, and a closed form as a line.

    Parameters
    ----------
    contact : Contact, such as ``result.contact("TOP").last``
    exact : function of the coordinate, such as ``closed_form.hertz_sphere_plane(...).pressure``
    axis : which coordinate of the slave points
    unit : of the pressure, such as "MPa"; that of the heading unless given
    deformed : where the points are now; else where they began
    """
    ax = new_axes(ax)
    units = getattr(contact, "units", Units())
    x = (contact.place if deformed else contact.x)[:, axis]
    order = np.argsort(x)
    closed = contact.status[order] > 0
    ax.plot(x[order][closed], contact.pressure[order][closed], "o", label="in contact")
    ax.plot(x[order][~closed], contact.pressure[order][~closed], "o", mfc="none", color="C0",
            label="open")
    if exact is not None:
        line = np.linspace(x.min(), x.max(), 1001)
        if closed.any():   # finer where something touches
            line = np.union1d(line, np.linspace(*x[order][closed][[0, -1]]*1.1, 1001))
        ax.plot(line, exact(line), "k-", lw=1, label="closed form")
    ax.set_xlabel(units.label(_axes_of(getattr(contact, "frame", None))[axis], "length"))
    ax.set_ylabel(f"contact pressure [{unit.strip('[]') or units.of('stress')}]")
    ax.legend()
    return ax


def deformed(result, field: str | None = None, index: int = -1, *, component: int = 0,
             scale: float = 1.0, ax=None):
    """The mesh of a plane result where it is at one increment, coloured by a field.

    Parameters
    ----------
    field : name of a field at the points, such as "Mises" or "displacement"
    component : of a vector or tensor field, counted from 0
    scale : factor on the displacements

    Raises
    ------
    UsageError : the result is not of a plane scene, or has no such field.
    """
    source = result.to_meshio(index)
    blocks = [(b.type, np.asarray(b.data)) for b in source.cells
              if b.type in CELLS and CELLS[b.type].ndim == 2]
    if not blocks or np.ptp(source.points[:, 2:]) > 0.0:
        raise UsageError("only plane scenes are drawn; result.to_pyvista() shows solid ones")
    values, label = None, ""
    if field is not None:
        values, word = result.at(index)[field], WORDS.get(field, field)
        values = values[:, component] if values.ndim == 2 else values
        label = result.units.label(field, quantity_of(word))
    flat = Mesh(np.asarray(source.points)[:, :2], blocks)
    ax = mesh(flat, result.at(index)["U"], scale=scale, field=values, label=label, ax=ax)
    names = _axes_of(result.at(index))
    ax.set_xlabel(result.units.label(names[0], "length"))
    ax.set_ylabel(result.units.label(names[1], "length"))
    return ax


def mesh(mesh: Mesh, displacement: ArrayLike | None = None, *, scale: float = 1.0,
         field: ArrayLike | None = None, label: str = "", ax=None):
    """A plane mesh, deformed `scale` times, coloured by a field at its points.

    A solid mesh shows its first two coordinates of the boundary.
    """
    from matplotlib.collections import PolyCollection

    ax = new_axes(ax)
    x = mesh.points[:, :2].copy()
    if displacement is not None:
        x += scale*np.asarray(displacement, float)[:, :2]
    outlines = [nodes[_outline(name)] for name, cells in mesh.blocks for nodes in cells
                if CELLS[name].ndim == 2]
    if mesh.ndim == 3:
        outlines = [mesh.face_nodes(e, f) for e, f in mesh.boundary()]
    cells = PolyCollection([x[nodes] for nodes in outlines], edgecolor="0.4", lw=0.4,
                           facecolor="none" if field is not None else "0.9")
    if field is not None:
        values = np.asarray(field, float)
        cells.set_array(np.array([values[nodes].mean() for nodes in outlines]))
        ax.figure.colorbar(cells, ax=ax, label=label)
    ax.add_collection(cells)
    ax.set_aspect("equal")
    ax.autoscale_view()
    return ax


def history(result, columns: list[str], *, against: str = "time", ax=None):
    """Columns of the history against another; a column that does not exist raises UsageError."""
    ax = new_axes(ax)
    data, units = result.history, result.units
    for name in (against, *columns):
        if name not in data:
            raise UsageError(f"no column '{name}' in the history; known: {', '.join(data)}")
    for name in columns:
        ax.plot(data[against], data[name], ".-", label=units.label(name, quantity_of(name)))
    ax.set_xlabel(units.label(against, quantity_of(against)))
    ax.legend()
    return ax


def _axes_of(frame) -> str:
    """Names of the coordinates: r and z in an axisymmetric scene."""
    kind = (frame.result.summary.get("model") or {}).get("kind") if frame else ""
    return "rz" if kind == "axisymmetric" else "xyz"


def _outline(name: str) -> list[int]:
    """Nodes of a plane cell on the way round it."""
    cell = CELLS[name]
    n = cell.n_corner
    if not cell.is_quadratic:
        return list(range(n))
    return [k for pair in zip(range(n), range(n, 2*n)) for k in pair]
