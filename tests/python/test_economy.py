"""Model no more than a scene needs: counts, G3 (a) to (h).

(b), an axisymmetric mesh beside a sector in space, is in test_twins.py; (d), pairs that are far
apart, in test_far_pairs.py.
"""
import json
import subprocess
from pathlib import Path

import numpy as np
import pytest
from tool_patches import Lines

from lopin.deck import Deck
from lopin.mesh_make import block


def scene(tool=True, friction=False, nlgeom=False, plastic=False, bilateral=False, cells=(12, 8)):
    """A block pressed down on a rigid line, or held where that was."""
    lines = Lines()
    lines.add("*HEADING", "economy", "*MATERIAL, NAME=M", "*ELASTIC", "1000., 0.3")
    if plastic:
        lines.add("*PLASTIC", "5., 0.", "8., 1.")
    lines.mesh(block((6.0, 4.0), cells), "CPE4", "B")
    lines.add("*SOLID SECTION, ELSET=BE, MATERIAL=M")
    if tool:
        lines.node += 1
        lines.add(f"*NODE, NSET=P\n{lines.node}, 0., 0.", "*SURFACE, NAME=T, TYPE=SEGMENTS",
                  "START, -30., 0.", "LINE, 30., 0.",
                  f"*RIGID BODY, ANALYTICAL SURFACE=T, REF NODE={lines.node}",
                  "*SURFACE INTERACTION, NAME=I")
        if bilateral:
            lines.add("*SURFACE BEHAVIOR, NO SEPARATION")
        if friction:
            lines.add("*FRICTION", "0.1")
        lines.add("*CONTACT PAIR, INTERACTION=I", "BSBOTTOM, T", "*BOUNDARY", "P, 1, 2", "P, 6")
    else:
        lines.add("*BOUNDARY", "BBOTTOM, 2")
    lines.add("BLEFT, 1", "BTOP, 2, 2, -0.02", f"*STEP{', NLGEOM' if nlgeom else ''}", "*STATIC")
    lines.add("0.25, 1., 1e-5, 0.25", "*END STEP")
    return Deck.parse("\n".join(lines.text) + "\n", name="economy")


def total(result, what):
    return sum(step[what] for step in result.summary["steps"])


def test_a_rigid_tool_has_no_equation(solve):
    """(a) The same body without it, whose foot is held by the 13 equations of its nodes."""
    assert solve(scene()).summary["equations"] == solve(scene(tool=False)).summary["equations"] + 13


def test_bilateral_contact_without_friction_is_one_linear_solve(solve):
    """(c) One factorisation and one iteration an increment."""
    result = solve(scene(bilateral=True))
    assert total(result, "factorisations") == 1
    assert total(result, "iterations") == total(result, "increments")


def test_a_symmetric_scene_has_a_symmetric_solver(solve):
    """(e) A factor of one triangle without friction, and with it, too: contact is solved on what it
    leaves."""
    for friction in (False, True):
        assert solve(scene(friction=friction)).summary["solver"] in ("cholmod", "skyline")


def state_bytes(executable, folder, name, deck):
    """Size of the checkpoint of the second increment of four."""
    deck.write(folder/f"{name}.inp")
    text = (folder/f"{name}.inp").read_text()
    (folder/f"{name}.inp").write_text(text.replace("*STEP", "*STEP, INC=2"))
    subprocess.run([executable, "run", f"{name}.inp", "-o", name, "--quiet"], cwd=folder,
                   capture_output=True, check=False)
    return next((folder/name).glob("*.rst")).stat().st_size


def test_elastic_metal_has_no_plastic_state(executable, tmp_path):
    """(f) What flow adds to a checkpoint is at least its strain at each of the points."""
    elastic = state_bytes(executable, tmp_path, "elastic", scene(nlgeom=True))
    plastic = state_bytes(executable, tmp_path, "plastic", scene(nlgeom=True, plastic=True))
    assert plastic - elastic >= 8*4*96


def test_without_contact_nothing_is_searched(solve, executable, tmp_path):
    """(g) No query, no candidate, one factorisation and a back-solve an increment."""
    result = solve(scene(tool=False))
    assert total(result, "factorisations") == 1
    assert total(result, "back_solves") == total(result, "increments")
    assert result.summary["candidates"] == 0
    deck = scene(tool=False, nlgeom=True)
    deck.write(tmp_path/"none.inp")
    subprocess.run([executable, "run", "none.inp", "-o", "none", "--quiet"], cwd=tmp_path,
                   capture_output=True, check=True)
    steps = json.loads((tmp_path/"none"/"none.json").read_text())["steps"]
    assert all(sum(s.get("search", {"queries": 0}).values()) == 0 for s in steps)


def test_a_tool_that_a_force_moves_takes_one_backward_pass(solve):
    """While it moves on, only what moves it is solved for; all else follows once it rests."""
    decks = Path(__file__).resolve().parents[2]/"decks"
    text = (decks/"rough_punch.inp").read_text(encoding="utf-8")
    result = solve(Deck.parse(text, "rough_punch", decks))
    assert total(result, "back_solves") == total(result, "increments")


@pytest.mark.parametrize("nlgeom", [False, True])
def test_a_plane_deck_has_two_components(solve, nlgeom):
    """(h) Equations and supports are two a node, and none moves out of the plane."""
    result = solve(scene(tool=False, nlgeom=nlgeom, cells=(6, 4)))
    supports = 5 + 7 + 7
    assert result.summary["equations"] == 2*35 - supports
    u = result["U"]
    assert u.shape[1] == 2 or not np.any(u[:, 2:])
