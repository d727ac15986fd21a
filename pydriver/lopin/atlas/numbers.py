"""Maps whose cells are decks with one number, beside its closed form or a run in small increments.

Map 7: length of increments by friction. Map 8: regularised friction. Map 11: metals and rubbers
that keep their volume. Map 13: Norton and Hoff's flow.
"""
from __future__ import annotations

from functools import cache
from math import atan, cos, pi, sin, sqrt, tan, tanh

import numpy as np
from numpy.typing import NDArray

from ..charts.cases import with_elements
from ..charts.run import WRONG, light
from ..deck import Deck
from ..errors import NotConvergedError, SingularError
from ..friction import Coulomb
from ..laws import Elastic
from ..materials import Material, NortonHoff
from ..mesh import make as mesh_make
from ..model import Model
from ..profile import arc, plane, start
from ..result import Result
from ..run import run
from .cells import Outcome, refusal
from .scenes import PLAIN, Frame


#: Share of the bound that a regularisation gives at so many times u0 or v0.
REGULARISED = {"arctan": lambda s: 2.0/pi*atan(s), "tanh": tanh,
               "sqrt": lambda s: s/sqrt(1.0 + s*s)}


class NumberMap:
    """Runs the deck of a cell and compares `value` with `exact`, both in the plain frame."""

    colour, across, linear = "error", 4, True

    def frame(self, rng: np.random.Generator) -> Frame:
        """Other units; supports of these scenes cannot be turned."""
        return Frame(0.0, float(10.0**rng.uniform(-3.0, 3.0)), float(10.0**rng.uniform(-3.0, 6.0)))

    def deck(self, panel: str, x: float, y: float, frame: Frame = PLAIN) -> Deck:
        """The deck of a cell."""
        raise NotImplementedError

    def value(self, panel: str, result: Result, frame: Frame) -> NDArray:
        """What is compared."""
        raise NotImplementedError

    def exact(self, panel: str, x: float, y: float) -> NDArray:
        """What it should be."""
        raise NotImplementedError

    def solve(self, panel: str, x: float, y: float, frame: Frame = PLAIN) -> Outcome:
        """What happens in a cell."""
        try:
            result = run(self.deck(panel, x, y, frame))
        except (NotConvergedError, SingularError) as problem:
            return Outcome(refusal(problem.id), said=problem.id)
        right = np.atleast_1d(self.exact(panel, x, y))
        found = np.atleast_1d(self.value(panel, result, frame))
        error = float(np.abs(found - right).max()/np.abs(right).max())
        told = [w.partition(":")[0] for w in result.warnings]
        iterations = sum(step["iterations"] for step in result.summary["steps"])
        said = " ".join([result.verdict, *told])
        if not np.isfinite(error):
            return Outcome("F4", error, iterations, said)
        wrong = "F1" if result.verdict == "PASS" and not told else "W"
        return Outcome("F0" if error <= WRONG else wrong, error, iterations, said)

    def theory(self, panel: str) -> list[tuple[str, NDArray, NDArray]]:
        """No borders are known."""
        return []


def _reaction(result: Result, tool: str, stress: float, length: float) -> NDArray:
    """Force on a tool at the end, in the plain frame."""
    history = result.history
    return np.array([history[f"{tool}.rf{d}"][-1] for d in (1, 2)])/(stress*length)


class IncrementMap(NumberMap):
    """An arc is pressed on an elastic slab and drawn along it: length of an increment by mu."""

    number, name = 7, "increments"
    title = "Map 7: increments of an arc that is drawn along a slab; beside increments of h/10"
    labels = ("increment / facet", r"$\mu$")
    panels = ("CPE4", "CPE4I", "CPE8R", "CPE4, facets")
    SIZE, WAY, DEPTH, RADIUS = 0.25, 2.0, 0.03, 2.0

    def grid(self, panel: str, small: bool) -> tuple[NDArray, NDArray]:
        """The values of x and y."""
        if small:
            return np.array([8.0]), np.array([0.3])[:0 if panel[3] != "4" or "I" in panel else 1]
        return np.array([0.2, 0.5, 1.0, 2.0, 4.0, 8.0]), np.array([0.0, 0.05, 0.1, 0.2, 0.3, 0.5])

    def deck(self, panel: str, x: float, y: float, frame: Frame = PLAIN) -> Deck:
        word, _, tool = panel.partition(", ")
        u = frame.length
        model = Model("draw", mesh_make.block((6.0*u, 1.5*u), (24, 6), origin=(-3.0*u, -1.5*u)))
        model.section("ALL", Elastic(1000.0*frame.stress, 0.3))
        profile = arc((-1.0*u, self.RADIUS*u), self.RADIUS*u, 220.0, 320.0) if not tool else \
            _polygon(self.RADIUS*u, -1.0*u)
        die = model.rigid_tool("DIE", profile, ref=(-1.0*u, 0.0))
        model.contact("TOP", die, friction=y or None)
        model.fix("BOTTOM", "x", "y")
        model.step(4, nlgeom=True).move(die, y=-self.DEPTH*u)
        count = max(1, round(self.WAY/(x*self.SIZE)))
        model.step(count, nlgeom=True).move(die, x=self.WAY*u)
        return _with_word(model.to_deck(), word)

    def value(self, panel: str, result: Result, frame: Frame) -> NDArray:
        return _reaction(result, "DIE", frame.stress, frame.length)

    @cache
    def exact(self, panel: str, x: float, y: float) -> NDArray:
        return self.value(panel, run(self.deck(panel, 0.1, y)), PLAIN)


class RegularisedMap(NumberMap):
    """A shoe on a plate: V0 over the speed, or u0 over the slip, by mu; a held load creeps."""

    number, name = 8, "regularisation"
    title = "Map 8: friction without stick; its own law is the exact solution"
    labels = (r"$v_0/v$, $u_0/u$; held: $v_0$ t / length", r"$\mu$; held: T/$\mu$N")
    colour = "iterations"
    panels = (*(f"{law}, {by}" for by in ("speed", "slip") for law in REGULARISED),
              "arctan, held")
    PRESSURE, SPEED = 1.0, 0.05

    def grid(self, panel: str, small: bool) -> tuple[NDArray, NDArray]:
        """The values of x and y."""
        held = panel.endswith("held")
        y = np.array([0.1, 0.3, 0.5, 0.7, 0.9, 0.99]) if held else \
            np.array([0.02, 0.05, 0.1, 0.2, 0.5, 1.0])
        x = 10.0**np.arange(-8.0, -2.9) if held else 10.0**np.arange(-8.0, 2.1)
        return (x[::4], y[1::3]) if small else (x, y)

    def deck(self, panel: str, x: float, y: float, frame: Frame = PLAIN) -> Deck:
        law, by = panel.split(", ")
        u, s = frame.length, frame.stress
        model = Model("shoe", mesh_make.block((2.0*u, 1.0*u), (4, 2)))
        held = by == "held"
        # What is held creeps by less than a soft shoe would bend.
        model.section("ALL", Elastic((1e12 if held else 1e3)*s, 0.0))
        plate = model.rigid_tool("PLATE", plane(0.0, 20.0*u, side="above"),
                                 free=("x",) if held else ())
        scale = (1.0 if held else self.SPEED)*x*u
        model.contact("BOTTOM", plate, friction=Coulomb(
            0.5 if held else y, regularization=law,
            **{"elastic_slip" if by == "slip" else "v0": scale}))
        model.fix("TOP", "x")
        first = model.step(1, nlgeom=False, at_once=True, fixed=True)
        first.pressure("TOP", self.PRESSURE*s)
        if held:
            first.force(plate, x=y*0.5*self.PRESSURE*s*2.0*u)
            return light(model.to_deck())
        model.step(4, at_once=True, fixed=True).pressure("TOP", self.PRESSURE*s).move(
            plate, velocity=True, x=self.SPEED*u)
        return light(model.to_deck())

    def value(self, panel: str, result: Result, frame: Frame) -> NDArray:
        if panel.endswith("held"):
            return np.array([result.history["PLATE.u1"][-1]])/frame.length
        return _reaction(result, "PLATE", frame.stress, frame.length)[:1]

    def exact(self, panel: str, x: float, y: float) -> NDArray:
        law, by = panel.split(", ")
        if by == "held":
            return np.array([x*tan(pi*y/2.0)])
        return np.array([y*self.PRESSURE*2.0*REGULARISED[law](1.0/x)])


class VolumeMap(NumberMap):
    """A tube under pressure inside: 1 - 2 nu by cells across the wall; a panel an element."""

    number, name = 11, "volume"
    title = "Map 11: a tube of nearly constant volume; its widening beside Lame's"
    labels = (r"$1 - 2\nu$", "cells across the wall")
    linear = False
    panels = ("CPE4", "CPE4, FULL", "CPE4R", "CPE4I", "CPE3", "CPE6", "CPE8", "CPE8R")

    def grid(self, panel: str, small: bool) -> tuple[NDArray, NDArray]:
        """The values of x and y."""
        x = np.array([0.4, 0.1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6])[::-1]
        return (x[::3], np.array([4])) if small else (x, np.array([4, 6, 8, 12, 16]))

    def deck(self, panel: str, x: float, y: float, frame: Frame = PLAIN) -> Deck:
        word, _, form = panel.partition(", ")
        u, n = frame.length, round(y)
        mesh = mesh_make.ring(1.0*u, 2.0*u, (n, 3*n//2))
        model = Model("tube", mesh_make.simplices(mesh) if word[3] in "36" else mesh)
        model.section("ALL", Elastic(1000.0*frame.stress, 0.5*(1.0 - x)),
                      full_integration=bool(form))
        model.fix("START", "y")
        model.fix("END", "x")
        model.step().pressure("INNER", 1.0*frame.stress)
        return _with_word(model.to_deck(), word)

    def value(self, panel: str, result: Result, frame: Frame) -> NDArray:
        return np.linalg.norm(result["U"], axis=1).max()/frame.length

    def exact(self, panel: str, x: float, y: float) -> NDArray:
        nu = 0.5*(1.0 - x)
        return np.array([(1.0 + nu)/1000.0*(x + 4.0)/3.0])


class FlowMap(NumberMap):
    """A disc of Norton and Hoff's metal, without friction, to 80 % of its height: m by
    increments."""

    number, name = 13, "flow"
    title = "Map 13: a disc of Norton and Hoff's metal; the force beside its closed form"
    labels = ("m", "increments")
    linear = False
    panels = ("CAX4, rigid", "CAX4, elastic", "CAX8R, rigid", "CAX3, rigid")
    K, RADIUS, HEIGHT, SPEED, TIME = 100.0, 10.0, 5.0, 1.0, 1.0

    def grid(self, panel: str, small: bool) -> tuple[NDArray, NDArray]:
        """The values of x and y."""
        x = np.array([0.003, 0.01, 0.03, 0.1, 0.2, 0.5, 1.0])
        return (x[::3], np.array([4])) if small else (x, np.array([1, 2, 4, 8, 16, 32]))

    def deck(self, panel: str, x: float, y: float, frame: Frame = PLAIN) -> Deck:
        word, _, kind = panel.partition(", ")
        u = frame.length
        mesh = mesh_make.block((self.RADIUS*u, self.HEIGHT*u), (4, 3))
        model = Model("disc", mesh_make.simplices(mesh) if word == "CAX3" else mesh,
                      kind="axisymmetric")
        law = NortonHoff(self.K*frame.stress, x, rigid=kind == "rigid")
        elastic = [] if kind == "rigid" else [Elastic(1e5*frame.stress, 0.3)]
        model.section("ALL", Material(*elastic, law))
        die = model.rigid_tool("DIE", plane(self.HEIGHT*u, 4.0*self.RADIUS*u))
        model.contact("TOP", die)
        model.fix("BOTTOM", "z")
        model.fix("LEFT", "r")
        model.step(round(y), self.TIME, nlgeom=True, fixed=True).move(
            die, z=-self.SPEED*self.TIME*u)
        return _with_word(model.to_deck(), word)

    def value(self, panel: str, result: Result, frame: Frame) -> NDArray:
        return _reaction(result, "DIE", frame.stress, frame.length**2)[1:]

    def exact(self, panel: str, x: float, y: float) -> NDArray:
        height = self.HEIGHT - self.SPEED*self.TIME
        area = pi*self.RADIUS**2*self.HEIGHT/height
        return np.array([-self.K*sqrt(3.0)**(x + 1.0)*(self.SPEED/height)**x*area])


def _polygon(radius: float, x: float):
    """Chords of 11 degrees in place of an arc."""
    angles = np.linspace(0.7, -0.7, 8)
    corners = [(x + radius*sin(a), radius*(1.0 - cos(a))) for a in angles]
    profile = start(*corners[0])
    for corner in corners[1:]:
        profile = profile.line_to(*corner)
    return profile


def _with_word(deck: Deck, word: str) -> Deck:
    return light(with_elements(deck, word))
