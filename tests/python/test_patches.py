"""Meshes of linear simplices and of elements with I under plastic flow, beside quads and bricks."""
import subprocess

import numpy as np
import pytest

import lopin
from lopin import mesh_make


def lines(values):
    return "\n".join(", ".join(map(repr, row)) for row in values)


def deck(mesh, word, stroke, *, flow=True, poisson=0.3, controls="", increments=5):
    """A block pressed between rough plates, plastic unless told."""
    last = mesh.ndim - 1
    height = mesh.points[:, last]
    text = ["*NODE", lines([i + 1, *map(float, p)] for i, p in enumerate(mesh.points)),
            f"*ELEMENT, TYPE={word}, ELSET=ALL",
            lines([i + 1, *(int(n) + 1 for n in c)] for i, c in enumerate(mesh.blocks[0][1]))]
    for name, mask in (("BOTTOM", height < 1e-9), ("TOP", height > height.max() - 1e-9),
                       ("MIDDLE", mesh.points[:, 0] < 1e-9)):
        text += [f"*NSET, NSET={name}", lines([i + 1] for i in map(int, np.flatnonzero(mask)))]
    text += ["*MATERIAL, NAME=STEEL", "*ELASTIC", f"210000., {poisson}"]
    text += ["*PLASTIC", "300., 0.", "500., 1."] if flow else []
    text += [f"*SOLID SECTION, ELSET=ALL, MATERIAL=STEEL{controls}", "1.", "*BOUNDARY",
             f"BOTTOM, 1, {mesh.ndim}", "MIDDLE, 1, 1", f"TOP, 1, {last}",
             "*STEP, NLGEOM, INC=200", "*STATIC", f"{1.0/increments}, 1.", "*BOUNDARY",
             f"TOP, {mesh.ndim}, {mesh.ndim}, {stroke*height.max()}", "*NODE FILE", "U, RF",
             "*EL FILE", "S", "*END STEP"]
    return "\n".join(text)


def force(folder, mesh, word, stroke, **options):
    path = folder / f"{word}.inp"
    path.write_text(deck(mesh, word, stroke, **options))
    height = mesh.points[:, -1]
    return lopin.run(path).at(-1)["RF"][height > height.max() - 1e-9, -1].sum()


@pytest.mark.parametrize("cells, tolerance", [(6, 0.06), (12, 0.02)])
def test_triangles_upset_as_quads_do(tmp_path, cells, tolerance):
    # 24 x 24 CPE4: 793.2, CPE3: 792.4. Finer quads than 6 x 6 turn inside out at the edges of the
    # plates, and are refused for it.
    quads = mesh_make.block((1.0, 1.0), (cells, cells))
    assert force(tmp_path, mesh_make.simplices(quads), "CPE3", -0.2) == pytest.approx(
        -793.2, rel=tolerance)


def test_words_with_i_converge_to_the_same_force(tmp_path):
    # 24 x 24 CPE4: 793.2, CPE3: 792.4
    quads = mesh_make.block((1.0, 1.0), (12, 12))
    assert force(tmp_path, quads, "CPE4I", -0.2) == pytest.approx(-793.0, rel=0.03)


@pytest.mark.parametrize("cells, tolerance", [(2, 0.06), (3, 0.015)])
def test_quadratic_quads_upset_as_linear_ones_do(tmp_path, cells, tolerance):
    # 24 x 24 CPE4: 793.2; with FORMULATION=FULL 1402 (2 x 2) and 1082 (3 x 3)
    quads = mesh_make.block((1.0, 1.0), (cells, cells), quadratic=True)
    assert force(tmp_path, quads, "CPE8", -0.2) == pytest.approx(-793.0, rel=tolerance)


def bent(folder, word, size, cells, stroke):
    """A cantilever whose tip goes sideways, plastic from the root: force, number of increments."""
    mesh = mesh_make.block(size, cells)
    x, last = mesh.points, mesh.ndim
    text = deck(mesh, word, 0.0, increments=10).split("*NSET, NSET=BOTTOM")[0].splitlines()
    for name, mask in (("ROOT", x[:, 0] < 1e-9), ("TIP", x[:, 0] > size[0] - 1e-9)):
        text += [f"*NSET, NSET={name}", lines([i + 1] for i in map(int, np.flatnonzero(mask)))]
    text += ["*MATERIAL, NAME=STEEL", "*ELASTIC", "210000., 0.3", "*PLASTIC", "300., 0.",
             "500., 1.",
             "*SOLID SECTION, ELSET=ALL, MATERIAL=STEEL", "1.", "*BOUNDARY", f"ROOT, 1, {last}",
             "*STEP, NLGEOM, INC=200", "*STATIC", "0.1, 1.", "*BOUNDARY",
             f"TIP, {last}, {last}, {stroke}", "*NODE FILE", "U, RF", "*END STEP"]
    (folder / "bent.inp").write_text("\n".join(text))
    results = lopin.run(folder / "bent.inp")
    return results.at(-1)["RF"][x[:, 0] > size[0] - 1e-9, last - 1].sum(), len(results.times)


def test_one_layer_with_i_bends_as_four_do(tmp_path):
    # One layer of CPE4I took 96 increments before its modes were searched along a line.
    one, increments = bent(tmp_path, "CPE4I", (100.0, 1.0), (20, 1), -50.0)
    four, _ = bent(tmp_path, "CPE4I", (100.0, 1.0), (40, 4), -50.0)
    assert increments <= 24
    assert one == pytest.approx(four, rel=0.05)


def test_bricks_with_i_bend_plastically(tmp_path):
    four, _ = bent(tmp_path, "C3D8I", (20.0, 1.0, 1.0), (20, 2, 2), -2.0)
    brick, increments = bent(tmp_path, "C3D8I", (20.0, 1.0, 1.0), (20, 1, 1), -2.0)
    assert increments <= 24
    assert brick == pytest.approx(four, rel=0.06)


@pytest.mark.parametrize("word, poisson, flow, controls, code", [
    ("CPE4", 0.499, False, ", CONTROLS=PLAIN", "warning[W0211]"),
    ("CPE4", 0.3, True, ", CONTROLS=PLAIN", "warning[W0211]"),
    ("CPE3", 0.499, False, "", "note[N0211]"), ("CPE3", 0.3, False, "", ""),
    ("CPE4", 0.499, False, "", ""), ("CPE8", 0.499, False, "", "note[N0212]"),
    ("CPE8", 0.3, True, "", "note[N0212]"), ("CPE8", 0.3, False, "", ""),
    ("CPE8R", 0.499, False, "", ""), ("CPE8R", 0.499, False, ", CONTROLS=PLAIN", "warning[W0211]"),
    ("CPE6", 0.499, False, ", CONTROLS=PLAIN", "")])
def test_elements_that_lock_are_named(executable, tmp_path, word, poisson, flow, controls, code):
    mesh = mesh_make.block((1.0, 1.0), (2, 2))
    mesh = mesh_make.simplices(mesh) if word in ("CPE3", "CPE6") else mesh
    mesh = mesh.quadratic() if word in ("CPE8", "CPE8R", "CPE6") else mesh
    text = deck(mesh, word, -0.01, flow=flow, poisson=poisson, controls=controls)
    (tmp_path / "locks.inp").write_text(
        "*SECTION CONTROLS, NAME=PLAIN, FORMULATION=FULL\n" + text)
    run = subprocess.run([executable, "check", "locks.inp"], capture_output=True, text=True,
                         timeout=20, cwd=tmp_path)
    assert run.returncode == 0, run.stderr
    assert code in run.stderr if code else "021" not in run.stderr
