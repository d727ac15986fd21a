"""Histories of friction begin each increment with what slid before sliding on (path condensed).

That ways which turn round are no matter, test_verification_mindlin and test_closed_friction say.
"""
import re

import pytest

import lopin
from conftest import ROOT


def deck(name, increment):
    text = (ROOT/"decks"/f"{name}.inp").read_text(encoding="utf-8")
    text = re.sub(r"(\*STATIC, DIRECT\n)[0-9.]+,", rf"\g<1>{increment},", text)
    return lopin.Deck.parse(text, name, ROOT/"decks")


def count(result):
    steps = result.summary["steps"]
    return sum(s["iterations"] for s in steps)/sum(s["increments"] for s in steps)


@pytest.mark.parametrize("name, most", [("rough_punch", 2.0), ("nafems_punch", 2.2)])
def test_what_slides_on_is_found_at_once(name, most, solve):
    """Two iterations an increment, one to predict and one to confirm; a prediction that all points
    stick took four to eight."""
    assert count(solve(deck(name, 0.02))) <= most


def test_a_drum_that_turns_needs_three(solve):
    """Its wedge of slip grows; 9.5 iterations an increment before."""
    assert count(solve(lopin.Deck.read(ROOT/"decks"/"capstan.inp"))) < 3.0
