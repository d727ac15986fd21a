"""The patch test against plane tools: every element as slave, three orientations of the tool,
both paths, all four methods, and a limited shear whose moment the sides balance."""
import re
from pathlib import Path

import lopin
import pytest
from tool_patches import (
    bent,
    errors,
    free_deck,
    is_quadratic,
    is_solid,
    patch_deck,
    ring_deck,
    ring_errors,
    upset_deck,
)

SOURCE = Path(__file__).resolve().parents[2]/"fortran"/"element"/"element_type.f90"
LIST = re.search(r"element_words\(.*?\[(.*?)\]", SOURCE.read_text(encoding="utf-8"), re.DOTALL)[1]
WORDS = [word for word in re.findall(r"'(\w+)'", LIST) if not word.startswith("R")]
CASE = "B6 patch test on plane tools: "
#: Words that are read as another one (the Fortran tests compare the elements, see distinct_elements);
#: of their letters these are patched all the same, and all words are upset below.
TWICE = re.compile(r".*[HM]|C(PE|PS|AX)4R|C3D[68]R|C3D10I")
KEPT = ("CPE4RH", "CPE4IH", "CPE6MH", "CPS4R", "CPS6M", "CAX4H", "CAX6M", "C3D8R", "C3D6H")
#: An element each, by path: on the present shape plane stress has the faces of plane strain.
BOTH = [(word, path) for word in WORDS for path in ("", "FINITE")
        if not (TWICE.fullmatch(word) and (path or word not in KEPT))
        and not (path and word.startswith("CPS"))]
CURVED = ("C3D10", "C3D15", "C3D20", "C3D20R", "CPE6", "CPE8", "CPE8R", "CPS6", "CPS8R")


@pytest.fixture
def run(core):
    """In memory: with all digits."""
    return lopin.run


def test_the_list_of_words_is_found():
    assert {"C3D10", "C3D20R", "C3D15", "CAX8R", "CPS4I"} <= set(WORDS)


@pytest.mark.parametrize("word, path", [b for b in BOTH if not b[0].startswith("CAX")])
def test_a_uniform_pressure_comes_out_uniform(run, sheet, word, path):
    result = run(patch_deck(word, path, distorted=True))
    worst = errors(result, word).max(axis=1)
    for value, what in zip(worst, ("pressure of a node", "normal force", "force of the limited shear")):
        sheet.compare(CASE + (path.lower() or "condensed") + " path",
                      f"{word}, 4 methods, 3 orientations: {what}", value, 0.0, 1e-8,
                      "equilibrium", absolute=True)


@pytest.mark.parametrize("word, path", [b for b in BOTH if b[0].startswith("CAX")])
def test_a_uniform_pressure_on_the_axis(run, sheet, word, path):
    """Tools below, above and around; friction of a uniform bound has no closed form here."""
    for value, what in zip(ring_errors(run(ring_deck(word, path))), ("pressure of a node", "force")):
        sheet.compare(CASE + (path.lower() or "condensed") + " path",
                      f"{word}, 4 methods, tool below, above, around: {what}", value, 0.0, 1e-8,
                      "equilibrium", absolute=True)


@pytest.mark.parametrize("word, path", [b for b in BOTH if b[0] in CURVED])
def test_faces_with_curved_edges(run, sheet, word, path):
    assert is_quadratic(word)
    result = run(patch_deck(word, path, distorted=True, bend=bent(word)))
    for value, what in zip(errors(result, word).max(axis=1), ("pressure of a node", "normal force")):
        sheet.compare(CASE + (path.lower() or "condensed") + " path", f"{word}, curved edges: {what}",
                      value, 0.0, 1e-8, "equilibrium", absolute=True)


@pytest.mark.parametrize("path", ["", "FINITE"])
@pytest.mark.parametrize("word", ["C3D10", "C3D15", "C3D20R"])
def test_curved_edges_inside_a_block(run, word, path):
    """The elements by themselves, no contact: gradients have exact means."""
    stress = run(free_deck(word, path, bent(word)))["S"]
    assert stress[:, 2] == pytest.approx(-10.0, rel=1e-9)
    assert stress[:, [0, 1, 3, 4, 5]] == pytest.approx(0.0, abs=1e-8)


@pytest.mark.parametrize("path", ["", "FINITE"])
@pytest.mark.parametrize("word", ["CAX6", "CAX8", "CAX8R"])
def test_curved_edges_of_rings(run, word, path):
    """Without exact means over the volume pressures of CAX6 were 1.2e-2 and of CAX8R 6e-2 off."""
    assert ring_errors(run(ring_deck(word, path, bent(word)))) == pytest.approx(0.0, abs=1e-8)


@pytest.fixture(scope="module")
def forces():
    """Force of the first word of each stress state."""
    return {}


@pytest.mark.parametrize("word", [w for w in WORDS if not w.startswith("CPS")])
def test_homogeneous_upsetting_by_30_per_cent(run, sheet, forces, word):
    result = run(upset_deck(word))
    column = "TOOL.rf3" if is_solid(word) else "TOOL.rf2"
    force, pressure = abs(result.history[column][-1]), result.contact(0).last.pressure
    reference = forces.setdefault("C3D" if is_solid(word) else word[:3], force)
    # Of a solid and of a cylinder: the same stress on 4 and on 4 pi.
    if word.startswith("CAX") and "C3D" in forces:
        reference = forces["C3D"]*3.141592653589793
    sheet.compare("B7 upsetting by 30 %, homogeneous", f"{word}: force", force, reference, 1e-6,
                  "the first word of the stress state")
    assert pressure.max() == pytest.approx(pressure.min(), rel=1e-6)
