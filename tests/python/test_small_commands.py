"""lopin info of a folder, lopin plot --terminal, words that a command does not take, loads that are
known and not there."""
import json
import os
import subprocess
from pathlib import Path

import lopin
import pytest
from lopin.__main__ import main

# A block on a soft table; a tool presses it and withdraws.
PRESSED = """*NODE
1, 0., 0.
2, 1., 0.
3, 1., 1.
4, 0., 1.
9, 0., 2.
*ELEMENT, TYPE=CPE4, ELSET=BLOCK
1, 1, 2, 3, 4
*SOLID SECTION, ELSET=BLOCK, MATERIAL=M
1.,
*MATERIAL, NAME=M
*ELASTIC
1000., 0.
*SURFACE, NAME=TOP
1, S3
*SURFACE, NAME=RAM, TYPE=SEGMENTS
START, 9., 1.
LINE, -9., 1.
*RIGID BODY, ANALYTICAL SURFACE=RAM, REF NODE=9
*SURFACE INTERACTION, NAME=SOFT
*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR
1000., 0.
*CONTACT PAIR, INTERACTION=SOFT
TOP, RAM
*BOUNDARY
1, 1, 2
2, 2
4, 1
9, 1
9, 6
*AMPLITUDE, NAME=PULSE
0., 0., 0.5, 1., 1., -0.1
*STEP
*STATIC
0.1, 1., 0.1, 0.1
*BOUNDARY, AMPLITUDE=PULSE
9, 2, 2, -0.2
*OUTPUT, FIELD, FREQUENCY=1
*END STEP
"""


@pytest.fixture
def withdrawn(executable, tmp_path, monkeypatch):
    """A run in out/job of the present folder, and what it said."""
    monkeypatch.chdir(tmp_path)
    (tmp_path/"job.inp").write_text(PRESSED)
    return subprocess.run([executable, "run", "job.inp"], capture_output=True, text=True)


def test_the_most_of_a_run_is_told_where_nothing_is_left_at_its_end(withdrawn):
    run = lopin.open_result("out/job")
    pair = run.summary["contact"][0]
    forces = run.history["TOP-RAM.force2"]
    most = int(abs(forces).argmax())
    assert forces[-1] == 0.0 and most < len(forces) - 1
    assert pair["closed"] == 0 and pair["peak"]["force"] == pytest.approx(abs(forces[most]))
    assert pair["peak"]["increment"] == pair["peak"]["pressure_increment"] == most + 1
    line = next(line for line in withdrawn.stdout.splitlines() if line.startswith("TOP-RAM"))
    assert "open at the end; largest force of the run 100" in line, line
    assert f"step 1, increment {most + 1}" in line


def test_the_worst_increment_is_the_one_furthest_beyond_its_limit(withdrawn):
    certificate = lopin.open_result("out/job").summary["certificate"]
    assert certificate["verdict"] == "WARN" and certificate["increments_warned"] > 3
    assert certificate["increment"] == 5
    assert f"step 1, increment {certificate['increment']}: " in withdrawn.stdout


def test_a_plot_at_a_time_and_at_the_peak(withdrawn, capsys):
    largest = "pressure against x, largest"
    for words, says in (("0.29", f"{largest} 60"), ("peak", f"{largest} 100"),
                        ("end", "nothing is pressed")):
        assert main(["plot", "job", "--terminal", "--time", words]) == 0
        assert capsys.readouterr().out.startswith(f"TOP-RAM: {says}")
    assert main(["plot", "job", "--time", "noon"]) == 2
    assert "a number, end or peak" in capsys.readouterr().err


def test_a_run_is_found_by_its_name(withdrawn, capsys):
    for name in ("job", "job.inp", "out/job"):
        assert main(["report", name]) == 0
        assert "out/job/report.html" in capsys.readouterr().out
    assert main(["report", "jib"]) == 5
    assert "results here: out/job" in capsys.readouterr().err


def test_a_geometry_is_no_mesh(tmp_path, capsys):
    (tmp_path/"x.geo").write_text("Point(1) = {0, 0, 0};")
    assert main(["convert", str(tmp_path/"x.geo"), str(tmp_path/"x.inp")]) == 5
    said = capsys.readouterr().err
    assert "geometry without a mesh" in said and "gmsh -2" in said


def test_a_run_in_a_few_lines(executable, tmp_path, root, capsys):
    subprocess.run([executable, "run", root/"decks"/"hertz_sphere.inp", "-o", tmp_path/"out"],
                   check=True, capture_output=True)
    assert main(["info", str(tmp_path/"out")]) == 0
    said = capsys.readouterr().out
    assert "hertz_sphere: finished" in said and "certificate: PASS" in said
    assert "largest pressure 279" in said and "lopin report" in said


def test_a_plot_of_characters(executable, tmp_path, root, capsys):
    subprocess.run([executable, "run", root/"decks"/"hertz_sphere.inp", "-o", tmp_path/"out"],
                   check=True, capture_output=True)
    assert main(["plot", str(tmp_path/"out"), "--terminal"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert "largest 279" in lines[0] and len(lines) == 19
    columns = [max(line.find("●"), line.find("*")) for line in lines[1:17]]
    seen = [c for c in columns if c > 0]
    assert len(seen) > 6 and max(len(line) for line in lines) < 90


def test_selftest_takes_no_word(executable):
    done = subprocess.run([executable, "selftest", "x"], capture_output=True, text=True)
    assert done.returncode == 2 and "one word too many" in done.stderr


def test_one_schema(executable, tmp_path, root):
    done = subprocess.run([executable, "run", root/"decks"/"bar_gap.inp", "-o", tmp_path/"out",
                           "--json"], capture_output=True, text=True, check=True)
    said, file = json.loads(done.stdout), json.loads((tmp_path/"out"/"bar_gap.json").read_text())
    assert said["schema"] == file["schema"] and said["status"] == file["status"] == "finished"


def test_centrifugal_loads_are_refused_by_name(executable, tmp_path, root):
    text = (root/"decks"/"bar_gap.inp").read_text()
    (tmp_path/"job.inp").write_text(text.replace("*CLOAD", "*DLOAD\nBAR, CENTRIF, 100., 0., 0., 0., 0., 0., 1.\n*CLOAD", 1))
    done = subprocess.run([executable, "check", tmp_path/"job.inp"], capture_output=True, text=True)
    assert done.returncode == 1 and done.stderr.count("error[") == 1 and "E0108" in done.stderr


@pytest.mark.skipif(not Path("/proc/cpuinfo").is_file(), reason="asks Linux for the processor")
def test_the_blas_uses_what_the_processor_has(executable):
    """An OpenBLAS that does not know the processor falls back to instructions of 2004."""
    def kernel(**said):
        free = {k: v for k, v in os.environ.items() if k != "OPENBLAS_CORETYPE"}
        out = subprocess.run([executable, "info"], check=True, capture_output=True, text=True,
                             env=free | said).stdout
        return out.split("kernel of the BLAS: ")[1].splitlines()[0]

    flags = Path("/proc/cpuinfo").read_text().split("flags", 1)[-1].split("\n")[0].split()
    if "avx2" in flags and "fma" in flags:
        assert not kernel().startswith("Prescott")
    if "ssse3" in flags and kernel():
        assert kernel(OPENBLAS_CORETYPE="Prescott") == "Prescott"
