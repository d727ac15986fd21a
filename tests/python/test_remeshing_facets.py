"""New meshes under tools of triangles: seated on them, planes exact, forces as under the true arc."""
import numpy as np
import pytest
from faceted_die import stl
from test_point_states import NORTON, deck
from test_remeshing import history, run

import lopin
from lopin import mesh_make
from lopin.remesh.body import DeckParts, boundary_facets, read_body
from lopin.remesh.join import join_histories
from lopin.remesh.part import NewMesh
from lopin.remesh.plane import corner_quality
from lopin.remesh.report import Remesh, Report
from lopin.remesh.space import narrowest_slot, volume_inside
from lopin.remesh.spatial import ENOUGH, KEPT, references, references_of_facets, upright_moves

pytest.importorskip("mmgpy")

RADIUS, LEVEL, DOWN = 4.0, 5.0, 1.6


def ridge(folder, facets, card, mu=0.2, travel=-DOWN, increments=20):
    """A block under a round ridge along z; `facets` to the whole turn, or 0 for the true arc."""
    mesh = mesh_make.simplices(mesh_make.block((5.0, 5.0, 4.0), (6, 6, 5)))
    text = deck("C3D4", mesh.points, mesh.blocks[0][1].tolist(), LEVEL, travel, mu=mu, law=NORTON,
                increments=increments).text()
    text = text.replace("*STEP, NLGEOM", f"*REMESH, ELSET=B, {card}\n*STEP, NLGEOM")
    start = text.index("*SURFACE, NAME=DIE")
    end = text.index("*RIGID BODY")
    if facets:
        angle = np.radians(np.arange(-80.0, 81.0, 360.0/facets))
        points = [(float(RADIUS*np.sin(a)), float(LEVEL + RADIUS - RADIUS*np.cos(a))) for a in angle.tolist()]
        upright = stl(points, 40.0).splitlines()
        folder.mkdir(exist_ok=True)
        (folder/"ridge.stl").write_text("\n".join(map(swapped, upright)))
        tool = f'*SURFACE, NAME=DIE, TYPE=STL, OPEN, INPUT="{folder/"ridge.stl"}"\n'
    else:
        x, y = map(float, RADIUS*np.array([np.sin(np.radians(80.0)), 1.0 - np.cos(np.radians(80.0))]))
        y += LEVEL
        tool = ("*SURFACE, NAME=DIE, TYPE=CYLINDER\n0., 0., 0., 1., 0., 0.\n0., 0., 1.\n"
                f"START, {x!r}, {y!r}\nCIRCL, {-x!r}, {y!r}, 0., {LEVEL + RADIUS!r}\n")
    return lopin.Deck.parse(text[:start] + tool + text[end:], name="ridge")


def swapped(line):
    """A vertex (x, width, height) as (x, height, width): the ridge lies along z."""
    words = line.split()
    if words[0] != "vertex":
        return line
    return f"vertex {words[1]} {words[3]} {float(words[2]) - 10.0!r}"


def test_a_ridge_of_triangles_presses_over_new_meshes_as_the_arc_does(core, tmp_path):
    """force, volume, planes, and nodes on the triangles."""
    card = "SIZE=1.6, SMALLEST=1., PERIOD=.4, STRAIN=10., PENETRATION=10."
    force = {}
    for facets in (0, 90):
        report = run(ridge(tmp_path, facets, card, travel=-1.2, increments=10), tmp_path/f"of{facets}")
        assert len(report.remeshes) >= 2 and report.verdict()[0] != "FAIL"
        assert max(abs(r.moved["volume_change"]) for r in report.remeshes) < 1e-12
        found = history(tmp_path/f"of{facets}", "ridge")
        force[facets] = np.interp(np.linspace(0.3, 1.0, 15), found["time"], found["DIE.rf2"])
    assert np.abs(force[90]/force[0] - 1.0).max() < 0.005
    for part in (2, 3):
        seated_and_held(lopin.Deck.read(tmp_path/"of90"/f"ridge.p{part:03d}.inp"))


def seated_and_held(deck):
    """Nodes of planes are on them to the bit; those that bear a traction are on the triangles."""
    body = read_body(DeckParts.of(deck), "B")
    for name, k in (("FLOOR", 1), ("AXIS", 0), ("BACK", 2)):
        held = np.unique([f for f, tag in zip(body.facets, body.tags) if ("N", name) in tag])
        assert len(held) > 4 and (body.x[held, k] == 0.0).all()
    with lopin.open(deck) as job:
        job.advance()
        bears = np.isin(body.labels, job.tractions.node[
            np.abs(job.tractions.traction).max(axis=1) > 0.0])
        gap = job._session.tool_feet(0, body.x[bears])[:, 0]
    assert bears.sum() > 10 and np.abs(gap).max() < 0.005


def test_facets_as_small_as_they_may_be_are_no_reason_for_a_new_mesh(core, tmp_path):
    """Middles of edges of 1.2 are h/8R = 0.04 to 0.08 inside the arc, on any new mesh."""
    card = "SIZE=1.2, SMALLEST=1.2, PENETRATION=.03, STRAIN=.5"
    report = run(ridge(tmp_path, 90, card, travel=-1.2, increments=8), tmp_path)
    assert 1 <= len(report.remeshes) <= 3
    assert all("inside a tool" not in r.reason for r in report.remeshes)


def brick(low, size, cells=(4, 4, 4)):
    mesh = mesh_make.simplices(mesh_make.block(size, cells)).moved(*low)
    return mesh.points, boundary_facets([mesh.blocks[0][1]], 3)[0]


def test_the_slot_of_a_fold_is_measured_and_the_thickness_of_metal_is_not():
    x, facets = brick((1.0, 1.0, 1.0), (2.0, 2.0, 0.4))
    assert narrowest_slot(x, facets, 1.0)[0] == np.inf
    y, more = brick((1.0, 1.0, 1.7), (2.0, 2.0, 2.0))
    both, skin = np.vstack([x, y]), np.vstack([facets, more + len(x)])
    slot, place = narrowest_slot(both, skin, 1.0)
    assert slot == pytest.approx(0.3, rel=1e-6) and place[2] == pytest.approx(1.55, rel=1e-6)
    assert narrowest_slot(both, skin, 0.2)[0] == np.inf


def test_a_fold_is_told_where_it_is(tmp_path):
    done = Remesh(1, 0.5, "worn", 10, 0.3, {"volume": 1.0, "volume_change": 0.0, "slot": 0.26,
                                            "slot_at": [103.53, 4.64, 2.87]}, 0.0, 0.0, 0.0, 1.0)
    assert "folds: 0.26 between its sides at (103.5, 4.64, 2.87)" in done.line()
    report = Report("rod", tmp_path, [], [done])
    report.jumps = lambda: [{"part": 1, "change": 0.0, "of_largest": 0.0}]
    verdict, said = report.verdict()
    assert verdict == "WARN" and len(said) == 1 and "at (103.5, 4.64, 2.87)" in said[0]


@pytest.mark.parametrize(("forces", "expected"), [
    (((0.0, -100.0), (-99.5, -10.0), (-6.0, -2.0)), "WARN"),   # a load that has fallen
    (((0.0, -10.0), (-6.0, -100.0), (-100.0, -100.0)), "FAIL"),   # one that rises
])
def test_a_change_of_force_is_judged_beside_the_largest_so_far(tmp_path, forces, expected):
    names = [f"cut.p{k + 1:03d}" for k in range(len(forces))]
    for name, pair in zip(names, forces):
        (tmp_path/f"{name}_history.csv").write_text(
            "time [t],PUNCH.rf2 [force]\n" + "".join(f"{0.1*k},{f}\n" for k, f in enumerate(pair)))
    done = [Remesh(k + 1, 0.1*k, "worn", 10, 0.3, {"volume": 1.0, "volume_change": 0.0}, 0.0, 0.0,
                   0.0, 1.0) for k in range(len(forces) - 1)]
    report = Report("cut", tmp_path, names, done)
    jumps = report.jumps()
    assert [j["change"] for j in jumps][expected == "FAIL"] == pytest.approx(
        {"WARN": 0.005, "FAIL": 0.0}[expected])
    worst = jumps[1 - (expected == "FAIL")]
    assert worst["change"] == pytest.approx(0.4)
    assert worst["of_largest"] == pytest.approx(0.04 if expected == "WARN" else 0.4)
    verdict, said = report.verdict()
    assert verdict == expected and len(said) == 1
    assert ("40 % of what it was then" in said[0]) == (expected == "WARN")
    assert "40 %" in report.text()


def test_nodes_that_a_tool_would_take_through_thin_metal_go_back_by_halves():
    """A plate of one cell; a tool that three of its top nodes are to lie on is below its bottom."""
    plate = mesh_make.simplices(mesh_make.block((4.0, 4.0, 0.5), (4, 4, 1)))
    x, cells = plate.points, plate.blocks[0][1]
    facets = boundary_facets([cells], 3)[0]
    mesh = NewMesh(x, [cells], facets, [frozenset()]*len(facets))
    wanted, top = x.copy(), np.flatnonzero(x[:, 2] > 0.4)[:3]
    wanted[top, 2] = -0.1
    assert corner_quality(wanted, cells).min() < 0.0
    free = np.ones(len(x), bool)
    free[top] = False
    moved, _, back = upright_moves(x, wanted, mesh, free, 8.0)
    assert back >= 3
    least = KEPT*np.minimum(corner_quality(x, cells), ENOUGH)
    assert (corner_quality(moved, cells) >= least).all()
    assert volume_inside(moved, facets) == pytest.approx(8.0, rel=1e-12)
    # What turns no cell over stays where it was put, to the bit.
    wanted[top, 2] = 0.45
    moved, _, back = upright_moves(x, wanted, mesh, free, 8.0)
    assert back == 0 and np.array_equal(moved[top], wanted[top])


def test_parts_with_other_columns_are_joined_by_their_names(tmp_path):
    (tmp_path/"a.p001_history.csv").write_text("time [t],energy.plastic [e]\n1.0,2.0\n")
    (tmp_path/"a.p002_history.csv").write_text("time [t],PAIR.gap [l],energy.plastic [e]\n"
                                               "2.0,0.5,3.0\n")
    join_histories(tmp_path, "a", ["a.p001", "a.p002"])
    head, *rows = (tmp_path/"a_history.csv").read_text().splitlines()
    assert head == "part [-],time [t],energy.plastic [e],PAIR.gap [l]"
    assert rows == ["1,1.0,2.0,nan", "2,2.0,5.0,0.5"]


def test_facets_keep_the_references_that_the_mesher_tells():
    facets = np.array([[3, 1, 2], [0, 1, 2], [4, 5, 6]])
    told, of = np.array([[2, 1, 0], [1, 2, 3]]), np.array([7, 9])
    assert references_of_facets(facets, told, of).tolist() == [9, 7, -1]


def test_around_a_spoilt_cell_pressed_and_free_faces_have_one_reference():
    """The line between them would keep the cell in every new mesh."""
    scene = deck("C3D4", np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]]),
                 [[0, 1, 2, 3], [1, 2, 3, 4]], LEVEL, -1.0, law=NORTON)
    body = read_body(DeckParts.of(scene), "B")
    pressed = np.arange(len(body.x)) < 3
    marks, of = references(body, body.x, pressed)
    assert {push for _, push in marks} == {True, False} and len(of) == len(body.facets)
    marks, _ = references(body, body.x*[1.0, 1.0, 0.02], pressed)
    assert not any(push for _, push in marks)
