"""Drawing of the atlas: a panel a method, a sign a class, colour for what F0 cells cost or miss."""
from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..files import whole_file
from .cells import CLASSES, Cell

COLOR = {"W": "#f0e2b6", "F1": "#ff0000", "F2": "#c9c9c9", "F3": "#e6a8d7", "F4": "#f4a582",
         "F5": "#a6a6a6", "F6": "#b2182b", "F7": "#bfa5e0"}
SIGN = {"W": "w", "F1": "1!", "F2": "2", "F3": "3", "F4": "4", "F5": "5", "F6": "6", "F7": "7"}
LINES = ("-", "--", ":", "-.")


#: By what F0 cells are coloured: label, value of a cell, range.
SHADE = {
    "error": (r"F0: $\log_{10}$ of the error", lambda c: np.log10(max(c.error, 1e-16)), (-16, -1)),
    "faces": (r"F0: $\log_{10}$ of the larger error, pressure or drag",
              lambda c: np.log10(max(np.nan_to_num(c.drag), c.error, 1e-16)), (-16, -1)),
    "iterations": ("F0: most iterations of an increment", lambda c: c.iterations, (0, 20)),
    "few": (r"F0: $\log_{10}$ of the error of the force", lambda c: np.log10(max(c.error, 1e-4)),
            (-3.0, -1.3)),
    "increments": (r"F0: $\log_{10}$ of the increments", lambda c: np.log10(max(c.increments, 1)),
                   (0.0, 2.5)),
    "passes": (r"F0: $\log_{10}$ of the passes", lambda c: np.log10(max(c.iterations, 1)),
               (0.0, 3.5)),
}


def edges(values: NDArray, linear: bool = False) -> NDArray:
    """Borders between values, half way on the axis."""
    x = values if linear else np.log10(values)
    middle = 0.5*(x[1:] + x[:-1])
    if len(x) == 1:
        ends = np.array([x[0] - 0.5, x[0] + 0.5])
    else:
        ends = np.concatenate([[2*x[0] - middle[0]], middle, [2*x[-1] - middle[-1]]])
    return ends if linear else 10.0**ends


def draw(chart, cells: list[Cell], path: Path) -> None:
    """All panels of a map, as SVG."""
    import matplotlib

    matplotlib.rcParams["svg.hashsalt"] = "lopin"
    matplotlib.rcParams["svg.fonttype"] = "none"
    from matplotlib.figure import Figure

    across = getattr(chart, "across", 3)
    rows = -(-len(chart.panels)//across)
    figure = Figure(figsize=(4.2*across, 3.3*rows + 1.0), layout="constrained")
    axes = figure.subplots(rows, across, squeeze=False, sharey=False)
    image, named = None, set()
    for k, ax in enumerate(axes.flat):
        mine = [c for c in cells if k < len(chart.panels) and c.panel == chart.panels[k]]
        if not mine:             # none, or none solved yet
            ax.set_axis_off()
            continue
        image = _panel(ax, chart, chart.panels[k], mine)
        names = tuple(line.get_label() for line in ax.lines)
        if names and names not in named:
            named.add(names)
            ax.legend(fontsize=6.5, loc="upper left", framealpha=0.85, handlelength=2.2)
        if k >= len(chart.panels) - across:
            ax.set_xlabel(chart.labels[0])
        if k % across == 0:
            ax.set_ylabel(chart.labels[1])
    figure.colorbar(image, ax=axes, label=SHADE[chart.colour][0], shrink=0.6, aspect=40)
    _legend(figure, cells, axes[0, 0])
    figure.suptitle(chart.title)
    words = {"Date": None, "Creator": "lopin atlas"} if path.suffix == ".svg" else None
    with whole_file(path) as part:
        figure.savefig(part, metadata=words, dpi=100)


def _panel(ax, chart, panel: str, cells: list[Cell]):
    """One method."""
    x, y = np.unique([c.x for c in cells]), np.unique([c.y for c in cells])
    shade = np.full((len(y), len(x)), np.nan)
    linear, named = getattr(chart, "linear", False), hasattr(chart, "ticks")
    even = named or getattr(chart, "even", False)
    ax.set(xscale="linear" if even else "log", yscale="linear" if linear else "log", title=panel)
    borders = edges(x, even), edges(y, linear)
    kinds = np.full(shade.shape, "", dtype=object)
    for cell in cells:
        i, j = np.searchsorted(y, cell.y), np.searchsorted(x, cell.x)
        kinds[i, j] = cell.kind
        if cell.kind == "F0":
            shade[i, j] = SHADE[chart.colour][1](cell)
    for region in regions(kinds):
        _mark(ax, region, kinds[region[0]], borders, (x, y))
    low, high = SHADE[chart.colour][2]
    image = ax.pcolormesh(*borders, np.ma.masked_invalid(shade), cmap="YlGn_r", vmin=low,
                          vmax=high, zorder=2, rasterized=True)
    ax.set_xlim(borders[0][0], borders[0][-1])
    ax.set_ylim(borders[1][0], borders[1][-1])
    if named:
        ax.set_xticks(x, [chart.ticks[0][round(v)] for v in x], fontsize=7)
        ax.set_yticks(y, [chart.ticks[1][round(v)] for v in y], fontsize=6.5)
    elif len(x) == 1:
        ax.set_xticks([], minor=False)
        ax.set_xticks([], minor=True)
    for style, (name, xs, ys) in zip(LINES, chart.theory(panel) if len(x) > 1 else ()):
        ax.plot(xs, ys, "k", ls=style, lw=1.3, label=name)
    return image


def regions(kinds: NDArray) -> list[list[tuple[int, int]]]:
    """Neighbours of one class but F0, as lists of (row, column), in order.

    >>> regions(np.array([["F0", "F2", "F2"], ["F3", "F0", "F2"]], dtype=object))
    [[(0, 1), (0, 2), (1, 2)], [(1, 0)]]
    """
    left = {(i, j) for i, j in np.ndindex(kinds.shape) if kinds[i, j] not in ("F0", "")}
    found = []
    for start in sorted(left):
        if start not in left:
            continue
        left.discard(start)
        region, front = [start], [start]
        while front:
            i, j = front.pop()
            for near in ((i + 1, j), (i - 1, j), (i, j + 1), (i, j - 1)):
                if near in left and kinds[near] == kinds[i, j]:
                    left.discard(near)
                    region.append(near)
                    front.append(near)
        found.append(sorted(region))
    return found


def _mark(ax, region: list[tuple[int, int]], kind: str, borders, places) -> None:
    """Colour a region by runs of its rows, and put its sign at its middle."""
    (across, along), (x, y) = borders, places
    style = {"facecolor": COLOR[kind], "edgecolor": COLOR[kind], "lw": 0.4}
    start = region[0]
    for k, (i, j) in enumerate(region):
        last = k + 1 == len(region) or region[k + 1] != (i, j + 1)
        if last:
            ax.fill_between([across[start[1]], across[j + 1]], along[i], along[i + 1], **style)
            start = region[k + 1] if k + 1 < len(region) else start
    middle = np.mean(region, axis=0)
    i, j = min(region, key=lambda at: float(np.sum((np.array(at) - middle)**2)))
    ax.text(x[j], y[i], SIGN[kind], ha="center", va="center", fontsize=8,
            color="white" if kind in ("F1", "F6") else "#333333")


def _legend(figure, cells: list[Cell], ax) -> None:
    """Signs of the classes that occur, below."""
    from matplotlib.patches import Patch

    present = [k for k in CLASSES if k != "F0" and any(c.kind == k for c in cells)]
    marks = [Patch(color=COLOR[k], label=f"{k} ({SIGN[k]}): {CLASSES[k]}") for k in present]
    if marks:
        figure.legend(handles=marks, loc="outside lower center", ncols=len(marks), fontsize=8,
                      frameon=False)
