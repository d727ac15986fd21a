"""Axes that *TRANSFORM gives to nodes: one rule for all that reads the card in Python."""
from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .deck import Block
from .errors import ModelError
from .model_read_mesh import plain

#: Of a length: places nearer to an axis are on it.
_ON_AXIS = 1e-9


def is_cylindrical(block: Block) -> bool:
    """TYPE=C: axes that turn from place to place, around a line.

    >>> is_cylindrical(Block("TRANSFORM", {"TYPE": "C"})), is_cylindrical(Block("TRANSFORM"))
    (True, False)
    """
    return str(plain(block.parameters.get("TYPE", "R"))).upper() == "C"


def axes_at(block: Block, x: ArrayLike) -> tuple[NDArray, NDArray]:
    """Axes of a card at places x (n, ndim), rows, in space (n, 3, 3); which places lie on the line
    of a cylindrical system (n,).

    The first axis is along the first point, or radial; the third across both points, or along the
    line through them. On that line the first is one direction for all, as the solver has it.

    >>> card = Block("TRANSFORM", {"TYPE": "C"}, [[0., 0., 0., 0., 0., 1.]])
    >>> axes, on = axes_at(card, [[0., 2.], [0., 0.]])
    >>> axes[0].tolist(), on.tolist()
    ([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], [False, True])
    """
    x = np.asarray(x, float)
    space = np.zeros((len(x), 3))
    space[:, :x.shape[1]] = x
    values = [float(v or 0.0) for v in block.data[0]] if block.data else []
    a, b = np.array([*values, *[0.0]*6][:6]).reshape(2, 3)
    third = b - a if is_cylindrical(block) else np.cross(a, b)
    long = np.linalg.norm(third)
    if not long > 0.0:
        raise ModelError("the points of *TRANSFORM give no axes", id="E0405")
    first, on = np.tile(a, (len(x), 1)), np.zeros(len(x), bool)
    if is_cylindrical(block):
        first, on = _radial(space - a, third/long, long)
    first = first/np.linalg.norm(first, axis=1)[:, None]
    third = np.broadcast_to(third/long, first.shape)
    return np.stack([first, np.cross(third, first), third], axis=1), on


def _radial(arm: NDArray, unit: NDArray, long: float) -> tuple[NDArray, NDArray]:
    """Directions away from a line at arms from one of its points; which of them are on it."""
    away = arm - np.outer(arm @ unit, unit)
    on = ~(np.linalg.norm(away, axis=1) > _ON_AXIS*np.maximum(long, np.linalg.norm(arm, axis=1)))
    if abs(unit[0]) > _ON_AXIS:
        across = [-unit[1]/unit[0], 1.0, 0.0]
    else:
        across = [0.0, -unit[2]/unit[1], 1.0] if abs(unit[1]) > _ON_AXIS else [1.0, 0.0, 0.0]
    away[on] = across
    return away, on
