"""Meshes of the decks with friction; meshes.py writes them with the others."""
from __future__ import annotations

import numpy as np
from meshes import fine_then_spread, half_space, lean, spread

from lopin import mesh_make
from lopin.deck import Deck
from lopin.mesh import Mesh, together
from lopin.model import Model
from lopin.model_deck import mesh_deck

#: Edge of the rough punch lies in the middle between two nodes.
PUNCH_SIZE = 10.0/120.5


def rough_punch() -> Deck:
    """Half of a half-plane under a punch of half width 10; 121 nodes touch it."""
    across = fine_then_spread(PUNCH_SIZE, 10.6, 1000.0, 1.25)
    down = np.concatenate([[0.0], spread(PUNCH_SIZE, 0.0, 1000.0, 1.25)])
    mesh, deck, sides = half_space([across, down], 10.5, "plane strain")
    half = lean(mesh.with_points("FAR", lambda x: (x[:, 0] > 999.9) | (x[:, 1] < -999.9)), "NEAR",
                "LEFT FAR")
    return mesh_deck(Model("mesh", half))


#: Radii of contact and of stick of benchmark A8.
CONTACT, STICK = 0.402073, 0.351243


def mindlin(rings: int = 6) -> Deck:
    """Half of a ball of radius 10, as a cylinder with a crown, on half of a cylinder; y = 0 is
    their plane of symmetry.

    `rings` of elements fill the ring that slips; its edges lie in the middle between nodes. The
    flat one is the master: normals stay in the plane of symmetry.
    """
    tall, ring = 40.0, (CONTACT - STICK)/rings
    fine = np.arange(STICK - 2.5*ring, CONTACT + 1.5001*ring, ring)
    plane = half_disc(4, np.concatenate([[0.2, 0.5*(0.2 + fine[0])], fine,
                                         spread(1.5*ring, fine[-1], tall, 2.0)]))
    up = np.concatenate([[0.0], spread(0.04 if rings < 4 else 0.03, 0.0, tall, 2.0)])
    body = mesh_make.extruded(plane, 1.0, len(up) - 1)
    level = np.rint(body.points[:, 2]*(len(up) - 1)).astype(int)

    def stacked(heights, crown):
        flat = body.points[:, :2]
        reach = np.minimum((flat**2).sum(axis=1), 1.0)
        z = heights[level]
        low = body.replaced(points=np.column_stack([flat, z]))
        low = low.with_surface("NEAR",
                               lambda x: (np.abs(x[:, 2]) < 1e-9) & (np.hypot(*x[:, :2].T) < 0.5))
        # The rigid upper face has its own supports.
        low = low.with_points("FRONT",
                              lambda x: (x[:, 1] > -1e-9) & (np.abs(x[:, 2]) < tall - 1e-6))
        low = low.with_points("FAR", lambda x: np.abs(x[:, 2]) > tall - 1e-6)
        return lean(low, "NEAR", "FAR FRONT").mapped(
            lambda x: np.column_stack([flat, z + crown*reach/20.0*(1.0 - z/tall)]))

    mesh = together(UP=stacked(up, 1.0), LOW=stacked(-up[::-1], 0.0))
    return mesh_deck(Model("mesh", mesh.mapped(lambda x: np.round(x, 9)), kind="3d"))


def half_disc(cells: int, radii: np.ndarray) -> Mesh:
    """The half y <= 0 of a disc: a core of the first radius, 4 x `cells` around, and rings at the
    others."""
    core = mesh_make.disc(radii[0], cells, part="half")
    around = mesh_make.ring(1.0, 2.0, (len(radii) - 1, 4*cells), angles=(180.0, 360.0))

    def spaced(x):
        r = np.hypot(*x.T)
        return x*(radii[np.rint((r - 1.0)*(len(radii) - 1)).astype(int)]/r)[:, None]

    around = around.mapped(spaced)
    cells_of = np.vstack([core.blocks[0][1], around.blocks[0][1] + core.n_point])
    return mesh_make.merged(Mesh(np.vstack([core.points, around.points]), [("quad", cells_of)], {},
                                 {"ALL": np.arange(len(cells_of))}, {}))


def _punch(along: np.ndarray, up: np.ndarray, quadratic: bool = False) -> Mesh:
    """A punch of radius 50 and height 100 whose lower edge is rounded by 10; ticks along its face
    (with the arc) and up."""
    mesh = mesh_make.block((1.0, 1.0), (len(along) - 1, len(up) - 1),
                           grading=(along/along[-1], up/100.0), quadratic=quadratic)

    def round_off(x):
        s = x[:, 0]*along[-1]
        angle = np.maximum(0.0, s - 40.0)/10.0
        low = np.column_stack([np.minimum(s, 40.0) + 10.0*np.sin(angle),
                               10.0*(1.0 - np.cos(angle))])
        top = np.column_stack([x[:, 0]*50.0, np.full(len(s), 100.0)])
        return low + (top - low)*x[:, 1:]

    mesh = mesh.with_surface("FACE", lambda x: (x[:, 1] < 1e-9) & (x[:, 0]*along[-1] < 48.0))
    return mesh.mapped(round_off)


def _on_block(punch: Mesh, across: np.ndarray, down: np.ndarray, quadratic: bool = False) -> Deck:
    """The punch on a block of radius 100 and height 200."""
    block = mesh_make.block((100.0, 200.0), (len(across) - 1, len(down) - 1), origin=(0.0, -200.0),
                            grading=(across/100.0, 1.0 - down[::-1]/200.0), quadratic=quadratic)
    block = block.with_surface("NEAR", lambda x: (x[:, 1] > -1e-9) & (x[:, 0] < 50.0))
    block = block.with_points("M", lambda x: (x[:, 1] > -1e-9) & (x[:, 0] < 1e-9))
    mesh = together(PUNCH=lean(punch, "FACE TOP", "LEFT"),
                    BLOCK=lean(block, "NEAR", "LEFT BOTTOM RIGHT M"))
    return mesh_deck(Model("mesh", mesh.mapped(lambda x: np.round(x, 9)), kind="axisymmetric"))


def nafems_punch(fine: float = 0.5, quadratic: bool = False) -> Deck:
    """The punch on its block, elements of size `fine` at the rounded edge."""
    inner = 40.0 - fine_then_spread(fine, 6.0, 40.0, 1.2)[::-1]
    turn = 40.0 + np.linspace(0.0, 5.0*np.pi, round(5.0*np.pi/fine) + 1)
    outer = 40.0 + fine_then_spread(fine, 8.0, 60.0, 1.2)
    up, down = (np.concatenate([[0.0], spread(fine, 0.0, height, growth)])
                for height, growth in ((100.0, 1.25), (200.0, 1.2)))
    return _on_block(_punch(np.concatenate([inner, turn[1:]]), up, quadratic),
                     np.concatenate([inner, outer[1:]]), down, quadratic)


def coarse_punch(cells: int) -> Deck:
    """The same of even squares: `cells`, an even number, along the flat part of the face."""
    size = 40.0/cells
    turn = 40.0 + np.linspace(0.0, 5.0*np.pi, round(5.0*np.pi/size) + 1)
    even = [np.linspace(0.0, length, round(length/size) + 1) for length in (40.0, 100.0, 200.0)]
    return _on_block(_punch(np.concatenate([even[0], turn[1:]]), even[1]), even[1], even[2])


MESHES = {f.__name__: f for f in (rough_punch, nafems_punch)}
