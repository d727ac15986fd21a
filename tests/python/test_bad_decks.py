"""Every deck in decks/bad says what is wrong with it, where, and ends with the exit code of its
class.

The first line of such a deck is `** expect: CODE | text that must appear | line:column`; the place
may be left out. Where the second line is `** run`, reading finds nothing wrong: the mistake shows
when the deck is run.
"""

import json
import os
import pathlib
import re
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDER = ROOT / "decks" / "bad"
EXECUTABLE = os.environ["LOPIN_EXECUTABLE"]


def check(deck):
    return subprocess.run([EXECUTABLE, "check", str(deck)], capture_output=True, text=True,
                          timeout=20, cwd=FOLDER)


def is_run(deck):
    """The mistake shows only when the deck is run."""
    return deck.read_text(encoding="utf-8").splitlines()[1].strip() == "** run"


DECKS = sorted(FOLDER.glob("*.inp"))


@pytest.mark.parametrize("deck", [deck for deck in DECKS if is_run(deck)],
                         ids=lambda path: path.stem)
def test_a_deck_that_cannot_be_run_ends_with_its_reason(deck, tmp_path):
    lines = deck.read_text(encoding="utf-8").splitlines()
    code, text = [part.strip() for part in lines[0].removeprefix("** expect: ").split("|")][:2]
    early = check(deck.name)
    # The first search of `lopin check` makes elements only where meshes do not match.
    assert early.returncode == 0 or f"error[{code}]: " in early.stderr, early.stderr
    run = subprocess.run([EXECUTABLE, "run", str(deck), "-o", str(tmp_path/"out")],
                         capture_output=True, text=True, timeout=20)
    # Singular: 4, not converged: 3, a deck whose mistake the geometry shows: 1.
    expected = 4 if code == "E0310" else 3 if code.startswith("E05") else 1
    assert run.returncode == expected, run.stderr
    assert f"error[{code}]: " in run.stderr and text in run.stderr, run.stderr
    assert expected != 1 or "--> " in run.stderr, run.stderr
    job = json.loads((tmp_path/"out"/f"{deck.stem}.json").read_text(encoding="utf-8"))
    assert job["exit_code"] == expected and job["status"] in ("failed", "not converged")


@pytest.mark.parametrize("deck", [deck for deck in DECKS if not is_run(deck)],
                         ids=lambda path: path.stem)
def test_a_bad_deck_is_refused_with_its_reason_and_place(deck):
    first = deck.read_text(encoding="utf-8").splitlines()[0]
    assert first.startswith("** expect: "), "the first line says what is expected"
    code, text, *place = [part.strip() for part in first.removeprefix("** expect: ").split("|")]
    run = check(deck.name)
    assert run.returncode == 1, run.stderr
    kind = {"E": "error", "W": "warning", "N": "note"}[code[0]]
    assert f"{kind}[{code}]: " in run.stderr, run.stderr
    assert text in run.stderr, run.stderr
    arrows = re.findall(r"^ *--> \S+?:(\d+:\d+)$", run.stderr, flags=re.MULTILINE)
    assert arrows, run.stderr
    assert not place or place[0] in arrows, run.stderr
    assert not run.stdout


def test_there_are_enough_of_them():
    assert len(list(FOLDER.glob("*.inp"))) >= 12


def test_several_errors_are_shown_in_one_run(tmp_path):
    deck = tmp_path / "two.inp"
    deck.write_text("*NODA\n*STEP, NLGOEM\n*END STEP\n")
    run = check(deck)
    assert run.returncode == 1
    assert "error[E0101]" in run.stderr and "error[E0102]" in run.stderr
    assert run.stderr.rstrip().endswith("2 errors")
