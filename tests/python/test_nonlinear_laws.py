"""The methods by the laws of friction on the finite path: the block of test_friction_laws, pressed
and dragged."""
import re
from pathlib import Path

import numpy as np
import pytest
from test_friction_laws import (AREA, CURVES, ELEMENTS, LAWS, METHODS, Q, SPEED, block,
                                shear_of)

from lopin import Deck

DECKS = Path(__file__).resolve().parents[2]/"decks"


@pytest.fixture
def drag(solve):
    """Forces of the floor along and across, and what the law says of the nodes."""
    def run(law, words="", method="DIRECT", change=None, **options):
        text = block(law, words, method, **options)
        if change:
            text = text.replace(*change)
        result = solve(Deck.parse("*LOPIN, PATH=FINITE\n" + text, name="block"))
        h = result.history
        contact = result.contact(0).last
        foot = result["Mises"].ravel()[:2*(ELEMENTS + 1):2]
        order = np.argsort(contact.x[:, 0])
        # Sums in double precision: those of the file's single numbers hang on the BLAS.
        pressure = np.asarray(contact.pressure, dtype=float)[order]
        weight = np.asarray(contact["weight"], dtype=float)[order]
        first = np.full(ELEMENTS + 1, AREA/ELEMENTS)
        first[[0, -1]] *= 0.5
        assert weight == pytest.approx(first, rel=2e-3)
        return abs(h["FLOOR.rf1"][-1]), abs(h["FLOOR.rf2"][-1]), weight @ shear_of(law, pressure,
                                                                                       foot), pressure

    return run


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("law", LAWS)
def test_every_law_by_every_method(drag, sheet, law, method):
    along, across, expected, _ = drag(law, method=method)
    sheet.compare("C9 law zoo, finite path", f"{law}, {method}: force that drags", along, expected,
                  1e-7)


@pytest.mark.parametrize("curve", CURVES)
@pytest.mark.parametrize("law", LAWS)
def test_every_law_regularised_by_speed(drag, sheet, law, curve):
    along, _, expected, _ = drag(law, f", REGULARIZATION={curve}, V0={SPEED}")
    expected *= CURVES[curve](1.0)
    if law == "NORTON-HOFF":
        expected *= 2.0**(0.5*Q)
    sheet.compare("C9 law zoo, finite path", f"{law}, {curve} at V0: force that drags", along,
                  expected, 1e-6)


@pytest.mark.parametrize("law", LAWS)
def test_the_number_of_increments_does_not_matter(drag, law):
    few, many = drag(law, increments=3)[0], drag(law, increments=12)[0]
    assert few == pytest.approx(many, rel=1e-7)


DECAY = ("*FRICTION, EXPONENTIAL DECAY\n0.3,", "*FRICTION, EXPONENTIAL DECAY\n0.4, 0.2, 0.7")


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("increments", [3, 12])
def test_decay_reads_the_speed_of_the_slip(drag, method, increments):
    along, across, _, _ = drag("COULOMB", ", EXPONENTIAL DECAY", method, change=DECAY,
                               increments=increments)
    mu = 0.2 + (0.4 - 0.2)*np.exp(-0.7*SPEED)
    assert along == pytest.approx(mu*across, rel=1e-7)


@pytest.mark.parametrize("static, kinetic, decay, most",
                         [(0.3, 0.1, 0.2, 250), (0.3, 0.1, 2.0, 280), (0.1, 0.3, 0.2, 200)])
def test_a_billet_whose_friction_changes_with_speed(solve, static, kinetic, decay, most):
    """Newton knows the slope of the coefficient: 179, 189 and 138 iterations; by the speed of the
    iteration before there were 323, 7394 and 286."""
    text = (DECKS/"upsetting.inp").read_text(encoding="utf-8")
    law = f"*FRICTION, EXPONENTIAL DECAY\n{static}, {kinetic}, {decay}"
    text = re.sub(r"\*FRICTION[^\n]*\n[^\n*]*", law, text)
    result = solve(Deck.parse(text, "billet", DECKS))
    assert result.verdict == "PASS"
    assert sum(result.history["iterations"]) < most
