"""Friction from ring tests: recovered from bores of a closed form and of a run, with its error."""
from pathlib import Path

import numpy as np
import pytest

import lopin
from lopin.__main__ import python_command
from lopin.closed_form import ring_bore
from lopin.identify import Ring, Table, fit, identify

DECKS = Path(__file__).resolve().parents[2]/"decks"
HEIGHTS = np.array([9.0, 8.0, 7.0])


def bores(m):
    """Diameters of a 30/15/10 ring by the upper bound."""
    return np.array([15.0*(1.0 + ring_bore(m, 1.0 - h/10.0, 3.0, 1.5)) for h in HEIGHTS])


def test_a_shear_factor_is_recovered_from_exact_bores():
    found = fit(bores, bores(0.137), 0.3, 1.0)
    assert found.value == pytest.approx(0.137, abs=2e-4) and found.rms < 2e-3
    assert len(found.runs) <= 8


def test_the_error_is_that_of_many_noisy_tables():
    rng = np.random.default_rng(1)
    # Near its answer the bore is linear in m: a cheap twin of the closed form.
    at, slope = bores(0.15), (bores(0.16) - bores(0.14))/0.02
    found = [fit(lambda m: at + slope*(m - 0.15), at + 0.05*rng.standard_normal(3), 0.2, 1.0)
             for _ in range(400)]
    values = np.array([f.value for f in found])
    assert values.std() == pytest.approx(0.05/np.linalg.norm(slope), rel=0.1)
    assert np.sqrt(np.mean([f.error**2 for f in found])) == pytest.approx(values.std(), rel=0.1)
    inside = np.mean([abs(f.value - 0.15) <= f.within for f in found])
    assert 0.92 < inside < 0.98


def ring_deck():
    """Half of a ring between plates, pressed by 30 %."""
    text = (DECKS/"ring_compression.inp").read_text()
    return lopin.Deck.parse(text[:text.index("*STEP, NAME=TO_50")], name="ring", folder=DECKS)


def test_a_run_is_identified_from_its_own_bores(core):
    deck = ring_deck()
    ring = Ring.of(deck)
    assert ring.half and ring.start() == pytest.approx((30.0, 15.0, 10.0))
    height, inner = ring.history("TRESCA", 0.12)
    assert height[-1] == pytest.approx(7.0) and len(height) > 10
    table = Table(HEIGHTS, np.interp(HEIGHTS, height[::-1], inner[::-1]))
    found = identify(deck, table, say=lambda line: None)
    assert found.law == "TRESCA" and found.value == pytest.approx(0.12, abs=1e-3)
    assert found.rms < 1e-2


def test_what_cannot_be_identified_is_said(tmp_path):
    bad = tmp_path/"bad.csv"
    bad.write_text("height;inner\n9;15\n")
    with pytest.raises(lopin.UsageError, match="height and inner"):
        Table.read(bad)
    bad.write_text("height,inner\n9,15\n")
    with pytest.raises(lopin.UsageError, match="1 rings"):
        Table.read(bad)
    with pytest.raises(lopin.UsageError, match="1 rings"):
        python_command(["identify", str(DECKS/"ring_compression.inp"), str(bad)])
    deck = lopin.Deck.read(DECKS/"hertz_sphere_3d.inp")
    with pytest.raises(lopin.UsageError, match="axisymmetric"):
        Ring.of(deck)
    with pytest.raises(lopin.UsageError, match="no node set HOLE"):
        Ring.of(ring_deck(), "HOLE")
    with pytest.raises(lopin.UsageError, match="does not change"):
        fit(lambda m: bores(0.2), bores(0.2), 0.2, 1.0)


def test_a_table_may_say_more(tmp_path):
    path = tmp_path/"rings.csv"
    path.write_text("# Ti6Al4V, glass at 900 C\nheight, inner, force\n8, 14.5, 100\n6, 13.9, 180\n")
    table = Table.read(path)
    assert table.height.tolist() == [8.0, 6.0] and table.inner.tolist() == [14.5, 13.9]
