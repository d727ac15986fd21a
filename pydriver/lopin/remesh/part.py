"""A part of a run: the deck that goes on where the last one ended, on the new mesh."""
from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..deck import Block, Deck, Row
from ..material_cards import word_of
from ..model_read_mesh import plain
from .body import SIMPLEX, SPRINGS, Body, DeckParts, boundary_facets
from .transfer import DAMAGE, DILATATION, FLOW, PLASTIC, RATIO, STRAIN, WORK

_MESH_CARDS = ("NODE", "ELEMENT", "NSET", "ELSET")
#: Cards of the start that the state of the last part replaces.
_START_CARDS = ("START", "INITIAL CONDITIONS", "REMESH")
#: Cards whose lines begin with names of surfaces, their TYPE, and how many names.
_OF_SURFACES = (("CONTACT PAIR", "", 2), ("MODEL CHANGE", "CONTACT PAIR", 2),
                ("INITIAL CONDITIONS", "TRACTION", 2), ("DSLOAD", "", 1))
#: Radii below this share of the size of a body are rounding of nodes on the axis.
ROUNDING = 1e-12


@dataclass
class NewMesh:
    """A new mesh of a body.

    Attributes
    ----------
    x : places (node, ndim) [length]
    cells : nodes of each group of elements (n, 3 or 4)
    facets : nodes of each facet of the skin (facet, k)
    tags : names that hold each facet
    named : rows of nodes by the name of their set, of sets that are not made of facets
    """

    x: NDArray
    cells: list[NDArray]
    facets: NDArray
    tags: list[frozenset]
    named: dict[str, NDArray] = field(default_factory=dict)


@dataclass
class SkinOrigin:
    """Where the nodes of a new skin lie on the old one.

    Attributes
    ----------
    node : rows of the new nodes (n,)
    old : rows of the old nodes of the facet that each lies on (n, k)
    weight : of these, adding up to 1 (n, k)
    """

    node: NDArray
    old: NDArray
    weight: NDArray

    def value(self, of_old: NDArray) -> NDArray:
        """Values (old node, ...) taken along."""
        return np.einsum("nk,nk...->n...", self.weight, of_old[self.old])

    def within(self, marked: NDArray) -> NDArray:
        """Whether all old nodes that count for each new one are marked."""
        return (marked[self.old] | (self.weight < 1e-9)).all(axis=1)


@dataclass
class Clock:
    """Where a run stands.

    Attributes
    ----------
    step : from 1; 0 before the first
    begun : total time where it began [time]
    time : of the step [time]
    increment : the next one [time]
    at_end : the step has ended
    number : increments of the step in this part
    """

    step: int
    begun: float
    time: float
    increment: float
    at_end: bool
    number: int

    @property
    def total(self) -> float:
        """Total time [time]."""
        return self.begun + self.time

    @classmethod
    def of(cls, session) -> Clock:
        """Of an open run."""
        step, begun, time, increment, at_end, number = map(
            float, session.field("STATE OF CLOCK")[0])
        return cls(int(step), begun, time, increment, at_end > 0.0, int(number))

    @classmethod
    def of_start(cls, deck: Deck) -> Clock:
        """Where a deck begins: its *START, or its first step."""
        if "START" not in deck:
            return cls(0, 0.0, 0.0, 0.0, False, 0)
        given = deck["START"].parameters
        return cls(int(given["STEP"]), *(float(given[k]) for k in ("BEGUN", "TIME", "INCREMENT")),
                   False, 0)


def next_deck(parts: DeckParts, body: Body, mesh: NewMesh, name: str, folder: Path,
              start: Iterable[Block]) -> Deck:
    """The deck of the next part, without *REMESH.

    Parameters
    ----------
    parts : of the last part's deck
    name, folder : of the new deck; files that the deck names are named from there
    start : cards of the state, before the first step
    """
    deck = Deck(name=name, folder=folder)
    node_label, element_label = new_labels(parts, body, mesh)
    written = False
    empty = {name for name, labels in _node_sets(parts.cards, body, mesh, node_label).items()
             if not labels}
    made = {id(b): _surface(parts, body, mesh, b, element_label, empty) for b in parts.blocks
            if b.keyword == "SURFACE"}
    gone = _gone(parts.blocks, made)
    for block in parts.blocks:
        if block.keyword in _MESH_CARDS:
            if not written:
                deck.blocks += _mesh_blocks(parts, body, mesh, node_label, element_label)
                written = True
            continue
        if block.keyword in _START_CARDS and not _is_temperature(block):
            continue
        if block.keyword == "STEP" and "STEP" not in deck:
            deck.blocks += [b for b in map(lambda b: _left(b, gone, empty), start) if b is not None]
        if block.keyword == "BOUNDARY":
            block = _kept_supports(block, empty)
        new = _left(made.get(id(block), block), gone, empty)
        if new is not None and not (id(block) in made and block.data and not new.data):
            deck.blocks.append(new)
    return deck


def _gone(blocks: list[Block], made: dict[int, Block]) -> set[str]:
    """Surfaces all of whose faces or nodes went as metal separated."""
    had: dict[str, int] = {}
    for block in blocks:
        if id(block) in made and block.data:
            name = word_of(block, "NAME")
            had[name] = had.get(name, 0) + len(made[id(block)].data)
    return {name for name, lines in had.items() if not lines}


def _left(block: Block, gone: set[str], empty: set[str]) -> Block | None:
    """A card without what it says of surfaces and sets of nodes that are gone; None if that is all
    it says."""
    named = {word_of(block, word) for word in ("SLAVE", "MASTER", "SURFACE")} & gone
    if named or word_of(block, "NSET") in empty:
        return None
    kind = word_of(block, "TYPE")
    first = next((n for word, of, n in _OF_SURFACES
                  if word == block.keyword and of in ("", kind)), 0)

    def names(row) -> set[str]:
        return {str(plain(v)).upper() for v in row[:first]}

    if not any(names(row) & gone for row in block.data):
        return block
    new = Block(block.keyword, block.parameters)
    new.lines = [row for row in block.data if not names(row) & gone]
    return new if new.lines or "OP" in new.parameters else None


def at_nodes(block: Block) -> Block:
    """A pair that says no TYPE, as all parts have it: their tractions go from node to node."""
    if block.keyword != "CONTACT PAIR" or {"TYPE", "TIED"} & set(block.parameters):
        return block
    new = Block(block.keyword, {**block.parameters, "TYPE": "NODE TO SURFACE"})
    new.lines = block.lines
    return new


def _is_temperature(block: Block) -> bool:
    """Temperatures of the start: a part begins with those too."""
    return str(plain(block.parameters.get("TYPE", ""))).upper() == "TEMPERATURE"


def _kept_supports(block: Block, empty: set[str]) -> Block:
    """A card without the lines of sets whose nodes went with a piece that came loose."""
    if not any(str(row[0]).upper() in empty for row in block.data):
        return block
    new = Block(block.keyword, block.parameters)
    new.lines = [row for row in block.data if str(row[0]).upper() not in empty]
    return new


def new_labels(parts: DeckParts, body: Body, mesh: NewMesh) -> tuple[NDArray, list[NDArray]]:
    """Labels of the new nodes and elements: from 1, or behind those that stay."""
    def start(stay, count):
        stay = sorted(stay)
        return 1 if not stay or stay[0] > count else stay[-1] + 1

    own, members = set(body.labels.tolist()), set(body.elements.tolist())
    n = sum(len(c) for c in mesh.cells)
    first = start(set(parts.cards.nodes) - own, len(mesh.x))
    element = start(set(parts.cards.elements) - members, n)
    labels, at = [], element
    for group in mesh.cells:
        labels.append(np.arange(at, at + len(group)))
        at += len(group)
    return np.arange(first, first + len(mesh.x)), labels


def places_of_deck(body: Body, mesh: NewMesh) -> NDArray:
    """Places of the nodes as a deck has them (node, ndim) [length]: those that lie on the axis but
    for rounding lie on it, as no radius may be negative."""
    if not body.axisymmetric:
        return mesh.x
    x = mesh.x.copy()
    x[np.abs(x[:, 0]) < ROUNDING*np.ptp(x, axis=0).max(), 0] = 0.0
    return x


def _mesh_blocks(parts: DeckParts, body: Body, mesh: NewMesh, node_label: NDArray,
                 element_label: list[NDArray]) -> list[Block]:
    """Nodes, elements and sets of the new deck."""
    cards, own = parts.cards, set(body.labels.tolist())
    members = set(body.elements.tolist())
    d = mesh.x.shape[1]
    rows = [[label, *x[:max(2, d)]] for label, x in cards.nodes.items() if label not in own]
    if any(row[-1] for row in ([0.0] if d == 3 else cards.nodes[r[0]][2:] for r in rows)):
        rows = [[r[0], *cards.nodes[r[0]]] for r in rows]
    blocks = [Block("NODE", {}, [[int(n), *map(float, p)] for n, p in zip(node_label,
                                                                     places_of_deck(body, mesh))]
                    + rows)]
    for group, labels in zip(mesh.cells, element_label):
        word = body.word if len(group[0]) == body.cells[0].shape[1] or d == 3 \
            else SIMPLEX[body.word]
        blocks.append(Block("ELEMENT", {"TYPE": word}, [
            [int(e), *(int(node_label[n]) for n in c)] for e, c in zip(labels, group)]))
    blocks += _springs(parts.blocks)
    for word in dict.fromkeys(w for e, (w, _) in cards.elements.items()
                              if e not in members and w not in SPRINGS):
        blocks.append(Block("ELEMENT", {"TYPE": word}, [
            [e, *nodes] for e, (w, nodes) in cards.elements.items()
            if w == word and e not in members]))
    sets = _node_sets(cards, body, mesh, node_label)
    blocks += [_set("NSET", name, labels) for name, labels in sets.items() if labels]
    everything = [int(e) for labels in element_label for e in labels]
    named = {word_of(b, "ELSET") for b in _springs(parts.blocks)}
    for name, old in cards.elsets.items():
        stay = [e for e in dict.fromkeys(old) if e not in members]
        # Part of the body: its elements are gone; sets that only name some are left out.
        labels = stay + (everything if members <= set(old) else [])
        if labels and name not in named:
            blocks.append(_set("ELSET", name, labels))
    return blocks


def _springs(blocks: list[Block]) -> list[Block]:
    """The cards of springs and gaps as they are: their sets are those of *ELEMENT itself."""
    return [b for b in blocks if b.keyword == "ELEMENT" and word_of(b, "TYPE") in SPRINGS]


def _node_sets(cards, body: Body, mesh: NewMesh, node_label: NDArray) -> dict[str, list[int]]:
    """Labels of every node set: of what stays, of facets that it held, of single nodes."""
    sets = {}
    for name in cards.nsets:
        rows = [np.asarray(mesh.named.get(name, []), int)]
        rows += [f for f, tag in zip(mesh.facets, mesh.tags) if ("N", name) in tag]
        new = np.unique(np.concatenate(rows)).astype(int)
        sets[name] = body.others.get(name, []) + [int(n) for n in node_label[new]]
    return sets


def _set(kind: str, name: str, labels: list[int]) -> Block:
    return Block(kind, {kind: name}, [labels[k:k + 16] for k in range(0, len(labels), 16)])


def _surface(parts: DeckParts, body: Body, mesh: NewMesh, block: Block,
             element_label: list[NDArray], empty: set[str] | frozenset[str] = frozenset()) -> Block:
    """A surface with its faces of the body made anew; whole sets of elements stay as they are, and
    sets of nodes that have any."""
    given = {name: plain(value) for name, value in block.parameters.items()}
    if str(given.get("TYPE", "")).upper() == "NODE":
        return _kept_supports(block, empty)
    if str(given.get("TYPE", "ELEMENT")).upper() != "ELEMENT":
        return block
    members = set(body.elements.tolist())

    def is_own(row):
        labels = [row[0]] if isinstance(row[0], int) else parts.cards.elsets[row[0].upper()]
        return bool(members & set(labels))

    def stays(row):
        whole = not isinstance(row[0], int) and members <= set(parts.cards.elsets[row[0].upper()])
        return not is_own(row) or (whole and (len(row) < 2 or row[1] is None))

    if all(stays(row) for row in block.data):
        return block
    _, owner = boundary_facets(mesh.cells, mesh.x.shape[1])
    labels = np.concatenate(element_label)
    wanted = [k for k, tag in enumerate(mesh.tags) if ("S", given["NAME"].upper()) in tag]
    new = Block(block.keyword, block.parameters)
    new.lines = [row for row in block.data if stays(row)]
    new.lines += [Row([int(labels[owner[k, 0]]), f"S{owner[k, 1]}"]) for k in wanted]
    return new


def state_block(parts: DeckParts, body: Body, mesh: NewMesh, states) -> Block:
    """*INITIAL CONDITIONS, TYPE=STATE of the new elements."""
    _, labels = new_labels(parts, body, mesh)
    rows = []
    for own, values in zip(labels, states):
        if body.word.endswith("R"):
            values = values.mean(axis=1, keepdims=True)
        for label, points in zip(own, values):
            for k, v in enumerate(points):
                numbers = [*v[STRAIN], v[DILATATION], v[RATIO], v[PLASTIC], v[FLOW], v[WORK]]
                if v[DAMAGE].any():
                    numbers += [*v[DAMAGE]]
                point = k + 1 if len(points) > 1 else 0   # all
                rows.append([int(label), point, *map(float, numbers)])
    return Block("INITIAL CONDITIONS", {"TYPE": "STATE"}, rows)
