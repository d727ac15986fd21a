"""Decks with other increments or another path, and whether their answer depends on them."""
from __future__ import annotations

import math
from dataclasses import dataclass

from ..deck import Block, Deck
from ..model_read_mesh import expanded
from ..result import Result

_MEMORY = ("PLASTIC", "VISCOPLASTIC", "CREEP", "VISCO", "CHANGE FRICTION")
_BEHAVIOURS = ("SURFACE BEHAVIOR", "CHANGE SURFACE BEHAVIOR")


def depends_on_path(deck: Deck) -> bool:
    """Whether the answer depends on the way to it: friction, metal that flows, NO SEPARATION."""
    for block in expanded(deck):
        if block.keyword in _MEMORY:
            return True
        if block.keyword in _BEHAVIOURS and "NO SEPARATION" in block.parameters:
            return True
        if block.keyword == "FRICTION" and _rubs(block):
            return True
    return False


def _rubs(block: Block) -> bool:
    """Whether a *FRICTION is more than a coefficient of nothing."""
    numbers = [v for row in block.data for v in row if isinstance(v, int | float)]
    return any(numbers[:1]) or "ROUGH" in block.parameters or bool(
        set(block.parameters) - {"LAW"} and not numbers)


def on_path(deck: Deck, path: str) -> Deck | None:
    """The deck on a path; None if it names one itself."""
    blocks = expanded(deck)
    own = next((b for b in blocks if b.keyword == "LOPIN"), None)
    if own is None:
        at = next(k for k, b in enumerate(blocks) if b.keyword == "STEP")
        blocks.insert(at, Block("LOPIN", {"PATH": path}))
    elif "PATH" in own.parameters:
        return None
    else:
        blocks[blocks.index(own)] = Block("LOPIN", {**own.parameters, "PATH": path})
    return Deck(blocks, preamble=deck.preamble, name=deck.name, folder=deck.folder)


#: The fall of changes that is believed, as an implicit step leaves it; the fastest there may be.
FALL, FASTEST = 2.0, 4.0


def left_by_increments(changes: list[float], fall: float = FALL) -> list[float]:
    """What is left of the error in each of some runs in increments of half the length each time,
    by the changes from one to the next: the sum of those that follow, and of those to come. Theirs
    fall as the last two did, by half at least and by `fall` at most: to more than the half is a
    chance, since the first run is of increments that grew as they liked, not of twice the length of
    the next. Changes to and fro, or one alone, are taken for as large as the last.

    >>> left_by_increments([4.0]), left_by_increments([9.0, 3.0])
    ([8.0, 4.0], [15.0, 6.0, 3.0])
    """
    last = abs(changes[-1])
    if len(changes) > 1 and changes[-1]*changes[-2] > 0.0:
        last /= min(max(changes[-2]/changes[-1], FALL), fall) - 1.0
    left = [last]
    for change in reversed(changes):
        left.insert(0, left[0] + abs(change))
    return left


@dataclass
class Settled:
    """What increments of some length leave on the first mesh.

    Attributes
    ----------
    most, least : of the number; `least` is 0 where the changes have no order
    sign : of what is left: that of the changes; 0: the number has none, or they go to and fro
    by_factor : `most` by the length beside that of the deck
    """

    most: float
    least: float
    sign: float
    by_factor: dict[float, float]

    @classmethod
    def of(cls, factors: list[float], changes: list[float], enough: int,
           signed: bool) -> Settled:
        """Of the run `enough` of those in increments of `factors`."""
        left, least = left_by_increments(changes), left_by_increments(changes, FASTEST)
        ordered = len(changes) > 1 and changes[-1]*changes[-2] > 0.0
        return cls(left[enough], 0.5*least[enough] if ordered else 0.0,
                   math.copysign(1.0, changes[-1]) if signed and (ordered or len(changes) == 1)
                   else 0.0, dict(zip(factors, left)))

    def at(self, factor: float) -> float:
        """`most` of another length."""
        least = min(self.by_factor)
        return self.by_factor[factor] if factor in self.by_factor else \
            self.by_factor[least]*factor/least


def with_smaller(deck: Deck, result: Result, factor: float) -> Deck:
    """The deck whose increments are `factor` times those that a run of it took on the mean.

    The first of a step is no longer than that; where the deck asks for fixed ones (DIRECT), all
    are smaller.
    """
    steps, number = result.summary["steps"], -1
    new = Deck(preamble=deck.preamble, name=deck.name, folder=deck.folder)
    for block in expanded(deck):
        if block.keyword == "STEP":
            number += 1
            block = _room(block, factor)
        elif block.keyword == "STATIC":
            block = _shorter(block, factor, max(1, steps[number]["increments"]))
        new.blocks.append(block)
    return new


def _room(block: Block, factor: float) -> Block:
    """A *STEP that allows for more increments."""
    if "INC" not in block.parameters:
        return block
    given = dict(block.parameters)
    given["INC"] = int(int(str(given["INC"]))/factor) + 1
    return Block("STEP", given)


def _shorter(block: Block, factor: float, count: int) -> Block:
    """A *STATIC with smaller increments; `count`: those that its step took."""
    row = list(block.data[0]) if block.data else []
    row += [None]*(4 - len(row))
    period = float(row[1]) if row[1] is not None else 1.0
    if "DIRECT" in block.parameters:
        return Block("STATIC", block.parameters, [[factor*float(row[0] or period), period]])
    most = factor*period/count
    if row[3] is not None:
        most = min(most, factor*float(row[3]))
    first = min(most, float(row[0]) if row[0] is not None else most)
    least = min(float(row[2]) if row[2] is not None else 1e-5*period, first)
    return Block("STATIC", block.parameters, [[first, period, least, most]])
