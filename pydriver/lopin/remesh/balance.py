"""Stresses on a new mesh in balance with what the body bears, before it meets its tools again.

Means over cells leave stresses out of balance. An increment at rest alone would take that up by the
tools, which stand: a wall that bends loses its force with them. What is known of the balance is the
forces on the skin: they are put on the new one, and the linear elastic stresses that balance them
are added, while the nodes stay. Of all fields in balance with these forces that is the closest in
elastic energy to the one that was carried over, and so closer than that to the one that was there.
"""
from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..deck import Block, Deck
from ..errors import LopinError
from ..job import Job
from ..model_read_mesh import plain
from ..points import Points
from .body import SIMPLEX, Body, DeckParts, inclined, pair_names, period_of, supports
from .loads import loads_of
from .masters import is_of_facets
from .part import NewMesh, new_labels, places_of_deck, state_block
from .state import Snapshot
from .tools import Tools
from .transfer import DILATATION, STRAIN, admissible, equivalent, highest_strain

#: Loads that leave more than this share of themselves unbalanced are not put on.
UNBALANCED = 0.1
#: Changes below this share of the strains are what loads on another skin are known to.
SLIGHT = 0.01
#: Elastic energy of deviators by that before, above which the new mesh is too coarse to bear the
#: loads, or forces of the two sides of a fold do not match.
WILD = 2.0
#: Cards of a material, and those by which its stress depends on the rate.
OF_MATERIAL = ("MATERIAL", "ELASTIC", "PLASTIC", "VISCOPLASTIC", "RATE DEPENDENT")
RATES = ("VISCOPLASTIC", "RATE DEPENDENT")
#: Cards that press or hold the body other than by contacts and *BOUNDARY.
_LOADS = ("DSLOAD", "FOUNDATION")
#: How often metal that is taken back to its yield stress is balanced again, until no point is
#: beyond it by more than this share.
PASSES, FLOWS = 4, 0.02
TINY = np.finfo(float).tiny
#: Yield stress, by Young's modulus, of metal that stays elastic.
ELASTIC = 1e6


def rigid_motions(x: NDArray, axisymmetric: bool) -> NDArray:
    """Motions that strain nothing (motion, node, ndim)."""
    n, d = x.shape
    if axisymmetric:
        return np.broadcast_to(np.array([0.0, 1.0]), (1, n, 2)).copy()
    arm = x - x.mean(axis=0)
    shifts = [np.broadcast_to(axis, (n, d)) for axis in np.eye(d)]
    turns = [np.stack([-arm[:, 1], arm[:, 0]], axis=1)] if d == 2 else \
        [np.cross(axis, arm) for axis in np.eye(3)]
    return np.array([*shifts, *(t/max(np.ptp(x), TINY) for t in turns)])


def free_motions(x: NDArray, held: NDArray, axisymmetric: bool) -> NDArray:
    """Motions that strain nothing and that no support holds (motion, node, ndim). `held`: degrees
    of freedom that are (node, ndim)."""
    motions = rigid_motions(x, axisymmetric)
    at = motions[:, held]
    if at.size == 0:
        return motions
    u, s, _ = np.linalg.svd(at, full_matrices=True)
    rank = int((s > 1e-6*max(s.max(), TINY)).sum())
    return np.tensordot(u[:, rank:].T, motions, axes=1)


def made_even(force: NDArray, free: NDArray) -> tuple[NDArray, float]:
    """Forces (node, ndim) without work on free motions, by the least change where they act, and
    the share of them that was changed."""
    if not len(free):
        return force, 0.0
    flat, work = free.reshape(len(free), -1), np.tensordot(free, force, axes=2)
    weight = np.repeat(np.linalg.norm(force, axis=1), force.shape[1])
    square = (flat*weight) @ flat.T
    change = (weight*(np.linalg.lstsq(square, work, rcond=1e-10)[0] @ flat)).reshape(force.shape)
    size = np.abs(force).sum()
    return force - change, float(np.abs(change).sum()/max(size, TINY))


def pinned(free: NDArray) -> list[tuple[int, int]]:
    """Degrees of freedom (node, direction) that hold free motions, one for each."""
    left, found = free.reshape(len(free), free[0].size if len(free) else 0).copy(), []
    for _ in range(len(free)):
        k = int(np.argmax((left**2).sum(axis=0)))
        column = left[:, k]/np.linalg.norm(left[:, k])
        left -= np.outer(column, column @ left)
        found.append((k//free.shape[2], k % free.shape[2]))
    return found


def in_balance(parts: DeckParts, body: Body, mesh: NewMesh, states, weights, last: Snapshot,
               tools: Tools, folder: Path):
    """The states (element, point, field) of each group in balance with the forces of the contacts,
    how far points are beyond the yield surface then, relative, and why they are not in balance,
    in words, if they are not. `weights`: their volumes.

    Metal that does not depend on the rate cannot bear more than its yield stress: it is taken back
    to that, and balanced again, a few times. Of metal that does, what is beyond relaxes by itself.
    Foundations, pressures beside contacts, and other bodies, whose nodes press it unevenly, leave
    the states as they are.
    """
    highest = highest_strain(last.points)
    load, why = _load(parts, body, mesh, last, tools)
    if why:
        return *_taken_back(states, highest), why
    flows, old = depends_on_rate(parts, body), last.points.within(body.elements)
    before = _energy([old.strain], [old.volume])/depth_of(parts, body)
    for done in range(1 if flows else PASSES):
        found = _balanced(parts, body, mesh, states, *load, folder)
        if found is None:
            why = "no elastic stresses balance the forces"
        elif _energy(found, weights) > WILD*before:
            why = "the mesh is too coarse to bear the forces elastically"
        if why or _change(states, found) < SLIGHT:
            break   # what earlier passes have put on stays
        if flows:
            return found, _taken_back(found, highest)[1], ""
        states, over = _taken_back(found, highest)
        if max(float(o.max()) for o in over) < FLOWS:
            return states, over, ""
    return *_taken_back(states, highest), "" if done else why


def _change(old, new) -> float:
    """How much the elastic strains differ, by their size."""
    def square(s):
        return float((equivalent(s[..., STRAIN])**2 + s[..., DILATATION]**2).sum())

    size = sum(map(square, old))
    return float(np.sqrt(sum(square(b - a) for a, b in zip(old, new))/max(size, TINY)))


def _energy(states, volume) -> float:
    """Integral of the square of the deviators of elastic strains, which come first."""
    return sum(float((equivalent(s[..., :6])**2*v).sum()) for s, v in zip(states, volume))


def _taken_back(states, highest: float):
    states, over = zip(*(admissible(s, highest) for s in states))
    return states, over


def _load(parts: DeckParts, body: Body, mesh: NewMesh, last: Snapshot, tools: Tools):
    """Forces on the nodes of the new skin and degrees of freedom that are held (node, ndim), or why
    there are none, in words."""
    if any(b.keyword in _LOADS for b in parts.blocks):
        return None, "springs or loads act beside contacts"
    if meets_bodies(parts, body):
        return None, "it meets another body"
    old = NewMesh(last.x, body.cells, body.facets, body.tags, body.named)
    step = last.clock.step
    if inclined(parts, old, step):
        return None, "supports hold it along inclined axes (*TRANSFORM)"
    if is_rigid(parts, body):
        return None, "rigid metal has no elastic stresses"
    force = loads_of(body, mesh, last, supports(parts, old, step), tools,
                     1.0 - min(1.0, last.clock.time/max(period_of(parts, step), TINY)))
    if force is None:
        return None, "its forces on the skin are not known"
    held = supports(parts, mesh, step)
    free = free_motions(mesh.x, held, body.axisymmetric)
    force, share = made_even(force, free)
    if share > UNBALANCED:
        return None, "its forces do not balance one another"
    for node, axis in pinned(free):
        held[node, axis] = True
    force[held] = 0.0
    return (force, held), ""


def meets_bodies(parts: DeckParts, body: Body) -> bool:
    """Whether a contact pair has the body and another one that deforms."""
    own = {name for tag in body.tags for kind, name in tag if kind == "S"}
    faces = {name for name, rows in parts.cards.surfaces.items() if rows
             and not is_of_facets(parts.cards, rows)}
    return any(len(names & faces) == 2 and names & own for b in parts.blocks
               if b.keyword == "CONTACT PAIR" for names in map(set, map(pair_names, b.data)))


def _balanced(parts: DeckParts, body: Body, mesh: NewMesh, states, force: NDArray, held: NDArray,
              folder: Path):
    """The states with linear elastic stresses that balance the forces; None where none do."""
    try:
        with Job(_deck(parts, body, mesh, states, force, held, folder)) as job:
            job.advance()
            return _with_strains(states, job.points)
    except LopinError:
        return None


def _with_strains(states, points: Points):
    """States with the elastic strains of points, whose elements come in the same order; where an
    element has more points than its state, with their means."""
    order = np.lexsort((points.number, points.element))
    found = np.column_stack([points.strain, points.dilatation])[order]
    count = np.unique(points.element, return_counts=True)[1]
    new, element, at = [], 0, 0
    for own in states:
        n = int(count[element])
        rows = found[at:at + n*len(own)].reshape(len(own), n, 7)
        if n != own.shape[1]:
            rows = np.broadcast_to(rows.mean(axis=1, keepdims=True), (*own.shape[:2], 7))
        own = own.copy()
        own[..., STRAIN], own[..., DILATATION] = rows[..., :6], rows[..., 6]
        new.append(own)
        element, at = element + len(own), at + n*len(own)
    return new


def _deck(parts: DeckParts, body: Body, mesh: NewMesh, states, force: NDArray, held: NDArray,
          folder: Path) -> Deck:
    """The body alone, elastic, with the forces of its contacts as loads: one increment."""
    node, element = new_labels(parts, body, mesh)
    deck = Deck(name="balance", folder=folder)
    deck.blocks.append(Block("NODE", {}, [[int(n), *map(float, x)] for n, x in
                                          zip(node, places_of_deck(body, mesh))]))
    for group, labels in zip(mesh.cells, element):
        word = body.word if len(group[0]) == body.cells[0].shape[1] else SIMPLEX[body.word]
        deck.blocks.append(Block("ELEMENT", {"TYPE": word, "ELSET": body.elset}, [
            [int(e), *(int(node[n]) for n in c)] for e, c in zip(labels, group)]))
    deck.blocks += _elastic(parts, body)
    deck.blocks.append(state_block(parts, body, mesh, states))
    deck.blocks.append(Block("BOUNDARY", {}, [[int(node[n]), int(k) + 1]
                                              for n, k in zip(*np.nonzero(held))]))
    deck.blocks += [Block("STEP", {"NLGEOM": None}),
                    Block("STATIC", {"DIRECT": None}, [[1.0, 1.0]]),
                    Block("CLOAD", {}, [[int(node[n]), int(k) + 1, float(force[n, k])]
                                        for n, k in zip(*np.nonzero(force))]),
                    Block("END STEP")]
    return deck


def section_of(parts: DeckParts, body: Body) -> tuple[Block, list[Block]]:
    """Section of the body, and the cards of its material."""
    cards, members = parts.cards, set(body.elements.tolist())
    section = next(b for b in parts.blocks if b.keyword == "SOLID SECTION" and
                   members & set(cards.elsets.get(str(plain(b.parameters["ELSET"])).upper(), [])))
    name, of, own = str(plain(section.parameters["MATERIAL"])).upper(), "", []
    for block in parts.blocks:
        if block.keyword == "MATERIAL":
            of = str(plain(block.parameters["NAME"])).upper()
        if of == name and block.keyword in OF_MATERIAL:
            own.append(block)
    return section, own


def depth_of(parts: DeckParts, body: Body) -> float:
    """Volume of a cell by its area: all round an axis, or the thickness of the section; in space
    volumes are what they are."""
    if body.axisymmetric or body.ndim == 3:
        return 2.0*np.pi if body.axisymmetric else 1.0
    given = [row[0] for row in section_of(parts, body)[0].data if row and row[0] is not None]
    return float(given[0]) if given else 1.0


def elasticity(parts: DeckParts, body: Body) -> tuple[float, float]:
    """Young's modulus [stress] and Poisson's ratio; none where rigid metal has no such card."""
    cards = [b for b in section_of(parts, body)[1] if b.keyword == "ELASTIC"]
    return (float(cards[0].data[0][0]), float(cards[0].data[0][1] or 0.0)) if cards else (0.0, 0.0)


def depends_on_rate(parts: DeckParts, body: Body) -> bool:
    """Whether the stress of the body's metal does."""
    return any(b.keyword in RATES for b in section_of(parts, body)[1])


def is_rigid(parts: DeckParts, body: Body) -> bool:
    """Whether the body's metal only flows: its deviators come from the rate alone."""
    return any("RIGID" in b.parameters for b in section_of(parts, body)[1])


def _elastic(parts: DeckParts, body: Body) -> list[Block]:
    """Section and material of the body, which does not flow."""
    section, material = section_of(parts, body)
    blocks = [b for b in parts.blocks if b.keyword in ("SECTION CONTROLS", "ORIENTATION")]
    blocks += [b for b in material if b.keyword in ("MATERIAL", "ELASTIC")]
    blocks.append(Block("PLASTIC", {}, [[ELASTIC*elasticity(parts, body)[0], 0.0]]))
    return [*blocks, Block("SOLID SECTION", {**section.parameters, "ELSET": body.elset},
                           section.data)]
