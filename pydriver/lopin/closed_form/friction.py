"""Closed forms with friction: sheared Hertz contacts, ropes, sliders, one node, one point.

Pressures are positive, tractions are those that oppose the slip; angles in radians.
"""
from __future__ import annotations

from dataclasses import dataclass
from math import acos, exp, pi, sqrt, tan

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .hertz import HertzLine, HertzPoint, contact_modulus, hertz_line, hertz_point


@dataclass(frozen=True)
class CattaneoLine:
    """Two equal cylinders pressed, then sheared (Cattaneo 1938, Mindlin 1949)."""

    normal: HertzLine
    c: float        #: half width of the middle that sticks [length]
    mu: float

    @property
    def q_centre(self) -> float:
        """Shear traction in the middle [stress]."""
        return float(self.traction(0.0))

    @property
    def q_largest(self) -> float:
        """At the edge of stick [stress]."""
        return float(self.traction(self.c))

    def traction(self, x: ArrayLike) -> NDArray:
        """Shear: mu times the pressure, less a smaller ellipse over the part that sticks."""
        x = np.asarray(x, float)
        a, p0 = self.normal.a, self.normal.p0
        outer = np.sqrt(np.clip(1.0 - (x/a)**2, 0.0, None))
        inner = np.sqrt(np.clip(1.0 - (x/self.c)**2, 0.0, None))*self.c/a
        return self.mu*p0*(outer - inner)


def cattaneo_line(force: float, shear: float, mu: float, radius: float, modulus: float
                  ) -> CattaneoLine:
    """Force, then shear < mu force, per length of like materials: c/a = sqrt(1 - Q/(mu P)).

    >>> s = cattaneo_line(1000.0, 150.0, 0.3, 100.0, contact_modulus(210e3, 0.3, 210e3, 0.3))
    >>> [round(v, 5) for v in (s.normal.a, s.c, s.q_centre, s.q_largest)]
    [1.05046, 0.74279, 53.25122, 128.55983]
    """
    normal = hertz_line(force, radius, modulus)
    return CattaneoLine(normal, normal.a*sqrt(1.0 - shear/(mu*force)), mu)


@dataclass(frozen=True)
class MindlinPoint:
    """Two equal spheres pressed, then sheared (Mindlin 1949, Mindlin and Deresiewicz 1953)."""

    normal: HertzPoint
    force: float         #: [force]
    mu: float
    compliance: float    #: sum of (2 - nu)/G [1/stress]

    def stick_radius(self, shear: float) -> float:
        """Radius of the middle that sticks, first loading [length]."""
        return float(self.normal.a*np.cbrt(1.0 - shear/(self.mu*self.force)))

    def displacement(self, shear: float) -> float:
        """Of the two bodies against each other, first loading [length]."""
        part = 1.0 - abs(shear)/(self.mu*self.force)
        full = 3.0*self.mu*self.force*self.compliance/(16.0*self.normal.a)
        return float(np.sign(shear)*full*(1.0 - part**(2.0/3.0)))

    def cycle(self, shear: ArrayLike, amplitude: float) -> tuple[NDArray, NDArray]:
        """Displacements at these shears on the way down from +amplitude, and on the way up."""
        shear = np.asarray(shear, float)
        turn = self.displacement(amplitude)
        down = [turn - 2.0*self.displacement(0.5*(amplitude - q)) for q in np.ravel(shear)]
        up = [2.0*self.displacement(0.5*(amplitude + q)) - turn for q in np.ravel(shear)]
        return np.reshape(down, shear.shape), np.reshape(up, shear.shape)

    def loop_energy(self, amplitude: float) -> float:
        """Dissipated in a cycle between -amplitude and +amplitude [force*length]."""
        s = amplitude/(self.mu*self.force)
        part = 1.0 - s
        factor = 9.0*(self.mu*self.force)**2*self.compliance/(10.0*self.normal.a)
        return factor*(1.0 - part**(5.0/3.0) - 5.0*s/6.0*(1.0 + part**(2.0/3.0)))


def mindlin_point(force: float, mu: float, radius: float, young: float, poisson: float
                  ) -> MindlinPoint:
    """Two spheres of one material; `radius` is that of the gap, R/2 of equal spheres.

    >>> s = mindlin_point(1000.0, 0.3, 10.0, 210e3, 0.3)
    >>> [round(v, 6) for v in (s.normal.a, s.stick_radius(100.0))]
    [0.402073, 0.351243]
    >>> f"{s.displacement(100.0):.6e} {s.loop_energy(100.0):.8f}"
    '1.394882e-03 0.01251884'
    """
    shear_modulus = young/(2.0*(1.0 + poisson))
    normal = hertz_point(force, radius, contact_modulus(young, poisson, young, poisson))
    return MindlinPoint(normal, force, mu, 2.0*(2.0 - poisson)/shear_modulus)


def capstan(mu: float, angle: float, thickness: float = 0.0, radius: float = 1.0) -> float:
    """T2/T1 of a belt that slides round a drum, with all of its thickness above the surface.

    Friction acts on the drum, tension in the middle of the belt. At constant curvature the couple
    of the two is carried by a shear force kappa f, kappa = t/(2 R + t), f the friction an angle:
    T' = (1 - kappa) f and T - kappa f' = f/mu, hence f ~ exp(s angle) with kappa s^2 + s/mu =
    1 - kappa. Without thickness s = mu (Euler, Eytelwein).

    >>> [round(capstan(mu, 0.5*pi), 6) for mu in (0.1, 0.2, 0.3)], round(capstan(0.3, pi), 6)
    ([1.170089, 1.369108, 1.601978], 2.566332)
    """
    kappa = thickness/(2.0*radius + thickness)
    exponent = 2.0*(1.0 - kappa)/(1.0/mu + sqrt(1.0/mu**2 + 4.0*kappa*(1.0 - kappa)))
    return exp(exponent*angle)


def stick_slip_energy(stiffness: float, limit: float, amplitude: float) -> float:
    """Of a cycle of a spring in series with a slider: 4 limit (U - limit/k) [force*length].

    >>> round(stick_slip_energy(1000.0, 30.0, 0.1), 12)
    8.4
    """
    return 4.0*limit*max(0.0, amplitude - limit/stiffness)


@dataclass(frozen=True)
class RotatingSlider:
    """A slider dragged by a spring whose end runs round a circle, in its steady state."""

    lag: float           #: angle of the force behind the end of the spring [rad]
    slider_radius: float   #: of the slider's own circle [length]
    energy: float        #: dissipated a turn [force*length]


def rotating_slider(stiffness: float, limit: float, radius: float) -> RotatingSlider:
    """cos(lag) = limit/(k R); the slider runs on a circle of radius R sin(lag).

    >>> s = rotating_slider(1000.0, 30.0, 0.2)
    >>> round(s.lag*180.0/pi, 2), round(s.energy, 4)
    (81.37, 37.2726)
    """
    cosine = limit/(stiffness*radius)
    lag, own = acos(cosine), radius*sqrt(1.0 - cosine**2)
    return RotatingSlider(lag, own, 2.0*pi*own*limit)


def slider_path(normal: float, tangential: float, mu: float, path: ArrayLike) -> float:
    """Traction at the end of a path of (approach, tangential) displacements of one node.

    Springs `normal` and `tangential` [force/length]; straight legs between the points.

    >>> down, aside = (0.1, 0.0), (0.1, 0.02)
    >>> [slider_path(1000.0, 1000.0, 0.3, p) for p in ([down, aside], [(0.0, 0.02), aside])]
    [20.0, 0.0]
    >>> slider_path(1000.0, 1000.0, 0.3, [down, aside, (0.05, 0.02), aside])
    15.0
    """
    points = np.asarray(path, float)
    force, last = 0.0, np.zeros(2)
    for point in points:
        # A leg with steps so fine that the cone is followed; one step is exact on straight legs
        # that change only one of the two.
        steps = 1 if np.count_nonzero(point - last) < 2 else 100000
        for i in range(1, steps + 1):
            limit = mu*normal*max(0.0, last[0] + (point[0] - last[0])*i/steps)
            trial = force + tangential*(point[1] - last[1])/steps
            force = float(np.clip(trial, -limit, limit))
        last = point
    return force


@dataclass(frozen=True)
class NodeState:
    """One solution of a node that may touch, stick and slip."""

    state: str                       #: free, stick, slip
    displacement: tuple[float, float]   #: towards the obstacle <= 0, along it
    reaction: tuple[float, float]    #: of the obstacle: normal >= 0, tangential


def one_node(stiffness: ArrayLike, force: tuple[float, float], mu: float) -> list[NodeState]:
    """All static solutions of Klarbring's node: K u + r = F, u_n <= 0 <= r_n, |r_t| <= mu r_n.

    >>> [s.state for s in one_node([[4.0, 1.6], [1.6, 1.0]], (1.0, 0.9), 1.0)]
    ['free', 'stick', 'slip']
    """
    k = np.asarray(stiffness, float)
    c, kt = k[0, 1], k[1, 1]
    fn, ft = force
    found = []
    un, ut = np.linalg.solve(k, force)
    if un <= 0.0:
        found.append(NodeState("free", (float(un), float(ut)), (0.0, 0.0)))
    if fn >= 0.0 and abs(ft) <= mu*fn:
        found.append(NodeState("stick", (0.0, 0.0), (fn, ft)))
    for way in (1.0, -1.0):
        ut = (ft - way*mu*fn)/(kt - way*mu*c)
        rn = fn - c*ut
        if way*ut > 0.0 and rn >= 0.0:
            found.append(NodeState("slip", (0.0, float(ut)), (float(rn), float(way*mu*rn))))
    return found


def unique_below(stiffness: ArrayLike) -> float:
    """The coefficient below which one node has one solution: K_t/|C| (Klarbring 1990).

    >>> round(unique_below([[4.0, 1.6], [1.6, 1.0]]), 12)
    0.625
    """
    k = np.asarray(stiffness, float)
    return float(k[1, 1]/abs(k[0, 1]))


def triangle_unique_below(poisson: float, shear: float) -> float:
    """The same for a triangle with corners (0, 0), (1, 0), (1 - shear, 1), the last two held.

    (d11 + t^2)/((d12 + 1) t), with the moduli of plane strain over G.

    >>> round(triangle_unique_below(0.49, 7.0), 6)
    0.285714
    """
    d11 = 2.0*(1.0 - poisson)/(1.0 - 2.0*poisson)
    d12 = 2.0*poisson/(1.0 - 2.0*poisson)
    return (d11 + shear**2)/((d12 + 1.0)*shear)


def triangle_unique_below_least(poisson: float) -> tuple[float, float]:
    """The least of it and the shear where it is reached.

    >>> [round(v, 4) for v in triangle_unique_below_least(0.3)]
    [1.4967, 1.8708]
    """
    shear = sqrt(2.0*(1.0 - poisson)/(1.0 - 2.0*poisson))
    return triangle_unique_below(poisson, shear), shear


def wedge_stays(half_angle: float, mu: float) -> bool:
    """A wedge pressed between two planes and released stays if tan(half angle) <= mu.

    >>> [wedge_stays(10.0*pi/180.0, mu) for mu in (0.17, 0.2)]
    [False, True]
    """
    return tan(half_angle) <= mu


def dragged_tractions(pressure: ArrayLike, speed: float, *, mu: float, m: float,
                      yield_stress: float, mises: ArrayLike, alpha: float, q: float
                      ) -> dict[str, ArrayLike]:
    """Traction of a pressed block that is dragged, by the deck's word of each law.

    Without the rise of bounds that are stresses, where the pressure is small.

    >>> dragged_tractions(100.0, 2.0, mu=0.3, m=0.2, yield_stress=200.0, mises=150.0, alpha=5.0,
    ...                   q=0.2)["NORTON-HOFF"].__round__(6)
    5.743492
    """
    shear = m*yield_stress/sqrt(3.0)
    return {"COULOMB": mu*pressure, "TRESCA": shear,
            "COULOMB-OROWAN": np.minimum(mu*pressure, shear),
            "CRISTESCU": m*np.minimum(mises, yield_stress)/sqrt(3.0),
            "NORTON-HOFF": alpha*speed**q}


def arctan_creep(load: float, limit: float, scale: float) -> float:
    """Slip under a held load with the arctangent: u0 tan(pi T/(2 mu N)); with V0 a speed.

    >>> [round(arctan_creep(r, 1.0, 1.0), 4) for r in (0.5, 0.9, 0.99)]
    [1.0, 6.3138, 63.6567]
    """
    return scale*tan(0.5*pi*load/limit)


def shrink_fit_torque(pressure: float, radius: float, mu: float, length: float = 1.0) -> float:
    """That turns a ring in its seat: 2 pi mu p R^2 length [force*length].

    >>> round(shrink_fit_torque(20.740741, 30.0, 0.1), 2)
    11728.61
    """
    return 2.0*pi*mu*pressure*radius**2*length
