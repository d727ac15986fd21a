"""Runs that are killed, interrupted or damaged: what goes on ends with the bits of a run left
alone, what cannot is refused."""
import json
import random
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import lopin
from faceted_die import pressed
from test_cut_back import pulled
from test_friction_laws import block
from test_contact_candidates import crown

sys.path.insert(0, str(Path(__file__).resolve().parents[2]/"decks"/"make"))
import sliding  # noqa: E402

NX, NY = 8, 4


def billet(words: str = "", law: str = "*FRICTION\n0.2,", method: str = "DIRECT",
           nlgeom: str = ", NLGEOM", path: str = "",
           pair: str = "", changes: bool = True, steps: tuple = (0.05, 0.1), pressure: str = "",
           floor: str = "START, -10., 0.\nLINE, 20., 0.") -> str:
    """A block pressed on a floor, dragged along it, let go by *MODEL CHANGE and pressed again."""
    node = [(1 + i + (NX + 1)*j, i*0.5, j*0.5) for j in range(NY + 1) for i in range(NX + 1)]
    element = [(1 + i + NX*j, *(1 + i + k % 2 + (NX + 1)*(j + k // 2) for k in (0, 1, 3, 2)))
               for j in range(NY) for i in range(NX)]
    text = path + "*NODE\n" + "".join(f"{n}, {x!r}, {y!r}\n"
                                      for n, x, y in node) + "999, 0., 0.\n*ELEMENT, TYPE=CPE4, ELSET=BODY\n"
    text += "".join(", ".join(map(str, e)) + "\n" for e in element)
    top, right = (NX + 1)*NY + 1, NX
    text += f"""*NSET, NSET=TOP, GENERATE
{top}, {top + NX}
*ELSET, ELSET=BOTTOM, GENERATE
1, {NX}
*ELSET, ELSET=SIDE, GENERATE
{right}, {NX*NY}, {NX}
*SURFACE, NAME=FOOT
BOTTOM, S1
*SURFACE, NAME=FLOOR, TYPE=SEGMENTS
{floor}
*RIGID BODY, ANALYTICAL SURFACE=FLOOR, REF NODE=999
*MATERIAL, NAME=METAL
*ELASTIC
1000., 0.3
{words}*SOLID SECTION, ELSET=BODY, MATERIAL=METAL
1.,
*SURFACE INTERACTION, NAME=GREASE
*SURFACE BEHAVIOR, {method}
{law}
*CONTACT PAIR, INTERACTION=GREASE{pair}
FOOT, FLOOR
*BOUNDARY
999, 1, 2
999, 6
*AMPLITUDE, NAME=WAVE
0., 0., 0.4, 1., 1., 0.3
"""
    output = "*NODE PRINT, NSET=TOP, TOTALS=YES\nU, RF\n*EL PRINT, ELSET=BOTTOM\nS, E\n*NODE FILE\nU, RF\n*EL FILE\nS\n*CONTACT FILE\nCDIS, CSTR\n"
    first, later = steps

    def step(increment, boundary, change=""):
        return (f"*STEP, INC=500{nlgeom}\n*STATIC\n{increment!r}, 1., 1.E-6, {2*increment!r}\n{change}*BOUNDARY\nTOP, 1, 1, {boundary[0]!r}\n"
                f"TOP, 2, 2, {boundary[1]!r}\n{output}*END STEP\n")

    text += step(first, (0.0, -0.02), pressure)
    text += step(later, (0.2, -0.02))
    if changes:
        text += step(later, (0.2, 0.05), "*MODEL CHANGE, TYPE=CONTACT PAIR, REMOVE\nFOOT, FLOOR\n")
        text += step(later, (0.1, -0.03), "*MODEL CHANGE, TYPE=CONTACT PAIR, ADD\nFOOT, FLOOR\n")
    return text


def wall_that_stays() -> str:
    """Metal pressed on a floor and against a wall at its side; the floor is taken away, the wall stays."""
    text = billet(words="*PLASTIC\n5., 0.\n20., 1.\n", steps=(0.1, 0.2), method="PENALTY\n1.E4,",
                  law="*FRICTION\n0.05,")
    text = text.replace("999, 0., 0.\n", "999, 0., 0.\n998, 4., 0.\n", 1)
    text = text.replace("REF NODE=999\n", """REF NODE=999
*SURFACE, NAME=FLANK
SIDE, S2
*SURFACE, NAME=WALL, TYPE=SEGMENTS
START, 4., -5.
LINE, 4., 10.
*RIGID BODY, ANALYTICAL SURFACE=WALL, REF NODE=998
""", 1)
    text = text.replace("FOOT, FLOOR\n*BOUNDARY\n", "FOOT, FLOOR\n*CONTACT PAIR, INTERACTION=GREASE\n"
                        "FLANK, WALL\n*BOUNDARY\n998, 1, 2\n998, 6\n", 1)
    text = "*STEP".join(text.split("*STEP")[:4])
    return text.replace("TOP, 1, 1, 0.2", "TOP, 1, 1, 0.03").replace("TOP, 2, 2, 0.05", "TOP, 2, 2, -0.015")


def behaviours() -> str:
    """The slope of the contact changes, then hard contact takes its place; friction goes on."""
    words = iter(["*SURFACE BEHAVIOR, PENALTY\n2.E4,\n", "*SURFACE BEHAVIOR, DIRECT\n"])
    return re.sub(r"\*MODEL CHANGE.*\nFOOT, FLOOR\n", lambda _: "*CHANGE SURFACE BEHAVIOR, "
                  f"INTERACTION=GREASE\n{next(words)}", billet(method="PENALTY\n1.E4,"))


def tied() -> str:
    """Two blocks tied by mortar, bent by large rotations."""
    text = re.sub(r"^\*\* expect.*\n", "", deck("two_blocks_mortar"),
                  flags=re.M).replace("TYPE=SURFACE TO SURFACE", "TYPE=SURFACE TO SURFACE, TIED")
    return text.replace("*STEP, NAME=PRESS\n",
                        "*STEP, NAME=PRESS, NLGEOM\n").replace("1., 1.\n*DSLOAD",
                                                               "0.1, 1., 1.E-5, 0.1\n*DSLOAD")


def deck(name: str) -> str:
    folder = Path(__file__).parents[2]/"decks"
    text = (folder/f"{name}.inp").read_text()
    return re.sub(r"INPUT=(\S+)", lambda m: f"INPUT={folder/m[1]}", text)


ROUND = "START, -38., -40.\nCIRCL, 2., 0., 2., -40.\nCIRCL, 42., -40., 2., -40."
PLASTIC = "*PLASTIC\n5., 0.\n8., 0.1\n20., 1.\n"
SHAPED = ("*PLASTIC, HARDENING=COMBINED, DATA TYPE=PARAMETERS\n5., 60., 10.\n*CYCLIC HARDENING, "
          "PARAMETERS\n5., 4., 3.\n*POTENTIAL\n1., 1.2, 0.9, 1., 1., 1.1\n")
SCENES = {
    "condensed friction": lambda: billet(nlgeom="", pair=", SMALL SLIDING", changes=False),
    "penalty": lambda: billet(nlgeom="", pair=", SMALL SLIDING", method="PENALTY", changes=False),
    "augmented": lambda: billet(nlgeom="", method="AUGMENTED LAGRANGE", law="", changes=False),
    "newton": lambda: billet(nlgeom="", law="", path="*LOPIN, PATH=NEWTON\n", changes=False),
    "newton by umfpack": lambda: billet(nlgeom="", law="",
                                        path="*LOPIN, PATH=NEWTON, SOLVER=UMFPACK\n",
                                        changes=False),
    "lagged law": lambda: block("CRISTESCU"),
    "law of speed": lambda: block("NORTON-HOFF"),
    "rows that come late": lambda: crown(False, 0.1, 12, friction="*FRICTION\n0.2\n"),
    "changed to finite": lambda: billet(nlgeom="", law="", changes=False, floor=ROUND),
    "model change": lambda: billet(),
    "model change beside a wall": wall_that_stays,
    "behaviour changes": behaviours,
    "by umfpack": lambda: billet(path="*LOPIN, SOLVER=UMFPACK\n"),
    "mixed penalty": lambda: billet(method="PENALTY"),
    "finite augmented": lambda: billet(method="AUGMENTED LAGRANGE", changes=False),
    "plastic": lambda: billet(PLASTIC),
    "plastic, small strain": lambda: billet(PLASTIC, nlgeom=""),
    "axes and backstress": lambda: billet(SHAPED),
    "axes and backstress, small strain": lambda: billet(SHAPED, nlgeom="", changes=False),
    "following pressure": lambda: billet(pressure="*DLOAD, AMPLITUDE=WAVE\nSIDE, P2, 3.\n*DLOAD\n1, P4, 1.\n"),
    "tied by mortar": tied,
    "die of facets": lambda: pressed("CPE4", 1.57, 0.0, path="FINITE", mu=0.2, slide=3.0).text(),
    "die of facets, condensed": lambda: pressed("CPE4", 1.57, 0.0, mu=0.2, slide=3.0).text(),
    "self-contact": lambda: sliding.crushed_ring((2, 48)).replace("0.02, 1., 1.E-6, 0.02",
                                                                  "0.04, 1., 1.E-6, 0.04"),
    "large rotation": lambda: deck("elastica"),
    "cut back and stopped": lambda: pulled(0.4),
}


class Bench:
    """Runs one deck in folders of one place."""

    def __init__(self, executable, place, text):
        self.executable, self.place = executable, place
        (place/"job.inp").write_text(text)

    def start(self, folder, *options):
        return subprocess.Popen([self.executable, "run", "job.inp", "-o", folder, *options],
                                stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE, text=True, cwd=self.place)

    def run(self, folder, *options):
        process = self.start(folder, *options)
        out, err = process.communicate(timeout=120)
        return process.returncode, out + err

    def increments(self, folder):
        try:
            return (self.place/folder/"job.sta").read_text().count("\n") - 2
        except OSError:
            return 0

    def kill_after(self, folder, increments, *options, by=signal.SIGKILL):
        """False if the run ended first."""
        process = self.start(folder, *options)
        while process.poll() is None and self.increments(folder) < increments:
            time.sleep(0.001)
        process.send_signal(by)
        out, err = process.communicate()
        return process.returncode, out + err

    def differences(self, one, other):
        """Names of what differs, but for times; PATH=NEWTON makes its factor again, and counts
        it."""
        a, b = self.place/one, self.place/other
        names = sorted(p.name for p in a.iterdir())
        if names != sorted(p.name for p in b.iterdir()):
            return [p.name for p in b.iterdir() if p.name not in names] + [n for n in names
                                                                           if not (b/n).exists()]
        found = [n for n in names if not n.endswith(".json")
                 and (a/n).read_bytes() != (b/n).read_bytes()]
        left, right = (json.loads((f/"job.json").read_text()) for f in (a, b))
        for job in (left, right):
            for step in job["steps"] if job["path"] == "newton" else ():
                step["factorisations"] = step["back_solves"] = 0
        return found + [k for k in left if k not in ("timing", "peak_memory_mib", "threads")
                        and left[k] != right[k]]


@pytest.fixture
def bench(executable, tmp_path):
    return lambda text: Bench(executable, tmp_path, text)


@pytest.mark.parametrize("name", SCENES)
def test_a_run_killed_again_and_again_ends_with_the_same_bits(bench, name):
    """The whole state is in the checkpoint: nothing else links the four processes."""
    b = bench(SCENES[name]())
    code, said = b.run("alone")
    assert code == (3 if "stopped" in name else 0), said
    total = b.increments("alone")
    assert total >= 4, "too few increments to break off"
    killed = 0
    options = ()
    for share in (0.1, 0.45, 0.8):
        killed += b.kill_after("broken", max(1, round(share*total)), *options)[0] == -signal.SIGKILL
        options = ("--resume",)
    again, said = b.run("broken", "--resume")
    assert again == code, said
    assert killed > 0
    assert b.differences("alone", "broken") == []


def test_changing_to_the_finite_path_is_kept(bench):
    """The scene of that name does change on its way."""
    b = bench(SCENES["changed to finite"]())
    b.run("alone")
    log = (b.place/"alone"/"job.cvg").read_text()
    assert "path condensed" in log and "a node slides by more than a quarter" in log


def test_rows_that_come_late_are_kept(bench):
    """In the scene of that name more points do come within reach on the way."""
    b = bench(SCENES["rows that come late"]())
    b.run("alone")
    assert "more slave points come within reach" in (b.place/"alone"/"job.cvg").read_text()


@pytest.mark.parametrize("name", ["condensed friction", "plastic"])
def test_six_runs_killed_at_random_moments(bench, name):
    """With both scenes twelve; the moments are other ones in every session, and said if one
    fails."""
    b = bench(SCENES[name]().replace("0.05, 1.",
                                     "0.02, 1.").replace("0.1, 1.",
                                                         "0.02, 1.").replace("0.2\n*BOUND",
                                                                             "0.02\n*BOUND"))
    begun = time.perf_counter()
    assert b.run("alone")[0] == 0
    span = time.perf_counter() - begun
    seed = random.randrange(10**6)
    moments = random.Random(seed)
    killed = 0
    for trial in range(40):
        folder = f"broken{trial}"
        process = b.start(folder)
        wait = moments.uniform(0.0, span)
        time.sleep(wait)
        process.kill()
        process.communicate()
        killed += process.returncode == -signal.SIGKILL
        # A run that ended sooner: the others are no longer than it.
        span = min(span, wait) if process.returncode == 0 else span
        code, said = b.run(folder, "--resume")
        assert code == 0, said
        assert b.differences("alone",
                             folder) == [], f"seed {seed}, trial {trial}, killed after {wait:.4f} s of {span:.4f} s"
        if killed == 6:
            return
    raise AssertionError(f"only {killed} runs were still going when they were killed")


def test_a_signal_ends_the_increment_and_says_how_to_go_on(bench):
    b = bench(billet(steps=(0.01, 0.01)))
    assert b.run("alone")[0] == 0
    code, said = b.kill_after("broken", 5, by=signal.SIGTERM)
    assert code == 130 and "E0605" in said and "--resume" in said, said
    assert json.loads((b.place/"broken"/"job.json").read_text())["status"] == "interrupted"
    assert (b.place/"broken"/"job.rst").exists()
    code, said = b.run("broken", "--resume")
    assert code == 0 and "N0604" in said, said
    assert b.differences("alone", "broken") == []
    assert not (b.place/"broken"/"job.rst").exists(), "a finished run has nothing to go on from"


def overloaded(frequency: int, cells: int = 5) -> str:
    """A sheet that does not harden, pulled by more than it bears: attempts that fail, for long."""
    n = cells + 1
    corner = [1 + i + n*j for j in range(cells) for i in range(cells)]
    return "\n".join([
        "*NODE", *(f"{1 + i + n*j}, {i}., {j}." for j in range(n) for i in range(n)),
        "*ELEMENT, TYPE=CPS4, ELSET=BAR",
        *(f"{k + 1}, {c}, {c + 1}, {c + n + 1}, {c + n}" for k, c in enumerate(corner)),
        "*NSET, NSET=LEFT, GENERATE", f"1, {1 + n*cells}, {n}",
        "*NSET, NSET=RIGHT, GENERATE", f"{2*n}, {n*cells}, {n}",
        "*MATERIAL, NAME=M", "*ELASTIC", "1000., 0.3", "*PLASTIC", "1., 0.",
        "*SOLID SECTION, ELSET=BAR, MATERIAL=M", "1.", "*BOUNDARY", "1, 1, 2", "LEFT, 1",
        "*STEP, NLGEOM, INC=1000", "*STATIC", "0.1, 1.",
        f"*RESTART, WRITE, FREQUENCY={frequency}", "*CLOAD",
        f"{n}, 1, 0.6", f"{n*n}, 1, 0.6", "RIGHT, 1, 1.2", "*END STEP", ""])


@pytest.mark.parametrize("frequency", [1, 0])
def test_a_signal_is_answered_while_attempts_fail(bench, frequency):
    """At the end of an iteration, not of the increment, which this run never finds; the state of
    the last increment that was accepted is kept, also where the deck keeps none on the way."""
    b = bench(overloaded(frequency))
    process = b.start("broken", "--progress", "json")
    for line in process.stdout:
        if '"cut"' in line:
            break
    process.send_signal(signal.SIGTERM)
    said = process.communicate()[1]
    assert process.returncode == 130 and "error[E0605]: interrupted within an increment" in said
    last = b.increments("broken")
    kept = re.search(r"goes on from increment (\d+) of step 1", said)
    assert kept and int(kept[1]) == last > 0, said
    process = b.start("broken", "--resume", "--progress", "json")
    first = next(line for line in process.stdout if '"attempt"' in line or '"increment"' in line)
    process.kill()
    process.communicate()
    assert json.loads(first)["increment"] == last + 1


@pytest.mark.parametrize("frequency, kept", [(3, 6), (0, 0)])
def test_the_deck_says_how_often(bench, frequency, kept):
    b = bench(billet(steps=(0.01, 0.01),
                     changes=False).replace("*BOUNDARY\nTOP",
                                            f"*RESTART, WRITE, FREQUENCY={frequency}\n*BOUNDARY\nTOP", 1))
    assert b.kill_after("broken", 8)[0] == -signal.SIGKILL
    rst = b.place/"broken"/"job.rst"
    assert rst.exists() == (kept > 0)
    code, said = b.run("broken", "--resume")
    assert code == 0
    number = re.search(r"goes on after increment (\d+) of step 1", said)
    assert (int(number[1]) if number else 0) % 3 == 0 and bool(number) == (kept > 0), said
    assert number is not None or "starts from its beginning" in said


def test_every_increment_is_kept(bench):
    """A line of job.sta comes before the checkpoint of its increment: only that one may be lost."""
    b = bench(billet(steps=(0.01, 0.01), changes=False))
    assert b.kill_after("broken", 8)[0] == -signal.SIGKILL
    seen = b.increments("broken")
    code, said = b.run("broken", "--resume")
    number = re.search(r"goes on after increment (\d+) of step 1", said)
    assert code == 0 and int(number[1]) >= seen - 1, said


def cut(data: bytes) -> bytes:
    return data[:-100]


def flipped(data: bytes) -> bytes:
    return data[:-50] + bytes([data[-50] ^ 1]) + data[-49:]


def foreign(data: bytes) -> bytes:
    return b"another program\n" + data


def another_version(data: bytes) -> bytes:
    head, _, rest = data.split(b"\n", 2)
    return head + b"\n9.9.9\n" + rest


@pytest.mark.parametrize("harm, reason", [(cut, "cut short"), (flipped, "damaged"),
                                          (foreign, "not a checkpoint of Lopin"),
                                          (another_version, "9.9.9"),
                                          (lambda data: b"", "not a checkpoint")])
def test_a_checkpoint_that_is_not_right_is_refused(bench, harm, reason):
    b = bench(billet(steps=(0.01, 0.01)))
    assert b.kill_after("broken", 4)[0] == -signal.SIGKILL
    rst = b.place/"broken"/"job.rst"
    rst.write_bytes(harm(rst.read_bytes()))
    before = {p.name: p.read_bytes() for p in (b.place/"broken").iterdir()}
    code, said = b.run("broken", "--resume")
    assert code == 5 and said.count("error[") == 1 and "E0604" in said and reason in said, said
    assert {p.name: p.read_bytes()
            for p in (b.place/"broken").iterdir()} == before, "nothing is touched"


def test_the_checkpoint_of_another_deck_is_refused(bench):
    """Also where only an included file, or the solver, has changed."""
    text = billet(steps=(0.01, 0.01))
    b = bench(text.replace("1000., 0.3\n", "*INCLUDE, INPUT=steel.inc\n"))
    (b.place/"steel.inc").write_text("1000., 0.3\n")
    assert b.kill_after("broken", 4)[0] == -signal.SIGKILL
    code, said = b.run("broken", "--resume", "--solver", "skyline")
    assert code == 5 and "E0604" in said and "another deck" in said, said
    (b.place/"steel.inc").write_text("1001., 0.3\n")
    code, said = b.run("broken", "--resume")
    assert code == 5 and "E0604" in said and "another deck" in said, said
    (b.place/"steel.inc").write_text("1000., 0.3\n")
    assert b.run("broken", "--resume")[0] == 0


def test_the_unfinished_run_of_another_deck_is_not_replaced(bench):
    """The same deck, changed since, replaces its own run; a deck of the same name elsewhere does
    not."""
    b = bench(billet(steps=(0.01, 0.01)))
    assert b.kill_after("broken", 4)[0] == -signal.SIGKILL
    (b.place/"other").mkdir()
    (b.place/"other"/"job.inp").write_text(billet(steps=(0.02, 0.02)))
    before = {p.name: p.read_bytes() for p in (b.place/"broken").iterdir()}

    def other(*options):
        done = subprocess.run([b.executable, "run", "job.inp", "-o", "../broken", *options],
                              capture_output=True, text=True, cwd=b.place/"other", timeout=120)
        return done.returncode, done.stderr

    code, said = other()
    assert code == 5 and "E0601" in said and str(b.place/"job.inp") in said, said
    assert "--overwrite" in said and said.count("error[") == 1
    assert {p.name: p.read_bytes() for p in (b.place/"broken").iterdir()} == before
    assert other("--overwrite")[0] == 0
    assert b.kill_after("again", 4)[0] == -signal.SIGKILL
    (b.place/"job.inp").write_text(billet(steps=(0.02, 0.02)))
    assert b.run("again")[0] == 0, "its own run"


def test_a_result_file_that_was_lost_is_named(bench):
    b = bench(billet(steps=(0.01, 0.01)))
    assert b.kill_after("broken", 4)[0] == -signal.SIGKILL
    (b.place/"broken"/"job_history.csv").write_text("")
    code, said = b.run("broken", "--resume")
    assert code == 5 and "E0606" in said and "job_history.csv" in said, said


def test_a_file_of_others_is_not_replaced(bench):
    b = bench(billet())
    (b.place/"mine").mkdir()
    (b.place/"mine"/"job.rst").write_text("my notes\n")
    code, said = b.run("mine")
    assert code == 5 and "E0603" in said and (b.place/"mine"/"job.rst").read_text() == "my notes\n"


def test_without_a_checkpoint_the_run_starts_from_its_beginning(bench):
    b = bench(billet(changes=False))
    code, said = b.run("first", "--resume")
    assert code == 0 and "N0604" in said
    assert b.run("alone")[0] == 0
    assert b.differences("alone", "first") == []


def test_python_goes_on_with_a_run_of_this_process_that_was_killed(tmp_path, executable):
    """The result of the run that went on is that of the whole run, to the bit."""
    deck = lopin.Deck.parse(billet(changes=False), "job")
    whole = lopin.run(deck)
    deck.write(tmp_path/"job.inp")
    code = "import lopin, sys; lopin.run('job.inp', 'out')"
    process = subprocess.Popen([sys.executable, "-c", code], cwd=tmp_path)
    while process.poll() is None and not (tmp_path/"out"/"job.rst").exists():
        time.sleep(0.001)
    process.kill()
    assert process.wait() == -signal.SIGKILL
    result = lopin.run(deck, tmp_path/"out", resume=True)
    assert result.summary["checksum"] == whole.summary["checksum"]
    assert np.array_equal(result.times, whole.times)
    assert any("goes on after increment" in said["message"] for said in result.diagnostics)
    with pytest.raises(lopin.UsageError, match="output folder"):
        lopin.run(deck, resume=True)
