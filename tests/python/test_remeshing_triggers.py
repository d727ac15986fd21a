"""Reasons to make a mesh anew."""
from types import SimpleNamespace

import numpy as np
import pytest

from lopin.remesh.card import RemeshCard
from lopin.remesh.part import Clock
from lopin.remesh.triggers import CREEPS, PATIENCE, STALLED, reason_to_remesh


def why(number, passed, following, before=0.25, first=0.0):
    """The reason on four squares that nothing has worn, `passed` after their part began."""
    x, y = (c.ravel() for c in np.meshgrid([0.0, 1.0, 2.0], [0.0, 1.0, 2.0]))
    body = SimpleNamespace(cells=[np.array([[0, 1, 4, 3], [1, 2, 5, 4], [3, 4, 7, 6], [4, 5, 8, 7]])], ndim=2,
                           elements=np.arange(1, 5), facets=np.zeros((0, 2), int), tags=None)
    now = SimpleNamespace(x=np.stack([x, y], axis=1), points=SimpleNamespace(element=np.arange(1, 5), plastic=np.zeros(4)),
                          clock=Clock(1, 0.0, before + passed, following, False, number))
    tools = SimpleNamespace(feet_of_facets=lambda *unused: [])
    return reason_to_remesh(body, RemeshCard("ALL", smallest=0.1), {}, Clock(1, 0.0, before, first, False, 0), now, tools, 1.0)


@pytest.mark.parametrize("unit", [1.0, 1e-3, 1e3])
def test_increments_that_come_to_a_standstill(unit):
    """A next increment of less than an eighth of those of the part, but not within the first three."""
    assert why(10, 0.1*unit, 0.99*STALLED*0.01*unit, 0.25*unit).startswith("increments of")
    assert not why(10, 0.1*unit, 1.01*STALLED*0.01*unit, 0.25*unit)
    assert not why(PATIENCE, 0.1*unit, 1e-6*unit, 0.25*unit)


@pytest.mark.parametrize("unit", [1.0, 1e-3, 1e3])
def test_increments_that_are_small_from_the_start_of_a_part(unit):
    """A next increment of less than a 4000th of the way so far."""
    assert why(10, 1e-5*unit, 0.99*CREEPS*unit, unit).startswith("increments of")
    assert not why(10, 1e-5*unit, 1.01*CREEPS*unit, unit)


def test_increments_that_grow_again_go_on():
    assert why(10, 1e-5, 0.9*CREEPS, 1.0, 0.91*CREEPS)
    assert not why(10, 1e-5, 0.9*CREEPS, 1.0, 0.89*CREEPS)
