"""Beams and strips that meet stops, floors and each other: problems of decks/handbook."""
from __future__ import annotations

from math import cos, cosh, pi, sin, sinh, sqrt

import numpy as np
from handbook_mesh import Grid, elastic, even, nset, pairs, step, tool

STEEL = 210000.0


def foundation():
    """A beam on a foundation that cannot pull."""
    young, high, reach, span, load = 200000.0, 2.0, 100.0, 150.0, 1.0
    bending, wave = young*high**3/12.0, pi/(2.0*100.0)
    stiff = 4.0*bending*wave**4
    # y of even and odd shapes, its second and third derivative by the wave number; y'(0) = 0,
    # y'''(0) = P/(2 EI), y'' = y''' = 0 where the beam lifts off, and so is y.
    shapes = [(lambda z: cosh(z)*cos(z), lambda z: -2.0*sinh(z)*sin(z),
               lambda z: -2.0*(cosh(z)*sin(z) + sinh(z)*cos(z))),
              (lambda z: sinh(z)*sin(z), lambda z: 2.0*cosh(z)*cos(z),
               lambda z: 2.0*(sinh(z)*cos(z) - cosh(z)*sin(z))),
              (lambda z: cosh(z)*sin(z) - sinh(z)*cos(z),
               lambda z: 2.0*(sinh(z)*cos(z) + cosh(z)*sin(z)), lambda z: 4.0*cosh(z)*cos(z))]
    end = wave*reach
    third = load/(2.0*bending*wave**3)/4.0
    left = np.array([[s[d](end) for s in shapes[:2]] for d in (1, 2)])
    first, second = np.linalg.solve(left, [-third*shapes[2][d](end) for d in (1, 2)])
    lift = first*shapes[0][0](end) + second*shapes[1][0](end) + third*shapes[2][0](end)
    assert abs(lift) < 1e-9*abs(first)
    beam = Grid("BEAM", "CPS8R", even(0.0, span, 45), even(0.0, high, 1))
    deck = beam.text("LEFT", "LEFT BOTTOM") + nset("MIDDLE", [beam.node(0, 0)])
    deck += elastic("STEEL", "BEAM", young, 0.0)
    deck += tool("GROUND", (0.0, -5.0), "START, -10., 0.\nLINE, 200., 0.")
    deck += pairs("BEAM.BOTTOM, GROUND",
                  behavior=f"*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TABULAR\n0., 0.\n{stiff:.10g}, 1.")
    deck += "*BOUNDARY\nBEAM.LEFT, 1\nGROUND_REF, 1, 2\nGROUND_REF, 6\n"
    deck += step(f"*DSLOAD\nBEAM.LEFT, TRVEC, {load/2.0/high:.10g}, 0., -1.")
    return (f"""A long beam on a foundation that cannot pull, loaded in its middle: it lifts
off.

300 x 2 x 1 mm, half of it, E = 200 GPa, nu = 0, no weight, 1 N; foundation {stiff:.6g} N/mm2, so
that b = (k/(4 EI))^(1/4) = pi/200. It rests on pi/(2 b) = 100 mm to either side, whatever the
load.""",
            "Hetenyi (1946), Beams on Elastic Foundation; Weitsman (1970), J. Appl. Mech. 37",
            "DISPLACEMENT", "MIDDLE", 2, -first, deck)


def touch_down():
    """A strip pressed down on a floor."""
    high, gap, length, free = 1.0, 0.5, 100.0, 60.0
    load = 72.0*STEEL*high**3/12.0*gap/free**4
    strip = Grid("STRIP", "CPS4I", even(0.0, length, 40), even(0.0, high, 2))
    deck = strip.text("LEFT RIGHT", "BOTTOM TOP") + elastic("STEEL", "STRIP", STEEL, 0.0)
    deck += tool("FLOOR", (0.0, -5.0), f"START, -10., {-gap:g}\nLINE, 200., {-gap:g}")
    deck += pairs("STRIP.BOTTOM, FLOOR") + "*BOUNDARY\nSTRIP.LEFT, 1, 2\nSTRIP.RIGHT, 1\n"
    deck += "FLOOR_REF, 1, 2\nFLOOR_REF, 6\n" + step(f"*DSLOAD\nSTRIP.TOP, P, {load:.10g}")
    return (f"""A strip clamped at both ends is pressed down on a floor by a uniform pressure.

200 x 1 x 1 mm, half of it, plane stress, E = 210 GPa, nu = 0, floor 0.5 mm below, {load:.6g} MPa.
A free length l hangs from the clamp to the floor, d = q l^4/(72 EI), l = 60 mm; where it ends the
floor presses with q l/3. The floor bears q (100 - l) + q l/3 of one half.""",
            "Timoshenko, Strength of Materials, part I (1955); by the equation of the beam",
            "FORCE", "", 2, load*(length - free) + load*free/3.0, deck)


def leaves():
    """Two leaves of a spring."""
    long, short, high, wide, load = 200.0, 100.0, 4.0, 10.0, 50.0
    bend, shear = STEEL*wide*high**3/12.0, 5.0/6.0*STEEL/2.0*wide*high
    force = load*(short**2*(3.0*long - short)/(6.0*bend) + short/shear) \
        / (2.0*(short**3/(3.0*bend) + short/shear))
    upper = Grid("UPPER", "C3D8I", even(0.0, long, 20), even(0.0, wide, 1), even(0.0, high, 2))
    lower = Grid("LOWER", "C3D8I", even(0.0, short, 8), even(0.0, wide, 1), even(-high, 0.0, 2),
                 first=1000)
    deck = upper.text("LEFT FRONT", "RIGHT BOTTOM") + lower.text("LEFT FRONT", "TOP")
    deck += elastic("STEEL", "UPPER LOWER", STEEL, 0.0)
    deck += pairs("UPPER.BOTTOM, LOWER.TOP")
    deck += "*BOUNDARY\nUPPER.LEFT, 1, 3\nLOWER.LEFT, 1, 3\nUPPER.FRONT, 2\nLOWER.FRONT, 2\n"
    deck += step(f"*DSLOAD\nUPPER.RIGHT, TRVEC, {load/wide/high:g}, 0., 0., -1.")
    return ("""Two leaves of a spring, 200 and 100 mm long, clamped together: 50 N on the end of
the long one.

10 x 4 mm each, E = 210 GPa, nu = 0, in space. They touch at the end of the short leaf alone, with
P (3 L - l)/(4 l) = 62.5 N by beams without shear, here with it.""",
            "Timoshenko, Strength of Materials, part II (1956), leaf springs", "FORCE", "", 3,
            force, deck)


def guide():
    """A cantilever that lies down on a curved guide."""
    high, length, wrapped, radius = 1.0, 100.0, 40.0, 2000.0
    bend = STEEL*high**3/12.0
    free = length - wrapped
    load = bend/radius/free
    drop = free**3*load/(3.0*bend) + free*wrapped/radius + wrapped**2/(2.0*radius)
    beam = Grid("BEAM", "CPS4I", even(0.0, length, 40), even(-0.5*high, 0.5*high, 2))
    deck = beam.text("LEFT", "BOTTOM RIGHT") + nset("TIP", [beam.node(-1, 1)])
    deck += elastic("STEEL", "BEAM", STEEL, 0.0)
    inner = radius - 0.5*high
    depth = -radius + sqrt(inner**2 - 150.0**2)
    deck += tool("GUIDE", (0.0, -50.0), f"START, -150., {depth:.12g}\n"
                 f"CIRCL, 150., {depth:.12g}, 0., {-radius:g}")
    deck += pairs("BEAM.BOTTOM, GUIDE") + "*BOUNDARY\nBEAM.LEFT, 1, 2\nGUIDE_REF, 1, 2\n"
    deck += "GUIDE_REF, 6\n" + step(f"*DSLOAD\nBEAM.RIGHT, TRVEC, {load/high:.10g}, 0., -1.")
    return (f"""A cantilever bent down on a curved guide, on which it lies over 40 of 100 mm.

1 x 1 mm, plane stress, E = 210 GPa, nu = 0, its axis on a radius of 2000 mm, {load:.6g} N at the
end: from where P (L - x) = EI/R the rest is a cantilever of 60 mm; d = P (L - x)^3/(3 EI) + (L -
x) x/R + x^2/(2 R).""",
            "Timoshenko, Strength of Materials, part I (1955), deflection of beams",
            "DISPLACEMENT", "TIP", 2, -drop, deck)


def thermostat():
    """A bimetal strip that meets a stop."""
    low, up, heat, length, stop, gap = 145000.0, 100000.0, 40.0, 100.0, 90.0, 1.0
    round_off = 5.0
    alpha_low, alpha_up = 19.0e-6, 1.2e-6
    n = low/up
    curve = 6.0*(alpha_low - alpha_up)*heat*4.0/(2.0*(12.0 + (1.0 + n)*(1.0 + 1.0/n)))
    axis = (low*0.5 + up*1.5)/(low + up)
    bend = low*(1.0/12.0 + (axis - 0.5)**2) + up*(1.0/12.0 + (1.5 - axis)**2)
    force = meet = 0.0
    for _ in range(20):  # the strip meets the round stop where it is as steep as it
        slope = curve*(stop + meet) - force*(stop + meet)**2/(2.0*bend)
        meet, rise = round_off*sin(slope), round_off*(1.0 - cos(slope))
        force = 3.0*bend*(curve*(stop + meet)**2/2.0 - gap - rise)/(stop + meet)**3
    strip = Grid("STRIP", "CPS8R", even(0.0, length, 40), even(0.0, 2.0, 2))
    deck = strip.text("LEFT", "TOP") + nset("FOOT", [strip.node(0, 1)])
    for k, name in enumerate(("BRASS", "INVAR")):
        deck += f"*ELSET, ELSET={name}\n" + "".join(f"{c},\n" for c in strip.cells[:, k])
    deck += elastic("BRASS", "BRASS", low, 0.0, f"*EXPANSION\n{alpha_low:g}\n")
    deck += elastic("INVAR", "INVAR", up, 0.0, f"*EXPANSION\n{alpha_up:g}\n")
    deck += nset("ALL", strip.numbers)
    deck += tool("STOP", (stop, 10.0), f"START, {stop + 5.0:g}, {7.0 + gap:g}\n"
                 f"CIRCL, {stop:g}, {2.0 + gap:g}, {stop:g}, {7.0 + gap:g}\n"
                 f"CIRCL, {stop - 5.0:g}, {7.0 + gap:g}, {stop:g}, {7.0 + gap:g}")
    deck += pairs("STRIP.TOP, STOP") + "*BOUNDARY\nSTRIP.LEFT, 1\nFOOT, 2\nSTOP_REF, 1, 2\n"
    deck += "STOP_REF, 6\n" + step(f"*TEMPERATURE\nALL, {heat:g}")
    return (f"""A bimetal strip heated by 40 K bends up against a stop: a thermostat.

Two layers of 100 x 1 x 1 mm, E = 145 and 100 GPa, nu = 0, 19e-6 and 1.2e-6 /K, plane stress. Free,
its curvature is {curve:.6g} per mm (Timoshenko); a round stop of radius 5 mm, 1 mm above it at 90
mm, bears 3 EI (c x^2/2 - gap)/x^3, x where the strip is as steep as the stop.""",
            "Timoshenko (1925), J. Opt. Soc. Am. 11; Roark's Formulas for Stress and Strain",
            "FORCE", "STOP_REF", 2, -force, deck)


PROBLEMS = (foundation, touch_down, leaves, guide, thermostat)
