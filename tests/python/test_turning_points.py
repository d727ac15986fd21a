"""Increments end at the points of amplitudes: friction and flow remember the way."""
import numpy as np
import pytest
from pressed_block import block, step

import lopin

SAW = [(0.0, 0.0), (0.1, 1.0), (0.3, -1.0), (0.5, 1.0), (0.7, -1.0), (0.9, 1.0), (1.0, 0.0)]


def amplitude(points, start=0.0, words=""):
    return f"*AMPLITUDE, NAME=SAW{words}\n" + "\n".join(f"{start + t!r}, {v!r}" for t, v in points)


def cycle(static="1., 1.", words="", direct=False, total=False, mu=0.3, span=0.2):
    """Pressed in a first step, moved to and fro in the second."""
    return block(step("*BOUNDARY\n9001, 1, 1, 0.\n9001, 2, 2, -0.1", words=words)
                 + step(f"*BOUNDARY, AMPLITUDE=SAW\n9001, 1, 1, {span!r}", static, words, direct),
                 mu=mu, before=amplitude(SAW, 1.0, ", TIME=TOTAL TIME") if total
                 else amplitude(SAW))


@pytest.fixture(scope="module")
def fine(executable, tmp_path_factory):
    """Shear, pressure and work of friction in fine increments, by the words of the steps."""
    found = {}
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("LOPIN_EXECUTABLE", str(executable))
        for words in ("", ", NLGEOM"):
            history = lopin.run(cycle("0.0025, 1.", words, direct=True),
                                tmp_path_factory.mktemp("fine"), executable=True).history
            found[words] = [history[name][-1] for name in ("TOOL.rf1", "TOOL.rf2",
                                                           "energy.friction")]
    return found


@pytest.mark.parametrize("words", ["", ", NLGEOM"], ids=["linear", "finite"])
@pytest.mark.parametrize("form", ["one", "default", "direct", "total time"])
def test_friction_after_the_last_turn(solve, fine, words, form):
    """The tool goes farther than the block is sheared after the last turn: T = mu N backwards,
    and the work of friction is that of fine increments."""
    force, pressure, work = fine[words]
    assert force == pytest.approx(-0.3*abs(pressure), rel=1e-9)
    run = solve(cycle({"default": "0.05, 1.", "direct": "0.4, 1."}.get(form, "1., 1."), words,
                      form == "direct", form == "total time"))
    assert run.history["TOOL.rf1"][-1] == pytest.approx(force, rel=1e-6)
    assert run.history["energy.friction"][-1] == pytest.approx(work, rel=0.06)
    turns = {round(1.0 + t, 9) for t, v in SAW}
    assert turns <= {round(float(t), 9) for t in run.times} | {1.0}
    said = [d for d in run.diagnostics if d["code"] == "N0550"]
    assert bool(said) == (form == "direct")
    if form == "direct":
        assert {1.4, 1.8} <= {round(float(t), 9) for t in run.times}


def test_the_end_of_a_step_is_no_point_of_an_amplitude(solve):
    """DIRECT, and a last increment that the step cuts."""
    run = solve(block(step("*BOUNDARY\n9001, 1, 1, 0.\n9001, 2, 2, -0.1", "0.3, 1.", direct=True), mu=0.3))
    assert list(run.times) == pytest.approx([0.3, 0.6, 0.9, 1.0])
    assert not [d for d in run.diagnostics if d["code"] == "N0550"]


def test_a_linear_scene_without_history_takes_its_own_increments(solve):
    run = solve(cycle(mu=0.0))
    assert list(run.times) == pytest.approx([1.0, 2.0])


def test_what_never_opens_remembers(solve):
    """NO SEPARATION: a tool that came near and left pulls the block along."""
    deck = block(step("*BOUNDARY, AMPLITUDE=SAW\n9001, 2, 2, -0.1\n*BOUNDARY\n9001, 1, 1, 0."),
                 behaviour="*SURFACE BEHAVIOR, NO SEPARATION", mu=0.0,
                 before="*AMPLITUDE, NAME=SAW\n0., 0., 0.5, 1., 1., -1.")
    assert solve(deck).history["TOOL.rf2"][-1] == pytest.approx(100.0, rel=1e-6)


@pytest.mark.parametrize("words", ["", ", NLGEOM"], ids=["linear", "finite"])
def test_pressure_that_dips_inside_an_increment(solve, words):
    """A dip to a tenth leaves mu N of the dip, which the return of the pressure hardly raises; a
    hundred increments say by how much."""
    def force(static):
        return abs(solve(lopin.Deck.parse(dip(static, words), "dip")).history["TOOL.rf1"][-1])

    few = force("1., 1.")
    assert few == pytest.approx(force("0.02, 1., 1e-3, 0.02"), rel=0.03)
    assert 3.0 <= few < 3.6


def dip(static, words):
    """The block on a tool; its top is pressed, then moved to the side, then held while the pressure
    dips."""
    cards = ("*DSLOAD, AMPLITUDE=SAW\nLID, P, 10.\n*BOUNDARY\nTOP, 1, 1, 0.",
             "*BOUNDARY\nTOP, 1, 1, 0.05", "*BOUNDARY\nTOP, 1, 1, 0.05")
    lid = "\n".join(f"{31 + i}, S3" for i in range(6))
    text = block("".join(step(c, static, words) for c in cards), cells=(6, 6), held="9001, 1, 2",
                 tool="START, -{b}, 0.\nLINE, {b}, 0.",
                 before="*AMPLITUDE, NAME=SAW, TIME=TOTAL TIME\n0., 0., 1., 1., 2., 1.\n"
                 "2.5, 0.1, 3., 1.\n*SURFACE, NAME=LID\n" + lid).text()
    return text.replace("*SURFACE, NAME=FACE\n" + lid, "*SURFACE, NAME=FACE\n"
                        + "\n".join(f"{1 + i}, S1" for i in range(6)))


def test_increments_at_points_are_not_those_that_inc_counts(solve):
    points = "*AMPLITUDE, NAME=SAW\n" + "\n".join(f"{t:.6f}, {np.sin(9*t):.6f}"
                                                  for t in np.linspace(0.0, 1.0, 41))
    deck = block(step("*BOUNDARY\n9001, 1, 1, 0.\n9001, 2, 2, -0.1")
                 + step("*BOUNDARY, AMPLITUDE=SAW\n9001, 1, 1, 0.2").replace("INC=1000", "INC=3"),
                 before=points)
    assert len(solve(deck).times) == 41


@pytest.mark.parametrize("direct", [False, True])
def test_heat_that_comes_and_goes_in_one_increment(solve, direct):
    """Held in its plane, heated by 500 and cooled: the residual stress of the cycle, by hand."""
    deck = block(step("*TEMPERATURE, AMPLITUDE=SAW\nALL, 500.\n*EL PRINT, ELSET=BLOCK\nS",
                      direct=direct), cells=(1, 1), gap=5.0,
                 held="LEFT, 1\nBOTTOM, 2\nRIGHT, 1\n9001, 1, 2",
                 material="*ELASTIC\n200000., 0.3\n*PLASTIC\n200., 0.\n400., 1.\n*EXPANSION\n1.2E-5",
                 before="*AMPLITUDE, NAME=SAW\n0., 0., 0.5, 1., 1., 0.")
    run = solve(deck)
    assert run.times[-1] == 1.0 and 0.5 in run.times and len(run.times) <= 3
    stress = np.asarray(run["S"])[:4, 0]
    assert stress == pytest.approx(np.full(stress.shape, 203.9485), rel=1e-2)
