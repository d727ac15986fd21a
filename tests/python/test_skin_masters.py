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
            way, up = (2.0 + up)*np.cos(turn), (2.0 + up)*np.sin(turn)
        else:
            up = up + {"flat": 0.0, "valley": 0.3, "ridge": -0.3}[shape]*np.abs(way - 2.0)
        return np.column_stack([way, *x[:, 1:-1].T, up])
    return place


def stacked(kind, shape, sides, path="condensed", *, to_surface=False, over=0.01, gap=0.0,
            cells=(4, 4), layers=(1, 1), thick=1, turn=0.0,
            moduli=(2e4, 2e4), swapped=False):
    """Two bodies of one width that meet at 1; `over`: pressed or entered by, from a gap."""
    space = kind.startswith("C3D")
    deep = [(n,) if space else () for n in layers]
    low = shaped(kind, (4.0, 1.0, 1.0)[:2 + space], (cells[0], *deep[0], thick))
    high = 1.5 if shape == "ring" else 0.8
    up = shaped(kind, (4.0, 1.0, high) if space else (4.0, high), (cells[1], *deep[1], thick))
    up = up.moved(*(0.0,)*(1 + space), 1.0 + gap - (over if shape != "flat" else 0.0))
    slave, master = SIDES[sides]
    both = together(UP=up, LOW=low).mapped(bent(shape))
    c, s = np.cos(turn), np.sin(turn)
    both = both.mapped(lambda x: np.column_stack(
        [c*x[:, 0] - s*x[:, -1], *x[:, 1:-1].T, s*x[:, 0] + c*x[:, -1]]))
    model = Model("skins", both, kind="3d" if space else "plane strain")
    for name, modulus, ratio in zip(("UP", "LOW"), moduli, (0.3, 0.2), strict=True):
        model.section(name, Elastic(modulus, ratio))
    names = [("UP.BOTTOM", "UP.SKIN"), ("LOW.TOP", "LOW.SKIN")][::-1 if swapped else 1]
    model.contact(names[0][slave], names[1][master],
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


def compare(solve, tolerance, kind, shape, path, others=("master", "both"), **words):
    """Whole skins give the force that the faces give."""
    faces = force(solve, stacked(kind, shape, "none", path, **words))
    for sides in others:
        skin = force(solve, stacked(kind, shape, sides, path, **words))
        assert np.linalg.norm(skin - faces) <= tolerance*np.linalg.norm(faces), sides
    return np.linalg.norm(faces)


@pytest.mark.parametrize("path", ["condensed", "finite"])
@pytest.mark.parametrize("kind, shape", [
    ("CPE4", "ridge"), ("C3D8", "valley"), ("C3D8", "ridge"), ("C3D4", "valley"), ("C3D4", "flat")])
def test_nodes_flush_with_walls_of_the_master_are_met(solve, kind, shape, path):
    assert compare(solve, 1e-3, kind, shape, path) > 100.0


@pytest.mark.parametrize("words", [{}, {"turn": 2.9}, {"gap": 0.001}, {"cells": (4, 8)}])
def test_corners_that_bulge_past_each_other_stay_in_contact(solve, words):
    words = {"cells": (8, 8), "thick": 2, "moduli": (2e4, 4e4), "over": 0.002, **words}
    assert compare(solve, 1e-4, "CPE4", "flat", "finite", **words) > 100.0


def test_corners_in_space_that_bulge_past_each_other(solve):
    words = {"cells": (8, 5), "thick": 2, "moduli": (2e4, 4e4), "over": 0.002}
    assert compare(solve, 1e-4, "C3D8", "flat", "finite", others=("both",), **words) > 100.0


@pytest.mark.parametrize("kind", ["CPE4", "C3D8", "CPE8"])
@pytest.mark.parametrize("over, gap", [(0.01, 0.0), (0.0, 0.01)])
def test_no_node_of_a_skin_is_inside_the_master_through_its_own_body(solve, kind, over, gap):
    size = compare(solve, 1e-6, kind, "ring", "condensed", others=("both",), over=over, gap=gap,
                   thick=2, to_surface=True, swapped=True)
    assert (size > 0.0) == (over > 0.0)


@pytest.mark.parametrize("kind, cells", [("CPE4", (8, 4)), ("CPE4", (8, 5)), ("C3D8", (8, 5))])
def test_skins_that_say_no_type_are_taken_surface_to_surface(solve, kind, cells):
    """Their other sides hang over nothing; at the nodes the force was 3 to 26 % too small."""
    words = {"cells": cells, "thick": 2, "moduli": (2e4, 4e4), "over": 0.002}
    right = force(solve, stacked(kind, "flat", "none", "finite", to_surface=True, **words))
    deck = stacked(kind, "flat", "both", "finite", **words)
    for block in deck.blocks:
        if block.keyword == "CONTACT PAIR":
            block.parameters.pop("TYPE", None)
    result = force(solve, deck)
    assert np.linalg.norm(result - right) < 1e-3*np.linalg.norm(right)
