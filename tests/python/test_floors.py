"""The dependency rule: a module uses only lower floors, or its own folder without cycles."""
import re
import sys

import pytest

from conftest import ROOT

sys.path.insert(0, str(ROOT/"tests"))
import measure_sources  # noqa: E402

FLOORS = {folder: level for level, floor in enumerate(measure_sources.FLOORS) for folder in floor}
USE = re.compile(r"^\s*use\s*(?:,\s*\w+\s*)?(?:::)?\s*lopin_(\w+)", re.IGNORECASE | re.MULTILINE)
MODULE = re.compile(r"^\s*module\s+(?!procedure\b|subroutine\b|function\b)(\w+)\s*$",
                    re.IGNORECASE | re.MULTILINE)


@pytest.fixture(scope="module")
def sources(root):
    """Fortran files by stem: (folder, text)."""
    files = sorted((root / "fortran").rglob("*.f90"))
    assert files
    stems = [f.stem for f in files]
    assert len(stems) == len(set(stems)), "two files have the same stem"
    return {f.stem: (measure_sources.folder_of(f), f.read_text()) for f in files}


def test_every_folder_is_a_floor(sources):
    assert {folder for folder, _ in sources.values()} == set(FLOORS)


def test_every_area_is_compiled(root):
    text = (root/"fortran"/"CMakeLists.txt").read_text()
    listed = re.search(r"foreach\(area ([^)]*)\)", text)[1].split()
    assert set(listed) == {folder.split("/")[0] for folder in FLOORS} - {"app"}


def test_a_module_is_named_after_its_file(sources):
    for stem, (folder, text) in sources.items():
        modules = MODULE.findall(text)
        assert modules in ([f"lopin_{stem}"], []) or folder == "app", (stem, modules)


def test_modules_use_lower_floors_only(sources):
    wrong = []
    for stem, (folder, text) in sources.items():
        for used in USE.findall(text):
            assert used.lower() in sources, f"{stem} uses lopin_{used}, which is in no file"
            target = sources[used.lower()][0]
            if target != folder and FLOORS[target] >= FLOORS[folder]:
                wrong.append(f"{folder}/{stem} uses {target}/{used}")
    assert not wrong, "\n".join(wrong)


def test_no_cycles_inside_a_folder(sources):
    uses = {stem: {u.lower() for u in USE.findall(text)} for stem, (_, text) in sources.items()}

    def visit(stem, path):
        assert stem not in path, " -> ".join([*path, stem])
        for used in uses.get(stem, ()):
            if sources.get(used, ("",))[0] == sources[stem][0]:
                visit(used, [*path, stem])

    for stem in uses:
        visit(stem, [])


@pytest.mark.parametrize("pattern, reason", [
    (r"^\s*(?:error\s+)?stop\b", "only app/ stops"),
    (r"^\s*print\b|write\s*\(\s*\*", "only app/ prints"),
    (r"^\s*common\b|^\s*save\b|^\s*go\s*to\b", "no COMMON, SAVE, GOTO"),
])
def test_forbidden_statements(sources, pattern, reason):
    wrong = [stem for stem, (folder, text) in sources.items() if folder != "app"
             and re.search(pattern, text, re.IGNORECASE | re.MULTILINE)]
    assert not wrong, f"{reason}: {wrong}"


def test_every_module_is_private_with_implicit_none(sources):
    for stem, (_, text) in sources.items():
        if MODULE.search(text):
            assert re.search(r"^\s*implicit none", text, re.MULTILINE), stem
            assert re.search(r"^\s*private\s*$", text, re.MULTILINE), stem
