"""Closed forms of bodies and structures: bars, springs, tubes, beams.

And the law of the penalty: its error, and the error of each augmentation, known beforehand.
"""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True)
class OneContact:
    """One contact point."""

    displacement: tuple[float, ...]   #: of the masses, or of the tip [length]
    reaction: float                   #: >= 0 [force]
    penetration: float                #: >= 0 [length]


def bar_with_gap(young: float, area: float, length: float, gap: float, force: float,
                 slope: float | None = None) -> OneContact:
    """A clamped bar pushed by its tip against a rigid wall.

    Exact contact (Lagrange) unless `slope` [force/length] is given: then penalty, which is also
    the perturbed Lagrangian. Balance: k u + R = F, with R = 0 or u = gap + penetration.

    >>> bar_with_gap(210e3, 100.0, 1000.0, 0.1, 10e3).reaction
    7900.0
    >>> round(bar_with_gap(210e3, 100.0, 1000.0, 0.1, 10e3, slope=210e3).reaction, 6)
    7181.818182
    """
    k = young*area/length
    excess = max(0.0, force - k*gap)
    penetration = 0.0 if slope is None else excess/(k + slope)
    reaction = excess if slope is None else slope*penetration
    return OneContact(((force - reaction)/k,), reaction, penetration)


def bar_with_gap_augmented(young: float, area: float, length: float, gap: float, force: float,
                           slope: float, solves: int) -> float:
    """Reaction of the same bar after n solves of the augmented Lagrangian started from 0 [force].

    >>> round(bar_with_gap_augmented(210e3, 100.0, 1000.0, 0.1, 10e3, 210e3, 3), 6)
    7894.064613
    """
    exact = bar_with_gap(young, area, length, gap, force).reaction
    return exact*(1.0 - penalty_error(slope, length/(young*area))**solves)


def two_springs(k1: float, k2: float, gap: float, force: float,
                slope: float | None = None) -> OneContact:
    """Two masses held by springs to two walls; the force pushes the first against the second.

    >>> two_springs(1000.0, 500.0, 0.2, 800.0).reaction.__round__(9)
    200.0
    >>> round(two_springs(1000.0, 500.0, 0.2, 800.0, slope=1e4).reaction, 7)
    193.5483871
    """
    compliance = 1.0/k1 + 1.0/k2 + (0.0 if slope is None else 1.0/slope)
    reaction = max(0.0, force/k1 - gap)/compliance
    penetration = 0.0 if slope is None else reaction/slope
    return OneContact(((force - reaction)/k1, reaction/k2), reaction, penetration)


def penalty_error(slope: float, compliance: float) -> float:
    """beta = 1/(1 + alpha s): relative pressure error of penalty; also what an augmentation leaves.

    `compliance` s is an eigenvalue of G' K^-1 G [length/force], `slope` alpha [force/length].

    >>> penalty_error(1e3, 3e-3)
    0.25
    """
    return 1.0/(1.0 + slope*compliance)


def penalty_slope(error: float, compliance: float) -> float:
    """Slope that reaches a relative pressure error: the inverse of `penalty_error`."""
    return (1.0/error - 1.0)/compliance


@dataclass(frozen=True)
class Tube:
    """Lame's thick tube between radii a and b: sigma_r = A - B/r^2, hoop = A + B/r^2.

    Source: Timoshenko and Goodier, Theory of Elasticity, 3rd ed., section 28.
    """

    a: float
    b: float
    inside: float      #: pressure on r = a, >= 0 pushes outward [stress]
    outside: float     #: pressure on r = b, >= 0 pushes inward [stress]
    young: float
    poisson: float
    kind: str = "plane strain"   #: or "plane stress"

    def _constants(self) -> tuple[float, float]:
        area = self.b**2 - self.a**2
        mean = (self.inside*self.a**2 - self.outside*self.b**2)/area
        return mean, (self.inside - self.outside)*self.a**2*self.b**2/area

    def stress(self, r: ArrayLike) -> NDArray:
        """(n, 2) radial and hoop stress [stress]."""
        mean, spread = self._constants()
        r = np.asarray(r, float)
        return np.stack([mean - spread/r**2, mean + spread/r**2], axis=-1)

    def displacement(self, r: ArrayLike) -> NDArray:
        """Radial displacement [length]."""
        mean, spread = self._constants()
        r = np.asarray(r, float)
        in_plane = 1.0 - self.poisson
        if self.kind == "plane strain":
            in_plane = (1.0 + self.poisson)*(1.0 - 2.0*self.poisson)
        return (in_plane*mean*r + (1.0 + self.poisson)*spread/r)/self.young


def thick_tube(a: float, b: float, pressure: float, young: float, poisson: float,
               kind: str = "plane strain") -> Tube:
    """A tube under internal pressure.

    >>> f"{thick_tube(1.0, 2.0, 1.0, 1000.0, 0.3).displacement(1.0):.6e}"
    '1.906667e-03'
    """
    return Tube(a, b, pressure, 0.0, young, poisson, kind)


def nested_rings(radii: tuple[float, float, float], pressure: float, young: tuple[float, float],
                 poisson: tuple[float, float], kind: str = "plane strain",
                 interference: float = 0.0) -> tuple[Tube, Tube]:
    """Outer and inner ring in frictionless contact at the middle radius.

    Parameters
    ----------
    radii : (outer, middle, inner) [length]
    pressure : on the outer radius [stress]
    young, poisson : of the outer and of the inner ring
    interference : radial overlap before assembly (shrink fit) [length]

    Returns
    -------
    The two rings; the contact pressure is ``outer.inside``.

    >>> outer, inner = nested_rings((1.0, 0.6, 0.2), 1e6, (1e9, 1e9), (0.2, 0.2))
    >>> f"{outer.inside:.3f} {inner.displacement(0.6):.5e}"
    '925925.926 -5.33333e-04'
    """
    r3, r2, r1 = radii

    def opening(contact: float) -> float:
        outer = Tube(r2, r3, contact, pressure, young[0], poisson[0], kind)
        inner = Tube(r1, r2, 0.0, contact, young[1], poisson[1], kind)
        return float(outer.displacement(r2) - inner.displacement(r2))

    start = opening(0.0)
    contact = max(0.0, (interference - start)/(opening(1.0) - start))
    return (Tube(r2, r3, contact, pressure, young[0], poisson[0], kind),
            Tube(r1, r2, 0.0, contact, young[1], poisson[1], kind))


@dataclass(frozen=True)
class LiftedBeam:
    """A heavy beam lifted by its end from a rigid floor."""

    free_length: float   #: between lift-off point and end [length]
    lift: float          #: of the end [length]
    reaction: float      #: concentrated at the lift-off point [force]
    stiffness: float
    weight: float

    def deflection(self, s: ArrayLike) -> NDArray:
        """Height at distances s from the lift-off point [length]."""
        s = np.clip(np.asarray(s, float), 0.0, None)
        return self.weight*s**3*(2.0*self.free_length - s)/(24.0*self.stiffness)


def lifted_beam(stiffness: float, weight: float, force: float) -> LiftedBeam:
    """Euler-Bernoulli beam EI under its weight per length q, end lifted by F.

    No moment at the lift-off point: F l = q l^2/2; EI w'' = q s (l - s)/2.

    >>> b = lifted_beam(1e6, 1.0, 50.0)
    >>> f"{b.free_length} {b.lift:.6f} {b.reaction}"
    '100.0 4.166667 50.0'
    """
    length = 2.0*force/weight
    return LiftedBeam(length, weight*length**4/(24.0*stiffness), weight*length - force,
                      stiffness, weight)
