"""What the scripts of this folder write decks with."""
from __future__ import annotations

import numpy as np

from lopin.mesh import Mesh
from lopin.model import Model
from lopin.model_deck import mesh_deck


def lean(mesh: Mesh, surfaces: str, points: str = "") -> Mesh:
    """The mesh with these surfaces and point sets only, coordinates to nine digits."""
    mesh = mesh.mapped(lambda x: np.round(x, 9))
    return mesh.replaced(surfaces={k: mesh.surfaces[k] for k in surfaces.split()},
                         point_sets={k: mesh.point_sets[k] for k in points.split()})


def text(mesh: Mesh, comment: str, rest: str, kind: str = "plane strain") -> str:
    """Comment, mesh, and the rest of the deck."""
    head = "\n".join(f"** {line}".rstrip() for line in comment.strip().splitlines())
    return f"{head}\n{mesh_deck(Model('mesh', mesh, kind=kind)).text()}{rest.lstrip()}"


def neo_hooke(young: float, poisson: float) -> str:
    """Data of *HYPERELASTIC, NEO HOOKE with these moduli at small strain: C10 = G/2, D1 = 2/K."""
    shear, bulk = young/(2.0*(1.0 + poisson)), young/(3.0*(1.0 - 2.0*poisson))
    return f"{0.5*shear:.10g}, {2.0/bulk:.10g}"


def interaction(name: str, mu: float = 0.0) -> str:
    """Exact contact, with friction if there is any."""
    rubs = f"*FRICTION\n{mu:g},\n" if mu else ""
    return f"*SURFACE INTERACTION, NAME={name}\n*SURFACE BEHAVIOR, DIRECT\n{rubs}"
