"""Rigid profiles as strips of elements, for programs that have none."""
from __future__ import annotations

import math

from .deck import Block

#: Facets of an arc, by their angle: no longer than the smallest edge of the mesh, and no smaller
#: than the second.
STEP, LEAST_STEP = math.radians(1.0), math.radians(0.01)


def number_of(value) -> float:
    return 0.0 if value is None else float(value)


def profile_points(block: Block, most: float) -> list[tuple[float, float]]:
    """The corners of a profile, arcs as chords no longer than `most` [length]."""
    points: list[tuple[float, float]] = []
    for row in block.data:
        word = str(row[0]).upper()
        x, y = number_of(row[1]), number_of(row[2])
        if word == "CIRCL":
            cx, cy = number_of(row[3]), number_of(row[4])
            x0, y0 = points[-1]
            first = math.atan2(y0 - cy, x0 - cx)
            turn = math.remainder(math.atan2(y - cy, x - cx) - first, 2.0*math.pi)
            radius = math.hypot(x0 - cx, y0 - cy)
            step = max(min(STEP, most/radius), LEAST_STEP)
            count = max(2, math.ceil(abs(turn)/step))
            points += [(cx + radius*math.cos(first + turn*k/count),
                        cy + radius*math.sin(first + turn*k/count)) for k in range(1, count)]
        points.append((x, y))
    return points


def beside_axis(points: list) -> list[tuple[float, float]]:
    """What of a profile is not beyond the axis of revolution, where no element may be."""
    found: list[tuple[float, float]] = []
    for a, b in zip(points, points[1:]):
        if a[0] >= 0.0:
            found.append(a)
        if a[0]*b[0] < 0.0:
            found.append((0.0, a[1] + (b[1] - a[1])*a[0]/(a[0] - b[0])))
    return found + [p for p in points[-1:] if p[0] >= 0.0]


def smallest_radius(block: Block) -> float:
    """Of the arcs of a profile: a strip thicker than that folds behind them [length]."""
    return min((math.dist([number_of(v) for v in row[1:3]], [number_of(v) for v in row[3:5]])
                for row in block.data if str(row[0]).upper() == "CIRCL"), default=math.inf)


def strip_behind(points: list, depth: float) -> tuple[list, list]:
    """Nodes and quads behind a profile, whose outward side is on the left of the way.

    Face S1 of every quad is on the profile.
    """
    behind = []
    for k, (x, y) in enumerate(points):
        near = [points[j] for j in (k - 1, k + 1) if 0 <= j < len(points)]
        a, b = (near[0], near[-1]) if len(near) == 2 else \
            ((near[0], (x, y)) if k else ((x, y), near[0]))
        length = math.dist(a, b) or 1.0
        behind.append((x + depth*(b[1] - a[1])/length, y - depth*(b[0] - a[0])/length))
    n = len(points)
    cells = [(k + 1, k, n + k, n + k + 1) for k in range(n - 1)]
    return [*points, *behind], cells
