"""Metals that flow, and rubber: problems of decks/handbook."""
from __future__ import annotations

from math import cos, exp, log, pi, sin, sqrt

import numpy as np
from handbook_mesh import (Cloud, Grid, elastic, even, gmsh_cells, graded, nset, pairs, step,
                           tetrahedra, tool)


def shell_sector(word: str, inner: float, outer: float, radial: int, round_: int) -> Grid:
    """A quarter of a section through a thick sphere: x is r, y the axis."""
    return Grid("SHELL", word, even(inner, outer, radial), even(0.0, pi/2.0, round_),
                at=lambda r, t: (r*cos(t), r*sin(t)))


def autofrettage():
    """A gun barrel put under pressure."""
    young, nu, flow, a, b, c = 200000.0, 0.4999, 300.0, 10.0, 20.0, 15.0
    load = 2.0/sqrt(3.0)*flow*(log(c/a) + 0.5*(1.0 - (c/b)**2))
    there = sqrt(3.0)/2.0*flow/young*c*c/a
    back = 1.5*load/young*a*b*b/(b*b - a*a)
    wall = Grid("WALL", "CAX8R", even(a, b, 8), even(0.0, 1.0, 1))
    deck = wall.text("LEFT BOTTOM TOP", "LEFT")
    deck += elastic("STEEL", "WALL", young, nu, f"*PLASTIC\n{flow:g}, 0.\n")
    deck += "*BOUNDARY\nWALL.BOTTOM, 2\nWALL.TOP, 2\n"
    deck += step(f"*DSLOAD\nWALL.LEFT, P, {load:.10g}", "0.1, 1.", ", NAME=PRESS")
    deck += step("*DSLOAD, OP=NEW", "0.5, 1.", ", NAME=RELEASE")
    return (f"""A thick tube put under {load:.6g} MPa until it flows to half its wall, and let
go: autofrettage.

Radii 10 and 20 mm, ends held, E = 200 GPa, elastic and plastic without change of volume (nu =
0.4999), von Mises 300 MPa. It flows as far as c = 15 mm, p = 2 Y/sqrt(3) (ln(c/a) + (1 -
c2/b2)/2); let go, all of it is elastic. Asked: what stays at the bore.""",
            "Hill (1950), The Mathematical Theory of Plasticity, chapter V", "DISPLACEMENT",
            "WALL.LEFT", 1, there - back, deck)


def shell():
    """A thick sphere under pressure, half plastic."""
    young, nu, flow, a, b, c = 210000.0, 0.3, 300.0, 10.0, 20.0, 14.0
    load = 2.0*flow*log(c/a) + 2.0/3.0*flow*(1.0 - (c/b)**3)
    grow = flow*c**3*(1.0 - nu)/(young*b*b)

    def draw(model):
        points = [model.geo.addPoint(*p, 0.0, s) for p, s in
                  (((0, 0), 2.0), ((a, 0), 2.0), ((b, 0), 3.0), ((0, b), 3.0), ((0, a), 2.0))]
        curves = [model.geo.addLine(points[1], points[2]),
                  model.geo.addCircleArc(points[2], points[0], points[3]),
                  model.geo.addLine(points[3], points[4]),
                  model.geo.addCircleArc(points[4], points[0], points[1])]
        model.geo.addPlaneSurface([model.geo.addCurveLoop(curves)])
        model.geo.synchronize()

    body = Cloud("SHELL", "CAX6", *gmsh_cells(draw, 2))
    deck = body.text({"AXIS": lambda x: abs(x[0]) < 1e-9, "MIDDLE": lambda x: abs(x[1]) < 1e-9,
                      "EQUATOR": lambda x: np.hypot(x[0] - b, x[1]) < 1e-6},
                     {"BORE": lambda x: np.hypot(*x) < a + 1e-6})
    deck += elastic("STEEL", "SHELL", young, nu, f"*PLASTIC\n{flow:g}, 0.\n")
    deck += "*BOUNDARY\nAXIS, 1\nMIDDLE, 2\n" + step(f"*DSLOAD\nBORE, P, {load:.10g}", "0.1, 1.")
    return (f"""A thick sphere under {load:.6g} MPa that flows as far as 14 mm.

Radii 10 and 20 mm, a quarter of a section, quadratic triangles of Gmsh; E = 210 GPa, nu = 0.3, 300
MPa. p = 2 Y ln(c/a) + 2/3 Y (1 - c3/b3); outside u = Y c3 (1 - nu)/(E b2).""",
            "Hill (1950), The Mathematical Theory of Plasticity, chapter V", "DISPLACEMENT",
            "EQUATOR", 1, grow, deck)


def bent_beam():
    """A beam beyond its elastic limit."""
    young, flow, high, half = 200000.0, 10.0, 4.0, 100.0
    bend = young*high**3/12.0
    load = 0.9*flow*high**2/4.0*2.0/half**2
    back = 5.0*load*(2.0*half)**4/(384.0*bend)*(1.0 + 2.4*(high/2.0/half)**2*0.8)
    beam = Grid("BEAM", "CPS8R", even(0.0, 104.0, 26), even(0.0, high, 4))
    deck = beam.text("LEFT", "BOTTOM") + nset("MIDDLE", [beam.node(0, 0)])
    deck += "*ELSET, ELSET=SPAN\n" + "".join(f"{c},\n" for c in beam.cells[:25, -1])
    deck += "*SURFACE, NAME=SPAN\nSPAN, S3\n"
    deck += elastic("STEEL", "BEAM", young, 0.0, f"*PLASTIC\n{flow:g}, 0.\n")
    deck += tool("KNIFE", (half, -10.0), "START, 99., -1.\nCIRCL, 100., 0., 100., -1.\n"
                 "CIRCL, 101., -1., 100., -1.")
    deck += pairs("BEAM.BOTTOM, KNIFE") + "*BOUNDARY\nBEAM.LEFT, 1\nKNIFE_REF, 1, 2\nKNIFE_REF, 6\n"
    deck += step(f"*DSLOAD\nSPAN, P, {load:.10g}", "0.1, 1.", ", NAME=BEND")
    deck += step(f"*DSLOAD, OP=NEW\nSPAN, P, {load/1000.0:.10g}", "0.5, 1.", ", NAME=RELEASE")
    return (f"""A beam on two supports is bent beyond its elastic limit by a uniform load and
let go.

200 x 4 x 1 mm, half of it, plane stress, E = 200 GPa, nu = 0, 10 MPa without hardening, {load:.6g}
MPa: 0.9 of the plastic moment in the middle. Let go (a thousandth of the load keeps it on its
supports) it springs back as an elastic beam, 5 q L^4/(384 EI). Stresses are small so that slopes
are.""",
            "Prager and Hodge (1951), Theory of Perfectly Plastic Solids; Timoshenko and Goodier, "
            "section 22", "SPRINGBACK", "MIDDLE", 2, back*0.999, deck)


def prandtl():
    """Prandtl's punch."""
    flow, young = 300.0, 210000.0
    ticks = graded(0.1, 1.2, 5.0, 1.35)
    block = Grid("BLOCK", "CPE4", ticks, -graded(0.1, 0.2, 3.0, 1.35)[::-1])
    near = [int(k) for k in block.cells[:10, -1]]
    deck = block.text("LEFT RIGHT BOTTOM") + f"*ELSET, ELSET=NEAR\n{', '.join(map(str, near))}\n"
    deck += "*SURFACE, NAME=NEAR\nNEAR, S3\n"
    deck += elastic("METAL", "BLOCK", young, 0.3, f"*PLASTIC\n{flow:g}, 0.\n")
    deck += tool("PUNCH", (0.0, 2.0), "START, 1., 3.\nLINE, 1., 0.\nLINE, -1., 0.")
    deck += pairs("NEAR, PUNCH") + "*BOUNDARY\nBLOCK.LEFT, 1\nBLOCK.RIGHT, 1\nBLOCK.BOTTOM, 1, 2\n"
    deck += "PUNCH_REF, 1\nPUNCH_REF, 6\n" + step("*BOUNDARY\nPUNCH_REF, 2, 2, -0.03", "0.05, 1.")
    return ("""A flat punch is pressed into metal that does not harden, plane strain: Prandtl's
limit load.

Half width 1 mm, block of 5 x 3 mm, E = 210 GPa, nu = 0.3, von Mises 300 MPa, no friction. The
punch goes 0.03 mm down: (2 + pi) k on half of it, k = 300/sqrt(3). Slip lines end within the
block.""",
            "Prandtl (1920); Hill (1950), chapter IX", "FORCE", "PUNCH_REF", 2,
            -(2.0 + pi)*flow/sqrt(3.0), deck)


def necking():
    """The largest force of a tensile test."""
    strength, n = 500.0, 0.2
    most = pi*25.0*strength*n**n*exp(-n)
    bar = Grid("BAR", "CAX4", even(0.0, 5.0, 2), even(0.0, 20.0, 4))
    deck = bar.text("LEFT BOTTOM TOP")
    deck += elastic("STEEL", "BAR", 210000.0, 0.3,
                    f"*PLASTIC, HARDENING=HOLLOMON\n{strength:g}, {n:g}\n")
    deck += "*BOUNDARY\nBAR.LEFT, 1\nBAR.BOTTOM, 2\n"
    deck += step("*BOUNDARY\nBAR.TOP, 2, 2, 7.", "0.1, 1.", ", NLGEOM")
    return ("""A round bar is drawn until its force falls: Considere's largest force.

10 mm across, 20 mm of its length, drawn by 35 %, s = 500 e^0.2 MPa. The force is largest at e = n:
A K n^n exp(-n). No imperfection: it stays a cylinder.""",
            "Considere (1885); Backofen (1972), Deformation Processing", "PEAK FORCE", "BAR.TOP", 2,
            most, deck)


def channel_die():
    """Plane-strain compression."""
    young, nu, strength, start, n, side, final = 210000.0, 0.3, 500.0, 0.01, 0.2, 10.0, 7.0
    strain = 2.0/sqrt(3.0)*log(side/final)
    flow = strength*(start + strain)**n
    for _ in range(30):  # what is elastic does not harden
        flow = strength*(start + strain - flow*(1.0 + nu)/(1.5*young))**n
    force = 2.0/sqrt(3.0)*flow*side**3/final
    body = tetrahedra("BILLET", "C3D4", *[even(0.0, side, 3)]*3)
    deck = body.text({"LEFT": lambda x: x[0] < 1e-9, "FRONT": lambda x: x[1] < 1e-9,
                      "BOTTOM": lambda x: x[2] < 1e-9},
                     {"WEST": lambda x: x[1] > side - 1e-9, "UP": lambda x: x[2] > side - 1e-9})
    deck += elastic("METAL", "BILLET", young, nu,
                    f"*PLASTIC, HARDENING=SWIFT\n{strength:g}, {start:g}, {n:g}\n")
    deck += tool("PRESS", (0.0, 0.0, 20.0), f"0., 0., {side:g}, 1., 0., {side:g}\n"
                 f"0., 1., {side:g}\n"
                 "START, -10., 0.\nLINE, 40., 0.", "CYLINDER")
    deck += tool("WALL", (0.0, 20.0, 0.0), f"0., {side:g}, 0., 1., {side:g}, 0.\n0., {side:g}, 1.\n"
                 "START, 40., 0.\nLINE, -10., 0.", "CYLINDER", 900002)
    deck += pairs("UP, PRESS\nWEST, WALL") + "*BOUNDARY\nLEFT, 1\nFRONT, 2\nBOTTOM, 3\n"
    deck += "PRESS_REF, 1, 2\nPRESS_REF, 4, 6\nWALL_REF, 1, 6\n"
    deck += step("*BOUNDARY\nPRESS_REF, 3, 3, -3.", "0.1, 1.", ", NLGEOM")
    return ("""A cube of tetrahedra is pressed by 30 % in a channel: plane strain, without
friction.

10 mm, s = 500 (0.01 + e)^0.2 MPa, E = 210 GPa, nu = 0.3; bottom, back and one side are planes of
symmetry, the press and one wall are tools. e = 2/sqrt(3) ln(h0/h), the force 2/sqrt(3) s V/h.""",
            "Ford (1948); Dieter, Mechanical Metallurgy, plane-strain compression", "FORCE",
            "PRESS_REF", 3, -force, deck)


def creep_tube():
    """A tube that creeps under pressure."""
    stiff, m, a, b, load = 200.0, 0.25, 10.0, 20.0, 100.0
    base = stiff*sqrt(3.0)**(m + 1.0)
    speed = (load*2.0*m/((2.0/sqrt(3.0))**(1.0 + m)*base*(a**(-2*m) - b**(-2*m))))**(1.0/m)
    time = 0.01/speed*a*a/10.0
    wall = Grid("WALL", "CAX4", even(a, b, 6), even(0.0, 2.0, 1))
    deck = wall.text("LEFT BOTTOM TOP", "LEFT")
    deck += f"*MATERIAL, NAME=HOT\n*VISCOPLASTIC, LAW=NORTON-HOFF, RIGID\n{stiff:g}, {m:g}\n"
    deck += "*SOLID SECTION, ELSET=WALL, MATERIAL=HOT\n*BOUNDARY\nWALL.BOTTOM, 2\nWALL.TOP, 2\n"
    deck += step(f"*DSLOAD\nWALL.LEFT, P, {load:g}", f"{time:.8g}, {time:.8g}",
                 ", AMPLITUDE=STEP")
    return (f"""A hot tube creeps under an inner pressure of 100 MPa, its ends held (Norton,
exponent 4).

Radii 10 and 20 mm; flow stress K sqrt(3)^(m+1) rate^m, K = 200, m = 0.25; {time:.5g} s. Without
change of volume the speed is C/r: p = B (2/sqrt(3))^(1+m) C^m (a^-2m - b^-2m)/(2m), and the bore
moves C t/a.""",
            "Bailey (1935); Kachanov (1971), Foundations of the Theory of Plasticity",
            "DISPLACEMENT", "WALL.LEFT", 1, speed*time/a, deck)


def balloon():
    """A thick ball of rubber, blown up."""
    a, b, stretch, c10, d1 = 1.0, 1.5, 1.5, 0.5, 2.0e-4
    outer = ((b**3 + a**3*(stretch**3 - 1.0))/b**3)**(1.0/3.0)

    def term(s):
        return (4.0*s**3 + 1.0)/(2.0*s**4)

    load = 2.0*c10*(term(outer) - term(stretch))
    body = shell_sector("CAX4", a, b, 4, 8)
    deck = body.text("BOTTOM TOP LEFT", "LEFT") + nset("EQUATOR", [body.node(0, 0)])
    deck += f"*MATERIAL, NAME=RUBBER\n*HYPERELASTIC, NEO HOOKE\n{c10:g}, {d1:g}\n"
    deck += "*SOLID SECTION, ELSET=SHELL, MATERIAL=RUBBER\n*BOUNDARY\n"
    deck += "SHELL.BOTTOM, 2\nSHELL.TOP, 1\n"
    deck += step(f"*DSLOAD\nSHELL.LEFT, P, {load:.10g}", "0.1, 1.", ", NLGEOM")
    return (f"""A thick ball of rubber blown up by {load:.6g} MPa until its bore is 1.5 times as
wide.

Radii 1 and 1.5 mm, neo-Hooke with a shear modulus of 1 MPa, nearly incompressible, a quarter of a
section. p = mu (f(outer) - f(inner)) with f(s) = (4 s^3 + 1)/(2 s^4) of the stretches.""",
            "Green and Zerna (1954), Theoretical Elasticity; Ogden (1984), section 5.3",
            "DISPLACEMENT", "EQUATOR", 1, a*(stretch - 1.0), deck)


PROBLEMS = (autofrettage, shell, bent_beam, prandtl, necking, channel_die, creep_tube, balloon)
