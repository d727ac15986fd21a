"""Runs that fail: where they stood, and what to try in that scene; words that were mistyped."""
import json
import os
import subprocess
import sys
from pathlib import Path

import lopin
import pytest

BAR = """*HEADING
bar, N mm
*NODE, NSET=ALL
1, 0., 0.
2, 10., 0.
3, 20., 0.
4, 0., 10.
5, 10., 10.
6, 20., 10.
*ELEMENT, TYPE=CPE4, ELSET=E
1, 1, 2, 5, 4
2, 2, 3, 6, 5
*NSET, NSET=LEFT
1, 4
*NSET, NSET=RIGHT
3, 6
*MATERIAL, NAME=METAL
*ELASTIC
210000., 0.3
*PLASTIC
250., 0.
{hardening}*SOLID SECTION, ELSET=E, MATERIAL=METAL
1.
*BOUNDARY
LEFT, 1, 1
1, 2, 2
*STEP, NLGEOM
*STATIC{direct}
{increments}
*{load}
*END STEP
"""


@pytest.fixture
def fails(executable, tmp_path):
    """What a run that ends with exit code 3 says, and its summary."""
    def run(**words):
        words = {"hardening": "", "direct": "", "increments": "0.1, 1.",
                 "load": "CLOAD\nRIGHT, 1, 2000."} | words
        (tmp_path/"bar.inp").write_text(BAR.format(**words))
        done = subprocess.run([executable, "run", "bar.inp", "-o", "out"], cwd=tmp_path,
                              capture_output=True, text=True)
        assert done.returncode == 3, done.stderr
        return done.stdout + done.stderr, json.loads((tmp_path/"out"/"bar.json").read_text())
    return run


def test_a_load_beyond_the_limit_load_is_named(fails):
    said, summary = fails()
    error, = (d for d in summary["diagnostics"] if d["severity"] == "error")
    assert error["code"] == "E0510" and "most at node" in error["message"]
    assert "METAL does not harden" in error["help"] and "smaller increments" not in error["help"]
    # In plane strain a bar bears 2/sqrt(3) times the yield stress: 2886.8 of 4000 N.
    assert "step 1 has come to time 0.72" in said or "step 1 has come to time 0.71" in said
    said, _ = fails(hardening="251., 10.\n", load="CLOAD\nRIGHT, 1, 20000.")
    assert "forces drive this step" in said and "smaller increments" not in said


def test_who_forbids_shorter_increments_is_told_so(fails):
    said, _ = fails(increments="0.1, 1., 0.05")
    assert "the third number of *STATIC, 0.05" in said and "smaller increments" not in said
    said, _ = fails(direct=", DIRECT", increments="0.5, 1.")
    assert "leave DIRECT out of *STATIC" in said


def test_elements_pressed_through_themselves_are_no_matter_of_increments(fails):
    said, _ = fails(load="BOUNDARY\nRIGHT, 1, 1, -21.", hardening="500., 1.\n")
    # Where it ends is a matter of rounding: a singular tangent, an element inside out, INC=100.
    assert "smaller increments" not in said and "drive by displacement" not in said


def test_a_run_that_fails_at_once_ends_with_its_summary(fails):
    said, _ = fails(direct=", DIRECT", increments="1., 1.")
    assert "no increment was found; its iterations are in out/bar.cvg" in said
    assert "MiB; 0 increments" in said


@pytest.mark.parametrize("words, code, said", [
    ("run bar", 5, "did you mean bar.inp?"),
    ("run .", 5, "lopin report . shows the results"),
    ("rnu bar.inp", 2, "did you mean run?"),
    ("explain 101", 2, "there is E0101"),
    ("run bar.inp --solver pardiso", 1, "solvers: cholmod"),
    ("report bar.inp", 5, "lopin run bar.inp, then lopin report out/bar"),
    ("example hertz", 2, "did you mean hertz_sphere"),
    ("example hertz_sphere bar.inp/x", 5, "cannot make the folder"),
])
def test_a_mistyped_word_is_told_what_was_meant(words, code, said, executable, tmp_path):
    (tmp_path/"bar.inp").write_text(BAR.format(hardening="", direct="", increments="1., 1.",
                                               load="CLOAD\nRIGHT, 1, 1."))
    environment = os.environ | {"LOPIN_EXECUTABLE": str(executable),
                                "PYTHONPATH": str(Path(lopin.__file__).parent.parent)}
    done = subprocess.run([sys.executable, "-m", "lopin", *words.split()], cwd=tmp_path,
                          capture_output=True, text=True, env=environment)
    assert done.returncode == code and said in done.stderr, done.stderr
    assert done.stderr.count("error") == 1 and "Traceback" not in done.stderr
    assert "no increment" not in done.stdout + done.stderr
