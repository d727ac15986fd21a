"""`lopin chart DECK --quantity ...`: one number over methods, elements, meshes and increments."""
from __future__ import annotations

import math
import sys
from pathlib import Path

import numpy as np

from ..accuracy import Quantity
from ..deck import Deck
from ..errors import UsageError
from ..laws import METHODS
from . import cases
from .front import draw


def chart_of_a_number(options, name: str, table: bool) -> int:
    """The table, the picture, and the table in words; the exit code."""
    besides = [(path, cases.read_cases(path)) for path in options.beside]   # before all runs
    if options.exact is not None and not math.isfinite(options.exact):
        raise UsageError(f"--exact {options.exact}: a number")
    if table:
        rows, what = cases.read_cases(Path(options.deck)), name
    else:
        rows, what = _measured(options)
    for path, found in besides:
        rows += _beside(path, found, rows)
    options.output.mkdir(parents=True, exist_ok=True)
    cases.write_cases(rows, options.output/f"{name}.csv")
    draw(rows, what, options.output/name)
    print("\n".join(cases.facts(rows)))
    if cases.busy():
        print(cases.busy(), file=sys.stderr)
    print(options.output/f"{name}.png")
    return 1 if cases.silent(rows) else 0


def _measured(options) -> tuple[list[cases.Case], str]:
    """The runs that the options ask for, and a title."""
    deck = Deck.read(options.deck)
    asked = Quantity.of(deck)
    if options.quantity:
        quantity = Quantity(" ".join(options.quantity.upper().split()), options.set.upper(),
                            options.component)
    elif asked:
        quantity = asked[0]
    else:
        raise UsageError("of which number? --quantity FORCE",
                         help="PRESSURE, 'PEAK PRESSURE', FORCE, 'PEAK FORCE', DISPLACEMENT, "
                              "SPRINGBACK")
    methods = _words(options.methods)
    for method in methods:
        if method not in METHODS:
            raise UsageError(f"--methods {method} is not known", help=", ".join(METHODS))
    chart = cases.Chart(deck, quantity, exact=options.exact, methods=methods,
                        elements=_words(options.elements.upper()),
                        meshes=_numbers("--meshes", options.meshes, int) or [0, 1],
                        increments=_numbers("--increments", options.increments, float) or [1.0],
                        say=lambda line: print(line, file=sys.stderr, flush=True))
    rows = chart.measure()
    if options.ccx:
        from .calculix import beside

        rows += beside(chart)
    return rows, f"{deck.name}: {quantity}"


def _words(text: str) -> list[str]:
    return [word.strip() for word in text.split(",") if word.strip()]


def _numbers(option: str, text: str, kind) -> list:
    try:
        found = [kind(word) for word in _words(text)]
    except ValueError:
        found = [-1]
    if any(not math.isfinite(v) or v < 0 or (kind is float and v <= 0) for v in found):
        raise UsageError(f"{option} {text}: numbers, separated by commas")
    return found


def _beside(path: Path, found: list[cases.Case], rows: list[cases.Case]) -> list[cases.Case]:
    """Rows of another program; values become errors beside the value that the chart's rows have."""
    right = next((r.right for r in rows if np.isfinite(r.right)), np.nan)
    for row in found:
        if not row.answered and np.isfinite(row.value):
            if np.isnan(right):
                raise UsageError(f"{path}: the chart knows no right value for its values",
                                 help="give errors, or --exact")
            row.right, row.error = right, abs(row.value - right)/abs(right)
    return found
