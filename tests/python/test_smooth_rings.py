"""Benchmark D5: shrink-fitted rings of unequal facets. Without smoothing the pressure ripples with
the sagitta of the chords; with it the pressure is that of Lame."""
import subprocess

import numpy as np
import pytest

from lopin.run import find_executable

R_IN, R_FIT, R_OUT, DELTA, E, NU = 10.0, 30.0, 50.0, 0.01, 210e3, 0.3
EXACT = 22.792022          # plane strain


def ring(first, inner, outer, around, layers, turn):
    """Nodes and elements of one ring; the first row of nodes is the inner one."""
    nodes, elements = [], []
    for j in range(layers + 1):
        r = inner + (outer - inner)*j/layers
        for i in range(around):
            a = 2*np.pi*i/around + turn
            nodes.append(f"{first + j*around + i}, {r*np.cos(a):.15g}, {r*np.sin(a):.15g}")
    for j in range(layers):
        for i in range(around):
            a, b = first + j*around + i, first + j*around + (i + 1) % around
            elements.append(f"{first + j*around + i}, {a}, {a + around}, {b + around}, {b}")
    return nodes, elements


def pressures(folder, smooth, turn, finite=False, around=(48, 60)):
    """Pressures of the shaft's nodes."""
    n_in, n_out = around
    nodes, elements = ring(1, R_IN, R_FIT + DELTA, n_in, 10, turn)
    more, others = ring(10001, R_FIT, R_OUT, n_out, 10, 0.0)
    last = 10*n_in                            # first node of the fitted row of the inner ring
    pins = []
    for start, count, shift in ((1, n_in, turn), (10001 + 10*n_out, n_out, 0.0)):
        # Four nodes without tangential motion hold the ring and leave it round.
        for q in range(4):
            i = start + q*count//4
            a = shift + np.pi/2*q
            pins.append((i, -np.sin(a), np.cos(a)))
    equations = "".join(f"*EQUATION\n2\n{i}, 2, {c:.15g}, {i}, 1, {s:.15g}\n" if abs(c) > abs(s)
                        else f"*EQUATION\n2\n{i}, 1, {s:.15g}, {i}, 2, {c:.15g}\n"
                        for i, s, c in pins)
    deck = "\n".join([
        "*NODE", *nodes, *more, "*ELEMENT, TYPE=CPE4, ELSET=INNER", *elements,
        "*ELEMENT, TYPE=CPE4, ELSET=OUTER", *others,
        "*MATERIAL, NAME=STEEL", "*ELASTIC", f"{E}, {NU}",
        "*SOLID SECTION, ELSET=INNER, MATERIAL=STEEL", "1.",
        "*SOLID SECTION, ELSET=OUTER, MATERIAL=STEEL", "1.",
        "*SURFACE, NAME=SHAFT", "INNER,", "*SURFACE, NAME=HUB", "OUTER,"])
    deck += "\n" + equations
    deck += "*NSET, NSET=FIT, GENERATE\n" + f"{last + 1}, {last + n_in}\n"
    deck += "*SURFACE INTERACTION, NAME=DRY\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD\n"
    deck += f"*CONTACT PAIR, INTERACTION=DRY, TYPE=NODE TO SURFACE, SMOOTH={smooth}\nSHAFT, HUB\n"
    if finite:
        deck += "*LOPIN, PATH=FINITE\n"
    deck += "*STEP\n*STATIC\n*CONTACT FILE\nCDIS, CSTR\n*CONTACT PRINT\nCDIS, CSTR\n*END STEP\n"
    (folder/"rings.inp").write_text(deck)
    done = subprocess.run(
        [find_executable(), "run", "rings.inp", "-o", ".", "--overwrite", "--quiet"], cwd=folder,
        capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr + deck[-800:]
    block = (folder/"rings.dat").read_text().split("contact stress")[1]
    rows = [line.split() for line in block.splitlines()[1:]]
    closed = [float(row[1]) for row in rows if len(row) == 4 and row[0].isdigit()]
    # Open points are not listed.
    return np.array(closed + [0.0]*(n_in - len(closed)))


@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize("around", [(48, 60), (60, 48)])
def test_smoothing_gives_the_pressure_of_round_rings(tmp_path, around, finite):
    """What ripples still is node to segment over unequal facets, not geometry."""
    faceted = pressures(tmp_path, "NO", 0.02, finite, around)
    smooth = pressures(tmp_path, "YES", 0.02, finite, around)
    assert faceted.mean() > 2*EXACT and np.ptp(faceted) > faceted.mean()
    assert smooth.mean() == pytest.approx(EXACT, rel=2e-3)
    assert np.ptp(smooth) < 0.12*EXACT


@pytest.mark.parametrize("turn", [0.0, 0.3, 0.5, 0.77])
def test_equal_smooth_facets_do_not_ripple_in_any_place(tmp_path, turn):
    p = pressures(tmp_path, "YES", turn*2*np.pi/48, around=(48, 48))
    assert p.mean() == pytest.approx(EXACT, rel=5e-3)
    assert np.ptp(p) < 1e-3*EXACT
