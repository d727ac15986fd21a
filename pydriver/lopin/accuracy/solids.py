"""Linear elastic solids of a deck as arrays: places, moduli, stresses from displacements."""
from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from itertools import product

import numpy as np
from numpy.typing import NDArray

from ..deck import Deck
from ..mesh.cells import CELLS
from ..mesh.shapes import shape_functions
from ..model_read_mesh import MeshCards, expanded, plain
from ..refine.children import cell_of

_KIND = {"CPE": "plane strain", "CPS": "plane stress", "CAX": "axisymmetric", "C3D": "3d"}
#: Cards that make a solid more than linear and elastic.
_MORE = ("PLASTIC", "HYPERELASTIC", "CREEP", "VISCOPLASTIC", "EXPANSION", "DEPVAR", "POTENTIAL")
_GAUSS = {1: ([0.0], [2.0]), 2: ([-3**-0.5, 3**-0.5], [1.0, 1.0]),
          3: ([-0.6**0.5, 0.0, 0.6**0.5], [5/9, 8/9, 5/9])}


@cache
def points_of(name: str, count: int) -> tuple[NDArray, NDArray]:
    """Places and weights of `count` points a direction in a reference cell.

    >>> float(points_of("triangle", 2)[1].sum()), points_of("quad", 1)[0]
    (0.5, array([[0., 0.]]))
    """
    cell = CELLS[name]
    x, w = map(np.array, _GAUSS[count])
    every = np.array(list(product(x, repeat=cell.ndim)))
    weight = np.array([np.prod(v) for v in product(w, repeat=cell.ndim)])
    if cell.family in ("quad", "hexahedron"):
        return every, weight
    if cell.family == "wedge":
        place, scale = _collapsed(every[:, :2])
        return np.column_stack([place, every[:, 2]]), weight*scale
    place, scale = _collapsed(every)
    return place, weight*scale


def _collapsed(cube: NDArray) -> tuple[NDArray, NDArray]:
    """Points of a cube taken to a simplex, with the change of volume."""
    t = 0.5*(cube + 1.0)
    left, place, scale = np.ones(len(t)), [], np.full(len(t), 0.5**t.shape[1])
    for column in t.T:
        place.append(left*column)
        scale, left = scale*left, left*(1.0 - column)
    return np.stack(place, axis=1), scale


#: Points a direction of the integrals, and where stresses are best known (None: the middle).
_WHOLE = {False: 2, True: 3}


@dataclass
class Group:
    """Elements of one word and material.

    Attributes
    ----------
    word, cell, kind : of the elements
    labels : (element,)
    nodes : rows of `Solids.labels` (element, node)
    young, poisson, thickness : of the material and section
    mean : its change of volume is the mean over the element (B-bar)
    inner : it has internal modes (words with I)
    """

    word: str
    cell: str
    kind: str
    labels: NDArray
    nodes: NDArray
    young: float
    poisson: float
    thickness: float
    mean: bool
    inner: bool = False

    @property
    def order(self) -> int:
        """Of the shape functions."""
        return 2 if CELLS[self.cell].is_quadratic else 1

    @property
    def corners(self) -> NDArray:
        """Rows of the corners (element, corner)."""
        return self.nodes[:, :CELLS[self.cell].n_corner]

    def whole(self) -> tuple[NDArray, NDArray]:
        """Points of the integrals."""
        return points_of(self.cell, _WHOLE[CELLS[self.cell].is_quadratic])

    def best(self) -> NDArray:
        """Points where stresses are best known."""
        if self.order == 2:
            return points_of(self.cell, 2)[0]
        return CELLS[self.cell].xi.mean(axis=0)[None]

    def geometry(self, x: NDArray, xi: NDArray):
        """Shape functions (point, node), their slopes in space (element, point, node, ndim), places
        and volumes of unit weight (element, point)."""
        shape, slope = map(np.array, zip(*(shape_functions(self.cell, p) for p in xi)))
        own = x[self.nodes]
        jacobian = np.einsum("end,pnc->epdc", own, slope)
        place = np.einsum("pn,end->epd", shape, own)
        dn = np.einsum("pnc,epcd->epnd", slope, np.linalg.inv(jacobian))
        volume = np.linalg.det(jacobian)*(2.0*np.pi*place[..., 0] if self.kind == "axisymmetric"
                                          else self.thickness)
        return shape, dn, place, volume

    def stress(self, shape: NDArray, dn: NDArray, place: NDArray, u: NDArray,
               dilatation: NDArray | None = None) -> tuple[NDArray, NDArray]:
        """Stresses xx, yy, zz, xy(, xz, yz) of displacements (node, ndim), and the change of volume
        (element, point); `dilatation`: its mean, where the element has that (element, 1)."""
        grad = np.einsum("epnd,enc->epcd", dn, u[self.nodes])
        e = np.zeros((*grad.shape[:2], 6 if self.kind == "3d" else 4))
        for d in range(grad.shape[-1]):
            e[..., d] = grad[..., d, d]
        for k, (i, j) in enumerate([(0, 1), (0, 2), (1, 2)][:e.shape[-1] - 3], start=3):
            e[..., k] = 0.5*(grad[..., i, j] + grad[..., j, i])
        if self.kind == "axisymmetric":
            e[..., 2] = np.einsum("pn,en->ep", shape, u[self.nodes][..., 0])/place[..., 0]
        return self._law(e, dilatation)

    def _law(self, e: NDArray, dilatation: NDArray | None = None) -> tuple[NDArray, NDArray]:
        """Stresses of strains, and the change of volume (element, point)."""
        if self.kind == "plane stress":
            e[..., 2] = -self.poisson/(1.0 - self.poisson)*(e[..., 0] + e[..., 1])
        own = e[..., :3].sum(axis=-1)
        shear = self.young/(2.0*(1.0 + self.poisson))
        bulk = self.young/(3.0*(1.0 - 2.0*self.poisson))
        stress = 2.0*shear*e
        stress[..., :3] += (bulk*(own if dilatation is None else dilatation)
                            - 2.0/3.0*shear*own)[..., None]
        return stress, own

    def relaxed(self, x: NDArray, xi: NDArray, volume: NDArray, stress: NDArray) -> NDArray:
        """Stresses at points (element, point, component) with the internal modes that they
        work on, of weights `volume` (element, point)."""
        modes = self._modes(x, xi)
        count = modes.shape[2]
        answer = np.stack([self._law(modes[:, :, m].copy())[0] for m in range(count)], axis=2)
        twice = np.ones(modes.shape[-1])
        twice[3:] = 2.0
        stiff = np.einsum("ep,epmc,epnc->emn", volume, modes*twice, answer)
        pushed = np.einsum("ep,epmc,epc->em", volume, modes*twice, stress)
        share = np.linalg.solve(stiff, -pushed[..., None])[..., 0]
        return stress + np.einsum("em,epmc->epc", share, answer)

    def _modes(self, x: NDArray, xi: NDArray) -> NDArray:
        """Strains of the internal modes (element, point, mode, component): of a parameter in each
        direction of the cell, carried to space by the centre (fortran/element/enhanced_modes.f90).
        """
        ndim = x.shape[1]
        _, _, place, volume = self.geometry(x, xi)
        centre = CELLS[self.cell].xi.mean(axis=0)[None]
        _, _, _, middle = self.geometry(x, centre)
        slope = shape_functions(self.cell, centre[0])[1]
        jacobian = np.einsum("end,nc->edc", x[self.nodes], slope)
        inverse = np.linalg.inv(jacobian)
        inverse *= (np.linalg.det(jacobian)**(1.0/ndim))[:, None, None]
        scale = middle/volume
        names = [(0, 1), (0, 2), (1, 2)][:3 if ndim == 3 else 1]
        found = []
        for i, j in product(range(ndim), repeat=2):
            matrix = np.einsum("ed,ec->edc", inverse[:, i], inverse[:, j])
            part = np.stack([*(matrix[:, d, d] for d in range(ndim)),
                             *([] if ndim == 3 else [np.zeros(len(matrix))]),
                             *(0.5*(matrix[:, a, b] + matrix[:, b, a]) for a, b in names)], axis=1)
            found.append((scale*xi[:, i])[..., None]*part[:, None])
        if self.kind in ("axisymmetric", "3d"):
            round_ = np.zeros(found[0].shape[-1])
            round_[:3] = 1.0
            found += [(scale*xi[:, i]*xi[:, j])[..., None]*round_ for i, j in names]
        return np.stack(found, axis=2)

    def product(self, one: NDArray, other: NDArray) -> NDArray:
        """Stress by strain of two fields of stress (element, point)."""
        twice = (one[..., :3]*other[..., :3]).sum(axis=-1) \
            + 2.0*(one[..., 3:]*other[..., 3:]).sum(axis=-1)
        return ((1.0 + self.poisson)*twice - self.poisson*one[..., :3].sum(axis=-1)
                * other[..., :3].sum(axis=-1))/self.young


@dataclass
class Solids:
    """All solid elements, and why they are not linear and elastic if they are not.

    Attributes
    ----------
    labels, x : of the nodes of the elements (node,), (node, ndim)
    """

    labels: NDArray
    x: NDArray
    groups: list[Group]
    reason: str = ""

    @classmethod
    def of(cls, deck: Deck) -> Solids:
        """Read from the cards of a flat deck."""
        blocks = expanded(deck)
        cards = MeshCards(blocks)
        material, reason = _materials(blocks)
        section = _sections(blocks, cards)
        full = any(b.keyword == "SECTION CONTROLS" and "FULL" in
                   str(b.parameters.get("FORMULATION", "")).upper() for b in blocks)
        sorted_by: dict[tuple, list[int]] = {}
        for label, (word, _) in cards.elements.items():
            if cell_of(word):
                sorted_by.setdefault((word, *section.get(label, ("", 1.0))), []).append(label)
        used = np.unique(np.concatenate([cards.elements[m][1] for own in sorted_by.values()
                                         for m in own]))
        groups = []
        for (word, name, thickness), labels in sorted_by.items():
            if name not in material:
                return cls(used, np.empty((0, 2)), [], reason or f"material '{name}' is no "
                           "linear elastic one")
            nodes = np.array([cards.elements[m][1] for m in labels])
            kind, cell = _KIND[word[:3]], cell_of(word)
            inner = word.endswith("I")
            mean = not full and not inner and cell in ("quad", "hexahedron") \
                and kind != "plane stress"
            groups.append(Group(word, cell, kind, np.array(labels), np.searchsorted(used, nodes),
                                *material[name], thickness, mean, inner))
        ndim = 3 if groups[0].kind == "3d" else 2
        return cls(used, np.array([cards.nodes[int(n)][:ndim] for n in used]), groups, reason)


def _materials(blocks) -> tuple[dict[str, tuple[float, float]], str]:
    """Moduli by name; a reason why some are not linear."""
    found, name, reason = {}, "", ""
    for block in blocks:
        if block.keyword == "MATERIAL":
            name = str(plain(block.parameters["NAME"])).upper()
        elif block.keyword == "ELASTIC":
            kind = str(block.parameters.get("TYPE", "ISO")).upper()
            if kind.startswith("ISO") and len(block.data) == 1:
                row = block.data[0]
                found[name] = float(row[0]), float((row[1] if len(row) > 1 else 0.0) or 0.0)
        elif block.keyword in _MORE and not reason:
            reason = f"*{block.keyword}"
        elif block.keyword == "STEP" and "NLGEOM" in block.parameters and not reason:
            reason = "NLGEOM"
    return found, reason


def _sections(blocks, cards: MeshCards) -> dict[int, tuple[str, float]]:
    """Material and thickness by element."""
    found = {}
    for block in blocks:
        if block.keyword != "SOLID SECTION":
            continue
        name = str(plain(block.parameters.get("MATERIAL", ""))).upper()
        row = block.data[0] if block.data else []
        thick = float(row[0]) if row and row[0] else 1.0
        for label in cards.elsets.get(str(plain(block.parameters["ELSET"])).upper(), []):
            found[label] = name, thick
    return found
