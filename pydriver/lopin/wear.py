"""Wear: the integral of pressure over slip, on the metal and where it passes the tool.

Archard's depth is this integral times k/H, of a metal that is measured. It is summed over the
outputs of a run by the trapezoidal rule: what slips between two outputs does so under the mean of
their pressures.
"""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .errors import UsageError
from .result import refuse_meshes

#: Cosine of the angle within which a point lies behind a place: half of that between neighbours
#: around a corner of four facets. Share of the distance of points that the sag of facets may be.
BEHIND, AT = 0.7, 0.05


@dataclass(frozen=True)
class Wear:
    """Pressure by slip [stress*length].

    Attributes
    ----------
    pair : slave and master
    places, on_metal : of the slave points at the end (point, ndim), and what they have borne
    tool, on_tool : places on the tool, where it stood at the start, and what has passed there
    outputs : of the run that were summed
    """

    pair: str
    places: NDArray
    on_metal: NDArray
    tool: NDArray
    on_tool: NDArray
    outputs: int

    def lines(self) -> str:
        """A table: side, place, integral."""
        axes = ",".join("xyz"[:self.places.shape[1]])
        rows = [f"side,{axes},pressure_by_slip"]
        for side, x, value in (("metal", self.places, self.on_metal),
                               ("tool", self.tool, self.on_tool)):
            rows += [",".join([side, *(repr(float(v)) for v in (*p, w))])
                     for p, w in zip(x, value)]
        return "\n".join(rows) + "\n"

    def line(self) -> str:
        """For a terminal."""
        worst = int(np.argmax(self.on_tool)) if len(self.on_tool) else -1
        at = ", ".join(f"{v:.4g}" for v in self.tool[worst]) if worst >= 0 else "nowhere"
        return (f"{self.pair}: pressure by slip {self.on_metal.max(initial=0.0):.4g} at most on "
                f"the metal, {self.on_tool.max(initial=0.0):.4g} on the tool, at ({at}); "
                f"{self.outputs} outputs")


def wear(result, pair: str | int = 0, cell: float | None = None) -> Wear:
    """Of a pair of a run, over all its outputs.

    Parameters
    ----------
    result : of `lopin.run`, `lopin.open` or `lopin.open_result`
    pair : slave surface, SLAVE-MASTER, or number
    cell : distance of the places on the tool; the mean distance of slave points unless given
    """
    refuse_meshes(result, "wear is summed at slave points, and each mesh has others")
    history = result.contact(pair)
    count = len(result.times)
    if count < 2:
        raise UsageError("wear is summed over the outputs of a run, and this one has "
                         f"{count}", help="ask for more: *OUTPUT, FIELD, FREQUENCY=1")
    frames = [history.at(k) for k in range(count)]
    tool = frames[0].pair.rpartition("-")[2]
    pressure = np.array([np.maximum(f.pressure, 0.0) for f in frames])
    path = np.array([f["SLIP_PATH"].ravel() for f in frames])
    place = np.array([f.place for f in frames]) - _motion(result, tool, frames[0].place.shape[1])
    # The run began unloaded.
    borne = 0.5*(pressure + np.vstack([0.0*pressure[:1], pressure[:-1]])) \
        * np.maximum(np.diff(path, axis=0, prepend=0.0), 0.0)
    size = cell or _spacing(place[-1])
    points, passed = _on_tool(place, borne, size)
    return Wear(frames[0].pair, frames[-1].place, borne.sum(axis=0), points, passed, count)


def _motion(result, tool: str, ndim: int) -> NDArray:
    """How far the tool has moved at each output (output, 1, ndim)."""
    history = result.history
    turns = [k for k in (4, 5, 6) if np.abs(history.get(f"{tool}.u{k}", 0.0)).max() > 1e-12]
    if turns:
        raise UsageError(f"{tool} turns: wear is summed for tools that move without turning")
    time = np.asarray(history["time"])
    rows = [int(np.argmin(np.abs(time - t))) for t in result.times]
    return np.stack([np.asarray(history[f"{tool}.u{k + 1}"])[rows] if f"{tool}.u{k + 1}" in history
                     else np.zeros(len(rows)) for k in range(ndim)], axis=1)[:, None, :]


def _spacing(x: NDArray) -> float:
    """Mean distance of each point from its nearest neighbour."""
    far = np.linalg.norm(x[:, None] - x[None], axis=2)
    np.fill_diagonal(far, np.inf)
    return float(far.min(axis=1).mean())


def _on_tool(place: NDArray, borne: NDArray, size: float) -> tuple[NDArray, NDArray]:
    """Places that the tool was met at, one a box of this size, and what has passed there: at each
    output what the nearest slave point bore, if it is as near as the box is large and metal lies
    over the place."""
    met = place[borne > 0.0]
    if len(met) == 0:
        return np.zeros((0, place.shape[2])), np.zeros(0)
    _, first = np.unique(np.floor(met/size).astype(int), axis=0, return_index=True)
    points = met[np.sort(first)]
    passed = np.zeros(len(points))
    for x, values in zip(place, borne):
        far = np.linalg.norm(points[:, None] - x[None], axis=2)
        near = far.argmin(axis=1)
        over = (far[np.arange(len(points)), near] <= size) & _covered(points, x, near, size)
        passed += np.where(over, values[near], 0.0)
    return points, passed


def _covered(points: NDArray, x: NDArray, near: NDArray, size: float) -> NDArray:
    """Whether metal lies over places: seen from the nearest slave point, another one lies behind
    the place, or the place is at that point but for the sag of facets. A place beyond the rim of
    the metal has none behind it."""
    off = points - x[near]
    way = x[None] - x[near][:, None]
    length, reach = np.linalg.norm(off, axis=1), np.linalg.norm(way, axis=2)
    behind = np.einsum("psd,pd->ps", way, off) >= BEHIND*reach*length[:, None]
    return (behind & (reach > 0.0)).any(axis=1) | (length <= AT*size)
