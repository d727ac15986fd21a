"""Pictures with matplotlib; every function draws on an axes and returns it."""
from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from .cells import CELLS
from .errors import LopinError
from .mesh import Mesh


def new_axes(ax=None):
    """The given axes, or new ones."""
    if ax is not None:
        return ax
    try:
        import matplotlib.pyplot as plt
    except ImportError as problem:
        raise LopinError("pictures need matplotlib", help="pip install 'lopin[plot]'") from problem
    return plt.subplots(layout="constrained")[1]


def pressure(contact, exact: Callable[[np.ndarray], np.ndarray] | None = None, *, axis: int = 0,
             ax=None, unit: str = ""):
    """Contact pressure against one coordinate, and a closed form as a line.

    Parameters
    ----------
    contact : Contact, such as ``result.contact("TOP").last``
    exact : function of the coordinate, such as ``closed_form.hertz_sphere_plane(...).pressure``
    axis : which coordinate of the slave points
    """
    ax = new_axes(ax)
    x = contact.x[:, axis]
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
    ax.set_xlabel("x" if axis == 0 else "xyz"[axis])
    ax.set_ylabel(f"contact pressure {unit}".strip())
    ax.legend()
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
    """Columns of the history against another."""
    ax = new_axes(ax)
    data = result.history
    for name in columns:
        ax.plot(data[against], data[name], ".-", label=name)
    ax.set_xlabel(against)
    ax.legend()
    return ax


def _outline(name: str) -> list[int]:
    """Nodes of a plane cell on the way round it."""
    cell = CELLS[name]
    n = cell.n_corner
    if not cell.is_quadratic:
        return list(range(n))
    return [k for pair in zip(range(n), range(n, 2*n)) for k in pair]
