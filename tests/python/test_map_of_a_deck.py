"""`lopin atlas DECK`: a deck over two of its numbers, resumed, and what cannot be mapped."""
import csv

import numpy as np
import pytest

from lopin.__main__ import main
from lopin.atlas.deck_map import Axis, DeckMap, draw, read_cells, write_cells
from lopin.accuracy import Quantity
from lopin.deck import Deck
from lopin.errors import UsageError


@pytest.fixture
def billet(tmp_path):
    """A billet that is upset with friction."""
    from upset_billet import billet as make

    return str(make(1, mu=0.1, share=0.2, cells=(2, 3), direct=False).to_deck().write(
        tmp_path/"upset.inp"))


def rows_of(folder):
    with (folder/"upset.csv").open(encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_a_billet_over_friction_and_increments(billet, tmp_path, capsys):
    words = ["atlas", billet, "--x", "FRICTION:1=0,0.1,0.2", "--y", "STATIC:1=0.1,0.3",
             "--quantity", "force", "--halved", "-o", str(tmp_path)]
    pytest.importorskip("matplotlib")
    assert main(words) == 0
    assert "6 runs: " in capsys.readouterr().out
    rows = rows_of(tmp_path)
    force = {(float(r["x"]), float(r["y"])): float(r["value"]) for r in rows}
    assert force[0.2, 0.1] > force[0.1, 0.1] > force[0.0, 0.1]
    assert np.isclose(force[0.1, 0.1], force[0.1, 0.3], rtol=0.05)
    assert all(float(r["change"]) < 0.05 for r in rows)
    assert (tmp_path/"upset.png").stat().st_size > 5000


def test_a_map_is_resumed(billet, tmp_path, capsys):
    words = ["atlas", billet, "--x", "FRICTION:1=0,0.1", "--no-picture", "-o", str(tmp_path)]
    assert main([*words, "--batch", "1"]) == 0
    assert [r["row"] for r in rows_of(tmp_path)] == ["0"]
    first = rows_of(tmp_path)[0]
    assert main([*words, "--resume"]) == 0
    assert len(rows_of(tmp_path)) == 2 and rows_of(tmp_path)[0] == first
    assert capsys.readouterr().err.count("FRICTION:1=0:") == 1
    # The deck of a cell runs on its own.
    assert main([*words, "--cell", "1"]) == 0
    cell = Deck.read(tmp_path/"upset_1.inp")
    assert cell["FRICTION"].data[0][0] == 0.1


def test_what_stops_is_a_cell_of_its_own(tmp_path, billet):
    text = Deck.read(billet)
    chart = DeckMap(text, Axis.of("STEP:INC=1,1000"))
    cells = chart.measure(tmp_path/"t.csv", None, lambda line: None)
    assert [c.kind for c in cells][0] == "no answer" and cells[0].said.startswith("E05")
    assert cells[1].kind in ("certified", "warned")


@pytest.mark.parametrize("words, says", [
    ("FRICTION", "no place with values"), ("FRICTION:0=1,2", "count from 1"),
    ("FRICTION:1=a,b", "no values"), ("FRICTION:1=1..2/1", "no values")])
def test_axes_that_say_nothing(words, says):
    with pytest.raises(UsageError, match=says):
        Axis.of(words)


def test_a_place_that_the_deck_does_not_have(billet):
    with pytest.raises(UsageError, match="no place in the deck"):
        DeckMap(Deck.read(billet), Axis.of("HYPERELASTIC:1=1,2"))


def test_ranges():
    assert Axis.of("A:1=0..1/3").values == (0.0, 0.5, 1.0)
    assert np.allclose(Axis.of("A B#2:3=1e-3..1/4").values, [1e-3, 1e-2, 0.1, 1.0])
    assert Axis.of("*A B#2:3=1").place == "*A B#2:0:2"


def test_a_change_without_a_warning_is_silent(tmp_path, monkeypatch, billet):
    """What half the increments change by 5 % is marked, and drawn red."""
    pytest.importorskip("matplotlib")
    chart = DeckMap(Deck.read(billet), Axis.of("FRICTION:1=0.05"), None, Quantity("FORCE"), True)
    monkeypatch.setattr(Quantity, "difference", lambda *_: 1e9)
    cells = chart.measure(tmp_path/"t.csv", None, lambda line: None)
    assert cells[0].kind in ("silent", "warned")
    cells[0].kind = "silent"
    write_cells(cells, tmp_path/"t.csv")
    assert read_cells(tmp_path/"t.csv")[0].kind == "silent"
    draw(chart, cells, tmp_path/"map")
    assert "#ff0000" in (tmp_path/"map.svg").read_text()
