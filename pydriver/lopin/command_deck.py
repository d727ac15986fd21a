"""The deck of a command line of `lopin run`, and the options that runs of several parts share."""
from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator
from pathlib import Path

from .deck import Block, heads
from .model_read_mesh import DEEPEST, included

#: Options of the executable that have a value, and those that do nothing in a run in parts.
VALUES = ("-o", "--output", "--solver", "--threads", "--progress", "--most-elements",
          "--most-seconds")
_PASSED_OVER = ("--no-color", "--verbose", "-v")


def deck_of(arguments: list[str]) -> Path | None:
    """The deck of a command line to run."""
    words, skip = [], False
    for word in arguments:
        if skip:
            skip = False
        elif word in VALUES:
            skip = True
        elif not word.startswith("-"):
            words.append(word)
    if words[:1] == ["run"]:
        words = words[1:]
    path = Path(words[0]) if len(words) == 1 else None
    return path if path is not None and path.is_file() else None


def first_found(path: Path, asks: list[Callable[[Block], bool]]) -> int | None:
    """The number of the first of some questions that a deck asks, or what it includes; each file
    is read once, by its keyword lines."""
    found = set()
    for block in _heads(path, path.parent, 0):
        found |= {k for k, is_asked in enumerate(asks) if is_asked(block)}
        if 0 in found:
            break
    return min(found, default=None)


def _heads(path: Path, top: Path, depth: int) -> Iterator[Block]:
    """The keyword lines of a deck, those of its includes in their place."""
    for block in heads(path.read_text(encoding="utf-8-sig", errors="replace")):
        yield block
        inner = included(block, path.parent, top) if block.keyword == "INCLUDE" else None
        if inner is not None and depth < DEEPEST:
            yield from _heads(inner, top, depth + 1)


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
    given = parser.parse_intermixed_args([a for a in arguments if a not in _PASSED_OVER])
    options = {name: getattr(given, name) for name in ("solver", "threads")
               if getattr(given, name) is not None}
    options |= {name: True for name in ("overwrite", "deterministic", "strict")
                if getattr(given, name)}
    return given, options, given.quiet or given.json or given.progress == "none"


def tell(line: str) -> None:
    """Progress, at once."""
    print(line, flush=True)
