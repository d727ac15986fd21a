"""Closed forms of sheets: bending and springback, air bending, drawing of a cup.

Bending is plane strain (wide sheets), per unit width; angles in radians.
"""
from __future__ import annotations

from dataclasses import dataclass
from math import exp, inf, log, pi, sqrt


@dataclass(frozen=True)
class BentSheet:
    """A wide sheet bent to a radius, and what the release of the moment leaves of it."""

    core: float           #: elastic core beside the thickness, 1: all of it [-]
    moment: float         #: that holds it, per width [force]
    radius: float         #: of the neutral fibre after release [length]
    elastic_curvature: float  #: that the release takes back [1/length]


def bent_sheet(young: float, poisson: float, flow: float, thickness: float,
               radius: float) -> BentSheet:
    """Pure bending of an elastic, perfectly plastic sheet to a neutral radius (Hill 1950, V.2).

    The flow stress across is 2/sqrt(3) of the uniaxial one, the modulus E/(1 - nu^2); fibres
    between core and skin carry the flow stress. Valid while thickness << radius.

    >>> sheet = bent_sheet(210e3, 0.3, 300.0, 1.0, 20.0)
    >>> round(sheet.moment, 4), round(sheet.radius, 5)
    (86.4985, 21.97702)
    """
    modulus = young/(1.0 - poisson**2)
    plane = 2.0*flow/sqrt(3.0)
    stiffness = modulus*thickness**3/12.0
    core = min(1.0, 2.0*plane*radius/(modulus*thickness))
    moment = plane*thickness**2/4.0*(1.0 - core**2/3.0) if core < 1.0 else stiffness/radius
    left = 1.0/radius - moment/stiffness if core < 1.0 else 0.0
    return BentSheet(core, moment, 1.0/left if left > 0.0 else inf, moment/stiffness)


def considere_strength(flow: float, hardening: float) -> float:
    """Ultimate tensile strength of flow + hardening*eps: nominal stress where it is largest.

    d(sigma)/d(eps) = sigma gives eps = 1 - flow/hardening (0 if it hardens less than it flows).

    >>> round(considere_strength(300.0, 500.0), 1)
    335.2
    """
    strain = max(0.0, 1.0 - flow/hardening)
    return (flow + hardening*strain)*exp(-strain)


def air_bending_force(strength: float, thickness: float, opening: float,
                      factor: float = 1.33) -> float:
    """Largest force of bending in a V, per width: factor*strength*thickness^2/opening.

    The factor is workshop practice (Kalpakjian and Schmid): 1.33 for a V-die.
    """
    return factor*strength*thickness**2/opening


def ideal_cup_force(punch: float, thickness: float, strength: float, exponent: float, blank: float,
                    rim: float) -> float:
    """Force that draws a flange inwards, without friction, bending and change of thickness.

    The metal flows by K eps^n; a particle at r came from sqrt(blank^2 - rim^2 + r^2), and
    sigma_r = integral of sigma/r from the cup's radius to the rim.

    >>> round(ideal_cup_force(50.0, 0.82, 513.0, 0.223, 100.0, 90.0))
    52763
    """
    from scipy.integrate import quad

    def slope(r: float) -> float:
        return strength*max(log(sqrt(blank**2 - rim**2 + r*r)/r), 0.0)**exponent/r

    return 2.0*pi*punch*thickness*quad(slope, punch, rim)[0]
