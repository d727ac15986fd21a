"""Drawing shared by the pictures of decks: one size, one colour map, tools in grey."""
from __future__ import annotations

import tempfile
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.colors import to_rgba  # noqa: F401
from matplotlib.tri import Triangulation
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

import lopin
from lopin.mesh.cells import CELLS

ROOT = Path(__file__).resolve().parents[2]
PICTURES = ROOT/"docs"/"pictures"
INK, EXACT, DOTS, TOOL = "#222222", "#888888", "#c1440e", "#3b4a5a"
MAP, SIGNED = "viridis", "RdBu_r"   # values of one sign, of both
plt.rcParams.update({"font.size": 9, "axes.edgecolor": INK, "axes.labelcolor": INK,
                     "text.color": INK, "axes.spines.top": False, "axes.spines.right": False})


def solved(name: str, **changes: str):
    """Run a deck by the executable; `changes` are texts to put in place of others, old=new."""
    text = (ROOT/"decks"/f"{name}.inp").read_text(encoding="utf-8")
    for old, new in changes.items():
        assert old in text, f"{name}.inp has no '{old}'"
        text = text.replace(old, new)
    deck = lopin.Deck.parse(text, name, ROOT/"decks")
    if "REMESH" in deck:
        return lopin.run(deck, tempfile.mkdtemp())
    return lopin.run(deck, executable=True)


def figure(width: float = 6.4, height: float = 3.8, columns: int = 1):
    """A figure and its axes."""
    return plt.subplots(1, columns, figsize=(width, height), layout="constrained")


def save(fig, name: str) -> None:
    """Write docs/pictures/name.png."""
    PICTURES.mkdir(parents=True, exist_ok=True)
    fig.savefig(PICTURES/f"{name}.png", dpi=110)
    plt.close(fig)


def curve(ax, x, exact, found_x, found, *, closed: str, xlabel: str, ylabel: str,
          dots: str = "Lopin") -> None:
    """A closed form as a grey line and what was computed as dots."""
    ax.plot(x, exact, color=EXACT, lw=2.5, label=closed)
    order = np.argsort(found_x)
    ax.plot(np.asarray(found_x)[order], np.asarray(found)[order], "o", ms=4.5, color=DOTS,
            label=dots)
    ax.set(xlabel=xlabel, ylabel=ylabel)
    ax.legend(frameon=False)


def deformed(ax, result, values, *, scale: float, index: int = -1, limits=None, mesh: bool = True,
             grid: float = 0.35, colours: str = MAP):
    """The deformed body, coloured by a value at the points; returns what a colour bar needs."""
    piece = result.to_meshio(index)
    x = piece.points[:, :2] + scale*np.asarray(piece.point_data["U"])[:, :2]
    triangles, edges = [], []
    for block in piece.cells:
        cell = CELLS[block.type]
        n = cell.n_corner
        triangles += [block.data[:, [0, k, k + 1]] for k in range(1, n - 1)]
        around = zip(range(n), range(n, 2*n))
        ring = [k for pair in around for k in pair] if cell.is_quadratic else range(n)
        edges += [x[nodes] for nodes in block.data[:, [*ring, 0]]]
    low, high = limits or (values.min(), values.max())
    drawn = ax.tripcolor(Triangulation(*x.T, np.vstack(triangles)), values, shading="gouraud",
                         cmap=colours, vmin=low, vmax=high)
    if mesh:
        ax.add_collection(LineCollection(edges, colors="k", linewidths=grid, alpha=0.35))
    ax.set_aspect("equal")
    return drawn


SIDES = {"hexahedron": np.array([[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5],
                                 [2, 3, 7, 6], [3, 0, 4, 7]]),
         "tetra": np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])}   # corners of faces


def skin(ax, result, values, *, index: int = -1, limits=None, colours: str = MAP):
    """The deformed outside of a body of hexahedra or of tetrahedra in space, coloured by a value at
    the points."""
    piece = result.to_meshio(index)
    x = piece.points + np.asarray(piece.point_data["U"])
    kind = max((b.type for b in piece.cells if b.type in SIDES), key=lambda name: len(SIDES[name]))
    cells = np.vstack([b.data for b in piece.cells if b.type == kind])
    faces = cells[:, SIDES[kind]].reshape(-1, SIDES[kind].shape[1])
    _, first, count = np.unique(np.sort(faces, axis=1), axis=0, return_index=True,
                                return_counts=True)
    faces = faces[first[count == 1]]
    low, high = limits or (values.min(), values.max())
    drawn = Poly3DCollection(x[faces], edgecolors=(0.0, 0.0, 0.0, 0.35), linewidths=0.25)
    drawn.set_array(values[faces].mean(axis=1))
    drawn.set(cmap=colours, clim=(low, high))
    ax.add_collection3d(drawn)
    return drawn


def tools(ax, result, *, scale: float, index: int = -1, mirror: bool = False,
          width: float = 2.2) -> None:
    """The profiles of all tools where they stand."""
    source = result.source
    index %= len(result.times)
    for part in source._frames[index][1]:
        if not part.startswith("tool "):
            continue
        piece = source._piece(index, part)
        motion = np.asarray(piece.point_data["MOTION"])
        x = (piece.points + (scale - 1.0)*motion)[:, :2]
        lines = np.concatenate([x[block.data] for block in piece.cells if block.type == "line"])
        for sign in (1, -1) if mirror else (1,):
            ax.add_collection(LineCollection(lines*[sign, 1], colors=TOOL, linewidths=width))


def coloured(fig, drawn, ax, label: str, **options) -> None:
    """A slim colour bar."""
    bar = fig.colorbar(drawn, ax=ax, label=label, shrink=0.85, pad=0.02, **options)
    bar.outline.set_visible(False)
