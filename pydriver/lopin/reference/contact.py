"""Numpy twins of the contact kernels and of the skyline solver, written from the definitions.

Sign: the normal leaves the master towards the slave, gap > 0 is open.
"""
from __future__ import annotations

from itertools import product

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..mesh.cells import CELLS
from ..mesh.shapes import monomials, shape_functions


def closest_on_segment(a: ArrayLike, b: ArrayLike, point: ArrayLike) -> tuple[float, NDArray]:
    """Parameter in [-1, 1] and position of the closest point of a segment, in any dimension."""
    a, b, point = (np.asarray(v, float) for v in (a, b, point))
    t = np.clip((point - a) @ (b - a)/((b - a) @ (b - a)), 0.0, 1.0)
    return float(2.0*t - 1.0), a + t*(b - a)


def closest_on_triangle(x: ArrayLike, point: ArrayLike) -> tuple[NDArray, NDArray]:
    """(xi, eta) and position of the closest point of a triangle x (3, 3)."""
    x, point = np.asarray(x, float), np.asarray(point, float)
    edges = x[1:] - x[0]
    xi = np.linalg.lstsq(edges.T, point - x[0], rcond=None)[0]
    if xi.min() >= 0.0 and xi.sum() <= 1.0:
        return xi, x[0] + xi @ edges
    corner = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    best = None
    for i, j in ((0, 1), (1, 2), (2, 0)):
        t, position = closest_on_segment(x[i], x[j], point)
        distance = np.linalg.norm(point - position)
        if best is None or distance < best[0]:
            s = 0.5*(t + 1.0)
            best = (distance, (1.0 - s)*corner[i] + s*corner[j], position)
    return best[1], best[2]


def closest_on_facet(name: str, x: ArrayLike, point: ArrayLike, levels: int = 70
                     ) -> tuple[NDArray, NDArray]:
    """Closest point of any line or surface cell by shrinking a grid: slow, and safe.

    Returns the parametric point and its position; accurate to about 1e-8 of the cell.
    """
    cell, x, point = CELLS[name], np.asarray(x, float), np.asarray(point, float)
    low, high = (-1.0, 1.0) if cell.family in ("line", "quad") else (0.0, 1.0)
    centre, reach = np.full(cell.ndim, 0.5*(low + high)), 0.5*(high - low)
    best = (np.inf, centre, point)
    powers, at_nodes = monomials(name)
    coefficients = np.linalg.solve(at_nodes, x)
    for level in range(levels):
        ticks = np.linspace(-1.0, 1.0, 9 if level == 0 else 5)
        offsets = np.array(list(product(ticks, repeat=cell.ndim)))
        xi = np.clip(centre + reach*offsets, low, high)
        if cell.family == "triangle":
            beyond = np.maximum(xi.sum(axis=1, keepdims=True) - 1.0, 0.0)
            xi = np.clip(xi - 0.5*beyond, 0.0, 1.0)
            xi /= np.maximum(1.0, xi.sum(axis=1, keepdims=True))
        position = np.prod(xi[:, None, :]**powers, axis=2) @ coefficients
        distance = np.linalg.norm(point - position, axis=1)
        k = int(np.argmin(distance))
        if distance[k] < best[0]:
            best = (distance[k], xi[k], position[k])
        centre, reach = best[1], 0.75*reach
    return best[1], best[2]


def facet_normal(name: str, x: ArrayLike, xi: ArrayLike) -> NDArray:
    """Unit normal: right-hand rule for surfaces, to the right of the way 1 -> 2 for lines."""
    tangents = shape_functions(name, xi)[1].T @ np.asarray(x, float)
    if len(tangents) == 1:
        normal = np.array([tangents[0, 1], -tangents[0, 0]])
    else:
        normal = np.cross(*tangents)
    return normal/np.linalg.norm(normal)


def plane_gap(origin: ArrayLike, normal: ArrayLike, points: ArrayLike) -> NDArray:
    """Gaps to a plane whose outward normal is given."""
    normal = np.asarray(normal, float)/np.linalg.norm(normal)
    return (np.atleast_2d(points) - np.asarray(origin, float)) @ normal


def sphere_gap(center: ArrayLike, radius: float, points: ArrayLike,
               cavity: bool = False) -> NDArray:
    """Gaps to a sphere (a circle in 2D); to the inside of one if `cavity`."""
    distance = np.linalg.norm(np.atleast_2d(points) - np.asarray(center, float), axis=1)
    return radius - distance if cavity else distance - radius


def cylinder_gap(start: ArrayLike, end: ArrayLike, radius: float, points: ArrayLike) -> NDArray:
    """Gaps to an endless cylinder about the axis through two points."""
    start, end = np.asarray(start, float), np.asarray(end, float)
    axis = (end - start)/np.linalg.norm(end - start)
    relative = np.atleast_2d(points) - start
    return np.linalg.norm(relative - np.outer(relative @ axis, axis), axis=1) - radius


def profile_gap(profile, point: ArrayLike, pieces: int = 4000) -> float:
    """Signed distance to a `Profile` in its plane by cutting it into chords; error ~ 1/pieces^2."""
    way = [np.array(profile.rows[0][1:3])]
    for row in profile.rows[1:]:
        first, last = way[-1], np.array(row[1:3])
        t = np.linspace(0.0, 1.0, pieces + 1)[1:, None]
        if row[0] == "LINE":
            way += list(first + t*(last - first))
            continue
        centre = np.array(row[3:5])
        a, b = (np.arctan2(*(p - centre)[::-1]) for p in (first, last))
        turn = (b - a + np.pi) % (2.0*np.pi) - np.pi
        angle = a + turn*t[:, 0]
        radius = np.linalg.norm(first - centre)
        way += list(centre + radius*np.stack([np.cos(angle), np.sin(angle)], axis=1))
    way = np.array(way)
    point = np.asarray(point, float)
    step = way[1:] - way[:-1]
    t = np.clip(((point - way[:-1])*step).sum(axis=1)/(step**2).sum(axis=1), 0.0, 1.0)
    away = point - (way[:-1] + t[:, None]*step)
    k = int((away**2).sum(axis=1).argmin())
    left = -step[k, 1]*away[k, 0] + step[k, 0]*away[k, 1]
    return float(np.copysign(np.linalg.norm(away[k]), left))


def skyline_ldlt(matrix: ArrayLike) -> tuple[NDArray, NDArray, NDArray]:
    """Unit lower L, diagonal d, first nonzero of each row: A = L diag(d) L' in the profile."""
    a = np.asarray(matrix, float)
    n = len(a)
    first = np.array([min(np.flatnonzero(a[i, :i + 1]), default=i) for i in range(n)])
    low, d = np.eye(n), np.zeros(n)
    for i in range(n):
        for j in range(first[i], i):
            k = max(first[i], first[j])
            low[i, j] = (a[i, j] - low[i, k:j]*d[k:j] @ low[j, k:j])/d[j]
        d[i] = a[i, i] - low[i, first[i]:i]**2 @ d[first[i]:i]
    return low, d, first


def contact_active_set(compliance: ArrayLike, gap: ArrayLike, limit: int = 200
                       ) -> tuple[NDArray, int]:
    """Forces p >= 0 with g = gap + S p >= 0, p g = 0, by the primal-dual active set; iterations."""
    s, gap = np.asarray(compliance, float), np.asarray(gap, float)
    force, active = np.zeros(len(gap)), gap < 0.0
    scale = 1.0/np.diag(s)
    for iteration in range(1, limit + 1):
        force = np.zeros(len(gap))
        force[active] = np.linalg.solve(s[np.ix_(active, active)], -gap[active])
        new = force - scale*(gap + s @ force)*~active > 0.0
        if (new == active).all():
            return force, iteration
        active = new
    return contact_oracle(s, gap), limit


def contact_oracle(compliance: ArrayLike, gap: ArrayLike) -> NDArray:
    """The same by non-negative least squares: min |L' p + L^-1 g| with S = L L'; needs scipy."""
    from scipy.optimize import nnls

    low = np.linalg.cholesky(np.asarray(compliance, float))
    return nnls(low.T, -np.linalg.solve(low, np.asarray(gap, float)))[0]
