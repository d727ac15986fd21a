"""Half a billet upset by a rigid plate, as a model: by element, mesh, increments, method and
friction."""
from __future__ import annotations

import numpy as np

import lopin
from lopin import Elastic, Material, Plastic, mesh_make, profile

#: Methods by the words of a deck.
METHODS = {"DIRECT": "lagrange", "PENALTY": "penalty", "PERTURBED LAGRANGE": "perturbed",
           "AUGMENTED LAGRANGE": "augmented"}


def billet(increments: int, *, mu: float = 0.0, share: float = 0.3, cells=(4, 6),
           direct: bool = True, word: str = "CAX4", method: str = "DIRECT", metal: bool = True,
           through: list | None = None) -> lopin.Model:
    """Half a billet of radius 10 and height 30, pressed by a share of it.

    `through`: points of an amplitude of the way.
    """
    mesh = mesh_make.block((10.0, 15.0), cells, quadratic=word.startswith("CAX8"))
    if word == "CAX3":
        mesh = mesh_make.simplices(mesh)
    skin = np.concatenate([mesh.surfaces["TOP"], mesh.surfaces["RIGHT"]])
    sets = {k: mesh.point_sets[k] for k in ("LEFT", "BOTTOM")}
    model = lopin.Model("billet", mesh.replaced(surfaces={"SKIN": skin}, point_sets=sets),
                        kind="axisymmetric", letters=word[4:])
    laws = [Elastic(200e3, 0.3)] + [Plastic([(700.0, 0.0), (1300.0, 2.0)])]*metal
    model.section("ALL", Material(*laws, name="STEEL"))
    die = model.rigid_tool("DIE", profile.line((40.0, 15.0), (-1.0, 15.0)), ref=(0.0, 20.0))
    model.contact("SKIN", die, METHODS[method], friction=mu or None)
    model.fix("LEFT", "r")
    model.fix("BOTTOM", "z")
    way = model.amplitude("WAY", through) if through else ""
    step = model.step(nlgeom=True, first=1.0/increments, largest=1.0, most=1000, fixed=direct)
    step.move(die, z=-15.0*share, amplitude=way)
    return model
