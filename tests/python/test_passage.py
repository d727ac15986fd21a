"""Nothing passes through a thin body within an increment: it is cut and said, or refused."""
import pytest

import lopin


def strip(words=", NLGEOM", direct=False, turn=0, scale=1.0, full=False, arm=False, mu=0.0,
          thick=1.0, n=1):
    """A strip of 10 by 1, clamped at its left end, and a disc of radius 1 that goes down by 6."""
    nx, ny = 20, 2

    def at(x, y):
        x, y = [(x, y), (-y, x), (-x, -y), (y, -x)][turn]
        return f"{x*scale:.9e}, {y*scale:.9e}"

    def number(i, j):
        return 1 + i + (nx + 1)*j

    nodes = "\n".join(f"{number(i, j)}, {at(0.5*i, thick*j/ny)}" for j in range(ny + 1)
                      for i in range(nx + 1))
    elements = "\n".join(f"{1 + i + nx*j}, {number(i, j)}, {number(i + 1, j)}, "
                         f"{number(i + 1, j + 1)}, {number(i, j + 1)}"
                         for j in range(ny) for i in range(nx))
    y = thick + 1.5
    disc = f"START, {at(9, y)}\nCIRCL, {at(8, y - 1)}, {at(8, y)}\nCIRCL, {at(7, y)}, {at(8, y)}"
    if full:
        disc += f"\nCIRCL, {at(8, y + 1)}, {at(8, y)}\nCIRCL, {at(9, y)}, {at(8, y)}"
    down = at(0.0, -6.0).split(", ")
    motion = f"9001, 1, 1, {down[0]}\n9001, 2, 2, {down[1]}\n9001, 6"
    if arm:
        motion = "9001, 1, 2\n9001, 6, 6, 0.6"
    friction = f"*FRICTION\n{mu},\n" if mu else ""
    top = "\n".join(f"{1 + i + nx}, S3" for i in range(nx))
    clamped = "\n".join(str(number(0, j)) for j in range(ny + 1))
    return lopin.Deck.parse(f"""*HEADING
A disc across a strip
*NODE, NSET=ALL
{nodes}
*NODE, NSET=REF
9001, {at(18 if arm else 8, y)}
*ELEMENT, TYPE=CPE4, ELSET=BODY
{elements}
*NSET, NSET=END
{clamped}
*SURFACE, NAME=FACE
{top}
*MATERIAL, NAME=M
*ELASTIC
1000., 0.3
*SOLID SECTION, ELSET=BODY, MATERIAL=M
1.,
*SURFACE, NAME=TOOL, TYPE=SEGMENTS
{disc}
*RIGID BODY, ANALYTICAL SURFACE=TOOL, REF NODE=9001
*SURFACE INTERACTION, NAME=I
{friction}*CONTACT PAIR, INTERACTION=I
FACE, TOOL
*STEP, INC=1000{words}
*STATIC{', DIRECT' if direct else ''}
{1/n!r}, 1.
*BOUNDARY
END, 1, 2
{motion}
*END STEP
""", "strip")


def codes(run):
    return {d["code"] for d in run.diagnostics}


@pytest.fixture
def fine(solve):
    """Sixty increments meet the strip on their way."""
    run = solve(strip(n=60))
    assert "N0551" not in codes(run)
    return run.history["TOOL.rf1"][-1], run.history["TOOL.rf2"][-1]


@pytest.mark.parametrize("more", [{}, {"full": True}, {"n": 3}], ids=["half", "full", "three"])
def test_a_disc_does_not_jump_through_a_strip(solve, fine, more):
    run = solve(strip(**more))
    assert "N0551" in codes(run)
    assert (run.history["TOOL.rf1"][-1], run.history["TOOL.rf2"][-1]) == pytest.approx(fine,
                                                                                      rel=1e-3)


@pytest.mark.parametrize("turn, scale", [(1, 1.0), (2, 1e-3), (3, 1e3)])
def test_directions_and_units_do_not_matter(solve, fine, turn, scale):
    run = solve(strip(turn=turn, scale=scale))
    x, y = (scale*f for f in fine)
    expected = [(x, y), (-y, x), (-x, -y), (y, -x)][turn]
    assert (run.history["TOOL.rf1"][-1], run.history["TOOL.rf2"][-1]) == pytest.approx(expected,
                                                                                      rel=1e-3)


@pytest.mark.parametrize("more", [{"arm": True}, {"mu": 0.3}, {"thick": 0.2}, {"words": ""},
                                  {"words": "", "arm": True}],
                         ids=["turning", "friction", "thin", "linear", "linear turning"])
def test_other_ways_across(solve, more):
    run = solve(strip(**more))
    assert "N0551" in codes(run)
    assert abs(run.history["TOOL.rf2"][-1]) > 0.01


@pytest.mark.parametrize("words", ["", ", NLGEOM"], ids=["linear", "finite"])
def test_fixed_increments_are_refused_by_name(solve, words):
    with pytest.raises(lopin.NotConvergedError, match="E0550.*FACE passes through TOOL"):
        solve(strip(words, direct=True))
