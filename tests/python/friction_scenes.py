"""A node on springs above a rigid floor with friction: every law and method solved by hand."""
from __future__ import annotations

KN = KT = 1000.0
METHODS = ("DIRECT", "PENALTY", "PERTURBED LAGRANGE", "AUGMENTED LAGRANGE")


def table(values) -> str:
    """Pairs of time and value as an amplitude's data lines."""
    flat = [f"{v!r}" for pair in values for v in pair]
    return "\n".join(", ".join(flat[i:i + 8]) for i in range(0, len(flat), 8))


def slider(friction: str, push, drag, increment: float, method: str = "DIRECT", slope: float | None = None,
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
