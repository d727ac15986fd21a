"""A tool smaller than a facet goes through the slave between its nodes: no row sees it, so that it must be told."""
import pytest

from lopin import Deck

# The round tool is 1 wide, its lowest point 1 above the block; nodes are 2.5 apart.
TOOLS = {2: ["*SURFACE, NAME=STOP, TYPE=SEGMENTS", "START, {right}, 11.5", "CIRCL, {x}, 11, {x}, 11.5",
             "CIRCL, {left}, 11.5, {x}, 11.5"]}


def lifted(x, way, direction=1.0, path="AUTO", kind="CPE4", increments=4):
    """A block of 10 by 10, all its nodes moved by `way` against a stop above it."""
    n, quadratic = 4, kind.endswith("8")
    lines = [f"*LOPIN, PATH={path}", "*NODE"]
    m = 2*n if quadratic else n
    places = [(i, j) for j in range(m + 1) for i in range(m + 1) if not (quadratic and i % 2 and j % 2)]
    label = {place: k + 1 for k, place in enumerate(places)}
    lines += [f"{label[p]}, {10.0*p[0]/m}, {10.0*p[1]/m}" for p in places]
    lines += [f"*ELEMENT, TYPE={kind}, ELSET=BLOCK"]
    s = m//n
    for k, (i, j) in enumerate((s*i, s*j) for j in range(n) for i in range(n)):
        corners = [(i, j), (i + s, j), (i + s, j + s), (i, j + s)]
        middles = [(i + 1, j), (i + s, j + 1), (i + 1, j + s), (i, j + 1)] if quadratic else []
        lines.append(", ".join(map(str, [k + 1, *(label[p] for p in corners + middles)])))
    lines += ["*ELSET, ELSET=TOP, GENERATE", f"{n*(n - 1) + 1}, {n*n}", "*SURFACE, NAME=TOP", "TOP, S3",
              "*NSET, NSET=ALL, GENERATE", f"1, {len(places)}", "*MATERIAL, NAME=STEEL", "*ELASTIC", "210000., 0.3",
              "*SOLID SECTION, ELSET=BLOCK, MATERIAL=STEEL", "*NODE, NSET=STOP_REF", "9001, 0, 20"]
    lines += [line.format(x=x, left=x - 0.5, right=x + 0.5) for line in TOOLS[2]]
    lines += ["*RIGID BODY, ANALYTICAL SURFACE=STOP, REF NODE=STOP_REF", "*SURFACE INTERACTION, NAME=TOUCH",
              "*SURFACE BEHAVIOR, PENALTY", "*CONTACT PAIR, INTERACTION=TOUCH", "TOP, STOP", "*BOUNDARY",
              "STOP_REF, 1, 2", "STOP_REF, 6", "ALL, 1", "*STEP, NLGEOM=NO", "*STATIC", f"{1.0/increments}, 1.",
              "*BOUNDARY", f"ALL, 2, 2, {way*direction}", "*END STEP"]
    return Deck.parse("\n".join(lines) + "\n", name="lifted")


def told(result):
    return [d["message"] for d in result.diagnostics if d["code"] == "W0337"]


@pytest.mark.parametrize("path", ["AUTO", "FINITE"])
@pytest.mark.parametrize("kind, x", [("CPE4", 3.75), ("CPE4", 6.0), ("CPE8", 3.1)])
def test_a_tool_that_goes_through_a_face_is_named(solve, path, kind, x):
    text = told(solve(lifted(x, 4.0, path=path, kind=kind), refused=True))
    assert any("STOP" in line and "TOP" in line and "goes through face S3" in line for line in text), text


@pytest.mark.parametrize("path", ["AUTO", "FINITE"])
@pytest.mark.parametrize("x, way", [(3.75, 0.9), (3.75, -4.0), (13.0, 4.0), (-3.0, 4.0)])
def test_one_that_stays_outside_is_not(solve, path, x, way):
    assert not told(solve(lifted(x, way, path=path)))


def ball(path, x):
    """Bricks of 2, moved up against a ball of radius 0.5 above the point (x, x)."""
    lines = [f"*LOPIN, PATH={path}", "*NODE"]
    lines += [f"{1 + i + 4*j + 16*k}, {2.0*i}, {2.0*j}, {2.0*k}" for k in range(2) for j in range(4) for i in range(4)]
    lines += ["*ELEMENT, TYPE=C3D8, ELSET=BLOCK"]
    for n, (i, j) in enumerate((i, j) for j in range(3) for i in range(3)):
        corners = [1 + i + a + 4*(j + b) + 16*c for c in (0, 1) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
        lines.append(", ".join(map(str, [n + 1, *corners])))
    lines += ["*NSET, NSET=ALL, GENERATE", "1, 32", "*SURFACE, NAME=TOP", "BLOCK, S2", "*MATERIAL, NAME=STEEL",
              "*ELASTIC", "1e5, 0.3", "*SOLID SECTION, ELSET=BLOCK, MATERIAL=STEEL", "*NODE, NSET=BALL_REF",
              f"900, {x}, {x}, 9", "*SURFACE, NAME=BALL, TYPE=REVOLUTION", f"{x}, {x}, 3.5, {x}, {x}, 9.",
              "START, 0., 0.5", "CIRCL, 0.5, 0., 0., 0.", "CIRCL, 0., -0.5, 0., 0.",
              "*RIGID BODY, ANALYTICAL SURFACE=BALL, REF NODE=BALL_REF", "*SURFACE INTERACTION, NAME=TOUCH",
              "*SURFACE BEHAVIOR, PENALTY", "*CONTACT PAIR, INTERACTION=TOUCH", "TOP, BALL", "*BOUNDARY",
              "BALL_REF, 1, 6", "ALL, 1, 2", "*STEP", "*STATIC", "0.25, 1.", "*BOUNDARY", "ALL, 3, 3, 4.", "*END STEP"]
    return Deck.parse("\n".join(lines) + "\n", name="ball")


@pytest.mark.parametrize("path", ["AUTO", "FINITE"])
def test_a_ball_goes_through_a_face_in_space(solve, path):
    text = told(solve(ball(path, 3.0), refused=True))
    assert any("BALL" in line and "goes through face S2 of element 5" in line for line in text), text
    assert not told(solve(ball(path, 9.0)))
