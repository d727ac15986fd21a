"""The next operation: the metal of an open run as the deck of another one, trimmed if asked.

The mesh stands in its present shape, the state of its points goes along to the last bit, tools,
supports and steps are new. Trimming takes out the elements beyond a plane or curve, whole or
divided along it; what they held is let go of in the first increment.
"""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from .deck import Block, Deck
from .errors import ModelError, UsageError
from .job import Job
from .material_cards import before_steps, beyond_points, of_body, temperatures_of
from .model_read_mesh import plain


@dataclass
class Carried:
    """What went on, and what was taken out.

    Attributes
    ----------
    elements, volume : that go on [length^3]
    gone, gone_volume : taken out [length^3]
    """

    elements: int
    volume: float
    gone: int
    gone_volume: float

    def line(self) -> str:
        """For a terminal."""
        share = self.gone_volume/(self.volume + self.gone_volume)
        return (f"{self.elements} elements of {self.volume:.6g} go on; trimmed: {self.gone} of "
                f"{self.gone_volume:.6g}, {100*share:.3g} % of the volume")


def beyond_plane(point, normal) -> Callable[[NDArray], NDArray]:
    """A cut by a plane: what lies on the side that the normal points to.

    >>> beyond_plane((1.0, 0.0), (1.0, 0.0))(np.array([[0.5, 3.0], [1.5, 3.0]])).tolist()
    [False, True]
    """
    distance = signed_plane(point, normal)
    return lambda places: distance(places) > 0.0


def signed_plane(point, normal) -> Callable[[NDArray], NDArray]:
    """A cut by a plane that divides elements: the distance, positive where the normal points to.

    >>> signed_plane((1.0, 0.0), (2.0, 0.0))(np.array([[0.5, 3.0], [1.5, 3.0]])).tolist()
    [-0.5, 0.5]
    """
    point, normal = np.asarray(point, float), np.asarray(normal, float)
    length = np.linalg.norm(normal)
    if point.shape not in ((2,), (3,)) or normal.shape != point.shape or \
            not np.isfinite(point).all() or not 0.0 < length < np.inf:
        raise UsageError(f"no plane goes through {point.tolist()} across {normal.tolist()}",
                         help="a point and a normal of two or three finite numbers each, not all "
                              "of the normal 0")

    def distance(places):
        if places.shape[1] != len(point):
            raise UsageError(f"the plane has {len(point)} coordinates, the body "
                             f"{places.shape[1]}")
        return (places - point) @ (normal/length)
    return distance


def next_operation(job: Job, elset: str, cards: str, *, name: str,
                   trim: Callable[[NDArray], NDArray] | None = None,
                   cut: Callable[[NDArray], NDArray] | None = None) -> tuple[Deck, Carried]:
    """The deck of the next operation, from where an open run stands.

    Parameters
    ----------
    job : open, after an accepted increment: called inside the loop over its frames
    elset : the body that goes on; its sets, surfaces, material, section and what that names keep
        their names, temperatures of the start go along
    cards : tools, interactions, contact pairs, supports and steps of the next operation
    name : of the new deck
    trim : told the present centres of the elements (element, ndim), says which are taken out
    cut : told places (n, ndim), a number for each, positive in what is taken out and continuous;
        elements are divided where it is 0, and both parts have the state of the whole
    """
    from .remesh.body import DeckParts, read_body
    from .remesh.part import _mesh_blocks, _surface, new_labels
    from .remesh.part import state_block
    from .remesh.separate import counted
    from .remesh.state import Snapshot

    refuse_ended(job)
    if trim is not None and cut is not None:
        raise ModelError("both trim and cut are given", help="one of them: cut divides elements")
    parts = DeckParts.of(job.deck)
    body = read_body(parts, elset.upper())
    own, members = set(body.labels.tolist()), set(body.elements.tolist())
    named = parts.cards
    material = of_body(parts.blocks, named, members)
    if beyond_points(material):
        raise ModelError(f"{beyond_points(material)}: Hill's surface and backstress do not go to a "
                         "mesh in its present shape",
                         help="lopin.same_mesh.next_on_same_mesh takes them along")
    warm = temperatures_of(parts.blocks, named, own)
    last = Snapshot.of(job, body)
    mesh, states, gone, volume, origin = \
        _trimmed(body, last, trim) if cut is None else _divided(body, last, cut)
    named.nodes = {n: x for n, x in named.nodes.items() if n in own}
    named.elements = {e: c for e, c in named.elements.items() if e in members}
    named.elsets = {k: v for k, v in named.elsets.items() if members & set(v)}
    body.others = {}
    node_label, element_label = new_labels(parts, body, mesh)
    deck = Deck(name=name, folder=job.deck.folder)
    deck.blocks = _mesh_blocks(parts, body, mesh, node_label, element_label)
    deck.blocks += [_surface(parts, body, mesh, block, element_label) for block in
                    before_steps(parts.blocks)
                    if block.keyword == "SURFACE" and _of_faces(block, named)]
    # *DAMAGE goes on to count.
    deck.blocks += [counted(block) for block in material]
    if warm:
        old = np.array([warm.get(int(n), 0.0) for n in body.labels])
        deck.blocks.append(Block("INITIAL CONDITIONS", {"TYPE": "TEMPERATURE"}, [
            [int(n), float(t)] for n, t in zip(node_label, origin(old))]))
    deck.blocks.append(state_block(parts, body, mesh, states))
    deck.blocks += Deck.parse(cards, name=name).blocks
    return deck, Carried(int((~gone).sum()), float(volume[~gone].sum()), int(gone.sum()),
                         float(volume[gone].sum()))


def refuse_ended(job: Job) -> None:
    """A run that has ended has let go of the state that would go on."""
    if not job.is_open:
        raise UsageError("the run has ended, and its state is gone: there is nothing to go on from",
                         help="call it inside the loop: for frame in job: deck, carried = "
                              "next_operation(job, ...); the last increment's deck stays")


def _trimmed(body, last, trim):
    """Mesh and states without whole elements; which are gone, and the volume of each; what takes
    values of the old nodes to the new."""
    from .remesh.separate import rows_of, states_of_rest, without

    centre = np.concatenate([last.x[group].mean(axis=1) for group in body.cells])
    gone = taken_out(trim, centre)
    row = rows_of(body, last.points)
    volume = np.bincount(row, last.points.volume, len(gone) + 1)[:-1]
    mesh, old = without(body, last.x, gone)
    return mesh, states_of_rest(body, last.points, gone), gone, volume, lambda value: value[old]


def _divided(body, last, cut):
    """The same, elements divided."""
    from .remesh.clip import clip, facets_of
    from .remesh.separate import rows_of, states_of_rest, without

    parts = clip(last.x, body.cells, _levels(cut))
    facets, tags = facets_of(parts, body.facets, body.tags, body.ndim)
    gone = np.concatenate(parts.beyond)
    _refuse_nothing_left(gone)
    mesh, old = without(replace(body, cells=parts.cells, facets=facets, tags=tags), parts.x, gone)
    states = states_of_rest(body, last.points, np.zeros(len(body.elements), bool))
    points = [point for group in states for point in group]
    kept = []
    for cells, parent, beyond in zip(parts.cells, parts.parent, parts.beyond):
        own = [points[n] for n in parent[~beyond]]
        if own:
            simple = cells.shape[1] == body.ndim + 1
            kept.append(np.stack([p.mean(axis=0, keepdims=True) if simple else p for p in own]))
    size = np.concatenate([measures(parts.x, cells, body.axisymmetric) for cells in parts.cells])
    parent = np.concatenate(parts.parent)
    n = len(body.elements)
    whole = np.bincount(rows_of(body, last.points), last.points.volume, n + 1)[:n]
    a, b = parts.ends[old].T
    length = np.linalg.norm(last.x[b] - last.x[a], axis=1)
    share = np.linalg.norm(mesh.x - last.x[a], axis=1)/np.where(length > 0.0, length, 1.0)
    return mesh, kept, gone, size*(whole/np.bincount(parent, size, n))[parent], \
        lambda value: value[a] + share*(value[b] - value[a])


def measures(x: NDArray, cells: NDArray, axisymmetric: bool) -> NDArray:
    """Volumes, or areas in a plane, of cells; around the axis with their mean radius."""
    corners = x[cells]
    if x.shape[1] == 3:
        return np.abs(np.linalg.det(corners[:, 1:] - corners[:, :1]))/6.0
    total = np.zeros(len(cells))
    for k in range(1, cells.shape[1] - 1):
        area = 0.5*np.abs(np.linalg.det(corners[:, [k, k + 1]] - corners[:, :1]))
        total += area*(corners[:, [0, k, k + 1], 0].sum(axis=1) if axisymmetric else 1.0)
    return total


def measures_of(points, members: list[int]) -> NDArray:
    """Present volumes of elements, of their points."""
    at = {label: k for k, label in enumerate(members)}
    row = np.array([at.get(int(label), len(members)) for label in points.element])
    return np.bincount(row, points.volume, len(members) + 1)[:len(members)]


def taken_out(trim: Callable[[NDArray], NDArray] | None, centre: NDArray) -> NDArray:
    """Which elements a trim takes out, told their centres."""
    if trim is None:
        return np.zeros(len(centre), bool)
    if not callable(trim):
        raise UsageError(f"trim is a function of places, not {trim!r}", help="beyond_plane(...)")
    gone = np.asarray(trim(centre))
    if gone.shape != (len(centre),):
        raise UsageError(f"trim gives a table of shape {gone.shape} for {len(centre)} elements",
                         help="True or False for each of them")
    if gone.dtype != bool and not np.isin(gone, (0, 1)).all():
        raise UsageError("trim says True or False for each element, and gives others",
                         help="distances, as of signed_plane, are a cut: cut=... divides elements, "
                              "trim=beyond_plane(...) takes whole ones")
    gone = gone.astype(bool)
    _refuse_nothing_left(gone)
    return gone


def _levels(cut: Callable[[NDArray], NDArray]) -> Callable[[NDArray], NDArray]:
    """A cut, with what it gives looked at."""
    if not callable(cut):
        raise UsageError(f"cut is a function of places, not {cut!r}", help="signed_plane(...)")

    def level(places):
        value = np.asarray(cut(places))
        if value.shape != (len(places),):
            raise UsageError(f"cut gives a table of shape {value.shape} for {len(places)} places",
                             help="a number for each of them")
        if value.dtype.kind not in "fiu" or not np.isfinite(value).all():
            raise UsageError("cut gives what is no number", help="a distance for each place, "
                             "positive in what is taken out, as signed_plane does; what says True "
                             "or False is a trim")
        return value.astype(float)
    return level


def _refuse_nothing_left(gone: NDArray) -> None:
    if gone.all():
        raise ModelError("the cut takes all elements out", help="the other side of it stays")


def _of_faces(block: Block, named) -> bool:
    """Whether a surface is one of faces of the body."""
    kind = str(plain(block.parameters.get("TYPE", "ELEMENT"))).upper()
    if kind != "ELEMENT":
        return False
    return any(row[0] in named.elements if isinstance(row[0], int) else
               str(row[0]).upper() in named.elsets for row in block.data)
