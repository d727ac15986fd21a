"""Meshes and cards of the decks of decks/handbook, with nothing of Lopin in them.

A `Grid` has quads or bricks, node sets and surfaces of its sides; a `Cloud` is of triangles or
tetrahedra.
"""
from __future__ import annotations

import numpy as np

#: Node order of the quadratic quad and brick on a grid of half steps.
QUAD = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1)]
BRICK = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2),
         (1, 0, 0), (2, 1, 0), (1, 2, 0), (0, 1, 0), (1, 0, 2), (2, 1, 2), (1, 2, 2), (0, 1, 2),
         (0, 0, 1), (2, 0, 1), (2, 2, 1), (0, 2, 1)]
SIDES_2D = {"LEFT": (0, 0, "S4"), "RIGHT": (0, -1, "S2"), "BOTTOM": (1, 0, "S1"),
            "TOP": (1, -1, "S3")}
SIDES_3D = {"LEFT": (0, 0, "S6"), "RIGHT": (0, -1, "S4"), "FRONT": (1, 0, "S3"),
            "BACK": (1, -1, "S5"), "BOTTOM": (2, 0, "S1"), "TOP": (2, -1, "S2")}
#: A cube in six tetrahedra round the diagonal from corner 0 to corner 6.
TETRA = [(0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6)]


def even(start: float, end: float, cells: int) -> np.ndarray:
    """Ticks of equal steps."""
    return np.linspace(start, end, cells + 1)


def graded(fine: float, until: float, end: float, growth: float) -> np.ndarray:
    """Ticks from 0: steps `fine` as far as `until`, then growing to `end`."""
    ticks = list(fine*np.arange(round(until/fine) + 1))
    step = fine
    while ticks[-1] + step*growth < end - 0.6*step*growth:
        step *= growth
        ticks.append(ticks[-1] + step)
    return np.array([*ticks, end])


def rows(numbers, width: int = 12) -> str:
    """Numbers, some a line."""
    numbers = [str(n) for n in numbers]
    return "".join(", ".join(numbers[k:k + width]) + "\n" for k in range(0, len(numbers), width))


def nset(name: str, nodes) -> str:
    """Card of a node set."""
    return f"*NSET, NSET={name}\n{rows(nodes)}"


def nodes_card(numbers, points) -> str:
    """Card of nodes, coordinates to ten digits."""
    return "*NODE\n" + "".join(f"{n}, " + ", ".join(f"{c:.10g}" for c in x) + "\n"
                               for n, x in zip(numbers, np.round(points, 11) + 0.0))


class Grid:
    """Cells of a rectangle or box of ticks, bent by `at`; numbers begin behind `first`."""

    def __init__(self, name: str, word: str, *ticks: np.ndarray, at=None, first: int = 0):
        self.name, self.word, self.dim = name, word, len(ticks)
        digits = "".join(c for c in word if c.isdigit())
        self.second = digits in ("8", "320") if self.dim == 2 else digits == "320"
        step = 2 if self.second else 1
        fine = [np.interp(np.arange(step*(len(t) - 1) + 1)/step, np.arange(len(t)), t)
                for t in ticks]
        grid = np.stack(np.meshgrid(*fine, indexing="ij"), axis=-1)
        odd = sum(np.meshgrid(*[np.arange(len(f)) % 2 for f in fine], indexing="ij"))
        used = (odd < 2) if self.second else np.ones(odd.shape, bool)
        self.number = np.where(used, np.cumsum(used).reshape(used.shape) + first, 0)
        points = grid[used] if at is None else np.array([at(*x) for x in grid[used]])
        self.numbers, self.points = self.number[used], points
        self.cells = np.arange(1, np.prod([len(t) - 1 for t in ticks]) + 1) + first
        self.cells = self.cells.reshape([len(t) - 1 for t in ticks])
        self.sides = SIDES_2D if self.dim == 2 else SIDES_3D

    def corners(self, cell: tuple) -> list[int]:
        """Nodes of one cell."""
        order = QUAD if self.dim == 2 else BRICK
        if not self.second:
            order = [tuple(k//2 for k in o) for o in order[:4 if self.dim == 2 else 8]]
        step = 2 if self.second else 1
        return [int(self.number[tuple(step*c + o for c, o in zip(cell, off))]) for off in order]

    def side(self, which: str) -> list[int]:
        """Nodes of a side."""
        axis, end, _ = self.sides[which]
        found = np.take(self.number, end, axis=axis).ravel()
        return [int(n) for n in found if n]

    def node(self, *index: int) -> int:
        """Number of the node at this place of the grid of corners."""
        step = 2 if self.second else 1
        return int(self.number[tuple(step*k if k >= 0 else k for k in index)])

    def text(self, sets: str = "", surfaces: str = "") -> str:
        """Cards of nodes, elements, node sets and surfaces of these sides: NAME.SIDE."""
        out = nodes_card(self.numbers, self.points)
        out += f"*ELEMENT, TYPE={self.word}, ELSET={self.name}\n"
        for cell, label in np.ndenumerate(self.cells):
            out += rows([label, *self.corners(cell)], 16).replace("\n", ",\n", 1) \
                if self.dim == 3 and self.second else rows([label, *self.corners(cell)], 16)
        for which in sets.split():
            out += nset(f"{self.name}.{which}", self.side(which))
        for which in surfaces.split():
            axis, end, face = self.sides[which]
            label = f"{self.name}.{which}"
            out += f"*ELSET, ELSET={label}\n{rows(np.take(self.cells, end, axis=axis).ravel())}"
            out += f"*SURFACE, NAME={label}\n{label}, {face}\n"
        return out


class Cloud:
    """Triangles or tetrahedra with points; surfaces are found from the corners of their edges."""

    def __init__(self, name: str, word: str, points: np.ndarray, cells: np.ndarray):
        self.name, self.word, self.points, self.cells = name, word, points, cells

    def text(self, sets: dict, surfaces: dict) -> str:
        """Cards; sets and surfaces are given by conditions on points."""
        out = nodes_card(range(1, len(self.points) + 1), self.points)
        out += f"*ELEMENT, TYPE={self.word}, ELSET={self.name}\n"
        out += "".join(rows([k, *(np.array(c) + 1)]) for k, c in enumerate(self.cells, start=1))
        for name, where in sets.items():
            out += nset(name, [k for k, x in enumerate(self.points, start=1) if where(x)])
        faces = [(0, 1), (1, 2), (2, 0)] if self.points.shape[1] == 2 else \
            [(0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0)]
        for name, where in surfaces.items():
            out += f"*SURFACE, NAME={name}\n"
            for k, cell in enumerate(self.cells, start=1):
                out += "".join(f"{k}, S{f}\n" for f, face in enumerate(faces, start=1)
                               if all(where(self.points[cell[i]]) for i in face))
        return out


def tetrahedra(name: str, word: str, *ticks: np.ndarray) -> Cloud:
    """A box of tetrahedra, six a cell."""
    grid = Grid(name, "C3D8", *ticks)
    cells = [[grid.corners(c)[k] - 1 for k in t] for c in np.ndindex(grid.cells.shape)
             for t in TETRA]
    return Cloud(name, word, grid.points, np.array(cells))


def gmsh_cells(draw, order: int) -> tuple[np.ndarray, np.ndarray]:
    """Points and triangles of what `draw(gmsh.model)` makes."""
    import gmsh
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    draw(gmsh.model)
    gmsh.model.mesh.generate(2)
    gmsh.model.mesh.setOrder(order)
    tags, x, _ = gmsh.model.mesh.getNodes()
    kind = {1: 2, 2: 9}[order]
    cells = gmsh.model.mesh.getElementsByType(kind)[1].reshape(-1, {1: 3, 2: 6}[order])
    gmsh.finalize()
    used = np.unique(cells)
    place = {t: k for k, t in enumerate(used)}
    where = {t: k for k, t in enumerate(tags)}
    points = x.reshape(-1, 3)[[where[t] for t in used], :2]
    return points, np.vectorize(place.get)(cells)


def elastic(name: str, sets: str, young: float, poisson: float, more: str = "",
            thick: str = "") -> str:
    """Material and sections."""
    out = f"*MATERIAL, NAME={name}\n*ELASTIC\n{young:.10g}, {poisson:.10g}\n{more}"
    for one in sets.split():
        out += f"*SOLID SECTION, ELSET={one}, MATERIAL={name}\n{thick}"
    return out


def tool(name: str, ref: tuple, profile: str, kind: str = "SEGMENTS", number: int = 900001) -> str:
    """A rigid tool with its reference node, set NAME_REF."""
    at = ", ".join(f"{c:.10g}" for c in ref)
    return (f"*NODE, NSET={name}_REF\n{number}, {at}\n*SURFACE, NAME={name}, TYPE={kind}\n"
            f"{profile.strip()}\n*RIGID BODY, ANALYTICAL SURFACE={name}, REF NODE={name}_REF\n")


def pairs(lines: str, mu: float = 0.0, behavior: str = "*SURFACE BEHAVIOR, DIRECT",
          options: str = "") -> str:
    """One interaction and its pairs."""
    rubs = f"*FRICTION\n{mu:g}\n" if mu else ""
    return (f"*SURFACE INTERACTION, NAME=TOUCH\n{behavior}\n{rubs}"
            f"*CONTACT PAIR, INTERACTION=TOUCH{options}\n{lines.strip()}\n")


def step(cards: str, static: str = "1., 1.", options: str = "") -> str:
    """One static step."""
    return f"*STEP{options}\n*STATIC\n{static}\n{cards.strip()}\n*END STEP\n"
