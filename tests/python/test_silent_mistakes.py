"""Mistakes that users make once: each is one line, with its place and what to do, and ordinary
decks say nothing of the kind.

The base deck is a block of 2 by 2 elements on the ground under a plane tool. Each case changes a
line or two of it.
"""

import os
import re
import subprocess

import pytest

EXECUTABLE = os.environ.get("LOPIN_EXECUTABLE", "")

pytestmark = pytest.mark.skipif(not EXECUTABLE, reason="LOPIN_EXECUTABLE names no executable")

NODES = "\n".join(f"{1 + i + 3*j}, {5.*i}, {5.*j}" for j in range(3) for i in range(3))
PARTS = {
    "mesh": "*NODE, NSET=ALL\n" + NODES + """
10, 0., 12.
11, 0., 12.
*ELEMENT, TYPE=CPE4, ELSET=BLOCK
1, 1, 2, 5, 4
2, 2, 3, 6, 5
3, 4, 5, 8, 7
4, 5, 6, 9, 8
*NSET, NSET=BOTTOM
1, 2, 3
*NSET, NSET=LEFT
1, 4, 7
*SURFACE, NAME=TOP
3, S3
4, S3
""",
    "material": """*MATERIAL, NAME=STEEL
*ELASTIC
210000., 0.3
*SOLID SECTION, ELSET=BLOCK, MATERIAL=STEEL
1.,
""",
    "tool": """*SURFACE, NAME=TOOL, TYPE=SEGMENTS
START, 20., 10.
LINE, -20., 10.
*RIGID BODY, ANALYTICAL SURFACE=TOOL, REF NODE=10
""",
    "pair": """*SURFACE INTERACTION, NAME=DRY
*FRICTION
0.1
*CONTACT PAIR, INTERACTION=DRY
TOP, TOOL
""",
    "supports": "*BOUNDARY\nBOTTOM, 1, 2\n10, 1\n10, 6\n",
    "steps": "*STEP\n*STATIC\n*BOUNDARY\n10, 2, 2, -0.01\n*END STEP\n",
}


def deck(**changed):
    return "".join({**PARTS, **changed}.values())


def lopin(word, text, folder, *options):
    path = folder/"deck.inp"
    path.write_text(text)
    return subprocess.run([EXECUTABLE, word, str(path), *options], capture_output=True, text=True,
                          timeout=30, cwd=folder)


def said(run, code):
    """The messages of a code."""
    return re.findall(rf"^(?:warning|note|error)\[{code}\]: (.*)$", run.stderr, flags=re.MULTILINE)


def test_a_right_deck_says_nothing(tmp_path):
    run = lopin("check", deck(), tmp_path)
    assert run.returncode == 0 and run.stderr == ""


TWICE = {
    "overlapping sets": deck(supports="*BOUNDARY\nBOTTOM, 1, 2\nLEFT, 1, 1, 0.1\n10, 1\n10, 6\n"),
    "the same set": deck(steps="*STEP\n*STATIC\n*BOUNDARY\n10, 2, 2, -0.01\n10, 2, 2, -0.02\n"
                               "*END STEP\n"),
    "symmetry and a motion": deck(steps="*STEP\n*STATIC\n*BOUNDARY\nLEFT, XSYMM\n7, 1, 1, 0.1\n"
                                        "10, 2, 2, -0.01\n*END STEP\n"),
    "two cards": deck(steps="*STEP\n*STATIC\n*BOUNDARY\n10, 2, 2, -0.01\n*BOUNDARY\n10, 2, 2, 0.\n"
                            "*END STEP\n"),
    "a velocity and a way": deck(steps="*STEP\n*STATIC\n1., 1.\n*BOUNDARY\n10, 2, 2, -0.01\n"
                                       "*BOUNDARY, TYPE=VELOCITY\n10, 2, 2, -0.01\n*END STEP\n"),
    "rotation at two nodes": deck(
        tool=PARTS["tool"].replace("REF NODE=10", "REF NODE=10, ROT NODE=11"),
        steps="*STEP\n*STATIC\n*BOUNDARY\n10, 2, 2, -0.01\n11, 3, 3, 0.01\n*END STEP\n",
        supports="*BOUNDARY\nBOTTOM, 1, 2\n10, 1\n",
    ).replace("10, 2, 2, -0.01\n", "10, 2, 2, -0.01\n10, 6, 6, 0.02\n"),
}


@pytest.mark.parametrize("case", TWICE)
def test_a_dof_with_two_values_in_one_step_is_said(case, tmp_path):
    run = lopin("check", TWICE[case], tmp_path)
    assert run.returncode == 0
    assert len(said(run, "W0404")) == 1 and "prescribed twice" in said(run, "W0404")[0], run.stderr


ONCE = {
    "equal values": deck(supports="*BOUNDARY\nBOTTOM, 1, 2\nLEFT, 1\nBOTTOM, ENCASTRE\n10, 1\n"
                                  "10, 6\n10, 1\n"),
    "another step": deck(steps=PARTS["steps"] + "*STEP\n*STATIC\n*BOUNDARY\n10, 2, 2, -0.02\n"
                                                "*END STEP\n"),
    "model and step": deck(supports="*BOUNDARY\nBOTTOM, 1, 2\n10, 1, 6\n"),
}


@pytest.mark.parametrize("case", ONCE)
def test_a_dof_with_one_value_is_not(case, tmp_path):
    run = lopin("check", ONCE[case], tmp_path)
    assert run.returncode == 0 and run.stderr == ""


def test_several_dofs_of_two_lines_are_one_message(tmp_path):
    steps = "*STEP\n*STATIC\n*BOUNDARY\nBOTTOM, 2, 2, 0.1\nBOTTOM, 2, 2, 0.2\n*END STEP\n"
    run = lopin("check", deck(steps=steps), tmp_path)
    assert len(said(run, "W0404")) == 1 and "2 more dofs" in said(run, "W0404")[0]


def test_the_last_value_counts(tmp_path):
    run = lopin("run", TWICE["the same set"], tmp_path, "-o", "out")
    assert run.returncode == 0
    lines = (tmp_path/"out"/"deck_history.csv").read_text().splitlines()
    row = dict(zip(lines[0].split(","), lines[-1].split(",")))
    assert float(next(v for k, v in row.items() if k.startswith("TOOL.u2"))) == -0.02


def material(*cards):
    return PARTS["material"].replace("*SOLID", "\n".join(cards) + "\n*SOLID")


PLAUSIBLE = {
    "yield above E": deck(material=material("*PLASTIC", "250.").replace("210000.", "210.")),
    "yield of E/2": deck(material=material("*PLASTIC", "250.").replace("210000.", "500.")),
    "yield in Pa": deck(material=material("*PLASTIC", "250.E6, 0.", "300.E6, 0.1")),
    "yield in GPa": deck(material=material("*PLASTIC", "0.25")),
    "curve in Pa": deck(material=material("*PLASTIC", "250., 0.", "300.E6, 0.1")),
    "slope in kPa": deck(material=material("*PLASTIC, HARDENING=LINEAR", "250., 1.E6")),
    "curve too steep": deck(material=material("*PLASTIC", "250., 0.", "900., 0.001")),
    "strain in per cent": deck(material=material("*PLASTIC", "250., 0.", "400., 20.")),
    "negative Poisson": deck(material=PARTS["material"].replace("0.3", "-0.3")),
    "pressure in Pa": deck(steps="*STEP\n*STATIC\n*DLOAD\n4, P2, 1.E6\n*END STEP\n"),
    "expansion in ppm": deck(
        material=material("*EXPANSION", "12."),
        steps="*STEP\n*STATIC\n*TEMPERATURE\nALL, 100.\n*END STEP\n"),
}


@pytest.mark.parametrize("case", PLAUSIBLE)
def test_numbers_in_another_unit_are_said(case, tmp_path):
    run = lopin("check", PLAUSIBLE[case], tmp_path)
    assert run.returncode == 0 and len(said(run, "W0402")) == 1, run.stderr


@pytest.mark.parametrize("scale", [1.0e-6, 1.0e-3, 1.0, 1.0e3, 1.0e6])
def test_a_metal_is_plausible_in_every_unit(scale, tmp_path):
    text = (f"*MATERIAL, NAME=STEEL\n*ELASTIC\n{210000.*scale}, 0.3\n*PLASTIC\n{180.*scale}, 0.\n"
            f"{200.*scale}, 2.E-5\n{320.*scale}, 0.2\n{600.*scale}, 2.5\n"
            "*SOLID SECTION, ELSET=BLOCK, MATERIAL=STEEL\n1.,\n")
    assert not said(lopin("check", deck(material=text), tmp_path), "W0402")


RIGID_PLATE = """*NODE
21, -20., 10.
22, 20., 10.
*ELEMENT, TYPE=R2D2, ELSET=PLATE
21, 22, 21
*RIGID BODY, ELSET=PLATE, REF NODE=10
"""
IDLE = {
    "tool in no pair": deck(pair=""),
    "rigid mesh in no pair": deck(tool=RIGID_PLATE, pair=""),
    "second tool": deck(tool=PARTS["tool"] + "*SURFACE, NAME=DIE, TYPE=SEGMENTS\n"
                                             "START, 20., 20.\nLINE, -20., 20.\n"),
    "interaction in no pair": deck(pair="*SURFACE INTERACTION, NAME=OIL\n" + PARTS["pair"]),
}


@pytest.mark.parametrize("case", IDLE)
def test_what_touches_nothing_is_said(case, tmp_path):
    run = lopin("check", IDLE[case], tmp_path)
    assert run.returncode == 0 and len(said(run, "W0303")) == 1, run.stderr


def test_a_rigid_mesh_in_a_pair_and_one_that_holds_a_body_are_not(tmp_path):
    faces = RIGID_PLATE + "*SURFACE, NAME=TOOL\nPLATE, SPOS\n"
    run = lopin("check", deck(tool=faces), tmp_path)
    assert not said(run, "W0303"), run.stderr
    held = deck(tool="*RIGID BODY, NSET=BOTTOM, REF NODE=10\n", pair="",
                supports="*BOUNDARY\n10, 1, 6\n", steps="*STEP\n*STATIC\n*CLOAD\n9, 2, 1.\n"
                                                        "*END STEP\n")
    assert not said(lopin("check", held, tmp_path), "W0303")


def test_unused_materials_and_amplitudes_are_noted(tmp_path):
    text = deck(material=PARTS["material"] + "*MATERIAL, NAME=LEAD\n*ELASTIC\n16000., 0.4\n",
                mesh="*AMPLITUDE, NAME=PULSE\n0., 0., 1., 1.\n" + PARTS["mesh"])
    run = lopin("check", text, tmp_path)
    assert len(said(run, "N0303")) == 2 and "PULSE" in run.stderr and "LEAD" in run.stderr


def pair(words="", interaction="", more=""):
    return (f"*SURFACE INTERACTION, NAME=DRY\n{interaction}"
            f"*CONTACT PAIR, INTERACTION=DRY{words}\nTOP, TOOL\n{more}")


OPTIONS = {
    "SMOOTH on a tool": deck(pair=pair(", SMOOTH=YES")),
    "SMOOTH on a plane mesh": deck(tool=RIGID_PLATE + "*SURFACE, NAME=TOOL\nPLATE, SPOS\n",
                                   pair=pair(", SMOOTH=YES")),
    "CLEARANCE of a tie": deck(pair=pair(", TIED", "", "*CLEARANCE, SLAVE=TOP, MASTER=TOOL, "
                                                       "VALUE=0.1\n")),
    "CLEARANCE and ADJUST": deck(pair=pair(", ADJUST=0.1", "", "*CLEARANCE, SLAVE=TOP, "
                                                               "MASTER=TOOL, VALUE=0.1\n")),
    "friction of a tie": deck(pair=pair(", TIED", "*FRICTION\n0.1\n")),
    "SMALL SLIDING and NLGEOM": deck(pair=pair(", SMALL SLIDING"),
                                     steps=PARTS["steps"].replace("*STEP", "*STEP, NLGEOM", 1)),
    "augmentations of a hard contact": deck(pair=pair("", "", "*CONTACT CONTROLS, MAX "
                                                              "AUGMENTATIONS=9\n")),
}


@pytest.mark.parametrize("case", OPTIONS)
def test_an_option_that_does_nothing_is_said(case, tmp_path):
    run = lopin("check", OPTIONS[case], tmp_path)
    assert run.returncode == 0 and len(said(run, "W0305")) == 1, run.stderr
