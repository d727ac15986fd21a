"""Error against cost of one number of any deck: methods, elements, meshes and increments.

The error is that beside a value that is given, or beside the finest run: the default method on
meshes of half the size of the finest in the chart, of second order if any of its elements is.
Cost is the least CPU time of repeated runs, also beside one linear solve of the deck's own mesh
without contact.
"""
from __future__ import annotations

import csv
import os
import time
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import product
from pathlib import Path

import numpy as np

from ..accuracy import Quantity
from ..accuracy.increments import with_smaller
from ..accuracy.reach import without_question
from ..deck import Block, Deck
from ..errors import LopinError, UsageError
from ..files import whole_file
from ..refine import of_second_order, refined
from ..refine.subdivide import cell_of
from ..result import Result
from .forming import behaved
from .rows import TableRow
from .run import LINEAR, answer, forget_peak, with_method, without_contact

#: The least time of a run has settled when so many more runs leave it within `STEADY`.
QUIET, STEADY, MOST, LONG = 2, 0.03, 8, 20.0
#: A run without a word that is off by so much more than another method on its mesh is counted.
WRONG = 0.05


@dataclass
class Case(TableRow):
    """A row of the table."""

    case: str
    program: str = "lopin"
    method: str = ""             #: of contact; empty: as the deck has it
    element: str = ""            #: word of the solid elements
    mesh: int = 0                #: halvings of the deck's cells
    increments: float = 1.0      #: length beside the deck's own
    equations: int = 0
    value: float = np.nan
    right: float = np.nan        #: what it is compared with
    error: float = np.nan        #: relative
    seconds: float = np.nan      #: CPU, least of the repetitions
    repetitions: int = 0
    linear: float = np.nan       #: linear solves of the deck's mesh
    peak_mb: float = np.nan
    verdict: str = ""
    warned: str = ""             #: codes of its warnings
    failure: str = ""            #: code of a run without an answer
    DIGITS = 8

    @property
    def answered(self) -> bool:
        """Whether it has an error and a cost."""
        return bool(np.isfinite(self.error) and np.isfinite(self.seconds))

    @property
    def label(self) -> str:
        """What it is, in words."""
        words = [w for w in (self.method, self.element) if w]
        words.append(f"mesh/{2**self.mesh}")
        if self.increments != 1.0:
            words.append(f"increments x {self.increments:g}")
        return ("" if self.program == "lopin" else self.program + " ") + " ".join(words)


def read_cases(path: Path) -> list[Case]:
    """The rows of a table, also of another program: case, program, seconds and value or error are
    enough."""
    known = Case.columns()
    rows = []
    with path.open(newline="", encoding="utf-8-sig") as file:
        for number, texts in enumerate(csv.DictReader(file), start=2):
            given = {k: v for k, v in texts.items() if k in known and v}
            if "failure" not in given and not (
                    "seconds" in given and {"value", "error"} & set(given)):
                raise UsageError(f"{path}:{number}: a row needs seconds, and value or error",
                                 help="columns: " + ", ".join(known))
            try:
                rows.append(Case.read({"case": path.stem} | given))
            except ValueError as problem:
                raise UsageError(f"{path}:{number}: {problem}") from problem
    if not rows:
        raise UsageError(f"{path} has no rows", help="columns: " + ", ".join(known))
    return rows


def is_table(path: Path) -> bool:
    """Whether a table is one of these."""
    with path.open(encoding="utf-8-sig") as file:
        return {"program", "seconds", "error"} <= set(file.readline().strip().split(","))


def write_cases(rows: list[Case], path: Path) -> None:
    """All rows as CSV."""
    with whole_file(path) as part, part.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(Case.columns())
        writer.writerows(row.values() for row in rows)


def with_elements(deck: Deck, word: str) -> Deck:
    """The deck with another solid element: on the same nodes, or of second order."""
    word = word.upper()
    words = {str(b.parameters["TYPE"]).upper() for b in deck.all("ELEMENT")
             if cell_of(str(b.parameters["TYPE"]))}
    cells = {cell_of(w) for w in words}
    if not cell_of(word):
        raise UsageError(f"--elements {word} is no solid element")
    if word[:3] not in {w[:3] for w in words}:
        raise UsageError(f"--elements {word}: the deck has {', '.join(sorted(words))}")
    if cell_of(word) not in cells:
        deck = of_second_order(deck).deck
        made = {cell_of(str(b.parameters["TYPE"])) for b in deck.all("ELEMENT")} - {None}
        if cell_of(word) not in made:
            raise UsageError(f"--elements {word} has other nodes than {', '.join(sorted(words))}")
    blocks = []
    for block in deck.blocks:
        if block.keyword == "ELEMENT" and cell_of(str(block.parameters["TYPE"])) == cell_of(word):
            lines = block.lines
            block = Block("ELEMENT", block.parameters | {"TYPE": word})
            block.lines = lines
        blocks.append(block)
    return Deck(blocks, preamble=deck.preamble, name=deck.name, folder=deck.folder)


class Chart:
    """All runs of a deck, and what they found.

    Parameters
    ----------
    deck, quantity : what is run, and the number that is compared
    exact : its value; None: that of the finest run
    methods : names of contact methods; none: as the deck has it
    elements : words; none: as the deck has them
    meshes : halvings of the deck's cells
    increments : their lengths beside the deck's own
    """

    def __init__(self, deck: Deck, quantity: Quantity, *, exact: float | None = None,
                 methods: Iterable[str] = (), elements: Iterable[str] = (),
                 meshes: Iterable[int] = (0, 1), increments: Iterable[float] = (1.0,),
                 say=lambda line: None):
        self.deck, self.quantity, self.exact, self.say = \
            behaved(without_question(deck)), quantity, exact, say
        self.methods, self.elements = list(methods) or [""], list(elements) or [""]
        self.meshes, self.increments = sorted(set(meshes)), sorted(set(increments), reverse=True)
        self.meshed = {("", 0): self.deck}
        self.linear = self.right = np.nan
        self.own: Result | None = None      #: the run of the deck as it is

    def measure(self) -> list[Case]:
        """A row for each combination."""
        self.linear = self._linear_solve()
        rows, kept = [], []
        todo = list(product(self.elements, self.meshes, self.increments, self.methods))
        for element, mesh, share, method in todo:
            row = Case(self.deck.name, method=method, element=element, mesh=mesh, increments=share)
            result = self._run(row)
            rows.append(row)
            kept.append(result)
            self.say(f"{row.label}: {row.failure or format(row.value, '.7g')}, "
                     f"{row.seconds:.3g} s")
        self._judge(rows, kept)
        return rows

    def _linear_solve(self) -> float:
        """CPU seconds of analysis, factorisation and solution of the deck's mesh, no contact."""
        found = []
        for _ in range(3):
            result, _ = answer(without_contact(self.deck))
            if result is not None:
                found.append(sum(result.summary["timing"].get(k, 0.0) for k in LINEAR))
        return min(found, default=np.nan)

    def mesh_of(self, element: str, mesh: int) -> Deck:
        if (element, mesh) not in self.meshed:
            if element:
                made = with_elements(self.mesh_of("", mesh), element)
            else:
                made = refined(self.mesh_of("", mesh - 1)).deck
            self.meshed[element, mesh] = made
        return self.meshed[element, mesh]

    def _varied(self, row: Case) -> Deck:
        deck = self.mesh_of(row.element, row.mesh)
        if row.method:
            deck = with_method(deck, row.method, None)
        if row.increments != 1.0:
            if self.own is None:
                self.own, failure = answer(self.deck)
                if self.own is None:
                    raise UsageError(f"the deck itself has no answer ({failure}): its increments "
                                     "cannot be varied")
            deck = with_smaller(deck, self.own, row.increments)
        return deck

    def _run(self, row: Case) -> Result | None:
        """Repeat a run until its least time has settled."""
        try:
            deck = self._varied(row)
        except LopinError as problem:
            row.failure = problem.id or str(problem).split("\n")[0]
            return None
        found, best, quiet, begun = None, np.inf, 0, time.monotonic()
        while quiet < QUIET and row.repetitions < MOST and time.monotonic() - begun < LONG:
            forget_peak()
            begin = time.process_time()
            result, row.failure = answer(deck)
            spent = time.process_time() - begin
            row.repetitions += 1
            quiet = 0 if spent < (1.0 - STEADY)*best else quiet + 1
            best = min(best, spent)
            if result is None:
                break
            found = result
        row.seconds, row.linear = best, best/self.linear
        if found is not None:
            row.equations, row.verdict = found.summary["equations"], found.verdict
            row.peak_mb = found.summary["peak_memory_mib"]
            row.warned = " ".join(sorted({w.partition(":")[0] for w in found.warnings}))
            row.value = self.quantity.value(found, deck)
        return found

    def _judge(self, rows: list[Case], kept: list[Result | None]) -> None:
        """Errors beside the exact value, or the finest run."""
        right, best = self.exact, None
        if right is None:
            finest = Case(self.deck.name, element=max(self.elements, key=_order),
                          mesh=self.meshes[-1] + 1,
                          increments=0.5*self.increments[-1] if len(self.increments) > 1 else 1.0)
            deck = self._varied(finest)
            best, failure = answer(deck)
            if best is None:
                raise UsageError(f"the finest run has no answer ({failure})",
                                 help="give the right value by --exact")
            right = self.quantity.value(best, deck)
        self.right = right
        if right == 0.0:
            raise UsageError(f"the {self.quantity} is 0: it has no relative error")
        for row, result in zip(rows, kept):
            if result is None:
                continue
            apart = abs(row.value - right) if best is None else \
                self.quantity.difference(best, result, (right, row.value))
            row.right, row.error = right, apart/abs(right)


def _order(word: str) -> int:
    """Of the shape functions of an element; 0: as the deck has it."""
    return 0 if not word else 2 if (cell_of(word) or "")[-1:].isdigit() else 1


def front(rows: list[Case]) -> list[Case]:
    """The runs that no other beats in error and cost at once, by cost."""
    found, least = [], np.inf
    for row in sorted((r for r in rows if r.answered), key=lambda r: (r.seconds, r.error)):
        if row.error < least:
            found.append(row)
            least = row.error
    return found


def silent(rows: list[Case]) -> list[Case]:
    """Runs that are off by more than another method on the same mesh, and nobody said so."""
    least: dict[tuple, float] = {}
    for row in rows:
        if row.answered and row.program == "lopin":
            key = (row.element, row.mesh, row.increments)
            least[key] = min(row.error, least.get(key, np.inf))
    return [row for row in rows if row.answered and row.program == "lopin" and not row.warned
            and row.verdict == "PASS"
            and row.error > least[row.element, row.mesh, row.increments] + WRONG]


def busy() -> str:
    """A warning where the machine has more to do than this; nothing where it is quiet."""
    try:
        load = os.getloadavg()[0]
    except OSError:
        return ""
    count = os.cpu_count() or 1
    return "" if load <= count else f"the machine is busy (load {load:.1f} on {count} " \
        "processors): times are CPU times, and yet up to a third too long"


def facts(rows: list[Case]) -> list[str]:
    """The table in words."""
    best = front(rows)
    lines = [f"{'':2} {'error %':>9} {'CPU s':>9} {'linear':>7} {'MiB':>7}  run"]
    for row in sorted(rows, key=lambda r: (not r.answered, r.seconds)):
        mark = "*" if row in best else " "
        lines.append(f"{mark:2} " + (f"{100.0*row.error:9.3g} {row.seconds:9.3g} {row.linear:7.3g} "
                                     f"{row.peak_mb:7.0f}  {row.label}" if row.answered else
                                     f"{'no answer':>9} {row.seconds:9.3g} {'':7} {'':7}  "
                                     f"{row.label} ({row.failure})")
                     + (f" [{row.warned}]" if row.warned else ""))
    failed = sum(bool(r.failure) for r in rows)
    return [*lines, f"{len(rows)} runs, {failed} without an answer, {len(silent(rows))} silent and "
                    f"off by {100*WRONG:g} % more than another method on their mesh; *: no other "
                    "run is both cheaper and better"]
