"""What springs that hold a free body would do beside its exact device (map 12): nothing holds this
block but a plane, and a pressure drives it across a gap onto that."""
import numpy as np
import pytest
from tool_patches import Lines

from lopin.deck import Deck
from lopin.mesh_make import block

GAP, WIDTH, YOUNG = 0.01, 4.0, 1000.0


def pressed(spring, pressure):
    """`spring`: stiffness to the ground of all nodes of the top together, beside the modulus."""
    lines = Lines()
    lines.add("*HEADING", "free block", "*MATERIAL, NAME=M", f"*ELASTIC\n{YOUNG}, 0.3")
    lines.mesh(block((WIDTH, 2.0), (8, 4)).moved(0.0, GAP), "CPE4", "B")
    top = lines.node - 8
    lines.node += 1
    lines.add("*SOLID SECTION, ELSET=BE, MATERIAL=M", f"*NODE, NSET=P\n{lines.node}, 0., 0.",
              "*SURFACE, NAME=T, TYPE=SEGMENTS", "START, -30., 0.", "LINE, 30., 0.",
              f"*RIGID BODY, ANALYTICAL SURFACE=T, REF NODE={lines.node}",
              "*SURFACE INTERACTION, NAME=I", "*CONTACT PAIR, INTERACTION=I", "BSBOTTOM, T")
    if spring:
        lines.add("*ELEMENT, TYPE=SPRING1, ELSET=GROUND",
                  *(f"{9001 + i}, {top + i}" for i in range(9)),
                  "*SPRING, ELSET=GROUND", "2", f"{spring*YOUNG/9.0!r}")
    lines.add("*BOUNDARY", "BLEFT, 1", "P, 1, 2", "P, 6", "*STEP", "*STATIC", "*DSLOAD",
              f"BSTOP, P, {pressure*YOUNG!r}", "*END STEP")
    return Deck.parse("\n".join(lines.text) + "\n", name="free")


def lost(result, pressure):
    """Share of the load that does not arrive at the plane."""
    force = np.sum(result.contact(0).last.force, axis=0)[1]
    return 1.0 - force/(pressure*YOUNG*WIDTH)


@pytest.mark.parametrize("pressure", [1e-5, 1e-3])
def test_a_free_body_needs_no_spring(solve, pressure):
    assert abs(lost(solve(pressed(0.0, pressure)), pressure)) < 1e-6   # single precision


@pytest.mark.parametrize("pressure", [1e-5, 1e-3])
def test_a_spring_takes_its_stiffness_times_the_way(solve, pressure):
    """The way is the gap and what the block gives: the lighter the load, the worse."""
    shares = []
    for spring in (1e-4, 1e-3):
        result = solve(pressed(spring, pressure))
        way = -np.mean(result["U"][-10:-1, 1])   # the reference node is the last
        share = lost(result, pressure)
        assert np.isclose(share, spring*way/(pressure*WIDTH), rtol=1e-2, atol=2e-6)
        shares.append(share)
    assert np.isclose(shares[1], 10.0*shares[0], rtol=0.1, atol=1e-5)
