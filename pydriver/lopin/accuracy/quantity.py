"""The number that a run is asked for, and how two runs differ in it."""
from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..deck import Block, Deck, Row
from ..errors import LopinError, ModelError, UsageError
from ..model_read_mesh import MeshCards, expanded, located, plain
from ..result import Result

#: A sum of forces below this share of their sizes is rounding.
ROUNDING = 1e-9
#: Values of a force that are looked at for a ripple at least, how often they turn at least, and the
#: share of the largest way between two turns that is a way at all.
RIPPLES, TURNS, WAY = 12, 3, 0.1
#: The share that W0333 names.
UNEVEN = re.compile(r"uneven by about ([0-9.eE+-]+) %")
DIRECTIONS = "1 to 3, or 0 for the length; moments and rotations cannot be asked for"
#: Share of the largest pressure from which another is beside it.
BESIDE_PEAK = 0.9
KINDS = ("PRESSURE", "PEAK PRESSURE", "FORCE", "PEAK FORCE", "DISPLACEMENT", "SPRINGBACK")


@dataclass(frozen=True)
class Quantity:
    """What is asked for.

    Attributes
    ----------
    kind : PRESSURE (root of the integral of its square over the slave surfaces: runs differ by the
        pressures at common nodes), PEAK PRESSURE, FORCE (on a tool's reference node, or on the
        slave surfaces where no set is named), PEAK FORCE (the largest of it over the run),
        DISPLACEMENT (mean over a set) and SPRINGBACK (what
        the last step adds to it)
    set : node set or label; empty: none
    component : 1, 2, 3; 0: the length of the vector
    nodes : labels that a displacement is the mean of, whatever the mesh; empty: those of the set.
        On finer meshes a set holds more nodes, and more of them where cells are smaller.
    """

    kind: str
    set: str = ""
    component: int = 0
    nodes: tuple[int, ...] = ()

    def __post_init__(self):
        if self.kind not in KINDS:
            raise UsageError(f"QUANTITY={self.kind} is not known",
                             help=f"one of {', '.join(KINDS)}")
        if self.kind in ("DISPLACEMENT", "SPRINGBACK") and not self.set:
            raise UsageError(f"QUANTITY={self.kind} needs SET=, the nodes that it is asked of")
        if not 0 <= self.component <= 3:
            raise UsageError(f"COMPONENT={self.component} is no direction", help=DIRECTIONS)

    @classmethod
    def of(cls, deck: Deck) -> tuple[Quantity, float] | None:
        """What the *LOPIN of a deck asks for, and the relative error; None if it asks for none."""
        block, file, line = _card_of(deck)
        if block is None:
            return None
        with at(file, line):
            return cls._of_card({k: plain(v) for k, v in block.parameters.items()})

    @classmethod
    def _of_card(cls, given: dict) -> tuple[Quantity, float]:
        """By the parameters of a card; numbers as the reader of decks takes them (5D-2, too)."""
        component, target = (Row.read(str(given.get(name, default)))[0] for name, default in
                             (("COMPONENT", 0), ("TARGET ERROR", 0.01)))
        if not isinstance(component, int):
            raise UsageError(f"COMPONENT={component} is no direction", help=DIRECTIONS)
        if not isinstance(target, int | float) or not 0.0 < target < 1.0:
            raise UsageError(f"TARGET ERROR={target} is not between 0 and 1")
        return cls(" ".join(str(given["QUANTITY"]).upper().split()),
                   str(given.get("SET", "")).upper(), component), float(target)

    def checked(self, deck: Deck) -> Quantity:
        """Itself, if a run of the deck can answer it."""
        if not self.set:
            return self
        blocks = expanded(deck)
        cards = MeshCards(blocks)
        asked = set(labels_of(cards, self.set))
        if "FORCE" in self.kind and not asked & driven(blocks, cards):
            raise ModelError(f"SET={self.set}: no node of it is held, driven or a tool's: there is "
                             "no force on it, only rounding",
                             help="without SET it is that of all contact")
        return self

    def of_nodes(self, deck: Deck) -> Quantity:
        """The same for any finer mesh of a deck: a displacement is that of the deck's own nodes."""
        if self.kind not in ("DISPLACEMENT", "SPRINGBACK"):
            return self
        return replace(self, nodes=tuple(labels_of(MeshCards(expanded(deck)), self.set)))

    def __str__(self) -> str:
        words = [self.kind.lower()]
        if self.set:
            words.append(f"of {self.set}")
        if self.component:
            words.append(f"in direction {self.component}")
        return " ".join(words)

    def value(self, result: Result, deck: Deck) -> float:
        """Of a run; `deck` is the one that was run."""
        if self.kind in ("PRESSURE", "PEAK PRESSURE"):
            pressure, weight, _ = pressures(result)
            return float(pressure.max(initial=0.0) if self.kind == "PEAK PRESSURE" else
                         np.sqrt(weight @ pressure**2))
        if self.kind == "PEAK FORCE":
            every = self._forces(result, deck, range(len(result.times)))
            return max(map(self.of_vector, every), key=abs)
        return self.of_vector(self.vector(result, deck))

    def vector(self, result: Result, deck: Deck) -> NDArray:
        """The force or displacement of which the number is a component or the length."""
        if self.kind == "FORCE":
            return self._forces(result, deck, [-1])[0]
        rows = _rows(result, deck, self.set, self.nodes)
        moved = np.asarray(result["displacement"])[rows].mean(axis=0)
        if self.kind == "SPRINGBACK":
            moved = moved - np.asarray(result.at(_before_last_step(result))["displacement"]
                                       )[rows].mean(axis=0)
        return moved

    def of_vector(self, vector: NDArray) -> float:
        if self.component:
            if self.component > len(vector):
                raise UsageError(f"COMPONENT={self.component}: the vector has {len(vector)}",
                                 help=DIRECTIONS)
            return float(vector[self.component - 1])
        return float(np.linalg.norm(vector))

    def _forces(self, result: Result, deck: Deck, at: Iterable[int]) -> list[NDArray]:
        """At outputs of the run."""
        if not self.set:
            if not result.pairs:
                raise ModelError("a force without SET is that of contact: the deck has none")
            return [_of_contact(result, k) for k in at]
        rows = _rows(result, deck, self.set)
        if len(rows) and "RF" in result.names:
            return [np.asarray(result.at(k)["reaction"])[rows].sum(axis=0) for k in at]
        raise ModelError(f"no forces are known of {self.set}")

    def change(self, apart: float, value: float, before: float) -> float:
        """How far a run is apart from the one before, with its sign where the number has one."""
        return apart if self.kind == "PRESSURE" else math.copysign(apart, value - before)

    def uneven(self, result: Result) -> float:
        """What W0333 says of the pressures that are asked for [-]."""
        if "PRESSURE" not in self.kind:
            return 0.0
        shares = [UNEVEN.search(line) for line in result.warnings if line.startswith("W0333")]
        return max((0.01*float(s.group(1)) for s in shares if s), default=0.0)

    def ripple(self, result: Result, deck: Deck) -> float:
        """Half the swing of a force that goes to and fro about its peak, or in the last half of the
        last step, as it does while nodes leave a tool one by one: where in it the increments find
        the peak, or the end falls, is chance."""
        if self.kind == "PEAK FORCE":
            every = [self.of_vector(v) for v in
                     self._forces(result, deck, range(len(result.times)))]
            peak = int(np.argmax(np.abs(every)))
            near = np.abs(np.asarray(result.times) - result.times[peak]) <= 0.25*_last_step(result)
            near[max(0, peak - RIPPLES//2):peak + RIPPLES//2 + 1] = True
            return swing([v for v, is_near in zip(every, near, strict=True) if is_near])
        if self.kind != "FORCE":
            return 0.0
        first = _begin_of_last_step(result) + 1
        half = int(np.searchsorted(result.times, result.times[-1] - 0.5*_last_step(result)))
        rows = range(max(first, min(half, len(result.times) - RIPPLES)), len(result.times))
        return swing([self.of_vector(v) for v in self._forces(result, deck, rows)])

    def moved(self, fine: Result, coarse: Result, values: tuple[float, float]) -> float:
        """How far a mesh is from the coarser one. The largest pressure may change place from mesh
        to mesh, so that its changes cancel: those of the pressures beside it count, too."""
        apart = self.difference(fine, coarse, values)
        both = common(fine, coarse) if self.kind == "PEAK PRESSURE" else None
        if both is None:
            return apart
        near = np.maximum(*both) >= BESIDE_PEAK*max(values)
        return max(apart, float(np.abs(both[0] - both[1])[near].max(initial=0.0)))

    def difference(self, fine: Result, coarse: Result, values: tuple[float, float]) -> float:
        """How far two runs are apart; `values` of the fine one and of the coarse one."""
        if self.kind != "PRESSURE":
            return abs(values[0] - values[1])
        both = common(fine, coarse)
        if both is None:
            return abs(values[0] - values[1])
        # What lies between common nodes, as beside a support, is in the values alone.
        weight = pressures(coarse)[1]
        return max(float(np.sqrt(weight @ (both[0] - both[1])**2)), abs(values[0] - values[1]))


def swing(values: list[float]) -> float:
    """Half the mean way between the turning points of values that turn `TURNS` times, or more; of
    others 0.

    Ways that are small beside the largest are of no turn, so that the spacing of the values does
    not count.

    >>> swing([0.0, 2.0, 1.0, 3.0, 2.0, 4.0, 3.0]), swing([1.0, 2.0, 3.0, 2.9, 3.5, 4.0])
    (0.75, 0.0)
    """
    ends = np.asarray(values, float)
    while len(ends) > 2:
        way = np.diff(ends)
        straight = way[1:]*way[:-1] >= 0.0
        if straight.any():
            ends = np.delete(ends, int(np.argmax(straight)) + 1)
            continue
        inner = np.abs(way[1:-1])
        if len(inner) == 0 or inner.min() >= WAY*inner.max():
            break
        least = int(np.argmin(inner)) + 1
        ends = np.delete(ends, [least, least + 1])
    turns = ends[1:-1]
    return float(0.5*np.abs(np.diff(turns)).mean()) if len(turns) >= TURNS else 0.0


def _begin_of_last_step(result: Result) -> int:
    """The output that the last step begins with; -1: there is no other step."""
    return _before_last_step(result) if len(set(result.history["step"])) > 1 else -1


def _last_step(result: Result) -> float:
    """Duration of the last step."""
    before = _begin_of_last_step(result)
    return float(result.times[-1] - (result.times[before] if before >= 0 else 0.0))


def _of_contact(result: Result, at: int) -> NDArray:
    """The sum of all contact forces on slaves at an output."""
    ends = [result.contact(k).at(at).force for k in range(len(result.pairs))]
    total = np.sum([f.sum(axis=0) for f in ends], axis=0)
    size = sum(np.abs(f).sum() for f in ends)
    # Two tools that press from both sides: what is left of their forces is rounding.
    return np.where(np.abs(total) > ROUNDING*size, total, 0.0)


def pressures(result: Result) -> tuple[NDArray, NDArray, NDArray]:
    """Pressures, areas and labels of all slave points at the end."""
    ends = [result.contact(k).last for k in range(len(result.pairs))]
    if not ends:
        raise ModelError("the pressure is asked of a deck without contact")
    return tuple(np.concatenate([np.ravel(c[name]) for c in ends])
                 for name in ("CPRESS", "WEIGHT", "LABEL"))


def common(fine: Result, coarse: Result) -> tuple[NDArray, NDArray] | None:
    """Pressures of both runs at the slave nodes of the coarse one; None: the fine one lacks one."""
    mine, _, label = pressures(fine)
    other, _, old = pressures(coarse)
    at = {int(n): k for k, n in enumerate(label)}
    rows = np.array([at.get(int(n), -1) for n in old], int)
    return None if (rows < 0).any() else (mine[rows], other)


def _rows(result: Result, deck: Deck, name: str, nodes: tuple[int, ...] = ()) -> NDArray:
    """Rows of the nodes of a set, of a label, or of labels, in the fields of a result."""
    own = np.asarray(result["LABEL"]).ravel().astype(int)
    return np.flatnonzero(np.isin(own, nodes or labels_of(MeshCards(expanded(deck)), name)))


def labels_of(cards: MeshCards, name: str) -> list[int]:
    """Nodes of a set, or of a label."""
    if name.isdigit() and int(name) in cards.nodes:
        return [int(name)]
    if name.isdigit():
        raise ModelError(f"SET={name}: there is no such node", id="E0201")
    if name in cards.nsets:
        return list(dict.fromkeys(cards.nsets[name]))
    raise ModelError(f"SET={name}: there is no such node set", id="E0201",
                     help=f"node sets: {', '.join(cards.nsets)}")


def driven(blocks: list[Block], cards: MeshCards) -> set[int]:
    """Nodes that a support, a motion or a tool may have forces on."""
    names = [row[0] for block in blocks if block.keyword == "BOUNDARY" for row in block.data]
    found = {cards.single(name) for name in cards.references}
    for name in set(names):
        found.update(labels_of(cards, str(name).upper()))
    return found


def _card_of(deck: Deck) -> tuple[Block | None, str, int]:
    """The card that asks, with its file and line."""
    return next(((block, file, line) for block, file, line in located(deck)
                 if block.keyword == "LOPIN" and "QUANTITY" in block.parameters), (None, "", 0))


def place_of(deck: Deck) -> tuple[str, int]:
    """File and line of the card that asks; nowhere: '' and 0."""
    return _card_of(deck)[1:]


@contextmanager
def at(file: str, line: int) -> Iterator[None]:
    """Errors that have no place are of this one."""
    try:
        yield
    except LopinError as problem:
        if not problem.file:
            problem.file, problem.line, problem.column = file, line, 1
        raise


def _before_last_step(result: Result) -> int:
    """The last output of the step before the last."""
    steps = np.asarray(result.history["step"])
    times = np.asarray(result.history["time"])
    before = times[steps < steps.max()]
    if not len(before):
        raise ModelError("QUANTITY=SPRINGBACK is what the last of several steps adds")
    kept = np.asarray(result.times)
    return int(np.argmin(np.abs(kept - before[-1])))
