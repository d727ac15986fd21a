"""The force of a pair is what its bodies bear: what stands on the tool, and what holds the body.

Rows with places beside their node, or inside its facets, push each place along the tool's normal
there: where a profile has corners, or is curved within a facet, area times traction is not their
sum.
"""
import re

import numpy as np
import pytest

import lopin
from faceted_die import RADIUS, pressed

KINDS = ["CPE3", "CPE4", "CPE6", "CPE8", "CPE8R", "CAX4", "CAX8", "C3D4", "C3D8", "C3D10", "C3D15",
         "C3D20", "C3D20R"]
ENFORCED = ["DIRECT", "PENALTY\n2000.", "AUGMENTED LAGRANGE", "PERTURBED LAGRANGE\n2000."]
#: A wedge and two flats, between which nodes pass.
WEDGE = [(12.0, 3.0), (4.0, 0.4), (0.5, 0.0), (-6.0, 0.3), (-12.0, 3.0)]


def die(kind, path, mu, facets, words="DIRECT", pair="", folder=None, **how):
    """Pressed, and slid along where the scene is no body of revolution."""
    slide = None if kind.startswith("CAX") else 1.7
    deck = pressed(kind, 0.0, 0.0, size=4.0, path=path, mu=mu, slide=slide, steps=3,
                   points=None if facets == "round" else WEDGE, folder=folder, **how)
    text = deck.text().replace("*SURFACE INTERACTION, NAME=I",
                               f"*SURFACE INTERACTION, NAME=I\n*SURFACE BEHAVIOR, {words}")
    text = text.replace("*CONTACT PAIR, INTERACTION=I", f"*CONTACT PAIR, INTERACTION=I{pair}")
    text = text.replace("*END STEP", "*CONTACT PRINT\nCF, CFN, CFS\n*END STEP")
    if path == "FINITE":
        text = text.replace("*STEP, ", "*STEP, NLGEOM, ")
    return lopin.Deck.parse(text, name="die")


def printed(result):
    """Forces and moments of the last increment: of CF, CFN and CFS."""
    dat = next(result.source.folder.glob("*.dat")).read_text(encoding="utf-8")
    number = r"\s+(-?\d\.\d+E[+-]\d+)"
    rows = re.findall(r"about the origin \(mx,my,mz\)\s*" + number*6, dat)
    return np.array(rows[-3:], float)


def check(result, d, axis=False):
    h = result.history
    force = np.array([h[f"TOP-TOOL.force{k}"] for k in range(1, d + 1)])
    tool = np.array([h[f"TOOL.rf{k}"] for k in range(1, d + 1)])
    size = np.abs(force).max()
    rows = slice(1, None) if axis else slice(None)
    # Newton ends at 1e-8 of the forces of the scene.
    assert np.abs(force - tool)[rows].max() < 1e-6*size
    end = result.summary["contact"][0]["force"]
    assert np.allclose(end, force[:, -1], rtol=0, atol=1e-9*size)
    points = result.contact(0).last
    # Fields are written in single precision, tables with seven figures.
    assert np.allclose(points.force.sum(axis=0)[:d], force[:, -1], rtol=0, atol=1e-5*size)
    both, normal, shear = printed(result)
    assert np.allclose(both[:d], force[:, -1], rtol=0, atol=1e-5*size)
    assert np.allclose(normal + shear, both, rtol=0, atol=1e-4*size)
    return both, shear, size


def check_moments(result, d, shear, both):
    """About the reference node, where the step has left it: on the axis of the round die."""
    h = result.history
    at = np.zeros(3)
    at[d - 1] = RADIUS
    for k in range(1, d + 1):
        at[k - 1] += h[f"TOOL.u{k}"][-1]
    moment = both[3:] - np.cross(at, both[:3])
    turn = np.array([h[f"TOOL.rf{k}"][-1] for k in ((4, 5, 6) if d == 3 else (6,))])
    # The tool bears shear at its foot, the body at its node.
    points = result.contact(0).last
    lift = np.abs(points.gap[points.status > 0]).max()
    bound = 1e-5*RADIUS*np.linalg.norm(both[:3]) + lift*np.abs(shear).sum()
    assert np.abs(moment[-turn.size:] - turn).max() < bound


def cases():
    """Of elements, paths, friction and dies."""
    for kind in KINDS:
        yield kind, "FINITE", 0.3, "wedge"
    for kind in ("CPE4", "CPE8", "CAX8", "C3D10", "C3D20"):
        yield kind, "FINITE", 0.0, "round"
        yield kind, "FINITE", 0.0, "wedge"
        yield kind, "", 0.3, "wedge"
        yield kind, "", 0.0, "round"


@pytest.mark.parametrize("kind, path, mu, facets", list(cases()))
def test_the_tool_bears_what_the_pair_says(solve, kind, path, mu, facets):
    d = 3 if kind.startswith("C3") else 2
    axis = kind.startswith("CAX")
    result = solve(die(kind, path, mu, facets), refused=True)
    both, shear, size = check(result, d, axis)
    if mu == 0.0:
        assert np.abs(shear).max() < 1e-6*size
    if path == "FINITE" and not axis:
        check_moments(result, d, shear[:3], both)


@pytest.mark.parametrize("pair", [", TYPE=NODE TO SURFACE", ", TYPE=SURFACE TO SURFACE"])
@pytest.mark.parametrize("words", ENFORCED)
@pytest.mark.parametrize("kind", ["CPE4", "C3D8"])
def test_however_contact_is_enforced(solve, kind, words, pair):
    result = solve(die(kind, "FINITE", 0.1, "wedge", words, pair), refused=True)
    check(result, 3 if kind.startswith("C3") else 2)


@pytest.mark.parametrize("kind", ["C3D4", "C3D8", "C3D10"])
@pytest.mark.parametrize("path", ["", "FINITE"])
def test_of_tools_of_triangles(solve, kind, path, tmp_path):
    result = solve(die(kind, path, 0.1, "wedge", tool="STL", folder=tmp_path), refused=True)
    check(result, 3)
