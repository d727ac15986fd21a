"""Measures of a filled die: gaps to its triangles, the flash."""
import sys
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("scipy")
pytest.importorskip("matplotlib")
sys.path.insert(0, str(Path(__file__).parents[2]/"decks"/"make"))

from die_filling import clearance, flash_of, gap_of_nodes  # noqa: E402
from die_forging import full_cross, full_rod  # noqa: E402
from die_shapes import Cross, on_grid  # noqa: E402
from tools import binary  # noqa: E402


def test_a_skin_below_the_die_is_as_far_as_it_was_moved(tmp_path):
    """Metal whose skin is the die itself, then 0.2 below the crown of the hub."""
    die = Cross()
    facets = on_grid(die, 2.0)
    (tmp_path/"die.stl").write_bytes(binary(facets + [0.0, 0.0, 5.0]))
    x, skin = facets.reshape(-1, 3), np.arange(3*len(facets)).reshape(-1, 3)
    gap, places = clearance(die, tmp_path/"die.stl", 5.0, x, skin)
    assert gap.max() < 1e-5 and len(gap) > 100
    gap, places = clearance(die, tmp_path/"die.stl", 5.2, x, skin)
    crown = np.hypot(*places[:, :2].T) < 8.0
    assert np.abs(gap[crown] - 0.2).max() < 1e-5


def test_nodes_on_the_wall_have_no_gap_and_below_it_their_distance_along_its_normal():
    die = Cross()
    facets = on_grid(die, 2.0)
    x, skin = facets.reshape(-1, 3), np.arange(3*len(facets)).reshape(-1, 3)
    gap, own = gap_of_nodes(die, 0.0, x, skin)
    assert gap.max() < 1e-9 and len(own) > 100
    gap, own = gap_of_nodes(die, 0.2, x, skin)
    crown = np.hypot(*own[:, :2].T) < 8.0
    assert np.abs(gap[crown] - 0.2).max() < 1e-9 and gap.max() < 0.2 + 1e-9


def test_the_flash_reaches_as_far_as_the_least_angle():
    die = Cross()
    angle = np.linspace(0.0, 0.5*np.pi, 2000)
    rim = np.column_stack([70.0*np.cos(angle), 70.0*np.sin(angle), 0.0*angle])
    least, most = flash_of(die, rim)
    assert least == pytest.approx(die.outline(70.0, 0.0), rel=0.1) and most > least


@pytest.mark.parametrize("scene", [full_cross, full_rod])
def test_full_scenes_are_decks_with_their_dies(scene, core, tmp_path):
    import lopin
    from lopin.run import check

    check(lopin.Deck.parse(scene(tmp_path), name="full", folder=tmp_path))
    assert len(list(tmp_path.glob("*.stl"))) == 1
