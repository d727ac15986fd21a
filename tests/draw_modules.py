"""The graph of the Fortran modules, drawn from their sources.

    python3 tests/draw_modules.py            # the graph of the folders, as in docs/architecture.md
    python3 tests/draw_modules.py --write    # put it there
    python3 tests/draw_modules.py contact    # modules of a folder: purpose, uses, used by
    python3 tests/draw_modules.py newton     # the same of one module
"""
import argparse
import re

from measure_sources import FLOORS, ROOT, read_all

PAGE = ROOT/"docs"/"architecture.md"
BEGIN = "<!-- drawn by tests/draw_modules.py: do not edit -->"
END = "<!-- end of the drawing -->"
FOLDERS = tuple(folder for floor in reversed(FLOORS) for folder in floor)


def edges(modules: dict) -> dict:
    """Folders, to the folders whose modules theirs use."""
    found = {folder: set() for folder in FOLDERS}
    for module in modules.values():
        found[module.folder] |= {modules[u].folder for u in module.uses if u in modules}
    return {folder: used - {folder} for folder, used in found.items()}


def by_area(graph: dict) -> dict:
    """The same of the folders that stand in fortran/ itself."""
    found = {}
    for folder, used in graph.items():
        area = folder.split("/")[0]
        found.setdefault(area, set()).update(u.split("/")[0] for u in used)
    return {area: used - {area} for area, used in found.items()}


def without_ways_round(graph: dict) -> dict:
    """Only edges that no longer way replaces."""
    def reached(start, skipped):
        seen, todo = set(), [u for u in graph[start] if u != skipped]
        while todo:
            one = todo.pop()
            if one not in seen:
                seen.add(one)
                todo += graph[one]
        return seen

    return {folder: {u for u in used if u not in reached(folder, u)}
            for folder, used in graph.items()}


def drawing(modules: dict) -> str:
    """Folders and their edges as a picture, and all edges as a table."""
    graph = edges(modules)
    lines = [BEGIN, "```mermaid", "flowchart TD"]
    for folder, used in without_ways_round(by_area(graph)).items():
        lines += [f"  {folder} --> {other}" for other in sorted(used)]
    lines += ["```", "", "| folder | uses modules of |", "| --- | --- |"]
    lines += [f"| {folder} | {', '.join(sorted(used)) or 'none'} |"
              for folder, used in graph.items()]
    return "\n".join([*lines, END])


def redrawn(page: str, modules: dict) -> str:
    """The page with today's drawing."""
    before, rest = page.split(BEGIN)
    return before + drawing(modules) + rest.split(END)[1]


def purpose(module) -> str:
    """The first sentence of a file."""
    said = re.match(r"(?:!>?\s?.*\n)+", module.text)
    text = " ".join(line.lstrip("!> ").strip() for line in (said[0] if said else "").split("\n"))
    return re.split(r"(?<=[.:])\s", text.strip(), maxsplit=1)[0]


def describe(modules: dict, name: str):
    """Print the modules of a folder, or one module."""
    for stem, module in modules.items():
        if name in (stem, module.folder, module.folder.split("/")[0]):
            users = sorted(other for other, m in modules.items() if stem in m.uses)
            print(f"{module.folder}/{module.path.name}: {purpose(module)}")
            print(f"    uses    {', '.join(sorted(module.uses)) or '-'}")
            print(f"    used by {', '.join(users) or '-'}")


def main():
    """Print or write the graph."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("name", nargs="?", help="a folder or a module")
    parser.add_argument("--write", action="store_true", help=f"into {PAGE.name}")
    options = parser.parse_args()
    modules = read_all()
    if options.name:
        describe(modules, options.name)
    elif options.write:
        PAGE.write_text(redrawn(PAGE.read_text(encoding="utf-8"), modules), encoding="utf-8")
    else:
        print(drawing(modules))


if __name__ == "__main__":
    main()
