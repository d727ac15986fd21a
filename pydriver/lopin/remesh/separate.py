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
    named_rows,
    read_body,
    refused,
)
from .part import NewMesh, SkinOrigin, next_deck, state_block
from .plane import crossings, worst_corner
from .remake import fading_rows, kept_block, start_block, traction_block
from .report import Remesh
from .scrap import bodies, by_group, loose, pieces, split
from .state import Snapshot
from .transfer import fields_of

#: Criteria in the order of the columns of damage.
CRITERIA = ("COCKCROFT-LATHAM", "OYANE", "RICE-TRACEY", "LEMAITRE")
#: Name of the faces that cuts have laid bare: a set of their nodes in the decks of parts.
CUT = ("N", "LOPIN_CUT")
#: Increments, of the length of the next, over which what separated elements held fades.
FADING = 5.0


def criticals(blocks: list[Block]) -> dict[str, float]:
    """Critical values among the cards of a body, by criterion: each metal has its own.

    >>> criticals([Block("DAMAGE", {"CRITERION": "OYANE", "CRITICAL": "0.5"}, [[3.9]])])
    {'OYANE': 0.5}
    """
    return {str(plain(b.parameters["CRITERION"])).upper():
            float(str(plain(b.parameters["CRITICAL"])).upper().replace("D", "E"))
            for b in blocks if b.keyword == "DAMAGE" and "CRITICAL" in b.parameters}


def cuts_of(blocks: list[Block]) -> tuple[tuple[int, float, float], ...]:
    """Column of damage, critical value and length of the cells of a cut: half the width over which
    the damage is a mean, 0 without one (as small as cells may be)."""
    widths = {str(plain(b.parameters["CRITERION"])).upper():
              float(str(plain(b.parameters.get("WIDTH", 0.0))).upper().replace("D", "E"))
              for b in blocks if b.keyword == "DAMAGE"}
    return tuple((CRITERIA.index(name), value, 0.5*widths[name])
                 for name, value in criticals(blocks).items())


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
    met = crushed(body, last.x, gone)
    if met.any():
        why.append(f"{int(met.sum())} where the sides of a cut meet")
    return gone | met, ", ".join(why)


def crushed(body: Body, x: NDArray, gone: NDArray) -> NDArray:
    """Elements of a plane body at sides of cuts that cross each other (element,)."""
    found = np.zeros(len(gone), bool)
    cut = np.array([CUT in tag for tag in body.tags])
    if body.ndim == 2 and cut.any():
        pairs = crossings(x, body.facets[cut])
        _, owner = boundary_facets(body.cells, 2)
        found[owner[cut][pairs.ravel(), 0]] = True
    return found & ~gone


def without(body: Body, x: NDArray, gone: NDArray, meeting: set[str] | None = None
            ) -> tuple[NewMesh, NDArray]:
    """The mesh without these elements, and the old row of each of its nodes.

    Faces that the cut lays bare belong to every surface of the body that the deck names by faces,
    so that they meet the tools that their neighbours meet; `meeting`: these surfaces alone.
    """
    kept = [g[~out] for g, out in zip(body.cells, by_group(body, gone))]
    cells, old = split([g for g in kept if len(g)], body.ndim)
    facets, _ = boundary_facets(cells, body.ndim)
    known = {tuple(sorted(f)): tag for f, tag in zip(body.facets.tolist(), body.tags)}
    bare = frozenset(entry for tag in body.tags for entry in tag if entry[0] == "S"
                     and (meeting is None or entry[1] in meeting)) | {CUT}
    tags = [known.get(tuple(sorted(old[f].tolist())), bare) for f in facets]
    mesh = NewMesh(x[old], cells, facets, tags)
    for name, rows in named_rows(body).items():
        mesh.named[name] = np.flatnonzero(np.isin(old, rows))
    return mesh, old


def in_contact(blocks: list[Block]) -> set[str]:
    """Names of the surfaces of contact pairs: one that loads alone are put on does not grow."""
    return {str(plain(name)).upper() for block in blocks if block.keyword == "CONTACT PAIR"
            for row in block.data for name in row[:2]}


def rows_of(body: Body, points: Points) -> NDArray:
    """Row of the element of each point; outside the body the one behind the last."""
    number = {int(e): k for k, e in enumerate(body.elements)}
    return np.array([number.get(int(label), len(number)) for label in points.element])


def states_of_rest(body: Body, points: Points, gone: NDArray) -> list[NDArray]:
    """The fields of the points of elements that stay (element, point, field), for each group that
    has any."""
    row = rows_of(body, points)
    fields, states = fields_of(points), []
    for own in by_group(body, np.arange(len(gone))):
        at = np.flatnonzero(np.isin(row, own))
        at = at[np.lexsort((points.number[at], row[at]))]
        if not gone[own].all():
            states.append(fields[at].reshape(len(own), -1, fields.shape[1])[~gone[own]])
    return states


def _told(body: Body, x: NDArray, piece: NDArray, volume: NDArray) -> dict:
    """What a report says of a piece that comes loose."""
    nodes = np.unique(np.concatenate([g[own].ravel() for g, own in
                                      zip(body.cells, by_group(body, piece))]))
    low, high = x[nodes].min(axis=0), x[nodes].max(axis=0)
    return {"elements": int(piece.sum()), "volume": float(volume[:-1][piece].sum()),
            "from": [float(v) for v in low], "to": [float(v) for v in high]}


def separate(deck: Deck, last: Snapshot, session, gone: NDArray, elset: str, why: str, part: int,
             name: str, folder: Path) -> tuple[Deck, Remesh] | None:
    """The deck of the part that follows without these elements and what they leave loose: the rest
    of the mesh as it is. None where nothing separates.

    Parameters
    ----------
    deck : of the part that ends, `part` from 1
    last : where it stands
    session : the open run
    gone : elements of the body that separate (element,)
    elset : of the body
    why : the reason, in words
    name, folder : of the new deck
    """
    began = time.perf_counter()
    parts = DeckParts.of(deck)
    direct_labels(parts, read_body(parts, elset))
    body = read_body(parts, elset)
    points = last.points
    found = loose(parts, body, last, gone)
    volume = np.bincount(rows_of(body, points), points.volume, len(gone) + 1)
    if not (gone.any() or found):
        return None
    scrap = [_told(body, last.x, piece, volume) for piece in found]
    torn_off = gone.sum()
    share = float(volume[:-1][gone].sum()/volume[:-1].sum())
    gone = np.any([gone, *found], axis=0)
    if gone.all():
        raise refused("nothing holds what is left of the body")
    mesh, old = without(body, last.x, gone, in_contact(parts.blocks))
    parts.cards.nsets.setdefault(CUT[1], [])
    states = states_of_rest(body, points, gone)
    skin, times = np.unique(mesh.facets), np.bincount(old)[old][:, None]
    origin = SkinOrigin(skin, old[skin][:, None], np.ones((len(skin), 1)))
    why = f"{int(torn_off)} elements separate, {why}" if torn_off else "pieces come loose"
    done = Remesh(part, last.clock.total, why, sum(len(c) for c in mesh.cells),
                  worst_corner(mesh.x, mesh.cells),
                  {"volume": float(volume[:-1].sum()), "volume_change": 0.0}, 0.0, 0.0, excess=0.0,
                  seconds=time.perf_counter() - began, separated=share, scrap=scrap,
                  pieces=sum(1 for _ in pieces(body, gone)))
    start: list[Block] = [state_block(parts, body, mesh, states), *kept_block(session, body),
                          *traction_block(parts, body, mesh, last, origin),
                          start_block(body, last, parts, FADING*last.clock.increment,
                                      fades=fading_rows(parts, body, mesh,
                                                        last.fading_on(body)[old]/times))]
    return next_deck(parts, body, mesh, name, folder, start), done
