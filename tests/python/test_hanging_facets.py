"""Metal that spreads past the corner of a meshed die, surface to surface."""
import pytest

import lopin
from lopin.deck import Deck
from lopin.mesh_make import block

#: Force at 1.5 mm on 32 x 24 cells (CPE4, 2082 N) and 16 x 12 (CPE8R, 2049 N), increments of 0.02.
FINE = 2065.0


def bodies(kind, *parts):
    """Rectangles (name, size, cells, origin) one after the other: their cards, faces and nodes by side."""
    text, skin, sets = [], {}, {}
    for start, (name, size, cells, origin) in zip(range(0, 10000, 1000), parts):
        mesh = block(size, cells, origin=origin, quadratic=kind.startswith("CPE8"))
        text += [f"*NODE, NSET=N{name}", *(f"{start + i + 1}, {x!r}, {y!r}" for i, (x, y)
                                           in enumerate(mesh.points.tolist())),
                 f"*ELEMENT, TYPE={kind}, ELSET=E{name}"]
        text += [f"{start + i + 1}, " + ", ".join(str(start + n + 1) for n in row)
                 for _, rows in mesh.blocks for i, row in enumerate(rows.tolist())]
        for side, faces in mesh.surfaces.items():
            skin[name, side] = [f"{start + e + 1}, S{f}" for e, f in faces.tolist()]
        for side, nodes in mesh.point_sets.items():
            sets[name, side] = [f"{start + n + 1}," for n in nodes.tolist()]
        text += [f"*SOLID SECTION, ELSET=E{name}, MATERIAL=M{'A' if name == 'A' else 'B'}", "1.,"]
    return text, skin, sets


def pressed_between(kind, block_, dies, steps, held=()):
    """A block on a floor under dies that come down together, one mortar pair each."""
    text, skin, sets = bodies(kind, block_, *dies)
    names = [name for name, *_ in dies]
    text = ["*HEADING", "A block under meshed dies", *text, "*NSET, NSET=MIDDLE", *sets["A", "LEFT"],
            *(node for name in held for node in sets[name, "LEFT"]), "*NSET, NSET=FLOOR",
            *sets["A", "BOTTOM"], "*NSET, NSET=RAM", *(n for name in names for n in sets[name, "TOP"]),
            "*SURFACE, NAME=UP", *skin["A", "TOP"]]
    for name in names:
        text += [f"*SURFACE, NAME=FACE{name}", *skin[name, "BOTTOM"]]
    text += ["*MATERIAL, NAME=MA", "*ELASTIC", "70000., 0.3", "*PLASTIC", "100., 0.", "300., 1.",
             "*MATERIAL, NAME=MB", "*ELASTIC", "210000., 0.3", "*SURFACE INTERACTION, NAME=I",
             "*FRICTION", "0.1,"]
    for name in names:
        text += ["*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE", f"UP, FACE{name}"]
    text += ["*BOUNDARY", "MIDDLE, 1", "FLOOR, 2", "RAM, 1"]
    for down in steps:
        text += ["*STEP, NLGEOM, INC=500", "*STATIC", "*BOUNDARY", f"RAM, 2, 2, {-down!r}",
                 "*END STEP"]
    return Deck.parse("\n".join(text) + "\n", name="spread")


def spread(kind, downs, cells=(3, 2)):
    """A quarter of a block, 5 by 4, pressed by a stiff die 7 wide, by one step for each way."""
    return pressed_between(kind, ("A", (5.0, 4.0), cells, (0.0, 0.0)),
                           [("B", (7.0, 4.0), (4, 2), (0.0, 4.0))], downs, held="B")


def pressed(solve, kind, downs):
    result = solve(spread(kind, downs))
    told = [w["message"] for w in result.diagnostics if w["code"] == "W0345"]
    return abs(result.history["UP-FACEB.force2"][-1]), told


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


def test_a_seam_between_two_dies_hangs_past_neither(solve):
    """A facet under the edges of both is covered: 22 % of the area in contact hung past one of them."""
    metal = ("A", (6.0, 4.0), (5, 2), (0.0, 0.0))
    force, told = [], []
    for dies in ([("B", (7.0, 3.0), (4, 1), (0.0, 4.0))],
                 [("B", (3.0, 3.0), (2, 1), (0.0, 4.0)), ("C", (4.0, 3.0), (2, 1), (3.0, 4.0))]):
        result = solve(pressed_between("CPE4", metal, dies, [0.1]))
        force.append(sum(abs(result.history[f"UP-FACE{name}.force2"][-1]) for name, *_ in dies))
        told += [w for w in result.diagnostics if w["code"] == "W0345"]
    assert not told and force[1] == pytest.approx(force[0], rel=0.02)


def test_a_die_whose_edge_cuts_into_its_master_is_told_to_be_exchanged():
    """With the metal as slave the same way ends, as it does with the die as slave surface to surface."""
    text = spread("CPE4", [3.2]).text().replace("TYPE=SURFACE TO SURFACE\nUP, FACEB", "TYPE=NODE TO SURFACE\nFACEB, UP")
    with pytest.raises(lopin.NotConvergedError, match=r"exchange slave and master of \(FACEB, UP\): node 10"):
        lopin.run(Deck.parse(text.replace("*STATIC", "*STATIC\n0.05, 1., 0.02"), name="cut"), executable=True)
