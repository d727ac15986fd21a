"""Decks with small harms, through `lopin check` and `lopin run`: none may crash, hang or be silent.

``python tests/benchmarks/mutate.py LOPIN FOLDER FIRST COUNT [run]`` takes the harms of so many
numbers, from FIRST on: the same number is the same harm, so that batches can follow each other.
What is found stays in FOLDER as a deck with its number, and the exit code says whether there was
any. LOPIN is the executable, or `library` for the package in this process: hundreds follow each
other in a child, which is four times as fast, and what one leaves behind meets the next.
"""
import json
import mmap
import os
import random
import re
import signal
import struct
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
#: What a program that is in order ends with.
CODES = {0, 1, 2, 3, 4, 5}
CRASH = re.compile(r"Fortran runtime|[Bb]acktrace|SIG[A-Z]{3,4}|Sanitizer|E07(?:99|00)|internal error")
NUMBERS = ("0", "-1", "1e308", "-1e-308", "nan", "1e999", "2147483648", "1,,2", "1.e", "", "ALL")


FACTORS = (0.0, -1.0, 1e-6, 1e-3, 0.1, 0.5, 2.0, 10.0, 1e3, 1e6)


def decks(solve: bool) -> list[Path]:
    """Decks that are small enough to be read, or solved, in no time."""
    found = sorted(p for p in ROOT.glob("decks/*.inp") if p.stat().st_size < 12_000)
    found = [p for p in found if "*INCLUDE" not in p.read_text(encoding="utf-8")]
    return found if solve else [*found, *found, *sorted(ROOT.glob("decks/bad/*.inp"))]


def other_number(number: int, files: list[Path]) -> tuple[str, str]:
    """A deck with one of its numbers changed: most of these are read, and solved or refused."""
    dice = random.Random(number)
    source = dice.choice(files)
    text = source.read_text(encoding="utf-8")
    places = [m for m in re.finditer(r"(?<![\w.])-?\d+\.\d*(?:[eE][-+]?\d+)?(?![\w.])", text)
              if not text[text.rfind("\n", 0, m.start()) + 1:m.start()].startswith("**")]
    place = dice.choice(places)
    value = float(place[0])*dice.choice(FACTORS)
    return text[:place.start()] + repr(value) + text[place.end():], source.stem


def harm(number: int, files: list[Path]) -> tuple[str, str]:
    """The deck of a number, and the name of the deck that it was."""
    dice = random.Random(number)
    source = dice.choice(files)
    lines = source.read_text(encoding="utf-8", errors="replace").splitlines()
    for _ in range(dice.choice((1, 1, 1, 2, 3))):
        at = dice.randrange(len(lines))
        line = lines[at]
        kind = dice.randrange(9)
        if kind == 0:
            del lines[at]
        elif kind == 1:
            lines.insert(at, dice.choice(lines))
        elif kind == 2:
            other = dice.choice(files).read_text(encoding="utf-8", errors="replace").splitlines()
            start = dice.randrange(len(other))
            lines[at:at] = other[start:start + dice.choice((1, 2, 5))]
        elif kind == 3:
            fields = line.split(",")
            fields[dice.randrange(len(fields))] = dice.choice(NUMBERS)
            lines[at] = ",".join(fields)
        elif kind == 4 and line:
            k = dice.randrange(len(line))
            lines[at] = line[:k] + dice.choice(",*=-. \t\"'A9\x00é") + line[k + 1:]
        elif kind == 5:
            lines[at:] = [line[:dice.randrange(len(line) + 1)]]
        elif kind == 6:
            b = dice.randrange(len(lines))
            lines[at], lines[b] = lines[b], lines[at]
        elif kind == 7:
            lines[at] = re.sub(r"=\s*\w+", "=" + dice.choice(("NONE", "", "1", "ALL")), line, count=1)
        else:
            lines[at] = re.sub(r"\d+", lambda m: str(int(m[0]) + dice.choice((-1, 1, 10))), line,
                               count=1)
        lines = lines or [""]
    return "\n".join(lines) + "\n", source.stem


def judge(program: Path, deck: Path, place: Path, solve: bool) -> str:
    """What is wrong with how the program takes the deck; nothing: ''."""
    words = [program, "run", deck, "-o", place/"out", "--overwrite", "--progress", "none"] if solve \
        else [program, "check", deck]
    try:
        done = subprocess.run(words, capture_output=True, timeout=20, cwd=ROOT/"decks")
    except subprocess.TimeoutExpired:
        return "" if solve else "no end in 20 s"
    said = (done.stdout + done.stderr).decode(errors="replace")
    if done.returncode not in CODES:
        return f"exit code {done.returncode}"
    if CRASH.search(said):
        return CRASH.search(said)[0]
    if done.returncode and not re.search(r"error\[E\d{4}\]", said):
        return f"exit code {done.returncode} without an error"
    if done.returncode == 1 and "-->" not in said:
        return "an error of the deck without its line: " + re.search(r"error\[.*", said)[0]
    if solve and not done.returncode and re.search(r"\bNaN\b|Infinity", said):
        return "NaN in an answer that is called good"
    return ""


def judge_here(text: str, solve: bool) -> str:
    """The same of the library in this process."""
    from lopin import _bridge

    words = (text, "now.inp", str(ROOT/"decks"), "")
    signal.setitimer(signal.ITIMER_PROF, 20.0)   # of the processor: the machine may be shared
    session = _bridge.Session(*words) if solve else _bridge.Session.opened(*words, {}, b"")
    if not solve:
        session.end()
    summary = json.dumps(session.summary()) if solve and not session.code else ""
    code, said = session.code, [d for d in session.diagnostics if d["severity"] == "error"]
    session.close()
    signal.setitimer(signal.ITIMER_PROF, 0.0)
    if code not in CODES:
        return f"exit code {code}"
    if code and not said:
        return f"exit code {code} without an error"
    if code == 1 and not any(d["line"] for d in said):
        return "an error of the deck without its line: " + said[0]["message"]
    return "NaN in an answer that is called good" if re.search(r"NaN|Infinity", summary) else ""


def in_children(place: Path, numbers: range, take) -> int:
    """Take numbers in children of a hundred; who dies is a finding, and the next one goes on."""
    at = mmap.mmap(-1, 8)
    found, first = 0, numbers.start
    while first < numbers.stop:
        last = min(first + 100, numbers.stop)
        at[:] = struct.pack("ii", first, 0)
        child = os.fork()
        if child == 0:
            os.dup2(os.open(place/"said", os.O_WRONLY | os.O_CREAT | os.O_TRUNC), 2)
            for number in range(first, last):
                at[:4] = struct.pack("i", number)
                if take(number):
                    at[4:] = struct.pack("i", struct.unpack("i", at[4:])[0] + 1)
            os._exit(0)
        status = os.waitpid(child, 0)[1]
        number, more = struct.unpack("ii", at[:])
        found, first = found + more, last
        if status:
            first = number + 1
            hung = os.WIFSIGNALED(status) and os.WTERMSIG(status) == signal.SIGPROF
            why = "no end in 20 s" if hung else f"status {status}: " + \
                (place/"said").read_text(errors="replace")[:200]
            found += take(number, why)
    return found


def main() -> int:
    """Print the findings."""
    place = Path(sys.argv[2]).resolve()
    first, count, solve = int(sys.argv[3]), int(sys.argv[4]), sys.argv[5:] == ["run"]
    place.mkdir(parents=True, exist_ok=True)
    files, here = decks(solve), sys.argv[1] == "library"
    program = Path(sys.argv[1]).resolve()

    def take(number: int, wrong: str | None = None) -> bool:
        text, stem = (other_number if solve else harm)(number, files)
        if wrong is None and here:
            wrong = judge_here(text, solve)
        deck = place/"now.inp"
        if wrong is None or wrong:
            deck.write_text(text, encoding="utf-8")
        if wrong is None:
            wrong = judge(program, deck, place, solve)
        if wrong and not (solve and wrong == "no end in 20 s"):
            deck.replace(place/f"{number}_{stem}.inp")
            print(number, stem, wrong, flush=True)
            return True
        return False

    if here:
        from lopin import _bridge

        _bridge.core()
        found = in_children(place, range(first, first + count), take)
    else:
        found = sum(map(take, range(first, first + count)))
    print(f"{count} decks from number {first}: {found} findings")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
