"""What the advice saves: twelve decks that model too much, beside what the advice makes of them.

    python tests/benchmarks/savings.py TABLE.csv

CPU seconds of the process, one thread, least of some runs.
"""
import csv
import os
import resource
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")
os.environ.setdefault("LOPIN_EXECUTABLE", str(ROOT/"build"/"lopin"))
sys.path[:0] = [str(ROOT/"tests"/"python")]

import lopin  # noqa: E402
from heavier_twins import twins  # noqa: E402
from test_twins import advised, counts, force  # noqa: E402

RUNS = 3


def measure(deck):
    """Counts, force, and least CPU seconds."""
    least = float("inf")
    for _ in range(RUNS):
        with tempfile.TemporaryDirectory() as folder:
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            result = lopin.run(deck, folder, executable=True)
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            least = min(least, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
            values = counts(result) | {"force": force(result)}
    return values | {"cpu_s": least}


def main(path):
    rows = []
    for name, code, heavy, light, share, _ in twins():
        much, little = measure(heavy), measure(light)
        row = {"twin": name, "advice": " ".join(sorted(advised(heavy)))}
        for key in ("equations", "increments", "factorisations", "back_solves"):
            row[key], row[f"{key}_light"] = much[key], little[key]
        row |= {"cpu_s": f"{much['cpu_s']:.3f}", "cpu_s_light": f"{little['cpu_s']:.3f}",
                "saved": f"{much['cpu_s']/little['cpu_s']:.1f}",
                "force_differs_percent":
                    f"{100.0*abs(much['force']/(share*little['force']) - 1.0):.2g}"}
        assert code in row["advice"]
        rows.append(row)
        print(row, flush=True)
        with open(path, "w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)


if __name__ == "__main__":
    main(sys.argv[1])
