"""Meshes: sound cells, right sides, sets that survive every operation."""
import doctest

import numpy as np
import pytest

import lopin.mesh
import lopin.mesh_make as make
import lopin.mesh.read
from lopin.mesh.cells import CELLS
from lopin.errors import ModelError, UsageError
from lopin.mesh.shapes import gradients, shape_functions

MESHES = {
    "rectangle": make.block((2.0, 1.0), (3, 2)),
    "graded": make.block((2.0, 1.0), (6, 4), grading=(5.0, [0.0, 0.1, 0.3, 0.6, 1.0])),
    "box": make.block((2.0, 1.0, 3.0), (3, 2, 2), origin=(1.0, 1.0, -1.0)),
    "quadratic box": make.block((2.0, 1.0, 3.0), (3, 2, 2), quadratic=True),
    "crowned": make.crowned_block((1.0, 1.0), (8, 4), 5.0, quadratic=True),
    "crowned box": make.crowned_block((1.0, 1.0, 1.0), (3, 3, 3), 5.0),
    "quarter ring": make.ring(1.0, 2.0, (2, 6)),
    "full ring": make.ring(1.0, 2.0, (2, 24), angles=(0.0, 360.0), quadratic=True),
    "disc": make.disc(2.0, 3),
    "half disc": make.disc(2.0, 3, part="half", quadratic=True),
    "quarter disc": make.disc(2.0, 4, part="quarter"),
    "cylinder": make.cylinder(1.0, 2.0, (3, 2)),
    "triangles": make.simplices(make.disc(1.0, 3, part="half")),
    "tetrahedra": make.simplices(make.block((1.0, 1.0, 1.0), (2, 2, 2))).quadratic(),
    "wedges": make.extruded(make.simplices(make.disc(1.0, 2)), 1.0, 2).quadratic(),
}


@pytest.fixture(params=MESHES, ids=str)
def mesh(request):
    return MESHES[request.param]


def measure(mesh):
    """Area or volume, and the integral of the outward normal times position over the surfaces."""
    total = 0.0
    for name, cells in mesh.blocks:
        family = {"triangle": [(1/6, 1/6), (2/3, 1/6), (1/6, 2/3)]}
        gauss = np.array([-np.sqrt(0.6), 0.0, np.sqrt(0.6)])
        weight = np.array([5.0, 8.0, 5.0])/9.0
        cell = CELLS[name]
        if cell.family == "triangle":
            points, weights = np.array(family["triangle"]), np.full(3, 1/6)
        elif cell.family == "tetra":
            a, b = 0.5854101966249685, 0.1381966011250105
            points, weights = np.full((4, 3), b), np.full(4, 1/24)
            points[[1, 2, 3], [0, 1, 2]] = a
        elif cell.family == "wedge":
            points = np.array([(*p, t) for p in family["triangle"] for t in gauss])
            weights = np.array([w/6 for _ in range(3) for w in weight])
        else:
            grid = np.meshgrid(*[gauss]*cell.ndim, indexing="ij")
            points = np.stack([g.ravel() for g in grid], axis=1)
            each = np.meshgrid(*[weight]*cell.ndim, indexing="ij")
            weights = np.prod(np.stack(each), axis=0).ravel()
        for xi, w in zip(points, weights):
            dn = shape_functions(name, xi)[1]
            total += w*np.linalg.det(np.swapaxes(mesh.points[cells], 1, 2) @ dn).sum()
    return total


def test_jacobians_are_positive(mesh):
    assert mesh.smallest_jacobian() > 0.0


def test_sides_are_on_the_boundary_and_cover_it(mesh):
    boundary = {tuple(r) for r in mesh.boundary().tolist()}
    named = [tuple(r) for rows in mesh.surfaces.values() for r in rows.tolist()]
    assert len(named) == len(set(named))
    assert set(named) == boundary


def test_point_sets_are_the_points_of_their_surface(mesh):
    for name in mesh.surfaces:
        assert sorted(mesh.point_sets[name]) == sorted(mesh.surface_points(name)), name


def test_every_point_is_used_once(mesh):
    used = np.unique(np.concatenate([c.ravel() for _, c in mesh.blocks]))
    assert used.tolist() == list(range(mesh.n_point))
    distance = np.round(mesh.points, 9)
    assert len(np.unique(distance, axis=0)) == mesh.n_point


def test_top_is_above_bottom(mesh):
    if {"TOP", "BOTTOM"} <= set(mesh.surfaces):
        top, bottom = (mesh.points[mesh.point_sets[k], -1] for k in ("TOP", "BOTTOM"))
        assert np.ptp(top) < 1e-12
        assert top.min() > bottom.max()


@pytest.mark.parametrize("name, exact, tolerance", [
    ("graded", 2.0, 1e-12), ("box", 6.0, 1e-12), ("quadratic box", 6.0, 1e-12),
    ("full ring", 3.0*np.pi, 1e-4), ("half disc", 2.0*np.pi, 1e-4), ("tetrahedra", 1.0, 1e-12),
    ("cylinder", 2.0*np.pi, 0.02), ("wedges", np.pi, 0.03)])
def test_size(name, exact, tolerance):
    assert measure(MESHES[name]) == pytest.approx(exact, rel=tolerance)


def test_arcs_have_their_radius():
    disc = MESHES["half disc"]
    assert np.hypot(*disc.points[disc.point_sets["ARC"]].T) == pytest.approx(2.0)
    crown = MESHES["crowned"].points[MESHES["crowned"].point_sets["BOTTOM"]]
    assert np.hypot(crown[::2, 0], crown[::2, 1] - 5.0)[[0, 2]] == pytest.approx(5.0)


def test_faces_point_outward(mesh):
    for name, rows in mesh.surfaces.items():
        for e, f in rows[:20]:
            cell_name, nodes = mesh.element(e)
            corners = CELLS[cell_name].n_corner
            centre = mesh.points[nodes[:corners]].mean(axis=0)
            face = [n for n in mesh.face_nodes(e, f) if n in nodes[:corners]]
            x = mesh.points[face]
            if mesh.ndim == 2:
                normal = np.array([x[1, 1] - x[0, 1], x[0, 0] - x[1, 0]])
            else:
                normal = np.cross(x[1] - x[0], x[2] - x[0])
            assert normal @ (x.mean(axis=0) - centre) > 0.0, (name, e, f)


@pytest.mark.parametrize("name", CELLS)
def test_shape_functions(name):
    cell = CELLS[name]
    rng = np.random.default_rng(0)
    for k, xi in enumerate(cell.xi):
        assert shape_functions(name, xi)[0] == pytest.approx(np.eye(cell.n_node)[k], abs=1e-12)
    xi = rng.uniform(0.1, 0.3, cell.ndim)
    values, slopes = shape_functions(name, xi)
    assert values.sum() == pytest.approx(1.0)
    assert slopes.sum(axis=0) == pytest.approx(np.zeros(cell.ndim), abs=1e-12)
    for d, step in enumerate(1e-6*np.eye(cell.ndim)):
        up, down = shape_functions(name, xi + step)[0], shape_functions(name, xi - step)[0]
        assert slopes[:, d] == pytest.approx((up - down)/2e-6, abs=1e-8)


def test_gradients_of_a_stretched_cell():
    x = CELLS["hexahedron"].xi*[1.0, 2.0, 3.0]
    gradient, det = gradients("hexahedron", x, [0.1, 0.2, 0.3])
    assert det == pytest.approx(6.0)
    assert gradient.T @ x == pytest.approx(np.eye(3))


def test_together_keeps_bodies_apart():
    both = lopin.mesh.together(UP=make.block((1.0, 1.0), (2, 2)).moved(0.0, 1.0),
                               LOW=make.block((1.0, 1.0), (3, 3)))
    assert both.n_element == 13
    assert both.element_sets["LOW"].tolist() == list(range(4, 13))
    assert both.points[both.surface_points("LOW.TOP"), 1] == pytest.approx(1.0)
    assert both.points[both.surface_points("UP.BOTTOM"), 1] == pytest.approx(1.0)


def test_meshio_groups_become_sets_and_surfaces():
    meshio = pytest.importorskip("meshio")
    plane = make.block((2.0, 1.0), (2, 1))
    quads = plane.blocks[0][1].copy()
    quads[1] = quads[1][::-1]   # clockwise: must be turned
    top = np.array([plane.face_nodes(e, f) for e, f in plane.surfaces["TOP"]])
    points = np.vstack([np.pad(plane.points, ((0, 0), (0, 1))), [[9.0, 9.0, 0.0]]])
    source = meshio.Mesh(points, [("line", top), ("quad", quads)],
                         cell_data={"gmsh:physical": [np.full(2, 7), np.full(2, 8)]},
                         field_data={"die side": np.array([7, 1]), "sheet": np.array([8, 2])})
    mesh = lopin.mesh.read.from_meshio(source)
    assert mesh.n_point == 6 and mesh.ndim == 2
    assert mesh.smallest_jacobian() > 0.0
    assert mesh.element_sets["SHEET"].tolist() == [0, 1]
    assert mesh.points[mesh.surface_points("DIE_SIDE"), 1] == pytest.approx(1.0)


def test_meshio_gmsh_file(tmp_path):
    meshio = pytest.importorskip("meshio")
    box = make.block((1.0, 1.0, 1.0), (2, 1, 1), quadratic=True)
    top = np.array([box.face_nodes(e, f) for e, f in box.surfaces["TOP"]])
    numbers = [np.full(2, 1), np.full(2, 2)]
    source = meshio.Mesh(
        box.points, [("quad8", top), ("hexahedron20", box.blocks[0][1])],
        cell_data={"gmsh:physical": numbers, "gmsh:geometrical": numbers},
        field_data={"TOP": np.array([1, 2]), "BODY": np.array([2, 3])})
    meshio.write(tmp_path/"box.msh", source, file_format="gmsh22")
    mesh = lopin.mesh.read.read_mesh(tmp_path/"box.msh")
    assert mesh.smallest_jacobian() > 0.0
    assert len(mesh.surface_points("TOP")) == 13
    assert mesh.surfaces["TOP"][:, 1].tolist() == [2, 2]


def test_facets_inside_a_body_are_refused():
    meshio = pytest.importorskip("meshio")
    plane = make.block((2.0, 1.0), (2, 1))
    source = meshio.Mesh(plane.points, [("line", np.array([[1, 4]])), ("quad", plane.blocks[0][1])],
                         cell_sets={"WALL": [np.array([0]), np.array([], int)]})
    with pytest.raises(ModelError, match="WALL.*between two elements"):
        lopin.mesh.read.from_meshio(source)


def test_a_deck_is_not_read_by_meshio(tmp_path):
    with pytest.raises(UsageError, match="is a deck"):
        lopin.mesh.read.read_mesh(tmp_path/"a.inp")


@pytest.mark.parametrize("module", [lopin.mesh, make, lopin.mesh.read, lopin.mesh.shapes])
def test_examples_in_docstrings(module):
    assert doctest.testmod(module).failed == 0
