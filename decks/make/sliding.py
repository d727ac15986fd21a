"""Decks whose bodies slide far or fold: `python decks/make/sliding.py name > deck.inp`.

Each function returns the text of a whole deck; its first comment says what to expect.
"""
from __future__ import annotations

import sys
from math import pi

import numpy as np

from lopin import mesh_make
from lopin.mesh import Mesh, together
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


def ironing(cells: int = 24, travel: float = 6.0, kind: str = "SURFACE TO SURFACE") -> str:
    """Shallow ironing (Puso and Laursen 2004, Fischer and Wriggers 2006)."""
    die = mesh_make.ring(1.5, 3.0, (max(2, cells//8), cells), angles=(180.0, 360.0))
    die = die.with_points("GRIP", lambda x: x[:, 1] > -1e-9).moved(3.0, 7.0)
    slab = mesh_make.block((12.0, 4.0), (2*cells, 2*cells//3))
    mesh = together(DIE=lean(die, "OUTER", "GRIP"), SLAB=lean(slab, "TOP", "BOTTOM"))
    return text(mesh, f"""
Shallow ironing: a half ring of radius 3 mm is pressed 1 mm into a slab and drawn {travel:g} mm along.

Neo-Hooke, die E = 6896 MPa, slab 689.6 MPa, nu = 0.32, mu = 0.3, plane strain. No closed form: the
forces must run smoothly, and their ratio lies between mu and 1.5 mu.

expect: certificate.verdict = PASS
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
0.01, 1., 1.E-5, 0.02
*BOUNDARY
DIE.GRIP, 1, 1, {travel:g}
DIE.GRIP, 2, 2, -1.
*NODE PRINT, NSET=DIE.GRIP, TOTALS=ONLY
RF
*NODE FILE, FREQUENCY=10
U
*CONTACT FILE, FREQUENCY=10
CDIS, CSTR
*END STEP
""")


def driven_rings_pressure(radii=(10.0, 30.0, 50.0), overlap: float = 0.01, young: float = 210e3,
                          poisson: float = 0.3) -> float:
    """Pressure between rings of one material, plane strain, whose other two sides do not move."""
    # u = A r + B/r, radial stress = E/(1 + nu) (A/(1 - 2 nu) - B/r^2).
    a, b, c = radii
    factor = young/(1.0 + poisson)

    def stress(r):
        return [factor/(1.0 - 2.0*poisson), -factor/r**2]

    matrix = np.zeros((4, 4))
    matrix[0, :2] = [a, 1.0/a]
    matrix[1, 2:] = [c, 1.0/c]
    matrix[2] = [*stress(b), *(-np.array(stress(b)))]
    matrix[3] = [-b, -1.0/b, b, 1.0/b]
    inner = np.linalg.solve(matrix, [0.0, 0.0, 0.0, overlap])[:2]
    return -float(np.dot(stress(b), inner))


def rotating_rings(facets: tuple[int, int] = (48, 60), mu: float = 0.0, turn: float = 90.0,
                   increments: int = 90) -> str:
    """A ring turned in its seat, which it fits too tightly by 0.01."""
    inner = mesh_make.ring(10.0, 30.01, (6, facets[0]), angles=(0.0, 360.0))
    outer = mesh_make.ring(30.0, 50.0, (6, facets[1]), angles=(0.0, 360.0))
    mesh = together(IN=lean(inner, "OUTER", "INNER"), OUT=lean(outer, "INNER", "OUTER"))
    pressure = driven_rings_pressure()
    return text(mesh, f"""
A ring turned by {turn:g} degrees in its seat, too large for it by 0.01 mm.

Radii 10, 30, 50 mm, E = 210000 MPa, nu = 0.3, plane strain; the bore and the outside are held. Lame:
pressure {pressure:.6f} MPa at every angle; moment {2.0*pi*mu*pressure*900.0:.6g} N (mu = {mu:g}).

expect: certificate.verdict = PASS
""", f"""*NODE, NSET=AXLE
90001, 0., 0.
*MATERIAL, NAME=STEEL
*ELASTIC
210000., 0.3
*SOLID SECTION, ELSET=IN, MATERIAL=STEEL
1.,
*SOLID SECTION, ELSET=OUT, MATERIAL=STEEL
1.,
*RIGID BODY, NSET=IN.INNER, REF NODE=90001
{interaction("SEAT", mu)}*CONTACT PAIR, INTERACTION=SEAT, TYPE=SURFACE TO SURFACE
IN.OUTER, OUT.INNER
*BOUNDARY
OUT.OUTER, 1, 2
AXLE, 1, 2
*STEP, NAME=FIT, NLGEOM, INC=100
*STATIC
0.5, 1.
*BOUNDARY
AXLE, 6, 6, 0.
*END STEP
*STEP, NAME=TURN, NLGEOM, INC={10*increments}
*STATIC
{1.0/increments:.10g}, 1., 1.E-6, {1.0/increments:.10g}
*BOUNDARY
AXLE, 6, 6, {turn*pi/180.0:.12g}
*NODE PRINT, NSET=AXLE
RF
*CONTACT FILE
CDIS, CSTR
*END STEP
""")


def _table(name: str, number: int, y: float, upward: bool, width: float = 99.0) -> str:
    """A flat rigid tool with its node, outside up or down."""
    way = (-width, width) if upward else (width, -width)
    return (f"*NODE, NSET={name}_REF\n{number}, 0., {y:g}\n*SURFACE, NAME={name}, TYPE=SEGMENTS\n"
            f"START, {way[0]:g}, {y:g}\nLINE, {way[1]:g}, {y:g}\n"
            f"*RIGID BODY, ANALYTICAL SURFACE={name}, REF NODE={number}\n")


def crushed_ring(cells: tuple[int, int] = (4, 64), stroke: float = 35.0) -> str:
    """Half a rubber ring crushed between plates until its inside meets itself."""
    half = mesh_make.ring(17.0, 20.0, cells, angles=(-90.0, 90.0))
    half = half.with_points("CUT", lambda x: x[:, 0] < 1e-9)
    return text(lean(half, "INNER OUTER", "CUT"), f"""
A rubber ring of radius 20 mm and thickness 3 mm crushed by {stroke:g} mm: its inside meets itself.

Neo-Hooke, C10 = 0.5 MPa, D1 = 0.02 /MPa, plane strain, half of it. Looked at: no node of the inside
passes through the other half.

expect: certificate.verdict = PASS
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

Neo-Hooke, E = 10 MPa, nu = 0.4. Looked at: the legs, 8 mm apart, lie on each other after 9 mm.

expect: certificate.verdict = PASS
""", f"""*MATERIAL, NAME=RUBBER
*HYPERELASTIC, NEO HOOKE
{neo_hooke(10.0, 0.4)}
*SOLID SECTION, ELSET=ALL, MATERIAL=RUBBER
{interaction("SMOOTH")}*CONTACT PAIR, INTERACTION=SMOOTH
INSIDE, INSIDE
*BOUNDARY
HELD, 1, 3
PRESSED, 3
*STEP, NLGEOM, INC=500
*STATIC
0.05, 1., 1.E-6, 0.05
*BOUNDARY
PRESSED, 2, 2, -9.
*NODE PRINT, NSET=PRESSED, TOTALS=ONLY
RF
*NODE FILE
U
*CONTACT FILE
CDIS, CSTR
*END STEP
""", "3d")


SCENES = {f.__name__: f for f in (ironing, rotating_rings, crushed_ring, folded_strip)}


def main(names: list[str]) -> None:
    """Print the decks of these names."""
    for name in names:
        print(SCENES[name](), end="")


if __name__ == "__main__":
    main(sys.argv[1:])
