"""SMOOTH=YES opposite a profile: facets of the slave that stand for a curve."""
import functools
import re
from unittest.mock import patch

import numpy as np
import pytest

import lopin
from lopin.atlas import forming_scenes
from lopin.atlas.forming_scenes import flanged, strip
from lopin.atlas.scenes import PLAIN, Frame
from lopin.run import run


def smooth(deck):
    """The deck with SMOOTH=YES on its pairs."""
    text, pairs = re.subn(r"(?im)^\*CONTACT PAIR,", "*CONTACT PAIR, SMOOTH=YES,", deck.text())
    assert pairs
    return lopin.Deck.parse(text, deck.name)


def flange(word="CPE4I", thickness=1.0, times=1, mu=0.0, frame=PLAIN):
    """The flange of map 16 on so many times more facets, wiped down and not let go."""
    def finer(word, t, cells, *place):
        return strip(word, t, (times*cells[0], cells[1]), *place)
    with patch.object(forming_scenes, "strip", finer):
        text = flanged(word, thickness, mu, (0.02, 0.02), "lagrange", frame=frame)[0].deck().text()
    return lopin.Deck.parse(text[:text.rindex("*STEP")], "flanged")


@functools.cache
def smoothed():
    """The flange without friction, in millimetres, run once."""
    return run(smooth(flange()))


def force_over_way(result):
    """The force of the punch at even steps of its way down."""
    history = result.history
    down = np.asarray(history["step"]) == 1
    force, way = (np.abs(np.asarray(history[name])[down]) for name in ("PUNCH.rf2", "PUNCH.u2"))
    return np.interp(np.linspace(0.125, 1.0, 200)*way[-1], way, force)


def test_the_force_of_a_flange_waves_less_and_is_nearer_to_that_on_short_facets():
    """Facets of a fifth of the radius, beside a third as long ones: .067 and .034 of the largest
    force in the mean square, .26 and .11 at most."""
    flat, curved = map(force_over_way, (run(flange()), smoothed()))
    right = force_over_way(run(flange(times=2)))
    off = [np.abs(force - right)/right.max() for force in (flat, curved)]
    assert np.sqrt((off[1]**2).mean()) < 0.6*np.sqrt((off[0]**2).mean())
    assert off[1].max() < 0.5*off[0].max()


@pytest.mark.parametrize("mu", [0.0, 0.1])
def test_it_does_not_hang_on_the_system_of_the_deck(mu):
    """Turned by 130 degrees, in inches and psi: forces as far as the way is alike."""
    here = run(smooth(flange(mu=mu))) if mu else smoothed()
    there = run(smooth(flange(mu=mu, frame=Frame(130.0, 1.0/25.4, 145.04))))
    force = [np.hypot(*(np.asarray(result.history[name]) for name in ("PUNCH.rf1", "PUNCH.rf2"))) for result in (here, there)]
    assert len(force[0]) == len(force[1])
    assert force[1]/force[1].max() == pytest.approx(force[0]/force[0].max(), abs=1e-5)


@pytest.mark.parametrize("change, said", [
    (lambda deck: deck, None),
    (lambda deck: lopin.Deck.parse(deck.text().replace(", NLGEOM", ""), "linear"), "present shape"),
    (lambda deck: flange("CPE8R"), "has none"),
    (lambda deck: flange("C3D8I"), "its own shape")])
def test_where_it_does_nothing_it_says_so(change, said):
    messages = " ".join(d["message"] for d in lopin.check(smooth(change(flange()))) if "SMOOTH" in d["message"])
    assert said in messages if said else not messages
