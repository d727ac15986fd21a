"""The error of a number from the solution of its dual problem, with the contact as it is.

A force on a tool is the slope of the least energy in the way of the tool, a displacement that in a
force put there. So the dual solution is the slope of the displacements in that parameter: the
deck gets further steps in which it changes by so little that no node of contact opens or closes. On
the condensed path such a step is a back-substitution.
"""
from __future__ import annotations

import copy
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..deck import Block, Deck
from ..model_read_mesh import MeshCards, expanded, plain
from ..result import Result
from .between import Between, tractions
from .missed import Missed, missed
from .quantity import Quantity, labels_of
from .solids import Solids

#: Change of the parameter beside its own size.
SMALL = 1e-8
#: Least change of displacements beside the largest that is not taken for rounding.
ROUNDING = 1e-11
#: Share of a direction in a number that is none.
SHARE = 1e-9
#: Pressures and gaps beside the largest that are nothing: of points at the edge of contact.
EDGE = 1e-5
HOPS = "contact changes with the smallest change"
LOST = "the dual solution is lost in rounding"
#: What the column `certificate` of a history means.
VERDICTS = ("PASS", "WARN", "FAIL")


class Until:
    """The results of a run without those of its last outputs."""

    def __init__(self, source, count: int):
        self._source, self._count = source, count

    def __getattr__(self, name: str):
        return getattr(self._source, name)

    @property
    def times(self) -> NDArray:
        return self._source.times[:self._count]

    @property
    def summary(self) -> dict:
        return copy.deepcopy(self._source.summary)

    def history(self) -> dict[str, NDArray]:
        return {k: v[:self._count] for k, v in self._source.history().items()}


@dataclass
class Question:
    """A number with the steps that its dual problem adds to a deck.

    Attributes
    ----------
    quantity : of the last step of the deck itself
    nodes : labels of the nodes that are loaded or moved
    directions : of each further step, from 1
    size : change of the parameter in each
    given : the parameter is a displacement, else a force
    """

    quantity: Quantity
    nodes: list[int]
    directions: list[int]
    size: float
    given: bool
    steps: list[Block]

    @classmethod
    def of(cls, deck: Deck, quantity: Quantity, moved: float = 0.0,
           small: float = SMALL) -> Question | str:
        """Of a flat deck; a reason where there is no dual problem.

        `moved`: the largest displacement, if it is known [length]; `small`: the change of the
        parameter beside its own size.
        """
        blocks = expanded(deck)
        if quantity.kind not in ("FORCE", "DISPLACEMENT"):
            return f"{quantity.kind.lower()} has no dual problem"
        cards = MeshCards(blocks)
        solids = Solids.of(deck)
        if solids.reason or not solids.groups:
            return solids.reason
        wanted = [quantity.component] if quantity.component else \
            list(range(1, solids.x.shape[1] + 1))
        try:
            nodes = list(quantity.nodes) or (labels_of(cards, quantity.set) if quantity.set
                                             else _tools(blocks, cards))
        except Exception as problem:   # the run says it better
            return str(problem)
        held = _Given(blocks, cards, moved, small)
        if held.reason:
            return held.reason
        if quantity.kind == "FORCE":
            return cls._of_force(quantity, nodes, wanted, held, solids)
        return cls._of_displacement(quantity, nodes, wanted, held, solids)

    @classmethod
    def _of_force(cls, quantity, nodes, wanted, held, solids) -> Question | str:
        if solids.groups[0].kind == "axisymmetric":
            wanted = [d for d in wanted if d == 2]   # a tool has no other way
        known = [d for d in wanted if all((n, d) in held.value for n in nodes)]
        if not nodes or not known:
            return "its tools are no rigid ones, or driven by forces"
        size = held.small*held.scale(solids)
        if size == 0.0:
            return "nothing moves"
        steps, now = [], dict(held.value)
        for d in known:
            rows = []
            for n in nodes:
                now[n, d] += size
                rows.append([n, d, d, float(now[n, d])])
            steps += _step(Block("BOUNDARY", {}, rows))
        return cls(quantity, nodes, known, size, True, steps)

    @classmethod
    def _of_displacement(cls, quantity, nodes, wanted, held, solids) -> Question | str:
        free = [d for d in wanted if not any((n, d) in held.value for n in nodes)]
        if not free:
            return "it is given"
        size = held.small*held.force(solids)
        if size == 0.0:
            return "nothing moves"
        steps = []
        for d in free:
            rows = [[n, d, float(held.load.get((n, d), 0.0) + size/len(nodes))] for n in nodes]
            steps += _step(Block("CLOAD", {}, rows))
        return cls(quantity, nodes, free, size, False, steps)

    def added(self, deck: Deck) -> Deck:
        """The deck with the steps of the dual problem behind its own."""
        return Deck([*expanded(deck), *self.steps], preamble=deck.preamble, name=deck.name,
                    folder=deck.folder)

    def split(self, result: Result) -> Result:
        """The result of the deck itself."""
        own = Result(Until(result.source, len(result.times) - len(self.directions)), result.deck)
        step = int(own.history["step"][-1])
        further = [f"step {step + k}," for k in range(1, len(self.directions) + 1)]
        said = {(d.get("code"), d.get("message", "")): d for d in reversed(own.diagnostics)}
        own.diagnostics = [d for d in reversed(said.values()) if not any(
            words in d.get("message", "") for words in further)]
        worst = int(own.history["certificate"].max(initial=0))
        if own.summary.get("certificate"):
            own.summary["certificate"]["verdict"] = VERDICTS[worst]
        return own

    def estimate(self, result: Result, deck: Deck) -> Estimate | str:
        """Of the error of the mesh; `result` of the deck with the further steps."""
        own = self.split(result)
        outputs = range(len(own.times) - 1, len(result.times))
        for pair in result.pairs:
            if _hops([result.contact(pair).at(k) for k in outputs]):
                return HOPS
        solids = Solids.of(deck)
        label = np.asarray(result["LABEL"]).ravel().astype(int)
        order = np.argsort(label)
        rows = order[np.searchsorted(label, solids.labels, sorter=order)]
        u = [np.asarray(result.at(k)["displacement"])[rows] for k in outputs]
        dual = [(b - a)/self.size for a, b in zip(u, u[1:])]
        most, share = np.abs(u[0]).max(), self._shares(own, deck)
        # A smooth tool that moves along itself moves nothing, and has no share in the number.
        if any(np.abs(b - a).max() < ROUNDING*most for a, b, part in zip(u, u[1:], share)
               if abs(part) > SHARE):
            return LOST
        found = missed(solids, [u[0], *dual])
        sign = -1.0 if self.given else 1.0
        parts = sign*(np.einsum("d,de->e", share, found.products[1:])
                      + self._between(result, outputs, deck, solids, (u[0], dual, share)))
        if self.quantity.kind == "FORCE" and not self.quantity.set:
            parts = parts + self._of_supports(own, deck, solids, share)
        crossed, doubled = (np.einsum("d,de->e", np.abs(share), v[1:]) for v in found.unsure)
        return Estimate(found.labels, parts, found,
                        float(np.linalg.norm(crossed) + doubled.sum()))

    def _between(self, result: Result, outputs, deck: Deck, solids: Solids, known) -> NDArray:
        """What pairs that hold their gap at nodes leave between these, by element."""
        blocks = expanded(deck)
        cards = MeshCards(blocks)
        u, dual, share = known
        z = np.einsum("d,dnk->nk", share, np.array(dual))
        labels = np.concatenate([g.labels for g in solids.groups])
        row = {int(n): k for k, n in enumerate(labels)}
        parts = np.zeros(len(labels))
        pairs = Between.of(blocks, cards, solids)
        for name, pair in zip(result.pairs, pairs):
            if pair is None:
                continue
            ends = [result.contact(name).at(k) for k in outputs]
            pushed = [tractions(end) for end in ends]
            slope = np.einsum("d,dpk->pk", share, np.array(
                [(b - a)/self.size for a, b in zip(pushed, pushed[1:])]))
            for part in (pair.work(ends[0], pushed[0], z, solids, False),
                         pair.work(ends[0], slope, u, solids, True)):
                for label, value in part.items():
                    parts[row[label]] += value
        return parts

    def _of_supports(self, own: Result, deck: Deck, solids: Solids, share: NDArray) -> NDArray:
        """What supports carry of the contact of slave nodes that they hold across it (W0409), by
        element: the traction there, as the nearest two nodes continue, on the node's area."""
        blocks = expanded(deck)
        held = _Given(blocks, MeshCards(blocks)).value
        labels = np.concatenate([g.labels for g in solids.groups])
        parts = np.zeros(len(labels))
        for pair in own.pairs:
            end = own.contact(pair).last
            label = np.ravel(end["LABEL"]).astype(int)
            across = np.argmax(np.abs(end["NORMAL"]), axis=1) + 1
            wrong = np.array([(int(n), int(d)) in held for n, d in zip(label, across)], bool)
            area = np.ravel(end["WEIGHT"])
            traction = end.force/np.where(area > 0.0, area, 1.0)[:, None]
            good = np.flatnonzero(~wrong & (area > 0.0))
            for k in np.flatnonzero(wrong & (end.status > 0)):
                near = good[np.argsort(np.linalg.norm(end.x[good] - end.x[k], axis=1))[:2]]
                if len(near) < 2:
                    continue
                way = np.linalg.norm(end.x[near] - end.x[k], axis=1)
                t = (traction[near[0]]*way[1] - traction[near[1]]*way[0])/(way[1] - way[0]) \
                    if way[1] > way[0] else traction[near].mean(axis=0)
                lost = float(share @ t[[d - 1 for d in self.directions]])*area[k]
                row = int(np.searchsorted(solids.labels, label[k]))
                mine = np.concatenate([(g.nodes == row).any(axis=1) for g in solids.groups])
                parts[mine] += lost/max(1, int(mine.sum()))
        return parts

    def _shares(self, own: Result, deck: Deck) -> NDArray:
        """What each direction has in the number."""
        if self.quantity.component:
            return np.ones(1)
        vector = self.quantity.vector(own, deck)
        return vector[[d - 1 for d in self.directions]]/max(np.linalg.norm(vector), 1e-300)


@dataclass
class Estimate:
    """What the mesh leaves of a number, by element.

    Attributes
    ----------
    labels : of the elements
    parts : exact value less that of the mesh, by element
    missed : of the primal problem
    unsure : what the sum of the parts may be off by
    """

    labels: NDArray
    parts: NDArray
    missed: Missed
    unsure: float

    @property
    def change(self) -> float:
        """Exact value less that of the mesh."""
        return float(self.parts.sum())


def _hops(ends) -> bool:
    """Whether points of contact close or open by more than one that is at the edge of doing so:
    its pressure and its gap are nothing beside what all have."""
    first = ends[0]
    closed = np.ravel(first.status) > 0
    most = np.abs(np.ravel(first["CPRESS"])).max(initial=0.0), np.abs(np.ravel(first["u_n"])).max(
        initial=0.0)
    for end in ends[1:]:
        odd = (np.ravel(end.status) > 0) != closed
        for one in (first, end):
            if (np.abs(np.ravel(one["CPRESS"]))[odd] > EDGE*most[0]).any() or \
                    (np.abs(np.ravel(one["COPEN"]))[odd] > EDGE*most[1]).any():
                return True
    return False


def _step(block: Block) -> list[Block]:
    return [Block("STEP", {}), Block("STATIC", {}, [[1.0, 1.0]]), block,
            Block("NODE FILE", {}, [["U"]]), Block("EL FILE", {}, [["S"]]),
            Block("CONTACT FILE", {}, [["CDIS", "CSTR"]]), Block("END STEP", {})]


def _tools(blocks, cards: MeshCards) -> list[int]:
    """Reference nodes of the masters of all pairs; none if one is no rigid tool."""
    tool = {}
    for block in blocks:
        name = block.parameters.get("ANALYTICAL SURFACE") if block.keyword == "RIGID BODY" else None
        if name:
            tool[str(plain(name)).upper()] = cards.single(plain(block.parameters["REF NODE"]))
    nodes = []
    for block in blocks:
        for row in block.data if block.keyword == "CONTACT PAIR" else ():
            master = str(row[1]).upper()
            if master not in tool:
                return []
            nodes.append(tool[master])
    return list(dict.fromkeys(nodes))


class _Given:
    """Displacements and loads at the end of the deck."""

    def __init__(self, blocks, cards: MeshCards, moved: float = 0.0, small: float = SMALL):
        self.moved, self.small = moved, small
        self.value: dict[tuple[int, int], float] = {}
        self.load: dict[tuple[int, int], float] = {}
        self.pressures, self.reason = 0.0, ""
        for block in blocks:
            words = set(block.parameters) & {"AMPLITUDE", "TYPE", "OP", "FIXED"}
            if block.keyword in ("BOUNDARY", "CLOAD", "DLOAD", "DSLOAD"):
                if words:
                    self.reason = f"*{block.keyword}, {words.pop()}"
                for row in block.data:
                    self._read(block.keyword, row, cards)

    def _read(self, keyword: str, row, cards: MeshCards) -> None:
        if keyword in ("DLOAD", "DSLOAD"):
            self.pressures = max(self.pressures, abs(float(row[2] or 0.0)))
            return
        if not isinstance(row[1], int):
            self.reason = f"{row[1]} of *{keyword}"
            return
        last = row[2] if keyword == "BOUNDARY" and len(row) > 2 and row[2] is not None else row[1]
        at = 3 if keyword == "BOUNDARY" else 2
        value = float(row[at] or 0.0) if len(row) > at else 0.0
        for n in cards.labels(row[0]):
            for d in range(row[1], int(last) + 1):
                (self.value if keyword == "BOUNDARY" else self.load)[n, d] = value

    def scale(self, solids: Solids) -> float:
        """Size of displacements [length]."""
        most = self.moved or max(map(abs, self.value.values()), default=0.0)
        return most or self._pressed(solids)*self._size(solids)

    def force(self, solids: Solids) -> float:
        """Size of forces [force]."""
        group, size = solids.groups[0], self._size(solids)
        across = group.thickness*size if group.kind.startswith("plane") else size**2
        return self.scale(solids)/size*max(g.young for g in solids.groups)*across

    def _pressed(self, solids: Solids) -> float:
        """Strains that the loads make."""
        group, size = solids.groups[0], self._size(solids)
        across = group.thickness*size if group.kind.startswith("plane") else size**2
        most = max(map(abs, self.load.values()), default=0.0)/across
        return (most + self.pressures)/min(g.young for g in solids.groups)

    @staticmethod
    def _size(solids: Solids) -> float:
        return float(np.ptp(solids.x, axis=0).max())
