"""Write the meshes that decks of this folder include: `python decks/make/meshes.py [name ...]`.

A deck `name.inp` includes `name.mesh`, which is written here with nothing else in it.
"""
from __future__ import annotations

import sys
from math import log, pi
from pathlib import Path

import numpy as np

from lopin import mesh_make
from lopin.closed_form import contact_modulus, hertz_point_approach, signorini_singular
from lopin.deck import Deck, Row
from lopin.mesh import Mesh, together
from lopin.model import Model
from lopin.model_deck import mesh_deck

FOLDER = Path(__file__).resolve().parents[1]


def spread(first: float, start: float, end: float, growth: float) -> np.ndarray:
    """Ticks from `start` (not included) to `end`, the first about `first`, growing by `growth`."""
    n = max(1, round(log(1.0 + (end - start)*(growth - 1.0)/first)/log(growth)))
    x = np.cumsum(growth**np.arange(1, n + 1))
    return start + (end - start)*x/x[-1]


def fine_then_spread(size: float, fine: float, end: float, growth: float) -> np.ndarray:
    """Ticks from 0 to `end`: of one size up to `fine`, growing beyond."""
    even = size*np.arange(round(fine/size) + 1)
    return np.concatenate([even, spread(size, even[-1], end, growth)])


def boussinesq(force: float, r, depth, young: float, poisson: float):
    """Radial and axial (upward) displacement of a half-space under a downward point force."""
    far = np.hypot(r, depth)
    factor = force*(1.0 + poisson)/(2.0*pi*young)
    radial = factor*(r*depth/far**3 - (1.0 - 2.0*poisson)*r/(far*(far + depth)))
    return radial, -factor*(depth**2/far**3 + 2.0*(1.0 - poisson)/far)


def far_sides(deck: Deck, mesh: Mesh, sides: np.ndarray, force: float, young: float,
              poisson: float) -> None:
    """Move nodes (0-based) as a half-space loaded at the origin would."""
    block = deck.add("BOUNDARY", comment="The far sides move as Boussinesq's half-space does: the "
                     "block stands for a half-space.")
    for i in sides:
        x = mesh.points[i]
        r = np.hypot(*x[:-1]) if len(x) == 3 else x[0]
        radial, axial = boussinesq(force, r, -x[-1], young, poisson)
        radial = [radial] if len(x) == 2 else [radial*c/r if r > 0.0 else 0.0 for c in x[:-1]]
        for d, value in enumerate([*radial, axial], start=1):
            if d == len(x) or x[d - 1] > 1e-9:
                block.lines.append(Row([int(i) + 1, d, d, float(f"{value:.8g}")]))


def half_space(ticks: list[np.ndarray], near: float, kind: str) -> tuple[Mesh, Deck, np.ndarray]:
    """Block below z = 0 with ticks along r (or x = y) and down; surface NEAR within `near`."""
    across, down = ticks
    end, depth = across[-1], down[-1]
    n = 2 if kind == "3d" else 1
    mesh = mesh_make.block((end,)*n + (depth,), (len(across) - 1,)*n + (len(down) - 1,),
                           grading=[across/end]*n + [1.0 - down[::-1]/depth],
                           origin=(0.0,)*n + (-depth,))
    mesh = mesh.mapped(lambda x: np.round(x, 9))
    mesh = mesh.with_surface("NEAR", lambda x: (x[:, -1] > -1e-9) & (x[:, :-1].max(axis=1) < near))
    keep = {"NEAR", "LEFT"} | ({"FRONT"} if kind == "3d" else set())
    lean = mesh.replaced(point_sets={k: v for k, v in mesh.point_sets.items() if k in keep},
                         surfaces={"NEAR": mesh.surfaces["NEAR"]})
    x = mesh.points
    sides = np.flatnonzero((x[:, :-1].max(axis=1) > end - 1e-6) | (x[:, -1] < -depth + 1e-6))
    return lean, mesh_deck(Model("mesh", lean, kind=kind)), sides


def hertz_sphere() -> Deck:
    """Half-space under a sphere that goes 0.02 deep: contact radius 1."""
    mesh, deck, sides = half_space([fine_then_spread(1/24, 1.125, 8.0, 1.08),
                                    np.concatenate([[0.0], spread(1/24, 0.0, 8.0, 1.08)])],
                                   1.5, "axisymmetric")
    force = hertz_point_approach(0.02, 50.0, contact_modulus(20e3, 0.3)).force
    far_sides(deck, mesh, sides, force, 20e3, 0.3)
    return deck


def hertz_sphere_3d() -> Deck:
    """The same in three dimensions, a quarter."""
    mesh, deck, sides = half_space([fine_then_spread(1/6, 7/6, 5.0, 1.5),
                                    np.concatenate([[0.0], spread(1/8, 0.0, 5.0, 1.5)])],
                                   1.4, "3d")
    force = hertz_point_approach(0.02, 50.0, contact_modulus(20e3, 0.3)).force
    far_sides(deck, mesh, sides, force, 20e3, 0.3)
    return deck


def lean(mesh: Mesh, surfaces: str, points: str = "") -> Mesh:
    """The mesh with these surfaces and point sets only."""
    return mesh.replaced(surfaces={k: mesh.surfaces[k] for k in surfaces.split()},
                         point_sets={k: mesh.point_sets[k] for k in points.split()})


def crowned(radius: float, size: tuple[float, float], fine: float, element: float,
            growth: float) -> Mesh:
    """The lower part of half a cylinder or ball; it touches y = 0 at the origin."""
    across = fine_then_spread(element, fine, size[0], growth)
    up = np.concatenate([[0.0], spread(element, 0.0, size[1], growth)])
    mesh = mesh_make.crowned_block(size, (len(across) - 1, len(up) - 1), radius,
                                   grading=(across/size[0], up/size[1]))
    # Middles of faces are asked for; those of the arc are off the axis and just inside the circle.
    return mesh.with_surface("ARC", lambda x: (x[:, 0] > 1e-3*element) & (x[:, 0] < 1.5*fine) & (
        np.hypot(x[:, 0], x[:, 1] - radius) > radius - element**2/radius))


def nafems_cylinder() -> Deck:
    """Half of a cylinder of radius 50, cut at 40, on half of a block of 200 by 200."""
    cylinder = crowned(50.0, (40.0, 50.0), 8.0, 0.4, 1.2)
    across = fine_then_spread(0.4, 8.0, 100.0, 1.15)
    down = np.concatenate([[0.0], spread(0.4, 0.0, 200.0, 1.15)])
    block = mesh_make.block((100.0, 200.0), (len(across) - 1, len(down) - 1), origin=(0.0, -200.0),
                            grading=(across/100.0, 1.0 - down[::-1]/200.0))
    block = block.with_surface("NEAR", lambda x: (x[:, 1] > -1e-9) & (x[:, 0] < 12.0))
    block = block.with_points("B", lambda x: (x[:, 1] > -1e-9) & (x[:, 0] < 1e-9))
    mesh = together(CYLINDER=lean(cylinder, "ARC TOP", "LEFT"),
                    BLOCK=lean(block, "NEAR", "LEFT BOTTOM B"))
    return mesh_deck(Model("mesh", mesh.mapped(lambda x: np.round(x, 9))))


def cattaneo() -> Deck:
    """Two cylinders of radius 200 on each other, as blocks of 50 by 25 with a crown each."""
    half = fine_then_spread(0.035, 1.365, 25.0, 1.4)
    across = np.concatenate([-half[:0:-1], half])
    up = np.concatenate([[0.0], spread(0.035, 0.0, 25.0, 1.3)])
    shape = (len(across) - 1, len(up) - 1)
    upper = mesh_make.block((50.0, 25.0), shape, origin=(-25.0, 0.0),
                            grading=((across + 25.0)/50.0, up/25.0))
    crown = lambda x: np.column_stack([x[:, 0], x[:, 1]
                                       + x[:, 0]**2/400.0*(1.0 - x[:, 1]/25.0)])  # noqa: E731
    near = upper.with_surface("NEAR",
                              lambda x: (x[:, 1] < 1e-9) & (np.abs(x[:, 0]) < 2.5)).mapped(crown)
    lower = mesh_make.block((50.0, 25.0), shape, origin=(-25.0, -25.0),
                            grading=((across + 25.0)/50.0, 1.0 - up[::-1]/25.0))
    lower = lower.with_surface("NEAR", lambda x: (x[:, 1] > -1e-9) & (np.abs(x[:, 0]) < 2.5))
    lower = lower.mapped(lambda x: crown(x*[1.0, -1.0])*[1.0, -1.0])
    mesh = together(UP=lean(near, "NEAR", "TOP"), LOW=lean(lower, "NEAR", "BOTTOM"))
    return mesh_deck(Model("mesh", mesh.mapped(lambda x: np.round(x, 9))))


def capstan() -> Deck:
    """A quarter of a ring from 100 to 101, quadratic."""
    mesh = mesh_make.ring(100.0, 101.0, (2, 90), quadratic=True).mapped(lambda x: np.round(x, 9))
    return mesh_deck(Model("mesh", lean(mesh, "INNER END", "START"), kind="plane stress"))


def drawbead() -> Deck:
    """A strip of 40 by 1."""
    mesh = mesh_make.block((40.0, 1.0), (50, 2))
    return mesh_deck(Model("mesh", lean(mesh, "BOTTOM TOP", "RIGHT"), kind="plane strain"))


def cylinder_on_plane() -> Deck:
    """Half of a cylinder of radius 100, cut at 20."""
    mesh = crowned(100.0, (20.0, 40.0), 1.0, 1/16, 1.2)
    return mesh_deck(Model("mesh", lean(mesh.mapped(lambda x: np.round(x, 9)), "ARC TOP", "LEFT")))


def flat_punch() -> Deck:
    """Half-space, fine where the edge of a punch of radius 10 presses, which is between nodes."""
    last = 10.0 - 0.02
    out = last + fine_then_spread(0.04, 0.16, 100.0 - last, 1.2)
    inside = last - np.concatenate([[0.0], spread(0.04, 0.0, last, 1.12)])[::-1]
    mesh, deck, sides = half_space([np.concatenate([inside, out[1:]]),
                                    np.concatenate([[0.0], spread(0.05, 0.0, 100.0, 1.2)])],
                                   12.0, "axisymmetric")
    far_sides(deck, mesh, sides, 1000.0, 210e3, 0.3)
    return deck


def lifted_beam() -> Deck:
    """A beam of 200 by 2, quadratic; its end on the middle line."""
    mesh = mesh_make.block((200.0, 2.0), (200, 2), quadratic=True)
    mesh = mesh.with_points("END", lambda x: (x[:, 0] > 199.9) & (np.abs(x[:, 1] - 1.0) < 1e-9))
    return mesh_deck(Model("mesh", lean(mesh, "BOTTOM", "LEFT END"), kind="plane stress"))


def patch_test() -> Deck:
    """Two blocks of 10 by 4 with three and four elements along."""
    low = mesh_make.block((10.0, 4.0), (3, 2))
    up = mesh_make.block((10.0, 4.0), (4, 2), origin=(0.0, 4.0))
    low = low.with_points("PIN", lambda x: np.abs(x).max(axis=1) < 1e-9)
    up = up.with_points("PIN", lambda x: (x[:, 0] < 1e-9) & (x[:, 1] > 7.9))
    mesh = together(UP=lean(up, "BOTTOM TOP", "PIN"), LOW=lean(low, "TOP", "BOTTOM PIN"))
    return mesh_deck(Model("mesh", mesh))


def two_blocks_mortar() -> Deck:
    """A block of 6 by 4 on one of 10 by 4, cut differently."""
    low = mesh_make.block((10.0, 4.0), (5, 3))
    up = mesh_make.block((6.0, 4.0), (7, 3), origin=(2.0, 4.0))
    low = low.with_points("PIN", lambda x: np.abs(x).max(axis=1) < 1e-9)
    low = low.with_surface("FREE", lambda x: (x[:, 1] > 3.9) & (np.abs(x[:, 0] - 5.0) > 2.9))
    up = up.with_points("PIN", lambda x: (x[:, 0] < 2.0 + 1e-9) & (x[:, 1] > 7.9))
    mesh = together(UP=lean(up, "BOTTOM TOP", "PIN"), LOW=lean(low, "TOP FREE", "BOTTOM PIN"))
    return mesh_deck(Model("mesh", mesh))


def signorini() -> Deck:
    """A unit square whose sides but the lower one move as the exact solution does."""
    mesh = mesh_make.block((1.0, 1.0), (16, 16))
    deck = mesh_deck(Model("mesh", lean(mesh, "BOTTOM")))
    x = mesh.points
    sides = np.flatnonzero((x[:, 0] < 1e-9) | (x[:, 0] > 1.0 - 1e-9) | (x[:, 1] > 1.0 - 1e-9))
    block = deck.add("BOUNDARY", comment="The exact displacements on three sides.")
    for i, u in zip(sides, signorini_singular(x[sides]).u):
        block.lines += [Row([int(i) + 1, d + 1, d + 1, float(f"{u[d]:.10g}")]) for d in (0, 1)]
    return deck


def strip_bending() -> Deck:
    """Half a strip, 60 by 2, finest under the punch and over the shoulder of the die."""
    step = np.repeat([0.25, 0.9, 0.375, 2.0], [12, 30, 16, 12])
    ticks = np.concatenate([[0.0], np.cumsum(step)])
    mesh = mesh_make.block((ticks[-1], 2.0), (len(step), 4), grading=(ticks/ticks[-1], 1.0),
                           quadratic=True)
    mesh = mesh.with_surface("TOP", lambda x: (x[:, 1] > 2.0 - 1e-9) & (x[:, 0] < 3.0))
    mesh = mesh.with_surface("BOTTOM", lambda x: (x[:, 1] < 1e-9) & (x[:, 0] > 30.0))
    return mesh_deck(Model("mesh", lean(mesh, "TOP BOTTOM", "LEFT")))


def glued_beam() -> Deck:
    """Two strips of 100 by 5, one on the other, with 40 and 30 elements along."""
    low = mesh_make.block((100.0, 5.0), (30, 2), origin=(0.0, -5.0), quadratic=True)
    up = mesh_make.block((100.0, 5.0), (40, 2), quadratic=True)
    up = up.with_points("TIP", lambda x: (x[:, 0] > 99.9) & (np.abs(x[:, 1]) < 1e-9))
    # The glue holds the corner of the upper one, so that nothing is held twice.
    up = up.with_points("LEFT", lambda x: (x[:, 0] < 1e-9) & (x[:, 1] > 1e-9))
    mesh = together(UP=lean(up, "BOTTOM RIGHT", "LEFT TIP"), LOW=lean(low, "TOP RIGHT", "LEFT"))
    return mesh_deck(Model("mesh", mesh, kind="plane stress"))


def shrink_fit() -> Deck:
    """Sections of two rings, 10 to 20 and 20 to 30."""
    inner = mesh_make.block((10.0, 4.0), (10, 4), origin=(10.0, 0.0), quadratic=True)
    outer = mesh_make.block((10.0, 4.0), (10, 4), origin=(20.0, 0.0), quadratic=True)
    mesh = together(SHAFT=lean(inner, "RIGHT", "BOTTOM"), SLEEVE=lean(outer, "LEFT", "BOTTOM"))
    return mesh_deck(Model("mesh", mesh, kind="axisymmetric"))


def ball_on_ball() -> Deck:
    """A quarter of a crowned block of radius 50; it touches z = 0 at the origin."""
    ticks = fine_then_spread(1/6, 7/6, 6.0, 1.45)
    up = np.concatenate([[0.0], spread(1/8, 0.0, 8.0, 1.45)])
    mesh = mesh_make.crowned_block((6.0, 6.0, 8.0), (len(ticks) - 1, len(ticks) - 1, len(up) - 1),
                                   50.0, grading=(ticks/6.0, ticks/6.0, up/8.0))
    low = 50.0 - (50.0**2 - 2*1.4**2)**0.5
    mesh = mesh.with_surface("CROWN", lambda x: (x[:, :2].max(axis=1) < 1.4) & (x[:, 2] < low)
                             & (x[:, :2].min(axis=1) > 1e-9))
    return mesh_deck(Model("mesh", lean(mesh.mapped(lambda x: np.round(x, 9)), "CROWN TOP",
                                        "LEFT FRONT"), kind="3d"))


def beam_on_roller() -> Deck:
    """A beam of 100 by 4 by 4, quadratic bricks."""
    mesh = mesh_make.block((100.0, 4.0, 4.0), (20, 1, 2), quadratic=True)
    mesh = mesh.with_surface("BOTTOM", lambda x: (x[:, 2] < 1e-9) & (np.abs(x[:, 0] - 80.0) < 5.0))
    mesh = mesh.with_points("TIP", lambda x: (x[:, 0] > 99.9) & (np.abs(x[:, 1] - 2.0) < 1.1)
                            & (np.abs(x[:, 2] - 2.0) < 1e-9))
    return mesh_deck(Model("mesh", lean(mesh, "BOTTOM RIGHT", "LEFT TIP"), kind="3d"))


MESHES = {f.__name__: f for f in (cattaneo, hertz_sphere, hertz_sphere_3d, nafems_cylinder,
                                  cylinder_on_plane, flat_punch, lifted_beam,
                                  patch_test, signorini, strip_bending,
                                  glued_beam, two_blocks_mortar, shrink_fit, ball_on_ball,
                                  beam_on_roller, capstan, drawbead)}


def main(names: list[str]) -> None:
    """Write the meshes of these names, or all."""
    from bulk_meshes import MESHES as of_bulk  # both take their tools from here
    from friction_meshes import MESHES as of_friction

    meshes = MESHES | of_friction | of_bulk
    for name in names or meshes:
        text = f"** Written by decks/make/meshes.py\n{meshes[name]().text()}"
        (FOLDER/f"{name}.mesh").write_text(text, encoding="ascii")
        print(f"{name}.mesh: {len(text)//1000} kB")


if __name__ == "__main__":
    main(sys.argv[1:])
