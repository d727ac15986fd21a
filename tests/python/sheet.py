"""The sheets of verification: what was demanded, what was measured.

Tests compare through the fixture `sheet`. With the environment variable LOPIN_SHEET set to a path,
the run of the tests ends by writing an index of all cases there, and the sheets with their rows
into the folder of that name beside it; docs/verification.md and docs/verification/ are made so.
"""
from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

HEAD = """# Verification

Written by the tests (`LOPIN_SHEET=docs/verification.md pytest tests/python`); do not edit.

Every row of a sheet is a test: it fails when the difference exceeds the tolerance. A reference is a
closed form unless its row says otherwise. Differences are relative to the reference, or absolute
where marked abs. Units are N and mm. Here each case has the number of its rows, and how much of its
tolerance the worst of them takes.
"""

#: Sheets by the first letter of a case that is followed by its number.
SUBJECTS = {"A": "Contact beside closed forms", "B": "Patch tests", "C": "Friction",
            "D": "Sliding over meshes and corners", "E": "Metal forming",
            "F": "Methods, units and invariance", "G": "Other scenes"}


def sheet_of(case: str) -> str:
    """The letter of the sheet that a case is on."""
    first = case.split()[0]
    return first[0] if first[0] in SUBJECTS and first[1:].isdigit() else "G"


def in_order(case: str) -> tuple:
    """A2 before A13."""
    first = case.split()[0]
    return (sheet_of(case), int(first[1:]) if first[1:].isdigit() else 0, case)


def index(cases: dict[str, list[tuple[str, float]]], folder: str) -> str:
    """The page that lists all cases: rows as (line of the table, share of the tolerance)."""
    lines = [HEAD]
    for letter, subject in SUBJECTS.items():
        own = sorted((case for case in cases if sheet_of(case) == letter), key=in_order)
        if not own:
            continue
        lines += [f"## [{subject}]({folder}/{letter.lower()}.md)", "",
                  "| case | rows | of the tolerance |", "| --- | --- | --- |",
                  *(f"| {case} | {len(cases[case])} | {max(share for _, share in cases[case]):.0%} |"
                    for case in own), ""]
    return "\n".join(lines)


def page(cases: dict[str, list[tuple[str, float]]], letter: str, up: str) -> str:
    """One sheet."""
    lines = [f"# {SUBJECTS[letter]}", "", f"What the columns are: [verification]({up}).", ""]
    for case in sorted((case for case in cases if sheet_of(case) == letter), key=in_order):
        lines += [f"## {case}", "",
                  "| quantity | reference | source | computed | difference | tolerance |",
                  "| --- | --- | --- | --- | --- | --- |", *(line for line, _ in cases[case]), ""]
    return "\n".join(lines)


def write(cases: dict[str, list[tuple[str, float]]], path: Path) -> None:
    """The index, and the sheets in the folder of its name."""
    folder = path.with_suffix("")
    folder.mkdir(exist_ok=True)
    path.write_text(index(cases, folder.name), encoding="utf-8")
    for letter in SUBJECTS:
        if any(sheet_of(case) == letter for case in cases):
            (folder/f"{letter.lower()}.md").write_text(page(cases, letter, f"../{path.name}"),
                                                       encoding="utf-8")


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
        """The index and the sheets."""
        cases: dict[str, list[tuple[str, float]]] = {}
        for row in self.rows:
            short = -row.difference if row.at_least else abs(row.difference)
            cases.setdefault(row.case, []).append(
                (row.text(), max(0.0, short)/row.tolerance if row.tolerance > 0.0 else 0.0))
        write(cases, Path(path))


#: Of the whole run of the tests.
SHEET = Sheet()
