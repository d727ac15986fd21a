"""On the linear paths only points within reach get rows; those beyond are looked at after every
solve."""
import json
import subprocess

import numpy as np
import pytest

PLATE = 50      # facets a side of the far plates
STRIP = 320     # facets of the crowned block


def bricks(node, element, name, cells, corner, size):
    """A box of C3D8 as deck text; nodes run along x, then y, then z."""
    nx, ny, nz = cells
    text = "*NODE, NSET=ALL\n"
    for k in range(nz + 1):
        for j in range(ny + 1):
            for i in range(nx + 1):
                at = [c + s*f/n for c, s, f, n in zip(corner, size, (i, j, k), cells)]
                text += f"{node + i + (nx + 1)*(j + (ny + 1)*k)}, {at[0]}, {at[1]}, {at[2]}\n"
    text += f"*ELEMENT, TYPE=C3D8, ELSET={name}\n"
    for k in range(nz):
        for j in range(ny):
            for i in range(nx):
                n = node + i + (nx + 1)*(j + (ny + 1)*k)
                m = n + (nx + 1)*(ny + 1)
                text += f"{element}, {n}, {n + 1}, {n + nx + 2}, {n + nx + 1}, {m}, {m + 1}, {m + nx + 2}, {m + nx + 1}\n"
                element += 1
    return text + f"*SOLID SECTION, ELSET={name}, MATERIAL=M\n"


def listed(name, ids):
    return f"*NSET, NSET={name}\n" + "".join(f"{i}\n" for i in ids)


def plates(far_pair):
    """A block pressed on a block by a force, and two plates five facets and more apart, with a pair
    or without."""
    n, h = 10, 3
    text = "*MATERIAL, NAME=M\n*ELASTIC\n1000., 0.3\n"
    text += bricks(1, 1, "LOW", (n, n, h), (0, 0, 0), (4, 4, 2))
    text += bricks(10001, 10001, "HIGH", (n, n, h), (0, 0, 2), (4, 4, 2))
    text += bricks(20001, 20001, "PLOW", (PLATE, PLATE, 1), (10, 0, 0), (10, 10, 1))
    text += bricks(40001, 40001, "PHIGH", (PLATE, PLATE, 1), (10, 0, 3), (10, 10, 1))
    layer, sheet = (n + 1)**2, (PLATE + 1)**2
    text += listed("FOOT", range(1, layer + 1)) + listed("HEAD", range(10001 + h*layer,
                                                                       10001 + (h + 1)*layer))
    text += listed("FLOOR", range(20001, 20001 + sheet)) + listed("ROOF", range(40001 + sheet,
                                                                                40001 + 2*sheet))
    text += f"*ELSET, ELSET=LTOP, GENERATE\n{1 + n*n*(h - 1)}, {n*n*h}\n*ELSET, ELSET=HBOT, GENERATE\n10001, {10000 + n*n}\n"
    text += "*SURFACE, NAME=UNDER\nHBOT, S1\n*SURFACE, NAME=OVER\nLTOP, S2\n"
    text += "*SURFACE, NAME=PUNDER\nPHIGH, S1\n*SURFACE, NAME=POVER\nPLOW, S2\n"
    text += "*SURFACE INTERACTION, NAME=DRY\n*SURFACE BEHAVIOR, DIRECT\n"
    text += "*CONTACT PAIR, INTERACTION=DRY, TYPE=NODE TO SURFACE\nUNDER, OVER\n"
    if far_pair:
        text += "*CONTACT PAIR, INTERACTION=DRY, TYPE=NODE TO SURFACE\nPUNDER, POVER\n"
    text += "*STEP\n*STATIC\n0.5, 1., 1e-5, 0.5\n*BOUNDARY\nFOOT, 1, 3\nHEAD, 1, 2\nFLOOR, 1, 3\nROOF, 1, 3\n"
    return text + f"*CLOAD\nHEAD, 3, {-10/layer}\n*NODE PRINT, NSET=HEAD\nU\n*END STEP\n"


def crown(whole, load, increments=1, behaviour="DIRECT", friction="", layers=2):
    """Half of a crowned block that only contact holds against falling, pressed on a bed.

    `whole`: a body far away that is moved far makes every point one within reach from the start."""
    width, crown_of = 0.1, 0.0025
    text = "*LOPIN, PATH=CONDENSED\n*MATERIAL, NAME=M\n*ELASTIC\n1000., 0.3\n*NODE, NSET=ALL\n"
    for i in range(STRIP + 1):
        x = i*width
        text += f"{1 + i}, {x}, -1.\n{1001 + i}, {x}, 0.\n"
        for j in range(layers + 1):
            text += f"{1001 + 1000*(j + 1) + i}, {x}, {(1 - j/layers)*crown_of*x*x + 4*j/layers}\n"
    text += "*ELEMENT, TYPE=CPE4, ELSET=BED\n" + "".join(
        f"{1 + i}, {1 + i}, {2 + i}, {1002 + i}, {1001 + i}\n" for i in range(STRIP))
    text += "*ELEMENT, TYPE=CPE4, ELSET=BLOCK\n" + "".join(
        f"{n}, {n + 1000}, {n + 1001}, {n + 2001}, {n + 2000}\n"
        for j in range(layers) for i in range(STRIP) for n in [1001 + 1000*j + i])
    text += "*SOLID SECTION, ELSET=BED, MATERIAL=M\n1.\n*SOLID SECTION, ELSET=BLOCK, MATERIAL=M\n1.\n"
    text += listed("FOOT", range(1, STRIP + 2)) + listed("MIDDLE",
                                                         range(2001, 2002 + 1000*layers, 1000))
    text += f"*ELSET, ELSET=LOWEST, GENERATE\n1001, {1000 + STRIP}\n"
    text += f"*ELSET, ELSET=HIGHEST, GENERATE\n{1 + 1000*layers}, {1000*layers + STRIP}\n"
    if whole:
        text += "*NODE, NSET=ASIDE\n90001, 50., 0.\n90002, 51., 0.\n90003, 51., 1.\n90004, 50., 1.\n"
        text += "*ELEMENT, TYPE=CPE4, ELSET=LOOSE\n90001, 90001, 90002, 90003, 90004\n"
        text += "*SOLID SECTION, ELSET=LOOSE, MATERIAL=M\n1.\n"
    text += "*SURFACE, NAME=UNDER\nLOWEST, S1\n*SURFACE, NAME=OVER\nBED, S3\n"
    text += f"*SURFACE INTERACTION, NAME=DRY\n*SURFACE BEHAVIOR, {behaviour}\n{friction}"
    text += "*CONTACT PAIR, INTERACTION=DRY, TYPE=NODE TO SURFACE\nUNDER, OVER\n"
    text += f"*STEP, INC=200\n*STATIC, DIRECT\n{1/increments}, 1.\n*BOUNDARY\nFOOT, 1, 2\nMIDDLE, 1, 1\n"
    if whole:
        text += "ASIDE, 1, 1, 100.\nASIDE, 2, 2\n"
    return text + f"*DLOAD\nHIGHEST, P3, {load}\n*NODE PRINT, NSET=ALL\nU\n*END STEP\n"


def run(executable, folder, name, text):
    (folder/f"{name}.inp").write_text(text)
    done = subprocess.run([executable, "run", f"{name}.inp", "-o", ".", "--overwrite", "--quiet"],
                          cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return json.loads((folder/f"{name}.json").read_text())


def displacements(folder, name):
    """Of the last increment, by node."""
    rows = {}
    for line in (folder/f"{name}.dat").read_text().splitlines():
        words = line.split()
        if words and words[0].isdigit():
            rows[int(words[0])] = [float(w) for w in words[1:3]]
    return rows


def total(job, what):
    return sum(step[what] for step in job["steps"])


def test_a_far_pair_gets_no_row_and_costs_no_solve(executable, tmp_path):
    alone = run(executable, tmp_path, "alone", plates(far_pair=False))
    both = run(executable, tmp_path, "both", plates(far_pair=True))
    for what in ("back_solves", "factorisations", "iterations"):
        assert total(both, what) == total(alone, what)
    assert both["candidates"] == alone["candidates"] == 121
    assert both["retained"] == alone["retained"]
    assert f"121 of {121 + (PLATE + 1)**2} slave points within reach" in both["plan"]
    assert both["contact"][0] == alone["contact"][0]
    assert both["contact"][1]["closed"] == 0


@pytest.mark.parametrize("behaviour, friction, load, increments", [
    ("DIRECT", "", 0.05, 1), ("DIRECT", "", 0.08, 1), ("DIRECT", "", 0.1,
                                                       6), ("DIRECT", "*FRICTION\n0.2\n", 0.1, 6),
    ("PENALTY\n1e6", "", 0.08, 1), ("PENALTY", "", 0.05, 1)])
def test_points_beyond_the_first_reach_that_press_get_rows(executable, tmp_path, behaviour,
                                                           friction, load, increments):
    """At 0.05 nothing presses beyond it, at 0.08 in the only increment, at 0.1 in a late one."""
    near = run(executable, tmp_path, "near", crown(False, load, increments, behaviour, friction))
    full = run(executable, tmp_path, "full", crown(True, load, increments, behaviour, friction))
    rows = 2 if friction else 1
    assert full["candidates"] == (STRIP + 1)*rows
    # A stiffness chosen from the compliance of the pair is that of all its points.
    whole = behaviour == "PENALTY"
    assert whole or near["candidates"] < full["candidates"]
    assert (near["candidates"] == 90*rows) == (load < 0.07 and not whole)
    assert ("slave points within reach" in near["plan"]) == (not whole)
    assert near["contact"][0]["closed"] == full["contact"][0]["closed"] > 20
    assert np.allclose(near["contact"][0]["force"], full["contact"][0]["force"], rtol=1e-11,
                       atol=1e-11)
    u, v = displacements(tmp_path, "near"), displacements(tmp_path, "full")
    size = max(abs(value) for pair in u.values() for value in pair)
    assert all(abs(a - b) <= 1e-6*size for node in u for a, b in zip(u[node], v[node]))


def test_a_block_above_its_first_reach_is_caught(executable, tmp_path):
    """Nothing within reach holds it: the nearest points come in, then the others."""
    first = run(executable, tmp_path, "near", crown(False, 0.5))
    lifted = crown(False, 0.5).replace("*STEP",
                                       "*CLEARANCE, MASTER=OVER, SLAVE=UNDER, VALUE=0.7\n*STEP", 1)
    job = run(executable, tmp_path, "lifted", lifted)
    assert job["candidates"] == STRIP + 1
    assert np.allclose(job["contact"][0]["force"], first["contact"][0]["force"], rtol=1e-10,
                       atol=1e-10)
