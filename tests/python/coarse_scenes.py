"""Decks of the collection on coarse meshes: the scene as it is, a quick run."""
import pathlib
import sys

import numpy as np

from lopin.closed_form import contact_modulus, hertz_point_approach
from lopin.deck import Deck
from lopin.model import Model
from lopin.model_deck import mesh_deck

DECKS = pathlib.Path(__file__).resolve().parents[2]/"decks"
sys.path.insert(0, str(DECKS/"make"))
import meshes  # noqa: E402


def hertz_sphere():
    """Six cells along the radius of contact; 24 in the deck."""
    mesh, deck, sides = meshes.half_space(
        [meshes.fine_then_spread(1/6, 1.125, 8.0, 1.8),
         np.concatenate([[0.0], meshes.spread(1/6, 0.0, 8.0, 1.8)])], 1.5, "axisymmetric")
    force = hertz_point_approach(0.02, 50.0, contact_modulus(20e3, 0.3)).force
    meshes.far_sides(deck, mesh, sides, force, 20e3, 0.3)
    return deck


def flat_punch():
    """The edge is between nodes, as in the deck."""
    last = 10.0 - 0.08
    out = last + meshes.fine_then_spread(0.16, 0.64, 100.0 - last, 1.6)
    inside = last - np.concatenate([[0.0], meshes.spread(0.16, 0.0, last, 1.4)])[::-1]
    mesh, deck, sides = meshes.half_space(
        [np.concatenate([inside, out[1:]]),
         np.concatenate([[0.0], meshes.spread(0.2, 0.0, 100.0, 1.6)])], 12.0, "axisymmetric")
    meshes.far_sides(deck, mesh, sides, 1000.0, 210e3, 0.3)
    return deck


def cylinder_on_plane():
    """Six cells along the half width of contact; twelve in the deck."""
    mesh = meshes.crowned(100.0, (20.0, 40.0), 1.0, 1/8, 1.8)
    return mesh_deck(Model("mesh", meshes.lean(mesh.mapped(lambda x: np.round(x, 9)), "ARC TOP",
                                               "LEFT")))


def coarse(name):
    """The deck of the collection with a coarse mesh in it."""
    text = (DECKS/f"{name}.inp").read_text(encoding="utf-8")
    own = {"hertz_sphere": hertz_sphere, "flat_punch": flat_punch,
           "cylinder_on_plane": cylinder_on_plane}[name]().text()
    return Deck.parse(text.replace(f"*INCLUDE, INPUT={name}.mesh\n", own), name=name)
