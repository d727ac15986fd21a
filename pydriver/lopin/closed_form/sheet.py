"""Closed forms of sheets: bending and springback, to and fro, air bending, drawing of a cup.

Bending is plane strain (wide sheets), per unit width; angles in radians.
"""
from __future__ import annotations

from dataclasses import dataclass
from math import exp, inf, log, pi, sqrt
from typing import Any, Callable, Sequence

import numpy as np

Array = Any   #: of numpy, one entry for each fibre


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


@dataclass(frozen=True)
class BentFibres:
    """A wide sheet bent along a path of curvatures, then released."""

    moments: tuple[float, ...]   #: at the curvatures of the path, per width [force]
    curvature: float             #: that the release leaves [1/length]
    flowed: float                #: mean plastic strain that the release adds [-]


def bent_fibres(young: float, poisson: float, thickness: float, path: Sequence[float],
                flow: Callable[[Array], tuple[Array, Array]],
                back: Sequence[tuple[float, float]] = (), steps: int = 400) -> BentFibres:
    """Pure bending to and fro in plane strain, fibre by fibre (Yoshida's bending-unbending).

    A fibre at y has the logarithmic strain ln(1 + curvature*y) along the sheet and none across,
    and carries no stress through the thickness. `flow` gives the flow stress and its slope at
    accumulated plastic strains; `back` are pairs (C, gamma) of Armstrong and Frederick,
    d(alpha) = C (s - alpha)/flow de - gamma alpha de. Each curvature is reached in `steps` steps of
    the midpoint rule; the release goes on until the moment is none, whether fibres flow or not.

    >>> bent = bent_fibres(210e3, 0.3, 1.0, [1/20], lambda e: (300.0 + 0.0*e, 0.0*e))
    >>> round(bent.moments[0], 1), round(1.0/bent.curvature, 2)
    (86.5, 21.98)
    """
    half, weight = np.polynomial.legendre.leggauss(20)
    y = 0.25*thickness*np.concatenate([half - 1.0, half + 1.0])
    weight = 0.25*thickness*np.concatenate([weight, weight])
    fibres = _Fibres(young, poisson, len(y), flow, back)
    moments = []
    now = 0.0

    def bend(to: float) -> float:
        nonlocal now
        fibres.strain(np.log1p(to*y) - np.log1p(now*y))
        now = to
        return float(np.sum(weight*y*fibres.stress[0]))

    for target in path:
        for curvature in np.linspace(now, target, steps + 1)[1:]:
            moment = bend(curvature)
        moments.append(moment)
    before = float(np.sum(weight*fibres.plastic))
    unit = moment*(1.0 - poisson**2)*12.0/(young*thickness**3)/steps
    while True:
        last, start = moment, now
        moment = bend(now - unit)
        if moment*last <= 0.0:
            break
    left = float(start + (now - start)*last/(last - moment))
    grown = float(np.sum(weight*fibres.plastic)) - before
    return BentFibres(tuple(moments), left, grown/thickness)


@dataclass(frozen=True)
class StraightStrip:
    """Pure bending of a strip whose metal hardens along a straight line, in closed form.

    Fibres are bilinear: `modulus` up to `yielding`, `tangent` beyond; they yield again, on the way
    back, after twice their stress (isotropic share 1) or twice the yield stress (share 0: linear
    kinematic hardening, Prager), or what lies between. In plane stress across the strip modulus and
    yield stress are Young's and that of tension; in plane strain they are E/(1 - nu^2) and
    2/sqrt(3) times the yield stress where nu = 1/2. Strains are small.
    """

    modulus: float          #: of a fibre [stress]
    yielding: float         #: of a fibre [stress]
    tangent: float          #: slope beyond [stress]
    thickness: float        #: [length]
    isotropic: float = 0.0  #: share of the hardening that widens the elastic range [-]

    def moment(self, curvature: float) -> float:
        """Of the first bending to a curvature >= 0, per width [force]."""
        m, h = self.modulus, 0.5*self.thickness
        core = min(h, self.yielding/(m*curvature)) if curvature > 0.0 else h
        ratio = self.tangent/m
        return 2.0/3.0*self.tangent*curvature*h**3 + (1.0 - ratio)*(
            2.0/3.0*m*curvature*core**3 + self.yielding*(h**2 - core**2))

    def back(self, bent: float, by: float) -> float:
        """Moment per width after bending to a curvature, and back by 0 <= `by` <= 2*`bent` [force].

        Fibres outside `core` have flowed on the way there; those outside `again` flow on the way
        back, beyond a range of stress that grows along the straight line of their hardening.
        """
        m, h, ratio, s = self.modulus, 0.5*self.thickness, self.tangent/self.modulus, self.isotropic
        left = by - 2.0*s*ratio*bent
        start = 2.0*self.yielding*(1.0 - s*ratio)
        again = min(h, start/(m*left)) if left > 0.0 else h
        # Stress that is taken off: elastic everywhere, less what yields give up outside `again`.
        whole = 2.0/3.0*m*by*h**3
        given = 2.0*(1.0 - ratio)*(m*left*(h**3 - again**3)/3.0 - 0.5*start*(h**2 - again**2))
        return self.moment(bent) - whole + given

    def released(self, bent: float) -> float:
        """Curvature that is left after bending to a curvature and letting go [1/length].

        >>> strip = StraightStrip(2e5, 300.0, 1e4, 1.0)
        >>> round(strip.back(0.05, 0.05 - strip.released(0.05)), 9)
        0.0
        """
        low, high = 0.0, 2.0*bent
        for _ in range(200):
            middle = 0.5*(low + high)
            low, high = (middle, high) if self.back(bent, middle) > 0.0 else (low, middle)
        return bent - 0.5*(low + high)


class _Fibres:
    """Stresses along and across of many fibres, their backstresses and plastic strains."""

    def __init__(self, young: float, poisson: float, count: int,
                 flow: Callable[[Array], tuple[Array, Array]],
                 back: Sequence[tuple[float, float]]):
        self.stress = np.zeros((2, count))
        self.plastic = np.zeros(count)
        self.alpha = np.zeros((len(back), 3, count))
        self.flow, self.back = flow, back
        self.elastic = young/(1.0 - poisson**2)*np.array([[1.0, poisson], [poisson, 1.0]])

    def strain(self, by: Array) -> None:
        """Elastic to the yield surface, then one step of the midpoint rule along it."""
        ahead = self.elastic[:, :1]*by
        at, way = _deviator(self.stress) - self.alpha.sum(0), _deviator(ahead)
        a, b = 1.5*(way**2).sum(0), 3.0*(at*way).sum(0)
        c = 1.5*(at**2).sum(0) - self.flow(self.plastic)[0]**2
        flows = a + b + c > 0.0
        share = (-b + np.sqrt(np.maximum(b*b - 4.0*a*c, 0.0)))/np.maximum(2.0*a, 1e-300)
        share = np.where(flows, np.clip(np.where(c < 0.0, share, 0.0), 0.0, 1.0), 1.0)
        self.stress = self.stress + share*ahead
        rest = (1.0 - share)*by
        stress, plastic, alpha = self.stress, self.plastic, self.alpha
        middle = self._rates(stress, plastic, alpha, rest, flows)
        ds, de, da = self._rates(stress + 0.5*middle[0], plastic + 0.5*middle[1],
                                 alpha + 0.5*middle[2], rest, flows)
        self.stress, self.plastic, self.alpha = stress + ds, plastic + de, alpha + da

    def _rates(self, stress: Array, plastic: Array, alpha: Array, by: Array,
               flows: Array) -> tuple[Array, Array, Array]:
        """Changes of stress, plastic strain and backstresses."""
        bound, slope = self.flow(plastic)
        x = _deviator(stress) - alpha.sum(0)
        normal = 1.5*x/np.sqrt(1.5*(x**2).sum(0) + 1e-300)
        spread = self.elastic @ normal[[0, 2]]
        hard = slope + 0.0*bound
        for (c, gamma), part in zip(self.back, alpha):
            hard = hard + c - gamma*(normal*part).sum(0)
        de = np.maximum(spread[0]*by/((normal[[0, 2]]*spread).sum(0) + hard), 0.0)*flows
        da = np.array([de*(c*x/bound - gamma*part)
                       for (c, gamma), part in zip(self.back, alpha)]).reshape(alpha.shape)
        return self.elastic[:, :1]*by - de*spread, de, da


def _deviator(stress: Array) -> Array:
    """Of stresses along and across: along, through, across."""
    mean = stress.sum(0)/3.0
    return np.array([stress[0] - mean, -mean, stress[1] - mean])
