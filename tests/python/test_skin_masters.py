"""Masters that are whole skins: nodes flush with their walls, corners that bulge past each other."""
import itertools

import numpy as np
import pytest

from lopin import mesh_make
from lopin.laws import Elastic
from lopin.mesh import together
from lopin.model import Model

SIDES = {"none": (False, False), "slave": (True, False), "master": (False, True),
         "both": (True, True)}


def with_skin(mesh):
    """A mesh with the surface SKIN of all its named faces."""
    return mesh.replaced(surfaces={**mesh.surfaces,
                                   "SKIN": np.concatenate(list(mesh.surfaces.values()))})


def shaped(kind, size, cells):
    """A block of a word."""
    mesh = mesh_make.block(size, cells)
    if kind in ("CPE3", "C3D4", "C3D10"):
        mesh = mesh_make.simplices(mesh)
    return with_skin(mesh.quadratic() if kind in ("CPE8", "C3D10", "C3D20") else mesh)


def bent(shape):
    """The mapping of blocks that stand on each other at a height of 1 to a shape."""
    def place(x):
        way, up = x[:, 0], x[:, -1]
        if shape == "ring":
            turn = np.pi/8*(4.0 - way)
            way, up = (3.0 + up)*np.cos(turn), (3.0 + up)*np.sin(turn)
        else:
            up = up + {"flat": 0.0, "valley": 0.3, "ridge": -0.3}[shape]*np.abs(way - 2.0)
        return np.column_stack([way, *x[:, 1:-1].T, up])
    return place


def stacked(kind, shape, sides, path="condensed", *, to_surface=False, over=0.01, gap=0.0,
            cells=(4, 4), layers=(1, 1), thick=1, turn=0.0,
            moduli=(2e4, 2e4)):
    """Two bodies of one width that meet at 1; `over`: pressed or entered by, from a gap."""
    space = kind.startswith("C3D")
    deep = [(n,) if space else () for n in layers]
    low = shaped(kind, (4.0, 1.0, 1.0)[:2 + space], (cells[0], *deep[0], thick))
    up = shaped(kind, (4.0, 1.0, 0.8)[:2] + (0.8,) if space else (4.0, 0.8), (cells[1], *deep[1], thick))
    up = up.moved(*(0.0,)*(1 + space), 1.0 + gap - (over if shape != "flat" else 0.0))
    slave, master = SIDES[sides]
    both = together(UP=up, LOW=low).mapped(bent(shape))
    c, s = np.cos(turn), np.sin(turn)
    both = both.mapped(lambda x: np.column_stack(
        [c*x[:, 0] - s*x[:, -1], *x[:, 1:-1].T, s*x[:, 0] + c*x[:, -1]]))
    model = Model("skins", both, kind="3d" if space else "plane strain")
    for name, modulus in zip(("UP", "LOW"), moduli, strict=True):
        model.section(name, Elastic(modulus, 0.3))
    model.contact("UP.SKIN" if slave else "UP.BOTTOM", "LOW.SKIN" if master else "LOW.TOP",
                  surface_to_surface=to_surface, initial="interference" if gap <= 0.0 else "")
    axes = ("x", "y", "z")[:2 + space]
    if shape == "ring":
        for name, face in itertools.product(("UP", "LOW"), ("LEFT", "RIGHT")):
            model.fix(f"{name}.{face}", axes[0] if face == "LEFT" else axes[-1])
    else:
        model.fix("LOW.BOTTOM", *axes)
    if space:
        model.fix("UP.FRONT", "y")
        model.fix("LOW.FRONT", "y")
    step = model.step(nlgeom=path == "finite")
    if shape == "flat":
        step.move("UP.TOP", **{axes[0]: float(s*(over + gap)), axes[-1]: float(-c*(over + gap))})
    elif shape != "ring":
        step.move("UP.TOP", **dict.fromkeys(axes, 0.0))
    return model.to_deck()


def force(solve, deck):
    """The force of the pair at the end, and what is closed."""
    result = solve(deck)
    name = next(k for k in result.history if k.endswith(".force1"))[:-1]
    return np.array([result.history[name + d][-1] for d in "123" if name + d in result.history])


@pytest.mark.parametrize("path", ["condensed", "finite"])
@pytest.mark.parametrize("kind, shape", [
    ("CPE4", "ridge"), ("CPE8", "flat"), ("C3D8", "valley"), ("C3D8", "ridge"), ("C3D4", "valley"),
    ("C3D4", "flat"), ("C3D8", "ring")])
def test_a_master_skin_gives_what_its_face_gives(solve, kind, shape, path):
    faces = force(solve, stacked(kind, shape, "none", path))
    assert np.linalg.norm(faces) > 1.0
    for sides in ("master", "both"):
        skin = force(solve, stacked(kind, shape, sides, path))
        assert np.linalg.norm(skin - faces) < 1e-3*np.linalg.norm(faces), sides


@pytest.mark.parametrize("words", [{"gap": 0.008}, {"turn": 2.9}, {"cells": (4, 6), "layers": (1, 2)}])
def test_open_at_the_start_turned_and_unlike(solve, words):
    kind = "C3D8" if "layers" in words else "CPE4"
    faces = force(solve, stacked(kind, "flat", "none", "finite", **words))
    skin = force(solve, stacked(kind, "flat", "both", "finite", **words))
    assert np.linalg.norm(skin - faces) < 1e-6*np.linalg.norm(faces)


def halves(sides, path, unlike):
    """Two blocks of one width, the upper one half as stiff: they bulge past each other."""
    deck = stacked("CPE4", "flat", sides, path, cells=(8, 8))
    return deck if not unlike else type(deck).parse(
        deck.text().replace("20000., 0.3", "10000., 0.3", 1))


@pytest.mark.parametrize("unlike", [False, True])
def test_corners_that_bulge_past_each_other_stay_in_contact(solve, unlike):
    faces = force(solve, halves("none", "finite", unlike))
    skin = force(solve, halves("both", "finite", unlike))
    assert np.linalg.norm(skin - faces) < 1e-4*np.linalg.norm(faces)


@pytest.mark.parametrize("over", [0.05, -0.1])
@pytest.mark.parametrize("kind", ["C3D8", "CPE8"])
def test_skins_surface_to_surface_have_no_far_side_inside(solve, kind, over):
    faces = force(solve, stacked(kind, "ring", "none", to_surface=True, over=over,
                                 gap=0.0 if over > 0.0 else 1e-9))
    skin = force(solve, stacked(kind, "ring", "both", to_surface=True, over=over,
                                gap=0.0 if over > 0.0 else 1e-9))
    assert np.linalg.norm(skin - faces) <= 1e-6*np.linalg.norm(faces)
    assert (np.linalg.norm(faces) > 0.0) == (over > 0.0)
