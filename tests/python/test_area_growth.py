"""Bounds of shear are stresses on the area at the end of an increment, however much it grows in it."""
import numpy as np
import pytest

from tool_patches import Lines, block_of, numbers, plane_tool

TAU, YIELD, ALPHA = 30.0, 100.0, 8.0
LAWS = {"taumax": (f", TAUMAX={TAU}\n10.,", TAU),
        "tresca": (f", LAW=TRESCA\n{float(TAU*np.sqrt(3.0)/YIELD)!r},", TAU),
        "rate": (f", LAW=NORTON-HOFF\n{ALPHA!r}, 0.", ALPHA)}


def squeezed(word, law, method="DIRECT", increments=1, words=""):
    """A soft block pressed by a third of its height and drawn along the tool meanwhile."""
    lines, mesh = Lines(), block_of(word)
    d = mesh.ndim
    top = mesh.points[:, d - 1].max()
    lines.add("*MATERIAL, NAME=M", "*ELASTIC", "1000., 0.3", "*PLASTIC, ONLY=FRICTION", f"{YIELD}, 0.")
    lines.mesh(mesh, word, "B")
    first = lines.node - mesh.n_point + 1
    high = [first + i for i, x in enumerate(mesh.points) if abs(x[d - 1] - top) < 1e-9]
    plane_tool(lines, "B", np.eye(d))
    tool = lines.node
    lines.add("*NSET, NSET=TOP", *(f"{n}," for n in high))
    lines.add("*SOLID SECTION, ELSET=BE, MATERIAL=M", *(["1.,"] if d == 2 else []))
    lines.add("*SURFACE INTERACTION, NAME=I", f"*SURFACE BEHAVIOR, {method}",
              f"*FRICTION{LAWS[law][0].replace(chr(10), words + chr(10), 1)}",
              "*CONTACT PAIR, INTERACTION=I, TYPE=NODE TO SURFACE", "BSBOTTOM, BT")
    lines.add("*BOUNDARY", f"{tool}, 1, 6",
              "*STEP, NLGEOM, INC=1000", "*STATIC, DIRECT", numbers([1.0/increments, 1.0]),
              "*BOUNDARY", *(f"TOP, {k}, {k}" for k in range(2, d)),
              "BLEFT, 1" if word.startswith("CAX") else "TOP, 1, 1, -0.8",
              f"TOP, {d}, {d}, {-float(top)/3.0!r}", "*NODE FILE", "U, RF", "*END STEP")
    return "\n".join(lines.text)


def shears(result, d):
    """Shear on the present area of each point that slips."""
    contact = result.contact(0).last
    force = np.asarray(contact.force, dtype=float)
    weight = np.asarray(contact["weight"], dtype=float)
    slips = np.asarray(contact.status) == 2
    assert np.count_nonzero(slips) >= len(slips) - 1
    return np.linalg.norm(force[slips, :d - 1], axis=1)/weight[slips]


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("word", ["CPE4", "CAX4", "CPE8", "C3D8", "C3D10", "C3D15"])
def test_the_bound_acts_on_the_area_of_the_end(solve, word, law):
    from lopin import Deck

    increments = 2 if word == "C3D15" else 1
    result = solve(Deck.parse(squeezed(word, law, increments=increments), name="squeezed"))
    d = 3 if word.startswith("C3D") else 2
    stress = shears(result, d)
    assert stress == pytest.approx(LAWS[law][1], rel=1e-6)


@pytest.mark.parametrize("words", ["", ", ELASTIC SLIP=1.E-4"])
@pytest.mark.parametrize("method", ["PENALTY", "PERTURBED LAGRANGE", "AUGMENTED LAGRANGE"])
@pytest.mark.parametrize("word", ["CPE4", "C3D8"])
def test_by_every_method(solve, word, method, words):
    from lopin import Deck

    deck = squeezed(word, "taumax", method, 2, words)
    stress = shears(solve(Deck.parse(deck, name="squeezed")), 3 if word == "C3D8" else 2)
    assert stress == pytest.approx(TAU, rel=1e-6)
