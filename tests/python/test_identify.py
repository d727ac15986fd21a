"""Friction from ring tests: recovered from bores of a closed form and of a run, with its error."""
from pathlib import Path

import numpy as np
import pytest

import lopin
from lopin import mesh_make
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
    ring = Ring.of(ring_deck())
    assert ring.half and ring.start() == pytest.approx((30.0, 15.0, 10.0))
    height, inner = ring.history("TRESCA", 0.12)
    assert height[-1] == pytest.approx(7.0) and len(height) > 10
    deck = small_ring("upper")
    height, inner = Ring.of(deck).history("TRESCA", 0.12)
    assert height[-1] == pytest.approx(4.8)
    table = Table(0.6*HEIGHTS[:-1], np.interp(0.6*HEIGHTS[:-1], height[::-1], inner[::-1]))
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


def small_ring(kind):
    """A ring of 18/9/6: upper or lower half, or whole with a node of its middle held."""
    low, high, turn = {"upper": (0.0, 3.0, 1.0), "lower": (-3.0, 0.0, -1.0)}.get(kind,
                                                                              (-3.0, 3.0, 1.0))
    rows = 3 if high - low < 4.0 else 6
    mesh = mesh_make.block((4.5, high - low), (4, rows), origin=(4.5, low))
    x = mesh.points
    held = np.abs(x[:, 1]) < 1e-9
    held &= (x[:, 0] > 8.9) | (kind in ("upper", "lower"))
    nodes = "".join(f"{k + 1}, {r!r}, {z!r}\n" for k, (r, z) in enumerate(x.tolist()))
    cells = "".join(f"{k + 1}, {', '.join(str(n + 1) for n in c)}\n"
                    for k, c in enumerate(mesh.blocks[0][1]))
    sets = "".join(f"*NSET, NSET={name}\n" + "".join(f"{n + 1}\n" for n in np.flatnonzero(on))
                   for name, on in (("BORE", x[:, 0] < 4.6), ("HELD", held)))
    sides = [turn] if rows == 3 else [1.0, -1.0]
    tools = "".join(f"*SURFACE, NAME=T{k}, TYPE=SEGMENTS\nSTART, {20.0*s!r}, {3.0*s!r}\nLINE, "
                    f"{-20.0*s!r}, {3.0*s!r}\n*NODE, NSET=Q{k}\n{9000 + k}, 0., {9.0*s!r}\n"
                    f"*RIGID BODY, ANALYTICAL SURFACE=T{k}, REF NODE=Q{k}\n"
                    for k, s in enumerate(sides))
    supports = "".join(f"Q{k}, 1\nQ{k}, 6\n" for k in range(len(sides)))
    moves = "".join(f"Q{k}, 2, 2, {-0.6*s!r}\n" for k, s in enumerate(sides))
    pairs = "".join(f"SKIN, T{k}\n" for k in range(len(sides)))
    return lopin.Deck.parse(f"""*NODE
{nodes}*ELEMENT, TYPE=CAX4, ELSET=B
{cells}{sets}*SURFACE, NAME=SKIN
B,
*MATERIAL, NAME=M
*ELASTIC
70000., .3
*PLASTIC
200., 0.
300., 1.
*SOLID SECTION, ELSET=B, MATERIAL=M
{tools}*SURFACE INTERACTION, NAME=I
*SURFACE BEHAVIOR, DIRECT
*FRICTION, LAW=TRESCA
.2
*CONTACT PAIR, INTERACTION=I
{pairs}*BOUNDARY
HELD, 2
{supports}*STEP, NLGEOM
*STATIC, DIRECT
.2, 1.
*BOUNDARY
{moves}*END STEP
""", name="ring")


def test_either_half_of_a_ring_and_a_whole_one_are_the_same_ring(core):
    for place in ("middle", "plate", "mean"):
        found = {}
        for kind in ("upper", "lower", "whole"):
            ring = Ring.of(small_ring(kind), place=place)
            assert ring.start() == pytest.approx((18.0, 9.0, 6.0))
            assert ring.half == (kind != "whole")
            found[kind] = ring.history("TRESCA", 0.2)
        for kind in ("lower", "whole"):
            for own, upper in zip(found[kind], found["upper"]):
                assert own == pytest.approx(upper, rel=1e-6)


def test_a_ring_whose_end_is_held_in_part_is_refused():
    deck = small_ring("upper")
    deck["BOUNDARY"].data[0][0] = 1
    with pytest.raises(lopin.UsageError, match="1 of the 5 nodes of the lower end"):
        Ring.of(deck)
    deck = small_ring("whole")
    text = deck.text().replace("HELD, 2", "B, 2").replace("*NODE\n", "*NODE, NSET=B\n", 1)
    with pytest.raises(lopin.UsageError, match="both ends"):
        Ring.of(lopin.Deck.parse(text, name="ring"))
