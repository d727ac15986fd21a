"""Fortran kernels against their numpy twins, on random input."""
import numpy as np
import pytest

from lopin import _bridge, profile, reference
from lopin.cells import CELLS


@pytest.fixture(autouse=True)
def api(core):
    """All tests here need the compiled part."""
    return core


def probe(name):
    """A probe of the bridge; tests of kernels that this build does not show are skipped."""
    if not hasattr(_bridge.core(), name):
        pytest.skip(f"the compiled part has no {name}")
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


@pytest.mark.parametrize("cell", ["line", "triangle", "quad", "triangle6", "quad8"])
def test_projection_on_facets(cell):
    rng = np.random.default_rng(4)
    ndim = CELLS[cell].ndim + 1
    flat = np.pad(CELLS[cell].xi, ((0, 0), (0, 1)))
    for _ in range(10):
        x = flat + 0.05*rng.normal(size=flat.shape)
        point = x.mean(axis=0) + rng.uniform(-0.2, 0.2, ndim)
        _, gap, normal = probe("probe_project")(cell, x, point)
        xi, position = reference.closest_on_facet(cell, x, point)
        assert abs(gap) == pytest.approx(np.linalg.norm(point - position), abs=1e-6)
        assert normal == pytest.approx(reference.facet_normal(cell, x, xi), abs=1e-3)


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


def test_condensed_contact():
    rng = np.random.default_rng(6)
    solve = probe("probe_contact")
    for _ in range(20):
        a = rng.normal(size=(12, 12))
        s, gap = a @ a.T + 0.1*np.eye(12), rng.normal(size=12)
        force, iterations = solve(s, gap)
        assert force == pytest.approx(reference.contact_oracle(s, gap), abs=1e-9)
        assert iterations <= 2*12 + 20
