"""A billet in space under a meshed elastic plate, Lopin beside CalculiX on one deck: CPU time and
the difference of their forces by mesh and formulation, as a table of Markdown.

    python tests/benchmarks/billet_beside_ccx.py [--cells 3 4 7] [--repeat 3] [--limit 3600]

The deck of billet_in_space.py, once TYPE=NODE TO SURFACE and once TYPE=SURFACE TO SURFACE. The
programs run in turns, one thread each, in an empty folder; of each the least CPU time of its runs counts (CalculiX once
where it takes more than a minute). The difference is that of the forces over the time, root mean
square beside that of CalculiX, from where both have ended an increment: on the way to there metal
begins to flow, and a program that has cut its first increment has points on the elastic line that
the other has not.
"""
from __future__ import annotations

import argparse
import resource
import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np
from billet_in_space import LOPIN, deck, totals

WORDS = ("NODE TO SURFACE", "SURFACE TO SURFACE")


def run(command: list[str], folder: Path, limit: float) -> float:
    """CPU seconds of a command."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, cwd=folder, timeout=limit, capture_output=True, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def compare(text: str, repeat: int, limit: float) -> tuple[dict, float, dict]:
    """Least CPU seconds of both, the difference of their forces, and their increments."""
    least, history = {}, {}
    with tempfile.TemporaryDirectory() as place:
        folders = {name: Path(place)/name for name in ("ccx", "lopin")}
        for folder in folders.values():
            folder.mkdir()
            (folder/"billet.inp").write_text(text)
        commands = {"ccx": ["ccx", "billet"],
                    "lopin": [LOPIN, "run", "billet.inp", "-o", ".", "--overwrite", "--quiet"]}
        for _ in range(repeat):
            for name, command in commands.items():
                if name == "ccx" and least.get(name, 0.0) > 60.0:
                    continue
                for old in folders[name].iterdir():
                    if old.name != "billet.inp":
                        shutil.rmtree(old) if old.is_dir() else old.unlink()
                seconds = run(command, folders[name], limit)
                least[name] = min(seconds, least.get(name, seconds))
        for name, folder in folders.items():
            history[name] = totals(folder/"billet.dat")
    count = {name: len(h[0]) - 1 for name, h in history.items()}
    return least, distance(history["lopin"], history["ccx"]), count


def distance(mine: tuple, other: tuple) -> float:
    """Root mean square of the difference of two forces over time, beside the other force."""
    begun = max(mine[0][1], other[0][1])
    times, forces = (values[other[0] >= begun - 1e-9] for values in other)
    return float(np.sqrt(((np.interp(times, *mine) - forces)**2).sum()/(forces**2).sum()))


def main() -> None:
    """Run all meshes and formulations."""
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cells", type=int, nargs="+", default=[3, 4, 7])
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--limit", type=float, default=3600.0)
    options = parser.parse_args()
    print("| cells | contact | ccx CPU s | Lopin CPU s | ccx / Lopin | increments "
          "| forces differ |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    for cells in options.cells:
        for word in WORDS:
            text = deck(cells, None).replace(WORDS[0], word)
            try:
                least, difference, count = compare(text, options.repeat, options.limit)
            except (subprocess.TimeoutExpired, subprocess.CalledProcessError) as trouble:
                print(f"| {cells} | {word.lower()} | {trouble} |", flush=True)
                continue
            print(f"| {cells} | {word.lower()} | {least['ccx']:.2f} | {least['lopin']:.2f} | "
                  f"{least['ccx']/least['lopin']:.1f} | {count['ccx']}, {count['lopin']} | "
                  f"{100.0*difference:.2f} % |", flush=True)


if __name__ == "__main__":
    main()
