"""The tools that a body meets, where they stand now."""
from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ..model_read_mesh import plain
from ..points import Tractions
from .body import Body, DeckParts, pair_names
from .masters import FacetMaster, feet_under_slaves
from .state import Snapshot


@dataclass
class Tools:
    """Contact pairs whose slave lies on the body and whose master is a tool, or of another body,
    and pairs whose master lies on the body.

    Attributes
    ----------
    session : the open run
    pairs : number of each pair from 0, and the tags that mark its slave
    masters : surfaces of element faces, by the number of their pair
    backs : tag of a master, and the surface of element faces that is its slave
    folds : pairs of a surface with itself: number, tags
    """

    session: object
    pairs: list[tuple[int, frozenset]] = field(default_factory=list)
    masters: dict[int, FacetMaster] = field(default_factory=dict)
    backs: list[tuple[tuple, FacetMaster]] = field(default_factory=list)
    folds: list[tuple[int, frozenset]] = field(default_factory=list)

    @classmethod
    def of(cls, session, parts: DeckParts, ndim: int) -> Tools:
        """Of the deck of an open run."""
        pairs, number, points, masters, backs, folds = [], 0, {}, {}, [], []
        for block in parts.blocks:
            if block.keyword == "SURFACE" and \
                    str(plain(block.parameters.get("TYPE", ""))).upper() == "NODE":
                name = str(plain(block.parameters["NAME"])).upper()
                points[name] = {("N", str(row[0]).upper()) for row in block.data}
            if block.keyword != "CONTACT PAIR":
                continue
            for row in block.data:
                slave, master = pair_names(row)
                pairs.append((number, frozenset({("S", slave)} | points.get(slave, set()))))
                if master == slave:
                    folds.append(pairs[-1])
                found = FacetMaster.of(parts, master, ndim) if master != slave else None
                if found is not None:
                    masters[number] = found
                    face = FacetMaster.of(parts, slave, ndim)
                    if face is not None:
                        backs.append((("S", master), face))
                number += 1
        return cls(session, pairs, masters, backs, folds)

    def closest(self, number: int, points: NDArray) -> NDArray | None:
        """Closest points of the master of a pair: a row each of gap, overhang, point, normal."""
        if number in self.masters:
            return self.masters[number].feet(points, self.session.field("STATE OF MOTION"))
        return self.session.tool_feet(number, points)

    def meets_metal(self, number: int) -> bool:
        """Whether the master of a pair is of another body of solids, or the body itself."""
        return number in dict(self.folds) or \
            (number in self.masters and not self.masters[number].rigid)

    def feet_of_nodes(self, body: Body, x: NDArray, facets: NDArray, tags: list[frozenset]):
        """For each tool, and each other body, the nodes of a skin that may meet it, and their
        closest points; where the skin is the master, the nodes under the slaves, their places."""
        for number, slave in self.pairs:
            nodes = nodes_within(facets, tags, slave)
            feet = self.closest(number, x[nodes]) if len(nodes) else None
            if feet is not None:
                yield nodes, feet
        for master, face in self._slaves_of_others(body):
            own = facets[[master in tag for tag in tags]]
            if len(own):
                yield feet_under_slaves(x, own, *self._places_of_slaves(face))

    def _places_of_slaves(self, face: FacetMaster) -> tuple[NDArray, NDArray]:
        """Present places of the nodes of a slave, and whether they bear."""
        t = Tractions.of(self.session)
        loaded = [] if t is None else t.node[np.abs(t.traction).max(axis=1) > 0.0]
        return face.places(self.session.field("STATE OF MOTION")), np.isin(face.labels, loaded)

    def _slaves_of_others(self, body: Body):
        """Masters on the body whose slaves are on other bodies."""
        return [(master, face) for master, face in self.backs
                if not np.isin(face.labels, body.labels).any()]

    def feet_of_facets(self, x: NDArray, facets: NDArray, tags: list[frozenset]):
        """For each tool the facets that may meet it, and the closest points of their middles."""
        for number, slave in self.pairs:
            rows = np.array([k for k, tag in enumerate(tags) if tag & slave], int)
            feet = self.closest(number, x[facets[rows]].mean(axis=1)) \
                if len(rows) else None
            if feet is not None:
                yield rows, feet

    def pressed(self, body: Body, state: Snapshot) -> NDArray:
        """Whether each node of the body bears a traction, or lies where slaves do (node,)."""
        bears = np.zeros(len(body.labels), bool)
        if state.tractions is None:
            return bears
        loaded = state.tractions.node[np.abs(state.tractions.traction).max(axis=1) > 0.0]
        bears = np.isin(body.labels, loaded)
        for master, face in self._slaves_of_others(body):
            nodes = nodes_within(body.facets, body.tags, frozenset({master}))
            if len(nodes):
                bears[nodes] |= face.bears(state.x[nodes], state.motion, loaded)
        return bears

    def pressed_on_itself(self, number: int, body: Body, state: Snapshot) -> NDArray:
        """Whether each node of the body bears a traction of one pair (node,)."""
        if state.tractions is None:
            return np.zeros(len(body.labels), bool)
        bears = np.abs(state.tractions.traction).max(axis=1) > 0.0
        return np.isin(body.labels, state.tractions.node[bears & (state.tractions.pair == number)])

    def arcs(self, x: NDArray, facets: NDArray, tags: list[frozenset], reach: float):
        """Places of facets near the tools, and the radius of the tool there, from the turn of its
        normals between the ends of each facet."""
        for number, slave in self.pairs:
            rows = np.array([k for k, tag in enumerate(tags) if tag & slave], int)
            if len(rows) == 0 or number in self.masters:
                continue
            n, d = facets.shape[1], x.shape[1]
            feet = self.session.tool_feet(number, x[facets[rows]].reshape(-1, d))
            if feet is None:
                continue
            feet = feet.reshape(len(rows), n, -1)
            point, normal = feet[..., 2:2 + d], feet[..., 2 + d:]
            near = np.abs(feet[..., 0]).min(axis=1) < reach
            way = np.linalg.norm(point - np.roll(point, 1, axis=1), axis=2).max(axis=1)
            turn = np.linalg.norm(normal - np.roll(normal, 1, axis=1), axis=2).max(axis=1)
            bent = near & (turn > 1e-6)
            yield x[facets[rows[bent]]].mean(axis=1), way[bent]/turn[bent]


def nodes_within(facets: NDArray, tags: list[frozenset], wanted: frozenset) -> NDArray:
    """Nodes of the facets that have a tag of those wanted."""
    own = np.array([bool(tag & wanted) for tag in tags], bool)
    return np.unique(facets[own])
