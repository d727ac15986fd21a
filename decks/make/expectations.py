"""What a deck says that its run gives, as comments that a test reads (only the standard library).

    ** expect: contact.0.max_pressure = 279.83 +- 0.5 %      a path into name.json
    ** expect: history.BALL.rf2 at 1 = -586.08 +- 1 %        a column of the history (at a time)
    ** expect: node.13.u2 = 1.5167e-3 +- 1e-6                u1..u3, rf1..rf3 of *NODE PRINT
    ** expect: certificate.verdict = PASS                    a word
    ** expect: certificate.verdict = PASS|WARN               one of several
    ** expect: contact.0.max_penetration < 1e-9              a bound

Without `at`, the last increment. A tolerance in % is of the value that is expected.
"""
from __future__ import annotations

import csv
import json
import re
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

LINE = re.compile(r"^\*\*\s*expect:\s*(?P<path>\S+)(?:\s+at\s+(?P<time>\S+))?\s*"
                  r"(?P<relation>[=<>])\s*(?P<value>\S+)"
                  r"(?:\s*\+-\s*(?P<tolerance>\S+)\s*(?P<percent>%)?)?\s*$")


@dataclass(frozen=True)
class Expectation:
    """One line of a deck."""

    path: str
    time: float | None
    relation: str
    value: float | str
    tolerance: float
    text: str

    def holds(self, found) -> bool:
        """Whether a run that gave `found` did what is expected."""
        if isinstance(self.value, str):
            return found in self.value.split("|")
        if self.relation == "=":
            return abs(found - self.value) <= self.tolerance
        return found < self.value if self.relation == "<" else found > self.value


def expectations(deck: Path) -> list[Expectation]:
    """All of a deck; a line that begins like one but does not read is an error."""
    found = []
    for number, line in enumerate(deck.read_text(encoding="utf-8").splitlines(), start=1):
        if not re.match(r"\*\*\s*expect\s*:", line):
            continue
        match = LINE.match(line)
        if not match:
            raise ValueError(f"{deck.name}:{number}: not an expectation: {line}")
        value = _number(match["value"])
        tolerance = float(match["tolerance"] or 0.0)
        if match["percent"]:
            tolerance *= abs(value)/100.0
        time = None if match["time"] is None else float(match["time"])
        found.append(Expectation(match["path"], time, match["relation"], value, tolerance,
                                 line.split(":", 1)[1].strip()))
    return found


def asks_to_remesh(deck: Path) -> bool:
    """Whether a deck needs the command of the Python package, and a mesher."""
    return "*REMESH" in deck.read_text(encoding="utf-8")


def run(deck: Path, executable: Path, folder: Path) -> subprocess.CompletedProcess:
    """Run a deck; results in folder/<name of the deck>."""
    command = [sys.executable, "-m", "lopin"] if asks_to_remesh(deck) else [str(executable)]
    return subprocess.run([*command, "run", str(deck), "-o", str(folder/deck.stem)],
                          capture_output=True, text=True, timeout=300, check=False)


def measured(folder: Path, name: str, what: Expectation):
    """What the run in this folder gave at the path of an expectation."""
    head, _, rest = what.path.partition(".")
    if head == "history":
        return _history(folder/f"{name}_history.csv", rest, what.time)
    if head == "node":
        node, _, word = rest.partition(".")
        return _node(folder/f"{name}.dat", int(node), word, what.time)
    value = json.loads((folder/f"{name}.json").read_text(encoding="utf-8"))
    for key in what.path.split("."):
        value = value[int(key)] if isinstance(value, list) else value[key]
    return value


def _number(word: str) -> float | str:
    try:
        return float(word)
    except ValueError:
        return word


def _history(path: Path, column: str, time: float | None) -> float:
    with path.open(newline="", encoding="utf-8") as file:
        rows = [{k.split("[")[0].strip(): v for k, v in row.items()}
                for row in csv.DictReader(file)]
    if time is not None:
        rows = [row for row in rows if abs(float(row["time"]) - time) < 1e-9*max(1.0, abs(time))]
    return float(rows[-1][column])


def _node(path: Path, node: int, word: str, time: float | None) -> float:
    wanted = {"u": "displacements", "rf": "forces"}[word[:-1]]
    table, now, found = "", 0.0, {}
    for line in path.read_text(encoding="utf-8").splitlines():
        fields = line.split()
        if " and time " in line:
            table, now = fields[0], float(fields[-1])
        elif table == wanted and fields and fields[0] == str(node):
            found[now] = float(fields[int(word[-1])])
    times = [t for t in found if time is None or abs(t - time) < 1e-6*max(1.0, abs(time))]
    return found[max(times)]
