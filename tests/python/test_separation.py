"""Metal that separates (*DAMAGE, CRITICAL): elements taken out, nodes split, scrap, resume."""
import json
from pathlib import Path

import numpy as np
import pytest
from test_remeshing import history, run

import lopin
from lopin.remesh.driver import Runner
from lopin.remesh.scrap import bodies, joined, split

DECKS = Path(__file__).resolve().parents[2]/"decks"


def blanking(critical="0.04", travel=0.07):
    """The disc of decks/blanking.inp, cut by a low critical value."""
    text = (DECKS/"blanking.inp").read_text()
    text = text.replace("CRITERION=OYANE, WIDTH=0.05",
                        f"CRITERION=OYANE, WIDTH=0.05, CRITICAL={critical}")
    text = text.replace("*STEP, NAME=CUT", "*REMESH, ELSET=SHEET, SIZE=0.5, SMALLEST=0.05, "
                        "STRAIN=9., PENETRATION=0.5\n*STEP, NAME=CUT")
    text = text.replace("PUNCH_REF, 2, 2, -0.2", f"PUNCH_REF, 2, 2, -{travel!r}")
    return lopin.Deck.parse(text, name="disc")


def test_elements_separate_and_a_killed_run_goes_on_to_the_same_bits(core, tmp_path):
    report = run(blanking(), tmp_path)
    cuts = [r for r in report.remeshes if r.separated > 0.0]
    assert len(cuts) >= 3
    elements = [r.elements for r in cuts]
    assert elements == sorted(elements, reverse=True)
    for r in cuts:
        assert "OYANE" in r.reason and r.plastic_change == 0.0 and r.pieces == 1
        assert 0.0 < r.separated < 0.01
    assert "separations of" in report.text()
    told = json.loads(report.json())["remeshes"]
    assert [r["separated"] for r in told] == [r.separated for r in report.remeshes]
    force = history(tmp_path, "disc")["PUNCH.rf2"]
    whole = np.abs(force).max()
    assert np.abs(np.diff(force)).max() < 0.2*whole and whole > 5e3
    last = tmp_path/f"{report.parts[-1]}.inp"
    before = last.read_bytes()
    last.unlink()
    again = run(blanking(), tmp_path, resume=True)
    assert again.parts == report.parts and last.read_bytes() == before


def test_nothing_separates_below_the_critical_value(core, tmp_path):
    assert not run(blanking("9.", 0.01), tmp_path).remeshes


def test_the_executable_says_what_it_needs(core, tmp_path):
    text = blanking().text()
    path = tmp_path/"disc.inp"
    path.write_text("\n".join(line for line in text.splitlines() if "REMESH" not in line) + "\n")
    with pytest.raises(lopin.LopinError) as caught:
        lopin.run(lopin.Deck.read(path), executable=True)
    assert caught.value.id == "E0620"


def test_a_value_that_is_not_positive_is_refused(core, tmp_path):
    with pytest.raises(lopin.LopinError, match="CRITICAL=0"):
        Runner(blanking("0."), tmp_path, say=lambda line: None)


def test_nodes_at_which_parts_only_touch_are_split():
    quads = np.array([[0, 1, 4, 3], [4, 5, 8, 7]])          # two quads corner to corner
    cells, old = split([quads], 2)
    assert len(old) == 8 and sorted(old.tolist()) == sorted([0, 1, 4, 3, 4, 5, 8, 7])
    assert (old[cells[0]] == quads).all()
    assert len(np.unique(bodies(cells, len(old)))) == 2
    cells, old = split([np.array([[0, 1, 4, 3], [1, 2, 5, 4]])], 2)
    assert old.tolist() == [0, 1, 2, 3, 4, 5]
    tetra = np.array([[0, 1, 2, 3], [0, 1, 4, 5]])           # an edge in common, no face
    assert len(split([tetra], 3)[1]) == 8
    assert joined(3, np.zeros((0, 2), int)).tolist() == [0, 1, 2]
