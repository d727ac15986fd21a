"""An arc pressed on an elastic slab and drawn along it: all slides, so that its forces depend on the place alone."""
import pytest

from lopin.atlas.numbers import PLAIN, IncrementMap


@pytest.mark.parametrize("facets", [2.0, 4.0, 8.0])
def test_long_increments_end_where_short_ones_do(solve, facets):
    """Steps of as many facets of quadratic elements; states that start a second attempt once were 7 to 25 % off."""
    scene = IncrementMap()
    long, short = (solve(scene.deck("CPE8R", x, 0.1, PLAIN)) for x in (facets, 0.5))
    for key in ("DIE.rf1", "DIE.rf2"):
        assert long.history[key][-1] == pytest.approx(short.history[key][-1], rel=1e-6)
    assert "W0530" not in {d["code"] for d in long.diagnostics}
