"""Closest points on surfaces of element faces: those of a box, inside, outside and off its edges."""
import numpy as np
import pytest

import lopin
from lopin.remesh.body import DeckParts
from lopin.remesh.masters import FacetMaster

CUBE = """*NODE
1, 0., 0., 0.
2, 2., 0., 0.
3, 2., 3., 0.
4, 0., 3., 0.
5, 0., 0., 4.
6, 2., 0., 4.
7, 2., 3., 4.
8, 0., 3., 4.
*ELEMENT, TYPE=C3D8, ELSET=B
1, 1, 2, 3, 4, 5, 6, 7, 8
*SURFACE, NAME=ALL
B,
*SURFACE, NAME=TOP
B, S2
"""
SQUARE = CUBE.replace(", 0.\n", "\n").replace("TYPE=C3D8", "TYPE=CPE4").replace(
    "1, 1, 2, 3, 4, 5, 6, 7, 8", "1, 1, 2, 3, 4").replace("B, S2", "B, S3")


def master(text, name, ndim):
    lines = [line for line in text.splitlines() if ndim == 3 or line[:2] not in
             ("5,", "6,", "7,", "8,")]
    return FacetMaster.of(DeckParts.of(lopin.Deck.parse("\n".join(lines), name="box")), name, ndim)


@pytest.mark.parametrize("text, ndim", [(CUBE, 3), (SQUARE, 2)])
def test_distances_from_a_box_have_the_right_side(text, ndim):
    """Places on the planes of its sides too, where the normal of one facet tells nothing."""
    high = np.array([2.0, 3.0, 4.0][:ndim])
    still = np.empty((0, 5))
    places = np.random.default_rng(3).uniform(-1.0, 5.0, (400, ndim))
    places[::4, 0], places[1::4, 1] = 0.0, 3.0
    found = master(text, "ALL", ndim).feet(places, still)
    outside = np.maximum(np.maximum(-places, places - high), 0.0)
    far = np.linalg.norm(outside, axis=1)
    depth = np.minimum(places, high - places).min(axis=1)
    expected = np.where(far > 0.0, far, -depth)
    assert found[:, 0] == pytest.approx(expected, abs=1e-12)
    assert not found[:, 1].any()
    foot = found[:, 2:2 + ndim]
    assert np.linalg.norm(places - foot, axis=1) == pytest.approx(np.abs(expected), abs=1e-12)


def test_beyond_the_rim_of_an_open_surface_is_told():
    top = master(CUBE, "TOP", 3)
    found = top.feet(np.array([[1.0, 1.0, 4.5], [3.0, 1.0, 4.5], [1.0, 1.0, 3.9]]),
                     np.empty((0, 5)))
    assert found[:, 0] == pytest.approx([0.5, 0.5, -0.1])
    assert found[:, 1] == pytest.approx([0.0, 1.0, 0.0])


def test_facets_go_with_their_nodes():
    """`motion`: a row a degree of freedom, label, dof, displacement."""
    top = master(CUBE, "TOP", 3)
    motion = np.array([[n, 3, 0.25, 0.0, 0.0] for n in (5, 6, 7, 8)])
    assert top.feet(np.array([[1.0, 1.0, 4.5]]), motion)[0, 0] == pytest.approx(0.25)


@pytest.mark.parametrize("text, ndim, name", [(CUBE, 3, "TOP"), (SQUARE, 2, "TOP")])
def test_points_bear_where_all_corners_below_them_do(text, ndim, name):
    """Near the facet, and not where a corner that counts is free."""
    face, still = master(text, name, ndim), np.empty((0, 5))
    level = 4.0 if ndim == 3 else 3.0
    places = np.array([[0.5, 1.0], [1.5, 2.0], [0.0, 0.0]]) if ndim == 3 else np.array([[0.5], [2.0], [0.0]])
    on = np.column_stack([places, np.full(3, level)])
    every = face.labels
    assert face.bears(on, still, every).all()
    assert face.bears(on + [*[0.0]*(ndim - 1), 0.01], still, every).all()
    assert not face.bears(on + [*[0.0]*(ndim - 1), 1.0], still, every).any()
    far = every[np.argmin(np.linalg.norm(face.start - on[2], axis=1))]   # the corner at the last place
    assert face.bears(on, still, every[every != far]).tolist()[2] is False
    assert face.bears(on, still, np.array([far])).tolist() == [False, False, True]
