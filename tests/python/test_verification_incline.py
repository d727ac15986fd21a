"""A17: a pad falls on an inclined plane and is pushed up along it (code_aster SSNV503)."""
import lopin
import numpy as np
import pytest

C, S = np.cos(np.pi/6.0), np.sin(np.pi/6.0)


def pad(share: float) -> str:
    """40 by 40 mm, almost rigid, 2 mm above a plane at 30 degrees; springs of 4 N/mm along, 0.01
    N/mm across."""
    at = {1: (-20.0, 2.0), 2: (20.0, 2.0), 3: (20.0, 42.0), 4: (-20.0, 42.0)}
    nodes = "".join(f"{k}, {float(C*s - S*n)!r}, {float(S*s + C*n)!r}\n"
                    for k, (s, n) in at.items())
    for first in (10, 20):
        nodes += "".join(f"{first + i}, {float(-200 + x)!r}, {float(first + y)!r}\n"
                         for i, (x, y) in enumerate(((0, 0), (1, 0), (1, 1), (0, 1))))
    links = "".join(f"*EQUATION\n3\n{node}, 1, 1., 1, 1, {-float(a)!r}, 1, 2, {-float(b)!r}\n"
                    for first, a, b in ((10, C, S), (20, -S, C)) for node in (first + 1, first + 2))
    push = 0.5*share*3600.0
    pushes = "".join(f"{k}, 1, {float(push*C)!r}\n{k}, 2, {float(push*S)!r}\n" for k in (1, 2))
    return f"""*NODE
{nodes}99, 0., 0.
*ELEMENT, TYPE=CPS4, ELSET=PAD
1, 1, 2, 3, 4
*ELEMENT, TYPE=CPS4, ELSET=ALONG
2, 10, 11, 12, 13
*ELEMENT, TYPE=CPS4, ELSET=ACROSS
3, 20, 21, 22, 23
*MATERIAL, NAME=STIFF
*ELASTIC
1.E8, 0.
*MATERIAL, NAME=SPRING
*ELASTIC
4., 0.
*MATERIAL, NAME=SOFT
*ELASTIC
0.01, 0.
*SOLID SECTION, ELSET=PAD, MATERIAL=STIFF
1.,
*SOLID SECTION, ELSET=ALONG, MATERIAL=SPRING
1.,
*SOLID SECTION, ELSET=ACROSS, MATERIAL=SOFT
1.,
{links}*SURFACE, NAME=FOOT
PAD, S1
*SURFACE, NAME=PLANE, TYPE=SEGMENTS
START, {float(-90*C)!r}, {float(-90*S)!r}
LINE, {float(90*C)!r}, {float(90*S)!r}
*RIGID BODY, ANALYTICAL SURFACE=PLANE, REF NODE=99
*SURFACE INTERACTION, NAME=DRY
*SURFACE BEHAVIOR, DIRECT
*FRICTION
0.3,
*CONTACT PAIR, INTERACTION=DRY, SMALL SLIDING
FOOT, PLANE
*BOUNDARY
10, 1, 2
13, 1, 2
11, 2
12, 2
20, 1, 2
23, 1, 2
21, 2
22, 2
99, 1, 2
99, 6
*STEP
*STATIC
1., 1.
*DLOAD
PAD, P3, 300.
*END STEP
*STEP
*STATIC
0.5, 1.
*CLOAD
{pushes}*NODE FILE
U
*CONTACT FILE
CDIS, CSTR
*END STEP
"""


@pytest.mark.parametrize("share, slip", [(0.99, 0.0), (1.01, (36.0 + 0.3*0.02)/4.0)])
def test_a_pad_on_an_inclined_plane(solve, sheet, share, slip):
    result = solve(lopin.Deck.parse(pad(share), name="pad"))
    case, start = "A17 pad on an inclined plane", f"{share} of the bound: "
    # The soft spring across takes 0.02 N off the pressing 12 000: the slip is 9.0015 instead of 9.
    across, along = result["U"][0, :2]
    sheet.compare(case, start + "u_x of A", across, 2.0*S + slip*C, 1e-4)
    sheet.compare(case, start + "u_y of A", along, -2.0*C + slip*S, 1e-4)
    force = np.asarray(result.contact().last["force"]).sum(axis=0)
    sheet.compare(case, start + "normal resultant", -S*force[0] + C*force[1], 12000.0, 1e-5)
