"""A sheet pressed home between a punch and its die: what the force rises by while the tool moves by
the sag of the facets on the radius is told."""
import re
from math import cos, radians, sin

import numpy as np
import pytest

from lopin.atlas.forming_scenes import billet, strip
from lopin.atlas.metal import Metal
from lopin.atlas.scenes import PLAIN, Frame
from lopin.run import run


def pressed_home(word, radius, cells, frame=PLAIN):
    """Half a sheet of 1 mm bent into a V of 90 degrees until its walls are a thickness apart."""
    scene = Metal("pressed_home", word, frame)
    solid = scene.ndim == 3
    mesh = strip(word, 1.0, (cells, 2), 20.0)
    supports = {"LEFT": [1]} | ({"FRONT": [2], "BACK": [2]} if solid else {})
    scene.body(mesh.replaced(surfaces={k: mesh.surfaces[k] for k in ("TOP", "BOTTOM")},
                             point_sets={k: mesh.point_sets[k] for k in supports}), supports)
    scene.metal(*scene.linear(600.0, 600.0))
    scene.interaction("lagrange", ["*FRICTION", "0.1,"])
    s, c = sin(radians(45.0)), cos(radians(45.0))
    x, y = radius*s, 1.0 + radius*(1.0 - c)
    scene.tool("PUNCH", "TOP", [(x + 30.0*c, y + 30.0*s), (x, y), (-x, y, 0.0, 1.0 + radius),
                                (-x - 9.0*c, y + 9.0*s)], (0.0, 11.0))
    # The lowest point of the die, its wall, and the rim (radius 2) level with the sheet.
    outer = radius + 1.0
    x, y, end = outer*s, outer*(1.0 - c), 13.3
    low = -(y + end - x + 2.0*(1.0 - c))
    scene.tool("DIE", "BOTTOM", [
        (-x - 5.0*c, low + y + 5.0*s), (-x, low + y), (x, low + y, 0.0, low + outer),
        (end, low + y + end - x), (end + 2.0*s, 0.0, end + 2.0*s, -2.0), (60.0, 0.0)], (20.0, low))
    scene.held += [f"DIEP, 1, {scene.ndim}", f"PUNCHP, 1, {scene.ndim - 1}"]
    scene.ready()
    scene.step({"PUNCH": (0.0, 0.0, low) if solid else (0.0, low)}, ())
    return scene.deck()


def rise(deck):
    """Code and figure [%] of the rise that is told, and the force at the end."""
    result = run(deck)
    found = re.compile(r"the force rises by ([\d.]+) %")
    said = [(d["code"], float(found.search(d["message"]).group(1)))
            for d in result.diagnostics if str(d["code"]).endswith("0562")]
    history = result.history
    name = next(k for k in ("PUNCH.rf3", "PUNCH.rf2", "DIE.rf2") if np.any(history.get(k, 0.0)))
    return (said or [(None, 0.0)])[0], abs(history[name][-1])


@pytest.mark.parametrize("word, cells", [("CPE4I", (14, 20)), ("CPE8R", (10, 20))])
def test_the_rise_tells_what_facets_make_of_a_force(word, cells):
    """Facets of a third to two thirds of the radius beside short ones."""
    (_, fine), right = rise(pressed_home(word, 3.0, {"CPE4I": 42, "CPE8R": 28}[word]))
    told = [rise(pressed_home(word, 3.0, n)) for n in cells]
    assert all(code == "W0562" for (code, _), _ in told)
    for (_, coarse), force in told:
        assert 0.01*coarse == pytest.approx(1.0 - right/force, rel=0.6)
    assert fine < told[-1][0][1]


def test_it_does_not_hang_on_the_system_of_the_deck():
    """Turned, in inches and psi."""
    here, there = (rise(pressed_home("CPE4I", 5.0, 20, frame))[0]
                   for frame in (PLAIN, Frame(40.0, 1.0/25.4, 145.04)))
    assert here[0] == there[0] == "W0562" and here[1] == pytest.approx(there[1], rel=0.2)


def test_a_strip_in_space_is_told_as_in_the_plane():
    """One row of bricks between planes of symmetry."""
    plane, space = (rise(pressed_home(word, 3.0, 14))[0] for word in ("CPE4", "C3D8"))
    assert plane[0] == space[0] == "W0562" and plane[1] == pytest.approx(space[1], rel=0.3)


def test_flat_tools_have_no_sag():
    """However steeply the force rises."""
    (code, _), _ = rise(billet("CPE4", [], share=0.01)[0].deck())
    assert code is None
