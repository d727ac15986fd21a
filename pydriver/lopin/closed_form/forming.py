"""Bulk forming: upsetting, rings, discs and strips between plates, wire through a cone.

Stresses in the unit of the yield stress, lengths in one unit, reductions as fractions of the first
height. Slabs and bounds are for a rigid, perfectly plastic solid of von Mises.
"""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, exp, log, pi, sin, sqrt, tan

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Upset:
    """A homogeneous billet: the axial Kirchhoff stress follows the flow curve Y + H eps_p."""

    strain: float           #: ln(height at the start/height) [-]
    kirchhoff: float        #: axial stress times the change of volume, compression > 0 [stress]
    volume: float           #: change of volume J [-]
    radius: float           #: [length]
    force: float            #: [force]


def upset(reduction: float, young: float, poisson: float, yield_stress: float, hardening: float,
          radius: float) -> Upset:
    """Frictionless upsetting, elastic strain included (Hencky; stress per reference volume).

    >>> at = upset(0.6, 200e3, 0.3, 700.0, 300.0, 10.0)
    >>> round(at.force/1e3, 3), round(at.radius, 5)
    (764.528, 15.796)
    """
    strain = log(1.0/(1.0 - reduction))
    kirchhoff = young*strain
    if kirchhoff > yield_stress:
        kirchhoff = (yield_stress + hardening*strain)/(1.0 + hardening/young)
    volume = exp(-(1.0 - 2.0*poisson)*kirchhoff/young)
    at = radius*sqrt(volume/(1.0 - reduction))
    return Upset(strain, kirchhoff, volume, at, kirchhoff/volume*pi*at*at)


def ring_bore(shear_factor: float, reduction: float, outer: float = 3.0, inner: float = 1.5,
              height: float = 2.0, steps: int = 40) -> float:
    """Change of the bore of a ring between plates with shear m k: fraction, > 0 wider.

    Upper bound with one free number, the neutral radius, chosen at every instant; the walls stay
    straight (Avitzur 1968): without friction exact. Steps of fourth order along the logarithm of
    the height.

    >>> round(100*ring_bore(0.0, 0.5), 1), round(100*ring_bore(0.2, 0.3), 1)
    (41.4, 1.0)
    """
    from scipy.optimize import minimize_scalar

    volume = (outer*outer - inner*inner)*height
    place, weight = np.polynomial.legendre.leggauss(24)

    def widening(strain: float, bore: float) -> float:
        """Speed of the bore along -ln(height/first height)."""
        tall = height*exp(-strain)
        far = volume/tall + bore*bore
        edge = sqrt(far)
        square = (0.5*(bore + edge) + 0.5*(edge - bore)*place)**2
        neutral = minimize_scalar(_ring_power, args=(shear_factor, bore, edge, tall, square,
                                                     weight), bounds=(-0.5*far, 0.999*far),
                                  method="bounded", options={"xatol": 1e-10*far}).x
        return 0.5*(bore - neutral/bore)

    bore, step = inner, -log(1.0 - reduction)/steps
    for k in range(steps):
        slope = [widening(k*step, bore)]
        for part in (0.5, 0.5, 1.0):
            slope.append(widening((k + part)*step, bore + part*step*slope[-1]))
        bore += step/6.0*(slope[0] + 2.0*slope[1] + 2.0*slope[2] + slope[3])
    return float(bore/inner - 1.0)


def _ring_power(neutral: float, m: float, inner: float, outer: float, height: float,
                square: NDArray, weight: NDArray) -> float:
    """Power of a ring at unit speed and unit yield stress; `neutral` = signed square of radius,
    `square`: those of Gauss' points of the wall, `weight` on [-1, 1]."""
    # Of 2 pi r sqrt(1 + (neutral/r^2)^2/3).
    flow = pi*(outer - inner)*float(weight @ np.sqrt(square + neutral*neutral/3.0/square))
    ends = [inner, outer]
    if inner*inner < neutral < outer*outer:
        ends.insert(1, sqrt(neutral))
    slip = pi/height*sum(abs((b**3 - a**3)/3.0 - neutral*(b - a)) for a, b in zip(ends, ends[1:]))
    return flow + 2.0*m/sqrt(3.0)*slip


def ring_chart(shear_factors: Sequence[float], reductions: Sequence[float]) -> NDArray:
    """Calibration chart of a 6:3:2 ring: change of the bore [%], a row per shear factor."""
    return np.array([[100.0*ring_bore(m, r) for r in reductions] for m in shear_factors])


def strip_pressure(shear_factor: float, width_to_height: float) -> float:
    """Mean pressure over 2k on a strip in plane strain, shear m k: upper bound with straight walls.

    >>> strip_pressure(1.0, 8.0), strip_pressure(0.2, 4.0)
    (3.0, 1.2)
    """
    return 1.0 + 0.25*shear_factor*width_to_height


def strip_pressure_rough(width_to_height: float) -> float:
    """Mean pressure over 2k on a rough strip, by slip lines (Hill 1950); width/height >= 3.6."""
    if width_to_height < 3.6:
        raise ValueError(f"slip lines of this form need width/height >= 3.6, got {width_to_height}")
    return 0.75 + 0.25*width_to_height


def disc_pressure(shear_factor: float, radius_to_height: float) -> float:
    """Mean pressure over Y on a disc, shear m k: upper bound with straight walls.

    >>> round(disc_pressure(0.2, 1.0), 4)
    1.077
    """
    return 1.0 + 2.0*shear_factor*radius_to_height/(3.0*sqrt(3.0))


@dataclass(frozen=True)
class Drawing:
    """Mean stress over the drawn wire, over Y."""

    ideal: float            #: homogeneous, a lower bound
    bound: float            #: Avitzur's upper bound without friction (1968)


def wire_drawing(before: float, after: float, half_angle: float) -> Drawing:
    """Drawing from one diameter to another through a cone without friction; angle in degrees.

    >>> at = wire_drawing(10.0, 9.0, 8.0)
    >>> round(at.ideal, 4), round(at.bound, 4)
    (0.2107, 0.3186)
    """
    a = half_angle*pi/180.0
    ideal = 2.0*log(before/after)
    root = sqrt(1.0 - 11.0/12.0*sin(a)**2)
    shape = (1.0 - cos(a)*root + log((1.0 + sqrt(11.0/12.0))/(sqrt(11.0/12.0)*cos(a) + root))
             / sqrt(132.0))/sin(a)**2
    turning = 2.0/sqrt(3.0)*(a/sin(a)**2 - 1.0/tan(a))
    return Drawing(ideal, shape*ideal + turning)
