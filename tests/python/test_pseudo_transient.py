"""Paths of equilibria that turn back: slow motion ends in the next equilibrium, says so, and finds
none where there is none."""
import numpy as np
import pytest

pytest.importorskip("lopin._core")

import lopin  # noqa: E402  (needs the compiled part)
from lopin.errors import NotConvergedError  # noqa: E402

CELLS, RISE, HALF, THICK = 30, 3.0, 10.0, 0.2


def arch(last: str, units: float = 1.0) -> lopin.Deck:
    """Half of a shallow arch, clamped at its foot; `units`: of length, forces stay."""
    x = np.linspace(0.0, HALF, CELLS + 1)
    y = RISE*(1.0 - (x/HALF)**2)
    lower = np.arange(1, CELLS + 1)
    upper = lower + CELLS + 1
    nodes = [f"{k*(CELLS + 1) + i + 1}, {units*x[i]:.15g}, {units*(y[i] + (k - 0.5)*THICK):.15g}"
             for k in range(2) for i in range(CELLS + 1)]
    cells = [f"{i}, {i}, {i + 1}, {j + 1}, {j}" for i, j in zip(lower, upper)]
    return lopin.Deck.parse("\n".join([
        "*NODE", *nodes, "*ELEMENT, TYPE=CPS4I, ELSET=ARCH", *cells,
        "*NSET, NSET=CROWN", f"1, {CELLS + 2}", "*NSET, NSET=FOOT", f"{CELLS + 1}, {2*CELLS + 2}",
        "*MATERIAL, NAME=M", "*ELASTIC", f"{1000.0/units**2:.15g}, 0.3",
        "*SOLID SECTION, ELSET=ARCH, MATERIAL=M", f"{units:.15g}",
        "*BOUNDARY", "CROWN, 1", "FOOT, 1, 2", "*STEP, NLGEOM, INC=500", "*STATIC", last,
        "*NODE FILE", "U, RF", "*END STEP"]) + "\n", "arch")


LOADED = "0.05, 1., 1e-5, 0.1\n*CLOAD\n1, 2, -0.1"


@pytest.fixture(scope="module")
def snapped():
    return lopin.run(arch(LOADED))


def test_an_arch_snaps_through(snapped):
    """Under its load the arch stands on the other side, as one that was pushed there does."""
    crown = snapped.at(-1)["U"][0, 1]
    assert -2.2*RISE < crown < -1.5*RISE
    pushed = lopin.run(arch(f"0.05, 1., 1e-6, 0.05\n*BOUNDARY\n1, 2, 2, {crown:.15g}"))
    force = -pushed.at(-1)["RF"][0, 1]
    assert force == pytest.approx(0.1, rel=1e-5)


def test_the_energy_of_the_jump_is_said(snapped):
    """Work that is neither stored nor dissipated: between two equilibria under a load that is all but
    the same it is the load's work less what the arch takes up."""
    assert any(w.startswith("W0517") for w in snapped.warnings)
    history = snapped.history
    lost = history["energy.external"][-1] - history["energy.strain"][-1]
    assert lost > 0.1*history["energy.external"][-1]


def test_a_jump_has_no_units(snapped):
    other = lopin.run(arch(LOADED, units=1e-3))
    assert other.at(-1)["U"][0, 1] == pytest.approx(1e-3*snapped.at(-1)["U"][0, 1], rel=1e-6)
    assert len(other.times) == len(snapped.times)


def test_no_motion_rests_beyond_a_limit_load():
    """A bar of a metal that does not harden, pulled by more than it can bear: no equilibrium."""
    deck = "\n".join([
        "*NODE", "1, 0., 0.", "2, 1., 0.", "3, 1., 1.", "4, 0., 1.",
        "*ELEMENT, TYPE=CPS4, ELSET=BAR", "1, 1, 2, 3, 4",
        "*MATERIAL, NAME=M", "*ELASTIC", "1000., 0.3", "*PLASTIC", "1., 0.",
        "*SOLID SECTION, ELSET=BAR, MATERIAL=M", "1.", "*BOUNDARY", "1, 1, 2", "4, 1",
        "*STEP, NLGEOM", "*STATIC", "0.1, 1.", "*CLOAD", "2, 1, 0.6", "3, 1, 0.6", "*END STEP"])
    with pytest.raises(NotConvergedError):
        lopin.run(lopin.Deck.parse(deck + "\n", "bar"))


FLOOR = """*NODE, NSET=STAND
900, 0., -2.5
*BOUNDARY
STAND, 1, 6
*SURFACE, NAME=UNDER, TYPE=ELEMENT
ARCH, S1
*SURFACE, NAME=FLOOR, TYPE=SEGMENTS
START, -12., -2.5
LINE, 12., -2.5
*RIGID BODY, ANALYTICAL SURFACE=FLOOR, REF NODE=900
*SURFACE INTERACTION, NAME=C
*SURFACE BEHAVIOR, AUGMENTED LAGRANGE
1.
*CONTACT PAIR, INTERACTION=C
UNDER, FLOOR
"""


def test_a_jump_onto_a_floor_is_augmented():
    """The equilibrium that slow motion finds is augmented like any other: a slope that alone would
    let the arch in by .08 leaves nothing in the increment of the jump."""
    text = arch(LOADED).text().replace("*STEP,", FLOOR + "*STEP,")
    history = lopin.run(lopin.Deck.parse(text, "floor")).history
    assert history["UNDER-FLOOR.force2"][-1] > 0.05
    assert np.max(history["UNDER-FLOOR.max_penetration"]) < 1e-6
