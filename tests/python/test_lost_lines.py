"""Keyword lines that are lost or lack their star, values in the field of a dof, and rigid bodies that
are free to turn: one message each, at the line itself, with what to write."""
import re
import subprocess

import pytest

from test_small_commands import PRESSED

MOVES = "*BOUNDARY, AMPLITUDE=PULSE\n9, 2, 2, -0.2\n"


def check(executable, tmp_path, text):
    (tmp_path/"job.inp").write_text(text)
    return subprocess.run([executable, "check", "job.inp"], capture_output=True, text=True,
                          cwd=tmp_path)


def changed(old, new):
    assert old in PRESSED
    return PRESSED.replace(old, new, 1)


LOST = {
    "END STEP": (changed("*END STEP", "END STEP"), "write *END STEP"),
    "end step": (changed("*END STEP", "  end step"), "write *end step"),
    "STEP": (changed("*STEP", "STEP"), "write *STEP"),
    "CONTACT PAIR": (changed("*CONTACT PAIR", "CONTACT PAIR"), "write *CONTACT PAIR, INTERACTION"),
    "SURFACE": (changed("*SURFACE, NAME=TOP", "SURFACE, NAME=TOP"), "write *SURFACE, NAME=TOP"),
    "STATIC": (changed("*STATIC", "STATIC"), "write *STATIC, with its star"),
    "*STATIC": (changed("*STATIC\n", ""), "write *STATIC, with its star"),
    "*BOUNDARY": (changed(MOVES, MOVES.split("\n", 1)[1]), "the keyword line that is lost"),
    "*ELASTIC": (changed("*ELASTIC\n", ""), "a keyword line is lost above it"),
    "*ELEMENT": (changed("*ELEMENT, TYPE=CPE4, ELSET=BLOCK\n", ""), "a keyword line is lost above it"),
    "*CONTACT PAIR": (changed("*CONTACT PAIR, INTERACTION=SOFT\n", ""), "a keyword line is lost"),
    "last dof": (changed("9, 2, 2, -0.2", "9, 2, -0.2"), "write 9, 2, 2, -0.2"),
    "last dof, whole": (changed("9, 2, 2, -0.2", "9, 2, -2"), "write 9, 2, 2, -2"),
    "last dof, large": (changed("9, 2, 2, -0.2", "9, 2, 20"), "write 9, 2, 2, 20"),
    "REF NODE": (changed("REF NODE=9", "REF NODE=99"), "node 99 does not exist"),
    "nu": (changed("1000., 0.\n", "1000., 3\n"), "is a decimal point lost?"),
}


@pytest.mark.parametrize("case", LOST)
def test_a_lost_line_is_one_message(case, executable, tmp_path):
    text, says = LOST[case]
    run = check(executable, tmp_path, text)
    assert run.returncode == 1 and run.stderr.count("error[") == 1, run.stderr
    assert says in run.stderr


def test_sets_may_be_called_as_keywords(executable, tmp_path):
    named = PRESSED.replace("*BOUNDARY\n1, 1, 2", "*NSET, NSET=STATIC_\n1\n*NSET, NSET=SPRING\n1\n"
                            "*NSET, NSET=BOTH\nSPRING, STATIC_\n*BOUNDARY\nSPRING, 1, 2", 1)
    assert check(executable, tmp_path, named).returncode == 0
    assert check(executable, tmp_path, "*HEADING\nSTEP\nEND STEP, A=1\n" + PRESSED).returncode == 0


STEP = PRESSED[PRESSED.index("*STEP"):]
PLAIN = PRESSED[:PRESSED.index("*AMPLITUDE")]


@pytest.mark.parametrize("ways, away", [
    ([0.2], True), ([-0.2], False), ([0.2, 0.3], True), ([0.2, -0.1], False), ([0.2, 0.0], True),
    ([0.0], False)])
def test_a_tool_that_moves_away_is_said_before_the_run(ways, away, executable, tmp_path):
    steps = "".join(STEP.replace(MOVES, f"*BOUNDARY\n9, 2, 2, {way}\n") for way in ways)
    run = check(executable, tmp_path, PLAIN + steps)
    assert run.returncode == 0 and run.stderr.count("W0343") == away, run.stderr
    loaded = steps.replace("*OUTPUT", "*CLOAD\n3, 2, 1.\n*OUTPUT", 1)
    assert "W0343" not in check(executable, tmp_path, PLAIN + loaded).stderr


def test_a_pulse_comes_back(executable, tmp_path):
    for sign in (1, -1):
        text = PRESSED.replace("9, 2, 2, -0.2", f"9, 2, 2, {0.2*sign}")
        assert "W0343" not in check(executable, tmp_path, text).stderr


BALL = PRESSED.replace("START, 9., 1.\nLINE, -9., 1.", "START, 3.5, 4.\nCIRCL, 0.5, 1., 0.5, 4.\n"
                       "CIRCL, -2.5, 4., 0.5, 4.").replace("9, 0., 2.", "9, 0.5, 4.")


@pytest.mark.parametrize("text, turns", [
    (BALL, False), (BALL.replace("9, 6\n", ""), True),
    (BALL.replace("9, 6\n", "").replace("*OUTPUT", "*CLOAD\n9, 6, 1.\n*OUTPUT"), False)])
def test_a_ball_that_is_free_to_turn_is_said(text, turns, executable, tmp_path):
    run = check(executable, tmp_path, text)
    said = re.findall(r"note\[N0305\].*", run.stderr)
    assert len(said) == turns, run.stderr
    assert not turns or "RAM is moved and free to turn about z: nothing prescribes dof 6" in said[0]


def test_axes_that_are_free_are_listed_with_blanks(executable, tmp_path):
    text = """*NODE
1, 0., 0., 0.
2, 1., 0., 0.
3, 1., 1., 0.
4, 0., 1., 0.
5, 0., 0., 1.
6, 1., 0., 1.
7, 1., 1., 1.
8, 0., 1., 1.
9, 0., 0., 1.
*ELEMENT, TYPE=C3D8, ELSET=B
1, 1, 2, 3, 4, 5, 6, 7, 8
*SURFACE, NAME=TOP
B, S2
*MATERIAL, NAME=M
*ELASTIC
1., 0.
*SOLID SECTION, ELSET=B, MATERIAL=M
*SURFACE, NAME=BALL, TYPE=REVOLUTION
0., 0., 2., 0., 0., 3.
START, 1., 0.
CIRCL, 0., -1., 0., 0.
*RIGID BODY, ANALYTICAL SURFACE=BALL, REF NODE=9
*SURFACE INTERACTION, NAME=I
*CONTACT PAIR, INTERACTION=I
TOP, BALL
*BOUNDARY
1, 1, 3
2, 1, 3
3, 1, 3
9, 1, 4
*STEP
*STATIC
*BOUNDARY
9, 3, 3, -0.1
*END STEP
"""
    run = check(executable, tmp_path, text)
    assert "free to turn about y or z: nothing prescribes dofs 5 and 6 of node 9" in run.stderr, run.stderr
