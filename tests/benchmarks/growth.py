"""How time and memory grow with the number of degrees of freedom, by phase: writes
docs/charts/growth.csv and growth.png, and the table of docs/growth.md.

    python tests/benchmarks/growth.py [--most 100000] [--repeat 3] [--kinds linear contact tied]
                                      [--dims 2 3] [--draw]

Two blocks of first-order elements in the plane and in space, meshes that do not match. `linear`:
one of them, of the size of both; `contact`: a crown pressed on a flat block without friction, so
that a third of its width touches; `tied`: both flat and tied; `forming`: a billet of metal between
its plane of symmetry and a rigid plane with friction, pressed by 2 % under NLGEOM. One thread;
seconds of processor time and the peak memory of the process, least of the runs; seconds of wall by
phase, least of the runs phase by phase. What the CSV has already is not run again: a machine may be
lent for an hour at a time. `--draw` only makes the picture and the table; they show phases by their
share of the wall, times the processor seconds, so that a busy machine does not count.
"""
from __future__ import annotations

import argparse
import csv
import json
import os
import subprocess
import tempfile
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
LOPIN = os.environ.get("LOPIN_EXECUTABLE", str(ROOT/"build"/"lopin"))
FOLDER = ROOT/"docs"/"charts"
PAGE = ROOT/"docs"/"growth.md"
PHASES = ("model", "search", "assemble", "analyse", "factorise", "contact", "solve", "output")
FIELDS = ("kind", "dim", "cells", "dofs", "iterations", "factorisations", "back_solves", "cpu",
          "mib", *PHASES)
KINDS = ("linear", "contact", "tied", "forming")
#: Cells along an edge; in space two blocks have 6 cells^3 degrees of freedom.
CELLS = {2: (50, 100, 160, 250, 350, 500), 3: (8, 12, 16, 20, 25, 31, 37)}


def block(dim: int, cells: tuple[int, ...], low: float, first: int, name: str,
          crown: float = 0.0) -> tuple[list[str], int]:
    """Lines of a block of unit width and height from `low` on; sets NAME.B and NAME.T at its
    bottom and top, NAME.X and NAME.Y at its planes of symmetry; surfaces NAME.SB and NAME.ST."""
    axes = [np.linspace(0.0, 1.0, n + 1) for n in cells]
    grid = np.stack([a.ravel(order="F") for a in np.meshgrid(*axes, indexing="ij")], axis=1)
    rise = 0.5*crown*(grid[:, :-1]**2).sum(axis=1)
    x = grid.copy()
    x[:, -1] = low + rise + grid[:, -1]*(1.0 - rise)
    node = np.arange(len(x)) + first
    lines = ["*NODE, NSET=" + name]
    lines += [f"{i}, " + ", ".join(f"{v:.12g}" for v in p) for i, p in zip(node, x)]
    shape = np.array(cells) + 1
    stride = np.concatenate([[1], np.cumprod(shape[:-1])])
    index = np.stack([a.ravel(order="F") for a in np.meshgrid(
        *[np.arange(n) for n in cells], indexing="ij")], axis=1)
    ring = [(0, 0), (1, 0), (1, 1), (0, 1)]
    corner = ring if dim == 2 else [(*r, k) for k in (0, 1) for r in ring]
    conn = (index@stride)[:, None] + np.array(corner)@stride + first
    element = np.arange(len(conn)) + first
    word = "CPE4" if dim == 2 else "C3D8"
    lines.append(f"*ELEMENT, TYPE={word}, ELSET={name}.E")
    lines += [f"{e}, " + ", ".join(map(str, c)) for e, c in zip(element, conn)]
    sides = {"B": (dim - 1, 0.0), "T": (dim - 1, 1.0), "X": (0, 0.0)}
    if dim == 3:
        sides["Y"] = (1, 0.0)
    for side, (axis, at) in sides.items():
        lines.append(f"*NSET, NSET={name}.{side}")
        lines += [str(i) for i in node[grid[:, axis] == at]]
    faces = ("S1", "S3") if dim == 2 else ("S1", "S2")
    for side, face, at in (("SB", faces[0], 0), ("ST", faces[1], cells[-1] - 1)):
        lines.append(f"*SURFACE, NAME={name}.{side}")
        lines += [f"{e}, {face}" for e in element[index[:, -1] == at]]
    return lines, first + max(len(x), len(conn))


def deck(kind: str, dim: int, cells: int) -> str:
    """The scene as text."""
    body, section = [], ["*SOLID SECTION, ELSET=A.E, MATERIAL=M", "1.,"]
    held = ["*BOUNDARY", f"A.B, {dim}", "A.X, 1"] + ["A.Y, 2"]*(dim == 3)
    if kind == "linear":
        body, _ = block(dim, (cells,)*(dim - 1) + (2*cells,), 0.0, 1, "A")
        top = "A.T"
    elif kind == "forming":
        return forming(dim, cells)
    else:
        crown = 0.06 if kind == "contact" else 0.0
        body, after = block(dim, (cells,)*dim, 0.0, 1, "A")
        more, _ = block(dim, (cells - 1,)*dim, 1.0, after, "B", crown)
        body += more
        section += ["*SOLID SECTION, ELSET=B.E, MATERIAL=M", "1.,"]
        held += ["B.X, 1"] + ["B.Y, 2"]*(dim == 3)
        top = "B.T"
    tail = {"linear": [], "tied": ["*TIE, NAME=T", "B.SB, A.ST"],
            "contact": ["*SURFACE INTERACTION, NAME=I", "*SURFACE BEHAVIOR, DIRECT",
                        "*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE",
                        "B.SB, A.ST"]}[kind]
    return "\n".join([*body, "*MATERIAL, NAME=M", "*ELASTIC", "200000., 0.3", *section, *tail,
                      *held, "*STEP", "*STATIC", "1., 1.", "*BOUNDARY",
                      f"{top}, {dim}, {dim}, -0.004",
                      "*NODE PRINT, NSET=A.B, TOTALS=ONLY", "RF", "*NODE FILE", "U", "*END STEP",
                      ""])


def forming(dim: int, cells: int) -> str:
    """Metal between its plane of symmetry and a rigid plane, with friction."""
    body, after = block(dim, (cells,)*(dim - 1) + (2*cells,), 0.0, 1, "A")
    shape = (["*SURFACE, NAME=DIE, TYPE=SEGMENTS", "START, 3., 1.", "LINE, -3., 1."] if dim == 2
             else ["*SURFACE, NAME=DIE, TYPE=CYLINDER", "0., 0., 0., 1., 0., 0.", "0., -1., 0.",
                   "START, 3., 1.", "LINE, -3., 1."])
    still = ["P, 1", "P, 6"] if dim == 2 else ["P, 1, 2", "P, 4, 6"]
    held = ["*BOUNDARY", f"A.B, {dim}", "A.X, 1"] + ["A.Y, 2"]*(dim == 3)
    node = f"{after + 1}, " + "0., "*(dim - 1) + "2."
    return "\n".join([
        *body, "*NODE, NSET=P", node, "*MATERIAL, NAME=M", "*ELASTIC", "200000., 0.3", "*PLASTIC",
        "700., 0.", "1300., 2.", "*SOLID SECTION, ELSET=A.E, MATERIAL=M", "1.,", *shape,
        "*RIGID BODY, ANALYTICAL SURFACE=DIE, REF NODE=P", "*SURFACE INTERACTION, NAME=I",
        "*SURFACE BEHAVIOR, DIRECT", "*FRICTION", "0.1,", "*CONTACT PAIR, INTERACTION=I",
        "A.ST, DIE", *held, *still, "*STEP, NLGEOM", "*STATIC", "0.3, 1.", "*BOUNDARY",
        f"P, {dim}, {dim}, -0.02", "*NODE PRINT, NSET=P, TOTALS=ONLY", "RF", "*NODE FILE", "U",
        "*END STEP", ""])


def run_once(folder: Path) -> tuple[float, float, dict]:
    """CPU seconds, peak MiB and the summary of one run."""
    environment = os.environ | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    command = [LOPIN, "run", "growth.inp", "-o", "out", "--overwrite", "--quiet"]
    with subprocess.Popen(command, cwd=folder, env=environment, stdout=subprocess.DEVNULL,
                          stderr=subprocess.PIPE) as process:
        told = process.stderr.read().decode()
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise RuntimeError(told.strip().splitlines()[0] if told else "it stopped")
    return (used.ru_utime + used.ru_stime, used.ru_maxrss/1024.0,
            json.loads((folder/"out"/"growth.json").read_text()))


def measure(kind: str, dim: int, cells: int, repeat: int) -> dict:
    """One row of the table."""
    row = {"kind": kind, "dim": dim, "cells": cells}
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        (folder/"growth.inp").write_text(deck(kind, dim, cells))
        for _ in range(repeat):
            cpu, mib, said = run_once(folder)
            row["cpu"] = min(cpu, row.get("cpu", cpu))
            row["mib"] = min(mib, row.get("mib", mib))
            for phase in PHASES:
                seconds = said["timing"].get(phase, 0.0)
                row[phase] = min(seconds, row.get(phase, seconds))
        row["dofs"] = said["equations"]
        for field in ("iterations", "factorisations", "back_solves"):
            row[field] = sum(step[field] for step in said["steps"])
    return row


def read() -> list[dict]:
    """Rows so far."""
    path = FOLDER/"growth.csv"
    if not path.exists():
        return []
    with path.open(newline="", encoding="utf-8") as file:
        return [{k: v if k == "kind" else float(v) for k, v in row.items()}
                for row in csv.DictReader(file)]


def write(rows: list[dict]) -> None:
    """All rows, in order."""
    rows.sort(key=lambda r: (KINDS.index(r["kind"]), r["dim"], r["dofs"]))
    with (FOLDER/"growth.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, FIELDS)
        writer.writeheader()
        writer.writerows({k: v if k == "kind" else f"{v:.5g}" if k in PHASES + ("cpu", "mib")
                          else int(v) for k, v in row.items()} for row in rows)


def exponent(rows: list[dict], value) -> float:
    """Slope of log value over log dofs, of the three largest meshes."""
    rows = rows[-3:]
    if len(rows) < 2 or any(value(r) <= 0.0 for r in rows):
        return float("nan")
    x = np.log([r["dofs"] for r in rows])
    return float(np.polyfit(x, np.log([value(r) for r in rows]), 1)[0])


def each(row: dict, field: str) -> float:
    """Processor seconds, of a phase by its share of the wall; a factorisation where a run makes
    many."""
    value = row["cpu"]
    if field != "cpu":
        value *= row[field]/max(sum(row[phase] for phase in PHASES), 1e-9)
    return value/max(row["factorisations"], 1) if row["kind"] == "forming" else value


def series(rows: list[dict]) -> dict[tuple[str, int], list[dict]]:
    """Rows by scene and dimension."""
    found = {}
    for row in rows:
        found.setdefault((row["kind"], int(row["dim"])), []).append(row)
    return found


def table(rows: list[dict]) -> str:
    """Largest mesh of each scene and the exponents."""
    lines = ["| scene | largest, dofs | CPU s | MiB | CPU | memory | factorise | other phases | "
             "exponent of the bare factorisation |", "| --- "*9 + "|"]
    bare = {dim: exponent(mine, lambda r: each(r, "factorise"))
            for (kind, dim), mine in series(rows).items() if kind == "linear"}
    for (kind, dim), mine in series(rows).items():
        last = mine[-1]
        rest = lambda r: sum(each(r, p) for p in PHASES if p != "factorise")  # noqa: E731
        lines.append(
            f"| {kind}, {'plane' if dim == 2 else 'space'} | {last['dofs']:.0f} | "
            f"{each(last, 'cpu'):.2f} | {last['mib']:.0f} | "
            f"{exponent(mine, lambda r: each(r, 'cpu')):.2f} | "
            f"{exponent(mine, lambda r: r['mib']):.2f} | "
            f"{exponent(mine, lambda r: each(r, 'factorise')):.2f} | {exponent(mine, rest):.2f} | "
            f"{bare.get(dim, float('nan')):.2f} |")
    return "\n".join(lines)


def draw(rows: list[dict]) -> None:
    """A panel for each scene and dimension: seconds by phase; the last row: memory."""
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    groups = series(rows)
    kinds = [k for k in KINDS if any(k == g for g, _ in groups)]
    fig, axes = plt.subplots(3, len(kinds), figsize=(3.4*len(kinds), 8.4), squeeze=False,
                             layout="constrained")
    for column, kind in enumerate(kinds):
        for line, dim in enumerate((2, 3)):
            mine, ax = groups.get((kind, dim), []), axes[line][column]
            for phase in PHASES:
                ax.loglog([r["dofs"] for r in mine], [max(each(r, phase), 1e-4) for r in mine],
                          ".-", lw=1, label=phase)
            ax.loglog([r["dofs"] for r in mine], [each(r, "cpu") for r in mine], "k--",
                      label="CPU of all")
            ax.set_title(f"{kind}, {'plane' if dim == 2 else 'space'}")
            ax.set_ylabel("s a factorisation" if kind == "forming" else "s")
            axes[2][column].loglog([r["dofs"] for r in mine], [r["mib"] for r in mine], "o-",
                                   label="plane" if dim == 2 else "space")
        axes[2][column].set_ylabel("MiB")
        axes[2][column].set_xlabel("degrees of freedom")
        axes[2][column].legend(fontsize=7)
    axes[0][0].legend(fontsize=6)
    fig.savefig(FOLDER/"growth.png", dpi=110)


def publish(rows: list[dict]) -> None:
    """Picture, and the table in its page."""
    draw(rows)
    text = PAGE.read_text(encoding="utf-8")
    before, rest = text.split("<!-- growth -->\n", 1)
    after = rest.split("<!-- end of growth -->", 1)[1]
    PAGE.write_text(f"{before}<!-- growth -->\n{table(rows)}\n<!-- end of growth -->{after}",
                    encoding="utf-8")


def main() -> None:
    """Run what is missing, smallest first."""
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--most", type=int, default=100000, help="degrees of freedom")
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--kinds", nargs="+", default=list(KINDS), choices=KINDS)
    parser.add_argument("--dims", nargs="+", type=int, default=[2, 3], choices=[2, 3])
    parser.add_argument("--draw", action="store_true")
    options = parser.parse_args()
    rows = read()
    known = {(r["kind"], int(r["dim"]), int(r["cells"])) for r in rows}
    wanted = [(2*dim*cells**dim, kind, dim, cells) for dim in options.dims
              for cells in CELLS[dim] for kind in options.kinds]
    for dofs, kind, dim, cells in sorted(wanted):
        if options.draw or dofs > options.most or (kind, dim, cells) in known:
            continue
        try:
            rows.append(measure(kind, dim, cells, options.repeat))
        except RuntimeError as trouble:
            print(f"{kind} {dim} {cells}: {trouble}", flush=True)
            continue
        write(rows)
        print(f"{kind} {dim}D {cells}: {dofs} dofs", flush=True)
    publish(rows)
    print(table(rows))


if __name__ == "__main__":
    main()
