"""Disks that fill up, runs that are killed while they write, two runs in one folder: nothing that was
written is lost, and the exit code tells."""
import json
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import time
import xml.etree.ElementTree
from pathlib import Path

import pytest

import lopin
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
        """A run that heeds the signals which the tests themselves may be told to pass over."""
        def heed():
            for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
                signal.signal(number, signal.SIG_DFL)

        how.setdefault("preexec_fn", heed)
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


@pytest.mark.parametrize("moment", [0, 1, 3, 5, 7, 9, 11])
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
@pytest.mark.parametrize("number", [1, 6])
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


@pytest.mark.parametrize("moment", [0, 1, 3, 5, 7])
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


def column(increments: int) -> str:
    """One element pressed on a floor in many increments."""
    return f"""*NODE
1, 0., 0.
2, 1., 0.
3, 1., 1.
4, 0., 1.
9, 0., 0.
*ELEMENT, TYPE=CPE4, ELSET=B
1, 1, 2, 3, 4
*MATERIAL, NAME=M
*ELASTIC
1000., 0.3
*SOLID SECTION, ELSET=B, MATERIAL=M
*SURFACE, NAME=FOOT
B, S1
*SURFACE, NAME=FLOOR, TYPE=SEGMENTS
START, -10., 0.
LINE, 10., 0.
*RIGID BODY, ANALYTICAL SURFACE=FLOOR, REF NODE=9
*SURFACE INTERACTION, NAME=I
*CONTACT PAIR, INTERACTION=I
FOOT, FLOOR
*BOUNDARY
9, 1, 2
9, 6
1, 1
*STEP, NLGEOM, INC={increments}
*STATIC, DIRECT
{1.0/increments!r}, 1.
*BOUNDARY
3, 2, 2, -0.01
4, 2, 2, -0.01
*END STEP
"""


def written() -> int:
    """Bytes that this process and those it waited for have written."""
    return int(next(line.split()[1] for line in Path("/proc/self/io").read_text().splitlines()
                    if line.startswith("wchar")))


@pytest.mark.skipif(not os.path.exists("/proc/self/io"), reason="the system does not count bytes")
def test_each_increment_writes_as_much_as_the_one_before(executable, tmp_path):
    """Nothing is written again because there is more of it."""
    bytes_of = []
    for k, increments in enumerate((100, 400)):
        place = tmp_path/str(k)
        place.mkdir()
        b = Bench(executable, place, column(increments))
        before = written()
        assert b.run("out").returncode == 0
        bytes_of.append(written() - before)
    assert bytes_of[1] < 4.1*bytes_of[0]


def brick(n: int) -> str:
    """A cube of n^3 elements, compressed."""
    m = n + 1
    node = "".join(f"{1 + i + m*(j + m*k)}, {i}., {j}., {k}.\n"
                   for k in range(m) for j in range(m) for i in range(m))
    corner = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))
    element = "".join(f"{1 + i + n*(j + n*k)}, " + ", ".join(
        str(1 + i + a + m*(j + b + m*(k + c))) for a, b, c in corner) + "\n"
        for k in range(n) for j in range(n) for i in range(n))
    return (f"*NODE\n{node}*ELEMENT, TYPE=C3D8, ELSET=B\n{element}*NSET, NSET=LOW, GENERATE\n1, {m*m}\n"
            f"*NSET, NSET=HIGH, GENERATE\n{m*m*n + 1}, {m**3}\n*MATERIAL, NAME=M\n*ELASTIC\n1000., 0.3\n"
            "*SOLID SECTION, ELSET=B, MATERIAL=M\n*BOUNDARY\nLOW, 1, 3\n*STEP\n*STATIC\n1., 1.\n"
            "*BOUNDARY\nHIGH, 3, 3, -0.1\n*END STEP\n")


@pytest.mark.parametrize("limit", [72, 96, 200, 320])
def test_memory_that_ends(executable, tmp_path, limit):
    """Of every command, within seconds: it gets through, or it says so."""
    (tmp_path/"job.inp").write_text(brick(14))
    bound = lambda: resource.setrlimit(resource.RLIMIT_AS, (limit*2**20, limit*2**20))
    codes = []
    for words in ("run job.inp", "check job.inp --json", "info job.inp", "selftest", "doc --all"):
        done = subprocess.run([executable, *words.split()], cwd=tmp_path, capture_output=True,
                              text=True, timeout=30, preexec_fn=bound)
        said = done.stdout + done.stderr
        if done.returncode == 127 and "shared" in done.stderr:
            pytest.skip("too little for the libraries")
        assert done.returncode == 0 or (done.returncode == 5 and "E0702" in said), (words, done)
        if words.endswith("json"):
            assert json.loads(done.stdout)["exit_code"] == done.returncode
        codes.append(done.returncode)
    if codes[0] and (tmp_path/"out"/"job"/"job.json").exists():
        assert json.loads((tmp_path/"out"/"job"/"job.json").read_text())["status"] == "failed"
    if limit == 96:
        assert codes[0] == 5, "OpenBLAS alone takes 128 MB"


@pytest.mark.parametrize("limit", [1, 100, 140])
def test_memory_that_ends_inside_the_library(core, tmp_path, limit):
    """`limit` MB beyond what the loaded library takes: an exception, or the end that the executable
    has, never a crash."""
    (tmp_path/"job.inp").write_text(brick(12))
    (tmp_path/"job.py").write_text(
        "import resource, lopin\n"
        "lopin.check('job.inp')\n"
        "used = 4096*int(open('/proc/self/statm').read().split()[0])\n"
        f"resource.setrlimit(resource.RLIMIT_AS, (used + {limit}*2**20,)*2)\n"
        "try:\n"
        "    lopin.run('job.inp')\n"
        "except lopin.LopinError as problem:\n"
        "    assert 'E0702' in str(problem), problem\n")
    done = subprocess.run([sys.executable, "job.py"], cwd=tmp_path, capture_output=True, text=True,
                          timeout=60, env={**os.environ, "OPENBLAS_NUM_THREADS": "1"})
    assert done.returncode == 0 or (done.returncode == 5 and "error[E0702]" in done.stderr), done


def test_output_that_nobody_reads(bench, disk):
    """A reader who left is no news; a full disk behind standard output is."""
    lopin = bench.executable
    reading, writing = os.pipe()
    os.close(reading)
    for words in (["doc", "--all"], ["explain"], ["check", "job.inp", "--json"], ["--help"]):
        for ignored in (True, False):
            done = subprocess.run([lopin, *words], cwd=bench.place, stdout=writing,
                                  stderr=subprocess.PIPE, restore_signals=not ignored, timeout=20)
            assert (done.returncode, done.stderr) == (5, b"")
    os.close(writing)
    if os.path.exists("/dev/full"):
        with open("/dev/full", "w") as full:
            done = subprocess.run([lopin, "doc", "--all"], stdout=full, stderr=subprocess.PIPE,
                                  text=True, timeout=20)
        assert done.returncode == 5 and "E0608" in done.stderr and "No space" in done.stderr
    # The run itself goes on to its end.
    for folder, ending in (("closed", ">&-"), ("unread", "| exec true"), ("silent", ">&- 2>&-")):
        done = subprocess.run(f"{lopin} run job.inp -o {folder} {ending}", shell=True, timeout=60,
                              cwd=bench.place, capture_output=True, text=True)
        assert "Fortran" not in done.stderr
        while (bench.place/folder/"job.lock").exists():
            time.sleep(0.01)
        assert bench.files(folder) == bench.files("alone")


def catches(process: int, number: int) -> bool:
    """Whether a process has a handler for a signal."""
    status = Path(f"/proc/{process}/status").read_text()
    return bool(int(re.search(r"SigCgt:\s*(\w+)", status)[1], 16) >> (number - 1) & 1)


@pytest.mark.parametrize("first, second", [("SIGINT", "SIGINT"), ("SIGTERM", "SIGTERM"),
                                           ("SIGINT", "SIGTERM"), ("SIGHUP", "SIGINT")])
def test_a_second_signal_ends_the_process_at_once(executable, tmp_path, first, second):
    """The first waits for the end of the iteration, which takes longer than the test."""
    b = Bench(executable, tmp_path, brick(24).replace("*STEP\n", "*STEP, NLGEOM\n"))
    process = b.start("out")
    while process.poll() is None and not (tmp_path/"out"/"job.lock").exists():
        time.sleep(0.01)
    time.sleep(0.2)
    process.send_signal(signal.Signals[first])
    while process.poll() is None and catches(process.pid, signal.Signals[second]):
        time.sleep(0.001)
    assert process.poll() is None, "the iteration goes on"
    begun = time.monotonic()
    process.send_signal(signal.Signals[second])
    assert process.wait(timeout=20) == -signal.Signals[second]
    assert time.monotonic() - begun < 1.0 and "Backtrace" not in process.stdout.read()


@pytest.mark.parametrize("few", [0, 1, 3])
def test_a_factor_does_with_the_threads_that_start(executable, tmp_path, few):
    """All that the test of factors asks, solutions to the bit, where threads do not start."""
    program = executable.parent/"tests"/"test_threads_of_factors"
    compiler = shutil.which(os.environ.get("CC", "cc"))
    if not program.is_file() or not compiler:
        pytest.skip("needs the test programs and a C compiler")
    library = tmp_path/"few_threads.so"
    subprocess.run([compiler, "-shared", "-fPIC", "-o", library,
                    Path(__file__).with_name("few_threads.c"), "-ldl"], check=True)
    done = subprocess.run([program], capture_output=True, text=True, timeout=120, env=os.environ | {
        "LD_PRELOAD": str(library), "FEW_THREADS": str(few), "OPENBLAS_NUM_THREADS": "1"})
    assert done.returncode == 0 and ", 0 failed" in done.stdout, done.stdout + done.stderr


def test_threads_have_a_limit(bench):
    done = bench.run("many", "--threads", "100000")
    assert done.returncode == 2 and "at most 1024" in done.stderr


def test_a_fork_after_a_threaded_run_computes(core, root):
    """OpenMP's threads do not come along; the child starts its own."""
    code = f"""
import os, lopin
def run():
    return lopin.run(r"{root/'decks'/'signorini.inp'}", threads=3).summary["checksum"]
first = run()
child = os.fork()
if child == 0:
    os._exit(0 if run() == first else 1)
assert os.waitpid(child, 0)[1] == 0 and run() == first
"""
    subprocess.run([sys.executable, "-W", "ignore", "-c", code], check=True, timeout=60)


def names(text: str) -> str:
    """A second tool whose name folds to the word of the first, and a surface no XML or CSV likes."""
    return (text.replace("FLOOR", '"A B"')
            .replace("*RIGID", '*SURFACE, NAME="A_B", TYPE=SEGMENTS\nSTART, 3., -10.\nLINE, 3., 10.\n'
                     '*NODE\n8, 3., 0.\n*RIGID BODY, ANALYTICAL SURFACE="A_B", REF NODE=8\n'
                     '*SURFACE, NAME="S,<&>[x]"\nB, S2\n*RIGID', 1)
            .replace("*BOUNDARY\n9, 1", '*CONTACT PAIR, INTERACTION=I\n"S,<&>[x]", "A_B"\n*BOUNDARY\n'
                     '8, 1, 2\n8, 6\n9, 1', 1))


def test_names_are_escaped_and_two_tools_get_two_files(executable, tmp_path):
    job = 'a&b "c"<d>'
    (tmp_path/f"{job}.inp").write_text(names(column(2)))
    run = [executable, "run", f"{job}.inp", "-o", "out"]
    for _ in range(2):   # its own files are known again
        done = subprocess.run(run, cwd=tmp_path, capture_output=True, text=True, timeout=20)
        assert done.returncode == 0, done.stderr
    out = tmp_path/"out"
    listed = [node.get("file") for node in
              xml.etree.ElementTree.parse(out/f"{job}.pvd").iter("DataSet")]
    assert len(set(listed)) == len(listed) == 10 and all((out/name).is_file() for name in listed)
    assert len(list(out.glob("*.vtu"))) == 10
    whole(out)
    result = lopin.open_result(out)
    assert result.source.pairs() == ["FOOT-A B", "S,<&>[X]-A_B"]
    assert "S,<&>[X]-A_B.area" in result.source.history()
    assert len(result.source.contact("S,<&>[X]-A_B", 0)["X"]) == 2


def test_control_characters_do_not_reach_the_terminal(executable, tmp_path):
    bad = "\x1b[31m\x07\x7f\x9b\u202e"
    text = column(2).replace("*MATERIAL", f"*NODA{bad}\n*MATERIAL", 1).replace(
        "*ELASTIC", f"*INCLUDE, INPUT={bad}.inp\n*ELASTIC")
    name = "job\x1b[2J.inp"
    (tmp_path/name).write_bytes(text.encode() + b"*\xff\xfe\n")
    for words in (["check", name], ["run", name], ["info", name], ["check", f"{bad}.inp"],
                  ["check", name, "--json"], ["explain", bad], ["doc", bad], [f"--{bad}"]):
        done = subprocess.run([executable, *words], cwd=tmp_path, capture_output=True, timeout=20)
        assert done.returncode in (1, 2, 5)
        said = (done.stdout + done.stderr).decode("utf-8")
        assert not [c for c in said if (ord(c) < 32 and c != "\n") or 127 <= ord(c) < 160 or
                    c == "\u202e"], said
        if "--json" in words:
            assert json.loads(done.stdout)["exit_code"] == done.returncode


def test_what_is_no_deck_gets_its_true_message(executable, tmp_path):
    """Pipes, folders, devices, files too long, too deep in one another, too many."""
    os.mkfifo(tmp_path/"pipe.inp")
    with (tmp_path/"long.inp").open("wb") as file:
        file.truncate(3*10**9)
    (tmp_path/"folder.inp").mkdir()
    for k in range(40):
        (tmp_path/f"deep{k}.inp").write_text(f"*INCLUDE, INPUT=deep{k + 1}.inp\n")
    for k in range(12):
        (tmp_path/f"many{k}.inp").write_text(f"*INCLUDE, INPUT=many{k + 1}.inp\n"*2)
    (tmp_path/"deep40.inp").write_text("** end\n")
    (tmp_path/"many12.inp").write_text("** end\n")
    (tmp_path/"of_pipe.inp").write_text("*INCLUDE, INPUT=pipe.inp\n")
    for name, code, words in (("pipe", 5, "it is a pipe"), ("long", 5, "3.0 GB"),
                              ("folder", 5, "it is a folder"), ("none", 5, "no such file"),
                              ("deep0", 1, "33 deep"), ("many0", 1, "1000 files"),
                              ("of_pipe", 1, "it is a pipe")):
        done = subprocess.run([executable, "check", f"{name}.inp"], cwd=tmp_path,
                              capture_output=True, text=True, timeout=10)
        assert done.returncode == code and words in done.stderr, (name, done.stderr)
        assert done.stderr.count("error[") == 1


def python(*words, **how):
    return subprocess.run([sys.executable, *words], capture_output=True, text=True, timeout=60, **how)


def test_what_python_writes_is_whole_too(tmp_path):
    """A deck that does not fit leaves the one that was there, and no temporary file."""
    deck = tmp_path/"job.inp"
    deck.write_text("old\n")
    code = ("import lopin, resource; resource.setrlimit(resource.RLIMIT_FSIZE, (64, 64))\n"
            f"lopin.Deck.parse({column(3)!r}).write(r'{deck}')\n")
    done = python("-c", code)
    assert "lopin.errors.ResourceError: E0602" in done.stderr and "too large" in done.stderr
    assert deck.read_text() == "old\n" and os.listdir(tmp_path) == ["job.inp"]
    words = ("-m", "lopin", "example", "two_springs", str(tmp_path))
    limit = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (64, 64))
    done = python(*words, preexec_fn=limit)
    assert done.returncode == 5 and done.stderr.startswith("error: "), done.stderr
    reading, writing = os.pipe()
    os.close(reading)
    done = subprocess.run([sys.executable, "-m", "lopin", "example"], stdout=writing,
                          stderr=subprocess.PIPE, timeout=60)
    os.close(writing)
    assert (done.returncode, done.stderr) == (5, b"")


def test_ctrl_c_ends_a_run_of_this_process(core, bench):
    """After the increment in hand, as KeyboardInterrupt; the state is kept, and Python's own
    handler is back."""
    code = """
import lopin, os, pathlib, signal, sys, threading, time
signal.signal(signal.SIGINT, signal.default_int_handler)   # a shell's background job ignores it
ended = threading.Event()
def press():
    while not pathlib.Path("ctrl", "job.rst").exists() and not ended.is_set():
        time.sleep(0.0002)
    if not ended.is_set():
        os.kill(os.getpid(), signal.SIGINT)
for attempt in range(200):        # a busy machine may let the run end first
    ended.clear()
    presser = threading.Thread(target=press)
    presser.start()
    try:
        lopin.run("job.inp", "ctrl")
    except KeyboardInterrupt as problem:
        assert "E0605" in str(problem) and "resume" in str(problem), problem
        break
    ended.set()
    presser.join()
else:
    sys.exit(3)
assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
try:
    os.kill(os.getpid(), signal.SIGINT)
    time.sleep(1.0)
except KeyboardInterrupt:
    sys.exit(7)
"""
    done = python("-c", code, cwd=bench.place)
    assert done.returncode == 7, done.stderr
    (bench.place/"ctrl"/"job.inp").unlink(missing_ok=True)
    if bench.files("ctrl").keys() & {"job.rst"}:
        bench.goes_on("ctrl")
