"""Forces that hold the stresses of integration points in balance, by the formulas: a twin of the
core's for quads whose change of volume is a mean over the element."""
from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from lopin.points import Points
from lopin.remesh.body import Body


def nodal_forces(x: NDArray, body: Body, points: Points, young: float, poisson: float) -> NDArray:
    """Sum of B^T stress over the points (node, ndim): deviators by the present shape, means by the
    change of volume of the element since the part began."""
    shear, bulk = 0.5*young/(1.0 + poisson), young/(3.0 - 6.0*poisson)
    group = body.cells[0]
    row = {int(label): k for k, label in enumerate(body.elements)}
    order = np.lexsort((points.number, [row[int(e)] for e in points.element]))
    own = order.reshape(len(group), -1)
    shape, slope = gradients(x[group], own.shape[1])
    strain = 2.0*shear*points.strain[own]
    tensor = strain[..., [[0, 3, 4], [3, 1, 5], [4, 5, 2]]][..., :2, :2]
    mass = (points.volume*np.exp(-points.ratio))[own]
    force = np.einsum("ep,epab,epkb->eka", mass, tensor, slope)
    wide = slope.copy()
    if body.axisymmetric:
        over = shape/np.einsum("pk,ek->ep", shape, x[group][..., 0])[..., None]
        force[..., 0] += np.einsum("ep,ep,epk->ek", mass, strain[..., 2], over)
        wide[..., 0] += over
    grown = mass*growth_since(body, group, x, shape)
    whole = mass.sum(axis=1, keepdims=True)/grown.sum(axis=1, keepdims=True)
    force += np.einsum("ep,epka->eka", bulk*points.dilatation[own]*grown*whole, wide)
    found = np.zeros_like(x)
    for k in range(4):
        np.add.at(found, group[:, k], force[:, k])
    return found


def growth_since(body: Body, group: NDArray, x: NDArray, shape: NDArray) -> NDArray:
    """Volumes of points by those where the part began (element, point)."""
    _, slope = gradients(body.x[group], len(shape))
    growth = np.linalg.det(np.einsum("eka,epkb->epab", x[group], slope))
    if body.axisymmetric:
        growth = growth*np.einsum("pk,ek->ep", shape, x[group][..., 0])/np.einsum(
            "pk,ek->ep", shape, body.x[group][..., 0])
    return growth


def gradients(corner: NDArray, n: int) -> tuple[NDArray, NDArray]:
    """Shape functions (point, corner) at the four points of Gauss, or in the middle, and their
    gradients (element, point, corner, 2) in quads with these corners (element, corner, 2)."""
    far = 1.0/np.sqrt(3.0) if n == 4 else 0.0
    xi, eta = far*np.array([[-1, 1, -1, 1], [-1, -1, 1, 1]])[:, :n]
    sx, sy = np.array([-1, 1, 1, -1]), np.array([-1, -1, 1, 1])
    fx, fy = 1.0 + xi[:, None]*sx, 1.0 + eta[:, None]*sy
    local = 0.25*np.stack([sx*fy, fx*sy], axis=2)
    jacobian = np.einsum("pkb,eka->epab", local, corner)
    return 0.25*fx*fy, np.einsum("pkb,epba->epka", local, np.linalg.inv(jacobian))
