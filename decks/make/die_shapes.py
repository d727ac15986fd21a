"""Shapes of forging dies and their triangles: a cardan cross and a connecting rod, mm.

The metal of a closed die is a field f(x, y, z) < 0 whose zero is the wall of the cavity, the land
of the flash and the gutter beyond; z = 0 is the parting plane. Walls lean by a draft, so that above
each place of that plane the upper die has one height. Radii between faces are those of the usual
blends of distances: exact where the faces are square to each other.
"""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np

Height = Callable[[np.ndarray, np.ndarray], np.ndarray]


def both(a, b, radius: float):
    """What lies in two bodies; their edge has a radius."""
    inside = np.minimum(np.maximum(a, b), -radius)
    return inside + np.hypot(np.maximum(a + radius, 0.0), np.maximum(b + radius, 0.0))


def either(a, b, radius: float):
    """What lies in one of two bodies; their crease is filled with a radius."""
    return -both(-a, -b, radius)


@dataclass(frozen=True)
class Die:
    """The upper half of a closed die; lengths in mm, angles in degrees."""

    corner: float        #: radius within the cavity
    edge: float          #: radius from the cavity to the land
    land: float          #: width of the land
    gap: float           #: half the thickness of the flash
    gutter: float        #: half the depth that the gutter adds
    draft: float = 7.0

    @property
    def cosine(self) -> float:
        """Of the draft."""
        return float(np.cos(np.radians(self.draft)))

    @property
    def tangent(self) -> float:
        """Of the draft."""
        return float(np.tan(np.radians(self.draft)))

    def cavity(self, x, y, z):
        """The field of the metal without flash."""
        raise NotImplementedError

    def outline(self, x, y):
        """Distance from the cavity in the parting plane, < 0 inside."""
        return self.cavity(x, y, 0.0*x)/self.cosine

    def flash(self, x, y):
        """Half the thickness of flash and gutter at a place."""
        beyond = np.clip((self.outline(x, y) - self.land)/(3.0*self.gutter), 0.0, 1.0)
        return self.gap + self.gutter*beyond*beyond*(3.0 - 2.0*beyond)

    def height(self, x, y) -> np.ndarray:
        """Of the wall above the parting plane, by bisection."""
        x, y = np.broadcast_arrays(np.asarray(x, float), np.asarray(y, float))
        flash, low, high = self.flash(x, y), np.zeros(x.shape), np.full(x.shape, 32.0)
        for _ in range(36):
            z = 0.5*(low + high)
            metal = either(self.cavity(x, y, z), z - flash, self.edge) < 0.0
            low, high = np.where(metal, z, low), np.where(metal, high, z)
        return 0.5*(low + high)

    def cone(self, distance, top: float, z):
        """A flat-topped body whose wall leans; its distance in plan is meant at the top."""
        wall = (distance - (top - z)*self.tangent)*self.cosine
        return both(wall, z - top, self.corner)


@dataclass(frozen=True)
class Cross(Die):
    """A cardan cross: four trunnions on a hub; the octant x, y, z >= 0."""

    corner: float = 3.0
    edge: float = 2.5
    land: float = 6.0
    gap: float = 1.0
    gutter: float = 2.5
    reach: float = 32.0      #: of a trunnion from the axis
    radius: float = 8.0      #: of a trunnion
    hub: float = 14.0        #: radius of its top
    top: float = 12.0        #: of the hub

    @property
    def box(self) -> tuple[float, float, float, float]:
        """Where the die is made: x and y, from and to."""
        far = self.reach + self.land + 12.0
        return -2.0, far, -2.0, far

    def trunnion(self, along, across, z):
        """Round, leaning by the draft where the circle would be steeper, with a leaning end."""
        sine = self.tangent*self.cosine
        aside = np.abs(across)
        round_ = np.hypot(aside, z)
        section = np.where(z < aside*self.tangent, aside*self.cosine + z*sine, round_) - self.radius
        return both(section, (np.abs(along) - self.reach)*self.cosine + z*sine, self.corner)

    def cavity(self, x, y, z):
        """Two trunnions and a hub."""
        arms = either(self.trunnion(x, y, z), self.trunnion(y, x, z), self.corner)
        return either(arms, self.cone(np.hypot(x, y) - self.hub, self.top, z), self.corner)


@dataclass(frozen=True)
class Rod(Die):
    """A connecting rod without its eyes; the quarter y, z >= 0, the axis along x."""

    corner: float = 2.5
    edge: float = 2.0
    land: float = 6.0
    gap: float = 0.75
    gutter: float = 2.0
    big: tuple[float, float] = (24.0, 10.0)      #: radius at the top, height of a half
    small: tuple[float, float] = (13.0, 8.0)
    shank: tuple[float, float] = (6.5, 6.0)      #: half width at the top, height of a half
    centres: float = 90.0

    @property
    def box(self) -> tuple[float, float, float, float]:
        """Where the die is made: x and y, from and to."""
        out = self.land + 12.0
        return -self.big[0] - out, self.centres + self.small[0] + out, -2.0, self.big[0] + out

    def cavity(self, x, y, z):
        """Two ends and a shank between their centres."""
        ends = either(self.cone(np.hypot(x, y) - self.big[0], self.big[1], z),
                      self.cone(np.hypot(x - self.centres, y) - self.small[0], self.small[1], z),
                      self.corner)
        shank = self.cone(np.abs(y) - self.shank[0], self.shank[1], z)
        return either(ends, np.maximum(shank, np.maximum(-x, x - self.centres)), self.corner)


@cache
def volume(die: Die, cells: int = 600) -> float:
    """Of the cavity over the quarter or octant, flash left out [mm3]."""
    low, right, _, back = die.box
    low = 0.0 if isinstance(die, Cross) else low
    x = low + (np.arange(cells) + 0.5)*(right - low)/cells
    y = (np.arange(cells) + 0.5)*back/cells
    x, y = np.meshgrid(x, y)
    inside = die.outline(x, y) < 0.0
    return float(die.height(x[inside], y[inside]).sum()*(right - low)*back/cells**2)


def on_grid(die: Die, size: float) -> np.ndarray:
    """Triangles (n, corner, coordinate) of a grid whose squares are halved; they look down."""
    left, right, front, back = die.box
    x = np.linspace(left, right, round((right - left)/size) + 1)
    y = np.linspace(front, back, round((back - front)/size) + 1)
    plan = np.stack(np.meshgrid(x, y, indexing="ij"), axis=2)
    points = np.dstack([plan, die.height(plan[..., 0], plan[..., 1])])
    a, b, c, d = points[:-1, :-1], points[1:, :-1], points[1:, 1:], points[:-1, 1:]
    return np.concatenate([np.stack(t, axis=2).reshape(-1, 3, 3) for t in ((a, c, b), (a, d, c))])


def irregular(die: Die, deviation: float, largest: float = 4.0, smallest: float = 0.2,
              seed: int | None = None) -> np.ndarray:
    """Delaunay triangles whose edges are off the wall by no more than `deviation`, as exported.

    A coarse grid, halved edge by edge where the wall is further away; slivers and all. A `seed`
    shakes the grid, so that other triangles come out.
    """
    from scipy.spatial import Delaunay

    left, right, front, back = die.box
    x = np.linspace(left, right, round((right - left)/largest) + 1)
    y = np.linspace(front, back, round((back - front)/largest) + 1)
    plan = np.stack(np.meshgrid(x, y, indexing="ij"), axis=2)
    if seed is not None:
        shake = np.random.default_rng(seed).uniform(-0.3*largest, 0.3*largest, plan.shape)
        plan[1:-1, :, 0] += shake[1:-1, :, 0]
        plan[:, 1:-1, 1] += shake[:, 1:-1, 1]
    plan, near = plan.reshape(-1, 2), np.empty(0, int)
    for _ in range(40):
        cells = Delaunay(plan).simplices
        edges = np.unique(np.sort(cells[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)), axis=0)
        keys = edges[:, 0]*1_000_000 + edges[:, 1]
        new = ~np.isin(keys, near)
        ends, keys = plan[edges[new]], keys[new]
        middle = ends.mean(axis=1)
        cut = off_wall(die, ends, middle) > deviation
        cut &= np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) > smallest
        near = np.concatenate([near, keys[~cut]])
        if not cut.any():
            break
        plan = np.concatenate([plan, middle[cut]])
    points = np.column_stack([plan, die.height(plan[:, 0], plan[:, 1])])[cells]
    up = np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])[:, 2]
    points[up > 0.0] = points[up > 0.0][:, ::-1]
    return points[np.abs(up) > 1e-9]


def off_wall(die: Die, ends: np.ndarray, middle: np.ndarray) -> np.ndarray:
    """How far the middles of edges are from the wall, along its normal."""
    step = 1e-4
    x, y = middle.T
    at = die.height(x, y)
    slope = np.hypot(die.height(x + step, y) - at, die.height(x, y + step) - at)/step
    chord = die.height(ends[..., 0], ends[..., 1]).mean(axis=1)
    return np.abs(at - chord)/np.hypot(1.0, slope)


def moved(facets: np.ndarray, up: float) -> np.ndarray:
    """The triangles, raised."""
    return facets + np.array([0.0, 0.0, up])


def mirrored(facets: np.ndarray) -> np.ndarray:
    """The lower die: the triangles below the parting plane, looking up."""
    return (facets*np.array([1.0, 1.0, -1.0]))[:, ::-1]
