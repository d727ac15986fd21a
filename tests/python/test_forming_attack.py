"""Solids that flow against a point integrated in numpy: every element, any frame and unit, there
and back again."""
import numpy as np
import pytest

import lopin
from lopin import mesh_make
from lopin.model import Model
from lopin.model_deck import mesh_deck

YOUNG, POISSON = 2.0e5, 0.3
CURVE = ((0.0, 200.0), (0.05, 260.0), (0.3, 330.0), (1.0, 400.0))
PLANE = [np.array(h) for h in ([[0.0, 0.3], [0.0, 0.0]], [[0.1, 0.3], [-0.15, -0.2]],
                               [[0.05, -0.1], [-0.05, -0.1]], [[0.0, 0.0], [0.0, 0.0]])]
SPACE = [np.array(h) for h in ([[0.0, 0.3, 0.0], [0.0, 0.0, 0.1], [0.0, 0.05, 0.0]],
                               [[0.1, 0.3, -0.1], [-0.15, -0.2, 0.0], [0.1, 0.0, 0.05]],
                               np.zeros((3, 3)))]
RING = [np.diag(h) for h in ((0.2, -0.3), (-0.1, 0.2), (0.0, 0.0))]
WORDS = ("CPE4", "CPE4I", "CPE3", "CPE8R", "CPE6", "CAX4", "CAX4I", "CAX3", "CAX8", "C3D8", "C3D8I",
         "C3D4", "C3D10", "C3D20R", "C3D6", "C3D15")
#: Increments a step; by DIRECT, which may not cut.
EACH, EACH_ENHANCED = 4, 10


def flow_stress(strain: float) -> float:
    return float(np.interp(strain, *np.transpose(CURVE)))


def flowed(trial: float, before: float) -> float:
    """Plastic strain of an increment by bisection."""
    three_g = 1.5*YOUNG/(1.0 + POISSON)
    low, high = 0.0, trial/three_g
    if trial <= flow_stress(before):
        return 0.0
    for _ in range(100):
        middle = 0.5*(low + high)
        low, high = (middle, high) if trial - three_g*middle > flow_stress(before
                                                                           + middle) else (low, middle)
    return 0.5*(low + high)


def returned(deviator, before: float):
    """Deviator of stress per trial deviator of strain, share kept, plastic strain of the
    increment."""
    shear = 0.5*YOUNG/(1.0 + POISSON)
    trial = 6.0**0.5*shear*np.linalg.norm(deviator)
    step = flowed(trial, before)
    kept = 1.0 - 3.0*shear*step/trial if step > 0.0 else 1.0
    return 2.0*shear*kept, kept, step


def finite_point(path):
    """Cauchy stress and plastic strain after every deformation gradient."""
    bulk, metric, strain, found = YOUNG/(3.0*(1.0 - 2.0*POISSON)), np.eye(3), 0.0, []
    for f in path:
        square, axes = np.linalg.eigh(f @ metric @ f.T)
        e = 0.5*np.log(square)
        deviator = e - e.mean()
        secant, kept, step = returned(deviator, strain)
        change = np.log(np.linalg.det(f))
        stress = axes @ np.diag(secant*deviator + bulk*change) @ axes.T/np.linalg.det(f)
        back = np.linalg.inv(f)
        metric = back @ axes @ np.diag(np.exp(2.0*(kept*deviator + e.mean()))) @ axes.T @ back.T
        strain += step
        found.append((stress, strain))
    return found


def small_point(path):
    bulk, plastic, strain, found = YOUNG/(3.0*(1.0 - 2.0*POISSON)), np.zeros((3, 3)), 0.0, []
    for f in path:
        e = 0.5*(f + f.T) - np.eye(3)
        deviator = e - np.trace(e)/3.0*np.eye(3) - plastic
        secant, kept, step = returned(deviator, strain)
        plastic = plastic + (1.0 - kept)*deviator
        strain += step
        found.append((secant*deviator + bulk*np.trace(e)*np.eye(3), strain))
    return found


def corners_of(word: str) -> list[np.ndarray]:
    return SPACE if word.startswith("C3D") else RING if word.startswith("CAX") else PLANE


def each_of(word: str) -> int:
    """Internal modes of points left behind need smaller increments."""
    return EACH_ENHANCED if word.endswith("I") else EACH


def gradients(corners, ring: bool, each: int) -> list[np.ndarray]:
    """F after every increment; the hoop of a ring stretches as its radius does."""
    path, before = [], np.zeros_like(corners[0])
    for after in corners:
        for k in range(1, each + 1):
            f = np.eye(3)
            d = len(after)
            f[:d, :d] += before + (after - before)*k/each
            if ring:
                f[2, 2] = f[0, 0]
            path.append(f)
        before = after
    return path


def mesh_of(word: str):
    """Points, cells, and which points lie on the surface; inner ones are moved off the grid."""
    space, nodes = word.startswith("C3D"), int(word[3:].rstrip("RI"))
    mesh = mesh_make.block((1.0,)*(3 if space else 2), (2,)*(3 if space else 2))
    if nodes in (6, 15) and space:
        mesh = mesh_make.extruded(mesh_make.simplices(mesh_make.block((1.0, 1.0), (2, 2))), 1.0, 2)
    elif nodes in ((4, 10) if space else (3, 6)):
        mesh = mesh_make.simplices(mesh)
    quadratic = nodes in ((10, 15, 20) if space else (6, 8))
    if quadratic:
        mesh = mesh.quadratic()
    x = mesh.points.copy()
    inner = np.all((x > 1e-9) & (x < 1.0 - 1e-9), axis=1)
    if not quadratic:
        x[inner] += 0.08*np.random.default_rng(1).uniform(-1.0, 1.0, (inner.sum(), x.shape[1]))
    return x, mesh.blocks[0][1], ~inner


def pulled(word: str, corners, *, nlgeom: bool = True, turn=None, length: float = 1.0,
           stress: float = 1.0):
    """A block whose surface moves with one displacement gradient: the same state at all points."""
    x, cells, edge = mesh_of(word)
    d = x.shape[1]
    turn = np.eye(d) if turn is None else turn
    x = length*x @ turn.T
    text = "*NODE\n" + "".join(f"{i}, {', '.join(repr(float(c)) for c in p)}\n"
                               for i, p in enumerate(x, 1))
    text += f"*ELEMENT, TYPE={word}, ELSET=BODY\n"
    for e, nodes in enumerate(cells, 1):
        row = [e, *(int(n) + 1 for n in nodes)]
        text += ",\n".join(", ".join(map(str, row[i:i + 12]))
                           for i in range(0, len(row), 12)) + "\n"
    text += f"*MATERIAL, NAME=M\n*ELASTIC\n{YOUNG*stress!r}, {POISSON}\n*PLASTIC\n"
    text += "".join(f"{s*stress!r}, {e!r}\n"
                    for e, s in CURVE) + "*SOLID SECTION, ELSET=BODY, MATERIAL=M\n"
    for h in corners:
        u = x @ (turn @ h @ turn.T).T
        text += f"*STEP{', NLGEOM' if nlgeom else ''}\n*STATIC, DIRECT\n{1.0/each_of(word)!r}, 1.\n*BOUNDARY\n"
        text += "".join(f"{n + 1}, {k + 1}, {k + 1}, {float(u[n, k])!r}\n"
                        for n in np.flatnonzero(edge) for k in range(d))
        text += "*OUTPUT, FIELD\n*ELEMENT OUTPUT\nS, PEEQ\n*END STEP\n"
    return lopin.run(lopin.Deck.parse(text, "pulled"))


def tensor(s):
    return np.array([[s[0], s[3], s[4]], [s[3], s[1], s[5]], [s[4], s[5], s[2]]])


def turned(d: int) -> np.ndarray:
    """A turn by 37 degrees, in space about an odd axis."""
    angle = np.radians(37.0)
    if d == 2:
        return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    a, b, c = np.array([1.0, 2.0, -1.0])/6.0**0.5
    w = np.array([[0.0, -c, b], [c, 0.0, -a], [-b, a, 0.0]])
    return np.eye(3) + np.sin(angle)*w + (1.0 - np.cos(angle))*w @ w


@pytest.mark.parametrize("nlgeom", [True, False])
@pytest.mark.parametrize("word", WORDS)
def test_elements_follow_a_point_there_and_back(word, nlgeom):
    """Stress and plastic strain at every increment, in a turned frame where the element has one; it
    ends in its first shape."""
    corners = [h*(1.0 if nlgeom else 0.02) for h in corners_of(word)]
    ring = word.startswith("CAX")
    turn = None if ring else turned(len(corners[0]))
    result = pulled(word, corners, nlgeom=nlgeom, turn=turn)
    whole = np.eye(3)
    if not ring:
        whole[:len(turn), :len(turn)] = turn
    expected = (finite_point if nlgeom else small_point)(gradients(corners, ring, each_of(word)))
    assert len(result.times) == len(expected)
    for k, (stress, strain) in enumerate(expected):
        frame = result.at(k)
        for found in frame["S"]:
            assert tensor(found) == pytest.approx(whole @ stress @ whole.T, abs=1e-8*CURVE[0][1])
        assert np.ravel(frame["PEEQ"]) == pytest.approx(strain, abs=1e-10)


@pytest.mark.parametrize("nlgeom", [True, False])
@pytest.mark.parametrize("word", ["CPE4", "C3D8I"])
def test_units_change_no_iteration(word, nlgeom):
    """At the accepted state rounding does not choose between the elastic and the plastic
    tangent."""
    corners = [h*(1.0 if nlgeom else 0.02) for h in corners_of(word)]
    counts = [[step["iterations"] for step in pulled(word, corners, nlgeom=nlgeom, length=length,
                                                     stress=stress).summary["steps"]]
              for length, stress in ((1.0, 1.0), (1e-3, 1e6), (1.0, 1e9), (1.0, 1e-9))]
    assert all(count == counts[0] for count in counts)
    assert max(counts[0]) <= 2*each_of(word)


def bar(curve: str, load: str, steps, nlgeom=(False,)*9):
    """A cube between planes of symmetry, its top pulled by forces as one; loads at the ends of the
    steps."""
    text = "*NODE\n" + "".join(f"{1 + i}, {i % 2}., {i // 2 % 2}., {i // 4}.\n" for i in range(8))
    text += "*ELEMENT, TYPE=C3D8, ELSET=E\n1, 1, 2, 4, 3, 5, 6, 8, 7\n*MATERIAL, NAME=M\n*ELASTIC\n200000., 0.3\n*PLASTIC\n" + curve
    text += "*SOLID SECTION, ELSET=E, MATERIAL=M\n*BOUNDARY\n1, 1, 3\n2, 2, 3\n3, 1\n3, 3\n4, 3\n5, 1, 2\n6, 2\n7, 1\n"
    text += "*EQUATION\n" + "".join(f"2\n{n}, 3, 1., 5, 3, -1.\n" for n in (6, 7, 8))
    for value, finite in zip(steps, nlgeom):
        text += f"*STEP, INC=300{', NLGEOM' if finite else ''}\n*STATIC\n0.1, 1.\n*{load}{value!r}\n"
        text += "*OUTPUT, FIELD\n*NODE OUTPUT\nU\n*ELEMENT OUTPUT\nS, PEEQ\n*END STEP\n"
    return lopin.run(lopin.Deck.parse(text, "bar"))


def test_a_cycle_of_force_hardens_as_far_as_it_was_pulled():
    result = bar("200., 0.\n260., 0.05\n", "CLOAD\n5, 3, ", (230.0, 0.0, -230.0, 0.0, 250.0, 0.0))
    assert np.ravel(result["PEEQ"]) == pytest.approx(0.05*50.0/60.0, rel=1e-9)
    assert result["U"][4][2] == pytest.approx(0.05*50.0/60.0, rel=1e-9)
    assert np.abs(result["S"]).max() < 1e-6


def test_a_force_beyond_the_limit_load_is_refused():
    with pytest.raises(lopin.NotConvergedError, match="limit load") as problem:
        bar("200., 0.\n", "CLOAD\n5, 3, ", (202.0,))
    assert problem.value.result is None or problem.value.result.times[-1] <= 200.0/202.0*(1.0 + 1e-8)


def test_a_stretch_and_its_reversal_have_their_logarithms():
    """Perfect beyond 5 %: what is not elastic flows, on the way out and back; a first step at small
    strain differs by its square."""
    flows = np.log(1.2) + np.log(1.2/1.1) - 3.0*260.0/YOUNG
    for first, accuracy in ((True, 1e-8), (False, 1e-4)):
        result = bar("200., 0.\n260., 0.05\n", "BOUNDARY\n5, 3, 3, ", (0.002, 0.2, 0.1),
                     (first, True, True))
        assert np.ravel(result["PEEQ"]) == pytest.approx(flows, rel=accuracy)


SQUEEZED = """*SURFACE, NAME=PLATE, TYPE=SEGMENTS
START, 4., 1.
LINE, -1., 1.
*NODE, NSET=REF
99999, 0., 1.
*RIGID BODY, ANALYTICAL SURFACE=PLATE, REF NODE=REF
*MATERIAL, NAME=M
*ELASTIC
200000., 0.3
*PLASTIC
200., 0.
260., 0.05
400., 1.
*SOLID SECTION, ELSET=ALL, MATERIAL=M
*SURFACE INTERACTION, NAME=I
*SURFACE BEHAVIOR, DIRECT
*FRICTION
0.2,
*CONTACT PAIR, INTERACTION=I
TOP, PLATE
*BOUNDARY
LEFT, 1
BOTTOM, 2
REF, 1
REF, 6
"""


@pytest.mark.parametrize("shape", ["CPE4", "CPE3", "CPE8"])
def test_a_plate_that_leaves_lets_the_body_spring_back(shape):
    """A few iterations where it goes far in its first increment: contact that opens does not drag
    the body along."""
    mesh = mesh_make.block((1.0, 1.0), (4, 4), quadratic=shape == "CPE8")
    mesh = mesh_make.simplices(mesh) if shape == "CPE3" else mesh
    text = mesh_deck(Model("mesh", mesh, kind="plane strain")).text() + SQUEEZED
    for first, way in ((0.1, -0.2), (0.5, -0.1)):
        text += f"*STEP, NLGEOM, INC=300\n*STATIC\n{first}, 1.\n*BOUNDARY\nREF, 2, 2, {way}\n*OUTPUT, FIELD\n*NODE OUTPUT\nU\n"
        text += "*ELEMENT OUTPUT\nS, PEEQ\n*END STEP\n"
    result = lopin.run(lopin.Deck.parse(text, "squeezed"))
    press, leave = result.summary["steps"]
    assert leave["iterations"] <= 20 and leave["increments"] <= 6
    assert result.history["PLATE.rf2"][-1] == pytest.approx(0.0, abs=1e-6)
    top = -result["U"][mesh.point_sets["TOP"], 1]
    assert np.all((top > 0.19) & (top < 0.2))
    # Nothing flows on the way back.
    assert np.ravel(result["PEEQ"]) == pytest.approx(np.ravel(result.at(press["increments"]
                                                                        - 1)["PEEQ"]), abs=1e-3)
