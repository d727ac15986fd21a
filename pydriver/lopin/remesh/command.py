"""`lopin run` of a deck with *REMESH."""
from __future__ import annotations

from pathlib import Path

from ..command_deck import given_by, parser_of, tell
from ..deck import Block, Deck
from ..errors import UsageError


def asks(block: Block) -> bool:
    """Whether a card asks for new meshes."""
    return block.keyword == "REMESH"


def run_remeshed(path: Path, arguments: list[str]) -> int:
    """Run it; the exit code."""
    from .driver import Runner

    parser = parser_of("a run with remeshing")
    for name in ("resume", "replay"):
        parser.add_argument(f"--{name}", action="store_true")
    given, options, quiet = given_by(parser, arguments)
    if given.resume and given.replay:
        raise UsageError("--resume goes on, --replay runs the parts again: one of them")
    output = given.output or Path("out")/path.stem
    runner = Runner(Deck.read(path), output, resume=given.resume, replay=given.replay,
                    say=(lambda line: None) if quiet else tell, **options)
    report = runner.run()
    print(report.json() if given.json else report.text())
    if given.strict:
        report.refuse_warnings()
    return 0
