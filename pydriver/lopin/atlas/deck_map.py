"""A map of a user's deck over two of its numbers: where it is certified, warned of, stopped.

A place is KEYWORD:field, a field (from 1) of the first data line of the first such card;
KEYWORD#2:field of the second card; KEYWORD:PARAMETER. Values follow: 0,0.1,0.2 or 1e-3..1/7, seven
values from the first to the last, in equal ratios if both are positive and a decade apart.

With a quantity each cell has its value, and with `halved` a second run in increments of half the
length, from which it may differ by less than `WRONG` if nobody warned.
"""
from __future__ import annotations

import csv
import hashlib
import json
import re
from collections.abc import Callable
from dataclasses import dataclass
from itertools import product
from pathlib import Path

import numpy as np

from ..accuracy import Quantity
from ..accuracy.increments import with_smaller
from ..accuracy.reach import without_question
from ..charts.rows import TableRow
from ..charts.run import WRONG, answer
from ..deck import Deck
from ..errors import UsageError
from ..files import whole_file
from ..model_read_mesh import plain
from ..sweep import put

_PLACE = re.compile(r"\*?\s*([A-Za-z][\w \-]*?)(#\d+)?:([^=]+)=(.+)")

PLACES = "write KEYWORD:field of the first data line of the first such card, KEYWORD#2:field of " \
    "the second, or KEYWORD:PARAMETER; fields count from 1"
CLASSES = {"certified": "#d9ecd9", "warned": "#f0e2b6", "refused": "#f4a582",
           "no answer": "#c9c9c9", "silent": "#ff0000"}


@dataclass(frozen=True)
class Axis:
    """A place in the deck and its values."""

    label: str
    place: str
    values: tuple[float, ...]

    @classmethod
    def of(cls, text: str) -> Axis:
        """From the words of an option.

        >>> Axis.of("FRICTION:1=0,0.1,0.2").values
        (0.0, 0.1, 0.2)
        >>> Axis.of("STEP:INC=10..1000/3")
        Axis(label='STEP:INC', place='*STEP:INC', values=(10.0, 100.0, 1000.0))
        """
        match = _PLACE.fullmatch(text.strip())
        if not match:
            raise UsageError(f"'{text}' is no place with values",
                             help="FRICTION:1=0,0.1,0.2 or STATIC:1=1e-3..1/7")
        keyword, number = match[1].strip().upper(), match[2] or ""
        where, values = match[3], match[4]
        where = where.strip()
        if where.isdigit():
            if where == "0":
                raise UsageError(f"'{text}': fields count from 1")
            place = f"*{keyword}{number}:0:{int(where) - 1}"
        else:
            place = f"*{keyword}{number}:{where.upper()}"
        return cls(f"{keyword}{number}:{where}", place, _values(values, text))

    @property
    def logarithmic(self) -> bool:
        """Whether the values span a decade and are all positive."""
        return min(self.values) > 0.0 and max(self.values) >= 10.0*min(self.values)


def _values(text: str, whole: str) -> tuple[float, ...]:
    """The numbers of a list or a range."""
    try:
        match = re.fullmatch(r"(.+)\.\.(.+)/(\d+)", text)
        if not match:
            found = tuple(float(v) for v in text.split(","))
            if not np.isfinite(found).all():
                raise ValueError
            return found
        first, last, count = float(match[1]), float(match[2]), int(match[3])
        if count < 2 or not np.isfinite([first, last]).all():
            raise ValueError
        grows = min(first, last) > 0.0 and max(first, last) >= 10.0*min(first, last)
        make = np.geomspace if grows else np.linspace
        return tuple(float(f"{v:.6g}") for v in make(first, last, count))
    except ValueError:
        raise UsageError(f"'{whole}': '{text}' are no values",
                         help="numbers with commas between, or first..last/count") from None


@dataclass
class DeckCell(TableRow):
    """A run of the map."""

    row: int
    x: float
    y: float
    kind: str = ""             #: one of CLASSES
    value: float = np.nan
    change: float = np.nan     #: relative, in increments of half the length
    increments: int = 0
    iterations: int = 0
    said: str = ""             #: codes of warnings, or of the failure
    DIGITS = 8


@dataclass
class DeckMap:
    """A deck, what is varied, what is read.

    Attributes
    ----------
    deck, x, y : the scene and its two axes; y may be None
    quantity : its value in each cell; None: none
    halved : run each cell in increments of half the length, too
    """

    deck: Deck
    x: Axis
    y: Axis | None = None
    quantity: Quantity | None = None
    halved: bool = False

    def __post_init__(self):
        # Includes in their place, so that their numbers can be varied as well.
        # Nobody is asked how well a cell is known: a run of it would warn of that (W0344).
        self.deck = without_question(self.deck)
        first = self.deck_of(self.x.values[0], self.y.values[0] if self.y else 0.0)
        if self.y and first.text() == self.deck_of(self.x.values[0] + 1.0,
                                                   self.y.values[0]).text():
            raise UsageError(f"--x and --y are the same place of the deck ({self.y.label})",
                             help="give two places, or one axis")

    def deck_of(self, x: float, y: float) -> Deck:
        """The deck of a cell."""
        copy = Deck.parse(self.deck.text(), name=self.deck.name, folder=self.deck.folder)
        for axis, value in ((self.x, x), (self.y, y)):
            if axis is not None:
                try:
                    put(copy, axis.place, int(value) if float(value).is_integer() else value)
                except UsageError:
                    raise UsageError(f"{axis.label} is no place in the deck", help=PLACES) from None
        return copy

    def places(self) -> list[DeckCell]:
        """Cells that are not run yet."""
        ys = self.y.values if self.y else (0.0,)
        return [DeckCell(k, x, y) for k, (y, x) in enumerate(product(ys, self.x.values))]

    def run(self, cell: DeckCell) -> None:
        """Fill a cell."""
        deck = self.deck_of(cell.x, cell.y)
        result, failure = answer(deck)
        if result is None:
            cell.kind, cell.said = "no answer", failure
            return
        codes = sorted({w.partition(":")[0] for w in result.warnings})
        cell.said = " ".join(codes)
        cell.kind = "refused" if result.verdict == "FAIL" else \
            "certified" if result.verdict == "PASS" and not codes else "warned"
        steps = result.summary["steps"]
        cell.increments = sum(step["increments"] for step in steps)
        cell.iterations = sum(step["iterations"] for step in steps)
        if self.quantity is None:
            return
        cell.value = self.quantity.value(result, deck)
        if self.halved:
            again, _ = answer(with_smaller(deck, result, 0.5))
            if again is not None:
                value = self.quantity.value(again, deck)
                apart = self.quantity.difference(again, result, (value, cell.value))
                cell.change = apart/abs(value) if value else np.nan
                if cell.kind == "certified" and cell.change > WRONG:
                    cell.kind = "silent"

    def told(self) -> dict[str, str]:
        """What a cell hangs on beside its two numbers."""
        digest = hashlib.sha256(self.deck.text().encode("utf-8", "surrogateescape"))
        for block in self.deck.blocks:   # a tool in a file of its own
            path = self.deck.folder/str(plain(block.parameters.get("INPUT") or ""))
            if path.is_file():
                digest.update(path.read_bytes())
        return {"deck": digest.hexdigest(), "--x": self.x.place,
                "--y": self.y.place if self.y else "", "--quantity": str(self.quantity or ""),
                "--halved": "yes" if self.halved else "no"}

    def measure(self, table: Path, batch: int | None, say: Callable[[str], None]
                ) -> list[DeckCell]:
        """All cells; those that the table holds are not run again."""
        if batch is not None and batch < 0:
            raise UsageError(f"--batch {batch}: a number of cells, not below 0")
        cells, kept, own = self.places(), table.with_suffix(".map.json"), self.told()
        if table.is_file():
            refuse_another(table, kept, own)
            done = {(c.x, c.y): c for c in read_cells(table)}
            cells = [done.get((float(f"{c.x:.8g}"), float(f"{c.y:.8g}")), c) for c in cells]
            for number, cell in enumerate(cells):
                cell.row = number
        with whole_file(kept) as part:
            part.write_text(json.dumps(own, indent=1) + "\n", encoding="utf-8")
        todo = [c for c in cells if not c.kind][:batch]
        for cell in todo:
            self.run(cell)
            say(f"{self.x.label}={cell.x:g}" + (f" {self.y.label}={cell.y:g}" if self.y else "")
                + f": {cell.kind} {cell.said}")
            write_cells(cells, table)
        write_cells(cells, table)
        return [c for c in cells if c.kind]


def refuse_another(table: Path, kept: Path, own: dict[str, str]) -> None:
    """Raise if the cells of a table are those of another map."""
    remedy = "another folder by -o, or a new map in its place without --resume"
    if not kept.is_file():
        raise UsageError(f"{table} cannot be resumed: there is no {kept.name} beside it, which "
                         "says of which map it is", help=remedy)
    before = json.loads(kept.read_text(encoding="utf-8"))
    other = [f"its {name} is another" if name == "deck" else
             f"its {name} is {before.get(name) or 'not given'}"
             for name, value in own.items() if before.get(name) != value]
    if other:
        raise UsageError(f"{table} is of another map and cannot be resumed: {', '.join(other)}",
                         help=remedy)


def write_cells(cells: list[DeckCell], path: Path) -> None:
    """Cells that have been run, as CSV."""
    with whole_file(path, lasting=False) as part, part.open("w", newline="",
                                                            encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(DeckCell.columns())
        writer.writerows(c.values() for c in cells if c.kind)


def read_cells(path: Path) -> list[DeckCell]:
    """Of a table."""
    with path.open(newline="", encoding="utf-8") as file:
        return [DeckCell.read(row) for row in csv.DictReader(file)]


def facts(cells: list[DeckCell]) -> list[str]:
    """The map in words."""
    count = {kind: sum(c.kind == kind for c in cells) for kind in CLASSES}
    lines = [f"{len(cells)} runs: " + ", ".join(f"{n} {kind}" for kind, n in count.items() if n)]
    for kind in ("silent", "no answer", "refused"):
        for c in [c for c in cells if c.kind == kind][:5]:
            lines.append(f"  {kind}: cell {c.row}, x = {c.x:g}, y = {c.y:g} {c.said}")
    return lines


def draw(chart: DeckMap, cells: list[DeckCell], path: Path) -> None:
    """A square for each cell, its class as colour, its value or increments as text."""
    from ..charts.figures import _pyplot

    with _pyplot() as plt:
        xs, ys = chart.x.values, chart.y.values if chart.y else (0.0,)
        fig, ax = plt.subplots(figsize=(1.8 + 0.8*len(xs), 2.0 + 0.5*len(ys)),
                               layout="constrained")
        for c in cells:
            i, j = _nearest(xs, c.x), _nearest(ys, c.y)
            ax.add_patch(plt.Rectangle((i - 0.5, j - 0.5), 1.0, 1.0, fc=CLASSES[c.kind],
                                       ec="white"))
            text = c.said.split(" ")[0] if c.kind == "no answer" else \
                f"{c.value:.4g}" if np.isfinite(c.value) else f"{c.increments}"
            if c.kind in ("warned", "refused"):
                text += "\n" + c.said.split(" ")[0]
            ax.text(i, j, text, ha="center", va="center", fontsize=7)
        ax.set(xlim=(-0.5, len(xs) - 0.5), ylim=(-0.5, len(ys) - 0.5), xlabel=chart.x.label,
               ylabel=chart.y.label if chart.y else "")
        ax.set_xticks(range(len(xs)), [f"{v:.3g}" for v in xs], fontsize=7)
        ax.set_yticks(range(len(ys)), [f"{v:.3g}" for v in ys] if chart.y else [""], fontsize=7)
        used = [k for k in CLASSES if any(c.kind == k for c in cells)]
        ax.legend([plt.Rectangle((0, 0), 1, 1, fc=CLASSES[k]) for k in used], used, ncols=len(used),
                  loc="lower left", bbox_to_anchor=(0.0, 1.0), frameon=False, fontsize=7.5)
        fig.suptitle(f"{chart.deck.name}: "
                     + (str(chart.quantity) if chart.quantity else "increments"), fontsize=9)
        for suffix in (".svg", ".png"):
            with whole_file(path.with_suffix(suffix)) as part:
                fig.savefig(part, metadata={"Date": None} if suffix == ".svg" else None)


def _nearest(values: tuple[float, ...], value: float) -> int:
    return int(np.argmin(np.abs(np.array(values) - value)))
