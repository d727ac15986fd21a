"""Decks of decks/handbook: asked for 1 %, some of the quick ones give it; all of them read."""
import csv
import importlib
import re
import subprocess
import sys
from pathlib import Path

import pytest

from lopin.accuracy import reach
from lopin.deck import Deck

ROOT = Path(__file__).resolve().parents[2]
DECKS = sorted((ROOT/"decks"/"handbook").glob("*.inp"), key=lambda p: p.stem)
#: Decks that take less than a second, one of each kind of problem and of element.
QUICK = ("wavy", "roller", "press_fit_mortar", "bolt", "leaves", "guide", "thermostat", "wedge",
         "autofrettage", "shell", "necking", "channel_die", "creep_tube")


def exact(deck):
    """The closed form at the head of a deck."""
    return float(re.search(r"^\*\* exact: (\S+)$", deck.read_text(encoding="utf-8"), re.M)[1])


@pytest.mark.parametrize("name", QUICK)
def test_the_answer_is_as_good_as_was_asked(name):
    """The deck asks for 1 %."""
    deck = ROOT/"decks"/"handbook"/f"{name}.inp"
    found = reach(deck)
    assert found.met and found.target == 0.01
    assert abs(found.value/exact(deck) - 1.0) <= 0.01
    work = [run.equations for run in found.levels]
    assert sum(work) < 3.0*work[-1]


@pytest.mark.parametrize("deck", DECKS, ids=lambda p: p.stem)
def test_a_deck_reads_and_says_what_it_is(deck, executable):
    text = deck.read_text(encoding="utf-8")
    assert re.search(r"^\*\* source: \S", text, re.M) and exact(deck) != 0.0
    assert "TARGET ERROR=0.01" in text and text.startswith("** ")
    done = subprocess.run([str(executable), "check", str(deck)], capture_output=True, text=True,
                          check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_decks_are_as_the_script_writes_them(monkeypatch):
    """But for those whose mesh is Gmsh's or whose closed form needs scipy: versions differ."""
    monkeypatch.setattr(sys, "path", [str(ROOT/"decks"/"make"), *sys.path])
    handbook = importlib.import_module("handbook")
    assert set(handbook.PROBLEMS) == {p.stem for p in DECKS}
    for deck in DECKS:
        if deck.stem in ("roller", "shell", "barrel", "brake_shoe"):
            continue
        written, now = deck.read_text(encoding="utf-8"), handbook.deck(deck.stem)
        assert same(written, now), deck.name


def same(one, other):
    """Equal texts, numbers to nine digits."""
    words = re.compile(r"[\s,]+")
    pairs = zip(words.split(one), words.split(other), strict=True)
    return all(a == b or float(a) == pytest.approx(float(b), rel=1e-9, abs=1e-12)
               for a, b in pairs)


def test_the_page_holds_the_table(monkeypatch):
    """Figures of docs/handbook.md are those of docs/charts/handbook.csv."""
    monkeypatch.setattr(sys, "path", [str(ROOT/"tests"/"benchmarks"), *sys.path])
    spec = importlib.util.spec_from_file_location("handbook_bench",
                                                  ROOT/"tests"/"benchmarks"/"handbook.py")
    bench = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(bench)
    page = (ROOT/"docs"/"handbook.md").read_text(encoding="utf-8")
    assert "\n".join(bench.lines_of_page()) in page
    with bench.TABLE.open(newline="", encoding="utf-8") as file:
        assert {row["deck"] for row in csv.DictReader(file)} == {p.stem for p in DECKS}


def test_decks_have_a_source_that_is_read():
    """`Deck.read` and its question."""
    from lopin.accuracy import Quantity
    for deck in DECKS:
        quantity, target = Quantity.of(Deck.read(deck))
        assert target == 0.01 and quantity.kind in deck.read_text(encoding="utf-8")
