"""The next operation: the metal of an open run as the deck of another one, trimmed if asked.

The mesh stands in its present shape, the state of its points goes along to the last bit, tools,
supports and steps are new. Trimming takes out the elements beyond a plane or curve; what they held
is let go of in the first increment.
"""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .deck import Block, Deck
from .errors import ModelError
from .job import Job
from .model_read_mesh import plain

#: Cards of a material that go along; *DAMAGE goes on to count.
_OF_MATERIAL = ("MATERIAL", "ELASTIC", "PLASTIC", "VISCOPLASTIC", "DENSITY", "DAMAGE", "EXPANSION",
                "CONDUCTIVITY", "SPECIFIC HEAT", "POTENTIAL", "SOLID SECTION")


@dataclass
class Carried:
    """What went on, and what was taken out.

    Attributes
    ----------
    elements, volume : that go on [length^3]
    gone, gone_volume : taken out [length^3]
    """

    elements: int
    volume: float
    gone: int
    gone_volume: float

    def line(self) -> str:
        """For a terminal."""
        share = self.gone_volume/(self.volume + self.gone_volume)
        return (f"{self.elements} elements of {self.volume:.6g} go on; trimmed: {self.gone} of "
                f"{self.gone_volume:.6g}, {100*share:.3g} % of the volume")


def beyond_plane(point, normal) -> Callable[[NDArray], NDArray]:
    """A cut by a plane: what lies on the side that the normal points to.

    >>> beyond_plane((1.0, 0.0), (1.0, 0.0))(np.array([[0.5, 3.0], [1.5, 3.0]])).tolist()
    [False, True]
    """
    point, normal = np.asarray(point, float), np.asarray(normal, float)
    return lambda places: (places - point) @ normal > 0.0


def next_operation(job: Job, elset: str, cards: str, *, name: str,
                   trim: Callable[[NDArray], NDArray] | None = None) -> tuple[Deck, Carried]:
    """The deck of the next operation, from where an open run stands.

    Parameters
    ----------
    job : open, after an accepted increment
    elset : the body that goes on; its sets, surfaces, material and section keep their names
    cards : tools, interactions, contact pairs, supports and steps of the next operation
    name : of the new deck
    trim : told the present centres of the elements (element, ndim), says which are taken out
    """
    from .remesh.body import DeckParts, read_body
    from .remesh.part import _mesh_blocks, _surface, new_labels
    from .remesh.remake import state_block
    from .remesh.separate import counted, rows_of, states_of_rest, without
    from .remesh.state import Snapshot

    parts = DeckParts.of(job.deck)
    body = read_body(parts, elset.upper())
    last = Snapshot.of(job, body)
    centre = np.concatenate([last.x[group].mean(axis=1) for group in body.cells])
    gone = np.zeros(len(body.elements), bool) if trim is None else np.asarray(trim(centre), bool)
    if gone.all():
        raise ModelError("the cut takes all elements out", help="the other side of it stays")
    row, states = rows_of(body, last.points), states_of_rest(body, last.points, gone)
    mesh, _ = without(body, last.x, gone)
    own, members = set(body.labels.tolist()), set(body.elements.tolist())
    named = parts.cards
    named.nodes = {n: x for n, x in named.nodes.items() if n in own}
    named.elements = {e: c for e, c in named.elements.items() if e in members}
    named.elsets = {k: v for k, v in named.elsets.items() if members & set(v)}
    body.others = {}
    node_label, element_label = new_labels(parts, body, mesh)
    deck = Deck(name=name, folder=job.deck.folder)
    deck.blocks = _mesh_blocks(parts, body, mesh, node_label, element_label)
    for block in parts.blocks:
        if block.keyword == "STEP":
            break
        if block.keyword in _OF_MATERIAL and _is_of(block, named):
            deck.blocks.append(counted(block))
        elif block.keyword == "SURFACE" and _of_faces(block, named):
            deck.blocks.append(_surface(parts, body, mesh, block, element_label))
    deck.blocks.append(state_block(parts, body, mesh, states))
    deck.blocks += Deck.parse(cards, name=name).blocks
    inside = row >= 0
    inside[inside] = gone[row[inside]]
    volume = last.points.volume
    return deck, Carried(int((~gone).sum()), float(volume[(row >= 0) & ~inside].sum()),
                         int(gone.sum()), float(volume[inside].sum()))


def _is_of(block: Block, named) -> bool:
    """Whether a card of materials or sections is for what goes on."""
    return block.keyword != "SOLID SECTION" or \
        str(plain(block.parameters["ELSET"])).upper() in named.elsets


def _of_faces(block: Block, named) -> bool:
    """Whether a surface is one of faces of the body."""
    kind = str(plain(block.parameters.get("TYPE", "ELEMENT"))).upper()
    if kind != "ELEMENT":
        return False
    return any(row[0] in named.elements if isinstance(row[0], int) else
               str(row[0]).upper() in named.elsets for row in block.data)
