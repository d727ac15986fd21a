"""Bulk forming: billets, rings, discs and strips between flat plates, wire through a cone.

Upper halves, cut at y = 0: the plate is a rigid profile that comes down. Surfaces of the mesh: TOP,
RIGHT, and LEFT, the bore, of a ring. The lines of the plate run so that its left looks at the
metal.
"""
from __future__ import annotations

import numpy as np

import lopin
from lopin import Coulomb, Elastic, Material, Plastic, Tresca, profile
from lopin.friction import Friction
from lopin.mesh import Mesh
from lopin.mesh_make import block

#: E, nu, flow curve (stress, plastic strain) [stress]
E1 = (200e3, 0.3, ((700.0, 0.0), (1300.0, 2.0)))
E5B = (200e3, 0.3, ((200.0, 0.0), (300.0, 2.0)))
RIGID_PLASTIC = (2e6, 0.3, ((200.0, 0.0),))


def metal(law) -> Material:
    """The material of E, nu and a flow curve."""
    young, poisson, curve = law
    return Material(Elastic(young, poisson), Plastic(curve), name="METAL")


def squeezed(mesh: Mesh, law, friction: Friction | None, reduction: float, *,
             kind: str = "axisymmetric", full: bool = False, sizes: tuple[float, ...] = (0.01,),
             reach: float = 0.0, surfaces: tuple[str, ...] = ("TOP", "RIGHT"), name: str = "scene",
             reduced: bool = False, axis: bool = True) -> lopin.Model:
    """A body over y = 0 pressed by a plate from above.

    `sizes` of increments: the first, the smallest, the largest. `full`: no mean dilatation.
    """
    height = float(mesh.points[:, 1].max())
    skin = np.vstack([mesh.surfaces[s] for s in surfaces])
    model = lopin.Model(name, mesh.replaced(surfaces={**mesh.surfaces, "SKIN": skin}), kind=kind,
                        letters="R" if reduced else "")
    model.section("ALL", metal(law), full_integration=full)
    reach = reach or 4.0*float(mesh.points[:, 0].max())
    plate = model.rigid_tool("PLATE", profile.line((reach, height), (-1.0, height)),
                             ref=(0.0, height + 1.0))
    model.contact("SKIN", plate, friction=friction)
    model.fix("BOTTOM", 2)
    if axis:
        model.fix("LEFT", 1)
    step = _step(model, sizes).move(plate, **{"y" if kind.startswith("plane") else "z":
                                              -reduction*height})
    step.output(("U",), (), ("CDIS", "CSTR"))
    return model


def _step(model: lopin.Model, sizes: tuple[float, ...]):
    first, smallest, largest = sizes if len(sizes) == 3 else (*sizes, 1e-6, 1.0)
    return model.step(nlgeom=True, first=first, smallest=smallest, largest=largest, most=5000)


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


def coulomb(mu: float, **options) -> Friction | None:
    """Coulomb's law; nothing without friction."""
    return Coulomb(mu, **options) if mu else None


def tresca(m: float, **options) -> Friction | None:
    """Shear m k, k from the flow curve; nothing without friction."""
    return Tresca(m, **options) if m else None


def wire(before: float, after: float, half_angle: float, law, friction: Friction | None,
         stroke: float, cells=(8, 60), *, length: float = 0.0,
         sizes: tuple[float, ...] = (0.01, 1e-6, 0.02), pull: bool = True,
         quadratic: bool = False) -> lopin.Model:
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
    model = lopin.Model("wire", mesh, kind="axisymmetric")
    model.section("ALL", metal(law))
    # Its left, inwards, looks at the metal: up from the inlet.
    bearing, far = 0.25*before, 1.5*before
    cone_of_die = profile.start(r0 + far*slope, -far).line_to(r1, cone).line_to(r1, cone + bearing)
    cone_of_die = cone_of_die.line_to(r1 + 0.2*before, cone + bearing + 0.5*before)
    die = model.rigid_tool("DIE", cone_of_die.rounded(0.5*before))
    model.contact("RIGHT", die, friction=friction)
    model.fix("LEFT", "r")
    step = _step(model, sizes).move("TOP" if pull else "BOTTOM", z=stroke)
    step.output(("U",))
    return model
