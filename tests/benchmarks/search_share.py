"""Share of the wall time that contact search takes in decks above 10 000 dofs: rewrites its table
in docs/search.md.

    python tests/benchmarks/search_share.py [--repeat 1]

The decks are made on the fly, one thread. On the linear paths "search" is the projection of every
slave point at the start; on the finite path "search" is the start of each increment, and what
evaluations ask anew is a part of "contact".
"""
from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import tempfile
from pathlib import Path

from page_tables import put_table

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT/"docs"/"search.md"
BEGIN, END = "<!-- search_share.py -->", "<!-- end of search_share.py -->"


def block(node: int, element: int, name: str, cells: tuple, corner: tuple, size: tuple) -> str:
    """A box of bilinear or trilinear elements; nodes run along x, then y, then z."""
    solid = len(cells) == 3
    nx, ny, nz = (*cells, 0) if not solid else cells
    text = "*NODE, NSET=ALL\n"
    at = node
    for k in range(nz + 1):
        for j in range(ny + 1):
            for i in range(nx + 1):
                place = [c + s*f/n for c, s, f, n in zip(corner, size, (i, j, k), cells)]
                text += f"{at}, " + ", ".join(f"{x:.9g}" for x in place) + "\n"
                at += 1
    text += f"*ELEMENT, TYPE={'C3D8' if solid else 'CPE4'}, ELSET={name}\n"
    layer = (nx + 1)*(ny + 1)
    for k in range(max(nz, 1)):
        for j in range(ny):
            for i in range(nx):
                n = node + i + (nx + 1)*j + layer*k
                corners = [n, n + 1, n + nx + 2, n + nx + 1]
                corners += [c + layer for c in corners]*solid
                text += f"{element}, " + ", ".join(map(str, corners)) + "\n"
                element += 1
    return text + f"*SOLID SECTION, ELSET={name}, MATERIAL=M\n" + ("" if solid else "1.\n")


def generated(kind: str, name: str, first: int, last: int) -> str:
    """A set of consecutive labels."""
    return f"*{kind}, {kind}={name}, GENERATE\n{first}, {last}\n"


def blocks(lower: tuple, upper: tuple, finite: bool, words: str, friction: str,
           slide: float) -> str:
    """A block pressed on a longer one, and drawn along it."""
    solid = len(lower) == 3
    low, high = ((6.0, 4.0, 2.0), (4.0, 4.0, 2.0)) if solid else ((6.0, 2.0), (4.0, 2.0))
    up, along = (3, 2) if solid else (2, 1)
    start = (1.0, 0.0, 2.0) if solid else (1.0, 2.0)
    text = "*MATERIAL, NAME=M\n*ELASTIC\n1000., 0.3\n"
    text += block(1, 1, "LOW", lower, (0.0,)*len(lower), low)
    text += block(500001, 500001, "HIGH", upper, start, high)
    layers = []
    for cells in (lower, upper):
        nodes = (cells[0] + 1)*(cells[1] + 1 if solid else 1)
        elements = cells[0]*(cells[1] if solid else 1)
        layers.append((nodes, elements, cells[-1]))
    (n1, e1, h1), (n2, e2, h2) = layers
    text += generated("NSET", "FOOT", 1, n1) + generated("NSET", "HEAD", 500001 + n2*h2,
                                                         500000 + n2*(h2 + 1))
    text += generated("ELSET", "TOP", 1 + e1*(h1 - 1), e1*h1) + generated("ELSET", "BOTTOM", 500001,
                                                                          500000 + e2)
    text += f"*SURFACE, NAME=UNDER\nBOTTOM, S1\n*SURFACE, NAME=OVER\nTOP, {'S2' if solid else 'S3'}\n"
    text += f"*SURFACE INTERACTION, NAME=TOUCH\n*SURFACE BEHAVIOR, DIRECT\n{friction}"
    text += f"*CONTACT PAIR, INTERACTION=TOUCH, {words}\nUNDER, OVER\n"
    step = "*STEP, NLGEOM, INC=100\n" if finite else "*STEP, INC=100\n"
    text += f"{step}*STATIC\n0.5, 1., 1e-3, 0.5\n*BOUNDARY\nFOOT, 1, {len(lower)}\nHEAD, {up}, {up}, -0.01\n"
    text += f"HEAD, {3 - along if not solid else 2}, {3 - along if not solid else 2}\n" if solid else ""
    return text + f"HEAD, 1, 1, {slide}\n*NODE PRINT, NSET=HEAD\nU\n*END STEP\n"


DECKS = (
    ("two blocks in the plane, finite sliding over 8 facets, node to segment",
     lambda: blocks((150, 24), (90, 24), True, "TYPE=NODE TO SURFACE", "*FRICTION\n0.2\n", 0.32)),
    ("the same by mortar",
     lambda: blocks((150, 24), (90, 24), True, "TYPE=SURFACE TO SURFACE", "*FRICTION\n0.2\n",
                    0.32)),
    ("two blocks in space, small sliding, node to segment",
     lambda: blocks((24, 16, 6), (14, 14, 6), False, "TYPE=NODE TO SURFACE", "", 0.0)),
    ("the same by mortar",
     lambda: blocks((24, 16, 6), (14, 14, 6), False, "TYPE=SURFACE TO SURFACE", "", 0.0)),
)


def run(text: str, folder: Path) -> dict:
    """The job.json of a deck."""
    (folder/"job.inp").write_text(text, encoding="utf-8")
    executable = os.environ.get("LOPIN_EXECUTABLE", str(ROOT/"build"/"lopin"))
    subprocess.run([executable, "run", "job.inp", "-o", ".", "--overwrite", "--quiet"], cwd=folder,
                   check=True,
                   env=os.environ | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"},
                   capture_output=True)
    return json.loads((folder/"job.json").read_text(encoding="utf-8"))


def row(name: str, text: str, repeat: int) -> str:
    """A line of the table."""
    jobs = []
    for _ in range(repeat):
        with tempfile.TemporaryDirectory() as folder:
            jobs.append(run(text, Path(folder)))
    job = jobs[0]
    share = [statistics.median(100.0*j["timing"][what]/j["timing"]["total"] for j in jobs)
             for what in ("search", "contact", "factorise")]
    asked = sum(s.get("search", {}).get("queries", 0) for s in job["steps"])
    iterations = sum(s["iterations"] for s in job["steps"])
    wall = statistics.median(j["timing"]["total"] for j in jobs)
    cells = [name, job["path"], job["equations"], job["contact"][0]["closed"], iterations,
             asked or "", f"{wall:.2f}", *(f"{s:.1f}" for s in share)]
    return "| " + " | ".join(map(str, cells)) + " |\n"


def main() -> None:
    """Run all decks and put the table where its marks stand."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeat", type=int, default=1)
    repeat = parser.parse_args().repeat
    table = "| deck | path | equations | closed | iterations | queries | wall [s] | search [%] | contact [%] | factorise [%] |\n"
    table += "| --- "*10 + "|\n"
    for name, make in DECKS:
        table += row(name, make(), repeat)
        print(table.splitlines()[-1], flush=True)
    put_table(PAGE, BEGIN, END, table.rstrip("\n"))


if __name__ == "__main__":
    main()
