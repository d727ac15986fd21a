"""What supports, sections and unloaded bodies do to a new mesh: held faces keep the forces along
them, axes of *TRANSFORM are read, energies have the thickness and are judged beside what matters."""
from types import SimpleNamespace

import numpy as np
import pytest
from test_point_states import grid
from test_remeshing import block, history, run

import lopin
from lopin.remesh.balance import depth_of
from lopin.remesh.body import DeckParts, inclined, read_body, supports
from lopin.remesh.loads import fading
from lopin.remesh.part import NewMesh, places_of_deck
from lopin.remesh.refusals import refuse_what_stays_behind
from lopin.remesh.remake import integrals
from lopin.remesh.report import Report
from lopin.remesh.state import Snapshot

STEP = "*STEP, NLGEOM"


def text_of(word, model="", thickness="", steps="", **options):
    """A block with more cards: before its step, and further steps; its top is set TOP."""
    x, _ = grid(word)
    top = "\n".join(str(k + 1) for k in np.flatnonzero(x[:, 1] > 5.0 - 1e-9))
    text = block(word, **options).text().replace("MATERIAL=M\n", f"MATERIAL=M\n{thickness}", 1)
    return text.replace(STEP, f"*NSET, NSET=TOP\n{top}\n{model}{STEP}", 1) + steps


def parts_of(text):
    parts = DeckParts.of(lopin.Deck.parse(text, name="block"))
    return parts, read_body(parts, "B")


def test_a_face_that_a_tool_presses_and_a_support_holds_keeps_its_force(core, tmp_path):
    """A sticking tool: all of its force and 51 to 95 % of the elastic energy were lost; and of a
    sheet of 7, energies after a new mesh were those of 1."""
    text = text_of("CPE4", "*BOUNDARY\nTOP, 1\n", "7.\n", travel=-.5, card="PERIOD=.7, STRAIN=10.")
    report = run(lopin.Deck.parse(text, name="block"), tmp_path)
    assert len(report.remeshes) == 1 and not report.remeshes[0].unbalanced
    assert report.jumps()[0]["change"] < 0.05
    assert abs(report.remeshes[0].energy_change) < 0.05
    assert abs(report.remeshes[0].plastic_change) < 0.01


@pytest.mark.parametrize("word, thickness, depth", [
    ("CPE4", "7.\n", 7.0), ("CPE4", "", 1.0), ("CAX4", "", 2.0*np.pi), ("C3D4", "", 1.0)])
def test_volumes_have_the_thickness_of_the_section(word, thickness, depth):
    assert depth_of(*parts_of(text_of(word, thickness=thickness))) == depth


def test_nodes_of_the_axis_are_on_it_in_a_deck():
    """Rounding to the wrong side of the axis ended runs (E0207, r = -8e-54)."""
    _, body = parts_of(text_of("CAX4"))
    axis = body.x[:, 0] == 0.0
    x = body.x - np.where(axis, 8e-54, 0.0)[:, None]*np.array([1.0, 0.0])
    mesh = NewMesh(x, body.cells, body.facets, body.tags, body.named)
    assert (places_of_deck(body, mesh) == body.x).all() and (x[axis, 0] < 0.0).all()


@pytest.mark.parametrize("row, refused", [
    ("*BOUNDARY\nTOP, 1", True), ("*BOUNDARY\nTOP, 1, 1, 0.", True), ("*BOUNDARY\n25, 1", True),
    ("*BOUNDARY, FIXED\nTOP, 1", False), ("*BOUNDARY\nFLOOR, 2", False),
    ("*BOUNDARY, TYPE=VELOCITY\nTOP, 1, 1, 0.", False), ("*BOUNDARY, OP=NEW\nFLOOR, 2", False)])
def test_a_later_step_does_not_bring_nodes_back_to_where_they_stood(row, refused):
    """The new mesh knows no such places; nodes that were held all along stand there."""
    found = parts_of(text_of("CPE4", steps=f"{STEP}\n*STATIC\n.1, 1.\n{row}\n*END STEP\n"))
    if not refused:
        refuse_what_stays_behind(*found)
        return
    with pytest.raises(lopin.LopinError, match="step 2 brings") as caught:
        refuse_what_stays_behind(*found)
    assert "FIXED" in str(caught.value)


@pytest.mark.parametrize("axes, dof, leans", [
    ("0., 1., 0., -1., 0., 0.", 2, False), ("0.8, 0.6, 0., -0.6, 0.8, 0.", None, True)])
def test_supports_hold_along_the_axes_of_transform(axes, dof, leans):
    """Read as global ones they lost 22 to 35 % of the force; what leans is not put in balance."""
    parts, body = parts_of(text_of("CPE4", f"*TRANSFORM, NSET=TOP\n{axes}\n*BOUNDARY\nTOP, 1\n"))
    mesh = NewMesh(body.x, body.cells, body.facets, body.tags, body.named)
    top = (body.x[:, 1] > 4.9) & (body.x[:, 0] > 0.1)
    held = supports(parts, mesh, 1)[top]
    assert inclined(parts, mesh, 1) is leans
    assert (held == (np.arange(1, 3) == dof)).all()
    assert supports(parts, mesh, 1)[body.x[:, 1] == 0.0, 1].all()


def test_elastic_energy_is_judged_beside_what_there_was(tmp_path):
    """What an unloaded body has left changes by half of itself: nothing, by the largest so far."""
    for part, strain in (("p1", [5.0, 100.0]), ("p2", [60.0, 0.1])):
        (tmp_path/f"{part}_history.csv").write_text(
            "time [s],energy.strain [J],energy.plastic [J]\n"
            + "".join(f"1.,{v},1e3\n" for v in strain))
    shares = Report("p", tmp_path, ["p1", "p2"]).shares_of_energy()
    assert shares == pytest.approx({1: 1.0, 2: 1e-3})
    (tmp_path/"p1_history.csv").write_text(
        "time [s],energy.strain [J],energy.plastic [J]\n1.,1e-9,1e3\n")
    assert Report("p", tmp_path, ["p1"]).shares_of_energy()[1] < 1e-6   # rounding of rigid metal


def test_deviators_that_are_rounding_are_beside_all_elastic_energy():
    """Rigid metal has pressure alone: its deviators, which are none, changed by 25 %."""
    points = SimpleNamespace(volume=np.full(2, 14.0), plastic=np.ones(2), dilatation=np.full(2, 0.1),
                             strain=np.full((2, 6), 1e-12))
    state = np.zeros((2, 1, 40))
    assert abs(integrals(points, [state], [np.full((2, 1), 2.0)], 7.0, 0.3)[1]) < 1e-12


def test_what_a_step_lets_go_of_fades_over_new_meshes(core, tmp_path):
    """A pair that is removed: such runs ended (E0621, loads act on nodes of the body)."""
    text = text_of("CAX4", travel=-.5, card="PERIOD=1.4, STRAIN=10.", steps=(
        f"{STEP}\n*STATIC\n.1, 1., , .1\n*MODEL CHANGE, TYPE=CONTACT PAIR, REMOVE\nSKIN, DIE\n"
        "*END STEP\n")).replace("0.05, 1.0", "0.2, 1.0")
    report = run(lopin.Deck.parse(text, name="block"), tmp_path)
    found = history(tmp_path, "block")
    time, energy = found["time"], found["energy.strain"]
    assert [round(r.time, 6) for r in report.remeshes] == [1.4] and not report.remeshes[0].unbalanced
    full = energy[np.argmin(np.abs(time - 1.0))]
    for at in (1.4, 1.5, 1.7, 2.0):   # the force fades, and the energy with its square
        share = energy[np.argmin(np.abs(time - at))]/full
        assert share == pytest.approx((2.0 - at)**2, abs=0.01)
    assert np.ptp(found["energy.plastic"][time > 0.999]) < 1e-6*found["energy.plastic"][-1]


@pytest.mark.parametrize("word", ["CPE4", "C3D4"])
def test_forces_that_fade_keep_their_resultant_whatever_their_way(word):
    """Those that press go as tractions; those of a freed support along a face or off it, too, to
    the nodes that are there."""
    _, body = parts_of(text_of(word))
    mesh = NewMesh(body.x.copy(), body.cells, body.facets, body.tags, body.named)
    for axis, sign in ((0, 1.0), (1, 1.0), (1, -1.0)):
        force = np.zeros_like(body.x)
        force[body.x[:, 1] > 4.9, axis] = sign
        last = SimpleNamespace(x=body.x, fading_on=lambda body, force=force: force)
        found = fading(body, mesh, last)
        assert found.sum(axis=0) == pytest.approx(force.sum(axis=0), abs=1e-12)
        assert not found[body.x[:, 1] < 4.9].any()
    motion = np.array([[int(body.labels[0]), 2, 0.1, 0.0, 7.0]])
    assert Snapshot.fading_on(SimpleNamespace(motion=motion), body)[0, 1] == 7.0
