"""Cells of the stability atlas and their classes.

F0 is what every cell should be. F1 must not exist: an error above 5 % against the exact solution of
the same equations, and nobody said so. An answer that is wrong *and said so* (the certificate warns
or refuses) has its own letter, W: it is no failure of the solver, but no F0 either.
"""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..charts.rows import TableRow
from ..charts.run import WRONG, pressures, relative
from ..deck import Deck
from ..errors import NotConvergedError, SingularError
from ..run import run

CLASSES = {
    "F0": "converged and certified",
    "W": "inaccurate, and said so",
    "F1": "wrong and silent",
    "F2": "iteration cap",
    "F3": "cycling",
    "F4": "divergence",
    "F5": "linear solver",
    "F6": "non-physical",
    "F7": "several answers",
}
#: What the codes of runs without an answer mean; every other one says that the system is singular.
_CODES = {"E0501": "F3", "E0502": "F2", "E0503": "F2", "E0505": "F2", "E0510": "F2", "E0512": "F4",
          "E0520": "F3"}
_WEDGING = "W0520"
#: Facets that do not match make the pressure uneven.
_UNEVEN = "W0333"


@dataclass
class Cell(TableRow):
    """A square of a map: where it is, and what happened there."""

    row: int                      #: number of the cell in its map; ``--cell`` takes it
    panel: str
    x: float
    y: float
    kind: str = "F0"              #: one of CLASSES
    error: float = np.nan         #: against the exact solution of the same equations [-]
    iterations: int = 0
    said: str = ""                #: verdict of the certificate, or the diagnostic
    turned: str = ""              #: its class, turned and in other units


@dataclass
class Outcome:
    """What a cell gives in one frame."""

    kind: str
    error: float = np.nan
    iterations: int = 0
    said: str = ""


def refusal(code: str) -> str:
    """The class of a run that gave no answer."""
    return _CODES.get(code, "F5")


def outcome(deck: Deck, exact: NDArray, stress: float = 1.0) -> Outcome:
    """Run a deck and judge its pressures, in a unit of stress, beside the exact ones."""
    try:
        result, refused = run(deck), ""
    except (NotConvergedError, SingularError) as problem:
        result, refused = getattr(problem, "result", None), problem.id
        if refused != "E0504" or result is None:
            return Outcome(refusal(refused), said=refused)
    pressure, weight = pressures(result)
    pressure = pressure/stress
    verdict = result.summary["certificate"]["verdict"]
    said = " ".join([verdict, *(w.partition(":")[0] for w in result.warnings)])
    error = relative(pressure, exact, weight)
    iterations = sum(step["iterations"] for step in result.summary["steps"])
    return Outcome(_kind(pressure, exact, error, verdict, said), error, iterations, said)


def _kind(pressure: NDArray, exact: NDArray, error: float, verdict: str, said: str) -> str:
    """The class of a run with an answer."""
    if not np.isfinite(error):
        return "F4"
    if verdict != "PASS":
        return "W"
    if _WEDGING in said:
        return "F7"
    if pressure.min() < -1e-6*np.abs(exact).max():
        return "F6"
    if error <= WRONG:
        return "F0"
    return "W" if _UNEVEN in said else "F1"


def exact_pressures(deck: Deck) -> NDArray:
    """Of a deck whose method is exact."""
    return pressures(run(deck))[0]
