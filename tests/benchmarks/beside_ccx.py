"""Lopin beside CalculiX on the same decks: whole process, one thread, median of several runs.

    python tests/benchmarks/beside_ccx.py DECK.inp [DECK.inp ...] [--repeat 5] [--limit 600] [--hertz]

Each deck is run as it is by ``ccx`` and by Lopin, and by Lopin once more with exact contact
(its *SURFACE BEHAVIOR replaced by HARD). With --hertz (quarter model of two blocks, crown R=20,
E=200000, nu=0.3) the pressures of all slave nodes in the .frd are compared with Hertz for the
measured force. Prints a Markdown table; seconds are CPU seconds of the process.
"""
from __future__ import annotations

import argparse
import json
import os
import re
import resource
import shutil
import statistics
import subprocess
import tempfile
from pathlib import Path

import numpy as np

ONE_THREAD = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "CCX_NPROC_STIFFNESS": "1"}


def cpu_seconds(command: list[str], folder: Path, limit: float) -> float | None:
    """User plus system seconds; None if it failed or passed the limit."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    try:
        done = subprocess.run(command, cwd=folder, env=os.environ | ONE_THREAD, timeout=limit,
                              capture_output=True, check=False)
    except subprocess.TimeoutExpired:
        return None
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    spent = after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime
    return spent if done.returncode == 0 else None


def exact_contact(text: str) -> str:
    """The deck with hard contact by multipliers."""
    return re.sub(r"(?im)^\*SURFACE BEHAVIOR[^\n]*\n(?:[^*\n][^\n]*\n)?",
                  "*SURFACE BEHAVIOR, DIRECT\n", text)


def frd_block(path: Path, name: str) -> dict[int, list[float]]:
    """Values by node of the last data set of that name in an ASCII .frd."""
    values: dict[int, list[float]] = {}
    inside = False
    for line in path.read_text().splitlines():
        if line.startswith(" -4"):
            inside = line[5:13].strip() == name
            values = {} if inside else values
        elif line.startswith(" -3"):
            inside = False
        elif inside and line.startswith(" -1"):
            values[int(line[3:13])] = [float(line[k:k + 12])
                                       for k in range(13, len(line.rstrip()), 12)]
    return values


def hertz_error(folder: Path, stem: str, text: str) -> tuple[float, float]:
    """Relative L2 distance of the pressures to Hertz, and of the peak, for the force of TOP."""
    force = 4.0*abs([float(v) for v in re.findall(r"(?m)^ +(\S+) +(\S+) +(\S+)$", (
        folder/f"{stem}.dat").read_text().split("total force")[-1])[0]][2])
    modulus, radius = 200000.0/(2.0*(1.0 - 0.09)), 20.0
    a = (0.75*force*radius/modulus)**(1.0/3.0)
    p0 = 1.5*force/(np.pi*a*a)
    points = {int(m[0]): (float(m[1]), float(m[2]), float(m[3])) for m in re.findall(
        r"(?m)^(\d+), (\S+), (\S+), (\S+)$", text.split("*ELEMENT")[0])}
    contact = frd_block(folder/f"{stem}.frd", "CONTACT")
    crown = {n: p for n, p in points.items()
             if n in contact
             and abs(p[2] - (radius - np.sqrt(radius**2 - p[0]**2 - p[1]**2))) < 1e-6
             and p[2] >= 0.0}
    r = np.array([np.hypot(p[0], p[1]) for p in crown.values()])
    p = np.array([contact[n][3] for n in crown])
    hertz = p0*np.sqrt(np.maximum(0.0, 1.0 - (r/a)**2))
    return float(np.linalg.norm(p - hertz)/np.linalg.norm(hertz)), float(p.max()/p0 - 1.0)


def measure(name: str, deck: Path, arguments: argparse.Namespace, program: str) -> dict:
    """Run one program on one deck in a folder of its own."""
    text = deck.read_text()
    if name == "lopin exact":
        text = exact_contact(text)
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        (folder/deck.name).write_text(text)
        stem = deck.stem
        command = [program, stem] if name == "ccx" else [program, "run", deck.name, "-o", ".",
                                                         "--quiet",
                                                         "--overwrite", "--deterministic"]
        times = []
        for _ in range(arguments.repeat):
            times.append(cpu_seconds(command, folder, arguments.limit))
            if times[-1] is None:
                break
        row = {"deck": stem, "program": name,
               "cpu": None if None in times else statistics.median(times)}
        if name.startswith("lopin") and (folder/f"{stem}.json").exists():
            said = json.loads((folder/f"{stem}.json").read_text())
            row["equations"] = said["equations"]
            row["factorisations"] = sum(s["factorisations"] for s in said["steps"])
            row["phases"] = {k: v for k, v in said["timing"].items() if v >= 0.005 and k != "total"}
        elif (folder/f"{stem}.sta").exists():
            lines = [x for x in (folder/f"{stem}.sta").read_text().splitlines()
                     if x.split()[:1] == ["1"]]
            row["factorisations"] = sum(int(x.split()[3]) for x in lines)
        if arguments.hertz and row["cpu"] is not None:
            row["l2"], row["peak"] = hertz_error(folder, stem, text)
        return row


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("decks", nargs="+", type=Path)
    parser.add_argument("--repeat", type=int, default=5)
    parser.add_argument("--limit", type=float, default=600.0)
    parser.add_argument("--hertz", action="store_true")
    parser.add_argument("--skip-ccx", action="store_true")
    arguments = parser.parse_args()
    lopin = os.environ.get("LOPIN_EXECUTABLE") or str(Path(__file__).parents[2]/"build"/"lopin")
    ccx = shutil.which("ccx")
    print("| deck | program | CPU s | ccx / Lopin | factorisations | L2(p) to Hertz | peak | phases |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- |")
    for deck in arguments.decks:
        programs = [("lopin", lopin)]
        if "*CONTACT PAIR" in deck.read_text():
            programs.append(("lopin exact", lopin))
        if ccx and not arguments.skip_ccx:
            programs.insert(0, ("ccx", ccx))
        reference = None
        for name, program in programs:
            row = measure(name, deck, arguments, program)
            reference = row["cpu"] if name == "ccx" else reference
            ratio = f"{reference/row['cpu']:.1f}" if reference and row["cpu"] and name != "ccx" else ""
            phases = ", ".join(f"{k} {v:.2f}" for k, v in row.get("phases", {}).items())
            cpu = f"{row['cpu']:.2f}" if row["cpu"] is not None else f"not finished ({arguments.limit:g} s)"
            l2 = f"{100*row['l2']:.1f} %" if "l2" in row else ""
            peak = f"{100*row['peak']:+.1f} %" if "peak" in row else ""
            print(f"| {row['deck']} | {name} | {cpu} | {ratio} | {row.get('factorisations', '')} | {l2} "
                  f"| {peak} | {phases} |", flush=True)


if __name__ == "__main__":
    main()
