"""The next operation on the mesh of the start: trimmed, let go of, pressed again by other tools.

Places of the start and displacements stay apart, and points keep their memory number by number:
internal modes, Hill's surface and backstress go along, which the state of `lopin.operation` cannot
take. A sheet of one layer that springs back is such a body.
"""
from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from .deck import Block, Deck, Row
from .errors import ModelError
from .job import Job
from .material_cards import before_steps, of_body, temperatures_of
from .model_read_mesh import plain
from .operation import Carried, measures_of, refuse_ended, taken_out

#: Length of the increment at rest, by the period of the step.
REST = 1e-8


def next_on_same_mesh(job: Job, elset: str, cards: str, *, name: str,
                      trim: Callable[[NDArray], NDArray] | None = None,
                      release: float = 0.0) -> tuple[Deck, Carried]:
    """The deck of the next operation, from where an open run stands.

    Parameters
    ----------
    job : open, after an accepted increment: called inside the loop over its frames
    elset : the body that goes on; its sets, surfaces, material, section and what that names keep
        their names, temperatures of the start go along
    cards : tools, interactions, contact pairs, supports and steps of the next operation. Tools
        stand where the cards put them, supports that hold a place of now say ``FIXED``
    name : of the new deck
    trim : told the present centres of the elements (element, ndim), says which are taken out
    release : time of the first step over which old tools and trimmed elements let go of the body;
        0: in its first increment
    """
    from .remesh.body import DeckParts

    refuse_ended(job)
    parts = DeckParts.of(job.deck)
    heat = next((b.keyword for b in parts.blocks if b.keyword in ("TEMPERATURE", "EXPANSION")), "")
    if heat:
        raise ModelError(f"*{heat}: heat does not go to the next operation")
    named = parts.cards
    if elset.upper() not in named.elsets:
        raise ModelError(f"there is no element set {elset}", id="E0201",
                         help=f"element sets: {', '.join(named.elsets)}")
    members = list(dict.fromkeys(named.elsets[elset.upper()]))
    if job.points is None:
        raise ModelError("the material remembers nothing that a next operation could go on with")
    motion = job._session.field("STATE OF MOTION")
    gone, volume = _gone(job, named, members, motion, trim)
    stay = {m for m, out in zip(members, gone) if not out}
    deck = Deck(name=name, folder=job.deck.folder)
    deck.blocks = _mesh(named, members, stay)
    nodes = {n for m in stay for n in named.elements[m][1]}
    for block in before_steps(parts.blocks):
        if block.keyword == "SURFACE":
            deck.blocks += _surface(block, named, stay)
    deck.blocks += of_body(parts.blocks, named, stay)
    warm = temperatures_of(parts.blocks, named, nodes)
    if warm:
        deck.blocks.append(Block("INITIAL CONDITIONS", {"TYPE": "TEMPERATURE"},
                                 [[n, t] for n, t in sorted(warm.items())]))
    deck.blocks.append(_memory(job, stay))
    own = Deck.parse(cards, name=name).blocks
    first = next((k for k, b in enumerate(own) if b.keyword == "STEP"), len(own))
    deck.blocks += [*own[:first], _start(motion, nodes, own, release), *own[first:]]
    return deck, Carried(len(stay), float(volume[~gone].sum()), int(gone.sum()),
                         float(volume[gone].sum()))


def _gone(job: Job, named, members: list[int], motion: NDArray, trim):
    """Which elements are taken out, and the present volume of each that remembers."""
    ndim = 3 if named.elements[members[0]][0].startswith("C3D") else 2
    place = {n: np.array(x[:ndim]) for n, x in named.nodes.items()}
    for label, dof, moved in motion[:, :3]:
        if dof <= ndim and int(label) in place:
            place[int(label)][int(dof) - 1] += moved
    centre = np.array([np.mean([place[n] for n in named.elements[m][1]], axis=0) for m in members])
    return taken_out(trim, centre), measures_of(job.points, members)


def _mesh(named, members: list[int], stay: set[int]) -> list[Block]:
    """Nodes at their places of the start, elements and sets of what stays."""
    known = {n for m in stay for n in named.elements[m][1]}
    nodes = [n for n in named.nodes if n in known]
    flat = not any(named.nodes[n][2] for n in nodes)
    blocks = [Block("NODE", {}, [[n, *named.nodes[n][:2 if flat else 3]] for n in nodes])]
    for word in dict.fromkeys(named.elements[m][0] for m in members if m in stay):
        blocks.append(Block("ELEMENT", {"TYPE": word}, [
            [m, *named.elements[m][1]] for m in members
            if m in stay and named.elements[m][0] == word]))
    for kind, sets, known in (("NSET", named.nsets, known), ("ELSET", named.elsets, stay)):
        for name, old in sets.items():
            labels = [n for n in dict.fromkeys(old) if n in known]
            if labels:
                blocks.append(Block(kind, {kind: name}, [labels[k:k + 16] for k in
                                                         range(0, len(labels), 16)]))
    return blocks


def _surface(block: Block, named, stay: set[int]) -> list[Block]:
    """A surface of faces without those that are gone; none if nothing of it stays."""
    if str(plain(block.parameters.get("TYPE", "ELEMENT"))).upper() != "ELEMENT":
        return []
    lines = [row for row in block.data if (row[0] in stay if isinstance(row[0], int) else
                                           stay & set(named.elsets.get(str(row[0]).upper(), [])))]
    new = Block(block.keyword, block.parameters)
    new.lines = [Row(row) for row in lines]
    return [new] if lines else []


def _memory(job: Job, stay: set[int]) -> Block:
    """*INITIAL CONDITIONS, TYPE=MEMORY."""
    table = job._session.field("STATE OF MEMORY")
    rows = [[int(row[0]), int(row[1]), *row[2:]] for row in table.tolist() if int(row[0]) in stay]
    return Block("INITIAL CONDITIONS", {"TYPE": "MEMORY"}, rows)


def _start(motion: NDArray, nodes: set[int], cards: list[Block], release: float) -> Block:
    """*START at the beginning of the first step, with what has moved."""
    period = next((float(b.data[0][1]) for b in cards if b.keyword == "STATIC" and b.data
                   and len(b.data[0]) > 1 and b.data[0][1] is not None), 1.0)
    rows = [[int(label), int(dof), moved, moved] for label, dof, moved in motion[:, :3].tolist()
            if int(label) in nodes and moved]
    fades = {"RELEASE": release} if release > 0.0 else {}
    return Block("START", {"STEP": 1, "TIME": 0.0, "REST": REST*period, **fades}, rows)
