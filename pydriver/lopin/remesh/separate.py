"""Metal that separates: elements whose mean damage is critical are taken out of the mesh."""
from __future__ import annotations

import time
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..deck import Block, Deck
from ..model_read_mesh import plain
from ..points import Points
from .body import (
    Body,
    DeckParts,
    boundary_facets,
    direct_labels,
    faces_of_cell,
    read_body,
    refused,
)
from .part import NewMesh, SkinOrigin, next_deck
from .plane import worst_corner
from .remake import start_block, state_block, traction_block
from .report import Remesh
from .state import Snapshot
from .transfer import fields_of

#: Criteria in the order of the columns of damage.
CRITERIA = ("COCKCROFT-LATHAM", "OYANE", "RICE-TRACEY", "LEMAITRE")


def criticals(blocks: list[Block]) -> dict[str, float]:
    """Critical values of a deck by criterion.

    >>> criticals([Block("DAMAGE", {"CRITERION": "OYANE", "CRITICAL": "0.5"}, [[3.9]])])
    {'OYANE': 0.5}
    """
    return {str(plain(b.parameters["CRITERION"])).upper():
            float(str(plain(b.parameters["CRITICAL"])).upper().replace("D", "E"))
            for b in blocks if b.keyword == "DAMAGE" and "CRITICAL" in b.parameters}


def counted(block: Block) -> Block:
    """A card as the decks of parts have it: *DAMAGE counts there, and separates nothing."""
    if block.keyword != "DAMAGE" or "CRITICAL" not in block.parameters:
        return block
    new = Block(block.keyword, {k: v for k, v in block.parameters.items() if k != "CRITICAL"})
    new.lines = block.lines
    return new


def torn(body: Body, last: Snapshot, critical: dict[str, float]) -> tuple[NDArray, str]:
    """Which elements of the body are beyond a critical value, and the reason in words.

    An element counts by the mean over its points, by volume, of the values that the criterion has
    there: means over its width where it has one.
    """
    points = last.points
    at = {int(label): k for k, label in enumerate(body.elements)}
    row = np.array([at.get(int(label), -1) for label in points.element])
    own = row >= 0
    volume = np.bincount(row[own], points.volume[own], len(body.elements))
    gone, why = np.zeros(len(body.elements), bool), []
    for name, value in critical.items():
        damage = points.damage_mean[own, CRITERIA.index(name)]
        mean = np.bincount(row[own], points.volume[own]*damage, len(body.elements))/volume
        if (mean >= value).any():
            why.append(f"{name} {mean.max():.3g} at least {value:g}")
        gone |= mean >= value
    return gone, ", ".join(why)


def joined(count: int, pairs: NDArray) -> NDArray:
    """The group of each of `count` things that pairs join, named by its first.

    >>> joined(4, np.array([[0, 2], [2, 3]])).tolist()
    [0, 1, 0, 0]
    """
    root = np.arange(count)
    while len(pairs):
        low = np.minimum(root[pairs[:, 0]], root[pairs[:, 1]])
        before = root.copy()
        np.minimum.at(root, pairs[:, 0], low)
        np.minimum.at(root, pairs[:, 1], low)
        root = root[root]
        if (root == before).all():
            break
    return root


def bodies(cells: list[NDArray], n_node: int) -> NDArray:
    """The body of each node: named by its first node."""
    return joined(n_node, np.vstack([np.stack([g[:, 0], g[:, k]], axis=1) for g in cells
                                     for k in range(1, g.shape[1])]))


def split(cells: list[NDArray], ndim: int) -> tuple[list[NDArray], NDArray]:
    """Nodes at which parts of a mesh only touch become one for each part.

    Corners of elements belong together where these share a facet. Returns the cells and the old
    row of each node.
    """
    first = np.cumsum([0, *(g.size for g in cells)])
    node = np.concatenate([g.ravel() for g in cells])
    corner = [np.arange(g.size).reshape(g.shape) + at for g, at in zip(cells, first)]
    facets = []
    for group, own in zip(cells, corner):
        for face in faces_of_cell(ndim, group.shape[1]):
            face = list(face)
            order = np.argsort(group[:, face], axis=1)
            facets.append(np.hstack([np.take_along_axis(group[:, face], order, 1),
                                     np.take_along_axis(own[:, face], order, 1)]))
    facets = np.vstack(facets)
    facets = facets[np.lexsort(facets[:, :ndim].T)]
    same = (facets[1:, :ndim] == facets[:-1, :ndim]).all(axis=1)
    pairs = np.stack([facets[:-1][same, ndim:].ravel(), facets[1:][same, ndim:].ravel()], axis=1)
    groups, number = np.unique(joined(len(node), pairs), return_inverse=True)
    order = np.argsort(node[groups], kind="stable")
    rank = np.empty(len(groups), int)
    rank[order] = np.arange(len(groups))
    number = rank[number.ravel()]
    return [number[own] for own in corner], node[groups][order]


def by_group(body: Body, values: NDArray) -> list[NDArray]:
    """Values of the elements of the body (element, ...), cut as `body.cells` is."""
    return np.split(values, np.cumsum([len(group) for group in body.cells])[:-1])


def named_rows(body: Body) -> dict[str, NDArray]:
    """Rows of the nodes of each set of the body."""
    rows = {name: [np.asarray(own, int)] for name, own in body.named.items()}
    for facet, tag in zip(body.facets, body.tags):
        for kind, name in tag:
            if kind == "N":
                rows.setdefault(name, []).append(facet)
    return {name: np.unique(np.concatenate(own)) for name, own in rows.items()}


def loose(body: Body, last: Snapshot, gone: NDArray) -> NDArray:
    """Elements of bodies that neither supports nor pressed faces hold, once others are gone."""
    apart, old = split([g[~out] for g, out in zip(body.cells, by_group(body, gone))], body.ndim)
    body_of = bodies(apart, len(old))
    names = named_rows(body)
    held = np.zeros(len(body.labels), bool)
    for kind, name in body.held:
        held[names.get(name, [])] = True
    if last.tractions is not None:
        bears = np.abs(last.tractions.traction).max(axis=1, initial=0.0) > 0.0
        held |= np.isin(body.labels, last.tractions.node[bears])
    holding = np.unique(body_of[held[old]])
    found = np.zeros(len(gone), bool)
    if len(holding):
        found[~gone] = ~np.isin(np.concatenate([body_of[g[:, 0]] for g in apart]), holding)
    return found


def without(body: Body, x: NDArray, gone: NDArray) -> tuple[NewMesh, NDArray]:
    """The mesh without these elements, and the old row of each of its nodes.

    Faces that the cut lays bare belong to every surface of the body that the deck names by faces,
    so that they meet the tools that their neighbours meet.
    """
    kept = [g[~out] for g, out in zip(body.cells, by_group(body, gone))]
    cells, old = split([g for g in kept if len(g)], body.ndim)
    facets, _ = boundary_facets(cells, body.ndim)
    known = {tuple(sorted(f)): tag for f, tag in zip(body.facets.tolist(), body.tags)}
    bare = frozenset(entry for tag in body.tags for entry in tag if entry[0] == "S")
    tags = [known.get(tuple(sorted(old[f].tolist())), bare) for f in facets]
    mesh = NewMesh(x[old], cells, facets, tags)
    for name, rows in named_rows(body).items():
        mesh.named[name] = np.flatnonzero(np.isin(old, rows))
    return mesh, old


def states_of_rest(body: Body, points: Points, gone: NDArray) -> tuple[NDArray, list[NDArray]]:
    """Row of the element of each point, -1 outside the body; the fields of the points of elements
    that stay (element, point, field), for each group that has any."""
    number = {int(e): k for k, e in enumerate(body.elements)}
    row = np.array([number.get(int(label), -1) for label in points.element])
    fields, states = fields_of(points), []
    for own in by_group(body, np.arange(len(gone))):
        at = np.flatnonzero(np.isin(row, own))
        at = at[np.lexsort((points.number[at], row[at]))]
        if not gone[own].all():
            states.append(fields[at].reshape(len(own), -1, fields.shape[1])[~gone[own]])
    return row, states


def separate(deck: Deck, last: Snapshot, gone: NDArray, elset: str, why: str, part: int,
             name: str, folder: Path) -> tuple[Deck, Remesh]:
    """The deck of the part that follows without these elements: the rest of the mesh as it is.

    Parameters
    ----------
    deck : of the part that ends, `part` from 1
    last : where it stands
    gone : elements of the body that separate (element,)
    elset : of the body
    why : the reason, in words
    name, folder : of the new deck
    """
    began = time.perf_counter()
    parts = DeckParts.of(deck)
    direct_labels(parts, read_body(parts, elset))
    body = read_body(parts, elset)
    if last.loaded(body):
        raise refused("loads act on nodes of the body that separates",
                      "load a surface by *DSLOAD, or a tool")
    scrap = loose(body, last, gone)
    gone = gone | scrap
    if scrap.any():
        why += f", {int(scrap.sum())} of them in pieces that nothing holds"
    if gone.all():
        raise refused("all elements of the body have separated")
    mesh, old = without(body, last.x, gone)
    points = last.points
    row, states = states_of_rest(body, points, gone)
    inside = np.isin(row, np.flatnonzero(gone))
    volume = float(points.volume[row >= 0].sum())
    share = float(points.volume[inside].sum())/volume
    count = len(np.unique(bodies(mesh.cells, len(mesh.x))))
    skin = np.unique(mesh.facets)
    origin = SkinOrigin(skin, old[skin][:, None], np.ones((len(skin), 1)))
    done = Remesh(part, last.clock.total, f"{int(gone.sum())} elements separate, {why}",
                  sum(len(c) for c in mesh.cells), worst_corner(mesh.x, mesh.cells),
                  {"volume": volume, "volume_change": 0.0}, 0.0, 0.0, excess=0.0,
                  seconds=time.perf_counter() - began, separated=share, pieces=count)
    start: list[Block] = [state_block(parts, body, mesh, states),
                          *traction_block(parts, body, mesh, last, origin),
                          start_block(body, last, parts)]
    return next_deck(parts, body, mesh, name, folder, start), done
