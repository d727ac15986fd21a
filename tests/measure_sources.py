"""Figures of the Fortran sources: what a reader must hold in mind at once.

Run as a program it prints a table and, with ``--list``, the places behind each figure. The limits of
`tests/python/test_sources.py` keep the figures from getting worse.
"""
import argparse
import re
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
#: Folders of fortran/ from the ground up: a module uses modules of lower floors or of its own folder.
FLOORS = (
    ("base",),
    ("mesh", "material", "linalg", "tool"),
    ("element", "contact/geometry", "contact/enforcement"),
    ("contact/search", "contact/friction"),
    ("contact/mortar", "deck"),
    ("model",),
    ("solids",),
    ("pairs/detection",),
    ("pairs/element", "pairs/linear"),
    ("pairs/mortar",),
    ("pairs/newton",),
    ("solve/workspace",),
    ("solve/linear", "solve/newton"),
    ("solve/checks",),
    ("solve/run",),
    ("build", "messages", "output"),
    ("api",),
    ("app",),
)
#: Words that an early version used in a sense of its own; docs/architecture.md says what replaced them.
PRIVATE = re.compile(r"(?<![a-z])(?:grips?|meetings?|ajar|coasts?|parted|march|keepers?|say_once|let_go|lets_go|"
                     r"rungs?|finite_(?:owner|grips|meeting|opposite|kernel|roles|system|state)|path_finite|"
                     r"path_newton|keep_state|judge_\w+|slow_motion|seed lecture)(?![a-z])", re.IGNORECASE)
BEGIN = re.compile(r"^\s*(?:(?:pure|elemental|impure|recursive|module|logical|integer|real|complex|"
                   r"character|type|class|double precision)\b[^!\"']*?)?\b(subroutine|function)\s+(\w+)\s*"
                   r"(?:\(|$|result|bind)", re.IGNORECASE)
END = re.compile(r"^\s*end\s*(?:subroutine|function)\b", re.IGNORECASE)
OPEN = re.compile(r"^\s*(?:\w+\s*:\s*)?(?:if\b.*\bthen\s*$|do\b|select\s+(?:case|type)\b|associate\s*\(|"
                  r"where\s*\([^)]*\)\s*$|block\s*$)", re.IGNORECASE)
SHUT = re.compile(r"^\s*end\s*(?:if|do|select|associate|where|block)\b", re.IGNORECASE)
DECLARATION = re.compile(r"^\s*(integer|real|complex|logical|character|type|class|procedure)\b(.*?)::(.*)",
                         re.IGNORECASE)


@dataclass
class Procedure:
    """A subroutine or function: where it stands and what it asks of its reader."""
    place: str
    name: str
    arguments: list
    public: bool = False
    lines: int = 0
    depth: int = 0
    documented: bool = False
    real_arguments: int = 0        # floating-point dummy arguments
    with_unit: int = 0             # of those, with a comment


@dataclass
class Module:
    """One file of Fortran."""
    path: Path
    folder: str
    text: str
    uses: set = field(default_factory=set)
    procedures: list = field(default_factory=list)
    types: dict = field(default_factory=dict)      # name: number of components
    excused: set = field(default_factory=set)      # types whose docstring says why they are large


def statements(text: str):
    """Lines joined over their continuation: (first line, code, comment)."""
    code, comment, first = "", "", 1
    for number, line in enumerate(text.split("\n"), start=1):
        body, _, said = split_comment(line)
        if not code:
            first = number
        code += re.sub(r"^\s*&", " ", body) if code else body
        comment += said
        if code.rstrip().endswith("&"):
            code = code.rstrip()[:-1]
            continue
        yield first, code, comment
        code, comment = "", ""


def split_comment(line: str):
    """Code and comment; an exclamation mark in a string is none."""
    quote = ""
    for i, c in enumerate(line):
        if quote:
            quote = "" if c == quote else quote
        elif c in "'\"":
            quote = c
        elif c == "!":
            return line[:i], "!", line[i:]
    return line, "", ""


def folder_of(path: Path) -> str:
    """The folder of a source below fortran/, as FLOORS names it."""
    parts = path.parent.parts
    return "/".join(parts[len(parts) - parts[::-1].index("fortran"):])


def read_module(path: Path) -> Module:
    """Measure one file, with the body that it includes if that has its name."""
    text = path.read_text(encoding="utf-8")
    body = path.with_suffix(".inc")
    if body.exists():
        text = text.replace(f"   include '{body.name}'\n", body.read_text(encoding="utf-8"))
    folder = folder_of(path)
    module = Module(path, folder, text)
    module.uses = {u.lower() for u in re.findall(r"^\s*use\s*(?:,\s*\w+\s*)?(?:::)?\s*lopin_(\w+)", text,
                                                 re.IGNORECASE | re.MULTILINE)}
    names = " ".join(re.findall(r"^\s*public\s*(?:::)?(.*(?:&\n.*)*)", text,
                                re.IGNORECASE | re.MULTILINE)).lower()
    public = set(re.findall(r"\w+", names))
    stack, inside, before, in_interface = [], "", "", False
    for line, code, comment in statements(text):
        if re.match(r"^\s*(?:abstract\s+)?interface\b", code, re.IGNORECASE):
            in_interface = True
        if re.match(r"^\s*end\s*interface\b", code, re.IGNORECASE):
            in_interface = False
        if in_interface:
            before = ""
            continue
        kind = re.match(r"^\s*type\b\s*(?:,[^:]*)?(?:::)?\s*(\w+)\s*$", code, re.IGNORECASE)
        if kind and "(" not in code.split("::")[-1]:
            inside = kind[1].lower()
            module.types[inside] = 0
            if "Many components:" in before:
                module.excused.add(inside)
        elif re.match(r"^\s*end\s*type\b", code, re.IGNORECASE):
            inside = ""
        elif inside and DECLARATION.match(code) and not re.match(r"^\s*procedure\b(?!\s*\()", code,
                                                                 re.IGNORECASE):
            declared = re.sub(r"\([^()]*\)", "", re.sub(r"\([^()]*\)", "", DECLARATION.match(code)[3]))
            module.types[inside] += declared.count(",") + 1
        begun = None if END.match(code) else BEGIN.match(code)
        if begun and not inside:
            listed = re.search(rf"\b{begun[2]}\s*\(([^)]*)\)", code, re.IGNORECASE)
            arguments = [a.strip().lower() for a in listed[1].split(",") if a.strip()] if listed else []
            stack.append([Procedure(f"{folder}/{path.name}:{line}", begun[2].lower(), arguments,
                                    begun[2].lower() in public, documented=bool(before)), line, 0])
        elif END.match(code) and stack:
            one, begin, _ = stack.pop()
            one.lines = line - begin + 1
            module.procedures.append(one)
        elif stack:
            one = stack[-1]
            if OPEN.match(code):
                one[2] += 1
                one[0].depth = max(one[0].depth, one[2])
            elif SHUT.match(code):
                one[2] -= 1
            declared = DECLARATION.match(code)
            if declared and declared[1].lower() == "real":
                names = re.findall(r"\w+", re.sub(r"\([^()]*\)", "", declared[3].lower()))
                dummies = [n for n in names if n in one[0].arguments]
                one[0].real_arguments += len(dummies)
                one[0].with_unit += len(dummies) if "!!" in comment else 0
        before = before + comment if comment.startswith("!>") or (before and comment) else ""
        if code.strip():
            before = ""
    return module


def read_all(root: Path = ROOT) -> dict:
    """All modules by the stem of their file."""
    return {path.stem: read_module(path) for path in sorted((root/"fortran").glob("*/**/*.f90"))}


def unreachable(modules: dict) -> list:
    """Stems that neither the executable nor the library of Python uses."""
    seen, todo = set(), [stem for stem, module in modules.items() if module.folder in ("app", "api")]
    while todo:
        stem = todo.pop()
        if stem in seen or stem not in modules:
            continue
        seen.add(stem)
        todo += modules[stem].uses
    return sorted(set(modules) - seen)


def figures(modules: dict) -> dict:
    """Each figure: (value, the places behind it)."""
    procedures = [p for m in modules.values() for p in m.procedures]
    public = [p for p in procedures if p.public]

    def places(chosen):
        return [f"{p.place} {p.name}" for p in chosen]

    long_files = [f"{m.folder}/{m.path.name}: {m.text.count(chr(10))}" for m in modules.values()
                  if m.text.count("\n") > 400]
    wide = [f"{m.folder}/{m.path.name}:{k}" for m in modules.values()
            for k, line in enumerate(m.text.split("\n"), start=1) if len(line) > 100]
    big = [f"{m.folder}/{m.path.name} {name}: {n}" for m in modules.values() for name, n in m.types.items()
           if n > 20]
    bare_types = [f"{m.folder}/{m.path.name} {name}: {n}" for m in modules.values()
                  for name, n in m.types.items() if n > 20 and name not in m.excused]
    asked, told = sum(p.real_arguments for p in public), sum(p.with_unit for p in public)
    bare = [p for p in public if not p.documented]
    dead = unreachable(modules)
    private = [f"{m.folder}/{m.path.name}:{k} {found[0]}" for m in modules.values()
               for k, line in enumerate(m.text.split("\n"), start=1) for found in PRIVATE.finditer(line)]
    folders = {}
    for m in modules.values():
        folders[m.folder] = folders.get(m.folder, 0) + 1
    many, deep, long = ([p for p in procedures if len(p.arguments) > 8],
                        [p for p in procedures if p.depth > 4], [p for p in procedures if p.lines > 60])
    return {
        "modules": (len(modules), [f"{name}: {n}" for name, n in sorted(folders.items())]),
        "lines": (sum(m.text.count("\n") for m in modules.values()), []),
        "files above 400 lines": (len(long_files), long_files),
        "lines above 100 columns": (len(wide), wide),
        "procedures": (len(procedures), []),
        "procedures above 8 arguments": (len(many), places(many)),
        "procedures nested deeper than 4": (len(deep), places(deep)),
        "procedures above 60 lines": (len(long), places(long)),
        "types above 20 components": (len(big), big),
        "types above 20 components without a reason beside them": (len(bare_types), bare_types),
        "modules out of reach": (len(dead), dead),
        "words of a private vocabulary": (len(private), private),
        "public procedures without a docstring, %": (round(100*len(bare)/max(1, len(public)), 1),
                                                     places(bare)),
        "real arguments of public procedures with a comment, %": (round(100*told/max(1, asked), 1), []),
    }


def main():
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--list", action="store_true", help="the places behind each figure")
    parser.add_argument("--root", type=Path, default=ROOT, help="the tree to count; default: this one")
    options = parser.parse_args()
    for name, (value, where) in figures(read_all(options.root)).items():
        print(f"{value:>8}  {name}")
        for place in where if options.list else ():
            print(" "*12 + place)


if __name__ == "__main__":
    main()
