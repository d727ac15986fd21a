"""Runs in this process: the same bits as the executable, no program started, nothing kept."""
import json
import os
import re
import runpy
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest

import lopin
from lopin import _bridge, mesh_make, profile

#: Decks whose mistake shows when they are read; the others say `** run` in their second line.
BAD = [path for path in sorted((Path(__file__).resolve().parents[2]/"decks"/"bad").glob("*.inp"))
       if path.read_text(encoding="utf-8").splitlines()[1].strip() != "** run"]


@pytest.fixture(autouse=True)
def api(core):
    """All tests here need the compiled part."""
    return core


def press(method="lagrange", cells=(4, 2), kind="plane strain", increments=2, depth=0.01):
    """A block under a ball that a rigid tool makes."""
    model = lopin.Model("press", mesh_make.block((2.0, 1.0), cells), kind=kind)
    model.section("ALL", lopin.Elastic(210e3, 0.3))
    ball = profile.arc((0.0, 4.0), 3.0, 180.0, 360.0)
    die = model.rigid_tool("die", ball, ref=(0.0, 1.0))
    model.contact("TOP", die, method)
    across, up = "rz" if kind == "axisymmetric" else "xy"
    model.fix("BOTTOM", up)
    model.fix("LEFT", across)
    model.step(increments=increments).move(die, **{up: -depth})
    return model


def fnv(data: bytes) -> str:
    """FNV-1a, 64 bits."""
    number = 0xcbf29ce484222325
    for byte in data:
        number = (number ^ byte)*0x100000001b3 & 0xffffffffffffffff
    return f"{number:016X}"


def signed(result) -> str:
    """The checksum of a result from its own displacements."""
    every = [result.at(k)["displacement"] for k in range(len(result.times))]
    space = [np.pad(u, ((0, 0), (0, 3 - u.shape[1]))) for u in every]
    return fnv(b"".join(u.tobytes() for u in space))


def agree_to_the_bit(scene, folder):
    """Run a scene both ways; every number that both show is the same."""
    mine = lopin.run(scene)
    other = lopin.run(scene, folder, executable=True)
    assert mine["displacement"].dtype == np.float64
    assert mine.summary["checksum"] == other.summary["checksum"] == signed(mine)
    # The history is written with all digits.
    assert mine.history.keys() == other.history.keys()
    for name, column in mine.history.items():
        assert column.tobytes() == other.history[name].tobytes(), name
    assert mine.times.tobytes() == other.times.tobytes()
    # Fields are written in single precision.
    for name in ("U", "RF", "S", "Mises"):
        assert (mine[name].astype(np.float32) == other[name]).all(), name
    assert mine.pairs == other.pairs
    for pair in mine.pairs:
        a, b = mine.contact(pair).last, other.contact(pair).last
        places = {tuple(x): k for k, x in enumerate(b.x)}
        order = [places[tuple(x)] for x in a.x]
        assert (a.pressure.astype(np.float32) == b.pressure[order]).all()
        assert (a.status == b.status[order]).all()
    for word in ("plan", "steps", "contact", "certificate", "energy", "model", "status"):
        assert mine.summary[word] == other.summary[word], word
    return mine


@pytest.mark.parametrize("method", ["lagrange", "penalty", "perturbed", "augmented"])
@pytest.mark.parametrize("kind", ["plane strain", "axisymmetric"])
def test_both_ways_give_the_same_bits(executable, tmp_path, method, kind):
    agree_to_the_bit(press(method, kind=kind), tmp_path)


@pytest.mark.parametrize("name", ["hertz_sphere", "hertz_sphere_3d", "bar_gap"])
def test_decks_give_the_same_bits(executable, root, tmp_path, name):
    agree_to_the_bit(root/"decks"/f"{name}.inp", tmp_path)


def test_files_can_be_written_from_this_process(tmp_path, executable):
    mine = lopin.run(press(), tmp_path/"mine")
    lopin.run(press(), tmp_path/"other", executable=True)
    names = [sorted(p.name for p in (tmp_path/side).iterdir()) for side in ("mine", "other")]
    assert names[0] == names[1] and "press_history.csv" in names[0]
    again = lopin.open_result(tmp_path/"mine")
    assert again.summary["checksum"] == mine.summary["checksum"]
    for name in names[0]:
        if name.endswith((".csv", ".vtu", ".pvd")):
            first, second = (tmp_path/side/name for side in ("mine", "other"))
            assert first.read_bytes() == second.read_bytes(), name


def test_no_program_is_started(monkeypatch, root):
    def forbidden(*_, **__):
        raise AssertionError("a program was started")

    monkeypatch.setenv("PATH", "")
    monkeypatch.delenv("LOPIN_EXECUTABLE", raising=False)
    monkeypatch.setattr(subprocess, "Popen", forbidden)
    for name in ("system", "popen", "fork", "posix_spawn", "posix_spawnp", "execv", "execve",
                 "execvp", "execvpe", "execl", "execlp", "execle", "execlpe", "spawnv", "spawnve"):
        monkeypatch.setattr(os, name, forbidden)
    result = lopin.run(root/"decks"/"bar_gap.inp")
    assert result["displacement"].shape[1] in (2, 3)
    assert lopin.run(press()).contact("TOP").last.pressure.max() > 0.0
    with pytest.raises(lopin.DeckError):
        lopin.run(root/"decks"/"bad"/"misspelt_keyword.inp")


@pytest.mark.parametrize("path", BAD, ids=lambda path: path.stem)
def test_bad_decks_raise_what_the_executable_says(path, executable, monkeypatch, tmp_path):
    monkeypatch.chdir(path.parent)
    done = subprocess.run([executable, "run", path.name, "--no-color", "-o", tmp_path/"out"],
                          capture_output=True, text=True)
    with pytest.raises(lopin.LopinError) as caught:
        lopin.run(path.name)
    error = caught.value
    first, second = path.read_text().splitlines()[:2]
    shows_in_a_run = second.strip() == "** run"
    assert isinstance(error, lopin.DeckError) or shows_in_a_run
    assert error.code == done.returncode > 0
    said = [d for d in error.diagnostics if d["severity"] == "error"]
    assert first[11:].split("|")[0].strip() in [d["code"] for d in said]
    assert error.id == said[0]["code"] and error.message.startswith(said[0]["message"])
    assert f"error[{error.id}]" in said[0]["text"]
    if said[0]["line"]:
        assert error.file.endswith(".inp") and error.line > 0 and error.column >= 0
        assert "-->" in said[0]["text"]
    else:
        assert shows_in_a_run
    # What a terminal shows, the place included, is in the exception, too.
    for item in error.diagnostics:
        assert item["text"] in done.stderr


def test_the_interpreter_survives_a_hundred_failures(tmp_path):
    handles = set()
    for k in range(100):
        text = press().to_deck().text()
        deck = lopin.Deck.parse(text.replace("*ELASTIC", ("*ELASTIK", "*PLASTIC", "*NODE")[k % 3]))
        with pytest.raises(lopin.DeckError) as caught:
            lopin.run(deck)
        handles.add(len(caught.value.diagnostics) > 0)
    assert handles == {True}
    assert lopin.run(press()).summary["status"] == "finished"


def test_a_body_that_nothing_holds_is_singular():
    model = lopin.Model("free", mesh_make.block((2.0, 1.0), (4, 2)), kind="plane strain")
    model.section("ALL", lopin.Elastic(210e3, 0.3))
    model.fix("BOTTOM", "y")
    model.step().move("TOP", y=-0.01)
    with pytest.raises(lopin.SingularError) as caught:
        lopin.run(model)
    assert (caught.value.code, caught.value.id) == (4, "E0310") and caught.value.line > 0


def test_an_unfinished_run_keeps_its_result():
    model = press(increments=10)
    model.steps[0].most = 3
    with pytest.raises(lopin.NotConvergedError) as caught:
        lopin.run(model)
    assert (caught.value.code, caught.value.id) == (3, "E0503")
    result = caught.value.result
    assert len(result.times) == 3 and result.summary["status"] == "not converged"
    assert np.abs(result["U"]).max() > 0.0


def test_check_solves_nothing(root):
    assert all(d["severity"] != "error" for d in lopin.check(press()))
    with pytest.raises(lopin.ModelError, match="no node set `TOPP`"):
        lopin.check(root/"decks"/"bad"/"undefined_node_set.inp")


def test_options():
    assert lopin.run(press(), solver="skyline").summary["solver"] == "skyline"
    assert lopin.run(press(), threads=1, deterministic=True).summary["exit_code"] == 0
    with pytest.raises(lopin.UsageError, match="no such option.*colour=red"):
        lopin.run(press(), colour="red")
    with pytest.raises(lopin.UsageError, match="threads=0"):
        lopin.run(press(), threads=0)
    with pytest.raises(lopin.LopinError):
        lopin.run(press(), solver="none_such")


def test_unknown_results_and_handles():
    result = lopin.run(press())
    with pytest.raises(lopin.UsageError, match="no result 'T'"):
        result["T"]
    session = result.source.session
    with pytest.raises(lopin.UsageError):
        session.field("U", 99)
    core = _bridge.core()
    for handle in (0, -1, 10**6):
        assert core.result_shape(handle, b"U", 1)[-1] == 2
        assert core.text_length(handle, b"names") == 0
        core.close_session(handle)
    session.close()
    with pytest.raises(lopin.UsageError):
        session.field("U", 0)


def test_mesh_and_fields_cross_whole():
    model = press(cells=(3, 2))
    mesh = lopin.run(model).to_meshio()
    assert mesh.points[:12, :2] == pytest.approx(model.mesh.points, abs=0.0)
    assert len(mesh.cells_dict["quad"]) == 6 and mesh.point_data["U"].shape == (13, 3)


def test_arrays_outlive_their_run():
    u = lopin.run(press())["U"]
    again = lopin.run(press(depth=0.02))["U"]
    assert not np.shares_memory(u, again)
    assert u.tobytes() == lopin.run(press())["U"].tobytes() != again.tobytes()


def test_two_models_at_once():
    depths = [0.004, 0.011]
    alone = [lopin.run(press(cells=(40, 20), depth=d)).summary["checksum"] for d in depths]
    together, trouble = {}, []

    def work(k):
        try:
            for turn in range(2):
                together[k, turn] = lopin.run(press(cells=(40, 20), depth=depths[k]))
        except BaseException as problem:
            trouble.append(problem)

    threads = [threading.Thread(target=work, args=(k,)) for k in (0, 1)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not trouble
    for (k, _), result in together.items():
        assert result.summary["checksum"] == alone[k] == signed(result)


def test_messages_of_threads_do_not_mix():
    decks = [lopin.Deck.read(path) for path in BAD[::8]]

    def messages():
        said = []
        for deck in decks:
            with pytest.raises(lopin.LopinError) as caught:
                lopin.run(deck)
            said.append([d["text"] for d in caught.value.diagnostics])
        return said

    alone, together = messages(), []
    threads = [threading.Thread(target=lambda: together.append(messages())) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert together == [alone]*4


def test_other_threads_go_on_while_a_run_is_solved():
    ticks, done = [0], threading.Event()

    def tick():
        while not done.wait(0.001):
            ticks[0] += 1

    thread = threading.Thread(target=tick)
    thread.start()
    lopin.run(press(cells=(120, 60)))
    done.set()
    thread.join()
    assert ticks[0] > 5


def memory() -> int:
    """Resident kilobytes of this process."""
    try:
        text = Path("/proc/self/status").read_text()
    except OSError:
        pytest.skip("this system does not say how much memory a process has")
    return int(re.search(r"VmRSS:\s+(\d+)", text)[1])


def test_closed_runs_are_forgotten():
    deck = press(cells=(12, 6)).to_deck()
    kept = [lopin.run(deck) for _ in range(5)]
    highest = max(r.source.session.handle for r in kept)
    sizes = []
    for k in range(80):
        result = lopin.run(deck)
        assert result["U"].shape[1] == 2 and result.source.session.handle <= highest + 2
        if k in (19, 79):
            sizes.append(memory())
    # 60 runs whose arrays alone take about 30 KiB each.
    assert sizes[-1] - sizes[0] < 1024, sizes
    assert kept[0]["U"].tobytes() == result["U"].tobytes()


def test_the_summary_is_that_of_the_file(tmp_path):
    result = lopin.run(press(), tmp_path)
    written = json.loads((tmp_path/"press.json").read_text())
    for word in result.summary.keys() - {"timing", "files", "peak_memory_mib", "threads"}:
        assert result.summary[word] == written[word], word


def test_the_example_of_hertz_draws_its_picture(root, tmp_path, monkeypatch, capsys):
    pytest.importorskip("matplotlib").use("Agg")
    monkeypatch.chdir(tmp_path)
    runpy.run_path(str(root/"decks"/"hertz_sphere.py"))
    words = capsys.readouterr().out.split()
    force, pressure, exact = (float(words[k]) for k in (1, 4, 7))
    # Beside Hertz's half-space the block is only forty times as deep as the contact is wide.
    assert force == pytest.approx(586.08, rel=0.03) and pressure == pytest.approx(exact, rel=0.005)
    assert (tmp_path/"hertz_sphere.png").stat().st_size > 10000


def test_the_command_of_the_package_is_the_executable(executable, root, tmp_path):
    environment = os.environ | {"LOPIN_EXECUTABLE": str(executable),
                                "PYTHONPATH": str(Path(lopin.__file__).parent.parent)}
    command = [sys.executable, "-m", "lopin", "run", root/"decks"/"bar_gap.inp", "-o", tmp_path]
    done = subprocess.run(command, env=environment, capture_output=True, text=True)
    assert done.returncode == 0 and done.stdout.endswith("Job finished\n")
    mine = lopin.run(root/"decks"/"bar_gap.inp")
    assert lopin.open_result(tmp_path).summary["checksum"] == mine.summary["checksum"]
    command[4] = root/"decks"/"bad"/"misspelt_keyword.inp"
    assert subprocess.run(command, env=environment, capture_output=True).returncode == 1
