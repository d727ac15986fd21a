"""When a mesh is made anew: reasons in words, empty where there is none."""
from __future__ import annotations

import numpy as np

from .body import Body
from .card import RemeshCard
from .part import Clock
from .plane import worst_corner
from .sizes import COARSER, NEAR_FRACTURE
from .state import Snapshot
from .tools import Tools

#: Increments of a part before the next remesh, the one at rest not counted.
PATIENCE = 3
#: Edges from which on a new mesh halves how deep their middles are, by the smallest size: depth
#: goes by the square of the length, and a new edge is up to sqrt(2) sizes long.
REFINED = 2.0
#: The next increment, beside those of the part so far and beside the way of the step so far, from
#: which on a run has come to a standstill.
STALLED, CREEPS = 1.0/8.0, 1.0/4000.0


def reason_to_remesh(body: Body, card: RemeshCard, plastic: dict[int, float], began: Clock,
                     now: Snapshot, tools: Tools, first_quality: float,
                     settles: float = 0.0) -> str:
    """Why the mesh should be made anew, or nothing.

    Parameters
    ----------
    plastic : accumulated strain of each element where the part began
    began : where that was
    first_quality : worst corner of the mesh there
    settles : time over which the mesh is pressed out of the tools [time]
    """
    if now.clock.number <= PATIENCE:
        return ""
    worst = worst_corner(now.x, body.cells)
    simplices = body.cells[0].shape[1] == body.ndim + 1
    bound = min(2.0*card.quality, 0.5*first_quality) if simplices else card.quality
    if worst < min(bound, 0.8*first_quality):
        return f"worst corner {worst:.3f} below {bound:.3f}"
    passed = now.clock.total - began.total
    deep = deepest(body, now, tools, REFINED*card.smallest) if passed >= settles else 0.0
    if deep > card.penetration:
        return f"an edge {deep:.3f} of its length inside a tool"
    own = np.isin(now.points.element, body.elements)
    before = np.array([plastic.get(int(e), 0.0) for e in now.points.element[own]])
    strain = float((now.points.plastic[own] - before).max())
    if strain > card.strain:
        return f"plastic strain {strain:.2f} since the last mesh"
    coarse = coarse_near_fracture(body, now, card)
    if coarse:
        return coarse
    if card.period and passed >= card.period*(1.0 - 1e-9):
        return f"time {passed:g} since the last mesh"
    usual = passed/now.clock.number
    if now.clock.increment < STALLED*usual:
        return f"increments of {now.clock.increment:.2g} where {usual:.2g} was usual on this mesh"
    grows = 0.0 < began.increment < now.clock.increment
    if now.clock.increment < CREEPS*now.clock.time and not grows:
        return f"increments of {now.clock.increment:.2g} at the time {now.clock.time:.3g}"
    return ""


def coarse_near_fracture(body: Body, now: Snapshot, card: RemeshCard) -> str:
    """Whether elements near a critical damage are longer than those of a cut are to be."""
    if not card.cuts:
        return ""
    length = np.concatenate([np.linalg.norm(now.x[g] - now.x[np.roll(g, 1, axis=1)], axis=2)
                             .mean(axis=1) for g in body.cells])
    at = {int(label): k for k, label in enumerate(body.elements)}
    row = np.array([at.get(int(label), -1) for label in now.points.element])
    for column, critical, cell in card.cuts:
        near = row[(row >= 0) & (now.points.damage_mean[:, column] >= NEAR_FRACTURE*critical)]
        bound = COARSER*max(cell, card.smallest)
        if len(near) and length[near].max() > bound:
            return f"edges of {length[near].max():.2g} where a cut comes near, beyond {bound:.2g}"
    return ""


def deepest(body: Body, now: Snapshot, tools: Tools, least: float = 0.0) -> float:
    """How far the middle of a facet is inside a tool, by the length of the facet.

    Facets up to `least` [length] do not count: a new mesh would hardly make them finer.
    """
    most = 0.0
    for rows, feet in tools.feet_of_facets(now.x, body.facets, body.tags):
        corner = now.x[body.facets[rows]]
        length = np.linalg.norm(corner - np.roll(corner, 1, axis=1), axis=2).max(axis=1)
        inside = (feet[:, 0] < 0.0) & (feet[:, 0] > -length) & (feet[:, 1] <= 0.0)
        inside &= length > least
        most = max(most, float((-feet[inside, 0]/length[inside]).max(initial=0.0)))
    return most
