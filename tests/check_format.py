"""The house's format of sources, as far as a program can check it.

All files: no tab, no blank at the end of a line, one newline at the end, no carriage return.
Fortran beside that: statements and their continuations are indented by threes, and blocks by one
step more than what opens them. Widths are counted by `tests/measure_sources.py` and
`tests/python/test_tree.py`.

    python3 tests/check_format.py          # what is not in order; exit code 1 if anything
    python3 tests/check_format.py --fix    # mend blanks, tabs and ends of files
"""
import argparse
import re
import sys
from pathlib import Path

from measure_sources import ROOT, split_comment

FOLDERS = ("fortran", "pydriver", "tests", "decks/make")
KINDS = (".f90", ".inc", ".py", ".c", ".txt", ".cmake", ".map")
BLOCK = (r"(?:\w+\s*:\s*)?(?:if\b.*\bthen$|do\b|select\s+(?:case|type|rank)\b|associate\s*\(|"
         r"block$|critical$|critical\s*\(|(?:where|forall)\s*\()")
UNIT = (r"(?:abstract\s+)?interface\b|type\b(?!\s*\()(?!\s+is\b)|enum\b|program\b|submodule\b|"
        r"module\s+(?!procedure\b|subroutine\b|function\b)")
PROCEDURE = (r"(?:(?:pure|elemental|impure|recursive|module|logical|integer|real|character|complex|"
             r"type|class|double\s+precision)\b[^:'\"]*?)??\b(?:subroutine|function)\s+\w+")
OPEN = re.compile(f"{BLOCK}|{UNIT}|{PROCEDURE}", re.IGNORECASE)
MIDDLE = re.compile(r"else\b|elsewhere\b|contains$", re.IGNORECASE)
#: Arms of a `select` stand where it stands.
ARM = re.compile(r"case\b\s*(?:\(|default)|(?:type|class|rank)\s+(?:is|default)\b|"
                 r"rank\s*(?:\(|default)", re.IGNORECASE)
END = re.compile(r"end\s*(?:if|do|select|associate|block|critical|where|forall|interface|type|enum|"
                 r"program|module|submodule|subroutine|function|$)", re.IGNORECASE)


def files(root: Path = ROOT):
    """Sources under the rules."""
    for folder in FOLDERS:
        for path in sorted((root/folder).rglob("*")):
            if path.suffix in KINDS and path.is_file() and "__pycache__" not in path.parts:
                yield path


def mended(text: str) -> str:
    """With blanks, tabs and the end of the file in order."""
    lines = [line.rstrip() for line in text.expandtabs(4).replace("\r", "").split("\n")]
    return "\n".join(lines).rstrip("\n") + "\n" if any(lines) else ""


def faults_of_blanks(text: str):
    """(line, what is wrong) of any file."""
    for number, line in enumerate(text.split("\n"), start=1):
        if "\t" in line:
            yield number, "a tab"
        if "\r" in line:
            yield number, "a carriage return"
        if line != line.rstrip():
            yield number, "blanks at the end"
    if text and (not text.endswith("\n") or text.endswith("\n\n")):
        yield text.count("\n") + 1, "the file does not end with one newline"


def masks_one_statement(statement: str) -> bool:
    """`where (mask) a = b` opens no block."""
    if not re.match(r"(?:where|forall)\b", statement, re.IGNORECASE):
        return False
    depth = 0
    for i, c in enumerate(statement):
        depth += (c == "(") - (c == ")")
        if c == ")" and depth == 0:
            return i < len(statement) - 1
    return False


def faults_of_indentation(text: str):
    """(line, what is wrong) of Fortran."""
    depth, going_on, statement, first = 0, False, "", 0
    for number, line in enumerate(text.split("\n"), start=1):
        code, _, _ = split_comment(line)
        code, blanks = code.strip(), len(line) - len(line.lstrip())
        if not code or code.startswith("#"):
            continue
        if going_on:
            if blanks != 3*(depth + 1) and blanks % 3:
                yield number, f"a continuation is indented by {blanks}"
        else:
            statement, first = "", number
            at = depth - bool(END.match(code) or MIDDLE.match(code) or ARM.match(code))
            if blanks != 3*at:
                yield number, f"indented by {blanks}, not {3*at}"
        statement += code.removeprefix("&").removesuffix("&")
        going_on = code.endswith("&")
        if going_on:
            continue
        if END.match(statement):
            depth -= 1
        elif OPEN.match(statement) and not (MIDDLE.match(statement) or ARM.match(statement)):
            depth += not masks_one_statement(statement)
    if depth:
        yield first, f"{depth} blocks stay open"


def faults(path: Path):
    """(line, what is wrong) of a file."""
    text = path.read_text(encoding="utf-8")
    yield from faults_of_blanks(text)
    if path.suffix == ".f90":
        yield from faults_of_indentation(text)


def main():
    """Print what is not in order."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--fix", action="store_true", help="mend blanks, tabs and ends of files")
    fix = parser.parse_args().fix
    wrong = 0
    for path in files():
        if fix:
            text = path.read_text(encoding="utf-8")
            if mended(text) != text:
                path.write_text(mended(text), encoding="utf-8")
        for number, what in faults(path):
            wrong += 1
            print(f"{path.relative_to(ROOT)}:{number}: {what}")
    sys.exit(wrong > 0)


if __name__ == "__main__":
    main()
