"""How the command reads what a deck asks of an accuracy: as the reader of decks does."""
import pytest

from lopin.accuracy import Quantity, reach
from lopin.accuracy.command import asks, options
from lopin.accuracy.reach import Level, Reached, _Search
from lopin.command_deck import VALUES, deck_of, first_found, given_by
from lopin.deck import Deck
from lopin.errors import LopinError
from lopin.model import Model
from lopin.model_read_mesh import expanded
from lopin.remesh.command import asks as asks_to_remesh

BLOCK = """*NODE
1, 0., 0.
2, 1., 0.
3, 1., 1.
4, 0., 1.
*ELEMENT, TYPE=CPE4, ELSET=B
1, 1, 2, 3, 4
*NSET, NSET=FOOT
1, 2
*NSET, NSET=HEAD
3, 4
*MATERIAL, NAME=M
*ELASTIC
1000., 0.3
*SOLID SECTION, ELSET=B, MATERIAL=M
{more}*BOUNDARY
FOOT, 1, 2
*STEP
*STATIC
1., 1.
*CLOAD
3, 2, -1.
*END STEP
"""
ASKED = "*LOPIN, QUANTITY=DISPLACEMENT, SET=HEAD, TARGET ERROR=0.5\n"


def written(folder, card=ASKED, more="", name="a.inp"):
    path = folder/name
    path.write_text(card + BLOCK.format(more=more), encoding="utf-8")
    return path


@pytest.mark.parametrize("card", [
    ASKED, "*LOPIN,\n** of contact\nQUANTITY=FORCE\n",
    "* lopin , target error=.1, quantity = Force\n",
    "\ufeff*LOPIN, QUANTITY=FORCE\n", "*INCLUDE, INPUT=sub/one.inc\n",
    "*INCLUDE,\nINPUT=sub/one.inc\n"])
def test_a_deck_that_asks_is_found(tmp_path, card):
    """Continued lines, and includes beside their own file or beside the deck."""
    (tmp_path/"sub").mkdir()
    (tmp_path/"sub/one.inc").write_text("*INCLUDE, INPUT=sub/two.inc\n*INCLUDE, INPUT=three.inc\n")
    (tmp_path/"sub/two.inc").write_text("*LOPIN, QUANTITY=FORCE\n")
    (tmp_path/"sub/three.inc").write_text("*PHYSICAL CONSTANTS, ABSOLUTE ZERO=0.\n")
    path = written(tmp_path, card)
    assert first_found(path, [asks, asks_to_remesh]) == 0
    assert Quantity.of(Deck.read(path))[0].kind in ("FORCE", "DISPLACEMENT")
    assert all(block.keyword != "INCLUDE" for block in expanded(Deck.read(path)))


def test_a_deck_that_does_not_ask(tmp_path):
    path = written(tmp_path, "*LOPIN, TARGET ERROR=0.1\n** *LOPIN, QUANTITY=FORCE\n")
    assert first_found(path, [asks, asks_to_remesh]) is None
    path.write_text("*INCLUDE, INPUT=a.inp\n")   # of itself
    assert first_found(path, [asks, asks_to_remesh]) is None
    with pytest.raises(LopinError, match="E0105.*a.inp:1:1"):
        expanded(Deck.read(path))


def test_every_option_with_a_value_is_known_before_the_deck(tmp_path):
    path = str(written(tmp_path))
    for action in options()._actions:
        if action.option_strings and action.nargs is None:
            word = action.option_strings[0]
            assert word in VALUES and str(deck_of(["run", word, "20", path])) == path
            given, _, _ = given_by(options(), ["run", word, "20", path])
            assert given.words == ["run", path]


@pytest.mark.parametrize("words, more, says", [
    ("FORCE, COMPONENT=-1", "", "COMPONENT=-1 is no direction"),
    ("DISPLACEMENT, SET=99", "", "there is no such node"),
    ("DISPLACEMENT, SET=NOPE", "", "there is no such node set"),
    ("FORCE, SET=HEAD", "", "there is no force on it"),
    ("DISPLACEMENT, SET=HEAD", "*ELEMENT, TYPE=SPRING1, ELSET=S\n9, 3\n*SPRING, ELSET=S\n1\n5.\n",
     "SPRING: springs hold single nodes")])
def test_what_no_run_can_answer_is_refused_before_the_first(tmp_path, words, more, says):
    lines = []
    with pytest.raises(LopinError, match=says) as problem:
        reach(written(tmp_path, f"*LOPIN, QUANTITY={words}\n", more), say=lines.append)
    assert not lines and (more or "a.inp:1:1" in str(problem.value))


def test_an_exponent_of_fortran(tmp_path):
    path = written(tmp_path, "*LOPIN, QUANTITY=FORCE, TARGET ERROR=5D-2\n")
    assert Quantity.of(Deck.read(path)) == (Quantity("FORCE"), 0.05)


def test_a_number_that_falls_to_nothing():
    """The share that one node of a support has halves with every mesh; it was refined on."""
    search = _Search(Deck([]), Quantity("FORCE", "B.TOP"), 0.05, None, None)
    found, values = search.found, [2.65002, 1.34373, 0.675927]
    for mesh, value in enumerate(values):
        change = value - values[mesh - 1] if mesh else float("nan")
        found.levels.append(Level(mesh, 1.0, 4**mesh, 0, value, abs(change), change, 0.0, "PASS"))
        found.value = value
        search._estimate(False)
    assert isinstance(found, Reached) and "has no limit but 0" in found.reason


def test_a_model_keeps_what_its_deck_asks(tmp_path):
    model = Model.read(written(tmp_path))
    deck = model.to_deck()
    assert Quantity.of(deck) == (Quantity("DISPLACEMENT", "HEAD"), 0.5)
