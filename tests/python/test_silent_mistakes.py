"""Mistakes that users make once: each is one line, with its place and what to do, and ordinary
decks say nothing of the kind.

The base deck is a block of 2 by 2 elements on the ground under a plane tool. Each case changes a
line or two of it.
"""

import os
import re
import subprocess

import pytest

from lopin import Elastic, mesh_make, profile
from lopin.model import Model

EXECUTABLE = os.environ["LOPIN_EXECUTABLE"]
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


def heavy(young, density, gravity, size=1.0):
    """The block under its own weight."""
    nodes = "\n".join(f"{1 + i + 3*j}, {5.*i*size}, {5.*j*size}" for j in range(3) for i in range(3))
    return (f"*NODE, NSET=ALL\n{nodes}\n*ELEMENT, TYPE=CPE4, ELSET=BLOCK\n1, 1, 2, 5, 4\n"
            "2, 2, 3, 6, 5\n3, 4, 5, 8, 7\n4, 5, 6, 9, 8\n*NSET, NSET=BOTTOM\n1, 2, 3\n"
            f"*MATERIAL, NAME=STEEL\n*ELASTIC\n{young!r}, 0.3\n*DENSITY\n{density!r}\n"
            "*SOLID SECTION, ELSET=BLOCK, MATERIAL=STEEL\n1.,\n*BOUNDARY\nBOTTOM, 1, 2\n"
            f"*STEP\n*STATIC\n*DLOAD\nBLOCK, GRAV, {gravity!r}, 0., -1.\n*END STEP\n")


@pytest.mark.parametrize("mixed", [(210000., 7850., 9810.), (210000., 7850., 9.81)])
def test_a_weight_beyond_the_modulus_is_said(mixed, tmp_path):
    run = lopin("check", heavy(*mixed), tmp_path)
    assert run.returncode == 0 and len(said(run, "W0401")) == 1, run.stderr


@pytest.mark.parametrize("right", [(210000., 7.85e-9, 9810., 1.0), (2.1e11, 7850., 9.81, 1.0),
                                   (2.1e11, 7850., 9.81, 50.0), (5.0e6, 1100., 9.81, 0.01)])
def test_no_system_of_units_is_suspect(right, tmp_path):
    # A bridge in SI, and rubber in SI, were warned of.
    assert not said(lopin("check", heavy(*right), tmp_path), "W0401")


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


@pytest.mark.parametrize("steps, warns", [
    (["9, 2", "L"], True), (["L", "9, 2"], False), (["9, 2", "L", "NEW"], False),
    (["L9, 2", "NEW"], False), (["L9, 2", ""], True), (["L", "9, 2", "NEW"], False)])
def test_a_force_does_nothing_only_if_no_step_lets_it(steps, warns, tmp_path):
    """L: the force comes; 9, 2: its node is held; NEW: only the other supports are left."""
    text = ""
    for word in steps:
        text += "*STEP\n*STATIC\n"
        if word == "NEW":
            text += PARTS["supports"].replace("*BOUNDARY", "*BOUNDARY, OP=NEW")
        if "9" in word:
            text += "*BOUNDARY\n9, 2, 2, -0.01\n"
        if "L" in word:
            text += "*CLOAD\n9, 2, -5.\n"
        text += "*END STEP\n"
    run = lopin("check", deck(steps=text), tmp_path)
    assert run.returncode == 0 and len(said(run, "W0405")) == warns, run.stderr


PUSHED = "*BOUNDARY\n10, 1\n10, 6\n"
FLOOR = "*SURFACE, NAME=FLOOR, TYPE=SEGMENTS\nSTART, -20., -0.5\nLINE, 20., -0.5\n"
SOLE = "*SURFACE, NAME=SOLE\n1, S1\n2, S1\n"


def down(way, words="", times=""):
    return f"*STEP{words}\n*STATIC\n{times}*BOUNDARY\n10, 2, 2, {-way}\n*END STEP\n"


DRIFTING = {
    "plane strain": deck(supports=PUSHED, steps=down(0.01)),
    "plane stress": deck(supports=PUSHED, steps=down(0.01)).replace("CPE4", "CPS4"),
    "finite strain": deck(supports=PUSHED, steps=down(0.01, ", NLGEOM")),
    "without friction": deck(supports=PUSHED, steps=down(0.01, ", NLGEOM"),
                             pair=PARTS["pair"].replace("*FRICTION\n0.1\n", "")),
    "along the axis": deck(supports=PUSHED + "LEFT, 1\n", steps=down(0.01)).replace("CPE4", "CAX4"),
    "and rests": deck(supports=PUSHED, steps=down(0.01, ", NLGEOM") + down(0.01, ", NLGEOM")),
    "not far enough": deck(supports=PUSHED, steps=down(0.3, ", NLGEOM", "0.1, 1.\n"),
                           mesh=PARTS["mesh"] + SOLE, tool=PARTS["tool"] + FLOOR,
                           pair=PARTS["pair"] + "SOLE, FLOOR\n"),
}


@pytest.mark.parametrize("case", DRIFTING)
def test_a_body_that_a_tool_pushes_away_is_said(case, tmp_path):
    run = lopin("run", DRIFTING[case], tmp_path, "-o", "out")
    assert run.returncode == 0
    assert len(said(run, "W0515")) == 1 and "moved away as a whole" in run.stderr, run.stderr


def test_a_body_that_is_caught_or_held_does_not_drift(tmp_path):
    caught = deck(supports=PUSHED, steps=down(0.6, "", "0.1, 1.\n"), mesh=PARTS["mesh"] + SOLE,
                  tool=PARTS["tool"] + FLOOR, pair=PARTS["pair"] + "SOLE, FLOOR\n")
    carried = deck(supports=PUSHED, steps=down(0.01), pair=pair(", TIED"))
    for text in (caught, carried, deck()):
        run = lopin("run", text, tmp_path, "-o", "out", "--overwrite")
        assert run.returncode == 0 and not said(run, "W0515"), run.stderr


@pytest.mark.parametrize("step, press, way, flow", [
    (", NLGEOM", 0.02, 1.0, ""), ("", 0.01, 0.2, ""),
    (", NLGEOM", 0.1, 1.0, "*PLASTIC\n300., 0.\n600., 1.\n")])
@pytest.mark.parametrize("walled", [False, True])
def test_a_body_that_friction_sweeps_away_is_said(step, press, way, flow, walled, tmp_path):
    """A block on a table, under a ram that presses and moves aside: the wall is there, or not."""
    wall = ("*SURFACE, NAME=RIGHT\n2, S2\n*NODE\n12, 5., 0.\n*SURFACE, NAME=WALL, TYPE=SEGMENTS\n"
            "START, 10., -20.\nLINE, 10., 20.\n*RIGID BODY, ANALYTICAL SURFACE=WALL, REF NODE=12\n")
    floor = FLOOR.replace("-0.5", "0.") + "*RIGID BODY, ANALYTICAL SURFACE=FLOOR, REF NODE=11\n"
    slippery = "*SURFACE INTERACTION, NAME=OIL\n*FRICTION\n0.02\n*CONTACT PAIR, INTERACTION=OIL\n"
    moves = f"*BOUNDARY\n10, 2, 2, {-press}\n10, 1, 1, {{}}\n*END STEP\n"
    text = deck(mesh=PARTS["mesh"] + SOLE + (wall if walled else ""), tool=PARTS["tool"] + floor,
                material=PARTS["material"].replace("*SOLID", flow + "*SOLID"),
                pair=PARTS["pair"] + slippery + "SOLE, FLOOR\n" + ("RIGHT, WALL\n" if walled else ""),
                supports="*BOUNDARY\n10, 6\n11, 1, 2\n11, 6\n" + ("12, 1, 2\n12, 6\n" * walled),
                steps="".join(f"*STEP{step}\n*STATIC\n0.1, 1.\n" + moves.format(x)
                              for x in (0., way)))
    run = lopin("run", text, tmp_path, "-o", "out")
    assert run.returncode == 0, run.stderr
    assert len(said(run, "W0515")) == (0 if walled else 1), run.stderr
    assert walled or "nothing but contact and friction holds it" in run.stderr


def test_an_elastic_solid_stretched_beyond_any_metal_is_said(tmp_path):
    load = "*STEP, NLGEOM\n*STATIC\n0.1, 1.\n*DSLOAD\nTOP, P, {}\n*END STEP\n"
    text = deck(tool="", pair="", supports="*BOUNDARY\nBOTTOM, 2\n1, 1\n")
    few = text.replace(PARTS["steps"], load.format(20000.))
    many = text.replace(PARTS["steps"], load.format(400000.))
    assert not said(lopin("run", few, tmp_path, "-o", "out"), "W0516")
    run = lopin("run", many, tmp_path, "-o", "out", "--overwrite")
    assert said(run, "W0516"), run.stderr
    back = "*AMPLITUDE, NAME=BACK\n0., 0., 0.5, 1., 1., 0.\n" + load.format(400000.)
    back = text.replace(PARTS["steps"], back.replace("*DSLOAD", "*DSLOAD, AMPLITUDE=BACK"))
    run = lopin("run", back, tmp_path, "-o", "out", "--overwrite")
    assert said(run, "W0516"), run.stderr


def test_a_warning_that_holds_again_is_said_once_and_counted(tmp_path):
    text = deck(material=material("*PLASTIC, ONLY=FRICTION", "100."),
                steps=down(0.05, "", "0.1, 1., 0.1, 0.1\n"))
    run = lopin("run", text, tmp_path, "-o", "out")
    assert run.returncode == 0 and len(said(run, "W0508")) == 1
    assert re.search(r"said once: W0508 of line \d+ \d times", said(run, "N0505")[0])


LOADS = {
    "force on a support": ("W0405", "*CLOAD\n1, 1, 5.\n"),
    "force on no body": ("W0405", "*CLOAD\n11, 1, 5.\n"),
    "pressure inside": ("W0406", "*DLOAD\nBLOCK, P1, 1.\n"),
    "a face twice": ("N0407", "*DLOAD\n4, P2, 1.\n4, P2, 2.\n"),
    "a value after FIXED": ("W0405", "*BOUNDARY, FIXED\n9, 1, 1, 0.1\n"),
    "a value after XSYMM": ("W0405", "*BOUNDARY\nLEFT, XSYMM, 1, 0.1\n"),
    "degrees": ("N0402", "*BOUNDARY\n10, 6, 6, 90.\n"),
    "an amplitude too long": ("W0408", "*BOUNDARY, AMPLITUDE=SLOW\n10, 2, 2, -0.01\n"),
}


@pytest.mark.parametrize("case", LOADS)
def test_loads_that_cannot_mean_what_they_say(case, tmp_path):
    code, card = LOADS[case]
    text = deck(mesh="*AMPLITUDE, NAME=SLOW\n0., 0., 100., 1.\n" + PARTS["mesh"],
                supports="*BOUNDARY\nBOTTOM, 1, 2\n10, 1\n",
                steps=f"*STEP\n*STATIC\n{card}*END STEP\n")
    run = lopin("check", text, tmp_path)
    assert run.returncode == 0 and len(said(run, code)) == 1, run.stderr


def test_a_load_on_a_part_of_a_support_says_nothing(tmp_path):
    run = lopin("check", deck(steps="*STEP\n*STATIC\n*CLOAD\nLEFT, 1, 5.\n*BOUNDARY\n10, 2, 2, "
                                    "-0.01\n*END STEP\n"), tmp_path)
    assert run.returncode == 0 and run.stderr == ""


def test_check_tells_the_first_search_of_each_pair(tmp_path):
    run = lopin("check", deck(), tmp_path)
    assert "pair (TOP, TOOL): 3 slave nodes, 3 face the master" in run.stdout
    assert "gaps from 0 at node 7 (0, 10) to 0" in run.stdout
    assert "3 closed at the start" in run.stdout
    assert "outward side of TOOL there: (0, -1)" in run.stdout
    high = deck(tool=PARTS["tool"].replace("20., 10.", "20., 10.25").replace("-20.", "-1."))
    run = lopin("check", high, tmp_path)
    assert "gaps from 0.25 at node 7 (0, 10)" in run.stdout and "0 closed" in run.stdout
    short = deck(tool=PARTS["tool"].replace("START, 20.", "START, 6."))
    run = lopin("check", short, tmp_path)
    assert "2 face the master, 1 have none (first: node 9 (10, 10))" in run.stdout


def test_check_tells_of_a_gap_that_nothing_closes(tmp_path):
    far = deck(tool=PARTS["tool"].replace("10.\n", "11.\n"))
    assert "the pair will not close" in lopin("check", far, tmp_path).stdout
    load = deck(tool=PARTS["tool"].replace("10.\n", "11.\n"),
                steps="*STEP\n*STATIC\n*CLOAD\n10, 2, -1.\n*END STEP\n")
    assert "will not close" not in lopin("check", load, tmp_path).stdout
    assert "will not close" not in lopin("check", deck(), tmp_path).stdout


def test_check_finds_a_tool_on_the_wrong_side(tmp_path):
    text = deck(tool=PARTS["tool"].replace("START, 20.", "START, -20.").replace("LINE, -20.",
                                                                                "LINE, 20."))
    run = lopin("check", text, tmp_path)
    assert run.returncode == 1 and said(run, "E0312") and run.stdout == ""


@pytest.mark.parametrize("moves", [False, True])
def test_check_finds_a_curved_tool_whose_wrong_side_a_part_of_the_slave_looks_along(moves,
                                                                                    tmp_path):
    """A sheet over a die: backwards, its solid is where the sheet is, and no node is outside."""
    codes = []
    for points in ([(30.0, 21.0), (30.0, 6.0), (35.0, 1.0, (35.0, 6.0)), (60.0, 1.0)],
                   [(60.0, 1.0), (35.0, 1.0), (30.0, 6.0, (35.0, 6.0)), (30.0, 21.0)]):
        way = profile.start(*points[0])
        for p in points[1:]:
            way = way.arc_to(*p) if len(p) > 2 else way.line_to(*p)
        model = Model("sheet", mesh_make.block((40.0, 1.0), (20, 1)))
        model.section("ALL", Elastic(210e3, 0.3))
        die = model.rigid_tool("DIE", way)
        model.contact("TOP", die)
        model.fix("LEFT", "x")
        model.fix("RIGHT", "x", "y")
        model.step(4, nlgeom=True).move(die, y=-0.1*moves)
        run = lopin("check", model.to_deck().text(), tmp_path)
        codes.append((run.returncode, said(run, "E0312"), said(run, "W0315")))
    assert codes[0][0] == 1 and codes[0][1][0].startswith("15 of 21 ")
    assert codes[1] == (0, [], [])


def test_no_adjust_of_more_than_half_a_facet_is_proposed(tmp_path):
    for depth in (0.3, 2.4, 2.6, 7.0):
        tool = PARTS["tool"].replace("10.\n", f"{10. - depth}\n")
        run = lopin("check", deck(tool=tool), tmp_path)
        assert said(run, "E0311" if depth > 2.5 else "W0311"), run.stderr
        assert not re.search(r"ADJUST=[\d.]", run.stderr)
        assert ("ADJUST=YES" in run.stderr) == (depth < 2.5)


def test_an_adjust_over_more_than_half_a_facet_is_warned_of(tmp_path):
    tool = PARTS["tool"].replace("10.\n", "14.\n")
    run = lopin("check", deck(tool=tool, pair=pair(", ADJUST=5.")), tmp_path)
    assert "by 4 (80 % of a facet)" in said(run, "W0316")[0]
    tool = PARTS["tool"].replace("10.\n", "10.5\n")
    run = lopin("check", deck(tool=tool, pair=pair(", ADJUST=5.")), tmp_path)
    assert not said(run, "W0316") and said(run, "N0316")


@pytest.mark.parametrize("code, cards", [
    ("E0103", "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=EXPONENTIAL\n0.1, 10.\n0.2, 20.\n"),
    ("N0306", "*SURFACE BEHAVIOR, AUGMENTED LAGRANGE, PRESSURE-OVERCLOSURE=TABULAR\n"
              "0., 0.\n100., 0.1\n"),
    ("W0305", "*FRICTION\n"),
    ("W0305", "*SURFACE BEHAVIOR, NO SEPARATION, PRESSURE-OVERCLOSURE=TABULAR\n"
              "0., 0.\n100., 0.1\n"),
])
def test_data_of_an_interaction_that_would_be_lost(code, cards, tmp_path):
    run = lopin("check", deck(pair=pair("", cards)), tmp_path)
    assert len(said(run, code)) == 1, run.stderr


def sheared(behaviour, friction, words=", NLGEOM"):
    steps = (f"*STEP{words}\n*STATIC\n0.1, 1.\n*BOUNDARY\n10, 2, 2, -0.05\n10, 1, 1, 0.01\n"
             "*END STEP\n")
    return deck(pair=pair("", f"*SURFACE BEHAVIOR, {behaviour}\n{friction}"),
                supports="*BOUNDARY\nBOTTOM, 1, 2\n10, 6\n", steps=steps)


def drag(run, folder):
    assert run.returncode == 0, run.stderr
    lines = (folder/"out"/"deck_history.csv").read_text().splitlines()
    row = dict(zip(lines[0].split(","), lines[-1].split(",")))
    return float(next(v for k, v in row.items() if k.startswith("TOP-TOOL.force1")))


@pytest.mark.parametrize("friction", ["*FRICTION\n0.3\n", "*FRICTION, ROUGH\n",
                                      "*FRICTION\n0.3, 1.E4\n", "*FRICTION, TAUMAX=20.\n0.3\n"])
def test_a_straight_table_rubs_like_a_penalty(friction, tmp_path):
    """The table is the penalty's line: so is the shear, in finite sliding."""
    table = "PRESSURE-OVERCLOSURE=TABULAR\n0., 0.\n1.E6, 0.1"
    one = drag(lopin("run", sheared(table, friction), tmp_path, "-o", "out"), tmp_path)
    other = drag(lopin("run", sheared("PENALTY\n1.E7", friction), tmp_path, "-o", "out",
                       "--overwrite"), tmp_path)
    assert abs(one - other) < 0.005*abs(other)


@pytest.mark.parametrize("behaviour", ["PRESSURE-OVERCLOSURE=TABULAR\n0., 0.\n1.E6, 0.1"])
def test_an_elastic_slip_that_the_finite_path_cannot_have_is_said(behaviour, tmp_path):
    friction = "*FRICTION, ELASTIC SLIP=0.01\n0.3\n"
    run = lopin("run", sheared(behaviour, friction), tmp_path, "-o", "out")
    assert len(said(run, "W0305")) == 1 and "ELASTIC SLIP" in said(run, "W0305")[0]
    run = lopin("run", sheared(behaviour, friction, ""), tmp_path, "-o", "out", "--overwrite")
    assert not said(run, "W0305")


@pytest.mark.parametrize("slope", ["*FRICTION, ELASTIC SLIP=0.01\n0.3\n", "*FRICTION\n0.3, 1.E3\n",
                                   "*FRICTION\n0.3, 1.E9\n"])
@pytest.mark.parametrize("path", ["", None])
def test_augmentation_keeps_what_gives_way_along_the_face(slope, path, tmp_path):
    """It mends penetrations, not the slip before sliding that the deck asks for."""
    ways = [] if path is None else [path]
    one = drag(lopin("run", sheared("AUGMENTED LAGRANGE\n1.E6", slope, *ways), tmp_path, "-o", "out"),
               tmp_path)
    other = drag(lopin("run", sheared("DIRECT", slope, *ways), tmp_path, "-o", "out", "--overwrite"),
                 tmp_path)
    assert abs(one - other) < 2e-3*abs(other)


@pytest.mark.parametrize("words", ["", ", NLGEOM"])
def test_supports_that_press_a_node_into_a_tool_are_refused(words, tmp_path):
    text = deck(supports="*BOUNDARY\nBOTTOM, 1, 2\n7, 1, 2\n9, 1, 2\n8, 1, 2\n10, 1\n10, 6\n",
                steps=down(0.01, words))
    run = lopin("run", text, tmp_path, "-o", "out")
    assert run.returncode == 3 and "is overconstrained" in said(run, "E0506")[0], run.stderr


ABOVE = """*NODE, NSET=LID
31, 0., 10.
32, 5., 10.
33, 10., 10.
34, 0., 15.
35, 5., 15.
36, 10., 15.
*ELEMENT, TYPE=CPE4, ELSET=BLOCK
31, 31, 32, 35, 34
32, 32, 33, 36, 35
*SURFACE, NAME=UNDER
31, S1
32, S1
"""


def test_bodies_that_meet_node_on_node_and_that_nothing_joins(tmp_path):
    lid = {"mesh": PARTS["mesh"] + ABOVE, "tool": "", "pair": "", "steps":
           "*STEP\n*STATIC\n*BOUNDARY\n34, 2, 2, -0.01\n*END STEP\n",
           "supports": "*BOUNDARY\nBOTTOM, 1, 2\n34, 1, 2\n35, 1, 2\n"}
    run = lopin("check", deck(**lid), tmp_path)
    assert len(said(run, "W0306")) == 1 and "3 nodes at the same places" in run.stderr
    for join in ("*TIE, NAME=SEAM\nUNDER, TOP\n", "*EQUATION\n2\n31, 2, 1., 7, 2, -1.\n",
                 "*SURFACE INTERACTION, NAME=DRY\n*CONTACT PAIR, INTERACTION=DRY\nUNDER, TOP\n"):
        run = lopin("check", deck(**(lid | {"pair": join})), tmp_path)
        assert run.returncode == 0 and not said(run, "W0306"), run.stderr
    moved = ABOVE.replace("10.\n", "10.001\n")
    run = lopin("check", deck(**(lid | {"mesh": PARTS["mesh"] + moved})), tmp_path)
    assert not said(run, "W0306")


def test_a_pair_that_acts_in_no_step_is_said(tmp_path):
    gone = "*MODEL CHANGE, TYPE=CONTACT PAIR, REMOVE\nTOP, TOOL\n"
    back = gone.replace("REMOVE", "ADD")
    first = PARTS["steps"].replace("*END STEP", gone + "*END STEP")
    run = lopin("check", deck(steps=first), tmp_path)
    assert len(said(run, "W0303")) == 1 and "acts nowhere" in run.stderr
    second = PARTS["steps"].replace("*END STEP", back + "*END STEP")
    assert not said(lopin("check", deck(steps=first + second), tmp_path), "W0303")


def test_two_tools_may_have_one_reference_node(tmp_path):
    """A vice: both jaws are driven by one node, and the block between them goes along."""
    jaw = FLOOR.replace("-0.5", "0.") + "*RIGID BODY, ANALYTICAL SURFACE=FLOOR, REF NODE=10\n"
    text = deck(mesh=PARTS["mesh"] + SOLE, tool=PARTS["tool"] + jaw, supports=PUSHED,
                pair=pair(", TIED") + "*CONTACT PAIR, INTERACTION=DRY, TIED\nSOLE, FLOOR\n")
    run = lopin("run", text, tmp_path, "-o", "out")
    assert run.returncode == 0 and not said(run, "W0515"), run.stderr


@pytest.mark.parametrize("friction, warns", [
    ("*FRICTION, LAW=TRESCA\n0.5\n", True), ("*FRICTION, TAUMAX=10.\n0.3\n", True),
    ("*FRICTION\n0.3\n", False), ("*FRICTION, ROUGH\n", False)])
def test_a_bound_of_the_shear_stress_needs_areas(friction, warns, tmp_path):
    nodes = "*SURFACE, NAME=DOTS, TYPE=NODE\n7, {0}\n9, {0}\n"    # no face between them
    contact = pair("", friction).replace("TOP, TOOL", "DOTS, TOOL")
    steel = material("*PLASTIC, ONLY=FRICTION", "250.")
    text = deck(mesh=PARTS["mesh"] + nodes.format(""), pair=contact, material=steel)
    run = lopin("check", text, tmp_path)
    assert run.returncode == 0 and len(said(run, "W0307")) == warns, run.stderr
    for good in (nodes.format(3.3), nodes.format("") + "8,\n"):
        text = deck(mesh=PARTS["mesh"] + good, pair=contact, material=steel)
        run = lopin("check", text, tmp_path)
        assert not said(run, "W0307")
        assert len(said(run, "N0318")) == (warns and good.endswith("8,\n"))


def test_pressures_on_the_faces_of_a_body_say_nothing(tmp_path):
    faces = "*STEP\n*STATIC\n*DLOAD\n3, P4, 1.\n4, P2, 1.\n*DSLOAD\nSOLE, P, 1.\n*END STEP\n"
    run = lopin("check", deck(mesh=PARTS["mesh"] + SOLE, steps=faces), tmp_path)
    assert run.returncode == 0 and run.stderr == ""


@pytest.mark.parametrize("words", ["", ", NLGEOM"])
def test_a_table_that_begins_at_touch_holds_a_tool_that_a_force_drives(words, tmp_path):
    """Ten times ten wide: pressure 10, which the table has at a penetration of 0.01."""
    table = "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TABULAR\n0., 0.\n100., 0.1\n"
    text = deck(pair=pair("", table), steps=f"*STEP{words}\n*STATIC\n*CLOAD\n10, 2, -100.\n"
                                            "*END STEP\n")
    run = lopin("run", text, tmp_path, "-o", "out")
    assert run.returncode == 0, run.stderr
    lines = (tmp_path/"out"/"deck_history.csv").read_text().splitlines()
    row = dict(zip(lines[0].split(","), lines[-1].split(",")))
    deepest = next(v for k, v in row.items() if k.startswith("TOP-TOOL.max_penetration"))
    assert abs(float(deepest) - 0.01) < 1e-4


def test_faces_that_look_away_from_the_nearer_wall_of_a_groove_are_not_behind_it(solve):
    """The outside of a block beside a mandrel looks at the far wall of the groove, and meets it."""
    model = Model("groove", mesh_make.block((1.0, 1.0), (2, 2), origin=(1.0, 1.0)))
    model.section("ALL", Elastic(1000.0, 0.3))
    groove = model.rigid_tool("GROOVE", profile.start(0.9, 5.0).line_to(0.9, 0.0).line_to(4.0, 0.0)
                              .line_to(4.0, 5.0))
    model.contact("RIGHT", groove)
    model.fix("LEFT", "y")
    model.step(4, nlgeom=True).move("LEFT", x=2.1)
    result = solve(model.to_deck())
    assert "W0315" in [m["code"] for m in result.diagnostics]
    assert result.contact(0).last.pressure.min() > 50.0


@pytest.mark.parametrize("card", ["CONTACT PRINT", "CONTACT FILE"])
@pytest.mark.parametrize("words, wrong", [
    ("", False), (", SLAVE=TOP", False), (", MASTER=TOOL", False), (", SLAVE=TOP, MASTER=TOOL", False),
    (", SLAVE=TOOL", True), (", MASTER=TOP", True), (", SLAVE=TOOL, MASTER=TOP", True)])
def test_contact_output_of_surfaces_that_are_no_pair(tmp_path, card, words, wrong):
    """It was silent, and MASTER= alone asked for every pair; a later step says nothing again."""
    steps = PARTS["steps"].replace("*END STEP", f"*{card}{words}\nCSTR\n*END STEP") + PARTS["steps"]
    run = lopin("check", deck(steps=steps), tmp_path)
    assert run.returncode == 0 and len(said(run, "W0350")) == wrong, run.stderr
    if wrong:
        assert "pairs are: SLAVE=TOP, MASTER=TOOL" in run.stderr
