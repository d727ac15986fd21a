"""The tutorials of docs/tutorials.md, typed as they stand."""
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import lopin
import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT/"docs"/"tutorials.md").read_text(encoding="utf-8")
BOX = re.compile(r"^```(\w+)(?: (\S+))?\n(.*?)^```$", re.M | re.S)
TUTORIALS = re.split(r"^## (?=\d)", PAGE, flags=re.M)[1:]


@pytest.fixture
def shell(executable, tmp_path):
    """A folder and a shell in which `lopin` and `python` are those of this tree."""
    programs = tmp_path/"programs"
    programs.mkdir()
    for name, words in (("lopin", "-m lopin"), ("python", "")):
        (programs/name).write_text(f'#!/bin/sh\nexec "{sys.executable}" {words} "$@"\n')
        (programs/name).chmod(0o755)
    place = tmp_path/"work"
    place.mkdir()
    shutil.copy(ROOT/"docs"/"tutorials"/"part.msh", place)
    environment = os.environ | {
        "PATH": f"{programs}:{os.environ['PATH']}", "LOPIN_EXECUTABLE": str(executable),
        "PYTHONPATH": str(Path(lopin.__file__).parent.parent), "MPLBACKEND": "Agg"}

    def run(commands):
        done = subprocess.run(["bash", "-e", "-c", commands], cwd=place, env=environment,
                              capture_output=True, text=True, timeout=300)
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout + done.stderr
    run.place = place
    return run


def test_there_are_five():
    assert len(TUTORIALS) == 5 and all("```sh" in text for text in TUTORIALS)


@pytest.mark.parametrize("text", TUTORIALS, ids=lambda text: text.split("\n")[0])
def test_what_is_typed_gives_what_is_seen(text, shell):
    said = ""
    for box in BOX.finditer(text):
        kind, name, content = box.groups()
        if name:
            (shell.place/name).write_text(content)
        elif kind == "sh":
            said = shell(content)
        elif kind == "text" and text[:box.start()].rstrip().endswith("\nsees"):
            for line in content.splitlines():
                assert line in said, f"{line!r} is not in what was said:\n{said}"


def test_the_mesh_that_comes_along_is_that_of_the_page():
    gmsh = pytest.importorskip("gmsh")
    geo = next(box[3] for box in BOX.finditer(PAGE) if box[2] == "part.geo")
    assert "Physical Volume" in geo and gmsh.__version__


def test_the_lines_that_let_go_are_those_of_the_deck():
    shown = next(box[3] for box in BOX.finditer(PAGE) if "NAME=OPEN" in box[3])
    deck = iter((ROOT/"decks"/"cup.inp").read_text().splitlines())
    assert all(line in deck for line in shown.splitlines())
