"""Pressures on faces of a body go on over new meshes: they follow the skin."""
import numpy as np
import pytest
from test_remeshing import block, history, run, tetrahedra

import lopin

SIDE = "*SURFACE, NAME=SIDE\n"


def pressed(word, travel=-2.0, load="40.", first=""):
    """A block pressed without friction while a pressure acts on its side, x = 5."""
    scene = block(word, travel=travel, card="PERIOD=.25, STRAIN=10.", increments=12)
    if word == "C3D4":
        x, cells = tetrahedra()
        faces = "".join(f"{k + 1}, S{1 + [0, 1, 2, 3].index(f)}\n" for k, c in enumerate(cells)
                        for f, three in enumerate(((0, 1, 2), (0, 1, 3), (1, 2, 3), (2, 0, 3)))
                        if (np.abs(x[[c[a] for a in three], 0] - 5.0) < 1e-9).all())
    else:
        faces = "".join(f"{k}, S2\n" for k in range(13, 17))
    text = scene.text().replace("*RIGID BODY", f"{SIDE}{faces}*RIGID BODY", 1)
    text = text.replace("*END STEP", f"*DSLOAD\nSIDE, P, {load}\n*END STEP")
    if first:
        text = text.replace("*STEP, NLGEOM", first + "*STEP, NLGEOM")
    return lopin.Deck.parse(text, name="block")


HELD = """*STEP, NLGEOM
*STATIC
.5, 1.
*BOUNDARY
FLOOR, 2
AXIS, 1
9999, 1
9999, 6
9999, 2, 2, -.1
*DSLOAD
SIDE, P, 40.
*END STEP
"""


@pytest.mark.parametrize("word, first", [("CAX4", ""), ("CPE4", HELD), ("C3D4", "")])
def test_a_pressure_on_the_side_acts_on_every_mesh(word, first, core, tmp_path):
    """Uniform strain: the force of the tool is that of one mesh, and not that without the
    pressure."""
    pytest.importorskip("mmgpy" if word == "C3D4" else "gmsh")
    scene = pressed(word, first=first)
    report = run(scene, tmp_path)
    assert len(report.remeshes) >= 3
    assert max(abs(j["change"]) for j in report.jumps()) < (1e-3 if word == "C3D4" else 1e-6)
    found = history(tmp_path, "block")["DIE.rf2"][-1]
    card = next(line for line in scene.text().splitlines() if line.startswith("*REMESH"))
    text = scene.text().replace(card + "\n", "")
    one = lopin.run(lopin.Deck.parse(text, name="one")).history["DIE.rf2"][-1]
    bare = lopin.run(lopin.Deck.parse(text.replace("SIDE, P, 40.", "SIDE, P, 0."), name="bare"))
    assert found == pytest.approx(one, rel=1e-6)
    assert abs(bare.history["DIE.rf2"][-1] - one) > 0.05*abs(one)


def test_tractions_that_keep_their_direction_are_refused(core, tmp_path):
    """From a step before the remesh they are forces of nodes that a new mesh does not have."""
    text = pressed("CAX4", first=HELD).text().replace("SIDE, P, 40.", "SIDE, TRVEC, 40., 0., -1.")
    with pytest.raises(lopin.LopinError, match="E0621"):
        run(lopin.Deck.parse(text, name="block"), tmp_path)
