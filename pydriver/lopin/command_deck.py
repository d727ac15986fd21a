"""The deck of a command line of `lopin run`, and the options that runs of several parts share."""
from __future__ import annotations

import argparse
import re
from pathlib import Path

from .model_read_mesh import plain

_INCLUDE = re.compile(r"^\s*\*\s*INCLUDE\s*,[^\n]*INPUT\s*=\s*([^\n,]+)", re.I | re.M)
#: Options of the executable that have a value, and those that do nothing in a run in parts.
_VALUES, _PASSED_OVER = ("-o", "--output", "--solver", "--threads", "--progress",
                         "--most-elements"), ("--no-color", "--verbose", "-v")


def deck_of(arguments: list[str]) -> Path | None:
    """The deck of a command line to run."""
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
    path = Path(words[0]) if len(words) == 1 else None
    return path if path is not None and path.is_file() else None


def first_found(path: Path, patterns: list[re.Pattern], depth: int = 0) -> int | None:
    """The number of the first pattern that a deck has, or what it includes; each file is read
    once."""
    text = path.read_text(encoding="utf-8", errors="replace")
    found = [k for k, pattern in enumerate(patterns) if pattern.search(text)]
    named = (path.parent/str(plain(name.strip())) for name in _INCLUDE.findall(text))
    if depth < 8 and 0 not in found:
        found += [k for p in named if p.is_file()
                  if (k := first_found(p, patterns, depth + 1)) is not None]
    return min(found, default=None)


def parser_of(description: str) -> argparse.ArgumentParser:
    """Options that all runs have."""
    parser = argparse.ArgumentParser(prog="lopin run", description=description)
    parser.add_argument("words", nargs="+")
    parser.add_argument("-o", "--output", type=Path)
    parser.add_argument("--solver")
    parser.add_argument("--threads", type=int)
    parser.add_argument("--progress", help="none: say nothing on the way")
    for name in ("overwrite", "deterministic", "strict", "json"):
        parser.add_argument(f"--{name}", action="store_true")
    parser.add_argument("-q", "--quiet", action="store_true")
    return parser


def given_by(parser: argparse.ArgumentParser, arguments: list[str]):
    """What a command line says, the options of a run in it, and whether it is quiet."""
    given = parser.parse_args([a for a in arguments if a not in _PASSED_OVER])
    options = {name: getattr(given, name) for name in ("solver", "threads")
               if getattr(given, name) is not None}
    options |= {name: True for name in ("overwrite", "deterministic", "strict")
                if getattr(given, name)}
    return given, options, given.quiet or given.json or given.progress == "none"


def tell(line: str) -> None:
    """Progress, at once."""
    print(line, flush=True)
