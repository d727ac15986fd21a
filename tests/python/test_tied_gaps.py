"""Ties across a gap are rigid arms that turn with the bodies: they keep the balance of moments, and
a rigid rotation strains nothing."""
import numpy as np
import pytest

from test_references import EXECUTABLE, run

pytestmark = pytest.mark.skipif(not EXECUTABLE, reason="LOPIN_EXECUTABLE names no executable")

FACES = {2: ("S1", "S3"), 3: ("S1", "S2")}


def block(name, first, low, high, cells, q):
    """A block of CPE4 or C3D8; sets NAME.LOW and NAME.HIGH of its lowest and highest nodes, faces
    NAME.S1 and NAME.S2 there. The last direction is upward."""
    d = len(cells)
    shape = [c + 1 for c in cells]
    low, high = np.array(low, float), np.array(high, float)
    at, x = {}, []
    for index in np.ndindex(*shape[::-1]):
        at[index[::-1]] = first + len(x)
        x.append(low + (high - low)*np.array(index[::-1])/cells)
    ring = [(0, 0), (1, 0), (1, 1), (0, 1)]
    corners = ring if d == 2 else [(*r, k) for k in (0, 1) for r in ring]
    lines, ends = [], ([], [])
    for index in np.ndindex(*cells[::-1]):
        i = index[::-1]
        label = first + len(lines)
        lines.append(f"{label}, " + ", ".join(str(at[tuple(np.add(i, c))]) for c in corners))
        for side, place in ((0, 0), (1, cells[-1] - 1)):
            if i[-1] == place:
                ends[side].append(f"{label}, {FACES[d][side]}")
    sets = [[str(n) for i, n in at.items() if i[-1] == k] for k in (0, cells[-1])]
    text = ["*NODE, NSET=" + name]
    text += [f"{first + i}, " + ", ".join(f"{v:.17g}" for v in q@p) for i, p in enumerate(x)]
    text += [f"*ELEMENT, TYPE={'CPE4' if d == 2 else 'C3D8'}, ELSET=E", *lines]
    for side, end in enumerate(("LOW", "HIGH")):
        text += [f"*NSET, NSET={name}.{end}", *sets[side], f"*SURFACE, NAME={name}.S{side + 1}",
                 *ends[side]]
    return text, np.array([q@p for p in x])


TIES = {
    "mortar": ["*TIE, NAME=T, TYPE=SURFACE TO SURFACE, POSITION TOLERANCE=0.3", "B.S1, A.S2"],
    "nodes": ["*SURFACE INTERACTION, NAME=I", "*CONTACT PAIR, INTERACTION=I, TIED, "
              "TYPE=NODE TO SURFACE", "B.S1, A.S2"],
}


def stack(d, tie, nlgeom, gap, drive, q=None, matching=False):
    q = np.eye(d) if q is None else q
    a, xa = block("A", 1, [0]*d, [2]*(d - 1) + [1], [3]*(d - 1) + [2], q)
    b, xb = block("B", 1001, [0]*(d - 1) + [1 + gap], [2]*(d - 1) + [2 + gap],
                  [3 if matching else 4]*(d - 1) + [2], q)
    text = [*a, *b, "*MATERIAL, NAME=M", "*ELASTIC", "1000., 0.3",
            "*SOLID SECTION, ELSET=E, MATERIAL=M", "1.,", *TIES[tie],
            "*STEP, INC=100" + ", NLGEOM"*nlgeom, "*STATIC", "0.5, 1.", *drive,
            "*NODE PRINT, NSET=A", "U, RF", "*NODE PRINT, NSET=B", "U, RF", "*END STEP", ""]
    return "\n".join(text), np.vstack([xa, xb])


def last(folder, word, count):
    """A table of all nodes of the last increment, by node."""
    rows, reading = {}, False
    for line in (folder/"out/job.dat").read_text().splitlines():
        if line.strip()[:1].isalpha():
            reading = word in line and "total" not in line
        elif reading and line.strip():
            row = [float(v) for v in line.split()]
            rows[int(row[0])] = row[1:4]
    assert len(rows) == count
    return np.array([rows[k] for k in sorted(rows)])


def moment(x, f):
    return np.cross(np.pad(x, ((0, 0), (0, 3 - x.shape[1]))), f).sum(axis=0)


CASES = [(d, tie, nlgeom, matching) for d in (2, 3) for tie in TIES for nlgeom in (False, True)
         for matching in (False, True)]


@pytest.mark.parametrize("d, tie, nlgeom, matching", CASES)
def test_moments_balance_across_a_gap(tmp_path, d, tie, nlgeom, matching):
    """A stack with a gap of a tenth of its height is sheared: all moments vanish together."""
    turned = np.array([[0.8, -0.6], [0.6, 0.8]]) if d == 2 else np.eye(3)
    load = turned@np.array([1.0, 0.0]) if d == 2 else np.array([0.8, 0.6, 0.0])
    drive = ["*BOUNDARY", f"A.LOW, 1, {d}", "*CLOAD"]
    drive += [f"B.HIGH, {k + 1}, {0.2*load[k]:.17g}" for k in range(d) if load[k]]
    text, x = stack(d, tie, nlgeom, 0.1, drive, turned, matching)
    done, summary, _ = run(tmp_path, text)
    assert done.returncode == 0, done.stderr
    u, f = last(tmp_path, "displacements", len(x)), last(tmp_path, "forces", len(x))
    top = (x@turned)[:, -1] > 2.1 - 1e-9
    f[top, :d] += 0.2*load
    now = x + u[:, :d] if nlgeom else x
    scale = abs(moment(x[top], f[top])).max()
    assert f.sum(axis=0) == pytest.approx(0.0, abs=1e-6*abs(f).sum())
    assert moment(now, f) == pytest.approx(0.0, abs=2e-6*scale)


@pytest.mark.parametrize("d, tie, nlgeom, matching", CASES)
def test_a_rigid_rotation_strains_nothing(tmp_path, d, tie, nlgeom, matching):
    axis = np.array([0, 0, 1.0]) if d == 2 else np.array([0.6, 0.48, 0.64])
    angle = 0.3 if nlgeom else 1e-3
    k = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    motion = (np.sin(angle)*k + (1 - np.cos(angle))*k@k if nlgeom else angle*k)[:d, :d]
    low = stack(d, tie, nlgeom, 0.1, [], matching=matching)[1]
    drive = ["*BOUNDARY"]
    for i, p in enumerate(low):
        if p[-1] > 1e-9:
            continue
        drive += [f"{i + 1}, {j + 1}, {j + 1}, {(motion@p)[j]:.17g}" for j in range(d)]
    text, x = stack(d, tie, nlgeom, 0.1, drive, matching=matching)
    if nlgeom:   # on the way the nodes go straight: only the end is a rotation
        text = text.replace("*STATIC\n0.5, 1.", "*STATIC\n0.1, 1., 1e-5, 0.1")
    done, summary, _ = run(tmp_path, text)
    assert done.returncode == 0, done.stderr
    u = last(tmp_path, "displacements", len(x))[:, :d]
    assert u == pytest.approx(x@motion.T, abs=1e-6*abs(u).max())
