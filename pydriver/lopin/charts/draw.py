"""Drawing of the work-precision chart; four panels a scene, two for a first look.

Colours are those of Okabe and Ito, which the colour-blind tell apart; markers repeat the method and
lines the path, so that a grey print is readable, too. Filled: certified. White: the certificate
warned or failed. Open triangles at the top: no answer at all.
"""
from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from .run import Run
from .theory import (
    augmentations,
    bound,
    medians,
    penalty_constant,
    rounding_constant,
    slope,
)

COLOR = {"lagrange": "#000000", "penalty": "#D55E00", "perturbed": "#0072B2",
         "augmented": "#009E73"}
MARKER = {"lagrange": "*", "penalty": "o", "perturbed": "s", "augmented": "D"}
LINE = {"condensed": "-", "newton": "--"}
SIZE = {"lagrange": 11, "penalty": 7, "perturbed": 4, "augmented": 5}
FLOOR, TOP = 1e-16, 3.0
GREY = "#777777"


def points(ax, rows: list[Run], x: str, y: str = "error_enforcement", join: bool = True,
           **more) -> None:
    """Rows of one method and path: joined in order, white where the certificate did not pass."""
    rows = [row for row in rows if row.verdict]
    if not rows:
        return
    color, marker = COLOR[rows[0].method], MARKER[rows[0].method]
    xs = np.array([getattr(row, x) for row in rows])
    ys = np.maximum([getattr(row, y) for row in rows], FLOOR)
    if join:
        ax.plot(xs, ys, LINE[rows[0].path], color=color, lw=1.1, alpha=0.75, zorder=2)
    passed = np.array([row.verdict == "PASS" for row in rows])
    style = {"ls": "", "marker": marker, "color": color, "ms": SIZE[rows[0].method], "mew": 1.0,
             "zorder": 4} | more
    ax.plot(xs[passed], ys[passed], **style)
    ax.plot(xs[~passed], ys[~passed], **style | {"mfc": "white"})


def chosen(rows: list[Run], method: str, path: str, swept: bool = True) -> list[Run]:
    """The sweep of one method over r, or its default."""
    found = [row for row in rows if row.method == method and row.path == path
             and np.isnan(row.tolerance) and row.default != swept]
    return sorted(found, key=lambda row: row.r)


def failures(ax, rows: list[Run], x: str) -> None:
    """Runs without an answer, at the top."""
    for row in rows:
        if row.failure and np.isfinite(getattr(row, x)):
            ax.plot(getattr(row, x), TOP, "^", mfc="none", color=COLOR[row.method], ms=7)


def logarithmic(ax, xlabel: str, ylabel: str) -> None:
    ax.set(xscale="log", yscale="log", xlabel=xlabel, ylabel=ylabel)
    ax.grid(True, which="major", color="#dddddd", lw=0.6)
    ax.set_axisbelow(True)
    ax.spines[["top", "right"]].set_visible(False)


def mesh_line(ax, rows: list[Run], at: float, align: str) -> None:
    """The error that the mesh makes anyway: enforcing contact better than this is wasted."""
    total = [row.error_total for row in rows
             if row.method == "lagrange" and row.path == "condensed"]
    if total and np.isfinite(total[0]):
        ax.axhspan(FLOOR, total[0], color="#f3efe2", zorder=0)
        ax.axhline(total[0], color="#a08a3c", lw=1.2, zorder=1)
        ax.annotate(f"mesh error {100*total[0]:.1g} %:\nless is wasted", (at, total[0]), ha=align,
                    xycoords=("axes fraction", "data"), xytext=(0, 3), textcoords="offset points",
                    va="bottom", fontsize=8, color="#7a6620")


def over_stiffness(ax, rows: list[Run]) -> None:
    """Enforcement error over r: slope -1, and what rounding makes of it."""
    mesh_line(ax, rows, 0.62, "center")
    r = np.logspace(-2.0, 12.0, 200)
    c, d = penalty_constant(rows), rounding_constant(rows)
    ax.plot(r, bound(r), color=GREY, lw=1.0, ls=":", zorder=1)
    ax.annotate(r"bound $1/(1+r)$", (1.0, 0.5), xytext=(7, 3), textcoords="offset points",
                fontsize=8, color=GREY)
    ax.plot(r[r > 1.0], c/r[r > 1.0], color=GREY, lw=1.0, zorder=1)
    ax.annotate(f"${c:.2g}/r$", (1e8, c/1e8), xytext=(-3, -3), textcoords="offset points",
                ha="right", va="top", fontsize=8, color=GREY)
    if np.isfinite(d):
        rise = r[r > 0.1*np.sqrt(c/d)]
        ax.plot(rise, d*rise, color=GREY, lw=1.0, ls="-.", zorder=1)
        ax.annotate("rounding\n" + r"$\propto r$", (1e10, d*1e10), xytext=(8, -6), fontsize=8,
                    textcoords="offset points", va="top", color=GREY)
    for method in ("penalty", "perturbed"):
        points(ax, chosen(rows, method, "condensed"), "r")
    exact = chosen(rows, "lagrange", "condensed", swept=False)
    for row in exact:
        level = max(row.error_enforcement, FLOOR)
        ax.axhline(level, color=COLOR["lagrange"], lw=1.0, zorder=2)
        ax.annotate("Lagrange (no stiffness)", (0.01, level), xycoords=("axes fraction", "data"),
                    xytext=(0, 3), textcoords="offset points", fontsize=8)
    for method in ("augmented", "penalty"):
        points(ax, chosen(rows, method, "condensed", swept=False), "r", join=False, ms=9, mew=1.6)
    failures(ax, rows, "r")
    logarithmic(ax, r"stiffness $r=\varepsilon\,s_{\min}$", "enforcement error of the pressure")
    ax.set_ylim(FLOOR*5, 8.0)


def over_augmentations(ax, rows: list[Run]) -> None:
    """Enforcement error over passes, with the lines beta^n of theory."""
    mesh_line(ax, rows, 0.99, "right")
    starts = sorted({row.r for row in rows if not np.isnan(row.tolerance)})
    for r, place in zip(starts, ((2, 30, "right"), (8, -2, "left"), (-12, -22, "left"))):
        found = augmentations(rows, r)
        if not found:
            continue
        n, error = np.array(found).T
        picked = [row for row in rows if row.method == "augmented" and row.path == "condensed"
                  and row.r == r and not np.isnan(row.tolerance)]
        points(ax, sorted(picked, key=lambda row: row.augmentations), "augmentations", join=False)
        line = np.arange(1, n.max() + 1)
        ax.plot(line, error[-1]*bound(r)**(line - n[-1]), color=GREY, lw=1.0)
        ax.annotate(f"r = {r:g}: $\\beta^n$, $\\beta$ = {bound(r):.2g}", (n[-1], error[-1]),
                    xytext=place[:2], ha=place[2], textcoords="offset points", fontsize=8,
                    color=COLOR["augmented"])
    logarithmic(ax, "augmentations n", "enforcement error of the pressure")
    ax.set_xscale("linear")
    ax.set_xlim(0.0, None)
    ax.set_ylim(1e-14, 8.0)


def over_cost(ax, rows: list[Run]) -> None:
    """Enforcement error over equivalent factorisations."""
    mesh_line(ax, rows, 0.01, "left")
    for path in LINE:
        for method in ("penalty", "perturbed"):
            points(ax, chosen(rows, method, path), "equivalent")
        passes = [row for row in rows if row.method == "augmented" and row.path == path
                  and row.r == 10.0 and not np.isnan(row.tolerance)]
        points(ax, sorted(passes, key=lambda row: row.augmentations), "equivalent")
        points(ax, chosen(rows, "lagrange", path, swept=False), "equivalent", join=False)
    failures(ax, rows, "equivalent")
    ax.axvline(1.0, color=GREY, lw=1.0, ls=":")
    logarithmic(ax, "cost [linear solves of the same mesh without contact]",
                "enforcement error of the pressure")
    ax.set_ylim(FLOOR*5, 8.0)
    biggest = max((row.equivalent for row in rows if np.isfinite(row.equivalent)), default=10.0)
    ax.set_xlim(0.7, 1.6*biggest)
    _plain_ticks(ax.xaxis, (1, 2, 3, 5, 10, 20, 30, 50, 100, 200))


def _plain_ticks(axis, values: Iterable[float]) -> None:
    from matplotlib.ticker import FixedLocator, FuncFormatter, NullFormatter

    axis.set_major_locator(FixedLocator(values))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(NullFormatter())


#: Curves of the mesh panel: method, path, r (None: the default), label.
MESH_CURVES = (("lagrange", "condensed", None), ("lagrange", "newton", None),
               ("penalty", "condensed", None), ("penalty", "condensed", 10.0),
               ("penalty", "condensed", 1.0), ("augmented", "newton", None))


def over_time(ax, rows: list[Run]) -> None:
    """Total error over wall time, mesh after mesh; bars are where the edge falls in a facet."""
    for method, path, r in MESH_CURVES:
        found = medians(rows, lambda row, m=method, p=path, r=r: row.method == m and row.path == p
                        and (row.default if r is None else row.r == r))
        if not found:
            continue
        middle = [m[0] for m in found]
        time = np.array([row.wall_s for row in middle])
        points(ax, middle, "wall_s", "error_total")
        if method == "lagrange" and path == "condensed":
            _, low, mid, high = zip(*found)
            ax.errorbar(time, mid, [np.subtract(mid, low), np.subtract(high, mid)], fmt="none",
                        color=GREY, lw=1.0, capsize=2, zorder=1)
            order = slope([row.h for row in middle], mid)
            ax.annotate(f"$h^{{{order:.2f}}}$", (time[1], mid[1]), xytext=(-6, -10), ha="right",
                        textcoords="offset points", fontsize=9)
        if r is not None:
            ax.annotate(f"r = {r:g}", (time[-1], found[-1][2]), xytext=(6, -3), fontsize=8,
                        textcoords="offset points", color=COLOR[method])
    logarithmic(ax, "wall time of the whole run [s]; finer meshes to the right",
                "total error against Hertz")
    _plain_ticks(ax.xaxis, [m*10.0**k for k in range(-4, 4) for m in (1, 3)])
    _plain_ticks(ax.yaxis, [m*10.0**k for k in range(-6, 2) for m in (1, 3)])
