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


def deck_with(arguments: list[str], pattern: re.Pattern) -> Path | None:
    """The deck of a command line to run, if it or what it includes has a pattern."""
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
    return path if path.is_file() and _has(path, pattern, 0) else None


def _has(path: Path, pattern: re.Pattern, depth: int) -> bool:
    """Whether a deck or what it includes has a pattern."""
    text = path.read_text(encoding="utf-8", errors="replace")
    if pattern.search(text):
        return True
    named = (path.parent/str(plain(name.strip())) for name in _INCLUDE.findall(text))
    return depth < 8 and any(p.is_file() and _has(p, pattern, depth + 1) for p in named)


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
