"""What sets and surfaces hold on a finer mesh."""
from __future__ import annotations

import re

import numpy as np
from numpy.typing import NDArray

from ..deck import Block, Row
from ..errors import ModelError
from ..mesh.cells import CELLS
from ..model_read_mesh import MeshCards, plain
from .curved import CREASE


#: Sets of the faces that a cut made: they are made anew by the next.
OWN = "CUT_FACES_"


def set_block(kind: str, name: str, labels: list[int]) -> Block:
    """*NSET or *ELSET."""
    return Block(kind, {kind: name}, [labels[k:k + 16] for k in range(0, len(labels), 16)])


class Members:
    """Elements and faces of the finer mesh, by those that they were cut from."""

    def __init__(self, cards: MeshCards, cut):
        self.cards, self.cut = cards, cut
        self.cell = {int(m): name for _, name, labels, _, _ in cut.groups for m in labels}
        self.made = 0

    def elements(self, labels: list[int]) -> list[int]:
        """Labels of the children; of other elements their own."""
        found = []
        for label in dict.fromkeys(labels):
            first, count = self.cut.first.get(label, (label, 1))
            found += range(first, first + count)
        return found

    def faces(self, label: int, face: int) -> list[tuple[int, int]]:
        """(label, face from 1) of the children's faces that a face became."""
        if label not in self.cell:
            return [(label, face)]
        first, _ = self.cut.first[label]
        own = self.cut.rule(self.cell[label]).faces
        if not 1 <= face <= len(own):
            raise ModelError(f"element {label} has no face {face}")
        return [(first + c, f + 1) for c, f in own[face - 1]]

    def of(self, field) -> list[int]:
        """Labels of the old elements that a data line names."""
        if isinstance(field, int):
            return [field]
        name = str(plain(field)).upper()
        if name not in self.cards.elsets:
            raise ModelError(f"no element set '{field}'", id="E0201")
        return list(dict.fromkeys(self.cards.elsets[name]))


def face_blocks(block: Block, members: Members) -> tuple[list[Block], Block]:
    """The sets that a *SURFACE or *DLOAD on the faces of the finer mesh needs, and itself."""
    kind = str(block.parameters.get("TYPE", "ELEMENT")).upper()
    if block.keyword == "SURFACE" and kind != "ELEMENT":
        return [], block
    letter = "S" if block.keyword == "SURFACE" else "P"
    new, sets = Block(block.keyword, block.parameters), []
    for row in block.data:
        face = str(row[1]).upper() if len(row) > 1 and row[1] is not None else ""
        match = re.fullmatch(letter + r"(\d)(NU)?", face)
        if not match:
            if isinstance(row[0], int) and row[0] in members.cell:
                raise ModelError(f"*{block.keyword} names element {row[0]}, which is cut",
                                 help="name an element set")
            new.lines.append(row)
            continue
        by_face: dict[int, list[int]] = {}
        for label in members.of(row[0]):
            for child, f in members.faces(label, int(match[1])):
                by_face.setdefault(f, []).append(child)
        for f, labels in by_face.items():
            if isinstance(row[0], int):
                new.lines += [Row([n, f"{letter}{f}{match[2] or ''}", *row[2:]]) for n in labels]
                continue
            members.made += 1
            name = f"{OWN}{members.made}"
            sets.append(set_block("ELSET", name, labels))
            new.lines.append(Row([name, f"{letter}{f}{match[2] or ''}", *row[2:]]))
    return sets, new


class Supports:
    """Which new nodes belong to a set of old ones."""

    def __init__(self, cut):
        self.cut = cut
        self.support = [tuple(int(n) for n in row if n) for row in cut.ends]
        self.half = self._halves(cut)
        outside: dict[tuple, int] = {}
        self.cells = []
        for _, name, _, nodes, *_ in [*cut.groups, *cut.kept]:
            corners = nodes[:, :CELLS[name].n_corner]
            self.cells.append(corners)
            for face in CELLS[CELLS[name].family].faces:
                for row in np.sort(corners[:, list(face)], axis=1).tolist():
                    outside[tuple(row)] = outside.get(tuple(row), 0) + 1
        facets = [f for f, count in outside.items() if count == 1 and f not in cut.inner]
        self.skin_nodes = {n for f in facets for n in f}
        self.facets = facets
        self.on_skin = _parts(facets)

    def within(self, labels) -> NDArray:
        """Rows of the new nodes that lie between nodes of the set.

        In an edge with a node in its middle these may be that node and one end.

        An edge or a face through the inside whose ends lie on the skin belongs to the set only
        with a whole element: a set of two opposite sides does not hold what is between them.
        """
        own = set(labels)
        found, whole = [], None
        for k, support in enumerate(self.support):
            if not own.issuperset(support) and not own.issuperset(self.half.get(k, (0,))):
                continue
            if support in self.on_skin or not self.skin_nodes.issuperset(support):
                found.append(k)
                continue
            whole = self._whole(own) if whole is None else whole
            if any(set(support) <= c for n in support[:1] for c in whole.get(n, ())):
                found.append(k)
        return np.array(found, int)

    def going_on(self, rows, parts: list[set], cards: MeshCards
                 ) -> list[tuple[int, tuple]]:
        """Of new nodes between nodes of several sets, those on edges and faces of the skin beside
        which a whole face of one set goes on without a crease; with the face."""
        around: dict[int, list[tuple]] = {}
        for f in self.facets if rows else ():
            for n in f:
                around.setdefault(n, []).append(f)
        x, normals = cards.nodes, {}

        def normal(facet: tuple) -> NDArray:
            if facet not in normals:
                normals[facet] = _unit_normal(np.array([x[n] for n in facet]))
            return normals[facet]

        def goes_on(facet: tuple) -> bool:
            return any(other != facet and any(own.issuperset(other) for own in parts)
                       and abs(normal(facet) @ normal(other)) > np.cos(CREASE)
                       for n in facet for other in around[n])

        found = []
        for k in sorted(rows):
            own = self.support[k]
            beside = around.get(own[0], ()) if own in self.on_skin else ()
            found += [(k, f) for f in beside if set(own) <= set(f) and goes_on(f)]
        return found

    def _halves(self, cut) -> dict[int, tuple[int, int]]:
        """Old nodes beside the new ones in the quarters of edges that have a node in the middle."""
        middle = {}
        for _, name, _, nodes, *_ in cut.groups:
            cell = CELLS[name]
            for k, ends in enumerate(cell.edges if cell.is_quadratic else ()):
                pairs = np.sort(nodes[:, list(ends)], axis=1).tolist()
                middle.update(zip(map(tuple, pairs), nodes[:, cell.n_corner + k].tolist()))
        return {k: (support[int(weight[1] > weight[0])], middle[support])
                for k, (support, weight) in enumerate(zip(self.support, cut.weight))
                if len(support) == 2 and support in middle and weight[0] != weight[1]}

    def _whole(self, own: set) -> dict[int, list[set]]:
        """Elements with all corners in a set, by corner."""
        found: dict[int, list[set]] = {}
        for rows in self.cells:
            for row in rows.tolist():
                if own.issuperset(row):
                    for n in row:
                        found.setdefault(n, []).append(set(row))
        return found


def _unit_normal(x: NDArray) -> NDArray:
    """Of an edge in the plane, or of a face whose corners come in any order."""
    if len(x) == 2:
        return np.array([x[1, 1] - x[0, 1], x[0, 0] - x[1, 0], 0.0])/np.linalg.norm(x[1] - x[0])
    return np.linalg.svd(x - x.mean(axis=0))[2][2]


def _parts(facets: list[tuple]) -> set[tuple]:
    """Facets and their edges (any two of their corners), as sorted tuples."""
    found = set(facets)
    for f in facets:
        found.update((a, b) for k, a in enumerate(f) for b in f[k + 1:])
    return found


def node_sets(cards: MeshCards, cut) -> dict[str, list[int]]:
    """Labels of every node set on the finer mesh."""
    supports = cut.supports
    return {name: [*dict.fromkeys(old), *map(int, cut.labels[supports.within(old)])]
            if len(set(old)) > 1 else list(old) for name, old in cards.nsets.items()}
