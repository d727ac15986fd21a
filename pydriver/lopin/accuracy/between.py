"""What contact at nodes leaves between them: tractions of one problem work on gaps of the other.

Rows hold the gap of slave nodes alone. Where the facets of two meshes do not match it is not
nothing between these. The exact pressure works on the gap that the dual solution leaves there, and
that of the dual problem on the gap of the solution: two parts of the error of a number beside that
of the stresses within the bodies (of a method that does not conform, after Strang). With u, z the
solution and the dual one, p, q their pressures, h what a mesh has:
J(u) - J(u_h) = a(u - u_h, z - z_h) + (p, [z_h]) + (q, [u_h]).
"""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..mesh.cells import CELLS
from ..mesh.shapes import shape_functions
from ..model_read_mesh import MeshCards, plain
from .solids import Group, Solids

#: Points of Gauss on each edge: facets of the other side begin and end within it.
POINTS = 8


@dataclass
class Edges:
    """Element faces of a surface in the plane.

    Attributes
    ----------
    nodes : rows of the nodes, ends first, the body on the left of the way (edge, 2 or 3)
    label : of the element of each
    group : of these elements
    """

    nodes: NDArray
    label: NDArray
    group: Group

    @classmethod
    def of(cls, name: str, cards: MeshCards, solids: Solids) -> list[Edges]:
        """Those of a surface; none if it is one of nodes."""
        wanted = [(label, int(str(row[1])[1:]) - 1) for row in cards.surfaces.get(name, ())
                  if len(row) > 1 and str(row[1])[1:].isdigit() for label in
                  ([row[0]] if isinstance(row[0], int) else cards.elsets[str(row[0]).upper()])]
        found = []
        for group in solids.groups:
            at = {int(n): k for k, n in enumerate(group.labels)}
            faces = [(at[label], face) for label, face in wanted if label in at]
            if faces:
                own = CELLS[group.cell].faces
                rows = np.array([group.nodes[k][list(own[f])] for k, f in faces])
                found.append(cls(rows, group.labels[[k for k, _ in faces]], group))
        return found


@dataclass
class Between:
    """A pair whose gap is held at nodes.

    Attributes
    ----------
    slave, master : their edges
    tied : in all directions
    """

    slave: list[Edges]
    master: list[Edges]
    tied: bool

    @classmethod
    def of(cls, blocks, cards: MeshCards, solids: Solids) -> list[Between | None]:
        """All pairs of a deck in the plane. None: the gap is held in the mean, the surface is one
        of nodes, or the tool rigid: what chords of its face leave is left to the size of cells."""
        found = []
        for block in blocks:
            for row in block.data if block.keyword == "CONTACT PAIR" else ():
                sides = [Edges.of(str(plain(name)).upper(), cards, solids) for name in row[:2]]
                mean = str(block.parameters.get("TYPE", "")).upper().startswith("SURFACE")
                can = solids.x.shape[1] == 2 and all(sides) and not mean
                found.append(cls(*sides, "TIED" in block.parameters) if can else None)
        return found

    def work(self, end, traction: NDArray, moved: NDArray, solids: Solids,
             strained: bool) -> dict[int, float]:
        """Of tractions (row of `end`, 2) on what displacements (node, 2) leave open between the
        nodes, by the label of the slave's element [force length].

        `end`: the pair's results, whose closed points count; `strained`: the displacements are
        those of the deck, with the gaps that the surfaces have without them, else their slope.
        """
        at = {int(n): k for k, n in reversed(list(enumerate(np.ravel(end["LABEL"]))))}
        closed = np.ravel(end["CSTATUS"]) > 0
        parts: dict[int, float] = {}
        for edges in self.slave:
            rows = np.array([[at.get(int(n), -1) for n in solids.labels[own]]
                             for own in edges.nodes])
            touch = np.flatnonzero((rows >= 0).all(axis=1) & closed[rows].all(axis=1))
            if not len(touch):
                continue
            shape, length = _along(edges, touch, solids.x)
            pushed = np.einsum("pn,end->epd", shape, traction[rows[touch]])
            gaps = self._gaps(edges.nodes[touch], shape, moved, solids.x, strained)
            for k, part in zip(touch, np.einsum("ep,epd,epd->e", length, pushed, gaps)):
                label = int(edges.label[k])
                parts[label] = parts.get(label, 0.0) + float(part)
        return parts

    def _gaps(self, own: NDArray, shape: NDArray, moved: NDArray, x: NDArray,
              strained: bool) -> NDArray:
        """Ways from the master to points of edges, less those at their nodes (edge, point, 2)."""
        every = np.vstack([shape, np.eye(shape.shape[1])])
        place = np.einsum("pn,end->epd", every, x[own])
        nodes, share = self._feet(place, x)
        gap = np.einsum("pn,end->epd", every, moved[own]) \
            - np.einsum("epm,epmd->epd", share, moved[nodes])
        if self.tied:
            return gap[:, :len(shape)]
        if strained:
            gap = gap + place - np.einsum("epm,epmd->epd", share, x[nodes])
        return gap[:, :len(shape)] - np.einsum("pn,end->epd", shape, gap[:, len(shape):])

    def _feet(self, x: NDArray, places: NDArray) -> tuple[NDArray, NDArray]:
        """Nearest points of the master's edges: their nodes and shares (edge, point, 3)."""
        nodes = np.concatenate([np.pad(e.nodes, ((0, 0), (0, 3 - e.nodes.shape[1])), mode="edge")
                                for e in self.master])
        curved = np.concatenate([np.full(len(e.nodes), e.nodes.shape[1] == 3)
                                 for e in self.master])
        a, way = places[nodes[:, 0]], places[nodes[:, 1]] - places[nodes[:, 0]]
        flat = x.reshape(-1, 2)
        t = np.clip(np.einsum("pmd,md->pm", flat[:, None] - a, way)/(way**2).sum(axis=1), 0.0, 1.0)
        middle = places[nodes[:, 2]] - a - 0.5*way
        middle[~curved] = 0.0
        foot = a + t[..., None]*way + (4.0*t*(1.0 - t))[..., None]*middle
        best = np.argmin(np.linalg.norm(flat[:, None] - foot, axis=2), axis=1)
        t = t[np.arange(len(flat)), best]
        share = np.stack([1.0 - t, t, np.zeros_like(t)], axis=1)
        share[curved[best]] = np.stack([(1.0 - t)*(1.0 - 2.0*t), t*(2.0*t - 1.0),
                                        4.0*t*(1.0 - t)], axis=1)[curved[best]]
        return nodes[best].reshape(*x.shape[:2], 3), share.reshape(*x.shape[:2], 3)


def tractions(end) -> NDArray:
    """On the slave at its points (point, 2)."""
    area = np.ravel(end["WEIGHT"])
    return end.force/np.where(area > 0.0, area, 1.0)[:, None]


def _along(edges: Edges, touch: NDArray, x: NDArray) -> tuple[NDArray, NDArray]:
    """Shape functions at the points of edges (point, node), and the areas of these (edge, point).
    """
    name = "line" if edges.nodes.shape[1] == 2 else "line3"
    shape, slope = map(np.array, zip(*(shape_functions(name, [s]) for s in _XI)))
    own = x[edges.nodes[touch]]
    length = np.linalg.norm(np.einsum("pn,end->epd", slope[..., 0], own), axis=2)*_WEIGHT
    if edges.group.kind == "axisymmetric":
        return shape, 2.0*np.pi*length*np.einsum("pn,en->ep", shape, own[..., 0])
    return shape, edges.group.thickness*length


_XI, _WEIGHT = np.polynomial.legendre.leggauss(POINTS)
