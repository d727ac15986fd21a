"""Where the middle of an edge lies on the smooth surface that a mesh of flat faces stands for.

A boundary of straight edges stands for a smooth one wherever neighbouring faces turn by little.
The middle of an edge is lifted to the arc of a circle that leaves both ends along the surface:
exact where the nodes lie on a circle (in the plane) or a sphere.
"""
from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

#: Faces that turn by more meet in an edge of the body [rad].
CREASE = np.deg2rad(30.0)


def lifts_in_plane(x: NDArray, edges: NDArray) -> NDArray:
    """From the middles of boundary edges to the smooth boundary (edge, 2) [length].

    `x`: nodes (node, 2); `edges`: rows of their two ends, the body on the left of the way.
    """
    after = {a: k for k, (a, b) in enumerate(edges.tolist())}
    before = {b: k for k, (a, b) in enumerate(edges.tolist())}
    along = x[edges[:, 1]] - x[edges[:, 0]]
    length = np.linalg.norm(along, axis=1)
    angle = np.arctan2(along[:, 1], along[:, 0])
    lifts = np.zeros((len(edges), 2))
    for k, (a, b) in enumerate(edges.tolist()):
        bends = [_bend(angle, length, before.get(a), k), _bend(angle, length, k, after.get(b))]
        # The chord leaves the arc by this angle at its ends; outward is to the right of the way.
        half = 0.5*_agreed([v for v in bends if v is not None])*length[k]
        out = np.array([along[k, 1], -along[k, 0]])
        lifts[k] = 0.5*np.tan(0.5*half)*out
    return lifts


def _agreed(ends: list[float]) -> float:
    """What both ends of an edge say of its bend: their mean; nothing where they disagree, as
    beside a flat or a turning point.

    >>> _agreed([1.0, 0.5]), _agreed([1.0, 0.1]), _agreed([1.0, -1.0]), _agreed([1.0])
    (0.75, 0.0, 0.0, 1.0)
    """
    if not ends or min(ends)*max(ends) < 0.0:
        return 0.0
    least, most = sorted(map(abs, (ends[0], ends[-1])))
    return float(np.mean(ends)) if 3.0*least >= most else 0.0


def _bend(angle: NDArray, length: NDArray, first, second) -> float | None:
    """Curvature where one edge follows another [1/length]; None at a crease or an end."""
    if first is None or second is None:
        return None
    turn = (angle[second] - angle[first] + np.pi) % (2.0*np.pi) - np.pi
    if abs(turn) > CREASE:
        return None
    # Of the circle through the three nodes: half angles of the chords add up to the turn.
    return 2.0*turn/(length[first] + length[second])


def lifts_in_space(x: NDArray, faces: list[NDArray], edges: NDArray) -> NDArray:
    """From the middles of edges of the boundary to the smooth boundary (edge, 3) [length].

    `faces`: corners of the boundary's faces, arrays (face, 3 or 4), outward; `edges`: their edges.
    Each end has the mean normal of the faces around it that belong to the smooth piece of the
    faces beside the edge; an edge between faces that turn by more than `CREASE` is bent only
    along itself, by the creases that go on at its ends.
    """
    normal = np.vstack([_normals(x, f) for f in faces])
    corners = [row for f in faces for row in f.tolist()]
    at_node: dict[int, list[int]] = {}
    at_edge: dict[tuple[int, int], list[int]] = {}
    for k, row in enumerate(corners):
        for a, b in zip(row, row[1:] + row[:1]):
            at_node.setdefault(a, []).append(k)
            at_edge.setdefault((min(a, b), max(a, b)), []).append(k)
    creases = _creases(at_edge, normal)
    lifts = np.zeros((len(edges), 3))
    for k, (a, b) in enumerate(edges.tolist()):
        key = (min(a, b), max(a, b))
        if key in creases[1]:
            lifts[k] = _along_crease(x, key, creases[0])
            continue
        own = normal[at_edge[key]].mean(axis=0)
        ends = []
        for node in (a, b):
            if node in creases[0]:
                continue   # the surface ends here: its faces tell nothing of the bend beyond
            near = [f for f in at_node[node] if normal[f] @ own/np.linalg.norm(own)
                    > np.cos(CREASE)*np.linalg.norm(normal[f])]
            mean = normal[near].sum(axis=0) if near else own
            ends.append((1.0 if node == b else -1.0, mean/np.linalg.norm(mean)))
        lifts[k] = _lift(x[a], x[b], own, ends)
    return lifts


def _normals(x: NDArray, faces: NDArray) -> NDArray:
    """Normals of faces, as long as their areas."""
    if faces.shape[1] == 3:
        return 0.5*np.cross(x[faces[:, 1]] - x[faces[:, 0]], x[faces[:, 2]] - x[faces[:, 0]])
    return 0.5*np.cross(x[faces[:, 2]] - x[faces[:, 0]], x[faces[:, 3]] - x[faces[:, 1]])


def _creases(at_edge: dict, normal: NDArray):
    """Edges where the surface is not smooth: neighbours of nodes along them, and their set."""
    sharp, around = set(), {}
    for key, own in at_edge.items():
        n = normal[own]
        n = n/np.linalg.norm(n, axis=1)[:, None]
        if len(own) == 2 and n[0] @ n[1] > np.cos(CREASE):
            continue
        sharp.add(key)
        for a, b in (key, key[::-1]):
            around.setdefault(a, []).append(b)
    return around, sharp


def _along_crease(x: NDArray, key: tuple[int, int], around: dict) -> NDArray:
    """The lift of the middle of a crease, by the creases that go on at its ends."""
    a, b = key
    chord = x[b] - x[a]
    long = np.linalg.norm(chord)
    bends = []
    for near, far in ((a, b), (b, a)):
        on = [n for n in around[near] if n != far]
        if len(on) != 1:
            continue
        step = x[near] - x[on[0]]
        this = x[far] - x[near]
        turn = this/np.linalg.norm(this) - step/np.linalg.norm(step)
        size = np.linalg.norm(turn)
        if 0.0 < size < 2.0*np.sin(0.5*CREASE):
            angle = 2.0*np.arcsin(0.5*size)
            bends.append(2.0*angle/size*turn/(np.linalg.norm(this) + np.linalg.norm(step)))
    if not bends:
        return np.zeros(3)
    bend = np.mean(bends, axis=0)
    bend -= (bend @ chord)*chord/long**2
    size = np.linalg.norm(bend)
    return -0.5*long*np.tan(0.25*size*long)*bend/size if size > 0.0 else np.zeros(3)


def _lift(a: NDArray, b: NDArray, own: NDArray, ends: list[tuple[float, NDArray]]) -> NDArray:
    """The lift of the middle of a chord; `ends`: unit normals where they are known, with -1 at a
    and 1 at b; `own`: mean normal of the faces beside the chord."""
    chord = b - a
    long = np.linalg.norm(chord)
    mean = sum(n for _, n in ends) if ends else own
    mean = mean - (mean @ chord)*chord/long**2
    size = np.linalg.norm(mean)
    if not ends or size == 0.0:
        return np.zeros(3)
    angles = [np.arcsin(np.clip(s*(n @ chord)/long, -1.0, 1.0)) for s, n in ends]
    return 0.5*long*np.tan(0.5*_agreed(angles))*mean/size
