"""A strip wrapped round a former by a right angle and let go: moment and springback of pure bending."""
import sys
from math import pi
from pathlib import Path

import pytest

import lopin
from lopin import closed_form as cf

sys.path.insert(0, str(Path(__file__).resolve().parents[2]/"decks"/"make"))
import sheets  # noqa: E402

METHODS = ("DIRECT", "PENALTY", "PERTURBED LAGRANGE", "AUGMENTED LAGRANGE")
STIFFNESS = 210e3/(12.0*(1.0 - 0.3**2))


def test_bilinear_fibres_without_hardening_are_hill_s():
    exact = cf.bent_sheet(210e3, 0.3, 300.0, 1.0, 20.0)
    assert sheets.wrapped_moment(20.0, hardening=1e-9) == pytest.approx(exact.moment, rel=1e-9)
    assert sheets.wrapped_moment(1000.0) == pytest.approx(cf.bent_sheet(210e3, 0.3, 300.0, 1.0, 1000.0).moment)


# DIRECT with friction is decks/wrapped_strip.inp.
@pytest.mark.parametrize("method, mu", [(METHODS[0], 0.0), *((m, 0.1) for m in METHODS[1:])])
def test_every_method_wraps_it_within_a_hundred_increments(solve, sheet, method, mu):
    deck = sheets.wrapped_strip(mu=mu, method=method)
    result = solve(lopin.Deck.parse(deck, "strip"))
    assert result.verdict == "PASS" and not any("W0523" in w for w in result.warnings)
    assert sum(step["increments"] for step in result.summary["steps"]) < 100
    time, exact = result.history["time"], sheets.wrapped_moment(20.0)
    moment = -result.history["END.rf6"][time <= 1.0 + 1e-9][-1]
    back = 0.5*pi + result.history["END.u6"][-1]
    name = f"{method.lower()}, mu = {mu:g}"
    sheet.compare("E7 wrapped strip", f"moment, {name}", moment, exact, 1e-2, "Hill 1950")
    sheet.compare("E7 wrapped strip", f"springback, {name}", back, exact*10.0*pi/STIFFNESS, 1e-2, "Hill 1950")


def test_a_shape_that_equilibrium_does_not_decide_is_told(solve):
    """Without hardening the end of the strip is 1.4 mm from where an arc of radius 20 has it."""
    text = sheets.wrapped_strip(cells=30, mu=0.0)
    assert "\n300, 0\n600, 1\n" in text
    text = text.replace("\n300, 0\n600, 1\n", "\n300., 0.\n")
    result = solve(lopin.Deck.parse(text[:text.index("*STEP, NAME=RELEASE")], "strip"))
    end = [result.history[f"END.u{k}"][-1] for k in (1, 2)]
    off = max(abs(end[0] - (20.0 - 10.0*pi)), abs(end[1] + 20.0))
    assert off < 0.4 or any("W0523" in w for w in result.warnings)   # 2 % of the radius
