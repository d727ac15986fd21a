"""Dies of irregular triangles: which they are tells little in the force of a forging."""
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2]/"decks"/"make"))
from feature_scene import run  # noqa: E402

pytest.importorskip("scipy")


def upset(executable, folder, **words):
    """A coarse bar of a cross, its rim in the edge of the cavity."""
    from die_forging import cross
    folder.mkdir()
    return run(executable, folder, cross(folder, (2, 6), 7.0, **words))


def test_force_is_that_of_other_triangles_and_of_a_grid(executable, tmp_path):
    found = {}
    for name, words in (("as made", {"deviation": 0.2}), ("shaken", {"deviation": 0.2, "seed": 1}),
                        ("grid", {"size": 1.5, "deviation": 0.2})):
        outcome = upset(executable, tmp_path/name.replace(" ", "_"), **words)
        assert outcome.code == 0, outcome.output
        assert len(outcome.history["time"]) < 60
        found[name] = float(outcome.history["UPPER.rf3"][-1])
    for force in found.values():
        assert force == pytest.approx(found["as made"], rel=0.01), found


def test_two_dies_press_alike(executable, tmp_path):
    outcome = upset(executable, tmp_path/"both", deviation=0.2, whole=True, method="PENALTY")
    assert outcome.code == 0, outcome.output
    upper, lower = (float(outcome.history[f"{die}.rf3"][-1]) for die in ("UPPER", "LOWER"))
    assert upper == pytest.approx(-lower, rel=1e-4)
