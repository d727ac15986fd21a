"""lopin export: decks that CalculiX and Abaqus read; CalculiX runs them where it is installed."""
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import lopin
from lopin.deck import Deck
from lopin.export import export

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT/"tests"/"benchmarks"))
from other_decks import frd_blocks  # noqa: E402

BLOCKS = """*NODE, NSET=ALL
1, 0., 0., 0.
2, 1., 0., 0.
3, 1., 1., 0.
4, 0., 1., 0.
5, 0., 0., 1.
6, 1., 0., 1.
7, 1., 1., 1.
8, 0., 1., 1.
11, 0., 0., 1.
12, 1., 0., 1.
13, 1., 1., 1.
14, 0., 1., 1.
15, 0., 0., 2.
16, 1., 0., 2.
17, 1., 1., 2.
18, 0., 1., 2.
*ELEMENT, TYPE=C3D8I, ELSET=LOW
1, 1, 2, 3, 4, 5, 6, 7, 8
*ELEMENT, TYPE=C3D8I, ELSET=UP
2, 11, 12, 13, 14, 15, 16, 17, 18
*NSET, NSET=FOOT
1, 2, 3, 4
*NSET, NSET=HEAD
15, 16, 17, 18
*NSET, NSET=UPPER, GENERATE
11, 18
*MATERIAL, NAME=M
*ELASTIC
1000., 0.3
*SOLID SECTION, ELSET=LOW, MATERIAL=M
*SOLID SECTION, ELSET=UP, MATERIAL=M
*SURFACE, NAME=UP.DOWN
UP, S1
*SURFACE, NAME=LOW.TOP
LOW, S2
*LOPIN, SOLVER=SKYLINE
*SURFACE INTERACTION, NAME=I
*SURFACE BEHAVIOR, PENALTY
1.E5
*FRICTION
0.2, 3.E4
*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE
UP.DOWN, LOW.TOP
*BOUNDARY
FOOT, 1, 3
ALL, 2
*STEP
*STATIC
1., 1.
*BOUNDARY
HEAD, 3, 3, -0.02
HEAD, 1, 1, 0.
*NODE FILE
U
*CONTACT FILE
CDIS, CSTR
*END STEP
"""
STRIP = """*NODE
1, 0., 0.
2, 2., 0.
3, 4., 0.
4, 0., 1.
5, 2., 1.
6, 4., 1.
900, 2., 9.
*NSET, NSET=REF
900
*NSET, NSET=FOOT
1, 2, 3
*ELEMENT, TYPE=CPS4, ELSET=BODY
1, 1, 2, 5, 4
2, 2, 3, 6, 5
*MATERIAL, NAME=M
*ELASTIC
1000., 0.
*SOLID SECTION, ELSET=BODY, MATERIAL=M
2.,
*SURFACE, NAME=TOP
BODY, S3
*SURFACE, NAME=PUNCH, TYPE=SEGMENTS
START, 5., 1.
LINE, -1., 1.
*RIGID BODY, ANALYTICAL SURFACE=PUNCH, REF NODE=900
*SURFACE INTERACTION, NAME=I
*SURFACE BEHAVIOR, PENALTY
1.E5
*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE
TOP, PUNCH
*BOUNDARY
FOOT, 1, 2
REF, 1
REF, 6
*STEP
*STATIC
1., 1.
*BOUNDARY
REF, 2, 2, -0.01
*NODE PRINT, NSET=REF
RF
*NODE FILE
U
*END STEP
"""
SPRING = STRIP.replace("*BOUNDARY\nFOOT", "*ELEMENT, TYPE=SPRINGA, ELSET=W\n9, 1, 5\n*SPRING, ELSET=W\n\n"
                       "400.\n*BOUNDARY\nFOOT")
#: Its profile goes on beyond the axis, round a small edge, and is pushed at a speed.
DISC = (STRIP.replace("CPS4", "CAX4").replace("START, 5., 1.\n", "START, 4.7, 3.\nLINE, 4.7, 1.2\n"
                                              "CIRCL, 4.5, 1., 4.5, 1.2\n")
        .replace("1., 1.\n*BOUNDARY\nREF, 2, 2, -0.01", "2., 2.\n*BOUNDARY, TYPE=VELOCITY\n"
                 "REF, 2, 2, -0.005"))


def frames(path):
    return frd_blocks(path)["DISP"]


def last(frame):
    return frame[max(frame)]


def differ(one, other):
    """Largest difference of displacements at nodes of both, beside the largest one."""
    nodes = sorted(set(one) & set(other))
    a, b = (np.array([frame[n] for n in nodes]) for frame in (one, other))
    return np.abs(a - b).max()/np.abs(a).max()


needs_ccx = pytest.mark.skipif(shutil.which("ccx") is None, reason="ccx is not installed")


@needs_ccx
@pytest.mark.parametrize("text", [BLOCKS, STRIP, DISC, SPRING],
                         ids=["blocks", "rigid profile", "profile about an axis", "spring"])
def test_calculix_reads_them_and_finds_the_same(tmp_path, text):
    (tmp_path/"job.inp").write_text(text)
    lopin.run(tmp_path/"job.inp", output=tmp_path/"out")
    export(Deck.read(tmp_path/"job.inp"), "ccx").write(tmp_path/"theirs.inp")
    done = subprocess.run(["ccx", "theirs"], cwd=tmp_path, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0 and "*ERROR" not in done.stdout, done.stdout[-2000:]
    ours, theirs = (last(frames(path)) for path in (tmp_path/"out"/"job.frd", tmp_path/"theirs.frd"))
    assert differ(ours, theirs) < 5e-3


@needs_ccx
@pytest.mark.parametrize("name", ["shrink_fit", "two_springs"])
def test_calculix_runs_decks_of_the_collection(tmp_path, name):
    lopin.run(ROOT/"decks"/f"{name}.inp", output=tmp_path/"out")
    export(Deck.read(ROOT/"decks"/f"{name}.inp"), "ccx").write(tmp_path/"theirs.inp")
    done = subprocess.run(["ccx", "theirs"], cwd=tmp_path, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stdout[-2000:]
    ours, theirs = (last(frames(path)) for path in (tmp_path/"out"/f"{name}.frd",
                                                    tmp_path/"theirs.frd"))
    assert differ(ours, theirs) < 1e-2


#: Cards of Abaqus that these decks may have.
ABAQUS = {"NODE", "ELEMENT", "NSET", "ELSET", "MATERIAL", "ELASTIC", "SOLID SECTION", "SURFACE",
          "SURFACE INTERACTION", "SURFACE BEHAVIOR", "FRICTION", "CONTACT PAIR", "BOUNDARY", "STEP",
          "STATIC", "NODE FILE", "NODE PRINT", "CONTACT FILE", "END STEP", "RIGID BODY", "HEADING",
          "SPRING", "EL FILE", "CLEARANCE", "DSLOAD", "DLOAD", "CLOAD", "PLASTIC", "AMPLITUDE"}


@pytest.mark.parametrize("text", [BLOCKS, STRIP, DISC, SPRING],
                         ids=["blocks", "rigid profile", "profile about an axis", "spring"])
def test_decks_for_abaqus_have_its_cards_and_the_same_answer(tmp_path, text):
    (tmp_path/"job.inp").write_text(text)
    ours = lopin.run(tmp_path/"job.inp", output=tmp_path/"out")
    deck = export(Deck.read(tmp_path/"job.inp"), "abaqus")
    assert {block.keyword for block in deck.blocks} <= ABAQUS
    assert not any("." in str(b.parameters.get("NAME", "")) for b in deck.blocks)
    deck.write(tmp_path/"theirs.inp")
    theirs = lopin.run(tmp_path/"theirs.inp", output=tmp_path/"again")
    assert np.allclose(ours["U"], theirs["U"], rtol=1e-6, atol=1e-9)


def test_one_file_has_the_includes(tmp_path):
    deck = export(Deck.read(ROOT/"decks"/"shrink_fit.inp"), "flat")
    assert "INCLUDE" not in deck
    deck.write(tmp_path/"flat.inp")
    ours = lopin.run(ROOT/"decks"/"shrink_fit.inp", output=tmp_path/"out")
    assert (lopin.run(tmp_path/"flat.inp", output=tmp_path/"flat")["U"] == ours["U"]).all()


@pytest.mark.parametrize("name, target, what", [
    ("ring_compression", "ccx", "LAW=TRESCA"), ("ring_compression", "abaqus", "LAW=TRESCA"),
    ("cup", "ccx", "a force moves"), ("square_cup", "ccx", "in space")])
def test_what_has_no_counterpart_is_refused(name, target, what):
    with pytest.raises(lopin.UsageError, match=what):
        export(Deck.read(ROOT/"decks"/f"{name}.inp"), target)


def test_the_command_says_what_it_changed(tmp_path, monkeypatch, capsys):
    from lopin.__main__ import main

    monkeypatch.chdir(tmp_path)
    Path("job.inp").write_text(BLOCKS)
    assert main(["export", "job.inp", "--ccx"]) == 0
    said = capsys.readouterr().out
    assert "job_ccx.inp" in said and "*LOPIN is left out" in said
    assert Path("job_ccx.inp").read_text().startswith("** written by Lopin for CalculiX")
    assert main(["export", "job.inp", "--flat", "-o", "job.inp"]) == 2
