"""A node on springs above a rigid floor with friction: every law and method solved by hand."""
from __future__ import annotations

KN = KT = 1000.0
METHODS = ("DIRECT", "PENALTY", "PERTURBED LAGRANGE", "AUGMENTED LAGRANGE")


def table(values) -> str:
    """Pairs of time and value as an amplitude's data lines."""
    flat = [f"{v!r}" for pair in values for v in pair]
    return "\n".join(", ".join(flat[i:i + 8]) for i in range(0, len(flat), 8))


def slider(friction: str, push, drag, increment: float, method: str = "DIRECT",
           slope: float | None = None,
           height: float = 0.0, steps: str = "", plastic: str = "", direct: bool = True) -> str:
    """One node on a spring across (kn) and one along (kt) the floor, whose ends are moved.

    `push` and `drag` are (time, displacement) of the ends of the springs, `friction` the card.
    """
    behavior = f"*SURFACE BEHAVIOR, {method}"
    if slope is not None:
        behavior += f"\n{slope!r},"
    links = "".join(f"*EQUATION\n2\n{n}, 1, 1., 11, 1, -1.\n" for n in (2, 3, 12, 13, 14))
    period = max(push[-1][0], drag[-1][0])
    count = 10*round(period/increment) + 100
    return f"""*HEADING
A slider on springs, N mm
*NODE
1, -3., 2.
2, -2., 2.
3, -2., 3.
4, -3., 3.
11, 0., {height!r}
12, 1., {height!r}
13, 1., {height + 1.0!r}
14, 0., {height + 1.0!r}
9, 0., 0.
*ELEMENT, TYPE=CPS4, ELSET=ALL
1, 1, 2, 3, 4
2, 11, 12, 13, 14
*NSET, NSET=DRAGGED
1, 4
*NSET, NSET=FLATX
1, 2, 3, 4
*NSET, NSET=PUSHED
13, 14
*NSET, NSET=SOLE
11,
*NSET, NSET=REF
9,
*MATERIAL, NAME=M
*ELASTIC
1000., 0.
{plastic}*SOLID SECTION, ELSET=ALL, MATERIAL=M
1.,
{links}*EQUATION
2
12, 2, 1., 11, 2, -1.
*SURFACE, NAME=FOOT, TYPE=NODE
11, 1.
*SURFACE, NAME=FLOOR, TYPE=SEGMENTS
START, -10., 0.
LINE, 10., 0.
*RIGID BODY, ANALYTICAL SURFACE=FLOOR, REF NODE=REF
*SURFACE INTERACTION, NAME=I
{behavior}
{friction}
*CONTACT PAIR, INTERACTION=I, SMALL SLIDING
FOOT, FLOOR
*AMPLITUDE, NAME=PUSH
{table(push)}
*AMPLITUDE, NAME=DRAG
{table(drag)}
*BOUNDARY
FLATX, 2
REF, 1, 2
REF, 6
*STEP, INC={count}
*STATIC{', DIRECT' if direct else ''}
{increment!r}, {period!r}
*BOUNDARY, AMPLITUDE=PUSH
PUSHED, 2, 2, -1.
*BOUNDARY, AMPLITUDE=DRAG
DRAGGED, 1, 1, 1.
*NODE FILE
U, RF
*EL FILE
S
*CONTACT FILE
CDIS, CSTR
*END STEP
{steps}"""


def rotating(steps: int, turns: int, friction: str = "*FRICTION\n0.3,", method: str = "DIRECT",
             radius: float = 0.2) -> str:
    """A node pressed by 100 N on a floor, dragged by springs across whose ends go round in a
    circle."""
    import math
    cube = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    bodies = {11: (0.0, 0.0, 0.0), 21: (-3.0, 0.0, 5.0), 31: (0.0, -3.0, 5.0)}
    nodes = "\n".join(f"{first + i}, " + ", ".join(repr(float(a + b)) for a, b in zip(c, at))
                      for first, at in bodies.items() for i, c in enumerate(cube))
    links = [(n, d) for d in (1, 2) for n in range(12, 19)] + [(n, 3) for n in (12, 13, 14)]
    links += [(21 + i, 1) for i, c in enumerate(cube)
              if c[0] == 1] + [(31 + i, 2) for i, c in enumerate(cube) if c[1] == 1]
    equations = "".join(f"*EQUATION\n2\n{n}, {d}, 1., 11, {d}, -1.\n" for n, d in links)
    angle = [2.0*math.pi*i/steps for i in range(turns*steps + 1)]
    time = [2.0 + i/steps for i in range(turns*steps + 1)]
    east = [(0.0, 0.0), (1.0, 0.0), *((t, radius*math.cos(a)) for t, a in zip(time, angle))]
    north = [(0.0, 0.0), (2.0, 0.0),
             *((t, radius*math.sin(a)) for t, a in zip(time[1:], angle[1:]))]
    return f"""*HEADING
A slider whose load turns, N mm
*NODE
{nodes}
9, 0., 0., 0.
*ELEMENT, TYPE=C3D8, ELSET=ALL
1, 11, 12, 13, 14, 15, 16, 17, 18
2, 21, 22, 23, 24, 25, 26, 27, 28
3, 31, 32, 33, 34, 35, 36, 37, 38
*NSET, NSET=TOP
15, 16, 17, 18
*NSET, NSET=WEST
21, 24, 25, 28
*NSET, NSET=SOUTH
31, 32, 35, 36
*NSET, NSET=EASTERLY, GENERATE
21, 28, 1
*NSET, NSET=NORTHERLY, GENERATE
31, 38, 1
*NSET, NSET=REF
9,
*MATERIAL, NAME=M
*ELASTIC
1000., 0.
*SOLID SECTION, ELSET=ALL, MATERIAL=M
{equations}*SURFACE, NAME=FOOT, TYPE=NODE
11, 1.
*SURFACE, NAME=FLOOR, TYPE=CYLINDER
0., 0., 0., 1., 0., 0.
0., -1., 0.
START, -10., 0.
LINE, 10., 0.
*RIGID BODY, ANALYTICAL SURFACE=FLOOR, REF NODE=REF
*SURFACE INTERACTION, NAME=I
*SURFACE BEHAVIOR, {method}
{friction}
*CONTACT PAIR, INTERACTION=I, SMALL SLIDING
FOOT, FLOOR
*AMPLITUDE, NAME=EAST
{table(east)}
*AMPLITUDE, NAME=NORTH
{table(north)}
*AMPLITUDE, NAME=PUSH
0., 0., 1., 1., 100., 1.
*BOUNDARY
EASTERLY, 2, 3
NORTHERLY, 1
NORTHERLY, 3
REF, 1, 6
*STEP, INC={(turns + 4)*steps}
*STATIC, DIRECT
{1.0/steps!r}, {2.0 + turns!r}
*BOUNDARY, AMPLITUDE=PUSH
TOP, 3, 3, -0.1
*BOUNDARY, AMPLITUDE=EAST
WEST, 1, 1, 1.
*BOUNDARY, AMPLITUDE=NORTH
SOUTH, 2, 2, 1.
*NODE FILE, FREQUENCY=1000
U
*CONTACT FILE, FREQUENCY=1000
CDIS
*END STEP
"""
