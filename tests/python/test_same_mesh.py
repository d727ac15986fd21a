"""The next operation on the mesh of the start: what is let go of springs back as it does in one
deck, whatever the elements remember."""
import numpy as np
import pytest
from test_kept_bodies import HILL, MOVING
from test_operation import FREE, HEAT, SECOND
from test_point_states import PLASTIC, deck, grid

import lopin
from lopin.errors import ModelError
from lopin.operation import beyond_plane
from lopin.same_mesh import next_on_same_mesh


def after(scene, cards, **options):
    """The deck of the next operation from the end of a run, and the last frame."""
    with lopin.open(scene) as job:
        for frame in job:
            found = next_on_same_mesh(job, "B", cards, name="second", **options)
    return *found, frame


def free(word):
    return FREE.replace("AXIS, 1", "AXIS, 1\nBACK, 3" if "3D" in word else "AXIS, 1")


@pytest.mark.parametrize("word, law", [
    ("CAX4", PLASTIC), ("CPE4I", PLASTIC), ("C3D8I", PLASTIC), ("CAX4", HILL), ("C3D8", MOVING)])
@pytest.mark.parametrize("release", [0.0, 1.0])
def test_a_block_let_go_of_springs_back_as_in_one_deck(word, law, release, core):
    """The tool taken away: by a step of the same deck, and as an operation of its own."""
    x, cells = grid(word)
    scene = deck(word, x, cells, 5.0, -1.0, law=law, mu=0.2)
    text = scene.text().replace("FLOOR, 1, 2", "FLOOR, 2")
    scene = lopin.Deck.parse(text, name="block")
    second, carried, pressed = after(scene, free(word), release=release)
    assert carried.gone == 0
    found = lopin.run(second)
    away = text + free(word)[free(word).index("*STEP"):].replace(
        "*STATIC", "*MODEL CHANGE, TYPE=CONTACT PAIR, REMOVE\nSKIN, DIE\n*STATIC")
    one = lopin.run(lopin.Deck.parse(away, name="one"))
    n = len(x)
    back = np.asarray(one["displacement"])[:n] - np.asarray(pressed["displacement"])[:n]
    gap = np.asarray(found["displacement"])[:n] - np.asarray(one["displacement"])[:n]
    assert np.abs(back).max() > 1e-3
    assert np.abs(gap).max() < (1e-8 if release else 1e-3)*np.abs(back).max()


def test_half_of_a_block_bears_half_of_the_force(core):
    """Trimmed along a line of the mesh and pressed on by another tool."""
    x, cells = grid("CPE4I")
    scene = lopin.Deck.parse(deck("CPE4I", x, cells, 5.0, -1.0, mu=0.0).text().replace(
        "FLOOR, 1, 2", "FLOOR, 2"), name="block")
    force = []
    for trim in (None, beyond_plane((3.0, 0.0), (1.0, 0.0))):
        second, carried, _ = after(scene, SECOND.format(level=4.0, travel=-1.0), trim=trim)
        force.append(lopin.run(second).history["PUNCH.rf2"][-1])
    assert carried.gone_volume == pytest.approx(carried.volume, rel=1e-12)
    assert force[1] == pytest.approx(0.5*force[0], rel=1e-6)


def test_what_does_not_go_along_is_refused(core):
    x, cells = grid("CAX4")
    scene = deck("CAX4", x, cells, 5.0, -0.2)
    with pytest.raises(ModelError, match="all elements"):
        after(scene, FREE, trim=lambda places: places[:, 0] > -1.0)
    with lopin.open(scene) as job:
        job.advance()
        with pytest.raises(ModelError, match="NOBODY"):
            next_on_same_mesh(job, "NOBODY", FREE, name="second")
    warm = lopin.Deck.parse(scene.text().replace("*ELASTIC", "*EXPANSION\n1e-5\n*ELASTIC"),
                            name="warm")
    with pytest.raises(ModelError, match="EXPANSION"):
        after(warm, FREE)
    elastic = deck("CAX4", x, cells, 5.0, -0.2, law="")
    with pytest.raises(ModelError, match="remembers nothing"):
        after(elastic, FREE)


@pytest.mark.parametrize("law, start", [
    ("*PLASTIC, HARDENING=COMBINED, DATA TYPE=PARAMETERS\n200., 2000., 15.\n"
     "*CYCLIC HARDENING, PARAMETERS\n200., 80., 5.", ""),
    (HEAT, "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nALL, 400.\n")])
def test_all_of_the_material_goes_along(law, start, core):
    """Pressed by 1 and by 1 again as by 2 at once."""
    x, cells = grid("CAX4")

    def scene(travel):
        text = deck("CAX4", x, cells, 5.0, travel, law=law, mu=0.0, increments=10).text()
        return lopin.Deck.parse(text.replace("FLOOR, 1, 2", "FLOOR, 2").replace(
            "*STEP", start + "*STEP"), name="block")

    second, _, _ = after(scene(-1.0), SECOND.format(level=4.0, travel=-1.0))
    assert lopin.run(second).history["PUNCH.rf2"][-1] == pytest.approx(
        lopin.run(scene(-2.0)).history["DIE.rf2"][-1], rel=1e-6)
