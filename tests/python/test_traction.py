"""The line `traction` of the certificate: printed pressures carry the forces of contact.

The kernel that finds fields which do not is tried in tests/fortran/test_carried_force.f90.
"""
import numpy as np
import pytest

from lopin import mesh_make, profile
from lopin.atlas.blocks import Scene, pressed_deck
from lopin.atlas.faces import SLOW, WORDS
from lopin.deck import Deck
from lopin.laws import Elastic
from lopin.mesh import together
from lopin.model import Model

PRESSURE, SHEAR, YOUNG = 10.0, 0.5, 1e3
MASTERS = {"tool": ("", True), "surface": ("own", True), "nodes": ("own", False),
           "other": ("other", True)}


def line(result):
    """Of the worst increment, and of the worst over the run, a pair."""
    summary = result.summary
    assert summary["certificate"]["verdict"] == "PASS", summary["certificate"]["reason"]
    return max([summary["certificate"]["traction"], *(p["traction"] for p in summary["contact"])])


#: By NLGEOM, which takes the longest, each word on every second kind of master.
FACES = [(word, master, nlgeom) for k, word in enumerate(WORDS) for m, master in enumerate(MASTERS)
         for nlgeom in (False, True)
         if not nlgeom or (k + m) % 2 == 0 and not (word in SLOW and master != "tool")]


@pytest.mark.parametrize("word, master, nlgeom", FACES)
def test_every_face_passes_on_every_kind_of_master(solve, word, master, nlgeom):
    """Pressed and dragged; what is uneven at the nodes (W0333) carries its force all the same."""
    other, to_surface = MASTERS[master]
    scene = Scene(word, {"own": word, "other": WORDS[word]}.get(other, ""), (3, 4), to_surface,
                  nlgeom, margin=0.2 if other else 0.0)
    assert line(solve(pressed_deck(scene))) < (1e-2 if nlgeom else 1e-9)


def skin_on_plate(kind, path, nodes):
    """A block, all of its sides its skin, pressed on a plate, a tool."""
    space, round_ = kind.startswith("C3D"), kind.startswith("CAX")
    d = 3 if space else 2
    mesh = mesh_make.block((6.0,)*d, (3,)*d)
    if kind[3:] in ("3", "4") and kind not in ("CPE4", "CAX4"):
        mesh = mesh_make.simplices(mesh)
    if nodes == "second":
        mesh = mesh.quadratic()
    sides = [n for n in mesh.surfaces if n != "TOP" and not (round_ and n == "LEFT")]
    mesh = mesh.replaced(surfaces={**mesh.surfaces, "SKIN": np.concatenate(
        [mesh.surfaces[n] for n in sides])})
    model = Model("skin", mesh, kind="3d" if space else "axisymmetric" if round_ else
                  "plane strain")
    model.section("ALL", Elastic(YOUNG, 0.0))
    shape = profile.plane(0.0, 40.0, side="above")
    tool = model.rigid_tool("PLATE", shape.extruded(generator=(0.0, -1.0, 0.0)) if space else shape)
    model.contact("SKIN", tool)
    way = ("r", "z") if round_ else ("x", "y", "z")[:d]
    model.fix("TOP", *way[:-1])
    model.fix(tool, *way)
    model.step(nlgeom=path == "finite").pressure("TOP", PRESSURE)
    if not round_:
        model.step(nlgeom=path == "finite").move(tool, x=0.5)
    text = model.to_deck().text().replace("*CONTACT PAIR", f"*FRICTION, TAUMAX={SHEAR}\n1.,\n"
                                          "*CONTACT PAIR", 1)
    return Deck.parse(text, name="skin")


@pytest.mark.parametrize("path", ["condensed", "finite"])
@pytest.mark.parametrize("nodes", ["first", "second"])
@pytest.mark.parametrize("kind", ["CPE4", "CAX4", "C3D8", "C3D4"])
def test_the_rim_of_a_skin_has_the_pressure_of_the_face_that_is_pressed(solve, kind, nodes, path):
    """Not that of its side, too: half of the pressure, and twice the area of a friction limit."""
    result = solve(skin_on_plate(kind, path, nodes))
    first = result.contact(0).at(0)
    pressed = np.asarray(first.status) > 0
    assert np.asarray(first.pressure)[pressed] == pytest.approx(PRESSURE, rel=2e-9)
    # Drawn aside the block leans: second-order faces stand out between the corners.
    assert line(result) < (1e-9 if nodes == "first" else 2e-2)
    if not kind.startswith("CAX"):
        drag = abs(result.history["SKIN-PLATE.force1"][-1])
        assert drag == pytest.approx(SHEAR*(36.0 if kind.startswith("C3D") else 6.0), rel=1e-3)


def test_what_slides_off_prints_by_the_area_that_is_covered_now(solve):
    """Surface to surface under NLGEOM: the area of the start would halve the pressure at the edge."""
    block = mesh_make.block((4.0, 2.0), (4, 2))
    low = block.with_points("ALL", lambda p: np.full(len(p), True))
    model = Model("off", together(UP=block.moved(0.0, 2.0), LOW=low), kind="plane strain")
    model.section("UP", Elastic(YOUNG, 0.0))
    model.section("LOW", Elastic(YOUNG, 0.0))
    model.contact("UP.BOTTOM", "LOW.TOP", surface_to_surface=True)
    model.fix("UP.TOP", "x")
    model.fix("LOW.ALL", "y")
    model.step(nlgeom=True).move("UP.TOP", y=-0.02)
    model.step(4, nlgeom=True).move("LOW.ALL", x=1.3)
    result = solve(model.to_deck())
    area = next(v for k, v in result.history.items() if k.endswith(".area"))
    assert area[-1] == pytest.approx(2.7, rel=0.02)
    assert line(result) < 1e-6
