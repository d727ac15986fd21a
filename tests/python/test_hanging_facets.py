"""Metal that spreads past the corner of a meshed die, surface to surface."""
import pytest

from lopin.deck import Deck
from lopin.mesh_make import block

#: Force at 1.5 mm on 32 x 24 cells (CPE4, 2082 N) and 16 x 12 (CPE8R, 2049 N), increments of 0.02.
FINE = 2065.0


def spread(kind, downs, cells=(3, 2)):
    """A quarter of a block, 5 by 4, pressed by a stiff die 7 wide, by one step for each way."""
    second = kind.startswith("CPE8")
    text = ["*HEADING", "A block that spreads past its die"]
    skin, sets = {}, {}
    for name, mesh, start in (("A", block((5.0, 4.0), cells, quadratic=second), 0),
                              ("B", block((7.0, 4.0), (4, 2), origin=(0.0, 4.0),
                                          quadratic=second), 1000)):
        text += [f"*NODE, NSET=N{name}", *(f"{start + i + 1}, {x!r}, {y!r}" for i, (x, y)
                                           in enumerate(mesh.points.tolist())),
                 f"*ELEMENT, TYPE={kind}, ELSET=E{name}"]
        text += [f"{start + i + 1}, " + ", ".join(str(start + n + 1) for n in row)
                 for _, rows in mesh.blocks for i, row in enumerate(rows.tolist())]
        for side, faces in mesh.surfaces.items():
            skin[name, side] = [f"{start + e + 1}, S{f}" for e, f in faces.tolist()]
        for side, nodes in mesh.point_sets.items():
            sets[name, side] = [f"{start + n + 1}," for n in nodes.tolist()]
        text += [f"*SOLID SECTION, ELSET=E{name}, MATERIAL=M{name}", "1.,"]
    text += ["*NSET, NSET=MIDDLE", *sets["A", "LEFT"], *sets["B", "LEFT"], "*NSET, NSET=FLOOR",
             *sets["A", "BOTTOM"], "*NSET, NSET=RAM", *sets["B", "TOP"], "*SURFACE, NAME=UP",
             *skin["A", "TOP"], "*SURFACE, NAME=FACE", *skin["B", "BOTTOM"], "*MATERIAL, NAME=MA",
             "*ELASTIC", "70000., 0.3", "*PLASTIC", "100., 0.", "300., 1.", "*MATERIAL, NAME=MB",
             "*ELASTIC", "210000., 0.3", "*SURFACE INTERACTION, NAME=I", "*FRICTION", "0.1,",
             "*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE", "UP, FACE",
             "*BOUNDARY", "MIDDLE, 1", "FLOOR, 2", "RAM, 1"]
    for down in downs:
        text += ["*STEP, NLGEOM, INC=500", "*STATIC", "*BOUNDARY", f"RAM, 2, 2, {-down!r}",
                 "*END STEP"]
    return Deck.parse("\n".join(text) + "\n", name="spread")


def pressed(solve, kind, downs):
    result = solve(spread(kind, downs))
    told = [w["message"] for w in result.diagnostics if w["code"] == "W0345"]
    return abs(result.history["UP-FACE.force2"][-1]), told


@pytest.mark.parametrize("kind", ["CPE8", "CPE8R"])
def test_the_force_does_not_depend_on_where_increments_end(solve, kind):
    """A node that left its die within an increment pressed to its end: 1982 and 2207 N (CPE8)."""
    at_once, told = pressed(solve, kind, [1.5])
    by_steps, also = pressed(solve, kind, [0.5, 1.5])
    assert at_once == pytest.approx(by_steps, rel=0.01)
    assert told and also and at_once == pytest.approx(FINE, rel=0.1)


@pytest.mark.parametrize("kind", ["CPE4", "CPE4I"])
def test_what_hangs_past_the_corner_is_told_beside_its_error(solve, kind):
    force, told = pressed(solve, kind, [1.5])
    share = float(told[0].partition(": ")[2].split(" %")[0])/100.0
    assert 0.03 < force/FINE - 1.0 < share + 0.02


def test_what_is_covered_is_not_told(solve):
    assert not pressed(solve, "CPE8", [1.0])[1]
