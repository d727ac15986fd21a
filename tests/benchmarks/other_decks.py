"""Contact decks of CalculiX's test package, run as they are, beside the results that come with them.

``python tests/benchmarks/other_decks.py FOLDER`` runs the decks of FOLDER (examples/test of the
package calculix-ccx-test, unpacked) and prints the table of docs/other-decks.md: every block of the
reference that both have, with its largest difference beside its largest value.
"""
import json
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
DECKS = ("beamcontact contact1 contact3 contact4 contact6 cubef2f1 fricloop friction1 friction2 "
         "hueeber1 hueeber3 metalforming plate punch1 ring1 thread "
         "changefric contact2 contactenergy cubef2f2 cubespring hueeber2 hueeber4 punch2 ring2 "
         "beamptied1 beamptied2 bolt changesurfbeh cubef2f3 gap gap2 metalformingmortar "
         "axiplane spring1 spring2").split()


def dat_blocks(path: Path) -> dict:
    """title: {time: {key: values}} of a .dat file; keys are nodes, or element and point."""
    blocks, rows = {}, None
    for line in path.read_text(errors="replace").splitlines():
        head = re.match(r"\s*(\S.*?)\s+(?:and )?time\s+(\S+)\s*$", line)
        if head:
            title = re.sub(r"\s*\(.*", "", head[1])
            rows = blocks.setdefault(title, {}).setdefault(float(head[2]), {})
            width = 2 if "elem, integ" in head[1] or "element+face" in head[1] else 1
            faces = "element+face" in head[1]
            continue
        words = line.removesuffix(" L").split()    # L: in the axes of the node
        if rows is None or len(words) < 3 or not re.fullmatch(r"\d+", words[0]):
            continue
        try:
            key = tuple(int(word) for word in words[:width])
            values = [float(word) for word in words[width:]]
        except ValueError:
            continue
        rows[(*key, len(rows)) if faces else key] = values
    return blocks


def frd_blocks(path: Path) -> dict:
    """The same of the nodal results of a .frd file (ASCII)."""
    blocks, rows, now = {}, None, 0.0
    for line in path.read_text(errors="replace").splitlines():
        if line.startswith("  100C"):
            now = float(line[12:24])
        elif line.startswith(" -4"):
            rows = blocks.setdefault(line.split()[1], {}).setdefault(now, {})
        elif line.startswith(" -3"):
            rows = None
        elif line.startswith(" -1") and rows is not None:
            rows[int(line[3:13]),] = [float(line[i:i + 12]) for i in range(13, len(line.rstrip()), 12)]
    return blocks


def compare(mine: dict, theirs: dict) -> list:
    """(block, largest difference, largest value of the reference, values compared)."""
    found = []
    for title, times in theirs.items():
        if title not in mine or not times:
            continue
        last = max(times)
        near = min(mine[title], key=lambda t: abs(t - last))
        if abs(near - last) > 1e-6*max(1.0, abs(last)):
            continue
        a, b = mine[title][near], times[last]
        keys = [key for key in b if key in a]
        if keys and len(next(iter(b))) < 3:
            pairs = [(x, y) for key in keys for x, y in zip(a[key], b[key])]
            one, two = np.array(pairs).T
            found.append((title, np.abs(one - two).max(), np.abs(two).max(), len(keys)))
        elif b and a:                       # other points: only the extremes compare
            one, two = (max((max(map(abs, row)) for row in rows.values()), default=0.0)
                        for rows in (a, b))
            found.append((title + " (largest value)", abs(one - two), two, 0))
    return found


def run(deck: Path, solver: Path, place: Path) -> tuple:
    """Exit code, time, summary, comparisons."""
    began = time.perf_counter()
    done = subprocess.run([solver, "run", deck, "-o", place/deck.stem, "--overwrite"],
                          capture_output=True, text=True)
    seconds = time.perf_counter() - began
    result, found = place/deck.stem, []
    for suffix, read in (("dat", dat_blocks), ("frd", frd_blocks)):
        mine, theirs = result/f"{deck.stem}.{suffix}", deck.with_suffix(f".{suffix}.ref")
        if mine.is_file() and theirs.is_file():
            found += compare(read(mine), read(theirs))
    summary = result/f"{deck.stem}.json"
    verdict = ""
    if summary.is_file():
        verdict = (json.loads(summary.read_text()).get("certificate") or {}).get("verdict", "")
    return done.returncode, seconds, verdict, found


def peer(deck: Path, place: Path) -> float:
    """Seconds of ccx on the same deck; not a number where there is no ccx."""
    (place/"ccx").mkdir(exist_ok=True)
    (place/"ccx"/deck.name).write_bytes(deck.read_bytes())
    began = time.perf_counter()
    try:
        subprocess.run(["ccx", deck.stem], cwd=place/"ccx", capture_output=True, timeout=300)
    except (FileNotFoundError, subprocess.TimeoutExpired):
        return float("nan")
    return time.perf_counter() - began


def main() -> None:
    """Print the table."""
    folder = Path(sys.argv[1])
    solver = Path(sys.argv[2]) if len(sys.argv) > 2 else ROOT/"build"/"lopin"
    print("| deck | exit | certificate | Lopin [s] | ccx [s] | block: largest difference beside the "
          "largest value |\n| --- | --- | --- | --- | --- | --- |")
    with tempfile.TemporaryDirectory() as place:
        for name in DECKS:
            deck = folder/f"{name}.inp"
            code, seconds, verdict, found = run(deck, solver, Path(place))
            blocks = "; ".join(f"{title}: {100.0*difference/(most or 1.0):.2g} %"
                               for title, difference, most, _ in found)
            print(f"| {name} | {code} | {verdict} | {seconds:.2f} | {peer(deck, Path(place)):.2f} | "
                  f"{blocks} |", flush=True)


if __name__ == "__main__":
    main()
