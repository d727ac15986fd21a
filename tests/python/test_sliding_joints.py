"""Nodes that slide over the joints of facets: ironing by node to segment, a corner under a beam, a
folded strip."""
import sys

import numpy as np
import pytest

from conftest import ROOT
from lopin import Deck, run

sys.path.insert(0, str(ROOT/"decks"/"make"))
import sliding  # noqa: E402

PLATEAU = 1.4   # time from which the forces of ironing are steady


def in_process(text: str, name: str):
    """The result of a deck, in double precision."""
    return run(Deck.parse(text, name, ROOT/"decks"))


def direct(text: str) -> str:
    """The same increments, and none smaller."""
    changed = text.replace("*STATIC\n0.1, 1., 1.E-5, 0.1", "*STATIC, DIRECT\n0.1, 1.").replace(
        "*STATIC\n0.05, 1., 1.E-5, 0.05", "*STATIC, DIRECT\n0.05, 1.")
    assert changed.count("DIRECT\n0.") == 2
    return changed


def ripple(time, force):
    """Largest departure from a parabola beside the mean, while the die is drawn."""
    on = np.asarray(time) > PLATEAU
    t, f = np.asarray(time)[on], np.asarray(force)[on]
    return np.abs(f - np.polyval(np.polyfit(t, f, 2), t)).max()/abs(f.mean())


@pytest.mark.parametrize("name, options, most", [
    ("node to segment, die of 32 facets", {"kind": "NODE TO SURFACE", "around": 32}, (0.08, 0.01)),
    ("mortar", {"kind": "SURFACE TO SURFACE"}, (0.02, 0.005))])
def test_ironing_in_equal_increments(solve, sheet, name, options, most):
    """D1: the die slides over ten facets and their joints; no increment is cut."""
    result = solve(Deck.parse(direct(sliding.ironing(16, 4.0, **options)), "ironing", ROOT/"decks"))
    history, case = result.history, "D1 shallow ironing, increments prescribed"
    time = np.asarray(history["time"])
    assert len(time) == 30 and time[-1] == pytest.approx(2.0)
    head = "DIE.OUTER-SLAB.TOP.force"
    along, down = np.asarray(history[head + "1"]), np.asarray(history[head + "2"])
    for what, force, bound in (("along", along, most[0]), ("down", down, most[1])):
        sheet.compare(case, f"{name}: ripple of the force {what}", ripple(time, force), 0.0, bound,
                      "a steady force", absolute=True)
    lean = np.abs(along/down)[time > PLATEAU]
    sheet.compare(case, f"{name}: force along over force down, between mu and 1.5 mu",
                  lean.mean()/0.3, 1.25, 0.25, "Coulomb and ploughing", absolute=True)
    assert ((lean > 0.3*(1.0 - most[0])) & (lean < 0.45)).all()


@pytest.mark.parametrize("name, cells, quadratic", [("quadratic facets", (80, 2), True),
                                                    ("linear facets", (100, 2), False)])
def test_a_beam_over_a_corner(core, sheet, name, cells, quadratic):
    """D3: the force is square to the beam, wherever the corner is under it, and all moments
    balance."""
    result = in_process(sliding.beam_over_corner(cells, quadratic=quadratic), "beam_over_corner")
    mesh, case = result.to_meshio(), "D3 beam over a corner"
    x = np.asarray(mesh.points, float)[:, :2] + np.asarray(result["U"], float)[:, :2]
    force = np.asarray(result["RF"], float)[:, :2]
    size = np.abs(force).max()
    sheet.compare(case, f"{name}: sum of clamp, corner and end",
                  np.abs(force.sum(axis=0)).max()/size, 0.0, 1e-8, "equilibrium", absolute=True)
    moment = (x[:, 0]*force[:, 1] - x[:, 1]*force[:, 0]).sum()
    sheet.compare(case, f"{name}: their moments over force times length", abs(moment)/(200.0*size),
                  0.0, 1e-8, "equilibrium", absolute=True)
    corner = np.flatnonzero(np.hypot(*(mesh.points[:, :2] - [100.0, 0.0]).T) < 1e-6)
    corner = corner[np.abs(force[corner]).max(axis=1).argmax()]
    way = tangent_at(mesh, x, x[corner], quadratic)
    lean = force[corner]/np.hypot(*force[corner])
    sheet.compare(case, f"{name}: cosine of the force at the corner and the beam", abs(lean @ way),
                  0.0, 1e-8, "square to the beam", absolute=True)
    assert abs(lean[0]) > 0.05


def tangent_at(mesh, x, at, quadratic):
    """Unit tangent of the lower side of the beam where it is nearest to a point."""
    low = np.flatnonzero((np.abs(mesh.points[:, 1]) < 1e-9) & (mesh.points[:, 0] < 200.0 + 1e-9))
    used = np.isin(low, np.unique(np.concatenate([b.data.ravel() for b in mesh.cells
                                                  if len(b.data) > 1])))
    low = low[used]
    low = low[np.argsort(mesh.points[low, 0])]
    width = 2 if quadratic else 1
    best = None
    for k in range(0, len(low) - width, width):
        nodes = x[low[k:k + width + 1]]
        powers = np.polyfit(np.linspace(-1.0, 1.0, width + 1), nodes, width)
        s = 0.0
        for _ in range(30):
            r, d = at - horner(powers, s), horner(slope_of(powers), s)
            s = np.clip(s + (r @ d)/(d @ d), -1.0, 1.0)
        distance = np.hypot(*(at - horner(powers, s)))
        if best is None or distance < best[0]:
            best = distance, horner(slope_of(powers), s)
    assert best[0] < 1e-8
    return best[1]/np.hypot(*best[1])


def slope_of(powers):
    """Coefficients of the derivative, highest first."""
    degree = len(powers) - 1
    return powers[:-1]*np.arange(degree, 0, -1)[:, None]


def horner(powers, s):
    """A polynomial with vectors as coefficients, highest first."""
    value = np.zeros(powers.shape[1])
    for row in powers:
        value = value*s + row
    return value


def test_a_strip_folded_in_space(core):
    """Its legs close without a node passing through, and alike on both faces but for who
    presses."""
    result = in_process(sliding.folded_strip(), "folded_strip")
    history = result.history
    assert result.times[-1] == pytest.approx(1.0)
    assert history["INSIDE-INSIDE.closed"][-1] == 15
    assert np.max(history["INSIDE-INSIDE.max_penetration"]) < 1e-9
    mesh, u = result.to_meshio(), np.asarray(result["U"], float)
    order = [np.lexsort(np.round(np.column_stack([mesh.points[:, :2],
                                                  side*(mesh.points[:, 2] - 3.0)]), 6).T)
             for side in (1.0, -1.0)]
    np.testing.assert_allclose(u[order[0], :2], u[order[1], :2], atol=1e-4*np.abs(u).max())
