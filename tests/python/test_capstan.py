"""A strip over a drum: soft as a whole, stiff from point to point. What is pulled farther cannot
pull back less."""
import lopin
import numpy as np
import pytest

SLIDING = 15.9552


@pytest.fixture
def wound(solve, root):
    """The deck with another turn of the grip, other increments, other friction while the strip is
    tightened."""
    text = (root/"decks"/"capstan.inp").read_text()
    text = text.replace("INPUT=capstan.mesh", f"INPUT={root/'decks'/'capstan.mesh'}")

    def run(turn=0.0003, first=0.01, tightened=0.0, loose=False):
        deck = text.replace("-0.0003", repr(-turn)).replace("0.01, 1.", f"{first!r}, 1.")
        deck = deck.replace("*FRICTION\n0.,", f"*FRICTION\n{tightened!r},")
        if loose:
            deck = deck.replace("\nGRIP, 1, 2\n", "\nGRIP, 2\n")
        return solve(lopin.Deck.parse(deck, name="capstan"))

    return run


def force_of(result):
    return result.summary["contact"][0]["force"][1]


@pytest.mark.parametrize("turn, first, tightened",
                         [(0.0003, 1.0, 0.0), (0.0004, 0.01, 0.0), (0.0004, 0.25, 0.0),
                          (0.0003, 0.1, 0.1), (0.003, 0.5, 0.2)])
def test_the_sliding_strip_pulls_the_same_whatever_the_increments(wound, turn, first, tightened):
    result = wound(turn, first, tightened)
    assert result.summary["certificate"]["verdict"] == "PASS"
    assert result.summary["contact"][0]["sticking"] == 0
    assert force_of(result) == pytest.approx(SLIDING, rel=1e-5)


def test_a_grip_that_contact_centres_holds_with_friction(wound):
    assert force_of(wound(loose=True, first=0.1)) == pytest.approx(15.9789, rel=1e-5)


def test_more_turn_never_pulls_less(wound):
    forces = [force_of(wound(turn, 0.1)) for turn in (0.00002, 0.00005, 0.0001, 0.0002)]
    assert np.all(np.diff(forces) > 0.0)
