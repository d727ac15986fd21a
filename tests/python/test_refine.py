"""Decks on finer meshes: every cell, sets, surfaces, loads and curved boundaries."""
import pathlib

import numpy as np
import pytest
from tool_patches import Lines, family, is_quadratic

import lopin
from lopin.deck import Deck
from lopin.errors import ModelError
from lopin.mesh.cells import CELLS
from lopin.mesh.shapes import smallest_jacobian
from lopin.mesh_make import block, extruded, ring, simplices
from lopin.model_read_mesh import MeshCards
from lopin.refine import of_second_order, refined
from lopin.refine.children import children
from lopin.refine.curved import lifts_in_plane, lifts_in_space
from lopin.refine.local import LocalMesh
from lopin.refine.subdivide import SECOND

DECKS = pathlib.Path(__file__).resolve().parents[2]/"decks"
WORDS = ["CPE3", "CPE4", "CPE4I", "CPE4R", "CPE6", "CPE8", "CPE8R", "CPS4", "CAX3", "CAX4", "CAX6",
         "CAX8R", "C3D4", "C3D6", "C3D8", "C3D8I", "C3D8R", "C3D10", "C3D15", "C3D20", "C3D20R"]


def mesh_of(word, size=(2.0, 1.0, 1.5), cells=(2, 2, 2)):
    cell = family(word)
    if not word.startswith("C3D"):
        mesh = block(size[:2], cells[:2])
        mesh = simplices(mesh) if cell == "triangle" else mesh
    elif cell == "wedge":
        mesh = extruded(simplices(block(size[:2], cells[:2])), size[2], cells[2])
    else:
        mesh = block(size, cells)
        mesh = simplices(mesh) if cell == "tetra" else mesh
    return mesh.quadratic() if is_quadratic(word) else mesh


def pressed(word, load):
    """A block on rollers under a uniform pressure on its top."""
    lines = Lines()
    lines.add("*HEADING", word, "*MATERIAL, NAME=M", "*ELASTIC", "1000., 0.3")
    lines.mesh(mesh_of(word), word, "B")
    sides = ["BLEFT, 1", "BFRONT, 2", "BBOTTOM, 3"] if word.startswith("C3D") else \
        ["BLEFT, 1", "BBOTTOM, 2"]
    lines.add("*SOLID SECTION, ELSET=BE, MATERIAL=M", "*BOUNDARY", *sides, "*STEP", "*STATIC",
              *load, "*END STEP")
    return Deck.parse("\n".join(lines.text) + "\n", name=f"cut_{word.lower()}")


@pytest.mark.parametrize("name", CELLS)
def test_children_fill_their_parent(name):
    if name.startswith("line"):
        return
    cut, cell = children(name), CELLS[name]
    assert len(cut.cells) == 2**cell.ndim
    assert smallest_jacobian(name, cut.xi[cut.cells]) > 0.0
    corners = cut.xi[cut.cells[:, :cell.n_corner]]
    inside = corners.mean(axis=1)
    assert len(np.unique(np.round(inside, 6), axis=0)) == len(inside)
    for number, own in enumerate(cut.faces):
        assert len(own) == (2 if cell.ndim == 2 else 4)
        nodes = CELLS[cell.family].faces[number]
        for child, face in own:
            on = cut.corner[cut.cells[child, list(CELLS[cell.family].faces[face])]]
            assert np.allclose(on[:, list(nodes)].sum(axis=1), 1.0)


@pytest.mark.parametrize("word", WORDS)
def test_a_uniform_state_stays_uniform(solve, word):
    """Sets, surfaces and pressures follow: each mesh has the same answer to rounding."""
    deck = pressed(word, ["*DSLOAD", "BSTOP, P, 10."])
    finer = refined(deck)
    count = sum(len(b.data) for b in deck.all("ELEMENT"))
    assert finer.n_element == count*(8 if word.startswith("C3D") else 4)
    coarse, fine = solve(deck), solve(finer.deck)
    assert np.allclose(coarse["S"], coarse["S"][0], atol=1e-9)
    assert np.allclose(fine["S"], coarse["S"][0], rtol=1e-9, atol=1e-9)
    rows = np.isin(fine["LABEL"].ravel(), coarse["LABEL"].ravel())
    assert np.allclose(fine["U"][rows], coarse["U"], rtol=1e-9, atol=1e-12)
    again = refined(finer.deck)
    assert again.n_element == finer.n_element*(8 if word.startswith("C3D") else 4)
    sets = MeshCards(again.deck.blocks)
    assert len(sets.nsets["BTOP"]) > len(MeshCards(deck.blocks).nsets["BTOP"])


@pytest.mark.parametrize("word", ["CPE4", "CPE8", "C3D8", "C3D10"])
def test_loads_on_faces_of_element_sets(solve, word):
    """*DLOAD names faces of whole sets: only the children that have such a face bear it."""
    lines = ["*DLOAD", "BE, P3, 10."] if not word.startswith("C3D8") else ["*DLOAD", "BE, P2, 10."]
    if word == "C3D10":
        lines = ["*DSLOAD", "BSTOP, P, 10."]
    mesh_cells = {"CPE4": (2, 1, 1), "CPE8": (2, 1, 1), "C3D8": (2, 2, 1)}
    deck = pressed(word, lines)
    if word in mesh_cells:
        text = Lines()
        text.add("*HEADING", word, "*MATERIAL, NAME=M", "*ELASTIC", "1000., 0.3")
        text.mesh(mesh_of(word, cells=mesh_cells[word]), word, "B")
        sides = ["BLEFT, 1", "BFRONT, 2", "BBOTTOM, 3"] if word.startswith("C3D") else \
            ["BLEFT, 1", "BBOTTOM, 2"]
        text.add("*SOLID SECTION, ELSET=BE, MATERIAL=M", "*BOUNDARY", *sides, "*STEP", "*STATIC",
                 *lines, "*END STEP")
        deck = Deck.parse("\n".join(text.text) + "\n", name="faces")
    coarse, fine = solve(deck), solve(refined(deck).deck)
    assert np.allclose(fine["S"], coarse["S"][0], rtol=1e-9, atol=1e-8)


def test_arcs_are_exact_in_the_plane():
    angles = np.cumsum([0.0, 0.3, 0.2, 0.25, 0.2])
    x = 5.0*np.column_stack([np.cos(angles), np.sin(angles)])
    edges = np.array([[0, 1], [1, 2], [2, 3], [3, 4]])
    middle = 0.5*(x[edges[:, 0]] + x[edges[:, 1]]) + lifts_in_plane(x, edges)
    assert np.allclose(np.linalg.norm(middle, axis=1), 5.0, atol=1e-4)
    even = 5.0*np.column_stack([np.cos(0.3*np.arange(5)), np.sin(0.3*np.arange(5))])
    middle = 0.5*(even[edges[:, 0]] + even[edges[:, 1]]) + lifts_in_plane(even, edges)
    assert np.allclose(np.linalg.norm(middle, axis=1), 5.0, atol=1e-12)


def test_flat_sides_and_corners_stay():
    x = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [0.0, 1.0]])
    edges = np.stack([np.arange(6), np.roll(np.arange(6), -1)], axis=1)
    assert not lifts_in_plane(x, edges).any()
    assert smallest_lift(block((1.0, 1.0, 1.0), (2, 2, 2))) == 0.0


def outline(points, low=-4.0):
    """Nodes and edges of the body below a line of points, the body on the left."""
    x = np.array([*points[::-1], [points[0][0], low], [points[-1][0], low]], float)
    return x, np.stack([np.arange(len(x)), np.roll(np.arange(len(x)), -1)], axis=1)


@pytest.mark.parametrize("points", [
    [(-4, -0.4), (0, 0), (4, -0.4)], [(-4, -0.8), (-2, -0.4), (0, 0), (2, -0.4), (4, -0.8)],
    [(0, 0), (4, -0.4)], [(0, 0), (1, 0), (2, 0), (3, 0), (4, -0.25)], [(0, 0), (2, 0), (4, -0.6)],
    [(-4, -0.5), (-2, 0), (2, 0), (4, -0.5)], [(-4, 0), (-1, 0), (1, -0.4), (4, -1.6)],
    [(-4, 0), (-2, 0), (-1, 0), (1, -0.4), (4, -1.6), (5, -2.0)], [(-4, 0), (0, -0.6), (4, 0)]],
    ids="roof roof_of_four half_roof chamfer cone two_chamfers slope slope_of_many valley".split())
def test_corners_that_turn_by_little_stay(points):
    """One turn, or two beside straight edges, are no arc: in the plane and as a prism in space, of
    one, two and three layers."""
    assert not lifts_in_plane(*outline(points)).any()
    x = np.array(points, float)
    for layers in (1, 2, 3):
        mesh = extruded(block((1.0, 1.0), (len(x) - 1, 2)), 2.0, layers)
        column = np.round(mesh.points[:, 0]*(len(x) - 1)).astype(int)
        top = x[column, 1]
        mesh.points[:, 0] = x[column, 0]
        mesh.points[:, 1] = -4.0 + mesh.points[:, 1]*(4.0 + top)
        assert smallest_lift(mesh) < 1e-12
        assert smallest_lift(simplices(mesh)) < 1e-12


@pytest.mark.parametrize("count", [2, 3, 4, 8])
def test_arcs_that_end_at_planes_of_symmetry_are_arcs(count):
    """Of two edges and more: pipes of one and two layers, of bricks and tetrahedra."""
    mesh = ring(1.0, 1.2, (1, count), angles=(0.0, 50.0))
    for layers in (1, 2):
        made = extruded(mesh, 0.3, layers)
        for cells in (made, simplices(made)):
            faces = np.array([cells.face_nodes(*row) for row in cells.boundary()])
            n = faces.shape[1]
            edges = np.unique(np.sort(np.vstack([faces[:, [k, (k + 1) % n]] for k in range(n)]),
                                      axis=1), axis=0)
            middle = cells.points[edges].mean(axis=1) + lifts_in_space(cells.points, [faces], edges)
            flat = np.abs(cells.points[edges][:, 0, 2] - cells.points[edges][:, 1, 2]) < 1e-9
            radius = np.linalg.norm(cells.points[:, :2], axis=1)
            for r in (1.0, 1.2):
                own = flat & (np.abs(radius[edges] - r) < 1e-9).all(axis=1)
                assert np.allclose(np.linalg.norm(middle[own, :2], axis=1), r, rtol=3e-3)


def smallest_lift(mesh):
    faces = np.array([mesh.face_nodes(*row) for row in mesh.boundary()])
    n = faces.shape[1]
    edges = np.unique(np.sort(np.vstack([faces[:, [k, (k + 1) % n]] for k in range(n)]), axis=1),
                      axis=0)
    return np.abs(lifts_in_space(mesh.points, [faces], edges)).max()


def test_a_ring_of_bricks_becomes_round():
    """Inner and outer faces and their rims; flat ends and cuts stay flat."""
    mesh = extruded(ring(1.0, 2.0, (2, 4)), 1.0, 2)
    faces = np.array([mesh.face_nodes(*row) for row in mesh.boundary()])
    pairs = np.vstack([np.stack([faces[:, k], faces[:, (k + 1) % 4]], axis=1) for k in range(4)])
    edges = np.unique(np.sort(pairs, axis=1), axis=0)
    middle = mesh.points[edges].mean(axis=1) + lifts_in_space(mesh.points, [faces], edges)
    radius = np.linalg.norm(mesh.points[:, :2], axis=1)
    for r in (1.0, 2.0):
        own = (np.abs(radius[edges] - r) < 1e-9).all(axis=1)
        assert np.allclose(np.linalg.norm(middle[own, :2], axis=1), r, atol=2e-3*r)
    assert np.abs(middle[:, 2] - mesh.points[edges][:, :, 2].mean(axis=1)).max() < 1e-12


def test_a_set_of_two_sides_holds_nothing_between_them():
    deck = pressed("CPE4", ["*DSLOAD", "BSTOP, P, 10."])
    cards = MeshCards(deck.blocks)
    both = sorted({*cards.nsets["BLEFT"], *cards.nsets["BRIGHT"]})
    deck.blocks.insert(1 + deck.blocks.index(deck.all("NSET")[-1]),
                       Deck.parse("*NSET, NSET=SIDES\n" + ", ".join(map(str, both)) + "\n"
                                  ).blocks[0])
    finer = MeshCards(refined(deck).deck.blocks)
    x = np.array([finer.nodes[n][0] for n in finer.nsets["SIDES"]])
    assert len(x) == 10 and np.isin(x, [x.min(), x.max()]).all()


def test_displacements_node_by_node_are_filled_in():
    deck = pressed("CPE4", ["*BOUNDARY", "BTOP, 2, 2, -0.1"])
    cards = MeshCards(deck.blocks)
    rows = [f"{n}, 2, 2, {-0.1*cards.nodes[n][0]!r}" for n in cards.nsets["BTOP"]]
    deck = Deck.parse(deck.text().replace("BTOP, 2, 2, -0.1", "\n".join(rows)), name="rows")
    finer = refined(deck).deck
    given = {row[0]: row[3] for row in finer.all("BOUNDARY")[-1].data}
    nodes = MeshCards(finer.blocks).nodes
    assert len(given) == 5
    assert all(np.isclose(v, -0.1*nodes[n][0]) for n, v in given.items())


def held_as(word, rows, sets=()):
    """Nodes held in each direction on the finer mesh of a block whose bottom is held by `rows`."""
    deck = pressed(word, ["*DSLOAD", "BSTOP, P, 10."])
    text = deck.text()
    begin = text.index("*BOUNDARY")
    cards = "".join(f"*NSET, NSET={name}\n" + ",\n".join(map(str, own)) + "\n"
                    for name, own in sets)
    text = text[:begin] + cards + "*BOUNDARY\n" + "\n".join(["BLEFT, 1", *rows]) + "\n" \
        + text[text.index("*STEP"):]
    finer = refined(refined(Deck.parse(text, name="held")).deck)
    cards = MeshCards(finer.deck.blocks)
    held = {}
    for b in finer.deck.all("BOUNDARY"):
        for row in b.data:
            for d in range(row[1], (row[2] if len(row) > 2 and row[2] else row[1]) + 1):
                held.setdefault(d, set()).update(cards.labels(row[0]))
    return held, cards


@pytest.mark.parametrize("word", ["CPE3", "CPE4", "CPE8", "C3D4", "C3D8"])
def test_one_support_is_one_however_it_is_written(word):
    """A bottom by a set; by labels of unlike fields, on one card or many; by labels and sets."""
    axis = 3 if word.startswith("C3D") else 2
    nodes = MeshCards(pressed(word, ["*DSLOAD", "BSTOP, P, 10."]).blocks)
    bottom = sorted(set(nodes.nsets["BBOTTOM"]), key=lambda n: nodes.nodes[n])
    x = {n: nodes.nodes[n][0] for n in bottom}
    left, right = ([n for n in bottom if (x[n] <= 1.0) == side] for side in (True, False))
    corner = next(n for n in bottom if x[n] == 0.0)
    both = f"{axis}, {axis}"
    ways = {
        "labels": ([f"{n}, {axis}" if k % 2 else f"{n}, {both}" for k, n in enumerate(bottom)], ()),
        "cards": ([f"{n}, {both}\n*BOUNDARY" for n in bottom[:-1]] + [f"{bottom[-1]}, {axis}"], ()),
        "corner": ([f"{corner}, 1, {axis}"] + [f"{n}, {axis}" for n in bottom if n != corner], ()),
        "label and set": ([f"{corner}, {both}", f"REST, {axis}"],
                          [("REST", [n for n in bottom if n != corner])]),
        "three sets": ([f"{name}, {axis}" for name in ("COLD", "LOW", "HIGH")],
                       [("COLD", [corner]), ("LOW", left), ("HIGH", right)]),
        "sets": ([f"LOW, {axis}\n*BOUNDARY\nHIGH, {axis}"], [("LOW", left), ("HIGH", right)])}
    right, _ = held_as(word, [f"BBOTTOM, {axis}"])
    for name, (rows, sets) in ways.items():
        found, cards = held_as(word, rows, sets)
        assert found[axis] == right[axis], (word, name)
        assert found[1] >= right[1] and len(found[1] - right[1]) <= (name == "corner"), name


def test_two_opposite_sides_hold_nothing_between_them():
    """One element between them: sets of one value, with and without a held bottom."""
    for word in ("CPE4", "C3D8", "CPE8"):
        text = Lines()
        text.add("*HEADING", word, "*MATERIAL, NAME=M", "*ELASTIC", "1000., 0.3")
        text.mesh(mesh_of(word, cells=(1, 2, 2)), word, "B")
        text.add("*SOLID SECTION, ELSET=BE, MATERIAL=M", "*BOUNDARY", "BLEFT, 1", "BRIGHT, 1",
                 "BBOTTOM, 1, 2", "*STEP", "*STATIC", "*DSLOAD", "BSTOP, P, 10.", "*END STEP")
        finer = refined(Deck.parse("\n".join(text.text) + "\n", name="opposite")).deck
        assert [row[0] for row in finer.all("BOUNDARY")[0].data] == ["BLEFT", "BRIGHT", "BBOTTOM"]


def test_temperatures_of_several_sets_and_labels_leave_no_hole():
    deck = pressed("CPE4", ["*DSLOAD", "BSTOP, P, 10."])
    cards = MeshCards(deck.blocks)
    halves = [[n for n in cards.nodes if (cards.nodes[n][1] < 0.4) == low] for low in (True, False)]
    text = deck.text().replace("*BOUNDARY", "".join(
        f"*NSET, NSET=H{k}\n" + ",\n".join(map(str, own)) + "\n" for k, own in enumerate(halves))
        + "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nH0, 10.\n" + "\n".join(
            f"{n}, 30." for n in halves[1]) + "\n*BOUNDARY", 1)
    finer = refined(Deck.parse(text, name="warm")).deck
    cards, given = MeshCards(finer.blocks), {}
    for row in finer.all("INITIAL CONDITIONS")[0].data:
        given |= dict.fromkeys(cards.labels(row[0]), row[1])
    assert given == {n: 10.0 if x[1] < 0.1 else 20.0 if x[1] < 0.4 else 30.0
                     for n, x in cards.nodes.items()}


@pytest.mark.parametrize("card", ["*CLOAD\nBTOP, 2, -1.", "*DLOAD\n1, P3, 2.\n*CLOAD\nBTOP, 1, 1."])
def test_what_a_finer_mesh_cannot_carry_is_refused(card):
    with pytest.raises(ModelError, match="CLOAD"):
        refined(pressed("CPE4", card.split("\n")))


def test_surfaces_of_single_nodes_are_refused_at_once():
    deck = pressed("CPE4", ["*DSLOAD", "BSTOP, P, 10."])
    text = deck.text().replace("*BOUNDARY", "*SURFACE, NAME=ROW, TYPE=NODE\n1\n2\n*BOUNDARY", 1)
    with pytest.raises(ModelError, match="ROW"):
        refined(Deck.parse(text, name="row"))
    refined(Deck.parse(text.replace("\n1\n2\n", "\nBTOP\n"), name="row"))


def test_layers_of_one_arc_are_lifted_alike():
    """A thin curved layer: the inside would fold if one of its sides stayed."""
    lines = ["*NODE"]
    for k, a in enumerate(np.linspace(0.0, 1.0, 3)):
        for j, r in enumerate((1.0, 1.001)):
            lines.append(f"{2*k + j + 1}, {float(r*np.cos(a))!r}, {float(r*np.sin(a))!r}")
    lines += ["*ELEMENT, TYPE=CPE4, ELSET=E", "1, 1, 2, 4, 3", "2, 3, 4, 6, 5"]
    deck = Deck.parse("\n".join(lines) + "\n")
    nodes = np.array(list(MeshCards(refined(deck).deck.blocks).nodes.values()))
    radius = np.linalg.norm(nodes[:, :2], axis=1)
    assert len(nodes) == 15 and radius.min() > 0.9999 and radius.max() < 1.0011


@pytest.mark.parametrize("word", SECOND)
def test_second_order_on_the_same_cells(solve, word):
    deck = pressed(word, ["*DSLOAD", "BSTOP, P, 10."])
    made = of_second_order(deck)
    assert {b.parameters["TYPE"] for b in made.deck.all("ELEMENT")} == {SECOND[word]}
    coarse, fine = solve(deck), solve(made.deck)
    assert np.allclose(fine["S"], coarse["S"][0], rtol=1e-9, atol=1e-8)
    with pytest.raises(ModelError, match="second order"):
        of_second_order(made.deck)


@pytest.mark.parametrize("path", sorted(DECKS.glob("*.inp")), ids=lambda p: p.stem)
def test_every_deck_of_the_collection_on_a_finer_mesh(path):
    """It reads and checks, or is refused by name."""
    try:
        finer = refined(Deck.read(path)).deck
    except ModelError as refusal:
        assert path.stem in ("bar_gap", "full_flash", "elastic_anvil",
                             "trimmed_cup"), refusal
        return
    lopin.check(finer)


@pytest.mark.parametrize("word", [w for w in WORDS if not w.startswith("C3D")])
def test_a_uniform_state_stays_uniform_where_nodes_hang(solve, word):
    """Cells picked by chance, halved up to five times: neighbours differ by one halving."""
    deck = pressed(word, ["*DSLOAD", "BSTOP, P, 10."])
    local, chance = LocalMesh(deck), np.random.default_rng(0)
    for _ in range(5):
        local = local.refined(chance.choice(list(MeshCards(local.open.blocks).elements), 2))
    cards = MeshCards(local.deck.blocks)
    assert len(local.hanging) > 10 and local.n_element == len(cards.elements)
    coarse, fine = solve(deck), solve(local.deck)
    used = {n for _, nodes in cards.elements.values() for n in nodes}
    own = np.isin(fine["LABEL"].ravel(), list(used))
    assert np.allclose(fine["S"][own], coarse["S"][0], rtol=1e-9, atol=1e-9)
    # A node hangs on the edge of a cell as large as two cells beyond it, never as four.
    for h in local.hanging:
        assert h.node not in cards.elements[h.element][1]
        assert sum(h.weights) == pytest.approx(1.0)
        own = [np.array(cards.nodes[n]) for n in h.masters]
        assert np.allclose(sum(w*x for w, x in zip(h.weights, own)), cards.nodes[h.node])
    everywhere = local.everywhere()
    assert everywhere.n_element == 4*local.n_element
    assert np.allclose(solve(everywhere.deck)["S"].max(axis=0), coarse["S"][0], atol=1e-8)


@pytest.mark.parametrize("word", ["CPE3", "CPE4", "CPE8R", "CPS6"])
@pytest.mark.parametrize("kind", ["R", "C"])
def test_hanging_nodes_between_turned_axes(solve, word, kind):
    """A sheared block turned by any angle, its sides held in their own axes, cylindrical ones at
    the nodes of one side included: the same displacements in those axes."""
    found = []
    for angle in (0.0, 0.5, 1.3):
        c, s, mesh = float(np.cos(angle)), float(np.sin(angle)), mesh_of(word, cells=(4, 3, 1))
        mesh.points[:, :2] = mesh.points[:, :2] @ [[c, s], [-s, c]]
        lines = Lines()
        lines.add("*HEADING", word, "*MATERIAL, NAME=M", "*ELASTIC", "1000., 0.3")
        lines.mesh(mesh, word, "B")
        turned = f"{c!r}, {s!r}, 0., {-s!r}, {c!r}, 0."
        lines.add("*SOLID SECTION, ELSET=BE, MATERIAL=M")
        for name in ("BLEFT", "BTOP", "BBOTTOM"):
            lines.add(f"*TRANSFORM, NSET={name}, TYPE=R", turned)
        if kind == "C":   # about a point below the block
            lines.add("*TRANSFORM, NSET=BRIGHT, TYPE=C",
                      f"{2.0*s!r}, {-2.0*c!r}, 0., {2.0*s!r}, {-2.0*c!r}, 1.", "*BOUNDARY",
                      "BRIGHT, 1, 2, 0.02")
        lines.add("*BOUNDARY", "BLEFT, 1", "BBOTTOM, 2", "*STEP", "*STATIC", "*BOUNDARY",
                  "BTOP, 1, 1, 0.1", "*NODE FILE", "U", "*END STEP")
        deck = Deck.parse("\n".join(lines.text) + "\n", name="turned")
        local = LocalMesh(deck)
        for _ in range(2):
            every = list(MeshCards(local.open.blocks).elements)
            local = local.refined(every[::3])
        assert len(local.hanging) > 3
        u = solve(local.deck)["U"]
        found.append(np.column_stack([c*u[:, 0] + s*u[:, 1], -s*u[:, 0] + c*u[:, 1]]))
    assert np.abs(found[0]).max() > 0.05
    for other in found[1:]:
        assert np.allclose(other, found[0], rtol=1e-5, atol=1e-7)   # results are single


def test_all_cells_in_part_are_all_cells():
    """The same nodes, sets and surfaces as of the deck that is refined everywhere."""
    deck = Deck.read(DECKS/"nafems_cylinder.inp")
    one, other = MeshCards(refined(deck).deck.blocks), MeshCards(LocalMesh(deck).everywhere(
        ).deck.blocks)
    assert np.allclose(sorted(one.nodes.values()), sorted(other.nodes.values()))
    assert {k: len(v) for k, v in one.nsets.items()} == {k: len(v) for k, v in other.nsets.items()}
    assert {k: len(v) for k, v in one.elsets.items()} == {
        k: len(v) for k, v in other.elsets.items()}


def test_a_round_side_stays_round_where_cells_are_halved_in_part():
    deck = Deck.read(DECKS/"nafems_cylinder.inp")
    local = LocalMesh(deck)
    for _ in range(3):
        cards = MeshCards(lopin.model_read_mesh.expanded(local.open))
        arc = set(cards.nsets["CYLINDER.ARC"]) if "CYLINDER.ARC" in cards.nsets else \
            {n for n, x in cards.nodes.items() if abs(np.hypot(x[0], x[1] - 50.0) - 50.0) < 1e-6}
        local = local.refined(label for label, (_, nodes) in cards.elements.items()
                              if arc & set(nodes) and cards.nodes[nodes[0]][0] < 5.0)
    before = MeshCards(lopin.model_read_mesh.expanded(deck))
    cards = MeshCards(lopin.model_read_mesh.expanded(local.deck))
    place = np.array(list(before.nodes.values()))
    cylinder = {n for m in before.elsets["CYLINDER"] for n in before.elements[m][1]}
    centre = before_centre(np.array([before.nodes[n] for n in cylinder]))

    def radius(n):
        return float(np.hypot(*(np.array(cards.nodes[n][:2]) - centre)))

    outer = max(radius(n) for n in cylinder)
    new = [n for m in cards.elsets["CYLINDER"] for n in cards.elements[m][1] if n not in cylinder]
    assert len(place) < len(cards.nodes)
    assert max(radius(n) for n in new) < outer*(1.0 + 1e-6)
    on = [n for n in new if radius(n) > outer*(1.0 - 1e-4)]
    assert len(on) > 20
    assert max(abs(radius(n) - outer) for n in on) < 1e-6*outer


def before_centre(x):
    """Centre of the cylinder: its radius is 50."""
    low = x[np.argmin(x[:, 1])]
    return np.array([0.0, low[1] + 50.0])


def test_meshes_in_space_are_not_refined_in_part():
    deck = pressed("C3D8", ["*DSLOAD", "BSTOP, P, 10."])
    with pytest.raises(ModelError, match="only plane"):
        LocalMesh(deck).refined([1])


@pytest.mark.parametrize("word", ["CPE6", "CPE8", "C3D20"])
def test_a_set_that_ends_in_the_middle_of_an_edge_goes_on_to_there(word):
    """A clamp that leaves out the slave node at its end: half of the last edge stays held, however
    often it is cut (new nodes had gaps between them that grew with every cut)."""
    deck = pressed(word, ["*DSLOAD", "BSTOP, P, 10."])
    cards = MeshCards(deck.blocks)
    lowest = min(v[-1 if word.startswith("C3D") else 1] for v in cards.nodes.values())
    axis = 2 if word.startswith("C3D") else 1
    held = [n for n in cards.nsets["BLEFT"] if cards.nodes[n][axis] > lowest + 1e-9]
    deck.blocks.insert(1 + deck.blocks.index(deck.all("NSET")[-1]),
                       Deck.parse("*NSET, NSET=HELD\n" + ",\n".join(map(str, held)) + "\n").blocks[0])
    least = min(cards.nodes[n][axis] for n in held)
    for _ in range(1 if word.startswith("C3D") else 2):
        deck = refined(deck).deck
    cards = MeshCards(deck.blocks)
    left = [n for n in cards.nsets["BLEFT"] if cards.nodes[n][axis] > least - 1e-9]
    if word.startswith("C3D"):   # new edges through faces that are held in part stay free
        left = [n for n in left if abs(cards.nodes[n][1] - cards.nodes[left[0]][1]) < 1e-9
                and cards.nodes[n][1] in (0.0, 1.0)]
    assert set(left) <= set(cards.nsets["HELD"])


def test_displacements_up_to_the_middle_of_an_edge_are_filled_in():
    deck = pressed("CPE8", ["*BOUNDARY", "BTOP, 2, 2, -0.1"])
    cards = MeshCards(deck.blocks)
    rows = {n: -0.1*cards.nodes[n][0] for n in cards.nsets["BTOP"] if cards.nodes[n][0] > 1e-9}
    text = "\n".join(f"{n}, 2, 2, {v!r}" for n, v in rows.items())
    deck = Deck.parse(deck.text().replace("BTOP, 2, 2, -0.1", text), name="rows")
    finer = refined(deck).deck
    given = {row[0]: row[3] for row in finer.all("BOUNDARY")[-1].data}
    nodes = MeshCards(finer.blocks).nodes
    assert len(given) == 7 and min(nodes[n][0] for n in given) == pytest.approx(0.5)
    assert all(np.isclose(v, -0.1*nodes[n][0]) for n, v in given.items())
