"""Map 14 of the atlas: a closed die on meshes that are made anew, by their size and their trigger.

The reference is one mesh of fine cells, as far as it lives (4.95 mm of 5). Compared are the force
of the die at four strokes and the plastic strain over the whole disc at the last. What one mesh of
such cells would give is `one_mesh`: the chart beside the map.
"""
from __future__ import annotations

import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..charts.run import WRONG
from ..deck import Deck
from ..errors import LopinError, optional
from ..mesh import make as mesh_make
from ..mesh.mesh import together
from ..model import Model
from ..model_deck import mesh_deck
from ..remesh.driver import Runner
from ..vtu import read_vtu
from .formed import FormingCell, FormingMap, FormingOutcome
from .scenes import PLAIN, Frame

#: Cells inside; next to the die and in the flash they may be a fifth.
SIZES = (1.6, 1.13, 0.8, 0.57)
#: Plastic strain since the last mesh that asks for a new one.
TRIGGERS = (0.25, 0.5, 1.0, 2.0)
#: Cells of the reference, strokes at which forces are compared.
FINE, STROKES = 0.35, (4.0, 4.4, 4.8, 4.95)
#: What the codes of runs that stop mean.
_CODES = {"E0510": "F2", "E0512": "F4", "E0513": "F4", "E0514": "F4"}
_DIE = ((40.0, 10.0), (27.5, 10.0), (26.594683, 6.37873219), (26.1096118, 6.0, 26.1096118, 6.5),
        (21.0503113, 6.0), (19.6407724, 6.98696979, 21.0503113, 7.5), (18.2951488, 10.6840403),
        (16.4157635, 12.0, 16.4157635, 10.0), (-1.0, 12.0))


@dataclass
class RemeshedCell(FormingCell):
    """With the error of the plastic strain, and how many meshes there were."""

    strain: float = np.nan        #: integral of the difference by that of the reference [-]
    meshes: int = 0


@dataclass
class RemeshedOutcome(FormingOutcome):
    """With the error of the plastic strain, and how many meshes there were."""

    strain: float = np.nan
    meshes: int = 0


@dataclass
class Pressed:
    """A run in the units of the plain frame."""

    code: str
    verdict: str
    seconds: float
    reached: float = 0.0
    increments: int = 0
    iterations: int = 0
    meshes: int = 0
    force: NDArray | None = None      #: at STROKES; the last one that was reached beyond
    x: NDArray | None = None          #: places and plastic strain of the nodes at the end
    plastic: NDArray | None = None


def disc(size: float, trigger: float | None, frame: Frame = PLAIN, end: float = STROKES[-1]
         ) -> Deck:
    """A hot disc between closed dies, to a stroke; without a trigger on one mesh."""
    unit, stress = frame.length, frame.stress
    cells = round(15.0/size)
    billet = mesh_make.block((15.0, 12.0), (cells, round(0.8*cells)))
    skin = np.concatenate([billet.surfaces["TOP"], billet.surfaces["RIGHT"]])
    billet = billet.replaced(surfaces={"SKIN": skin}, point_sets={
        k: billet.point_sets[k] for k in ("LEFT", "BOTTOM")}).mapped(lambda x: x*unit)
    card = "" if trigger is None else (f"*REMESH, ELSET=BILLET, SIZE={size*unit:.12g}, "
                                       f"SMALLEST={0.2*size*unit:.12g}, STRAIN={trigger:g}\n")
    mesh = mesh_deck(Model("disc", together(BILLET=billet), kind="axisymmetric")).text()
    return Deck.parse(f"""{mesh}{hot(stress)}*NODE, NSET=DIE_REF
900001, 0., {20.0*unit:.12g}
*SURFACE, NAME=DIE, TYPE=SEGMENTS
{profile(unit)}*RIGID BODY, ANALYTICAL SURFACE=DIE, REF NODE=DIE_REF
*SURFACE INTERACTION, NAME=GRAPHITE
*SURFACE BEHAVIOR, DIRECT
*FRICTION
0.1,
*CONTACT PAIR, INTERACTION=GRAPHITE
BILLET.SKIN, DIE
*BOUNDARY
BILLET.LEFT, 1
BILLET.BOTTOM, 2
DIE_REF, 1
DIE_REF, 6
{card}{press(2, unit, end)}""", name="disc")


def profile(unit: float) -> str:
    """The lines of the die, (r, z) from outside to the axis and beyond."""
    words = ["START" if k == 0 else "CIRCL" if len(p) == 4 else "LINE" for k, p in enumerate(_DIE)]
    return "".join(", ".join([word, *(f"{v*unit:.12g}" for v in p)]) + "\n"
                   for word, p in zip(words, _DIE))


def hot(stress: float) -> str:
    """The metal of the disc, and its section."""
    return f"""*MATERIAL, NAME=HOT
*ELASTIC
{150000.0*stress:.12g}, 0.3
*VISCOPLASTIC, LAW=NORTON-HOFF
{50.0*stress:.12g}, 0.15
*SOLID SECTION, ELSET=BILLET, MATERIAL=HOT
"""


def press(axis: int, unit: float, end: float) -> str:
    """The step that moves the die along an axis."""
    return f"""*STEP, NLGEOM, INC=1000
*STATIC
0.001, {end/50.0:g}, 1.E-6, 0.002
*BOUNDARY, TYPE=VELOCITY
DIE_REF, {axis}, {axis}, {-50.0*unit:.12g}
*OUTPUT, FIELD, FREQUENCY=1000
*NODE OUTPUT
U
*ELEMENT OUTPUT
PEEQ
*END STEP
"""


def pressed(deck: Deck, frame: Frame = PLAIN, strokes: tuple[float, ...] = STROKES) -> Pressed:
    """Run a disc to its end, or as far as it goes."""
    from ..job import Job

    with tempfile.TemporaryDirectory() as folder:
        begin, code, where = time.process_time(), "", Path(folder)
        verdict, meshes, names = "", 1, [deck.name]
        try:
            if "REMESH" in deck:
                report = Runner(deck, where, say=lambda _: None).run()
                verdict, names = report.verdict()[0], report.parts
                meshes = len(names)
            else:
                with Job(deck, where) as job:
                    for _ in job:
                        pass
                    verdict = job.result.verdict
        except LopinError as problem:
            code = problem.id or type(problem).__name__
            names = sorted(p.stem for p in where.glob(f"{deck.name}*.json")
                           if ".parts" not in p.name)
        found = Pressed(code, verdict, time.process_time() - begin, meshes=meshes)
        _measure(found, where, names, frame, strokes)
        return found


def _measure(found: Pressed, folder: Path, names: list[str], frame: Frame,
             strokes: tuple[float, ...]) -> None:
    """Forces over the stroke and the plastic strain at the end; a quarter in space counts for the
    whole."""
    rows, last = [], None
    for name in names:
        path = folder/f"{name}_history.csv"
        if not path.is_file():
            continue
        head, *lines = [line.split(",") for line in path.read_text().splitlines()]
        column = {word.partition(" ")[0]: k for k, word in enumerate(head)}
        axis = 3 if "DIE.rf3" in column else 2
        at = [column[word] for word in (f"DIE.u{axis}", f"DIE.rf{axis}", "iterations")]
        rows += [[float(line[k]) for k in at] for line in lines]
        shapes = sorted(folder.glob(f"{name}_[0-9]*.vtu"))
        last = shapes[-1] if shapes else last
    if not rows:
        return
    table = np.array(rows)
    way, force = -table[:, 0]/frame.length, -table[:, 1]/(frame.stress*frame.length**2)
    found.increments, found.iterations = len(table), int(table[:, 2].sum())
    found.reached = float(way[-1]/strokes[-1])
    ends = found.reached > 1.0 - 1e-9
    found.force = np.interp(strokes, way, force, right=None if ends else np.nan)
    if axis == 3:
        found.force *= 4.0
    if last is not None:
        shape = read_vtu(last)
        found.x = (shape.points + shape.point_data["U"])[:, :axis]/frame.length
        if axis == 3:
            found.x = np.column_stack([np.hypot(found.x[:, 0], found.x[:, 1]), found.x[:, 2]])
        found.plastic = np.asarray(shape.point_data["PEEQ"]).ravel()


def strain_apart(one: Pressed, other: Pressed, spacing: float = 0.2) -> float:
    """Integral over the disc of the difference of plastic strain, by that of the other.

    Both are read at places of a grid that lie in the metal of both.
    """
    interpolate = optional("scipy.interpolate", "this map")
    r, z = np.meshgrid(np.arange(0.5*spacing, 26.0, spacing), np.arange(0.5*spacing, 7.1, spacing))
    values = []
    for run in (one, other):
        near = interpolate.LinearNDInterpolator(run.x, run.plastic)(r, z)
        values.append(near)
    both = np.isfinite(values[0]) & np.isfinite(values[1])
    weight = r[both]
    apart = np.abs(values[0][both] - values[1][both])
    return float((weight*apart).sum()/(weight*values[1][both]).sum())


class RemeshMap(FormingMap):
    """Size of the cells by trigger; beside it one mesh of these sizes."""

    number, name = 14, "remeshing"
    title = "Map 14: a closed die, its mesh made anew"
    labels = ("cells inside [mm]", "plastic strain since the last mesh")
    panels = ("closed die",)
    colour, cell, across = "few", RemeshedCell, 1
    needs = ("gmsh", "scipy")
    ticks = ([f"{x:g}" for x in SIZES], [f"{y:g}" for y in TRIGGERS])

    def frame(self, rng: np.random.Generator) -> Frame:
        """Small and large units; an axis stays where it is."""
        return Frame(0.0, float(10.0**rng.uniform(-3.0, 3.0)), float(10.0**rng.uniform(-3.0, 6.0)))

    def grid(self, panel: str, small: bool) -> tuple[NDArray, NDArray]:
        """The values of x and y: places in SIZES and TRIGGERS."""
        if small:
            return np.array([0]), np.array([3])
        return np.arange(len(SIZES)), np.arange(len(TRIGGERS))

    def deck(self, panel: str, x: float, y: float, folder=None) -> Deck:
        """The deck of a cell."""
        return disc(SIZES[round(x)], TRIGGERS[round(y)])

    def solve(self, panel: str, x: float, y: float, frame: Frame = PLAIN) -> RemeshedOutcome:
        """What happens in a cell."""
        found = pressed(disc(SIZES[round(x)], TRIGGERS[round(y)], frame), frame)
        return judged(found, self.fine())

    def fine(self) -> Pressed:
        """The reference, run once."""
        if "fine" not in self._references:
            self._references["fine"] = pressed(disc(FINE, None))
        return self._references["fine"]

    def one_mesh(self, size: float) -> RemeshedOutcome:
        """The same disc on one mesh of such cells."""
        return judged(pressed(disc(size, None)), self.fine())

    def theory(self, panel: str) -> list[tuple[str, NDArray, NDArray]]:
        """Nothing is known beforehand."""
        return []


def judged(found: Pressed, right: Pressed) -> RemeshedOutcome:
    """The class of a run: its forces are right to five per cent, or it says what is wrong."""
    error = strain = np.nan
    if not found.code:
        error = float(np.abs(found.force - right.force).max()/right.force.max())
        strain = strain_apart(found, right)
    if found.code:
        kind = _CODES.get(found.code, "F5")
    elif not error <= WRONG:
        kind = "F1" if found.verdict == "PASS" else "W"
    else:
        kind = "W" if found.verdict == "FAIL" else "F0"
    return RemeshedOutcome(kind, error, found.iterations, found.code or found.verdict,
                           found.reached, found.increments, found.seconds, strain, found.meshes)
