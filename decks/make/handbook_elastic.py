"""Elastic contact: problems of decks/handbook with a closed form."""
from __future__ import annotations

from math import cos, log, pi, radians, sin, sqrt, tan

import numpy as np
from handbook_mesh import Cloud, Grid, elastic, even, gmsh_cells, graded, nset, pairs, step, tool



def cone():
    """A rigid cone on a half-space."""
    young, nu, slope, radius, end = 1000.0, 0.49, tan(radians(2.0)), 1.0, 40.0
    mean = young/(1.0 - nu**2)*slope/2.0
    force = mean*pi*radius**2
    ticks = graded(0.125, 1.25, end, 1.5)
    block = Grid("BLOCK", "CAX4", ticks, -ticks[::-1])
    near = [int(k) for k in block.cells[:11, -1]]
    deck = block.text("LEFT BOTTOM") + "*ELSET, ELSET=NEAR\n" + ", ".join(map(str, near)) + "\n"
    deck += "*SURFACE, NAME=NEAR\nNEAR, S3\n" + elastic("BODY", "BLOCK", young, nu)
    deck += tool("CONE", (0.0, 5.0), f"START, 40., {40*slope:.10g}\nLINE, 0., 0.")
    deck += pairs("NEAR, CONE") + "*BOUNDARY\nBLOCK.LEFT, 1\nBLOCK.BOTTOM, 1, 2\nCONE_REF, 1\n"
    deck += "CONE_REF, 6\n" + step(f"*CLOAD\nCONE_REF, 2, {-force:.10g}")
    return (f"""A rigid cone pressed by {force:.4g} N into an elastic half-space, axisymmetric.

Its flank makes 2 degrees with the surface; E = 1000 MPa, nu = 0.49. Sneddon: contact radius a = 1
mm, p = (E*/2) tan 2 acosh(a/r), infinite at the tip; root of the integral of p^2: pm a sqrt(2 pi
ln 2). The block is 40 a wide and deep; with the force given its size hardly matters to the
pressure.""",
            "Sneddon (1965), Int. J. Engng Sci. 3; Johnson (1985), Contact Mechanics, section 5.2",
            "PRESSURE", "", 0, mean*radius*sqrt(2.0*pi*log(2.0)), deck)


def wavy():
    """A wavy surface on a flat."""
    young, nu, wave, high, share = 210000.0, 0.3, 10.0, 0.01, 0.25
    psi = pi*share
    mean = pi*young/(1.0 - nu**2)*high/wave*sin(psi)**2
    down = 1.5*wave*(graded(0.06, 0.3, 1.0, 1.3))

    def at(x, y):
        return x, y + high*(1.0 - cos(2.0*pi*x/wave))*(1.0 - y/(1.5*wave))

    body = Grid("BODY", "CPE4", even(0.0, wave/2.0, 16), down, at=at)
    deck = body.text("LEFT RIGHT", "BOTTOM TOP") + elastic("STEEL", "BODY", young, nu)
    deck += tool("FLAT", (0.0, -1.0), "START, -5., 0.\nLINE, 15., 0.")
    deck += pairs("BODY.BOTTOM, FLAT") + "*BOUNDARY\nBODY.LEFT, 1\nBODY.RIGHT, 1\n"
    deck += "FLAT_REF, 1, 2\nFLAT_REF, 6\n" + step(f"*DSLOAD\nBODY.TOP, P, {mean:.10g}")
    return ("""A wavy surface pressed on a rigid flat until half of it touches, plane strain.

Waves 10 mm long, 0.01 mm high to either side, E = 210 GPa, nu = 0.3; half a wave between planes of
symmetry, 15 mm deep. Westergaard: mean pressure pi E* h/l sin^2(pi a/l) with the contact 2 a =
l/2, and 2 pm/sin(pi a/l) on the crest. Nothing but the contact holds the body up.""",
            "Westergaard (1939), J. Appl. Mech. 6; Johnson (1985), section 13.2",
            "PEAK PRESSURE", "", 0, 2.0*mean/sin(psi), deck)


def roller():
    """A roller between two plates."""
    young, nu, radius, half = 210000.0, 0.3, 10.0, 0.3
    modulus = young/(1.0 - nu**2)
    force = pi*modulus*half**2/(4.0*radius)
    approach = force/(pi*modulus)*(2.0*log(4.0*radius/half) - 1.0)

    def draw(model):
        points = [model.geo.addPoint(*p, 0.0, s) for p, s in
                  (((0, 0), 2.5), ((radius, 0), 2.5), ((0, radius), 0.06),
                   ((radius*sin(0.06), radius*cos(0.06)), 0.06))]
        center, right, top, edge = points
        curves = [model.geo.addLine(center, right), model.geo.addCircleArc(right, center, edge),
                  model.geo.addCircleArc(edge, center, top), model.geo.addLine(top, center)]
        model.geo.addPlaneSurface([model.geo.addCurveLoop(curves)])
        model.geo.synchronize()

    body = Cloud("ROLLER", "CPE3", *gmsh_cells(draw, 1))
    deck = body.text({"AXIS": lambda x: abs(x[0]) < 1e-9, "MIDDLE": lambda x: abs(x[1]) < 1e-9},
                     {"TOP": lambda x: np.hypot(*x) > radius - 1e-6 and x[0] < 1.0})
    deck += elastic("STEEL", "ROLLER", young, nu)
    deck += tool("PLATE", (0.0, 12.0), "START, 15., 10.\nLINE, -5., 10.")
    deck += pairs("TOP, PLATE") + "*BOUNDARY\nAXIS, 1\nMIDDLE, 2\nPLATE_REF, 1\nPLATE_REF, 6\n"
    deck += step(f"*CLOAD\nPLATE_REF, 2, {-force/2.0:.10g}")
    return (f"""A roller pressed between two rigid plates by {force:.5g} N per mm, plane strain,
a quarter.

Radius 10 mm, E = 210 GPa, nu = 0.3, triangles of Gmsh. Half width of contact a = 0.3 mm; a plate
comes nearer to the middle by P/(pi E*) (2 ln(4 R/a) - 1), right to a share of (a/R)^2 = 0.1 %.""",
            "Johnson (1985), section 5.6", "DISPLACEMENT", "PLATE_REF", 2, -approach, deck)


def barrel():
    """A barrel-shaped tool: an elliptical contact."""
    from scipy.optimize import brentq
    from scipy.special import ellipe, ellipk
    young, nu, small, large, length = 20000.0, 0.3, 20.0, 60.0, 1.2
    modulus = young/(1.0 - nu**2)

    def ratio(k):  # k = b/a, e^2 = 1 - k^2
        m = 1.0 - k*k
        return (ellipe(m)/(k*k) - ellipk(m))/(ellipk(m) - ellipe(m)) - large/small

    k = brentq(ratio, 0.05, 0.999)
    m = 1.0 - k*k
    peak = modulus*length*(1.0/large)/2.0*m/(ellipk(m) - ellipe(m))/k
    force = 2.0/3.0*peak*pi*length*length*k
    ticks = graded(0.3, 1.5, 10.0, 1.8)
    block = Grid("BLOCK", "C3D8", ticks, ticks, -graded(0.3, 0.6, 10.0, 1.8)[::-1])
    near = [int(c) for c in block.cells[:6, :6, -1].ravel()]
    deck = block.text("LEFT FRONT BOTTOM") + "*ELSET, ELSET=NEAR\n"
    deck += "".join(f"{c},\n" for c in near) + "*SURFACE, NAME=NEAR\nNEAR, S2\n"
    deck += elastic("BODY", "BLOCK", young, nu)
    low = small - large + sqrt(large**2 - 625.0)
    deck += tool("BARREL", (0.0, 0.0, small),
                 f"0., 0., {small:g}, 0., 1., {small:g}\nSTART, {low:.10g}, 25.\n"
                 f"CIRCL, {low:.10g}, -25., {small - large:g}, 0.", "REVOLUTION")
    deck += pairs("NEAR, BARREL") + "*BOUNDARY\nBLOCK.LEFT, 1\nBLOCK.FRONT, 2\nBLOCK.BOTTOM, 1, 3\n"
    deck += "BARREL_REF, 1, 2\nBARREL_REF, 4, 6\n"
    deck += step(f"*CLOAD\nBARREL_REF, 3, {-force/4.0:.10g}")
    return (f"""A rigid barrel of radii 20 and 60 mm pressed by {force:.5g} N on a block, in
space, a quarter.

E = 20 GPa, nu = 0.3. Hertz for an ellipse: semi-axes {length:g} and {length*k:.6g} mm, largest
pressure 3 P/(2 pi a b) = {peak:.6g} MPa.""",
            "Hertz (1882); Johnson (1985), section 4.2", "PEAK PRESSURE", "", 0, peak, deck)


def press_fit(options: str = ""):
    """A steel hub on a brass shaft."""
    inner, fit, outer, over = 8.0, 20.0, 30.0, 0.02
    hub, shaft = (207000.0, 0.292), (106000.0, 0.324)
    soft = ((outer**2 + fit**2)/(outer**2 - fit**2) + hub[1])/hub[0] \
        + ((fit**2 + inner**2)/(fit**2 - inner**2) - shaft[1])/shaft[0]

    def ring(r, turn):
        return r*cos(turn), r*sin(turn)

    one = Grid("SHAFT", "CPS4", even(inner, fit, 5), even(0.0, pi/2.0, 10), at=ring)
    two = Grid("HUB", "CPS4", even(fit, outer, 4), even(0.0, pi/2.0, 13), at=ring, first=1000)
    deck = one.text("BOTTOM TOP", "RIGHT") + two.text("BOTTOM TOP", "LEFT")
    deck += elastic("BRASS", "SHAFT", *shaft) + elastic("STEEL", "HUB", *hub)
    deck += pairs("HUB.LEFT, SHAFT.RIGHT", options=options)
    deck += f"*CLEARANCE, SLAVE=HUB.LEFT, MASTER=SHAFT.RIGHT, VALUE={-over:g}\n*BOUNDARY\n"
    deck += "SHAFT.BOTTOM, 2\nHUB.BOTTOM, 2\nSHAFT.TOP, 1\nHUB.TOP, 1\n"
    deck += step("*CONTACT FILE\nCDIS, CSTR")
    return ("""A steel hub pressed on a hollow brass shaft, 0.02 mm too large, plane stress, a
quarter.

Radii 8, 20, 30 mm; steel 207 GPa, 0.292, brass 106 GPa, 0.324. The two meshes have 10 and 13
elements round the quarter. p = d/(b ((c2 + b2)/(c2 - b2) + nu_o)/E_o + b ((b2 + a2)/(b2 - a2) -
nu_i)/E_i).""",
            "Shigley's Mechanical Engineering Design, 9th ed. (2011), section 3-16",
            "PEAK PRESSURE", "", 0, over/(fit*soft), deck)


def press_fit_mortar():
    """The same as the warning of press_fit says."""
    comment, *rest, cards = press_fit(", TYPE=SURFACE TO SURFACE")
    title = " ".join(comment.partition("\n\n")[0].split())
    return comment.replace(comment.partition("\n\n")[0], title[:-1] + ", by mortar."), *rest, cards


def bolt():
    """A bolt in a sleeve, tightened and then pulled."""
    steel, light, length, turn, pull = 210000.0, 70000.0, 100.0, 0.05, 8000.0
    one, two = steel*pi*25.0/length, light*pi*(100.0 - 49.0)/length
    preload = turn*one*two/(one + two)
    screw = Grid("BOLT", "CAX4", even(0.0, 5.0, 2), even(0.0, length, 8))
    sleeve = Grid("SLEEVE", "CAX4", even(7.0, 10.0, 2), even(0.0, length, 10), first=100)
    deck = screw.text("BOTTOM TOP") + nset("BOLT.AXIS", screw.side("LEFT")[:-1])
    deck += sleeve.text("BOTTOM", "TOP")
    deck += elastic("STEEL", "BOLT", steel, 0.0) + elastic("ALUMINIUM", "SLEEVE", light, 0.0)
    deck += tool("HEAD", (0.0, 110.0), "START, 15., 100.\nLINE, 5., 100.").replace(
        "REF NODE=HEAD_REF", "REF NODE=HEAD_REF, TIE NSET=BOLT.TOP")
    deck += pairs("SLEEVE.TOP, HEAD")
    deck += f"*CLEARANCE, SLAVE=SLEEVE.TOP, MASTER=HEAD, VALUE={-turn:g}\n*BOUNDARY\n"
    deck += "BOLT.AXIS, 1\nBOLT.BOTTOM, 2\nSLEEVE.BOTTOM, 2\nHEAD_REF, 1\nHEAD_REF, 6\n"
    deck += step("", options=", NAME=TIGHTEN").replace("\n\n", "\n")
    deck += step(f"*CLOAD\nHEAD_REF, 2, {pull:g}", options=", NAME=PULL")
    return ("""A steel bolt tightened in an aluminium sleeve, its head then pulled by 8 kN,
axisymmetric.

Bolt of 10 mm, sleeve of 14 and 20 mm, both 100 mm long, nu = 0; the nut is turned by 0.05 mm
(*CLEARANCE). Preload d kb ks/(kb + ks); of the pull the bolt bears kb/(kb + ks), the sleeve loses
the rest.""",
            "Shigley's Mechanical Engineering Design, 9th ed. (2011), sections 8-4 and 8-7",
            "FORCE", "BOLT.BOTTOM", 2, -(preload + pull*one/(one + two)), deck)


PROBLEMS = (cone, wavy, roller, barrel, press_fit, press_fit_mortar, bolt)
