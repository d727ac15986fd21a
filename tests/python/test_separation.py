"""Metal that separates (*DAMAGE, CRITICAL): elements taken out, nodes split, scrap, resume."""
import json
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from test_remeshing import history, run

import lopin
from lopin.points import Tractions
from lopin.remesh.body import DeckParts, read_body
from lopin.remesh.driver import Runner
from lopin.remesh.report import work_of_tools
from lopin.remesh.scrap import bodies, joined, loose, split
from lopin.remesh.separate import CUT, crushed
from lopin.remesh.state import Snapshot

DECKS = Path(__file__).resolve().parents[2]/"decks"


def blanking(critical="0.04", travel=0.046, most=0.04):
    """The disc of decks/blanking.inp, cut by a low critical value, in increments of `most`."""
    text = (DECKS/"blanking.inp").read_text()
    assert "1.E-7, 0.02" in text
    text = text.replace("1.E-7, 0.02", f"1.E-7, {most!r}")
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
    kept = report.balance()
    assert abs(kept["lost"]) < 2e-3 and kept["scrap"] == 0.0
    assert kept["taken_out"] == pytest.approx(report.taken_out()*kept["volume"], rel=1e-2)
    assert 0.0 < kept["let_go"] < 0.1*kept["work"]
    assert told_balance(report, "volume") and told_balance(report, "work of the tools")
    force = history(tmp_path, "disc")["PUNCH.rf2"]
    whole = np.abs(force).max()
    assert np.abs(np.diff(force)).max() < 0.2*whole and whole > 5e3
    last = tmp_path/f"{report.parts[-1]}.inp"
    before = last.read_bytes()
    last.unlink()
    again = run(blanking(), tmp_path, resume=True)
    assert again.parts == report.parts and last.read_bytes() == before


def told_balance(report, what):
    return any(line.startswith(what) for line in report.text().splitlines())


def strip(height=4, width=4):
    """A body of unit squares in the plane, its bottom held, in a deck and as it stands."""
    nodes = "".join(f"{j*(width + 1) + i + 1}, {float(i)}, {float(j)}\n"
                    for j in range(height + 1) for i in range(width + 1))
    cells = "".join(f"{j*width + i + 1}, " + ", ".join(str(j*(width + 1) + i + 1 + k) for k in (
        0, 1, width + 2, width + 1)) + "\n" for j in range(height) for i in range(width))
    bottom = ", ".join(str(i + 1) for i in range(width + 1))
    top = "".join(f"{(height - 1)*width + i + 1}, S3\n" for i in range(width))
    deck = lopin.Deck.parse(f"""*NODE
{nodes}*ELEMENT, TYPE=CPE4, ELSET=B
{cells}*NSET, NSET=LOW
{bottom}
*SURFACE, NAME=TOP
{top}*SOLID SECTION, ELSET=B, MATERIAL=M
*BOUNDARY
LOW, 1, 2
""", name="strip")
    parts = DeckParts.of(deck)
    return parts, read_body(parts, "B")


def state(body, pressed=()):
    """The strip at rest; `pressed`: node label, traction."""
    tractions = Tractions(np.zeros(len(pressed), int), np.array([p[0] for p in pressed], int),
                          np.array([[*p[1], 0.0] for p in pressed]).reshape(-1, 3),
                          np.zeros((len(pressed), 3)))
    return Snapshot(body.x, None, tractions, SimpleNamespace(step=1), np.zeros((0, 3)), np.zeros((0, 5)))


def test_a_piece_that_nothing_holds_is_scrap():
    parts, body = strip()
    gone = np.zeros(16, bool)
    assert loose(parts, body, state(body), gone) == []          # held below
    gone[8:12] = True                                           # the third row
    upper, = loose(parts, body, state(body), gone)
    assert upper.nonzero()[0].tolist() == [12, 13, 14, 15]
    one_way = [(21 + k, (0.0, -5.0)) for k in range(5)]
    assert len(loose(parts, body, state(body, one_way), gone)) == 1
    # Pinched from above and from below it is held.
    both = [(21, (0.0, -5.0)), (25, (0.0, -5.0)), (16, (0.0, 5.0)), (20, (0.0, 5.0))]
    assert loose(parts, body, state(body, both), gone) == []


def test_sides_of_a_cut_that_cross_are_found():
    _, body = strip()
    body.tags = [frozenset({CUT}) for _ in body.tags]
    x = body.x.copy()
    assert not crushed(body, x, np.zeros(16, bool)).any()
    x[20] = [4.5, 2.5]                                          # a corner through the right side
    assert crushed(body, x, np.zeros(16, bool)).any()
    body.tags = [frozenset() for _ in body.tags]                # a fold is none of it
    assert not crushed(body, x, np.zeros(16, bool)).any()


def test_nothing_separates_below_the_critical_value(core, tmp_path):
    report = run(blanking("9.", 0.01, 0.2), tmp_path)
    assert not report.remeshes and report.balance() == {}
    found = history(tmp_path, "disc")
    assert work_of_tools(found) == pytest.approx(found["energy.external"][-1], rel=1e-6)


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
