"""Rigid bodies of nodes under large rotation: their nodes go on circles, driven by rotations or by
moments, in the plane and in space."""
import numpy as np
import pytest

from test_references import run


def bar(space, held, drive, increment="0.1, 1."):
    """A bar 10 long of one row of cells; its end at x = 10 is a rigid body about a node at (12, 0.5).
    `held`: the other end is clamped, else the bar is free."""
    x = [(2.5*i, j, k) for k in range(2 if space else 1) for j in range(2) for i in range(5)]
    at = {p: n + 1 for n, p in enumerate(x)}
    ring = [(0, 0), (1, 0), (1, 1), (0, 1)]
    cells = []
    for i in range(4):
        nodes = [at[2.5*(i + a), b, k] for k in range(2 if space else 1) for a, b in ring]
        cells.append(f"{i + 1}, " + ", ".join(map(str, nodes)))
    n = 3 if space else 2
    nodes = [f"{at[p]}, " + ", ".join(map(str, p[:n])) for p in x]
    end = ", ".join(str(at[p]) for p in x if p[0] == 10)
    start = ", ".join(str(at[p]) for p in x if p[0] == 0)
    reference = "99, 12., 0.5" + (", 0.5" if space else "")
    lines = ["*NODE, NSET=ALL", *nodes, "*NODE, NSET=REF", reference,
             f"*ELEMENT, TYPE={'C3D8I' if space else 'CPE4I'}, ELSET=B", *cells, "*NSET, NSET=END",
             end, "*NSET, NSET=START", start, "*MATERIAL, NAME=M", "*ELASTIC", "1000., 0.3",
             "*SOLID SECTION, ELSET=B, MATERIAL=M", "1.,", "*RIGID BODY, NSET=END, REF NODE=99",
             "*BOUNDARY", *([f"START, 1, {n}"] if held else [f"REF, 1, {n}"]),
             "*STEP, NLGEOM, INC=1000", "*STATIC", increment, *drive,
             "*NODE PRINT, NSET=ALL", "U", "*END STEP", ""]
    return "\n".join(lines), x


def displacements(folder, count):
    """Of the last increment, by node."""
    rows, reading = [], False
    for line in (folder/"out/job.dat").read_text().splitlines():
        if line.strip()[:1].isalpha():
            reading = "displacements" in line
            if reading:
                rows = []
        elif reading and line.strip():
            rows.append([float(v) for v in line.split()])
    return np.array([row[1:] for row in rows[:count]])


def rotation(v):
    angle = np.linalg.norm(v)
    k = np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])/angle
    return np.eye(3) + np.sin(angle)*k + (1 - np.cos(angle))*k@k


@pytest.mark.parametrize("space, turn", [(False, (0, 0, 2.0)), (False, (0, 0, -3.1)),
                                         (True, (1.0, 0.7, -1.2)), (True, (0, 2.5, 0))])
@pytest.mark.parametrize("increment", ["0.1, 1.", "1., 1."])
def test_a_free_bar_turns_with_its_end(tmp_path, space, turn, increment):
    drive = ["*BOUNDARY"] + [f"REF, {4 + k}, {4 + k}, {turn[k]}" for k in range(3)
                             if space or k == 2]
    text, x = bar(space, False, drive, increment)
    done, summary, _ = run(tmp_path, text)
    assert done.returncode == 0, done.stderr
    assert "W0513" not in done.stderr and summary["certificate"]["verdict"] == "PASS"
    centre = np.array([12, 0.5, 0.5 if space else 0.0])
    exact = (rotation(np.array(turn)) - np.eye(3))@(np.array(x, float) - centre).T
    n = 3 if space else 2
    assert displacements(tmp_path, len(x))[:, :n] == pytest.approx(exact.T[:, :n], abs=1e-5)


@pytest.mark.parametrize("space", [False, True])
def test_a_moment_turns_as_far_as_its_rotation_asks_for_it(tmp_path, space):
    """A clamped bar bent to a quarter turn by rotation; the moment of that does the same."""
    turned, _ = bar(space, True, ["*BOUNDARY", "REF, 6, 6, 1.5"])
    done, _, rows = run(tmp_path, turned)
    assert done.returncode == 0, done.stderr
    end = rows[-1]
    moment = next(v for k, v in end.items() if k.endswith(".rm3") or k.endswith(".rf6"))
    place = [v for k, v in end.items() if k.endswith((".u1", ".u2"))]
    pushed, _ = bar(space, True, ["*CLOAD", f"REF, 6, {moment!r}"])
    done, _, rows = run(tmp_path, pushed)
    assert done.returncode == 0, done.stderr
    end = rows[-1]
    assert next(v for k, v in end.items() if k.endswith(".u6")) == pytest.approx(1.5, rel=1e-6)
    assert [v for k, v in end.items() if k.endswith((".u1", ".u2"))] == pytest.approx(place, rel=1e-6)
    # The tangent is that of the circles too: few iterations an increment.
    assert sum(row["iterations"] for row in rows) < 12*len(rows)


def test_small_rotations_without_nlgeom_stay_linear(tmp_path):
    text, _ = bar(False, False, ["*BOUNDARY", "REF, 6, 6, 1.5"])
    done, _, _ = run(tmp_path, text.replace(", NLGEOM", ""))
    assert "W0513" in done.stderr
