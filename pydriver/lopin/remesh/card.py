"""*REMESH: what a deck asks of its remeshes."""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..deck import Block
from ..model_read_mesh import plain
from .body import Body


@dataclass
class RemeshCard:
    """Values of the card; None where it leaves the choice.

    Attributes
    ----------
    elset : elements of the body
    size, smallest, hausdorff : lengths [length]
    growth : ratio of the sizes of neighbours
    quality, penetration, strain, period : triggers
    most : remeshes of a run
    cuts : of each criterion with a critical value: its column of damage, the value, the length of
        cells that metal near it has
    """

    elset: str
    size: float | None = None
    smallest: float | None = None
    hausdorff: float | None = None
    growth: float = 1.3
    quality: float = 0.15
    penetration: float = 0.05
    strain: float = 0.5
    period: float | None = None
    most: int = 50
    cuts: tuple[tuple[int, float, float], ...] = ()

    @classmethod
    def of(cls, block: Block) -> RemeshCard:
        """Of a card that the reader of decks has checked."""
        given = {name.lower(): plain(value) for name, value in block.parameters.items()}
        numbers = {name: float(str(given[name]).upper().replace("D", "E")) for name in given
                   if name not in ("elset", "most")}
        most = {"most": int(given["most"])} if "most" in given else {}
        return cls(str(given["elset"]).upper(), **numbers, **most)

    def filled(self, body: Body) -> RemeshCard:
        """With the sizes that the first mesh of the body stands for."""
        size = self.size or mean_edge(body)
        return RemeshCard(**{**vars(self), "size": size,
                             "smallest": self.smallest or 0.2*size,
                             "hausdorff": self.hausdorff or 0.01*size})


def mean_edge(body: Body) -> float:
    """Mean length of the edges of the elements [length]."""
    lengths = [np.linalg.norm(body.x[g] - body.x[np.roll(g, -1, axis=1)], axis=2).ravel()
               for g in body.cells]
    return float(np.concatenate(lengths).mean())
