"""Numpy twins of the element kernels, written from the definitions and not from the Fortran.

Shape functions come from inverting the matrix of monomials at the nodes; element matrices from
quadrature in plain loops. Slow and short: for verification.
"""
from __future__ import annotations

from functools import cache
from itertools import product

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .cells import CELLS

_DIRECTIONS = {"line": 1, "quad": 2, "hexahedron": 3}


def exponents(name: str) -> list[tuple[int, ...]]:
    """Powers of the monomials that span the shape functions of a cell.

    Bricks: superlinear degree <= order; simplices: total degree <= order; wedges: a product, and
    for 15 nodes the triangle's linear functions times t^2.

    >>> len(exponents("hexahedron20")), len(exponents("wedge15")), len(exponents("tetra10"))
    (20, 15, 10)
    """
    cell = CELLS[name]
    order = 2 if cell.is_quadratic else 1
    if cell.family in _DIRECTIONS:
        every = product(range(order + 1), repeat=cell.ndim)
        return [e for e in every if sum(k for k in e if k > 1) <= order]
    if cell.family == "wedge":
        linear = [e for e in product((0, 1), repeat=2) if sum(e) <= 1]
        full = [e for e in product(range(order + 1), repeat=2) if sum(e) <= order]
        return ([(*e, t) for e in full for t in (0, 1)]
                + ([(*e, 2) for e in linear] if order == 2 else []))
    return [e for e in product(range(order + 1), repeat=cell.ndim) if sum(e) <= order]


@cache
def monomials(name: str) -> tuple[NDArray, NDArray]:
    """Powers of the monomials (monomial, ndim), and their values at the nodes (node, monomial)."""
    powers = np.array(exponents(name))
    return powers, np.prod(CELLS[name].xi[:, None, :]**powers[None], axis=2)


def shape_functions(name: str, xi: ArrayLike) -> tuple[NDArray, NDArray]:
    """Values (node) and parametric gradients (node, ndim) at one point.

    >>> shape_functions("quad", [0.0, 0.0])[0]
    array([0.25, 0.25, 0.25, 0.25])
    """
    cell = CELLS[name]
    xi = np.atleast_1d(np.asarray(xi, float))
    powers, vandermonde = monomials(name)
    values = np.prod(xi**powers, axis=1)
    slopes = np.empty((len(powers), cell.ndim))
    for d in range(cell.ndim):
        lower = powers.copy()
        lower[:, d] = np.maximum(lower[:, d] - 1, 0)
        slopes[:, d] = powers[:, d]*np.prod(xi**lower, axis=1)
    solved = np.linalg.solve(vandermonde.T, np.column_stack([values, slopes]))
    return solved[:, 0], solved[:, 1:]


def gradients(name: str, x: ArrayLike, xi: ArrayLike) -> tuple[NDArray, float]:
    """Shape gradients (node, ndim) in space, and the Jacobian determinant, at one point."""
    _, dn = shape_functions(name, xi)
    jacobian = np.asarray(x, float).T @ dn
    return dn @ np.linalg.inv(jacobian), float(np.linalg.det(jacobian))


def smallest_jacobian(name: str, x: ArrayLike) -> float:
    """Smallest Jacobian determinant at the nodes; x (node, ndim), or (cell, node, ndim)."""
    x = np.asarray(x, float)
    slopes = [shape_functions(name, xi)[1] for xi in CELLS[name].xi]
    return float(min(np.linalg.det(np.swapaxes(x, -1, -2) @ dn).min() for dn in slopes))


def hooke(young: float, poisson: float, kind: str = "3d") -> NDArray:
    """Moduli for stresses (xx, yy, zz, xy[, xz, yz]) and engineering shear strains [stress].

    `kind`: "3d", "plane strain", "axisymmetric" (xx = radial, zz = hoop) or "plane stress".
    """
    if kind == "plane stress":
        d = np.zeros((4, 4))
        factor = young/(1.0 - poisson**2)
        d[:2, :2] = factor*np.array([[1.0, poisson], [poisson, 1.0]])
        d[3, 3] = 0.5*factor*(1.0 - poisson)
        return d
    n = 6 if kind == "3d" else 4
    d = np.zeros((n, n))
    shear = young/(2.0*(1.0 + poisson))
    d[:3, :3] = young*poisson/((1.0 + poisson)*(1.0 - 2.0*poisson))
    d[:3, :3] += 2.0*shear*np.eye(3)
    d[range(3, n), range(3, n)] = shear
    return d


def strain_matrix(gradient: NDArray, values: NDArray | None = None,
                  radius: float | None = None) -> NDArray:
    """B (component, node*ndim) of plane, axisymmetric (give N and r) or solid strains."""
    n_node, ndim = gradient.shape
    b = np.zeros((6 if ndim == 3 else 4, n_node*ndim))
    for d in range(ndim):
        b[d, d::ndim] = gradient[:, d]
    for row, (i, j) in enumerate([(0, 1), (0, 2), (1, 2)][:1 if ndim == 2 else 3], start=3):
        b[row, i::ndim] = gradient[:, j]
        b[row, j::ndim] = gradient[:, i]
    if radius is not None:
        b[2, 0::2] = values/radius
    return b


def brick_stiffness(x: ArrayLike, young: float, poisson: float, kind: str = "3d",
                    thickness: float = 1.0, bbar: bool = False) -> NDArray:
    """Stiffness of a quad or hexahedron with 2 Gauss points a direction; x (4 or 8, ndim).

    Axisymmetric: over the full circumference. `bbar`: the volumetric part of B is replaced by its
    mean over the element (Hughes 1980), in the three normal components.
    """
    x = np.asarray(x, float)
    name = "quad" if x.shape[1] == 2 else "hexahedron"
    moduli = hooke(young, poisson, kind)
    points = []
    for xi in product((-1/3**0.5, 1/3**0.5), repeat=x.shape[1]):
        values, _ = shape_functions(name, xi)
        gradient, det = gradients(name, x, xi)
        radius = float(values @ x[:, 0]) if kind == "axisymmetric" else None
        weight = det*(thickness if radius is None else 2.0*np.pi*radius)
        points.append((strain_matrix(gradient, values, radius), weight))
    volume = sum(w for _, w in points)
    mean = sum(w*b[:3].sum(axis=0) for b, w in points)/volume
    stiffness = np.zeros((x.size, x.size))
    for b, w in points:
        if bbar:
            b = b.copy()
            b[:3] += (mean - b[:3].sum(axis=0))/3.0
        stiffness += w*b.T @ moduli @ b
    return stiffness
