"""What preconditions Newton's iterations changes no answer."""
from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
from upset_billet import billet

import lopin
from lopin import mesh_make
from lopin.mesh import together
from lopin.model import Model
from lopin.model_deck import mesh_deck

#: The executable with PETSc, which is built beside the other where PETSc is installed.
COARSE = Path(os.environ.get("LOPIN_EXECUTABLE", "build/lopin")).with_name("lopin_multigrid")


def pressed(solver: str) -> np.ndarray:
    """Force of the plate over time, on a mesh for which single precision is chosen."""
    scene = billet(2, mu=0.1, share=0.02, cells=(40, 60))
    history = lopin.run(scene, executable=True, solver=solver).history
    return np.asarray(history["DIE.rf2"])


def test_answers_do_not_depend_on_the_factor() -> None:
    """Beside factors of double precision, by profile and by CHOLMOD."""
    chosen = pressed("auto")
    for solver in ("skyline", "cholmod"):
        assert np.allclose(pressed(solver), chosen, rtol=1e-6, atol=0.0)


def block_under_plate(metal: bool) -> lopin.Deck:
    """An eighth of a block of bricks under an elastic plate, meshes that do not match."""
    body = mesh_make.block((10.0, 10.0, 8.0), (5, 5, 4))
    plate = mesh_make.block((14.0, 14.0, 3.0), (4, 4, 1), origin=(0.0, 0.0, 8.0))
    sets = {k: body.point_sets[k] for k in ("LEFT", "FRONT", "BACK", "BOTTOM")
            if k in body.point_sets}
    side = "FRONT" if body.points[list(sets["FRONT"])][:, 1].max() < 1e-9 else "BACK"
    parts = {"BODY": body.replaced(surfaces={"FACE": body.surfaces["TOP"]},
                                   point_sets={k: sets[k] for k in ("LEFT", side, "BOTTOM")}),
             "PLATE": plate.replaced(surfaces={"FACE": plate.surfaces["BOTTOM"]},
                                     point_sets={"NODES": np.arange(plate.n_point)})}
    plastic = "*PLASTIC\n300., 0.\n500., 0.5\n" if metal else ""
    return lopin.Deck.parse(mesh_deck(Model("block", together(**parts), kind="3d")).text() + (
        f"*MATERIAL, NAME=METAL\n*ELASTIC\n200000., 0.3\n{plastic}"
        "*SOLID SECTION, ELSET=BODY.ALL, MATERIAL=METAL\n"
        "*MATERIAL, NAME=HARD\n*ELASTIC\n600000., 0.3\n"
        "*SOLID SECTION, ELSET=PLATE.ALL, MATERIAL=HARD\n*SURFACE INTERACTION, NAME=I\n"
        "*SURFACE BEHAVIOR, DIRECT\n*FRICTION\n0.2,\n*CONTACT PAIR, INTERACTION=I\n"
        "BODY.FACE, PLATE.FACE\n*BOUNDARY\nBODY.LEFT, 1, 1\n"
        f"BODY.{side}, 2, 2\nBODY.BOTTOM, 3, 3\nPLATE.NODES, 1, 2\n*LOPIN, PATH=FINITE\n"
        f"*STEP{', NLGEOM' if metal else ''}\n*STATIC\n0.5, 1.\n*BOUNDARY\n"
        f"PLATE.NODES, 3, 3, {-0.4 if metal else -0.01}\n"
        "*NODE PRINT, NSET=PLATE.NODES, TOTALS=ONLY\nRF\n*END STEP\n"))


@pytest.mark.skipif(not COARSE.exists(), reason="PETSc is not installed")
@pytest.mark.parametrize("metal", [False, True])
def test_multigrid_gives_the_answers_of_a_factor(metal, monkeypatch) -> None:
    """Friction, and plastic metal that is upset."""
    deck = block_under_plate(metal)
    factor = lopin.run(deck, executable=True, solver="skyline")
    monkeypatch.setenv("LOPIN_EXECUTABLE", str(COARSE))
    coarse = lopin.run(deck, executable=True, solver="multigrid")
    assert np.abs(factor["U"] - coarse["U"]).max() <= 1e-6*np.abs(factor["U"]).max()


def test_a_build_without_petsc_says_so() -> None:
    """Multigrid cannot be had by its name alone; a factor never is called so."""
    if "multigrid" in str(os.environ.get("LOPIN_EXECUTABLE", "")):
        pytest.skip("this one has it")
    with pytest.raises(lopin.LopinError, match=r"no solver multigrid|E0704"):
        lopin.run(block_under_plate(metal=False), executable=True, solver="multigrid")
