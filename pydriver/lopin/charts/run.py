"""Runs of the work-precision chart: a deck under another method, path and stiffness, and its cost.

The unit of cost is the *equivalent factorisation*: analysis, factorisation and solution of one
linear system of the same mesh without contact, measured in the same session. The unit of stiffness
is 1/s_min, s_min the least compliance per area of the contact: r = slope times s_min has no unit,
and the pressure error of a penalty is at most 1/(1 + r).
"""
from __future__ import annotations

import os
import time
from dataclasses import dataclass, field, fields

import numpy as np
from numpy.typing import NDArray

from ..deck import Block, Deck
from ..errors import LopinError, UsageError
from ..laws import METHODS
from ..result import Result
from ..run import run
from .scenes import Scene

#: Phases of a run that an equivalent factorisation consists of, and those of contact.
LINEAR, CONTACT = ("analyse", "factorise", "solve"), ("analyse", "factorise", "contact", "solve")
#: A pressure error above this must be warned of.
WRONG = 0.05


@dataclass(frozen=True)
class Setting:
    """How a scene is solved; without r the stiffness is left to the code."""

    method: str
    path: str = "condensed"
    r: float | None = None           #: slope times s_min [-]
    tolerance: float | None = None   #: penetration that the augmented method accepts [facet]

    def deck(self, deck: Deck, least: float) -> Deck:
        """The deck solved this way; `least` is s_min [length/stress]."""
        slope = None if self.r is None else self.r/least
        new = with_method(deck, self.method, slope)
        cards = [Block("LOPIN", _parameters(new, "LOPIN") | {"PATH": self.path.upper()})]
        if self.tolerance is not None:
            cards.append(Block("CONTACT CONTROLS", {
                "RELATIVE PENETRATION TOLERANCE": self.tolerance, "MAX AUGMENTATIONS": 200}))
            new.blocks = [b for b in new.blocks if b.keyword != "CONTACT CONTROLS"]
        new.blocks = [b for b in new.blocks if b.keyword != "LOPIN"]
        step = new.blocks.index(new["*STEP"])
        new.blocks[step:step] = cards
        return new


@dataclass
class Run:
    """A row of the table: a setting on a mesh, what it cost and how wrong it was."""

    case: str
    method: str
    path: str
    element: str
    h: float
    n_dof: int = 0
    slope: float = np.nan
    r: float = np.nan
    tolerance: float = np.nan
    default: bool = False             #: the stiffness was left to the code
    increments: int = 0
    iterations: int = 0
    augmentations: int = 0
    factorisations: int = 0
    back_solves: int = 0
    wall_s: float = np.inf            #: the whole run, least of the repetitions
    equivalent: float = np.nan        #: equivalent factorisations
    peak_mb: float = np.nan           #: of the process
    error_enforcement: float = np.nan
    error_total: float = np.nan
    estimate: float = np.nan          #: of the enforcement error, by the certificate
    verdict: str = ""
    failure: str = ""                 #: diagnostic of a run without an answer
    setting: Setting | None = field(default=None, repr=False)
    least: dict[str, float] = field(default_factory=dict, repr=False)   #: seconds by phase
    pressure: NDArray | None = field(default=None, repr=False)

    @property
    def silent(self) -> bool:
        """Wrong by enforcement, and nobody said so."""
        return self.verdict == "PASS" and self.error_enforcement > WRONG

    @classmethod
    def columns(cls) -> list[str]:
        return [f.name for f in fields(cls) if f.name not in ("setting", "least", "pressure")]

    @classmethod
    def read(cls, texts: dict[str, str]) -> Run:
        """The row of texts that `values` gave."""
        kinds = {f.name: str(f.type) for f in fields(cls)}
        read = {"float": lambda t: float(t or "nan"), "int": int, "str": str,
                "bool": lambda t: t == "True"}
        return cls(**{name: read[kinds[name]](text) for name, text in texts.items()})

    def values(self) -> list[str]:
        """The row as text; nothing where nothing is known."""
        raw = [getattr(self, name) for name in self.columns()]
        return ["" if isinstance(v, float) and not np.isfinite(v) else
                f"{v:.6g}" if isinstance(v, float) else str(v) for v in raw]


def light(deck: Deck) -> Deck:
    """The same deck, its long tables turned to text once and for all."""
    return Deck([Block(b.keyword, b.parameters, text=b.text()) if len(b.lines) > 20 else b
                 for b in deck.blocks], preamble=deck.preamble, name=deck.name, folder=deck.folder)


def with_method(deck: Deck, method: str, slope: float | None) -> Deck:
    """The deck with another contact method in every interaction; the rest is shared."""
    if "*SURFACE BEHAVIOR" not in deck:
        raise UsageError(f"{deck.name} has no *SURFACE BEHAVIOR to vary")
    blocks = []
    for block in deck.blocks:
        if block.keyword == "SURFACE BEHAVIOR":
            kept = {k: v for k, v in block.parameters.items() if k == "NO SEPARATION"}
            block = Block(block.keyword, {METHODS[method].word: None} | kept,
                          [] if slope is None else [[float(slope)]])
        blocks.append(block)
    return Deck(blocks, preamble=deck.preamble, name=deck.name, folder=deck.folder)


def _parameters(deck: Deck, keyword: str) -> dict:
    return dict(deck[keyword].parameters) if keyword in deck else {}


def without_contact(deck: Deck) -> Deck:
    """The same mesh, supports and loads, and no contact."""
    blocks = [b for b in deck.blocks if not b.keyword.startswith("CONTACT")
              and b.keyword not in ("CLEARANCE", "SURFACE INTERACTION", "SURFACE BEHAVIOR")]
    return Deck(blocks, preamble=deck.preamble, name=f"{deck.name}-linear", folder=deck.folder)


def answer(deck: Deck) -> tuple[Result | None, str]:
    """The result, also one whose certificate fails; else None and the diagnostic."""
    try:
        return run(deck), ""
    except LopinError as problem:
        if problem.id == "E0504" and getattr(problem, "result", None) is not None:
            return problem.result, ""
        return None, problem.id or type(problem).__name__


def pressures(result: Result) -> tuple[NDArray, NDArray]:
    """Pressures and areas of all slave points at the end."""
    ends = [result.contact(k).last for k in range(len(result.pairs))]
    return (np.concatenate([np.ravel(c.pressure) for c in ends]),
            np.concatenate([np.ravel(c["weight"]) for c in ends]))


def least_compliance(result: Result, target: float = 0.01) -> float:
    """s_min from a penalty run that chose its stiffness, (1/target - 1)/s_min."""
    ends = [result.contact(k).last for k in range(len(result.pairs))]
    pressure, gap = (np.concatenate([np.ravel(c[k]) for c in ends]) for k in ("pressure", "gap"))
    if not (gap < 0.0).any():
        raise UsageError("nothing touches in this deck: there is no accuracy to compare")
    return (1.0/target - 1.0)/float(np.median(pressure[gap < 0.0]/-gap[gap < 0.0]))


def relative(values: NDArray, exact: NDArray, weight: NDArray) -> float:
    """Weighted L2 norm of a difference over that of the exact values."""
    return float(np.sqrt((weight*(values - exact)**2).sum()/(weight*exact**2).sum()))


def once(scene: Scene, deck: Deck) -> tuple[Result | None, dict[str, float], float, str]:
    """One run: result, seconds by phase, peak memory [MiB], diagnostic of a failure."""
    forget_peak()
    begin = time.perf_counter()
    result, failure = answer(deck)
    if result is None:
        return None, {"total": time.perf_counter() - begin}, np.nan, failure
    summary = result.summary
    return result, summary["timing"], summary["peak_memory_mib"], ""


def forget_peak() -> None:
    """Start the system's count of peak memory again, where it allows."""
    if os.path.exists("/proc/self/clear_refs"):
        try:
            with open("/proc/self/clear_refs", "w", encoding="ascii") as file:
                file.write("5")
        except OSError:
            pass
