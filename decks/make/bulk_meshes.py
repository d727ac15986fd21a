"""Meshes of the decks of bulk forming, for meshes.py."""
from __future__ import annotations

import numpy as np
from meshes import lean

from lopin import mesh_make
from lopin.deck import Deck
from lopin.mesh import Mesh
from lopin.model import Model
from lopin.model_deck import mesh_deck


def with_skin(mesh: Mesh, sides: str, *points: tuple[str, float, float]) -> Mesh:
    """Sides in one surface SKIN, and points by name."""
    mesh = mesh.replaced(surfaces={"SKIN": np.vstack([mesh.surfaces[s] for s in sides.split()])})
    for name, x, y in points:
        mesh = mesh.with_points(name, lambda p, x=x, y=y: np.hypot(p[:, 0] - x, p[:, 1] - y) < 1e-9)
    return mesh


def upsetting(cells: tuple[int, int] = (12, 18)) -> Deck:
    """A quarter of a billet, radius 10 and height 30; TOP and side are its skin."""
    mesh = with_skin(mesh_make.block((10.0, 15.0), cells), "TOP RIGHT", ("MIDDLE", 10.0, 0.0))
    return mesh_deck(Model("mesh", lean(mesh, "SKIN", "LEFT BOTTOM MIDDLE"), kind="axisymmetric"))


def ring_compression(cells: tuple[int, int] = (16, 10)) -> Deck:
    """Half the section of a ring 7.5/15/10."""
    mesh = mesh_make.block((7.5, 5.0), cells, origin=(7.5, 0.0))
    mesh = with_skin(mesh, "TOP RIGHT LEFT", ("BORE", 7.5, 0.0))
    return mesh_deck(Model("mesh", lean(mesh, "SKIN", "BOTTOM BORE"), kind="axisymmetric"))


def wire_drawing(cells: tuple[int, int] = (4, 52)) -> Deck:
    """A wire of diameter 10 before and 9 behind a cone of 8 degrees, which it fills."""
    cone = 0.5/np.tan(np.radians(8.0))
    mesh = mesh_make.block((1.0, 42.0), cells, origin=(0.0, -28.0))
    mesh = mesh.mapped(lambda x: np.round(np.column_stack([
        x[:, 0]*np.interp(x[:, 1], [0.0, cone], [5.0, 4.5]), x[:, 1]]), 9))
    return mesh_deck(Model("mesh", lean(mesh, "RIGHT", "LEFT TOP"), kind="axisymmetric"))


MESHES = {f.__name__: f for f in (upsetting, ring_compression, wire_drawing)}
