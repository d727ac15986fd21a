"""Bulk forming: billets, rings, discs and strips between flat plates, wire through a cone.

Upper halves, cut at y = 0: the plate is a rigid profile that comes down. Surfaces of the mesh: TOP,
RIGHT, and LEFT, the bore, of a ring. The lines of the plate run so that its left looks at the
metal.
"""
from __future__ import annotations

import numpy as np

import lopin
from lopin.mesh import Mesh
from lopin.mesh_make import block
from lopin.model import Model
from lopin.model_deck import mesh_deck

#: E, nu, flow curve (stress, plastic strain) [stress]
E1 = (200e3, 0.3, ((700.0, 0.0), (1300.0, 2.0)))
E5B = (200e3, 0.3, ((200.0, 0.0), (300.0, 2.0)))
RIGID_PLASTIC = (2e6, 0.3, ((200.0, 0.0),))


def metal(law) -> str:
    """The cards of a material named METAL."""
    young, poisson, curve = law
    rows = "".join(f"{s!r}, {e!r}\n" for s, e in curve)
    return f"*MATERIAL, NAME=METAL\n*ELASTIC\n{young!r}, {poisson!r}\n*PLASTIC\n{rows}"


def plate(height: float, reach: float, start: float = -1.0) -> str:
    """A flat rigid plate PLATE at a height, with the set PLATE_REF of its reference node."""
    return (f"*NODE, NSET=PLATE_REF\n900001, 0., {height + 1.0!r}\n"
            f"*SURFACE, NAME=PLATE, TYPE=SEGMENTS\nSTART, {reach!r}, {height!r}\nLINE, {start!r}, {height!r}\n"
            "*RIGID BODY, ANALYTICAL SURFACE=PLATE, REF NODE=PLATE_REF\n")


def squeezed(mesh: Mesh, law, friction: str, reduction: float, *, kind: str = "axisymmetric",
             control: str = "",
             static: str = "0.01, 1.", behaviour: str = "*SURFACE BEHAVIOR, DIRECT",
             reach: float = 0.0,
             prints: str = "", surfaces: tuple[str, ...] = ("TOP", "RIGHT"), name: str = "scene",
             reduced: bool = False, axis: bool = True) -> lopin.Deck:
    """A body over y = 0 pressed by a plate from above; `friction` are the cards of *FRICTION."""
    height = float(mesh.points[:, 1].max())
    mesh = mesh.replaced(surfaces={**mesh.surfaces,
                                   "SKIN": np.vstack([mesh.surfaces[s] for s in surfaces])})
    text = mesh_deck(Model(name, mesh, kind=kind)).text()
    if reduced:
        text = text.replace("CAX8\n", "CAX8R\n").replace("CAX8,", "CAX8R,")
    text += "*SECTION CONTROLS, NAME=PLAIN, FORMULATION=FULL\n" if control else ""
    text += metal(law) + f"*SOLID SECTION, ELSET=ALL, MATERIAL=METAL{control}\n"
    text += "1.,\n" if kind != "axisymmetric" else ""
    text += plate(height, reach or 4.0*float(mesh.points[:, 0].max()), -1.0)
    text += f"*SURFACE INTERACTION, NAME=I\n{behaviour}\n{friction}"
    text += f"*CONTACT PAIR, INTERACTION=I, TYPE=NODE TO SURFACE\nSKIN, PLATE\n"
    text += "*BOUNDARY\nBOTTOM, 2\nPLATE_REF, 1\nPLATE_REF, 6\n" + ("LEFT, 1\n" if axis else "")
    text += f"*STEP, NLGEOM, INC=5000\n*STATIC\n{static}\n*BOUNDARY\nPLATE_REF, 2, 2, {-reduction*height!r}\n"
    text += f"{prints}*NODE FILE\nU\n*CONTACT FILE\nCDIS, CSTR\n*END STEP\n"
    return lopin.Deck.parse(text, name, ".")


def billet(nr: int, nz: int, *, radius: float = 10.0, half: float = 15.0,
           quadratic: bool = False) -> Mesh:
    """A quarter of a round billet; MIDDLE and RIM are its outer points at mid-height and at the
    top."""
    mesh = block((radius, half), (nr, nz), quadratic=quadratic)
    return _named(mesh, MIDDLE=(radius, 0.0), RIM=(radius, half))


def ring(nr: int, nz: int, *, inner: float = 7.5, outer: float = 15.0, half: float = 5.0,
         quadratic: bool = False) -> Mesh:
    """Half a section of a ring; BORE_MIDDLE and BORE_PLATE are its inner points."""
    mesh = block((outer - inner, half), (nr, nz), origin=(inner, 0.0), quadratic=quadratic)
    return _named(mesh, BORE_MIDDLE=(inner, 0.0), BORE_PLATE=(inner, half))


def _named(mesh: Mesh, **places) -> Mesh:
    for name, place in places.items():
        mesh = mesh.with_points(name, lambda x, place=place: np.linalg.norm(x - np.asarray(place),
                                                                            axis=1) < 1e-9)
    return mesh


def coulomb(mu: float, words: str = "") -> str:
    """Cards of Coulomb's law; none without friction."""
    return f"*FRICTION{words}\n{mu!r},\n" if mu else ""


def tresca(m: float, words: str = "") -> str:
    """Cards of shear m k, k from the flow curve; none without friction."""
    return f"*FRICTION, LAW=TRESCA{words}\n{m!r}\n" if m else ""


def wire(before: float, after: float, half_angle: float, law, friction: str, stroke: float,
         cells=(8, 60), *,
         length: float = 0.0, static: str = "0.01, 1., 1e-6, 0.02", pull: bool = True,
         quadratic: bool = False) -> lopin.Deck:
    """A wire with a drawn tip, taken through a cone DIE by its end; lengths in diameters of
    `before`.

    The die runs from inlet to bearing with a round of one radius at both ends; the mesh is drawn
    already as far as the exit, so that the cone is full at the start.
    """
    r0, r1 = 0.5*before, 0.5*after
    slope = float(np.tan(np.radians(half_angle)))
    cone = (r0 - r1)/slope
    inlet = length or 3.0*before
    mesh = block((1.0, inlet + 1.5*cone + before), cells, origin=(0.0, -inlet), quadratic=quadratic)

    def shaped(x):
        y = x[:, 1]
        radius = np.interp(y, [0.0, cone], [r0, r1])
        return np.column_stack([x[:, 0]*radius, y])

    mesh = mesh.mapped(shaped)
    end = "TOP" if pull else "BOTTOM"
    text = mesh_deck(Model("wire", mesh, kind="axisymmetric")).text()
    text += metal(law) + "*SOLID SECTION, ELSET=ALL, MATERIAL=METAL\n"
    # Its left, inwards, looks at the metal: up from the inlet.
    bearing = 0.25*before
    far = 1.5*before
    text += ("*NODE, NSET=DIE_REF\n900001, 0., 0.\n*SURFACE, NAME=DIE, TYPE=SEGMENTS, FILLET RADIUS="
             f"{0.5*before!r}\nSTART, {r0 + far*slope!r}, {-far!r}\nLINE, {r1!r}, {cone!r}\n"
             f"LINE, {r1!r}, {cone + bearing!r}\nLINE, {r1 + 0.2*before!r}, {cone + bearing + 0.5*before!r}\n"
             "*RIGID BODY, ANALYTICAL SURFACE=DIE, REF NODE=DIE_REF\n")
    text += f"*SURFACE INTERACTION, NAME=I\n*SURFACE BEHAVIOR, DIRECT\n{friction}"
    text += "*CONTACT PAIR, INTERACTION=I, TYPE=NODE TO SURFACE\nRIGHT, DIE\n"
    text += f"*BOUNDARY\nLEFT, 1\nDIE_REF, 1\nDIE_REF, 2\nDIE_REF, 6\n"
    text += f"*STEP, NLGEOM, INC=5000\n*STATIC\n{static}\n*BOUNDARY\n{end}, 2, 2, {stroke!r}\n"
    text += "*NODE FILE\nU\n*EL FILE\nS\n*CONTACT FILE\nCDIS, CSTR\n*END STEP\n"
    return lopin.Deck.parse(text, "wire", ".")
