"""What decks of other programs say in their own way: pre-tension, sections twice, names used twice,
axes of transforms, ties between surfaces that look the same way."""
import json
import subprocess

import numpy as np
import pytest

import lopin

BAR_2D = """*NODE, NSET=ALL
1, 0., 0.
2, 1., 0.
3, 2., 0.
4, 3., 0.
5, 4., 0.
6, 0., 1.
7, 1., 1.
8, 2., 1.
9, 3., 1.
10, 4., 1.
100, 2., 2.
*ELEMENT, TYPE=CPS4, ELSET=BAR
1, 1, 2, 7, 6
2, 2, 3, 8, 7
3, 3, 4, 9, 8
4, 4, 5, 10, 9
*NSET, NSET=LEFT
1, 6
*NSET, NSET=RIGHT
5, 10
"""
CUT = "*SURFACE, NAME=CUT\n2, S2\n*PRE-TENSION SECTION, SURFACE=CUT, NODE=100\n"
STEEL = """*MATERIAL, NAME=STEEL
*ELASTIC
200000., 0.
*SOLID SECTION, ELSET=BAR, MATERIAL=STEEL
1.,
"""


def bar_3d():
    """The same bar of bricks, one by one in section."""
    nodes = [(x, y, z) for x in range(5) for y in (0, 1) for z in (0, 1)]
    text = "*NODE, NSET=ALL\n" + "".join(f"{i + 1}, {x}., {y}., {z}.\n"
                                        for i, (x, y, z) in enumerate(nodes))
    text += "100, 2., 2., 0.\n*ELEMENT, TYPE=C3D8, ELSET=BAR\n"
    for k in range(4):
        a, b = 4*k + 1, 4*k + 5
        text += f"{k + 1}, {a}, {b}, {b + 2}, {a + 2}, {a + 1}, {b + 1}, {b + 3}, {a + 3}\n"
    return text + ("*NSET, NSET=LEFT\n1, 2, 3, 4\n*NSET, NSET=RIGHT\n17, 18, 19, 20\n")


def run(tmp_path, text, code=0):
    (tmp_path/"job.inp").write_text(text)
    try:
        return lopin.run(tmp_path/"job.inp", output=tmp_path/"out")
    except lopin.LopinError as error:
        assert code and error.code == code, error
        return error.result


def codes(tmp_path):
    summary = json.loads((tmp_path/"out"/"job.json").read_text())
    return [item["code"] for item in summary["diagnostics"]]


@pytest.mark.parametrize("nlgeom", ["", ", NLGEOM"])
@pytest.mark.parametrize("normal", ["", "1., 0., 0.\n", "-1., 0., 0.\n"])
@pytest.mark.parametrize("bar", [BAR_2D, bar_3d()], ids=["plane", "solid"])
def test_a_bolt_is_tightened_by_a_force_and_locked(tmp_path, bar, normal, nlgeom):
    """F = 100 on a bar of length 4 and section 1: stress 100, shortening F L/(E A) = 2e-3."""
    cut = CUT.replace("2, S2", "2, S4") if "C3D8" in bar else CUT
    result = run(tmp_path, f"{bar}{STEEL}{cut}{normal}"
                 "*BOUNDARY\nLEFT, 1, 3\nRIGHT, 1, 3\n"
                 f"*STEP{nlgeom}\n*STATIC\n1., 1.\n*CLOAD\n100, 1, 100.\n*NODE PRINT, NSET=LEFT\nRF\n"
                 f"*NODE FILE\nU, RF\n*EL FILE\nS\n*END STEP\n"
                 f"*STEP{nlgeom}\n*STATIC\n1., 1.\n*BOUNDARY, FIXED\n100, 1\n*END STEP\n")
    for frame in (result.at(0), result.at(-1)):
        body = frame["LABEL"] != 100
        assert frame["S"][body, 0] == pytest.approx(100.0, rel=2e-3 if nlgeom else 1e-9)
        assert frame["U"][~body, 0] == pytest.approx(2e-3, rel=2e-3 if nlgeom else 1e-9)
    assert result.verdict == "PASS"


def test_a_bolt_is_tightened_by_a_shortening(tmp_path):
    result = run(tmp_path, BAR_2D + STEEL + CUT + "*BOUNDARY\nLEFT, 1, 2\nRIGHT, 1, 2\n*STEP\n*STATIC\n*BOUNDARY\n100, 1, 1, 4e-3\n"
                 "*NODE FILE\nU, RF\n*EL FILE\nS\n*END STEP\n")
    assert result["S"][result["LABEL"] != 100, 0] == pytest.approx(200.0, rel=1e-9)


def test_the_surface_of_a_section_is_made_of_faces_across_the_bolt(executable, tmp_path):
    for change, code in (("*SURFACE, NAME=CUT\n2, S2", "*SURFACE, NAME=CUT, TYPE=NODE\n3"),
                         ("NODE=100\n", "NODE=100\n0., 1., 0.\n")):
        text = (BAR_2D + STEEL + CUT + "*STEP\n*STATIC\n*CLOAD\n100, 1, 1.\n*END STEP\n").replace(change, code)
        (tmp_path/"job.inp").write_text(text)
        done = subprocess.run([executable, "check", tmp_path/"job.inp"], capture_output=True,
                              text=True)
        assert done.returncode == 1 and "error[E0315]" in done.stderr


def test_a_node_of_equations_alone_carries_a_force(tmp_path):
    """Both right nodes follow node 100 by *EQUATION: its force is theirs."""
    result = run(tmp_path, BAR_2D + STEEL + "*EQUATION\n2\nRIGHT, 1, 1., 100, 1, -1.\n"
                 "*BOUNDARY\nLEFT, 1, 2\nRIGHT, 2\n*STEP\n*STATIC\n*CLOAD\n100, 1, 50.\n"
                 "*NODE FILE\nU\n*EL FILE\nS\n*END STEP\n")
    assert result["S"][result["LABEL"] != 100, 0] == pytest.approx(50.0, rel=1e-9)
    assert "W0405" not in codes(tmp_path)


def test_the_later_section_of_an_element_holds(tmp_path):
    second = STEEL.replace("NAME=STEEL", "NAME=LEAD").replace("=STEEL", "=LEAD") \
        .replace("200000.", "20000.")
    result = run(tmp_path, BAR_2D + STEEL + second + "*BOUNDARY\nLEFT, 1, 2\n*STEP\n*STATIC\n"
                 "*CLOAD\nRIGHT, 1, 50.\n*NODE FILE\nU\n*EL FILE\nS\n*END STEP\n")
    assert result["U"][:, 0].max() == pytest.approx(100.0*4/20000.0, rel=1e-9)
    assert codes(tmp_path).count("W0203") == 1


BLOCKS = """*NODE, NSET=ALL, SYSTEM=R
1, 0., 1.
2, 1., 1.
3, 1., 2.
4, 0., 2.
5, -1., 0.
6, 2., 0.
7, 2., 1.
8, -1., 1.
*ELEMENT, TYPE=CPS4, ELSET=UP
1, 1, 2, 3, 4
*ELEMENT, TYPE=CPS4, ELSET=LOW
2, 5, 6, 7, 8
*NSET, NSET=TOP, FREQUENCY=100
3, 4
*NSET, NSET=FOOT
1, 2
*ELSET, ELSET=BAR
UP, LOW
"""


def test_nodes_and_faces_may_have_one_name(tmp_path):
    """A pair takes the faces, which know their areas, whichever is first."""
    for order in (1, -1):
        surfaces = ["*SURFACE, NAME=ONE, TYPE=NODE\nFOOT, 0.5\n", "*SURFACE, NAME=ONE\nUP, S1\n"]
        result = run(tmp_path, BLOCKS + STEEL + "".join(surfaces[::order]) +
                     "*SURFACE, NAME=OTHER\nLOW, S3\n*SURFACE, NAME=OTHER, TYPE=NODE\n7, 8\n"
                     "*SURFACE INTERACTION, NAME=I\n*SURFACE BEHAVIOR, DIRECT\n"
                     "*CONTACT PAIR, INTERACTION=I, TYPE=NODE TO SURFACE\nONE, OTHER\n"
                     "*BOUNDARY\n5, 1, 2\n6, 1, 2\nTOP, 1\nFOOT, 1\n*STEP\n*STATIC\n*CLOAD\nTOP, 2, -5.\n"
                     "*CONTACT PRINT, SLAVE=ONE, MASTER=OTHER, SET=FOOT\nCDIS, CSTR\n*END STEP\n")
        assert result.contact("ONE").last.pressure == pytest.approx(10.0, rel=1e-9)


def test_tied_surfaces_that_look_the_same_way(tmp_path):
    """Both S3: the upper block hangs by its nodes on the side of the lower one that looks down."""
    result = run(tmp_path, BLOCKS + STEEL + "*SURFACE, NAME=ONE\nUP, S1\n*SURFACE, NAME=OTHER\n"
                 "LOW, S1\n*TIE, NAME=GLUE, POSITION TOLERANCE=2.\nONE, OTHER\n*BOUNDARY\n5, 1, 2\n"
                 "6, 1, 2\n*STEP\n*STATIC\n*CLOAD\nTOP, 2, 5.\n*NODE FILE\nU\n*EL FILE\nS\n*END STEP\n")
    assert "W0319" in codes(tmp_path)
    assert np.abs(result.contact("ONE").last.force[:, 1]).sum() == pytest.approx(10.0, rel=1e-6)


def test_a_node_on_the_axis_of_a_cylindrical_system(tmp_path):
    """A wedge about y; the radial direction of nodes on the axis is CalculiX' (z)."""
    text = """*NODE, NSET=ALL
1, 0., 0., 0.
2, 0., 0., 1.
3, 0.5, 0., 1.
4, 0., 1., 0.
5, 0., 1., 1.
6, 0.5, 1., 1.
*ELEMENT, TYPE=C3D6, ELSET=BAR
1, 1, 2, 3, 4, 5, 6
*TRANSFORM, TYPE=C, NSET=ALL
0., 0., 0., 0., 1., 0.
""" + STEEL + """*BOUNDARY
1, 1, 3
2, 2, 3
3, 2, 3
4, 1, 2
5, 2
6, 2
*STEP
*STATIC
*BOUNDARY
4, 3, 3, 0.001
5, 3, 3, 0.001
6, 3, 3, 0.001
*NODE FILE
U
*EL FILE
S
*END STEP
"""
    result = run(tmp_path, text)
    assert codes(tmp_path).count("N0406") == 1
    assert result["S"][:, 1] == pytest.approx(200.0, rel=1e-6)


@pytest.mark.parametrize("control, load, code", [
    ("", "", "W0311"), ("*CONTACT CONTROLS, INITIAL=INTERFERENCE\n", "", "N0311"),
    ("*CONTACT CONTROLS, INITIAL=INTERFERENCE\n", "TOP, 2, -1e-3\n", "N0311"),
    ("", "TOP, 2, -1e-3\n", "N0316")])
def test_a_small_overlap_is_the_load_where_nothing_else_is(tmp_path, control, load, code):
    """CalculiX' press fits have no load at all: 5e-4 of an element is pressed out, not set right."""
    blocks = BLOCKS.replace("1, 0., 1.\n2, 1., 1.\n3, 1., 2.\n4, 0., 2.",
                            "1, 0., 0.9995\n2, 1., 0.9995\n3, 1., 2.\n4, 0., 2.")
    result = run(tmp_path, blocks + STEEL + "*SURFACE, NAME=ONE\nUP, S1\n*SURFACE, NAME=OTHER\nLOW, S3\n"
                 "*SURFACE INTERACTION, NAME=I\n*SURFACE BEHAVIOR, DIRECT\n*CONTACT PAIR, INTERACTION=I, "
                 f"TYPE=NODE TO SURFACE\nONE, OTHER\n{control}*BOUNDARY\n5, 1, 2\n6, 1, 2\nTOP, 1, 2\n"
                 f"FOOT, 1\n*STEP\n*STATIC\n*CLOAD\n{load.replace('TOP', 'FOOT')}*END STEP\n")
    assert code in codes(tmp_path)
    most = result.contact("ONE").last.pressure.max()
    assert most < 1.0 if code == "N0316" else most > 10.0
