"""The first ten minutes of somebody new: every command of the way, and what it shows."""
import os
import shutil
import subprocess
import sys
from pathlib import Path

import lopin
import pytest


@pytest.fixture(scope="module")
def type_(executable, tmp_path_factory):
    """A shell in an empty folder; gives the exit code and all that was said."""
    place = tmp_path_factory.mktemp("new")
    environment = os.environ | {"LOPIN_EXECUTABLE": str(executable), "MPLBACKEND": "Agg",
                                "PYTHONPATH": str(Path(lopin.__file__).parent.parent)}

    def typed(*words, program=("-m", "lopin")):
        done = subprocess.run([sys.executable, *program, *words], cwd=place, env=environment,
                              capture_output=True, text=True, timeout=120)
        return done.returncode, done.stdout + done.stderr
    typed.place = place
    typed.example = typed("example", "hertz_sphere", ".")
    return typed


def test_a_look_at_what_is_installed(type_):
    code, said = type_("info")
    assert code == 0 and said.startswith("lopin 0.") and "cholmod" in said
    code, said = type_("selftest")
    assert code == 0 and "selftest passed" in said and len(said.splitlines()) >= 10


def test_from_the_example_to_its_pictures(type_):
    assert type_.example[0] == 0 and "next: lopin check" in type_.example[1]
    code, said = type_("check", "hertz_sphere.inp")
    assert code == 0 and "gaps from" in said and "no error" in said
    code, said = type_("run", "hertz_sphere.inp", "-o", "out")
    assert code == 0 and "certificate: PASS" in said and "lopin report out" in said
    code, said = type_("plot", "out", "--terminal")
    assert code == 0 and "largest 279" in said
    code, said = type_("report", "out")
    page = (type_.place/"out"/"report.html").read_text()
    assert code == 0 and "out/report.html" in said and "http" not in page.split("<body")[0]
    pvd = (type_.place/"out"/"hertz_sphere.pvd").read_text()
    assert pvd.count("part=") >= 2                     # the piece and its contact


def test_a_misspelt_keyword_is_told_with_its_place(type_):
    text = (type_.place/"hertz_sphere.inp").read_text()
    (type_.place/"typo.inp").write_text(text.replace("*SURFACE BEHAVIOR", "*SURFACE BEHAVIOUR"))
    code, said = type_("check", "typo.inp")
    assert code == 1 and said.count("error[") == 1 and "error[E0101]" in said
    assert "did you mean *SURFACE BEHAVIOR" in said and "--> typo.inp:" in said
    code, said = type_("explain", "E0101")
    assert code == 0 and said.startswith("E0101")


def test_a_penalty_beside_the_exact_answer(type_):
    text = (type_.place/"hertz_sphere.inp").read_text()
    assert "BEHAVIOR, DIRECT" in text
    (type_.place/"soft.inp").write_text(text.replace("BEHAVIOR, DIRECT", "BEHAVIOR, PENALTY"))
    for deck in ("hertz_sphere.inp", "soft.inp"):
        assert type_("run", deck, "--quiet") == (0, "")
    code, said = type_("report", "out/hertz_sphere", "--compare", "out/soft", "-o", "both.html")
    page = (type_.place/"both.html").read_text()
    assert code == 0 and "penalty" in page and "lagrange" in page


def test_the_same_from_python_and_a_mesh_of_ones_own(type_, root):
    code, said = type_(program=(str(root/"decks"/"hertz_sphere.py"),))
    assert code == 0 and "pressure 280.9" in said
    shutil.copy(root/"docs"/"tutorials"/"part.msh", type_.place)
    code, said = type_("convert", "part.msh", "part.inp")
    assert code == 0 and "elements: C3D10, 3d" in said and "next: *INCLUDE" in said
