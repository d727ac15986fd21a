"""Small forming decks, written line by line in any frame: a body of metal and rigid tools.

Geometry, yield stress and friction are given in the plain frame; a `Frame` turns and scales all
of it. About an axis of revolution nothing turns, and in space everything turns about a skew axis.
"""
from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..deck import Deck
from ..mesh.mesh import Mesh
from .blocks import rotation
from .scenes import PLAIN, Frame

#: In the units of the plain frame (N, mm).
YOUNG, POISSON = 2e5, 0.3
#: *SURFACE BEHAVIOR by method.
METHODS = {"lagrange": "DIRECT", "penalty": "PENALTY", "perturbed": "PERTURBED LAGRANGE",
           "augmented": "AUGMENTED LAGRANGE"}
#: No increment is smaller than this, and none of a step is beyond this number, or three times what
#: its largest increments make.
LEAST, MOST = 1e-9, 200


def _numbers(values) -> str:
    return ", ".join(repr(float(v)) for v in values)


class Metal:
    """The lines of a deck as they come; `deck` closes it."""

    def __init__(self, name: str, word: str, frame: Frame = PLAIN):
        self.name, self.word, self.frame = name, word, frame
        self.ndim = 3 if word.startswith("C3D") or word.startswith("CSS") else 2
        self.turned = not word.startswith("CAX")
        self.turn = rotation(frame, self.ndim) if self.turned else np.eye(2)
        self.lines = ["*HEADING", name]
        self.held: list[str] = []
        self.pairs: list[str] = []
        self.tools: list[str] = []
        self.driven: set[tuple[str, int]] = set()   # tools and axes that a step moves
        self.node = self.element = 0
        self.folder = Path()

    def place(self, x) -> NDArray:
        """Points as this frame has them."""
        return self.frame.length*(np.asarray(x, float) @ self.turn.T)

    def body(self, mesh: Mesh, supports: dict[str, Sequence[int]]) -> None:
        """Nodes, elements, the surfaces of a mesh, and supports of its sides by axes."""
        self.lines += ["*NODE, NSET=BODY", *(f"{i + 1}, {_numbers(x)}" for i, x in
                                             enumerate(self.place(mesh.points)))]
        self.node = mesh.n_point
        self.lines.append(f"*ELEMENT, TYPE={self.word}, ELSET=METAL")
        for _, block in mesh.blocks:
            for row in block:
                self.element += 1
                self.lines.append(", ".join(map(str, (self.element, *(int(k) + 1 for k in row)))))
        for side, members in mesh.point_sets.items():
            self.lines += [f"*NSET, NSET={side}", *(f"{int(k) + 1}," for k in members)]
        for side, rows in mesh.surfaces.items():
            self.lines += [f"*SURFACE, NAME={side}", *(f"{int(e) + 1}, S{int(f)}" for e, f in rows)]
        self._axes("BODY")
        for side, axes in supports.items():
            self.held += [f"{side}, {axis}" for axis in axes]

    def metal(self, *flow: str) -> None:
        """*PLASTIC or another card, its stresses in this frame already."""
        unit = self.frame.stress
        self.lines += ["*MATERIAL, NAME=M", "*ELASTIC", f"{YOUNG*unit!r}, {POISSON}", *flow,
                       "*SOLID SECTION, ELSET=METAL, MATERIAL=M",
                       *([f"{self.frame.length!r},"] if self.word.startswith("CP") else [])]

    def linear(self, yielding: float, slope: float) -> list[str]:
        """Flow stress that grows linearly with the plastic strain."""
        unit = self.frame.stress
        return ["*PLASTIC", f"{yielding*unit!r}, 0.", f"{(yielding + 5.0*slope)*unit!r}, 5."]

    def interaction(self, method: str, friction: Sequence[str] = ()) -> None:
        """Of all pairs; friction as its lines."""
        self.lines += ["*SURFACE INTERACTION, NAME=I", f"*SURFACE BEHAVIOR, {METHODS[method]}",
                       *friction]

    def tool(self, name: str, slave: str, profile: Sequence[Sequence[float]],
             at: Sequence[float] = (0.0, 0.0)) -> None:
        """A rigid profile: its first point, then (x, y) lines and (x, y, xc, yc) arcs.

        In space it is swept along the second axis, and x, y are the first and the third.
        """
        axes = [f"*SURFACE, NAME={name}, TYPE=SEGMENTS"]
        local = self.place
        if self.ndim == 3:
            t = self.frame.length*self.turn
            axes = [f"*SURFACE, NAME={name}, TYPE=CYLINDER",
                    _numbers([0.0, 0.0, 0.0, *t[:, 0]]), _numbers(-t[:, 1])]
            at = (at[0], 0.0, at[1])

            def local(x):
                return self.frame.length*np.asarray(x, float)

        self._reference(name, slave, at)
        self.lines += axes
        for k, row in enumerate(profile):
            points = np.concatenate([local(row[i:i + 2]) for i in range(0, len(row), 2)])
            word = "START" if k == 0 else "LINE" if len(row) == 2 else "CIRCL"
            self.lines.append(f"{word}, {_numbers(points)}")
        self.lines.append(f"*RIGID BODY, ANALYTICAL SURFACE={name}, REF NODE={name}P")

    def facets(self, name: str, slave: str, triangles: NDArray, folder: Path, smooth: bool,
               at: Sequence[float] = (0.0, 0.0, 0.0)) -> None:
        """A tool of (n, 3, 3) triangles, written as STL into a folder."""
        self.folder = folder
        path = folder/f"{self.name}.stl"
        rows = ["solid tool"]
        for triangle in self.place(triangles):
            rows += ["facet normal 0 0 0", "outer loop",
                     *(f"vertex {x!r} {y!r} {z!r}" for x, y, z in triangle.tolist()),
                     "endloop", "endfacet"]
        path.write_text("\n".join([*rows, "endsolid tool", ""]), encoding="ascii")
        self._reference(name, slave, at)
        self.lines += [f"*SURFACE, NAME={name}, TYPE=STL, OPEN, INPUT={path.name}"
                       + ("" if smooth else ", SMOOTH=NO"),
                       f"*RIGID BODY, ANALYTICAL SURFACE={name}, REF NODE={name}P"]

    def _reference(self, name: str, slave: str, at: Sequence[float]) -> None:
        self.node += 1
        self.tools.append(name)
        self.pairs.append(f"{slave}, {name}")
        self.lines += [f"*NODE, NSET={name}P", f"{self.node}, {_numbers(self.place(at))}"]
        self._axes(f"{name}P")
        self.held += [f"{name}P, 4, 6"] if self.ndim == 3 else [f"{name}P, 6"]

    def _axes(self, points: str) -> None:
        if self.turned:
            turn = np.eye(3)
            turn[:self.ndim, :self.ndim] = self.turn
            self.lines += [f"*TRANSFORM, NSET={points}, TYPE=R",
                           _numbers([*turn[:, 0], *turn[:, 1]])]

    def ready(self) -> None:
        """Pairs and supports: the model ends, steps follow."""
        self.lines += ["*CONTACT PAIR, INTERACTION=I", *self.pairs, "*BOUNDARY", *self.held]

    def step(self, moves: dict[str, Sequence[float]], increments: Sequence[float] = (),
             extra: Sequence[str] = ()) -> None:
        """Tools go to a displacement; `increments`: first and largest, or left to the code."""
        static = [f"{increments[0]!r}, 1., {min(LEAST, increments[0])!r}, {increments[-1]!r}"] \
            if increments else []
        most = max(MOST, round(3.0/increments[-1])) if increments else MOST
        self.lines += [f"*STEP, NLGEOM, INC={most}", "*STATIC", *static, *extra, "*BOUNDARY"]
        for name, way in moves.items():
            self.lines += [f"{name}P, {k + 1}, {k + 1}, {self.frame.length*float(v)!r}"
                           for k, v in enumerate(way)]
            self.driven |= {(name, k) for k, v in enumerate(way) if v}
        self.lines += ["*NODE FILE", "U", "*END STEP"]

    def deck(self) -> Deck:
        """All of it."""
        deck = Deck.parse("\n".join(self.lines) + "\n", name=self.name)
        deck.folder = self.folder
        return deck
