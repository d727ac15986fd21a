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


#: *TRANSFORM of the bore, of all nodes, of what is held; in the plane and in space.
TURNED = [("ring", "LEFT", "R", "0.8, 0.6, 0., -0.6, 0.8, 0."),
          ("ring", "LEFT", "R", "0., 1., 0., -1., 0."),
          ("plane", "LEFT", "C", "3., 4., 0., 3., 4., 1."),
          ("plane", "ALL", "C", "10., 4., 0., 10., 4., -2."),
          ("plane", "ALL", "R", "1., 2., 0., -2., 1., 0."),
          ("bricks", "BOTTOM", "R", "1., 2., 0.5, -2., 1., 1."),
          ("bricks", "BOTTOM", "C", "1., -2., 0., 2., 1., 3."),
          ("bricks", "ALL", "C", "2., 2., 0., 2., 2., 1.")]


def die_of(kind, more=""):
    """A die clamped along a side, loads of any directions on another."""
    rng = np.random.default_rng(3)
    if kind == "bricks":
        mesh, word, faces, held = mesh_make.block((4.0, 4.0, 2.0), (4, 4, 1)), "C3D8", "BOTTOM", "TOP"
        place = np.column_stack([rng.uniform(0.0, 4.0, (20, 2)), np.zeros(20)])
    else:
        mesh = mesh_make.block((OUT - BORE, TALL), (5, 4), origin=(BORE, 0.0))
        word, faces, held = "CAX4" if kind == "ring" else "CPE4", "LEFT", "RIGHT"
        place = np.column_stack([np.full(20, BORE), rng.uniform(0.0, TALL, 20)])
    every = "*NSET, NSET=ALL, GENERATE\n" + f"1, {len(mesh.points)}\n"
    text = mesh_cards(mesh, word, faces) + every + f"""*MATERIAL, NAME=M
*ELASTIC
{YOUNG}, {NU}
*SOLID SECTION, ELSET=BODY, MATERIAL=M
{more}*BOUNDARY
{held}, 1, {mesh.points.shape[1]}
*STEP
*STATIC
*END STEP
"""
    loads = ToolLoads("DIE", place, rng.normal(1.0, 2.0, size=place.shape))
    return lopin.Deck.parse(text, name="die"), loads


@pytest.mark.parametrize("kind, names, axes, points", TURNED)
def test_loads_are_meant_in_the_axes_of_their_nodes(core, kind, names, axes, points):
    """A die with *TRANSFORM moves as one without, and its supports bear the told force."""
    plain, loads = die_of(kind)
    turned, _ = die_of(kind, f"*TRANSFORM, NSET={names}, TYPE={axes}\n{points}\n")
    expected = lopin.run(die_deck(plain, "BORE", loads)[0])
    deck, balance = die_deck(turned, "BORE", loads)
    found = lopin.run(deck)
    assert found["displacement"] == pytest.approx(
        expected["displacement"], rel=1e-9, abs=1e-9*np.abs(expected["displacement"]).max())
    if kind != "ring":
        assert found["reaction"].sum(axis=0) == pytest.approx(-balance.force, rel=1e-9)
    else:
        assert found["reaction"][:, 1].sum() == pytest.approx(-balance.force[1], rel=1e-9)


def test_the_last_transform_of_a_node_counts(core):
    plain, loads = die_of("plane")
    deck, _ = die_of("plane", "*TRANSFORM, NSET=ALL\n1., 2., 0., -2., 1., 0.\n"
                              "*TRANSFORM, NSET=LEFT, TYPE=C\n0., 0., 0., 0., 0., 1.\n")
    found, expected = (lopin.run(die_deck(d, "BORE", loads)[0])["displacement"] for d in (deck, plain))
    assert found == pytest.approx(expected, abs=1e-9*np.abs(expected).max())
    bad, _ = die_of("plane", "*TRANSFORM, NSET=ALL\n1., 0., 0., 2., 0., 0.\n")
    with pytest.raises(ModelError, match="give no axes"):
        die_deck(bad, "BORE", loads)


def test_all_pairs_of_a_tool_are_taken_or_named(core, tmp_path, capsys):
    """A wall that two surfaces of the disc press: by halves of its height."""
    from lopin.__main__ import main

    text = confined().text()
    cut = "*SURFACE, NAME=SKIN\nBODY,\n"
    assert cut in text
    halves = "".join(f"*SURFACE, NAME={name}\n" + "".join(
        f"{row*10 + 10}, S2\n" for row in rows) for name, rows in (("LOW", range(3)), ("UP", range(3, 8))))
    halves += "*SURFACE, NAME=LID\n" + "".join(f"{71 + k}, S3\n" for k in range(10))
    text = text.replace(cut, halves).replace("SKIN, WALL\nSKIN, PUNCH", "LOW, WALL\nUP, WALL\nLID, PUNCH")
    result = lopin.run(lopin.Deck.parse(text, name="confined"), tmp_path/"forging")
    whole, low, up = (ToolLoads.of(result, pair) for pair in (None, "LOW", "UP"))
    assert whole.force.sum(axis=0) == pytest.approx(low.force.sum(axis=0) + up.force.sum(axis=0))
    assert min(low.force[:, 0].sum(), up.force[:, 0].sum()) > 0.3*whole.force[:, 0].sum()
    assert (whole.left_out, low.left_out, up.left_out) == ((), ("UP-WALL",), ("LOW-WALL",))
    ring().write(tmp_path/"ring.inp")
    words = ["die", str(tmp_path/"forging"), str(tmp_path/"ring.inp"), "--surface", "BORE",
             "-o", str(tmp_path/"loaded.inp")]
    assert main(words) == 0 and "WALL (LOW-WALL, UP-WALL): force" in capsys.readouterr().out
    assert main([*words, "--pair", "UP"]) == 0
    assert "WALL, without LOW-WALL: force" in capsys.readouterr().out
