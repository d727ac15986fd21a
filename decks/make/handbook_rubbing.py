"""Friction: problems of decks/handbook."""
from __future__ import annotations

from math import atan, cos, radians, sin, sqrt, tan

from handbook_mesh import Grid, elastic, even, nset, pairs, rows, step, tool


def wedge():
    """A wedge under a machine."""
    mu, load, slope = 0.35, 400.0, radians(8.0)
    turn = slope + atan(mu)
    under = load/(cos(turn) - mu*sin(turn))
    push = under*(sin(turn) + mu*cos(turn))

    def inclined(x):
        return 10.0 + (x - 20.0)*tan(slope)

    low = Grid("WEDGE", "CPE4", even(30.0, 110.0, 16), even(0.0, 1.0, 4),
               at=lambda x, t: (x, t*inclined(x)))
    high = Grid("BLOCK", "CPE4", even(20.0, 80.0, 10), even(0.0, 1.0, 6), first=500,
                at=lambda x, t: (x, (1.0 - t)*inclined(x) + t*60.0))
    deck = low.text("RIGHT", "BOTTOM TOP") + high.text("", "BOTTOM LEFT TOP")
    deck += elastic("STEEL", "WEDGE BLOCK", 200000.0, 0.3)
    deck += tool("FLOOR", (0.0, -5.0), "START, -50., 0.\nLINE, 200., 0.")
    deck += tool("WALL", (10.0, 0.0), "START, 20., 100.\nLINE, 20., 0.", number=900002)
    deck += pairs("WEDGE.BOTTOM, FLOOR\nBLOCK.LEFT, WALL\nBLOCK.BOTTOM, WEDGE.TOP", mu)
    deck += "*BOUNDARY\nFLOOR_REF, 1, 2\nFLOOR_REF, 6\nWALL_REF, 1, 2\nWALL_REF, 6\n"
    deck += step("*BOUNDARY\nWEDGE.RIGHT, 1\n"
                 f"*DSLOAD\nBLOCK.TOP, TRVEC, {load/60.0:.10g}, 0., -1.", "0.2, 1.", ", NAME=REST")
    deck += step("*BOUNDARY\nWEDGE.RIGHT, 1, 1, -0.5", "0.1, 1.", ", NAME=PUSH")
    return ("""A machine block is raised by a wedge of 8 degrees driven in under it, friction on
all faces.

400 N on the block, mu = 0.35 on the floor, between wedge and block, and on the wall that holds the
block; steel, plane strain. Statics: 423 N push the wedge (the book counts in pounds).""",
            "Beer and Johnston, Vector Mechanics for Engineers: Statics, sample problem 8.4",
            "FORCE", "WEDGE.RIGHT", 1, -push, deck)


def brake_shoe():
    """An internal expanding brake shoe."""
    from scipy.integrate import quad
    mu, radius, hinge, wide, peak, slope = 0.32, 150.0, 120.0, 32.0, 1.0, 10.0
    start, end = radians(15.0), radians(125.0)
    turn = peak/(slope*hinge)

    def total(component):
        def part(t):
            out, along = (cos(t), sin(t)), (-sin(t), cos(t))
            return peak*sin(t)*wide*radius*(out[component] + mu*along[component])
        return quad(part, start, end)[0]

    force = sqrt(total(0)**2 + total(1)**2)
    shoe = Grid("SHOE", "CPS4", even(radius - 6.0, radius, 1), even(start, end, 30),
                at=lambda r, t: (r*cos(t), r*sin(t)))
    deck = shoe.text("LEFT", "RIGHT")
    deck += elastic("STIFF", "SHOE", 1.0e7, 0.0, thick=f"{wide:g}\n")
    deck += f"*NODE, NSET=HINGE\n900002, {hinge:g}, 0.\n"
    deck += "*RIGID BODY, NSET=SHOE.LEFT, REF NODE=HINGE\n"
    side, top = radius*cos(radians(150.0)), radius*sin(radians(150.0))
    deck += tool("DRUM", (0.0, 0.0), f"START, {radius:g}, 0.\n"
                 f"CIRCL, {side:.10g}, {top:.10g}, 0., 0.")
    deck += pairs("SHOE.RIGHT, DRUM", mu,
                  f"*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TABULAR\n0., 0.\n{slope:g}., 1.")
    deck += "*BOUNDARY\nHINGE, 1, 2\nDRUM_REF, 1, 2\n"
    deck += step(f"*BOUNDARY\nHINGE, 6, 6, {-turn:.10g}\nDRUM_REF, 6, 6, -0.02", "0.1, 1.")
    return ("""A brake shoe that turns about its hinge against a drum: the pressure grows as
sin(t).

Drum of 300 mm, shoe 32 mm wide from 15 to 125 degrees, hinge 120 mm from the middle, lining of 10
MPa/mm on a stiff shoe (*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TABULAR), mu = 0.32. The shoe turns
until p = 1 MPa at 90 degrees, the drum by 0.02 rad. Asked: the force on the drum's bearing.""",
            "Shigley's Mechanical Engineering Design, 9th ed. (2011), section 16-2", "FORCE",
            "DRUM_REF", 0, force, deck)


def pipeline():
    """A pipeline heated on the sea bed."""
    young, high, mu, alpha, heat, slip, length = 210000.0, 1.0, 0.3, 1.2e-5, 100.0, 600.0, 1000.0
    hold = young*high*alpha*heat/slip
    pipe = Grid("PIPE", "CPS4", even(0.0, length, 100), even(0.0, high, 1))
    deck = pipe.text("LEFT RIGHT", "BOTTOM TOP") + nset("ALL", pipe.numbers)
    deck += elastic("STEEL", "PIPE", young, 0.0, f"*EXPANSION\n{alpha:g}\n")
    deck += tool("BED", (0.0, -5.0), "START, -50., 0.\nLINE, 1200., 0.")
    deck += pairs("PIPE.BOTTOM, BED", mu) + "*BOUNDARY\nPIPE.LEFT, 1\nBED_REF, 1, 2\nBED_REF, 6\n"
    deck += step(f"*DSLOAD\nPIPE.TOP, P, {hold/mu:.10g}", options=", NAME=LAY")
    deck += step(f"*TEMPERATURE\nALL, {heat:g}", "0.1, 1.", ", NAME=HEAT, INC=1000")
    deck += step("*TEMPERATURE\nALL, 0.", "0.1, 1.", ", NAME=COOL, INC=1000")
    return (f"""The end of a heated pipeline that friction with the sea bed holds, after it has
cooled.

A strip of 1000 x 1 x 1 mm, E = 210 GPa, nu = 0, 1.2e-5 /K, on a rigid bed: friction f = {hold:.6g}
N/mm. Heated by 100 K its end moves by EA (a T)^2/(2 f), slipping over EA a T/f = 600 mm; cooled
again, half of that is left. Right but for the height of the strip, mu h/600 mm = 0.05 %.""",
            "Palmer and King, Subsea Pipeline Engineering (2004), expansion of an end",
            "DISPLACEMENT", "PIPE.RIGHT", 1, alpha*heat*slip/4.0, deck)


def v_block():
    """A bar pulled along a groove."""
    mu, side, length, weight = 0.2, 20.0, 40.0, 100.0
    root = sqrt(0.5)
    bar = Grid("BAR", "C3D20", even(0.0, length, 2), even(0.0, side, 4), even(0.0, side, 4),
               at=lambda x, y, z: (x, (y - z)*root, (y + z)*root))
    deck = bar.text("RIGHT")
    for name, cells, face in (("WEST", bar.cells[:, 0, 1:], "S3"),
                              ("EAST", bar.cells[:, 1:, 0], "S1")):
        deck += f"*ELSET, ELSET={name}\n{rows(cells.ravel())}"
        deck += f"*SURFACE, NAME={name}\n{name}, {face}\n"
    deck += elastic("STEEL", "BAR", 210000.0, 0.3)
    for k, (name, turn) in enumerate((("ONE", 1.0), ("TWO", -1.0)), start=1):
        # Local x down the face, local z along the groove; the profile has its left side outside.
        deck += tool(name, (20.0, 0.0, -20.0),
                     f"0., 0., 0., 0., {turn:g}, 1.\n1., 0., 0.\n" +
                     ("START, -5., 0.\nLINE, 40., 0." if turn > 0.0 else
                      "START, 40., 0.\nLINE, -5., 0."),
                     "CYLINDER", 900000 + k)
    deck += pairs("WEST, TWO\nEAST, ONE", mu)
    deck += "*BOUNDARY\n" + "".join(f"{n}_REF, 1, 6\n" for n in ("ONE", "TWO"))
    deck += step("*BOUNDARY\nBAR.RIGHT, 1\n*DLOAD\n"
                 f"BAR, BZ, {-weight/(side*side*length):g}", "0.5, 1.", ", NAME=REST")
    deck += step("*BOUNDARY\nBAR.RIGHT, 1, 1, 0.05", "0.1, 1.", ", NAME=PULL")
    return ("""A square bar lies in a groove of 90 degrees and is pulled along it, in space.

20 x 20 x 40 mm of steel, 100 N of weight (a body force), mu = 0.2, quadratic bricks; the groove is
relieved at its root. Each side bears W/sqrt(2), so the pull is mu W sqrt(2): the groove makes
friction 1.41 times as large.""",
            "Juvinall and Marshek, Fundamentals of Machine Component Design; statics of a V-guide",
            "FORCE", "BAR.RIGHT", 1, mu*weight*sqrt(2.0), deck)


PROBLEMS = (wedge, brake_shoe, pipeline, v_block)
