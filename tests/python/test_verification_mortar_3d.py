"""B2: patch tests of surface-to-surface contact in space, on meshes that do not match.

Blocks of 10 by 10 by 4 on each other under a pressure of 1; exact: -1 along z at every point.
"""
import numpy as np
import pytest

from lopin import mesh_make
from lopin.laws import Augmented, Elastic, Lagrange
from lopin.mesh import Mesh, together
from lopin.model import Model

SIZE = (10.0, 10.0, 4.0)


def swirled(mesh, angle):
    """Turn the middle of a block about its axis; its sides stay: distorted, in-plane faces."""
    def turn(x):
        u = x[:, :2]/5.0 - 1.0
        t = np.radians(angle)*((1.0 - u**2).prod(axis=1))
        moved = np.stack([u[:, 0]*np.cos(t) - u[:, 1]*np.sin(t),
                          u[:, 0]*np.sin(t) + u[:, 1]*np.cos(t), x[:, 2]], axis=1)
        moved[:, :2] = 5.0*(moved[:, :2] + 1.0)
        return moved
    return mesh.mapped(turn)


def diamond(layers):
    """The block by bricks turned by 45 degrees, wedges in its corners."""
    points = np.array([[i, j] for i in range(5) for j in range(5)], float)*2.5
    def at(i, j):
        return 5*i + j
    quads = [[at(i, j), at(i + 1, j - 1), at(i + 2, j), at(i + 1, j + 1)]
             for i, j in [(0, 2), (1, 1), (1, 3), (2, 2)]]
    triangles = [[at(0, 0), at(2, 0), at(1, 1)], [at(0, 0), at(1, 1), at(0, 2)],
                 [at(4, 0), at(4, 2), at(3, 1)], [at(4, 0), at(3, 1), at(2, 0)],
                 [at(4, 4), at(2, 4), at(3, 3)], [at(4, 4), at(3, 3), at(4, 2)],
                 [at(0, 4), at(0, 2), at(1, 3)], [at(0, 4), at(1, 3), at(2, 4)]]
    used, number = np.unique(np.concatenate([np.ravel(quads), np.ravel(triangles)]),
                             return_inverse=True)
    flat = Mesh(points[used], [("quad", number[:16].reshape(4, 4)),
                               ("triangle", number[16:].reshape(8, 3))],
                element_sets={"ALL": np.arange(12)})
    return mesh_make.extruded(flat, 4.0, layers)


def upper_block(kind, cells):
    up = diamond(cells[2]) if kind == "turned" else mesh_make.block(SIZE, cells)
    if kind == "tet":
        up = mesh_make.simplices(up)
    return up


def blocks(lower, upper, kind, slave="upper", *, quadratic=False, swirl=0.0, method=None,
           degree=None, mortar=True, tied=False, stiff=1.0):
    """`stiff`: of the upper block over the lower."""
    low = mesh_make.block(SIZE, lower)
    up = upper_block(kind, upper).moved(0.0, 0.0, 4.0)
    if swirl:
        low, up = swirled(low, swirl), swirled(up, -1.3*swirl)
    if quadratic:
        low, up = low.quadratic(), up.quadratic()
    def corner(mesh, name, x):
        return mesh.with_points(name, lambda p: np.linalg.norm(p - np.array(x), axis=1) < 1e-9)
    for name, x in (("PIN", (0.0, 0.0)), ("GUIDE", (10.0, 0.0))):
        low, up = corner(low, name, (*x, 0.0)), corner(up, name, (*x, 8.0))
    model = Model("patch", together(UP=up, LOW=low), kind="3d")
    for body in ("UP", "LOW"):
        model.section(body, Elastic(1e6*(stiff if body == "UP" else 1.0), 0.3))
    surfaces = ("UP.BOTTOM", "LOW.TOP")
    model.contact(*surfaces[::1 if slave == "upper" else -1], method or Lagrange(),
                  surface_to_surface=mortar, tied=tied)
    model.fix("LOW.BOTTOM", "z")
    for body in ("LOW",) if tied else ("UP", "LOW"):
        model.fix(f"{body}.PIN", "x", "y")
        model.fix(f"{body}.GUIDE", "y")
    model.step().pressure("UP.TOP", 1.0)
    if degree:
        model.options(mortar_degree=degree)
    return with_stresses(model)


def with_stresses(model):
    """Print the stresses of all integration points of both bodies."""
    for body in ("UP", "LOW"):
        model.steps[-1].table(body, "S", of="elements")
    return model


def worst_stress(result):
    """Largest error of all stresses, from the .dat file: the five zeros are printed in full."""
    text = (result.source.folder/"patch.dat").read_text(encoding="utf-8")
    values = []
    for table in text.split(" stresses (")[1:]:
        for line in table.splitlines()[2:]:
            if not line.strip():
                break
            values.append([float(v) for v in line.split()[2:8]])
    assert len(values) > 8
    return np.abs(np.array(values) - [0.0, 0.0, -1.0, 0.0, 0.0, 0.0]).max()


PAIRS = [("hex", (3, 3, 2), (4, 4, 2)), ("hex", (2, 5, 2), (3, 2, 2)),
         ("tet", (3, 3, 2), (4, 4, 2)),
         ("turned", (3, 3, 2), (4, 4, 2))]


CASE = "B2 patch test in space, mortar"


def compare(sheet, result, name, tolerance):
    sheet.compare(CASE, f"{name}: worst stress error", worst_stress(result), 0.0, tolerance,
                  "exact", absolute=True)
    assert result.summary["certificate"]["verdict"] == "PASS"


@pytest.mark.parametrize("slave", ["upper", "lower"])
@pytest.mark.parametrize(("kind", "lower", "upper"), PAIRS)
def test_flat_parallelograms_have_no_error(solve, sheet, kind, lower, upper, slave):
    name = f"{kind} {upper[0]}x{upper[1]} on hex {lower[0]}x{lower[1]}, {slave} slave"
    compare(sheet, solve(blocks(lower, upper, kind, slave)), name, 1e-10)
    if kind == "hex" or lower[0] == 3:
        error = worst_stress(solve(blocks(lower, upper, kind, slave, mortar=False)))
        sheet.compare("B2 patch test in space, node to segment", name + ": worst stress error",
                      error, 0.1, 0.0, "not passed, a property of the method", at_least=True)


@pytest.mark.parametrize("slave", ["upper", "lower"])
@pytest.mark.parametrize("kind", ["hex", "tet", "turned"])
def test_distorted_faces_cost_what_the_rule_leaves(solve, sheet, kind, slave):
    for degree, tolerance in ((None, 1e-6), (8, 1e-8), (12, 1e-10)):
        result = solve(blocks((3, 3, 2), (4, 4, 2), kind, slave, swirl=15.0, degree=degree))
        compare(sheet, result, f"{kind} on hex, distorted, {slave} slave, degree {degree or 5}",
                tolerance)


@pytest.mark.parametrize("slave", ["upper", "lower"])
@pytest.mark.parametrize("kind", ["hex", "tet", "turned"])
def test_quadratic_faces_have_no_error(solve, sheet, kind, slave):
    result = solve(blocks((3, 3, 2), (4, 4, 2), kind, slave, quadratic=True))
    compare(sheet, result, f"B5 quadratic {kind} on hex, {slave} slave", 1e-10)


@pytest.mark.parametrize("options", [{"tied": True}, {"tied": True, "quadratic": True},
                                     {"method": Augmented()}, {"stiff": 1e3}, {"stiff": 1e-3}])
def test_ties_methods_and_stiffness(solve, sheet, options):
    name = ", ".join(f"{k} {type(v).__name__ if k == 'method' else v}".strip()
                     for k, v in options.items())
    for kind, slave in (("hex", "upper"), ("tet", "lower")):
        if "stiff" in options and slave == "lower":
            continue
        result = solve(blocks((3, 3, 2), (4, 4, 2), kind, slave, **options))
        compare(sheet, result, f"{kind} on hex, {slave} slave, {name}", 1e-10)


def small_on_large(slave, kind, quadratic):
    """The upper block covers the middle of the lower, whose rim carries the pressure itself."""
    def rim(x):
        return (x[:, 2] > 4.0 - 1e-9) & (np.abs(x[:, :2] - 5.0).max(axis=1) > 3.0)
    low = mesh_make.block(SIZE, (5, 5, 2)).with_surface("RIM", rim)
    up = mesh_make.block((6.0, 6.0, 4.0), (4, 4, 2), origin=(2.0, 2.0, 4.0))
    if kind == "tet":
        up = mesh_make.simplices(up)
    if quadratic:
        low, up = low.quadratic(), up.quadratic()
    def corner(mesh, name, *x):
        return mesh.with_points(name, lambda p: np.linalg.norm(p - np.array(x), axis=1) < 1e-9)
    low = corner(corner(low, "PIN", 2.0, 2.0, 0.0), "GUIDE", 8.0, 2.0, 0.0)
    up = corner(corner(up, "PIN", 2.0, 2.0, 8.0), "GUIDE", 8.0, 2.0, 8.0)
    model = Model("patch", together(UP=up, LOW=low), kind="3d")
    for body in ("UP", "LOW"):
        model.section(body, Elastic(1000.0, 0.3))
        model.fix(f"{body}.PIN", "x", "y")
        model.fix(f"{body}.GUIDE", "y")
    model.contact(*("UP.BOTTOM", "LOW.TOP")[::1 if slave == "upper" else -1],
                  surface_to_surface=True)
    model.fix("LOW.BOTTOM", "z")
    model.step().pressure("UP.TOP", 1.0).pressure("LOW.RIM", 1.0)
    return with_stresses(model)


@pytest.mark.parametrize("quadratic", [False, True])
@pytest.mark.parametrize("kind", ["hex", "tet"])
@pytest.mark.parametrize("slave", ["upper", "lower"])
def test_a_small_block_on_a_large_one(solve, sheet, slave, kind, quadratic):
    name = f"{'quadratic ' if quadratic else ''}{kind} on the middle of a larger hex, {slave} slave"
    compare(sheet, solve(small_on_large(slave, kind, quadratic)), name, 1e-10)


def test_a_degree_out_of_range_is_refused(solve):
    with pytest.raises(Exception, match="E0408"):
        solve(blocks((1, 1, 1), (1, 1, 1), "hex", degree=3))


def crown_on_block(cells, slave="crown", *, quadratic=False, mortar=True):
    """A quarter of a spherical crown, R = 20, pressed into a flat block of the same steel."""
    def ticks(fine, coarse, share):
        return np.concatenate([np.linspace(0.0, share, fine + 1),
                               share + (1.0 - share)*mesh_make.graded(coarse, 4.0)[1:]])
    up = mesh_make.crowned_block((6.0, 6.0, 6.0), (2*cells, 2*cells, 2*cells), 20.0,
                                 grading=[ticks(cells, cells, 0.233)]*3, quadratic=quadratic)
    low = mesh_make.block((6.0, 6.0, 6.0), (2*cells, 2*cells, 2*cells), origin=(0.0, 0.0, -6.0),
                          grading=[ticks(cells, cells, 0.245)]*2
                          + [1.0 - ticks(cells, cells, 0.233)[::-1]], quadratic=quadratic)
    model = Model("crown", together(UP=up, LOW=low), kind="3d")
    for body in ("UP", "LOW"):
        model.section(body, Elastic(200e3, 0.3))
        model.fix(f"{body}.LEFT", "x")
        model.fix(f"{body}.FRONT", "y")
    surfaces = ("UP.BOTTOM", "LOW.TOP")
    model.contact(*surfaces[::1 if slave == "crown" else -1], surface_to_surface=mortar)
    model.fix("LOW.BOTTOM", "z")
    model.step().move("UP.TOP", z=-0.065)
    return model


@pytest.mark.parametrize("quadratic", [False, True])
def test_hertz_in_space_with_sides_swapped(solve, sheet, quadratic):
    case, cells = "A4 crown on a block in space, mortar", 4 if quadratic else 7
    force = {}
    for slave in ("crown", "block"):
        result = solve(crown_on_block(cells, slave, quadratic=quadratic))
        assert result.summary["certificate"]["verdict"] == "PASS"
        contact = result.contact(0).last
        force[slave] = 4.0*abs(float(np.sum(contact.force[:, 2].astype(float))))
        name = f"{'second' if quadratic else 'first'} order, {slave} slave"
        a = (0.75*force[slave]*20.0*2.0*(1.0 - 0.09)/200e3)**(1/3)
        peak = 1.5*force[slave]/(np.pi*a**2)
        r = np.linalg.norm(contact.x[:, :2], axis=1)
        p = contact.pressure.astype(float)
        hertz = peak*np.sqrt(np.maximum(0.0, 1.0 - (r/a)**2))
        sheet.compare(case, f"{name}: largest pressure", p.max(), peak, 0.02,
                      "Hertz for the computed force")
        sheet.compare(case, f"{name}: L2 error of the pressure",
                      np.linalg.norm(p - hertz)/np.linalg.norm(hertz), 0.0, 0.07, absolute=True)
    sheet.compare(case, f"{'second' if quadratic else 'first'} order: force with sides swapped",
                  force["block"], force["crown"], 0.01, "crown slave")
