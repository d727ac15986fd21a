"""Decks whose bodies slide far or fold: `python decks/make/sliding.py name > deck.inp`.

Each function returns the text of a whole deck; its first comment says what to expect.
"""
from __future__ import annotations

import sys
from math import pi

import numpy as np
from deck_text import interaction, lean, neo_hooke, text

from lopin import mesh_make
from lopin.mesh import Mesh, together


def ironing(cells: int = 16, travel: float = 4.0, kind: str = "SURFACE TO SURFACE", *,
            around: int = 0) -> str:
    """Shallow ironing (Puso and Laursen 2004, Fischer and Wriggers 2006); `around`: cells of the
    die."""
    around = around or cells
    die = mesh_make.ring(1.5, 3.0, (max(2, around//8), around), angles=(180.0, 360.0))
    die = die.with_points("GRIP", lambda x: x[:, 1] > -1e-9).moved(3.0, 7.0)
    slab = mesh_make.block((12.0, 4.0), (2*cells, 2*cells//3))
    mesh = together(DIE=lean(die, "OUTER", "GRIP"), SLAB=lean(slab, "TOP", "BOTTOM"))
    return text(mesh, f"""
Shallow ironing: a half ring of radius 3 mm is pressed 1 mm into a slab and drawn {travel:g} mm along.

Neo-Hooke, die E = 6896 MPa, slab 689.6 MPa, nu = 0.32, mu = 0.3, plane strain. No closed form: the
forces must run smoothly, and their ratio lies between mu and 1.5 mu. By mortar they ripple by 0.3 %
(down) and 1.4 % (along), with a mesh 1.5 times as fine by 0.2 % and 0.8 %.

expect: certificate.verdict = PASS
expect: history.DIE.OUTER-SLAB.TOP.force1 at 1.8 = -226 +- 3 %
expect: history.DIE.OUTER-SLAB.TOP.force2 at 1.8 = 742 +- 2 %
expect: history.DIE.OUTER-SLAB.TOP.max_penetration < 1e-9
""", f"""*MATERIAL, NAME=HARD
*HYPERELASTIC, NEO HOOKE
{neo_hooke(6896.0, 0.32)}
*MATERIAL, NAME=SOFT
*HYPERELASTIC, NEO HOOKE
{neo_hooke(689.6, 0.32)}
*SOLID SECTION, ELSET=DIE, MATERIAL=HARD
1.,
*SOLID SECTION, ELSET=SLAB, MATERIAL=SOFT
1.,
{interaction("DRY", 0.3)}*CONTACT PAIR, INTERACTION=DRY, TYPE={kind}
DIE.OUTER, SLAB.TOP
*BOUNDARY
SLAB.BOTTOM, 1, 2
*STEP, NAME=PRESS, NLGEOM, INC=500
*STATIC
0.1, 1., 1.E-5, 0.1
*BOUNDARY
DIE.GRIP, 1, 1, 0.
DIE.GRIP, 2, 2, -1.
*NODE PRINT, NSET=DIE.GRIP, TOTALS=ONLY
RF
*END STEP
*STEP, NAME=DRAW, NLGEOM, INC=2000
*STATIC
0.05, 1., 1.E-5, 0.05
*BOUNDARY
DIE.GRIP, 1, 1, {travel:g}
DIE.GRIP, 2, 2, -1.
*NODE PRINT, NSET=DIE.GRIP, TOTALS=ONLY
RF
*NODE FILE, FREQUENCY=5
U
*EL FILE, FREQUENCY=5
S
*CONTACT FILE, FREQUENCY=5
CDIS, CSTR
*END STEP
""")


def fitted_rings_pressure(radii=(10.0, 30.0, 50.0), overlap: float = 0.01, young: float = 210e3,
                          poisson: float = 0.3) -> tuple[float, float]:
    """Pressure between rings of one material, plane strain, and what the bore moves outwards
    (Lame)."""
    a, b, c = radii
    modulus = young/(1.0 - poisson**2)
    give = b/modulus*((c*c + b*b)/(c*c - b*b) + (b*b + a*a)/(b*b - a*a))
    pressure = overlap/give
    return pressure, -2.0*pressure*a*b*b/(modulus*(b*b - a*a))


def rotating_rings(facets: int = 48, mu: float = 0.0, turn: float = 90.0, increments: int = 90,
                   smooth: str = "YES") -> str:
    """A shaft turned in its hub, which it fits too tightly by 0.01."""
    shaft = mesh_make.ring(10.0, 30.01, (4, facets), angles=(1.3, 361.3))
    hub = mesh_make.ring(30.0, 50.0, (4, facets), angles=(0.0, 360.0))
    mesh = together(SHAFT=lean(shaft, "OUTER", "INNER"), HUB=lean(hub, "INNER", "OUTER"))
    pressure, bore = fitted_rings_pressure()
    angle = np.radians(turn)*np.arange(increments + 1)/increments
    tables, fitted, turned, held = [], [], [], []
    for quarter in range(4):
        start = np.radians(1.3) + quarter*pi/2.0
        node = 1 + _nearest(mesh, 10.0*np.array([np.cos(start), np.sin(start)]))
        outside = 1 + _nearest(mesh,
                               50.0*np.array([np.cos(quarter*pi/2.0), np.sin(quarter*pi/2.0)]))
        held.append(f"{outside}, {2 - quarter % 2}")
        for d, wave in ((1, np.cos), (2, np.sin)):
            way = (10.0 + bore)*wave(start + angle) - 10.0*wave(start)
            fitted.append(f"{node}, {d}, {d}, {way[0]:.12g}")
            pairs = [f"{t:.10g}, {w:.12g}" for t, w in zip(np.linspace(0.0, 1.0, len(way)), way,
                                                           strict=True)]
            rows = [", ".join(pairs[k:k + 4]) for k in range(0, len(pairs), 4)]
            tables.append("\n".join([f"*AMPLITUDE, NAME=WAY{node}_{d}", *rows]))
            turned.append(f"*BOUNDARY, AMPLITUDE=WAY{node}_{d}\n{node}, {d}, {d}, 1.")
    return text(mesh, f"""
A shaft turned by {turn:g} degrees in its hub, too large for it by 0.01 mm.

Radii 10, 30, 50 mm, E = 210000 MPa, nu = 0.3, plane strain. Lame: pressure {pressure:.6f} MPa at every
angle, moment 0 (mu = {mu:g}). {facets} linear facets on both sides: straight, they stand off the circle by
0.064 mm, six times the interference, and the pressure ripples from 1.7 to 8 times Lame's. SMOOTH=YES
curves them by their averaged normals. The shaft is led by four nodes of its bore, {turn/increments:g} degree an
increment; their radius is Lame's, so that they need no force.

expect: certificate.verdict = PASS
expect: contact.0.max_pressure = {pressure:.6f} +- 0.5 %
expect: history.SHAFT.OUTER-HUB.INNER.max_pressure at 1 = {pressure:.6f} +- 0.5 %
expect: history.SHAFT.OUTER-HUB.INNER.max_pressure at 1.5 = {pressure:.6f} +- 0.5 %
expect: history.SHAFT.OUTER-HUB.INNER.area at 1.5 = 188.5 +- 0.5 %
""", f"""*MATERIAL, NAME=STEEL
*ELASTIC
210000., 0.3
*SOLID SECTION, ELSET=SHAFT, MATERIAL=STEEL
1.,
*SOLID SECTION, ELSET=HUB, MATERIAL=STEEL
1.,
{interaction("SEAT", mu)}*CONTACT PAIR, INTERACTION=SEAT, SMOOTH={smooth}
SHAFT.OUTER, HUB.INNER
{chr(10).join(tables)}
*BOUNDARY
{chr(10).join(held)}
*STEP, NAME=FIT, NLGEOM, INC=100
*STATIC
1., 1.
*BOUNDARY
{chr(10).join(fitted)}
*END STEP
*STEP, NAME=TURN, NLGEOM, INC={10*increments}
*STATIC, DIRECT
{1.0/increments:.12g}, 1.
{chr(10).join(turned)}
*NODE FILE, FREQUENCY=15
U
*EL FILE, FREQUENCY=15
S
*CONTACT FILE, FREQUENCY=15
CDIS, CSTR
*END STEP
""")


def _nearest(mesh: Mesh, place) -> int:
    """The point nearest to a place."""
    return int(np.argmin(((mesh.points - place)**2).sum(axis=1)))


def _table(name: str, number: int, y: float, upward: bool, width: float = 99.0) -> str:
    """A flat rigid tool with its node, outside up or down."""
    way = (-width, width) if upward else (width, -width)
    return (f"*NODE, NSET={name}_REF\n{number}, 0., {y:g}\n*SURFACE, NAME={name}, TYPE=SEGMENTS\n"
            f"START, {way[0]:g}, {y:g}\nLINE, {way[1]:g}, {y:g}\n"
            f"*RIGID BODY, ANALYTICAL SURFACE={name}, REF NODE={number}\n")


def crushed_ring(cells: tuple[int, int] = (3, 96), stroke: float = 35.0) -> str:
    """Half a rubber ring crushed between plates until its inside meets itself."""
    half = mesh_make.ring(17.0, 20.0, cells, angles=(-90.0, 90.0))
    half = half.with_points("CUT", lambda x: x[:, 0] < 1e-9)
    return text(lean(half, "INNER OUTER", "CUT"), f"""
A rubber ring of radius 20 mm and thickness 3 mm crushed by {stroke:g} mm: its inside meets itself.

Neo-Hooke, C10 = 0.5 MPa, D1 = 0.02 /MPa, plane strain, half of it, no friction. No closed form: no node
of the inside passes through the other half, both plates feel the same force, and one layer on the
other they leave 5 mm of the 6. At the end a corner of the outside is nearly flat (W0531). The force is the
same to .01 % with increments of .01 to .04; by some of these, meshes of 4 x 64, 4 x 80 and 6 x 96 cells do
not reach the end: a corner folds, or the ring gives way to one side.

expect: certificate.verdict = PASS
expect: history.INNER-INNER.closed > 20
expect: history.INNER-INNER.max_penetration < 1e-9
expect: history.PRESS.rf2 = -24.94 +- 0.5 %
expect: history.FLOOR.rf2 = 24.94 +- 0.5 %
""", f"""*MATERIAL, NAME=RUBBER
*HYPERELASTIC, NEO HOOKE
0.5, 0.02
*SOLID SECTION, ELSET=ALL, MATERIAL=RUBBER
1.,
{_table("FLOOR", 90001, -20.0, True)}{_table("PRESS", 90002, 20.0, False)}{interaction("SMOOTH")}\
*CONTACT PAIR, INTERACTION=SMOOTH
OUTER, FLOOR
*CONTACT PAIR, INTERACTION=SMOOTH
OUTER, PRESS
*CONTACT PAIR, INTERACTION=SMOOTH
INNER, INNER
*BOUNDARY
CUT, 1
FLOOR_REF, 1, 2
FLOOR_REF, 6
PRESS_REF, 1
PRESS_REF, 6
*STEP, NLGEOM, INC=2000
*STATIC
0.02, 1., 1.E-6, 0.02
*BOUNDARY
PRESS_REF, 2, 2, -{stroke:g}
*NODE PRINT, NSET=PRESS_REF
RF
*NODE FILE, FREQUENCY=5
U
*EL FILE, FREQUENCY=5
S
*CONTACT FILE, FREQUENCY=5
CDIS, CSTR
*END STEP
""")


def folded_strip(cells: tuple[int, int, int, int] = (2, 16, 10, 4)) -> str:
    """A strip bent to a U in space whose legs are pressed together: (thick, round, leg, wide)."""
    thick, turn, leg, wide = cells
    bend = mesh_make.ring(4.0, 6.0, (thick, turn), angles=(90.0, 270.0))
    up = mesh_make.block((20.0, 2.0), (leg, thick), origin=(0.0, 4.0))
    low = mesh_make.block((20.0, 2.0), (leg, thick), origin=(0.0, -6.0))
    pieces = together(A=lean(bend, "INNER"), B=lean(up, "BOTTOM"), C=lean(low, "TOP"))
    inside = np.concatenate([pieces.surfaces[k] for k in ("A.INNER", "B.BOTTOM", "C.TOP")])
    plane = pieces.replaced(surfaces={"INSIDE": inside}, point_sets={}, element_sets={})
    mesh = mesh_make.extruded(mesh_make.merged(plane), 6.0, wide)
    mesh = mesh.with_points("PRESSED", lambda x: (x[:, 1] > 6.0 - 1e-6) & (x[:, 0] > 14.0))
    mesh = mesh.with_points("HELD", lambda x: (x[:, 1] < -6.0 + 1e-6) & (x[:, 0] > 14.0))
    return text(lean(mesh, "INSIDE", "PRESSED HELD"), """
A strip bent to a U, 2 mm thick and 6 mm wide, whose legs are pressed together until they meet.

Neo-Hooke, E = 10 MPa, nu = 0.4, half a millimetre more than the 8 mm between the legs. No closed form:
the fifteen nodes of the pressed patch close, none passes through, and both faces of the strip move
alike. The outer faces of both ends are held along the legs: free to slide, the legs slip
off each other sideways at .89 of the way (they are squeezed, without friction).

expect: certificate.verdict = PASS
expect: history.INSIDE-INSIDE.closed = 15
expect: history.INSIDE-INSIDE.max_penetration < 1e-9
""", f"""*MATERIAL, NAME=RUBBER
*HYPERELASTIC, NEO HOOKE
{neo_hooke(10.0, 0.4)}
*SOLID SECTION, ELSET=ALL, MATERIAL=RUBBER
{interaction("SMOOTH")}*CONTACT PAIR, INTERACTION=SMOOTH
INSIDE, INSIDE
*BOUNDARY
HELD, 1, 3
PRESSED, 1
PRESSED, 3
*STEP, NLGEOM, INC=500
*STATIC
0.05, 1., 1.E-6, 0.05
*BOUNDARY
PRESSED, 2, 2, -8.5
*NODE PRINT, NSET=PRESSED, TOTALS=ONLY
RF
*NODE FILE
U
*CONTACT FILE
CDIS, CSTR
*END STEP
""", "3d")


def beam_over_corner(cells: tuple[int, int] = (80, 2), push: float = 60.0,
                     quadratic: bool = True) -> str:
    """A cantilever whose end is pushed down over a sharp corner under its middle."""
    beam = mesh_make.block((200.0, 2.0), cells, quadratic=quadratic)
    beam = beam.with_points("END", lambda x: np.hypot(x[:, 0] - 200.0, x[:, 1] - 2.0) < 1e-6)
    anvil = mesh_make.block((10.0, 10.0), (1, 1), origin=(90.0, -10.0))
    anvil = anvil.with_points("EDGE", lambda x: np.hypot(x[:, 0] - 100.0, x[:, 1]) < 1e-6)
    anvil = anvil.with_points("ALL", lambda x: x[:, 0] > 0.0)
    mesh = together(BEAM=lean(beam, "BOTTOM", "LEFT END"), ANVIL=lean(anvil, "", "EDGE ALL"))
    return text(mesh, f"""
A cantilever 200 mm long and 2 mm thick is pushed {push:g} mm down at its end over a sharp corner.

E = 210000 MPa, nu = 0.3, plane strain, no friction. The corner, at mid-span, is a node; the beam is the
master, so that the force is square to the beam, not to the corner's sides. No closed form: forces and
moments of clamp, corner and end balance to rounding (a test), and the force leans as the beam does.

expect: certificate.verdict = PASS
expect: history.EDGE-BEAM.BOTTOM.closed = 1
expect: history.EDGE-BEAM.BOTTOM.max_penetration < 1e-9
""", f"""*MATERIAL, NAME=STEEL
*ELASTIC
210000., 0.3
*SOLID SECTION, ELSET=BEAM, MATERIAL=STEEL
1.,
*SOLID SECTION, ELSET=ANVIL, MATERIAL=STEEL
1.,
*SURFACE, NAME=EDGE, TYPE=NODE
ANVIL.EDGE, 1.
{interaction("SMOOTH")}*CONTACT PAIR, INTERACTION=SMOOTH
EDGE, BEAM.BOTTOM
*BOUNDARY
BEAM.LEFT, 1, 2
ANVIL.ALL, 1, 2
*STEP, NLGEOM, INC=200
*STATIC
0.05, 1., 1.E-5, 0.05
*BOUNDARY
BEAM.END, 2, 2, -{push:g}
*NODE PRINT, NSET=BEAM.END
RF
*NODE FILE, FREQUENCY=20
U
*EL FILE, FREQUENCY=20
S
*CONTACT FILE, FREQUENCY=20
CDIS, CSTR
*END STEP
""")


def sliding_ball(cells: tuple[int, int, int] = (14, 5, 3), travel: float = 1.0) -> str:
    """A ball of triangles pressed into a block and drawn along it; half of both."""
    block = mesh_make.block((4.2, 1.5, 1.2), cells, origin=(-1.6, 0.0, -1.2))
    return text(lean(block, "TOP", "BOTTOM FRONT"), f"""
A rigid ball from an STL file is pressed into a block and drawn {travel:g} mm along it with friction.

R = 50 mm, E = 20000 MPa, nu = 0.3, mu = 0.2, half of it: y = 0 is a plane of symmetry. The block is 1.2 mm
thick on a fixed base. No closed form but Coulomb's: once all slips, drag over load is mu but for the
lean of the ball where it touches, which is at most 1 degree and cancels; 140.7 over 703.2 N half way. A block twice
as fine has 694 N, and meshes go to 691 N.

expect: certificate.verdict = PASS
expect: history.TOP-BALL.force1 at 1.5 = 140.69 +- 0.5 %
expect: history.TOP-BALL.force3 at 1.5 = -703.2 +- 0.5 %
expect: history.TOP-BALL.closed at 1.5 = 35 +- 1
""", f"""*MATERIAL, NAME=BLOCK
*ELASTIC
20000., 0.3
*SOLID SECTION, ELSET=ALL, MATERIAL=BLOCK
*NODE, NSET=BALL_REF
900001, 0., 0., 50.
*SURFACE, NAME=BALL, TYPE=STL, INPUT=ball_of_facets.stl
*RIGID BODY, ANALYTICAL SURFACE=BALL, REF NODE=BALL_REF
*SURFACE INTERACTION, NAME=DRY
*SURFACE BEHAVIOR, PENALTY
4.e6,
*FRICTION
0.2,
*CONTACT PAIR, INTERACTION=DRY
TOP, BALL
*BOUNDARY
BOTTOM, 1, 3
FRONT, 2
BALL_REF, 2
BALL_REF, 4, 6
*STEP, NAME=PRESS, NLGEOM, INC=200
*STATIC
0.5, 1.
*BOUNDARY
BALL_REF, 1, 1, 0.
BALL_REF, 3, 3, -0.02
*END STEP
*STEP, NAME=DRAW, NLGEOM, INC=1000
*STATIC
0.1, 1., 1.E-5, 0.1
*BOUNDARY
BALL_REF, 1, 1, {travel:g}
BALL_REF, 3, 3, -0.02
*NODE PRINT, NSET=BALL_REF
RF
*NODE FILE, FREQUENCY=5
U
*EL FILE, FREQUENCY=5
S
*CONTACT FILE, FREQUENCY=5
CDIS, CSTR
*END STEP
""", "3d")


SCENES = {f.__name__: f for f in (ironing, rotating_rings, crushed_ring, folded_strip,
                                beam_over_corner, sliding_ball)}


def main(names: list[str]) -> None:
    """Print the decks of these names."""
    for name in names:
        print(SCENES[name](), end="")


if __name__ == "__main__":
    main(sys.argv[1:])
