"""Patch tests of surface-to-surface contact by dual mortar, beside node to segment where it
fails."""
import numpy as np
import pytest

import lopin
from blocks_2d import NU, YOUNG, Pair
from lopin import mesh_make
from lopin.laws import Elastic, Lagrange
from lopin.mesh import together
from lopin.model import Model
from scenes import METHODS

CASE = "B1 patch test, mortar"
def in_process(deck):
    return lopin.run(deck)


PRESSED = (0.0, -1.0, -NU, 0.0)


@pytest.mark.parametrize("slave", ["lower", "upper"])
@pytest.mark.parametrize("kind", ["CPE4", "CPE3", "CPE8", "CPE6"])
@pytest.mark.parametrize("variant", ["plain", "turned by 27 degrees", "ratio of moduli 1000",
                                     "ratio of moduli 1/1000",
                                     "shorter upper block", "thickness 0.37"])
def test_uniform_pressure(core, solve, sheet, tmp_path, kind, variant, slave):
    pair = Pair(kind, 7, 10, 3, uneven=0.3, **({"left": 2.1, "right": 7.7}
                                               if variant.startswith("short") else {}))
    if variant.startswith("turned"):
        # Printed stresses have seven digits: enough where all but one vanish.
        pair.turned(27.0)
        solve = in_process
    if variant.startswith("ratio"):
        pair.young = (1e3, 1e6) if variant.endswith(" 1000") else (1e6, 1e3)
    if variant.startswith("thick"):
        pair.thickness = 0.37
    result = pair.pressed().solve(solve, tmp_path, slave=slave)
    case = CASE if kind == "CPE4" else "B5 patch test with other elements, mortar"
    sheet.compare(case, f"{kind}, 7/10 uneven, {slave} slave, {variant}: worst stress error",
                  pair.stress_error(result, PRESSED), 0.0, 1e-10, "exact", absolute=True)
    assert result.summary["certificate"]["verdict"] == "PASS"
    pressed = result.contact(0).last
    closed = pressed.status > 0
    assert np.abs(pressed.pressure[closed] - 1.0).max() < 1e-9


@pytest.mark.parametrize("kind", ["CPE4", "CPE8", "CPE3", "CPE6"])
@pytest.mark.parametrize("slave", ["lower", "upper"])
def test_any_share_of_a_facet(solve, sheet, tmp_path, kind, slave):
    """The end of the upper block at many places of a lower facet, hardly past its node and hardly
    before."""
    worst = 0.0
    for right in (7.5 + 2.5*np.array([1e-8, 1e-4, 5e-3, 0.04, 0.08, 0.2, 0.5, 0.9, 0.95, 0.999,
                                      1 - 1e-7])):
        pair = Pair(kind, 4, 5, 2, left=2.5, right=float(right)).pressed()
        result = pair.solve(solve, tmp_path, slave=slave)
        worst = max(worst, pair.stress_error(result, PRESSED))
        assert result.summary["certificate"]["verdict"] == "PASS"
    sheet.compare("B1 patch test, mortar",
                  f"{kind}, {slave} slave, 11 ends of the upper block: worst stress error",
                  worst, 0.0, 1e-10, "exact", absolute=True)


@pytest.mark.parametrize("kind", ["CPE4", "CPE8", "CPE6"])
@pytest.mark.parametrize("slave", ["lower", "upper"])
def test_a_tie_hands_on_any_uniform_strain(core, sheet, tmp_path, kind, slave):
    """Both meshes move with one linear field at their boundary, the ends of the tie included."""
    pair = Pair(kind, 7, 10, 3, uneven=0.3).turned(27.0)
    strain = np.array([[0.003, 0.004], [-0.001, -0.002]])
    lines = []
    for body in pair.bodies:
        low, high = body.x.min(0), body.x.max(0)
        for i, p in enumerate(body.nodes):
            sides = [abs(p[0] - low[0]) < 1e-9, abs(p[0] - high[0]) < 1e-9]
            outer = abs(p[1] - (low[1] if body is pair.low else high[1])) < 1e-9
            if outer or any(sides):
                u = strain @ p
                lines += [f"{body.first + 1 + i}, {d + 1}, {d + 1}, {float(u[d])!r}"
                          for d in (0, 1)]
    pair.loads += ["*BOUNDARY", *lines]
    result = pair.solve(lopin.run, tmp_path, slave=slave, tie=True, words="")
    e = 0.5*(strain + strain.T)
    lame, shear = YOUNG*NU/((1 + NU)*(1 - 2*NU)), YOUNG/(1 + NU)
    expected = (lame*np.trace(e) + shear*e[0, 0], lame*np.trace(e) + shear*e[1, 1],
                lame*np.trace(e), shear*e[0, 1])
    sheet.compare("B3 patch test, tied",
                  f"{kind}, 7/10 uneven, turned, {slave} slave: worst stress error",
                  pair.stress_error(result, expected), 0.0, 1e-10, "exact", absolute=True)


@pytest.mark.parametrize("kind", ["CAX4", "CAX8", "CAX3", "CAX6"])
@pytest.mark.parametrize("slave", ["lower", "upper"])
@pytest.mark.parametrize("inner", [0.0, 3.0])
def test_uniform_pressure_about_an_axis(solve, sheet, tmp_path, kind, slave, inner):
    pair = Pair(kind, 7, 10, 3, uneven=0.3, inner=inner).pressed()
    result = pair.solve(solve, tmp_path, slave=slave)
    name = "cylinder" if inner == 0.0 else "ring"
    sheet.compare("B1 patch test about an axis, mortar",
                  f"{kind}, {name}, 7/10 uneven, {slave} slave: worst stress error",
                  pair.stress_error(result, (0.0, -1.0, 0.0, 0.0)), 0.0, 1e-10, "exact",
                  absolute=True)
    assert result.summary["certificate"]["verdict"] == "PASS"


@pytest.mark.parametrize("kind", ["CPE4", "CPE8", "CPE6", "CAX4"])
def test_matching_meshes_are_as_node_to_segment(core, sheet, tmp_path, kind):
    """Under a load that is not uniform; linear facets of equal length have the same rows."""
    energy = {}
    for words in ("TYPE=SURFACE TO SURFACE", "TYPE=NODE TO SURFACE"):
        pair = Pair(kind, 6, 6, 3).pressed()
        pair.loads += ["*CLOAD", f"{pair.up.number[(5.0, 8.0)]}, 2, -3."] if kind != "CAX4" else []
        energy[words] = pair.solve(lopin.run, tmp_path, words=words).history["energy.strain"][-1]
    mortar, nodes = energy.values()
    sheet.compare("B1 patch test, mortar", f"{kind}, 6/6, point force besides: strain energy",
                  mortar, nodes, 1e-12, "node to segment")


@pytest.mark.parametrize("method", METHODS)
def test_all_methods_have_the_same_rows(core, sheet, tmp_path, method):
    """A slope of 1e4 gives 1e-4 of penetration, evenly: the pressure stays uniform."""
    pair = Pair("CPE8", 7, 10, 3, uneven=0.3).pressed()
    slope = "" if method == "DIRECT" else "\n1.e4"
    result = pair.solve(lopin.run, tmp_path, behaviour=method + slope)
    tolerance = 1e-6 if method == "AUGMENTED LAGRANGE" else 1e-10
    sheet.compare(CASE, f"CPE8, 7/10 uneven, {method.lower()}: worst stress error",
                  pair.stress_error(result, PRESSED), 0.0, tolerance, "exact", absolute=True)
    if method in ("PENALTY", "PERTURBED LAGRANGE"):
        sheet.compare(CASE, f"CPE8, 7/10 uneven, {method.lower()}: penetration",
                      -result.contact(0).last.gap.min(), 1e-4, 1e-10, "pressure over slope")


@pytest.mark.parametrize("tie", [False, True])
@pytest.mark.parametrize("cells", [(6, 6), (7, 10)])
def test_a_node_of_two_slave_surfaces(core, sheet, tmp_path, cells, tie):
    """The upper face cut into two pairs: its middle node has a share in both."""
    pair = Pair("CPE4", *cells, 3).pressed()
    deck = pair.deck(tie=tie, words="" if tie else "TYPE=SURFACE TO SURFACE")
    faces = [f"{e}, S{f}" for e, f in pair.up.bottom]
    half = len(faces)//2
    deck = deck.replace("*SURFACE, NAME=UP_TOP", "\n".join(
        ["*SURFACE, NAME=ONE", *faces[:half], "*SURFACE, NAME=TWO", *faces[half:],
         "*SURFACE, NAME=UP_TOP"]))
    deck = deck.replace("UP_BOTTOM, LOW_TOP", "ONE, LOW_TOP\nTWO, LOW_TOP")
    result = lopin.run(lopin.Deck.parse(deck, "halves", tmp_path))
    sheet.compare(CASE,
                  f"CPE4, {cells[0]}/{cells[1]}, slave in two halves{', tied' if tie else ''}: "
                  "worst stress error", pair.stress_error(result, PRESSED), 0.0, 1e-10, "exact",
                  absolute=True)


def rings(out, inside, mortar, slave, quadratic):
    """Concentric rings 1.0/0.6 and 0.6/0.2, a quarter; adjusted: their facets are chords of one
    circle."""
    mesh = together(
        OUT=mesh_make.ring(0.6, 1.0, (max(2, out//4), out), quadratic=quadratic),
        IN=mesh_make.ring(0.2, 0.6, (max(2, inside//4), inside), quadratic=quadratic))
    model = Model("rings", mesh)
    for body in ("OUT", "IN"):
        model.section(body, Elastic(1e9, 0.2))
        model.fix(f"{body}.START", "y")
        model.fix(f"{body}.END", "x")
    model.contact(*("OUT.INNER", "IN.OUTER")[::1 if slave == "outer" else -1], Lagrange(),
                  adjust=1.0, surface_to_surface=mortar)
    model.step().pressure("OUT.OUTER", 1e6)
    result = lopin.run(model.to_deck())
    pressed = result.contact(0).last
    weight, error = pressed["weight"], pressed.pressure/925925.9259259259 - 1.0
    points = result.to_meshio().points
    middle = np.abs(np.linalg.norm(points[:, :2], axis=1) - 0.6) < 1e-6
    moved = np.linalg.norm(np.asarray(result["U"])[middle, :2], axis=1)
    return (np.abs(error).max(), np.sqrt((weight*error**2).sum()/weight.sum()),
            np.abs(moved/(0.0016/3.0) - 1.0).max(), pressed.pressure.max()/pressed.pressure.min())


@pytest.mark.parametrize("slave", ["outer", "inner"])
@pytest.mark.parametrize("quadratic", [False, True])
def test_rings(core, sheet, quadratic, slave):
    """Uniform pressure on a curved interface; displacements converge with h^2 although facets do
    not match."""
    case, name = "B4 concentric rings", f"{'CPE8' if quadratic else 'CPE4'}, {slave} slave"
    found = [rings(n, 2*n//3, True, slave, quadratic) for n in (12, 24, 48)]
    worst, mean, moved, ratio = found[-1]
    sheet.compare(case, f"{name}, 48/32: worst pressure error", worst, 0.0, 2e-4 if quadratic
                  else 2e-3, absolute=True)
    sheet.compare(case, f"{name}, 48/32: radial displacement, worst error", moved, 0.0,
                  1e-5 if quadratic else 6e-4, absolute=True)
    sheet.compare(case, f"{name}, 48/32: largest over smallest pressure", ratio, 1.0,
                  3e-4 if quadratic else 4e-3)
    rate = np.log(found[0][2]/moved)/np.log(4.0)
    sheet.compare(case, f"{name}: rate of the radial displacement", rate, 1.8, 0.0, "h^2",
                  at_least=True)
    rate = np.log(found[0][1]/mean)/np.log(4.0)
    sheet.compare(case, f"{name}: rate of the pressure, root mean square", rate, 1.8 if quadratic
                  else 0.95, 0.0, "h^2 and h", at_least=True)
    node = rings(48, 32, False, slave, quadratic)
    sheet.compare(case, f"{name}, 48/32, node to segment: largest over smallest pressure", node[3],
                  1.0, 1.5, "a property of the method")


@pytest.mark.parametrize("kind", ["CPE4", "CPE3"])
def test_node_to_segment_beside_it(solve, sheet, tmp_path, kind):
    """What mortar is for: the same blocks at the nodes."""
    for slave in ("lower", "upper"):
        pair = Pair(kind, 7, 10, 3, uneven=0.3).pressed()
        result = pair.solve(solve, tmp_path, slave=slave, words="TYPE=NODE TO SURFACE")
        error = pair.stress_error(result, PRESSED)
        case = CASE if kind == "CPE4" else "B5 patch test with other elements, mortar"
        sheet.compare(case,
                      f"{kind}, 7/10 uneven, {slave} slave, node to segment: worst stress error",
                      error, 0.0, 1.0, "a property of the method", absolute=True)
        assert error > 0.01


@pytest.mark.parametrize("kind", ["CPE8", "CPE6"])
def test_node_to_segment_of_second_order_faces_is_carried_out_surface_to_surface(
        solve, sheet, tmp_path, kind):
    pair = Pair(kind, 7, 10, 3, uneven=0.3).pressed()
    result = pair.solve(solve, tmp_path, slave="upper", words="TYPE=NODE TO SURFACE")
    sheet.compare("B5 patch test with other elements, mortar",
                  f"{kind}, 7/10 uneven, NODE TO SURFACE: worst stress error",
                  pair.stress_error(result, PRESSED), 0.0, 1e-10, "exact", absolute=True)


def test_swapping_the_sides_of_a_line_contact(core, root, sheet):
    """NAFEMS R0094-1: cylinder or block as slave; the normals are those of the slave."""
    text = (root/"decks"/"nafems_cylinder.inp").read_text(encoding="utf-8")
    pair = "*CONTACT PAIR, INTERACTION=SMOOTH\nBLOCK.NEAR, CYLINDER.ARC"
    assert pair in text
    found = []
    for sides in ("BLOCK.NEAR, CYLINDER.ARC", "CYLINDER.ARC, BLOCK.NEAR"):
        words = f"*CONTACT PAIR, INTERACTION=SMOOTH, TYPE=SURFACE TO SURFACE\n{sides}"
        result = lopin.run(lopin.Deck.parse(text.replace(pair, words), "swap", root/"decks"))
        found.append((result.contact(0).last.pressure.max(), result.history["energy.strain"][-1]))
        sheet.compare("A3 cylinder on block, mortar",
                      f"{sides.split('.')[0].lower()} as slave: largest pressure",
                      found[-1][0], 3585.36, 0.01, "Hertz 1882")
    for name, first, second in zip(("largest pressure", "strain energy"), *found):
        sheet.compare("A3 cylinder on block, mortar", f"sides swapped: {name}", second, first, 0.01,
                      "the other side")


@pytest.mark.parametrize("kind", ["CPE4", "CPE8", "CPE6"])
@pytest.mark.parametrize("slave", ["lower", "upper"])
@pytest.mark.parametrize("turn", [0.0, 27.0])
def test_friction_holds_a_uniform_shear(core, sheet, tmp_path, kind, slave, turn):
    """Pressure 1 and shear 0.25 with mu = 0.5: all sticks, and friction alone holds the upper
    block."""
    pair = Pair(kind, 7, 10, 3, uneven=0.3).turned(turn).pressed(held=False).sheared(0.25)
    result = pair.solve(lopin.run, tmp_path, slave=slave, friction="0.5")
    name = f"{kind}, 7/10 uneven, {slave} slave{', turned by 27 degrees' if turn else ''}"
    sheet.compare("B3 patch test with friction, mortar", f"{name}: worst stress error",
                  pair.stress_error(result, (0.0, -1.0, -NU, 0.25)), 0.0, 1e-10, "exact",
                  absolute=True)
    pressed = result.contact(0).last
    assert (pressed.status == 1).all()
    sheet.compare("B3 patch test with friction, mortar", f"{name}: largest slip",
                  np.abs(pressed["tangential_displacement"]).max(), 0.0, 1e-10, "stick",
                  absolute=True)


@pytest.mark.parametrize("kind", ["CPE4", "CPE8", "CPE6", "CAX4"])
@pytest.mark.parametrize("slave", ["lower", "upper"])
def test_uniform_pressure_on_the_present_shape(solve, sheet, tmp_path, kind, slave):
    """NLGEOM: the blocks swell and slide on each other; stresses stay uniform."""
    pair = Pair(kind, 7, 10, 3, uneven=0.3, inner=3.0 if kind == "CAX4" else 0.0).pressed(20.0)
    path = tmp_path/"far.inp"
    path.write_text(pair.deck(slave=slave).replace("*STEP\n", "*STEP, NLGEOM\n"), encoding="utf-8")
    result = solve(lopin.Deck.read(path))
    stress = pair.stresses(result)
    sheet.compare("B1 patch test with NLGEOM, mortar",
                  f"{kind}, 7/10 uneven, {slave} slave: spread of the stresses "
                  "over the largest", np.ptp(stress, axis=0).max()/np.abs(stress).max(), 0.0, 1e-6,
                  "uniform; printed to seven digits", absolute=True)


@pytest.mark.parametrize("method", ["DIRECT", "PENALTY\n1.e5", "AUGMENTED LAGRANGE\n1.e5"])
@pytest.mark.parametrize("kind", ["CPE4", "CPE8"])
def test_a_block_dragged_over_many_facets(core, sheet, tmp_path, kind, method):
    """Full slip by Coulomb's law over joints of a mesh that does not match, 1.4 facets in 8
    increments."""
    pair = Pair(kind, 10, 5, 2, left=2.1, right=5.0).pressed(held=False)
    deck = pair.deck(behaviour=method, friction="0.3").replace("*STEP\n", "*STEP, NLGEOM\n")
    deck = deck.replace("1., 1.\n", "0.125, 1.\n")
    top = "\n".join(f"{n}," for n in pair.up.where(lambda p: abs(p[1] - 8.0) < 1e-9))
    deck = deck[:deck.index("*CLOAD")] + deck[deck.index("*EL PRINT"):]
    deck = deck.replace("*STEP,", f"*NSET, NSET=GRIP\n{top}\n*BOUNDARY\nLOW_BASE, 1\n*STEP,", 1)
    deck = deck.replace("*DSLOAD", "*BOUNDARY\nGRIP, 1, 1, 1.4\nGRIP, 2, 2, -0.05\n*DSLOAD", 1)
    result = lopin.run(lopin.Deck.parse(deck, "drag", tmp_path))
    name = method.split("\n")[0].lower()
    worst = 0.0
    for k in range(1, 8):
        pressed = result.contact(0).at(k)
        shut = pressed.status == 2
        normal, force = pressed["normal"], pressed.force
        along = np.linalg.norm(np.atleast_2d(np.asarray(pressed["R_t"]))[shut],
                               axis=1) if "R_t" in pressed.fields \
            else np.linalg.norm(force[shut]
                                - (force[shut]*normal[shut]).sum(1)[:, None]*normal[shut], axis=1)
        push = np.abs((force[shut]*normal[shut]).sum(1))
        worst = max(worst, np.abs(along/push - 0.3).max())
        assert shut.any()
    sheet.compare("D6 sliding over joints, mortar",
                  f"{kind}, {name}: worst |t| over p - mu of closed nodes", worst,
                  0.0, 1e-10, "Coulomb", absolute=True)
