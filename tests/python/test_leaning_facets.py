"""Nodes on planes of symmetry under facets whose normals lean out of the plane: friction acts along what supports
leave to the node. Rows along the held direction would ask of the node what it cannot do."""
import numpy as np
import pytest

from lopin.deck import Deck
from lopin.mesh_make import block

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
