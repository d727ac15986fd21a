"""Friction from ring tests: the coefficient with which a deck gives the measured bores."""
from __future__ import annotations

import csv
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .closed_form import ring_bore
from .deck import Deck
from .errors import LopinError, UsageError, optional
from .files import reading
from .model_read_mesh import MeshCards, expanded
from .sweep import put

#: Runs of a fit, and the change of the coefficient at which it ends.
MOST_RUNS, CLOSE = 12, 2e-4
#: Largest coefficients that are tried.
LARGEST = {"TRESCA": 1.0, "COULOMB": 0.57}


@dataclass
class Table:
    """What was measured: heights and inner diameters of rings [length]."""

    height: NDArray
    inner: NDArray

    @classmethod
    def read(cls, path: str | Path) -> Table:
        """From a CSV file with columns `height` and `inner`; lines that begin with # say more."""
        with reading(Path(path)), Path(path).open(newline="") as file:
            rows = list(csv.DictReader((line for line in file if not line.startswith("#")),
                                       skipinitialspace=True))
        try:
            pairs = np.array([[float(r[k]) for k in ("height", "inner")] for r in rows])
        except (KeyError, TypeError, ValueError):
            raise UsageError(f"'{path}' has no numbers in columns height and inner",
                             help="the first line is `height,inner`; a line a ring follows: its "
                             "height and its inner diameter, in the unit of the deck") from None
        if len(pairs) < 2:
            raise UsageError(f"'{path}' has {len(pairs)} rings: an error is told from two on")
        if not (pairs > 0.0).all():
            raise UsageError(f"'{path}': heights and diameters are positive")
        return cls(*pairs.T)


@dataclass
class Fit:
    """A coefficient, and how well it is known.

    Attributes
    ----------
    law : TRESCA (m) or COULOMB (mu)
    value, error : coefficient; its standard deviation, from what the fit leaves over
    within : half of the interval that holds it with 95 % (Student's distribution)
    rms : root of the mean square of what is left of the diameters [length]
    left : measured less computed diameters [length]
    runs : coefficients that were run
    """

    law: str
    value: float
    error: float
    within: float
    rms: float
    left: NDArray
    runs: list[float]

    def line(self) -> str:
        """For a terminal."""
        name = {"TRESCA": "m", "COULOMB": "mu"}[self.law]
        return (f"{name} = {self.value:.4f} +- {self.within:.4f} (95 %, {len(self.left)} rings); "
                f"diameters are met within {self.rms:.3g} (rms), {np.abs(self.left).max():.3g} at "
                f"most; {len(self.runs)} runs")


def fit(curve: Callable[[float], NDArray], measured: NDArray, start: float, most: float,
        law: str = "TRESCA", say: Callable[[str], None] = lambda line: None) -> Fit:
    """Least squares of one coefficient by Gauss and Newton, slopes from the last two runs.

    Parameters
    ----------
    curve : computed diameters at the measured heights, of a coefficient
    measured : diameters [length]
    start, most : first coefficient; largest one, the least is 0
    """
    p = float(np.clip(start, 0.01*most, 0.9*most))
    runs, found = [p], [curve(p)]
    p = p + 0.05*most if p < 0.5*most else p - 0.05*most
    slope = None
    while len(runs) < MOST_RUNS:
        runs.append(p)
        found.append(curve(p))
        say(f"{p:.4f}: {_rms(measured - found[-1]):.4g} rms")
        slope = (found[-1] - found[-2])/(runs[-1] - runs[-2])
        if not slope @ slope > 0.0:
            raise UsageError("the bore does not change with the coefficient",
                             help="rings that stick (m near 1) do not tell it; test with less "
                             "friction, or to smaller heights")
        best = int(np.argmin([_rms(measured - f) for f in found]))
        step = float(slope @ (measured - found[-1])/(slope @ slope))
        p = float(np.clip(runs[-1] + step, 0.0, most))
        if abs(p - runs[-1]) < CLOSE:
            best = len(runs) - 1
            break
    else:
        raise UsageError(f"no coefficient was settled on in {MOST_RUNS} runs; the best is "
                         f"{runs[best]:.4f}")
    left = measured - found[best]
    n = len(left)
    error = float(np.sqrt(left @ left/(n - 1)/(slope @ slope)))
    t = float(optional("scipy.special", "errors of fits").stdtrit(n - 1, 0.975))
    return Fit(law, runs[best], error, t*error, _rms(left), left, runs)


def _rms(left: NDArray) -> float:
    return float(np.sqrt(np.mean(left**2)))


@dataclass
class Ring:
    """The deck of a ring between flat plates, and where its bore is.

    Attributes
    ----------
    deck : axisymmetric, with one *FRICTION
    bore : node set
    place : `middle` of the height, at the `plate`, or the `mean` of both sides' whole bore
    half : a plane at an end of the ring is held along the axis: the deck has half of its height
    labels : of the nodes of the bore
    lower : that plane is the upper one: the deck has the lower half
    """

    deck: Deck
    bore: str
    place: str
    half: bool
    labels: NDArray
    lower: bool = False

    @classmethod
    def of(cls, deck: Deck, bore: str = "BORE", place: str = "middle") -> Ring:
        """Of a deck; what is missing is said."""
        cards = MeshCards(expanded(deck))
        words = {word for word, _ in cards.elements.values()}
        if not words or not all(w.startswith("CAX") for w in words):
            raise UsageError("identify takes the deck of a ring of axisymmetric elements (CAX)")
        if len(deck.all("FRICTION")) != 1:
            raise UsageError(f"the deck has {len(deck.all('FRICTION'))} cards *FRICTION: the "
                             "coefficient of one is looked for")
        if bore.upper() not in cards.nsets:
            raise UsageError(f"the deck has no node set {bore}",
                             help=f"name that of the bore by --bore: {', '.join(cards.nsets)}")
        body = {n for _, nodes in cards.elements.values() for n in nodes}
        held = {n for block in expanded(deck) if block.keyword == "BOUNDARY" for row in block.data
                if _holds_height(row) for n in body & _nodes(row[0], cards.nsets)}
        side = _held_end({n: cards.nodes[n][1] for n in body}, held)
        return cls(deck, bore.upper(), place, bool(side),
                   np.array(sorted(set(cards.nsets[bore.upper()]) & body)), side == "upper")

    def start(self) -> tuple[float, float, float]:
        """Outer and inner diameter and height before the test [length]."""
        cards = MeshCards(expanded(self.deck))
        body = {n for _, nodes in cards.elements.values() for n in nodes}
        x = np.array([cards.nodes[n][:2] for n in body])
        inner = 2.0*np.mean([cards.nodes[n][0] for n in self.labels])
        return 2.0*x[:, 0].max(), float(inner), (1 + self.half)*float(np.ptp(x[:, 1]))

    def history(self, law: str, value: float) -> tuple[NDArray, NDArray]:
        """Height and inner diameter after each increment of a run [length]."""
        from . import open as open_job

        deck = Deck.parse(self.deck.text(), name=self.deck.name, folder=self.deck.folder)
        block = deck["FRICTION"]
        block.parameters.pop("LAW", None)
        if law != "COULOMB":
            block.parameters["LAW"] = law
        put(deck, "*FRICTION:0:0", value)
        heights, inners = [], []
        cards = MeshCards(expanded(self.deck))
        body = sorted({n for _, nodes in cards.elements.values() for n in nodes})
        x0 = np.array([cards.nodes[n][:2] for n in body])
        bore = np.isin(body, self.labels)
        with open_job(deck) as job:
            for frame in job:
                label = frame["LABEL"].ravel().astype(int)
                order = np.argsort(label)
                x = x0 + frame["U"][order[np.searchsorted(label, body, sorter=order)]][:, :2]
                heights.append((1 + self.half)*np.ptp(x[:, 1]))
                inners.append(2.0*self._radius(x[bore]))
        return np.array(heights), np.array(inners)

    def _radius(self, x: NDArray) -> float:
        """Of the bore at the place that was measured, from its nodes in the present shape."""
        x = x[np.argsort(x[:, 1])]
        r, z = x.T
        middle, plate = (-1, 0) if self.lower else (0, -1)
        if self.place == "plate":
            return float(r[plate])
        if self.place == "mean":
            return float((0.5*(r[1:] + r[:-1])*np.diff(z)).sum()/np.ptp(z))
        return float(r[middle] if self.half else np.interp(0.5*(z[0] + z[-1]), z, r))

    def curve(self, law: str, table: Table) -> Callable[[float], NDArray]:
        """Computed diameters at the heights of a table, of a coefficient."""
        outer, inner, height = self.start()

        def of(value: float) -> NDArray:
            try:
                heights, inners = self.history(law, value)
            except LopinError as problem:
                raise UsageError(f"the run with {value:.4f} ended: {problem.message}",
                                 help="finer increments or a finer mesh in the deck") from problem
            heights, inners = np.r_[height, heights], np.r_[inner, inners]
            if table.height.min() < heights.min()*(1.0 - 1e-9):
                raise UsageError(f"the deck presses the ring to a height of {heights.min():.4g}, "
                                 f"a measured one has {table.height.min():.4g}",
                                 help="press it farther in the deck")
            if table.height.max() > height*(1.0 + 1e-6):
                raise UsageError(f"a measured ring is {table.height.max():.4g} high, that of the "
                                 f"deck {height:.4g} before the test")
            order = np.argsort(heights)
            return np.interp(table.height, heights[order], inners[order])

        return of

    def guess(self, table: Table) -> float:
        """Shear factor by the upper bound of straight walls (Avitzur): what a fit starts from."""
        outer, inner, height = self.start()
        factors = np.linspace(0.0, 1.0, 21)
        off = []
        for m in factors:
            change = [ring_bore(m, max(0.0, 1.0 - h/height), outer/height, inner/height)
                      for h in table.height]
            off.append(_rms(table.inner - inner*(1.0 + np.array(change))))
        return float(factors[int(np.argmin(off))])


def _holds_height(row) -> bool:
    """Whether a line of *BOUNDARY holds direction 2."""
    if len(row) < 2 or (len(row) > 3 and row[3]):
        return False
    if isinstance(row[1], str):
        return row[1].upper() in ("YSYMM", "ENCASTRE", "PINNED")
    last = row[2] if len(row) > 2 and row[2] is not None else row[1]
    return int(row[1]) <= 2 <= int(last)


def _held_end(height: dict[int, float], held: set[int]) -> str:
    """At which end of the ring a plane is held along the axis; empty: at none, the ring is whole.

    Nodes that are held within its height, as against drifting, hold no plane of symmetry.
    """
    z = np.array(list(height.values()))
    ends = {"lower": z.min(), "upper": z.max()}
    found = []
    for side, level in ends.items():
        plane = {n for n, at in height.items() if abs(at - level) <= 1e-6*np.ptp(z)}
        if plane <= held:
            found.append(side)
        elif plane & held:
            raise UsageError(f"{len(plane & held)} of the {len(plane)} nodes of the {side} end of "
                             "the ring are held along the axis: is that its middle, or its plate?",
                             help="hold all of them in half of a ring, none in a whole one")
    if len(found) == 2:
        raise UsageError("both ends of the ring are held along the axis",
                         help="half of a ring is held in the middle of its height")
    return "".join(found)


def _nodes(what, nsets) -> set[int]:
    return {what} if isinstance(what, int) else set(nsets.get(str(what).upper(), []))


def identify(deck: Deck, table: Table, law: str = "", bore: str = "BORE", place: str = "middle",
             say: Callable[[str], None] = print) -> Fit:
    """The coefficient of the deck's friction with which its ring has the measured bores.

    Parameters
    ----------
    deck : of a ring, whole or half of its height, the upper or the lower
    table : what was measured
    law : TRESCA or COULOMB; that of the deck if empty
    bore : node set of the bore
    place : where diameters were measured: middle, plate or mean
    """
    ring = Ring.of(deck, bore, place)
    law = (law or str(deck["FRICTION"].parameters.get("LAW", "COULOMB"))).upper()
    if law not in LARGEST:
        raise UsageError(f"identify finds m (TRESCA) or mu (COULOMB), not a number of {law}")
    start = ring.guess(table)
    # At the yield point of a flat disc p = 2 k sqrt(3)/2: mu p = m k.
    start = start/np.sqrt(3.0) if law == "COULOMB" else start
    return fit(ring.curve(law, table), table.inner, start, LARGEST[law], law, say)
