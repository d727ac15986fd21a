"""A block pressed and then dragged on a plane tool or on another block: stress is uniform.

Poisson's ratio is zero, and tractions on the sides and on what the slave leaves free of the master
balance the moment of the drag: sigma_zz = -p and sigma_xz = -tau everywhere, in any element word,
for any mesh. Axisymmetric blocks are pressed only: a drag has no direction there.
"""
from __future__ import annotations

import re
from dataclasses import dataclass
from math import radians

import numpy as np
from numpy.typing import NDArray

from ..deck import Deck
from ..mesh import make as mesh_make
from ..mesh.mesh import Mesh
from .scenes import PLAIN, Frame

#: In the units of the plain frame; `WAY`: how far the master slides, over the 2 of the slave.
PRESSURE, SHEAR, YOUNG, WAY = 10.0, 2.0, 1e5, 1e-3
_CELLS = {4: "tetra", 10: "tetra", 6: "wedge", 15: "wedge", 8: "hexahedron", 20: "hexahedron"}
_FLAT = {3: "triangle", 6: "triangle", 4: "quad", 8: "quad"}
_HEIGHT = 1.0


@dataclass(frozen=True)
class Scene:
    """What meets what; an empty word of the master: a plane tool."""

    slave: str
    master: str
    facets: tuple[int, int]
    to_surface: bool | None = True   #: surface to surface, or node to surface; None: not told
    nlgeom: bool = False
    coulomb: bool = False       #: friction mu p, or a bound TAUMAX of the same size
    margin: float = 0.0         #: by what the master is wider at either end

    @property
    def ndim(self) -> int:
        return 3 if self.slave.startswith("C3D") else 2

    @property
    def dragged(self) -> bool:
        return not self.slave.startswith("CAX")

    def area(self) -> float:
        """Of the slave face, in the plain frame."""
        return 4.0 if self.ndim == 3 else 2.0


def block_of(word: str, ticks: NDArray, wide: int) -> Mesh:
    """A block of a word on these coordinates along x, its base at height zero."""
    nodes = int(re.match(r"C..(\d+)", word)[1])
    solid = word.startswith("C3D")
    cell = (_CELLS if solid else _FLAT)[nodes]
    t = (ticks - ticks[0])/(ticks[-1] - ticks[0])
    size, cells = (ticks[-1] - ticks[0], 2.0 if solid else _HEIGHT), (len(ticks) - 1, wide)
    mesh = mesh_make.block(size, cells, origin=(ticks[0], 0.0), grading=(t, 1.0))
    if cell in ("triangle", "wedge"):
        mesh = mesh_make.simplices(mesh)
    if solid:
        mesh = mesh_make.extruded(mesh, _HEIGHT, 1)
    if cell == "tetra":
        mesh = mesh_make.simplices(mesh)
    return mesh.quadratic() if nodes in ((10, 15, 20) if solid else (6, 8)) else mesh


def rotation(frame: Frame, ndim: int) -> NDArray:
    """That of a frame; in space about a skew axis."""
    if ndim == 2:
        return frame.turn()
    a = radians(frame.angle)
    x, y, z = np.array([0.4, -1.1, 0.7])/np.linalg.norm([0.4, -1.1, 0.7])
    w = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(a)*w + (1.0 - np.cos(a))*w @ w


def pressed_deck(scene: Scene, frame: Frame = PLAIN) -> Deck:
    """The deck of a scene: pressed in a step, dragged in the next."""
    return _Writer(scene, frame).deck()


def _numbers(values) -> str:
    return ", ".join(repr(float(v)) for v in values)


class _Writer:
    """Lines of a deck as they come."""

    def __init__(self, scene: Scene, frame: Frame):
        self.scene, self.frame, self.ndim = scene, frame, scene.ndim
        # About the axis nothing turns: what is above goes below instead.
        self.flipped = not scene.dragged and frame.angle > 0.0
        self.turn = rotation(frame, self.ndim) if scene.dragged else np.eye(2)
        self.lines: list[str] = ["*HEADING",
                                 f"A block of {scene.slave} on {scene.master or 'a tool'}"]
        self.held: list[str] = []
        self.pressed: list[str] = []
        self.shears: list[str] = []
        self.node = self.element = 0

    def deck(self) -> Deck:
        scene, unit = self.scene, self.frame.stress
        self.lines += ["*MATERIAL, NAME=M", "*ELASTIC", f"{YOUNG*unit!r}, 0."]
        far, near = ("BOTTOM", "TOP") if self.flipped else ("TOP", "BOTTOM")
        n, m = scene.facets
        wide = (2, 2) if n == m else (1, 2)
        self._body("UP", scene.slave, np.linspace(0.0, 2.0, n + 1), wide[0],
                   -_HEIGHT if self.flipped else 0.0)
        self.held.append(f"UP{far}, 1, {self.ndim - 1}")
        self.pressed.append(f"UPS{far}, P, {PRESSURE*unit!r}")
        if scene.master:
            self._master(m, wide[1], near, far)
        else:
            self._tool()
        kind = {True: ", TYPE=SURFACE TO SURFACE", False: ", TYPE=NODE TO SURFACE", None: ""}[
            scene.to_surface if scene.master else None]
        master = f"LOWS{far}" if scene.master else "TOOL"
        self.lines += ["*SURFACE INTERACTION, NAME=I", "*SURFACE BEHAVIOR, DIRECT", "*FRICTION",
                       "0.,",
                       f"*CONTACT PAIR, INTERACTION=I{kind}",
                       f"UPS{near}, {master}", "*BOUNDARY", *self.held]
        step = ["*STEP, NLGEOM, INC=100" if scene.nlgeom else "*STEP, INC=100", "*STATIC, DIRECT",
                "1., 1."]
        end = ["*CONTACT FILE", "CDIS, CSTR", "*END STEP"]
        self.lines += [*step, "*DSLOAD", *self.pressed, *end]
        if scene.dragged:
            friction = ["*FRICTION", f"{SHEAR/PRESSURE!r},"] if scene.coulomb else \
                [f"*FRICTION, TAUMAX={SHEAR*unit!r}", "0.3,"]
            self.lines += [*step, "*CHANGE FRICTION, INTERACTION=I", *friction, "*BOUNDARY",
                           *self._slide(), "*DSLOAD", *self.shears, *end]
        return Deck.parse("\n".join(self.lines) + "\n", name=f"faces_{scene.slave.lower()}")

    def _place(self, x: NDArray) -> NDArray:
        return self.frame.length*(x @ self.turn.T)

    def _body(self, name: str, word: str, ticks: NDArray, wide: int, base: float) -> None:
        """Nodes, elements, sets and surfaces of a block; sides sheared, axis held."""
        if self.ndim == 2:
            wide = 2
        lift = np.zeros(self.ndim)
        lift[-1] = base
        mesh = block_of(word, ticks, wide).mapped(lambda x: x + lift)
        if name == "LOW" and self.scene.margin:
            face = "BOTTOM" if self.flipped else "TOP"
            mesh = mesh.replaced(surfaces={**mesh.surfaces, "FREE": _free(mesh, face)})
        first, cells = self.node + 1, self.element + 1
        self.lines += [f"*NODE, NSET={name}N", *(f"{first + i}, {_numbers(x)}" for i, x in
                                                  enumerate(self._place(mesh.points)))]
        self.lines.append(f"*ELEMENT, TYPE={word}, ELSET={name}E")
        for _, block in mesh.blocks:
            for row in block:
                self.element += 1
                self.lines.append(f"{self.element}, " + ", ".join(str(first + int(k)) for k in row))
        for side, members in mesh.point_sets.items():
            self.lines += [f"*NSET, NSET={name}{side}", *(f"{first + int(k)}," for k in members)]
        for side, rows in mesh.surfaces.items():
            self.lines += [f"*SURFACE, NAME={name}S{side}",
                           *(f"{cells + int(e)}, S{int(f)}" for e, f in rows)]
        self.node += mesh.n_point
        self.lines += [f"*SOLID SECTION, ELSET={name}E, MATERIAL=M",
                       *([f"{self.frame.length!r},"] if word[:2] == "CP" else [])]
        if not self.scene.dragged:
            self.held.append(f"{name}LEFT, 1")
            return
        turn = np.eye(3)
        turn[:self.ndim, :self.ndim] = self.turn
        self.lines += [f"*TRANSFORM, NSET={name}N, TYPE=R", _numbers([*turn[:, 0], *turn[:, 1]])]
        for side, sign in (("RIGHT", -1.0), ("LEFT", 1.0)):
            self._traction(f"{name}S{side}", sign, -1)

    def _traction(self, surface: str, sign: float, axis: int) -> None:
        """The shear on a side, along an axis before turning."""
        along = _numbers([*self.turn[:, axis], 0.0][:3])
        self.shears.append(f"{surface}, TRVEC, {sign*SHEAR*self.frame.stress!r}, {along}")

    def _master(self, facets: int, wide: int, near: str, far: str) -> None:
        """A block; what the slave leaves free of a wider one carries the same tractions."""
        ticks, margin = np.linspace(0.0, 2.0, facets + 1), self.scene.margin
        if margin:
            before = [-margin] if self.scene.dragged else []
            ticks = np.array([*before, *ticks, 2.0 + margin])
        self._body("LOW", self.scene.master, ticks, wide, 0.0 if self.flipped else -_HEIGHT)
        self.held.append(f"LOW{near}, 1, {self.ndim}")
        if not margin:
            return
        self.pressed.append(f"LOWSFREE, P, {PRESSURE*self.frame.stress!r}")
        if self.scene.dragged:
            self._traction("LOWSFREE", -1.0, 0)

    def _tool(self) -> None:
        """A plane through the origin, its outside up (flipped: down)."""
        self.node += 1
        d, size = self.ndim, 9.0*self.frame.length
        self.lines += ["*NODE, NSET=TOOLP", f"{self.node}, {_numbers(np.zeros(d))}"]
        if d == 2:
            ends = [self.turn @ np.array([x, 0.0]) for x in (-size, size)]
            ends = [np.zeros(2), ends[1]] if not self.scene.dragged else ends
            ends = ends[::-1] if self.flipped else ends
            self.lines += ["*SURFACE, NAME=TOOL, TYPE=SEGMENTS", f"START, {_numbers(ends[0])}",
                           f"LINE, {_numbers(ends[1])}"]
            self.held += ["TOOLP, 1, 2", "TOOLP, 6"]
        else:
            axes = self.frame.length*self.turn
            self.lines += ["*SURFACE, NAME=TOOL, TYPE=CYLINDER",
                           _numbers([*np.zeros(3), *axes[:, 0]]), _numbers(-axes[:, 1]),
                           f"START, {-size!r}, 0.", f"LINE, {size!r}, 0."]
            self.held.append("TOOLP, 1, 6")
        self.lines.append(f"*RIGID BODY, ANALYTICAL SURFACE=TOOL, REF NODE={self.node}")

    def _slide(self) -> list[str]:
        """Where the master goes."""
        way = WAY*self.frame.length
        if self.scene.master:
            return [f"LOWBOTTOM, 1, 1, {way!r}"]
        return [f"TOOLP, {i + 1}, {i + 1}, {way*float(v)!r}"
                for i, v in enumerate(self.turn[:, 0])]


def _free(mesh: Mesh, face: str) -> NDArray:
    """Facets of a face that lie outside the slave."""
    middle = [mesh.points[mesh.face_nodes(int(e), int(f)), 0].mean()
              for e, f in mesh.surfaces[face]]
    return mesh.surfaces[face][(np.array(middle) < 0.0) | (np.array(middle) > 2.0)]
