"""Is Lopin's default on the front of every chart? A row of docs/charts.md for each.

    python tests/benchmarks/fronts.py

Default: the exact method in the deck's own elements and increments. One of its runs is off the
front if another run, of any program, errs less in less time; times within a tenth are alike, as of
runs of a machine that does other things, and so are errors within a hundredth. Why it is off is
what the last column of the page says (`tests/python/test_chart_fronts.py` asks for it).
"""
import csv
from dataclasses import dataclass
from pathlib import Path

CHARTS = Path(__file__).resolve().parents[2]/"docs"/"charts"
#: Shares of time and of error that are alike, and errors that are nothing.
TIME, ERROR, NOTHING = 0.9, 0.99, 1e-9
#: Tables by the label of the page, and the element of the deck where several are charted.
SCENES = {"A3": ("a3_cylinder", "CPE4"), "A4": ("a4_sphere", "CAX4"), "A7": ("a7_cattaneo", "CPE4"),
          "A13": ("a13_signorini", ""), "B1 at the nodes": ("b1_nodes", ""),
          "B1 by mortar": ("b1_mortar", ""), "D5": ("d5_rings", ""), "E1": ("e1_upsetting", "CAX4"),
          "E5": ("e5_ring", "CAX4"), "billet in space": ("billet_3d", ""),
          "closed die": ("closed_die_cold", "CAX4"), "cup": ("cup_fixed", "")}


@dataclass
class Run:
    """A run with an answer."""

    words: str       #: what it is
    default: bool
    seconds: float
    error: float

    def beats(self, other: "Run") -> bool:
        return self.seconds < TIME*other.seconds and \
            max(self.error, NOTHING) < ERROR*max(other.error, NOTHING)

    def __str__(self) -> str:
        return f"{self.words} ({self.seconds:.2g} s, {100.0*self.error:.2g} %)"


def runs_of(table: str, element: str) -> list[Run]:
    """Of a table, without failures."""
    with (CHARTS/f"{table}.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    if "cells" in rows[0]:
        return [Run(f"{r['program']} {r['method']}, {r['cells']} cells, {r['tool']}",
                    r["program"] == "lopin" and r["method"] == "lagrange", float(r["cpu_s"]),
                    float(r["error"])) for r in rows if r["error"] and not r["stopped"]]
    return [Run(" ".join(w for w in ("" if r["program"] == "lopin" else r["program"], r["method"],
                                     r["element"], f"mesh {r['mesh']}", "" if
                                     float(r["increments"]) == 1.0 else f"x {r['increments']}")
                         if w),
                r["program"] == "lopin" and r["method"] in ("lagrange", "") and
                r["element"] in (element, "") and float(r["increments"]) == 1.0,
                float(r["seconds"]), float(r["error"])) for r in rows
            if not r["failure"] and r["error"] not in ("", "nan")]


def row_of(label: str) -> str:
    """The first three columns of the page: chart, default runs on the front, what beats the rest."""
    table, element = SCENES[label]
    runs = runs_of(table, element)
    own = [r for r in runs if r.default]
    beaten = {str(r): max((s for s in runs if s.beats(r)), key=lambda s: r.error/max(
        s.error, NOTHING), default=None) for r in own}
    off = "; ".join(f"{who} by {best}" for who, best in beaten.items() if best)
    on = sum(best is None for best in beaten.values())
    return f"| [{label}](charts/{table}.csv) | {on} of {len(own)} | {off or 'none'} |"


if __name__ == "__main__":
    print("\n".join(row_of(label) for label in SCENES if (CHARTS/f"{SCENES[label][0]}.csv").is_file()))
