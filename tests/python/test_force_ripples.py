"""Forces that rise and fall as facets come to press one by one are told, with a figure."""
import re
from math import cos, radians, sin, tan

import numpy as np
import pytest

from lopin import Deck
from lopin.atlas import forming_scenes
from lopin.atlas.forming_scenes import air_bend, flanged, strip
from lopin.atlas.metal import Metal
from lopin.atlas.scenes import PLAIN, Frame
from lopin.mesh_make import block
from lopin.run import run


def waves(build, *args, released=False, **more):
    """Code, height [%] and length [facets] of the waves that are told on the way down; the
    result."""
    deck = build(*args, "lagrange", **more)[0].deck()
    if not released:
        text = deck.text()
        deck = Deck.parse(text[:text.rindex("*STEP")], deck.name)
    result = run(deck)
    found = re.compile(r"falls and rises by ([\d.]+) %.*, ([\d.]+) of a facet")
    said = [(d["code"], *map(float, found.search(d["message"]).groups()))
            for d in result.diagnostics if str(d["code"]).endswith("0561")]
    return said, result


@pytest.fixture
def finer(monkeypatch):
    """Strips with so many times more facets."""
    def refine(times):
        monkeypatch.setattr(forming_scenes, "strip", lambda word, t, cells, *place: strip(
            word, t, (times*cells[0], cells[1]), *place))
    return refine


@pytest.mark.parametrize("word, thickness, least, times", [("CPE8R", 1.0, 0.07, 2),
                                                           ("CPE4I", 1.0, 0.15, 3)])
def test_facets_that_leave_a_radius_one_by_one_are_told(word, thickness, least, times, finer):
    """A flange over a radius of five facets, and of ten or fifteen: the waves get lower."""
    (code, coarse, span), = waves(flanged, word, thickness, 0.0, (0.02, 0.02))[0]
    assert code == "W0561" and coarse > 100.0*least and 0.3 < span < 3.0
    finer(times)
    said, _ = waves(flanged, word, thickness, 0.0, (0.02, 0.02))
    assert not said or said[0][1] < 0.5*coarse


def test_what_is_told_does_not_hang_on_the_system_of_the_deck():
    """Turned by 130 degrees, in inches and psi."""
    frame = Frame(130.0, 1.0/25.4, 145.04)
    here, there = (waves(flanged, "CPE4I", 1.0, 0.1, (0.02, 0.02), frame=f)[0]
                   for f in (PLAIN, frame))
    assert [(code, fall) for code, fall, _ in here] == [(code, fall) for code, fall, _ in there]


def test_the_figure_is_the_highest_wave_of_the_history():
    """Counted again from the table of the run by the rule of four points (Amzallag et al. 1994)."""
    ((_, height, _),), result = waves(flanged, "CPE8R", 0.25, 0.0, (0.02, 0.02))
    history = result.history
    step = np.asarray(history["step"]) == 1
    force, way = (np.abs(np.asarray(history[name])[step]) for name in ("PUNCH.rf2", "PUNCH.u2"))
    left = [0, *(i for i in range(1, len(force) - 1)
                 if (force[i] - force[i - 1])*(force[i + 1] - force[i]) < 0.0), len(force) - 1]
    found, i = 0.0, 0
    while i + 3 < len(left):
        ranges = np.abs(np.diff(force[left[i:i + 4]]))
        if ranges[1] > min(ranges[0], ranges[2]):
            i += 1
            continue
        first, second = left[i + 1:i + 3]
        beyond = (force - force[first])*np.sign(force[first] - force[second]) >= 0.0
        back = second + beyond[second:].argmax()
        if way[back] - way[first] <= 3.0:
            found = max(found, ranges[1])
        del left[i + 1:i + 3]
        i = 0
    assert 100.0*found/force.max() == pytest.approx(height, rel=0.05)


@pytest.mark.parametrize("build, args", [(air_bend, ("CPE8R", 0.5, 0.0, (0.02, 0.02)))])
def test_a_force_that_rises_all_the_way_is_not_doubted(build, args):
    """A bend in air."""
    assert not waves(build, *args, released=True)[0]


def drawn(word, who, frame=PLAIN):
    """Half a strip, or a wire, drawn by 3 through a die of 10 degrees: `who` moves."""
    a, high, low = radians(10.0), 2.0, 1.7
    mesh = block((1.0, 10.0), (2, 24), origin=(0.0, -7.0)).mapped(lambda x: np.column_stack(
        [x[:, 0]*np.clip(low - np.minimum(x[:, 1], 0.0)*tan(a), low, high), x[:, 1]]))
    scene = Metal("drawn", word, frame)
    ends = {"LEFT": [1]} | ({"TOP": [2]} if who == "die" else {})
    scene.body(mesh.replaced(surfaces={"RIGHT": mesh.surfaces["RIGHT"]},
                             point_sets={k: mesh.point_sets[k] for k in ("LEFT", "TOP")}), ends)
    scene.metal(*scene.linear(250.0, 0.0))
    scene.interaction("lagrange", ["*FRICTION", "0.05,"])
    radius, foot = 2.0, 2.0*tan(0.5*a)
    x, y = low + radius*(1.0 - cos(a)), foot - radius*sin(a)
    scene.tool("DIE", "RIGHT", [(x + 8.0*sin(a), y - 8.0*cos(a)), (x, y),
                                (low, foot, low + radius, foot), (low, 1.5), (low + 1.0, 2.5)],
               (4.0, 0.0))
    scene.held.append("DIEP, 1")
    scene.ready()
    pull = ["*BOUNDARY", f"TOP, 2, 2, {3.0*frame.length!r}"] if who == "strip" else []
    scene.step({"DIE": (0.0, -3.0 if who == "die" else 0.0)}, (0.01, 0.02), pull)
    return scene.deck()


@pytest.mark.parametrize("word", ["CPE4", "CAX4"])
def test_a_die_that_stands_is_told_of_as_one_that_moves(word):
    """The strip is pulled through it: forces are the same, and so is what is told."""
    found = re.compile(r"falls and rises by ([\d.]+) %.*, ([\d.]+) of a facet")
    told = [[(d["code"], *map(float, found.search(d["message"]).groups()))
             for d in run(drawn(word, who)).diagnostics if str(d["code"]).endswith("0561")]
            for who in ("die", "strip")]
    assert told[0][0][0] == told[1][0][0] == "W0561" and len(told[0]) == len(told[1]) == 1
    assert told[0][0][1:] == pytest.approx(told[1][0][1:], rel=0.1)
