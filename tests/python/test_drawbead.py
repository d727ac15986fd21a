"""Drawbeads: a strip that is pulled through one is held back by force per length times length."""
import numpy as np
import pytest

import lopin
from lopin import mesh_make
from lopin.drawbead import drawbead
from lopin.errors import ModelError

#: In front of the steps, behind the sheet; and the steps: press, pull.
DIE = {2: ["*NODE", "9900, 0., -5.", "*SURFACE, NAME=DIE, TYPE=SEGMENTS", "START, -50., 0.",
           "LINE, 90., 0.", "*RIGID BODY, ANALYTICAL SURFACE=DIE, REF NODE=9900"],
       3: ["*NODE", "9900, 0., 0., -5.", "9901, -50., -50., 0.", "9902, 90., -50., 0.",
           "9903, 90., 60., 0.", "9904, -50., 60., 0.", "*ELEMENT, TYPE=R3D4, ELSET=DIE",
           "9900, 9901, 9902, 9903, 9904", "*RIGID BODY, ELSET=DIE, REF NODE=9900",
           "*SURFACE, NAME=DIE", "DIE,"]}


def pulled(word, size, boxes, bead, held, way, material=("*ELASTIC", "200000., 0.3"), part=0.02):
    """A strip from x = 0 on a slick die, pressed by a bead from above, then pulled by its end, a
    part of the way in an increment."""
    d = len(size)
    mesh = mesh_make.block(size, boxes)
    (_, rows), = mesh.blocks
    lines = ["*HEADING", "a strip pulled through a drawbead", "*NODE",
             *(f"{i + 1}, " + ", ".join(map(repr, x)) for i, x in enumerate(mesh.points.tolist())),
             f"*ELEMENT, TYPE={word}, ELSET=STRIP",
             *(f"{i + 1}, " + ", ".join(str(k + 1) for k in row)
               for i, row in enumerate(rows.tolist())),
             *(line for side in ("TOP", "BOTTOM") for line in
               [f"*SURFACE, NAME={side}",
                *(f"{e + 1}, S{f}" for e, f in mesh.surfaces[side].tolist())]),
             "*NSET, NSET=END", *(f"{k + 1}," for k in mesh.point_sets["RIGHT"].tolist()),
             *DIE[d], *bead.splitlines(), "*MATERIAL, NAME=M", *material,
             "*SOLID SECTION, ELSET=STRIP, MATERIAL=M", *["1.,"][:3 - d],
             "*SURFACE INTERACTION, NAME=SLICK", "*SURFACE BEHAVIOR, DIRECT",
             "*CONTACT PAIR, INTERACTION=SLICK", "BOTTOM, DIE", "*BOUNDARY", "9900, 1, 6", *held,
             "*STEP, NLGEOM, INC=100", "*STATIC", ".25, 1.", "*BOUNDARY",
             f"9000, {d}, {d}, -0.002", "END, 1, 1, 0.", "*END STEP",
             "*STEP, NLGEOM, INC=500", "*STATIC", f"{part!r}, 1., , {part!r}", "*BOUNDARY",
             f"END, 1, 1, {way!r}", "*END STEP", ""]
    return lopin.Deck.parse("\n".join(lines), "strip")


def forces(scene, from_, places):
    """On the bead along x, at so many places and more once the strip slides."""
    history = lopin.run(scene).history
    along = np.asarray(history["BEAD.rf1"])[np.asarray(history["step"]) == 2][from_:]
    assert len(along) >= places   # more where a node goes past the edge of the bead
    return along


@pytest.mark.parametrize("cell", [0.5, 0.8])
@pytest.mark.parametrize("width", [3.0, 4.1])
def test_a_strip_is_held_back_by_the_force_of_the_bead(core, cell, width):
    """In the plane, over several cells of way: the force does not know where the nodes are."""
    bead = drawbead("BEAD", (9.0, 1.0), force=100.0, width=width, faces=(0.0, -2.0), sheet="TOP",
                    node=9000, element=9000)
    # 0.23 in an increment: no two of the places are alike in a cell.
    scene = pulled("CPE4", (16.0, 1.0), (int(16/cell), 2), bead, ["9000, 1", "9000, 6"], 6.0,
                   part=0.0383)
    assert forces(scene, 5, 20) == pytest.approx(-100.0, rel=1e-5)


def test_a_bent_bead_in_space_holds_by_its_width_along_the_pull(core):
    """Across the strip, then askew: the band is 1/cos as long as wide there, f/cos by its cos."""
    line = [(7.5, -1.0, 1.0), (7.5, 3.0, 1.0), (8.5, 7.0, 1.0)]
    bead = drawbead("BEAD", line, force=100.0, width=3.0, faces=(0.0, 0.0, -1.0), sheet="TOP",
                    node=9000, element=9000)
    scene = pulled("C3D8", (16.0, 6.0, 1.0), (16, 4, 1), bead,
                   ["9000, 1, 2", "9000, 4, 6", "END, 2"], 2.0, part=0.05)
    # The slip is along x all over; the line over the strip is 3 long and 3 sqrt(1 + 1/16).
    expected = 100.0*(3.0 + 3.0*np.sqrt(1.0 + 1.0/16.0))
    assert forces(scene, 4, 16) == pytest.approx(-expected, rel=0.015)


def test_steel_gives_way_where_the_bead_holds_more_than_it_bears(core):
    """A strip that flows at 46 per thickness stretches behind a bead of 55, not behind 42."""
    def stretch(force):
        bead = drawbead("BEAD", (17.0, 1.0), force=force, width=4.0, faces=(0.0, -1.0), sheet="TOP",
                        node=9000, element=9000)
        scene = pulled("CPE4", (40.0, 1.0), (40, 2), bead, ["9000, 1", "9000, 6"], 1.0,
                       ("*ELASTIC", "70000., 0.3", "*PLASTIC", "40., 0.", "80., 1."))
        with lopin.open(scene) as job:
            for _ in job:
                points = job.points
        return points.plastic[points.place[:, 0] > 25.0].max()

    # In plane strain a strip flows from 2/sqrt 3 of its yield stress of 40.
    assert stretch(42.0) == 0.0
    assert stretch(55.0) > 1e-3


@pytest.mark.parametrize("change, message", [
    ({"force": 0.0}, "above 0"), ({"width": -1.0}, "above 0"), ({"line": (1.0, 2.0, 3.0)}, "line"),
    ({"faces": (0.0, 0.0, 1.0)}, "line"),
    ({"line": [(0.0, 0.0, 0.0), (0.0, 0.0, 1.0)], "faces": (0.0, 0.0, 1.0)}, "along its faces")])
def test_what_is_no_bead_is_refused(change, message):
    given = {"line": (17.0, 1.0), "force": 1.0, "width": 4.0, "faces": (0.0, -1.0)} | change
    with pytest.raises(ModelError, match=message):
        drawbead("BEAD", given.pop("line"), sheet="TOP", node=1, element=1, **given)


def test_the_cards_of_a_bead_stand_before_another_card(core):
    """Pasted before a card as they are."""
    cards = drawbead("BEAD", (17.0, 1.0), force=1.0, width=4.0, faces=(0.0, -1.0), sheet="TOP",
                     node=9000, element=9000)
    assert cards.endswith("TOP, BEAD\n") and "\n\n" not in cards
    assert lopin.Deck.parse(cards + "*STEP\n*END STEP\n").blocks[-2].keyword == "STEP"
