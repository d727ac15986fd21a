"""A tool that turns far in an increment under what slides on it: never the chord without a word."""
from math import radians

import pytest

import lopin


def disc(angle, first, words=", NLGEOM", direct="", friction="*FRICTION\n0.2,"):
    """A square block of 4 by 4 bricks; a flat tool pressed on it turns about its normal."""
    n, layers = 4, range(2)

    def at(i, j, k):
        return 1 + i + (n + 1)*(j + (n + 1)*k)

    every = range(n + 1)
    nodes = "\n".join(f"{at(i, j, k)}, {2*i/n - 1}, {2*j/n - 1}, {k - 1}"
                      for k in layers for j in every for i in every)
    bricks = [(i, j) for j in range(n) for i in range(n)]
    elements = "\n".join(", ".join(str(v) for v in (
        1 + i + n*j, *(at(i + a, j + b, k) for k in layers for a, b in
                       ((0, 0), (1, 0), (1, 1), (0, 1))))) for i, j in bricks)
    held = "\n".join(f"{at(i, j, 0)}, 1, 3" for j in every for i in every)
    face = "\n".join(f"{1 + i + n*j}, S2" for i, j in bricks)
    return lopin.Deck.parse(f"""*NODE
{nodes}
9001, 0., 0., 0.
*ELEMENT, TYPE=C3D8, ELSET=B
{elements}
*SURFACE, NAME=F
{face}
*MATERIAL, NAME=M
*ELASTIC
20000., 0.
*SOLID SECTION, ELSET=B, MATERIAL=M
*SURFACE, NAME=W, TYPE=CYLINDER
0., 0., 0., -1., 0., 0.
0., -1., 0.
START, -20., 0.
LINE, 20., 0.
*RIGID BODY, ANALYTICAL SURFACE=W, REF NODE=9001
*SURFACE INTERACTION, NAME=I
{friction}
*CONTACT PAIR, INTERACTION=I
F, W
*BOUNDARY
{held}
*STEP{words}
*STATIC
1., 1.
*BOUNDARY
9001, 1, 2, 0.
9001, 4, 6, 0.
9001, 3, 3, -0.001
*END STEP
*STEP, INC=1000{words}
*STATIC{direct}
{first!r}, 1.
*BOUNDARY
9001, 6, 6, {radians(angle)!r}
*END STEP
""", "disc")


def turned(solve, *more, **options):
    result = solve(disc(*more, **options))
    work = result.history["energy.friction"]
    codes = {d["code"] for d in result.diagnostics}
    return result.history["W.rf6"][-1], work[-1] - work[0], codes, len(work) - 1


@pytest.mark.parametrize("friction", ["*FRICTION\n0.2,", "*FRICTION, TAUMAX=2.\n0.9,"],
                         ids=["coulomb", "shear limit"])
@pytest.mark.parametrize("angle", [15.0, 90.0, 360.0])
def test_an_increment_is_cut_to_six_degrees(solve, angle, friction):
    torque, work, codes, increments = turned(solve, angle, 1.0, friction=friction)
    # Steps of one degree, over ten of them, are the reference.
    exact, _, none, _ = turned(solve, 10.0, 0.1, direct=", DIRECT", friction=friction)
    assert torque == pytest.approx(exact, rel=2e-3) and "N0551" in codes
    assert work == pytest.approx(exact*radians(angle), rel=2e-2 if angle < 90.0 else 4e-3)
    assert angle/6.0 <= increments <= angle/6.0*1.4 + 3
    assert not {"W0553", "N0551"} & none


@pytest.mark.parametrize("angle", [15.0, 90.0, 360.0])
def test_an_increment_that_may_not_be_cut_says_it(solve, angle):
    _, _, codes, increments = turned(solve, angle, 1.0, direct=", DIRECT")
    assert "W0553" in codes and increments == 1


def test_the_linear_path_follows_the_turn(solve):
    torque, work, codes, _ = turned(solve, 360.0, 1.0, words="")
    exact, _, _, _ = turned(solve, 10.0, 0.1, words="", direct=", DIRECT")
    assert torque == pytest.approx(exact, rel=1e-5)
    assert work == pytest.approx(exact*radians(360.0), rel=2e-3)
    assert not {"W0553", "N0551"} & codes
