"""W0333 names how uneven node to segment makes a uniform pressure, within a third; second-order
faces are integrated, or warned of where they cannot be."""
import re
import subprocess

import numpy as np
import pytest

import lopin
from lopin import Material, Plastic, Tresca, mesh_make, profile
from lopin.atlas.blocks import PRESSURE, Scene, pressed_deck
from lopin.atlas.scenes import Frame
from lopin.deck import Deck
from lopin.laws import Elastic
from lopin.mesh import together
from lopin.model import Model
from lopin.run import find_executable

LOAD = 10.0
#: Kind, facets of slave and master.
CASES = [(kind, *facets) for kind in ("CPE4", "CPE3", "CAX4")
         for facets in ((7, 4), (10, 15), (3, 4), (5, 7), (9, 4), (5, 10))]
CASES += [("CAX3", 10, 15), ("CAX3", 4, 3), ("CPE4", 9, 10), ("CPE4", 100, 75)]
CASES += [("C3D8", 4, 3), ("C3D8", 3, 4), ("C3D8", 4, 6), ("C3D8", 7, 4), ("C3D4", 4, 3),
          ("C3D4", 3, 4), ("C3D4", 4, 7), ("C3D4", 6, 4)]


def pressed(kind, slave, master, ratio, turn=0.0, scale=1.0, quadratic=False):
    """Two blocks without Poisson effect under a uniform load; `ratio`: moduli, master over
    slave."""
    space = kind.startswith("C3D")
    side = 10.0*scale
    size = (side, side, 0.4*side) if space else (side, side)

    def cells(n):
        return (n, n, 2) if space else (n, max(2, n//2))
    low = mesh_make.block(size, cells(master))
    up = mesh_make.block(size, cells(slave)).moved(*(0.0,)*(len(size) - 1), size[-1])
    if kind[-1] in "34" and kind not in ("CPE4", "CAX4"):
        low, up = mesh_make.simplices(low), mesh_make.simplices(up)
    if quadratic:
        low, up = low.quadratic(), up.quadratic()
    both = together(UP=up, LOW=low)
    if turn:
        c, s = np.cos(turn), np.sin(turn)
        both = both.mapped(lambda x: np.column_stack(
            [c*x[:, 0] - s*x[:, 1], s*x[:, 0] + c*x[:, 1], *x.T[2:]]))
    model = Model("uneven", both, kind="3d" if space else
                  "axisymmetric" if kind.startswith("CAX") else "plane strain")
    model.section("UP", Elastic(1e5/scale, 0.0))
    model.section("LOW", Elastic(1e5*ratio/scale, 0.0))
    model.contact("UP.BOTTOM", "LOW.TOP", surface_to_surface=False)
    names = ("x", "y", "z")[:len(size)] if not kind.startswith("CAX") else ("r", "z")
    model.fix("LOW.BOTTOM", *names)
    if not kind.startswith("CAX") and not turn:
        model.fix("UP.TOP", *names[:-1])
    model.step().pressure("UP.TOP", LOAD/scale)
    return model.to_deck()


def run(deck, folder):
    path = folder/"uneven.inp"
    deck.write(path)
    done = subprocess.run([find_executable(), "run", path, "-o", folder/"out", "--overwrite"],
                          capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout + done.stderr


def deviation(text):
    said = re.search(r"W0333.*uneven by about ([\d.]+) %", text)
    return float(said.group(1))/100.0 if said else 0.0


def pressures(solve, deck, folder):
    return np.asarray(solve(deck, folder).contact(0).last.pressure)


@pytest.mark.parametrize("kind, slave, master, ratio", [
    (*case, ratio) for k, case in enumerate(CASES) for ratio in (0.01, 1.0)
    if k % 3 == 0 or (ratio == 1.0) == (k % 3 == 1)])
def test_the_warning_names_the_deviation_within_a_third(solve, tmp_path, kind, slave, master,
                                                        ratio):
    deck = pressed(kind, slave, master, ratio)
    true = abs(pressures(solve, deck, tmp_path)/LOAD - 1.0).max()
    said = deviation(run(deck, tmp_path))
    assert true*2/3 < said < true*1.5


@pytest.mark.parametrize("facets", [(3, 4), (4, 3), (5, 10), (5, 7), (7, 4)])
@pytest.mark.parametrize("word", ["CPE3", "CPE4", "CPS4", "CAX3", "C3D4", "C3D6", "C3D8"])
def test_it_does_so_on_a_wider_master_whose_ends_are_pressed_too(solve, tmp_path, word, facets):
    """The slave covers the outermost facets of its reach in part: they count by what it covers."""
    deck = pressed_deck(Scene(word, word, facets, to_surface=False, margin=0.2))
    history = solve(deck, tmp_path).contact(0)
    end = history.last if word.startswith("CAX") else history.at(0)
    true, said = abs(end.pressure/PRESSURE - 1.0).max(), deviation(run(deck, tmp_path))
    assert true*2/3 < said < true*1.5 or true < 0.03 and said == 0.0


def free(deck):
    """The deck, its pair without TYPE."""
    return Deck.parse(re.sub(r", TYPE=(NODE|SURFACE) TO SURFACE", "", deck.text()), "free")


@pytest.mark.parametrize("kind, slave, master", [
    ("CPE4", 7, 4), ("CAX4", 3, 4), ("CPE3", 9, 4), ("C3D8", 4, 5), ("C3D8", 5, 4), ("C3D4", 3, 4),
    ("C3D8", 4, 9)])
def test_a_pair_that_says_nothing_is_surface_to_surface_there(solve, tmp_path, kind, slave,
                                                              master):
    """Exact where the nodes are off by what W0333 says, in any units; the plan says so."""
    deck = pressed(kind, slave, master, 1.0, 0.0, 1e3)
    at_nodes, said = pressures(solve, deck, tmp_path), run(free(deck), tmp_path)
    found = pressures(solve, free(deck), tmp_path)*1e3
    assert abs(at_nodes*1e3/LOAD - 1.0).max() > 0.02 and abs(found/LOAD - 1.0).max() < 1e-6
    assert "N0347" in said and "W0333" not in said
    assert "; surface to surface where facets do not match" in said


def test_a_coarse_slave_whose_own_pressure_is_even_goes_surface_to_surface_too(core):
    """At its nodes alone the master would have the load: stresses off by half, without a word."""
    deck = pressed("CPE4", 2, 6, 1.0, 0.0)
    nodes, even, chosen = (lopin.run(Deck.parse(text, "coarse")).summary for text in (
        deck.text(), deck.text().replace("NODE TO SURFACE", "SURFACE TO SURFACE"),
        free(deck).text()))
    strain = even["energy"]["strain"]
    assert nodes["energy"]["strain"] > 1.01*strain
    assert chosen["energy"]["strain"] == pytest.approx(strain, rel=1e-12)
    assert "N0347" in [d["code"] for d in chosen["diagnostics"]]


@pytest.mark.parametrize("kind, slave, master", [
    ("CPE4", 2, 4), ("CPE4", 4, 6), ("CPE3", 2, 6), ("CAX4", 5, 7), ("C3D8", 3, 4), ("C3D4", 4, 6)])
def test_stresses_of_a_stiff_master_under_a_coarse_slave_are_told(kind, slave, master, tmp_path):
    """W0348 names what they are off by (within a factor of two), where pressures are nearly even."""
    deck = pressed(kind, slave, master, 10.0)
    said = run(Deck.parse(deck.text().replace("*END STEP", "*EL PRINT, ELSET=LOW.ALL\nS\n*END STEP"),
                          "uneven"), tmp_path)
    rows = [line.split() for line in (tmp_path/"out"/"uneven.dat").read_text().splitlines()]
    stress = np.array([[float(v) for v in row] for row in rows
                       if len(row) > 5 and row[0].isdigit() and row[1].isdigit()])
    off = abs(stress[:, 4 if kind.startswith("C3D") else 3]/-LOAD - 1.0).max()
    named = re.search(r"W0348.*uneven by about ([\d.]+) %", said)
    assert 0.5*off < float(named.group(1))/100.0 < 2.0*off
    assert "W0348" not in run(pressed(kind, master, slave, 10.0), tmp_path)


@pytest.mark.parametrize("change", [
    lambda text: text.replace("*STEP", "*INITIAL CONDITIONS, TYPE=STATE\nUP, 0, 0., 0., 0., 0., 0., 0., 0.\n"
                              "*STEP, NLGEOM", 1),
    lambda text: text.replace("*CONTACT PAIR,", "*CONTACT PAIR, EXTENSION ZONE=0.1,"),
    lambda text: text.replace("*CONTACT PAIR,", "*CONTACT PAIR, SMOOTH=YES,")])
def test_it_is_at_the_nodes_where_the_deck_has_a_say_or_meshes_are_made_anew(tmp_path, change):
    text = change(free(pressed("CPE4", 7, 4, 1.0)).text())
    said = run(Deck.parse(text, "free"), tmp_path)
    assert "N0347" not in said and "W0333" in said


@pytest.mark.parametrize("path, card, instead", [
    ("FINITE", "*STEP", "*STEP"), ("CONDENSED", "*STEP", "*STEP"), ("AUTO", "*STEP", "*STEP, NLGEOM"),
    ("CONDENSED", "100000., 0.\n", "100000., 0.\n*PLASTIC\n1e6, 0.\n")])
@pytest.mark.parametrize("kind", ["CPE4", "C3D8"])
def test_neither_the_path_nor_what_bodies_do_has_a_say_in_it(solve, path, card, instead, kind, tmp_path):
    """And the pressure is even."""
    plain = free(pressed(kind, 7, 4, 1.0)).text()
    assert card in plain
    deck = Deck.parse(f"*LOPIN, PATH={path}\n" + plain.replace(card, instead, 1), "free")
    said = run(deck, tmp_path)
    assert "N0347" in said and "W0333" not in said
    assert pressures(solve, deck, tmp_path) == pytest.approx(LOAD, rel=1e-3)


def test_facets_that_match_stay_at_the_nodes(solve, tmp_path):
    deck = pressed("CPE4", 8, 4, 1.0)
    assert (pressures(solve, deck, tmp_path) == pressures(solve, free(deck), tmp_path)).all()
    assert "N0347" not in run(free(deck), tmp_path)


def billets(kind, up=(8.0, 8), way=6.0, layers=8):
    """Two billets of unlike metals on each other, 8 mm high, the lower one 8 mm wide; width and facets of
    the upper one."""
    parts = {"LOW": mesh_make.block((8.0, 8.0), (layers, layers)),
             "UP": mesh_make.block((up[0], 8.0), (up[1], layers)).moved(0.0, 8.0)}
    model = Model("billets", together(**parts), kind=kind)
    for part, flow in (("LOW", 300.0), ("UP", 150.0)):
        model.section(part, Material(Elastic(2.1e5, 0.3), Plastic([(flow, 0.0), (3.0*flow, 1.0)])))
    press = model.rigid_tool("PRESS", profile.plane(16.0, 40.0), ref=(0.0, 16.0))
    model.contact("UP.TOP", press, friction=Tresca(0.2))
    model.contact("LOW.BOTTOM", model.rigid_tool("FLOOR", profile.plane(0.0, 40.0, side="above")),
                  friction=Tresca(0.2))
    model.contact("UP.BOTTOM", "LOW.TOP", friction=0.2)
    across, along = ("r", "z") if kind == "axisymmetric" else ("x", "y")
    for part in parts:
        model.fix(f"{part}.LEFT", across)
    model.step(40, nlgeom=True).move(press, **{along: -way})
    return model.to_deck()


@pytest.mark.parametrize("kind", ["plane strain", "axisymmetric"])
def test_facets_that_match_and_slide_go_surface_to_surface(solve, kind):
    """At the nodes, which come to joints of facets all at once, they stop at a third of the way."""
    result = solve(billets(kind))
    assert [m["message"] for m in result.diagnostics if m["code"] == "N0347"][0].count("slide")
    assert result.summary["certificate"]["verdict"] == "PASS"


def test_metal_that_hangs_over_goes_surface_to_surface(solve):
    """Facets of the slave 1.1 mm long beside .67: at the nodes the force is 19 % too low."""
    coarse, fine = (solve(billets("axisymmetric", (10.0, n), 5.0, 12)) for n in (9, 30))
    force = [result.history["PRESS.rf2"][-1] for result in (coarse, fine)]
    assert "N0347" in [m["code"] for m in coarse.diagnostics]
    assert force[0] == pytest.approx(force[1], rel=0.02)


@pytest.mark.parametrize("step", ["*STEP", "*STEP, NLGEOM"])
def test_check_chooses_and_a_run_goes_on_to_the_same_bits(tmp_path, step):
    text = free(pressed("CPE4", 7, 4, 1.0)).text().replace("*STEP", step, 1)
    path = Deck.parse(text.replace("1., 1., 1e-06, 1.", "0.3, 1., 1e-06, 0.3"), "free").write(tmp_path/"free.inp")
    done = subprocess.run([find_executable(), "check", path], capture_output=True, text=True,
                          check=False)
    assert done.returncode == 0 and "N0347" in done.stdout + done.stderr
    with lopin.open(path) as running:
        while running.advance():
            running.forget_workspace()
        last = running.result
    assert (last.contact(0).last.pressure == lopin.run(path).contact(0).last.pressure).all()


def test_the_figure_turns_with_the_scene(tmp_path):
    """What holds the bodies aside turns with it, so that only the contact is compared."""
    scene = Scene("CPE4", "CPE4", (3, 4), to_surface=False, margin=0.2)
    plain = deviation(run(pressed_deck(scene), tmp_path))
    turned = deviation(run(pressed_deck(scene, Frame(77.0, 1e3, 1e-6)), tmp_path))
    assert plain == pytest.approx(turned, rel=1e-6) and plain > 0.05


def test_check_says_it_too(tmp_path):
    path = tmp_path/"uneven.inp"
    pressed("CPE4", 3, 4, 1.0).write(path)
    done = subprocess.run([find_executable(), "check", path], capture_output=True, text=True,
                          check=False)
    assert done.returncode == 0 and deviation(done.stdout + done.stderr) > 0.05


def test_the_figure_does_not_depend_on_units(tmp_path):
    assert deviation(run(pressed("CPE4", 7, 4, 1.0), tmp_path)) == pytest.approx(
        deviation(run(pressed("CPE4", 7, 4, 1.0, scale=1e-6), tmp_path)), rel=1e-9)


@pytest.mark.parametrize("kind", ["CPE4", "C3D8"])
@pytest.mark.parametrize("slave, master", [(4, 4), (8, 4)])
def test_nothing_is_said_of_meshes_that_match(tmp_path, kind, slave, master):
    assert "W0333" not in run(pressed(kind, slave, master, 1.0), tmp_path)


@pytest.mark.parametrize("kind", ["CPE4", "CAX4", "C3D8", "C3D4"])
def test_second_order_faces_are_carried_out_surface_to_surface(solve, tmp_path, kind):
    deck = pressed(kind, 3, 4, 1.0, quadratic=True)
    found = pressures(solve, deck, tmp_path)
    assert abs(found/LOAD - 1.0).max() < 1e-8
    said = run(deck, tmp_path)
    assert "N0334" in said and "W0333" not in said


def test_second_order_faces_against_themselves_are_warned_of(tmp_path):
    mesh = mesh_make.block((4.0, 1.0), (4, 1)).quadratic()
    model = Model("itself", mesh, kind="plane strain")
    model.section("ALL", Elastic(1e5, 0.3))
    model.fix("BOTTOM", "x", "y")
    model.contact("TOP", "TOP")
    model.step(nlgeom=True).pressure("RIGHT", 1.0)
    path = model.to_deck().write(tmp_path/"itself.inp")
    said = subprocess.run([find_executable(), "check", path], capture_output=True, text=True,
                          check=False)
    assert "W0335" in said.stdout + said.stderr
