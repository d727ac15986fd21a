"""Local axes of *TRANSFORM hold for rotations and moments of reference nodes as for translations:
a scene that is turned as a whole has the same answer in its own axes."""
import numpy as np
import pytest

from test_references import EXECUTABLE, run

pytestmark = pytest.mark.skipif(not EXECUTABLE, reason="LOPIN_EXECUTABLE names no executable")

TURNED = {"x90": np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]),
          "any": np.linalg.qr(np.array([[0.4, 0.8, -0.3], [0.7, -0.2, 0.9], [0.1, 0.5, 0.6]]))[0]}
TURNED["any"] *= np.linalg.det(TURNED["any"])


def brick(first, low, high, q, names, n=2):
    """n by n by 1 elements C3D8 between two corners; the sets NAME.LOW and NAME.HIGH."""
    x = [np.array(low) + np.array([i/n, j/n, k])*(np.array(high) - low)
         for k in range(2) for j in range(n + 1) for i in range(n + 1)]
    m = n + 1
    nodes = [f"{first + i}, " + ", ".join(f"{v:.17g}" for v in q@p) for i, p in enumerate(x)]
    cells = []
    for j in range(n):
        for i in range(n):
            a = first + i + m*j
            ring = [a, a + 1, a + 1 + m, a + m]
            ring += [r + m*m for r in ring]
            cells.append(f"{first + len(cells)}, " + ", ".join(map(str, ring)))
    ends = [", ".join(str(first + k*m*m + i) for i in range(m*m)) for k in range(2)]
    return ["*NODE", *nodes, f"*ELEMENT, TYPE=C3D8, ELSET={names}", *cells,
            f"*NSET, NSET={names}.LOW", ends[0], f"*NSET, NSET={names}.HIGH", ends[1],
            f"*SURFACE, NAME={names}.S1", f"{names}, S1", f"*SURFACE, NAME={names}.S2",
            f"{names}, S2"]


def line(v):
    return ", ".join(f"{float(x):.17g}" for x in v)


def scene(q, tool, nlgeom, steps, rot_node=False):
    """A block whose top is a rigid body about TREF; under it a tool about PREF: a plane, elements,
    or none, and the block is clamped."""
    text = [*brick(1, [0, 0, 0], [1, 1, 0.5], q, "B"),
            "*NODE, NSET=TREF", "901, " + line(q@[0.5, 0.5, 0.5]),
            "*NODE, NSET=PREF", "902, " + line(q@[0.5, 0.5, 0.0]),
            "*NODE, NSET=TROT", "903, 0, 0, 0",
            "*MATERIAL, NAME=M", "*ELASTIC", "20000., 0.3", "*SOLID SECTION, ELSET=B, MATERIAL=M",
            "*RIGID BODY, NSET=B.HIGH, REF NODE=901" + (", ROT NODE=903" if rot_node else "")]
    if tool == "plane":
        text += ["*SURFACE, NAME=P, TYPE=CYLINDER", "0, 0, 0, " + line(q[:, 0]), line(-q[:, 1]),
                 "START, -30, 0", "LINE, 30, 0",
                 "*RIGID BODY, ANALYTICAL SURFACE=P, REF NODE=902"]
    elif tool == "mesh":
        text += [*brick(101, [-1, -1, -1], [2, 2, 0], q, "T", 1),
                 "*SOLID SECTION, ELSET=T, MATERIAL=M", "*RIGID BODY, ELSET=T, REF NODE=902"]
    if tool:
        text += ["*SURFACE INTERACTION, NAME=I", "*SURFACE BEHAVIOR, DIRECT", "*FRICTION", "0.3,",
                 "*CONTACT PAIR, INTERACTION=I, TYPE=NODE TO SURFACE",
                 "B.S1, " + ("P" if tool == "plane" else "T.S2")]
    else:
        text += ["*BOUNDARY", "B.LOW, 1, 3"]
    sets = ["TREF", *(["TROT"] if rot_node else []), *(["PREF"] if tool else [])]
    for name in sets:
        text += [f"*TRANSFORM, NSET={name}", line([*q[:, 0], *q[:, 1]])]
    for step in steps:
        text += ["*STEP, INC=200" + ", NLGEOM"*nlgeom, "*STATIC", "0.5, 1", *step,
                 "*OUTPUT, HISTORY", "*NODE OUTPUT, NSET=TREF", "U, RF",
                 *(["*NODE OUTPUT, NSET=PREF", "U, RF"] if tool else []), "*END STEP"]
    return "\n".join([*text, ""])


def answer(folder, deck, q):
    """Displacements, rotations, forces and moments of the nodes in the axes of the scene."""
    folder.mkdir()
    done, summary, rows = run(folder, deck)
    assert done.returncode == 0, done.stderr
    assert summary["certificate"]["verdict"] == "PASS"
    last = rows[-1]
    found = []
    for node in ("B.HIGH", "P" if any(key.startswith("P.") for key in last) else "T"):
        for kind, number in (("u", 0), ("u", 3), ("rf", 0), ("rf", 3)):
            ends = [f"{node}.{kind}{number + k}" for k in (1, 2, 3)]
            found.append(q.T@[last.get(e, 0.0) for e in ends])
    return np.array(found)


PRESSED = ["*BOUNDARY", "TREF, 1, 2", "TREF, 4, 6", "PREF, 1, 5", "PREF, 6, 6, 0.", "*CLOAD",
           "TREF, 3, -60"]
CASES = {
    "plane spins": ("plane", [PRESSED, ["*BOUNDARY", "PREF, 6, 6, 0.02"]]),
    "mesh spins": ("mesh", [PRESSED, ["*BOUNDARY", "PREF, 6, 6, 0.02"]]),
    "top turns": (None, [["*BOUNDARY", "TREF, 4, 4, 0.01", "TREF, 6, 6, -0.02", "TREF, 1, 3"]]),
    "moment": (None, [["*CLOAD", "TREF, 4, 1.", "TREF, 5, 2.", "TREF, 6, -3."]]),
}


@pytest.mark.parametrize("nlgeom", [False, True])
@pytest.mark.parametrize("case", CASES)
def test_a_turned_scene_has_the_same_answer(tmp_path, case, nlgeom):
    tool, steps = CASES[case]
    one = answer(tmp_path/"one", scene(np.eye(3), tool, nlgeom, steps), np.eye(3))
    assert max(abs(one[0]).max(), abs(one[1]).max(), abs(one[5]).max()) > 0
    for name, q in TURNED.items():
        other = answer(tmp_path/name, scene(q, tool, nlgeom, steps), q)
        for a, b in zip(*(f.reshape(-1, 4, 3).swapaxes(0, 1) for f in (one, other))):
            assert b == pytest.approx(a, rel=1e-6, abs=1e-7*max(abs(a).max(), 1e-3))


@pytest.mark.parametrize("nlgeom", [False, True])
def test_gaps_that_are_rounding_leave_a_pressed_block_symmetric(tmp_path, nlgeom):
    """A block that rests on a plane is pressed on it, in axes by which its gaps are rounding: it spreads
    to all sides alike. A node that rounding holds apart has not moved before it touched."""
    chance = np.random.default_rng(1)
    for k in range(6):
        q = np.linalg.qr(chance.normal(size=(3, 3)))[0]
        q *= np.linalg.det(q)
        folder = tmp_path/str(k)
        folder.mkdir()
        done, _, rows = run(folder, scene(q, "plane", nlgeom, [PRESSED]))
        assert done.returncode == 0, done.stderr
        for row in rows:
            force = q.T@[row[f"P.rf{k}"] for k in (1, 2, 3)]
            assert force[2] > 20.0 and abs(force[:2]).max() < 1e-9*force[2]


@pytest.mark.parametrize("nlgeom", [False, True])
def test_a_rotation_node_has_the_axes_of_rotations(tmp_path, nlgeom):
    steps = [["*BOUNDARY", "TREF, 1, 3", "TROT, 1, 1, 0.01", "TROT, 3, 3, -0.02"]]
    one = answer(tmp_path/"one", scene(np.eye(3), None, nlgeom, steps, True), np.eye(3))
    q = TURNED["any"]
    other = answer(tmp_path/"other", scene(q, None, nlgeom, steps, True), q)
    assert abs(one[1]).max() == pytest.approx(0.02)
    assert other[:4] == pytest.approx(one[:4], rel=1e-6, abs=1e-7*abs(one).max())


@pytest.mark.parametrize("nlgeom", [False, True])
def test_equations_between_rotations_are_in_local_axes(tmp_path, nlgeom):
    equation = "*EQUATION\n2\nTREF, 5, 1., TREF, 6, -2.\n"
    steps = [["*CLOAD", "TREF, 4, 1.", "TREF, 6, -3."]]

    def deck(q):
        return scene(q, None, nlgeom, steps).replace("*STEP", equation + "*STEP", 1)

    one = answer(tmp_path/"one", deck(np.eye(3)), np.eye(3))
    q = TURNED["any"]
    other = answer(tmp_path/"other", deck(q), q)
    assert one[1][1] == pytest.approx(2*one[1][2]) and abs(one[1][1]) > 0
    assert other[:2] == pytest.approx(one[:2], rel=1e-6, abs=1e-9)


BLOCK = """*MATERIAL, NAME=M
*ELASTIC
20000., 0.3
*NODE, NSET=B
{nodes}
*ELEMENT, TYPE=CPE4, ELSET=E
1, 1, 2, 5, 4
2, 2, 3, 6, 5
*SOLID SECTION, ELSET=E, MATERIAL=M
1.,
*SURFACE, NAME=LOW
1, S1
2, S1
*NSET, NSET=TOP
4, 5, 6
*NODE, NSET=TREF
8, {tref}
*NODE, NSET=FREF
9, 0, 0
*RIGID BODY, NSET=TOP, REF NODE=8
*SURFACE, NAME=FLOOR, TYPE=SEGMENTS
START, {start}
LINE, {end}
*RIGID BODY, ANALYTICAL SURFACE=FLOOR, REF NODE=9
*SURFACE INTERACTION, NAME=I
*SURFACE BEHAVIOR, DIRECT
*FRICTION
{friction},
*CONTACT PAIR, INTERACTION=I, TYPE=NODE TO SURFACE
LOW, FLOOR
*BOUNDARY
FREF, 1, 2
FREF, 6
TREF, 6
TREF, 1, 1, 0.
"""


def pressed(q, steps, friction=0.3, law=None):
    """Two elements on a plane floor, their upper nodes a rigid body, pressed on it and pushed."""
    at = [q@[0.5*i, 0.5*j] for j in range(2) for i in range(3)]
    text = BLOCK.format(nodes="\n".join(f"{i + 1}, {line(p)}" for i, p in enumerate(at)),
                        tref=line(q@[0.5, 0.5]), start=line(q@[-30.0, 0]), end=line(q@[30.0, 0]),
                        friction=friction)
    if law:
        text = text.replace(*law)
    return text + "".join(steps)


OUTPUT = "*OUTPUT, HISTORY\n*NODE OUTPUT, NSET=FREF\nU, RF\n*END STEP\n"


def test_local_axes_of_followers_leave_a_floating_body_found(tmp_path):
    """A block that only contact holds, and the nodes of its rigid end have local axes too."""
    found = []
    for q in (np.eye(2), np.array([[0.8, -0.6], [0.6, 0.8]])):
        step = ["*NSET, NSET=EVERY\nB, TREF, FREF\n*TRANSFORM, NSET=EVERY\n",
                line([*q[:, 0], 0, *q[:, 1], 0]),
                "\n*STEP\n*STATIC\n*CLOAD\nTREF, 2, -20\n", OUTPUT]
        done, summary, rows = run(tmp_path, pressed(q, step))
        assert done.returncode == 0, done.stderr
        assert summary["certificate"]["verdict"] == "PASS"
        found.append(q.T@[rows[-1]["FLOOR.rf1"], rows[-1]["FLOOR.rf2"]])
    assert found[0] == pytest.approx([0.0, 20.0], abs=1e-9)
    assert found[1] == pytest.approx(found[0], abs=1e-9)


def test_sliding_along_one_plane_is_exact_and_silent(tmp_path):
    """Half a facet along a plane: no W0505, and the moment on the plane goes on with the block."""
    steps = ["*STEP{0}\n*STATIC\n*CLOAD\nTREF, 2, -20\n" + OUTPUT,
             "*STEP{0}, INC=100\n*STATIC\n0.1, 1.\n*BOUNDARY\nTREF, 1, 1, 0.25\n" + OUTPUT]
    last = []
    for how in ("", ", NLGEOM"):
        done, _, rows = run(tmp_path, pressed(np.eye(2), [s.format(how) for s in steps]))
        assert done.returncode == 0 and "W0505" not in done.stderr, done.stderr
        last.append([rows[-1][f"FLOOR.rf{k}"] for k in (1, 2, 6)])
    assert last[0][:2] == pytest.approx([6.0, 20.0] if last[0][0] > 0 else [-6.0, 20.0])
    assert last[0] == pytest.approx(last[1], rel=2e-3)


def test_a_free_tool_may_tilt_under_a_pressure_that_moves(tmp_path):
    steps = ["*STEP\n*STATIC\n*CLOAD\nTREF, 2, -20\n" + OUTPUT,
             "*STEP\n*STATIC\n*BOUNDARY\nTREF, 1, 1, 0.25\n" + OUTPUT]
    text = pressed(np.eye(2), steps, 0.0, (
        "FREF, 6\n", "*EQUATION\n2\nFREF, 6, 1., TREF, 6, -1.\n*BOUNDARY\n"))
    done, _, _ = run(tmp_path, text)
    assert done.returncode == 0 and "W0505" in done.stderr, done.stderr


@pytest.mark.parametrize("law", ["ARCTAN", "TANH", "SQRT"])
@pytest.mark.parametrize("nlgeom", ["", ", NLGEOM"])
def test_friction_regularised_by_slip_loses_no_work(tmp_path, law, nlgeom):
    steps = ["*STEP{0}\n*STATIC\n*CLOAD\nTREF, 2, -20\n" + OUTPUT,
             "*STEP{0}, INC=100\n*STATIC\n0.05, 1., 1e-5, 0.05\n*BOUNDARY\nTREF, 1, 1, 0.02\n"
             + OUTPUT]
    text = pressed(np.eye(2), [s.format(nlgeom) for s in steps], law=(
        "*FRICTION\n", f"*FRICTION, REGULARIZATION={law}, ELASTIC SLIP=0.01\n"))
    done, _, rows = run(tmp_path, text)
    assert done.returncode == 0 and "W0530" not in done.stderr, done.stderr
    held = rows[-1]["energy.contact"] + rows[-1]["energy.friction"]
    assert held == pytest.approx(rows[-1]["energy.external"] - rows[-1]["energy.strain"], rel=0.02)


LAWS = {"TABULAR": "0., 0.\n10., 0.001\n100., 0.002\n400., 0.003", "EXPONENTIAL": "5., 0.002"}


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("increments", [1, 20])
def test_a_pressure_law_holds_the_area_of_its_curve(tmp_path, law, increments):
    step = [f"*STEP, NLGEOM, INC=100\n*STATIC\n{1/increments}, 1., 1e-5, {1/increments}\n"
            "*CLOAD\nTREF, 2, -100\n" + OUTPUT]
    text = pressed(np.eye(2), step, 0.0, (
        "*SURFACE BEHAVIOR, DIRECT",
        f"*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE={law}\n{LAWS[law]}"))
    text = text.replace("*FRICTION\n0.0,\n", "").replace("20000., 0.3", "20000., 0.")
    done, _, rows = run(tmp_path, text)
    assert done.returncode == 0 and "W0530" not in done.stderr, done.stderr
    # The pressure is 100 everywhere.
    area = {"TABULAR": 0.5*10*0.001 + 55*0.001}
    if law in area:
        assert rows[-1]["energy.contact"] == pytest.approx(area[law], rel=0.02)
    assert rows[-1]["energy.contact"] > 0
