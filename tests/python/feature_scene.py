"""Decks of blocks on tools, in a few lines each: what the tests of features are written with."""
from __future__ import annotations

import json
import math
import subprocess
from itertools import product

import numpy as np

E, W, H = 1000.0, 2.0, 1.0
K = E*W/H                                  # stiffness of a block without Poisson's effect


class Scene:
    """Lines of a deck; blocks are grids with sets and surfaces named after their sides."""

    def __init__(self, young=1000.0, poisson=0.0, element="CPS4"):
        self.head = ["*HEADING", "feature"]
        self.element, self.nodes, self.elements = element, {}, 0
        self.material(young, poisson)

    def material(self, young, poisson=0.0, name="M"):
        self.head += [f"*MATERIAL, NAME={name}", "*ELASTIC", f"{young!r}, {poisson!r}"]

    def block(self, name, low, high, boxes, material="M", turn=0.0):
        """A grid; node sets NAME_LEFT, _RIGHT, _BOTTOM, _TOP (and _BACK, _FRONT) and surfaces
        NAME_S1..."""
        d = len(low)
        label = {}
        axes = [np.linspace(low[i], high[i], boxes[i] + 1) for i in range(d)]
        c, s = math.cos(turn), math.sin(turn)
        lines = []
        for key in product(*(range(b + 1) for b in boxes)):
            x = [axes[i][key[i]] for i in range(d)]
            if turn:
                x[0], x[1] = c*x[0] - s*x[1], s*x[0] + c*x[1]
            label[key] = len(self.nodes) + 1
            self.nodes[label[key]] = tuple(x)
            lines.append(f"{label[key]}, " + ", ".join(repr(float(v)) for v in x))
        self.head += [f"*NODE, NSET={name}"] + lines
        corner = [(0, 0), (1, 0), (1, 1), (0, 1)] if d == 2 else \
            [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
        kind = self.element if d == 2 else "C3D8"
        self.head.append(f"*ELEMENT, TYPE={kind}, ELSET={name}")
        of = {}
        for key in product(*(range(b) for b in boxes)):
            self.elements += 1
            of[key] = self.elements
            self.head.append(f"{self.elements}, " + ", ".join(
                str(label[tuple(k + o for k, o in zip(key, offset))]) for offset in corner))
        self.head += [f"*SOLID SECTION, ELSET={name}, MATERIAL={material}"]
        if d == 2:
            self.head.append("1.,")
        sides = {"LEFT": (0, 0), "RIGHT": (0, boxes[0]), "BOTTOM": (1, 0), "TOP": (1, boxes[1])}
        faces = {"LEFT": 4, "RIGHT": 2, "BOTTOM": 1, "TOP": 3}
        if d == 3:
            sides |= {"BACK": (2, 0), "FRONT": (2, boxes[2])}
            faces = {"LEFT": 6, "RIGHT": 4, "BOTTOM": 3, "TOP": 5, "BACK": 1, "FRONT": 2}
        for side, (axis, at) in sides.items():
            self.head += [f"*NSET, NSET={name}_{side}"]
            self.head += [f"{label[k]}," for k in label if k[axis] == at]
            self.head += [f"*SURFACE, NAME={name}_{side}"]
            self.head += [f"{of[k]}, S{faces[side]}" for k in of if k[axis] == (at and at - 1)]
        return label

    def node(self, x, nset):
        label = len(self.nodes) + 1
        self.nodes[label] = tuple(x)
        self.head += [f"*NODE, NSET={nset}", f"{label}, " + ", ".join(repr(float(v)) for v in x)]
        return label

    def tool(self, name, reference, segments):
        """A polyline tool on its reference node (node set NAME_REF)."""
        self.node(reference, f"{name}_REF")
        self.head += [f"*SURFACE, NAME={name}, TYPE=SEGMENTS", "START, " + _numbers(segments[0])]
        self.head += ["LINE, " + _numbers(p) for p in segments[1:]]
        self.head += [f"*RIGID BODY, ANALYTICAL SURFACE={name}, REF NODE={name}_REF"]

    def add(self, text):
        self.head += [line.strip() for line in text.strip().splitlines()]

    def pair(self, slave, master, behavior="", words="", name=None):
        name = name or f"I{sum('SURFACE INTERACTION' in h for h in self.head)}"
        self.head += [f"*SURFACE INTERACTION, NAME={name}"]
        if behavior:
            self.add(behavior)
        self.head += [f"*CONTACT PAIR, INTERACTION={name}{', ' + words if words else ''}",
                      f"{slave}, {master}"]

    def step(self, text, increments="1., 1.", words="", step_words=""):
        self.head += [f"*STEP{step_words}", f"*STATIC{words}", increments]
        self.add(text)
        self.head += ["*NODE FILE", "U, RF", "*EL FILE", "S", "*CONTACT FILE", "CDIS, CSTR",
                      "*END STEP"]

    @property
    def text(self):
        return "\n".join(self.head) + "\n"


def _numbers(values):
    return ", ".join(repr(float(v)) for v in values)


class Outcome:
    """What a run of the executable left: exit code, messages, history, fields."""

    def __init__(self, folder, code, output):
        self.code, self.output = code, output
        found = sorted(folder.glob("*.json"))
        self.summary = json.loads(found[0].read_text()) if found else {}
        self.folder = folder
        self._source = None

    @property
    def source(self):
        if self._source is None:
            from lopin.folder import Folder
            self._source = Folder(self.folder)
        return self._source

    @property
    def history(self):
        return self.source.history()

    def field(self, name, index=-1):
        return self.source.field(name, index % len(self.source.times))

    def u(self, label, index=-1):
        return self.field("U", index)[label - 1]

    def contact(self, index=-1, pair=0):
        return self.source.contact(self.source.pairs()[pair], index % len(self.source.times))

    def ids(self):
        return [d.get("code") or d.get("id") for d in self.summary.get("diagnostics", [])]

    def message(self, code):
        return "\n".join(d["message"] for d in self.summary.get("diagnostics", [])
                         if (d.get("code") or d.get("id")) == code)


def run(executable, folder, scene, name="feature"):
    """Run a scene or a deck's text."""
    folder.mkdir(parents=True, exist_ok=True)
    deck = folder/f"{name}.inp"
    deck.write_text(scene if isinstance(scene, str) else scene.text, encoding="utf-8")
    done = subprocess.run([str(executable), "run", str(deck), "-o", str(folder/"out"),
                           "--overwrite", "--no-color"], capture_output=True, text=True, timeout=60)
    return Outcome(folder/"out", done.returncode, done.stdout + done.stderr)


def bar(gap=0.0, behavior="", words="", extra="", load=None, **step):
    """A block over a fixed tool, held at its top edge's spring side: the bottom row moves freely in
    y.

    The top is fixed; forces on the bottom row push it down onto the floor at a distance `gap`.
    """
    s = Scene(E)
    s.block("B", (0, 0), (W, H), (2, 1))
    s.tool("FLOOR", (0, -1), [(-3, -gap), (5, -gap)])
    s.pair("B_BOTTOM", "FLOOR", behavior, words)
    s.add("*BOUNDARY\nB, 1\nB_TOP, 2\nFLOOR_REF, 1, 2\nFLOOR_REF, 6")
    if extra:
        s.add(extra)
    if load is not None:
        s.step(f"*CLOAD\n1, 2, {-load/4}\n3, 2, {-load/2}\n5, 2, {-load/4}", **step)
    return s


def two_blocks(low=2, up=2, behavior="", words="", gap=0.0, poisson=0.3, shift=0.0, extra=""):
    s = Scene(E, poisson)
    s.block("LOW", (0, 0), (W, H), (low, 1))
    s.block("UP", (shift, H + gap), (W + shift, 2*H + gap), (up, 1))
    s.pair("UP_BOTTOM", "LOW_TOP", behavior, words)
    if extra:
        s.add(extra)
    return s
