"""`lopin chart` of one number of a deck: rows, front, other programs, what cannot be charted."""
import csv
import shutil

import numpy as np
import pytest
from crown import crown

from lopin.__main__ import main
from lopin.charts.cases import Case, front, read_cases

ASKED = ["--quantity", "FORCE", "--set", "FLOOR_REF", "--component", "2"]


@pytest.fixture(name="crown")
def deck(tmp_path):
    return crown(tmp_path)


def rows_of(folder):
    with (folder/"crown.csv").open(encoding="utf-8") as file:
        return list(csv.DictReader(file))


def reference_of(deck):
    """The set of the tool's reference node, as the model names it."""
    with open(deck, encoding="utf-8") as file:
        names = [line for line in file if line.upper().startswith("*NODE, NSET=")]
    return names[-1].partition("NSET=")[2].strip()


def test_methods_elements_and_meshes(crown, tmp_path, capsys):
    pytest.importorskip("matplotlib")
    asked = ["--quantity", "FORCE", "--set", reference_of(crown), "--component", "2"]
    words = ["--methods", "lagrange,penalty", "--elements", "CPE4,CPE8", "--meshes", "0,1"]
    assert main(["chart", crown, *asked, *words, "-o", str(tmp_path)]) == 0
    said = capsys.readouterr().out
    assert "8 runs, 0 without an answer, 0 silent" in said
    rows = rows_of(tmp_path)
    exact = {(r["element"], int(r["mesh"])): float(r["error"]) for r in rows
             if r["method"] == "lagrange"}
    assert exact["CPE4", 1] < 0.5*exact["CPE4", 0]
    assert exact["CPE8", 0] < exact["CPE4", 0]
    assert all(float(r["seconds"]) > 0.0 and int(r["repetitions"]) >= 3 for r in rows)
    assert len({float(r["right"]) for r in rows}) == 1
    # Drawn again from its table, another program's rows beside it.
    other = tmp_path/"other.csv"
    other.write_text(f"program,seconds,value\nother,2.,{1.1*float(rows[0]['right'])!r}\n",
                     encoding="utf-8")
    (tmp_path/"crown.png").unlink()
    again = ["chart", str(tmp_path/"crown.csv"), "--beside", str(other), "-o", str(tmp_path)]
    assert main(again) == 0
    assert (tmp_path/"crown.png").stat().st_size > 10000
    assert np.isclose(float(rows_of(tmp_path)[-1]["error"]), 0.1)


def test_a_deck_that_asks_is_charted_without_options(crown, tmp_path, capsys):
    pytest.importorskip("matplotlib")
    with open(crown, encoding="utf-8") as file:
        text = file.read()
    asks = tmp_path/"crown.inp"
    asks.write_text(text.replace("*STEP", "*LOPIN, QUANTITY=PRESSURE, TARGET ERROR=.02\n*STEP", 1),
                    encoding="utf-8")
    assert main(["chart", str(asks), "-o", str(tmp_path)]) == 0
    assert "2 runs, 0 without an answer" in capsys.readouterr().out


def test_the_front_holds_what_nothing_beats():
    rows = [Case("a", seconds=s, error=e, value=1.0) for s, e in
            ((1.0, 0.1), (2.0, 0.2), (3.0, 0.05), (3.0, 0.04), (4.0, 0.04))]
    assert [(r.seconds, r.error) for r in front(rows)] == [(1.0, 0.1), (3.0, 0.04)]
    assert not front([Case("a", failure="E0510")])


@pytest.mark.parametrize("words, says", [
    (["--meshes", "0"], "of which number"), ([*ASKED, "--methods", "magic"], "magic"),
    ([*ASKED, "--meshes", "0,x"], "--meshes 0,x"), ([*ASKED, "--meshes", "0", "--elements", "C3D8"],
                                                   "C3D8"),
    ([*ASKED, "--increments", "0"], "--increments 0"),
    ([*ASKED, "--increments", "nan"], "--increments nan"), ([*ASKED, "--exact", "nan"], "--exact")])
def test_what_cannot_be_charted(crown, tmp_path, capsys, words, says):
    assert main(["chart", crown, *words, "-o", str(tmp_path)]) in (1, 2) \
        or says in rows_of(tmp_path)[0]["failure"]
    err = capsys.readouterr().err
    assert says in err or says in rows_of(tmp_path)[0]["failure"]


def test_a_table_of_another_program_needs_times_and_values(tmp_path):
    table = tmp_path/"t.csv"
    table.write_text("program,seconds\nother,3.\n", encoding="utf-8")
    with pytest.raises(Exception, match="t.csv:2: a row needs seconds, and value or error"):
        read_cases(table)
    table.write_text("program,seconds,value\nother,fast,1.\n", encoding="utf-8")
    with pytest.raises(Exception, match="t.csv:2"):
        read_cases(table)


def test_tables_are_read_before_the_first_run(crown, tmp_path, capsys):
    words = ["chart", crown, *ASKED, "--beside", str(tmp_path/"none.csv"), "-o", str(tmp_path)]
    assert main(words) != 0
    assert capsys.readouterr().err.count("\n") == 1 and not (tmp_path/"crown.csv").exists()


def test_tables_that_are_none(tmp_path, capsys):
    """Empty, of another program alone, and one that begins with a mark of its encoding."""
    table = tmp_path/"t.csv"
    table.write_text("")
    with pytest.raises(Exception, match="t.csv has no rows"):
        read_cases(table)
    table.write_text("\ufeffprogram,seconds,value\nother,3.,1.\n", encoding="utf-8")
    assert read_cases(table)[0].program == "other"
    assert main(["chart", str(table), "-o", str(tmp_path)]) == 2
    assert "--beside" in capsys.readouterr().err


@pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX is not here")
def test_calculix_on_the_same_meshes(crown, tmp_path):
    """Its force on the tool is that of Lopin, within its own stiffness of contact."""
    pytest.importorskip("matplotlib")
    asked = ["--quantity", "FORCE", "--set", reference_of(crown), "--component", "2"]
    assert main(["chart", crown, *asked, "--meshes", "0", "--ccx", "-o", str(tmp_path)]) == 0
    mine, other = rows_of(tmp_path)
    assert other["program"] == "ccx" and not other["failure"]
    assert abs(float(other["value"])/float(mine["value"]) - 1.0) < 0.05
