"""The whole test suite under each BLAS kernel that this processor can run.

    .venv/bin/python tests/benchmarks/kernels.py [--kernels HASWELL,ZEN,...] [--fortran-only] [PYTEST ARGUMENT ...]

OpenBLAS chooses its kernels by the processor; OPENBLAS_CORETYPE overrules it, so that one machine
shows what others would compute. What hangs on the last bits of a product fails under one of them.
Prints a Markdown table; the exit code is 1 where a test fails. Needs a finished `./bootstrap build`.
"""
from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
import xml.etree.ElementTree as tree
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BUILD = ROOT/"build"
KERNELS = "HASWELL,ZEN,SKYLAKEX,SANDYBRIDGE,NEHALEM,PRESCOTT"
PRODUCT = "import numpy; a = numpy.ones((300, 300)); a @ a; numpy.linalg.solve(a + 300*numpy.eye(300), a)"


def environment(kernel: str) -> dict[str, str]:
    return dict(os.environ, OPENBLAS_CORETYPE=kernel, OPENBLAS_NUM_THREADS="1", OMP_NUM_THREADS="1",
                PYTHONPATH=str(BUILD/"python"), LOPIN_EXECUTABLE=str(BUILD/"lopin"))


def runs_here(kernel: str) -> bool:
    """Whether the processor has the instructions of this kernel, in our BLAS and in numpy's."""
    with tempfile.TemporaryDirectory() as folder:
        trials = ([str(BUILD/"lopin"), "run", str(ROOT/"decks"/"hertz_sphere.inp"), "-o", folder,
                   "--overwrite", "-q"], [sys.executable, "-c", PRODUCT])
        return all(subprocess.run(t, env=environment(kernel), capture_output=True).returncode == 0
                   for t in trials)


def fortran(kernel: str) -> tuple[int, list[str]]:
    """Programs that were run, names of those that failed."""
    run = subprocess.run(["ctest", "--test-dir", str(BUILD), "-j2", "-E", "^python"], text=True,
                         env=environment(kernel), capture_output=True)
    lines = [line for line in run.stdout.splitlines() if "Test" in line and "#" in line]
    return len(lines), [line.split(":")[1].split()[0] for line in lines if "Passed" not in line]


def python(kernel: str, arguments: list[str]) -> tuple[int, list[str]]:
    """Tests that were run, names of those that failed."""
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder)/"report.xml"
        subprocess.run([sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider",
                        f"--junitxml={report}", *(arguments or [str(ROOT/"tests"/"python")])],
                       env=environment(kernel), stdout=subprocess.DEVNULL, cwd=ROOT)
        cases = list(tree.parse(report).getroot().iter("testcase"))
    failed = [c.get("name", "") for c in cases
              if c.find("failure") is not None or c.find("error") is not None]
    return sum(c.find("skipped") is None for c in cases), failed


def main() -> int:
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--kernels", default=KERNELS)
    options.add_argument("--fortran-only", action="store_true")
    given, rest = options.parse_known_args()
    bad = 0
    print("| kernel | Fortran programs | Python tests | failed | minutes |\n|---|---|---|---|---|")
    for kernel in given.kernels.split(","):
        if not runs_here(kernel):
            print(f"| {kernel} | this processor lacks its instructions | | | |", flush=True)
            continue
        start = time.time()
        programs, failed = fortran(kernel)
        tests, more = (0, []) if given.fortran_only else python(kernel, rest)
        failed += more
        bad += len(failed)
        print(f"| {kernel} | {programs} | {tests} | {', '.join(failed) or 'none'} "
              f"| {(time.time() - start)/60.0:.1f} |", flush=True)
    return bad > 0


if __name__ == "__main__":
    sys.exit(main())
