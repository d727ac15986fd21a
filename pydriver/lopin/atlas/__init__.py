"""The stability atlas: where the methods work, where they fail, and whether they say so.

A map is a grid of two parameters for methods side by side. Every cell is solved twice: as it is,
and turned by a random angle in random units, which must not change its class.
"""
from __future__ import annotations

import csv
import sys
import time
from collections import Counter
from dataclasses import fields
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from ..errors import UsageError
from ..files import whole_file
from .cells import CLASSES, Cell
from .faces import FaceCell, FaceMap
from .facets import FacetMap
from .first_steps import FirstMap
from .formed import FormingCell, FormingMap
from .friction import FrictionMap
from .laws import LawMap
from .mesh import MeshMap
from .numbers import FlowMap, IncrementMap, RegularisedMap, VolumeMap
from .penalty import AugmentedMap, PenaltyMap
from .remeshed import RemeshedCell, RemeshMap
from .scenes import Frame
from .sheets import SheetMap
from .tresca import TrescaMap
from .uzawa import UzawaMap
from .wedge import WedgeMap

MAPS = {m.number: m for m in (
    PenaltyMap(), UzawaMap(), AugmentedMap(), FrictionMap(), TrescaMap(), WedgeMap(),
    IncrementMap(), RegularisedMap(), MeshMap(), FacetMap(), VolumeMap(), FlowMap(), RemeshMap(),
    FaceMap(), SheetMap(), LawMap(), FirstMap())}
#: Classes of cells without an answer, or with a wrong one.
FAILED = ("F1", "F2", "F3", "F4", "F5", "F6")
#: Seconds between two writings of a table that grows.
_PAUSE = 10.0


def map_of(number: int):
    """A map by its number."""
    if number not in MAPS:
        raise UsageError(f"no map {number}; maps: {', '.join(map(str, MAPS))}")
    return MAPS[number]


def possible() -> list[int]:
    """Numbers of the maps for which everything is installed; the others are told."""
    found = []
    for number, chart in MAPS.items():
        lacks = [name for name in getattr(chart, "needs", ()) if not find_spec(name)]
        if lacks:
            say(f"map {number} is left out: it needs {', '.join(lacks)}")
        else:
            found.append(number)
    return found


def places(chart, small: bool = False) -> list[Cell]:
    """All cells of a map, not solved yet, in the order of their numbers."""
    cells, kind = [], getattr(chart, "cell", Cell)
    for panel in chart.panels:
        x, y = chart.grid(panel, small)
        for level in y:
            cells += [kind(len(cells) + k, panel, float(v), float(level)) for k, v in enumerate(x)]
    return cells


def frame_of(chart, cell: Cell) -> Frame:
    """The other frame of a cell: random, but the same for a scene each time."""
    rng = np.random.default_rng([chart.number, int(1e3*cell.y)])
    return chart.frame(rng) if hasattr(chart, "frame") else Frame.random(rng)


def measure(chart, small: bool = False, table: Path | None = None,
            most: int | None = None) -> list[Cell]:
    """Solve the cells of a map.

    `table`: a file that takes the cells as they are solved; what it has already is not solved
    again. `most`: a batch, so many cells and no more.
    """
    cells, begin = places(chart, small), time.perf_counter()
    known = {c.row: c for c in read_table(table)} if table and table.is_file() else {}
    cells = [known.get(cell.row, cell) for cell in cells]
    todo, written = [c for c in cells if c.row not in known][:most], begin
    for cell in todo:
        first = chart.solve(cell.panel, cell.x, cell.y)
        for found in fields(first):
            setattr(cell, found.name, getattr(first, found.name))
        cell.turned = chart.solve(cell.panel, cell.x, cell.y, frame_of(chart, cell)).kind
        if table and time.perf_counter() > written + _PAUSE:
            write_table([c for c in cells if c.turned], table)
            written = time.perf_counter()
    cells = [c for c in cells if c.turned]
    if table:
        write_table(cells, table)
    say(f"map {chart.number}: {len(todo)} cells, {time.perf_counter() - begin:.0f} s")
    return cells


def counts(cells: list[Cell]) -> dict[str, dict[str, int]]:
    """Numbers of cells by panel and class."""
    table: dict[str, Counter] = {}
    for cell in cells:
        table.setdefault(cell.panel, Counter())[cell.kind] += 1
    return {panel: {k: found[k] for k in CLASSES if found[k]} for panel, found in table.items()}


def write_table(cells: list[Cell], path: Path) -> None:
    """All cells as CSV."""
    with whole_file(path) as part, part.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(cells[0].columns())
        writer.writerows(cell.values() for cell in cells)


def read_table(path: Path) -> list[Cell]:
    """The cells of a table, to be drawn again."""
    with path.open(newline="", encoding="utf-8") as file:
        rows = csv.DictReader(file)
        names = rows.fieldnames or ()
        kind = RemeshedCell if "meshes" in names else FaceCell if "drag" in names else \
            FormingCell if "reached" in names else Cell
        return [kind.read(row) for row in rows]


def again(chart, number: int, folder: Path, small: bool = False) -> Path:
    """Write the deck of a cell, so that anyone can run it."""
    cells = places(chart, small)
    if not 0 <= number < len(cells):
        raise UsageError(f"map {chart.number} has the cells 0 to {len(cells) - 1}, not {number}")
    cell = cells[number]
    folder.mkdir(parents=True, exist_ok=True)
    stem = f"map{chart.number}_cell{number}"
    if not hasattr(chart, "deck"):
        return chart.write(cell.panel, cell.x, cell.y, folder/f"{stem}.json")
    more = [folder] if isinstance(chart, FormingMap) else []
    return chart.deck(cell.panel, cell.x, cell.y, *more).write(folder/f"{stem}.inp")


def keep_failing(chart, cells: list[Cell], folder: Path, small: bool = False) -> list[Path]:
    """Decks of the cells of forming maps that failed, in a folder of their own."""
    if not isinstance(chart, FormingMap):
        return []
    return [again(chart, cell.row, folder/"failing", small) for cell in cells
            if cell.kind in FAILED]


def summary(chart, cells: list[Cell]) -> list[str]:
    """What was found, in words."""
    found = Counter(cell.kind for cell in cells)
    other = sum(cell.turned != cell.kind for cell in cells)
    lines = [f"map {chart.number}, {chart.name}: {len(cells)} cells, " + ", ".join(
        f"{found[k]} {k} ({CLASSES[k]})" for k in CLASSES if found[k] or k == "F1")
        + f"; {other} change their class when turned and in other units"]
    for panel, table in counts(cells).items():
        lines.append(f"  {panel}: " + ", ".join(f"{n} {k}" for k, n in table.items()))
    return lines


def say(text: str) -> None:
    """Progress, where it does not get into the way of the answer."""
    print(text, file=sys.stderr, flush=True)
