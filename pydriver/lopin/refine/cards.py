"""Cards that name nodes and elements by their labels, on a finer mesh."""
from __future__ import annotations

import numpy as np

from ..deck import Block, Row
from ..errors import ModelError
from ..mesh.cells import CELLS
from ..model_read_mesh import HELD_BY_WORD, MeshCards, plain
from .names import set_block

#: Cards that a finer mesh would have to be told anew, and what to do.
_LOST = {"EQUATION": "equations tie single nodes", "MPC": "couplings tie single nodes",
         "SPRING": "springs hold single nodes", "GAP": "gaps hold single nodes",
         "REMESH": "the mesh is made anew on the way already",
         "START": "a run that goes on has its own mesh"}
#: Sets of nodes between sets that hold them.
JOINT = "CUT_JOINT_"
_BY_ELEMENT = ("STATE", "STRESS", "PLASTIC STRAIN", "HARDENING", "TRACTION")


def refuse_what_is_lost(blocks: list[Block], cards: MeshCards) -> None:
    """Raise what a finer mesh cannot carry."""
    for block in blocks:
        if block.keyword in _LOST:
            raise ModelError(f"*{block.keyword}: {_LOST[block.keyword]}: the deck cannot be "
                             "refined")
        if block.keyword == "INITIAL CONDITIONS" and \
                str(block.parameters.get("TYPE", "")).upper() in _BY_ELEMENT:
            raise ModelError("*INITIAL CONDITIONS of elements and points: the deck cannot be "
                             "refined")
        if block.keyword == "SURFACE" and len(block.data) > 1 and \
                str(block.parameters.get("TYPE", "")).upper() == "NODE" and \
                any(isinstance(row[0], int) for row in block.data):
            raise ModelError(f"*SURFACE, NAME={block.parameters.get('NAME')}, TYPE=NODE of single "
                             "nodes: a finer mesh has more between them",
                             help="name a set of nodes")
        for row in block.data if block.keyword == "CLOAD" else ():
            if not isinstance(row[0], int) and len(set(cards.nsets.get(str(row[0]).upper(), []))
                                                   ) > 1:
                raise ModelError(f"*CLOAD on every node of {row[0]}: its sum grows with the nodes "
                                 "of a finer mesh", help="load a surface by *DSLOAD or *DLOAD, or "
                                 "one node")


class SpreadRows:
    """*BOUNDARY and temperatures on the finer mesh: what holds all nodes that a new one lies
    between holds it too, whichever rows, cards and sets of one place in the deck name them.

    Rows that name a set hold what it became. What single labels hold, together or beside sets of
    the same value, goes on between them: new nodes take the mean of the old ones, by their
    distances. Sets that meet hold an edge or a face between them where one of them goes on beyond
    it without a crease: not what lies between two opposite sides. What they hold there is a set of
    its own, so that the next mesh knows it.

    Attributes
    ----------
    sets : of nodes, to be declared
    """

    def __init__(self, blocks: list[Block], cards: MeshCards, cut):
        self.cards, self.cut = cards, cut
        self.own = {n for _, _, _, nodes, _ in [*cut.groups, *((*k, None) for k in cut.kept)]
                    for n in nodes.ravel().tolist()}
        self.dims = max(CELLS[name].ndim for _, name, *_ in cut.groups)
        self.axes: dict[int, tuple] = {}
        self.sets: list[Block] = []
        self.first = 1 + sum(name.startswith(JOINT) for name in cards.nsets)
        self.by_block: dict[int, list[Row]] = {}
        places: dict[tuple, list[int]] = {}
        step = 0
        for k, block in enumerate(blocks):
            step += block.keyword == "STEP"
            if block.keyword == "TRANSFORM":
                name = str(plain(block.parameters.get("NSET", ""))).upper()
                self.axes |= dict.fromkeys(cards.nsets.get(name, ()), (
                    str(block.parameters.get("TYPE", "R")).upper(), *block.data[0]))
            if _is_spread(block):
                given = {name: str(plain(v)).upper() for name, v in block.parameters.items()
                         if name != "OP"}
                places.setdefault((block.keyword, step, *sorted(given.items())), []).append(k)
        for own in places.values():
            rows = self._rows([blocks[k] for k in own])
            if rows:
                self.by_block[own[-1]] = rows

    def block(self, number: int, block: Block) -> Block:
        """A block with the rows of new nodes."""
        if number not in self.by_block:
            return block
        new = Block(block.keyword, block.parameters)
        new.lines = [*block.lines, *self.by_block[number]]
        return new

    def _rows(self, blocks: list[Block]) -> list[Row]:
        """Of all cards of one place."""
        of_dof = blocks[0].keyword == "BOUNDARY"
        held: dict[tuple, dict[str, dict[int, float]]] = {}   # by dof and axes, by source
        for block in blocks:
            for row in block.data:
                single = isinstance(row[0], int)
                nodes = [row[0]] if single else self.cards.nsets.get(
                    str(plain(row[0])).upper(), [])
                source = "" if single else str(plain(row[0])).upper()
                dofs, value = _dofs(row) if of_dof else ((0,), _number(row, 1))
                for n in nodes:
                    for d in dofs if n in self.own else ():
                        if d > self.dims:
                            break   # solids have no rotations
                        held.setdefault((d, self.axes.get(n, ())), {}).setdefault(
                            source, {})[n] = value
        found = []
        for (d, _), sources in held.items():
            for n, value in self._between(sources, anywhere=not of_dof).items():
                found.append(Row([n, d, d, value] if of_dof else [n, value]))
            if of_dof and len(sources) > 1:
                found += [Row([name, d, d, value]) for name, value in self._joints(sources)]
        return found

    def _between(self, sources: dict[str, dict[int, float]], anywhere: bool) -> dict[int, float]:
        """Values by label of new nodes between nodes that labels name (or, `anywhere`, sets too),
        but those that rows of sets hold already."""
        given = dict(sources.get("", {}))
        if anywhere:
            given = {n: v for own in sources.values() for n, v in own.items()}
        rows = self._within(given) - self._of_sets(sources)
        return {int(self.cut.labels[k]): self._mean(k, given) for k in sorted(rows)}

    def _joints(self, sources: dict[str, dict[int, float]]) -> list[tuple[str, float]]:
        """Sets, and their values, of the edges and faces between several sets, or between sets and
        labels."""
        supports, found = self.cut.supports, []
        done = self._of_sets(sources) | self._within(sources.get("", {}))
        every = {n: v for own in sources.values() for n, v in own.items()}
        for value in sorted(set(every.values())):
            held = {n for n, v in every.items() if v == value}
            parts = [held & set(own) for own in sources.values()]
            rows = self._within(held)
            joints: dict[tuple, list[int]] = {}
            for k, facet in supports.going_on(rows, parts, self.cards) if rows - done else ():
                joints.setdefault(facet, []).append(k)
            for own in joints.values():
                if done.issuperset(own):
                    continue
                nodes = {n for k in own for n in (*supports.support[k], *supports.half.get(k, ()))}
                nodes = nodes & held | set(self.cut.labels[own].tolist())
                found.append((f"{JOINT}{self.first + len(self.sets)}", value))
                self.sets.append(set_block("NSET", found[-1][0], sorted(nodes)))
        return found

    def _of_sets(self, sources: dict[str, dict[int, float]]) -> set[int]:
        """Rows of the new nodes that sets hold themselves."""
        return set().union(*(self._within(own) for name, own in sources.items() if name))

    def _within(self, nodes) -> set[int]:
        return set(self.cut.supports.within(nodes).tolist()) if len(nodes) > 1 else set()

    def _mean(self, k: int, values: dict[int, float]) -> float:
        """Of the nodes that a new one lies between."""
        ends, weight = self.cut.ends[k], self.cut.weight[k]
        if any(n and int(n) not in values for n in ends):
            ends, weight = self.cut.supports.half[int(k)], (0.5, 0.5)
        return float(np.sum([w*values[int(n)] for n, w in zip(ends, weight) if n]))


def _is_spread(block: Block) -> bool:
    return block.keyword in ("BOUNDARY", "TEMPERATURE") or (
        block.keyword == "INITIAL CONDITIONS" and "TEMPERATURE" in
        str(block.parameters.get("TYPE", "")).upper())


def _dofs(row: Row) -> tuple[tuple[int, ...], float]:
    """Degrees of freedom that a row of *BOUNDARY holds, and where."""
    if not isinstance(row[1], int):
        return HELD_BY_WORD.get(str(plain(row[1])).upper(), ()), 0.0
    last = row[2] if len(row) > 2 and row[2] is not None else row[1]
    return tuple(range(row[1], int(last) + 1)), _number(row, 3)


def _number(row: Row, at: int) -> float:
    return float(row[at] or 0.0) if len(row) > at else 0.0
