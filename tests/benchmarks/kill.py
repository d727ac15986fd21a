"""Kill a deck at random moments, resume it, and compare every byte with a run left alone.

    python tests/benchmarks/kill.py DECK.inp [DECK.inp ...] [--kills 20] [--once] [--seed N]

Each trial starts anew and is killed once (--once) or, by default, again and again until a run ends
before its moment comes. Prints a Markdown table; the exit code is 1 where a byte differs.
"""
from __future__ import annotations

import argparse
import json
import os
import random
import subprocess
import tempfile
import time
from pathlib import Path

EXECUTABLE = os.environ.get("LOPIN_EXECUTABLE", str(Path(__file__).parents[2]/"build"/"lopin"))


def start(deck: Path, folder: Path, *options: str) -> subprocess.Popen:
    return subprocess.Popen([EXECUTABLE, "run", str(deck), "-o", str(folder), "-q", *options],
                            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def content(folder: Path) -> dict[str, object]:
    """Bytes by name; of the summary all but the times."""
    found: dict[str, object] = {p.name: p.read_bytes() for p in folder.iterdir()}
    for name in [n for n in found if n.endswith(".json")]:
        job = json.loads(found[name])
        for word in ("timing", "peak_memory_mib", "threads"):
            job.pop(word, None)
        found[name] = job
    return found


def trial(deck: Path, folder: Path, span: float, moments: random.Random, once: bool) -> int:
    """Times it was killed before it ended."""
    kills = 0
    options: tuple[str, ...] = ()
    while True:
        process = start(deck, folder, *options)
        if not (once and kills):
            time.sleep(moments.uniform(0.0, span))
            process.kill()
        if process.wait() >= 0:
            return kills
        kills += 1
        options = ("--resume",)


def main() -> int:
    words = argparse.ArgumentParser(description=__doc__,
                                    formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("deck", nargs="+", type=Path)
    words.add_argument("--kills", type=int, default=20)
    words.add_argument("--once", action="store_true")
    words.add_argument("--seed", type=int, default=random.randrange(10**6))
    asked = words.parse_args()
    moments = random.Random(asked.seed)
    worst = 0
    print(f"seed {asked.seed}\n\n| deck | seconds | trials | kills | differing |\n| --- | --- | --- | --- | --- |")
    for deck in asked.deck:
        with tempfile.TemporaryDirectory() as place:
            begun = time.perf_counter()
            start(deck, Path(place)/"alone").wait()
            span = time.perf_counter() - begun
            alone = content(Path(place)/"alone")
            trials = kills = differing = 0
            while kills < asked.kills:
                folder = Path(place)/f"broken{trials}"
                kills += trial(deck, folder, span, moments, asked.once)
                differing += content(folder) != alone
                trials += 1
        print(f"| {deck.stem} | {span:.1f} | {trials} | {kills} | {differing} |", flush=True)
        worst = max(worst, differing)
    return int(worst > 0)


if __name__ == "__main__":
    raise SystemExit(main())
