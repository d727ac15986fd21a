"""A deck with every cell of its solids cut in half along each edge.

Names stay: sets of nodes, of elements, and surfaces hold the nodes, elements and faces that their
old members became. Nodes of the old mesh keep their labels and places. Boundaries of linear cells
stand for smooth surfaces (`curved`); quadratic cells are cut along their own curved edges.
"""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..deck import Block, Deck
from ..errors import ModelError, UsageError
from ..mesh.cells import CELLS
from ..model_read_mesh import MeshCards, expanded
from .cards import SpreadRows, refuse_what_is_lost
from .children import boundary, cell_of, children, upgraded
from .curved import lifts_in_plane, lifts_in_space
from .names import OWN, Members, Supports, face_blocks, node_sets, set_block

_MESH_CARDS = ("NODE", "ELEMENT", "NSET", "ELSET")


@dataclass
class Refined:
    """The finer deck, and where its nodes come from.

    Attributes
    ----------
    deck : on the finer mesh
    labels : of the new nodes (n,)
    ends : labels of the old corners that each lies between, padded by 0 (n, 8)
    weight : of these, adding up to 1 (n, 8)
    n_element : solid elements of the finer mesh
    filled_in : displacements and temperatures that were given node by node, for which new nodes
        have the mean of their neighbours
    rounded : the farthest that the middle of an edge was moved onto a smooth boundary, beside the
        edge; 0: the boundary is what it was
    """

    deck: Deck
    labels: NDArray
    ends: NDArray
    weight: NDArray
    n_element: int
    filled_in: int = 0
    rounded: float = 0.0


#: The words of second order that stand for linear ones.
SECOND = {"CPE3": "CPE6", "CPE4": "CPE8", "CPE4R": "CPE8R", "CPE4I": "CPE8", "CPS3": "CPS6",
          "CPS4": "CPS8", "CPS4R": "CPS8R", "CPS4I": "CPS8", "CAX3": "CAX6", "CAX4": "CAX8",
          "CAX4R": "CAX8R", "CAX4I": "CAX8", "C3D4": "C3D10", "C3D6": "C3D15", "C3D8": "C3D20",
          "C3D8R": "C3D20R", "C3D8I": "C3D20"}


def size_of_refined(deck: Deck) -> int:
    """Solid elements that `refined` would make; nothing is made."""
    cells = (cell_of(word) for word, _ in MeshCards(expanded(deck)).elements.values())
    return sum(2**CELLS[name].ndim for name in cells if name)


def refined(deck: Deck, curved: bool = True) -> Refined:
    """The deck with every solid element cut in half along each edge.

    Parameters
    ----------
    deck : flat, without parts and assemblies
    curved : boundaries of straight edges stand for smooth ones; else they stay as they are

    Raises
    ------
    ModelError : the deck has cards that belong to its first mesh, or cells would be turned inside
        out.
    """
    return made(deck, curved, Cut(children, {}))


def of_second_order(deck: Deck, curved: bool = True) -> Refined:
    """The deck with every linear solid element replaced by one with nodes in the middle of edges.

    Raises
    ------
    ModelError : as of `refined`; or the deck has elements of second order already.
    """
    words = {str(b.parameters["TYPE"]).upper() for b in expanded(deck) if b.keyword == "ELEMENT"
             and "TYPE" in b.parameters}
    wrong = sorted(w for w in words if cell_of(w) and w not in SECOND)
    if wrong:
        raise ModelError(f"{', '.join(wrong)}: there is no element of second order for it")
    return made(deck, curved, Cut(upgraded, SECOND))


def made(deck: Deck, curved: bool, cut: Cut) -> Refined:
    """The deck with solid elements cut."""
    blocks, cards = refuse(deck)
    cut.read(cards)
    places = cut.places(cards, curved)
    members = Members(cards, cut)
    new = Deck(preamble=deck.preamble, name=deck.name, folder=deck.folder)
    written, sets, filled, spread = False, [], 0, SpreadRows(blocks, cards, cut)
    for number, block in enumerate(blocks):
        if block.keyword in _MESH_CARDS:
            if not written:
                new.blocks += _mesh_blocks(cards, cut, places, members)
                written = True
        elif block.keyword in ("SURFACE", "DLOAD"):
            own, faces = face_blocks(block, members)
            sets += own
            new.blocks.append(faces)
        else:
            new.blocks.append(spread.block(number, block))
            filled += sum(bool(row[-1]) for row in new.blocks[-1].lines[len(block.lines):]
                          if isinstance(row[0], int))
    sets += spread.sets
    at = max(k for k, b in enumerate(new.blocks) if b.keyword == "ELEMENT")
    new.blocks[at + 1:at + 1] = sets
    return Refined(new, cut.labels, cut.ends, cut.weight, cut.n_element, filled, cut.rounded)


def refuse(deck: Deck) -> tuple[list[Block], MeshCards]:
    """Raise what a finer mesh cannot carry; the blocks of the deck and what its mesh's said."""
    blocks = expanded(deck)
    if any(b.keyword in ("PART", "INSTANCE", "ASSEMBLY") for b in blocks):
        raise ModelError("a deck with parts and instances cannot be refined",
                         help="write it flat: lopin export --flat")
    try:
        cards = MeshCards(blocks)
    except UsageError as problem:
        raise ModelError(f"the mesh cannot be refined: {problem.message}") from problem
    refuse_what_is_lost(blocks, cards)
    return blocks, cards


class Cut:
    """The finer mesh by labels.

    Attributes
    ----------
    rule, words : how a cell is cut, and the words of what comes of it
    marked : labels of the elements that are cut; None: all
    known : labels of nodes that earlier cuts made, by what tells them; those of this one are added
    inner : sorted corners of facets through the inside that have one element only, since the mesh
        beyond is finer or coarser
    groups : (word, cell, labels of the old elements, their nodes, their children's nodes (old,
        child, node)) for each word
    kept : (word, cell, labels, nodes) of the solid elements that stay
    first : label of the first child by old element; its children follow
    rounded : as of `Refined`
    """

    def __init__(self, rule, words: dict[str, str], marked: set[int] | None = None,
                 known: dict[tuple, int] | None = None, inner: set[tuple] | None = None):
        self.rule, self.words, self.marked = rule, words, marked
        self.known = {} if known is None else known
        self.inner = inner or set()
        self.rounded = 0.0
        self.groups: list[tuple[str, str, NDArray, NDArray, NDArray]] = []
        self.kept: list[tuple[str, str, NDArray, NDArray]] = []

    def read(self, cards: MeshCards) -> None:
        """Cut the mesh of some cards."""
        rule = self.rule
        by_word: dict[str, list[int]] = {}
        kept: dict[str, list[int]] = {}
        for label, (word, nodes) in cards.elements.items():
            if cell_of(word):
                cut = self.marked is None or label in self.marked
                (by_word if cut else kept).setdefault(word, []).append(label)
        if not by_word:
            raise ModelError("the deck has no solid elements to refine")
        self.kept = [(word, cell_of(word), np.array(labels),
                      np.array([cards.elements[m][1] for m in labels]))
                     for word, labels in kept.items()]
        keys, rows = [], []
        for word, labels in by_word.items():
            name = cell_of(word)
            nodes = np.array([cards.elements[m][1] for m in labels])
            rows.append((word, name, np.array(labels), nodes))
            keys.append(_keys(rule(name), nodes[:, :CELLS[name].n_corner]))
        self._number(cards, keys, rows)

    def _number(self, cards, keys, rows) -> None:
        """New nodes, the same wherever cells share an edge, a face or a corner."""
        every, inverse = np.unique(np.vstack(keys), axis=0, return_inverse=True)
        inverse = inverse.ravel()
        ends, parts = every[:, :8], every[:, 8:]/64.0
        single = (parts == 1.0).any(axis=1)
        label = np.empty(len(every), int)
        label[single] = ends[single][parts[single] == 1.0]
        middles = self._middles(rows, keys, inverse)
        kept = np.array([m > 0 for m in middles])     # middles of old quadratic edges
        label[kept] = np.array(middles)[kept]
        new = ~single & ~kept
        if self.marked is not None:
            new &= ~self._recalled(every, label, np.flatnonzero(new))
        label[new] = max(cards.nodes) + 1 + np.arange(int(new.sum()))
        if self.marked is not None:
            self.known.update(zip(map(tuple, every[~single].tolist()), label[~single].tolist()))
        self.labels, self.ends, self.weight = label[new], ends[new], parts[new]
        at, first, words = 0, max(cards.elements) + 1, self.words
        self.first: dict[int, tuple[int, int]] = {}
        self.place: dict[int, NDArray] = {}
        for word, name, labels, nodes in rows:
            cut = self.rule(name)
            n = len(labels)*len(cut.xi)
            points = label[inverse[at:at + n]].reshape(len(labels), len(cut.xi))
            at += n
            x = np.array([[cards.nodes[v] for v in row] for row in nodes])
            moved = np.einsum("pn,end->epd", cut.shape, x)
            for own, place in zip(points.ravel().tolist(), moved.reshape(-1, 3)):
                self.place[own] = place
            for k, m in enumerate(labels):
                self.first[int(m)] = first + k*len(cut.cells), len(cut.cells)
            first += len(labels)*len(cut.cells)
            self.groups.append((words.get(word.upper(), word), name, labels, nodes,
                                points[:, cut.cells]))
        self.supports = Supports(self)
        self.n_element = sum(g[4].shape[0]*g[4].shape[1] for g in self.groups) \
            + sum(len(g[2]) for g in self.kept)

    def _recalled(self, every: NDArray, label: NDArray, rows: NDArray) -> NDArray:
        """Nodes that an earlier cut of a neighbour made."""
        found = np.zeros(len(every), bool)
        for k in rows.tolist():
            old = self.known.get(tuple(every[k].tolist()))
            if old is not None:
                label[k], found[k] = old, True
        return found

    def _middles(self, rows, keys, inverse) -> list[int]:
        """Labels of old mid-side nodes that become corners, 0 for others."""
        found = [0]*(int(inverse.max()) + 1)
        at = 0
        for (_, name, labels, nodes), own in zip(rows, keys):
            cut, cell = self.rule(name), CELLS[name]
            numbers = inverse[at:at + len(own)].reshape(len(labels), len(cut.xi))
            at += len(own)
            for k in range(cell.n_corner, cell.n_node):
                p = int(np.argmin(np.abs(cut.xi - cell.xi[k]).sum(axis=1)))
                for number, node in zip(numbers[:, p], nodes[:, k]):
                    found[int(number)] = int(node)
        return found

    def places(self, cards: MeshCards, curved: bool) -> dict[int, NDArray]:
        """Coordinates by label, those of linear boundaries lifted to the smooth surface."""
        place = {int(k): v.copy() for k, v in self.place.items()}
        linear = [g for g in self.groups if not CELLS[g[1]].is_quadratic]
        if curved and linear:
            stay = [g for g in self.kept if not CELLS[g[1]].is_quadratic]
            self.rounded = _lift(cards, linear, place, self.rule,
                                 boundary([*linear, *stay], self.inner))
        for word, name, labels, nodes, cells in self.groups:
            _refuse_folded(cell_of(word), labels, cells, place)
        return place

def _keys(cut, corners: NDArray) -> NDArray:
    """What tells the points of the children: corners of the parent and their weights in 64ths."""
    weight = np.round(64.0*cut.corner).astype(int)
    keys = np.zeros((len(corners), len(cut.xi), 16), int)
    for p, w in enumerate(weight):
        own = np.flatnonzero(w)
        order = np.argsort(corners[:, own], axis=1)
        keys[:, p, :len(own)] = np.take_along_axis(corners[:, own], order, axis=1)
        keys[:, p, 8:8 + len(own)] = w[own][order]
    return keys.reshape(-1, 16)


def _lift(cards: MeshCards, groups, place: dict[int, NDArray], rule, faces) -> float:
    """Move points of linear cells onto the smooth boundary, and those within cells along; the
    farthest beside its edge."""
    x = {n: np.array(v) for n, v in cards.nodes.items()}
    space = CELLS[groups[0][1]].ndim == 3
    rows = np.unique(np.concatenate([f.ravel() for f in faces]))
    at = {int(n): k for k, n in enumerate(rows)}
    own = [np.vectorize(at.get)(f) for f in faces]
    points = np.array([x[int(n)][:3 if space else 2] for n in rows])
    if space:
        edges = np.unique(np.sort(np.vstack([np.stack([f, np.roll(f, -1, axis=1)], axis=2)
                                             .reshape(-1, 2) for f in own]), axis=1), axis=0)
        lifts = lifts_in_space(points, own, edges)
    else:
        edges = own[0]
        lifts = lifts_in_plane(points, edges)
    lifted = {(min(a, b), max(a, b)): np.r_[v, np.zeros(3 - len(v))]
              for (a, b), v in zip(rows[edges].tolist(), lifts) if v.any()}
    if not lifted:
        return 0.0
    for _, name, _, nodes, cells in groups:
        _move_along(rule(name), CELLS[name], nodes, cells, lifted, place)
    length = np.linalg.norm(points[edges[:, 1]] - points[edges[:, 0]], axis=1)
    return float((np.linalg.norm(lifts, axis=1)/length).max())


def _move_along(cut, cell, nodes: NDArray, cells: NDArray, lifted: dict,
                place: dict[int, NDArray]) -> None:
    """Points on edges by their lifts, those of faces and of the inside by Coons' blends."""
    points = np.zeros((len(nodes), len(cut.xi)), int)
    for c, own in enumerate(cut.cells):
        points[:, own] = cells[:, c]
    ends = [[k for k in np.flatnonzero(w > 1e-9)] for w in cut.corner]
    on_edge = {frozenset(e): p for p, e in enumerate(map(tuple, ends)) if len(e) == 2}
    for e, row in enumerate(nodes.tolist()):
        shift = {}
        for pair, p in on_edge.items():
            a, b = (row[k] for k in pair)
            value = lifted.get((min(a, b), max(a, b)))
            if value is not None:
                shift[pair] = value
        if not shift:
            continue
        for p, own in enumerate(ends):
            if len(own) < 2:
                continue
            inside = [v for pair, v in shift.items() if pair <= set(own)]
            if inside:
                # The blend of straight corners leaves half the sum over the four edges of a
                # square, a quarter over the twelve of a brick: as many as pass the middle.
                share = 1.0 if len(own) == 2 else _SHARE[len(own), cell.ndim]
                place[int(points[e, p])] = cut.corner[p] @ _corners_of(row, cell, place) \
                    + share*np.sum(inside, axis=0)


#: Part of the lifts of the edges that reaches the middle of a face or cell, by its corners.
_SHARE = {(4, 2): 0.5, (4, 3): 0.5, (6, 3): 0.25, (8, 3): 0.25}


def _corners_of(row: list[int], cell, place: dict[int, NDArray]) -> NDArray:
    return np.array([place[n] for n in row[:cell.n_corner]])


def _refuse_folded(name: str, labels: NDArray, cells: NDArray, place: dict) -> None:
    """A child must not be turned inside out by the curved boundary."""
    from ..mesh.shapes import shape_functions

    cell = CELLS[name]
    x = np.array([[place[int(n)] for n in row] for row in cells.reshape(-1, cells.shape[2])])
    x = x[..., :cell.ndim]
    for xi in cell.xi[:cell.n_corner]:
        slope = shape_functions(name, xi)[1]
        det = np.linalg.det(np.einsum("end,nc->edc", x, slope))
        if (det <= 0.0).any():
            k = int(np.argmin(det))//cells.shape[1]
            raise ModelError(f"element {labels[k]} would be turned inside out when it is cut along "
                             "the smooth boundary", help="take finer cells along the curve")


def _mesh_blocks(cards: MeshCards, cut: Cut, places: dict[int, NDArray],
                 members: Members) -> list[Block]:
    """Nodes, elements and sets."""
    every = dict(cards.nodes) | {n: places[n] for n in map(int, cut.labels)}
    flat = all(v[2] == 0.0 for v in every.values())
    blocks = [Block("NODE", {}, [[n, *map(float, v[:2] if flat else v)]
                                 for n, v in every.items()])]
    for word, _, labels, _, cells in cut.groups:
        rows = []
        for m, own in zip(labels, cells):
            first, _ = cut.first[int(m)]
            rows += [[first + k, *map(int, nodes)] for k, nodes in enumerate(own)]
        blocks.append(Block("ELEMENT", {"TYPE": word}, rows))
        _continue_long(blocks[-1])
    for word, _, labels, nodes in cut.kept:
        blocks.append(Block("ELEMENT", {"TYPE": word},
                            np.column_stack([labels, nodes]).tolist()))
        _continue_long(blocks[-1])
    for label, (word, nodes) in cards.elements.items():
        if cell_of(word) is None:
            blocks.append(Block("ELEMENT", {"TYPE": word}, [[label, *nodes]]))
    blocks += [set_block("NSET", name, labels)
               for name, labels in node_sets(cards, cut).items() if labels]
    blocks += [set_block("ELSET", name, members.elements(old))
               for name, old in cards.elsets.items() if old and not name.startswith(OWN)]
    return blocks


def _continue_long(block: Block) -> None:
    """Lines of twenty nodes go on in a second line."""
    if block.lines and len(block.lines[0]) > 16:
        text = []
        for row in block.lines:
            text += [", ".join(map(str, row[:11])) + ",", ", ".join(map(str, row[11:]))]
        from ..deck import Row
        block.lines = [Row.read(line) for line in text]
