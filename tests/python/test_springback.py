"""What comes free after forming is a small part of its work, and is known no better than that."""
import numpy as np
import pytest

from lopin.atlas import metal
from lopin.atlas.formed import formed
from lopin.atlas.forming_scenes import air_bend, flanged


def released(build, thickness, increments, mu=0.0):
    """How far the nodes of a strip spring back, and the codes that were said."""
    found = formed(*build("CPE8R", thickness, mu, increments, "lagrange"))
    assert not found.code, found.code
    return found.shapes[-1] - found.shapes[-2], found.warned


@pytest.mark.parametrize("thickness, mu", [(0.25, 0.0), (0.5, 0.0), (0.25, 0.1)])
def test_energy_that_no_work_gave_is_told_beside_what_comes_free(thickness, mu, monkeypatch):
    """A flange over a radius of five facets: its force rises and falls as each of them leaves."""
    monkeypatch.setattr(metal, "MOST", 2000)
    right, said = released(flanged, thickness, (0.0025, 0.0025), mu)
    assert "W0519" not in said
    coarse, said = released(flanged, thickness, (), mu)
    off = np.linalg.norm(coarse - right)/np.linalg.norm(right)
    assert "W0519" in said and off > 0.01


def test_a_bend_in_air_is_not_doubted():
    assert "W0519" not in released(air_bend, 0.5, (0.02, 0.02))[1]
