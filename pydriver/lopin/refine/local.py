"""A plane deck with some of its cells cut in half along each edge.

A node in the middle of an edge that the cell beyond still has whole hangs there: *EQUATION holds it
where that cell's own displacement is, so that nothing opens and a uniform state stays uniform. No
other cells are needed, every element keeps its word, and a boundary edge, which has one cell, never
has such a node: surfaces of contact are what they are on a mesh that is refined everywhere.
Neighbours differ by one halving at most.
"""
from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ..deck import Block, Deck
from ..errors import ModelError
from ..mesh.cells import CELLS
from ..model_read_mesh import MeshCards, expanded, plain
from ..turned_axes import axes_at
from .children import cell_of, children
from .subdivide import Cut, Refined, made

#: Places on an edge in 64ths from its first end, and what the nodes of the coarse edge (two ends,
#: its middle where it has one) have there.
_LINEAR = {32: (0.5, 0.5)}
_QUADRATIC = {16: (0.375, -0.125, 0.75), 48: (-0.125, 0.375, 0.75)}


#: Cosines of less are of axes at right angles.
ROUNDING = 1e-12


@dataclass
class Hanging:
    """A node on an edge of a coarser cell."""

    node: int
    element: int                #: the coarser cell
    ends: tuple[int, int]
    masters: tuple[int, ...]    #: nodes of the coarse edge
    weights: tuple[float, ...]


@dataclass
class LocalMesh:
    """A deck that is refined where it is asked for.

    Attributes
    ----------
    open : the deck without the equations of hanging nodes
    known : labels of the nodes that cuts made, by what tells them
    filled_in, n_element, rounded : as of `Refined`
    first : (label, count) of the children of the elements that the last cut halved
    """

    open: Deck
    known: dict[tuple, int] = field(default_factory=dict, repr=False)
    filled_in: int = 0
    n_element: int = 0
    first: dict[int, tuple[int, int]] = field(default_factory=dict, repr=False)
    rounded: float = 0.0

    def __post_init__(self):
        self._hanging: list[Hanging] | None = None

    def inherited(self, values: dict[int, float], left: float) -> dict[int, float]:
        """Values by element before the last cut as they are after it: the children of a cut element
        share what is `left` of its own."""
        found = {}
        for label, value in values.items():
            first, count = self.first.get(label, (0, 0))
            if count:
                found.update(dict.fromkeys(range(first, first + count), left*value/count))
            else:
                found[label] = value
        return found

    def everywhere(self) -> LocalMesh:
        """With all elements cut."""
        cards = MeshCards(expanded(self.open))
        return self.refined(label for label, (word, _) in cards.elements.items() if cell_of(word))

    @property
    def hanging(self) -> list[Hanging]:
        """Nodes on edges of coarser cells."""
        if self._hanging is None:
            self._hanging = list(_hanging(MeshCards(expanded(self.open)), self.known))
        return self._hanging

    @property
    def deck(self) -> Deck:
        """What can be run."""
        if not self.hanging:
            return self.open
        blocks = list(expanded(self.open))
        rows: list[list] = []
        axes = local_axes(blocks, MeshCards(blocks))
        for h in self.hanging:
            own = axes.get(h.node, np.eye(2))
            for d in (0, 1):
                terms = [[h.node, d + 1, 1.0]]
                for n, w in zip(h.masters, h.weights):
                    along = own[d] @ axes.get(n, np.eye(2)).T
                    terms += [[n, k + 1, -w*float(v)] for k, v in enumerate(along)
                              if abs(v) > ROUNDING]
                rows.append([len(terms)])
                rows += [sum(terms[k:k + 4], []) for k in range(0, len(terms), 4)]
        at = max(k for k, b in enumerate(blocks) if b.keyword == "ELEMENT")
        blocks.insert(at + 1, Block("EQUATION", {}, rows))
        return Deck(blocks, preamble=self.open.preamble, name=self.open.name,
                    folder=self.open.folder)

    def refined(self, elements: Iterable[int]) -> LocalMesh:
        """With some elements cut, and those that must be so that neighbours differ by one halving.

        Raises
        ------
        ModelError : as of `lopin.refine.refined`; or the deck is one in space, or turns degrees of
            freedom of its nodes out of the plane.
        """
        blocks = expanded(self.open)
        cards = MeshCards(blocks)
        local_axes(blocks, cards)
        for word in {word for word, _ in cards.elements.values()}:
            name = cell_of(word)
            if name and CELLS[name].ndim != 2:
                raise ModelError(f"{word}: only plane and axisymmetric meshes are refined in part")
        marked = self._balanced(cards, set(map(int, elements)))
        known = dict(self.known)
        cut = Cut(children, {}, marked, known, self._inner())
        finer: Refined = made(self.open, True, cut)
        return LocalMesh(finer.deck, known, max(self.filled_in, finer.filled_in),
                         finer.n_element, cut.first, max(self.rounded, finer.rounded))

    def _inner(self) -> set[tuple]:
        """Edges through the inside that have one cell: coarse ones and their halves."""
        found = set()
        for h in self.hanging:
            a, b = h.ends
            found.add((a, b))
            middle = self.known.get(_key((a, b), 32))
            if middle is not None:
                found |= {tuple(sorted((a, middle))), tuple(sorted((middle, b)))}
        return found

    def _balanced(self, cards: MeshCards, marked: set[int]) -> set[int]:
        """With the coarser cells on whose edges nodes of the marked ones hang."""
        coarse: dict[int, list[int]] = {}
        for h in self.hanging:
            coarse.setdefault(h.node, []).append(h.element)
        fresh = set(marked)
        while fresh:
            touched = {m for e in fresh for n in cards.elements[e][1] for m in coarse.get(n, ())}
            fresh = touched - marked
            marked = marked | fresh
        return marked


def local_axes(blocks: list[Block], cards: MeshCards) -> dict[int, NDArray]:
    """Axes of *TRANSFORM, rows, of the nodes of solids that have some.

    Raises
    ------
    ModelError : they leave the plane, or a node lies on the axis of a cylindrical system.
    """
    solid = {n for word, nodes in cards.elements.values() if cell_of(word) for n in nodes}
    found: dict[int, NDArray] = {}
    for block in blocks:
        if block.keyword != "TRANSFORM":
            continue
        name = str(plain(block.parameters.get("NSET", ""))).upper()
        nodes = sorted(solid.intersection(cards.nsets.get(name, ())))
        if not nodes:
            continue
        axes, on = axes_at(block, [cards.nodes[n] for n in nodes])
        wrong = on | (np.abs(axes[:, 2, 2]) < 1.0 - ROUNDING)
        if wrong.any():
            raise ModelError(f"*TRANSFORM, NSET={name}: its axes at node {nodes[wrong.argmax()]} "
                             "are not those of the plane: the mesh is not refined in part")
        found |= dict(zip(nodes, axes[:, :2, :2]))
    return found


def _key(ends: tuple[int, int], part: int) -> tuple:
    """What tells a node on an edge (as of `Cut`): corners in order, their weights in 64ths."""
    return (*ends, *[0]*6, 64 - part, part, *[0]*6)


def _hanging(cards: MeshCards, known: dict[tuple, int]) -> Iterable[Hanging]:
    """Of all edges of all elements."""
    if not known:
        return
    seen = set()
    for label, (word, nodes) in cards.elements.items():
        name = cell_of(word)
        if name is None:
            continue
        cell = CELLS[name]
        for k, (i, j) in enumerate(cell.edges):
            a, b = nodes[i], nodes[j]
            ends = (a, b) if a < b else (b, a)
            if cell.is_quadratic:
                masters, rules = (*ends, nodes[cell.n_corner + k]), _QUADRATIC
            else:
                masters, rules = ends, _LINEAR
            for part, weights in rules.items():
                node = known.get(_key(ends, part))
                if node is None or node in seen:
                    continue
                if cell.is_quadratic:
                    weights = weights if part == 16 else _QUADRATIC[48]
                seen.add(node)
                yield Hanging(node, label, ends, masters, weights)
