"""What harms a run with new meshes is told by name, before the run where the deck says it; a
mesher that fails loses nothing."""
import builtins
import json
import shutil
import sys

import numpy as np
import pytest
from test_remeshing import block, history, run

import lopin
from lopin.remesh import planar, plane, remake

CARD = "*REMESH, ELSET=B, PERIOD=.2, STRAIN=10."
HOT = "*PLASTIC\n200., 0., 0.\n600., 2., 0.\n50., 0., 100.\n100., 2., 100."
STEP = "*STEP, NLGEOM"


def with_card(more):
    return (CARD, CARD + ", " + more)


def before_step(lines):
    return (STEP, f"{lines}\n{STEP}")


@pytest.mark.parametrize("change, code, name", [
    (with_card("SIZE=-1."), "E0106", "SIZE"), (with_card("HAUSDORFF=-1."), "E0106", "HAUSDORFF"),
    (with_card("SIZE=1., SMALLEST=2."), "E0106", "SMALLEST"),
    (with_card("SMALLEST=20."), "E0106", "SMALLEST"),
    (with_card("GROWTH=.5"), "E0106", "GROWTH"), (with_card("GROWTH=1."), "E0106", "GROWTH"),
    (with_card("QUALITY=2."), "E0106", "QUALITY"), (with_card("MOST=-3"), "E0106", "MOST"),
    ((CARD, "*REMESH, ELSET=B, PERIOD=-.2"), "E0106", "PERIOD"),
    ((CARD, "*REMESH, ELSET=B, STRAIN=0."), "E0106", "STRAIN"),
    ((STEP, "*STEP, NLGEOM=NO"), "E0621", "finite strain"),
    (("INTERACTION=I\nSKIN", "INTERACTION=I, SMALL SLIDING\nSKIN"), "E0621", "SMALL SLIDING"),
    (before_step("*CLEARANCE, MASTER=DIE, SLAVE=SKIN, VALUE=.3"), "E0621", "CLEARANCE"),
    (before_step("*EQUATION\n2\n25, 1, 1., 24, 1, -1."), "E0621", "EQUATION acts on 25"),
    (before_step("*NSET, NSET=E1\n25\n*NSET, NSET=E2\n24\n*EQUATION\n2\nE1, 1, 1., E2, 1, -1."),
     "E0621", "EQUATION acts on E1"),
    (("*END STEP", "*EL PRINT, ELSET=PART\nS\n*END STEP"), "E0621", "element set PART"),
    (before_step("*INITIAL CONDITIONS, TYPE=TEMPERATURE\nFLOOR, 20."), "E0621", "temperature"),
    (("TYPE=CAX4", "TYPE=CPS4"), "E0621", "CPS4"), (("*REMESH, ELSET=B,", "*REMESH,"), "E01", ""),
])
def test_decks_that_a_new_mesh_would_spoil_are_refused_by_name(change, code, name, core, tmp_path):
    text = block("CAX4").text()
    if "PART" in change[1]:
        text = text.replace("*SOLID SECTION", "*ELSET, ELSET=PART\n1, 2\n*SOLID SECTION")
    assert change[0] in text
    with pytest.raises(lopin.LopinError) as caught:
        run(lopin.Deck.parse(text.replace(*change), name="block"), tmp_path)
    assert code in str(caught.value) and name in str(caught.value)
    assert not list(tmp_path.glob("*.p002.inp"))


def test_the_temperature_of_the_start_goes_along(core, tmp_path):
    """Flow curves of two temperatures: every part has the one that the deck gives."""
    text = block("CAX4").text().replace("*PLASTIC\n200., 0.\n300., .5\n600., 2.", HOT)
    text = text.replace(*before_step("*INITIAL CONDITIONS, TYPE=TEMPERATURE\nALL, 50."))
    force = []
    for most in (0, 50):
        folder = tmp_path/str(most)
        report = run(lopin.Deck.parse(text.replace(*with_card(f"MOST={most}")), name="block"),
                     folder)
        assert len(report.remeshes) == (4 if most else 0)
        force.append(history(folder, "block")["DIE.rf2"][-1])
    assert force[1] == pytest.approx(force[0], rel=1e-7)


@pytest.mark.parametrize("words", ["1., 0., 0., 0., 1., 0.", "1, 0, 0, 0, 1, 0"])
def test_axes_of_a_set_are_no_labels_of_nodes(words, core, tmp_path):
    text = block("CAX4").text().replace(*before_step(f"*TRANSFORM, NSET=FLOOR\n{words}"))
    assert len(run(lopin.Deck.parse(text, name="block"), tmp_path).remeshes) == 4


def without_tag(made, name):
    """A mesh whose facets do not have a name any more."""
    mesh, *rest = made
    mesh.tags = [tag - {name} for tag in mesh.tags]
    return mesh, *rest


def half_of_it(made, name):
    """A mesh that has lost half of the facets of a name."""
    mesh, *rest = made
    own = [k for k, tag in enumerate(mesh.tags) if name in tag]
    for k in own[::2]:
        mesh.tags[k] = mesh.tags[k] - {name}
    return mesh, *rest


def broken(fault, patch):
    """Make the mesher fail in one way, from its second call on."""
    calls = []

    def later(real, change):
        def act(*given, **named):
            calls.append(1)
            made = real(*given, **named)
            return change(made) if len(calls) > 1 else made
        return act

    def fail(made):
        raise Exception("could not recover boundary mesh")

    def turned(made):
        x, cells = made
        x = x.copy()
        x[-1] = [40.0, 40.0]
        return x, cells

    if fault == "fails":
        patch.setattr(plane, "_read", later(plane._read, fail))
    elif fault == "inverts":
        patch.setattr(planar, "fill", later(planar.fill, turned))
    elif fault == "missing":
        real = builtins.__import__

        def without_gmsh(name, *rest):
            if name == "gmsh":
                raise ModuleNotFoundError("No module named 'gmsh'")
            return real(name, *rest)

        patch.setattr(plane, "optional", later(plane.optional, lambda made: made))
        patch.setattr(builtins, "__import__", without_gmsh)
        import importlib
        load = importlib.import_module
        patch.setattr(importlib, "import_module", lambda name, *rest: without_gmsh(name)
                      if name == "gmsh" else load(name, *rest))
    elif fault == "loses":
        patch.setattr(remake, "remesh_plane", later(remake.remesh_plane, lambda made: without_tag(
            made, ("N", "FLOOR"))))
    else:
        patch.setattr(remake, "remesh_plane", later(remake.remesh_plane, lambda made: half_of_it(
            made, ("N", "FLOOR"))))


@pytest.mark.parametrize("fault, code, word", [
    ("fails", "E0621", "could not recover"), ("inverts", "E0621", "turned over"),
    ("missing", "", "gmsh"), ("loses", "E0621", "node set FLOOR"),
    ("loses half", "E0621", "FLOOR holds")])
def test_a_mesher_that_fails_is_named_and_nothing_is_lost(fault, code, word, whole, core,
                                                          tmp_path, monkeypatch):
    """The run goes on to the same bits once the mesher is well again."""
    scene, folder, _ = whole
    with monkeypatch.context() as patch:
        broken(fault, patch)
        with pytest.raises(lopin.LopinError) as caught:
            run(scene, tmp_path/"harmed")
        assert code in str(caught.value) and word in str(caught.value)
    report = run(scene, tmp_path/"harmed", resume=True)
    assert len(report.remeshes) == 2
    found, expected = (history(own, "block")["DIE.rf2"] for own in (tmp_path/"harmed", folder))
    assert np.array_equal(found, expected)


def test_parts_of_another_deck_are_not_gone_on_with(core, tmp_path):
    run(block("CAX4", travel=-1.0), tmp_path)
    with pytest.raises(lopin.LopinError, match="E0604"):
        run(block("CAX4", travel=-1.1), tmp_path, resume=True)


@pytest.mark.parametrize("line, code", [("900, 1", "E02"), ("1, 9", "E0210"), ("1, 1", "E0210")])
def test_a_state_of_another_deck_is_refused(line, code, core):
    """An element that is not there, a point that is not, one point of four alone."""
    text = block("CAX4").text().replace(CARD, "*INITIAL CONDITIONS, TYPE=STATE\n" + line
                                        + ", 0., 0., 0., 0., 0., 0., 0., 0., .1")
    with pytest.raises(lopin.LopinError, match=code):
        lopin.run(lopin.Deck.parse(text, name="state"))


@pytest.mark.parametrize("word", ["CAX4", "C3D4"])
def test_metres_give_what_millimetres_do(word, core, tmp_path):
    """Lengths by a thousandth, forces in newtons: the same residuals, meshes and forces to the end.
    Neither moments beside forces nor the last bits of places decide anything."""
    if word == "C3D4":
        pytest.importorskip("mmgpy")
    size = {"CAX4": "SIZE=.9, SMALLEST=.3, PERIOD=.2",
            "C3D4": "SIZE=1.5, SMALLEST=1., PERIOD=.3"}[word]
    card = f"{size}, STRAIN=10."
    scene = block(word, card=card, travel=-1.5 if word == "CAX4" else -0.8, mu=0.1,
                  increments=10 if word == "CAX4" else 8)
    run(scene, tmp_path/"mm")
    report = run(in_metres(scene), tmp_path/"m")
    mm, m = (history(tmp_path/name, "block") for name in ("mm", "m"))
    one, other = (json.loads((tmp_path/name/"block.parts.json").read_text())["remeshes"]
                  for name in ("mm", "m"))
    assert len(report.remeshes) >= 2
    for a, b in zip(one, other, strict=True):
        assert a["time"] == pytest.approx(b["time"], rel=1e-9) and a["elements"] == b["elements"]
        assert a["worst_corner"] == pytest.approx(b["worst_corner"], rel=1e-6)
    axis = "DIE.rf2"
    assert m[axis] == pytest.approx(mm[axis], rel=1e-6, abs=1e-6*abs(mm[axis]).max())
    assert m["volume"][-1] == pytest.approx(1e-9*mm["volume"][-1], rel=1e-6)
    one, other = (residuals(tmp_path/name/"block.p001.cvg") for name in ("mm", "m"))
    assert len(one) > 10 and other == pytest.approx(one, rel=1e-3, abs=1e-8)


def residuals(path):
    """What is out of balance in every iteration, beside the largest force."""
    rows = [line.split() for line in path.read_text(encoding="utf-8").splitlines()]
    return np.array([float(row[1]) for row in rows if len(row) > 8 and row[0].isdigit()])


def in_metres(scene):
    """The block in metres and pascals."""
    deck = lopin.Deck.parse(scene.text(), name="block")
    for b in deck.blocks:
        rows = b.data
        if b.keyword == "NODE":
            for row in rows:
                row[1:] = [1e-3*float(v) for v in row[1:]]
        elif b.keyword == "SURFACE" and b.parameters.get("TYPE") == "SEGMENTS":
            for row in rows:
                row[1:] = [1e-3*float(v) for v in row[1:]]
        elif b.keyword == "SURFACE" and b.parameters.get("TYPE") == "CYLINDER":
            for row in rows[2:]:
                row[1:] = [1e-3*float(v) for v in row[1:]]
        elif b.keyword in ("ELASTIC", "PLASTIC"):
            for row in rows:
                row[0] = 1e6*float(row[0])
        elif b.keyword == "REMESH":
            for name in ("SIZE", "SMALLEST"):
                b.parameters[name] = repr(1e-3*float(b.parameters[name]))
        elif b.keyword == "BOUNDARY":
            for row in rows:
                row[3:] = [1e-3*float(v) for v in row[3:]]
    return deck


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """A run in three parts, and its history."""
    folder = tmp_path_factory.mktemp("whole")
    scene = block("CAX4", travel=-1.0, card="PERIOD=.4, STRAIN=10.")
    run(scene, folder)
    return scene, folder, (folder/"block_history.csv").read_text()


@pytest.mark.parametrize("gone", ["block.p002_history.csv", "block.p002.inp", "block.p003*",
                                  "block.p002_*.vtu"])
def test_what_is_missing_of_a_part_is_made_again(gone, whole, tmp_path):
    """Rows of a part whose history was gone were left out, and a part without a deck, silently."""
    scene, folder, expected = whole
    again = tmp_path/"again"
    shutil.copytree(folder, again)
    for path in list(again.glob(gone)):
        path.unlink()
    report = run(scene, again, resume=True)
    assert (again/"block_history.csv").read_text() == expected and len(report.remeshes) == 2
    assert {path.name for path in again.iterdir()} == {path.name for path in folder.iterdir()}


@pytest.mark.parametrize("harm", [
    lambda lines: lines[:1], lambda lines: lines[:2] + lines[3:], lambda lines: [*lines[:-1], lines[-1][:40]]],
    ids=["head alone", "a row", "half a row"])
def test_a_history_of_a_part_that_was_cut_is_made_again(harm, whole, tmp_path):
    """Its rows were left out with PASS, or read as those of another step."""
    scene, folder, expected = whole
    again = tmp_path/"again"
    shutil.copytree(folder, again)
    cut = again/"block.p002_history.csv"
    cut.write_text("".join(harm(cut.read_text().splitlines(keepends=True))))
    run(scene, again, resume=True)
    assert (again/"block_history.csv").read_text() == expected


def test_parts_of_another_card_and_damaged_decks_of_parts_are_refused(whole, tmp_path):
    scene, folder, _ = whole
    again = tmp_path/"again"
    shutil.copytree(folder, again)
    other = block("CAX4", travel=-1.0, card="PERIOD=.4, STRAIN=10., SIZE=2.")
    with pytest.raises(lopin.ResourceError, match=r"of another deck: its \*REMESH differs"):
        run(other, again, resume=True)
    summary = again/"block.p002.json"
    kept = summary.read_text()
    summary.unlink()
    with pytest.raises(lopin.ResourceError, match="was not written by Lopin"):
        run(scene, again, resume=True)
    summary.write_text(kept)
    deck = again/"block.p002.inp"
    text = deck.read_text()
    deck.write_text(text[:2000])
    with pytest.raises(lopin.ResourceError, match="is damaged: it has no end"):
        run(scene, again, resume=True)
    head, start = text.split("*START")
    deck.write_text(f"{head}*START{start.replace('0.', '1.', 1)}")
    with pytest.raises(lopin.ResourceError, match="is not as it was written"):
        run(scene, again, resume=True)
    deck.write_text(text)
    listed = again/"block.parts.json"
    known = json.loads(listed.read_text())
    listed.write_text(json.dumps({**known, "sums": {}}))
    with pytest.raises(lopin.ResourceError, match="has no sum of 'block.p002.inp'"):
        run(scene, again, resume=True)
    listed.unlink()
    with pytest.raises(lopin.ResourceError, match="not known without 'block.parts.json'"):
        run(scene, again, resume=True)


@pytest.mark.parametrize("harm, said", [
    (lambda x, c: (np.full_like(x, np.nan), c), "places that are no numbers"),
    (lambda x, c: (x, []), "gives no cells"), (lambda x, c: (x, [c[0][1:], *c[1:]]), "leaves a hole")])
def test_a_mesher_that_fails_without_a_word_is_named(harm, said, tmp_path, monkeypatch):
    fill = planar.fill
    monkeypatch.setattr(planar, "fill", lambda *given: harm(*fill(*given)))
    with pytest.raises(lopin.ModelError, match=said):
        run(block("CAX4", travel=-0.5, card="PERIOD=.3, STRAIN=10."), tmp_path)


@pytest.mark.parametrize("package, word", [("gmsh", "CAX4"), ("gmsh", "CPE3"), ("mmgpy", "C3D4"),
                                           ("scipy", "CAX4"), ("scipy", "C3D4")])
def test_a_missing_mesher_is_told_before_the_run(package, word, core, tmp_path, monkeypatch):
    """With the extra that brings all of them; decks that make no mesh need none."""
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(lopin.MissingPackageError,
                       match=rf"(?s)E0620: new meshes need {package}\n.*lopin\[remesh\]"):
        run(block(word), tmp_path/"no")
    assert not (tmp_path/"no").exists()
    run(block(word, card="MOST=0", travel=-0.1, increments=2), tmp_path/"none")


@pytest.mark.parametrize("word, instead", [
    ("C3D8", "in space take C3D4"), ("C3D8I", "in space take C3D4"), ("CPS4", "take CPE4 or CPE3"),
    ("CPS3", "plane stress"), ("CAX4I", "take CAX4 or CAX3"), ("CPE4I", "take CPE4 or CPE3")])
def test_elements_that_no_new_mesh_is_made_of_are_told_what_to_take(word, instead, core, tmp_path):
    like = "C3D8" if word.startswith("C3D") else {"3": "CPE3"}.get(word[3], "CPE4")
    text = block(like).text().replace(f"TYPE={like}", f"TYPE={word}")
    with pytest.raises(lopin.ModelError, match=f"(?s)E0621.*not of {word}.*help: .*{instead}"):
        run(lopin.Deck.parse(text, name="block"), tmp_path)
