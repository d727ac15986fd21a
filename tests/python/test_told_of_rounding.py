"""Contact that closes by nothing, and bodies that come back, are not told of as if they were more."""
import json
import re
import subprocess

import numpy as np

from lopin import mesh_make
from lopin.laws import Elastic
from lopin.mesh import together
from lopin.model import Model
from lopin.run import find_executable


def run(text, folder):
    """Codes, output, and the first pair of the summary."""
    (folder/"a.inp").write_text(text)
    result = subprocess.run([find_executable(), "run", folder/"a.inp", "-o", folder/"r"],
                            capture_output=True, text=True, check=False)
    said = result.stdout + result.stderr
    summary = json.loads((folder/"r"/"a.json").read_text())
    return set(re.findall(r"\[([EWN]\d{4})\]", said)), said, summary["contact"][0]


def test_a_pair_that_closes_exactly_where_an_increment_ends(tmp_path):
    low = mesh_make.block((4.0, 1.0, 1.0), (2, 2, 2)).quadratic()
    up = mesh_make.block((4.0, 1.0, 0.8), (3, 3, 2)).quadratic().moved(0.0, 0.0, 1.0)
    model = Model("closes", together(UP=up, LOW=low), kind="3d")
    for name, ratio in (("UP", 0.3), ("LOW", 0.2)):
        model.section(name, Elastic(2e4, ratio))
    model.contact("UP.BOTTOM", "LOW.TOP", surface_to_surface=True, clearance=0.002)
    model.fix("LOW.BOTTOM", "x", "y", "z")
    model.fix("UP.FRONT", "y")
    model.fix("LOW.FRONT", "y")
    model.step(2).move("UP.TOP", x=0.0, z=-0.004)
    codes, said, pair = run(model.to_deck().text(), tmp_path)
    assert "E0504" not in codes and "certificate: PASS" in said, said
    assert pair["force"][2] > 50.0


def turned_ring(angle, folder):
    """A ring shrunk on a mandrel that turns it; codes and what is said."""
    n = 12
    turn = 2.0*np.pi*np.arange(n)/n
    x = np.concatenate([np.column_stack([r*np.cos(turn), r*np.sin(turn)]) for r in (10.0, 15.0)])
    lines = ["*NODE", *(f"{i + 1}, {a!r}, {b!r}" for i, (a, b) in enumerate(x.tolist())),
             "*ELEMENT, TYPE=CPE4, ELSET=A"]
    lines += [f"{i + 1}, {i + 1}, {n + i + 1}, {n + (i + 1) % n + 1}, {(i + 1) % n + 1}"
              for i in range(n)]
    lines += ["*SURFACE, NAME=BORE", *(f"{i + 1}, S4" for i in range(n)), """*MATERIAL, NAME=M
*ELASTIC
1e5, 0.3
*SOLID SECTION, ELSET=A, MATERIAL=M
*NODE, NSET=REF
900, 0., 0.
*SURFACE, NAME=W, TYPE=SEGMENTS
START, 10.02, 0.
CIRCL, 0., -10.02, 0., 0.
CIRCL, -10.02, 0., 0., 0.
CIRCL, 0., 10.02, 0., 0.
CIRCL, 10.02, 0., 0., 0.
*RIGID BODY, ANALYTICAL SURFACE=W, REF NODE=REF
*SURFACE INTERACTION, NAME=I
*FRICTION
0.5
*CONTACT PAIR, INTERACTION=I
BORE, W
*CONTACT CONTROLS, INITIAL=INTERFERENCE
*BOUNDARY
REF, 1, 2
*STEP, NLGEOM
*STATIC
1., 1.
*BOUNDARY
REF, 6, 6, 0.
*END STEP
*STEP, NLGEOM
*STATIC
0.05, 1.
*BOUNDARY""", f"REF, 6, 6, {float(np.radians(angle))!r}", "*END STEP", ""]
    return run("\n".join(lines), folder)


def test_a_ring_that_is_turned_all_the_way_has_not_moved_away(tmp_path):
    """Nor do forces in balance, whose sum is rounding, rise by a part of themselves."""
    codes, said, _ = turned_ring(360.0, tmp_path)
    assert "certificate: PASS" in said and not codes & {"W0515", "W0562", "N0562"}, said
