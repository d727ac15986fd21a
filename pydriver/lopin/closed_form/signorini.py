"""Exact plane-strain fields of Signorini's problem: a body y > 0 on a frictionless floor y = 0.

Impose their displacements on the other sides; compare pressure, gap and energy. Both are
Westergaard's form of Muskhelishvili's solution, without shear on y = 0; signs: tension positive.
"""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True)
class PlaneField:
    """Displacement and stress at points of a plane-strain field."""

    u: NDArray        #: (n, 2) [length]
    stress: NDArray   #: (n, 3) xx, yy, xy [stress]


def signorini_singular(points: ArrayLike, young: float = 1000.0, poisson: float = 0.3,
                       amplitude: float = 10.0, end: float = 0.5) -> PlaneField:
    """A body y > 0 on a frictionless floor y = 0, in contact for x < `end` only.

    Pressure A sqrt(end - x), gap ~ (x - end)^(3/2): the natural singularity of a contact end.
    Westergaard's function Z = -A sqrt(end - z), with the branch arg = -pi behind the end.

    >>> f = signorini_singular([[0.75, 0.0], [0.5, 0.5]])
    >>> f"{f.u[0, 1]:.7e} {f.u[1, 0]:.7e}", f.stress[1].round(9).tolist()
    ('1.5166667e-03 -4.1166667e-03', [-7.5, -2.5, -2.5])
    """
    x, y = np.atleast_2d(np.asarray(points, float)).T
    w = np.empty(x.shape, complex)
    w.real = end - x
    w.imag = -np.abs(y)   # -0.0 on the floor chooses the branch
    root = np.sqrt(w)
    safe = np.where(root == 0.0, 1.0, root)
    slope = np.where(root == 0.0, 0.0, 0.5*amplitude/safe)
    return _westergaard(y, -amplitude*root, slope, 2.0/3.0*amplitude*w*root, young, poisson)


def signorini_smooth(points: ArrayLike, young: float = 1000.0, poisson: float = 0.3,
                     pressure: tuple[float, ...] = (10.0, 5.0, -8.0)) -> PlaneField:
    """A body y > 0 on a frictionless floor under the pressure c0 + c1 x + c2 x^2 + ... > 0.

    >>> f = signorini_smooth([[1.0, 1.0]])
    >>> f"{f.u[0, 0]:.7e} {f.u[0, 1]:.7e}", f.stress[0].round(9).tolist()
    ('-2.2273333e-02 1.9066667e-03', [-31.0, 1.0, -11.0])
    """
    x, y = np.atleast_2d(np.asarray(points, float)).T
    function = -np.polynomial.Polynomial(pressure)
    z = x + 1j*y
    return _westergaard(y, function(z), function.deriv()(z), function.integ()(z), young, poisson)


def _westergaard(y, function, derivative, integral, young, poisson) -> PlaneField:
    """Field without shear on y = 0: Muskhelishvili's solution in Westergaard's form."""
    kolosov = 3.0 - 4.0*poisson
    shear = young/(2.0*(1.0 + poisson))
    ux = 0.5*(kolosov - 1.0)*integral.real - y*function.imag
    uy = 0.5*(kolosov + 1.0)*integral.imag - y*function.real
    stress = [function.real - y*derivative.imag, function.real + y*derivative.imag,
              -y*derivative.real]
    return PlaneField(np.stack([ux, uy], axis=1)/(2.0*shear), np.stack(stress, axis=1))
