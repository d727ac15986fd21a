"""Ten more problems of decks/handbook: rings, plates, tubes, hooks, rubber and creep in contact."""
from __future__ import annotations

from math import asin, atan, cos, pi, radians, sin, sqrt, tan

from handbook_mesh import Grid, elastic, even, graded, nset, pairs, step, tool

STEEL = 210000.0


def compound_barrel():
    """Two tubes shrunk on each other, then under pressure."""
    bore, fit, outer, over, inside = 10.0, 15.0, 25.0, 0.01, 50.0
    young, nu = 207000.0, 0.3
    shrink = young*over*(fit**2 - bore**2)*(outer**2 - fit**2) \
        / (2.0*fit**3*(outer**2 - bore**2))
    more = inside*bore**2*(outer**2 - fit**2)/(fit**2*(outer**2 - bore**2))

    def ring(r, turn):
        return r*cos(turn), r*sin(turn)

    liner = Grid("LINER", "CPS4", even(bore, fit, 4), even(0.0, pi/2.0, 14), at=ring)
    jacket = Grid("JACKET", "CPS4", even(fit, outer, 5), even(0.0, pi/2.0, 11), at=ring, first=500)
    deck = liner.text("BOTTOM TOP", "LEFT RIGHT") + jacket.text("BOTTOM TOP", "LEFT")
    deck += elastic("STEEL", "LINER JACKET", young, nu)
    deck += pairs("JACKET.LEFT, LINER.RIGHT")
    deck += f"*CLEARANCE, SLAVE=JACKET.LEFT, MASTER=LINER.RIGHT, VALUE={-over:g}\n*BOUNDARY\n"
    deck += "LINER.BOTTOM, 2\nJACKET.BOTTOM, 2\nLINER.TOP, 1\nJACKET.TOP, 1\n"
    deck += step("*CONTACT FILE\nCDIS, CSTR", options=", NAME=SHRINK")
    deck += step(f"*DSLOAD\nLINER.LEFT, P, {inside:g}", options=", NAME=FIRE")
    return ("""A gun barrel of two tubes, shrunk on each other by 0.01 mm and then put under 50
MPa.

Radii 10, 15 and 25 mm, both of steel (207 GPa, 0.3), plane stress, a quarter; 14 and 11 elements
round it. p = E d (b2 - a2)(c2 - b2)/(2 b3 (c2 - a2)) + q a2 (c2 - b2)/(b2 (c2 - a2)).""",
            "Timoshenko, Strength of Materials, part II (1956), compound cylinders",
            "PEAK PRESSURE", "", 0, shrink + more, deck)


def expanded_tube():
    """A tube widened until it presses on the bore of its plate."""
    a, b, gap, load, young, nu = 10.0, 12.0, 0.005, 60.0, 200000.0, 0.3
    free, back = ((1.0 + nu)*b/(young*(b*b - a*a))*part for part in (
        2.0*(1.0 - nu)*a*a, (1.0 - 2.0*nu)*b*b + a*a))
    meets = (free*load - gap)/back
    tube = Grid("TUBE", "CAX4", even(a, b, 3), even(0.0, 2.0, 2))
    deck = tube.text("BOTTOM TOP", "LEFT RIGHT") + elastic("STEEL", "TUBE", young, nu)
    deck += tool("BORE", (0.0, -5.0), f"START, {b + gap:.10g}, -5.\nLINE, {b + gap:.10g}, 10.")
    deck += pairs("TUBE.RIGHT, BORE") + "*BOUNDARY\nTUBE.BOTTOM, 2\nTUBE.TOP, 2\nBORE_REF, 1, 2\n"
    deck += "BORE_REF, 6\n" + step(f"*DSLOAD\nTUBE.LEFT, P, {load:g}")
    return (f"""A tube is widened by {load:g} MPa until it presses on a stiff bore 0.005 mm away.

Radii 10 and 12 mm, E = 200 GPa, nu = 0.3, its ends held. Lame: the outside moves by (1 + nu) b/(E
(b2 - a2)) (2 (1 - nu) p a2 - q ((1 - 2 nu) b2 + a2)) = gap, which gives the pressure q outside.""",
            "Timoshenko and Goodier, Theory of Elasticity, article 28; tube-to-tubesheet joints",
            "PEAK PRESSURE", "", 0, meets, deck)


def rail():
    """A rail that the sun closes."""
    long, high, gap, alpha, heat = 200.0, 10.0, 0.1, 12.0e-6, 60.0
    force = STEEL*high*(alpha*heat*long - gap)/long
    bar = Grid("RAIL", "CPS4", even(0.0, long, 20), even(0.0, high, 2))
    deck = bar.text("LEFT", "RIGHT") + nset("FOOT", [bar.node(0, 0)]) + nset("ALL", bar.numbers)
    deck += elastic("STEEL", "RAIL", STEEL, 0.3, f"*EXPANSION\n{alpha:g}\n")
    deck += tool("WALL", (220.0, 0.0), f"START, {long + gap:g}, -20.\nLINE, {long + gap:g}, 40.")
    deck += pairs("RAIL.RIGHT, WALL") + "*BOUNDARY\nRAIL.LEFT, 1\nFOOT, 2\nWALL_REF, 1, 2\n"
    deck += "WALL_REF, 6\n" + step(f"*TEMPERATURE\nALL, {heat:g}")
    return ("""A rail heated by 60 K closes a gap of 0.1 mm and presses on its neighbour.

200 x 10 x 1 mm, plane stress, E = 210 GPa, nu = 0.3, 12e-6 /K; the neighbour is stiff. N = E A (a
T - g/L).""",
            "Gere and Timoshenko, Mechanics of Materials, thermal effects", "FORCE", "WALL_REF", 1,
            -force, deck)


def propped_plate():
    """A clamped round plate that comes down on a stop."""
    radius, thick, nu, free, gap, ball = 100.0, 1.0, 0.3, 0.2, 0.1, 2.0
    stiff = STEEL*thick**3/(12.0*(1.0 - nu**2))
    load = 64.0*stiff*free/radius**4
    force = (free - gap)*16.0*pi*stiff/radius**2
    for _ in range(50):  # the ball goes in a little
        dent = (9.0*force**2*(1.0 - nu**2)**2/(16.0*STEEL**2*ball))**(1.0/3.0)
        force = (free - gap - dent)*16.0*pi*stiff/radius**2
    plate = Grid("PLATE", "CAX8R", graded(0.5, 4.0, radius, 1.25), even(0.0, thick, 1))
    deck = plate.text("LEFT RIGHT", "BOTTOM TOP") + elastic("STEEL", "PLATE", STEEL, nu)
    deck += tool("STOP", (0.0, -10.0), f"START, 0., {-gap:g}\n"
                 f"CIRCL, {ball:g}, {-gap - ball:g}, 0., {-gap - ball:g}")
    deck += pairs("PLATE.BOTTOM, STOP") + "*BOUNDARY\nPLATE.LEFT, 1\nPLATE.RIGHT, 1, 2\n"
    deck += "STOP_REF, 1, 2\nSTOP_REF, 6\n" + step(f"*DSLOAD\nPLATE.TOP, P, {load:.10g}")
    return (f"""A clamped round plate under {load:.6g} MPa comes down on a stop in its middle.

Radius 100 mm, 1 mm thick, E = 210 GPa, nu = 0.3; alone it would go down by q a4/(64 D) = 0.2 mm,
the stop, a ball of radius 2 mm, is 0.1 mm below: it bears 16 pi D/a2 times the rest, less what the
ball goes in (Hertz, 0.8 %).""",
            "Timoshenko and Woinowsky-Krieger, Theory of Plates and Shells, articles 16 and 19",
            "FORCE", "STOP_REF", 2, force, deck)


def sunken_support():
    """A beam over two spans whose middle support has sunk."""
    young, high, span, load, sunk = 200000.0, 2.0, 100.0, 0.002, 0.1
    bend = young*high**3/12.0
    force = 1.25*load*span - 6.0*bend*sunk/span**3
    beam = Grid("BEAM", "CPS8R", even(0.0, 104.0, 26), even(0.0, high, 1))
    deck = beam.text("LEFT", "BOTTOM") + "*ELSET, ELSET=SPAN\n"
    deck += "".join(f"{c},\n" for c in beam.cells[:25, -1]) + "*SURFACE, NAME=SPAN\nSPAN, S3\n"
    deck += elastic("STEEL", "BEAM", young, 0.0)
    for name, x, y, number in (("PROP", 0.0, -sunk, 900001), ("END", span, 0.0, 900002)):
        deck += tool(name, (x, -10.0), f"START, {x - 1.0:g}, {y - 1.0:g}\n"
                     f"CIRCL, {x:g}, {y:g}, {x:g}, {y - 1.0:g}\n"
                     f"CIRCL, {x + 1.0:g}, {y - 1.0:g}, {x:g}, {y - 1.0:g}", number=number)
    deck += pairs("BEAM.BOTTOM, PROP\nBEAM.BOTTOM, END") + "*BOUNDARY\nBEAM.LEFT, 1\n"
    deck += "PROP_REF, 1, 2\nPROP_REF, 6\nEND_REF, 1, 2\nEND_REF, 6\n"
    deck += step(f"*DSLOAD\nSPAN, P, {load:g}")
    return ("""A beam over two spans of 100 mm, whose middle support has sunk by 0.1 mm.

2 x 1 mm, half of it, plane stress, E = 200 GPa, nu = 0, 0.002 N/mm; rounded supports, nothing else
holds it. The middle bears 5/4 q L - 6 EI d/L3, half of it here.""",
            "Timoshenko, Strength of Materials, part I (1955), continuous beams", "FORCE",
            "PROP_REF", 2, 0.5*force, deck)


def proving_ring():
    """A ring between two plates."""
    radius, thick, press = 50.0, 2.0, 0.5
    bend, area = STEEL*thick**3/12.0, thick
    soft = radius**3/bend*(pi/4.0 - 2.0/pi) + pi*radius/(4.0*STEEL*area)*(1.0 + 2.0*1.2)
    ring = Grid("RING", "CPS8R", even(radius - 0.5*thick, radius + 0.5*thick, 1),
                even(0.0, pi/2.0, 24), at=lambda r, t: (r*cos(t), r*sin(t)))
    deck = ring.text("BOTTOM TOP", "RIGHT") + elastic("STEEL", "RING", STEEL, 0.0)
    top = radius + 0.5*thick
    deck += tool("PLATE", (0.0, 60.0), f"START, 60., {top:g}\nLINE, -10., {top:g}")
    deck += pairs("RING.RIGHT, PLATE") + "*BOUNDARY\nRING.BOTTOM, 2\nRING.TOP, 1\nPLATE_REF, 1\n"
    deck += "PLATE_REF, 6\n" + step(f"*BOUNDARY\nPLATE_REF, 2, 2, {-0.5*press:g}")
    return ("""A proving ring is pressed by 0.5 mm between two plates.

Mean radius 50 mm, 2 x 1 mm, a quarter, plane stress, E = 210 GPa, nu = 0. d = P R3/(EI) (pi/4 -
2/pi) and pi P R/(4 E A) (1 + 2.4) of normal and shear forces; half of P is on the quarter.""",
            "Timoshenko, Strength of Materials, part II (1956), thin rings", "FORCE", "PLATE_REF",
            2, -0.5*press/soft, deck)


def snap_hook():
    """A snap hook rides up on its catch."""
    long, high, mu, slope, way = 40.0, 2.0, 0.2, radians(30.0), 0.1
    bend, shear, area = STEEL*high**3/12.0, 5.0/6.0*STEEL/2.0*high, high
    along = tan(slope + atan(mu))
    # Rise of the tip for a transverse force of 1, the push along the beam at its lower edge.
    rise = long**3/(3.0*bend) + long/shear - along*0.5*high*long**2/(2.0*bend)
    turn = long**2/(2.0*bend) - along*0.5*high*long/bend
    force = way*tan(slope)/(rise - tan(slope)*(turn*0.5*high - along*long/(STEEL*area)))
    beam = Grid("BEAM", "CPS4I", even(0.0, long, 40), even(-0.5*high, 0.5*high, 2))
    deck = beam.text("LEFT", "BOTTOM") + elastic("STEEL", "BEAM", STEEL, 0.0)
    low, up = (f"{long + s:.10g}, {s*tan(slope) - 0.5*high:.10g}" for s in (-4.0, 6.0))
    deck += tool("CATCH", (50.0, -5.0), f"START, {low}\nLINE, {up}")
    deck += pairs("BEAM.BOTTOM, CATCH", mu) + "*BOUNDARY\nBEAM.LEFT, 1, 2\nCATCH_REF, 2\n"
    deck += "CATCH_REF, 6\n" + step(f"*BOUNDARY\nCATCH_REF, 1, 1, {-way:g}", "0.25, 1.")
    return ("""A snap hook, a cantilever of 40 mm, rides up on the flank of its catch, 30 degrees
steep, by 0.1 mm.

2 x 1 mm, plane stress, E = 210 GPa, nu = 0, mu = 0.2. The force across is that of a cantilever
whose tip is lifted, the force along tan(30 + atan mu) times as large, at its lower edge.""",
            "Bayer, Snap-Fit Joints for Plastics; Roark's Formulas for Stress and Strain",
            "FORCE", "CATCH_REF", 1, -force*along, deck)


def rubber_puck():
    """A rubber puck between plates."""
    radius, half, c10, d1, stretch = 10.0, 5.0, 0.5, 2.0e-4, 0.7
    force = 2.0*c10*pi*radius**2*(stretch**-2 - stretch)
    puck = Grid("PUCK", "CAX4", even(0.0, radius, 4), even(0.0, half, 3))
    deck = puck.text("LEFT BOTTOM", "TOP")
    deck += f"*MATERIAL, NAME=RUBBER\n*HYPERELASTIC, NEO HOOKE\n{c10:g}, {d1:g}\n"
    deck += "*SOLID SECTION, ELSET=PUCK, MATERIAL=RUBBER\n"
    deck += tool("PRESS", (0.0, 20.0), f"START, 30., {half:g}\nLINE, 0., {half:g}")
    deck += pairs("PUCK.TOP, PRESS") + "*BOUNDARY\nPUCK.LEFT, 1\nPUCK.BOTTOM, 2\nPRESS_REF, 1\n"
    deck += "PRESS_REF, 6\n" + step(f"*BOUNDARY\nPRESS_REF, 2, 2, {-(1.0 - stretch)*half:g}",
                                    "0.1, 1.", ", NLGEOM")
    return ("""A rubber puck is pressed by 30 % between greased plates.

20 mm across, 10 mm high, half of it, neo-Hooke with a shear modulus of 1 MPa, nearly
incompressible. F = G A (1/s2 - s), s = 0.7.""",
            "Treloar (1975), The Physics of Rubber Elasticity", "FORCE", "PRESS_REF", 2, -force,
            deck)


def two_rollers():
    """Two parallel rollers of different metals."""
    one, two, half = (210000.0, 0.3, 20.0), (70000.0, 0.33, 30.0), 0.3
    stiff = 1.0/sum((1.0 - nu**2)/young for young, nu, _ in (one, two))
    radius = 1.0/(1.0/one[2] + 1.0/two[2])
    load = half**2*pi*stiff/(4.0*radius)
    peak = 2.0*load/(pi*half)

    def crown(r, side):
        def at(x, y):
            sag = r*(1.0 - cos(asin(x/r)))
            return x, y + side*sag*(1.0 - abs(y)/8.0)
        return at

    low = Grid("LOW", "CPE4", graded(0.05, 0.5, 8.0, 1.4), -graded(0.05, 0.2, 8.0, 1.4)[::-1],
               at=crown(two[2], -1.0))
    up = Grid("UP", "CPE4", graded(0.042, 0.504, 8.0, 1.4), graded(0.05, 0.2, 8.0, 1.4),
              at=crown(one[2], 1.0), first=2000)
    deck = low.text("LEFT BOTTOM", "") + up.text("LEFT", "TOP")
    for name, body, row, face, count in (("CROWN", up, 0, "S1", 16), ("SEAT", low, -1, "S3", 15)):
        cells = ", ".join(str(c) for c in body.cells[:count, row][:16])
        deck += f"*ELSET, ELSET={name}\n{cells}\n*SURFACE, NAME={name}\n{name}, {face}\n"
    deck += elastic("STEEL", "UP", *one[:2]) + elastic("ALUMINIUM", "LOW", *two[:2])
    deck += pairs("SEAT, CROWN") + "*BOUNDARY\nLOW.LEFT, 1\nLOW.BOTTOM, 2\nUP.LEFT, 1\n"
    deck += step(f"*DSLOAD\nUP.TOP, P, {0.5*load/8.0:.10g}")
    return (f"""A steel roller on one of aluminium, {load:.6g} N per mm of their length, plane
strain.

Radii 20 and 30 mm, 210 GPa and 0.3, 70 GPa and 0.33; 8 mm of both, half of them, nothing but the
contact holds the upper one. Half width 0.3 mm, p = 2 P/(pi a).""",
            "Hertz (1882); Johnson (1985), section 4.2, line contact", "PEAK PRESSURE", "", 0,
            peak, deck)


def relaxing_post():
    """A post that creeps between fixed plates."""
    young, stiff, m, radius, high, strain, time = 100000.0, 200.0, 0.25, 5.0, 10.0, 1.0e-3, 1.0
    n, base = 1.0/m, stiff*sqrt(3.0)**(m + 1.0)
    first = young*strain
    stress = (first**(1.0 - n) + (n - 1.0)*young*time/base**n)**(1.0/(1.0 - n))
    post = Grid("POST", "CAX4", even(0.0, radius, 2), even(0.0, high, 4))
    deck = post.text("LEFT BOTTOM", "TOP")
    deck += f"*MATERIAL, NAME=HOT\n*ELASTIC\n{young:g}, 0.3\n"
    deck += f"*VISCOPLASTIC, LAW=NORTON-HOFF\n{stiff:g}, {m:g}\n"
    deck += "*SOLID SECTION, ELSET=POST, MATERIAL=HOT\n"
    deck += tool("PLATE", (0.0, 20.0), f"START, 20., {high:g}\nLINE, 0., {high:g}")
    deck += pairs("POST.TOP, PLATE") + "*BOUNDARY\nPOST.LEFT, 1\nPOST.BOTTOM, 2\nPLATE_REF, 1\n"
    deck += "PLATE_REF, 6\n"
    deck += step(f"*BOUNDARY\nPLATE_REF, 2, 2, {-strain*high:g}", "1e-6, 1e-6", ", NAME=LOAD")
    deck += step(f"*BOUNDARY\nPLATE_REF, 2, 2, {-strain*high:g}", f"0.01, {time:g}",
                 ", NAME=HOLD, INC=1000")
    return ("""A hot post is set between two plates by 0.01 mm and relaxes for a second (Norton,
exponent 4).

10 x 10 mm, E = 100 GPa, flow stress K sqrt(3)^(m+1) rate^m, K = 200, m = 0.25. s' = -E (s/S)^n:
s^(1-n) = s0^(1-n) + (n - 1) E t/S^n.""",
            "Odqvist (1966), Mathematical Theory of Creep and Creep Rupture; relaxation of bolts",
            "FORCE", "PLATE_REF", 2, -stress*pi*radius**2, deck)


PROBLEMS = (compound_barrel, expanded_tube, rail, propped_plate, sunken_support, proving_ring,
            snap_hook, rubber_puck, two_rollers, relaxing_post)
