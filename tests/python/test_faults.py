"""Disks that fill up, runs that are killed while they write, two runs in one folder: nothing that was
written is lost, and the exit code tells."""
import json
import os
import resource
import shutil
import signal
import subprocess
import time
import xml.etree.ElementTree
from pathlib import Path

import pytest

from test_checkpoint import billet

DISK = Path(__file__).with_name("full_disk.c")


@pytest.fixture(scope="module")
def disk(tmp_path_factory):
    """The environment of a program whose disk fails as told."""
    compiler = shutil.which(os.environ.get("CC", "cc"))
    if not compiler:
        pytest.skip("no C compiler")
    library = tmp_path_factory.mktemp("disk")/"full_disk.so"
    done = subprocess.run([compiler, "-shared", "-fPIC", "-o", library, DISK, "-ldl"],
                          capture_output=True, text=True)
    if done.returncode:
        pytest.skip(f"the disk of tests cannot be built: {done.stderr}")
    return lambda **fault: os.environ | {"LD_PRELOAD": str(library)} | {
        f"FAULT_{k.upper()}": str(v) for k, v in fault.items()}


class Bench:
    """A deck and its runs, beside a run left alone."""

    def __init__(self, executable, place, text):
        self.executable, self.place = str(executable), place
        (place/"job.inp").write_text(text)

    def run(self, folder, *words, **how):
        return subprocess.run([self.executable, "run", "job.inp", "-o", folder, *words],
                              cwd=self.place, capture_output=True, text=True, timeout=60, **how)

    def start(self, folder, *words, **how):
        return subprocess.Popen([self.executable, "run", "job.inp", "-o", folder, *words],
                                cwd=self.place, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                text=True, **how)

    def files(self, folder):
        """What a folder holds, but for times."""
        files = {p.name: p.read_bytes() for p in (self.place/folder).iterdir()}
        files.pop("job.json")
        return files

    def goes_on(self, folder):
        """The run goes on, and ends with the bits of the run left alone."""
        done = self.run(folder, "--resume")
        assert done.returncode == 0, done.stderr
        here, there = self.files("alone"), self.files(folder)
        assert sorted(here) == sorted(there)
        assert [k for k in here if here[k] != there[k]] == []
        assert json.loads((self.place/folder/"job.json").read_text())["status"] == "finished"


@pytest.fixture(scope="module")
def bench(executable, tmp_path_factory):
    b = Bench(executable, tmp_path_factory.mktemp("faults"), billet(steps=(0.1, 0.2)))
    assert b.run("alone").returncode == 0
    return b


def whole(folder):
    """No file is torn, and what is listed is there."""
    for path in folder.iterdir():
        data = path.read_bytes()
        if path.suffix in (".sta", ".cvg", ".csv", ".dat", ".frd"):
            assert not data or data.endswith(b"\n"), path
        if path.suffix == ".json":
            assert json.loads(data)["schema"]
        if path.suffix == ".vtu":
            assert data.endswith(b"</VTKFile>\n"), path
        if path.suffix == ".pvd":
            listed = {node.get("file")
                      for node in xml.etree.ElementTree.fromstring(data).iter("DataSet")}
            assert all((folder/name).is_file() for name in listed)


@pytest.mark.parametrize("moment", range(12))
def test_a_disk_that_fills_up(bench, disk, moment):
    """At any moment: exit 5, the file and the reason named, all files whole, the run goes on."""
    total = sum(map(len, bench.files("alone").values()))
    room = 40 + int(1.4*total*(moment/12)**2)
    folder = f"full{moment}"
    done = bench.run(folder, env=disk(room=room))
    assert done.returncode == 5 and "error[E0602]" in done.stderr, done.stderr
    assert "No space left on device" in done.stderr and "Job finished" not in done.stdout
    whole(bench.place/folder)
    parts = [p.name for p in (bench.place/folder).iterdir() if p.suffix in (".part", ".lock")]
    assert parts == []
    state = bench.place/folder/"job.rst"
    assert state.exists() == ("checkpoint after" in done.stderr)
    if (bench.place/folder/"job.json").exists():
        said = json.loads((bench.place/folder/"job.json").read_text())
        assert said["status"] == "failed" and said["exit_code"] == 5
    # On the same full disk neither a resumed nor a new run destroys anything.
    before = state.read_bytes() if state.exists() else None
    assert bench.run(folder, "--resume", env=disk(room=10)).returncode == 5
    assert bench.run(folder, env=disk(room=10)).returncode == 5
    assert (state.read_bytes() if state.exists() else None) == before
    bench.goes_on(folder)


@pytest.mark.parametrize("fault", ["sync", "close"])
@pytest.mark.parametrize("number", [1, 3, 6])
def test_a_sync_or_close_that_fails(bench, disk, fault, number):
    """Disks on a network tell late that they were full."""
    folder = f"{fault}{number}"
    done = bench.run(folder, env=disk(**{fault: number}))
    assert done.returncode == 5 and "Input/output error" in done.stderr
    assert "Job finished" not in done.stdout
    whole(bench.place/folder)
    bench.goes_on(folder)


@pytest.mark.parametrize("blocks", [0, 2, 10, 36])
def test_a_limit_of_file_sizes(bench, blocks):
    """`ulimit -f` sends a signal, which must not end the run unheard."""
    folder = f"limit{blocks}"
    limit = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (1024*blocks, 1024*blocks))
    done = bench.run(folder, preexec_fn=limit)
    assert done.returncode == 5 and "File too large" in done.stderr, (done.returncode, done.stderr)
    assert "ulimit -f" in done.stderr
    whole(bench.place/folder)
    bench.goes_on(folder)


@pytest.mark.parametrize("moment", range(8))
def test_a_run_killed_in_the_middle_of_a_write(bench, disk, moment):
    total = sum(map(len, bench.files("alone").values()))
    folder = f"killed{moment}"
    done = bench.run(folder, env=disk(kill=int(500 + total*(0.15*moment)**2)))
    assert done.returncode == -signal.SIGKILL
    for path in list((bench.place/folder).glob("*.part")):
        assert (bench.place/folder/path.stem).suffix in (".rst", ".vtu", ".json", ".sta", ".cvg",
                                                         ".csv", ".dat", ".frd", ".pvd")
    bench.goes_on(folder)


def test_two_runs_in_one_folder(bench):
    """The second is refused by the name of the first, whose lock ends with it."""
    folder = bench.place/"two"
    place = bench.place/"slow"
    place.mkdir()
    slow = Bench(bench.executable, place, billet(steps=(0.01, 0.01)))
    first = slow.start(str(folder))
    while not (folder/"job.rst").exists() and first.poll() is None:
        time.sleep(0.002)
    second = slow.run(str(folder))
    third = slow.run(str(folder), "--resume")
    alive = first.poll() is None
    for refused in (second, third):
        assert refused.returncode == 5 and "error[E0607]" in refused.stderr
        assert f"process {first.pid} on {os.uname().nodename}" in refused.stderr
    assert alive, "the first run was still going when the others were refused"
    first.kill()
    first.communicate()
    assert (folder/"job.lock").exists(), "a killed run leaves its lock's file"
    assert slow.run(str(folder), "--resume").returncode == 0
    assert not (folder/"job.lock").exists()


def test_links_of_others_are_not_followed(bench):
    """Files that somebody else laid under the names of ours lead nowhere."""
    precious = bench.place/"precious"
    precious.write_text("mine")
    folder = bench.place/"links"
    folder.mkdir()
    for name in ("job.json.part", "job.sta.part", "job.pvd.part", "job_0001.vtu.part",
                 "job.rst.part"):
        (folder/name).symlink_to(precious)
    assert bench.run("links").returncode == 0
    assert precious.read_text() == "mine"
    for name in ("job.sta", "job.rst", "job.lock", "job_0001.vtu"):
        folder = bench.place/f"link_{name}"
        folder.mkdir()
        (folder/name).symlink_to(precious)
        done = bench.run(folder.name)
        assert done.returncode == 5 and ("E0603" in done.stderr or "E0602" in done.stderr), name
        assert precious.read_text() == "mine" and (folder/name).is_symlink()
