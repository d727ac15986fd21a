"""Ties whose slave nodes are eliminated against the same ties as rows with forces of their own.

PATH=NEWTON keeps every tie as rows; the condensed path eliminates the slave nodes of exact ties and
takes their forces from the residual. Displacements, stresses, reactions and tie forces are equal.
"""
import numpy as np
import pytest
from test_tied_gaps import TIES, stack
from test_tied_rings import RATIOS, WORDS, rings
from tool_patches import METHODS, Lines, family, is_quadratic

from lopin.deck import Deck
from lopin.mesh_make import block, extruded, simplices

OUTPUT = "*NODE FILE\nU, RF\n*EL FILE\nS\n*CONTACT FILE\nCSTRESS\n*END STEP"


def both(solve, text):
    """The deck on the path that eliminates, and on the one that does not."""
    text = text.replace("*END STEP", OUTPUT)
    found = []
    for path in ("CONDENSED", "NEWTON"):
        with_path = text.replace("*MATERIAL", f"*LOPIN, PATH={path}\n*MATERIAL", 1)
        found.append(solve(Deck.parse(with_path, name=path.lower())))
    return found


def eliminated(result):
    """Displacements of tied nodes that the plan says are eliminated."""
    words = result.summary["plan"].split(", ")
    return sum(int(w.split()[0]) for w in words if "displacements of tied nodes eliminated" in w)


def distance(one, other):
    """Largest difference of all fields and of the forces of all tied points, relative."""
    worst = 0.0
    for name in ("U", "RF", "S"):
        a, b = np.asarray(one[name]), np.asarray(other[name])
        worst = max(worst, np.abs(a - b).max()/np.abs(b).max())
    force = [np.concatenate([np.ravel(r.contact(p).last.force) for p in r.pairs])
             for r in (one, other)]
    return max(worst, np.abs(force[0] - force[1]).max()/np.abs(force[1]).max())


#: Rows of the others depend on each other in the planes of symmetry, which PATH=NEWTON refuses.
ON_PLANES = [w for w in WORDS if w[0] in ("C3D8", "C3D20") and w[1] == "C3D8"
             or w[0].startswith("CPE")]


@pytest.mark.parametrize("turn", [0.0, 0.6])
@pytest.mark.parametrize("words", ON_PLANES, ids="/".join)
def test_rings_are_those_of_rows(solve, words, turn):
    """Elements of the plane and of space, ends in planes of symmetry; turned, the ends have local
    axes, and their slave nodes stay rows."""
    ratios = list(RATIOS)[:1 if words[0].startswith("C3D") else 5]
    deck, _ = rings(words, "condensed", [(r, "tie", turn) for r in ratios])
    one, other = both(solve, deck.text())
    assert eliminated(one) > 0 and eliminated(other) == 0
    assert distance(one, other) < 1e-9


@pytest.mark.parametrize("words", [w for w in WORDS if w not in ON_PLANES]
                         + [("C3D20", "C3D20"), ("C3D6", "C3D8")], ids="/".join)
def test_beams_of_two_blocks_are_those_of_rows(solve, words):
    """A block tied across a flat seam to one that is clamped, bent and sheared."""
    lines = Lines()
    lines.add("*MATERIAL, NAME=M", "*ELASTIC", "1000., 0.3")
    for name, word, start, cells in (("I", words[0], 0.0, (2, 3)), ("O", words[1], 1.0, (2, 2))):
        cell = family(word)
        mesh = block((1.0, 1.0), cells)
        if cell == "wedge":
            mesh = simplices(mesh)
        mesh = extruded(mesh, 1.0, 2)
        mesh = simplices(mesh) if cell == "tetra" else mesh
        mesh = mesh.quadratic() if is_quadratic(word) else mesh
        lines.mesh(mesh.mapped(lambda x, start=start: x + [start, 0.0, 0.0]), word, name)
        lines.add(f"*SOLID SECTION, ELSET={name}E, MATERIAL=M")
    lines.add("*TIE, NAME=T", "ISRIGHT, OSLEFT", "*BOUNDARY", "ILEFT, 1, 3", "*STEP", "*STATIC",
              "1., 1.", "*DSLOAD", "OSTOP, P, 1.", "OSRIGHT, P, -2.", "*END STEP")
    one, other = both(solve, "\n".join(lines.text) + "\n")
    assert eliminated(one) > 0 and eliminated(other) == 0
    assert distance(one, other) < 1e-9


@pytest.mark.parametrize("tie", TIES)
@pytest.mark.parametrize("gap", [0.0, 0.1])
@pytest.mark.parametrize("d", [2, 3])
def test_arms_across_a_gap_are_those_of_rows(solve, d, gap, tie):
    drive = ["*BOUNDARY", f"A.LOW, 1, {d}", "*CLOAD", "B.HIGH, 1, 0.2", f"B.HIGH, {d}, -0.1"]
    one, other = both(solve, stack(d, tie, False, gap, drive)[0])
    assert eliminated(one) == d*5**(d - 1)
    assert distance(one, other) < 1e-9


@pytest.mark.parametrize("way", METHODS)
def test_pairs_whose_method_gives_way_stay_rows(solve, way):
    deck, _ = rings(("CPE4", "CPE4"), "condensed", [("8:6", way, 0.0)])
    one, _ = both(solve, deck.text())
    soft = way != "DIRECT"
    assert (eliminated(one) == 0) == soft, way


def test_a_chain_of_ties_is_that_of_rows(solve):
    """The middle block is slave below and master above: slaves depend on slaves at its corners
    where both surfaces meet."""
    drive = ["*BOUNDARY", "C.LOW, 1, 2", "*CLOAD", "B.HIGH, 1, 0.2"]
    text = stack(2, "mortar", False, 0.0, drive)[0]
    text = text.replace("B.S1, A.S2", "B.S1, A.S2\nA.S1, C.S2")
    third = stack(2, "mortar", False, 0.0, [])[0].split("*MATERIAL")[0].split("*NODE, NSET=B")[0]
    lines = []
    for line in third.replace("NSET=A", "NSET=C").replace("NAME=A.", "NAME=C.").splitlines():
        if line.startswith("*"):
            lines.append(line)
            shift = 1.0 if line.startswith("*NODE") else 0.0
            continue
        head, *rest = line.split(", ")
        if shift:
            x, y = map(float, rest)
            lines.append(f"{int(head) + 5000}, {x!r}, {y - 1.0!r}")
        else:
            lines.append(", ".join([str(int(head) + 5000),
                                    *(str(int(r) + 5000) if r.isdigit() else r for r in rest)]))
    one, other = both(solve, "\n".join(lines) + "\n" + text)
    assert eliminated(one) == 2*(5 + 4)
    assert distance(one, other) < 1e-9
