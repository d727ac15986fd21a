"""Bricks of one integration point with hourglass control: they bend like beams, pass the patch test
through contact, store nothing when they turn, and the certificate says what their control holds."""
import numpy as np
import pytest

import lopin
from conftest import ROOT

YOUNG = 1000.0
CONTROLS = "*SECTION CONTROLS, NAME=ONE, HOURGLASS=ENHANCED\n"


def bricks(name, low, high, counts, first=0, controls=True, poisson=0.3):
    """A box of C3D8R with node sets and surfaces of its lower and upper side."""
    low, high = np.array(low, float), np.array(high, float)
    nx, ny, nz = counts
    place = {}
    lines = ["*NODE"]
    for k in range(nz + 1):
        for j in range(ny + 1):
            for i in range(nx + 1):
                label = first + 1 + i + (nx + 1)*(j + (ny + 1)*k)
                place[i, j, k] = label
                x = low + (high - low)*np.array([i/nx, j/ny, k/nz])
                lines.append(f"{label}, {x[0]:.12g}, {x[1]:.12g}, {x[2]:.12g}")
    lines.append(f"*ELEMENT, TYPE=C3D8R, ELSET={name}")
    label = first
    sides = {"LOW": [], "HIGH": []}
    for k in range(nz):
        for j in range(ny):
            for i in range(nx):
                label += 1
                ring = [place[i, j, k], place[i + 1, j, k], place[i + 1, j + 1, k],
                        place[i, j + 1, k]]
                lines.append(", ".join(map(str, [label, *ring,
                                                 *[n + (nx + 1)*(ny + 1) for n in ring]])))
                if k == 0:
                    sides["LOW"].append(label)
                if k == nz - 1:
                    sides["HIGH"].append(label)
    for side, face in (("LOW", "S1"), ("HIGH", "S2")):
        lines += [f"*ELSET, ELSET={name}{side}E", *map(str, sides[side]),
                  f"*SURFACE, NAME={name}{side}", f"{name}{side}E, {face}"]
    planes = {"X0": (0, 0), "X1": (0, nx), "Y0": (1, 0), "Y1": (1, ny), "Z0": (2, 0), "Z1": (2, nz)}
    for plane, (axis, at) in planes.items():
        lines += [f"*NSET, NSET={name}{plane}", *(str(n) for p, n in place.items() if p[axis] == at)]
    lines += [f"*MATERIAL, NAME=M{name}", "*ELASTIC", f"{YOUNG}, {poisson}",
              f"*SOLID SECTION, ELSET={name}, MATERIAL=M{name}" + (", CONTROLS=ONE" if controls else "")]
    return "\n".join(lines) + "\n"


def beam(counts, length, nlgeom, controls=True):
    """A cantilever 1 thick and 1 wide, its end moved down."""
    text = CONTROLS*controls + bricks("B", [0, 0, 0], [length, 1, 1], counts, controls=controls)
    down = 1e-3*length
    text += ("*BOUNDARY\nBX0, 1\nBX0, 3\nBY0, 2\n" f"*STEP{', NLGEOM'*nlgeom}\n*STATIC\n1., 1.\n"
             f"*BOUNDARY\nBX1, 3, 3, {-down}\n*END STEP\n")
    return solve(text), down


def solve(text):
    return lopin.run(lopin.Deck.parse(text, "bricks.inp", ROOT/"decks"))


def verdict(result):
    """Certificate and energies of the run."""
    return result.summary["certificate"], result.summary["energy"]


@pytest.mark.parametrize("nlgeom", [False, True])
@pytest.mark.parametrize("counts, length", [((20, 1, 1), 20.0), ((5, 1, 1), 20.0), ((20, 2, 2), 20.0)])
def test_one_point_bends_like_a_beam(counts, length, nlgeom):
    result, down = beam(counts, length, nlgeom)
    flexibility = length**3/(3*YOUNG/12) + length/(YOUNG/2.6*5/6)
    # The exact shape between the nodes is a cubic: (1 - 1/(4 n^2)) of the deflection, n cells long.
    expected = down/flexibility/(1 - 1/(4*counts[0]**2))
    certificate, energy = verdict(result)
    assert 2*energy["strain"]/down == pytest.approx(expected, rel=0.03)
    assert 0 < energy["hourglass"] <= energy["strain"]
    assert certificate["verdict"] == "WARN" and "artificial" in certificate["reason"]
    assert certificate["artificial"] == pytest.approx(energy["hourglass"]/energy["strain"])


def test_without_the_word_it_is_integrated_fully():
    result, down = beam((5, 1, 1), 20.0, False, controls=False)
    energy = verdict(result)[1]
    assert 2*energy["strain"]/down > 2.0*down/(20.0**3/(3*YOUNG/12))
    assert "hourglass" not in energy


@pytest.mark.parametrize("nlgeom", [False, True])
def test_the_patch_test_passes_through_contact(nlgeom):
    text = (CONTROLS + bricks("A", [0, 0, 0], [1, 1, 1], (2, 3, 2), poisson=0.0)
            + bricks("C", [0, 0, 1], [1, 1, 2], (3, 2, 2), first=1000, poisson=0.0)
            + "*SURFACE INTERACTION, NAME=I\n*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE\n"
            "CLOW, AHIGH\n*BOUNDARY\nAZ0, 3\nAX0, 1\nAY0, 2\nCX0, 1\nCY0, 2\n"
            f"*STEP{', NLGEOM'*nlgeom}\n*STATIC\n1., 1.\n*BOUNDARY\nCZ1, 3, 3, -0.02\n*END STEP\n")
    result = solve(text)
    pressure = result.contact(result.pairs[0]).at(-1).pressure
    assert pressure == pytest.approx(np.full(len(pressure), pressure[0]), rel=1e-9)
    certificate, energy = verdict(result)
    assert certificate["verdict"] == "PASS"
    assert energy.get("hourglass", 0.0) < 1e-12*energy["strain"]


def test_a_turn_stores_nothing():
    angle = 1.0
    text = CONTROLS + bricks("B", [0, 0, 0], [2, 1, 1], (2, 1, 1))
    at = {1 + i + 3*(j + 2*k): (float(i), float(j), float(k))
          for k in range(2) for j in range(2) for i in range(3)}
    turn = "".join(f"{n}, 1, 1, {x*np.cos(angle) - z*np.sin(angle) - x:.15g}\n{n}, 2\n"
                   f"{n}, 3, 3, {x*np.sin(angle) + z*np.cos(angle) - z:.15g}\n"
                   for n, (x, y, z) in at.items() if n != 2)
    result = solve(text + "*STEP, NLGEOM\n*STATIC, DIRECT\n1., 1.\n*BOUNDARY\n" + turn + "*END STEP\n")
    assert verdict(result)[1]["strain"] < 1e-20*YOUNG


def test_words_that_do_nothing_are_told():
    text = (CONTROLS + bricks("B", [0, 0, 0], [1, 1, 1], (1, 1, 1))).replace("C3D8R,", "C3D8,")
    result = solve(text + "*BOUNDARY\nBZ0, 3\nBX0, 1\nBY0, 2\n*STEP\n*STATIC\n*BOUNDARY\nBZ1, 3, 3, 0.01\n"
                   "*END STEP\n")
    assert any("HOURGLASS" in d["message"] for d in result.summary["diagnostics"])
