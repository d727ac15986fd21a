"""Scenes of the work-precision chart: Hertz contacts on meshes of any fineness, as decks.

Contact half width (radius) is 1 and the relative radius 5000 or 1000, so flat that the slope of the
curved surface, which Hertz neglects, changes the pressure by less than the meshes do.
"""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import log, pi

import numpy as np
from numpy.typing import NDArray

from .. import profile
from ..closed_form import contact_modulus, hertz_line, hertz_point_approach
from ..deck import Deck, Row
from ..laws import Elastic
from ..mesh import make as mesh_make
from ..mesh.mesh import Mesh, together
from ..model import Model

SOLID = Elastic(20e3, 0.3)


@dataclass(frozen=True)
class Scene:
    """A deck and what the chart needs to know of it.

    `exact` gives the pressure at the slave points of a result's contact, from a closed form.
    """

    name: str
    deck: Deck
    h: float = np.nan       #: size of a facet in the contact [length]
    element: str = ""
    exact: Callable[[object], NDArray] | None = None


def sphere(cells: float) -> Scene:
    """A rigid sphere on a half-space, axisymmetric, with `cells` facets on the contact radius."""
    h, radius, depth, reach = 1.0/cells, 5000.0, 2e-4, 12.0
    ball = hertz_point_approach(depth, radius, contact_modulus(SOLID.young, SOLID.poisson))
    mesh = _half_space(h, reach, 1.15)
    model = Model("sphere", _lean(mesh, "NEAR", "NEAR LEFT"), kind="axisymmetric", units="N mm")
    model.section("ALL", SOLID)
    tool = model.rigid_tool("BALL", profile.start(radius, radius).arc_to(0.0, 0.0, (0.0, radius)),
                            ref=(0.0, radius))
    model.contact("NEAR", tool)
    model.fix("LEFT", "r")
    model.step().move(tool, z=-depth)
    deck = model.to_deck()
    far = deck.all("BOUNDARY")[-1]
    for point in np.flatnonzero((mesh.points[:, 0] > reach - 1e-9)
                                | (mesh.points[:, 1] < -reach + 1e-9)):
        r, z = mesh.points[point]
        radial, axial = _boussinesq(ball.force, r, -z)
        values = [(2, axial)] if r == 0.0 else [(1, radial), (2, axial)]
        far.lines += [Row([int(point) + 1, d, d, float(v)]) for d, v in values]
    return Scene("sphere", deck, h, "CAX4", lambda contact: ball.pressure(contact.r))


def cylinder(cells: float) -> Scene:
    """An elastic cylinder on an elastic block of the same material, plane strain, half of both."""
    h, radius, size = 1.0/cells, 1000.0, 40.0
    modulus = contact_modulus(SOLID.young, SOLID.poisson, SOLID.young, SOLID.poisson)
    upper, lower = _crowned(h, radius, size), _half_space(h, size, 1.2)
    mesh = together(UP=_lean(upper, "NEAR", "NEAR LEFT TOP"),
                    LOW=_lean(lower, "NEAR", "LEFT BOTTOM"))
    model = Model("cylinder", mesh, kind="plane strain", units="N mm")
    model.section("UP", SOLID)
    model.section("LOW", SOLID)
    model.contact("UP.NEAR", "LOW.NEAR")
    model.fix("UP.LEFT", "x")
    model.fix("LOW.LEFT", "x")
    model.fix("LOW.BOTTOM", "x", "y")
    model.fix("UP.TOP", "x")
    model.step().move("UP.TOP", y=-_approach(modulus, radius, size))

    def exact(contact) -> NDArray:
        force = 2.0*float((contact["weight"]*contact.pressure).sum())
        return hertz_line(force, radius, modulus).pressure(contact.x[:, 0])

    return Scene("cylinder", model.to_deck(), h, "CPE4", exact)


#: Scenes by name, as functions of the number of facets on the half width of the contact.
SCENES = {"sphere": sphere, "cylinder": cylinder}


def _approach(modulus: float, radius: float, size: float) -> float:
    """Approach of two blocks of this height that makes the half width about 1 (Johnson 5.56)."""
    force = pi*modulus/(4.0*radius)
    factor = force*(1.0 - SOLID.poisson**2)/(pi*SOLID.young)
    return 2.0*factor*(2.0*log(2.0*size) - SOLID.poisson/(1.0 - SOLID.poisson))


def _ticks(h: float, even: float, end: float, growth: float) -> NDArray:
    """Ticks from 0 to `end`: steps h up to `even`, growing beyond."""
    n = int(np.ceil(even/h))
    start = h*n
    m = max(1, round(log(1.0 + (end - start)*(growth - 1.0)/h)/log(growth)))
    x = np.cumsum(growth**np.arange(1, m + 1))
    return np.concatenate([h*np.arange(n + 1), start + (end - start)*x/x[-1]])


def _half_space(h: float, size: float, growth: float) -> Mesh:
    """A square block below y = 0, fine at the origin; surface NEAR is where contact may be."""
    across, down = _ticks(h, 1.25, size, growth), _ticks(h, 0.25, size, growth)
    mesh = mesh_make.block((size, size), (len(across) - 1, len(down) - 1), origin=(0.0, -size),
                           grading=(across/size, 1.0 - down[::-1]/size))
    return mesh.with_surface("NEAR", lambda x: (x[:, 1] > -1e-3*h) & (x[:, 0] < 1.6))


def _crowned(h: float, radius: float, size: float) -> Mesh:
    """The lower part of a cylinder, touching y = 0 at the origin."""
    across, up = _ticks(h, 1.25, size, 1.2), _ticks(h, 0.25, size, 1.2)
    mesh = mesh_make.crowned_block((size, size), (len(across) - 1, len(up) - 1), radius,
                                   grading=(across/size, up/size))
    return mesh.with_surface("NEAR", lambda x: (x[:, 0] > 1e-3*h) & (x[:, 0] < 1.5)
                             & (x[:, 1] < 1.5**2/radius))


def _lean(mesh: Mesh, surfaces: str, points: str) -> Mesh:
    """The mesh with these surfaces and point sets only."""
    return mesh.replaced(surfaces={k: mesh.surfaces[k] for k in surfaces.split()},
                         point_sets={k: mesh.point_sets[k] for k in points.split()})


def _boussinesq(force: float, r: float, depth: float) -> tuple[float, float]:
    """Radial and upward displacement of a half-space under a downward point force (Johnson 3.4)."""
    far, poisson = np.hypot(r, depth), SOLID.poisson
    factor = force*(1.0 + poisson)/(2.0*pi*SOLID.young)
    radial = r*depth/far**3 - (1.0 - 2.0*poisson)*r/(far*(far + depth))
    return factor*radial, -factor*(depth**2/far**3 + 2.0*(1.0 - poisson)/far)
