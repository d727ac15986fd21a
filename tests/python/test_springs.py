"""Springs and gaps: forces, energies, what they hold, in all paths."""
import json
import subprocess

import numpy as np
import pytest

import lopin

BAR = """*NODE, NSET=ALL
1, 0., 0., 0.
2, 1., 0., 0.
3, 1., 1., 0.
4, 0., 1., 0.
5, 0., 0., 1.
6, 1., 0., 1.
7, 1., 1., 1.
8, 0., 1., 1.
11, 3., 0., 0.
12, 3., 1., 0.
13, 3., 1., 1.
14, 3., 0., 1.
*ELEMENT, TYPE=C3D8, ELSET=CUBE
1, 1, 2, 3, 4, 5, 6, 7, 8
*MATERIAL, NAME=M
*ELASTIC
1000., 0.
*SOLID SECTION, ELSET=CUBE, MATERIAL=M
*NSET, NSET=LEFT
1, 4, 5, 8
*NSET, NSET=RIGHT
2, 3, 6, 7
*NSET, NSET=POSTS
11, 12, 13, 14
"""
STEP = "*STEP{nlgeom}\n*STATIC\n1., 1.\n*CLOAD\n{load}\n*NODE FILE\nU, RF\n*END STEP\n"
AXIAL = ("*ELEMENT, TYPE=SPRINGA, ELSET=WIRES\n21, 2, 11\n22, 3, 12\n23, 6, 14\n24, 7, 13\n"
         "*SPRING, ELSET=WIRES{nonlinear}\n\n{law}\n")


def run(tmp_path, text):
    (tmp_path/"job.inp").write_text(text)
    return lopin.run(tmp_path/"job.inp", output=tmp_path/"out")


def u_of(result, label, index=-1):
    frame = result.at(index)
    return frame["U"][frame["LABEL"] == label][0]


@pytest.mark.parametrize("nlgeom", ["", ", NLGEOM"])
@pytest.mark.parametrize("kind", ["SPRINGA", "SPRING1", "SPRING2"])
def test_springs_beside_a_bar_share_the_load(tmp_path, kind, nlgeom):
    """Four springs of 50 hold the end of a bar of 1000: u = F/(1000 + 200) for F = 6."""
    cards = {"SPRINGA": AXIAL.format(nonlinear="", law="50."),
             "SPRING1": "*ELEMENT, TYPE=SPRING1, ELSET=W\n21, 2\n22, 3\n23, 6\n24, 7\n"
                        "*SPRING, ELSET=W\n1\n50.\n",
             "SPRING2": "*ELEMENT, TYPE=SPRING2, ELSET=W\n21, 2, 11\n22, 3, 12\n23, 6, 14\n24, 7, 13\n"
                        "*SPRING, ELSET=W\n1, 1\n50.\n"}[kind]
    result = run(tmp_path, BAR + cards + "*BOUNDARY\nLEFT, 1, 3\nRIGHT, 2, 3\nPOSTS, 1, 3\n"
                 + STEP.format(nlgeom=nlgeom, load="RIGHT, 1, 1.5"))
    assert u_of(result, 2)[0] == pytest.approx(5e-3, rel=1e-2 if nlgeom else 1e-9)
    assert result.verdict == "PASS"
    if kind != "SPRING1":
        assert result.at(-1)["RF"][result.at(-1)["LABEL"] == 11][0][0] == pytest.approx(
            -0.25, rel=1e-2)


@pytest.mark.parametrize("nlgeom", ["", ", NLGEOM"])
def test_springs_alone_hold_a_body(tmp_path, nlgeom):
    """Nothing else holds the cube along x: u = F/(4 k)."""
    result = run(tmp_path, BAR + AXIAL.format(nonlinear="", law="50.")
                 + "*BOUNDARY\nLEFT, 2, 3\nRIGHT, 2, 3\nPOSTS, 1, 3\n"
                 + STEP.format(nlgeom=nlgeom, load="LEFT, 1, -1."))
    assert u_of(result, 2)[0] == pytest.approx(-0.02, rel=1e-6)


def test_without_its_springs_the_body_floats(tmp_path):
    with pytest.raises(lopin.LopinError, match="can move along x"):
        run(tmp_path, BAR + "*BOUNDARY\nLEFT, 2, 3\nRIGHT, 2, 3\nPOSTS, 1, 3\n"
            + STEP.format(nlgeom="", load="LEFT, 1, -1."))


@pytest.mark.parametrize("nlgeom", ["", ", NLGEOM"])
def test_a_table_of_forces(tmp_path, nlgeom):
    """50 up to 0.01, then 500: a force of 1 a spring extends it by 0.01 + 0.5/500."""
    result = run(tmp_path, BAR + AXIAL.format(nonlinear=", NONLINEAR",
                                              law="-5., -0.1\n0., 0.\n0.5, 0.01\n50.5, 0.11")
                 + "*BOUNDARY\nLEFT, 2, 3\nRIGHT, 2, 3\nPOSTS, 1, 3\n"
                 + STEP.format(nlgeom=nlgeom, load="LEFT, 1, -1."))
    assert u_of(result, 2)[0] == pytest.approx(-0.011, rel=1e-6)


def test_a_wire_turns_with_its_ends(tmp_path):
    """A rope of stiffness k across which a force pulls: F = 2 k (l - l0) v/l, as geometry says."""
    text = ("*NODE, NSET=ALL\n1, 0., 0., 0.\n2, 1., 0., 0.\n3, 2., 0., 0.\n"
            "*ELEMENT, TYPE=SPRINGA, ELSET=W\n1, 1, 2\n2, 2, 3\n*SPRING, ELSET=W\n\n100.\n"
            "*BOUNDARY\n1, 1, 3\n3, 1, 3\n2, 1\n2, 3\n*STEP, NLGEOM\n*STATIC\n0.1, 1.\n"
            "*BOUNDARY\n2, 2, 2, 0.5\n*NODE FILE\nU, RF\n*END STEP\n")
    result = run(tmp_path, text)
    length = np.hypot(1.0, 0.5)
    frame = result.at(-1)
    assert frame["RF"][frame["LABEL"] == 2][0][1] == pytest.approx(
        2*100.0*(length - 1.0)*0.5/length, rel=1e-9)


@pytest.mark.parametrize("clearance, pressed", [(0.0, True), (0.004, True), (0.02, False)])
def test_a_gap_presses_only_where_it_is_closed(tmp_path, clearance, pressed):
    """Bar end moved by F/1000 = 0.01 towards posts, gaps stiff beside the bar."""
    text = BAR + ("*ELEMENT, TYPE=GAPUNI, ELSET=G\n21, 2, 11\n22, 3, 12\n23, 6, 14\n24, 7, 13\n"
                  f"*GAP, ELSET=G\n{clearance}, 1., 0., 0.\n") \
        + "*BOUNDARY\nLEFT, 1, 3\nRIGHT, 2, 3\nPOSTS, 1, 3\n" \
        + STEP.format(nlgeom="", load="RIGHT, 1, 2.5")
    result = run(tmp_path, text)
    expected = clearance if pressed else 0.01
    assert u_of(result, 2)[0] == pytest.approx(expected, abs=1e-5)


@pytest.mark.parametrize("change, code", [
    ("*SPRING, ELSET=WIRES\n\n50.\n", None),
    ("*SPRING, ELSET=WRES\n\n50.\n", "E0201"),
    ("*SPRING, ELSET=WIRES\n\n", "E0103"),
    ("*SPRING, ELSET=WIRES\n\n-50.\n", "E0106"),
    ("*SPRING, ELSET=WIRES, NONLINEAR\n\n5., 0.\n0., 1.\n", "E0106"),
    ("", "E0203"),
    ("*GAP, ELSET=WIRES\n0., 1., 0., 0.\n", "E0203")])
def test_what_is_wrong_with_springs_is_said(executable, tmp_path, change, code):
    cards = AXIAL.format(nonlinear="", law="50.").split("*SPRING")[0] + change
    text = BAR + cards + "*BOUNDARY\nLEFT, 1, 3\nPOSTS, 1, 3\n" + STEP.format(nlgeom="", load="RIGHT, 1, 1.")
    (tmp_path/"job.inp").write_text(text)
    done = subprocess.run([executable, "check", tmp_path/"job.inp"], capture_output=True, text=True)
    assert (f"error[{code}]" in done.stderr) if code else done.returncode == 0, done.stderr


def test_a_set_may_name_springs(tmp_path):
    result = run(tmp_path, BAR + AXIAL.format(nonlinear="", law="50.")
                 + "*ELSET, ELSET=ALL\nCUBE, 21, 22\n*BOUNDARY\nLEFT, 1, 3\nRIGHT, 2, 3\nPOSTS, 1, 3\n"
                 + STEP.format(nlgeom="", load="RIGHT, 1, 1.5"))
    assert json.loads((tmp_path/"out"/"job.json").read_text())["exit_code"] == 0
    assert u_of(result, 2)[0] == pytest.approx(5e-3, rel=1e-9)
