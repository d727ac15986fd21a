"""A mesh with a corner that is turned inside out never has PASS: it is refused where it comes so, and
ends the run where the deformation does it, whatever its element."""
import json
import os
import subprocess

import pytest

EXECUTABLE = os.environ["LOPIN_EXECUTABLE"]
SQUARE = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
CUBE = SQUARE + [(x, y, 1) for x, y, _ in SQUARE]
TETRA = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
WEDGE = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (0, 1, 1)]
EDGES = {3: [(0, 1), (1, 2), (2, 0)], 4: [(0, 1), (1, 2), (2, 3), (3, 0)],
         "tetra": [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)],
         6: [(0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)],
         8: [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6),
             (3, 7)]}


def cell(word):
    """Corners of a good cell, and its edges."""
    if word.startswith("C3D"):
        corners = {"4": TETRA, "10": TETRA, "6": WEDGE, "15": WEDGE}.get(word[3:].rstrip("RIHM"), CUBE)
        edges = EDGES["tetra"] if corners is TETRA else EDGES[len(corners)]
    else:
        corners = [(x + 1, y, z) for x, y, z in SQUARE[:3 if word[3] in "36" else 4]]
        edges = EDGES[len(corners)]
    return [list(map(float, c)) for c in corners], edges


def deck(word, spoil, nlgeom=False):
    x, edges = cell(word)
    if word.rstrip("RIHM").endswith(("6", "8", "10", "15", "20")) and word.rstrip("RIHM") not in (
            "C3D6", "C3D8"):
        x += [[0.5*(p + q) for p, q in zip(x[a], x[b])] for a, b in edges]
    spoil(x)
    n = 3 if word.startswith("C3D") else 2
    nodes = "\n".join(f"{i + 1}, " + ", ".join(map(str, p[:n])) for i, p in enumerate(x))
    return (f"*NODE, NSET=ALL\n{nodes}\n*ELEMENT, TYPE={word}, ELSET=E\n1, "
            + ", ".join(str(i + 1) for i in range(len(x))).replace(", 16,", ",\n16,")
            + "\n*MATERIAL, NAME=M\n*ELASTIC\n1000., 0.3\n*SOLID SECTION, ELSET=E, MATERIAL=M\n1.,\n"
            + f"*BOUNDARY\n1, 1, {n}\n2, 1, {n}\n3, 1, {n}\n*STEP" + ", NLGEOM"*nlgeom
            + f"\n*STATIC\n*CLOAD\n{len(x) if n == 3 else 3}, 1, 1e-3\n*END STEP\n")


def run(folder, text):
    (folder/"job.inp").write_text(text)
    done = subprocess.run([EXECUTABLE, "run", "job.inp", "-o", "out", "--overwrite"], cwd=folder,
                          capture_output=True, text=True, timeout=60)
    path = folder/"out/job.json"
    return done, json.loads(path.read_text()) if path.exists() else {}


FIRST = ["CPE4", "CPS4", "CAX4", "CPE4I", "C3D8", "C3D8I"]
SECOND = ["CPE6", "CPE8", "CPE8R", "CAX6", "CAX8", "CAX8R", "C3D10", "C3D15", "C3D20", "C3D20R"]


@pytest.mark.parametrize("nlgeom", [False, True])
@pytest.mark.parametrize("word", FIRST)
def test_a_corner_that_is_pushed_in_is_refused(tmp_path, word, nlgeom):
    def spoil(x):
        x[-1] = [sum(p[k] for p in x)/len(x) for k in range(3)]
        low = min(p[0] for p in x[:-1])
        x[-1] = [low + 0.55, 0.45, 0.45 if len(x) == 8 else 0.0]
        if len(x) == 8:
            x[-1] = [0.6, 0.4, 0.6]
    done, _ = run(tmp_path, deck(word, spoil, nlgeom))
    assert done.returncode == 1 and "E0302" in done.stderr, done.stderr


@pytest.mark.parametrize("nlgeom", [False, True])
@pytest.mark.parametrize("word", SECOND)
def test_a_node_amid_an_edge_that_lies_near_its_end_is_refused(tmp_path, word, nlgeom):
    corners, edges = cell(word)

    def spoil(x):
        a, b = edges[0]
        x[len(corners)] = [0.85*p + 0.15*q for p, q in zip(x[a], x[b])]
    done, _ = run(tmp_path, deck(word, spoil, nlgeom))
    assert done.returncode == 1 and "E0302" in done.stderr, done.stderr


@pytest.mark.parametrize("word", FIRST + SECOND + ["C3D4", "C3D6", "CPE3"])
def test_good_cells_pass(tmp_path, word):
    done, summary = run(tmp_path, deck(word, lambda x: None))
    assert "E0302" not in done.stderr
    if done.returncode == 0:
        assert summary["certificate"]["corner"] == 1


def squeezed(word, way):
    """Two cells of a strip; the top middle node is pushed down into the lower half."""
    return (f"*NODE, NSET=ALL\n1, 0., 0.\n2, 1., 0.\n3, 2., 0.\n4, 0., 1.\n5, 1., 1.\n6, 2., 1.\n"
            f"*ELEMENT, TYPE={word}, ELSET=E\n1, 1, 2, 5, 4\n2, 2, 3, 6, 5\n*MATERIAL, NAME=M\n"
            "*ELASTIC\n1000., 0.3\n*SOLID SECTION, ELSET=E, MATERIAL=M\n1.,\n*BOUNDARY\n1, 1, 2\n"
            "2, 1, 2\n3, 1, 2\n4, 1, 2\n6, 1, 2\n5, 2\n*STEP, NLGEOM, INC=1000\n*STATIC\n0.02, 1., , "
            f"0.02\n*BOUNDARY\n5, 1, 1, {way}\n*END STEP\n")


@pytest.mark.parametrize("word", ["CPE4", "CPE4R", "CPS4"])
def test_a_corner_that_turns_inside_out_ends_the_run(tmp_path, word):
    text = squeezed(word, 1.6)
    done, summary = run(tmp_path, text)
    if done.returncode == 1 and "E0105" in done.stderr:
        pytest.skip("no such element")
    assert done.returncode == 3, done.stderr
    assert "element 2" in done.stderr


def pressed(kind, n, depth, static, nu=0.0, words=", NLGEOM"):
    """A square whose bottom is held and whose middle node of the top goes down."""
    def at(i, j):
        return 1 + i + (n + 1)*j

    nodes = "\n".join(f"{at(i, j)}, {i/n}, {j/n}" for j in range(n + 1) for i in range(n + 1))
    elements = "\n".join(f"{1 + i + n*j}, {at(i, j)}, {at(i + 1, j)}, {at(i + 1, j + 1)}, "
                         f"{at(i, j + 1)}" for j in range(n) for i in range(n))
    held = "\n".join(f"{at(i, 0)}, 1, 2" for i in range(n + 1))
    return (f"*NODE\n{nodes}\n*ELEMENT, TYPE={kind}, ELSET=E\n{elements}\n*MATERIAL, NAME=M\n"
            f"*ELASTIC\n1000., {nu}\n*SOLID SECTION, ELSET=E, MATERIAL=M\n1.,\n"
            f"*BOUNDARY\n{held}\n*STEP{words}\n*STATIC\n{static}\n*BOUNDARY\n{at(n//2, n)}, 2, 2, {-depth}\n"
            "*END STEP\n")


@pytest.mark.parametrize("kind, nu, cut", [("CPE4", 0.0, True), ("CPS4", 0.0, True),
                                           ("CPE4I", 0.3, False)])
def test_a_folded_balance_beside_the_path_is_not_taken(tmp_path, kind, nu, cut):
    """In one increment full steps of Newton end in a balance with corners inside out; the path has
    none. The last one is found by shorter steps, the others by shorter increments."""
    done, job = run(tmp_path, pressed(kind, 8, 0.3, "1., 1.", nu))
    assert done.returncode == 0 and job["certificate"]["corner"] == 1, done.stdout + done.stderr
    assert ("because the balance found" in (tmp_path/"out/job.cvg").read_text()) == cut


def test_increments_that_may_not_be_cut_say_that_they_fold(tmp_path):
    text = pressed("CPE4", 8, 0.3, "1., 1.").replace("*STATIC", "*STATIC, DIRECT")
    done, job = run(tmp_path, text)
    assert done.returncode == 3 and "E0504" in done.stderr and job["certificate"]["corner"] < 0


def test_a_path_that_folds_is_followed_to_its_fold(tmp_path):
    """One increment would end folded at time 1; by 0.79 the corner is flat."""
    done, job = run(tmp_path, pressed("CPE4", 4, 0.6, "1., 1."))
    assert done.returncode == 3 and "E0504" in done.stderr
    lines = (tmp_path/"out/job.sta").read_text().splitlines()[2:]
    times = [float(line.split()[5]) for line in lines]
    assert 0.77 < times[-2] < times[-1] < 0.83 and len(times) < 15


def test_metal_that_necks_until_it_folds_is_called_so(tmp_path):
    """A bar, a little thinner in the middle, that hardly hardens: one column of nodes goes to nothing."""
    place = [(x, y*(0.98 + 0.0025*x)) for y in (0.0, 0.5, 1.0) for x in range(9)]
    text = ["*NODE, NSET=ALL", *(f"{i + 1}, {x}, {y!r}" for i, (x, y) in enumerate(place)),
            "*ELEMENT, TYPE=CPE4I, ELSET=E",
            *(f"{1 + i + 8*j}, {1 + i + 9*j}, {2 + i + 9*j}, {11 + i + 9*j}, {10 + i + 9*j}"
              for j in range(2) for i in range(8)),
            "*SOLID SECTION, ELSET=E, MATERIAL=M", "1.,", "*MATERIAL, NAME=M", "*ELASTIC", "2e5, .3",
            "*PLASTIC", "300., 0.", "330., 1.", "*BOUNDARY", "1, 1", "10, 1", "19, 1",
            *(f"{1 + i}, 2" for i in range(9)), "*STEP, NLGEOM, INC=500", "*STATIC", "*BOUNDARY",
            "9, 1, 1, 4.", "18, 1, 1, 4.", "27, 1, 1, 4.", "*END STEP"]
    done, job = run(tmp_path, "\n".join(text) + "\n")
    assert done.returncode == 3
    assert [d for d in job["diagnostics"] if d["code"] == "W0531" and "necked" in d["help"]]
