"""The state of integration points, carried from one mesh to another."""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from . import _bridge
from .errors import UsageError


def _table(session: _bridge.Session, name: str) -> NDArray | None:
    """A table of an open run, a row an item; None where it has none."""
    try:
        return session.field(name)
    except UsageError:
        return None


@dataclass
class Points:
    """One row an integration point that remembers, in the present shape.

    Attributes
    ----------
    element : labels of the elements (point,)
    number : of each point in its element, from 1 (point,)
    place : present coordinates (point, 3) [length]
    volume : present volumes (point,) [length^3]
    strain : deviator of the elastic logarithmic strain, xx yy zz xy xz yz, tensor components
        (point, 6)
    dilatation : ln J of the elastic part (point,)
    ratio : ln of the present volume over the one that energies count by (point,)
    plastic : accumulated plastic strain (point,)
    flow_stress : of the last flow (point,) [stress]
    work : plastic work per volume of the law (point,) [stress]
    damage : by criterion, in the order of ``*DAMAGE``; 0 where none is counted (point, 4)
    damage_mean : the same over the width of each criterion (point, 4)
    """

    element: NDArray
    number: NDArray
    place: NDArray
    volume: NDArray
    strain: NDArray
    dilatation: NDArray
    ratio: NDArray
    plastic: NDArray
    flow_stress: NDArray
    work: NDArray
    damage: NDArray
    damage_mean: NDArray

    @classmethod
    def of(cls, session: _bridge.Session) -> Points | None:
        """Of an open run."""
        table = _table(session, "STATE OF POINTS")
        if table is None:
            return None
        damage = _table(session, "STATE OF DAMAGE")
        if damage is None:
            damage = np.zeros((len(table), 8))
        return cls(table[:, 0].astype(int), table[:, 1].astype(int), table[:, 2:5], table[:, 5],
                   table[:, 6:12], *table[:, 12:17].T, damage[:, :4], damage[:, 4:])

    def within(self, elements: NDArray) -> Points:
        """Of these elements alone, by their labels."""
        own = np.isin(self.element, elements)
        return Points(**{name: values[own] for name, values in vars(self).items()})

    def lines(self) -> str:
        """Data lines of ``*INITIAL CONDITIONS, TYPE=STATE``, to the last bit."""
        numbers = np.column_stack([self.strain, self.dilatation, self.ratio, self.plastic,
                                   self.flow_stress, self.work])
        if self.damage.any():
            numbers = np.column_stack([numbers, self.damage])
        return "".join(f"{e}, {k}, {', '.join(map(repr, row))}\n" for e, k, row in
                       zip(self.element.tolist(), self.number.tolist(), numbers.tolist()))


@dataclass
class Tractions:
    """One row a slave node of a contact pair.

    Attributes
    ----------
    pair : number of the pair in the deck, from 0 (point,)
    node : labels (point,)
    traction : on the slave (point, 3) [stress]
    slip : from the stick anchor, of laws that are regularised by slip (point, 3) [length]
    """

    pair: NDArray
    node: NDArray
    traction: NDArray
    slip: NDArray

    @classmethod
    def of(cls, session: _bridge.Session) -> Tractions | None:
        """Of an open run."""
        table = _table(session, "STATE OF CONTACT")
        if table is None:
            return None
        return cls(table[:, 0].astype(int) - 1, table[:, 1].astype(int), table[:, 2:5],
                   table[:, 5:])

    def lines(self, names: list[tuple[str, str]]) -> str:
        """Data lines of ``*INITIAL CONDITIONS, TYPE=TRACTION``; names: (slave, master) of each
        pair. Nodes that bear nothing are left out."""
        rows = zip(self.pair.tolist(), self.node.tolist(),
                   np.hstack([self.traction, self.slip]).tolist())
        return "".join(f"{', '.join(names[pair])}, {node}, {', '.join(map(repr, row))}\n"
                       for pair, node, row in rows if any(row))
