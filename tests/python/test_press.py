"""Presses and hammers: cranks against their geometry, blows against closed forms."""
from pathlib import Path

import numpy as np
import pytest

import lopin
from lopin.press import Crank, blow, times_of_blow

DECKS = Path(__file__).resolve().parents[2]/"decks"


def test_a_crank_moves_as_its_geometry_says():
    crank = Crank(50.0, 300.0, 2.0)
    for height in (0.0, 0.3, 7.0, 60.0, 99.9):
        assert crank.height(crank.angle(height)) == pytest.approx(height, abs=1e-9)
    angle, step = crank.angle(20.0), 1e-6
    slope = float(crank.height(angle + step) - crank.height(angle - step))/(2.0*step)
    assert crank.speed(20.0) == pytest.approx(slope*2.0*np.pi*2.0, rel=1e-8)
    # A long rod: a cosine.
    assert Crank(50.0, 1e9, 1.0).height(1.0) == pytest.approx(50.0*(1.0 - np.cos(1.0)), rel=1e-4)
    card, period = crank.amplitude(20.0, 11)
    rows = np.array([[float(v) for v in line.split(",")] for line in card.splitlines()[1:]])
    assert rows[0].tolist() == [0.0, pytest.approx(0.0, abs=1e-12)]
    assert rows[-1] == pytest.approx([period, 1.0])
    assert period == pytest.approx(crank.angle(20.0)/(4.0*np.pi))
    assert (np.diff(rows[:, 1]) > 0.0).all()
    with pytest.raises(lopin.UsageError, match="radius"):
        Crank(300.0, 50.0, 1.0)
    with pytest.raises(lopin.UsageError, match="at most 100"):
        crank.angle(101.0)


def test_a_hammer_slows_as_its_energy_goes():
    # A constant force: way = v t - F t^2/2 m. A spring: a quarter of a sine.
    mass, energy, force = 2.0, 100.0, 30.0
    way = np.linspace(0.0, 3.0, 4)
    t = times_of_blow(way, force*way, energy, mass)
    assert way == pytest.approx(np.sqrt(2.0*energy/mass)*t - force*t**2/(2.0*mass))
    way = np.linspace(0.0, 1.0, 2001)
    t = times_of_blow(way, energy*way**2, energy, mass)
    assert t[-1] == pytest.approx(0.5*np.pi*np.sqrt(mass/(2.0*energy)), rel=2e-2)
    assert way[1000] == pytest.approx(np.sin(np.sqrt(2.0*energy/mass)*t[1000]), rel=1e-6)
    with pytest.raises(lopin.UsageError, match="spent"):
        times_of_blow([0.0, 1.0, 2.0], [0.0, 1.0, 2.0], 0.5, 1.0)


def billet():
    """A billet without friction: its force is that of uniaxial pressing."""
    text = (DECKS/"upsetting.inp").read_text()
    text = text[:text.index("*STEP, NAME=TO_30")]
    head, _, tail = text.partition("*FRICTION\n")
    deck = lopin.Deck.parse(head + tail.partition("\n")[2], name="blow", folder=DECKS)
    # The first increments are elastic: the work is a sum over increments.
    deck["STATIC"].data[0][:] = [2e-3, 1.0, 1e-6, 0.05]
    return deck


def work_of_pressing(stroke):
    """Plastic work of the half billet, radius 10 and height 15 [mJ]: V (700 e + 150 e^2)."""
    e = np.log(15.0/(15.0 - stroke))
    return np.pi*100.0*15.0*(700.0*e + 150.0*e*e)


def test_a_blow_ends_where_its_energy_is_spent(core):
    energy = work_of_pressing(1.8)
    with lopin.open(billet()) as job:
        done = blow(job, "PLATE", 2, energy)
        assert done.spent and job.is_open
        # The elastic work is 1 % of it, and bends the answer by as much.
        assert done.stroke == pytest.approx(1.8, rel=0.02)
        assert done.work[-2] < energy <= done.work[-1]
        history = job.result.history["energy.external"][-1]
        assert done.work[-1] == pytest.approx(history, rel=1e-6)
        # The next blow goes on from there.
        more = blow(job, "PLATE", 2, 0.2*energy)
        assert more.spent and more.way[0] == 0.0 and 0.1 < more.stroke < 0.6
        with pytest.raises(lopin.UsageError, match="above 0"):
            blow(job, "PLATE", 2, 0.0)
        with pytest.raises(lopin.UsageError, match="no RAM.rf2"):
            blow(job, "RAM", 2, 1.0)


@pytest.mark.parametrize("largest", [0.02, 0.05, 0.2])
@pytest.mark.parametrize("blows", [3, 10, 40])
def test_blows_add_up_whatever_the_increments(core, largest, blows):
    """Strokes of blows end where one blow of all their energy does: surpluses are not forgotten."""
    deck, energy = billet(), work_of_pressing(2.0)
    deck["STATIC"].data[0][-1] = largest
    with lopin.open(deck) as job:
        one = blow(job, "PLATE", 2, energy)
    with lopin.open(deck) as job:
        done = [blow(job, "PLATE", 2, energy/blows) for _ in range(blows)]
        # The last increment of them all may go beyond; none of a blow before is beyond the stroke.
        beyond = -job.result.history["PLATE.u2"][-1] - sum(b.stroke for b in done)
        assert 0.0 <= beyond <= 3.0*largest + 1e-9
    assert all(b.spent and b.way[0] == 0.0 for b in done)
    assert sum(b.stroke for b in done) == pytest.approx(one.stroke, rel=1e-6)
    assert done[-1].force == pytest.approx(one.force, rel=1e-6)
    assert one.stroke == pytest.approx(2.0, rel=0.02)


def test_increments_between_blows_and_states_begin_anew(core):
    with lopin.open(billet()) as job:
        blow(job, "PLATE", 2, work_of_pressing(1.0))
        job.advance()
        more = blow(job, "PLATE", 2, 1.0)
        assert more.way[0] == 0.0 and len(more.way) == 2
        state = job.state
    with lopin.open(billet(), state=state) as job:
        with pytest.raises(lopin.UsageError, match="where its tools stand"):
            blow(job, "PLATE", 2, 1.0)
        job.advance()
        assert blow(job, "PLATE", 2, work_of_pressing(0.1)).stroke < 0.1


@pytest.mark.parametrize("ask, message", [
    (lambda: Crank(50.0, 300.0, 1.0).amplitude(0.0), "a last 0"),
    (lambda: Crank(50.0, 300.0, 1.0).amplitude(-3.0), "a last -3"),
    (lambda: Crank(50.0, 300.0, 1.0).amplitude(101.0), "a last 101"),
    (lambda: Crank(50.0, 300.0, 1.0).amplitude(np.nan), "a last nan"),
    (lambda: Crank(50.0, 300.0, 1.0).amplitude(20.0, 1), "at least 2 points, not 1"),
    (lambda: Crank(50.0, 300.0, np.nan), "nan turns"),
    (lambda: Crank(50.0, np.inf, 1.0), "rod inf"),
    (lambda: times_of_blow([0.0, 1.0], [0.0, 1.0], 5.0, 0.0), "not 0 and 5"),
    (lambda: times_of_blow([0.0, 1.0], [0.0, 1.0], np.inf, 1.0), "not 1 and inf"),
    (lambda: times_of_blow([0.0, 1.0, 0.5], [0.0, 1.0, 2.0], 5.0, 1.0), "does not fall"),
    (lambda: times_of_blow([0.0, np.nan], [0.0, 1.0], 5.0, 1.0), "rows of numbers"),
    (lambda: times_of_blow([0.0, 1.0], [0.0], 5.0, 1.0), "as many of the one"),
    (lambda: times_of_blow(1.0, 1.0, 5.0, 1.0), "rows of numbers")])
def test_nonsense_is_refused_by_what_it_is(ask, message):
    with pytest.raises(lopin.UsageError, match=message):
        ask()


def test_a_blow_that_the_deck_does_not_take_says_so(core):
    with lopin.open(billet()) as job:
        done = blow(job, "PLATE", 2, 1e9)
    assert not done.spent and done.stroke == pytest.approx(3.0)
