"""Every deck of the collection runs and gives what its comments expect (`** expect: ...`)."""
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT/"decks"/"make"))
from expectations import expectations, measured, run  # noqa: E402

DECKS = sorted((ROOT/"decks").glob("*.inp"), key=lambda p: p.stem)


@pytest.mark.parametrize("deck", DECKS, ids=lambda p: p.stem)
def test_runs_and_gives_what_it_says(deck, executable, tmp_path):
    if "*REMESH" in deck.read_text():
        pytest.importorskip("gmsh")
    lines = expectations(deck)
    done = run(deck, executable, tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    wrong = [f"{line.text}: measured {found}" for line in lines
             if not line.holds(found := measured(tmp_path/deck.stem, deck.stem, line))]
    assert not wrong, "\n".join(wrong)


@pytest.mark.parametrize("deck", DECKS, ids=lambda p: p.stem)
def test_says_what_to_expect(deck):
    paths = {line.path for line in expectations(deck)}
    assert "certificate.verdict" in paths and len(paths) > 1


@pytest.mark.parametrize("deck", DECKS, ids=lambda p: p.stem)
def test_is_in_the_catalogue(deck):
    catalogue = (ROOT/"decks"/"README.md").read_text(encoding="utf-8")
    assert f"## {deck.stem}\n" in catalogue
    assert f"docs/pictures/{deck.stem}.png" in catalogue
