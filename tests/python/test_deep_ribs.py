"""Ribs that go in deeper than they are wide, small displacements: a node meets the wall that it faced,
however the rib is turned, and neither a side of the rib nor the corner behind it."""
import numpy as np
import pytest

from lopin.deck import Deck
from lopin.mesh_make import block
from test_narrow_tools import rib

FAR = ("1e-9", 12.0, 45.0, 90.0, 211.7)


def turned(points, angle):
    """Points turned in the plane."""
    c, s = np.cos(np.radians(float(angle))), np.sin(np.radians(float(angle)))
    points = np.array(points, dtype=float)
    points[:, :2] = points[:, :2] @ np.array([[c, s], [-s, c]])
    return points


def stl(path, line, angle):
    """A profile drawn out along z, as triangles whose outward side is that of the profile."""
    line = turned(line, angle)
    text = ["solid rib"]
    for a, b in zip(line[:-1], line[1:]):
        corners = [(*a, -3.0), (*b, -3.0), (*b, 6.0), (*a, 6.0)]
        for three in ((0, 2, 1), (0, 3, 2)):
            text += ["facet normal 0 0 0", "outer loop",
                     *("vertex %r %r %r" % tuple(map(float, corners[k])) for k in three),
                     "endloop", "endfacet"]
    path.write_text("\n".join([*text, "endsolid rib"]) + "\n")


def scene(width, angle=0.0, path="", kind="plane", how="", pair="", shift=0.0, folder=None):
    """A block 40 by 10 under a rib that goes down by 1.2; its top is at 0 before all is turned."""
    solid = kind != "plane"
    mesh = block((40.0, 10.0, 2.5)[:2 + solid], (16, 4, 1)[:2 + solid],
                 origin=(0.0, -10.0, 0.0)[:2 + solid])
    ways = rib(22.5 + shift, width)
    line = [tuple(float(v) for v in w.split(",")[1:]) for w in ways]
    text = ["*HEADING", "A deep rib", *([f"*LOPIN, PATH={path}"] if path else []), "*NODE, NSET=N"]
    text += [f"{i + 1}, " + ", ".join(map(repr, x))
             for i, x in enumerate(turned(mesh.points, angle).tolist())]
    text += [f"*ELEMENT, TYPE={'C3D8' if solid else 'CPE4'}, ELSET=E"]
    for _, rows in mesh.blocks:
        text += [f"{i + 1}, " + ", ".join(str(n + 1) for n in r) for i, r in enumerate(rows.tolist())]
    if how == "NODES":
        top = np.flatnonzero(np.isclose(mesh.points[:, 1], 0.0))
        text += ["*SURFACE, NAME=TOP, TYPE=NODE", *(f"{n + 1}, {2.5*(1 + solid)/2.0!r}" for n in top)]
    else:
        faces = mesh.surfaces["BACK" if solid else "TOP"].tolist()
        text += ["*SURFACE, NAME=TOP", *(f"{e + 1}, S{f}" for e, f in faces)]
    low = np.flatnonzero(np.isclose(mesh.points[:, 1], -10.0))
    text += ["*NSET, NSET=LOW", *(f"{n + 1}," for n in low), "*NODE, NSET=P",
             "9001, 0., 0." + (", 0." if solid else "")]
    if kind == "stl":
        stl(folder/"rib.stl", line, angle)
        text += [f"*SURFACE, NAME=TOOL, TYPE=STL, OPEN, INPUT={folder/'rib.stl'}"]
    elif solid:
        first = turned([(1.0, 0.0, 0.0)], angle)[0].tolist()
        text += ["*SURFACE, NAME=TOOL, TYPE=CYLINDER",
                 "0., 0., 0., " + ", ".join(map(repr, first)), "0., 0., 1.", *ways]
    else:
        text += ["*SURFACE, NAME=TOOL, TYPE=SEGMENTS",
                 *(("LINE" if k else "START") + ", " + ", ".join(map(repr, x))
                   for k, x in enumerate(turned(line, angle).tolist()))]
    down = turned([(0.0, -1.2)], angle)[0]
    sides = [f"{n + 1}, 3" for n in range(len(mesh.points))] if solid else []
    text += ["*RIGID BODY, ANALYTICAL SURFACE=TOOL, REF NODE=9001", "*MATERIAL, NAME=M",
             "*ELASTIC", "1000., 0.3", "*SOLID SECTION, ELSET=E, MATERIAL=M",
             *([] if solid else ["1.,"]), "*SURFACE INTERACTION, NAME=I",
             *(["*SURFACE BEHAVIOR, PENALTY", "1e7"] if how == "PENALTY" else []),
             f"*CONTACT PAIR, INTERACTION=I{pair}", "TOP, TOOL", "*BOUNDARY", "LOW, 1, 2", *sides,
             "P, 4, 6" if solid else "P, 6", *(["P, 3"] if solid else []), "*STEP, INC=1000",
             "*STATIC", "0.1, 1.", "*BOUNDARY",
             *(f"P, {k + 1}, {k + 1}, {float(v)!r}" for k, v in enumerate(down)), "*END STEP"]
    return Deck.parse("\n".join(text) + "\n", name="deep")


def force(result, angle=0.0):
    """Of the tool, along and across its way, before all was turned."""
    rf = [result.history[f"TOOL.rf{k}"][-1] for k in (1, 2)]
    return turned([rf], -float(angle))[0]


def check(result, angle, right):
    along, down = force(result, angle)
    assert abs(along) < 1e-6*abs(right), f"it pushes aside by {along}"
    assert down == pytest.approx(right, rel=1e-6)


@pytest.fixture(scope="module")
def right(executable, tmp_path_factory):
    """The force of the path that follows the motion."""
    import lopin
    folder = tmp_path_factory.mktemp("right")
    return force(lopin.run(scene(1.8, path="FINITE"), folder/"run", executable=True))[1]


@pytest.mark.parametrize("width", [1.4, 1.8, 2.0, 2.2])
def test_ribs_of_any_width(solve, right, width):
    # One node meets the rib: its width does not count.
    check(solve(scene(width)), 0.0, right)


@pytest.mark.parametrize("angle", FAR)
@pytest.mark.parametrize("width", [1.8, 2.0])
def test_a_turned_rib(solve, right, width, angle):
    check(solve(scene(width, angle)), angle, right)


@pytest.mark.parametrize("shift", [-0.5, -0.1, 0.1, 0.5])
def test_a_rib_beside_the_node(solve, right, shift):
    check(solve(scene(1.8, 12.0, shift=shift)), 12.0, right)


@pytest.mark.parametrize("how", ["NODES", "PENALTY", "FACES"])
def test_slaves_and_methods(solve, right, how):
    pair = ", TYPE=SURFACE TO SURFACE" if how == "FACES" else ""
    _, down = force(solve(scene(1.8, 12.0, how=how, pair=pair)), 12.0)
    along, _ = force(solve(scene(2.0, 12.0, how=how, pair=pair)), 12.0)
    assert abs(along) < 1e-6*abs(right)
    assert down == pytest.approx(right, rel=1e-3)


@pytest.mark.parametrize("kind", ["drawn", "stl"])
@pytest.mark.parametrize("angle", [0.0, 12.0])
def test_ribs_in_space(solve, right, tmp_path, kind, angle):
    check(solve(scene(1.8, angle, kind=kind, folder=tmp_path)), angle, 2.5*right)


def test_a_tip_on_a_node_presses_straight(go):
    from test_feature_tools import punch

    result = go(punch("*BOUNDARY\nPUNCH_REF, 2, 2, -0.2"))
    aside, down = (result.history[f"B_TOP-PUNCH.force{k}"][-1] for k in (1, 2))
    assert down < 0.0 and abs(aside) < 1e-9*abs(down)
