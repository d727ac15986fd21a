"""Blocks of any element word pressed and sheared on plane rigid tools: the stress is uniform, and so
must be the pressure of every slave node.

One deck holds a block for each method and orientation of its tool. A pressure presses the block on
its tool, the tool slides, and shear on the sides balances the moment of the drag, so that
sigma_zz = -p and sigma_xz = tau everywhere (nu = 0).
"""
import numpy as np

from lopin.mesh.cells import CELLS
from lopin.deck import Deck
from lopin.mesh import Mesh
from lopin.mesh_make import block, extruded, simplices

METHODS = ("DIRECT", "PENALTY", "PERTURBED LAGRANGE", "AUGMENTED LAGRANGE")
PRESSURE, SHEAR, YOUNG = 10.0, 2.0, 1.0e5
TICKS = np.array([0.0, 0.43, 1.0])


def turned(vector):
    """Rotation matrix of a rotation vector (2D: an angle)."""
    if np.ndim(vector) == 0:
        c, s = np.cos(vector), np.sin(vector)
        return np.array([[c, -s], [s, c]])
    angle = np.linalg.norm(vector)
    x, y, z = np.asarray(vector)/max(angle, 1e-300)
    w = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle)*w + (1.0 - np.cos(angle))*w @ w


#: How the block, its tool and its loads are turned.
ORIENTATIONS = {2: [0.0, 2.3, 0.6], 3: [(0.0, 0, 0), (0.4, -1.1, 0.7), (np.pi/2, 0, 0)]}


def is_solid(word) -> bool:
    """Of three dimensions."""
    return word.startswith(("C3D", "CSS"))


def nodes_of(word):
    return int("".join(c for c in word[3:] if c.isdigit()))


def is_quadratic(word):
    return nodes_of(word) in ((10, 15, 20) if is_solid(word) else (6, 8))


def family(word):
    """The linear cell of a word."""
    solid = {4: "tetra", 10: "tetra", 6: "wedge", 15: "wedge", 8: "hexahedron", 20: "hexahedron"}
    plane = {3: "triangle", 6: "triangle", 4: "quad", 8: "quad"}
    return (solid if is_solid(word) else plane)[nodes_of(word)]


def linear_block(cell, distorted):
    """A unit square or cube times (2, 2, 1.5); inner nodes of the horizontal planes moved."""
    plane = cell in ("triangle", "quad")
    mesh = block((2.0, 1.5), (2, 2), grading=(TICKS, TICKS)) if plane else \
        block((2.0, 2.0), (2, 2), grading=(TICKS, TICKS))
    if distorted:
        rng = np.random.default_rng(3)
        x = mesh.points.copy()
        high = 1.5 if plane else 2.0
        inner = (x[:, 0] > 0.1) & (x[:, 0] < 1.9) & (x[:, 1] < high - 0.1)
        inner &= (x[:, 1] > 0.1)
        x[inner] += rng.uniform(-0.12, 0.12, (inner.sum(), 2))
        mesh = mesh.mapped(lambda _: x)
    if cell in ("triangle", "wedge"):
        mesh = simplices(mesh)
    if not plane:
        mesh = extruded(mesh, 1.5, 1)
    return simplices(mesh) if cell == "tetra" else mesh


def block_of(word, distorted=False) -> Mesh:
    """The block of a word, base at z = 0 (y = 0 in the plane)."""
    mesh = linear_block(family(word), distorted)
    return mesh.quadratic() if is_quadratic(word) else mesh


class Lines:
    """A deck as it is written."""

    def __init__(self):
        self.text, self.node, self.element = [], 0, 0

    def add(self, *lines):
        self.text += lines

    def mesh(self, mesh, word, name):
        """Nodes, elements, sets and surfaces of a block, all with its name in front."""
        first, first_element = self.node + 1, self.element + 1
        self.add(f"*NODE, NSET={name}N")
        self.add(*(f"{first + i}, " + ", ".join(repr(float(v)) for v in x)
                   for i, x in enumerate(mesh.points)))
        self.add(f"*ELEMENT, TYPE={word}, ELSET={name}E")
        for cell, cells in mesh.blocks:
            for row in cells:
                self.element += 1
                self.add(f"{self.element}, " + ", ".join(str(first + int(n)) for n in row))
        for side, members in mesh.point_sets.items():
            self.add(f"*NSET, NSET={name}{side}", *(f"{first + int(n)}," for n in members))
        for side, rows in mesh.surfaces.items():
            self.add(f"*SURFACE, NAME={name}S{side}",
                     *(f"{first_element + int(e)}, S{int(f)}" for e, f in rows))
        self.node += mesh.n_point


def numbers(values):
    return ", ".join(repr(float(v)) for v in values)


def plane_tool(lines, name, q):
    """A plane through the origin, its outside along the last axis turned by q."""
    d = len(q)
    lines.node += 1
    lines.add(f"*NODE, NSET={name}P", f"{lines.node}, {numbers(np.zeros(d))}")
    if d == 2:
        ends = [q @ np.array([x, 0.0]) for x in (-9.0, 9.0)]
        lines.add(f"*SURFACE, NAME={name}T, TYPE=SEGMENTS", f"START, {numbers(ends[0])}",
                  f"LINE, {numbers(ends[1])}")
    else:
        # Origin, a point on local x, one on the generator: local y is the outside.
        lines.add(f"*SURFACE, NAME={name}T, TYPE=CYLINDER",
                  numbers([*np.zeros(3), *q[:, 0]]), numbers(-q[:, 1]),
                  "START, -9., 0.", "LINE, 9., 0.")
    lines.add(f"*RIGID BODY, ANALYTICAL SURFACE={name}T, REF NODE={lines.node}")


def cases(word, methods=METHODS):
    """(name, method, rotation) of the blocks of a deck."""
    d = 3 if is_solid(word) else 2
    return [(f"{'DPLA'[m]}{k}", method, turned(vector)) for m, method in enumerate(methods)
            for k, vector in enumerate(ORIENTATIONS[d])]


def patch_deck(word, path, distorted=False, bend=None, methods=METHODS) -> Deck:
    """The deck of a plane or solid word; `path` is FINITE or empty."""
    lines, mesh = Lines(), block_of(word, distorted)
    if bend:
        mesh = mesh.mapped(bend)
    d, held, sides, shears = mesh.ndim, [], [], []
    lines.add("*HEADING", f"Blocks of {word} on plane tools",
              *([f"*LOPIN, PATH={path}"] if path else []),
              "*MATERIAL, NAME=M", "*ELASTIC", f"{YOUNG!r}, 0.")
    for name, method, q in cases(word, methods):
        lines.mesh(mesh.mapped(lambda x, q=q: x @ q.T), word, name)
        lines.add(f"*SOLID SECTION, ELSET={name}E, MATERIAL=M", *(["1.,"] if d == 2 else []))
        plane_tool(lines, name, q)
        turn = np.eye(3)
        turn[:d, :d] = q
        lines.add(f"*TRANSFORM, NSET={name}N, TYPE=R", numbers([*turn[:, 0], *turn[:, 1]]),
                  f"*SURFACE INTERACTION, NAME={name}I", f"*SURFACE BEHAVIOR, {method}",
                  "*FRICTION", "0.,",
                  f"*CONTACT PAIR, INTERACTION={name}I", f"{name}SBOTTOM, {name}T")
        held += [f"{name}TOP, 1, {d - 1}", f"{name}P, 1, {3 if d == 2 else 6}".replace(", 3", ", 2")]
        held += [f"{name}P, 6"] if d == 2 else []
        up, along = q[:, -1], q[:, 0]
        sides += [f"{name}STOP, P, {PRESSURE!r}"]
        shears += [f"{name}S{side}, TRVEC, {sign*SHEAR!r}, {numbers([*up, 0.0][:3])}"
                   for side, sign in (("RIGHT", -1.0), ("LEFT", 1.0))]
        shears += [(f"{name}P", float(way)) for way in along]
    boundary = [s for s in shears if isinstance(s, tuple)]
    slide = [line for name, *_ in cases(word, methods) for line in
             (f"*CHANGE FRICTION, INTERACTION={name}I", f"*FRICTION, TAUMAX={SHEAR!r}", "0.3,")]
    lines.add("*BOUNDARY", *held, "*STEP, INC=100", "*STATIC, DIRECT", "1., 1.",
              "*DSLOAD", *sides, "*CONTACT FILE", "CDIS, CSTR", "*END STEP",
              "*STEP, INC=100", "*STATIC, DIRECT", "1., 1.", *slide, "*BOUNDARY",
              *(f"{n}, {i % d + 1}, {i % d + 1}, {v!r}" for i, (n, v) in enumerate(boundary)),
              "*DSLOAD", *(s for s in shears if isinstance(s, str)), "*CONTACT FILE", "CDIS, CSTR",
              "*END STEP")
    return Deck.parse("\n".join(lines.text) + "\n", name=f"patch_{word.lower()}_{path.lower()}")


def errors(result, word, methods=METHODS):
    """Worst error of any pressure, and of the normal and tangential force of any tool; relative."""
    d = 3 if is_solid(word) else 2
    area = 2.0 if d == 2 else 4.0
    pressure, normal, drag = [], [], []
    for k, (name, _, q) in enumerate(cases(word, methods)):
        contact = result.contact(k).last
        pressure.append(np.abs(contact.pressure/PRESSURE - 1.0).max())
        force = q.T @ np.array([result.history[f"{name}T.rf{i + 1}"][-1] for i in range(d)])
        normal.append(abs(abs(force[-1])/(PRESSURE*area) - 1.0))
        drag.append(np.linalg.norm(force[:-1] - [SHEAR*area, 0.0][:d - 1])/(SHEAR*area))
    return np.array([pressure, normal, drag])


def bent(word):
    """Mid-side nodes of a block moved along its slave face: curved edges, a plane face."""
    corners = linear_block(family(word), True).n_point

    def bend(x):
        new = x.copy()
        free = np.arange(len(x)) >= corners
        free &= (x[:, :-1] > 1e-9).all(axis=1) & (x[:, :-1] < 2.0 - 1e-9).all(axis=1)
        shift = np.random.default_rng(5).uniform(-0.06, 0.06, x[:, :-1].shape)
        # The same for all heights, so that vertical faces stay vertical.
        new[free, :-1] += shift[free]
        return new

    return bend


def free_deck(word, path, bend) -> Deck:
    """A distorted block of a solid word between two pressures, without contact; it may widen."""
    lines, mesh = Lines(), block_of(word, True).mapped(bend)
    lines.add("*HEADING", f"A block of {word}", *([f"*LOPIN, PATH={path}"] if path else []),
              "*MATERIAL, NAME=M", "*ELASTIC", f"{YOUNG!r}, 0.3")
    lines.mesh(mesh, word, "B")
    corner = {p: int(np.linalg.norm(mesh.points - p, axis=1).argmin()) + 1
              for p in [(0, 0, 0), (2, 0, 0), (0, 2, 0)]}
    lines.add("*SOLID SECTION, ELSET=BE, MATERIAL=M", "*BOUNDARY", f"{corner[0, 0, 0]}, 1, 3",
              f"{corner[2, 0, 0]}, 2, 3", f"{corner[0, 2, 0]}, 3", "*STEP", "*STATIC, DIRECT",
              "1., 1.", "*DSLOAD", f"BSTOP, P, {PRESSURE!r}", f"BSBOTTOM, P, {PRESSURE!r}",
              "*EL FILE", "S", "*END STEP")
    return Deck.parse("\n".join(lines.text) + "\n", name=f"free_{word.lower()}")


def ring_deck(word, path, bend=None) -> Deck:
    """Solid cylinders of an axisymmetric word: pressed down, pressed up, and set into a bore.

    In the bore, narrower by 0.01, the strain is -0.01/2 in all directions of the plane.
    """
    mesh = block_of(word, distorted=False)
    if bend is not None:
        mesh = mesh.mapped(bend)
    lines = Lines()
    lines.add("*HEADING", f"Cylinders of {word} on tools", *([f"*LOPIN, PATH={path}"] if path else []),
              "*MATERIAL, NAME=M", "*ELASTIC", f"{YOUNG!r}, 0.")
    held, pressed = [], []
    places = {"0": ("BOTTOM", "TOP", ["START, 0., 0.", "LINE, 9., 0."]),
              "1": ("TOP", "BOTTOM", ["START, 9., 1.5", "LINE, 0., 1.5"]),
              "2": ("RIGHT", "", ["START, 1.99, -5.", "LINE, 1.99, 5."])}
    for m, method in enumerate(METHODS):
        for k, (slave, loaded, tool) in places.items():
            name = f"{'DPLA'[m]}{k}"
            lines.mesh(mesh, word, name)
            lines.node += 1
            lines.add(f"*SOLID SECTION, ELSET={name}E, MATERIAL=M", f"*NODE, NSET={name}P",
                      f"{lines.node}, 0., 0.", f"*SURFACE, NAME={name}T, TYPE=SEGMENTS", *tool,
                      f"*RIGID BODY, ANALYTICAL SURFACE={name}T, REF NODE={lines.node}",
                      f"*SURFACE INTERACTION, NAME={name}I", f"*SURFACE BEHAVIOR, {method}",
                      f"*CONTACT PAIR, INTERACTION={name}I", f"{name}S{slave}, {name}T",
                      f"*CONTACT CONTROLS, MASTER={name}T, SLAVE={name}S{slave}, "
                      "INITIAL=INTERFERENCE")
            held += [f"{name}P, 1, 2", f"{name}P, 6", f"{name}LEFT, 1"]
            held += [f"{name}BOTTOM, 2"] if k == "2" else []
            pressed += [f"{name}S{loaded}, P, {PRESSURE!r}"] if loaded else []
    lines.add("*BOUNDARY", *held, "*STEP, INC=100", "*STATIC, DIRECT", "1., 1.", "*DSLOAD", *pressed,
              "*CONTACT FILE", "CDIS, CSTR", "*END STEP")
    return Deck.parse("\n".join(lines.text) + "\n", name=f"rings_{word.lower()}_{path.lower()}")


def ring_errors(result):
    """Worst error of a pressure, and of a force; relative. A penalty is soft in the bore: there
    pressures are compared with their mean. The area of the bore may be that of the end."""
    pressure, force = [], []
    for k in range(12):
        contact, method = result.contact(k).last, METHODS[k//3]
        p, weight = contact.pressure.ravel(), contact["WEIGHT"].ravel()
        if k % 3 < 2:
            pressure.append(np.abs(p/PRESSURE - 1.0).max())
            name = f"{'DPLA'[k//3]}{k % 3}T"
            force.append(abs(abs(result.history[f"{name}.rf2"][-1])/(PRESSURE*4.0*np.pi) - 1.0))
        else:
            pressure.append(np.abs(p/p.mean() - 1.0).max())
            if method not in METHODS[1:3]:
                force.append(abs((p*weight).sum()/(YOUNG*0.5e-2*6.0*np.pi) - 1.0))
    return np.array([max(pressure), max(force)])


def upset_deck(word, increments=6) -> Deck:
    """A block of metal upset by 30 % between a plane tool and its base, without friction."""
    mesh, lines = block_of(word), Lines()
    d = mesh.ndim
    lines.add("*HEADING", f"Upsetting of {word}", "*MATERIAL, NAME=M", "*ELASTIC", "200000., 0.3",
              "*PLASTIC", "200., 0.", "400., 2.")
    lines.mesh(mesh, word, "B")
    lines.add("*SOLID SECTION, ELSET=BE, MATERIAL=M", *(["1.,"] if word[:2] == "CP" else []))
    lines.node += 1
    lines.add("*NODE, NSET=P", f"{lines.node}, {numbers(np.zeros(d))}")
    if d == 2:
        lines.add("*SURFACE, NAME=TOOL, TYPE=SEGMENTS", "START, 9., 1.5", "LINE, -9., 1.5")
    else:
        lines.add("*SURFACE, NAME=TOOL, TYPE=CYLINDER", "0., 0., 1.5, 1., 0., 1.5", "0., -1., 1.5",
                  "START, 9., 0.", "LINE, -9., 0.")
    held = ["BLEFT, 1", f"BBOTTOM, {d}", f"P, 1, {d - 1}"]
    held += ["P, 6"] if d == 2 else ["BFRONT, 2", "P, 4, 6"]
    lines.add(f"*RIGID BODY, ANALYTICAL SURFACE=TOOL, REF NODE={lines.node}",
              "*SURFACE INTERACTION, NAME=I", "*CONTACT PAIR, INTERACTION=I", "BSTOP, TOOL",
              "*BOUNDARY", *held, "*STEP, NLGEOM, INC=200", "*STATIC", f"{1.0/increments!r}, 1.",
              "*BOUNDARY", f"P, {d}, {d}, -0.45", "*CONTACT FILE", "CDIS, CSTR", "*END STEP")
    return Deck.parse("\n".join(lines.text) + "\n", name=f"upset_{word.lower()}")
