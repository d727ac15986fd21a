"""Where the executable's deck is written when Python has changed it: over no file of the user."""
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from shutil import copy

import lopin

DECKS = Path(__file__).resolve().parents[2]/"decks"


def changed(folder: Path) -> lopin.Deck:
    """A deck with its mesh beside it, changed by one number."""
    for name in ("flat_punch.inp", "flat_punch.mesh"):
        copy(DECKS/name, folder)
    deck = lopin.Deck.read(folder/"flat_punch.inp")
    deck["STEP"].parameters["INC"] = 77
    return deck


def test_runs_of_one_deck_at_once_do_not_meet(tmp_path, executable):
    """Each has its own copy, and leaves nothing in the folder of the deck."""
    deck = changed(tmp_path)
    before = sorted(p.name for p in tmp_path.iterdir())
    with ThreadPoolExecutor() as pool:
        done = list(pool.map(lambda _: lopin.run(deck, executable=True).verdict, range(3)))
    assert done == ["PASS"]*3
    assert sorted(p.name for p in tmp_path.iterdir()) == before


def test_a_changed_deck_is_not_written_over_its_file(tmp_path, executable):
    """Also where the results are to lie beside it."""
    deck = changed(tmp_path)
    text = (tmp_path/"flat_punch.inp").read_text()
    assert lopin.run(deck, tmp_path, executable=True).verdict == "PASS"
    assert (tmp_path/"flat_punch.inp").read_text() == text
