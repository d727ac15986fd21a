"""Model: a mesh and what happens to it, collected by name, written as a deck."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from .deck import Block, Deck
from .errors import ModelError, UsageError
from .friction import Friction, friction_of
from .laws import Lagrange, method_of
from .materials import Elastic, Material, NeoHooke, Orientation
from .mesh.mesh import Mesh
from .model_deck import write_model
from .model_parts import Pair, Tool
from .model_read import read_model
from .profile import Profile, Stl
from .run import run
from .step import Load, Points, Step, direction

_LETTERS = {"quad": "I", "hexahedron": "I", "quad8": "R", "hexahedron20": "R"}
_PREFIX = {"plane strain": "CPE", "plane stress": "CPS", "axisymmetric": "CAX", "3d": "C3D"}
_NODES = {"triangle": 3, "triangle6": 6, "quad": 4, "quad8": 8, "tetra": 4, "tetra10": 10,
          "wedge": 6, "wedge15": 15, "hexahedron": 8, "hexahedron20": 20}
#: Options that other codes do not have: words of `Model.options`.
OPTIONS = ("path", "solver", "target_error", "continuation", "mortar_degree", "quantity",
           "set", "component")


@dataclass
class Model:
    """A scene. `kind`: "plane strain", "plane stress", "axisymmetric" or "3d".

    `letters`: what follows the number of nodes in the element words it fits: "I" has linear quads
    and bricks bend without locking (sheets), "R" integrates quadratic ones with fewer points.

    >>> from .mesh.make import block
    >>> from .profile import plane
    >>> m = Model("press", block((1.0, 1.0), (2, 2)), kind="plane strain")
    >>> m.section("ALL", Elastic(210e3, 0.3))
    >>> die = m.rigid_tool("DIE", plane(1.0, 2.0))
    >>> _ = m.contact("TOP", die, friction=0.1)
    >>> m.fix("BOTTOM", "x", "y")
    >>> _ = m.step().move(die, y=-0.01)
    >>> "*CONTACT PAIR, INTERACTION=I1" in m.to_deck().text()
    True
    """

    name: str
    mesh: Mesh
    kind: str = "plane strain"
    units: str = ""
    sections: list[tuple] = field(default_factory=list)
    tools: list[Tool] = field(default_factory=list)
    contacts: list[Pair] = field(default_factory=list)
    fixed: list[Load] = field(default_factory=list)
    steps: list[Step] = field(default_factory=list)
    letters: str = ""
    ties: list[tuple[str, str, str, dict]] = field(default_factory=list)
    amplitudes: dict[str, tuple[list, dict]] = field(default_factory=dict)
    equations: list[list[tuple[str | int, int, float]]] = field(default_factory=list)
    transforms: list[tuple[str, str, list[float]]] = field(default_factory=list)
    initial: list[tuple[str, list]] = field(default_factory=list)
    node_surfaces: dict[str, tuple[str, float | None]] = field(default_factory=dict)
    choices: dict[str, str | int | float] = field(default_factory=dict)
    settings: list[Block] = field(default_factory=list)

    def __post_init__(self):
        if self.kind not in _PREFIX:
            raise UsageError(f"kind is one of {', '.join(_PREFIX)}, not '{self.kind}'")
        if (self.kind == "3d") != (self.mesh.ndim == 3):
            raise ModelError(f"a mesh of {self.mesh.ndim} dimensions is not '{self.kind}'")
        if self.kind == "axisymmetric" and self.mesh.points[:, 0].min() < 0.0:
            least = self.mesh.points[:, 0].min()
            raise ModelError(f"axisymmetric points need r >= 0, not {least:g}")

    @classmethod
    def read(cls, scene: Deck | str | Path) -> Model:
        """The model of a deck; a card that a model has no method for raises `UsageError`."""
        return read_model(scene, cls)

    def section(self, elements: str, material: Elastic | NeoHooke | Material,
                thickness: float = 1.0, *, full_integration: bool = False,
                orientation: Orientation | None = None) -> None:
        """Give a material to an element set; linear quads and bricks use B-bar by default.

        `thickness`: of plane scenes, > 0 [length]. `orientation`: axes that `Hill48` counts along.
        """
        self.known(elements, "element")
        if not hasattr(material, "add_to"):
            raise UsageError(f"a material is Elastic, NeoHooke or Material(...), not {material!r}")
        self.sections.append((elements, material, thickness, full_integration, orientation))

    def rigid_tool(self, name: str, profile: Profile | Stl, ref: Sequence[float] | None = None,
                   free: Sequence[str | int] = (), *, node_name: str = "") -> Tool:
        """A rigid tool; held in every direction that no step moves or loads, but those `free`.

        Parameters
        ----------
        profile : from `lopin.profile`: lines and arcs, swept, turned, or an STL file
        ref : reference point [length], where forces and moments are told; the origin unless given
        node_name : node set of the reference point, NAME_REF unless given
        """
        return self._add_tool(name, profile, ref, free, (), node_name)

    def rigid_body(self, name: str, ref: Sequence[float] | None = None,
                   free: Sequence[str | int] = (), *, points: str = "", elements: str = "",
                   node_name: str = "") -> Tool:
        """Mesh points or elements that move as one with a reference point; see `rigid_tool`."""
        if bool(points) == bool(elements):
            raise UsageError("a rigid body is either of points or of elements")
        self.known(points or elements, "point" if points else "element")
        body = (("nset", points),) if points else (("elset", elements),)
        return self._add_tool(name, None, ref, free, body, node_name)

    def _add_tool(self, name, profile, ref, free, body, node_name) -> Tool:
        reference = tuple((0.0,)*self.mesh.ndim if ref is None else map(float, ref))
        number = self.mesh.n_point + 1 + len(self.tools)
        tool = Tool(name.upper(), profile, reference, number, tuple(self.dof(f) for f in free),
                    body, node_name)
        self.tools.append(tool)
        return tool

    def contact(self, slave: str, master: str | Tool, method: str | Lagrange = "lagrange", *,
                friction: float | Friction | None = None, adjust: float | str | None = None,
                small_sliding: bool = False, tied: bool = False, no_separation: bool = False,
                clearance: float | None = None, surface_to_surface: bool | None = None,
                smooth: bool = False, extension: float | None = None,
                initial: str = "") -> Pair:
        """Two surfaces that may touch; the slave is the softer or finer one.

        Parameters
        ----------
        method : "lagrange", "penalty", "perturbed", "augmented", or one of `Lagrange`, `Penalty`...
        friction : coefficient of Coulomb's law, or a law such as `Tresca`; none unless given
        adjust : move slave points nearer than this [length], or those of a point set, on the
            master without strain; "yes": only those that penetrate
        clearance : one value in place of all initial gaps; negative is an overclosure [length]
        surface_to_surface : dual mortar, exact for uniform pressure on meshes that do not match;
            unless told, tied surfaces have it, and others where the plan of the run chooses it
        smooth : curve linear facets of the master by averaged normals
        extension : of open master edges, fraction of a facet, 0 to 0.2; 0.1 unless given
        initial : what an overclosure is: "error", "interference" or "adjust"
        """
        if slave not in self.node_surfaces:
            self.known(slave, "surface")
        if isinstance(master, str):
            self.known(master, "surface")
        if extension is not None and not 0.0 <= extension <= 0.2:
            raise UsageError(f"extension must lie in [0, 0.2], not {extension:g}")
        if initial not in ("", "error", "interference", "adjust"):
            raise UsageError(f"initial is 'error', 'interference' or 'adjust', not '{initial}'")
        pair = Pair(len(self.contacts) + 1, slave,
                    master.name if isinstance(master, Tool) else master, method_of(method),
                    friction_of(friction),
                    {"adjust": adjust, "small_sliding": small_sliding, "tied": tied,
                     "no_separation": no_separation, "clearance": clearance, "smooth": smooth,
                     "surface_to_surface": surface_to_surface, "extension": extension,
                     "initial": initial})
        self.contacts.append(pair)
        return pair

    def tie(self, slave: str, master: str, *, tolerance: float | None = None,
            surface_to_surface: bool = True) -> None:
        """Glue two surfaces whose meshes need not match.

        `tolerance`: ties what is nearer than this [length], or than half a slave facet.
        """
        self.known(slave, "surface")
        self.known(master, "surface")
        kind = "SURFACE TO SURFACE" if surface_to_surface else "NODE TO SURFACE"
        self.ties.append((f"TIE{len(self.ties) + 1}", slave, master,
                          {"type": kind, "position_tolerance": tolerance}))

    def surface_of_points(self, name: str, points: str, area: float | None = None) -> str:
        """A slave surface of points; without an `area` [area], its pressure is a force."""
        self.known(points, "point")
        self.node_surfaces[name] = (points, area)
        return name

    def fix(self, points: Points, *directions: str | int) -> None:
        """Hold points (a set, a tool, or 0-based indices) for the whole run."""
        self.fixed += self.loads(points, {d: 0.0 for d in directions})

    def prescribe(self, points: Points, **values: float | ArrayLike) -> None:
        """Displacements [length] of the first step that stay; as `Step.move`."""
        self.fixed += self.loads(points, values)

    def amplitude(self, name: str, points: Sequence[tuple[float, float]], *,
                  total_time: bool = False, absolute: bool = False) -> str:
        """A factor through time, linear between (time, value) points; returns its name.

        `total_time`: times count from the start of the run, not of the step. `absolute`: the
        values are the load itself, not factors of it.
        """
        rows = [(float(t), float(v)) for t, v in points]
        if len(rows) < 2 or any(b[0] <= a[0] for a, b in zip(rows, rows[1:])):
            raise UsageError("an amplitude has two points or more, and its times grow")
        self.amplitudes[name] = (rows, {"time": "TOTAL TIME" if total_time else None,
                                        "value": "ABSOLUTE" if absolute else None})
        return name

    def equation(self, *terms: tuple[str | int, str | int, float]) -> None:
        """The sum of coefficient times displacement is zero; the first term is eliminated.

        A term: a point set or a 0-based index, a direction, a coefficient [-].
        """
        self.equations.append([(load.target, load.dof, load.value) for points, d, factor in terms
                               for load in self.loads(points, {d: factor})])

    def transform(self, points: str, a: Sequence[float], b: Sequence[float], *,
                  cylindrical: bool = False) -> None:
        """Local axes in which the directions of points are meant.

        Cartesian: `a` is on local x, `b` in the local xy plane; cylindrical: the axis from a to b.
        """
        self.known(points, "point")
        self.transforms.append((points, "C" if cylindrical else "R", [*map(float, (*a, *b))]))

    def initial_temperature(self, points: Points, value: float | ArrayLike) -> None:
        """Temperature before the first step, where nothing is strained; 0 where none is given."""
        self.initial.append(("TEMPERATURE", [list(row) for row in self.valued(points, value)]))

    def initial_stress(self, elements: str, *stress: float) -> None:
        """S11, S22, S33, S12, S13, S23 [stress] before the first step; need not be in balance."""
        self.known(elements, "element")
        self.initial.append(("STRESS", [[elements, *map(float, stress)]]))

    def options(self, **choices: str | int | float) -> None:
        """Choices of *LOPIN: path, solver, target_error, continuation, mortar_degree, and the
        number that `lopin.accuracy.reach` is asked for: quantity, set, component."""
        for name in choices:
            if name not in OPTIONS:
                raise UsageError(f"no option '{name}'; known: {', '.join(OPTIONS)}")
        self.choices |= choices

    def setting(self, keyword: str, *lines: str, **parameters: str | int | float | None) -> None:
        """A card of the model that is only kept and reported: its lines and its parameters.

        The keyword table says which these are: "reported" of `lopin.keywords()`.
        """
        words = {name.upper().replace("_", " "): value for name, value in parameters.items()}
        block = Block(keyword, words)
        block.lines += lines
        self.settings.append(block)

    def step(self, increments: int = 1, time: float = 1.0, *, nlgeom: bool = False,
             name: str = "", first: float | None = None, smallest: float | None = None,
             largest: float | None = None, most: int | None = None, fixed: bool = False,
             at_once: bool = False) -> Step:
        """Append a step: what changes until its end, linearly in time.

        Parameters
        ----------
        increments : how many there are if none is cut, >= 1
        time : period, > 0 [time]
        nlgeom : finite rotation, strain and sliding, in this step and all later ones
        first, smallest, largest : sizes of increments [time]; time/increments, time/10^6 and
            time/increments unless given
        most : number of increments after which the run gives up
        fixed : increments keep the first size
        at_once : loads act at once in place of growing
        """
        self.steps.append(Step(self, increments, time, nlgeom, name=name, first=first,
                               smallest=smallest, largest=largest, most=most, fixed=fixed,
                               at_once=at_once))
        return self.steps[-1]

    def dof(self, name: str | int) -> int:
        """Number of a direction: "x", "y", "z", "r", "rx".. or the number itself."""
        return direction(name, self.kind)

    def point_set(self, points: str | Tool) -> str:
        """Name of a set of points that exists."""
        if isinstance(points, Tool):
            return points.node
        self.known(points, "point")
        return points

    def targets(self, points: Points) -> list[str | int]:
        """A node set or node numbers, as data lines name them."""
        if isinstance(points, (str, Tool)):
            return [self.point_set(points)]
        indices = np.atleast_1d(np.asarray(points))
        if indices.dtype.kind not in "iu" or indices.min() < 0 or \
                indices.max() >= self.mesh.n_point:
            raise ModelError(f"points are a set, a tool or indices 0 to {self.mesh.n_point - 1}, "
                             f"not {points!r}")
        return (indices + 1).tolist()

    def valued(self, points: Points, value: float | ArrayLike) -> list[tuple[str | int, float]]:
        """Targets and values; an array has an entry a point."""
        if np.ndim(value) == 0:
            return [(target, float(value)) for target in self.targets(points)]
        if isinstance(points, str):
            self.known(points, "point")
            points = self.mesh.point_sets[points]
        targets, values = self.targets(points), np.asarray(value, float)
        if values.shape != (len(targets),):
            raise ModelError(f"{len(targets)} points need as many values, not {values.shape}")
        return list(zip(targets, values.tolist()))

    def loads(self, points: Points, values: Mapping[str | int, float | ArrayLike]) -> list[Load]:
        """Loads on points by direction."""
        return [Load(target, self.dof(d), number) for d, value in values.items()
                for target, number in self.valued(points, value)]

    def to_deck(self) -> Deck:
        """The whole deck: readable, commented, ready to run by hand."""
        return write_model(self)

    def run(self, output: str | Path | None = None, **options):
        """Write the deck, solve it in this process and return a `Result`; see `lopin.run`."""
        return run(self, output, **options)

    def element_word(self, cell: str) -> str:
        """Element word of the deck: CPE4, C3D20..."""
        word = f"{_PREFIX[self.kind]}{_NODES[cell]}"
        return word + self.letters if self.letters in _LETTERS.get(cell, ()) else word

    def tool_directions(self) -> tuple[int, ...]:
        """All dofs of a reference node."""
        return (1, 2, 3, 4, 5, 6) if self.kind == "3d" else (1, 2, 6)

    def known(self, name: str, what: str) -> None:
        """Raise `ModelError` unless the mesh has this "element", "point" set or "surface"."""
        sets = {"element": self.mesh.element_sets, "point": self.mesh.point_sets,
                "surface": self.mesh.surfaces}[what]
        if name not in sets:
            raise ModelError(f"no {what} set '{name}' in the mesh",
                             help=f"{what} sets: {', '.join(sorted(sets)) or 'none'}")

    def known_amplitude(self, name: str) -> str:
        """The name of an amplitude that exists, or nothing."""
        if name and name not in self.amplitudes:
            raise ModelError(f"no amplitude '{name}'",
                             help=f"amplitudes: {', '.join(self.amplitudes) or 'none'}")
        return name

    def known_pair(self, pair: Pair | tuple[str, str | Tool]) -> Pair:
        """A pair of this model, by itself or by slave and master."""
        if isinstance(pair, Pair):
            pair = (pair.slave, pair.master)
        slave, master = pair
        master = master.name if isinstance(master, Tool) else master
        for known in self.contacts:
            if (known.slave, known.master) == (slave, master):
                return known
        pairs = ", ".join(f"{p.slave}-{p.master}" for p in self.contacts)
        raise ModelError(f"no contact pair {slave}-{master}", help=f"pairs: {pairs or 'none'}")

    def __repr__(self) -> str:
        tools = ", ".join(t.name for t in self.tools) or "none"
        return (f"Model({self.name!r}, {self.kind}, {np.size(self.mesh.points)} dofs, "
                f"{len(self.contacts)} contacts, tools {tools}, {len(self.steps)} steps)")
