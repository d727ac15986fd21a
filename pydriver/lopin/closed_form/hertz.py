"""Closed forms of half-space contact: Hertz, flat and conical punches, Boussinesq.

Source: K. L. Johnson, Contact Mechanics, Cambridge University Press, 1985 (section numbers below).
Forces of line contacts are per unit thickness. Small strains, half-spaces.
"""
from __future__ import annotations

from dataclasses import dataclass
from math import log, pi, radians, sqrt, tan

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import UsageError

RIGID = float("inf")


def contact_modulus(young: float, poisson: float, young_2: float = RIGID,
                    poisson_2: float = 0.0) -> float:
    """E*: 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2 [stress] (Johnson 4.2).

    >>> round(contact_modulus(210e3, 0.3, 70e3, 0.3), 1)
    57692.3
    """
    return 1.0/((1.0 - poisson**2)/young + (1.0 - poisson_2**2)/young_2)


def relative_radius(radius: float, radius_2: float = RIGID) -> float:
    """R: 1/R = 1/R1 + 1/R2; infinite for a plane, negative for a cavity [length]."""
    return 1.0/(1.0/radius + 1.0/radius_2)


@dataclass(frozen=True)
class HertzLine:
    """Cylinders in contact: pressure p0 sqrt(1 - x^2/a^2) (Johnson 4.42-4.45)."""

    force: float   #: [force/length]
    a: float       #: half width [length]
    p0: float      #: largest pressure [stress]

    def pressure(self, x: ArrayLike) -> NDArray:
        """Pressure at distances x from the middle [stress]."""
        return _ellipse(self.p0, self.a, x)

    def axis_stress(self, depth: ArrayLike, poisson: float) -> NDArray:
        """(n, 3) stresses xx, yy (along the load), zz under the middle, plane strain [stress]."""
        z = np.asarray(depth, float)/self.a
        root = np.sqrt(1.0 + z**2)
        xx = -self.p0*((1.0 + 2.0*z**2)/root - 2.0*z)
        yy = -self.p0/root
        return np.stack([xx, yy, poisson*(xx + yy)], axis=-1)


@dataclass(frozen=True)
class HertzPoint:
    """Spheres in contact: pressure p0 sqrt(1 - r^2/a^2) (Johnson 4.22-4.24, 3.45)."""

    force: float      #: [force]
    a: float          #: contact radius [length]
    p0: float         #: largest pressure [stress]
    approach: float   #: of distant points [length]

    def pressure(self, r: ArrayLike) -> NDArray:
        """Pressure at distances r from the middle [stress]."""
        return _ellipse(self.p0, self.a, r)

    def axis_stress(self, depth: ArrayLike, poisson: float) -> NDArray:
        """(n, 3) stresses rr, zz (along the load), hoop under the middle [stress]."""
        z = np.asarray(depth, float)/self.a
        zz = -self.p0/(1.0 + z**2)
        angle = np.arctan2(1.0, z)
        rr = -self.p0*(1.0 + poisson)*(1.0 - z*angle) - 0.5*zz
        return np.stack([rr, zz, rr], axis=-1)


def hertz_line(force: float, radius: float, modulus: float) -> HertzLine:
    """Line contact of relative radius R under a force per thickness; `modulus` is E*.

    >>> h = hertz_line(35e3, 50.0, contact_modulus(210e3, 0.3, 70e3, 0.3))
    >>> f"{h.a:.5f} {h.p0:.2f}"
    '6.21463 3585.36'
    """
    a = sqrt(4.0*force*radius/(pi*modulus))
    return HertzLine(force, a, 2.0*force/(pi*a))


def hertz_line_approach(force: float, a: float, young: float, poisson: float, *,
                        cylinder: float | None = None, depth: float | None = None) -> float:
    """Compression of one body of a line contact of half width a [length].

    Either a half cylinder of radius `cylinder`, from its centre (Johnson 5.58), or a block of
    height `depth` on a rigid base (Johnson 5.56). A half-plane has no finite answer.

    >>> round(hertz_line_approach(35e3, 6.21463, 210e3, 0.3, cylinder=50.0), 4)
    0.2869
    """
    factor = force*(1.0 - poisson**2)/(pi*young)
    if cylinder is not None:
        return factor*(2.0*log(4.0*cylinder/a) - 1.0)
    if depth is not None:
        return factor*(2.0*log(2.0*depth/a) - poisson/(1.0 - poisson))
    raise UsageError("a line contact needs `cylinder` or `depth` to say how far its body reaches")


def hertz_point(force: float, radius: float, modulus: float) -> HertzPoint:
    """Point contact of relative radius R under a force; `modulus` is E*."""
    a = (0.75*force*radius/modulus)**(1.0/3.0)
    return HertzPoint(force, a, 1.5*force/(pi*a**2), a**2/radius)


def hertz_point_approach(approach: float, radius: float, modulus: float) -> HertzPoint:
    """Point contact of relative radius R at a given approach; `modulus` is E*.

    >>> h = hertz_point_approach(0.02, 50.0, contact_modulus(20e3, 0.3))
    >>> f"{h.a:.6f} {h.force:.4f} {h.p0:.3f}"
    '1.000000 586.0806 279.833'
    """
    return hertz_point(4.0/3.0*modulus*sqrt(radius*approach**3), radius, modulus)


def hertz_sphere_plane(force: float, radius: float, young: float, poisson: float,
                       young_2: float = RIGID, poisson_2: float = 0.0) -> HertzPoint:
    """A sphere on a plane; the second body is rigid unless given.

    >>> h = hertz_sphere_plane(1000.0, 10.0, 210e3, 0.3)
    >>> f"{h.a:.6f} {h.p0:.2f} {h.approach:.7f}"
    '0.319125 4688.34 0.0101841'
    """
    return hertz_point(force, radius, contact_modulus(young, poisson, young_2, poisson_2))


def flat_punch_2d(force: float, a: float, x: ArrayLike) -> NDArray:
    """Pressure under a rigid flat punch of half width a: P/(pi sqrt(a^2 - x^2)) (Johnson 2.64).

    >>> flat_punch_2d(1000.0, 10.0, [0.0, 9.0]).round(4)
    array([31.831 , 73.0253])
    """
    return _edge_singular(force/pi, a, x)


def flat_punch_axisymmetric(force: float, a: float, modulus: float) -> float:
    """Depth of a rigid flat cylinder of radius a: P/(2 a E*) (Johnson 3.36).

    >>> f"{flat_punch_axisymmetric(1000.0, 10.0, contact_modulus(210e3, 0.3)):.5e}"
    '2.16667e-04'
    """
    return force/(2.0*a*modulus)


def flat_punch_axisymmetric_pressure(force: float, a: float, r: ArrayLike) -> NDArray:
    """Pressure under a rigid flat cylinder: P/(2 pi a sqrt(a^2 - r^2)) (Johnson 3.34)."""
    return _edge_singular(force/(2.0*pi*a), a, r)


@dataclass(frozen=True)
class ConeContact:
    """A rigid cone in a half-space."""

    a: float       #: contact radius [length]
    force: float   #: [force]


def cone_punch(depth: float, angle: float, modulus: float) -> ConeContact:
    """A rigid cone whose flank makes `angle` degrees with the surface (Sneddon; Johnson 5.12).

    >>> c = cone_punch(0.05, 10.0, contact_modulus(210e3, 0.3))
    >>> f"{c.a:.4f} {c.force:.2f}"
    '0.1805 2082.95'
    """
    slope = tan(radians(angle))
    a = 2.0*depth/(pi*slope)
    return ConeContact(a, 0.5*pi*a**2*modulus*slope)


def boussinesq_point(force: float, r: ArrayLike, young: float, poisson: float) -> NDArray:
    """Settlement of the surface at distances r from a point force (Johnson 3.22) [length]."""
    return (1.0 - poisson**2)*force/(pi*young*np.asarray(r, float))


def boussinesq_disc(pressure: float, a: float, young: float, poisson: float) -> dict[str, float]:
    """Settlement under a uniform pressure on a disc: centre, edge, mean (Johnson 3.29).

    >>> s = boussinesq_disc(100.0, 10.0, 210e3, 0.3)
    >>> " ".join(f"{s[k]:.5e}" for k in ("centre", "edge", "mean"))
    '8.66667e-03 5.51737e-03 7.35650e-03'
    """
    unit = (1.0 - poisson**2)*pressure*a/young
    return {"centre": 2.0*unit, "edge": 4.0*unit/pi, "mean": 16.0*unit/(3.0*pi)}


def first_yield_line(poisson: float) -> tuple[float, float]:
    """(p0/Y, depth/a) at which von Mises yield starts under a line contact, on the axis."""
    return _first_yield(HertzLine(0.0, 1.0, 1.0), poisson)


def first_yield_point(poisson: float) -> tuple[float, float]:
    """(p0/Y, depth/a) at which von Mises yield starts under a point contact, on the axis."""
    return _first_yield(HertzPoint(0.0, 1.0, 1.0, 0.0), poisson)


def _first_yield(contact: HertzLine | HertzPoint, poisson: float) -> tuple[float, float]:
    low, high = 0.05, 3.0
    for _ in range(12):
        depth = np.linspace(low, high, 41)
        s = contact.axis_stress(depth, poisson)
        mises = np.sqrt(0.5*((s - np.roll(s, 1, axis=-1))**2).sum(axis=-1))
        k = int(mises.argmax())
        low, high = depth[max(k - 1, 0)], depth[min(k + 1, 40)]
    return float(1.0/mises[k]), float(depth[k])


def _ellipse(p0: float, a: float, x: ArrayLike) -> NDArray:
    return p0*np.sqrt(np.maximum(0.0, 1.0 - (np.asarray(x, float)/a)**2))


def _edge_singular(factor: float, a: float, x: ArrayLike) -> NDArray:
    x = np.asarray(x, float)
    inside = np.abs(x) < a
    return np.where(inside, factor/np.sqrt(np.where(inside, a**2 - x**2, 1.0)), 0.0)
