"""Decks of bulk forming: `python decks/make/forging.py name > deck.inp`.

Each function returns the text of a whole deck; its first comment says what to expect.
"""
from __future__ import annotations

import sys
from math import hypot, pi, tan

import numpy as np
from deck_text import lean, text

from lopin import mesh_make
from lopin.mesh import together


#: The upper half of the closed die, closed: corners (r, z) and their fillets [mm].
CLOSED_DIE = [(40.0, 5.0, 0.0), (27.5, 5.0, 0.0), (26.5, 1.0, 0.5), (20.0, 1.0, 1.5),
              (20.0 - 6.0*tan(20.0*pi/180.0), 7.0, 2.0), (-1.0, 7.0, 0.0)]


def segments(name: str, corners: list[tuple[float, float, float]]) -> str:
    """A rigid profile through corners (r, z, fillet radius); the material is on its left."""
    lines = [f"*SURFACE, NAME={name}, TYPE=SEGMENTS",
             f"START, {corners[0][0]:.9g}, {corners[0][1]:.9g}"]
    for before, (r, z, fillet), after in zip(corners, corners[1:], corners[2:]):
        if fillet == 0.0:
            lines.append(f"LINE, {r:.9g}, {z:.9g}")
            continue
        a, b = direction((r, z), before), direction((r, z), after)
        bisector = direction((0.0, 0.0), (a[0] + b[0], a[1] + b[1]))
        half = a[0]*bisector[0] + a[1]*bisector[1]           # cosine of half the corner
        sine = (1.0 - half**2)**0.5
        foot, centre = fillet*half/sine, fillet/sine
        lines.append(f"LINE, {r + foot*a[0]:.9g}, {z + foot*a[1]:.9g}")
        lines.append(f"CIRCL, {r + foot*b[0]:.9g}, {z + foot*b[1]:.9g}, "
                     f"{r + centre*bisector[0]:.9g}, {z + centre*bisector[1]:.9g}")
    lines.append(f"LINE, {corners[-1][0]:.9g}, {corners[-1][1]:.9g}")
    return "\n".join(lines) + "\n"


def direction(start, end) -> tuple[float, float]:
    """Unit vector from one point to another."""
    x, y = end[0] - start[0], end[1] - start[1]
    return x/hypot(x, y), y/hypot(x, y)


def hot_disc(comment: str, cells: int, stroke: float, stop: float, card: str = "") -> str:
    """A disc between two equal dies that come together by `stroke`; they stop before, at `stop`."""
    billet = mesh_make.block((15.0, 12.0), (cells, round(0.8*cells)))
    skin = np.concatenate([billet.surfaces["TOP"], billet.surfaces["RIGHT"]])
    billet = billet.replaced(surfaces={"SKIN": skin})
    mesh = together(BILLET=lean(billet, "SKIN", "LEFT BOTTOM"))
    return text(mesh, comment, f"""*MATERIAL, NAME=HOT
*ELASTIC
150000., 0.3
*VISCOPLASTIC, LAW=NORTON-HOFF
50., 0.15
*SOLID SECTION, ELSET=BILLET, MATERIAL=HOT
*NODE, NSET=DIE_REF
900001, 0., 20.
{segments("DIE", [(r, z + stroke, f) for r, z, f in CLOSED_DIE])}*RIGID BODY, ANALYTICAL SURFACE=DIE, REF NODE=DIE_REF
*SURFACE INTERACTION, NAME=GRAPHITE
*SURFACE BEHAVIOR, DIRECT
*FRICTION
0.1,
*CONTACT PAIR, INTERACTION=GRAPHITE
BILLET.SKIN, DIE
*BOUNDARY
BILLET.LEFT, 1
BILLET.BOTTOM, 2
DIE_REF, 1
DIE_REF, 6
{card}*STEP, NAME=FORGE, NLGEOM, INC=1000
*STATIC
0.001, {stop/50.0:g}, 1.E-6, 0.002
*BOUNDARY, TYPE=VELOCITY
DIE_REF, 2, 2, -50.
*OUTPUT, FIELD, FREQUENCY=10
*NODE OUTPUT
U
*ELEMENT OUTPUT
S, PEEQ
*END STEP
""", "axisymmetric")


def closed_die(cells: int = 24, stroke: float = 5.0, short: float = 0.05) -> str:
    """A disc with a hub-less web and a flash, forged between two equal dies that stop short of closing."""
    return hot_disc("""
A hot disc forged in a closed die with a flash; the press comes down at 50 mm/s.

The billet is 30 mm across and 24 mm high (one half by symmetry), Norton-Hoff: sqrt(3)^(m+1) K rate^m with
K = 50 MPa s^m, m = 0.15, E = 150000 MPa, mu = 0.1. It is upset until it meets the wall of the cavity (near
4 mm), fills it, and flows out into a flash of 2 mm: the force is more than three times that at the wall.
The press stops 0.05 mm short: there a corner of the mesh at the end of the flash turns inside out.
No closed form: volume, energies and penetration are what can be held to.

expect: certificate.verdict = PASS
expect: certificate.energy < 0.01
expect: history.DIE.rf2 < -471.e3
expect: history.volume = 8482.3 +- 0.6 %
expect: history.BILLET.SKIN-DIE.max_penetration < 1e-9
""", cells, stroke, stroke - short)


def full_flash(cells: int = 16, stop: float = 5.3) -> str:
    """The same disc beyond what one mesh can do: it is made anew on the way."""
    return hot_disc("""
The hot disc of closed_die pressed on, into a thin flash: its mesh is made anew whenever it is worn.

On one mesh the run ends at 5.0 mm with a corner turned inside out (cells of 0.5 mm). Here the mesh begins with
cells of 0.9 mm and is made anew five to seven times: two cells across the flash, eight around the
arcs of the die, the state carried over, volume kept to 1e-14. The force at 4.95 and 5.0 mm is within 2 % of one
mesh of 0.35 mm, at 5.3 mm other cells of the start give 1468 to 1479 kN. At the first remesh the die's arc, which
the coarse cells had cut short, is met as it is: the force changes by about 1 %, from which on the verdict is WARN.
Run by the command of the Python package (docs/remeshing.md).

expect: certificate.verdict = PASS|WARN
expect: history.DIE.rf2 = -1473.e3 +- 1 %
expect: history.BILLET.SKIN-DIE.max_penetration < 1e-9
""", cells, 5.0, stop, "*REMESH, ELSET=BILLET, SIZE=0.8, SMALLEST=0.15, STRAIN=1.\n")


def elastic_anvil(cells: int = 16, reduction: float = 0.6,
                  card: str = "*REMESH, ELSET=BILLET, SIZE=0.8, SMALLEST=0.2, STRAIN=0.4\n") -> str:
    """A cold disc upset on an anvil that deforms: one body is meshed anew, the other one stays."""
    billet = mesh_make.block((10.0, 12.0), (cells, round(1.2*cells)))
    skin = np.concatenate([billet.surfaces[side] for side in ("TOP", "RIGHT", "BOTTOM")])
    billet = billet.replaced(surfaces={"SKIN": skin})
    anvil = mesh_make.block((30.0, 20.0), (40, 20))
    anvil = anvil.replaced(points=anvil.points - [0.0, 20.0])
    mesh = together(BILLET=lean(billet, "SKIN", "LEFT"), ANVIL=lean(anvil, "TOP", "LEFT BOTTOM"))
    return text(mesh, f"""
A cold disc upset by {100*reduction:g} % on an elastic anvil: the mesh of the disc is made anew, that of the anvil stays.

Radius 10 mm, height 12 mm, E = 210000 MPa, yield stress 400 + 500 eps^0.3 MPa (a table), mu = 0.1; the ram is
rigid, the anvil steel of 60 mm across that is held at its foot and gives way under the disc. Each part of the run
has the anvil where it was, with its displacements (*START); what the disc presses, friction included, goes on.
On one mesh of cells of 0.5 mm, of which a corner turns over at the end, the ram needs 832 kN. At a remesh metal
without rate loses 1 to 2 % of its force, from which on the verdict is WARN, and is back on its curve after a per
cent of strain. Run by the command of the Python package (docs/remeshing.md).

expect: certificate.verdict = PASS|WARN
expect: certificate.energy < 0.01
expect: history.RAM.rf2 = -830.e3 +- 1 %
""", f"""*MATERIAL, NAME=COLD
*ELASTIC
210000., 0.3
*PLASTIC
{chr(10).join(f"{400.0 + 500.0*e**0.3:.6g}, {e:g}" for e in (0.0, 0.01, 0.03, 0.1, 0.2, 0.4, 0.7, 1.0, 1.5, 2.5, 4.0))}
*MATERIAL, NAME=STEEL
*ELASTIC
210000., 0.3
*SOLID SECTION, ELSET=BILLET, MATERIAL=COLD
*SOLID SECTION, ELSET=ANVIL, MATERIAL=STEEL
*NODE, NSET=RAM_REF
900001, 0., 30.
*SURFACE, NAME=RAM, TYPE=SEGMENTS
START, 40., 12.
LINE, -1., 12.
*RIGID BODY, ANALYTICAL SURFACE=RAM, REF NODE=RAM_REF
*SURFACE INTERACTION, NAME=OILED
*SURFACE BEHAVIOR, DIRECT
*FRICTION
0.1,
*CONTACT PAIR, INTERACTION=OILED
BILLET.SKIN, RAM
*CONTACT PAIR, INTERACTION=OILED
BILLET.SKIN, ANVIL.TOP
*BOUNDARY
BILLET.LEFT, 1
ANVIL.LEFT, 1
ANVIL.BOTTOM, 2
RAM_REF, 1
RAM_REF, 6
{card}*STEP, NAME=UPSET, NLGEOM, INC=1000
*STATIC
0.01, 1., 1.E-6, 0.025
*BOUNDARY
RAM_REF, 2, 2, {-12.0*reduction:g}
*OUTPUT, FIELD, FREQUENCY=10
*NODE OUTPUT
U
*ELEMENT OUTPUT
S, PEEQ
*END STEP
""", "axisymmetric")


def upset_tetra(cells: tuple[int, int] = (4, 6), share: float = 0.4) -> str:
    """A quarter of a billet of linear tetrahedra, upset by a plate from an STL file."""
    billet = mesh_make.simplices(mesh_make.cylinder(10.0, 15.0, cells, part="quarter"))
    skin = np.concatenate([billet.surfaces["TOP"], billet.surfaces["ARC"]])
    billet = billet.replaced(surfaces={"SKIN": skin})
    mesh = together(BILLET=lean(billet, "SKIN", "LEFT BACK BOTTOM"))
    return text(mesh, f"""
A billet of linear tetrahedra upset by {100*share:g} % between flat dies that come from an STL file.

Radius 10 mm, height 30 mm, a quarter of its upper half; E = 200000 MPa, yield stress 700 + 300 eps MPa,
mu = 0.1. The same billet of fine axisymmetric quads needs 456 kN, a quarter of it 114 kN: tetrahedra that
share their volume in patches are within 2 % of it, where plain ones lock. The side rolls onto the die.

expect: certificate.verdict = PASS
expect: history.DIE.rf3 = -114.e3 +- 2 %
expect: history.BILLET.SKIN-DIE.max_penetration < 1e-9
""", f"""*MATERIAL, NAME=STEEL
*ELASTIC
200000., 0.3
*PLASTIC
700., 0.
1300., 2.
*SOLID SECTION, ELSET=BILLET, MATERIAL=STEEL
*NODE, NSET=DIE_REF
900001, 0., 0., 20.
*SURFACE, NAME=DIE, TYPE=STL, INPUT=die_plate.stl
*RIGID BODY, ANALYTICAL SURFACE=DIE, REF NODE=DIE_REF
*SURFACE INTERACTION, NAME=OILED
*SURFACE BEHAVIOR, DIRECT
*FRICTION
0.1,
*CONTACT PAIR, INTERACTION=OILED
BILLET.SKIN, DIE
*BOUNDARY
BILLET.LEFT, 1
BILLET.BACK, 2
BILLET.BOTTOM, 3
DIE_REF, 1, 2
DIE_REF, 4, 6
*STEP, NAME=UPSET, NLGEOM, INC=1000
*STATIC
0.02, 1., 1.E-5, 0.05
*BOUNDARY
DIE_REF, 3, 3, {-15.0*share:g}
*OUTPUT, FIELD, FREQUENCY=10
*NODE OUTPUT
U
*ELEMENT OUTPUT
S, PEEQ
*END STEP
""", "3d")


SCENES = {f.__name__: f for f in (closed_die, full_flash, elastic_anvil, upset_tetra)}


if __name__ == "__main__":
    for scene in sys.argv[1:]:
        print(SCENES[scene](), end="")
