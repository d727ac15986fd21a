"""Every deck in decks/bad says what is wrong with it, where, and ends with exit code 1.

The first line of such a deck is `** expect: CODE | text that must appear | line:column`; the place may be left out.
"""

import os
import pathlib
import re
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDER = ROOT / "decks" / "bad"
EXECUTABLE = os.environ.get("LOPIN_EXECUTABLE", "")

pytestmark = pytest.mark.skipif(not EXECUTABLE, reason="LOPIN_EXECUTABLE names no executable")


def check(deck):
    return subprocess.run([EXECUTABLE, "check", str(deck)], capture_output=True, text=True, timeout=20, cwd=FOLDER)


@pytest.mark.parametrize("deck", sorted(FOLDER.glob("*.inp")), ids=lambda path: path.stem)
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
