"""The patch test against meshes that do not match, surface to surface: every element as slave,
straight and turned, both paths, all four methods, and a limited shear whose moment the sides
balance."""
import lopin
import numpy as np
import pytest
from mesh_patches import RATIOS, errors, patch_deck
from tool_patches import is_solid
from test_verification_tools import BOTH, WORDS

CASE = "B7 patch test between meshes, surface to surface: "
PLANE = [w for w in WORDS if not (is_solid(w) or w.startswith("CAX"))]
#: What all ratios are solved for on both paths here; the others take turns.
CHOSEN = ("CPE4", "CPE8")


@pytest.fixture
def run(core):
    """In memory: with all digits."""
    return lopin.run


def compare(run, sheet, word, path, ratio):
    result = run(patch_deck(word, path, ratio))
    worst = errors(result, word, path, ratio).max(axis=1)
    for value, what in zip(worst, ("pressure of a node", "normal force",
                                   "force of the limited shear")):
        sheet.compare(CASE + (path.lower() or "condensed") + " path",
                      f"{word}, {ratio}, 4 methods, straight and turned: {what}", value, 0.0, 1e-8,
                      "equilibrium", absolute=True)
    assert np.isfinite(worst).all()


@pytest.mark.parametrize("ratio", RATIOS)
@pytest.mark.parametrize("path", ["", "FINITE"])
@pytest.mark.parametrize("word", CHOSEN)
def test_all_ratios(run, sheet, word, path, ratio):
    compare(run, sheet, word, path, ratio)


@pytest.mark.parametrize("word, path", [b for b in BOTH if b[0] in PLANE and b[0] not in CHOSEN])
def test_every_plane_element(run, sheet, word, path):
    compare(run, sheet, word, path, "4:7")


@pytest.mark.parametrize("word", [w for w, path in BOTH if is_solid(w) and not path])
def test_every_solid_element(run, sheet, word):
    compare(run, sheet, word, "", "3:4")


@pytest.mark.parametrize("word", ["C3D4", "C3D8", "C3D10"])
def test_solid_words_on_the_finite_path(run, sheet, word):
    result = run(patch_deck(word, "FINITE", "1:1", methods=("DIRECT",)))
    worst = errors(result, word, "FINITE", "1:1", ("DIRECT",)).max(axis=1)
    for value, what in zip(worst, ("pressure", "normal force", "limited shear")):
        sheet.compare(CASE + "finite path", f"{word}, 1:1, straight and turned: {what}", value, 0.0,
                      1e-8, "equilibrium", absolute=True)
