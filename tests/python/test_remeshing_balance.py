"""Stresses on a new mesh are put in balance with what acts on the skin: no force is lost at rest."""
import numpy as np
import pytest
from nodal_twin import nodal_forces
from test_loads_over_meshes import pressed
from test_point_states import NORTON
from test_remeshing import block, run
from test_remeshing_folds import oval

import lopin
from lopin import mesh_make
from lopin.remesh import spatial
from lopin.remesh.balance import free_motions, made_even, pinned, rigid_motions, supports
from lopin.remesh.body import DeckParts, held_in, read_body
from lopin.remesh.loads import Samples
from lopin.remesh.part import NewMesh
from lopin.remesh.state import Snapshot


@pytest.mark.parametrize("word", ["CAX4", "CAX3", "CAX4R", "CPE4", "CPE3", "C3D4"])
def test_forces_of_nodes_are_those_that_the_core_balances(word, core):
    """Of a rough block: nothing acts inside, the top bears the force of its tool; by the formulas."""
    scene = lopin.Deck.parse(block(word, mu=0.2, travel=-1.0).text().replace(
        "*REMESH, ELSET=B, PERIOD=.2, STRAIN=10.\n", ""), name="whole")
    body = read_body(DeckParts.of(scene), "B")
    with lopin.open(scene) as job:
        for _ in range(3):
            job.advance()
        last = Snapshot.of(job, body)
        bears = job.result.history["DIE.rf2"][-1]
        saved = job.state
    force = last.forces_on(body)
    inside = np.setdiff1d(np.arange(len(last.x)), body.facets)
    assert np.abs(force[inside]).max(initial=0.0) < 1e-6*abs(bears)
    top = last.x[:, 1] > last.x[:, 1].max() - 1e-9
    assert force[top].sum(axis=0)[1] == pytest.approx(bears, rel=1e-6)
    if body.cells[0].shape[1] == 4 and body.ndim == 2:
        twin = nodal_forces(last.x, body, last.points.within(body.elements), 70000.0, 0.3)
        assert force == pytest.approx(twin, abs=1e-7*abs(bears))
    with lopin.open(scene, state=saved) as job:
        assert (Snapshot.of(job, body).forces == last.forces).all()


@pytest.mark.parametrize("word", ["CAX3", "CAX4"])
def test_friction_around_an_axis_is_in_balance_too(word, core, tmp_path):
    """Triangles there have three points and one state: read point by point they jumped by 11 %."""
    report = run(block(word, mu=0.2, travel=-1.0, law=NORTON), tmp_path)
    assert len(report.remeshes) == 4 and max(j["change"] for j in report.jumps()) < 1e-3


def test_a_wall_that_bends_keeps_its_force_at_a_new_mesh(core, tmp_path, monkeypatch):
    """A flat ring whose walls bend: 33 % of the force were lost with stresses out of balance."""
    ring = mesh_make.ring
    monkeypatch.setattr(mesh_make, "ring",
                        lambda inner, outer, cells, angles: ring(inner, outer, (3, 40), angles=angles))
    scene = oval(travel=1.0, increments=10, law=NORTON,
                 card="PERIOD=.6, STRAIN=10., SIZE=.3, SMALLEST=.3")
    report = run(scene, tmp_path)
    assert len(report.remeshes) == 1
    assert report.jumps()[0]["change"] < 0.01


def test_loads_do_no_work_on_motions_that_nothing_holds():
    """Supports leave some rigid motions; loads are made even on these, and as many pins hold them."""
    x = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]])
    held = np.zeros((4, 2), bool)
    assert len(free_motions(x, held, False)) == 3 and len(rigid_motions(x, True)) == 1
    held[[0, 3], 0] = True   # a line of symmetry leaves the way along it
    free = free_motions(x, held, False)
    assert len(free) == 1 and free[0, :, 1] == pytest.approx(np.full(4, free[0, 0, 1]))
    force = np.array([[0.0, 3.0], [0.0, 0.0], [0.0, -2.0], [0.0, 0.0]])
    even, share = made_even(force, free)
    assert even.sum(axis=0) == pytest.approx([0.0, 0.0], abs=1e-12) and even[1, 1] == 0.0
    assert share == pytest.approx(0.2)
    assert [axis for _, axis in pinned(free)] == [1]
    held[0, 1] = True
    assert len(free_motions(x, held, False)) == 0
    assert pinned(free_motions(x, held, False)) == []


def test_a_word_holds_what_its_degrees_of_freedom_do():
    """A support told by a word ended the run at its first new mesh by a ValueError."""
    held = []
    for way in ("AXIS, 1", "AXIS, XSYMM"):
        parts = DeckParts.of(lopin.Deck.parse(block("CAX4").text().replace("AXIS, 1", way),
                                              name="block"))
        body = read_body(parts, "B")
        mesh = NewMesh(body.x, body.cells, body.facets, body.tags, body.named)
        held.append(supports(parts, mesh, 1))
    assert held[0].any() and (held[0] == held[1]).all()


@pytest.mark.parametrize("step, held", [(1, ["A", "B"]), (2, ["C", "D"]), (3, ["C", "D", "E"])])
def test_what_a_step_has_let_go_of_holds_no_more(step, held):
    """OP=NEW takes away what was held before, not what other cards of its step hold."""
    steps = ["*BOUNDARY\nA, 1\n*STEP\n*STATIC\n*BOUNDARY\nB, 2\n*END STEP",
             "*STEP\n*STATIC\n*BOUNDARY, OP=NEW\nC, 1\n*BOUNDARY, OP=NEW\nD, YSYMM\n*END STEP",
             "*STEP\n*STATIC\n*BOUNDARY, OP=MOD\nE, 2\n*END STEP"]
    parts = DeckParts.of(lopin.Deck.parse("*NODE\n1, 0., 0.\n" + "\n".join(steps) + "\n", name="d"))
    assert [name for name, _ in held_in(parts, step)] == held


def test_a_report_says_why_stresses_are_not_in_balance(core, tmp_path):
    """A pressure acts on the side, beside the contact."""
    report = run(pressed("CAX4", travel=-0.5), tmp_path)
    said = [r.line() for r in report.remeshes]
    assert said and all("not put in balance: springs or loads" in line for line in said)
    plain = run(block("CAX4", mu=0.2, travel=-0.4, card="PERIOD=.5, STRAIN=10."), tmp_path/"plain")
    assert not any("balance" in r.line() for r in plain.remeshes)


def test_samples_carry_linear_tractions_along_edges_and_round_an_axis():
    """Resultant of a traction that grows along an edge, plane and all round an axis."""
    x, facets = np.array([[1.0, 0.0], [3.0, 0.0]]), np.array([[0, 1]])
    traction = np.array([[0.0, 1.0], [0.0, 2.0]])
    for round_axis, total in ((False, 3.0), (True, 2.0*np.pi*(19.0/3.0))):
        skin = Samples.of(x, facets, round_axis)
        at = np.einsum("sk,fkd->fsd", skin.shape, traction[facets])
        assert skin.forces(at).sum() == pytest.approx(total, rel=1e-12)
        assert not skin.forces(-at).any()   # no face pulls


def test_around_a_spoilt_cell_pressed_and_free_faces_have_one_reference():
    """The line between them would keep the cell in every new mesh."""
    x = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]])
    cells = np.array([[0, 1, 2, 3], [1, 2, 3, 4]])
    cells[1] = [1, 3, 2, 4] if np.linalg.det(x[cells[1, 1:]] - x[cells[1, 0]]) < 0 else cells[1]
    facets, _ = spatial.boundary_facets([cells], 3)
    skin = frozenset({("S", "SKIN")})

    class OneBody:
        pass
    body = OneBody()
    body.cells, body.facets, body.tags = [cells], facets, [skin]*len(facets)
    pressed = np.array([True, True, True, False, False])
    marks, of = spatial.references(body, x, pressed)
    assert sorted(marks) == [(skin, False), (skin, True)] and len(set(of.tolist())) == 2
    flat = x*[1.0, 1.0, 0.02]
    marks, of = spatial.references(body, flat, pressed)
    assert marks == [(skin, False)] and set(of.tolist()) == {0}
