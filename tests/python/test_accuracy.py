"""The accuracy that a deck asks for: estimates beside true errors, refusals, the command."""
import functools
import json
import os
import pathlib
import re
import subprocess
import sys

import numpy as np
import pytest
from coarse_scenes import coarse

import lopin
from lopin.__main__ import main
from lopin.accuracy import Quantity, reach
from lopin.accuracy.quantity import swing
from lopin.accuracy.reach import Level, Reached, _Search
from lopin.accuracy.increments import (Settled, depends_on_path, left_by_increments,
                                       with_smaller)
from lopin.deck import Deck
from lopin.errors import ModelError, NotConvergedError, UsageError
from lopin.refine import refined

DECKS = pathlib.Path(__file__).resolve().parents[2]/"decks"
#: Decks whose meshes are coarse here.
COARSE = ("hertz_sphere", "cylinder_on_plane")
#: Decks, what is asked of them, and the error asked for. The command is asked for the force of
#: hertz_sphere.
SCENES = [("hertz_sphere", Quantity("PRESSURE"), 1e-2),
          ("cylinder_on_plane", Quantity("PEAK PRESSURE"), 1e-3),
          ("cylinder_on_plane", Quantity("PRESSURE"), 1e-2), ("signorini", Quantity("FORCE"), 0.02),
          ("flat_punch", Quantity("FORCE"), 1e-2),
          ("flat_punch", Quantity("DISPLACEMENT", "LOWER.TOP"), 5e-3)]


@functools.cache
def halved(name, small, times):
    """A deck, or its coarse twin, all of whose cells are halved so many times."""
    if times:
        return refined(halved(name, small, times - 1)).deck
    return coarse(name) if small else Deck.read(DECKS/f"{name}.inp")


@functools.cache
def solved_halved(name, small, times):
    return lopin.run(halved(name, small, times))


@pytest.mark.parametrize("name, quantity, target", SCENES)
def test_the_true_error_is_what_was_asked(name, quantity, target):
    """Beside a mesh of half the size of the finest."""
    small = name in COARSE or (name, quantity.kind) == ("flat_punch", "FORCE")
    deck = halved(name, small, 0)
    if quantity.set:
        quantity = Quantity(quantity.kind, first_set(deck))
    found = reach(deck, quantity, target)
    quantity = found.quantity   # a displacement is that of the deck's own nodes
    assert found.met and found.error <= target
    # Seconds of runs that take some; of the quickest, equations.
    work = [v.equations for v in found.levels]
    assert sum(work) < 3.0*work[-1] and (found.cost < 3.0 or found.levels[-1].seconds < 0.2)
    # Where cells were halved in part: beside all cells of the deck, three times.
    halvings = found.levels[-1].mesh + 1
    which = name, small, max(3, halvings) if found.by_dual else halvings
    finest, result = halved(*which), solved_halved(*which)
    value = quantity.value(result, finest)
    apart = quantity.difference(result, found.result, (value, found.value))
    # Half the size takes away at least half of the error.
    assert apart <= target*abs(value)
    assert found.increments == 0.0 and "increments 0 %" in found.text()
    assert ("taken as straight" in found.text()) == (found.filled_in > 0)
    assert (found.filled_in > 0) == (name != "cylinder_on_plane")


def test_a_displacement_is_that_of_the_nodes_of_the_deck():
    """Where cells are halved in part, more nodes of a set stand there: their mean is another
    number (12 % off here, at 0.6 % told, before)."""
    deck = Deck.read(DECKS/"handbook/wavy.inp")
    found = reach(deck, Quantity("DISPLACEMENT", "BODY.LEFT", 2), 0.01)
    finest = refined(refined(refined(deck).deck).deck).deck
    value = found.quantity.value(lopin.run(finest), finest)
    assert found.met and abs(found.value/value - 1.0) < 0.01


def first_set(deck):
    """A node set of the slave side."""
    names = [str(b.parameters.get("NSET", "")) for b in lopin.model_read_mesh.expanded(deck)
             if b.keyword == "NSET"]
    return next(n for n in names if n)


def test_a_quantity_without_limit_is_refused():
    """The pressure at the edge of a flat punch grows with every mesh."""
    with pytest.raises(NotConvergedError, match="E0622.*has no limit") as caught:
        reach(coarse("flat_punch"), Quantity("PEAK PRESSURE"), 0.01)
    assert not caught.value.reached.met and len(caught.value.reached.levels) == 4


def test_a_limit_says_what_would_meet_it():
    with pytest.raises(NotConvergedError, match="elements; about [0-9]+ would meet it") as caught:
        reach(DECKS/"signorini.inp", Quantity("PRESSURE"), 1e-3, most_elements=5000)
    levels = caught.value.reached.levels
    assert [v.elements for v in levels] == [256, 1024, 4096]


def test_increments_are_halved_where_the_way_matters():
    found = reach(DECKS/"upsetting.inp", Quantity("FORCE"), 0.02)
    # 0.4 of what is asked on the first mesh, more on finer ones.
    assert found.met and 0.0 < found.increments <= 0.6*0.02
    halved = [v for v in found.levels if v.mesh == 0]
    assert [v.increments for v in halved] == [1.0, 0.5, 0.25][:len(halved)] and len(halved) > 2
    # Finer meshes have the longest of these that leaves room.
    assert len({v.increments for v in found.levels if v.mesh}) == 1
    assert found.levels[-1].increments in [v.increments for v in halved]


def test_who_depends_on_the_way():
    read = {name: depends_on_path(Deck.read(DECKS/f"{name}.inp"))
            for name in ("hertz_sphere", "flat_punch", "upsetting", "cattaneo", "rough_punch")}
    assert read == {"hertz_sphere": False, "flat_punch": False, "upsetting": True,
                    "cattaneo": True, "rough_punch": True}


def test_what_increments_leave_by_the_order_of_their_fall():
    assert left_by_increments([8.0, 4.0, 2.0]) == [16.0, 8.0, 4.0, 2.0]
    assert left_by_increments([16.0, 4.0])[-1] == 4.0   # faster than by half is a chance
    assert left_by_increments([64.0, 4.0], 4.0)[-1] == pytest.approx(4.0/3.0)   # at the least
    assert left_by_increments([4.0, -3.0])[-1] == 3.0                      # to and fro
    assert left_by_increments([1.0, 3.0])[-1] == 3.0                       # none yet


def test_smaller_increments_of_fixed_ones():
    class Run:
        summary = {"steps": [{"increments": 4}, {"increments": 10}]}

    deck = Deck.parse("*STEP, INC=20\n*STATIC, DIRECT\n0.25, 1.\n*END STEP\n*STEP\n*STATIC\n"
                      "0.2, 2., 1e-5, 0.4\n*END STEP\n")
    new = with_smaller(deck, Run, 0.5)
    assert new.all("STATIC")[0].data[0] == [0.125, 1.0]
    assert new.all("STATIC")[1].data[0] == [0.1, 2.0, 1e-5, 0.1]
    assert new["STEP"].parameters["INC"] == 41


@pytest.mark.parametrize("words, says", [
    (("SPEED",), "not known"), (("DISPLACEMENT",), "needs SET"),
    (("SPRINGBACK",), "needs SET")])
def test_what_cannot_be_asked(words, says):
    with pytest.raises(UsageError, match=says):
        Quantity(*words)


@pytest.mark.parametrize("quantity, says", [
    (Quantity("DISPLACEMENT", "NOWHERE"), "no such node set"),
    (Quantity("FORCE", "", 3), "COMPONENT=3"), (Quantity("SPRINGBACK", "1"), "last of several")])
def test_what_a_deck_does_not_have(quantity, says):
    with pytest.raises((ModelError, UsageError), match=says):
        reach(DECKS/"hertz_sphere.inp", quantity, 0.01)


def asking(folder, words):
    path = folder/"ask.inp"
    path.write_text(coarse("hertz_sphere").text().replace("*STEP", f"*LOPIN, {words}\n*STEP", 1))
    return path


def command(path, *words):
    return subprocess.run([sys.executable, "-m", "lopin", "run", path.name, *words],
                          cwd=path.parent, capture_output=True, text=True, timeout=120,
                          env={**os.environ, "OPENBLAS_NUM_THREADS": "1"})


def test_the_command_refines_until_it_is_met(tmp_path):
    path = asking(tmp_path, "QUANTITY=FORCE, TARGET ERROR=0.001")
    done = command(path)
    assert done.returncode == 0, done.stderr
    value, apart = map(float, re.search(r"force: ([\d.]+) \+- ([\d.]+)", done.stdout).groups())
    # All cells halved up to five times, and the order of what is left: 588.7463.
    assert abs(value - 588.7463) < apart < 1e-3*value and "(dual problem)" in done.stdout
    told = json.loads((tmp_path/"out/ask/ask.accuracy.json").read_text())
    assert told["met"] and told["error"] < 0.001 and len(told["runs"]) == 4
    assert "results: out/ask/mesh3" in done.stdout
    assert (tmp_path/"out/ask/mesh3/ask.pvd").is_file()
    # Each run of it is a deck that asks for nothing more.
    assert "QUANTITY" not in (tmp_path/"out/ask/mesh3/ask.inp").read_text()


def test_the_command_prints_what_it_writes(tmp_path):
    printed = json.loads(command(asking(tmp_path, "QUANTITY=FORCE, TARGET ERROR=0.05"), "--json"
                                 ).stdout)
    assert printed == json.loads((tmp_path/"out/ask/ask.accuracy.json").read_text())
    assert printed["met"] and printed["value"] > 0.0


def test_the_command_says_what_is_not_met(tmp_path):
    done = command(asking(tmp_path, "QUANTITY=FORCE, TARGET ERROR=2e-5"), "--most-elements", "2000")
    assert done.returncode == 3 and "error: E0622" in done.stderr
    assert "not met" in done.stdout and re.search("results: out/ask/mesh[1-9]", done.stdout)


def test_no_run_is_begun_that_would_take_too_long():
    with pytest.raises(NotConvergedError, match="and would take about .* s, above 0.001"):
        reach(DECKS/"cylinder_on_plane.inp", Quantity("PRESSURE"), 1e-4, most_seconds=1e-3)


def test_the_executable_alone_warns(executable, tmp_path):
    path = asking(tmp_path, "QUANTITY=FORCE, TARGET ERROR=0.001")
    done = subprocess.run([executable, "run", path.name], cwd=tmp_path, capture_output=True,
                          text=True, timeout=60)
    assert done.returncode == 0 and "warning[W0344]" in done.stdout + done.stderr


def test_values_do_not_change_with_units(tmp_path):
    """The table of relative errors is that of the deck in other units."""
    found = reach(coarse("cylinder_on_plane"), Quantity("PRESSURE"), 0.02)
    stiff = coarse("cylinder_on_plane")
    for block in stiff.blocks:
        if block.keyword == "ELASTIC":
            block.lines = [type(block.data[0])([1e3*block.data[0][0], *block.data[0][1:]])]
        if block.keyword in ("DLOAD", "DSLOAD", "CLOAD"):
            block.lines = [type(r)([*r[:2], 1e3*r[2], *r[3:]]) for r in block.data]
    other = reach(stiff, Quantity("PRESSURE"), 0.02)
    assert np.isclose(other.value, 1e3*found.value, rtol=1e-6)
    assert np.isclose(other.error, found.error, rtol=1e-4)


def test_a_number_that_is_nothing_has_no_relative_error():
    """Contact forces of a sphere along the axis direction 1 of a deck that has none across."""
    with pytest.raises(NotConvergedError, match="E0622.*is 0: it has no relative error"):
        reach(DECKS/"cylinder_on_plane.inp", Quantity("FORCE", "", 1), 0.01)


@pytest.mark.parametrize("words, says", [
    ("QUANTITY=SPEED", "SPEED"), ("QUANTITY=FORCE, TARGET ERROR=abc", "abc"),
    ("QUANTITY=FORCE, TARGET ERROR=2.", "not between 0 and 1"),
    ("QUANTITY=FORCE, COMPONENT=x", "x")])
def test_what_cannot_be_read_is_named_with_its_place(tmp_path, monkeypatch, capfd, words, says):
    asking(tmp_path, words)
    monkeypatch.chdir(tmp_path)
    said = main(["run", "ask.inp"]), capfd.readouterr().err
    assert said[0] == 1 and says in said[1] and "ask.inp:" in said[1]
    assert not (tmp_path/"out").exists()


def test_changes_to_and_fro_have_no_order():
    """+27, +14, -3.9 of 872, as under a punch whose corner slips: an order of 1.8 would promise
    0.2 %, where 2.1 % are wrong."""
    found = Reached(Quantity("FORCE"), 0.01, value=-872.0)
    search = _Search(Deck([]), found.quantity, 0.01, None, None)
    search.found = found
    values = [-834.6, -861.9, -876.0, -872.0]
    for mesh, value in enumerate(values):
        apart = abs(value - values[mesh - 1]) if mesh else float("nan")
        sign = found.quantity.change(apart, value, values[mesh - 1])
        found.levels.append(Level(mesh, 1.0, 4**mesh, 0, value, apart, sign, 0.0, "PASS"))
    search._estimate(False)
    assert found.mesh == pytest.approx(14.1/872.0, rel=1e-3) and np.isnan(found.order)
    found.levels.pop()
    found.value = -876.0
    search._estimate(False)
    assert found.order == pytest.approx(np.log2(27.3/14.1))


def asked_by(values, settled, target=0.01, kind="FORCE"):
    """A search that has these values on meshes whose cells were halved."""
    found = Reached(Quantity(kind), target, value=values[-1])
    search = _Search(Deck([]), found.quantity, target, None, None)
    search.found, search.settled = found, settled
    for mesh, value in enumerate(values):
        change = value - values[mesh - 1] if mesh else float("nan")
        found.levels.append(Level(mesh, 1.0, 4**mesh, 0, value, abs(change), change, 0.0, "PASS"))
    search._estimate(False)
    return search


def test_increments_leave_more_on_a_finer_mesh():
    """A ring, by halves of increments on four meshes: 330, 450 and 620 N of 240 600 are left on
    meshes 0, 1 and 2 in increments of the deck, and 330 was said of all."""
    settled = Settled.of([1.0, 0.5, 0.25], [-196.0, -68.0], 0, True)
    assert settled.most == pytest.approx(332.0, abs=2.0) and settled.sign == -1.0
    search = asked_by([-240677.0, -240332.0, -240067.0], settled)
    assert 240600.0*search.found.increments == pytest.approx(2.0*settled.most, rel=3e-3)
    # What increments of an eighth leave, which were not tried, is half of those of a quarter.
    assert settled.at(0.125) == 0.5*settled.at(0.25)
    # Too much for the next mesh: smaller ones are taken there.
    search.found.target = 0.002
    assert search._must_be_shorter() and search.factor == 0.25
    assert not search._must_be_shorter()


@pytest.mark.parametrize("changes, less", [([-196.0, -68.0], True), ([-196.0], True),
                                           ([-196.0, 68.0], False), ([196.0, 68.0], False)])
def test_mesh_and_increments_that_err_in_opposite_directions(changes, less):
    """Of two errors of opposite sign the larger counts, less the least that the other may be;
    nothing is taken off where either has no sign."""
    settled = Settled.of([1.0, 0.5, 0.25][:len(changes) + 1], changes, 0, True)
    found = asked_by([-240677.0, -240332.0], settled).found
    apart = found.mesh + found.increments
    assert found.error == pytest.approx(apart - found.against)
    assert (found.against > 0.0) == less and ("opposite directions" in found.text()) == less
    # Never below what either leaves alone, less the least of the other.
    assert found.error >= max(found.mesh - 0.5*found.increments, found.increments) - 1e-12
    assert asked_by([-240677.0, -240332.0], Settled.of([1.0, 0.5], [196.0], 0, False)
                    ).found.against == 0.0
    # A mesh that goes to and fro may be off either way.
    assert asked_by([-240600.0, -240677.0, -240332.0], settled).found.against == 0.0


def test_where_a_rippling_force_ends_is_chance():
    """A wire that is drawn: nodes leave the die one by one. 1.2 % were stated of 3 321 N, where the
    next two meshes have 3 357 and 3 412."""
    ends = [-3318.0, -3322.0, -3379.0, -3281.0, -3426.0, -3321.0, -3413.0]
    assert swing(ends) == pytest.approx(0.5*np.mean([98.0, 145.0, 105.0]), rel=0.2)
    rising = np.linspace(1.0, 2.0, 12)
    assert swing(list(rising)) == 0.0 and swing(list(rising + 0.2*(rising > 1.5))) == 0.0
    assert swing([]) == 0.0 and swing([1.0]) == 0.0
    # About the peak of a V-bend, in increments that find it by chance.
    assert swing([16.32, 16.35, 16.26, 16.20, 16.40, 16.22, 15.96, 15.68, 15.95, 15.62]) > 0.1
    found = Reached(Quantity("FORCE"), 0.05, value=3321.0, mesh=0.01, increments=0.005, ripple=0.02)
    assert found.error == pytest.approx(0.035)


@pytest.mark.parametrize("quantity", [Quantity("FORCE", "", 2), Quantity("PEAK FORCE")])
def test_a_force_that_rises_has_no_ripple(quantity, solve):
    deck = Deck.read(DECKS/"upsetting.inp")
    assert quantity.ripple(solve(deck), deck) == 0.0


def test_facets_that_do_not_match_are_in_the_estimate_of_a_pressure():
    """W0333 is no matter of the mesh; a force does not mind."""
    from lopin.atlas.scenes import flat

    deck = Deck.parse(flat(9, 15, 1.0).text(), name="flat")
    with pytest.raises(NotConvergedError, match="SURFACE TO SURFACE") as problem:
        reach(deck, Quantity("PEAK PRESSURE"), 0.01)
    found = problem.value.reached
    assert len(found.levels) == 1 and found.uneven > 0.02
    assert any(line.startswith("W0333") for line in found.warnings) and "warning: W0333" in \
        found.text()
    assert reach(deck, Quantity("FORCE"), 0.01).met
    mortar = Deck.parse(flat(9, 15, 1.0, mortar=True).text(), name="flat")
    assert reach(mortar, Quantity("PEAK PRESSURE"), 0.01).met


@pytest.mark.parametrize("law, met", [("PENALTY\n50.,", False),
                                      ("PRESSURE-OVERCLOSURE=TABULAR\n0., 0.\n50., 1.", True)])
def test_what_the_stiffness_of_contact_leaves_no_mesh_mends(law, met):
    """A soft penalty is refused after one mesh; a law of the surface is no error."""
    from lopin.atlas.scenes import flat

    text = flat(10, 10, 1.0).text()
    begin = text.index("*SURFACE BEHAVIOR")
    text = text[:begin] + f"*SURFACE BEHAVIOR, {law}\n" + text[text.index("*CONTACT PAIR"):]
    deck = Deck.parse(text, name="soft")
    if met:
        assert reach(deck, Quantity("FORCE"), 0.01).met
        return
    with pytest.raises(NotConvergedError, match="whatever the mesh") as problem:
        reach(deck, Quantity("FORCE"), 0.01)
    assert len(problem.value.reached.levels) == 1


def test_a_direction_that_has_no_share_has_no_say_in_the_dual_problem():
    """A plane without friction that moves along itself moves nothing: the length of the force on it
    is known as cheaply as its component."""
    both = [reach(DECKS/"signorini.inp", Quantity("FORCE", "", k), 0.02) for k in (0, 2)]
    assert all(found.by_dual for found in both)
    assert both[0].error == pytest.approx(both[1].error) and \
        both[0].value == pytest.approx(abs(both[1].value))
    assert len(both[0].levels) == len(both[1].levels)
