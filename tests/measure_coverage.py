"""Lines of the Fortran and Python sources that the tests run.

    .venv/bin/python tests/measure_coverage.py            # the Fortran programs and the fast loop
    .venv/bin/python tests/measure_coverage.py --all      # every test: an hour on two cores
    .venv/bin/python tests/measure_coverage.py --report   # once more what was counted
    ... --list solve                                      # and the lines of a folder nothing runs

The build stands in build-coverage/. The lines of Python are counted if the package `coverage` is
there.
"""
import argparse
import gzip
import importlib.util
import json
import os
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

from measure_sources import folder_of

ROOT = Path(__file__).resolve().parents[1]
BUILD = ROOT/"build-coverage"
JOBS = str(os.cpu_count() or 2)


def build():
    """The library with counters; those of earlier runs are forgotten."""
    options = {"CMAKE_BUILD_TYPE": "Debug", "LOPIN_COVERAGE": "ON", "LOPIN_TESTS": "ON",
               "LOPIN_PYTHON": "ON", "Python_EXECUTABLE": sys.executable}
    subprocess.run(["cmake", "-S", str(ROOT), "-B", str(BUILD), "-G", "Ninja",
                    *(f"-D{key}={value}" for key, value in options.items())],
                   check=True, stdout=subprocess.DEVNULL)
    subprocess.run(["cmake", "--build", str(BUILD), "-j", JOBS], check=True,
                   stdout=subprocess.DEVNULL)
    for path in BUILD.rglob("*.gcda"):
        path.unlink()


def run(everything: bool):
    """Tests that fail are told by their runners, and count all the same."""
    environment = os.environ | {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1",
                                "PYTHONPATH": str(BUILD/"python"),
                                "LOPIN_EXECUTABLE": str(BUILD/"lopin")}
    subprocess.run(["ctest", "--test-dir", str(BUILD), "-j", JOBS, "-E", "^python", "--quiet",
                    "--output-on-failure"], env=environment)
    # One process: the counters of Python are of the process.
    python = [sys.executable, "-m"]
    if importlib.util.find_spec("coverage"):
        python += ["coverage", "run", f"--data-file={BUILD/'python.coverage'}",
                   f"--source={ROOT/'pydriver'/'lopin'},{BUILD/'python'/'lopin'}", "-m"]
    subprocess.run([*python, "pytest", "-q", "-p", "no:cacheprovider", str(ROOT/"tests"/"python"),
                    *([] if everything else ["-m", "fast"])], env=environment, cwd=ROOT)


def counted() -> dict:
    """Of each Fortran source: how often each of its lines ran."""
    lines = defaultdict(lambda: defaultdict(int))
    objects = sorted((BUILD/"fortran").rglob("*.gcno"))
    for path in objects:
        done = subprocess.run(["gcov", "--json-format", "--stdout", str(path)], cwd=BUILD,
                              capture_output=True)
        text = done.stdout
        if text[:2] == b"\x1f\x8b":
            text = gzip.decompress(text)
        for report in text.decode().splitlines():
            for file in json.loads(report)["files"]:
                source = (BUILD/file["file"]).resolve()
                if source.is_relative_to(ROOT/"fortran"):
                    for line in file["lines"]:
                        lines[source][line["line_number"]] += line["count"]
    return lines


def report(listed: str):
    """A line for each folder, and one for all."""
    folders = defaultdict(lambda: [0, 0])
    for source, lines in sorted(counted().items()):
        never = sorted(number for number, count in lines.items() if count == 0)
        for name in (folder_of(source), "all Fortran"):
            folders[name][0] += len(lines) - len(never)
            folders[name][1] += len(lines)
        if listed in (folder_of(source), folder_of(source).split("/")[0]) and never:
            print(f"{source.relative_to(ROOT)}: {', '.join(map(str, never))}")
    for name, (ran, every) in folders.items():
        print(f"{100*ran/every:6.1f} %  {ran:6d} of {every:6d}  {name}")
    data = BUILD/"python.coverage"
    if data.exists():
        done = subprocess.run([sys.executable, "-m", "coverage", "report", f"--data-file={data}",
                               "--format=total"], capture_output=True, text=True)
        print(f"{done.stdout.strip():>6} %                    all Python")


def main():
    """Count and tell."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--all", action="store_true", help="run every test")
    parser.add_argument("--report", action="store_true", help="run none")
    parser.add_argument("--list", default="", help="folder whose untested lines are listed")
    options = parser.parse_args()
    if not options.report:
        build()
        run(options.all)
    report(options.list)


if __name__ == "__main__":
    main()
