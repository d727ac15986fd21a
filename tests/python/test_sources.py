"""What a reader of the Fortran sources must hold in mind does not grow (tests/measure_sources.py),
their format is the house's (tests/check_format.py), and the graph of the modules is today's
(tests/draw_modules.py)."""
import sys

import pytest

from conftest import ROOT

sys.path.insert(0, str(ROOT/"tests"))
import check_format  # noqa: E402
import draw_modules  # noqa: E402
import measure_sources  # noqa: E402

#: Figures of today; lower them when they have fallen.
LIMITS = {
    "files above 400 lines": 0,
    "lines above 100 columns": 0,
    "procedures above 8 arguments": 0,
    "procedures nested deeper than 4": 0,
    "procedures above 60 lines": 15,
    "types above 20 components": 9,
    "types above 20 components without a reason beside them": 0,
    "modules out of reach": 0,
    "words of a private vocabulary": 0,
    "public procedures without a docstring, %": 8.5,
}


@pytest.fixture(scope="module")
def modules(root):
    found = measure_sources.read_all(root)
    assert len(found) > 300 and sum(len(m.procedures) for m in found.values()) > 2000
    return found


@pytest.fixture(scope="module")
def figures(modules):
    return measure_sources.figures(modules)


@pytest.mark.parametrize("name", LIMITS)
def test_a_figure_does_not_get_worse(figures, name):
    value, places = figures[name]
    assert value <= LIMITS[name], "\n".join(places)


def test_arguments_say_what_they_are(figures):
    assert figures["real arguments of public procedures with a comment, %"][0] >= 76.0


def test_sources_have_the_format_of_the_house(root):
    wrong = [f"{path.relative_to(root)}:{line}: {what}" for path in check_format.files(root)
             for line, what in check_format.faults(path)]
    assert not wrong, "\n".join(wrong) + "\npython3 tests/check_format.py --fix mends blanks"


@pytest.mark.parametrize("line, fault", [
    ("   a = 1", ""),
    ("  a = 1", "indented by 2"),
    ("      a = 1", "indented by 6"),
    ("\ta = 1", "tab"),
    ("   a = 1 ", "blanks"),
    ("   if (a) then", "stay open"),
    ("   if (a) b = 1", ""),
    ("   where (a > b) c = d", ""),
    ("   critical = 1.0", ""),
    ("   select case (a)\n   case (1)\n      b = 2\n   end select", ""),
    ("end subroutine\npure character(len=8) function f()\n   f = ''\nend function\n"
     "subroutine s", "")])
def test_the_check_of_the_format_sees(line, fault, tmp_path):
    path = tmp_path/"probe.f90"
    path.write_text(f"subroutine probe()\n{line}\nend subroutine probe\n")
    found = [what for _, what in check_format.faults(path)]
    assert any(fault in what for what in found) if fault else not found, found


def test_the_graph_of_the_modules_is_today_s(modules):
    page = draw_modules.PAGE.read_text(encoding="utf-8")
    assert draw_modules.redrawn(page, modules) == page, "python3 tests/draw_modules.py --write"
