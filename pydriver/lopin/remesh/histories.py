"""What the histories of the parts of a run say of its tools: forces, ways, work."""
from __future__ import annotations

import csv
import re
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..files import reading

#: Ways of a tool below this share of the longest of any are none to speak of.
SHORT = 1e-3
TINY = np.finfo(float).tiny


@dataclass
class Ways:
    """How far tools have come, and where they stood last, by their names.

    Attributes
    ----------
    longest : way of each up to now [length]
    stood : places (ndim,) [length]
    """

    longest: dict[str, float] = field(default_factory=dict)
    stood: dict[str, NDArray] = field(default_factory=dict)

    def at_rest(self, history: dict[str, NDArray]) -> dict:
        """Of the next part, how far the increment at rest that it begins with has moved a tool, by
        its way up to then, and which one; the way of all others goes on."""
        worst: dict = {"way": 0.0, "tool": ""}
        for tool in dict.fromkeys(word[:-3] for word in history if re.search(r"\.u[123]$", word)):
            u = of_tools({w: c for w, c in history.items() if w[:-3] == tool}, "u")
            most = max(SHORT*max(self.longest.values(), default=0.0),
                       self.longest.get(tool, 0.0), TINY)
            if tool in self.stood and len(u):
                way = float(np.linalg.norm(u[0] - self.stood[tool]))/most
                worst = max(worst, {"way": way, "tool": tool}, key=lambda w: w["way"])
            if len(u):
                self.stood[tool] = u[-1]
                self.longest[tool] = max(self.longest.get(tool, 0.0),
                                         float(np.linalg.norm(u, axis=1).max()))
        return worst


def of_tools(history: dict[str, NDArray], what: str) -> NDArray:
    """Columns of the tools, a row an increment: forces "rf" or displacements "u"."""
    found = [c for word, c in history.items() if re.search(rf"\.{what}[123]$", word)]
    rows = len(next(iter(history.values()), []))
    return np.array(found).T if found else np.zeros((rows, 0))


def columns(path: Path) -> dict[str, NDArray]:
    """Columns of a history by their first word; none without a history."""
    if not path.is_file():
        return {}
    with reading(path), path.open(newline="") as file:
        head, *rows = list(csv.reader(file))
    table = np.array([[float(v) for v in row] for row in rows]).reshape(len(rows), len(head))
    return {word.partition(" ")[0]: column for word, column in zip(head, table.T)}


def work_of_tools(columns: dict[str, NDArray]) -> float:
    """What the prescribed motions of all tools have done: forces by displacements, moments by
    rotations, by the trapezoidal rule from the unloaded start on [energy]."""
    work = 0.0
    for name, force in columns.items():
        moved = columns.get(re.sub(r"\.rf(\d)$", r".u\1", name))
        if re.search(r"\.rf\d$", name) and moved is not None:
            f, u = np.r_[0.0, force], np.r_[0.0, moved]
            work += float((0.5*(f[1:] + f[:-1])*np.diff(u)).sum())
    return work
