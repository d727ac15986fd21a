"""Contact pressure along a slave surface of the plane."""
from __future__ import annotations

import numpy as np

from .shape import Part, Shape


def last_pressed(shape: Shape, part: Part) -> int | None:
    """The last frame in which the surface is pressed."""
    pressure = part.fields.get("contact pressure", [])
    pressed = [i for i, values in enumerate(pressure) if np.nanmax(values, initial=0.0) > 0.0]
    return pressed[-1] if pressed and shape.dimensions == 2 else None


def chains(faces) -> list[list[int]]:
    """Points of lines in the order in which they hang together, a list a piece.

    >>> chains([(2, 1), (0, 1), (5, 4)])
    [[0, 1, 2], [4, 5]]
    """
    beside: dict[int, list[int]] = {}
    for a, b in (face for face in faces if len(face) == 2):
        beside.setdefault(int(a), []).append(int(b))
        beside.setdefault(int(b), []).append(int(a))
    left, found = set(beside), []
    while left:
        ends = [k for k in left if len(beside[k]) == 1]
        chain = [min(ends or left)]
        left.discard(chain[0])
        while True:
            following = [k for k in beside[chain[-1]] if k in left]
            if not following:
                break
            chain.append(following[0])
            left.discard(following[0])
        found.append(chain)
    return sorted(found)


def along(part: Part, frame: int, field: str) -> list[tuple[np.ndarray, np.ndarray]]:
    """Length along the surface from its end, and values; one piece after another.

    Surfaces of single points are taken in the order of their first coordinate.
    """
    places, values = part.places[frame], np.asarray(part.fields[field][frame])
    pieces = chains(part.faces(frame))
    if not pieces:
        order = np.argsort(places[:, 0])
        return [(places[order, 0], values[order])]
    found = []
    for chain in pieces:
        if places[chain[0], 0] > places[chain[-1], 0]:
            chain = chain[::-1]
        steps = np.linalg.norm(np.diff(places[chain], axis=0), axis=1)
        found.append((np.concatenate([[0.0], np.cumsum(steps)]), values[chain]))
    return found
