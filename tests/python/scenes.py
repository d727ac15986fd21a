"""Small scenes as data, so that tests can scale, turn and renumber them before they become
decks."""
from __future__ import annotations

import copy
import json
import subprocess
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

METHODS = ("DIRECT", "PENALTY", "PERTURBED LAGRANGE", "AUGMENTED LAGRANGE")


@dataclass
class Scene:
    """A scene in N and mm; `length` and `modulus` scale all that has a unit when it is written."""

    kind: str                                     # element word
    nodes: dict = field(default_factory=dict)     # label: coordinates
    elements: dict = field(default_factory=dict)  # label: (set, nodes)
    nsets: dict = field(default_factory=dict)
    surfaces: dict = field(default_factory=dict)  # name: [(element, face)]
    materials: dict = field(default_factory=dict)  # element set: (E, nu)
    tool: list = field(default_factory=list)      # lines of *SURFACE, a number in < > is a length
    tool_type: str = ""
    reference: tuple = ()                         # label, coordinates
    pairs: list = field(default_factory=list)     # (slave, master)
    fixed: list = field(default_factory=list)     # lines of *BOUNDARY in the model
    moved: list = field(default_factory=list)     # (set, dof, length)
    pushed: list = field(default_factory=list)    # (set, dof, force)
    pressed: list = field(default_factory=list)   # (surface, pressure)
    method: str = "DIRECT"
    slope: float | None = None
    length: float = 1.0
    modulus: float = 1.0
    turn: np.ndarray | None = None
    increments: int = 1
    extra_model: str = ""
    extra_interaction: str = ""
    output: str = "*NODE FILE\nU, RF\n*EL FILE\nS\n*CONTACT FILE\nCDIS, CSTR\n"

    def but(self, **changes) -> Scene:
        """A copy with other fields. Places and nodes of elements are shared: nobody writes into them."""
        new = copy.copy(self)
        for name, value in vars(self).items():
            if isinstance(value, dict):
                value = {k: list(v) if isinstance(v, list) else v for k, v in value.items()}
            setattr(new, name, list(value) if isinstance(value, list) else value)
        for name, value in changes.items():
            setattr(new, name, value)
        return new

    @property
    def ndim(self) -> int:
        return 3 if self.kind.startswith("C3D") else 2

    def turned(self, x):
        x = np.asarray(x, float)
        return x if self.turn is None else self.turn @ x

    def tool_line(self, line: str) -> str:
        """A line of the tool: `word, x, y` with lengths; an oblique tool is turned through its
        axes."""
        word, *values = line.split(",")
        return ", ".join([word, *(repr(float(v)*self.length) for v in values)])

    def tool_lines(self) -> list[str]:
        if self.ndim == 3:
            # Origin, a point on local x, one on the generator: local y, the outside, is +z here.
            a, b, c = (self.turned(v)*self.length for v in ([0., 0, 0], [1., 0, 0], [0, -1., 0]))
            axes = [", ".join(repr(float(v)) for v in (*a, *b)),
                    ", ".join(repr(float(v)) for v in c)]
            return axes + [self.tool_line(line) for line in self.tool]
        if self.turn is None:
            return [self.tool_line(line) for line in self.tool]
        lines = []
        for line in self.tool:
            word, *values = line.split(",")
            points = np.array(values, float).reshape(-1, 2)
            lines.append(self.tool_line(",".join([word, *(repr(float(v)) for p in points
                                                          for v in self.turned(p))])))
        return lines

    def deck(self) -> str:
        """The text of the deck."""
        out = ["*HEADING", "A scene of the invariances", "*NODE, NSET=ALL"]
        out += [f"{k}, " + ", ".join(repr(float(v)) for v in self.turned(x)*self.length)
                for k, x in self.nodes.items()]
        for name in self.materials:
            out.append(f"*ELEMENT, TYPE={self.kind}, ELSET={name}")
            out += [f"{k}, " + ", ".join(map(str, n)) for k, (s, n) in self.elements.items()
                    if s == name]
        for name, members in self.nsets.items():
            out.append(f"*NSET, NSET={name}")
            out += [f"{k}," for k in members]
        for name, faces in self.surfaces.items():
            out.append(f"*SURFACE, NAME={name}")
            out += [f"{e}, S{f}" for e, f in faces]
        for name, (young, nu) in self.materials.items():
            out += [f"*MATERIAL, NAME=M{name}", "*ELASTIC", f"{young*self.modulus!r}, {nu!r}",
                    f"*SOLID SECTION, ELSET={name}, MATERIAL=M{name}"]
            if self.kind.startswith(("CPE", "CPS")):
                out.append(f"{self.length!r},")
        if self.tool:
            label, x = self.reference
            out += ["*NODE, NSET=REF", f"{label}, "
                    + ", ".join(repr(float(v)) for v in self.turned(x)*self.length),
                    f"*SURFACE, NAME=TOOL, TYPE={self.tool_type}", *self.tool_lines(),
                    "*RIGID BODY, ANALYTICAL SURFACE=TOOL, REF NODE=REF"]
        if self.turn is not None:
            q = np.eye(3)
            q[:self.ndim, :self.ndim] = self.turn
            out += ["*TRANSFORM, NSET=ALL, TYPE=R",
                    ", ".join(repr(float(v)) for v in (*q[:, 0], *q[:, 1]))]
        out += ["*SURFACE INTERACTION, NAME=I", f"*SURFACE BEHAVIOR, {self.method}"]
        if self.slope is not None and self.method != "DIRECT":
            out.append(f"{self.slope*self.modulus/self.length!r}")
        out += [self.extra_interaction.rstrip()] if self.extra_interaction else []
        for slave, master in self.pairs:
            out += ["*CONTACT PAIR, INTERACTION=I, TYPE=NODE TO SURFACE", f"{slave}, {master}"]
        out += [self.extra_model.rstrip()] if self.extra_model else []
        out += ["*BOUNDARY", *self.fixed, "*STEP, INC=1000", "*STATIC, DIRECT",
                f"{1.0/self.increments!r}, 1."]
        if self.moved:
            out += ["*BOUNDARY", *(f"{s}, {d}, {d}, {v*self.length!r}" for s, d, v in self.moved)]
        if self.pushed:
            force = self.modulus*self.length**2
            out += ["*CLOAD", *(f"{s}, {d}, {v*force!r}" for s, d, v in self.pushed)]
        if self.pressed:
            out += ["*DSLOAD", *(f"{s}, P, {v*self.modulus!r}" for s, v in self.pressed)]
        return "\n".join(out) + "\n" + self.output + "*END STEP\n"


def add_block(scene, name, cells, place, first=1, first_element=None):
    """A block of cells = (nx, ny[, nz]); `place` maps [0, 1]^d to the body. Returns labels by
    index."""
    shape = tuple(n + 1 for n in cells)
    labels = np.arange(first, first + int(np.prod(shape))).reshape(shape)
    for index in np.ndindex(shape):
        scene.nodes[int(labels[index])] = np.array(place(*(i/n for i, n in zip(index, cells))),
                                                   float)
    corners = [(0, 0), (1, 0), (1, 1), (0, 1)]
    number = {}
    label = first if first_element is None else first_element
    for index in np.ndindex(tuple(cells)):
        if len(cells) == 2:
            nodes = [labels[index[0] + a, index[1] + b] for a, b in corners]
        else:
            nodes = [labels[index[0] + a, index[1] + b, index[2] + c] for c in (0, 1)
                     for a, b in corners]
        scene.elements[label] = (name, [int(n) for n in nodes])
        number[index] = label
        label += 1
    return labels, number


def deformable() -> Scene:
    """Half of a crowned block pressed by a pressure on a block with other nodes."""
    s = Scene("CPE4")
    upper, up = add_block(s, "UPPER", (7, 5), lambda a, b: (8*a, (1 - b)*(8*a)**2/120 + 6*b))
    lower, low = add_block(s, "LOWER", (13, 5), lambda a, b: (12*a, -6 + 6*b), first=501)
    s.materials = {"UPPER": (20000.0, 0.3), "LOWER": (7000.0, 0.25)}
    s.nsets = {"BASE": lower[:, 0].tolist(), "LEFT": [*upper[0, :].tolist(),
                                                      *lower[0, 1:].tolist()]}
    s.surfaces = {"CROWN": [(up[i, 0], 1) for i in range(7)],
                  "FACE": [(low[i, 4], 3) for i in range(13)],
                  "TOP": [(up[i, 4], 3) for i in range(7)]}
    s.pairs = [("CROWN", "FACE")]
    s.fixed = ["BASE, 1, 2", "LEFT, 1"]
    s.pressed = [("TOP", 60.0)]
    return s


def sphere() -> Scene:
    """An axisymmetric block and a rigid sphere that moves into it."""
    s = Scene("CAX4")
    block, number = add_block(s, "BLOCK", (12, 8), lambda a, b: (10*a**1.4, -8 + 8*b))
    s.materials = {"BLOCK": (20000.0, 0.3)}
    s.nsets = {"BASE": block[:, 0].tolist(), "LEFT": block[0, 1:].tolist()}
    s.surfaces = {"FACE": [(number[i, 7], 3) for i in range(12)]}
    s.tool_type, s.tool = "SEGMENTS", ["START, 20., 20.", "CIRCL, 0., 0., 0., 20."]
    s.reference = (9001, (0.0, 20.0))
    s.pairs = [("FACE", "TOOL")]
    s.fixed = ["BASE, 1, 2", "LEFT, 1", "REF, 1", "REF, 6"]
    s.moved = [("REF", 2, -0.2)]
    return s


def floating() -> Scene:
    """The same sphere pushed by a force: nothing but contact holds it."""
    return sphere().but(moved=[], pushed=[("REF", 2, -20000.0)])


def corner() -> Scene:
    """A quarter of a crowned block on a rigid plane, in three dimensions."""
    s = Scene("C3D8")

    def place(a, b, c):
        x, y = 5*a, 4*b
        return x, y, (1 - c)*(x**2 + y**2)/90 + 4*c

    block, number = add_block(s, "BLOCK", (6, 5, 4), place)
    s.materials = {"BLOCK": (20000.0, 0.3)}
    s.nsets = {"TOP": block[:, :, -1].ravel().tolist(), "XZERO": block[0, :, :-1].ravel().tolist(),
               "YZERO": block[:, 0, :-1].ravel().tolist()}
    s.surfaces = {"CROWN": [(number[i, j, 0], 1) for i in range(6) for j in range(5)]}
    # The way of the profile is along local x with the outside (+z) on its left.
    s.tool_type, s.tool = "CYLINDER", ["START, -50., 0.", "LINE, 50., 0."]
    s.reference = (9001, (0.0, 0.0, 0.0))
    s.pairs = [("CROWN", "TOOL")]
    s.fixed = ["XZERO, 1", "YZERO, 2", "TOP, 1, 2", "REF, 1, 6"]
    s.moved = [("TOP", 3, -0.12)]
    return s


SCENES = {"deformable": deformable, "sphere": sphere, "floating": floating, "corner": corner}


def renumbered(scene: Scene, seed: int = 7) -> Scene:
    """Nodes and elements with other labels and in another order."""
    random = np.random.default_rng(seed)
    node = dict(zip(scene.nodes, (int(k) for k in random.permutation(len(scene.nodes)) + 101)))
    element = dict(zip(scene.elements, (int(k) for k in random.permutation(len(scene.elements))
                                        + 1)))
    new = scene.but()
    new.nodes = {node[k]: scene.nodes[k] for k in sorted(scene.nodes, key=node.get)}
    new.elements = {element[k]: (scene.elements[k][0], [node[n] for n in scene.elements[k][1]])
                    for k in sorted(scene.elements, key=element.get)}
    new.nsets = {k: [node[n] for n in random.permutation(v)] for k, v in scene.nsets.items()}
    new.surfaces = {k: [(element[v[i][0]], v[i][1]) for i in random.permutation(len(v))]
                    for k, v in scene.surfaces.items()}
    return new


def cycled(scene: Scene) -> Scene:
    """Every element begins with another of its nodes."""
    new = scene.but()
    shift = {k: k % 4 for k in scene.elements}
    for k, (name, nodes) in scene.elements.items():
        j = shift[k]
        new.elements[k] = (name, [n for i in range(0, len(nodes), 4) for n in nodes[i + j:i + 4]
                                  + nodes[i:i + j]])
    first_side = 3 if scene.ndim == 3 else 1
    new.surfaces = {name: [(e, f if f < first_side else (f - first_side - shift[e]) % 4
                            + first_side)
                           for e, f in faces] for name, faces in scene.surfaces.items()}
    return new


def oblique(ndim: int) -> np.ndarray:
    """37 degrees in the plane, or about an axis along no other."""
    c, s = np.cos(np.radians(37.0)), np.sin(np.radians(37.0))
    if ndim == 2:
        return np.array([[c, -s], [s, c]])
    k = np.array([1.0, -2.0, 0.5])/np.linalg.norm([1.0, -2.0, 0.5])
    cross = np.array([[0, -k[2], k[1]], [k[2], 0, -k[0]], [-k[1], k[0], 0]])
    return c*np.eye(3) + s*cross + (1 - c)*np.outer(k, k)


@dataclass
class Answer:
    """Numbers of a run without units."""

    values: dict
    counts: dict
    job: dict
    folder: Path
    stderr: str


def run(executable, text, folder, *options, environment=None, accept=(0,)):
    """Run a deck of this text; the process, the folder of results."""
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    deck = folder/"job.inp"
    deck.write_text(text, encoding="utf-8")
    process = subprocess.run([str(executable), "run", str(deck), "-o", str(folder/"out"),
                              "--overwrite", *options],
                             capture_output=True, text=True, timeout=60, env=environment)
    assert process.returncode in accept, process.stderr
    return process, folder/"out"


def history(folder) -> dict:
    """Columns of the history without their units."""
    head, *rows = (Path(folder)/"job_history.csv").read_text(encoding="utf-8").splitlines()
    table = np.array([[float(v) for v in row.split(",")] for row in rows])
    return {name.split(" [")[0]: table[:, i] for i, name in enumerate(head.split(","))}


def answer(executable, scene: Scene, folder, *options, accept=(0,), environment=None) -> Answer:
    """Run a scene and divide out its units."""
    process, out = run(executable, scene.deck(), folder, *options, accept=accept,
                       environment=environment)
    job = json.loads((out/"job.json").read_text(encoding="utf-8"))
    columns = history(out)
    force, energy = scene.modulus*scene.length**2, scene.modulus*scene.length**3
    values, counts = {}, {}
    for i, pair in enumerate(job["contact"]):
        values[f"{i}.force"] = np.linalg.norm(pair["force"])/force
        values[f"{i}.area"] = pair["area"]/scene.length**2
        values[f"{i}.pressure"] = pair["max_pressure"]/scene.modulus
        values[f"{i}.penetration"] = pair["max_penetration"]/scene.length
        counts[f"{i}.closed"] = pair["closed"]
    for name in ("strain", "contact", "external"):
        values[f"energy.{name}"] = job["energy"][name]/energy
    reaction = [v[-1] for k, v in columns.items() if k.startswith("TOOL.rf")
                and int(k[-1]) <= scene.ndim]
    if reaction:
        values["reaction"] = np.linalg.norm(reaction)/force
    counts["steps"] = job["steps"]
    return Answer(values, counts, job, out, process.stderr)


def difference(first: Answer, second: Answer, only=None, without=()) -> float:
    """Largest difference of the values, each over its own size; lengths over the depth that drives
    the scene."""
    worst = 0.0
    for name, a in first.values.items():
        if (only and name not in only) or name in without:
            continue
        b = second.values[name]
        size = max(abs(a), abs(b), floor(name, first))
        worst = max(worst, abs(a - b)/size if size > 0 else 0.0)
    return worst


def floor(name: str, one: Answer) -> float:
    """What a value that is round-off is compared with."""
    if name.endswith("penetration"):
        return 1e-2
    if name.startswith("energy"):
        return 1e-3*one.values["energy.strain"]
    return 0.0
