"""What theory says of the chart, and what a sweep measured: constants, slopes, crossings."""
from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..laws import METHODS
from .run import Run


def bound(r: ArrayLike) -> NDArray:
    """Largest relative error of a penalty: what is missing of the stiffest mode of pressure."""
    return 1.0/(1.0 + np.asarray(r, float))


def stiffness_curve(rows: list[Run], method: str, path: str) -> tuple[NDArray, NDArray]:
    """r and enforcement error of one method in order of r."""
    points = sorted((r.r, r.error_enforcement) for r in rows if r.method == method
                    and r.path == path and not r.default and not r.failure)
    return np.array([p[0] for p in points]), np.array([p[1] for p in points])


def penalty_constant(rows: list[Run]) -> float:
    """C of the enforcement error C/r, from the perturbed method where it has a slope of -1."""
    r, error = stiffness_curve(rows, "perturbed", "condensed")
    use = (r >= 1e2) & (error > 1e-12)
    return float(np.median(r[use]*error[use])) if use.any() else np.nan


def rounding_constant(rows: list[Run], path: str = "condensed") -> float:
    """D of the rounding error D r of the penalty matrix, where that is what is left."""
    r, error = stiffness_curve(rows, "penalty", path)
    use = error > 10.0*penalty_constant(rows)/r
    return float(np.exp(np.mean(np.log(error[use]/r[use])))) if use.any() else np.nan


def slope(x: ArrayLike, y: ArrayLike) -> float:
    """Slope of a straight line through points on logarithmic axes."""
    x, y = np.log(np.asarray(x, float)), np.log(np.asarray(y, float))
    return float(np.polyfit(x, y, 1)[0]) if len(x) > 1 else np.nan


def contraction(rows: list[Run], r: float) -> float:
    """What each augmentation leaves of the error at stiffness r, over the last ones measured."""
    points = augmentations(rows, r)
    last = [p for p in points if p[1] < 1e-2][-6:]
    if len(last) < 2:
        return np.nan
    n, error = np.array(last).T
    return float(np.exp(np.polyfit(n, np.log(error), 1)[0]))


def augmentations(rows: list[Run], r: float, path: str = "condensed") -> list[tuple[int, float]]:
    """(number of passes, enforcement error) of the augmented method at stiffness r."""
    return sorted((row.augmentations, row.error_enforcement) for row in rows
                  if row.method == "augmented" and row.path == path and row.r == r
                  and not np.isnan(row.tolerance) and not row.failure)


def medians(rows: list[Run], pick) -> list[tuple[Run, float, float, float]]:
    """Of each mesh: the row of median total error and the least time of its shifts, and the least,
    median and largest total error."""
    meshes: dict[str, list[Run]] = {}
    for row in filter(pick, rows):
        meshes.setdefault(row.case, []).append(row)
    out = []
    for group in meshes.values():
        error = np.array([row.error_total for row in group])
        middle = group[int(np.argsort(error)[len(error)//2])]
        middle = replace(middle, wall_s=min(row.wall_s for row in group))
        out.append((middle, error.min(), float(np.median(error)), error.max()))
    return out


def facts(name: str, rows: dict[str, list[Run]]) -> list[str]:
    """The numbers of one scene, as sentences."""
    sweep, lines = rows["sweep"], []
    c, d = penalty_constant(sweep), rounding_constant(sweep)
    r, error = stiffness_curve(sweep, "perturbed", "condensed")
    lines.append(f"penalty and perturbed: enforcement error {c:.3g}/r; slope "
                 f"{slope(r[r >= 100.0], error[r >= 100.0]):.3f} from r = 100 to {r.max():.0e}")
    lines.append(f"rounding of the penalty matrix: {d:.2g} r, smallest error "
                 f"{2.0*np.sqrt(c*d):.1e} near r = {np.sqrt(c/d):.0e}")
    for start in sorted({row.r for row in sweep if not np.isnan(row.tolerance)}):
        rate = contraction(sweep, start)
        lines.append(f"augmented, r = {start:g}: each pass leaves {rate:.4f} of the error "
                     f"(theory: at most {bound(start):.4f})")
    lines += [_cost(sweep, method, path) for method in METHODS for path in ("condensed", "newton")]
    exact = medians(rows["meshes"],
                    lambda row: row.method == "lagrange" and row.path == "condensed")
    if exact:
        lines.append(f"meshes: total error of the exact method falls as h^"
                     f"{slope([m[0].h for m in exact], [m[2] for m in exact]):.2f}")
    everything = sweep + rows["meshes"]
    failed, silent = (sum(map(f, everything)) for f in (lambda r: bool(r.failure),
                                                        lambda r: r.silent))
    lines.append(f"{len(everything)} runs, {failed} without an answer, {silent} wrong by more than "
                 "5 % and silent")
    return [f"{name}: {line}" for line in lines]


def _cost(rows: list[Run], method: str, path: str) -> str:
    """Cost of a method left to its defaults."""
    for row in rows:
        if row.method == method and row.path == path and row.default and not row.failure:
            return (f"{method}, {path}: {row.equivalent:.2f} equivalent factorisations "
                    f"({row.factorisations} factorisations, {row.back_solves} back-solves, "
                    f"{row.wall_s*1e3:.0f} ms), enforcement error {row.error_enforcement:.1e}")
    return f"{method}, {path}: no answer"
