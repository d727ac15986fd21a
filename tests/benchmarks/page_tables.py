"""What benchmarks that write tables into pages share: the marks, and the words of a command."""
from __future__ import annotations

import argparse
from pathlib import Path


def put_table(page: Path, begin: str, end: str, table: str) -> None:
    """A table in the place of what stands between two marks of a page."""
    before, rest = page.read_text(encoding="utf-8").split(begin)
    page.write_text(f"{before}{begin}\n{table}\n{end}{rest.split(end)[1]}", encoding="utf-8")


def scene_words(description: str) -> argparse.Namespace:
    """`[WORD ...] [--keep FOLDER] [--print]`: scenes, where rows are kept, whether no page."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("words", nargs="*")
    parser.add_argument("--keep", type=Path)
    parser.add_argument("--print", action="store_true", dest="only_print")
    return parser.parse_args()
