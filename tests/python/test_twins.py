"""Sixteen heavier twins: each gets the advice that is due, the light one none, and the answer is the
same for fewer counts."""
import numpy as np
import pytest
from heavier_twins import twins

import lopin

TWINS = list(twins())
ADVICE = {f"N036{k}" for k in range(1, 10)}


def advised(deck, solve=lopin.run):
    """Codes of a check, and of a run where only its end tells."""
    notes = lopin.check(deck)
    if "CPE8" in deck.text() or "NLGEOM" in deck.text():
        notes = notes + solve(deck).diagnostics
    return {n["code"] for n in notes} & ADVICE


def force(result):
    """Across the tool of the first pair: shear along it cancels in a whole."""
    return np.abs(np.sum(result.contact(0).last.force, axis=0)).max()


def counts(result):
    steps = result.summary["steps"]
    return {"equations": result.summary["equations"],
            **{k: sum(s[k] for s in steps) for k in ("increments", "iterations", "factorisations",
                                                     "back_solves")}}


@pytest.mark.parametrize("twin", TWINS, ids=lambda t: t[0])
def test_advice_is_due_to_the_heavy_one_alone(twin, solve):
    _, code, heavy, light, _, _ = twin
    assert advised(heavy, solve) == {code}
    assert not advised(light)


@pytest.mark.parametrize("twin", TWINS, ids=lambda t: t[0])
def test_the_light_one_has_the_answer(twin, solve):
    _, code, heavy, light, share, tolerance = twin
    much, little = solve(heavy), solve(light)
    assert np.isclose(force(much), share*force(little), rtol=tolerance)
    before, after = counts(much), counts(little)
    assert all(after[k] <= before[k] for k in ("equations", "increments"))
    # Small scenes keep no factor for a second tangent: what factors cost goes by their size.
    assert after["factorisations"]*after["equations"] <= before["factorisations"]*before["equations"]
    if code in ("N0361", "N0362", "N0364", "N0365", "N0367", "N0368"):
        assert after["equations"] < 0.6*before["equations"]
    if code == "N0369":
        assert after["iterations"] < before["iterations"]
    if code == "N0363":
        assert after["increments"] == 1 and before["back_solves"] > 3*after["back_solves"]
