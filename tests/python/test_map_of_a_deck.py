"""`lopin atlas DECK`: a deck over two of its numbers, resumed, and what cannot be mapped."""
import csv
import re

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


@pytest.mark.parametrize("change, says", [
    (["--quantity", "PEAK FORCE"], "its --quantity is force"), (["--halved"], "its --halved is no"),
    (["--x", "ELASTIC:2=0.1,0.2"], "its --x is .FRICTION"), (None, "its deck is another")])
def test_a_map_does_not_take_the_cells_of_another(billet, tmp_path, capsys, change, says):
    """Deck, places, quantity and halved are kept beside the table."""
    words = ["atlas", billet, "--x", "FRICTION:1=0,0.1", "--quantity", "FORCE", "--no-picture",
             "--batch", "0", "-o", str(tmp_path/"maps")]
    assert main(words) == 0 and main([*words, "--resume"]) == 0
    if change is None:
        deck = Deck.read(billet)
        deck["ELASTIC"].data[0][0] *= 2.0
        deck.write(billet)
    assert main([*words, "--resume", *(change or [])]) == 2
    assert re.search(says, capsys.readouterr().err)
    (tmp_path/"maps/upset.map.json").unlink()
    assert main([*words, "--resume"]) == 2


def test_a_deck_that_asks_for_an_accuracy_is_mapped_without_the_question(billet, tmp_path):
    """Its runs would all be warned of (W0344), so that none is certified and none silent."""
    deck = Deck.read(billet)
    deck.blocks.insert(0, Deck.parse("*LOPIN, QUANTITY=FORCE, TARGET ERROR=0.1").blocks[0])
    chart = DeckMap(deck, Axis.of("LOPIN:TARGET ERROR=0.1"))
    cells = chart.measure(tmp_path/"t.csv", None, lambda line: None)
    assert "W0344" not in cells[0].said and "LOPIN" in chart.deck


@pytest.mark.parametrize("words, says", [
    (["--batch", "-1"], "--batch -1"), (["--map", "1"], "not beside a deck"),
    (["--x", "FRICTION:1=nan"], "no values"), (["--x", "FRICTION:1=0..inf/3"], "no values"),
    (["--x", "FRICTION:9=1"], "fields count from 1")])
def test_what_cannot_be_mapped(billet, tmp_path, capsys, words, says):
    assert main(["atlas", billet, "--x", "FRICTION:1=0.1", *words, "-o", str(tmp_path/"a")]) == 2
    assert says in capsys.readouterr().err and not list(tmp_path.glob("a/*.csv"))


@pytest.mark.parametrize("words, says", [
    ("FRICTION", "no place with values"), ("FRICTION:0=1,2", "count from 1"),
    ("FRICTION:1=a,b", "no values"), ("FRICTION:1=1..2/1", "no values")])
def test_axes_that_say_nothing(words, says):
    with pytest.raises(UsageError, match=says):
        Axis.of(words)


def test_a_place_that_the_deck_does_not_have(billet):
    with pytest.raises(UsageError, match="no place in the deck"):
        DeckMap(Deck.read(billet), Axis.of("HYPERELASTIC:1=1,2"))


def test_one_place_on_both_axes_is_refused(billet):
    for other in ("FRICTION:1=0.1,0.2", "friction:1=0.1"):
        with pytest.raises(UsageError, match="same place"):
            DeckMap(Deck.read(billet), Axis.of("FRICTION:1=0.05,0.3"), Axis.of(other))


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
