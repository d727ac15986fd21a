"""Fortran kernels against their numpy twins, on random input."""
import numpy as np
import pytest

from lopin import _bridge, profile, reference
from lopin.mesh.cells import CELLS
from lopin.errors import SingularError, UsageError


@pytest.fixture(autouse=True)
def api(core):
    """All tests here need the compiled part."""
    return core


def probe(name):
    """A probe of the bridge."""
    assert hasattr(_bridge.core(), name), f"the compiled part has no {name}"
    return getattr(_bridge, name)


@pytest.mark.parametrize("cell", CELLS)
def test_shape_functions(cell):
    rng = np.random.default_rng(1)
    fortran = probe("probe_shape")
    for _ in range(10):
        xi = rng.uniform(-0.2, 0.8, CELLS[cell].ndim)
        values, slopes = fortran(cell, xi)
        assert (values, slopes) == tuple(
            pytest.approx(mine, abs=1e-12) for mine in reference.shape_functions(cell, xi))


@pytest.mark.parametrize("kind, data, gap", [
    ("plane", [0.1, 0.2, 0.0, 1.0], lambda x: reference.plane_gap([0.1, 0.2], [0.0, 1.0], x)),
    ("sphere", [0.0, 0.0, 0.5, 2.0], lambda x: reference.sphere_gap([0.0, 0.0, 0.5], 2.0, x)),
    ("cylinder", [0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.7],
     lambda x: reference.cylinder_gap([0.0, 0.0, 0.0], [1.0, 1.0, 0.0], 0.7, x))])
def test_simple_tools(kind, data, gap):
    points = np.random.default_rng(2).normal(size=(50, 2 if kind == "plane" else 3))
    assert probe("probe_tool_gap")(kind, data, points)[0] == pytest.approx(gap(points), abs=1e-12)


def test_profile():
    punch = profile.start(6.0, 9.0).line_to(6.0, 5.0).arc_to(4.0, 3.0, (4.0, 5.0))
    punch = punch.line_to(-6.0, 3.0)
    words = {"START": 0.0, "LINE": 1.0, "CIRCL": 2.0}
    data = [[words[row[0]], *row[1:], *[0.0]*(5 - len(row))] for row in punch.rows]
    points = np.random.default_rng(3).uniform([-5.0, 1.0], [8.0, 8.0], (40, 2))
    gaps, normals = probe("probe_tool_gap")("profile", data, points)
    assert np.linalg.norm(normals, axis=1) == pytest.approx(1.0)
    for point, gap in zip(points, gaps):
        assert gap == pytest.approx(reference.profile_gap(punch, point), abs=1e-6)


@pytest.mark.parametrize("cell", ["line", "line3", "triangle", "quad", "triangle6", "quad8"])
def test_projection_on_facets(cell):
    rng = np.random.default_rng(4)
    ndim = CELLS[cell].ndim + 1
    flat = np.pad(CELLS[cell].xi, ((0, 0), (0, 1)))
    for _ in range(10):
        x = flat + 0.05*rng.normal(size=flat.shape)
        point = x.mean(axis=0) + rng.uniform(-0.8, 0.8, ndim)
        xi, gap, normal = probe("probe_project")(cell, x, point)
        mine = reference.shape_functions(cell, xi)[0] @ x
        _, position = reference.closest_on_facet(cell, x, point)
        assert np.linalg.norm(point - mine) <= np.linalg.norm(point - position) + 1e-12
        assert mine == pytest.approx(position, abs=1e-6)
        assert normal == pytest.approx(reference.facet_normal(cell, x, xi), abs=1e-12)
        assert gap == pytest.approx(normal @ (point - mine), abs=1e-12)
        if cell == "triangle":
            exact, _ = reference.closest_on_triangle(x, point)
            assert xi == pytest.approx(exact, abs=1e-12)
        if cell == "line":
            exact, _ = reference.closest_on_segment(*x, point)
            assert xi == pytest.approx(exact, abs=1e-12)


def test_skyline():
    rng = np.random.default_rng(5)
    band = np.triu(np.tril(rng.normal(size=(30, 30)), 4), -4)
    a = band @ band.T + np.eye(30)
    columns = [np.flatnonzero(np.abs(a[j:, j]) > 0.0) + j for j in range(30)]
    pointers = np.cumsum([0, *(len(c) for c in columns)])
    rows, values = np.concatenate(columns), np.concatenate([a[c, j] for j, c in enumerate(columns)])
    b = rng.normal(size=30)
    x = probe("probe_skyline_solve")(pointers, rows, values, b)
    assert x == pytest.approx(np.linalg.solve(a, b))


def random_contact(rng, n):
    """A positive definite compliance and gaps of both signs."""
    a = rng.normal(size=(n, n))
    return a @ a.T + 0.1*np.eye(n), rng.normal(size=n)


def test_condensed_contact():
    rng = np.random.default_rng(6)
    solve = probe("probe_contact")
    for n in (1, 2, 5, 12, 40):
        for _ in range(20):
            s, gap = random_contact(rng, n)
            force, iterations = solve(s, gap)
            size = max(1.0, np.abs(force).max())
            assert force == pytest.approx(reference.contact_oracle(s, gap), abs=1e-12*size)
            twin, passes = reference.contact_active_set(s, gap)
            assert force == pytest.approx(twin, abs=1e-12*size)
            assert force.min() >= 0.0 and iterations <= 2*n + 20


def test_contact_where_the_plain_active_set_cycles():
    s = np.array([[9.0, -13.0, -16.0], [-13.0, 22.0, 28.0], [-16.0, 28.0, 36.0]])
    force, _ = probe("probe_contact")(s, [-9.0, 9.0, 2.0])
    assert force == pytest.approx([4.29411765, 0.0, 1.85294118])


def test_methods_of_condensed_contact():
    """Springs of stiffness alpha are a compliance 1/alpha more; augmentation takes it away
    again."""
    rng = np.random.default_rng(7)
    solve = probe("probe_contact")
    for _ in range(20):
        s, gap = random_contact(rng, 8)
        alpha = rng.uniform(0.5, 20.0, 8)
        soft = reference.contact_oracle(s + np.diag(1.0/alpha), gap)
        for method in ("penalty", "perturbed"):
            assert solve(s, gap, method, alpha)[0] == pytest.approx(soft, abs=1e-10)
        hard = reference.contact_oracle(s, gap)
        assert solve(s, gap, "augmented", 100.0)[0] == pytest.approx(hard, abs=1e-7)


def test_probes_refuse_what_does_not_exist():
    with pytest.raises(UsageError):
        probe("probe_contact")(np.eye(2), [1.0, -1.0], "lagrang")
    with pytest.raises(SingularError):
        probe("probe_contact")(np.ones((2, 2)), [1.0, -1.0])
    with pytest.raises(UsageError):
        probe("probe_tool_gap")("cone", [1.0], np.zeros((1, 2)))
    with pytest.raises(SingularError):
        probe("probe_skyline_solve")([0, 1, 2], [0, 1], [1.0, 0.0], [1.0, 1.0])


@pytest.mark.parametrize("kind", ["plane strain", "plane stress", "axisymmetric", "3d"])
def test_moduli(kind):
    exact = reference.hooke(1234.5, 0.31, kind)
    assert probe("probe_hooke")(1234.5, 0.31, kind) == pytest.approx(exact, rel=1e-14)


@pytest.mark.parametrize("word, kind", [("CPE4", "plane strain"), ("CPS4", "plane stress"),
                                        ("CAX4", "axisymmetric"), ("C3D8", "3d")])
@pytest.mark.parametrize("full", [False, True])
def test_stiffness(word, kind, full):
    cell = "hexahedron" if kind == "3d" else "quad"
    rng = np.random.default_rng(8)
    mean_dilatation = not full and kind != "plane stress"
    for _ in range(5):
        x = CELLS[cell].xi + 3.0 + 0.15*rng.normal(size=CELLS[cell].xi.shape)
        exact = reference.brick_stiffness(x, 1000.0, 0.3, kind, 1.0, mean_dilatation)
        mine = probe("probe_stiffness")(word, x, 1000.0, 0.3, full=full)
        assert mine == pytest.approx(exact, abs=1e-12*np.abs(exact).max())


def test_numbers_cross_unchanged():
    values = [1/3, -2/3, 1e-310, 5e-324, 1.7976931348623157e308, -0.0, np.pi]
    back = _bridge.echo(values)
    assert back.dtype == np.float64
    assert back.tobytes() == np.array(values).tobytes()


def test_keywords_are_rows():
    rows = {row["name"]: row for row in _bridge.keywords()}
    assert rows["BOUNDARY"]["status"] == "supported" and rows["CREEP"]["status"] == "later"
    behaviour = rows["SURFACE BEHAVIOR"]
    assert "PENALTY" in [p["name"] for p in behaviour["parameters"]]
    assert all(row["sentence"] for row in rows.values())


def test_no_loop_takes_vector_copies_of_functions(executable):
    """Powers and exponentials of libmvec have other bits, which depend on the processor."""
    assert b"_ZGV" not in executable.read_bytes()
