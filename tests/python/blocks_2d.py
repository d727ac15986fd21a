"""Two blocks in the plane, one on the other, with meshes that need not match: decks for patch
tests."""
import numpy as np

from lopin.deck import Deck

YOUNG, NU = 1000.0, 0.3
#: Nodes of the cells by element word, per cell of the grid of corners: [(corner indices ...), ...].
QUADRATIC = {"CPE8", "CPE6", "CAX8", "CAX6"}
TRIANGLES = {"CPE3", "CPE6", "CAX3", "CAX6"}


class Block:
    """A grid of cells between `x` ticks and `y` ticks; labels start behind `first`."""

    def __init__(self, kind, x, y, first, name):
        self.name, self.kind = name, kind
        self.nodes, self.number, self.elements = [], {}, []
        self.first, self.first_element = first, first
        self.bottom, self.top, self.right, self.left = [], [], [], []
        for j in range(len(y) - 1):
            for i in range(len(x) - 1):
                a, b, c, d = ((x[i], y[j]), (x[i + 1], y[j]), (x[i + 1], y[j + 1]),
                              (x[i], y[j + 1]))
                cells = [(a, b, c), (a, c, d)] if kind in TRIANGLES else [(a, b, c, d)]
                labels = [self.add(cell) for cell in cells]
                faces = ((labels[0], 1), (labels[-1], 2)) if kind in TRIANGLES else ((labels[0], 1),
                                                                                     (labels[0], 3))
                if j == 0:
                    self.bottom.append(faces[0])
                sides = ((labels[0], 2), (labels[-1], 3)) if kind in TRIANGLES else ((labels[0], 2),
                                                                                     (labels[0], 4))
                if i == len(x) - 2:
                    self.right.append(sides[0])
                if i == 0:
                    self.left.append(sides[1])
                if j == len(y) - 2:
                    self.top.append(faces[1])

    def add(self, corners):
        corners = [np.array(c, float) for c in corners]
        points = list(corners)
        if self.kind in QUADRATIC:
            points += [0.5*(a + b) for a, b in zip(corners, corners[1:] + corners[:1])]
        self.elements.append([self.node(p) for p in points])
        return self.first_element + len(self.elements)

    def node(self, point):
        key = tuple(np.round(point, 9))
        if key not in self.number:
            self.nodes.append(np.asarray(point))
            self.number[key] = self.first + len(self.nodes)
        return self.number[key]

    @property
    def x(self):
        return np.array(self.nodes)

    def where(self, test):
        return [self.first + 1 + i for i, p in enumerate(self.nodes) if test(p)]


def ticks(a, b, n, seed=0, uneven=0.0):
    t = np.linspace(a, b, n + 1)
    t[1:-1] += uneven*(b - a)/n*np.random.default_rng(seed).uniform(-1, 1, n - 1)
    return t


class Pair:
    """A lower block of 10 by 4 and an upper one on it, from `left` to `right`."""

    def __init__(self, kind="CPE4", lower=3, upper=4, layers=2, left=0.0, right=10.0, inner=0.0,
                 uneven=0.0, kinds=None):
        low, up = kinds or (kind, kind)
        self.height = 4.0
        self.low = Block(low, inner + ticks(0.0, 10.0, lower, 1, uneven), ticks(0.0, 4.0, layers),
                         0, "LOW")
        self.up = Block(up, inner + ticks(left, right, upper, 2, uneven), ticks(4.0, 8.0, layers),
                        5000, "UP")
        self.bodies = (self.low, self.up)
        self.inner, self.left, self.right = inner, left + inner, right + inner
        self.lines, self.loads = [], []
        self.turn, self.young, self.full = np.eye(2), (YOUNG, YOUNG), False
        self.axisymmetric = low.startswith("CAX")
        self.thickness = 1.0

    def turned(self, degrees):
        a = np.radians(degrees)
        self.turn = np.array([[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]])
        return self

    def pressed(self, pressure=1.0, held=True):
        """A pressure above, rollers below, and on the free part of the lower block the same
        pressure."""
        self.lines += ["*BOUNDARY", "LOW_BASE, 2"]
        if not self.axisymmetric:
            self.lines += ["LOW_PIN, 1", *(["UP_PIN, 1"] if held else [])]
        elif self.inner == 0.0:
            self.lines += ["LOW_AXIS, 1", "UP_AXIS, 1"]
        self.loads += ["*DSLOAD", f"UP_TOP, P, {pressure}"]
        force = self.free_part(pressure)
        if force:
            self.loads += ["*CLOAD", *(f"{label}, 2, {value!r}" for label, value in force.items())]
        return self

    def sheared(self, shear):
        """A uniform shear stress, by tractions on all faces but the two of the interface."""
        for name, along in (("UP_TOP", (1.0, 0.0)), ("UP_RIGHT", (0.0, 1.0)),
                            ("UP_LEFT", (0.0, -1.0)),
                            ("LOW_RIGHT", (0.0, 1.0)), ("LOW_LEFT", (0.0, -1.0)),
                            ("LOW_BOTTOM", (-1.0, 0.0))):
            x, y = (float(v) for v in self.turn @ np.array(along))
            self.loads += ["*DSLOAD", f"{name}, TRVEC, {shear!r}, {x!r}, {y!r}, 0."]
        return self

    def free_part(self, pressure):
        """Consistent forces of a pressure on the part of the lower block that the upper leaves
        free."""
        force = {}
        points, weights = np.polynomial.legendre.leggauss(5)
        for label, _ in self.low.top:
            nodes = self.low.elements[label - self.low.first_element - 1]
            above = [n for n in nodes if abs(self.low.x[n - 1 - self.low.first][1] - 4.0) < 1e-9]
            above.sort(key=lambda n: self.low.x[n - 1 - self.low.first][0])
            x = np.array([self.low.x[n - 1 - self.low.first][0] for n in above])
            for a, b in ((x[0], min(x[-1], self.left)), (max(x[0], self.right), x[-1])):
                if b - a < 1e-12:
                    continue
                for t, w in zip(0.5*(a + b) + 0.5*(b - a)*points, 0.5*(b - a)*weights):
                    for k, n in enumerate(above):
                        shape = np.prod([(t - x[m])/(x[k] - x[m]) for m in range(len(x)) if m != k])
                        force[n] = force.get(n, 0.0) - float(pressure*w*shape*self.thickness)
        return force

    def deck(self, slave="upper", words="TYPE=SURFACE TO SURFACE", behaviour="DIRECT", tie=False,
             friction=None):
        out = ["*HEADING", "Two blocks", "*NODE"]
        for body in self.bodies:
            out += [f"{body.first + 1 + i}, " + ", ".join(repr(float(v)) for v in self.turn @ p)
                    for i, p in enumerate(body.nodes)]
        for body, young in zip(self.bodies, self.young):
            out.append(f"*ELEMENT, TYPE={body.kind}, ELSET={body.name}")
            out += [f"{body.first_element + 1 + i}, " + ", ".join(map(str, e))
                    for i, e in enumerate(body.elements)]
            low, high = body.x.min(0), body.x.max(0)
            sets = {"BASE": body.where(lambda p, y=low[1]: abs(p[1] - y) < 1e-9),
                    "AXIS": body.where(lambda p: abs(p[0]) < 1e-9),
                    "PIN": body.where(lambda p, b=body, lo=low, hi=high: abs(p[0] - lo[0]) < 1e-9
                                      and
                                      abs(p[1] - (lo[1] if b is self.low else hi[1])) < 1e-9)}
            for name, members in sets.items():
                if members:
                    out += [f"*NSET, NSET={body.name}_{name}", *(f"{m}," for m in members)]
            for name, faces in (("TOP", body.top), ("BOTTOM", body.bottom), ("LEFT", body.left),
                                ("RIGHT", body.right)):
                out += [f"*SURFACE, NAME={body.name}_{name}", *(f"{e}, S{f}" for e, f in faces)]
            out += [f"*MATERIAL, NAME=M{body.name}", "*ELASTIC", f"{young!r}, {NU!r}"]
            if self.full:
                out += [f"*SECTION CONTROLS, NAME=C{body.name}, FORMULATION=FULL"]
            out += [f"*SOLID SECTION, ELSET={body.name}, MATERIAL=M{body.name}"
                    + (f", CONTROLS=C{body.name}" if self.full else "")]
            if not self.axisymmetric:
                out.append(f"{self.thickness!r},")
        if np.abs(self.turn - np.eye(2)).max() > 0:
            out += ["*NSET, NSET=EVERY", *(f"{b.first + 1 + i}," for b in self.bodies
                                           for i in range(len(b.nodes)))]
            out += ["*TRANSFORM, NSET=EVERY, TYPE=R",
                    ", ".join(repr(float(v)) for v in (*self.turn[:, 0], 0.0, *self.turn[:, 1],
                                                       0.0))]
        names = ("UP_BOTTOM", "LOW_TOP")[::1 if slave == "upper" else -1]
        if tie:
            out += [f"*TIE, NAME=GLUE{', ' + words if words else ''}", ", ".join(names)]
        else:
            out += ["*SURFACE INTERACTION, NAME=I", f"*SURFACE BEHAVIOR, {behaviour}",
                    *([] if friction is None else ["*FRICTION", friction]),
                    f"*CONTACT PAIR, INTERACTION=I, {words}", ", ".join(names)]
        out += [*self.lines, "*STEP", "*STATIC, DIRECT", "1., 1.", *self.loads]
        out += ["*EL PRINT, ELSET=LOW", "S", "*EL PRINT, ELSET=UP", "S", "*NODE FILE", "U",
                "*EL FILE", "S", "*CONTACT FILE", "CDIS, CSTR", "*END STEP"]
        return "\n".join(out) + "\n"

    def solve(self, solve, tmp_path, **words):
        path = tmp_path/"blocks.inp"
        path.write_text(self.deck(**words), encoding="utf-8")
        return solve(Deck.read(path))

    def stresses(self, result):
        """(points, 4): stresses on the axes of the blocks: xx, yy, zz, xy.

        Those of all integration points; of a run in this process those of the nodes, to full
        precision.
        """
        if not hasattr(result.source, "folder"):
            return self._on_axes(np.asarray(result["stress"]))
        text = next(result.source.folder.glob("*.dat")).read_text(encoding="utf-8")
        rows = []
        for table in text.split(" stresses (")[1:]:
            for line in table.splitlines()[2:]:
                if not line.strip():
                    break
                rows.append([float(v) for v in line.split()[2:6]])
        return self._on_axes(np.array(rows))

    def _on_axes(self, s):
        full = np.zeros((len(s), 2, 2))
        full[:, 0, 0], full[:, 1, 1], full[:, 0, 1], full[:, 1, 0] = s[:, 0], s[:, 1], s[:, 3], s[:, 3]
        full = self.turn.T @ full @ self.turn
        return np.column_stack([full[:, 0, 0], full[:, 1, 1], s[:, 2], full[:, 0, 1]])

    def stress_error(self, result, expected):
        return np.abs(self.stresses(result) - np.asarray(expected)).max()/np.abs(expected).max()
