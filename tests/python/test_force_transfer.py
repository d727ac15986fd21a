"""Contact forces that pass from point to point within an increment: it is cut, or says so.

Increments of default settings are compared with those of a fiftieth of a step, on the same mesh and
tools. Before they were cut, the forces of these scenes were 6 to 16 % off, and a release in one
increment ended jammed or free as the angle of the scene had it.
"""
import re
import sys
from functools import lru_cache
from pathlib import Path

import pytest

import lopin
from lopin.atlas.formed import FINE, difference, formed
from lopin.atlas.forming_scenes import air_bend, indented, nested
from lopin.atlas.laws import LAWS
from lopin.atlas.scenes import PLAIN, Frame

sys.path.insert(0, str(Path(__file__).resolve().parents[2]/"decks"/"make"))
import sheets  # noqa: E402

pytestmark = pytest.mark.usefixtures("core")
TURNED = Frame(-160.3, 0.02, 3e4)


@lru_cache
def fine(build, *arguments, **words):
    """The reference of a scene."""
    scene, body, steps = build(*arguments, increments=FINE, **dict(words))
    return formed(scene, body, steps)


def beside_fine_increments(build, arguments, frame=PLAIN, released=False, **words):
    """A scene by default settings, and its error."""
    scene, body, steps = build(*arguments, frame=frame, **words)
    run = formed(scene, body, steps)
    right = fine(build, *arguments, **words)
    assert not (run.code or right.code)
    return run, difference(run, right, released)


@pytest.mark.parametrize("frame, build, facets, mu, method", [
    (PLAIN, indented, 0.25, 0.05, "lagrange"), (TURNED, indented, 0.25, 0.05, "lagrange"),
    (PLAIN, indented, 0.25, 0.0, "augmented"), (TURNED, indented, 0.25, 0.0, "penalty"),
    (PLAIN, nested, 0.25, 0.0, "penalty"), (PLAIN, nested, 1.0, 0.4, "lagrange"),
    (TURNED, nested, 1.0, 0.4, "lagrange"), (TURNED, nested, 0.7, 0.15, "perturbed")])
def test_metal_under_polygons_is_right_by_default_increments(frame, build, facets, mu, method):
    run, error = beside_fine_increments(build, (facets, mu, method), frame)
    assert error < 0.045 and run.verdict == "PASS" and run.increments < 60


@pytest.mark.parametrize("words", [
    {"friction": LAWS["Tresca"](0.05, PLAIN)},
    {"yielding": 2e3, "friction": LAWS["Coulomb"](0.17, PLAIN)}], ids=["Tresca", "Coulomb"])
def test_a_release_with_friction_ends_the_same_at_every_angle(words):
    """Jammed or free, and at the place where it was left: rounding does not choose."""
    runs = []
    for angle in (0.0, -160.3):
        scene, body, steps = air_bend("CPE8R", 1.0, 0.0, frame=Frame(angle, 1.0, 1.0), **words)
        runs.append(formed(scene, body, steps))
    for run in runs:
        assert not run.code and run.verdict == "PASS"
        assert ("W0518" in run.warned) == ("W0518" in runs[0].warned)
        assert difference(run, runs[0], True) < 0.03


def test_what_may_not_be_cut_warns():
    """DIRECT increments are taken as they are; small ones have nothing to say."""
    said = {}
    for share in (0.05, 0.02):
        scene, _, _ = indented(0.25, 0.0, "lagrange")
        first, _, last = scene.deck().text().rpartition("*STATIC\n")
        deck = lopin.Deck.parse(f"{first}*STATIC, DIRECT\n{share}, 1.\n{last}", "drawn")
        said[share] = [w for w in lopin.run(deck).warnings if w.startswith("W0555")]
    assert len(said[0.05]) == 1 and "contact force passes" in said[0.05][0]
    assert not said[0.02]


def test_a_jump_is_taken_and_increments_go_on_as_before():
    """A V by Tresca's friction springs off its punch at once, in any increment: 49 increments if
    nothing is cut. Searched for by cuts alone that place took 44 of 89."""
    deck = re.sub(r"(\*FRICTION)\n[^\n]*", r"\1, LAW=TRESCA\n0.2", sheets.v_bending())
    bend, release = lopin.run(lopin.Deck.parse(deck, "vee")).summary["steps"]
    assert bend["increments"] < 45 and release["increments"] < 25


def test_force_that_passes_by_elastic_metal_is_no_matter():
    """The legs of a V slide over the die where the sheet is elastic: 33 increments if nothing is
    cut, 40 by all of the force that passes."""
    deck = lopin.Deck.parse(sheets.v_bending(), "vee")
    assert lopin.run(deck).summary["steps"][0]["increments"] < 39


def test_metal_that_stays_elastic_keeps_its_increments():
    """Nothing remembers: points may close as they like."""
    scene, _, _ = nested(1.0, 0.0, "lagrange")
    text = scene.deck().text()
    at = text.index("*PLASTIC")
    elastic = text[:at] + text[text.index("*SOLID SECTION"):]
    assert lopin.run(lopin.Deck.parse(elastic, "elastic")).summary["steps"][0]["increments"] == 1
