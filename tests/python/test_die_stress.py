"""Die stress: forces of a forging on the mesh of its die, beside Lame's ring and beside statics."""
import numpy as np
import pytest

import lopin
from lopin import mesh_make
from lopin.die_stress import ToolLoads, die_deck
from lopin.errors import ModelError

pytest.importorskip("scipy")
BORE, OUT, TALL, YOUNG, NU = 10.0, 30.0, 8.0, 210000.0, 0.3


def mesh_cards(mesh, word, faces=""):
    """Nodes, elements and sets of a mesh; a surface of all faces of the side `faces`."""
    rows = "*NODE\n" + "".join(f"{k + 1}, {', '.join(map(repr, map(float, p)))}\n"
                               for k, p in enumerate(mesh.points))
    rows += f"*ELEMENT, TYPE={word}, ELSET=BODY\n"
    rows += "".join(f"{k + 1}, {', '.join(str(n + 1) for n in c)}\n"
                    for k, c in enumerate(mesh.blocks[0][1]))
    for name, members in mesh.point_sets.items():
        rows += f"*NSET, NSET={name}\n" + "".join(f"{n + 1}\n" for n in members)
    if faces:
        rows += "*SURFACE, NAME=BORE\n" + "".join(f"{e + 1}, S{f}\n"
                                                  for e, f in mesh.surfaces[faces])
    return rows


def confined(travel=-0.005, shift=0.0):
    """A disc without friction in a rigid container, pressed by a punch: one pressure on the wall."""
    mesh = mesh_make.block((BORE, TALL), (10, 8))
    return lopin.Deck.parse(mesh_cards(mesh, "CAX4") + f"""*SURFACE, NAME=SKIN
BODY,
*NODE, NSET=W
9001, 50., 0.
*NODE, NSET=P
9002, 0., 50.
*SURFACE, NAME=WALL, TYPE=SEGMENTS
START, {BORE}, -5.
LINE, {BORE}, 20.
*RIGID BODY, ANALYTICAL SURFACE=WALL, REF NODE=W
*SURFACE, NAME=PUNCH, TYPE=SEGMENTS
START, 50., {TALL}
LINE, -50., {TALL}
*RIGID BODY, ANALYTICAL SURFACE=PUNCH, REF NODE=P
*MATERIAL, NAME=M
*ELASTIC
70000., .3
*SOLID SECTION, ELSET=BODY, MATERIAL=M
*SURFACE INTERACTION, NAME=I
*SURFACE BEHAVIOR, DIRECT
*CONTACT PAIR, INTERACTION=I
SKIN, WALL
SKIN, PUNCH
*BOUNDARY
LEFT, 1
BOTTOM, 2
W, 1
W, 6
W, 2, 2, {shift}
P, 1
P, 6
P, 2, 2, {travel}
*STEP, NLGEOM
*STATIC
1., 1.
*END STEP
""".replace(f"W, 2, 2, {shift}\n", "").replace(f"P, 2, 2, {travel}\n", "").replace(
        "*STATIC\n1., 1.\n", f"*STATIC\n1., 1.\n*BOUNDARY\nW, 2, 2, {shift}\nP, 2, 2, {travel}\n"),
        name="confined")


def ring(cells=(60, 8), up=0.0):
    mesh = mesh_make.block((OUT - BORE, TALL), cells, origin=(BORE, up))
    return lopin.Deck.parse(mesh_cards(mesh, "CAX4", "LEFT") + f"""*MATERIAL, NAME=STEEL
*ELASTIC
{YOUNG}, {NU}
*SOLID SECTION, ELSET=BODY, MATERIAL=STEEL
*BOUNDARY
BOTTOM, 2
*STEP
*STATIC
*END STEP
""", name="ring")


def test_a_ring_about_a_confined_disc_widens_as_lame_says(core):
    forged = lopin.run(confined())
    loads = ToolLoads.of(forged, "SKIN-WALL")
    deck, balance = die_deck(ring(), "BORE", loads)
    assert balance.force_error < 1e-14 and balance.moment_error < 1e-3
    strain = 0.005/TALL
    pressure = strain*70000.0*0.3/((1.0 + 0.3)*(1.0 - 0.6))
    assert balance.force[0] == pytest.approx(pressure*2.0*np.pi*BORE*TALL, rel=2e-3)
    found = lopin.run(deck)
    at = np.linalg.norm(ring_points() - [BORE, 0.5*TALL], axis=1).argmin()
    wide = pressure*BORE/YOUNG*((OUT**2 + BORE**2)/(OUT**2 - BORE**2) + NU)
    assert found["displacement"][at, 0] == pytest.approx(wide, rel=4e-3)
    hoop = pressure*(OUT**2 + BORE**2)/(OUT**2 - BORE**2)
    assert found["stress"][at, 2] == pytest.approx(hoop, rel=0.02)


def test_the_command_writes_the_loaded_deck_and_says_what_it_kept(core, tmp_path, capsys):
    from lopin.__main__ import main

    lopin.run(confined(), tmp_path/"forging")
    ring().write(tmp_path/"ring.inp")
    words = ["die", str(tmp_path/"forging"), str(tmp_path/"ring.inp"), "--surface", "BORE"]
    assert main([*words, "-o", str(tmp_path/"loaded.inp")]) == 0
    assert "WALL: force" in capsys.readouterr().out
    found = lopin.run(lopin.Deck.read(tmp_path/"loaded.inp"))
    assert abs(found["reaction"][:, 1].sum()) < 1e-8*np.abs(found["reaction"]).max()
    assert main([*words, "-o", str(tmp_path/"ring.inp")]) == 2
    assert "the deck itself" in capsys.readouterr().err


@pytest.mark.parametrize("own, extra", [("*CLOAD\nTOP, 2, -3.\n", -3.0*11),
                                        ("*CLOAD, OP=NEW\nLEFT, 2, 5.\n", 5.0*5)])
def test_loads_of_the_die_itself_stay_beside_those_of_the_forging(core, own, extra):
    """A press that bears on a die: the support bears the sum of both, in steps after it too."""
    loads = ToolLoads("DIE", np.array([[10.0, 2.0], [10.0, 6.0]]), np.array([[7.0, -4.0]]*2))
    text = ring((10, 4)).text().replace("*STATIC\n", f"*STATIC\n{own}")
    die = lopin.Deck.parse(text + "*STEP\n*STATIC\n*END STEP\n", name="ring")
    found = lopin.run(die_deck(die, "BORE", loads)[0])["reaction"][:, 1].sum()
    assert found == pytest.approx(8.0 - extra, rel=1e-9)


def ring_points():
    return mesh_make.block((OUT - BORE, TALL), (60, 8), origin=(BORE, 0.0)).points


def test_loads_go_back_to_where_the_tool_stood(core):
    """A container that moves by 0.5 along its axis: its die is loaded 0.5 lower on its bore."""
    still, moved = (ToolLoads.of(lopin.run(confined(shift=s)), "SKIN-WALL") for s in (0.0, 0.5))
    assert moved.force == pytest.approx(still.force, rel=1e-9)
    assert (still.place - moved.place)[:, 1] == pytest.approx(0.5, abs=1e-12)


def test_a_die_of_bricks_takes_forces_and_moments_of_a_pressed_block(core):
    """Any loads on the face of a block of bricks: sums are those of the nodes; lies are told."""
    mesh = mesh_make.block((4.0, 4.0, 2.0), (5, 5, 2))
    rng = np.random.default_rng(7)
    place = np.column_stack([rng.uniform(0.0, 4.0, (40, 2)), np.zeros(40)])
    loads = ToolLoads("DIE", place, rng.normal(size=(40, 3)))
    die = lopin.Deck.parse(mesh_cards(mesh, "C3D8", "BOTTOM") + "*MATERIAL, NAME=M\n*ELASTIC\n1.,0.\n"
                           "*SOLID SECTION, ELSET=BODY, MATERIAL=M\n*BOUNDARY\nTOP, 1, 3\n"
                           "*STEP\n*STATIC\n*END STEP\n", name="die")
    deck, balance = die_deck(die, "bore", loads)
    assert balance.force_error < 1e-14 and balance.moment_error < 1e-14
    reaction = lopin.run(deck)["reaction"][mesh.point_sets["TOP"]].sum(axis=0)
    assert reaction == pytest.approx(-loads.force.sum(axis=0), rel=1e-9)
    loads.place[3, 2] = -1.5
    with pytest.raises(ModelError, match="lies 1.5 from bore"):
        die_deck(die, "bore", loads)
    with pytest.raises(ModelError, match="no surface 'FACE'"):
        die_deck(die, "FACE", loads)
