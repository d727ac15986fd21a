"""Tools narrower than the facets of their slaves: said, and ribs press on the node that they meet."""
import pytest

from lopin.deck import Deck
from lopin.mesh_make import block


def pressed(segments, down, path="", cells=16):
    """A block 40 by 10 under a tool that goes down; the top is at 0."""
    mesh = block((40.0, 10.0), (cells, 4), origin=(0.0, -10.0))
    text = ["*HEADING", "A block under a tool", *([f"*LOPIN, PATH={path}"] if path else []),
            "*NODE, NSET=N", *(f"{i + 1}, {x[0]!r}, {x[1]!r}" for i, x in
                               enumerate(mesh.points.tolist())), "*ELEMENT, TYPE=CPE4, ELSET=E"]
    for _, rows in mesh.blocks:
        text += [f"{i + 1}, " + ", ".join(str(n + 1) for n in r) for i, r in enumerate(rows.tolist())]
    text += ["*SURFACE, NAME=TOP", *(f"{e + 1}, S{f}" for e, f in mesh.surfaces["TOP"].tolist()),
             "*NSET, NSET=LOW", *(f"{n + 1}," for n in mesh.point_sets["BOTTOM"].tolist()),
             "*NODE, NSET=P", "9001, 0., 0.", "*SURFACE, NAME=TOOL, TYPE=SEGMENTS", *segments,
             "*RIGID BODY, ANALYTICAL SURFACE=TOOL, REF NODE=9001",
             "*MATERIAL, NAME=M", "*ELASTIC", "1000., 0.3", "*SOLID SECTION, ELSET=E, MATERIAL=M",
             "1.,", "*SURFACE INTERACTION, NAME=I", "*CONTACT PAIR, INTERACTION=I", "TOP, TOOL",
             "*BOUNDARY", "LOW, 1, 2", "P, 1", "P, 6", "*STEP, INC=100", "*STATIC", "0.25, 1.",
             "*BOUNDARY", f"P, 2, 2, {-down!r}", "*END STEP"]
    return Deck.parse("\n".join(text) + "\n", name="under")


def rib(centre, width, high=1.0):
    return ["START, 60., %r" % high, f"LINE, {centre + width/2!r}, {high!r}",
            f"LINE, {centre + width/2!r}, 0.", f"LINE, {centre - width/2!r}, 0.",
            f"LINE, {centre - width/2!r}, {high!r}", "LINE, -20., %r" % high]


def said(result):
    return [w for w in result.diagnostics if w["code"] in ("W0337", "W0338")]


@pytest.mark.parametrize("path", ["", "FINITE"])
def test_a_rib_over_one_node_presses_down_and_is_named(solve, path):
    result = solve(pressed(rib(22.5, 2.0), 0.6, path))
    assert said(result), "nothing is said of the rib"
    assert abs(result.history["TOOL.rf1"][-1]) < 1e-6*abs(result.history["TOOL.rf2"][-1])
    # The other path, and a rib that ends far above: the corner behind the wall is nothing.
    other = solve(pressed(rib(22.5, 2.0, high=30.0), 0.6, "" if path else "FINITE"))
    assert result.history["TOOL.rf2"][-1] == pytest.approx(other.history["TOOL.rf2"][-1], rel=1e-6)


@pytest.mark.parametrize("path", ["", "FINITE"])
def test_a_punch_between_nodes_is_named(solve, path):
    result = solve(pressed(rib(21.25, 1.0, high=9.0), 0.5, path))
    assert any("no node sees it" in w["message"] for w in said(result))


@pytest.mark.parametrize("path", ["", "FINITE"])
@pytest.mark.parametrize("width", [0.05, 0.1, 0.15])
def test_a_rib_much_narrower_than_a_facet_is_named(solve, path, width):
    # At 21.25 no place of a fixed lattice meets it.
    result = solve(pressed(rib(21.25, 2.5*width, high=9.0), 0.3, path))
    assert any("no node sees it" in w["message"] for w in said(result))


@pytest.mark.parametrize("path", ["", "FINITE"])
@pytest.mark.parametrize("tool", ["edge on a node", "edge between nodes", "round", "flat"])
def test_tools_wider_than_facets_are_not_named(solve, path, tool):
    segments = {"edge on a node": rib(20.0, 10.0, 9.0), "edge between nodes": rib(20.0, 12.0, 9.0),
                "round": ["START, 30., 10.", "CIRCL, 20., 0., 20., 10.",
                          "CIRCL, 10., 10., 20., 10."],
                "flat": ["START, 60., 0.", "LINE, -20., 0."]}[tool]
    assert not said(solve(pressed(segments, 0.3, path)))
