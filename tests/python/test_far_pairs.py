"""Pairs that are far apart cost a box a look: no query, no projection, and no digit of the
answer."""
import json
import subprocess

import numpy as np
import pytest

FACETS = 10_000


def deck(far, way=-0.01, inc="0.25, 1., 1e-5, 0.25", height=0.0):
    """Two blocks pressed together; a strip of many facets, `height` above the blocks, may meet the
    upper one."""
    text = "*NODE, NSET=ALL\n"
    text += "".join(f"{i + 5*j + 1}, {i/4}, {j/4}\n" for j in range(5) for i in range(5))
    text += "".join(f"{101 + i + 4*j}, {i/3}, {1 + j/3}\n" for j in range(4) for i in range(4))
    text += "*ELEMENT, TYPE=CPE4, ELSET=LOW\n"
    text += "".join(f"{1 + i + 4*j}, {n}, {n + 1}, {n + 6}, {n + 5}\n"
                    for j in range(4) for i in range(4) for n in [1 + i + 5*j])
    text += "*ELEMENT, TYPE=CPE4, ELSET=HIGH\n"
    text += "".join(f"{101 + i + 3*j}, {n}, {n + 1}, {n + 5}, {n + 4}\n"
                    for j in range(3) for i in range(3) for n in [101 + i + 4*j])
    first = 1001
    if far:
        text += "*NODE, NSET=WALL\n"
        for i in range(far + 1):
            x = -4.5 + 10.0*i/far
            text += f"{first + 2*i}, {x}, {2 + height}\n{first + 2*i + 1}, {x}, {2.01 + height}\n"
        text += "*ELEMENT, TYPE=CPE4, ELSET=FAR\n"
        text += "".join(f"{first + i}, {n}, {n + 2}, {n + 3}, {n + 1}\n" for i in range(far)
                        for n in [first + 2*i])
    text += "*MATERIAL, NAME=M\n*ELASTIC\n1000., 0.3\n"
    for body in ["LOW", "HIGH"] + ["FAR"]*bool(far):
        text += f"*SOLID SECTION, ELSET={body}, MATERIAL=M\n1.\n"
    text += "*SURFACE, NAME=UNDER\n101, S1\n102, S1\n103, S1\n*SURFACE, NAME=OVER\n"
    text += "13, S3\n14, S3\n15, S3\n16, S3\n*SURFACE INTERACTION, NAME=DRY\n"
    text += "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD\n"
    text += "*CONTACT PAIR, INTERACTION=DRY, TYPE=NODE TO SURFACE\nUNDER, OVER\n"
    if far:
        text += "*SURFACE, NAME=ROOF\n107, S3\n108, S3\n109, S3\n*SURFACE, NAME=CEILING\nFAR, S1\n"
        text += "*CONTACT PAIR, INTERACTION=DRY, TYPE=NODE TO SURFACE\nROOF, CEILING\n"
    text += "*NSET, NSET=FOOT\n1, 2, 3, 4, 5\n*NSET, NSET=HEAD\n113, 114, 115, 116\n"
    text += f"*STEP, NLGEOM, INC=100\n*STATIC\n{inc}\n*BOUNDARY\nFOOT, 1, 2\nHEAD, 1, 1\nHEAD, 2, 2, {way}\n"
    if far:
        text += "WALL, 1, 2\n"
    return text + "*NODE PRINT, NSET=ALL\nU\n*END STEP\n"


def solve(executable, folder, name, *args, **options):
    (folder/f"{name}.inp").write_text(deck(*args, **options))
    done = subprocess.run([executable, "run", f"{name}.inp", "-o", ".", "--overwrite", "--quiet"],
                          cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    job = json.loads((folder/f"{name}.json").read_text())
    search = {what: sum(step["search"][what] for step in job["steps"])
              for what in ("queries", "projections", "boxes")}
    return job, search


def test_a_far_pair_adds_no_query_and_no_projection(executable, tmp_path):
    alone, without = solve(executable, tmp_path, "alone", 0)
    both, beside = solve(executable, tmp_path, "both", FACETS, height=5.0)
    assert without["projections"] > 0
    assert beside["queries"] == without["queries"]
    assert beside["projections"] == without["projections"]
    # One box for each look at the pair: as many as evaluations, each of which asks for four points.
    assert 0 < beside["boxes"] - without["boxes"] <= without["queries"]/4 + 1
    assert np.allclose(both["contact"][0]["force"], alone["contact"][0]["force"], rtol=1e-12,
                       atol=1e-12)
    assert both["contact"][1]["closed"] == 0


@pytest.mark.parametrize("inc", ["0.1, 1., 1e-5, 0.1", "1., 1., 1e-5, 1."])
def test_a_far_pair_wakes_when_it_comes_near(executable, tmp_path, inc):
    """The upper block is lifted against the strip, also in one increment through all of the gap."""
    job, _ = solve(executable, tmp_path, "lift", 20, way=0.0, height=2.0)
    assert job["contact"][1]["closed"] == 0
    text = deck(20, height=2.0, way=2.0, inc=inc).replace("HEAD, 1, 1\nHEAD, 2, 2, 2.0",
                                                          "BASE, 1, 1\nBASE, 2, 2, 2.01")
    # A small force aside, because a block that only moves has no force to compare residuals with.
    text = text.replace("*NODE PRINT", "*CLOAD\nHEAD, 1, 0.01\n*NODE PRINT")
    text = text.replace("*NSET, NSET=FOOT",
                        "*NSET, NSET=BASE\n101, 102, 103, 104\n*NSET, NSET=FOOT")
    (tmp_path/"up.inp").write_text(text)
    done = subprocess.run([executable, "run", "up.inp", "-o", ".", "--overwrite", "--quiet"],
                          cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    pair = json.loads((tmp_path/"up.json").read_text())["contact"][1]
    assert pair["closed"] == 4
    # A bar of modulus E/(1 - nu^2), shortened by 0.01, between smooth ends that are held and free
    # aside.
    assert abs(pair["force"][1]) > 5.0
    assert pair["max_penetration"] < 1e-8


def test_every_step_counts_its_own_searches(executable, tmp_path):
    """The same press in one step and in the first of two: the second does not count the first
    again."""
    step = "*STEP, NLGEOM\n*STATIC\n1., 1.\n*END STEP\n"
    (tmp_path/"two.inp").write_text(deck(0) + step)
    subprocess.run([executable, "run", "two.inp", "-o", ".", "--quiet"], cwd=tmp_path, check=True)
    _, alone = solve(executable, tmp_path, "alone", 0)
    first, second = (s["search"] for s in json.loads((tmp_path/"two.json").read_text())["steps"])
    assert first == alone
    assert 0 < second["queries"] < first["queries"]
