"""What a report says of a run, gathered from its folder."""
from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ..errors import ResourceError
from ..folder import Folder
from ..result import Result
from .shape import Shape, shapes_of

_STEP = re.compile(r"step (\d+), increment (\d+)(?:, attempt (\d+), time increment (\S+)|: (.*)|"
                   r", attempt \d+: cut to (\S+), because (.*))")


@dataclass
class Run:
    """One run."""
    folder: Path
    name: str
    summary: dict
    history: dict
    steps: list = field(default_factory=list)        # rows of .sta
    attempts: list = field(default_factory=list)     # (step, increment, residuals, cut reason)
    lines: dict = field(default_factory=dict)        # (file, line): text of the deck
    shape: Shape | None = None
    troubles: list = field(default_factory=list)     # what of the folder cannot be read

    @property
    def status(self) -> str:
        """finished, not converged, failed, interrupted, stopped, running."""
        return str(self.summary.get("status", "without a summary"))

    @property
    def verdict(self) -> str:
        """PASS, WARN or FAIL; nothing without an increment."""
        certificate = self.summary.get("certificate") or {}
        return str(certificate.get("verdict", "")) if certificate.get("step") else ""

    @property
    def diagnostics(self) -> list:
        """Errors first, then warnings, then notes."""
        order = {"error": 0, "warning": 1, "note": 2}
        return sorted(self.summary.get("diagnostics", []),
                      key=lambda item: order.get(item.get("severity"), 3))

    def tools(self) -> dict[str, list[tuple[int, np.ndarray, np.ndarray]]]:
        """Travel and force of every tool, by the dofs in which it both moves and is loaded."""
        found: dict[str, list] = {}
        for column in self.history:
            name, dot, what = column.rpartition(".")
            if not dot or not re.fullmatch(r"u[1-3]", what) \
                    or f"{name}.rf{what[1]}" not in self.history:
                continue
            travel, force = self.history[column], self.history[f"{name}.rf{what[1]}"]
            if np.abs(travel).max(initial=0.0) > 0.0 and np.abs(force).max(initial=0.0) > 0.0:
                found.setdefault(name, []).append((int(what[1]), travel, force))
        return found


def collect(folder: Path, decks: Path) -> Run:
    """All of a run that its folder still has; a part that is missing is left out, and told where
    it is damaged."""
    name = None
    if folder.suffix == ".json":
        folder, name = folder.parent, folder.stem
    elif folder.suffix == ".inp":
        raise ResourceError(f"{folder} is a deck, not a folder of results",
                            help=f"lopin run {folder}, then lopin report out/{folder.stem}")
    source = Folder(folder, name, whole=False)
    result = Result(source)
    run = Run(folder, result.name, result.summary, {}, troubles=source.troubles)
    others = sorted({p.stem for p in folder.glob("*.sta")
                     if not re.fullmatch(rf"{re.escape(result.name)}(\.p\d+)?", p.stem)})
    if others and not name:
        run.troubles.append(f"the folder also holds {', '.join(others)}: lopin report "
                            f"{folder/others[0]}.json shows it")
    try:
        run.history = dict(result.history)
    except ResourceError as problem:
        run.troubles.append(problem.message)
    run.steps = _steps(folder/f"{run.name}.sta")
    run.attempts = _attempts(folder/f"{run.name}.cvg")
    run.lines = _deck_lines(run, decks)
    run.shape = shapes_of(result)
    if run.shape and run.shape.unread:
        some = ", ".join(f"{time:g}" for time in run.shape.unread[:5])
        run.troubles.append(f"{len(run.shape.unread)} outputs of fields are damaged or missing (at "
                            f"time {some}{', ...' if len(run.shape.unread) > 5 else ''})")
    return run


def _steps(path: Path) -> list[list[float]]:
    """Step, increment, attempts, iterations, total time, step time, increment, closed,
    augmentations."""
    if not path.is_file():
        return []
    rows = [line.split() for line in path.read_text(errors="replace").splitlines()[2:]]
    return [[_float(word) for word in row] for row in rows if len(row) == 9]


def _float(word: str) -> float:
    """A number as Fortran writes it: its exponent may stand without letter; nan: none.

    >>> _float("1.2791-111") == 1.2791e-111, _float("3.5E-02"), _float("x")
    (True, 0.035, nan)
    """
    try:
        return float(re.sub(r"(?<=\d)([+-]\d+)$", r"e\1", word))
    except ValueError:
        return float("nan")


def _attempts(path: Path) -> list[tuple[int, int, list[float], str]]:
    """Residuals of every attempt, in order."""
    found: list = []
    if not path.is_file():
        return found
    for line in path.read_text(errors="replace").splitlines():
        start = _STEP.match(line)
        if start and start[4]:
            found.append((int(start[1]), int(start[2]), [], ""))
        elif start and found and (start[7] or start[5]):
            found[-1] = (*found[-1][:3], start[7] or start[5])
        elif found and re.match(r"\s*\d+\s+\d", line):
            words = line.split()
            found[-1][2].append(max(map(_float, words[1:3])))
    return found


def _deck_lines(run: Run, decks: Path) -> dict[tuple[str, int], str]:
    """The lines of the deck that diagnostics point to, as far as the files are still there."""
    wanted = {(item["file"], item["line"]) for item in run.diagnostics
              if item.get("file") and item.get("line")}
    texts, lines = {}, {}
    for name, number in wanted:
        path = next((p for p in (decks/name, Path(name)) if p.is_file()), None)
        if path is None:
            continue
        if name not in texts:
            texts[name] = path.read_text(encoding="utf-8", errors="replace").splitlines()
        if 0 < number <= len(texts[name]):
            lines[name, number] = texts[name][number - 1]
    return lines
