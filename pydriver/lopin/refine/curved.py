"""Where the middle of an edge lies on the smooth surface that a mesh of flat faces stands for.

A boundary of straight edges stands for a smooth one where it turns by little from edge to edge, and
by as much at three nodes in a row: one turn, or two beside straight edges, are corners of the body.
Where a surface ends on another, its image in that one tells of a plane of symmetry.
The middle of an edge is lifted to the arc of a circle that leaves both ends along the surface:
exact where the nodes lie on a circle (in the plane) or a sphere.
"""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

#: Faces that turn by more meet in an edge of the body [rad].
CREASE = np.deg2rad(30.0)
#: Nodes that must tell of the same bend.
IN_A_ROW = 3


@dataclass(frozen=True)
class Bend:
    """Curvature of a boundary at a node [1/length]."""

    size: float
    image: bool = False   #: the surface ends: as a mirror in the face that meets it there would say


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
    followers = [[way.get(n) for n in edges[:, end].tolist()]
                 for way, end in ((before, 0), (after, 1))]
    for k in range(len(edges)):
        ends = [_bends(angle, length, k, on, end) for end, on in enumerate(followers)]
        # The chord leaves the arc by this angle at its ends; outward is to the right of the way.
        half = 0.5*_agreed(*ends)*length[k]
        out = np.array([along[k, 1], -along[k, 0]])
        lifts[k] = 0.5*np.tan(0.5*half)*out
    return lifts


def _bends(angle: NDArray, length: NDArray, k: int, follower: list, end: int) -> list[Bend]:
    """Curvatures at the nodes that follow an edge [1/length], nearest first: of the circle through
    three nodes, whose half angles of the chords add up to the turn."""
    found: list[Bend] = []
    while len(found) < IN_A_ROW:
        other = follower[k]
        if other is None:
            break
        turn = _wrapped((angle[other] - angle[k])*(1.0 if end else -1.0))
        if abs(turn) > CREASE:
            turn = _wrapped(2.0*turn - np.pi)
            if abs(turn) <= CREASE:
                found.append(Bend(turn/length[k], image=True))
            break
        found.append(Bend(2.0*turn/(length[k] + length[other])))
        k = other
    return found


def _wrapped(angle: float) -> float:
    return (angle + np.pi) % (2.0*np.pi) - np.pi


def _agreed(before: list[Bend], after: list[Bend]) -> float:
    """What the nodes before and after an edge, nearest first, say of its bend: the mean of its two
    ends; nothing where three in a row disagree, as beside a flat, a corner or a turning point.

    >>> bends = [Bend(v) for v in (1.0, 0.5, 1.0)]
    >>> _agreed(bends[:1], bends[1:]), _agreed([], bends), _agreed([], bends[1:])
    (0.75, 1.0, 0.0)
    >>> _agreed([Bend(1.0)], [Bend(1.0), Bend(0.0)]), _agreed([Bend(0.0)], bends)
    (0.0, 0.0)
    """
    if before and after and _alike([before[0], after[0]]):
        told = [v.size for v in (before[0], after[0]) if not v.image]
        if told and any(_alike([before[0], after[0], third])
                        for third in (*before[1:2], *after[1:2])):
            return float(np.mean(told))
    for near, far in ((before, after), (after, before)):
        # The end of the surface, where it is no plane of symmetry, does not say anything.
        if (not near or near[0].image) and len(far) == IN_A_ROW and _alike(far) \
                and not far[0].image:
            return far[0].size
    return 0.0


def _alike(bends: list[Bend]) -> bool:
    """Whether curvatures are of one sign, and of one size within a factor of three."""
    sizes = [v.size for v in bends]
    return min(sizes)*max(sizes) > 0.0 and 3.0*min(map(abs, sizes)) >= max(map(abs, sizes))


def lifts_in_space(x: NDArray, faces: list[NDArray], edges: NDArray) -> NDArray:
    """From the middles of edges of the boundary to the smooth boundary (edge, 3) [length].

    `faces`: corners of the boundary's faces, arrays (face, 3 or 4), outward; `edges`: their edges.
    Each end has the mean normal of the faces around it that belong to the smooth piece of the
    faces beside the edge; an edge between faces that turn by more than `CREASE` is bent only
    along itself, by the creases that go on at its ends.
    """
    skin = _Skin(x, faces)
    return np.array([skin.along_crease(a, b) if (min(a, b), max(a, b)) in skin.sharp
                     else skin.lift(a, b) for a, b in edges.tolist()]).reshape(-1, 3)


class _Skin:
    """The boundary of bodies in space.

    Attributes
    ----------
    normal : unit normals of the faces, and their areas `area`
    at_node, at_edge : faces by node and by sorted edge
    sharp, creases : edges where the surface is not smooth, and their far nodes by node
    smooth : far nodes of the other edges by node
    """

    def __init__(self, x: NDArray, faces: list[NDArray]):
        self.x = x
        normal = np.vstack([_normals(x, f) for f in faces])
        self.area = np.linalg.norm(normal, axis=1)
        self.normal = normal/self.area[:, None]
        self.at_node: dict[int, list[int]] = {}
        self.at_edge: dict[tuple[int, int], list[int]] = {}
        for k, row in enumerate(row for f in faces for row in f.tolist()):
            for a, b in zip(row, row[1:] + row[:1]):
                self.at_node.setdefault(a, []).append(k)
                self.at_edge.setdefault((min(a, b), max(a, b)), []).append(k)
        self.sharp: set[tuple[int, int]] = set()
        self.creases: dict[int, list[int]] = {}
        self.smooth: dict[int, list[int]] = {}
        for key, own in self.at_edge.items():
            flat = len(own) == 2 and self.normal[own[0]] @ self.normal[own[1]] > np.cos(CREASE)
            if not flat:
                self.sharp.add(key)
            for a, b in (key, key[::-1]):
                (self.smooth if flat else self.creases).setdefault(a, []).append(b)
        self._known: dict[tuple[int, int], tuple[NDArray, Bend] | None] = {}

    def lift(self, a: int, b: int) -> NDArray:
        """The lift of the middle of an edge within a smooth piece."""
        chord = self.x[b] - self.x[a]
        long = np.linalg.norm(chord)
        ends = [end[0] for end in (self._end(b, a), self._end(a, b)) if end and not end[1].image]
        mean = sum(ends)
        if ends:
            mean = mean - (mean @ chord)*chord/long**2
        size = np.linalg.norm(mean)
        if size == 0.0:
            return np.zeros(3)
        half = 0.5*long*_agreed(self._bends(b, a), self._bends(a, b))
        return 0.5*long*np.tan(0.5*half)*mean/size

    def _bends(self, a: int, b: int) -> list[Bend]:
        """Curvatures at b and at the nodes that follow on the straightest way from a."""
        found: list[Bend] = []
        while len(found) < IN_A_ROW:
            end = self._end(a, b)
            if end is None:
                break
            found.append(end[1])
            on = [n for n in self.smooth.get(b, ()) if n != a]
            if end[1].image or not on:
                break
            way = self.x[on] - self.x[b]
            way = way @ (self.x[b] - self.x[a])/np.linalg.norm(way, axis=1)
            if way.max() <= np.sqrt(0.5)*np.linalg.norm(self.x[b] - self.x[a]):
                break
            a, b = b, on[int(np.argmax(way))]
        return found

    def _end(self, a: int, b: int) -> tuple[NDArray, Bend] | None:
        """Unit normal at b of the smooth piece around an edge, and the curvature along the edge;
        None where b lies on a crease that is no plane of symmetry."""
        if (a, b) in self._known:
            return self._known[a, b]
        faces = self.at_edge[min(a, b), max(a, b)]
        own = self.area[faces] @ self.normal[faces]
        own /= np.linalg.norm(own)
        at = self.at_node[b]
        near = self.normal[at] @ own > np.cos(CREASE)
        mean = np.sum([self.area[f]*self.normal[f] for f, n in zip(at, near) if n], axis=0) \
            if near.any() else own
        chord = self.x[b] - self.x[a]
        long = np.linalg.norm(chord)
        image = b in self.creases
        if image:
            wall = self._wall([f for f, n in zip(at, near) if not n], chord)
            mean = None if wall is None else mean - (mean @ wall)*wall
        found = None
        if mean is not None and np.linalg.norm(mean) > 0.0:
            mean = mean/np.linalg.norm(mean)
            angle = float(np.arcsin(np.clip(mean @ chord/long, -1.0, 1.0)))
            if not image or abs(angle) <= 0.5*CREASE:
                found = mean, Bend(2.0*angle/long, image)
        self._known[a, b] = found
        return found

    def _wall(self, faces: list[int], chord: NDArray) -> NDArray | None:
        """Unit normal of the face that a chord runs into; None: there is none."""
        if not faces:
            return None
        return self.normal[max(faces, key=lambda f: abs(float(self.normal[f] @ chord)))]

    def along_crease(self, a: int, b: int) -> NDArray:
        """The lift of the middle of a crease, by the creases that go on at its ends."""
        ends = [self._crease_bends(b, a), self._crease_bends(a, b)]
        told = [v[0] for v in ends if v and not v[0][1]]
        chord = self.x[b] - self.x[a]
        long = np.linalg.norm(chord)
        bend = np.sum([v for v, _ in told], axis=0) if told else np.zeros(3)
        bend = bend - (bend @ chord)*chord/long**2
        size = np.linalg.norm(bend)
        if size == 0.0:
            return np.zeros(3)
        way = bend/size
        size = _agreed(*([Bend(float(np.sign(v @ way)*np.linalg.norm(v)), image)
                          for v, image in end] for end in ends))
        return -0.5*long*np.tan(0.25*size*long)*way

    def _crease_bends(self, a: int, b: int) -> list[tuple[NDArray, bool]]:
        """Curvatures (towards the centre) at b and where creases go on, and whether of an image."""
        found: list[tuple[NDArray, bool]] = []
        while len(found) < IN_A_ROW:
            this = self.x[a] - self.x[b]
            long = np.linalg.norm(this)
            on = [n for n in self.creases[b] if n != a]
            image = len(on) != 1
            if image:
                beside = self.normal[self.at_edge[min(a, b), max(a, b)]]
                wall = self._wall([f for f in self.at_node[b] if (
                    beside @ self.normal[f] < np.cos(CREASE)).all()], this)
                if wall is None:
                    break
                turn = 2.0*(this - (this @ wall)*wall)/long
                step = long
            else:
                step = np.linalg.norm(self.x[on[0]] - self.x[b])
                turn = this/long + (self.x[on[0]] - self.x[b])/step
            size = np.linalg.norm(turn)
            if size > 2.0*np.sin(0.5*CREASE):
                break
            factor = 2.0*np.arcsin(0.5*size)/size if size > 0.0 else 1.0
            found.append((2.0*factor*turn/(long + step), image))
            if image:
                break
            a, b = b, on[0]
        return found


def _normals(x: NDArray, faces: NDArray) -> NDArray:
    """Normals of faces, as long as their areas."""
    if faces.shape[1] == 3:
        return 0.5*np.cross(x[faces[:, 1]] - x[faces[:, 0]], x[faces[:, 2]] - x[faces[:, 0]])
    return 0.5*np.cross(x[faces[:, 2]] - x[faces[:, 0]], x[faces[:, 3]] - x[faces[:, 1]])
