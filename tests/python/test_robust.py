"""A run that is killed, cannot write or is fed nonsense leaves nothing half done and says why."""
import json
import os
import random
import signal
import subprocess
import time
import xml.etree.ElementTree

import pytest

from conftest import ROOT
from scenes import SCENES, run


def check_folder(folder):
    """All files are whole; returns how many fields there are."""
    fields = 0
    for path in folder.iterdir():
        data = path.read_bytes()
        if path.suffix in (".vtu", ".pvd"):
            # Appended data is raw: the head must be XML, the tail must close it.
            assert data.rstrip().endswith(b"</VTKFile>"), path
            if b"<AppendedData" not in data:
                xml.etree.ElementTree.fromstring(data)
            fields += path.suffix == ".vtu"
        elif path.suffix == ".json":
            json.loads(data)
        elif path.suffix in (".csv", ".sta", ".cvg") and data:
            assert data.endswith(b"\n"), path
        if path.suffix == ".pvd":
            for node in xml.etree.ElementTree.fromstring(data).iter("DataSet"):
                assert (folder/node.get("file")).is_file(), node.get("file")
        if path.name.endswith("_history.csv") and data:
            lines = data.decode().splitlines()
            assert len({line.count(",") for line in lines}) == 1
    return fields


@pytest.mark.parametrize("name", ["sphere", "corner"])
def test_a_killed_run_leaves_whole_files(executable, tmp_path, name):
    deck = tmp_path/"job.inp"
    deck.write_text(SCENES[name]().but(increments=900).deck(), encoding="utf-8")
    dice = random.Random(3)
    fields, killed = 0, 0
    for trial in range(6):
        folder = tmp_path/f"out{trial}"
        process = subprocess.Popen([str(executable), "run", str(deck), "-o", str(folder),
                                    "--quiet"],
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        time.sleep(dice.uniform(0.02, 0.8))
        process.send_signal(signal.SIGKILL)
        killed += process.wait(timeout=60) == -signal.SIGKILL
        if folder.is_dir():
            fields += check_folder(folder)
    assert killed >= 3 and fields > 0


def test_a_folder_that_cannot_be_made_ends_with_5(executable, tmp_path):
    (tmp_path/"file").write_text("in the way")
    deck = tmp_path/"job.inp"
    deck.write_text(SCENES["sphere"]().deck(), encoding="utf-8")
    for folder in ("/dev/null/results", str(tmp_path/"file")):
        process = subprocess.run([str(executable), "run", str(deck), "-o", folder],
                                 capture_output=True, text=True, timeout=60)
        assert process.returncode == 5 and "error[E0601]" in process.stderr


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="no device that is always full")
def test_a_full_disk_ends_with_5(executable, tmp_path):
    """Every log and table in turn stands on a full device."""
    deck = tmp_path/"job.inp"
    deck.write_text(SCENES["sphere"]().deck(), encoding="utf-8")
    for ending in (".sta", ".cvg", "_history.csv"):
        folder = tmp_path/ending.strip("._")
        folder.mkdir()
        (folder/f"job{ending}").symlink_to("/dev/full")
        process = subprocess.run([str(executable), "run", str(deck), "-o", str(folder),
                                  "--overwrite"],
                                 capture_output=True, text=True, timeout=60)
        # Either it is refused, or the link is replaced by a file of its own.
        assert process.returncode == 5 or (folder/f"job{ending}").stat().st_size > 0, (ending,
                                                                                       process.stderr)


@pytest.mark.parametrize("word", ["nan", "inf", "1e400", "-1e999", "0x10", "1.5e"])
@pytest.mark.parametrize("place", ["20000.0, 0.3", "9001, 0.0, 20.0", "REF, 2, 2, -0.2"])
def test_what_is_no_number_is_refused_where_it_stands(executable, tmp_path, place, word):
    text = SCENES["sphere"]().deck()
    assert place in text
    head, _, last = place.rpartition(", ")
    process, _ = run(executable, text.replace(place, f"{head}, {word}"), tmp_path, accept=(1,))
    assert "error[E010" in process.stderr and "job.inp:" in process.stderr


def test_a_nearly_incompressible_body_is_right(executable, tmp_path):
    """Linear elements with mean dilatation do not lock: nu -> 1/2 converges to a limit."""
    from scenes import answer
    force = []
    for nu in (0.499, 0.49999, 0.4999999):
        scene = SCENES["sphere"]().but(materials={"BLOCK": (20000.0, nu)})
        scene.nsets["LEFT"] = [*scene.nsets["LEFT"]]
        force.append(answer(executable, scene, tmp_path/str(nu)).values["0.force"])
    assert force[1] == pytest.approx(force[0], rel=0.03) and force[2] == pytest.approx(force[1],
                                                                                       rel=1e-3)


@pytest.mark.parametrize("ratio", [1e3, 1e5])
def test_very_long_elements_are_solved_or_refused(executable, tmp_path, ratio):
    """A bar of one flat element under its own pressure: the certificate holds."""
    scene = SCENES["sphere"]()
    scene.nodes = {k: x*[1.0, 1.0/ratio] for k, x in scene.nodes.items()}
    scene.moved = [("REF", 2, -0.2/ratio)]
    process, folder = run(executable, scene.deck(), tmp_path, accept=(0, 3, 4))
    job = json.loads((folder/"job.json").read_text(encoding="utf-8"))
    assert process.returncode or job["certificate"]["equilibrium"] < 1e-6


def test_tables_that_a_deck_no_longer_asks_for_go(executable, root, tmp_path):
    """They would look like results of the new run; a file of somebody else stays."""
    deck = (root/"decks"/"bar_gap.inp").read_text()
    lines = deck.splitlines(keepends=True)
    at = next(i for i, line in enumerate(lines) if line.startswith("*NODE PRINT"))
    without = "".join(lines[:at] + lines[at + 2:])

    def run(text):
        (tmp_path/"a.inp").write_text(text)
        done = subprocess.run([executable, "run", "a.inp", "-o", "o", "--quiet"], cwd=tmp_path,
                              capture_output=True, text=True)
        return done.returncode, done.stderr

    assert run(deck) == (0, "") and (tmp_path/"o"/"a.dat").is_file()
    assert run(without)[0] == 0 and not (tmp_path/"o"/"a.dat").exists()
    assert run(deck)[0] == 0 and (tmp_path/"o"/"a.dat").is_file()
    assert run(without)[0] == 0
    (tmp_path/"o"/"a.dat").write_text("mine")
    code, said = run(deck)
    assert code == 5 and "E0603" in said and (tmp_path/"o"/"a.dat").read_text() == "mine"
    assert run(without)[0] == 0 and (tmp_path/"o"/"a.dat").read_text() == "mine"


@pytest.mark.usefixtures("core")
def test_harmed_decks_are_read_or_refused_with_their_line(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT/"tests"/"benchmarks"))
    import mutate

    files = mutate.decks(False)
    wrong = {n: mutate.judge_here(mutate.harm(n, files)[0], False) for n in range(60)}
    assert not {n: what for n, what in wrong.items() if what}
