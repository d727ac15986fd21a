"""Bounds of friction that follow the stress of the solids: Newton knows them, and keeps its order."""
import re

import pytest

from lopin import Deck, mesh_make
from lopin.atlas.forming_scenes import billet


@pytest.mark.parametrize("word, law, m, method, hollow", [
    ("CAX8R", "CRISTESCU", 0.3, "lagrange", False), ("CAX8R", "CRISTESCU", 0.6, "penalty", True),
    ("CAX4", "CRISTESCU", 1.0, "lagrange", True), ("C3D8", "CRISTESCU", 0.6, "lagrange", False),
    ("C3D4", "TRESCA", 0.6, "lagrange", False)])
def test_billets_and_rings_end_in_few_iterations(solve, word, law, m, method, hollow):
    """Read of the iteration before, the first three took thousands of iterations and stopped."""
    scene, _, _ = billet(word, [f"*FRICTION, LAW={law}", f"{m!r},"], (), method, hollow=hollow)
    result = solve(scene.deck())
    assert result.history["time"][-1] == pytest.approx(1.0)
    assert len(result.history["time"]) <= 60
    assert sum(result.history["iterations"]) <= 9*len(result.history["time"])


def block_on_block(word, law, pairing):
    """A block pressed and sheared on a larger one, both of metal that flows."""
    ndim = 3 if word == "C3D8" else 2
    lower = mesh_make.block((4.0, 1.0, 1.0)[:ndim], (6, 2, 2)[:ndim])
    upper = mesh_make.block((2.0, 1.0, 1.0)[:ndim], (4, 3, 2)[:ndim],
                            origin=(1.0, 0.0, 1.0) if ndim == 3 else (1.0, 1.0))
    lines, node, element = ["*HEADING", "block on block"], 0, 0
    for name, mesh in (("LOW", lower), ("UP", upper)):
        lines += ["*NODE", *(f"{node + i + 1}, " + ", ".join(map(repr, x))
                             for i, x in enumerate(mesh.points.tolist()))]
        (_, rows), = mesh.blocks
        lines += [f"*ELEMENT, TYPE={word}, ELSET={name}",
                  *(f"{element + i + 1}, " + ", ".join(str(node + k + 1) for k in row)
                    for i, row in enumerate(rows.tolist()))]
        for side in ("TOP", "BOTTOM"):
            lines += [f"*NSET, NSET={name}_{side}",
                      *(f"{node + k + 1}," for k in mesh.point_sets[side].tolist()),
                      f"*SURFACE, NAME={name}_S{side}",
                      *(f"{element + e + 1}, S{f}" for e, f in mesh.surfaces[side].tolist())]
        node, element = node + mesh.n_point, element + len(rows)
    return Deck.parse("\n".join(lines + [
        "*MATERIAL, NAME=M", "*ELASTIC", "200000., 0.3", "*PLASTIC", "300., 0.", "1800., 5.",
        *(line for name in ("LOW", "UP") for line in (f"*SOLID SECTION, ELSET={name}, MATERIAL=M",
                                                      "1.,")[:4 - ndim]),
        "*SURFACE INTERACTION, NAME=I", f"*FRICTION, LAW={law}", "0.4,",
        f"*CONTACT PAIR, INTERACTION=I, TYPE={pairing}", "UP_SBOTTOM, LOW_STOP", "*BOUNDARY",
        f"LOW_BOTTOM, 1, {ndim}", "*STEP, NLGEOM, INC=200", "*STATIC", "0.05, 1.", "*BOUNDARY",
        *([] if ndim == 2 else ["UP_TOP, 2, 2, 0."]), "UP_TOP, 1, 1, 0.15", f"UP_TOP, {ndim}, {ndim}, -0.1", "*END STEP", ""]), "blocks")


@pytest.mark.parametrize("word, law, pairing", [
    ("CPE4", "CRISTESCU", "SURFACE TO SURFACE"), ("CPE4", "CRISTESCU", "NODE TO SURFACE"),
    ("C3D8", "CRISTESCU", "SURFACE TO SURFACE"), ("C3D8", "TRESCA", "NODE TO SURFACE")])
def test_newton_converges_quadratically_on_meshes(solve, tmp_path, word, law, pairing):
    """A step by the exact tangent of a state near the solution squares its residual, but for a factor."""
    solve(block_on_block(word, law, pairing))
    text = next((tmp_path/"run0").glob("*.cvg")).read_text()
    last = text.split("step 1, increment ")[-1]
    rows = [line.split() for line in last.splitlines() if re.match(r" +\d+ +\d\.\d+E", line)]
    residual = [float(row[1]) for row in rows if row[-1] != "old"]
    near = [(a, b) for a, b in zip(residual, residual[1:]) if 1e-7 < a < 1e-3]
    assert near and all(b < max(1e-2*a, 1e-9) for a, b in near), residual
