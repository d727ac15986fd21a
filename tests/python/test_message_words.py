"""Messages name the cause and the cure: plurals, elements that Lopin lacks, gaps without *GAP, a
limit load, a body that friction cannot hold."""
import subprocess

import pytest

CUBE = """*NODE
1, 0., 0., 0.
2, 1., 0., 0.
3, 1., 1., 0.
4, 0., 1., 0.
5, 0., 0., 1.
6, 1., 0., 1.
7, 1., 1., 1.
8, 0., 1., 1.
11, 0., 0., 1.
12, 1., 0., 1.
13, 1., 1., 1.
14, 0., 1., 1.
15, 0., 0., 2.
16, 1., 0., 2.
17, 1., 1., 2.
18, 0., 1., 2.
*ELEMENT, TYPE=C3D8, ELSET=A
1, 1, 2, 3, 4, 5, 6, 7, 8
*ELEMENT, TYPE=C3D8, ELSET=B
2, 11, 12, 13, 14, 15, 16, 17, 18
*SURFACE, NAME=AT
1, S2
*SURFACE, NAME=BB
2, S1
*SURFACE, NAME=BT
2, S2
*MATERIAL, NAME=M
*ELASTIC
210000., 0.3
*SOLID SECTION, ELSET=A, MATERIAL=M
*SOLID SECTION, ELSET=B, MATERIAL=M
*NSET, NSET=X
1, 4, 5, 8, 11, 14, 15, 18
*NSET, NSET=Y
1, 2, 5, 6, 11, 12, 15, 16
*NSET, NSET=Z
1, 2, 3, 4
*BOUNDARY
X, 1
Y, 2
Z, 3
*TIE, NAME=T
BB, AT
"""
STEP = "*STEP\n*STATIC{static}\n*DSLOAD\nBT, P, 100.\n*END STEP\n"


@pytest.fixture
def told(executable, tmp_path):
    def run(text, task="check"):
        (tmp_path/"job.inp").write_text(text)
        words = ["-o", "out"] if task == "run" else []
        done = subprocess.run([executable, task, "job.inp", *words], capture_output=True, text=True,
                              cwd=tmp_path, timeout=30)
        return done.stderr + done.stdout
    return run


@pytest.mark.parametrize("cards, words", [
    ("*SPRING, ELSET=W\n\n1.\n", "no set of spring elements `W`; sets of spring elements defined"),
    ("*SOLID SECTION, ELSET=A, MATERIAL=M, CONTROLS=C\n", "`C`; section controls defined: none"),
    ("*COUPLING\n", "couplings (*RIGID BODY exists) come with a later version"),
    ("*UNIAXIAL TEST DATA\n", "constants fitted to tests come with a later version"),
    ("*RIGID SURFACE\n", "exists) comes with a later version"),
    ("*ELEMENT, TYPE=GAPUNI, ELSET=G\n21, 1, 11\n", "gap elements of `G` have no *GAP"),
    ("*ELEMENT, TYPE=GAPUNI\n21, 1, 11\n", "gap elements are in no set"),
    ("*ELEMENT, TYPE=SPRINGA, ELSET=G\n21, 1, 11\n", "spring elements of `G` have no *SPRING")])
def test_plurals_and_missing_cards(told, cards, words):
    assert words in told(CUBE + cards + STEP.format(static=""))


@pytest.mark.parametrize("word, nodes", [
    ("T3D2", 2), ("B31", 2), ("PIPE31", 2), ("S4", 4), ("S4RS", 4), ("S3", 3), ("STRI3", 3), ("M3D4", 4)])
@pytest.mark.parametrize("alone", [False, True])
def test_trusses_beams_shells_and_membranes_are_told_as_such(told, word, nodes, alone):
    text = CUBE + f"*ELEMENT, TYPE={word}, ELSET=S\n31, {', '.join('1234'[:nodes])}\n"
    if alone:
        text = text.replace("TYPE=C3D8", f"TYPE={word}")
    said = told(text + STEP.format(static=""))
    assert "there are no " in said and "instead of a truss SPRINGA" in said
    assert "mix dimensions" not in said and "did you mean" not in said


def test_flat_solids_beside_bricks_still_mix_dimensions(told):
    said = told(CUBE + "*ELEMENT, TYPE=CPS4, ELSET=S\n31, 1, 2, 3, 4\n" + STEP.format(static=""))
    assert "CPS4 cannot stand beside C3D8: one scene does not mix dimensions" in said


@pytest.mark.parametrize("name", ['"my part-1".Low', '"MY PART-1.Low"', 'MY PART-1."low"'])
def test_quotes_around_a_part_of_a_name(told, name):
    """In a parameter and in a data line."""
    text = f"""*PART, NAME="my part"
{CUBE.split("*SURFACE")[0]}*NSET, NSET=LOW
1, 2, 3, 4
*SOLID SECTION, ELSET=A, MATERIAL=M
*SOLID SECTION, ELSET=B, MATERIAL=M
*END PART
*ASSEMBLY, NAME=ALL
*INSTANCE, NAME="my part-1", PART="my part"
*END INSTANCE
*NSET, NSET=AGAIN
{name}
*END ASSEMBLY
*MATERIAL, NAME=M
*ELASTIC
1., 0.
*BOUNDARY
{name}, 1, 3
AGAIN, 3
*STEP
*STATIC
*NODE PRINT, NSET={name}
U
*END STEP
"""
    said = told(text)
    assert "E0201" not in said and "no error" in said, said


def test_a_limit_load_is_named_before_the_tied_body(told):
    metal = CUBE.replace("210000., 0.3\n", "210000., 0.3\n*PLASTIC\n50., 0.\n60., 0.1\n")
    said = told(metal + STEP.format(static="\n1., 1., 0.3"), "run")
    assert "metal flows at a limit load, or body B can move along z" in said
    assert "1 free rigid motion\n" in said


def rows(n, b, first):
    """n quadrilaterals in a row, on y from b to b + 1, by the labels of their nodes and cells."""
    nodes = "".join(f"{first + i + (n + 1)*j}, {i/n}, {float(b + j)}\n"
                    for j in range(2) for i in range(n + 1))
    cells = "".join(f"{first + i}, {first + i}, {first + i + 1}, {first + i + n + 2}, {first + i + n + 1}\n"
                    for i in range(n))
    name = "AB"[b]
    faces = "".join(f"*SURFACE, NAME={name}{side}\n{name}, S{side}\n" for side in (1, 3))
    return f"*NODE\n{nodes}*ELEMENT, TYPE=CPE4, ELSET={name}\n{cells}{faces}"


METAL = """*MATERIAL, NAME=M
*ELASTIC
1.E5, 0.3
*DENSITY
1.
*SOLID SECTION, ELSET=B, MATERIAL=M
*SURFACE INTERACTION, NAME=C
"""


def test_hard_contact_has_no_error_of_a_penalty(told):
    """Tie and contact the other way round hold the same faces: rounding is all that tells them
    apart."""
    both = ""
    for n in (1, 3):
        held = "".join(f"{k}, 1\n" for k in (1, n + 2, 101, 102 + n)) \
            + "".join(f"{1 + i}, 2\n" for i in range(n + 1))
        both += told(rows(n, 0, 1) + rows(n, 1, 101) + METAL + "*SOLID SECTION, ELSET=A, MATERIAL=M\n"
                     "*TIE, NAME=T\nB1, A3\n*CONTACT PAIR, INTERACTION=C\nA3, B1\n*BOUNDARY\n" + held
                     + "*STEP\n*STATIC\n*DSLOAD\nB3, P, 100.\n*END STEP\n", "run")
    assert "gaps at odds with the contact forces" in both, both
    assert "penalty" not in both


def incline(n, mu):
    """A block on a floor, under gravity that leans by mu = 0.2."""
    return rows(n, 1, 101) + METAL + f"""*FRICTION
{mu}
*NODE
9, 0., 1.
*SURFACE, NAME=PLANE, TYPE=SEGMENTS
START, -9., 1.
LINE, 9., 1.
*RIGID BODY, ANALYTICAL SURFACE=PLANE, REF NODE=9
*CONTACT PAIR, INTERACTION=C
B1, PLANE
*BOUNDARY
9, 1, 2
9, 6
*STEP
*STATIC
*DLOAD
B, GRAV, 10., 0.2, -1., 0.
*END STEP
"""


@pytest.mark.parametrize("n, mu, held", [(1, 0.199, False), (2, 0.1, False), (4, 0.19, False),
                                         (6, 0.19, False), (6, 0.199, False), (4, 0.201, True)])
def test_a_body_that_friction_cannot_hold_slides(told, n, mu, held):
    said = told(incline(n, mu), "run")
    assert ("certificate: PASS" in said) == held, said
    assert ("contact and friction do not hold it" in said) != held, said
    assert held or "help: more friction" in said


def test_the_executable_knows_the_commands_of_the_package(executable):
    from lopin.__main__ import PYTHON_COMMANDS

    said = subprocess.run([executable, "nonsense"], capture_output=True, text=True, check=False)
    assert said.returncode == 2
    listed = said.stderr.split("commands:")[1].split(";")[0].replace(",", " ").split()
    assert set(PYTHON_COMMANDS) <= set(listed)
