"""Work that a mesh adds is told: elements that lock where a beam bends, and coarse ones (W0565)."""
import re

import pytest

from lopin import Elastic, Material, Plastic, mesh_make
from lopin.deck import Deck
from lopin.model import Model

#: Words whose strains follow a bend, and words that add to its work.
RIGHT = ["CPE4I", "CPS4I", "CPE6", "CPE8", "CPE8R", "C3D8I", "C3D10", "C3D20", "CSS8"]
LOCKED = ["CPE4", "CPS4", "CPE3", "C3D8", "C3D4"]
CELLS = {"CPE4R": "CPE4", "CPE4I": "CPE4", "CAX4I": "CAX4", "CPS4I": "CPS4", "CPE8R": "CPE8", "CAX8R": "CAX8",
         "C3D8I": "C3D8", "CSS8": "C3D8"}


def cantilever(word, layers, length=20.0, cells=20, law=None, nlgeom=False, scale=1.0, way=0.005):
    """Clamped at one end, the other moved across by `way` of its length."""
    solid = word.startswith("C3D") or word == "CSS8"
    size = (length, 1.0, 1.0) if solid else (length, 1.0)
    mesh = mesh_make.block([scale*x for x in size],
                           (cells, 1, layers) if solid else (cells, layers))
    mesh.points[:, 0] += 5.0*word.startswith("CAX")
    if word in ("CPE3", "CPS3", "CAX3", "CPE6", "C3D4", "C3D10"):
        mesh = mesh_make.simplices(mesh)
    if word.rstrip("R") in ("CPE6", "CPE8", "CAX8", "C3D10", "C3D20"):
        mesh = mesh.quadratic()
    model = Model("beam", mesh, kind="3d" if solid else
                  "plane stress" if word.startswith("CPS") else
                  "axisymmetric" if word.startswith("CAX") else "plane strain")
    model.section("ALL", law or Elastic(2e5/scale**2, 0.0))
    axes = "xyz" if solid else "rz" if word.startswith("CAX") else "xy"
    model.fix("LEFT", *axes)
    model.step(nlgeom=nlgeom).move("RIGHT", **{axes[-1]: -way*length*scale})
    base = CELLS.get(word, word)
    return Deck.parse(re.sub(rf"TYPE={base}\b", f"TYPE={word}", model.to_deck().text()), "beam")


def work(result):
    energy = result.summary["energy"]
    return energy["strain"] + energy["plastic"]


def told(result):
    texts = [m["message"] for m in result.diagnostics if m["code"][1:] == "0565"]
    return 0.01*float(re.search(r"about ([\d.]+) %", texts[0]).group(1)) if texts else 0.0


def exact(length=20.0):
    """Of the beam, without shear, whose share is below a hundredth."""
    return 0.5*(0.005*length)**2*3.0*2e5/12.0/length**3


@pytest.mark.parametrize("layers", [1, 2, 4])
@pytest.mark.parametrize("word", LOCKED)
def test_words_that_lock_are_told(solve, word, layers):
    """What is too much beside all work, within a half, is the figure; of one layer of B-bar
    elements more."""
    result = solve(cantilever(word, layers))
    excess = 1.0 - exact()/work(result)
    assert excess > 0.05
    assert 0.9*excess < told(result) < (1.5*excess if layers > 1 else max(0.45, 1.4*excess))


@pytest.mark.parametrize("word", RIGHT)
def test_words_that_bend_are_not(solve, word):
    for layers in (1, 2):
        result = solve(cantilever(word, layers))
        assert work(result) == pytest.approx(exact(), rel=0.01) and not told(result)


@pytest.mark.parametrize("word", ["CPE4", "CPE3"])
def test_a_fine_mesh_is_not(solve, word):
    result = solve(cantilever(word, 16, 5.0, 80))
    assert not told(result)


@pytest.mark.parametrize("nlgeom", [False, True])
@pytest.mark.parametrize("scale", [1e-3, 1e3])
def test_it_is_told_in_all_units(solve, scale, nlgeom):
    figures = [told(solve(cantilever("CPE4", 2, nlgeom=nlgeom, scale=s))) for s in (1.0, scale)]
    assert figures[1] == pytest.approx(figures[0], rel=0.02) and figures[0] > 0.3


@pytest.mark.parametrize("word, least", [("CPE4", 0.05), ("CPE3", 0.3), ("CPE4I", None)])
def test_metal_is_told_as_well(solve, word, least):
    law = Material(Elastic(2e5, 0.3), Plastic([(200.0, 0.0), (700.0, 1.0)]))
    found = told(solve(cantilever(word, 2, 10.0, law=law, nlgeom=True)))
    assert found > least if least else not found


@pytest.mark.parametrize("word, excess", [("CPS4", True), ("CPE4", True), ("C3D8", True),
                                          ("CPS4I", False), ("CPE8", False), ("C3D8I", False)])
def test_a_bend_by_heat_that_locks_is_told(solve, word, excess):
    """A strip warm below and cold above becomes an arc without stress (but across plane strain);
    locked words reach a third of it."""
    text = cantilever(word, 2, law=Material(Elastic(2e5, 0.0), name="M", expansion=1e-5)).text()
    blocks = Deck.parse(text, "beam").blocks
    rows = [row for block in blocks if block.keyword == "NODE" for row in block.data]
    height = 3 if word.startswith("C3D") else 2
    foot = [int(row[0]) for row in rows if row[1] == 0.0 and row[2] in (0.0, 1.0)
            and row[height] == 0.0]
    held = f"*BOUNDARY\nLEFT, 1\n{foot[0]}, 2, {height}\n" + f"{foot[-1]}, {height}\n"*(height - 2)
    warm = "".join(f"{int(row[0])}, {100.0*(0.5 - row[height])!r}\n" for row in rows)
    cold = "".join(f"{int(row[0])}, 0.\n" for row in rows)
    text = (text[:text.index("*BOUNDARY")] + held + "*INITIAL CONDITIONS, TYPE=TEMPERATURE\n" + cold
            + "*STEP\n*STATIC\n*TEMPERATURE\n" + warm + "*END STEP\n")
    result = solve(Deck.parse(text, "heated"))
    assert (told(result) > 0.2) == excess


def ideal():
    """Metal that does not harden to speak of."""
    return Material(Elastic(2e5, 0.3), Plastic([(200.0, 0.0), (201.0, 1.0)]))


@pytest.mark.parametrize("word, right, too", [
    ("CPE4", "CPE4I", "small"), ("CPE4R", "CPE4I", "small"), ("C3D8", "C3D8I", "small"),
    ("CAX4", "CAX4I", "small"), ("CPS4", "CPS4I", "large")])
def test_metal_that_bends_in_one_layer_is_told(solve, word, right, too):
    """Two points with one mean dilatation carry two thirds of a plastic moment; without a word until
    now, or "too high"."""
    results = [solve(cantilever(w, 1, 10.0, law=ideal(), nlgeom=True, way=0.06))
               for w in (word, right)]
    texts = [m["message"] for m in results[0].diagnostics if m["code"] == "W0566"]
    assert len(texts) == 1 and texts[0].endswith("too "+too) and not told(results[0])
    share = work(results[0])/work(results[1])
    assert share < 0.9 if too == "small" else share > 1.05
    assert not any(m["code"] == "W0566" for m in results[1].diagnostics)


@pytest.mark.parametrize("word", ["CPE4", "C3D8"])
def test_one_layer_that_is_stretched_is_not(solve, word):
    deck = cantilever(word, 1, 10.0, law=ideal(), nlgeom=True, way=0.06)
    axis = "3" if word == "C3D8" else "2"
    text = deck.text().replace(f"RIGHT, {axis}, {axis}, -0.6", "RIGHT, 1, 1, 0.6")
    assert text != deck.text()
    result = solve(Deck.parse(text, "stretched"))
    assert not any(m["code"][1:] in ("0565", "0566") for m in result.diagnostics)


@pytest.mark.parametrize("word, layers", [("CPE3", 2), ("CPE4", 3), ("C3D4", 1), ("CAX3", 2)])
def test_metal_that_does_not_harden_is_told(solve, word, layers):
    """Its work is along its strains but for what is elastic; rings by radian were taken for whole
    ones."""
    found, right = (solve(cantilever(w, n, 10.0, cells, ideal(), True, way=0.06))
                    for w, n, cells in ((word, layers, 20),
                                        ("CAX8R" if word == "CAX3" else "CPE8R", 3, 40)))
    excess = 1.0 - work(right)/work(found)
    assert excess > 0.05
    assert 0.6*excess < told(found) < 3.5*excess
