"""The error that a mesh leaves, from the runs on it and on coarser ones."""
from __future__ import annotations

import math

#: Orders of the error's fall that are believed: of linear elements, of quadratic ones.
LEAST_ORDER, MOST_ORDER = 0.5, {False: 2.0, True: 3.0}
#: What factors and sums leave of any number, beside it.
ROUNDING = 1e-10
#: An order so far above the most is that of no fall.
CHANCE = 0.3
#: On what three meshes say: the order still changes (Roache 1994).
SAFETY = 1.25
#: Changes of a largest pressure fall if they come to this share of the one before, at most.
FALLS = 0.8
#: Where a largest pressure is.
INSIDE, END = "inside", "at an end"
#: A dual problem is believed where it foretold the change from mesh to mesh by these factors.
FORETOLD = 0.5, 2.0


def error_of_mesh(levels, quadratic: bool, in_space: bool = False, pressure: bool = False,
                  rough: bool = False, peak: str = "") -> tuple[float, float, bool]:
    """Of the last of some levels: absolute error, measured order (nan: none), by the dual problem.

    Two meshes, every cell halved: their difference, which holds if the error falls at least as the
    size of cells; of a `pressure`, whose error at the edge of contact falls as that and hangs on
    where the edge lies in its facet, by Roache's safety more. Three: with the order of its fall and
    the safety of Roache's index; an order that the elements cannot have is a chance of coarse
    meshes, and the size of cells is believed. What the dual problem says is taken where it foretold
    the last change by half and twice; what it did not foretell of that is added, or what it is not
    sure of. Elsewhere the larger of both, in the plane: a difference of two meshes may vanish by
    chance (in space the dual problem says many times too much). Nothing is known (inf) of a mesh
    that was refined in part where the dual problem fails. `rough`: of the order no more is believed
    than the least, as of a pressure that grows beside a support. `peak`: of a largest pressure
    inside of contact, or at an end of a surface that may have none (`_of_peak`).
    """
    if len(levels) < 2:
        return math.inf, math.nan, False
    known = halved(levels)
    if peak and known:
        error, order = _of_peak([v.difference for v in known], abs(known[-1].value),
                                LEAST_ORDER if rough else MOST_ORDER[quadratic], peak == END)
    else:
        error, order = _by_differences(known, quadratic, pressure, rough)
    last, before = levels[-1], levels[-2]
    floor = ROUNDING*abs(last.value)
    foretold = before.foretold - last.foretold
    if math.isnan(foretold):
        return error + floor, order, False
    if not last.uniform and abs(last.foretold) > abs(before.foretold):
        return math.inf, math.nan, False   # hanging nodes did harm, as in a layer that bends
    share = foretold/last.change if last.change else math.inf
    if not FORETOLD[0] <= share <= FORETOLD[1]:
        doubt = 0.0 if in_space else abs(last.foretold) + last.unsure
        return max(error, doubt) + floor, order, False
    unsure = max(last.unsure, abs(last.change - foretold))
    return abs(last.foretold) + unsure + floor, order, True


def halved(levels) -> list:
    """The last levels for which every cell of the one before was halved, on the same increments."""
    found = []
    for level in reversed(levels):
        if math.isnan(level.difference) or not level.uniform:
            break
        found.insert(0, level)
    return found


def _of_peak(apart: list[float], value: float, most: float, at_end: bool) -> tuple[float, float]:
    """Of a largest pressure, by its changes from mesh to mesh, and their order.

    Where it lies among the nodes is chance on coarse meshes, and its error falls as the size of
    cells or slower. One change: the least order counts; at a free end of a surface nothing is known
    of it. Two: their order, but no less than if the first had fallen by half; three: the smaller of
    two orders. Changes that hardly fall (`FALLS`) say nothing yet.
    """
    if apart[-1] <= ROUNDING*value:
        return apart[-1], math.nan
    if len(apart) == 1:
        return math.inf if at_end else apart[0]/(2.0**LEAST_ORDER - 1.0), math.nan
    orders = [math.log2(max(a/max(b, 1e-300), 1e-3)) for a, b in zip(apart, apart[1:])]
    if apart[-1] > FALLS*apart[-2]:
        return math.inf, orders[-1]
    order = min(max(min(orders[-2:]), LEAST_ORDER), most)
    error = SAFETY*apart[-1]/(2.0**order - 1.0)
    return max(error, 0.5*apart[-2]) if len(orders) == 1 else error, orders[-1]


def _by_differences(known, quadratic: bool, pressure: bool, rough: bool) -> tuple[float, float]:
    if not known:
        return math.inf, math.nan
    apart, changes = [v.difference for v in known], [v.change for v in known]
    if len(apart) == 1:
        share = 2.0**LEAST_ORDER - 1.0 if rough else 1.0/SAFETY if pressure else 1.0
        return apart[0]/share, math.nan
    if changes[-1]*changes[-2] < 0.0:
        # Changes to and fro have no order: the answer may be off by as much as they are.
        return max(apart[-2:]), math.nan
    order = math.log2(max(apart[-2]/max(apart[-1], 1e-300), 1e-3))
    most = LEAST_ORDER if rough else MOST_ORDER[quadratic]
    if order > MOST_ORDER[quadratic] + CHANCE:
        # A change that all but vanishes by chance: as if the one before had fallen by half.
        return max(apart[-1], 0.5*apart[-2]), order
    return SAFETY*apart[-1]/(2.0**min(max(order, LEAST_ORDER), most) - 1.0), order
