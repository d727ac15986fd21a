"""A rigid flat punch with friction on a half-plane: how much of it sticks while the load grows.

Solved by boundary elements, with the full coupling: pressure moves the surface inwards, and the
shear that resists tilts it. Spence (1975) dropped the second for his closed form, here too.
"""
from __future__ import annotations

from collections.abc import Callable
from math import sqrt

import numpy as np
from numpy.typing import NDArray


def dundurs_rigid(poisson: float) -> float:
    """Dundurs' beta of a half-space under a rigid body: (1 - 2 nu)/(2 (1 - nu))."""
    return (1.0 - 2.0*poisson)/(2.0*(1.0 - poisson))


def punch_stick_uncoupled(mu: float, poisson: float) -> float:
    """c/a of Spence's closed form K'(c/a)/K(c/a) = beta/mu, where shear does not tilt the surface.

    >>> [round(punch_stick_uncoupled(mu, 0.3), 5) for mu in (0.2, 0.3, 0.5)]
    [0.40579, 0.74379, 0.96776]
    """
    ratio = dundurs_rigid(poisson)/mu
    # K(c) = pi/2 over the arithmetic-geometric mean of 1 and sqrt(1 - c^2).
    return _root(lambda c: _mean(sqrt(1.0 - c*c))/_mean(c) - ratio, 1e-9, 1.0 - 1e-12)


def punch_stick(mu: float, poisson: float, panels: int = 160, coupled: bool = True) -> float:
    """c/a of a flat punch pressed by a growing force: the same at every load.

    The mesh ends at the edge of stick, which is moved until the shear there is mu p: elsewhere the
    shear would have a jump.

    >>> round(punch_stick(0.3, 0.3, panels=120), 2)
    0.69
    """
    def jump(c: float) -> float:
        x, pressure, shear = punch_tractions(c, mu, poisson, panels, coupled)
        last = int(np.searchsorted(x, c)) - 1
        return float(shear[last]/(mu*pressure[last]) - 1.0)

    return _root(jump, 0.02, 1.0 - 1e-4)


def punch_tractions(c: float, mu: float, poisson: float, panels: int = 160, coupled: bool = True
                    ) -> tuple[NDArray, NDArray, NDArray]:
    """Places x/a > 0, pressure and shear on the half-plane, both times a/P, if |x| < c a sticks.

    Panels of constant traction, mirrored at the middle: pressure is even, shear odd.
    """
    half = panels//2
    fine = 0.5*(1.0 - np.cos(np.pi*np.linspace(0.0, 1.0, half + 1)))
    edges = np.concatenate([c*np.sin(0.5*np.pi*np.linspace(0.0, 1.0, half + 1)),
                            c + (1.0 - c)*fine[1:]])
    x = 0.5*(edges[1:] + edges[:-1])
    n, width = len(x), np.diff(edges)
    even, odd = _logarithm(x, edges, 1.0), _logarithm(x, edges, -1.0)
    beta = np.pi*dundurs_rigid(poisson)
    # Half the integral of sgn(x - s): of an odd density minus what lies beyond x, of an even one
    # what lies between 0 and x.
    below = np.tril(np.ones((n, n)), -1)*width + 0.5*np.diag(width)
    beyond = width - below
    matrix, right = np.zeros((2*n + 1, 2*n + 1)), np.zeros(2*n + 1)
    matrix[:n, :n] = -even
    if coupled:
        matrix[:n, n:-1] = -beta*beyond
    matrix[:n, -1] = -1.0                       # the punch stays level
    matrix[-1, :n] = 2.0*width
    right[-1] = 1.0
    stick = x < c
    matrix[n:-1, :n][stick] = -beta*below[stick]
    matrix[n:-1, n:-1][stick] = -odd[stick]
    slip = np.flatnonzero(~stick)
    matrix[n + slip, n + slip] = 1.0
    matrix[n + slip, slip] = -mu
    found = np.linalg.solve(matrix, right)
    return x, found[:n], found[n:-1]


def _logarithm(x: NDArray, edges: NDArray, parity: float) -> NDArray:
    """Integrals of ln|x - s| over panels and their images at -s, of this parity."""
    def primitive(y: NDArray) -> NDArray:
        return y*np.log(np.abs(y)) - y

    direct = primitive(x[:, None] - edges[None, :-1]) - primitive(x[:, None] - edges[None, 1:])
    image = primitive(x[:, None] + edges[None, 1:]) - primitive(
        np.maximum(x[:, None] + edges[None, :-1], 1e-300))
    return direct + parity*image


def _mean(b: float) -> float:
    """Arithmetic-geometric mean of 1 and b."""
    a = 1.0
    for _ in range(60):
        a, b = 0.5*(a + b), sqrt(a*b)
    return a


def _root(function: Callable[[float], float], low: float, high: float) -> float:
    """A root between two signs, by the Illinois form of the false position."""
    at_low, at_high = function(low), function(high)
    for _ in range(200):
        middle = (low*at_high - high*at_low)/(at_high - at_low)
        value = function(middle)
        if value*at_high < 0.0:
            low, at_low = high, at_high
        else:
            at_low *= 0.5
        step, high, at_high = abs(middle - high), middle, value
        if step < 1e-9 or value == 0.0:
            break
    return high
