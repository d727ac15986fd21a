"""What preconditions Newton's iterations changes no answer."""
from __future__ import annotations

import numpy as np
from upset_billet import billet

import lopin


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
