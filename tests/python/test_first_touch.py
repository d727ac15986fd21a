"""A gap that closes and a shear in one increment: what is moved before the touch is no slip."""
import pytest
from pressed_block import block, step

ROUND = ("START, 11., {top}\nCIRCL, 5., {y}, 5., {top}\nCIRCL, -1., {top}, 5., {top}")


def force(solve, n, words="", mu=1.0, down=1.1, along=1.0, tool="flat", swap=False, word="CPE4",
          direct=False):
    """Shear that the tool gives the block (or the block, where it moves, the tool), and codes."""
    moved = (f"*BOUNDARY\n9001, 1, 1, {along!r}\n9001, 2, 2, {-down!r}" if not swap else
             f"*BOUNDARY\nBOTTOM, 1, 1, {-along!r}\nBOTTOM, 2, 2, {down!r}")
    deck = block(step(moved, f"{1/n!r}, 1., 1e-9, {1/n!r}", words, direct), gap=1.0, mu=mu, word=word,
                 cells=(4, 4) if tool == "flat" else (20, 8),
                 held="9001, 1, 2\nBOTTOM, 1, 2" if swap else "BOTTOM, 1, 2",
                 **({} if tool == "flat" else {"tool": ROUND.format(y=11.0, top=17.0)}))
    run = solve(deck)
    return run.history["TOOL.rf1"][-1], {d["code"] for d in run.diagnostics}


@pytest.mark.parametrize("words", ["", ", NLGEOM"], ids=["linear", "finite"])
@pytest.mark.parametrize("mu", [1.0, 0.3])
def test_under_a_flat_tool_any_number_of_increments_is_the_same(solve, words, mu):
    """Loading is proportional from the touch on: one answer, whichever of the two moves."""
    expected = {("", 1.0): 28.9732, ("", 0.3): 27.015, (", NLGEOM", 1.0): 29.0842,
                (", NLGEOM", 0.3): 27.2054}[words, mu]
    for n, swap in ((1, False), (7, False), (50, False), (1, True), (3, True)):
        assert force(solve, n, words, mu, swap=swap)[0] == pytest.approx(expected, rel=2e-5)


@pytest.mark.parametrize("words", ["", ", NLGEOM"], ids=["linear", "finite"])
@pytest.mark.parametrize("mu, down, along", [(1.0, 1.1, 1.0), (0.3, 1.1, 1.0), (0.5, 1.3, 0.3)])
def test_under_a_round_tool_the_increment_goes_by_parts(solve, words, mu, down, along):
    fine, _ = force(solve, 100, words, mu, down, along, "round")
    for n in (1, 2):
        assert force(solve, n, words, mu, down, along, "round")[0] == pytest.approx(fine, rel=0.02)


def test_fixed_increments_say_it(solve):
    fine, _ = force(solve, 100, ", NLGEOM", tool="round")
    coarse, codes = force(solve, 1, ", NLGEOM", tool="round", direct=True)
    assert "W0551" in codes
    assert coarse == pytest.approx(fine, rel=0.25)


def test_other_elements_and_the_other_side(solve):
    assert force(solve, 1, word="CPS4")[0] == pytest.approx(force(solve, 9, word="CPS4")[0],
                                                            rel=1e-6)
    assert force(solve, 1, along=-1.0)[0] == pytest.approx(-28.9732, rel=2e-5)
