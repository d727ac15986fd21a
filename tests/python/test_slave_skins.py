"""Skins that go round edges, thin sheets whose whole skins meet, narrow punches, ties on curves."""
import re
import subprocess

import numpy as np
import pytest

from lopin import mesh_make
from lopin.deck import Deck
from lopin.laws import Elastic
from lopin.mesh import together
from lopin.model import Model
from lopin.run import find_executable

KINDS = ("CPE4", "CPE3", "CPE8", "CAX4", "CAX8", "C3D8", "C3D4", "C3D10", "C3D20")


def wrapped(kind, path, slave, unit=1.0, turn=0.0):
    """A block pressed by a wide stiff plate; `slave`: the pressed face alone, or the skin."""
    space, round_ = kind.startswith("C3D"), kind.startswith("CAX")
    d = 3 if space else 2
    cells = (3, 3, 3)[:d]
    low = mesh_make.block((10.0,)*d, cells)
    up = mesh_make.block((16.0, 16.0, 2.0)[-d:] if space else (16.0, 2.0), (4, 4, 1)[-d:])
    up = up.moved(*(0.0,)*(d - 1), 10.0)
    if kind in ("CPE3", "C3D4", "C3D10"):
        low, up = mesh_make.simplices(low), mesh_make.simplices(up)
    if kind[3:] in ("8", "10", "20") and kind != "C3D8":
        low, up = low.quadratic(), up.quadratic()
    up = up.with_points("ALL", lambda p: np.full(len(p), True))
    names = ["TOP", "RIGHT"] + (["BACK"] if space and "BACK" in low.surfaces else [])
    low = low.replaced(surfaces={**low.surfaces, "SKIN": np.concatenate(
        [low.surfaces[n] for n in (names if slave == "SKIN" else names[:1])])})
    both = together(LOW=low, UP=up)
    if turn:
        c, s = np.cos(turn), np.sin(turn)
        both = both.mapped(lambda x: np.column_stack(
            [c*x[:, 0] - s*x[:, 1], s*x[:, 0] + c*x[:, 1], *x.T[2:]]))
    model = Model("skin", both.mapped(lambda x: unit*x), kind="3d" if space else
                  "axisymmetric" if round_ else "plane strain")
    model.section("LOW", Elastic(1e3/unit, 0.0))
    model.section("UP", Elastic(1e6/unit, 0.0))
    model.contact("LOW.SKIN", "UP.BOTTOM", surface_to_surface=True)
    way = ("r", "z") if round_ else ("x", "y", "z")[:d]
    model.fix("LOW.BOTTOM", *way)
    if not turn:
        model.fix("UP.ALL", *way[:-1])
    if turn:
        model.step(nlgeom=path == "finite").move(
            "UP.ALL", x=float(unit*0.5*np.sin(turn)), y=float(-unit*0.5*np.cos(turn)))
    else:
        model.step(nlgeom=path == "finite").move("UP.ALL", **{way[-1]: -0.5*unit})
    return model.to_deck()


def forces(solve, deck, d=3):
    history = solve(deck).history
    name = next(k for k in history if k.endswith(".force1"))[:-1]
    return np.array([history[f"{name}{i + 1}"][-1] for i in range(d)
                     if f"{name}{i + 1}" in history])


@pytest.mark.parametrize("path", ["condensed", "finite"])
@pytest.mark.parametrize("kind", KINDS)
def test_a_wrapped_skin_gives_what_the_pressed_face_gives(solve, kind, path):
    alone = forces(solve, wrapped(kind, path, "TOP"))
    skin = forces(solve, wrapped(kind, path, "SKIN"))
    size = np.abs(alone).max()
    assert np.abs(skin[:-1]).max() < 1e-9*size
    assert skin[-1] == pytest.approx(alone[-1], rel=1e-9)


@pytest.mark.parametrize("path", ["condensed", "finite"])
@pytest.mark.parametrize("turn, unit", [(0.7, 1.0), (2.9, 1e-3), (0.0, 1e3)])
def test_a_wrapped_skin_turned_and_in_other_units(solve, path, turn, unit):
    force = forces(solve, wrapped("CPE4", path, "SKIN", unit, turn), 2)
    normal = np.array([np.sin(turn), -np.cos(turn)])
    across = np.array([np.cos(turn), np.sin(turn)])
    assert abs(force @ across) < 1e-9*abs(force @ normal)


def sheets(words, n=8, height=0.1):
    """Two sheets on each other, all their faces in contact."""
    low = mesh_make.block((10.0, height), (n, 1))
    up = mesh_make.block((10.0, height), (n, 1)).moved(0.0, height)
    def skin(mesh):
        return mesh.replaced(surfaces={**mesh.surfaces, "SKIN": np.concatenate(
            [mesh.surfaces[k] for k in ("TOP", "BOTTOM", "LEFT", "RIGHT")])})
    model = Model("sheets", together(UP=skin(up), LOW=skin(low)), kind="plane strain")
    for body in ("UP", "LOW"):
        model.section(body, Elastic(2e5, 0.0))
    model.contact("UP.SKIN", "LOW.SKIN", surface_to_surface="SURFACE" in words)
    model.fix("LOW.BOTTOM", "y")
    model.fix("LOW.LEFT", "x")
    model.fix("UP.LEFT", "x")
    model.step(nlgeom="NLGEOM" in words).pressure("UP.TOP", 100.0)
    return model.to_deck()


@pytest.mark.parametrize("words", ["NODE", "SURFACE", "NODE NLGEOM", "SURFACE NLGEOM"])
def test_sheets_whose_whole_skins_meet_rest_on_each_other(solve, words):
    force = forces(solve, sheets(words), 2)
    assert abs(force[1]) == pytest.approx(1000.0, rel=1e-3)
    energy = solve(sheets(words)).history["energy.strain"][-1]
    assert energy == pytest.approx(0.5*100.0**2/2e5*10.0*0.2, rel=5e-3)


def punch(at, half, slave_cells=12, path="condensed"):
    """A stiff punch on a block of longer facets."""
    low = mesh_make.block((40.0, 10.0), (slave_cells, 4), origin=(-20.0, 0.0))
    n = max(2, round(2*half/0.5))
    up = mesh_make.block((2*half, 6.0), (n, 4), origin=(at - half, 10.0))
    model = Model("punch", together(UP=up, LOW=low), kind="plane strain")
    model.section("LOW", Elastic(1e3, 0.3))
    model.section("UP", Elastic(1e6, 0.3))
    model.contact("LOW.TOP", "UP.BOTTOM", surface_to_surface=True)
    model.fix("LOW.BOTTOM", "x", "y")
    model.fix("UP.TOP", "x")
    model.step(nlgeom=path == "finite").move("UP.TOP", y=-0.1)
    return model.to_deck()


@pytest.mark.parametrize("path", ["condensed", "finite"])
def test_the_force_changes_little_while_a_punch_crosses_a_facet(solve, path):
    found = [abs(forces(solve, punch(at, 5.0, path=path), 2)[1])
             for at in np.arange(0.0, 3.4, 0.83)]
    assert max(found)/min(found) < 1.05


def said(deck, folder):
    path = folder/"deck.inp"
    deck.write(path)
    return subprocess.run([find_executable(), "check", path], capture_output=True, text=True,
                          check=False).stderr + subprocess.run(
        [find_executable(), "run", path, "-o", folder/"out", "--overwrite"], capture_output=True,
        text=True, check=False).stdout


@pytest.mark.parametrize("half, narrow", [(1.0, True), (5.0, False)])
def test_a_punch_narrower_than_a_facet_is_told(tmp_path, half, narrow):
    assert ("W0336" in said(punch(0.4, half), tmp_path)) == narrow


def curved_tie(angle, folder):
    """Two half rings glued at the nodes along a curve of other facets, turned as a whole."""
    inner = mesh_make.ring(10.0, 15.0, (2, 12), angles=(0.0, 180.0))
    outer = mesh_make.ring(15.0, 20.0, (2, 17), angles=(0.0, 180.0))
    model = Model("tie", together(IN=inner, OUT=outer), kind="plane strain")
    for body in ("IN", "OUT"):
        model.section(body, Elastic(1e5, 0.3))
    model.contact("IN.OUTER", "OUT.INNER", surface_to_surface=False, tied=True)
    model.step(nlgeom=True).move("IN.INNER", x=0.0, y=0.0)
    path = folder/"tie.inp"
    model.to_deck().write(path)
    c, s = np.cos(angle), np.sin(angle)
    lines = []
    for node in inner.point_sets["INNER"]:
        p = inner.points[node]
        for k, u in enumerate(np.array([[c, -s], [s, c]]) @ p - p):
            lines.append(f"{node + 1}, {k + 1}, {k + 1}, {float(u)!r}")
    text = path.read_text(encoding="utf-8")
    text = re.sub(r"(?m)^IN\.INNER, *\d.*\n", "", text)
    at = text.rindex("*BOUNDARY")
    at = text.index("\n", at) + 1
    return Deck.parse(text[:at] + "\n".join(lines) + "\n" + text[at:], "tie")


def test_a_tie_of_nodes_on_a_curve_turns_as_a_rigid_body(solve, tmp_path):
    result = solve(curved_tie(0.15, tmp_path))
    assert result.history["energy.strain"][-1] < 1e-2
    assert result.summary["certificate"]["verdict"] == "PASS"
