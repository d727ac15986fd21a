"""A sheet pressed home between a punch and its die: what the force rises by while the tool moves by
the sag of the facets on the radius is told."""
import re
from math import cos, radians, sin

import numpy as np
import pytest

import lopin
from lopin.atlas.forming_scenes import billet, strip
from lopin.atlas.metal import Metal
from lopin.atlas.scenes import PLAIN, Frame
from lopin.mesh_make import block
from lopin.operation import next_operation
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
    name = next(k for k in ("PUNCH.rf3", "PUNCH.rf2", "DIE.rf2", "TOOL.rf2")
                if np.any(history.get(k, 0.0)))
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


def dented(ways, depth=0.0):
    """Half a block that a round tool, `depth` deep at first, presses by ways, one after another."""
    scene = Metal("dented", "CPE4")
    mesh = block((6.0, 6.0), (8, 8))
    scene.body(mesh.replaced(surfaces={"TOP": mesh.surfaces["TOP"]},
                             point_sets={k: mesh.point_sets[k] for k in ("LEFT", "BOTTOM")}),
               {"LEFT": [1], "BOTTOM": [2]})
    scene.metal(*scene.linear(300.0, 300.0))
    scene.interaction("lagrange", ["*FRICTION", "0.1,"])
    s, c, y = sin(radians(50.0)), cos(radians(50.0)), 11.0 - depth
    scene.tool("TOOL", "TOP", [(5.0*s + 4.0*c, y - 5.0*c + 4.0*s), (5.0*s, y - 5.0*c),
                               (-5.0*s, y - 5.0*c, 0.0, y)], (0.0, y + 1.0))
    scene.held.append("TOOLP, 1")
    scene.ready()
    for way in ways:
        scene.step({"TOOL": (0.0, way)}, (0.02, 0.05))
    return scene.deck()


def test_metal_that_is_pressed_again_has_the_imprint_of_the_facets():
    """Pressed by 1, lifted by 0.5 and pressed on: 95 % were told, of a single way 8."""
    (_, once), force = rise(dented([-1.2]))
    (_, again), end = rise(dented([-1.0, -0.5, -1.2]))
    assert end == pytest.approx(force, rel=0.01) and again < once + 1.0


def test_so_has_formed_metal_that_a_next_operation_begins_with():
    """96 % were told of its first increments."""
    (_, once), force = rise(dented([-1.2]))
    cards = dented([-0.2], depth=1.0).text()
    cards = cards[cards.index("*SURFACE INTERACTION"):]
    with lopin.open(dented([-1.0])) as job:
        for _ in job:
            second = next_operation(job, "METAL", cards, name="second")[0]
    (_, again), end = rise(second)
    assert end == pytest.approx(force, rel=0.01) and again < once + 1.0
