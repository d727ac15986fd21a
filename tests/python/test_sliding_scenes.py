"""The generators of decks whose bodies slide far: what they write can be read."""
import sys

import pytest

from conftest import ROOT

sys.path.insert(0, str(ROOT/"decks"/"make"))

NAMES = ["ironing", "rotating_rings", "crushed_ring", "folded_strip", "beam_over_corner",
         "sliding_ball"]


@pytest.mark.parametrize("name", NAMES)
def test_the_reader_knows_every_word(core, name):
    from lopin import _bridge
    from lopin.errors import LopinError

    import sliding

    assert list(sliding.SCENES) == NAMES
    try:
        _bridge.check_deck(sliding.SCENES[name](), name, str(ROOT/"decks"))
    except LopinError as problem:
        # Self-contact is known and comes later; nothing else may be wrong.
        assert str(problem).startswith("E0108: self-contact"), problem


def test_fitted_rings_are_lame_s(core):
    from lopin import closed_form as cf

    import sliding

    p, bore = sliding.fitted_rings_pressure()
    outer, inner = cf.nested_rings((50.0, 30.0, 10.0), 0.0, (210e3,)*2, (0.3,)*2, "plane strain",
                                   0.01)
    assert p == pytest.approx(22.792022, rel=1e-6)
    assert bore < 0.0
