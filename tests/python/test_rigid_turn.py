"""A rigid body takes a body without loads along, by any angle: no stress, whatever the axes of the
supports are.

All forces are rounding there. What of them is nothing is known by sizes of stiffnesses: local axes
and equations combine those with coefficients of either sign, and signed sums of them cancel.
"""
import numpy as np
import pytest

import lopin
from lopin.mesh_make import block, simplices

WAYS = {"one": (1.0, 0.7, -1.2), "two": (-0.4, 1.3, 0.8), "axis": (0.0, 0.0, 1.5)}


def turn(w):
    """Of a rotation vector (Rodrigues)."""
    w = np.array(w)
    angle = np.linalg.norm(w)
    k = np.cross(np.eye(3), w/angle)
    return np.eye(3) + np.sin(angle)*k + (1.0 - np.cos(angle))*k@k


AXES = turn((0.3, -1.1, 0.6))


def solid(kind, n):
    mesh = block((2.0, 2.0, 2.0), (n, n, n), origin=(-1.0, -1.0, -1.0))
    if kind in ("C3D4", "C3D10"):
        mesh = simplices(mesh)
    return mesh if kind in ("C3D4", "C3D8") else mesh.quadratic()


def scene(kind, n, way, seed, coupled):
    """A cube about its reference node; its supports stand in turned axes. The rigid nodes are those
    of its base, or of its middle; then opposite nodes of its ends move by opposite ways."""
    mesh = solid(kind, n)
    x = mesh.points
    number = np.arange(1, len(x) + 1)
    if seed:
        number = np.random.default_rng(seed).permutation(number)
    free = coupled or seed % 2 == 0
    place = x if free else x@AXES.T
    base = np.abs(x[:, 2] - (0.0 if coupled else -1.0)) < 1e-9
    sets = {"BASE": number[base], "ALL": number}
    text = ["*NODE", *(f"{number[i]}, " + ", ".join(f"{v:.17g}" for v in place[i])
                       for i in np.argsort(number)), "9001, 0., 0., 0.",
            f"*ELEMENT, TYPE={kind}, ELSET=E"]
    for _, rows in mesh.blocks:
        for i, row in enumerate(rows.tolist()):
            words = [str(i + 1), *(str(number[k]) for k in row)]
            text += [", ".join(words[k:k + 12]) + ","*(k + 12 < len(words))
                     for k in range(0, len(words), 12)]
    for name, nodes in sets.items():
        text += [f"*NSET, NSET={name}", *(f"{k}," for k in nodes)]
    text += ["*NSET, NSET=P", "9001", "*MATERIAL, NAME=M", "*ELASTIC", "1000., 0.3",
             "*SOLID SECTION, ELSET=E, MATERIAL=M", "*RIGID BODY, NSET=BASE, REF NODE=9001"]
    if coupled:
        ends = np.flatnonzero(x[:, 2] > 0.999)
        for i in ends:
            j = int(np.argmin(np.abs(x + x[i]).sum(axis=1)))
            for k in (1, 2, 3):
                text += ["*EQUATION", "2", f"{number[i]}, {k}, 1., {number[j]}, {k}, 1."]
    else:
        text += [f"*TRANSFORM, NSET={name}\n" + ", ".join(f"{v:.17g}" for v in
                 (*AXES[:, 0], *AXES[:, 1])) for name in ("ALL", "P")]
    w = WAYS[way]
    text += ["*BOUNDARY", "P, 1, 3", "*STEP, INC=1000, NLGEOM", "*STATIC", "0.1, 1.", "*BOUNDARY",
             *(f"P, {4 + k}, {4 + k}, {w[k]!r}" for k in range(3)), "*END STEP"]
    about = w if coupled else AXES@np.array(w)
    return lopin.Deck.parse("\n".join(text) + "\n", name="turn"), place@(turn(about) - np.eye(3)).T, number


def check(solve, *how):
    deck, expected, number = scene(*how)
    result = solve(deck)
    assert result.verdict == "PASS"
    # Rounding of the balance, over a stiffness: far below what single precision shows.
    label = result["LABEL"].ravel()
    order = np.argsort(label)
    u = result["displacement"][order[np.searchsorted(label[order], number)]]
    assert np.abs(u - expected).max() < 1e-5


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("kind, n", [("C3D4", 2), ("C3D8", 2), ("C3D8", 3), ("C3D10", 1), ("C3D10", 2),
                                     ("C3D20", 2), ("C3D20R", 2)])
def test_supports_in_local_axes(solve, kind, n, way):
    check(solve, kind, n, way, 0, False)


@pytest.mark.parametrize("seed", range(1, 9))
def test_numbers_of_nodes_do_not_matter(solve, seed):
    check(solve, "C3D8", 2, "one", seed, False)


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("kind, n", [("C3D8", 2), ("C3D10", 2), ("C3D20", 2)])
def test_equations_of_unlike_signs(solve, kind, n, way):
    check(solve, kind, n, way, 0, True)
