"""Which module of the package imports which, drawn from the sources: there is no way round."""
import ast
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[2]/"pydriver"/"lopin"


def modules():
    """Dotted names below the package, to their files."""
    found = {}
    for path in PACKAGE.rglob("*.py"):
        parts = path.relative_to(PACKAGE).with_suffix("").parts
        found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return found


def only_for_types(tree):
    """Imports below `if TYPE_CHECKING`."""
    return {inner for node in ast.walk(tree) if isinstance(node, ast.If)
            and isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING"
            for inner in ast.walk(node)}


def imported(name, path, known):
    """Modules of the package that a module imports, wherever in it."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    here = name.split(".") if path.name == "__init__.py" else name.split(".")[:-1]
    here = [part for part in here if part]
    for node in set(ast.walk(tree)) - only_for_types(tree):
        if isinstance(node, ast.ImportFrom) and node.level:
            base = here[:len(here) - node.level + 1] + (node.module or "").split(".")
            base = [part for part in base if part]
            for alias in node.names:
                full = ".".join([*base, alias.name])
                yield full if full in known else ".".join(base)
        elif isinstance(node, ast.ImportFrom) and (node.module or "").startswith("lopin"):
            yield node.module.removeprefix("lopin").removeprefix(".")


def graph():
    """Each module and those that it imports."""
    known = modules()
    return {name: {other for other in imported(name, path, known)
                   if other in known and other != name} for name, path in known.items()}


def test_the_import_graph_has_no_cycle():
    try:
        order = list(TopologicalSorter(graph()).static_order())
    except CycleError as problem:
        raise AssertionError("imports go in a circle: " + " <- ".join(problem.args[1])) from None
    assert order.index("errors") < order.index("deck") < order.index("model") < order.index("")


def test_the_graph_sees_imports():
    drawn = graph()
    assert {"deck", "mesh.mesh", "step"} <= drawn["model"] and "model" in drawn[""]
