"""A rigid ball in metal that does not harden: SSNV506 of code_aster, beside its values."""
import sys
from math import pi
from pathlib import Path

import numpy as np
import pytest

import lopin

sys.path.insert(0, str(Path(__file__).resolve().parents[2]/"decks"/"make"))
from indenting import ball_in_metal  # noqa: E402

RADIUS, FLOW = 500.0, 50.0
PUBLISHED = {20.0: 2.038043e6, 40.0: 4.076085e6, 60.0: 6.114128e6, 80.0: 8.152170e6,
             100.0: 10.190213e6}


@pytest.fixture(scope="module")
def pressed():
    """The ball 100 mm deep, 16 cells under it."""
    return lopin.run(lopin.Deck.parse(ball_in_metal(16), "ball_in_metal"))


def test_force_beside_the_published_line(pressed, sheet):
    """F = 4.076 Y R depth is the line of a constant pressure, 2.83 Y over 1.44 times the cap.

    Pressure falls as the ball sinks in: the force falls short of the line
    the more, the deeper. Reported, not gated: code_aster's own runs fall 11 % short at 100 mm.
    """
    depth, force = -pressed.history["BALL.u2"], -pressed.history["BALL.rf2"]/(2.0*pi)
    for at, line in PUBLISHED.items():
        sheet.compare("SSNV506 ball in metal", f"force per radian, {at:g} mm deep [N]",
                      float(np.interp(at, depth, force)), line, 0.35, "code_aster, linear law")


def test_metal_piles_up_and_pressure_is_nearly_three_times_the_flow_stress(pressed, sheet):
    """a^2 over that of the cap without pile-up, 1.43; pressure between 2.3 and 3 Y."""
    a = radius_of_contact(pressed)
    depth = -pressed.history["BALL.u2"][-1]
    pile = a**2/(2.0*RADIUS*depth - depth**2)
    pressure = -pressed.history["BALL.rf2"][-1]/(pi*a**2)
    sheet.compare("SSNV506 ball in metal", "square of the radius over that of the cap", pile, 1.43,
                  0.06, "finite elements, recalled")
    assert 2.2*FLOW < pressure < 3.0*FLOW


def radius_of_contact(result) -> float:
    """Half way between the last node that touches and the next."""
    piece = result.to_meshio(-1)
    x = piece.points[:, :2]
    now = x + np.asarray(piece.point_data["U"])[:, :2]
    top = np.flatnonzero((np.abs(x[:, 1]) < 1e-9) & (x[:, 0] > -1e-9) & (x[:, 0] < 2.0*RADIUS))
    top = top[np.argsort(x[top, 0])]
    centre = RADIUS + result.history["BALL.u2"][-1]
    gap = np.sqrt(now[top, 0]**2 + (now[top, 1] - centre)**2) - RADIUS
    last = np.flatnonzero(gap < 1e-3)[-1]
    return 0.5*float(now[top[last], 0] + now[top[last + 1], 0])
