"""Tools driven by a velocity: they go on from where a step finds them, by its own time."""
import pytest

import lopin

BLOCK = """*NODE, NSET=ALL
1, 0., 0.
2, 1., 0.
3, 1., 1.
4, 0., 1.
*ELEMENT, TYPE=CPE4, ELSET=E
1, 1, 2, 3, 4
*NSET, NSET=TOP
3, 4
*MATERIAL, NAME=M
*ELASTIC
1000., 0.3
*SOLID SECTION, ELSET=E, MATERIAL=M
*AMPLITUDE, NAME=SAW
0., 0., 2., 1., 4., 0.
*BOUNDARY
1, 1, 2
2, 2
*STEP
*STATIC, DIRECT
1., 4.
*BOUNDARY, TYPE=VELOCITY{first}
TOP, 2, 2, 0.01
*END STEP
*STEP
*STATIC, DIRECT
1., 2.
{second}*END STEP
"""


def way(first: str = "", second: str = "") -> list[float]:
    """Displacement of the top after every increment."""
    result = lopin.run(lopin.Deck.parse(BLOCK.format(first=first, second=second), "block"))
    return [float(result.at(k)["U"][2][1]) for k in range(len(result.times))]


def test_a_velocity_goes_on_in_the_next_step():
    assert way() == pytest.approx([0.01*k for k in range(1, 7)], rel=1e-12)


def test_another_velocity_goes_on_from_there():
    card = "*BOUNDARY, TYPE=VELOCITY\nTOP, 2, 2, -0.02\n"
    assert way(second=card) == pytest.approx([0.01, 0.02, 0.03, 0.04, 0.02, 0.0], abs=1e-15)


def test_fixed_stops():
    card = "*BOUNDARY, FIXED\nTOP, 2, 2\n"
    assert way(second=card) == pytest.approx([0.01, 0.02, 0.03, 0.04, 0.04, 0.04], rel=1e-12)


def test_the_integral_of_an_amplitude_is_exact():
    """A saw tooth: t^2/4 up to 2, then its mirror image; it ends at rest, and stays there."""
    card = "*BOUNDARY, TYPE=VELOCITY\nTOP, 2, 2, 0.01\n"
    found = way(first=", AMPLITUDE=SAW")
    assert found == pytest.approx([0.0025, 0.01, 0.0175, 0.02, 0.02, 0.02], rel=1e-12)
    assert way(first=", AMPLITUDE=SAW", second=card)[-1] == pytest.approx(0.04, rel=1e-12)


def test_fixed_holds_what_was_free_where_it_is():
    bent = BLOCK.format(first="",
                        second="*BOUNDARY, FIXED\n3, 1\n*BOUNDARY, TYPE=VELOCITY\nTOP, 2, 2, 0.\n")
    result = lopin.run(lopin.Deck.parse(bent.replace("1, 1, 2\n2, 2", "1, 1, 2\n2, 2\n4, 1"),
                                        "block"))
    across = [float(result.at(k)["U"][2][0]) for k in range(len(result.times))]
    assert across[3] < -1e-3
    assert across[4:] == [across[3]]*2
