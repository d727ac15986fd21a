"""Histories of friction on the condensed path, in linear solves of their meshes.

    python tests/benchmarks/frictional_histories.py TABLE.csv

Fifty increments each; one linear solve is what assembling, analysing, factorising and one pass of
solving take in the same run. Times are the least of some runs, by phase; output is not counted.
"""
import csv
import os
import re
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")
os.environ.setdefault("LOPIN_EXECUTABLE", str(ROOT/"build"/"lopin"))
sys.path[:0] = [str(ROOT/"decks"/"make"), str(ROOT/"tests"/"python")]

import lopin  # noqa: E402
from lopin.refine import refined  # noqa: E402

PHASES = ("assemble", "analyse", "factorise", "contact", "solve", "check", "search")
RUNS = 5


def _deck(name: str, finer: int = 0, **increments) -> lopin.Deck:
    text = (ROOT/"decks"/f"{name}.inp").read_text(encoding="utf-8")
    for old, new in increments.items():
        text = re.sub(rf"(\*STATIC, DIRECT\n){re.escape(old.replace('_', '.'))},",
                      rf"\g<1>{new},", text)
    deck = lopin.Deck.parse(text, name, ROOT/"decks")
    for _ in range(finer):
        deck = refined(deck).deck
    return deck


def scenes():
    """Names and decks."""
    from test_verification_mindlin import build

    yield "Cattaneo", _deck("cattaneo")
    yield "Cattaneo, cells halved", _deck("cattaneo", 1)
    yield "Mindlin in space", lopin.Deck.parse(build(2), "mindlin")
    yield "Mindlin in space, finer", lopin.Deck.parse(build(6), "mindlin")
    yield "rough punch", _deck("rough_punch", **{"0_1": "0.02"})
    yield "rough punch, cells halved", _deck("rough_punch", 1, **{"0_1": "0.02"})
    yield "NAFEMS punch", _deck("nafems_punch", **{"0_1": "0.02"})
    yield "NAFEMS punch, cells halved", _deck("nafems_punch", 1, **{"0_1": "0.02"})
    yield "ring on a drum (101)", _deck("capstan")


def main(path):
    rows = []
    for name, deck in scenes():
        least, result = {}, None
        for _ in range(RUNS):
            with tempfile.TemporaryDirectory() as folder:
                result = lopin.run(deck, folder, executable=True)
                for phase in PHASES:
                    spent = result.summary["timing"].get(phase, 0.0)
                    least[phase] = min(least.get(phase, spent), spent)
        steps = result.summary["steps"]
        count = {k: sum(s[k] for s in steps) for k in ("increments", "iterations", "back_solves")}
        one = sum(least[p] for p in ("assemble", "analyse", "factorise")) \
            + least["solve"]/max(count["back_solves"], 1)
        rows.append({"scene": name, "equations": result.summary["equations"], **count,
                     "linear_solve_ms": f"{1e3*one:.1f}",
                     "total": f"{sum(least.values())/one:.2f}",
                     **{p: f"{least[p]/one:.2f}" for p in PHASES}})
        print(rows[-1], flush=True)
        with open(path, "w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)


if __name__ == "__main__":
    main(sys.argv[1])
