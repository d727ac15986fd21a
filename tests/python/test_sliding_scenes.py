"""The generators of decks whose bodies slide far: what they write can be read."""
import sys

import pytest

from conftest import ROOT

sys.path.insert(0, str(ROOT/"decks"/"make"))

NAMES = ["ironing", "rotating_rings", "crushed_ring", "folded_strip"]


@pytest.mark.parametrize("name", NAMES)
def test_the_reader_knows_every_word(core, name):
    from lopin import _bridge
    from lopin.errors import LopinError

    sliding = pytest.importorskip("sliding")
    assert list(sliding.SCENES) == NAMES
    try:
        _bridge.check_deck(sliding.SCENES[name](), name, ".")
    except LopinError as problem:
        # Self-contact is known and comes later; nothing else may be wrong.
        assert str(problem).startswith("E0108: self-contact"), problem


def test_driven_rings_are_lame_s(core):
    from lopin import closed_form as cf

    sliding = pytest.importorskip("sliding")
    p = sliding.driven_rings_pressure()
    # A free bore and a free outside give way: less pressure.
    outer, _ = cf.nested_rings((50.0, 30.0, 10.0), 0.0, (210e3,)*2, (0.3,)*2, interference=0.01)
    assert p > outer.inside
    # Solid against rigid, thin limit: the overlap over the two layers, oedometric.
    thin = sliding.driven_rings_pressure((999.0, 1000.0, 1001.0))
    assert thin == pytest.approx(0.01/2.0*210e3*0.7/(1.3*0.4), rel=2e-3)
