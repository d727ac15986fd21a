"""What halving the cells of a forming scene changes: `python tests/benchmarks/halving.py [names]`.

Prints the table of docs/forming.md, section 7: each deck as its maker writes it, then on cells half
as long, and half again where that is cheap; increments are controlled as in the deck.
"""
from __future__ import annotations

import os
import resource
import sys
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT/"decks"/"make")]
os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")
os.environ.setdefault("LOPIN_EXECUTABLE", str(ROOT/"build"/"lopin"))

import bulk_meshes  # noqa: E402
from bending import free_bending  # noqa: E402
from forging import closed_die, upset_tetra  # noqa: E402
from sheets import cup, v_bending  # noqa: E402

import lopin  # noqa: E402

ALLOWED = 0.02   #: change of the tool force when the cells are halved


class Scene(NamedTuple):
    """A deck by its mesh, and what to read of its run."""

    text: Callable[..., str]                       #: the deck of a mesh
    meshes: dict[str, tuple]                       #: arguments of `text` by the name of the mesh
    tool: str                                      #: column of the history
    unit: tuple[str, float]                        #: of the force, and its size in that of the deck
    end: float                                     #: total time at the end of the stroke
    shape: tuple[str, Callable[..., float]]        #: what is measured there, and how
    stretch: tuple[float, float] = (0.0, 0.0)      #: total time over which the force is averaged


def included(name: str) -> Callable[[tuple[int, int]], str]:
    """A deck of the gallery with another mesh in place of the one it includes."""
    def text(cells: tuple[int, int]) -> str:
        deck = (ROOT/"decks"/f"{name}.inp").read_text(encoding="utf-8")
        card = f"*INCLUDE, INPUT={name}.mesh\n"
        assert card in deck
        return deck.replace(card, bulk_meshes.MESHES[name](cells).text())
    return text


def points(frame) -> tuple[np.ndarray, np.ndarray]:
    """Places of the nodes of the metal before and after [length]; tools are left out."""
    x, u = frame.points, np.asarray(frame.point_data["U"])
    used = np.unique(np.concatenate([block.data.ravel() for block in frame.cells
                                     if block.type not in ("line", "triangle", "vertex")]))
    return x[used], (x + u)[used]


def moved(x: float, y: float) -> Callable[..., float]:
    """The radius now of the node that was at (x, y)."""
    def radius(frame) -> float:
        before, after = points(frame)
        return after[np.argmin(np.hypot(before[:, 0] - x, before[:, 1] - y)), 0]
    return radius


def widest(frame) -> float:
    """Largest distance from the axis."""
    return points(frame)[1][:, 0].max()


def drawn_length(frame) -> float:
    """How far the free end of the wire has come."""
    before, after = points(frame)
    return after[np.argmin(before[:, 1]), 1] - before[:, 1].min()


def slope(low: float, high: float) -> Callable[..., float]:
    """Degrees by which the sheet between two distances from the middle has turned."""
    def degrees(frame) -> float:
        before, after = points(frame)
        leg = (before[:, 0] > low) & (before[:, 0] < high) & (before[:, 1] < 1e-9)
        first, last = (after[leg][k(before[leg, 0])] for k in (np.argmin, np.argmax))
        return np.degrees(np.arctan2(last[1] - first[1], last[0] - first[0]))
    return degrees


SCENES = {
    "upsetting": Scene(
        included("upsetting"), {f"{n} x {m}": ((n, m),) for n, m in ((12, 18), (24, 36), (48, 72))},
        "PLATE.rf2", ("kN", 1e3), 4.0, ("radius at mid-height [mm]", moved(10.0, 0.0))),
    "ring_compression": Scene(
        included("ring_compression"),
        {f"{n} x {m}": ((n, m),) for n, m in ((16, 10), (32, 20), (64, 40))},
        "PLATE.rf2", ("kN", 1e3), 3.0, ("bore at mid-height [mm]", moved(7.5, 0.0))),
    "wire_drawing": Scene(
        included("wire_drawing"),
        {f"{n} x {m}": ((n, m),) for n, m in ((4, 52), (8, 104), (16, 208))},
        "DIE.rf2", ("kN", 1e3), 3.0, ("wire fed [mm]", drawn_length), (1.0, 3.0)),
    "closed_die": Scene(
        closed_die, {f"{n} x {round(0.8*n)}": (n,) for n in (24, 48, 96)},
        "DIE.rf2", ("kN", 1e3), 0.1, ("radius of the flash [mm]", widest)),
    "upset_tetra": Scene(
        upset_tetra, {f"{n} x {m}": ((n, m),) for n, m in ((4, 6), (8, 12))},
        "DIE.rf3", ("kN", 1e3), 1.0, ("largest x [mm]", widest)),
    "v_bending": Scene(
        v_bending, {f"{23*n} x {2*n}": (23*n, 2*n, "CPE4I", 14.0, 0.1, 10*n) for n in (2, 4, 8)},
        "PUNCH.rf2", ("N/mm", 1.0), 1.0, ("leg [degrees]", slope(31.0, 38.0))),
    "free_bending": Scene(
        free_bending, {f"{n} x 4": ((n, 4),) for n in (120, 240, 480)},
        "PUNCH.rf2", ("N/mm", 1.0), 1.0, ("leg [degrees]", slope(45.0, 56.0)),
        (15.0/28.5, 25.0/28.5)),
    "cup": Scene(
        lambda elements, layers: cup(elements, layers, opened=False),
        {f"{20*n} x {n}": (20*n, n) for n in (3, 6, 12)},
        "PUNCH.rf2", ("kN", 1e3), 2.0, ("radius of the rim [mm]", widest), (1.5, 2.0)),
}


class Found(NamedTuple):
    """Figures of a run."""

    force: float        #: at the end of the stroke
    largest: float      #: over the stroke
    mean: float         #: over the stretch, not a number if there is none
    shape: float
    increments: int
    seconds: float      #: of the processor


def run(scene: Scene, arguments: tuple) -> Found:
    """One mesh."""
    before = resource.getrusage(resource.RUSAGE_SELF)
    result = lopin.run(lopin.Deck.parse(scene.text(*arguments), "scene", ROOT/"decks"))
    after = resource.getrusage(resource.RUSAGE_SELF)
    time, force = result.history["time"], np.abs(result.history[scene.tool])/scene.unit[1]
    stroke = time < scene.end*(1.0 + 1e-9)
    frame = int(np.argmin(np.abs(result.times - scene.end)))
    low, high = scene.stretch
    part = (time > low) & (time < high*(1.0 + 1e-9))
    mean = np.trapezoid(force[part], time[part])/np.ptp(time[part]) if part.any() else np.nan
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return Found(force[stroke][-1], force[stroke].max(), mean,
                 scene.shape[1](result.to_meshio(frame)), int(stroke.sum()), seconds)


def change(value: float, coarser: float | None) -> str:
    """What halving changed, in per cent."""
    return "" if coarser is None else f" ({100.0*(value/coarser - 1.0):+.1f} %)"


def rows(name: str):
    """Lines of the table, one per mesh."""
    scene, coarser = SCENES[name], None
    for mesh, arguments in scene.meshes.items():
        try:
            found = run(scene, arguments)
        except lopin.NotConvergedError as stopped:
            code, times = str(stopped).split(":")[0], stopped.result.history["time"]
            time = times[-1] if len(times) else 0.0
            yield f"|  | {mesh} | {code} at time {time:.2f} of {scene.end:g} |  |  |  |  |  |  |"
            return
        cells = []
        for word in ("force", "largest", "mean", "shape"):
            value, last = getattr(found, word), coarser and getattr(coarser, word)
            cells.append("" if np.isnan(value) else f"{value:.4g}{change(value, last)}")
        worst = coarser and max(abs(getattr(found, word)/getattr(coarser, word) - 1.0)
                                for word in ("force", "largest"))
        verdict = "" if worst is None else "yes" if worst < ALLOWED else "**no**"
        unit = f"{name} [{scene.unit[0]}]; {scene.shape[0]}" if coarser is None else ""
        yield (f"| {unit} | {mesh} | {' | '.join(cells)} | {verdict} | {found.increments} | "
               f"{found.seconds:.1f} |")
        coarser = found


def main(names: list[str]) -> None:
    """The table; in parentheses the change against the row above."""
    print("| scene [force]; shape | cells | force at the end | largest | mean | "
          f"shape | within {100*ALLOWED:g} % | increments | CPU s |\n{'| --- '*9}|")
    for name in names or SCENES:
        for row in rows(name):
            print(row, flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
