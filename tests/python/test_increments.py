"""F17: how many increments an answer needs, and what is said where they are too few."""
import sys
from pathlib import Path

import numpy as np
import pytest
from upset_billet import billet

import lopin

sys.path.insert(0, str(Path(__file__).resolve().parents[2]/"decks"/"make"))
import sheets  # noqa: E402


def force(*arguments, **options) -> float:
    """Of the press at the end."""
    return -float(lopin.run(billet(*arguments, **options)).history["DIE.rf2"][-1])


def test_a_straight_path_needs_one_increment():
    """Without friction the strain is uniform and its path straight: any number of increments, one
    answer."""
    forces = [force(n) for n in (1, 2, 5, 20, 100)]
    assert forces == pytest.approx([forces[0]]*5, rel=1e-9)


def test_the_error_falls_with_the_increment_where_the_path_bends():
    """With friction: halving the increments halves what is missing."""
    coarse, middle, fine = (force(n, mu=0.1) for n in (20, 40, 80))
    assert (middle - coarse)/(fine - middle) == pytest.approx(2.0, rel=0.25)
    assert abs(fine - middle) < 0.01*fine


def test_increments_that_are_too_large_are_refused_or_cut():
    """One increment of 60 % with friction: DIRECT stops and says why, automatic increments go on to
    the end."""
    with pytest.raises(lopin.errors.NotConvergedError, match="E05"):
        lopin.run(billet(1, mu=0.1, share=0.6))
    result = lopin.run(billet(1, mu=0.1, share=0.5, direct=False))
    assert result.times[-1] == 1.0
    assert result.summary["certificate"]["verdict"] == "PASS"
    assert result.summary["steps"][0]["increments"] > 5


def test_the_history_shows_where_the_work_went():
    """Work is summed by trapezoids: what the first increment, from elastic to plastic, misses is of
    its own size."""
    result = lopin.run(billet(200, mu=0.1, direct=False))
    history = {name: float(result.history[name][-1]) for name in result.history}
    parts = sum(history["energy." + name] for name in ("strain", "contact", "friction_mean",
                                                       "plastic"))
    assert parts == pytest.approx(history["energy.external"], rel=2e-3)
    assert history["energy.plastic"] > 0.9*history["energy.external"]
    assert history["volume"] == pytest.approx(np.pi*100.0*15.0, rel=5e-3)
    assert result.summary["certificate"]["energy"] < 2e-3


def test_no_point_of_an_amplitude_is_jumped_over():
    """A saw tooth whose turn is shorter than an increment: the metal remembers it all the same."""
    saw = [(0.0, 0.0), (0.5, 0.1), (0.51, -0.1), (1.0, 0.1)]
    result = lopin.run(billet(10, direct=False, cells=(1, 1), through=saw))
    assert {0.5, 0.51} <= {round(float(t), 9) for t in result.times}


def test_work_that_is_lost_is_said_where_it_is_lost():
    """One increment of 20 % loses 41 % of its work; of fine steps after it nothing is said, of
    coarse ones again."""
    model = billet(1, share=0.2, cells=(1, 1))
    for size, way in ((0.1, -3.15), (0.1, -3.3), (1.0, -6.3)):
        model.step(nlgeom=True, first=size, fixed=True).move(model.tools[0], z=way)
    said = [d["message"] for d in lopin.run(model).diagnostics
            if d["code"] == "W0530"]
    assert [message.partition("in step ")[2][:1] for message in said] == ["1", "4"]
    assert all(message.endswith("in increment 1") for message in said)


def lifted(element: str, pressure: float, lift: float, longest: str = "") -> lopin.Result:
    """A sheet on a flat die is lifted by its middle while what presses it on fades: each section
    is bent most at a time of its own."""
    lines = sheets.sheet(element, [float(i) for i in range(41)], 1.0, 1)
    lines += sheets.material([(300.0, 0.0), (1300.0, 2.0)], 210e3)
    lines += sheets.tool("DIE", 90002, (0.0, 0.0), ["START, -5., 0.", "LINE, 90., 0."])
    lines += ["*SURFACE INTERACTION, NAME=OILED", "*CONTACT PAIR, INTERACTION=OILED", "BOTTOM, DIE",
              "*BOUNDARY", "MIDDLE, 1", "DIE_REF, 1, 2", "DIE_REF, 6", "*STEP, NLGEOM", "*STATIC",
              "*DSLOAD", f"TOP, P, {pressure}", "*END STEP", "*STEP, NLGEOM, INC=500",
              f"*STATIC\n{longest}".strip(), "*DSLOAD", "TOP, P, 0.01", "*BOUNDARY",
              f"MIDDLE, 2, 2, {lift}", "*END STEP", ""]
    return lopin.run(lopin.Deck.parse("\n".join(["*HEADING", "Lifted", *lines]), "lifted"))


@pytest.mark.parametrize("element, pressure, lift", [
    ("CPE4I", 5.0, 3.0), ("CAX4I", 5.0, 2.0)])
def test_metal_that_ceases_to_flow_is_followed(element, pressure, lift):
    """The plastic work by default increments beside increments of a fiftieth: points that unload
    within an increment missed 2 to 5 % of it."""
    works, numbers = [], []
    for longest in ("", ".02, 1., 1e-9, .02"):
        result = lifted(element, pressure, lift, longest)
        works.append(float(result.history["energy.plastic"][-1]))
        numbers.append(result.summary["steps"][1]["increments"])
    assert works[0] == pytest.approx(works[1], rel=0.0125)
    assert numbers[0] < 40 < numbers[1]
