"""Nodes on planes of symmetry under facets whose normals lean out of the plane: friction acts along what supports
leave to the node. Rows along the held direction would ask of the node what it cannot do."""
import numpy as np
import pytest

from lopin.deck import Deck
from lopin.mesh_make import block, simplices

TURN, _ = np.linalg.qr(np.array([[0.4, 0.8, -0.3], [0.7, -0.2, 0.9], [0.1, 0.5, 0.6]]))
TURN *= np.linalg.det(TURN)


def line(values):
    return ", ".join(repr(float(v)) for v in values)


def quarter(folder, method="DIRECT", q=None, unit=1.0, mu=0.3, facets=True, kind="NODE TO SURFACE"):
    """A quarter of a block under a plane that leans by 2.9 and 1.4 degrees, all of it turned by q."""
    axes = np.eye(3) if q is None else q
    mesh = block((unit, unit, unit), (3, 3, 2))
    top = [unit*np.array([x, y, 1.05 + 0.05*x + 0.025*y])@axes.T for x, y in ((-1, -1), (2, -1), (2, 2), (-1, 2))]
    if facets:
        text = ["solid d"]
        for t in ((0, 2, 1), (0, 3, 2)):
            text += ["facet normal 0 0 0", "outer loop", *("vertex " + line(top[i]).replace(",", "") for i in t),
                     "endloop", "endfacet"]
        (folder/"d.stl").write_text("\n".join([*text, "endsolid d"]) + "\n")
        tool = [f"*SURFACE, NAME=TOOL, TYPE=STL, OPEN, INPUT={folder/'d.stl'}",
                "*RIGID BODY, ANALYTICAL SURFACE=TOOL, REF NODE=9001"]
    else:
        tool = ["*NODE, NSET=T", *(f"{9011 + i}, " + line(x) for i, x in enumerate(top)),
                *(f"{9015 + i}, " + line(x + axes@[0, 0, unit]) for i, x in enumerate(top)),
                "*ELEMENT, TYPE=C3D8, ELSET=TOOL", "9001, 9011, 9012, 9013, 9014, 9015, 9016, 9017, 9018",
                "*SOLID SECTION, ELSET=TOOL, MATERIAL=M", "*RIGID BODY, ELSET=TOOL, REF NODE=9001",
                "*SURFACE, NAME=TOOL", "TOOL, S1"]
    sets = {name: mesh.point_sets[of] for name, of in (("X0", "LEFT"), ("Y0", "FRONT"), ("LOW", "BOTTOM"))}
    turned = []
    for name in ("N", "P")*(q is not None):
        turned += [f"*TRANSFORM, NSET={name}", line([*axes[:, 0], *axes[:, 1]])]
    return Deck.parse("\n".join([
        "*HEADING", "Leaning facets", "*NODE, NSET=N",
        *(f"{i + 1}, " + line(axes@x) for i, x in enumerate(mesh.points)), "*ELEMENT, TYPE=C3D8, ELSET=E",
        *(f"{i + 1}, " + ", ".join(str(n + 1) for n in row) for i, row in enumerate(mesh.blocks[0][1].tolist())),
        *(line for name, nodes in sets.items() for line in (f"*NSET, NSET={name}", *(f"{n + 1}," for n in nodes))),
        "*SURFACE, NAME=TOP", *(f"{e + 1}, S{f}" for e, f in mesh.surfaces["TOP"].tolist()),
        "*NODE, NSET=P", "9001, " + line(unit*axes@[0.5, 0.5, 2.0]),
        "*MATERIAL, NAME=M", "*ELASTIC", "1000., 0.3", "*SOLID SECTION, ELSET=E, MATERIAL=M", *tool,
        "*SURFACE INTERACTION, NAME=I", f"*SURFACE BEHAVIOR, {method}", "*FRICTION", f"{mu!r},",
        f"*CONTACT PAIR, INTERACTION=I, TYPE={kind}", "TOP, TOOL", *turned,
        "*BOUNDARY", "X0, 1", "Y0, 2", "LOW, 3", "P, 1, 2", "P, 4, 6", "*STEP, INC=100, NLGEOM", "*STATIC",
        "0.1, 1.", "*BOUNDARY", f"P, 3, 3, {-0.15*unit!r}", "*END STEP"]) + "\n", name="leaning")


def force(result, q=None, unit=1.0):
    """On the tool, in the axes of the block."""
    return (np.eye(3) if q is None else q.T)@[result.history[f"TOOL.rf{i}"][-1] for i in (1, 2, 3)]/unit**2


CASES = {"direct": {}, "turned": dict(q=TURN), "metres": dict(unit=1e-3), "augmented": dict(method="AUGMENTED LAGRANGE"),
         "perturbed": dict(method="PERTURBED LAGRANGE"), "rigid mesh": dict(facets=False), "sticks": dict(mu=5.0)}


@pytest.mark.parametrize("case", CASES)
def test_methods_agree_on_what_leaning_facets_do_at_planes_of_symmetry(solve, tmp_path, case):
    """Exact rows once gave a lateral force of 81 N where springs give 2.3 N."""
    words = CASES[case]
    soft = force(solve(quarter(tmp_path, "PENALTY", mu=words.get("mu", 0.3))))
    (tmp_path/"own").mkdir()
    exact = solve(quarter(tmp_path/"own", **words))
    assert exact.summary["certificate"]["verdict"] == "PASS"
    assert force(exact, words.get("q"), words.get("unit", 1.0)) == pytest.approx(soft, abs=0.01*abs(soft[2]))
    assert sum(exact.history["iterations"]) < (200 if case == "augmented" else 70)


def ridge(folder, method, mu=0.3):
    """A roof of 25 degrees under a valley of the same, pressed down and drawn along it."""
    rise = np.tan(np.radians(12.5))
    mesh = block((2.0, 2.0, 1.0), (2, 2, 2), origin=(-1.0, -1.0, 0.0))
    points = mesh.points + [0.0, 0.0, 1.0]*(mesh.points[:, 2:]*rise*(1.0 - abs(mesh.points[:, :1])))
    text = ["solid d"]
    for side in (1, -1):
        a, b, c, d = ((side*x, y, 1.0 + rise*(1 - x)) for x, y in ((0, -3), (2, -3), (2, 3), (0, 3)))
        for t in ((a, c, b), (a, d, c)):
            text += ["facet normal 0 0 0", "outer loop", *("vertex " + line(x).replace(",", "") for x in t[::side]),
                     "endloop", "endfacet"]
    (folder/"v.stl").write_text("\n".join([*text, "endsolid d"]) + "\n")
    return Deck.parse("\n".join([
        "*HEADING", "A roof in a valley", "*NODE, NSET=N", *(f"{i + 1}, " + line(x) for i, x in enumerate(points)),
        "*ELEMENT, TYPE=C3D8, ELSET=E",
        *(f"{i + 1}, " + ", ".join(str(n + 1) for n in row) for i, row in enumerate(mesh.blocks[0][1].tolist())),
        "*NSET, NSET=LOW", *(f"{n + 1}," for n in mesh.point_sets["BOTTOM"]), "*SURFACE, NAME=TOP",
        *(f"{e + 1}, S{f}" for e, f in mesh.surfaces["TOP"].tolist()), "*NODE, NSET=P", "9001, 0., 0., 2.",
        f"*SURFACE, NAME=TOOL, TYPE=STL, OPEN, INPUT={folder/'v.stl'}",
        "*RIGID BODY, ANALYTICAL SURFACE=TOOL, REF NODE=9001", "*MATERIAL, NAME=M", "*ELASTIC", "1000., 0.3",
        "*SOLID SECTION, ELSET=E, MATERIAL=M", "*SURFACE INTERACTION, NAME=I", f"*SURFACE BEHAVIOR, {method}",
        "*FRICTION", f"{mu!r},", "*CONTACT PAIR, INTERACTION=I", "TOP, TOOL", "*BOUNDARY", "LOW, 1, 3", "P, 1",
        "P, 4, 6", "*STEP, INC=100, NLGEOM", "*STATIC", "0.25, 1.", "*BOUNDARY", "P, 2", "P, 3, 3, -0.05", "*END STEP",
        "*STEP, INC=100, NLGEOM", "*STATIC", "0.25, 1.", "*BOUNDARY", "P, 2, 2, 0.2", "*END STEP"]) + "\n", name="roof")


def test_nodes_in_a_crease_stick_and_slide_along_it(solve, tmp_path):
    """Both walls hold the nodes in the crease; that they stick to both asks for no motion twice."""
    soft, exact = (solve(ridge(tmp_path, method)) for method in ("PENALTY", "DIRECT"))
    assert exact.summary["certificate"]["verdict"] == "PASS"
    for step in (1, 2):
        last = [np.flatnonzero(result.history["step"] == step)[-1] for result in (soft, exact)]
        for axis in (2, 3):
            force = [result.history[f"TOOL.rf{axis}"][i] for result, i in zip((soft, exact), last, strict=True)]
            assert force[1] == pytest.approx(force[0], rel=0.03, abs=0.01*abs(soft.history["TOOL.rf3"][last[0]]))
    assert sum(exact.history["iterations"]) < 60


SLOPE = np.array([-1.0, 0.0, -0.3])


def stack(gap, word, q=None, unit=1.0, tilt=0.05):
    """A quarter of a block above a quarter of a larger one, whose top leans at both planes of symmetry; turned by q."""
    axes = unit*(np.eye(3) if q is None else q)
    nodes, rows, surfaces, sets = [], [], [], {}
    for name, first, wide, lift, side in (("LOW", 1, 3.0, -2.0, "TOP"), ("UP", 1001, 2.0, gap, "BOTTOM")):
        mesh = block((wide, 2.0, wide), (round(wide), 2, round(wide)), origin=(0.0, lift, 0.0))
        level = mesh.points[:, 1].copy()
        mesh = simplices(mesh) if word == "C3D4" else mesh
        leaning = mesh.mapped(lambda x: x + tilt*np.outer(x @ SLOPE, [0.0, 1.0, 0.0]))
        nodes += [f"{first + i}, " + line(axes@x) for i, x in enumerate(leaning.points)]
        rows += [f"*ELEMENT, TYPE={word}, ELSET={name}", *(f"{first + i}, " + ", ".join(str(n + first) for n in row)
                                                           for i, row in enumerate(mesh.blocks[0][1].tolist()))]
        met = lift + 2.0*(name == "LOW")
        surfaces += [f"*SURFACE, NAME={name}_FACE", *(f"{first + e}, S{f}" for e, f in mesh.boundary().tolist() if np.all(
            np.abs(mesh.points[mesh.face_nodes(e, f), 1] - met) < 1e-12))]
        sets |= {f"{name}_X": first + np.flatnonzero(mesh.points[:, 0] == 0.0),
                 f"{name}_Z": first + np.flatnonzero(mesh.points[:, 2] == 0.0),
                 f"{name}_END": first + np.flatnonzero(np.abs(level - (-2.0 if side == "TOP" else 2.0 + gap)) < 1e-12)}
    turned = [] if q is None else ["*TRANSFORM, NSET=N", line([*q[:, 0], *q[:, 1]])]
    return Deck.parse("\n".join([
        "*HEADING", "Leaning stack", "*NODE, NSET=N", *nodes, *rows,
        *(text for name, of in sets.items() for text in (f"*NSET, NSET={name}", *(f"{n}," for n in of))), *surfaces,
        "*MATERIAL, NAME=M", "*ELASTIC", "1000., 0.3", "*SOLID SECTION, ELSET=LOW, MATERIAL=M",
        "*SOLID SECTION, ELSET=UP, MATERIAL=M", "*SURFACE INTERACTION, NAME=I", "*SURFACE BEHAVIOR, DIRECT",
        "*FRICTION", "0.3,", "*CONTACT PAIR, INTERACTION=I", "UP_FACE, LOW_FACE", *turned, "*STEP, NLGEOM", "*STATIC",
        "0.25, 1., , 0.25", "*BOUNDARY", "LOW_X, 1", "LOW_Z, 3", "UP_X, 1", "UP_Z, 3", "LOW_END, 1, 3", "UP_END, 1",
        f"UP_END, 2, 2, {unit*(-0.1 - gap)!r}", "UP_END, 3", "*END STEP"]) + "\n", name="stack")


@pytest.mark.parametrize("word, gap, more", [("C3D8", 1e-6, {}), ("C3D8", 1e-3, {}), ("C3D4", 1e-6, {}), ("C3D4", 1e-2, {}),
                                             ("C3D8", 1e-6, dict(q=TURN, unit=1e-3))])
def test_small_gaps_under_leaning_facets_leave_nodes_on_their_planes(solve, word, gap, more):
    """The foot of a gap lies beside the plane by its tilt: rows that took that for a motion had shears without bounds
    (144 iterations and no end, or 1778)."""
    found = solve(stack(gap, word, **more))
    closed = solve(stack(0.0, word))
    assert found.summary["certificate"]["verdict"] == "PASS"
    assert sum(found.history["iterations"]) < 35
    axes, unit = more.get("q", np.eye(3)), more.get("unit", 1.0)
    ends = [axis.T @ [result.history[f"UP_FACE-LOW_FACE.force{i}"][-1] for i in (1, 2, 3)]/size**2
            for result, axis, size in ((found, axes, unit), (closed, np.eye(3), 1.0))]
    assert ends[0] == pytest.approx(ends[1], abs=1e-3*abs(ends[1][1]))


@pytest.mark.parametrize("word, tilt, gap", [("C3D8", 0.4, 8e-3), ("C3D4", 0.8, 3e-3)])
def test_wider_gaps_under_steeper_facets_change_nothing(solve, word, tilt, gap):
    """The foot lies beside the plane by gap times tilt, whatever these are: 13 and 8 % of the shear were lost without
    a word where a share of a thousandth counted as a motion of the master."""
    near, far = (solve(stack(g, word, tilt=tilt)) for g in (1e-6, gap))
    ends = [r.contact(0).at(-1).force.sum(axis=0) for r in (near, far)]
    assert abs(ends[1] - ends[0]).max() < 0.01*abs(ends[0]).max()
    assert sum(far.history["iterations"]) < 40
