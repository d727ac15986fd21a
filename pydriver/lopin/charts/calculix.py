"""Rows of CalculiX for a chart: the decks of the chart as `lopin export --ccx` writes them."""
from __future__ import annotations

import os
import re
import shutil
import subprocess
import tempfile
import threading
from pathlib import Path

import numpy as np

from ..deck import Block, Deck
from ..errors import LopinError, UsageError
from ..export import tools_of
from ..model_read_mesh import MeshCards
from .cases import Case, Chart

#: A run is left after so long [s].
LIMIT = 900.0
#: Wedges of an axisymmetric body in CalculiX.
WEDGES = 180.0
_ONE_THREAD = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "CCX_NPROC_STIFFNESS": "1"}


def beside(chart: Chart) -> list[Case]:
    """A row for each mesh of the chart."""
    program = shutil.which("ccx")
    if program is None:
        raise UsageError("--ccx needs CalculiX (Debian's calculix-ccx)")
    if chart.quantity.kind not in ("FORCE", "DISPLACEMENT") or not chart.quantity.set:
        raise UsageError("--ccx compares FORCE and DISPLACEMENT of a set")
    rows, right = [], chart.right
    for element in chart.elements:
        for mesh in chart.meshes:
            row = Case(chart.deck.name, program="ccx", element=element, mesh=mesh)
            try:
                _run(row, program, chart.mesh_of(element, mesh), chart)
            except (LopinError, OSError) as problem:
                row.failure = getattr(problem, "id", "") or str(problem).split("\n")[0]
            if np.isfinite(row.value):
                row.right, row.error = right, abs(row.value - right)/abs(right)
            rows.append(row)
            chart.say(f"{row.label}: {row.failure or format(row.value, '.7g')}, "
                      f"{row.seconds:.3g} s")
    return rows


def _run(row: Case, program: str, deck: Deck, chart: Chart) -> None:
    """Run CalculiX on a deck as it writes it."""
    new, tools = tools_of(deck)
    asked = chart.quantity.set
    name = tools.get(asked, asked)
    if chart.quantity.kind == "DISPLACEMENT" and asked in tools:
        raise UsageError("a tool moves as it is told")
    word = "RF" if chart.quantity.kind == "FORCE" else "U"
    last = max(k for k, b in enumerate(new.blocks) if b.keyword == "END STEP")
    new.blocks.insert(last, Block("NODE PRINT", {"NSET": name}, [[word]]))
    with tempfile.TemporaryDirectory(prefix="lopin-") as folder:
        new.write(Path(folder)/"job.inp")
        with subprocess.Popen([program, "job"], cwd=folder, env=os.environ | _ONE_THREAD,
                              stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
            clock = threading.Timer(LIMIT, process.kill)
            clock.start()
            _, status, used = os.wait4(process.pid, 0)
            late = not clock.is_alive()
            clock.cancel()
            process.returncode = os.waitstatus_to_exitcode(status)
        if late:
            row.seconds, row.failure = LIMIT, "time"
            return
        row.seconds = used.ru_utime + used.ru_stime
        row.linear, row.repetitions = row.seconds/chart.linear, 1
        row.peak_mb = used.ru_maxrss/1024.0
        table = _last_table(Path(folder)/"job.dat")
        if process.returncode or not len(table):
            row.failure = f"exit {process.returncode}"
            return
    vector = table.sum(axis=0) if word == "RF" else table.mean(axis=0)
    cards = MeshCards(new.blocks)
    if word == "RF" and any(w.startswith("CAX") for w, _ in cards.elements.values()):
        vector = vector*WEDGES   # it prints those of a wedge of two degrees
    row.equations = 2*len(cards.nodes) if not vector[2] else 3*len(cards.nodes)
    row.value = chart.quantity.of_vector(vector)


def _last_table(path: Path) -> np.ndarray:
    """Rows of the last table of a .dat file, without their labels."""
    rows: list[list[float]] = []
    if path.is_file():
        for line in path.read_text().splitlines():
            words = line.split()
            if words and re.match(r"\s*(displacements|forces)", line):
                rows = []
            elif len(words) == 4 and words[0].isdigit():
                rows.append([float(w) for w in words[1:]])
    return np.array(rows).reshape(-1, 3)
