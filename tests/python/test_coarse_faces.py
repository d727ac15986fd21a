"""Second-order faces that are coarse for a ball: their early contact is said, and only theirs."""
import numpy as np
import pytest
from tool_patches import Lines, family, is_quadratic, numbers

from lopin.deck import Deck
from lopin.mesh_make import block, extruded, simplices

WORDS = ["C3D8", "C3D4", "C3D10", "C3D15", "C3D20", "C3D20R"]
SIDE, CELLS = 10.0, 6


def indented(word, radius, down, path, scale=1.0):
    """A ball over the middle of an edge of a block's top; it goes down, up where negative."""
    cell, edge = family(word), SIDE/CELLS
    mesh = block((SIDE, SIDE), (CELLS, CELLS))
    mesh = extruded(simplices(mesh) if cell == "wedge" else mesh, 4.0, 3)
    if cell == "tetra":
        mesh = simplices(mesh)
    if is_quadratic(word):
        mesh = mesh.quadratic()
    over = np.array([SIDE/2.0 + edge/2.0, SIDE/2.0, 4.0])
    mesh = mesh.mapped(lambda x: scale*(x - over))
    lines = Lines()
    lines.add("*HEADING", f"A ball on {word}", "*MATERIAL, NAME=M", "*ELASTIC", "200000., 0.3")
    lines.mesh(mesh, word, "B")
    lines.node += 1
    end = scale*radius*np.array([np.sin(0.8), 1.0 - np.cos(0.8)])
    lines.add("*SOLID SECTION, ELSET=BE, MATERIAL=M", "*NODE, NSET=P",
              f"{lines.node}, {numbers(np.zeros(3))}", "*SURFACE, NAME=BALL, TYPE=REVOLUTION",
              "0., 0., 0., 0., 0., 1.", f"START, {numbers(end)}",
              f"CIRCL, {numbers((0.0, 0.0, 0.0, scale*radius))}",
              f"*RIGID BODY, ANALYTICAL SURFACE=BALL, REF NODE={lines.node}",
              "*SURFACE INTERACTION, NAME=I", "*CONTACT PAIR, INTERACTION=I", "BSTOP, BALL",
              "*BOUNDARY", "BBOTTOM, 1, 3", "P, 1, 2", "P, 4, 6", f"*STEP{path}", "*STATIC",
              "1., 1.", "*BOUNDARY", f"P, 3, 3, {-scale*down!r}", "*END STEP")
    return Deck.parse("\n".join(lines.text) + "\n", name=f"coarse_{word.lower()}")


def said(result):
    return [w for w in result.diagnostics if w["code"] == "W0558"]


@pytest.mark.parametrize("path", ["", ", NLGEOM"])
@pytest.mark.parametrize("word", WORDS)
def test_a_ball_that_is_met_too_early_is_said(solve, word, path):
    result = solve(indented(word, 8.0, -0.004, path))
    early = abs(result.history["BALL.rf3"][-1]) > 0.0
    assert early == is_quadratic(word)
    assert bool(said(result)) == early
    if early:
        assert " node " in said(result)[0]["message"]


@pytest.mark.parametrize("word", WORDS)
def test_many_nodes_in_contact_are_not_warned_of(solve, word):
    result = solve(indented(word, 300.0, 0.1, ""))
    assert not said(result)


def test_the_share_has_no_unit(solve):
    texts = [said(solve(indented("C3D10", 8.0, 0.002, "", scale)))[0]["message"]
             for scale in (1.0, 1.0e-3)]
    shares = [t.split("forces, are ")[1].split(" %")[0] for t in texts]
    assert shares[0] == shares[1]
