"""The table of verification: what was demanded, what was measured.

Tests compare through the fixture `sheet`. With the environment variable LOPIN_SHEET set to a path,
the run of the tests ends by writing all rows there; docs/verification.md is made that way.
"""
from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

HEAD = """# Verification

Written by the tests (`LOPIN_SHEET=docs/verification.md pytest tests/python`); do not edit.

Every row is a test: it fails when the difference exceeds the tolerance. A reference is a closed
form unless its row says otherwise. Differences are relative to the reference, or absolute where
marked abs. Units are N and mm.
"""


@dataclass(frozen=True)
class Row:
    """One comparison."""

    case: str
    quantity: str
    reference: float
    source: str
    computed: float
    tolerance: float
    absolute: bool
    at_least: bool

    @property
    def difference(self) -> float:
        """Computed minus reference, divided by it unless absolute."""
        size = 1.0 if self.absolute else abs(self.reference)
        return (self.computed - self.reference)/size

    @property
    def holds(self) -> bool:
        if self.at_least:
            return self.difference >= -self.tolerance
        return abs(self.difference) <= self.tolerance

    def text(self) -> str:
        mark = " abs" if self.absolute else ""
        least = "at least " if self.at_least else ""
        return (f"| {self.quantity} | {least}{self.reference:.9g} | {self.source} | {self.computed:.9g} "
                f"| {self.difference:+.1e}{mark} | {self.tolerance:.1e} |")


class Sheet:
    """Collects rows; a row that does not hold fails its test."""

    def __init__(self):
        self.rows: list[Row] = []

    def compare(self, case: str, quantity: str, computed: float, reference: float,
                tolerance: float, source: str = "closed form", absolute: bool = False,
                at_least: bool = False) -> None:
        """Record and assert; `absolute` differences, or a reference to reach `at_least`."""
        row = Row(case, quantity, float(reference), source, float(computed), tolerance, absolute,
                  at_least)
        self.rows.append(row)
        print(f"{case}: {row.text()}")
        assert row.holds, f"{case}: {row.text()}"

    def write(self, path: str | Path) -> None:
        """The page, case by case in order of their names."""
        lines = [HEAD]
        for case in sorted({row.case for row in self.rows}):
            lines += [f"## {case}", "",
                      "| quantity | reference | source | computed | difference | tolerance |",
                      "| --- | --- | --- | --- | --- | --- |",
                      *(row.text() for row in self.rows if row.case == case), ""]
        Path(path).write_text("\n".join(lines), encoding="utf-8")


#: Of the whole run of the tests.
SHEET = Sheet()
