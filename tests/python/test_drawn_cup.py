"""A cup drawn from a disc; tests/benchmarks/cup.py has the scene."""
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[1]/"benchmarks"))
from cup import drawn  # noqa: E402


@pytest.fixture(scope="module")
def light():
    """Rows of a cup whose holder hardly presses."""
    return drawn(20.0, 1e3, 20, 1, "CAX4I")


def test_the_rim_thickens_as_a_ring_under_hoop_stress(light, sheet):
    last = light[-1]
    assert last.stroke == pytest.approx(20.0) and last.rim < 95.0
    sheet.compare("E9 cup", f"light holder: thickening of the rim at r = {last.rim:.1f} mm",
                  last.thicker, last.hoop, 0.05, source="sqrt(R0/r) - 1")


def test_a_pressed_rim_thickens_less(light):
    pressed = drawn(20.0, 1e5, 20, 1, "CAX4I")[-1]
    assert pressed.rim > light[-1].rim
    assert 0.3*pressed.hoop < pressed.thicker < 0.9*pressed.hoop
