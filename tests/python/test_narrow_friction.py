"""Friction by area where contact is narrower than a facet: W0560."""
import pytest

from lopin.atlas.forming_scenes import air_bend, billet

TRESCA = ("*FRICTION, LAW=TRESCA", "0.3,")


def told(result):
    return [w["message"] for w in result.diagnostics if w["code"] == "W0560"]


@pytest.mark.parametrize("friction, said", [
    (TRESCA, True), (("*FRICTION, LAW=CRISTESCU", "0.3,"), True), (("*FRICTION", "0.3,"), False)])
def test_a_sheet_over_radii_is_told_unless_friction_follows_the_force(solve, friction, said):
    """One node has the area of a facet of 1 mm: with quarter facets the punch needs less."""
    assert bool(told(solve(air_bend("CPE4I", 1.0, 0.0, friction=friction)[0].deck()))) == said


def test_a_billet_under_a_plate_is_not_told(solve):
    """What presses side by side is known but for a facet."""
    assert not told(solve(billet("CPE4", TRESCA)[0].deck()))
