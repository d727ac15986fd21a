"""The work-precision chart: error against cost for the four methods, both paths, many meshes.

Every setting of a scene is run several times in turns; times are the least of the repetitions. The
*enforcement error* compares nodal pressures with the exact discrete solution of the same mesh, the
*total error* with a closed form; both are relative, in the L2 norm weighted by nodal areas.
"""
from __future__ import annotations

import csv
import math
import sys
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

import numpy as np

from ..deck import Deck
from ..errors import UsageError
from ..files import whole_file
from .run import (
    CONTACT,
    LINEAR,
    Run,
    Setting,
    least_compliance,
    light,
    once,
    pressures,
    relative,
    without_contact,
)
from .scenes import SCENES, Scene

PATHS = ("condensed", "newton")
EXACT = Setting("lagrange")
#: Facets on the contact radius: of the sweep over r, and of the sweep over meshes. The error
#: depends on where between two nodes contact ends, so each mesh of the sweep stands for three.
SWEEP_CELLS = {"sphere": 36.5, "cylinder": 20.8}
CELLS, SHIFTS = (4, 6, 9, 14, 21, 32), (1/6, 1/2, 5/6)

TITLES = {"sphere": "Hertz: rigid sphere on an elastic half-space, axisymmetric",
          "cylinder": "Hertz: elastic cylinder on an elastic block, plane strain"}


def sweep(decades: Iterable[int] = range(-2, 13),
          starts: Iterable[float] = (1.0, 10.0, 100.0)) -> list[Setting]:
    """All methods on both paths: stiffness over decades, augmentations from some stiffnesses."""
    settings, decades, starts = [], list(decades), list(starts)
    for path in PATHS:
        # The second path gives the same answers at more cost: fewer points tell it.
        tens, first = (decades, starts) if path == PATHS[0] else (decades[::2], starts[1:2])
        settings.append(Setting("lagrange", path))
        for method in ("penalty", "perturbed", "augmented"):
            settings.append(Setting(method, path))
            if method != "augmented":
                settings += [Setting(method, path, 10.0**k) for k in tens]
        settings += [Setting("augmented", path, r, 10.0**-(0.5*k))
                     for r in first for k in range(2, 27)]
    return settings


def mesh_settings() -> list[Setting]:
    """What is run on every mesh: the exact method, defaults, and stiffnesses that stay behind."""
    return [EXACT, Setting("lagrange", "newton"), Setting("penalty"), Setting("penalty", r=1.0),
            Setting("penalty", r=10.0), Setting("augmented"), Setting("augmented", "newton")]


def measure(scene: Scene, settings: list[Setting], repetitions: int = 5) -> list[Run]:
    """A row per setting; runs that another tolerance stopped at the same pass are left out."""
    scene = replace(scene, deck=light(scene.deck))
    reference, *_ = once(scene, EXACT.deck(scene.deck, 1.0))
    if reference is None:
        raise UsageError(f"{scene.name} has no solution by the exact method")
    chosen, *_ = once(scene, Setting("penalty").deck(scene.deck, 1.0))
    least = least_compliance(chosen, _target(scene))
    rows = [Run(scene.name, s.method, s.path, scene.element, scene.h, setting=s,
                r=s.r if s.r else np.nan, slope=s.r/least if s.r else np.nan,
                default=s.r is None, tolerance=s.tolerance or np.nan) for s in settings]
    linear, linear_seconds = without_contact(scene.deck), math.inf
    for repetition in range(repetitions):
        for _ in range(3):
            result, seconds, *_ = once(scene, linear)
            if result is not None:
                linear_seconds = min(linear_seconds, sum(seconds[k] for k in LINEAR))
        for row in rows:
            if not row.failure:
                _run_once(row, scene, least, first=repetition == 0)
        if repetition == 0:
            rows = _distinct(rows)
    _judge(rows, scene, reference)
    if math.isinf(linear_seconds):   # supports alone do not hold it: the condensed system does
        linear_seconds = sum(rows[0].least[k] for k in LINEAR)
    for row in rows:
        row.equivalent = sum(row.least.get(k, np.nan) for k in CONTACT)/linear_seconds
    return rows


def _target(scene: Scene) -> float:
    block = scene.deck.all("LOPIN")
    return float(block[0].parameters.get("TARGET ERROR", 0.01)) if block else 0.01


def _run_once(row: Run, scene: Scene, least: float, first: bool) -> None:
    """Add a repetition to a row."""
    result, seconds, peak, row.failure = once(scene, row.setting.deck(scene.deck, least))
    row.least = {k: min(v, row.least.get(k, np.inf)) for k, v in seconds.items()}
    row.wall_s = min(row.wall_s, seconds["total"])
    if result is None or not first:
        return
    summary, row.peak_mb = result.summary, peak
    row.n_dof, row.verdict = summary["equations"], summary["certificate"]["verdict"]
    row.estimate = summary["certificate"]["pressure_error"]
    for name in ("increments", "iterations", "augmentations", "factorisations", "back_solves"):
        setattr(row, name, sum(step[name] for step in summary["steps"]))
    row.pressure, weight = pressures(result)
    if scene.exact is not None:
        row.error_total = relative(row.pressure, scene.exact(result.contact(0).last), weight)
    if row.default and row.method != "lagrange":
        row.r, row.slope = 1.0/_target(scene) - 1.0, (1.0/_target(scene) - 1.0)/least


def _judge(rows: list[Run], scene: Scene, reference) -> None:
    """Enforcement errors; the exact solution itself is compared with that of the other path."""
    exact, weight = pressures(reference)
    other = [r.pressure for r in rows if r.method == "lagrange" and r.path == "newton"]
    for row in rows:
        if row.pressure is not None:
            mine = row.method == "lagrange" and row.path == "condensed"
            against = other[0] if mine and other and other[0] is not None else exact
            row.error_enforcement = relative(row.pressure, against, weight)


def _distinct(rows: list[Run]) -> list[Run]:
    """Without the augmented runs that another tolerance stopped at the same pass."""
    kept, seen = [], set()
    for row in rows:
        key = (row.path, row.r, row.augmentations)
        if not np.isnan(row.tolerance) and not row.failure:
            if key in seen:
                continue
            seen.add(key)
        kept.append(row)
    return kept


def hertz(repetitions: int = 5, cells: Iterable[int] = CELLS,
          fine: dict[str, float] = SWEEP_CELLS) -> dict[str, dict[str, list[Run]]]:
    """Rows of the Hertz scenes by name: the sweep over r on one mesh, and over meshes."""
    rows = {}
    for name, scene in SCENES.items():
        say(f"{name}: stiffness and augmentations, {fine[name]:g} facets on the contact radius")
        rows[name] = {"sweep": measure(scene(fine[name]), sweep(), repetitions), "meshes": []}
        for n in cells:
            say(f"{name}: mesh of {n} facets")
            for shift in SHIFTS:
                rows[name]["meshes"] += [
                    replace(row, case=f"{name} mesh {n}")
                    for row in measure(scene(n + shift), mesh_settings(), repetitions)]
    return rows


def of_deck(deck: Deck, repetitions: int = 5) -> dict[str, dict[str, list[Run]]]:
    """Rows of any deck that has a *SURFACE BEHAVIOR."""
    scene = Scene(deck.name, deck)
    return {deck.name: {"sweep": measure(scene, sweep(), repetitions), "meshes": []}}


def title(name: str, rows: dict[str, list[Run]]) -> str:
    """What a figure shows."""
    row = next((row for row in rows["sweep"] if row.n_dof), rows["sweep"][0])
    fine = f", {1.0/row.h:.3g} facets on the contact radius" if np.isfinite(row.h) else ""
    return f"{TITLES.get(name, name)}: {row.n_dof} equations{fine}"


def write_table(rows: list[Run], path: Path) -> None:
    """All rows as CSV."""
    with whole_file(path) as part, part.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(Run.columns())
        writer.writerows(row.values() for row in rows)


def is_table(path: Path) -> bool:
    """Whether a table is one of these."""
    with path.open(encoding="utf-8") as file:
        return set(Run.columns()) <= set(file.readline().strip().split(","))


def read_table(path: Path) -> dict[str, dict[str, list[Run]]]:
    """The rows of a table written earlier, to be drawn again."""
    scenes: dict[str, dict[str, list[Run]]] = {}
    with path.open(newline="", encoding="utf-8") as file:
        for row in map(Run.read, csv.DictReader(file)):
            name, _, mesh = row.case.partition(" mesh ")
            both = scenes.setdefault(name, {"sweep": [], "meshes": []})
            both["meshes" if mesh else "sweep"].append(row)
    return scenes


def say(text: str) -> None:
    """Progress, where it does not get into the way of the answer."""
    print(text, file=sys.stderr, flush=True)
