"""Runs by the increment: open, advance, state out, state in, close; Ctrl-C; memory."""
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import lopin
from lopin import mesh_make, profile
from test_checkpoint import SCENES, billet, wall_that_stays

#: Increments after which the state is taken out. Cup, rings, friction loop, punch; heat, mortar that
#: slides; and scenes of test_checkpoint.py.
DECKS = {"upsetting": 4, "cattaneo": 3, "ring_compression": 3, "rotating_rings": 2, "rough_punch": 2,
         "cup": 3, "hot_upsetting": 3, "ironing": 5, "self-contact": 15, "tied by mortar": 3,
         "following pressure": 12, "rows that come late": 5, "newton": 4, "changed to finite": 8,
         "axes and backstress": 4, "finite augmented": 3}


@pytest.fixture
def press(tmp_path, core):
    """A billet that slips on its tool, in ten increments and two steps."""
    path = tmp_path/"press.inp"
    path.write_text(billet(steps=(0.1, 0.1)))
    return path


def same(one, other, index=-1):
    """Fields and contact of one increment of two results, bit for bit."""
    compared = 0
    for name in one.names:
        assert np.array_equal(one.at(index)[name], other.at(index)[name]), name
        compared += 1
    for pair in one.pairs:
        a, b = one.contact(pair).at(index).fields, other.contact(pair).at(index).fields
        assert set(a) == set(b)
        for word, values in a.items():
            assert np.array_equal(values, b[word]), (pair, word)
            compared += 1
    assert compared > 5


def test_increments_one_by_one_are_the_run(press):
    whole = lopin.run(press)
    with lopin.open(press) as job:
        assert job.is_open and job.state == b""
        for k, frame in enumerate(job):
            assert np.array_equal(frame["displacement"], whole.at(k)["displacement"])
        assert not job.is_open
    assert k + 1 == len(whole.times) and job.result.summary["status"] == "finished"
    same(whole, job.result)
    with pytest.raises(lopin.UsageError, match="ended"):
        job.advance()


def test_a_caller_stops_a_run(press, tmp_path):
    with lopin.open(press, tmp_path/"out") as job:
        for frame in job:
            if job.result.times[-1] > 0.45:
                break
    stopped = job.result
    assert len(stopped.times) == 4 and stopped.summary["status"] == "stopped"
    assert (tmp_path/"out"/"press.json").read_text().count('"stopped"') == 1
    assert (tmp_path/"out"/"press.rst").exists(), "it may be resumed"
    assert lopin.run(press, tmp_path/"out", resume=True).summary["status"] == "finished"
    lopin.run(press, tmp_path/"whole")
    for suffix in (".sta", ".cvg", "_history.csv"):
        name = f"press{suffix}"
        assert (tmp_path/"out"/name).read_bytes() == (tmp_path/"whole"/name).read_bytes(), name


def test_a_model_is_stopped_on_a_condition(core):
    """Press until the tool carries enough; what was reached is the result."""
    model = lopin.Model("press", mesh_make.block((4.0, 2.0), (4, 2)))
    model.section("ALL", lopin.Elastic(1000.0, 0.3))
    die = model.rigid_tool("DIE", profile.plane(2.0, 9.0), ref=(0.0, 2.0))
    model.contact("TOP", die)
    model.fix("BOTTOM", 2)
    model.fix("LEFT", 1)
    model.step(20, nlgeom=True).move(die, y=-0.4)
    with lopin.open(model) as job:
        for frame in job:
            if -job.result.history["DIE.rf2"][-1] > 300.0:
                break
    force = -job.result.history["DIE.rf2"]
    assert job.result.summary["status"] == "stopped"
    assert force[-1] > 300.0 >= force[-2] and 2 < len(force) < 20


@pytest.mark.parametrize("name", DECKS)
def test_a_state_goes_on_in_a_new_model_to_the_same_bits(name, root, core, tmp_path):
    """Taken out after some increments, put into a model that is built anew from the same deck; three
    more, or as many as there are, are those of a run that was left alone."""
    deck, taken = root/"decks"/f"{name}.inp", DECKS[name]
    if name in SCENES:
        deck = tmp_path/"scene.inp"
        deck.write_text(SCENES[name]())
    with lopin.open(deck) as alone, lopin.open(deck) as job:
        for _ in range(taken):
            alone.advance(), job.advance()
        state = job.state
        assert len(job.result.times) == taken and state
        with lopin.open(deck, state=state) as rest:
            for k in range(3):
                frames = alone.advance(), rest.advance()
                assert (frames[0] is None) == (frames[1] is None)
                if frames[0] is None:
                    break
            assert len(rest.result.times) + taken == len(alone.result.times) > taken
            same(alone.result, rest.result)


#: Cup and ring on the present shape, friction loops on both paths, turning rings, exact springs.
FORGETTING = {"cup": 3, "ring_compression": 4, "crushed_ring": 4, "cattaneo": 6,
              "rotating_rings": 3, "two_springs": 4}


def forgetting(deck, increments, forget=True):
    with lopin.open(deck) as job:
        for k, frame in enumerate(job, start=1):
            if forget:
                job.forget_workspace()
            if k == increments:
                break
    return job.result


@pytest.mark.parametrize("name", FORGETTING)
def test_the_workspace_can_be_thrown_away_between_increments(name, root, core):
    deck, n = root/"decks"/f"{name}.inp", FORGETTING[name]
    alone, forgot = forgetting(deck, n, forget=False), forgetting(deck, n)
    assert len(alone.times) == len(forgot.times) > 0
    assert alone.summary["checksum"] == forgot.summary["checksum"]
    for k in range(len(alone.times)):
        same(alone, forgot, k)


def test_the_workspace_can_be_thrown_away_across_steps(press):
    """Contact that slips, is taken away and comes back."""
    same(lopin.run(press), forgetting(press, None))


def test_what_a_step_lets_go_is_part_of_the_state(tmp_path, core):
    """Forces of a pair that is taken away, beside one that stays: not found again after a resume."""
    path = tmp_path/"wall.inp"
    path.write_text(wall_that_stays())
    alone, forgot = lopin.run(path), forgetting(path, None)
    assert np.abs(alone.contact("FLANK-WALL").at(-1)["CPRESS"]).max() > 0.0
    for k in range(len(alone.times)):
        same(alone, forgot, k)


def test_a_state_across_the_end_of_a_step(press):
    whole = lopin.run(press)
    for n in range(1, len(whole.times)):
        with lopin.open(press) as job:
            for _, frame in zip(range(n), job):
                pass
            state = job.state
        with lopin.open(press, state=state) as rest:
            assert rest.advance()
            same(whole.at(n).result, _Shifted(rest.result, n), n)


class _Shifted:
    """A result whose first increment is the n-th."""

    def __init__(self, result, n):
        self.result, self.n, self.names = result, n, result.names

    def at(self, index):
        return self.result.at(index - self.n)

    def contact(self, pair):
        history, n = self.result.contact(pair), self.n

        class Pair:
            def at(self, index):
                return history.at(index - n)
        return Pair()


def test_what_is_no_state_is_refused(press, tmp_path):
    with lopin.open(press) as job:
        job.advance()
        state = job.state
    other = lopin.Deck.parse(press.read_text().replace("0.3\n", "0.31\n"), "press")
    with pytest.raises(lopin.ResourceError, match="another deck"):
        lopin.open(other, state=state)
    for wrong in (b"nonsense", state[:-40], state + b"\0\0\0\0"):
        with pytest.raises(lopin.ResourceError, match="E0604"):
            lopin.open(press, state=wrong)


def test_errors_are_those_of_a_run(tmp_path, core):
    with pytest.raises(lopin.DeckError):
        lopin.open(lopin.Deck.parse("*NODE\n1, 0., 0.\n*STEP\n*STATICK\n*END STEP\n", "bad"))


CTRL_C = """
import os, signal, sys, threading, time
import numpy as np
import lopin
with lopin.open(sys.argv[1]) as job:
    job.advance()
    started = time.process_time()
    job.advance()
    long = time.process_time() - started
    asked = []
    def press():                      # by the clock of this process: others may slow it down
        while time.process_time() - started < 0.2*long:
            time.sleep(0.001)
        asked.append(time.process_time())
        os.kill(os.getpid(), signal.SIGINT)
    for _ in range(8):                # on a busy machine a thread may wake when all is over
        before, inside = job.result["displacement"], True
        started = time.process_time()
        thread = threading.Thread(target=press)
        thread.start()
        try:
            job.advance()
            inside = False
            thread.join()
            time.sleep(0.05)
        except KeyboardInterrupt:
            took = time.process_time() - asked[-1]
            if inside:
                break
    else:
        sys.exit("not interrupted in eight increments")
    # Some eight iterations make an increment, four fifths of which were still to come.
    assert took < 0.5*long, (took, long)
    assert job.is_open and np.array_equal(job.result["displacement"], before)
    assert job.advance() is not None, "goes on"
"""


def test_ctrl_c_gives_the_increment_up_and_the_run_may_go_on(root, core):
    """Within one iteration, so long before the increment would have ended. In a process of its own, which a
    signal that comes too late ends."""
    done = subprocess.run([sys.executable, "-c", CTRL_C, str(root/"decks"/"upset_tetra.inp")], text=True,
                          capture_output=True)
    assert done.returncode == 0, done.stderr


def resident():
    return 4096*int(Path("/proc/self/statm").read_text().split()[1])


def test_many_runs_leave_no_memory_behind(press):
    def runs(n):
        for _ in range(n):
            with lopin.open(press) as job:
                job.advance()
                state = job.state
            lopin.open(press, state=state).close()

    runs(20)
    before = resident()
    runs(60)
    assert resident() - before < 1e6


def test_two_hundred_runs_in_one_process_do_not_grow(root, core):
    """Two kilobytes a run would show; the keyword table once left 22 behind."""
    deck = root/"decks"/"bar_gap.inp"
    for _ in range(50):
        lopin.run(deck)
    before = resident()
    for _ in range(200):
        lopin.run(deck)
    assert resident() - before < 0.4e6
