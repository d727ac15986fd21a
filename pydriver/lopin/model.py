"""Model: a mesh and what happens to it, collected by name, written as a deck."""
from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from .deck import Deck
from .errors import ModelError, UsageError
from .laws import Elastic, Lagrange, NeoHooke, method_of
from .mesh import Mesh
from .profile import Profile
from .step import Step, direction

_LETTERS = {"quad": "I", "hexahedron": "I", "quad8": "R", "hexahedron20": "R"}
_PREFIX = {"plane strain": "CPE", "plane stress": "CPS", "axisymmetric": "CAX", "3d": "C3D"}
_NODES = {"triangle": 3, "triangle6": 6, "quad": 4, "quad8": 8, "tetra": 4, "tetra10": 10,
          "wedge": 6, "wedge15": 15, "hexahedron": 8, "hexahedron20": 20}


@dataclass(frozen=True)
class Tool:
    """A rigid tool: a surface and its reference node (a node set of one)."""

    name: str
    profile: Profile
    reference: tuple[float, ...]
    number: int
    free: tuple[int, ...] = ()

    @property
    def node(self) -> str:
        """Name of the node set that holds the reference node."""
        return f"{self.name}_REF"


@dataclass
class Model:
    """A scene. `kind`: "plane strain", "plane stress", "axisymmetric" or "3d".

    `letters`: what follows the number of nodes in the element words it fits: "I" has linear quads
    and bricks bend without locking (sheets), "R" integrates quadratic ones with fewer points.

    >>> from .mesh_make import block
    >>> from .profile import plane
    >>> m = Model("press", block((1.0, 1.0), (2, 2)), kind="plane strain")
    >>> m.section("ALL", Elastic(210e3, 0.3))
    >>> die = m.rigid_tool("DIE", plane(1.0, 2.0))
    >>> m.contact("TOP", die)
    >>> m.fix("BOTTOM", "x", "y")
    >>> _ = m.step().move(die, y=-0.01)
    >>> "*CONTACT PAIR, INTERACTION=I1" in m.to_deck().text()
    True
    """

    name: str
    mesh: Mesh
    kind: str = "plane strain"
    units: str = ""
    sections: list[tuple[str, Elastic | NeoHooke, float, bool]] = field(default_factory=list)
    tools: list[Tool] = field(default_factory=list)
    contacts: list[dict] = field(default_factory=list)
    fixed: list[tuple[str, int]] = field(default_factory=list)
    steps: list[Step] = field(default_factory=list)
    letters: str = ""

    def __post_init__(self):
        if self.kind not in _PREFIX:
            raise UsageError(f"kind is one of {', '.join(_PREFIX)}, not '{self.kind}'")
        if (self.kind == "3d") != (self.mesh.ndim == 3):
            raise ModelError(f"a mesh of {self.mesh.ndim} dimensions is not '{self.kind}'")
        if self.kind == "axisymmetric" and self.mesh.points[:, 0].min() < 0.0:
            least = self.mesh.points[:, 0].min()
            raise ModelError(f"axisymmetric points need r >= 0, not {least:g}")

    def section(self, elements: str, material: Elastic | NeoHooke, thickness: float = 1.0, *,
                full_integration: bool = False) -> None:
        """Give a material to an element set; linear quads and bricks use B-bar by default."""
        self._known(elements, "element")
        self.sections.append((elements, material, thickness, full_integration))

    def rigid_tool(self, name: str, profile: Profile, ref: tuple[float, ...] | None = None,
                   free: tuple[str | int, ...] = ()) -> Tool:
        """A rigid tool; held in every direction that no step moves or loads, but those `free`."""
        reference = tuple(ref or (0.0,)*self.mesh.ndim)
        number = self.mesh.n_point + 1 + len(self.tools)
        tool = Tool(name.upper(), profile, reference, number, tuple(self.dof(f) for f in free))
        self.tools.append(tool)
        return tool

    def contact(self, slave: str, master: str | Tool, method: str | Lagrange = "lagrange", *,
                adjust: float | None = None, small_sliding: bool = False, tied: bool = False,
                no_separation: bool = False, clearance: float | None = None,
                surface_to_surface: bool | None = None) -> None:
        """Two surfaces that may touch; the slave is the softer or finer one.

        `surface_to_surface`: dual mortar, exact for uniform pressure on meshes that do not match;
        unless told, tied surfaces have it.
        """
        self._known(slave, "surface")
        if isinstance(master, str):
            self._known(master, "surface")
        self.contacts.append({
            "slave": slave, "master": master.name if isinstance(master, Tool) else master,
            "method": method_of(method), "adjust": adjust, "small_sliding": small_sliding,
            "tied": tied, "no_separation": no_separation, "clearance": clearance,
            "surface_to_surface": tied if surface_to_surface is None else surface_to_surface})

    def fix(self, points: str | Tool, *directions: str | int) -> None:
        """Hold the points of a set, for the whole run."""
        name = self.point_set(points)
        self.fixed += [(name, self.dof(d)) for d in directions]

    def step(self, increments: int = 1, time: float = 1.0, *, nlgeom: bool = False) -> Step:
        """Append a step: what changes until its end, linearly in time.

        `nlgeom`: finite rotation, strain and sliding, in this step and all later ones.
        """
        self.steps.append(Step(self, increments, time, nlgeom))
        return self.steps[-1]

    def dof(self, name: str | int) -> int:
        """Number of a direction: "x", "y", "z", "r", "rx".. or the number itself."""
        return direction(name, self.kind)

    def point_set(self, points: str | Tool) -> str:
        """Name of a set of points that exists."""
        if isinstance(points, Tool):
            return points.node
        self._known(points, "point")
        return points

    def to_deck(self) -> Deck:
        """The whole deck: readable, commented, ready to run by hand."""
        from .model_deck import write_model

        return write_model(self)

    def run(self, output: str | Path | None = None, **options):
        """Write the deck, solve it in this process and return a `Result`; see `lopin.run`."""
        from .run import run

        return run(self, output, **options)

    def element_word(self, cell: str) -> str:
        """Element word of the deck: CPE4, C3D20..."""
        word = f"{_PREFIX[self.kind]}{_NODES[cell]}"
        return word + self.letters if self.letters in _LETTERS.get(cell, ()) else word

    def tool_directions(self) -> tuple[int, ...]:
        """All dofs of a reference node."""
        return (1, 2, 3, 4, 5, 6) if self.kind == "3d" else (1, 2, 6)

    def _known(self, name: str, what: str) -> None:
        sets = {"element": self.mesh.element_sets, "point": self.mesh.point_sets,
                "surface": self.mesh.surfaces}[what]
        if name not in sets:
            raise ModelError(f"no {what} set '{name}' in the mesh",
                             help=f"{what} sets: {', '.join(sorted(sets)) or 'none'}")

    def __repr__(self) -> str:
        tools = ", ".join(t.name for t in self.tools) or "none"
        return (f"Model({self.name!r}, {self.kind}, {np.size(self.mesh.points)} dofs, "
                f"{len(self.contacts)} contacts, tools {tools}, {len(self.steps)} steps)")
