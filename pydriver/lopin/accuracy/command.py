"""`lopin run` of a deck that asks for an accuracy."""
from __future__ import annotations

import argparse
import sys
from pathlib import Path

from ..command_deck import given_by, parser_of, tell
from ..deck import Block
from ..errors import NotConvergedError


def asks(block: Block) -> bool:
    """Whether a card asks for an accuracy."""
    return block.keyword == "LOPIN" and "QUANTITY" in block.parameters


def options() -> argparse.ArgumentParser:
    """Of such a run."""
    parser = parser_of("runs until a number is known as well as asked")
    parser.add_argument("--most-elements", type=int, metavar="N",
                        help="no finer mesh than of so many solid elements")
    parser.add_argument("--most-seconds", type=float, metavar="S", default=float("inf"),
                        help="begin no run that would take longer, in CPU time")
    return parser


def run_asked(path: Path, arguments: list[str]) -> int:
    """Run it as often as it takes; the exit code."""
    from .reach import reach

    given, shared, quiet = given_by(options(), arguments)
    output = given.output or Path("out")/path.stem
    problem = None
    try:
        found = reach(path, output=output, say=(lambda line: None) if quiet else tell,
                      most_elements=given.most_elements,
                      most_seconds=given.most_seconds, **shared)
    except NotConvergedError as stopped:
        problem, found = stopped, getattr(stopped, "reached", None)
        if found is None:
            raise
    print(found.json() if given.json else found.text())
    if not given.json:
        print(f"results: {output}/mesh{found.levels[-1].mesh}")
    if problem is not None:
        print(f"error: {problem}", file=sys.stderr)
        return problem.code
    return 0
