"""`lopin run` of a deck with *REMESH."""
from __future__ import annotations

import argparse
import re
from pathlib import Path

from ..deck import Deck
from ..errors import UsageError
from ..model_read_mesh import plain

_CARD = re.compile(r"^\s*\*\s*REMESH\b", re.I | re.M)
_INCLUDE = re.compile(r"^\s*\*\s*INCLUDE\s*,[^\n]*INPUT\s*=\s*([^\n,]+)", re.I | re.M)
#: Options of the executable that have a value, and those that do nothing in a run in parts.
_VALUES, _PASSED_OVER = ("-o", "--output", "--solver", "--threads", "--progress"), \
    ("--no-color", "--verbose", "-v")


def deck_to_remesh(arguments: list[str]) -> Path | None:
    """The deck of a command line, if it asks for remeshing."""
    words, skip = [], False
    for word in arguments:
        if skip:
            skip = False
        elif word in _VALUES:
            skip = True
        elif not word.startswith("-"):
            words.append(word)
    if words[:1] == ["run"]:
        words = words[1:]
    if len(words) != 1:
        return None
    path = Path(words[0])
    return path if path.is_file() and _asks(path, 0) else None


def _asks(path: Path, depth: int) -> bool:
    """Whether a deck or what it includes has the card."""
    text = path.read_text(encoding="utf-8", errors="replace")
    if _CARD.search(text):
        return True
    named = (path.parent/str(plain(name.strip())) for name in _INCLUDE.findall(text))
    return depth < 8 and any(p.is_file() and _asks(p, depth + 1) for p in named)


def run_remeshed(path: Path, arguments: list[str]) -> int:
    """Run it; the exit code."""
    from .driver import Runner

    parser = argparse.ArgumentParser(prog="lopin run", description="a run with remeshing")
    parser.add_argument("words", nargs="+")
    parser.add_argument("-o", "--output", type=Path)
    parser.add_argument("--solver")
    parser.add_argument("--threads", type=int)
    parser.add_argument("--progress", help="none: say nothing between parts")
    for name in ("resume", "replay", "overwrite", "deterministic", "strict", "json"):
        parser.add_argument(f"--{name}", action="store_true")
    parser.add_argument("-q", "--quiet", action="store_true")
    given = parser.parse_args([a for a in arguments if a not in _PASSED_OVER])
    if given.resume and given.replay:
        raise UsageError("--resume goes on, --replay runs the parts again: one of them")
    options = {name: getattr(given, name) for name in ("solver", "threads")
               if getattr(given, name) is not None}
    options |= {name: True for name in ("overwrite", "deterministic", "strict")
                if getattr(given, name)}
    quiet = given.quiet or given.json or given.progress == "none"
    output = given.output or Path("out")/path.stem
    runner = Runner(Deck.read(path), output, resume=given.resume, replay=given.replay,
                    say=(lambda line: None) if quiet else _say, **options)
    report = runner.run()
    print(report.json() if given.json else report.text())
    return 0


def _say(line: str) -> None:
    print(line, flush=True)
