"""Surfaces of elements that a body meets: closest points, as those of the tools are told."""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..mesh.cells import CELLS
from ..model_read_mesh import PLANE, SOLID, MeshCards
from .body import DeckParts
from .space import closest_on_facets

#: Words of rigid facets: their faces are their two sides, SPOS (S2 of shells) and SNEG (S1).
SIDED = ("R2D2", "RAX2", "R3D3", "R3D4")
#: Points this near to a facet, by its length, lie on it.
LIES = 0.05
#: Ways beside an end below this share of the size of a surface are none.
ROUNDING = 1e-12
#: How often facets are moved under the slaves, one after the other.
SWEEPS = 30


@dataclass
class FacetMaster:
    """A surface of element faces of another body.

    Attributes
    ----------
    labels : of its nodes (node,)
    start : their coordinates in the deck (node, ndim) [length]
    facets : rows of the nodes of each facet, edges or triangles, outward (facet, ndim)
    rim : nodes of the ends of an open surface: of edges that one facet alone has (node,)
    open : sides of each facet, by the corner opposite, that no other facet has (facet, ndim)
    rigid : a tool of rigid facets
    """

    labels: NDArray
    start: NDArray
    facets: NDArray
    rim: NDArray
    open: NDArray
    rigid: bool = False

    @classmethod
    def of(cls, parts: DeckParts, name: str, ndim: int) -> FacetMaster | None:
        """The surface of a deck; None if it is not one of faces."""
        rows = list(_faces(parts, name, ndim))
        if not rows:
            return None
        corners = np.array(rows)
        labels, facets = np.unique(corners, return_inverse=True)
        facets = facets.reshape(corners.shape)
        # The side opposite to each corner: the other corner of an edge, an edge of a triangle.
        sides = np.sort(np.vstack([np.delete(facets, k, axis=1) for k in range(ndim)]), axis=1)
        sides, number, count = np.unique(sides, axis=0, return_inverse=True, return_counts=True)
        rim = np.zeros(len(labels), bool)
        rim[sides[count == 1].ravel()] = True
        alone = (count == 1)[number.ravel()].reshape(ndim, -1).T
        start = np.array([parts.cards.nodes[int(n)][:ndim] for n in labels])
        return cls(labels, start, facets, rim, alone,
                   is_of_facets(parts.cards, parts.cards.surfaces[name]))

    def places(self, motion: NDArray) -> NDArray:
        """Present places of its nodes (node, ndim). `motion`: of `Snapshot`."""
        x = self.start.copy()
        row = np.searchsorted(self.labels, motion[:, 0])
        row = np.minimum(row, len(self.labels) - 1)
        own = (self.labels[row] == motion[:, 0]) & (motion[:, 1] <= x.shape[1])
        x[row[own], motion[own, 1].astype(int) - 1] += motion[own, 2]
        return x

    def feet(self, points: NDArray, motion: NDArray) -> NDArray:
        """Closest points: a row each of gap, overhang beyond an open end, point, normal."""
        x = self.places(motion)
        closest = closest_on_facets if points.shape[1] == 3 else closest_on_edges
        facet, share = closest(points, x, self.facets)
        corners = x[self.facets[facet]]
        foot = np.einsum("nk,nkd->nd", share, corners)
        wide = normals_of(x[self.facets])
        normal = wide[facet]/np.linalg.norm(wide[facet], axis=1)[:, None]
        arm = points - foot
        gap = (arm*normal).sum(axis=1)
        beside = np.linalg.norm(arm - gap[:, None]*normal, axis=1)
        beside[beside < ROUNDING*np.ptp(x, axis=0).max()] = 0.0
        # On the rim: on a side that no other facet has, or at a corner of one.
        off = share < 1e-9
        corner = (self.rim[self.facets[facet]] | off).all(axis=1)
        ends = np.where(off.sum(axis=1) == 1, (self.open[facet] & off).any(axis=1), corner) \
            & off.any(axis=1)
        # Off a ridge the distance counts, and its side is that of all facets that meet there.
        ridge = ~ends & off.any(axis=1)
        at_nodes = np.zeros_like(x)
        for k in range(self.facets.shape[1]):
            np.add.at(at_nodes, self.facets[:, k], wide)
        mean = np.einsum("nk,nkd->nd", share, at_nodes[self.facets[facet]])
        side = np.where((arm*mean).sum(axis=1) < 0.0, -1.0, 1.0)
        gap[ridge] = (side*np.linalg.norm(arm, axis=1))[ridge]
        return np.column_stack([gap, np.where(ends, beside, 0.0), foot, normal])

    def bears(self, points: NDArray, motion: NDArray, loaded: NDArray) -> NDArray:
        """Whether points lie on facets all of whose corners are among `loaded`, or nearly."""
        x = self.places(motion)
        closest = closest_on_facets if points.shape[1] == 3 else closest_on_edges
        facet, share = closest(points, x, self.facets)
        corners = x[self.facets[facet]]
        far = np.linalg.norm(points - np.einsum("nk,nkd->nd", share, corners), axis=1)
        size = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
        held = np.isin(self.labels, loaded)[self.facets[facet]] | (share < 1e-9)
        return held.all(axis=1) & (far < LIES*size)


def feet_under_slaves(x: NDArray, facets: NDArray, slaves: NDArray, loaded: NDArray
                      ) -> tuple[NDArray, NDArray]:
    """Nodes of a master under slave nodes, and where they are for these to lie on its facets.

    The slave nodes are what the master meets, not the chords between them, into which it reaches:
    its nodes put on these would leave the slaves in the air. Each facet is moved along its normal
    by the gap of its slave, again and again; a few slaves on many facets all lie on them then.

    Parameters
    ----------
    x, facets : of the master, edges or triangles (facet, ndim)
    slaves : present places of the slave nodes (n, ndim) [length]
    loaded : whether they press; others count where they are inside (n,)

    Returns
    -------
    nodes, feet : rows of gap (0), overhang (0), place, normal, as of a tool
    """
    closest = closest_on_facets if x.shape[1] == 3 else closest_on_edges
    facet, share = closest(slaves, x, facets)
    corners = x[facets[facet]]
    size = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    normal = normals_of(corners)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    arm = slaves - np.einsum("nk,nkd->nd", share, corners)
    gap = (arm*normal).sum(axis=1)
    # Straight above a facet, or nearly: others hang over its end.
    met = (np.abs(gap) < LIES*size) & (loaded | (gap < 0.0)) & \
        (np.linalg.norm(arm - gap[:, None]*normal, axis=1) < LIES*size)
    moved = x.copy()
    for _ in range(SWEEPS):
        for k in np.flatnonzero(met):
            own, s = facets[facet[k]], share[k]
            left = (slaves[k] - s @ moved[own]) @ normal[k]
            moved[own] += (left/(s @ s))*s[:, None]*normal[k]
    nodes = np.unique(facets[facet[met]])
    feet = np.zeros((len(nodes), 2 + 2*x.shape[1]))
    feet[:, 2:2 + x.shape[1]] = moved[nodes]
    return nodes, feet


def normals_of(corners: NDArray) -> NDArray:
    """Outward normals of edges or triangles (facet, ndim, ndim), as long as these are large."""
    if corners.shape[2] == 3:
        return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    edge = corners[:, 1] - corners[:, 0]
    return np.stack([edge[:, 1], -edge[:, 0]], axis=1)


def _faces(parts: DeckParts, name: str, ndim: int):
    """Labels of the corners of each facet: faces of hexahedra in two triangles."""
    cards = parts.cards
    for row in cards.surfaces.get(name, []):
        members = [row[0]] if isinstance(row[0], int) else cards.elsets.get(str(row[0]).upper(), [])
        face = str(row[1]).upper() if len(row) > 1 and row[1] is not None else ""
        found = []
        for member in members:
            word, nodes = cards.elements[member]
            if word in SIDED:
                yield from _parts_of(side_of(nodes, face))
                continue
            cell = CELLS[(PLANE if ndim == 2 else SOLID)[len(nodes)]]
            own = cell.faces if not face else [cell.faces[int(face[1:]) - 1]]
            for f in own:
                corners = [nodes[k] for k in f[:2 if ndim == 2 else min(len(f), 4)]]
                if ndim == 3 and cell.is_quadratic:
                    corners = [nodes[k] for k in f[:len(f)//2]]
                found.append(corners)
        if not face:
            seen: dict[frozenset, int] = {}
            for f in found:
                seen[frozenset(f)] = seen.get(frozenset(f), 0) + 1
            found = [f for f in found if seen[frozenset(f)] == 1]
        for f in found:
            yield from _parts_of(f)


def is_of_facets(cards: MeshCards, rows: list) -> bool:
    """Whether a surface is of rigid facets alone: a tool, as one of segments."""
    return all(cards.elements[member][0] in SIDED for row in rows for member in
               ([row[0]] if isinstance(row[0], int) else cards.elsets.get(row[0].upper(), [])))


def _parts_of(face: list[int]):
    """An edge or a triangle as it is, a quad in two triangles."""
    yield face[:3]
    if len(face) == 4:
        yield [face[0], face[2], face[3]]


def side_of(nodes: list[int], face: str) -> list[int]:
    """Corners of one side of a rigid facet, outward as those of solids; no word is SPOS: the side
    of the right-hand rule, of a line to the left of its way.

    >>> side_of([1, 2], "SPOS"), side_of([1, 2], "SNEG"), side_of([1, 2, 3, 4], "SNEG")
    ([2, 1], [1, 2], [1, 4, 3, 2])
    """
    positive = face in ("", "SPOS", "S2")
    if len(nodes) == 2:
        return nodes[::-1] if positive else list(nodes)
    return list(nodes) if positive else [nodes[0], *nodes[:0:-1]]


def closest_on_edges(places: NDArray, x: NDArray, facets: NDArray) -> tuple[NDArray, NDArray]:
    """Edge that is closest to each place, and the shares of its ends there."""
    a, b = x[facets[:, 0]], x[facets[:, 1]]
    along = b - a
    square = np.maximum((along**2).sum(axis=1), np.finfo(float).tiny)
    s = np.clip(((places[:, None] - a)*along).sum(axis=2)/square, 0.0, 1.0)
    far = np.linalg.norm(a + s[..., None]*along - places[:, None], axis=2)
    best = np.argmin(far, axis=1)
    s = s[np.arange(len(places)), best]
    return best, np.stack([1.0 - s, s], axis=1)
