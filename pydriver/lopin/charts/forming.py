"""Error against cost of a forming deck: methods, stiffness and increments beside fine exact steps.

The reference is the exact method (Lagrange) in two hundred increments a step, on the same mesh.
Errors are those of the forces on all tools over the time, and of the shape at the end; both are
relative, in the L2 norm. The unit of cost is one Newton iteration with a new factor, taken from the
exact run with the increments of the deck.
"""
from __future__ import annotations

import csv
import time
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..deck import Block, Deck
from ..errors import UsageError
from ..files import whole_file
from ..laws import METHODS
from ..result import Result
from .rows import TableRow
from .run import WRONG, answer, light, with_method

#: Increments of the reference and of the sweep, as shares of a step.
FINE, SHARES = 0.005, (0.2, 0.1, 0.05, 0.02, 0.01)
#: Slopes of the penalty beside the one that the code chooses.
FACTORS = (1e-2, 1e-1, 1.0, 1e1, 1e2)


@dataclass
class FormingRun(TableRow):
    """A row of the table."""

    case: str
    method: str
    share: float = np.nan         #: largest increment over the step; nan: as the deck has it
    factor: float = np.nan        #: slope beside the code's choice; nan: left to the code
    increments: int = 0
    iterations: int = 0
    factorisations: int = 0
    seconds: float = np.nan       #: CPU
    equivalent: float = np.nan    #: Newton iterations with a new factor
    error_force: float = np.nan
    error_shape: float = np.nan
    verdict: str = ""
    warned: str = ""              #: codes of its warnings
    failure: str = ""             #: code of a run without an answer

    @property
    def silent(self) -> bool:
        """Off by more than 5 % beside the exact method, and nobody said so."""
        return self.verdict == "PASS" and not self.warned and self.error_force > WRONG


def forms(deck: Deck) -> bool:
    """Whether a deck presses metal that flows, at large strain."""
    finite = any("NLGEOM" in step.parameters for step in deck.all("STEP"))
    return finite and ("*PLASTIC" in deck or "*VISCOPLASTIC" in deck)


def with_increments(deck: Deck, share: float) -> Deck:
    """The deck with increments of at most this share of each step."""
    blocks = []
    for block in deck.blocks:
        if block.keyword == "STATIC":
            given = block.data[0] if block.data else []
            period = float(given[1]) if len(given) > 1 and given[1] is not None else 1.0
            least = min(1e-6, 1e-3*share)*period
            block = Block("STATIC", dict(block.parameters),
                          [[share*period, period, least, share*period]])
        blocks.append(block)
    return Deck(blocks, preamble=deck.preamble, name=deck.name, folder=deck.folder)


def behaved(deck: Deck) -> Deck:
    """The deck with a *SURFACE BEHAVIOR in every interaction."""
    blocks: list[Block] = []
    for k, block in enumerate(deck.blocks):
        blocks.append(block)
        if block.keyword != "SURFACE INTERACTION":
            continue
        later = [b.keyword for b in deck.blocks[k + 1:]]
        ends = next((i for i, word in enumerate(later) if word in ("SURFACE INTERACTION",
                                                                    "CONTACT PAIR")), len(later))
        if "SURFACE BEHAVIOR" not in later[:ends]:
            blocks.append(Block("SURFACE BEHAVIOR", {"DIRECT": None}))
    return Deck(blocks, preamble=deck.preamble, name=deck.name, folder=deck.folder)


def run_once(row: FormingRun, deck: Deck) -> Result | None:
    """Fill a row by a run; what it found."""
    begin = time.process_time()
    result, row.failure = answer(deck)
    row.seconds = time.process_time() - begin
    if result is None:
        return None
    row.verdict = result.verdict
    row.warned = " ".join(sorted({w.partition(":")[0] for w in result.warnings}))
    for name in ("increments", "iterations", "factorisations"):
        setattr(row, name, sum(step[name] for step in result.summary["steps"]))
    return result


def unit_of(row: FormingRun, result: Result) -> float:
    """CPU seconds of a Newton iteration with a new factor."""
    timing = result.summary["timing"]
    linear = sum(timing.get(k, 0.0) for k in ("assemble", "analyse", "factorise", "solve"))
    return row.seconds*linear/timing["total"]/max(1, row.factorisations)


def forces(result: Result) -> tuple[NDArray, NDArray]:
    """Times, and the forces on the reference nodes of tools (increment, component)."""
    history = result.history
    names = [k for k in history if ".rf" in k and int(k[-1]) <= 3]
    if not names:
        raise UsageError("no tool has a reference node: there is no force to compare")
    return np.asarray(history["time"]), np.column_stack([history[k] for k in names])


def error_of_forces(result: Result, right: Result) -> float:
    """L2 norm over the time of the difference of the forces on tools, over that of the forces."""
    t, f = forces(result)
    s, g = forces(right)
    g = np.column_stack([np.interp(t, s, column) for column in g.T])
    dt = np.diff(np.r_[0.0, t])[:, None]
    return float(np.sqrt((dt*(f - g)**2).sum()/(dt*g**2).sum()))


def error_of_shape(result: Result, right: Result) -> float:
    """Of the displacements at the end."""
    u, v = (np.asarray(r["displacement"]) for r in (result, right))
    return float(np.linalg.norm(u - v)/np.linalg.norm(v))


def chosen_slope(result: Result) -> float:
    """Median slope that the code gave to penalties [stress/length]."""
    slopes = []
    for k in range(len(result.pairs)):
        for frame in range(len(result.times)):
            end = result.contact(k).at(frame)
            gap, pressure = np.ravel(end.gap), np.ravel(end.pressure)
            slopes += list(pressure[gap < 0.0]/-gap[gap < 0.0])
    if not slopes:
        raise UsageError("nothing touches in this deck: there is no accuracy to compare")
    return float(np.median(slopes))


def measure(deck: Deck, shares: Iterable[float] = SHARES,
            factors: Iterable[float] = FACTORS) -> list[FormingRun]:
    """Rows of a deck: the exact method by its increments, the others by their stiffness."""
    deck = light(behaved(deck))
    exact = with_method(deck, "lagrange", None)
    fine = FormingRun(deck.name, "lagrange", FINE)
    right = run_once(fine, with_increments(exact, FINE))
    if right is None:
        raise UsageError(f"{deck.name} has no solution by the exact method in increments of "
                         f"{FINE:g}: {fine.failure}")
    rows, own = [fine], FormingRun(deck.name, "lagrange")
    todo = [(own, exact)]
    todo += [(FormingRun(deck.name, "lagrange", share), with_increments(exact, share))
             for share in shares]
    todo += [(FormingRun(deck.name, name), with_method(deck, name, None))
             for name in METHODS if name != "lagrange"]
    unit, slope = np.nan, np.nan
    for row, each in todo:
        found = run_once(row, each)
        rows.append(row)
        if found is None:
            continue
        unit = unit_of(row, found) if row is own else unit
        slope = chosen_slope(found) if row.method == "penalty" else slope
        row.error_force, row.error_shape = error_of_forces(found, right), error_of_shape(
            found, right)
    rows += _by_stiffness(deck, right, slope, factors)
    for row in rows:
        row.equivalent = row.seconds/unit
    return rows


def _by_stiffness(deck: Deck, right: Result, slope: float,
                  factors: Iterable[float]) -> list[FormingRun]:
    """Penalties of slopes beside the one that the code chooses."""
    rows = []
    for method in ("penalty", "perturbed"):
        for factor in factors if np.isfinite(slope) else ():
            row = FormingRun(deck.name, method, factor=factor)
            found = run_once(row, with_method(deck, method, factor*slope))
            if found is not None:
                row.error_force = error_of_forces(found, right)
                row.error_shape = error_of_shape(found, right)
            rows.append(row)
    return rows


def facts(rows: list[FormingRun]) -> list[str]:
    """The table in words."""
    lines = []
    for row in rows:
        what = f"{row.method}" + (f", increments of {row.share:g}" if np.isfinite(row.share) else
                                  "") + (f", slope x {row.factor:g}" if np.isfinite(row.factor)
                                         else "")
        lines.append(f"{row.case}: {what}: " + (f"no answer ({row.failure})" if row.failure else
                     f"force {100*row.error_force:.2g} %, shape {100*row.error_shape:.2g} %, "
                     f"{row.increments} increments, {row.iterations} iterations, "
                     f"{row.equivalent:.0f} iterations with a new factor"))
    failed, silent = sum(bool(r.failure) for r in rows), sum(r.silent for r in rows)
    return [*lines, f"{len(rows)} runs, {failed} without an answer, {silent} wrong by more than "
                    "5 % and silent"]


def write_table(rows: list[FormingRun], path: Path) -> None:
    """All rows as CSV."""
    with whole_file(path) as part, part.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(FormingRun.columns())
        writer.writerows(row.values() for row in rows)


def read_table(path: Path) -> list[FormingRun]:
    """The rows of a table written earlier, to be drawn again."""
    with path.open(newline="", encoding="utf-8") as file:
        return [FormingRun.read(row) for row in csv.DictReader(file)]


def is_table(path: Path) -> bool:
    """Whether a table is one of these."""
    with path.open(encoding="utf-8") as file:
        return "error_shape" in file.readline()


def draw(rows: list[FormingRun], path: Path) -> None:
    """Errors of force and shape against the cost, as PNG and SVG."""
    from .draw import COLOR, MARKER, logarithmic
    from .figures import _pyplot

    rows = [row for row in rows if np.isfinite(row.error_force)]
    with _pyplot() as plt:
        fig, axes = plt.subplots(1, 2, figsize=(10.0, 4.7), layout="constrained")
        for ax, name in zip(axes, ("error_force", "error_shape")):
            for method in COLOR:
                for what, group in _groups(rows, method):
                    xs = [row.equivalent for row in group]
                    ys = [max(getattr(row, name), 1e-9) for row in group]
                    ax.plot(xs, ys, "-" if what == "increments" else ":", color=COLOR[method],
                            lw=1.0, alpha=0.7)
                    for row, x, y in zip(group, xs, ys):
                        passed = row.verdict == "PASS"
                        own = np.isnan(row.share) and np.isnan(row.factor)
                        ax.plot(x, y, MARKER[method], color=COLOR[method], ms=11 if own else 6,
                                mfc=COLOR[method] if passed else "white",
                                label=f"{method}: {what}" if row is group[0] else None)
            logarithmic(ax, "cost [Newton iterations with a new factor]",
                        f"error of the {name.removeprefix('error_')}")
        axes[0].legend(fontsize=7.5, frameon=False)
        fig.suptitle(f"{rows[0].case}: beside the exact method in increments of {FINE:g}; large: "
                     "as the deck and the code have it; white: warned", x=0.01, ha="left",
                     fontsize=9.5)
        for suffix in (".svg", ".png"):
            with whole_file(path.with_suffix(suffix)) as part:
                fig.savefig(part, metadata={"Date": None} if suffix == ".svg" else None)


def _groups(rows: list[FormingRun], method: str) -> list[tuple[str, list[FormingRun]]]:
    """Rows of a method by what is varied, in its order."""
    mine = [row for row in rows if row.method == method]
    by_share = sorted((r for r in mine if np.isfinite(r.share)), key=lambda r: -r.share)
    by_factor = sorted((r for r in mine if np.isfinite(r.factor)), key=lambda r: r.factor)
    own = [r for r in mine if np.isnan(r.share) and np.isnan(r.factor)]
    found = [("increments", by_share), ("slope", by_factor), ("default", own)]
    return [(what, group) for what, group in found if group]
