"""Decks with small harms, through `lopin check` and `lopin run`: none may crash, hang or be silent.

``python tests/benchmarks/mutate.py LOPIN FOLDER FIRST COUNT [run]`` takes the harms of so many
numbers, from FIRST on: the same number is the same harm, so that batches can follow each other.
What is found stays in FOLDER as a deck with its number, and the exit code says whether there was
any.
"""
import random
import re
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
    if solve and not done.returncode and re.search(r"\bNaN\b|Infinity", said):
        return "NaN in an answer that is called good"
    return ""


def main() -> int:
    """Print the findings."""
    program, place = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
    first, count, solve = int(sys.argv[3]), int(sys.argv[4]), sys.argv[5:] == ["run"]
    place.mkdir(parents=True, exist_ok=True)
    files, found = decks(solve), 0
    for number in range(first, first + count):
        text, stem = (other_number if solve else harm)(number, files)
        deck = place/"now.inp"
        deck.write_text(text, encoding="utf-8")
        wrong = judge(program, deck, place, solve)
        if wrong:
            found += 1
            deck.replace(place/f"{number}_{stem}.inp")
            print(number, stem, wrong, flush=True)
    print(f"{count} decks from number {first}: {found} findings")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
