"""Metal whose stress depends on its rate flows on while a tool goes back."""
import sys
from pathlib import Path

import lopin
from lopin.mesh_make import block

sys.path.insert(0, str(Path(__file__).resolve().parents[2]/"decks"/"make"))
import forging  # noqa: E402


def released(solve, first):
    """Plastic work while the die goes back at 8 mm/s, that of the forming, and what was said."""
    up = f"*STEP, NLGEOM, INC=500\n*STATIC\n{first:g}, 1.\n*BOUNDARY, TYPE=VELOCITY\nDIE_REF, 2, 2, 8.\n*END STEP\n"
    result = solve(lopin.Deck.parse(forging.closed_die(8, short=3.5) + up, "up"))
    work = result.history["energy.plastic"]
    formed = int((result.history["step"] == 1).sum()) - 1
    return work[-1] - work[formed], {d["code"] for d in result.diagnostics}


def test_a_die_that_is_gone_within_an_increment_is_told_or_followed(solve):
    """An increment of a twentieth of a second let go of all at once, without a word."""
    right, _ = released(solve, 1e-5)
    found, said = released(solve, 0.05)
    assert right > 0.0 and (found > 0.8*right or "W0555" in said)


def test_metal_that_has_not_flowed_lets_go_in_one_increment(solve):
    """Its law depends on the rate, its stress is a thousandth of the yield stress: nothing flows on."""
    mesh = block((1.0, 1.0), (2, 2))
    text = ["*NODE", *(f"{i}, " + ", ".join(map(repr, p)) for i, p in enumerate(mesh.points.tolist(), 1)),
            "*NODE, NSET=DIE", "9001, 0.5, 1.", "*ELEMENT, TYPE=CPE4, ELSET=B",
            *(f"{i}, " + ", ".join(str(n + 1) for n in row)
              for i, row in enumerate(mesh.blocks[0][1].tolist(), 1)),
            "*NSET, NSET=LOW", *(f"{n + 1}," for n in mesh.point_sets["BOTTOM"].tolist()),
            "*SURFACE, NAME=TOP", *(f"{e + 1}, S{f}" for e, f in mesh.surfaces["TOP"].tolist()),
            "*SURFACE, NAME=TOOL, TYPE=SEGMENTS", "START, 3., 1.", "LINE, -3., 1.",
            "*RIGID BODY, ANALYTICAL SURFACE=TOOL, REF NODE=9001", "*MATERIAL, NAME=M", "*ELASTIC",
            "1000., .3", "*PLASTIC", "1.e6, 0.", "*RATE DEPENDENT", "40., 5.",
            "*SOLID SECTION, ELSET=B, MATERIAL=M", "1.,", "*SURFACE INTERACTION, NAME=I",
            "*CONTACT PAIR, INTERACTION=I", "TOP, TOOL", "*BOUNDARY", "LOW, 2", "1, 1", "DIE, 1",
            "DIE, 6"]
    for way in (-0.02, 0.02):
        text += ["*STEP, NLGEOM", "*STATIC", "1., 1.", "*BOUNDARY", f"DIE, 2, 2, {way}",
                 "*END STEP"]
    result = solve(lopin.Deck.parse("\n".join(text) + "\n", "still"))
    assert [step["increments"] for step in result.summary["steps"]][1] <= 2
    assert not [d for d in result.diagnostics if d["code"] in ("W0555", "E0555")]
