"""*REMESH: what a deck asks of its remeshes."""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..deck import Block
from ..errors import ModelError
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
        card = cls(str(given["elset"]).upper(), **numbers, **most)
        card.refuse_nonsense()
        return card

    def refuse_nonsense(self) -> None:
        """Numbers that ask for no mesh at all."""
        for name in ("size", "smallest", "hausdorff", "penetration", "strain", "period", "quality"):
            value = getattr(self, name)
            if value is not None and not value > 0.0:
                raise _senseless(name, value, "it is above 0; leave it out for a choice")
        if not self.growth > 1.0:
            raise _senseless("growth", self.growth, "cells grow by a ratio above 1, such as 1.3")
        if not self.quality < 1.0:
            raise _senseless("quality", self.quality, "1 is a right angle: take 0.15")
        if self.most < 0:
            raise _senseless("most", self.most, "0: no mesh is made anew")
        if self.size and self.smallest and self.smallest > self.size:
            raise _senseless("smallest", self.smallest, f"SIZE is {self.size:g}, the largest")

    def filled(self, body: Body) -> RemeshCard:
        """With the sizes that the first mesh of the body stands for."""
        size = self.size or mean_edge(body)
        if self.smallest and self.smallest > size:
            raise _senseless("smallest", self.smallest,
                             f"the edges of the first mesh are {size:.4g} long: give SIZE")
        return RemeshCard(**{**vars(self), "size": size,
                             "smallest": self.smallest or 0.2*size,
                             "hausdorff": self.hausdorff or 0.01*size})


def _senseless(name: str, value: float, why: str) -> ModelError:
    return ModelError(f"{name.upper()}={value:g} of *REMESH makes no sense", id="E0106", help=why)


def mean_edge(body: Body) -> float:
    """Mean length of the edges of the elements [length]."""
    lengths = [np.linalg.norm(body.x[g] - body.x[np.roll(g, -1, axis=1)], axis=2).ravel()
               for g in body.cells]
    return float(np.concatenate(lengths).mean())
