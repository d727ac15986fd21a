"""Dies of facets on coarse slabs: rows from points inside the faces that meet creases."""
import math

import numpy as np
import pytest

from faceted_die import pressed

FACET = 1.57                      # of the die; the slab's are 2
PHASES = np.arange(4)/4
# A tool that is flat up to here, and rises by 15 degrees from there: the force of CPE4, facets of 0.25.
RISE = math.tan(math.radians(15.0))
SLOPES = {0.5: 407.6, 1.0: 424.9, 1.5: 442.2}


def forces(solve, kind, phases=PHASES, facet=FACET, **scene):
    key = "TOOL.rf3" if kind.startswith("C3") else "TOOL.rf2"
    return np.array([abs(solve(pressed(kind, facet, p, **scene)).history[key][-1]) for p in phases])


def ripple(force):
    return np.ptp(force)/force.mean()


# Rows at nodes only: CPE4 5.5 %, CPE3 10, CAX4 18, C3D8 5.9, C3D4 12, CPE8 4.2, CPE6 4.6; means -20, -4, -13, -20, -3 %.
@pytest.mark.parametrize("path", ["", "FINITE"])
@pytest.mark.parametrize("kind, most, mean, within", [("CPE4", 0.01, 92.0, 0.04), ("CPE3", 0.015, 92.0, 0.1),
                                                      ("CAX4", 0.04, 400.0, 0.18), ("CPE8", 0.022, 92.0, 0.04),
                                                      ("CPE6", 0.025, 92.0, 0.06)])
def test_a_polygon_turned_over_its_facets_presses_evenly(solve, path, kind, most, mean, within):
    force = forces(solve, kind, path=path)
    assert ripple(force) < most
    assert force.mean() == pytest.approx(mean, rel=within)


@pytest.mark.parametrize("path", ["", "FINITE"])
@pytest.mark.parametrize("kind, tool, most", [("C3D8", "STL", 0.02), ("C3D8", "CYLINDER", 0.02),
                                              ("C3D4", "STL", 0.03)])
def test_so_it_does_in_space(solve, tmp_path, path, kind, tool, most):
    force = forces(solve, kind, PHASES[::2], path=path, tool=tool, folder=tmp_path, smooth=", SMOOTH=NO")
    assert ripple(force) < most
    # Plane strain, 2 wide.
    assert force.mean()/2.0 == pytest.approx(92.0, rel=0.1)


@pytest.mark.parametrize("kind", ["CPE4", "CPE8"])
def test_both_paths_agree(solve, kind):
    linear, finite = (forces(solve, kind, [0.2], path=path)[0] for path in ("", "FINITE"))
    assert finite == pytest.approx(linear, rel=2e-3)


@pytest.mark.parametrize("path", ["", "FINITE"])
@pytest.mark.parametrize("kind", ["C3D8", "C3D4"])
def test_triangles_curved_by_their_normals_press_as_the_circle_they_mean(solve, tmp_path, path, kind):
    """At four phases of facets that are nearly as long as those of the slab."""
    round_ = forces(solve, kind, [0.0], path=path, tool="CYLINDER", facet=0.0)
    curved = forces(solve, kind, PHASES[::2], path=path, tool="STL", folder=tmp_path)
    assert curved == pytest.approx(round_[0], rel=0.01)


@pytest.mark.parametrize("path", ["", "FINITE"])
def test_long_faces_of_second_order_press_as_short_ones(solve, path):
    """At the nodes only: 99.6, 92.1, 89.6, 92.1."""
    assert ripple(forces(solve, "CPE8", path=path, size=4.0)) < 0.03


# Refined: 392.4 to 439.6 by where the slope begins. At the nodes only: CPE8 +4.3 to -2.7 %, C3D20R 2.3, -1.9, C3D10 4.7,
# -1.7 on the linear path, and on the other one up to 3 % away from it.
@pytest.mark.parametrize("path", ["", "FINITE"])
@pytest.mark.parametrize("kind, tool", [("CPE8", "SEGMENTS"), ("C3D20R", "CYLINDER"), ("C3D10", "STL"), ("C3D15", "STL")])
def test_a_slope_that_begins_within_a_face(solve, tmp_path, path, kind, tool):
    key, width = ("TOOL.rf3", 2.0) if kind.startswith("C3") else ("TOOL.rf2", 1.0)
    for start, refined in SLOPES.items():
        result = solve(pressed(kind, FACET, 0.0, path=path, tool=tool, folder=tmp_path, down=0.284,
                               points=[(30.0, (30.0 - start)*RISE), (start, 0.0), (-30.0, 0.0)]))
        assert abs(result.history[key][-1])/width == pytest.approx(refined, rel=0.02)


@pytest.mark.parametrize("path", ["", "FINITE"])
@pytest.mark.parametrize("mu", [0.0, 0.2])
def test_it_slides_without_cycling(solve, path, mu):
    result = solve(pressed("CPE4", FACET, 0.0, path=path, mu=mu, slide=3.0))
    assert result.history["time"][-1] == pytest.approx(2.0)
    down, along = (np.abs(result.history[f"TOOL.rf{k}"][-11:]) for k in (2, 1))
    # Facets that climb and fall under the die push it along by their slope.
    assert np.all(np.abs(along - mu*down) < 0.12*down)
