"""No force between bodies that do not touch, and no sense of turning at the joints of chords."""
import numpy as np
import pytest
from tool_patches import Lines

from lopin.deck import Deck
from lopin.mesh_make import block, ring

LIFT, RISE = 0.1, 0.32


def arched(down, word="CPE4", facets=8, nlgeom=False, friction=False, path="AUTO", pair="", behavior=""):
    """A convex tool of five chords comes down on a flat block: the least gap is that of the
    lowest chord, LIFT + RISE/25 - down."""
    lines = Lines()
    lines.add("*MATERIAL, NAME=M", "*ELASTIC", "1000., .3")
    space = word.startswith("C3D")
    wide = (1,) if space else ()
    up = 3 if space else 2

    def arch(x):
        y, u, w = np.array(x, dtype=float), x[:, 0], x[:, -1]
        y[:, 0] = 1.6*u - 0.8
        y[:, -1] = 0.5*w + (1.0 - w)*RISE*(2.0*u - 1.0)**2 + LIFT
        return y

    base = block((4.0, *wide, 2.0), (facets, *wide, 4), origin=(-2.0, *(0.0 for _ in wide), -2.0))
    lines.mesh(base, word, "B")
    lines.mesh(block((1.0, *wide, 1.0), (5, *wide, 2)).mapped(arch), word, "T")
    for name in "BT":
        lines.add(f"*SOLID SECTION, ELSET={name}E, MATERIAL=M", "1.,")
    lines.add("*SURFACE INTERACTION, NAME=C", *(("*FRICTION", "0.1,") if friction else ()),
              *((f"*SURFACE BEHAVIOR, {behavior}",) if behavior else ()), f"*LOPIN, PATH={path}",
              f"*CONTACT PAIR, INTERACTION=C, TYPE=SURFACE TO SURFACE{pair}", "BSTOP, TSBOTTOM",
              "*BOUNDARY", f"BBOTTOM, 1, {up}", "TTOP, 1",
              *(("BN, 2", "TN, 2") if space else ()),
              f"*STEP, INC=100{', NLGEOM' if nlgeom else ''}", "*STATIC", "0.5, 1.",
              "*BOUNDARY", f"TTOP, {up}, {up}, {-down!r}", "*CONTACT FILE", "CDIS, CSTR",
              "*END STEP")
    return Deck.parse("\n".join(lines.text) + "\n", name="arched")


@pytest.mark.parametrize("nlgeom", [False, True])
@pytest.mark.parametrize("word, facets, friction", [
    ("CPE4", 4, False), ("CPE4", 8, False), ("CPE4", 12, True), ("C3D8", 8, False)])
def test_no_force_across_a_gap(solve, word, facets, friction, nlgeom):
    result = solve(arched(LIFT + RISE/25.0 - 0.0028, word, facets, nlgeom, friction))
    assert np.abs(result.contact(0).last.pressure).max() < 1e-9


@pytest.mark.parametrize("nlgeom", [False, True])
@pytest.mark.parametrize("word", ["CPE4", "C3D8"])
@pytest.mark.parametrize("options", [{"pair": ", ADJUST=0."}, {"pair": ", ADJUST=0.01"}, {"behavior": "NO SEPARATION"}])
def test_nor_where_nodes_may_be_adjusted_or_are_to_stay(solve, options, word, nlgeom):
    result = solve(arched(LIFT + RISE/25.0 - 0.0028, word, nlgeom=nlgeom, **options))
    assert np.abs(result.contact(0).last.pressure).max() < 1e-9


def test_a_path_that_is_given_is_kept_and_told(solve):
    result = solve(arched(LIFT + RISE/25.0 - 0.0028, path="CONDENSED"))
    assert any("W0342" in w for w in result.warnings)


@pytest.mark.parametrize("nlgeom", [False, True])
def test_bodies_that_touch_press(solve, nlgeom):
    result = solve(arched(LIFT + RISE/25.0 + 0.05, nlgeom=nlgeom))
    assert result.contact(0).last.pressure.max() > 1.0


@pytest.mark.parametrize("word", ["CPE4", "C3D8"])
def test_gaps_from_a_flat_master_are_those_of_the_nodes(solve, word):
    """However the slave turns away: linear gaps are their own means, none is another node's."""
    lines = Lines()
    lines.add("*MATERIAL, NAME=M", "*ELASTIC", "1000., 0.3")
    space = word.startswith("C3D")
    up, wide = (3, (1,)) if space else (2, ())

    def rocker(x):
        y, u = np.array(x, dtype=float), x[:, 0]
        y[:, 0] = 2.0*u
        y[:, -1] = x[:, -1] + (1.0 - x[:, -1])*0.6*u**3
        return y

    lines.mesh(block((1.0, *wide, 1.0), (8, *wide, 3)).mapped(rocker), word, "B")
    lines.mesh(block((5.0, *wide, 1.0), (7, *wide, 1), origin=(-1.0, *(0.0 for _ in wide), -1.0)),
               word, "T")
    for name in "BT":
        lines.add(f"*SOLID SECTION, ELSET={name}E, MATERIAL=M", "1.,")
    slope = 2000.0
    lines.add("*SURFACE INTERACTION, NAME=C", "*SURFACE BEHAVIOR, PERTURBED LAGRANGE", f"{slope},",
              "*CONTACT PAIR, INTERACTION=C, TYPE=SURFACE TO SURFACE", "BSBOTTOM, TSTOP",
              "*BOUNDARY", f"TN, 1, {up}", "BTOP, 1", *(("BN, 2",) if space else ()),
              "*STEP, NLGEOM", "*STATIC", "0.25, 1.", "*BOUNDARY", f"BTOP, {up}, {up}, -0.5",
              "*NODE FILE", "U", "*CONTACT FILE", "CDIS, CSTR", "*END STEP")
    deck = Deck.parse("\n".join(lines.text) + "\n", name="rocker")
    last = solve(deck).contact(0).last
    depth = -last.place[:, -1]
    closed = last.pressure > 0.0
    assert closed.sum() >= 6
    assert np.allclose(last.pressure[closed], slope*depth[closed], rtol=1e-6)


def rings(sense, clearance, nlgeom=False):
    """Rings of 40 matching chords, one pressed into the other and turned until it slips."""
    lines = Lines()
    lines.add("*MATERIAL, NAME=M", "*ELASTIC", "2.1e5, .3")
    for name, radii in (("I", (10.0, 20.0)), ("O", (20.0, 30.0))):
        lines.mesh(ring(*radii, (3, 40), angles=(0.0, 360.0)), "CPE4", name)
        lines.add(f"*SOLID SECTION, ELSET={name}E, MATERIAL=M", "1.,",
                  f"*TRANSFORM, NSET={name}N, TYPE=C", "0., 0., 0., 0., 0., 1.")
    step = f"*STEP, INC=200{', NLGEOM' if nlgeom else ''}"
    lines.add("*SURFACE INTERACTION, NAME=C", "*SURFACE BEHAVIOR, DIRECT", "*FRICTION", "0.05,",
              "*CONTACT PAIR, INTERACTION=C, TYPE=NODE TO SURFACE", "ISOUTER, OSINNER",
              f"*CLEARANCE, SLAVE=ISOUTER, MASTER=OSINNER, VALUE={clearance!r}",
              "*BOUNDARY", "IINNER, 2", "OOUTER, 2",
              step, "*STATIC", "1., 1.", "*END STEP", step, "*STATIC", "0.1, 1., 1e-6, 0.1",
              "*BOUNDARY", f"IINNER, 2, 2, {0.01*sense!r}", "*CONTACT FILE", "CDIS, CSTR",
              "*END STEP")
    return Deck.parse("\n".join(lines.text) + "\n", name="rings")


def test_chords_have_no_sense_of_turning(solve):
    shear = []
    for sense in (1.0, -1.0):
        result = solve(rings(sense, -0.01))
        assert not any("W0341" in w for w in result.warnings)
        last = result.contact(0).last
        shear.append(last.pressure)
        assert np.ptp(last.pressure) < 1e-3*last.pressure.max()
    assert np.allclose(*shear, rtol=1e-3)


def test_nodes_that_follow_chords_are_told(solve):
    result = solve(rings(1.0, -0.01, nlgeom=True))
    assert any("W0341" in w and "lean" in w for w in result.warnings)


def crowned(word, slave, master, across=(1, 1), nlgeom=True):
    """A crowned block of metal, the slave, pressed into one of metal by a tenth of its height; in
    space between planes of symmetry."""
    lines = Lines()
    lines.add("*MATERIAL, NAME=M", "*ELASTIC", "210e3, .3", "*PLASTIC", "300., 0.", "600., 1.")
    space = word.startswith("C3D")
    up, wide = (3, (1.0,)) if space else (2, ())

    def crown(x):
        y = np.array(x, dtype=float)
        y[:, -1] += (1.0 - x[:, -1])*(x[:, 0] - 1.0)**2/6.0
        return y

    lines.mesh(block((3.0, *wide, 1.0), (master, *across[1:][:space], 2),
                     origin=(-0.5, *(0.0 for _ in wide), -1.0)), word, "B")
    lines.mesh(block((2.0, *wide, 1.0), (slave, *across[:1][:space], 2)).mapped(crown), word, "T")
    for name in "BT":
        lines.add(f"*SOLID SECTION, ELSET={name}E, MATERIAL=M", "1.,")
    lines.add("*SURFACE INTERACTION, NAME=C",
              "*CONTACT PAIR, INTERACTION=C, TYPE=SURFACE TO SURFACE", "TSBOTTOM, BSTOP",
              "*BOUNDARY", f"BBOTTOM, 1, {up}", "TTOP, 1", *(("BN, 2", "TN, 2") if space else ()),
              f"*STEP, INC=100{', NLGEOM' if nlgeom else ''}", "*STATIC",
              "*BOUNDARY", f"TTOP, {up}, {up}, -0.1", "*END STEP")
    return Deck.parse("\n".join(lines.text) + "\n", name="crowned")


@pytest.mark.parametrize("nlgeom", [False, True])
@pytest.mark.parametrize("slave, master", [(4, 12), (6, 12), (5, 9)])
def test_metal_that_is_dented_is_pressed_on(solve, slave, master, nlgeom):
    """Forces act by means over facets. Where a dent makes the least gap fall as a node is pressed,
    a row that held to that gap had no answer (E0510); the force does not hang on the width, nor on
    cells across."""
    forces = []
    for word, across in [("CPE4", ()), ("C3D8", (1, 1)), ("C3D8", (1, 3)), ("C3D8", (2, 1)),
                         *([("C3D8", (3, 2))] if slave == 4 else [])]:
        result = solve(crowned(word, slave, master, across, nlgeom))
        assert result.verdict in ("PASS", "WARN") and result.summary["steps"][0]["increments"] < 40
        forces.append(np.asarray(result.history["TSBOTTOM-BSTOP.force2" if word == "CPE4" else
                                                "TSBOTTOM-BSTOP.force3"])[-1])
    assert np.abs(forces) == pytest.approx(abs(forces[0]), rel=0.01)
