"""Patch tests of surface-to-surface contact by dual mortar, beside node to segment where it fails."""
import numpy as np
import pytest

import lopin
from blocks_2d import NU, YOUNG, Pair

CASE = "B1 patch test, mortar"
def in_process(deck):
    return lopin.run(deck)


PRESSED = (0.0, -1.0, -NU, 0.0)


@pytest.mark.parametrize("slave", ["lower", "upper"])
@pytest.mark.parametrize("kind", ["CPE4", "CPE3", "CPE8", "CPE6"])
@pytest.mark.parametrize("variant", ["plain", "turned by 27 degrees", "ratio of moduli 1000", "ratio of moduli 1/1000",
                                     "shorter upper block", "thickness 0.37"])
def test_uniform_pressure(core, solve, sheet, tmp_path, kind, variant, slave):
    pair = Pair(kind, 7, 10, 3, uneven=0.3, **({"left": 2.1, "right": 7.7} if variant.startswith("short") else {}))
    if variant.startswith("turned"):
        # Printed stresses have seven digits: enough where all but one vanish.
        pair.turned(27.0)
        solve = in_process
    if variant.startswith("ratio"):
        pair.young = (1e3, 1e6) if variant.endswith(" 1000") else (1e6, 1e3)
    if variant.startswith("thick"):
        pair.thickness = 0.37
    result = pair.pressed().solve(solve, tmp_path, slave=slave)
    case = CASE if kind == "CPE4" else "B5 patch test with other elements, mortar"
    sheet.compare(case, f"{kind}, 7/10 uneven, {slave} slave, {variant}: worst stress error",
                  pair.stress_error(result, PRESSED), 0.0, 1e-10, "exact", absolute=True)
    assert result.summary["certificate"]["verdict"] == "PASS"
    pressed = result.contact(0).last
    closed = pressed.status > 0
    assert np.abs(pressed.pressure[closed] - 1.0).max() < 1e-9


@pytest.mark.parametrize("kind", ["CPE4", "CPE8", "CPE3", "CPE6"])
@pytest.mark.parametrize("slave", ["lower", "upper"])
def test_any_share_of_a_facet(solve, sheet, tmp_path, kind, slave):
    """The end of the upper block at many places of a lower facet, hardly past its node and hardly before."""
    worst = 0.0
    for right in (7.5 + 2.5*np.array([1e-8, 1e-4, 5e-3, 0.04, 0.08, 0.2, 0.5, 0.9, 0.95, 0.999, 1 - 1e-7])):
        pair = Pair(kind, 4, 5, 2, left=2.5, right=float(right)).pressed()
        result = pair.solve(solve, tmp_path, slave=slave)
        worst = max(worst, pair.stress_error(result, PRESSED))
        assert result.summary["certificate"]["verdict"] == "PASS"
    sheet.compare("B1 patch test, mortar", f"{kind}, {slave} slave, 11 ends of the upper block: worst stress error",
                  worst, 0.0, 1e-10, "exact", absolute=True)


@pytest.mark.parametrize("kind", ["CPE4", "CPE8", "CPE6"])
@pytest.mark.parametrize("slave", ["lower", "upper"])
def test_a_tie_hands_on_any_uniform_strain(core, sheet, tmp_path, kind, slave):
    """Both meshes move with one linear field at their boundary, the ends of the tie included."""
    pair = Pair(kind, 7, 10, 3, uneven=0.3).turned(27.0)
    strain = np.array([[0.003, 0.004], [-0.001, -0.002]])
    lines = []
    for body in pair.bodies:
        low, high = body.x.min(0), body.x.max(0)
        for i, p in enumerate(body.nodes):
            sides = [abs(p[0] - low[0]) < 1e-9, abs(p[0] - high[0]) < 1e-9]
            outer = abs(p[1] - (low[1] if body is pair.low else high[1])) < 1e-9
            if outer or any(sides):
                u = strain @ p
                lines += [f"{body.first + 1 + i}, {d + 1}, {d + 1}, {float(u[d])!r}" for d in (0, 1)]
    pair.loads += ["*BOUNDARY", *lines]
    result = pair.solve(lopin.run, tmp_path, slave=slave, tie=True, words="")
    e = 0.5*(strain + strain.T)
    lame, shear = YOUNG*NU/((1 + NU)*(1 - 2*NU)), YOUNG/(1 + NU)
    expected = (lame*np.trace(e) + shear*e[0, 0], lame*np.trace(e) + shear*e[1, 1], lame*np.trace(e), shear*e[0, 1])
    sheet.compare("B3 patch test, tied", f"{kind}, 7/10 uneven, turned, {slave} slave: worst stress error",
                  pair.stress_error(result, expected), 0.0, 1e-10, "exact", absolute=True)


@pytest.mark.parametrize("kind", ["CAX4", "CAX8", "CAX3", "CAX6"])
@pytest.mark.parametrize("slave", ["lower", "upper"])
@pytest.mark.parametrize("inner", [0.0, 3.0])
def test_uniform_pressure_about_an_axis(solve, sheet, tmp_path, kind, slave, inner):
    pair = Pair(kind, 7, 10, 3, uneven=0.3, inner=inner).pressed()
    result = pair.solve(solve, tmp_path, slave=slave)
    name = "cylinder" if inner == 0.0 else "ring"
    sheet.compare("B1 patch test about an axis, mortar", f"{kind}, {name}, 7/10 uneven, {slave} slave: worst stress error",
                  pair.stress_error(result, (0.0, -1.0, 0.0, 0.0)), 0.0, 1e-10, "exact", absolute=True)
    assert result.summary["certificate"]["verdict"] == "PASS"


@pytest.mark.parametrize("kind", ["CPE4", "CPE8", "CPE6", "CAX4"])
def test_matching_meshes_are_as_node_to_segment(core, sheet, tmp_path, kind):
    """Under a load that is not uniform; linear facets of equal length have the same rows."""
    energy = {}
    for words in ("TYPE=SURFACE TO SURFACE", "TYPE=NODE TO SURFACE"):
        pair = Pair(kind, 6, 6, 3).pressed()
        pair.loads += ["*CLOAD", f"{pair.up.number[(5.0, 8.0)]}, 2, -3."] if kind != "CAX4" else []
        energy[words] = pair.solve(lopin.run, tmp_path, words=words).history["energy.strain"][-1]
    mortar, nodes = energy.values()
    sheet.compare("B1 patch test, mortar", f"{kind}, 6/6, point force besides: strain energy", mortar, nodes, 1e-12,
                  "node to segment")
