"""A quarter of the closed die's disc in space: its first mesh, its deck, a short way of it."""
import numpy as np
import pytest

import lopin
from lopin.atlas.remeshed_space import HEIGHT, RADIUS, quarter, round_quarter
from lopin.atlas.scenes import Frame


@pytest.mark.parametrize("size", [3.2, 2.13])
def test_the_first_mesh_has_the_volume_of_the_round_disc(size):
    """Chords lack up to 0.6 % of it, which the force of a closing die would show tenfold."""
    mesh = round_quarter(size)
    corner = mesh.points[mesh.blocks[0][1]]
    volume = np.linalg.det(corner[:, 1:] - corner[:, :1])/6.0
    assert volume.min() > 0.0
    assert volume.sum() == pytest.approx(0.25*np.pi*RADIUS**2*HEIGHT, rel=1e-12)
    for k, name in enumerate(("X0", "Y0", "Z0")):
        assert np.abs(mesh.points[mesh.point_sets[name], k]).max() < 1e-9
        assert np.isin(mesh.surface_points("SKIN"), mesh.point_sets[name]).sum() > 4


def test_its_deck_is_sound_in_any_unit(core):
    for frame in (Frame(0.0, 1.0, 1.0), Frame(0.0, 1e-3, 1e6)):
        lopin.check(quarter(3.2, 0.5, frame))
