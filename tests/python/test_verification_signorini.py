"""Signorini's problem with a known answer: how fast displacements, stresses, pressures converge."""
import numpy as np
import pytest

from lopin import mesh_make, profile
from lopin.closed_form import signorini_singular, signorini_smooth
from lopin.laws import Elastic, Lagrange, Penalty
from lopin.model import Model
from lopin.mesh.shapes import shape_functions

YOUNG, POISSON = 1000.0, 0.3
FIELDS = {"singular": signorini_singular, "smooth": signorini_smooth}
#: Family: (quadratic, triangles, full integration)
FAMILIES = {"CPE4": (False, False, False), "CPE4 FULL": (False, False, True),
            "CPE3": (False, True, False), "CPE8": (True, False, False),
            "CPE6": (True, True, False)}


def scene(family, n, exact, method):
    """The unit square on a rigid floor, the exact displacements on its other three sides."""
    quadratic, triangles, full = FAMILIES[family]
    mesh = mesh_make.block((1.0, 1.0), (n, n))
    if triangles:
        mesh = mesh_make.simplices(mesh)
    if quadratic:
        mesh = mesh.quadratic()
    x = mesh.points
    sides = np.flatnonzero((x[:, 0] < 1e-9) | (x[:, 0] > 1.0 - 1e-9) | (x[:, 1] > 1.0 - 1e-9))
    mesh = mesh.replaced(point_sets=mesh.point_sets | {f"N{i + 1}": np.array([i]) for i in sides})
    model = Model("signorini", mesh)
    model.section("ALL", Elastic(YOUNG, POISSON), full_integration=full)
    floor = model.rigid_tool("FLOOR", profile.plane(0.0, 3.0, side="above"))
    model.contact("BOTTOM", floor, method)
    step = model.step()
    for i, u in zip(sides, exact(x[sides]).u):
        step.move(f"N{i + 1}", x=float(u[0]), y=float(u[1]))
    return model


def gauss(name):
    """Points and weights, exact well beyond what the elements need."""
    t, w = np.polynomial.legendre.leggauss(5)
    if name.startswith("quad"):
        return [((a, b), v*s) for a, v in zip(t, w) for b, s in zip(t, w)]
    # A square folded to the triangle (0,0) (1,0) (0,1).
    t, w = 0.5*(t + 1.0), 0.5*w
    return [((a, b*(1.0 - a)), v*s*(1.0 - a)) for a, v in zip(t, w) for b, s in zip(t, w)]


def errors(model, result, exact):
    """Relative errors: displacement in L2, stress energy, contact pressure in L2 of the floor."""
    u = np.asarray(result["displacement"])[:model.mesh.n_point, :2].astype(float)
    shear = YOUNG/(2.0*(1.0 + POISSON))
    lame = 2.0*shear*POISSON/(1.0 - 2.0*POISSON)
    total = np.zeros(4)
    for name, cells in model.mesh.blocks:
        x, v = model.mesh.points[cells], u[cells]
        for xi, weight in gauss(name):
            n, dn = shape_functions(name, xi)
            jacobian = np.einsum("end,nk->edk", x, dn)
            area = weight*np.linalg.det(jacobian)
            slope = np.einsum("nk,ekd->end", dn, np.linalg.inv(jacobian))
            grad = np.einsum("enc,end->ecd", v, slope)
            truth = exact(np.einsum("end,n->ed", x, n))
            e = np.einsum("enc,n->ec", v, n) - truth.u
            trace = grad[:, 0, 0] + grad[:, 1, 1]
            stress = np.stack([lame*trace + 2.0*shear*grad[:, 0, 0],
                               lame*trace + 2.0*shear*grad[:, 1, 1],
                               shear*(grad[:, 0, 1] + grad[:, 1, 0])], axis=1)
            total += [area @ (e**2).sum(1), area @ (truth.u**2).sum(1),
                      area @ energy(stress - truth.stress), area @ energy(truth.stress)]
    return (np.sqrt(total[0]/total[1]), np.sqrt(total[2]/total[3]),
            pressure_error(model, result, exact))


def energy(stress):
    """Twice the energy density of plane-strain stresses xx, yy, xy."""
    xx, yy, xy = stress.T
    return ((1.0 - POISSON**2)*(xx**2 + yy**2) - 2.0*POISSON*(1.0 + POISSON)*xx*yy
            + 2.0*(1.0 + POISSON)*xy**2)/YOUNG


def pressure_error(model, result, exact):
    """Nodal pressures, interpolated on the element edges, against the exact ones.

    The corners are prescribed and carry no contact force; the edges that end there do not count.
    """
    contact = result.contact(0).last
    order = np.argsort(contact.x[:, 0])
    x, p = contact.x[order, 0], contact.pressure.ravel()[order]
    width = 2 if model.mesh.blocks[0][0] in ("quad8", "triangle6") else 1
    t, w = np.polynomial.legendre.leggauss(8)
    above = below = 0.0
    for k in range(width, len(x) - 1 - width, width):
        nodes = slice(k, k + width + 1)
        s = 0.5*(x[k] + x[k + width]) + 0.5*(x[k + width] - x[k])*t
        truth = -exact(np.column_stack([s, 0.0*s])).stress[:, 1]
        lagrange = np.polynomial.Polynomial.fit(x[nodes], p[nodes], width)
        above += w @ (lagrange(s) - truth)**2*(x[k + width] - x[k])
        below += w @ truth**2*(x[k + width] - x[k])
    return np.sqrt(above/below)


def rates(values, sizes):
    """Slope of log error over log element size, by all meshes."""
    return np.polyfit(np.log(1.0/np.asarray(sizes)), np.log(values), 1)[0]


def study(solve, family, exact, sizes, method):
    """Rates of the three errors, and the errors of the finest mesh."""
    table = []
    for n in sizes:
        model = scene(family, n, exact, method(n))
        table.append(errors(model, solve(model), exact))
        print(f"{family} {n}: " + " ".join(f"{e:.2e}" for e in table[-1]))
    return [rates(column, sizes) for column in zip(*table)], table[-1]


CASES = {"singular": "A13 Signorini, singular end of contact", "smooth": "A14 Signorini, smooth"}
#: Rates of displacements in L2, of stresses, at least of the pressure; linear and quadratic.
RATES = {("singular", False): (2.0, 1.0, 1.0), ("singular", True): (2.25, 1.5, 1.0),
         ("smooth", False): (2.0, 1.0, 1.0), ("smooth", True): (3.0, 2.0, 2.0)}
SIZES = {False: (8, 16, 32), True: (4, 8, 16)}
#: Where the rates of the coarsest are not yet those of theory.
FINER = (8, 16, 32, 64)


@pytest.mark.parametrize("which", FIELDS)
@pytest.mark.parametrize("family", FAMILIES)
def test_rates_of_the_exact_method(solve, sheet, family, which):
    quadratic = FAMILIES[family][0]
    found, last = study(solve, family, FIELDS[which],
                        FINER if family == "CPE3" else SIZES[quadratic], lambda n: Lagrange())
    case = CASES[which]
    u, stress, pressure = RATES[which, quadratic]
    theory = "theory of finite elements"
    # A singular field leaves the rate of P2 displacements between 2 and 2.5.
    sheet.compare(case, f"{family}: rate of displacements in L2", found[0], u,
                  0.4 if (which, quadratic) == ("singular", True) else 0.15, theory, absolute=True)
    sheet.compare(case, f"{family}: rate of stresses (H1)", found[1], stress, 0.15, theory,
                  absolute=True)
    sheet.compare(case, f"{family}: rate of the contact pressure in L2", found[2], pressure, 0.15,
                  theory, absolute=True, at_least=True)
    sheet.compare(case, f"{family}: displacements in L2, finest mesh", last[0], 0.0, 5e-4,
                  "closed form", absolute=True)


@pytest.mark.parametrize("which", FIELDS)
def test_penalty_must_grow_as_the_mesh_is_refined(solve, sheet, which):
    """A slope proportional to 1/h keeps the rates of linear elements; a fixed one stalls."""
    exact = FIELDS[which]
    found, _ = study(solve, "CPE4", exact, FINER, lambda n: Penalty(10.0*YOUNG*n))
    fixed, _ = study(solve, "CPE4", exact, FINER, lambda n: Penalty(10.0*YOUNG*8))
    case, theory = CASES[which], "theory of the penalty method"
    sheet.compare(case, "CPE4, penalty 10 E/h: rate of stresses (H1)", found[1], 1.0, 0.15, theory,
                  absolute=True)
    sheet.compare(case, "CPE4, penalty 10 E/h: rate of the pressure in L2", found[2], 0.5, 0.15,
                  theory, absolute=True, at_least=True)
    sheet.compare(case, "CPE4, penalty kept at 80 E: rate of displacements in L2", fixed[0], 0.0,
                  0.3, "stalls at 1/slope", absolute=True)
