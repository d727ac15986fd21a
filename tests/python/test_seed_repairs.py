"""Every line of the lecture that cannot be coded as it stands: Lopin follows the repaired form, and
not the printed one.

Counted are the lines of sections C to J that carry a mark; H4 carries two and counts once, J1 three
and J4 two, which count by themselves.
"""
import numpy as np
import pytest

from seed_repairs import REPAIRS, page

SECTIONS = [*"C1 C2 D2 D3 D4 E1 E2 E3 E4 E5 E6 F1 F2 F3 F4 F5 G1 G2 H4 H5 H8 H9 J0 J1".split(),
            "J1, energy", "J1, work", "J3", "J4", "J4, update"]


def test_none_is_left_out():
    assert [r.id for r in REPAIRS] == SECTIONS and len(SECTIONS) == 29
    assert len({r.quote for r in REPAIRS}) == 29


@pytest.mark.parametrize("repair", REPAIRS, ids=lambda r: r.id)
def test_lopin_follows_the_repaired_form(repair):
    assert np.asarray(repair.lopin(), float) == pytest.approx(np.asarray(repair.repaired(), float),
                                                              rel=1e-6, abs=1e-9)


@pytest.mark.parametrize("repair", REPAIRS, ids=lambda r: r.id)
def test_the_printed_form_in_its_place_would_fail(repair):
    lopin, printed = np.asarray(repair.lopin(), float), np.asarray(repair.printed(), float)
    scale = max(np.abs(lopin).max(), np.abs(printed).max())
    assert np.abs(lopin - printed).max() > 0.1*scale


def test_the_manual_shows_the_same_table(root):
    told = (root/"docs"/"seed-repairs.md").read_text(encoding="utf-8")
    assert told == page(), "write it again: python tests/python/seed_repairs.py"
