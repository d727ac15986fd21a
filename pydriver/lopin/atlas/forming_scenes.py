"""The scenes of the forming maps: billets, blocks under round tools, strips that are bent.

Each returns the deck as it is written, the number of nodes of the body, and the number of steps.
Bodies are a few units wide; flow stresses are those of steel in N and mm.
"""
from __future__ import annotations

import tempfile
from collections.abc import Sequence
from math import cos, radians, sin
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..mesh import make as mesh_make
from ..mesh.mesh import Mesh
from .metal import Metal
from .scenes import PLAIN, Frame

Built = tuple[Metal, int, int]
_folders: list[tempfile.TemporaryDirectory] = []


def scratch() -> Path:
    """A folder for the STL files of decks that only run."""
    if not _folders:
        _folders.append(tempfile.TemporaryDirectory(prefix="lopin-atlas-"))
    return Path(_folders[0].name)


def coulomb(mu: float) -> list[str]:
    """Lines of *FRICTION; none without friction."""
    return ["*FRICTION", f"{mu!r},"] if mu else []


def billet(word: str, friction: Sequence[str], increments: Sequence[float] = (),
           method: str = "lagrange", yielding: float = 300.0, share: float = 0.4,
           frame: Frame = PLAIN, hollow: bool = False) -> Built:
    """A billet (or a ring) of height 2 and radius 1, its upper half pressed by a flat plate."""
    first = 0.5 if hollow else 0.0
    scene = Metal("billet", word, frame)
    if scene.ndim == 3:
        mesh = mesh_make.block((1.0, 1.0, 1.0), (3, 3, 3))
        sides, supports = ("TOP", "RIGHT", "BACK"), {"LEFT": [1], "FRONT": [2], "BOTTOM": [3]}
    else:
        mesh = mesh_make.block((1.0 - first, 1.0), (5, 5), origin=(first, 0.0),
                               quadratic=word[3] in "68")
        sides = ("TOP", "RIGHT", "LEFT") if hollow else ("TOP", "RIGHT")
        supports = {"BOTTOM": [2]} if hollow else {"LEFT": [1], "BOTTOM": [2]}
    if word in ("C3D4", "CAX3", "CPE3", "CAX6", "CPE6"):
        mesh = mesh_make.simplices(mesh)
    _body(scene, mesh, sides, supports, scene.linear(yielding, yielding), method, friction)
    scene.tool("DIE", "SKIN", [(4.0, 1.0), (0.0 if word.startswith("CAX") else -3.0, 1.0)],
               (0.0, 1.5))
    scene.held.append("DIEP, 1, 2" if scene.ndim == 3 else "DIEP, 1")
    scene.ready()
    down = (0.0, 0.0, -share) if scene.ndim == 3 else (0.0, -share)
    scene.step({"DIE": down}, increments)
    return scene, mesh.n_point, 1


def cavity(friction: Sequence[str], increments: Sequence[float] = (), method: str = "lagrange",
           frame: Frame = PLAIN) -> Built:
    """A disc of radius and half height 1 pressed by a die with a rounded, sloping wall."""
    scene = Metal("cavity", "CAX4", frame)
    mesh = mesh_make.block((1.0, 1.0), (6, 6))
    _body(scene, mesh, ("TOP", "RIGHT"), {"LEFT": [1], "BOTTOM": [2]},
          scene.linear(300.0, 300.0), method, friction)
    a, r = radians(20.0), 0.3
    # The wall leans outwards by 20 degrees and meets the top in a fillet.
    middle = np.array([1.0, 1.0 - r])
    end = middle + r*np.array([cos(a), sin(a)])
    low = end + 0.8*np.array([sin(a), -cos(a)])
    scene.tool("DIE", "SKIN", [low, (*end,), (1.0, 1.0, *middle), (0.0, 1.0)], (0.0, 1.5))
    scene.held.append("DIEP, 1")
    scene.ready()
    scene.step({"DIE": (0.0, -0.3)}, increments)
    return scene, mesh.n_point, 1


def _body(scene: Metal, mesh: Mesh, sides: Sequence[str], supports: dict, flow: list[str],
          method: str, friction: Sequence[str]) -> None:
    """The body with one skin, its supports, its metal and the interaction."""
    skin = np.concatenate([mesh.surfaces[side] for side in sides])
    mesh = mesh.replaced(surfaces={"SKIN": skin},
                         point_sets={k: mesh.point_sets[k] for k in supports})
    scene.body(mesh, supports)
    scene.metal(*flow)
    scene.interaction(method, friction)


def arc(radius: float, centre: Sequence[float], angles: Sequence[float], facet: float) -> list:
    """Corners of a polygon on an arc, from the first angle to the last [degrees]."""
    span = abs(radians(angles[1] - angles[0]))
    count = max(1, round(span*radius/facet))
    return [(centre[0] + radius*cos(t), centre[1] + radius*sin(t))
            for t in np.radians(np.linspace(*angles, count + 1))]


def indented(facets: float, mu: float, method: str, increments: Sequence[float] = (),
             frame: Frame = PLAIN) -> Built:
    """A block 2 wide and 1 high under a polygon on a circle of radius 1.5, pressed and drawn."""
    scene, cells = Metal("indented", "CPE4", frame), 10
    mesh = mesh_make.block((2.0, 1.0), (cells, 5), origin=(-1.0, 0.0))
    _body(scene, mesh, ("TOP",), {"BOTTOM": [1, 2]}, scene.linear(300.0, 300.0), method,
          coulomb(mu))
    ends = (-150.0 + 7.0, -30.0 + 7.0)   # no corner points straight down
    scene.tool("PUNCH", "SKIN", arc(1.5, (0.0, 2.5), ends, 2.0/cells/facets)[::-1], (0.0, 2.5))
    scene.ready()
    scene.step({"PUNCH": (0.0, -0.12)}, increments)
    scene.step({"PUNCH": (0.15, -0.12)}, increments)
    return scene, mesh.n_point, 2


def nested(facets: float, mu: float, method: str, increments: Sequence[float] = (),
           frame: Frame = PLAIN) -> Built:
    """Half a block with a round top (radius 1.2) pressed by a polygon in a hollow of radius 1.5."""
    scene, cells, radius = Metal("nested", "CPE4", frame), 6, 1.2
    mesh = mesh_make.block((1.0, 1.0), (cells, 5)).mapped(
        lambda x: np.column_stack([x[:, 0], x[:, 1]*(
            1.0 - radius + np.sqrt(radius**2 - x[:, 0]**2))]))
    _body(scene, mesh, ("TOP",), {"LEFT": [1], "BOTTOM": [2]}, scene.linear(300.0, 300.0), method,
          coulomb(mu))
    corners = np.array(arc(1.5, (0.0, -0.5), (24.0, 107.0), 1.0/cells/facets))
    top = mesh.points[mesh.surface_points("TOP")]
    gap = np.interp(top[:, 0], *corners[::-1].T) - top[:, 1]
    scene.tool("DIE", "SKIN", [(x, y - gap.min()) for x, y in corners], (0.0, 1.5))
    scene.held.append("DIEP, 1")
    scene.ready()
    scene.step({"DIE": (0.0, -0.11)}, increments)
    return scene, mesh.n_point, 1


def ball(facets: float, mu: float, method: str, increments: Sequence[float] = (),
         frame: Frame = PLAIN, smooth: bool = True, folder: Path | None = None) -> Built:
    """A block in space under a cap of triangles on a sphere of radius 1.5, pressed and drawn."""
    scene, cells = Metal("ball", "C3D8", frame), 4
    mesh = mesh_make.block((2.0, 2.0, 0.8), (cells, cells, 2), origin=(-1.0, -1.0, 0.0))
    _body(scene, mesh, ("TOP",), {"BOTTOM": [1, 2, 3]}, scene.linear(300.0, 300.0), method,
          coulomb(mu))
    scene.name = f"ball_{facets:g}"
    scene.facets("PUNCH", "SKIN", cap(1.5, 0.8, 2.0/cells/facets), folder or scratch(), smooth,
                 (0.0, 0.0, 2.3))
    scene.ready()
    scene.step({"PUNCH": (0.0, 0.0, -0.12)}, increments)
    scene.step({"PUNCH": (0.15, 0.0, -0.12)}, increments)
    return scene, mesh.n_point, 2


def cap(radius: float, top: float, facet: float) -> NDArray:
    """Triangles (n, 3, 3) of the lower cap of a sphere that touches the height `top`."""
    n = max(2, round(2.0*1.1/facet))
    a = np.linspace(-1.1, 1.1, n + 1) + 0.013   # no corner over the middle of the block
    x, y = np.meshgrid(a, a + 0.008, indexing="ij")
    z = top + radius - np.sqrt(radius**2 - np.minimum(x**2 + y**2, (0.98*radius)**2))
    p = np.stack([x, y, z], axis=2)
    q, r, s, t = p[:-1, :-1], p[1:, :-1], p[1:, 1:], p[:-1, 1:]
    return np.concatenate([np.stack([q, s, r], axis=2).reshape(-1, 3, 3),
                           np.stack([q, t, s], axis=2).reshape(-1, 3, 3)])


def strip(word: str, thickness: float, cells: Sequence[int], length: float,
          start: float = 0.0) -> Mesh:
    """A flat sheet from `start` along x, its lower face at height zero; in space one row wide."""
    solid = word.startswith("C3D") or word == "CSS8"
    if solid:
        mesh = mesh_make.block((length, length/cells[0], thickness), (cells[0], 1, cells[1]),
                               origin=(start, 0.0, 0.0))
        return mesh
    return mesh_make.block((length, thickness), cells, origin=(start, 0.0),
                           quadratic=word[3] in "68")


def _hold(scene: Metal) -> None:
    """The die stays, the punch moves along the last axis."""
    scene.held += [f"DIEP, 1, {scene.ndim}", f"PUNCHP, 1, {scene.ndim - 1}"]


def air_bend(word: str, thickness: float, mu: float, increments: Sequence[float] = (),
             method: str = "lagrange", yielding: float = 300.0, frame: Frame = PLAIN,
             friction: Sequence[str] | None = None) -> Built:
    """Half a strip over a V of radius 5, bent by a punch of radius 5 to 30 degrees, let go."""
    scene, t = Metal("air_bend", word, frame), thickness
    solid = scene.ndim == 3
    mesh = strip(word, t, (22, 1), 22.0)
    supports = {"LEFT": [1]} | ({"FRONT": [2], "BACK": [2]} if solid else {})
    mesh = mesh.replaced(surfaces={k: mesh.surfaces[k] for k in ("TOP", "BOTTOM")},
                         point_sets={k: mesh.point_sets[k] for k in supports})
    scene.body(mesh, supports)
    scene.metal(*scene.linear(yielding, yielding))
    scene.interaction(method, coulomb(mu) if friction is None else friction)
    scene.tool("PUNCH", "TOP", [(5.0, t + 25.0), (5.0, t + 5.0), (0.0, t, 0.0, t + 5.0),
                                (-4.0, t + 2.0, 0.0, t + 5.0)], (0.0, t + 10.0))
    scene.tool("DIE", "BOTTOM", [(10.0, -30.0), (10.0, -5.0), (15.0, 0.0, 15.0, -5.0),
                                 (40.0, 0.0)], (15.0, -10.0))
    _hold(scene)
    scene.ready()
    down, up = ((0.0, 0.0, -7.0), (0.0, 0.0, 2.0)) if solid else ((0.0, -7.0), (0.0, 2.0))
    scene.step({"PUNCH": down}, increments)
    scene.step({"PUNCH": up}, increments)
    return scene, mesh.n_point, 2


def flanged(word: str, thickness: float, mu: float, increments: Sequence[float] = (),
            method: str = "lagrange", frame: Frame = PLAIN) -> Built:
    """A strip clamped on a die of radius 5; a punch wipes its free end down by 8, then lets go."""
    scene, t = Metal("flanged", word, frame), thickness
    solid = scene.ndim == 3
    mesh = strip(word, t, (18, 1), 18.0, -2.0)
    supports = {"LEFT": [1, scene.ndim]} | ({"FRONT": [2], "BACK": [2]} if solid else {})
    mesh = mesh.replaced(surfaces={k: mesh.surfaces[k] for k in ("TOP", "BOTTOM")},
                         point_sets={k: mesh.point_sets[k] for k in supports})
    scene.body(mesh, supports)
    scene.metal(*scene.linear(300.0, 300.0))
    scene.interaction(method, coulomb(mu))
    scene.tool("DIE", "BOTTOM", [(-9.0, 0.0), (0.0, 0.0), (5.0, -5.0, 0.0, -5.0), (5.0, -25.0)],
               (0.0, -10.0))
    left = 5.0 + 1.1*t
    scene.tool("PUNCH", "TOP", [(30.0, t), (left + 3.0, t), (left, t + 3.0, left + 3.0, t + 3.0),
                                (left, t + 25.0)], (left, t + 10.0))
    _hold(scene)
    scene.ready()
    down, up = ((0.0, 0.0, -8.0), (0.0, 0.0, 2.0)) if solid else ((0.0, -8.0), (0.0, 2.0))
    scene.step({"PUNCH": down}, increments)
    scene.step({"PUNCH": up}, increments)
    return scene, mesh.n_point, 2
