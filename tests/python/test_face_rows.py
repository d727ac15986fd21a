"""Dies of facets on coarse slabs: rows from points inside the faces that meet creases."""
import numpy as np
import pytest

from faceted_die import pressed

FACET = 1.57                      # of the die; the slab's are 2
PHASES = np.arange(4)/4


def forces(solve, kind, phases=PHASES, **scene):
    key = "TOOL.rf3" if kind.startswith("C3") else "TOOL.rf2"
    return np.array([abs(solve(pressed(kind, FACET, p, **scene)).history[key][-1]) for p in phases])


def ripple(force):
    return np.ptp(force)/force.mean()


# Rows at nodes only: CPE4 5.5 %, CPE3 10, CAX4 18, C3D8 5.9, C3D4 12; means -20, -4, -13, -20, -3 %.
@pytest.mark.parametrize("path", ["", "FINITE"])
@pytest.mark.parametrize("kind, most, mean, within", [("CPE4", 0.01, 92.0, 0.04), ("CPE3", 0.015, 92.0, 0.1),
                                                      ("CAX4", 0.04, 400.0, 0.18)])
def test_a_polygon_turned_over_its_facets_presses_evenly(solve, path, kind, most, mean, within):
    force = forces(solve, kind, path=path)
    assert ripple(force) < most
    assert force.mean() == pytest.approx(mean, rel=within)


@pytest.mark.parametrize("path", ["", "FINITE"])
@pytest.mark.parametrize("kind, tool, most", [("C3D8", "STL", 0.02), ("C3D8", "CYLINDER", 0.02),
                                              ("C3D4", "STL", 0.03)])
def test_so_it_does_in_space(solve, tmp_path, path, kind, tool, most):
    force = forces(solve, kind, PHASES[::2], path=path, tool=tool, folder=tmp_path)
    assert ripple(force) < most
    # Plane strain, 2 wide.
    assert force.mean()/2.0 == pytest.approx(92.0, rel=0.1)


def test_both_paths_agree(solve):
    linear, finite = (forces(solve, "CPE4", [0.2], path=path)[0] for path in ("", "FINITE"))
    assert finite == pytest.approx(linear, rel=2e-3)


@pytest.mark.parametrize("path", ["", "FINITE"])
@pytest.mark.parametrize("mu", [0.0, 0.2])
def test_it_slides_without_cycling(solve, path, mu):
    result = solve(pressed("CPE4", FACET, 0.0, path=path, mu=mu, slide=3.0))
    assert result.history["time"][-1] == pytest.approx(2.0)
    down, along = (np.abs(result.history[f"TOOL.rf{k}"][-11:]) for k in (2, 1))
    # Facets that climb and fall under the die push it along by their slope.
    assert np.all(np.abs(along - mu*down) < 0.12*down)
