"""Scenes that slide far or turn: a mesh of lopin.mesh_make and the cards around it."""
from __future__ import annotations

import numpy as np

import lopin
from lopin.mesh import Mesh
from lopin.model import Model
from lopin.model_deck import mesh_deck

LAGRANGE = "*SURFACE BEHAVIOR, DIRECT"


def turned(mesh: Mesh, degrees: float) -> Mesh:
    """The mesh rotated about the origin (in space: about z)."""
    turn = rotation(degrees)
    return mesh.mapped(lambda x: np.column_stack([x[:, :2] @ turn.T, x[:, 2:]]))


def rotation(degrees: float) -> np.ndarray:
    """Matrix of a rotation in the plane."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.array([[c, -s], [s, c]])


def material(young: float = 210e3, poisson: float = 0.3, *, name: str = "M") -> str:
    """A material of Hooke and Hencky."""
    return f"*MATERIAL, NAME={name}\n*ELASTIC\n{young!r}, {poisson!r}\n"


def rubber(c10: float, d1: float, *, name: str = "M") -> str:
    """A neo-Hookean material."""
    return f"*MATERIAL, NAME={name}\n*HYPERELASTIC, NEO HOOKE\n{c10!r}, {d1!r}\n"


def sections(materials: dict[str, str]) -> str:
    """Element sets and their materials."""
    return "".join(f"*SOLID SECTION, ELSET={k}, MATERIAL={v}\n" for k, v in materials.items())


def pair(slave: str, master: str, *, behaviour: str = LAGRANGE, friction: float = 0.0,
         words: str = "") -> str:
    """An interaction and its pair."""
    rub = f"*FRICTION\n{friction!r},\n" if friction else ""
    return (f"*SURFACE INTERACTION, NAME=I\n{behaviour}\n{rub}"
            f"*CONTACT PAIR, INTERACTION=I{words}\n{slave}, {master}\n")


def step(static: str, cards: str, *, inc: int = 1000, direct: bool = False) -> str:
    """A step under finite rotation with all outputs."""
    return (f"*STEP, NLGEOM, INC={inc}\n*STATIC{', DIRECT' if direct else ''}\n{static}\n{cards}"
            "*NODE FILE\nU, RF\n*EL FILE\nS\n*CONTACT FILE\nCDIS, CSTR\n*END STEP\n")


def deck(mesh: Mesh, cards: str, folder=".", kind: str = "plane strain") -> lopin.Deck:
    """The mesh and the cards as one deck."""
    text = mesh_deck(Model("mesh", mesh, kind=kind)).text()
    return lopin.Deck.parse(text + cards, "scene", folder)
