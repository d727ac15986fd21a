"""The mesh of the next run: finer everywhere, or where the parts of the error say."""
from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..deck import Deck
from ..errors import ModelError
from ..refine import refined, size_of_refined
from ..refine.local import LocalMesh

#: What is left of a part of the error when its cell is halved.
LEFT = 0.25
#: Passes over the mesh at once, and the most that the sum of the parts falls by at once: what the
#: coarse mesh tells does not reach further.
PASSES, AT_ONCE = 2, 5.0
#: Where the first cut was not enough, cells of the next mesh beside the last before neighbours are
#: cut too, at least: a few cells more cost another run of all others.
GROWTH = 1.4


class Meshes:
    """A deck and its finer meshes.

    Attributes
    ----------
    deck : the last one, to run
    n_element : its solid elements; 0: as the deck came
    filled_in, rounded : as of `lopin.refine.Refined`
    uniform : every cell of the mesh before was halved
    """

    def __init__(self, deck: Deck):
        self.deck, self.n_element, self.filled_in, self.uniform = deck, 0, 0, True
        self.rounded = 0.0
        self._local: LocalMesh | None = None
        self._whole = deck, 0

    def begin_again(self) -> None:
        """From the last mesh that was not refined in part."""
        self.deck, self.n_element = self._whole
        self._local = None

    def size(self) -> int:
        """Solid elements if every cell is halved."""
        return size_of_refined(self.deck)

    def halve(self) -> None:
        """Every cell."""
        self.uniform = True
        self._local = None
        finer = refined(self.deck)
        self.deck, self.n_element = self._whole = finer.deck, finer.n_element
        self.filled_in = max(self.filled_in, finer.filled_in)
        self.rounded = max(self.rounded, finer.rounded)

    def spend(self, labels: NDArray, parts: NDArray, goal: float) -> bool:
        """Halve cells until the sum of the sizes of their parts should be `goal`; whether it could
        be: meshes in space are refined everywhere or not at all."""
        first = local = self._local or LocalMesh(self.deck)
        own = dict(zip(labels.tolist(), np.abs(parts).tolist()))
        every = np.sort(np.abs(parts))[::-1]
        least = equal_parts(every, max(goal, every.sum()/AT_ONCE))
        if self._local is not None:   # a cell that is halved is four
            least = min(least, every[min(int((GROWTH - 1.0)/3.0*len(every)), len(every) - 1)])
        try:
            for _ in range(PASSES):
                marked = [label for label, part in own.items() if part > least]
                if not marked:
                    break
                local = local.refined(marked)
                own = local.inherited(own, LEFT)
        except ModelError:
            return False
        if local is first:
            return False   # no part stands out
        self.uniform = False
        self._take(local)
        return True

    def _take(self, local: LocalMesh) -> None:
        self._local, self.deck, self.n_element = local, local.deck, local.n_element
        self.filled_in = max(self.filled_in, local.filled_in)
        self.rounded = max(self.rounded, local.rounded)


def equal_parts(parts: NDArray, goal: float) -> float:
    """The largest part that a cell may keep so that the sum comes to the goal: a cell with more is
    halved, and its four children again, `PASSES` times at most.

    >>> equal_parts(np.array([4.0, 1.0, 8.0]), 7.5)
    4.0
    """
    # A cell is halved k times where its part in a child of k - 1 halvings is above the limit.
    steps = (0.25*LEFT)**np.arange(PASSES)
    limits = (parts[:, None]*steps).ravel()
    gains = (parts[:, None]*LEFT**np.arange(PASSES)*(1.0 - LEFT)).ravel()
    order = np.argsort(-limits, kind="stable")
    left = parts.sum() - np.cumsum(gains[order])
    enough = np.flatnonzero(left <= goal)
    if parts.sum() <= goal:
        return float(parts.max(initial=0.0))
    if not len(enough):
        return 0.0
    at = enough[0] + 1
    return float(limits[order[at]]) if at < len(order) else 0.0
