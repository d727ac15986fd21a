"""Profiles of rigid tools: lines and arcs with the outward side on the LEFT of the way.

A plane or axisymmetric scene uses a profile as it is (x, y) or (r, z); a solid scene revolves or
extrudes it.
"""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, radians, sin
from pathlib import Path

from .errors import ResourceError, UsageError

Point = Sequence[float]


@dataclass(frozen=True)
class Profile:
    """Data lines START, LINE, CIRCL of a *SURFACE, and how they become a surface."""

    rows: tuple[tuple[str | float, ...], ...]
    kind: str = "SEGMENTS"                           #: or REVOLUTION, CYLINDER, STL
    frame: tuple[tuple[float, ...], ...] = ()        #: data lines before START
    fillet: float = 0.0                              #: radius at the corners [length]

    def options(self) -> dict[str, str | float | bool | None]:
        """Parameters of the *SURFACE besides name and type."""
        return {"fillet_radius": self.fillet or None}

    def line_to(self, x: float, y: float) -> Profile:
        """Continue straight to a point."""
        return self._with(("LINE", float(x), float(y)))

    def arc_to(self, x: float, y: float, center: Point) -> Profile:
        """Continue along an arc (less than half a turn) about a centre."""
        return self._with(("CIRCL", float(x), float(y), float(center[0]), float(center[1])))

    def revolved(self, start: Point = (0.0, 0.0, 0.0), end: Point = (0.0, 0.0, 1.0),
                 sides: tuple[Point, Point] | None = None) -> Profile:
        """Turned about the axis from `start` to `end`; the profile is then (r, along the axis).

        `sides`: the middles of two sides of a rectangle about `start` [length]: the profile runs
        around the rectangle, and r is the distance from it.
        """
        frame = ((*map(float, start), *map(float, end)),)
        if sides:
            frame += ((*map(float, sides[0]), *map(float, sides[1])),)
        return Profile(self.rows, "REVOLUTION", frame, self.fillet)

    def extruded(self, origin: Point = (0.0, 0.0, 0.0), x: Point = (1.0, 0.0, 0.0),
                 generator: Point = (0.0, -1.0, 0.0)) -> Profile:
        """Swept along local z; unless told, the profile is (x, z) of the scene.

        `x`: a point on the local x axis, `generator`: one on local z; local y is z cross x.
        """
        frame = ((*map(float, origin), *map(float, x)), tuple(map(float, generator)))
        return Profile(self.rows, "CYLINDER", frame, self.fillet)

    def rounded(self, radius: float) -> Profile:
        """With corners rounded by a radius."""
        return Profile(self.rows, self.kind, self.frame, float(radius))

    def _with(self, row: tuple) -> Profile:
        return Profile((*self.rows, row), self.kind, self.frame, self.fillet)


@dataclass(frozen=True)
class Stl:
    """Triangles of an STL file, binary or in words, outward by the right-hand rule."""

    path: str                  #: of the file
    scale: float = 1.0         #: factor on its lengths, > 0 [-]
    is_open: bool = False      #: a sheet, such as the face of a die
    repair: bool = False       #: turn facets that look against the greater area

    kind = "STL"
    frame = rows = ()

    def options(self) -> dict[str, str | float | bool | None]:
        """Parameters of the *SURFACE besides name and type."""
        return {"input": self.path, "scale": None if self.scale == 1.0 else self.scale,
                "open": self.is_open, "repair": self.repair}


def stl(path: str | Path, scale: float = 1.0, *, is_open: bool = False,
        repair: bool = False) -> Stl:
    """A tool from an STL file.

    Parameters
    ----------
    scale : factor on the lengths of the file, > 0
    is_open : a sheet, such as the face of a die; without it a surface with a hole is refused
    repair : turn facets that look against the greater area; without it they are refused

    Raises
    ------
    ResourceError : there is no such file.
    UsageError : the scale is not positive.
    """
    if not Path(path).is_file():
        raise ResourceError(f"no file {path}")
    if not scale > 0.0:
        raise UsageError(f"the scale of an STL file must be positive, not {scale:g}")
    return Stl(str(Path(path).absolute()), float(scale), is_open, repair)


def start(x: float, y: float) -> Profile:
    """The first point; continue with `line_to` and `arc_to`.

    >>> start(6.0, 0.0).line_to(-6.0, 0.0).rows
    (('START', 6.0, 0.0), ('LINE', -6.0, 0.0))
    """
    return Profile((("START", float(x), float(y)),))


def line(first: Point, last: Point) -> Profile:
    """A straight segment; its outward side is on the left of the way."""
    return start(*first).line_to(*last)


def arc(center: Point, radius: float, first: float = 270.0, last: float = 360.0, *,
        solid: bool = True) -> Profile:
    """An arc between two angles in degrees, counted from the x axis.

    A `solid` tool has its outward side away from the centre, a cavity towards it, whichever angle
    comes first. Long arcs are cut in pieces below a quarter turn.

    >>> arc((0.0, 50.0), 50.0).rows[0][1:], arc((0.0, 50.0), 50.0).rows[-1][1:3]
    ((50.0, 50.0), (0.0, 0.0))
    """
    if radius <= 0.0 or first == last:
        raise UsageError("an arc needs a positive radius and two angles")
    low, high = sorted((first, last))
    way = (high, low) if solid else (low, high)   # the left of a clockwise way points outward
    pieces = max(1, int(-(-(high - low)//90.0)))

    def point(k: int) -> tuple[float, float]:
        angle = radians(way[0] + (way[1] - way[0])*k/pieces)
        return (center[0] + radius*_clean(cos(angle)),
                center[1] + radius*_clean(sin(angle)))

    profile = start(*point(0))
    for k in range(1, pieces + 1):
        profile = profile.arc_to(*point(k), center)
    return profile


def plane(height: float, width: float, *, side: str = "below") -> Profile:
    """A horizontal line of half width `width`; outward "below" (a punch) or "above" (a floor)."""
    if side not in ("below", "above"):
        raise UsageError(f"side is 'below' or 'above', not '{side}'")
    w = width if side == "below" else -width
    return line((w, height), (-w, height))


def _clean(value: float) -> float:
    """Round-off of right angles, taken out: 0 where 6e-17 would stand."""
    return 0.0 if abs(value) < 1e-15 else value
