"""Thermal expansion and stresses of the start against closed forms, at small and at finite
strain."""
import math

import numpy as np
import pytest

from flow_scenes import grid

YOUNG, POISSON, ALPHA, RISE = 2000.0, 0.3, 1e-4, 150.0
STRAIN = ALPHA*RISE
SINGLE = 2e-7      # fields of the files have single precision
KINDS = ["CPE4", "CPE8", "CPE4I", "CPS4", "CPS8", "CAX4", "CAX8", "C3D8", "C3D20", "C3D4", "C3D10"]


def block(word, *, extra="", step="*TEMPERATURE\nALL, 170.", fixed=(), nlgeom=True,
          material="*EXPANSION\n1e-4", increments=2, end="", rollers=True):
    """A unit cube or square of a few elements on three rollers, at 20 degrees."""
    from lopin import Deck
    nodes, elements = mesh_of(word)
    x = np.array(list(nodes.values()))
    d = x.shape[1]
    lines = ["*NODE, NSET=ALL", *(f"{k}, " + ", ".join(repr(float(v)) for v in p)
                                  for k, p in nodes.items()),
             f"*ELEMENT, TYPE={word}, ELSET=BODY", *(f"{k + 1}, " + ", ".join(map(str, e))
                                                     for k, e in enumerate(elements))]
    for side, axis in zip("XYZ", range(d)):
        for value, end_name in ((x[:, axis].min(), "0"), (x[:, axis].max(), "1")):
            lines += [f"*NSET, NSET={side}{end_name}"] + [f"{k}," for k, p in nodes.items()
                                                          if abs(p[axis] - value) < 1e-9]
    lines += ["*MATERIAL, NAME=M", f"*ELASTIC\n{YOUNG}, {POISSON}", material,
              "*SOLID SECTION, ELSET=BODY, MATERIAL=M\n1.,",
              "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nALL, 20.", extra, "*BOUNDARY",
              *(f"{'XYZ'[i]}0, {i + 1}" for i in range(d) if rollers), *fixed,
              "*STEP" + (", NLGEOM" if nlgeom else ""),
              f"*STATIC, DIRECT\n{1.0/increments}, 1.", step,
              "*NODE FILE\nU, RF\n*EL FILE\nS, E\n*END STEP", end]
    return Deck.parse("\n".join(line for line in lines if line) + "\n", name="block")


def mesh_of(word):
    """Two by two quads, or a cube of one brick or five tetrahedra."""
    if not word.startswith("C3D"):
        nodes, elements, _ = grid(2, 2, 1.0, 1.0, word[3] == "8")
        return nodes, elements
    corner = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1),
              (0, 1, 1)]
    cells = [[0, 1, 2, 3, 4, 5, 6, 7]]
    edges = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6),
             (3, 7)]
    if word in ("C3D4", "C3D10"):
        cells = [[0, 1, 2, 5], [0, 2, 3, 7], [0, 5, 7, 4], [2, 7, 5, 6], [0, 2, 7, 5]]
        edges = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]
    nodes, elements = {k + 1: c for k, c in enumerate(corner)}, []
    label = {c: k for k, c in nodes.items()}
    for cell in cells:
        element = [c + 1 for c in cell]
        if word in ("C3D20", "C3D10"):
            for a, b in edges:
                middle = tuple((p + q)/2 for p, q in zip(corner[cell[a]], corner[cell[b]]))
                element.append(label.setdefault(middle, len(label) + 1))
                nodes[label[middle]] = middle
        elements.append(element)
    return nodes, elements


def stretch(word, nlgeom):
    """Strain of the free directions: plane strain holds the third one."""
    strain = STRAIN*(1.0 + POISSON) if word.startswith("CPE") else STRAIN
    return math.exp(strain) - 1.0 if nlgeom else strain


@pytest.mark.parametrize("nlgeom", [True, False], ids=["finite", "small"])
@pytest.mark.parametrize("word", KINDS)
def test_a_free_body_expands_without_stress(solve, word, nlgeom):
    result = solve(block(word, nlgeom=nlgeom))
    d = 3 if word.startswith("C3D") else 2
    assert result["U"][:, :d].max(axis=0) == pytest.approx(stretch(word, nlgeom), rel=1e-8)
    stress = np.asarray(result["S"])
    if word.startswith("CPE"):
        across = -YOUNG*STRAIN*(math.exp(-2.0*STRAIN*(1.0 + POISSON)) if nlgeom else 1.0)
        np.testing.assert_allclose(stress[:, 2], across, rtol=SINGLE)
        stress = stress[:, [0, 1, 3]]
    assert np.abs(stress).max() < 1e-7*YOUNG*STRAIN


@pytest.mark.parametrize("nlgeom", [True, False], ids=["finite", "small"])
@pytest.mark.parametrize("word", [word for word in KINDS if word[:3] not in ("CPE", "CAX")])
def test_a_clamped_bar_is_pressed(solve, sheet, word, nlgeom):
    """tau = -E alpha T; Cauchy stress divides by J = exp(2 (1 + nu) alpha T)."""
    result = solve(block(word, fixed=["X1, 1"], nlgeom=nlgeom))
    exact = -YOUNG*STRAIN*(math.exp(-2.0*(1.0 + POISSON)*STRAIN) if nlgeom else 1.0)
    sheet.compare("Heat", f"clamped bar, {word}, {'finite' if nlgeom else 'small'} strain: stress",
                  float(np.mean(result["S"][:, 0])), exact, SINGLE)


def test_a_slope_of_temperature_bends_without_stress(solve):
    """T = 150 y: u_x = a x y, u_y = a (y^2 - x^2)/2 in the space of quadratic quads."""
    nodes, _ = mesh_of("CPS8")
    heat = "*TEMPERATURE\n" + "\n".join(f"{k}, {20.0 + RISE*y!r}" for k, (_, y) in nodes.items())
    corner = next(k for k, place in nodes.items() if place == (1.0, 0.0))
    result = solve(block("CPS8", step=heat, nlgeom=False, rollers=False,
                         fixed=["1, 1, 2", f"{corner}, 2"]))
    assert np.abs(result["U"]).max() > 0.5*STRAIN
    assert np.abs(result["S"]).max() < 1e-8*YOUNG*STRAIN


def test_amplitudes_and_steps_lead_the_temperature(solve):
    """120 % at half time by an amplitude, then back to the start in a second step that says
    OP=NEW."""
    deck = block("CPS4", extra="*AMPLITUDE, NAME=A\n0., 0., 0.5, 1.2, 1., 1.",
                 step="*TEMPERATURE, AMPLITUDE=A\nALL, 170.", nlgeom=False,
                 end="*STEP\n*STATIC, DIRECT\n0.5, 1.\n*TEMPERATURE, OP=NEW\n*NODE FILE\nU\n*END STEP")
    result = solve(deck)
    free = [result.at(i)["U"][:, 0].max() for i in range(4)]
    np.testing.assert_allclose(free, ALPHA*np.array([184.0, 150.0, 75.0, 0.0]), rtol=SINGLE,
                               atol=1e-9)


@pytest.mark.parametrize("nlgeom", [True, False], ids=["finite", "small"])
@pytest.mark.parametrize("word", [word for word in KINDS if not word.startswith("CPS")])
def test_stresses_of_the_start_are_held_or_released(solve, word, nlgeom):
    """Held on all sides they stay; released, a bar shortens by their elastic strain."""
    d = 3 if word.startswith("C3D") else 2
    start = "*INITIAL CONDITIONS, TYPE=STRESS\nBODY, 30., -10., 20., 5.\n"
    held = block(word, extra=start, step="", nlgeom=nlgeom, fixed=[f"ALL, 1, {d}"])
    stress = np.asarray(solve(held)["S"])
    np.testing.assert_allclose(stress[:, :4], np.tile([30.0, -10.0, 20.0, 5.0], (len(stress), 1)),
                               rtol=SINGLE)
    if d == 2:
        return
    free = solve(block(word, extra="*INITIAL CONDITIONS, TYPE=STRESS\nBODY, 30.\n", step="",
                       nlgeom=nlgeom))
    strain = -30.0/YOUNG
    assert np.abs(free["S"]).max() < 1e-7*30.0
    assert free["U"][:, 0].min() == pytest.approx(math.exp(strain) - 1.0 if nlgeom else strain,
                                                  rel=1e-8)


def test_heat_that_meets_no_expansion_is_said(solve):
    result = solve(block("CPS4", material=""))
    assert any(warning.startswith("W0325") for warning in result.warnings)
