"""Strains of a sheet beside closed forms, and read against a limit curve."""
from types import SimpleNamespace

import numpy as np
import pytest

import lopin
from lopin import mesh_make
from lopin.__main__ import main
from lopin.forming_limit import read_curve, sheet_strains

CURVE = "-0.3, 0.6\n0.0, 0.3\n0.3, 0.4\n"


def sheet(cells=(4, 4, 1), size=(10.0, 10.0, 0.5)):
    mesh = mesh_make.block(size, cells)
    blocks = [SimpleNamespace(type=name, data=nodes) for name, nodes in mesh.blocks]
    return mesh.points, SimpleNamespace(points=mesh.points, cells=blocks)


@pytest.mark.parametrize("turned", [0.0, 0.7])
def test_stretches_in_the_plane_of_a_sheet(turned):
    """Stretched by 1.3 and 0.9 along axes that lie askew, sheared through, and turned in space."""
    x, mesh = sheet()
    c, s = np.cos(0.4), np.sin(0.4)
    askew = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    f = askew @ np.diag([1.3, 0.9, 1.0/(1.3*0.9)]) @ askew.T
    f[:2, 2] += [0.2, -0.1]          # what bends over a radius: no strain of the circles
    c, s = np.cos(turned), np.sin(turned)
    f = np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]]) @ f
    found = sheet_strains(mesh, x @ f.T - x, read_curve(CURVE))
    assert found.major == pytest.approx(np.log(1.3), rel=1e-12)
    assert found.minor == pytest.approx(np.log(0.9), rel=1e-12)
    limit = 0.3 - np.log(0.9)*(0.6 - 0.3)/0.3
    assert found.limit == pytest.approx(limit, rel=1e-12)
    assert found.share == pytest.approx(np.log(1.3)/limit, rel=1e-12)
    assert "0 of 16 elements are beyond the curve" in found.line()


def test_an_axisymmetric_sheet_has_the_hoop_for_a_third():
    x, mesh = sheet((8, 1), (10.0, 0.5))
    wide = x*[1.2, 1.0/1.44] - x
    found = sheet_strains(mesh, wide, axisymmetric=True)
    assert found.major == pytest.approx(np.log(1.2)) and found.minor == pytest.approx(np.log(1.2))
    assert sheet_strains(mesh, wide).minor == pytest.approx(0.0, abs=1e-14)
    assert "no element is judged" in found.line()


def test_strains_outside_a_curve_are_not_judged_and_it_says_so():
    x, mesh = sheet()
    grown = x*np.r_[np.exp(0.5), np.exp(0.45), 0.4] - x
    found = sheet_strains(mesh, grown, read_curve(CURVE))
    assert np.isnan(found.limit).all() and "no element is judged" in found.line()
    with pytest.raises(lopin.UsageError, match="minor strains that rise"):
        read_curve("0, 0.3\n-0.3, 0.6\n")
    with pytest.raises(lopin.UsageError, match="cannot be read"):
        read_curve("minor, major\n0, 0.3\n")


def strip(word, x=0.0, more=""):
    """A strip of one element of 4 by 1 whose end is drawn out by a tenth."""
    return f"""*NODE
1, {x!r}, 0.
2, {x + 4.0!r}, 0.
3, {x + 4.0!r}, 1.
4, {x!r}, 1.
*ELEMENT, TYPE={word}, ELSET=SHEET
1, 1, 2, 3, 4
*MATERIAL, NAME=STEEL
*ELASTIC
210000., 0.3
*PLASTIC
300., 0.
600., 1.
*SOLID SECTION, ELSET=SHEET, MATERIAL=STEEL
*BOUNDARY
1, 1, 2
4, 1
2, 2
*STEP, NLGEOM
*STATIC
0.1, 1.
*BOUNDARY
2, 1, 1, 0.4
3, 1, 1, 0.4
{more}*END STEP
"""


def test_the_command_reads_a_run(core, tmp_path, capsys):
    """A strip drawn out by a tenth between grips, plane strain: major ln 1.1, minor 0."""
    (tmp_path/"strip.inp").write_text(strip("CPE4"))
    (tmp_path/"curve.csv").write_text("-0.1, 0.12\n0.1, 0.08\n")
    assert main(["run", str(tmp_path/"strip.inp"), "-o", str(tmp_path/"out")]) == 0
    capsys.readouterr()
    words = ["flc", str(tmp_path/"out"), "--curve", str(tmp_path/"curve.csv")]
    assert main(words) == 0
    said = capsys.readouterr().out
    assert "95.3 % of 0.1" in said and "0 of 1 elements" in said
    row = (tmp_path/"out"/"flc.csv").read_text().splitlines()[1].split(",")
    assert float(row[2]) == pytest.approx(np.log(1.1), rel=1e-6)
    assert float(row[3]) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("word, x, more, minor", [
    ("CPS4", 0.0, "", -0.5), ("CAX4", 40.0, "1, 1, 1, 4.\n4, 1, 1, 4.\n2, 1, 1, 4.4\n3, 1, 1, 4.4\n",
                              1.0)])
def test_the_kind_of_the_run_says_what_the_third_direction_is(core, tmp_path, capsys, word, x, more,
                                                              minor):
    """Plane stress: the sheet lies in the plane. Axisymmetric: the hoop grows by a tenth, too."""
    (tmp_path/"strip.inp").write_text(strip(word, x, more))
    assert main(["run", str(tmp_path/"strip.inp"), "-o", str(tmp_path/"out")]) == 0
    words = ["flc", str(tmp_path/"out")]
    assert main(words) == 0
    row = (tmp_path/"out"/"flc.csv").read_text().splitlines()[1].split(",")
    # Plane stress: by Poisson's ratio the elastic part narrows less.
    assert float(row[2]) == pytest.approx(np.log(1.1), rel=1e-6)
    assert float(row[3]) == pytest.approx(minor*np.log(1.1), rel=0.01 if word == "CPS4" else 1e-6)
    if word == "CPS4":
        assert main([*words, "--normal", "0", "0", "1"]) == 0
        capsys.readouterr()
        assert main([*words, "--axisymmetric"]) == 2
        assert "the run is plane stress" in capsys.readouterr().err
        assert main([*words, "--normal", "0", "1"]) == 2
        assert "its normal is 0 0 1" in capsys.readouterr().err
        assert main([*words, "--normal", "0", "0"]) == 2
    else:
        assert main([*words, "--axisymmetric"]) == 0


def test_a_normal_across_the_plane_of_a_mesh_and_one_that_is_none():
    x, mesh = sheet((4, 4), (1.0, 1.0))
    found = sheet_strains(mesh, x*[1.2, 0.9] - x, normal=(0.0, 0.0, 2.0))
    assert found.major == pytest.approx(np.log(1.2)) and found.minor == pytest.approx(np.log(0.9))
    for wrong in ((0.0, 0.0), (1.0,), (0.0, np.nan, 1.0)):
        with pytest.raises(lopin.UsageError, match="is no normal"):
            sheet_strains(mesh, x, normal=wrong)


def turn(angles):
    a, b, c = angles
    about = [np.array([[np.cos(t), -np.sin(t), 0], [np.sin(t), np.cos(t), 0], [0, 0, 1]]) for t in
             (a, b, c)]
    return about[0] @ about[1][np.ix_([0, 2, 1], [0, 2, 1])] @ about[2]


def blank(kind, slant):
    """A flat blank across z: cells and places; its rim leans by `slant` along x."""
    mesh = mesh_make.block((10.0, 8.0, 0.8), (5, 4, 2))
    if kind == "tetra":
        mesh = mesh_make.simplices(mesh)
    x = mesh.points*[1.0, 1.0, 1.0]
    x[:, 0] += slant*x[:, 2]
    blocks = mesh.blocks
    if kind == "wedge":
        cells = blocks[0][1]
        blocks = [("wedge", np.vstack([cells[:, [0, 1, 2, 4, 5, 6]], cells[:, [0, 2, 3, 4, 6, 7]]]))]
    return x, blocks


@pytest.mark.parametrize("angles", [(0.0, 0.0, 0.0), (0.0, np.pi/3, 0.0), (0.4, 1.1, -2.0),
                                    (0.3, np.pi/2, 0.0), (1.0, 0.01, 0.2), (2.0, np.pi/4, 0.7)])
@pytest.mark.parametrize("kind, slant", [("hexahedron", 0.0), ("hexahedron", 0.8), ("wedge", 0.0),
                                         ("tetra", 0.0), ("tetra", -0.5)])
def test_a_blank_that_lies_inclined_has_the_normal_of_its_faces(angles, kind, slant):
    x, blocks = blank(kind, slant)
    q = turn(angles)
    f = q @ np.array([[1.2, 0.05, 0.3], [0.05, 0.95, -0.1], [0.0, 0.0, 0.9]]) @ q.T
    places = x @ q.T
    mesh = SimpleNamespace(points=places, cells=[SimpleNamespace(type=n, data=c) for n, c in blocks])
    found = sheet_strains(mesh, places @ f.T - places)
    given = sheet_strains(mesh, places @ f.T - places, normal=q[:, 2])
    assert found.major == pytest.approx(given.major, rel=1e-9)
    assert found.minor == pytest.approx(given.minor, rel=1e-9)
    small, large = np.linalg.eigvalsh(np.array([[1.2, 0.05], [0.05, 0.95]]))
    assert found.major == pytest.approx(np.log(large), rel=1e-9)
    assert found.minor == pytest.approx(np.log(small), rel=1e-9)
    is_axis = np.abs(q[:, 2]).max() > 1.0 - 1e-9
    assert ("the normal of the blank is" in found.line()) == (not is_axis)


@pytest.mark.parametrize("angle", [0.0, 0.5, 1.5707963267948966, 2.5])
def test_a_strip_that_lies_inclined_in_its_plane(angle):
    mesh = mesh_make.block((10.0, 0.5), (8, 2))
    q = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    x = mesh.points @ q.T
    f = q @ np.diag([1.1, 1.0/1.1]) @ q.T
    found = sheet_strains(SimpleNamespace(points=x, cells=[SimpleNamespace(
        type=n, data=c) for n, c in mesh.blocks]), x @ f.T - x)
    assert found.major == pytest.approx(np.log(1.1)) and found.minor == pytest.approx(0.0, abs=1e-14)


@pytest.mark.parametrize("radius, bent", [(2.0, True), (8.0, True), (30.0, True), (1e4, False)])
def test_a_blank_that_is_bent_at_the_start_is_told(radius, bent):
    x, blocks = blank("hexahedron", 0.0)
    angle = x[:, 0]/radius
    rolled = np.column_stack([(radius + x[:, 2])*np.sin(angle), x[:, 1],
                              (radius + x[:, 2])*np.cos(angle)])
    mesh = SimpleNamespace(points=rolled, cells=[SimpleNamespace(type=n, data=c) for n, c in blocks])
    assert ("bent at the start" in sheet_strains(mesh, 0.0*rolled + 0.01*rolled).line()) == bent


def test_a_channel_is_no_flat_blank():
    """A bottom and two walls of quads: faces along two axes only."""
    mesh = mesh_make.block((10.0, 10.0), (20, 20))
    cells = mesh.blocks[0][1]
    middle = mesh.points[cells].mean(axis=1)
    keep = (middle[:, 0] < 0.5) | (middle[:, 0] > 9.5) | (middle[:, 1] < 0.5)
    channel = SimpleNamespace(points=mesh.points, cells=[SimpleNamespace(type="quad", data=cells[keep])])
    assert "bent at the start" in sheet_strains(channel, 0.01*mesh.points).line()
