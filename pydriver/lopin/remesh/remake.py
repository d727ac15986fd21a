"""From a worn mesh to the deck of the next part: a new mesh, and the state on it."""
from __future__ import annotations

import time
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..deck import Block, Deck
from ..errors import UsageError
from ..points import Points
from .balance import depth_of, elasticity, in_balance
from .body import Body, DeckParts, direct_labels, pair_names, period_of, read_body, refused
from .card import RemeshCard
from .loads import fading
from .part import NewMesh, SkinOrigin, new_labels, next_deck, state_block
from .planar import remesh_plane
from .plane import worst_corner
from .report import Remesh
from .spatial import remesh_space
from .state import Snapshot
from .tools import Tools
from .transfer import (
    PLASTIC,
    STRAIN,
    Locator,
    cell_fields,
    equivalent,
    fields_of,
    quartered,
    transfer,
)

#: Length of the increment at rest, by the period of the step.
REST = 1e-8
#: A new mesh settles over so many increments of the present length, and over no less than this
#: share of the step: at once, nodes inside a tool would be pressed out elastically.
SETTLES, LEAST = 5.0, 0.005
#: Share of the faces that a support holds by which a new mesh may have other ones.
LOST = 0.02


def remake(deck: Deck, last: Snapshot, tools: Tools, card: RemeshCard, why: str, part: int,
           name: str, folder: Path) -> tuple[Deck, Remesh]:
    """The deck of the part that follows, and what the remesh did.

    Parameters
    ----------
    deck : of the part that ends, `part` from 1
    last : where it stands
    why : the reason, in words
    name, folder : of the new deck
    """
    began = time.perf_counter()
    parts = DeckParts.of(deck)
    direct_labels(parts, read_body(parts, card.elset))
    body = read_body(parts, card.elset)
    x, cells, owner = point_cells(last, body)
    fields = cell_fields(x, cells, *owner)
    make = remesh_plane if body.ndim == 2 else remesh_space
    mesh, moved, origin = make(body, last, card, tools, fields)
    refuse_lost_names(body, last.x, mesh)
    fades = fading(body, mesh, last)
    states, weights = transfer(fields, Locator(x, cells), mesh.x, mesh.cells, body.axisymmetric)
    states, over, unbalanced = in_balance(parts, body, mesh, states, weights, last, tools, folder)
    done = Remesh(part, last.clock.total, why, sum(len(c) for c in mesh.cells),
                  worst_corner(mesh.x, mesh.cells), moved,
                  *integrals(last.points, states, weights, depth_of(parts, body),
                             elasticity(parts, body)[1]),
                  excess=max(float(o.max()) for o in over), unbalanced=unbalanced,
                  seconds=time.perf_counter() - began)
    settles = settling(last, parts)
    start = [state_block(parts, body, mesh, states), *kept_block(tools.session, body),
             *traction_block(parts, body, mesh, last, origin),
             start_block(body, last, parts, 0.0, seating=settles,
                         fades=fading_rows(parts, body, mesh, fades))]
    return next_deck(parts, body, mesh, name, folder, start), done


def refuse_lost_names(body: Body, x: NDArray, mesh: NewMesh) -> None:
    """Every set and surface that had faces of the body has some of the new mesh, and planes that
    supports hold are as large as they were: a mesher that loses one would set the body free."""
    for name in frozenset().union(*body.tags) - frozenset().union(*mesh.tags):
        kind = {"N": "node set", "S": "surface"}[name[0]]
        raise refused(f"the mesher has lost {kind} {name[1]}", "a smaller SMALLEST there")
    for name, rows in body.named.items():
        if len(rows) and not len(mesh.named.get(name, [])):
            raise refused(f"the mesher has lost node set {name}", "a smaller SMALLEST there")
    for name in body.held:
        old = size_of_facets(x, body.facets[[name in tag for tag in body.tags]])
        new = size_of_facets(mesh.x, mesh.facets[[name in tag for tag in mesh.tags]])
        if not abs(new - old) <= LOST*old:
            raise refused(f"the mesher has changed the faces that {name[1]} holds from {old:.4g} "
                          f"to {new:.4g}", "a smaller SMALLEST there")


def size_of_facets(x: NDArray, facets: NDArray) -> float:
    """Length of edges, or area of triangles."""
    corner = x[facets]
    if x.shape[1] == 2:
        return float(np.linalg.norm(corner[:, 1] - corner[:, 0], axis=1).sum())
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    return float(0.5*np.linalg.norm(normal, axis=1).sum())


def point_cells(last: Snapshot, body: Body):
    """The mesh whose cells belong to the integration points: quads in four parts where they have
    four. Returns its nodes, its cells, and (fields, cell, place, volume) of the points."""
    points = last.points
    at = {int(label): k for k, label in enumerate(body.elements)}
    element = np.array([at.get(int(label), -1) for label in points.element])
    own = element >= 0
    element, number = element[own], points.number[own]
    x, cells, cell = last.x, body.cells, element
    if body.cells[0].shape[1] == 4 and body.ndim == 2 and number.max() == 4:
        x, cells = quartered(last.x, body.cells)
        quads = len(body.cells[0])
        cell = np.where(element < quads, 4*element + number - 1, element + 3*quads)
    return x, cells, (fields_of(points)[own], cell, points.place[own, :body.ndim],
                      points.volume[own])


def integrals(points: Points, states, weights, depth: float, poisson: float) -> tuple[float, float]:
    """Relative changes of the integrals of plastic strain, and of the elastic energy of the
    deviator, by all elastic energy. `depth`: volume by the weights, 2 pi or the thickness of a
    section."""
    bulk = (1.0 + poisson)/(3.0*(1.0 - 2.0*poisson))   # by the factor of the deviator

    def change(of_old, of_new, beside=0.0):
        old = float((points.volume*of_old).sum())
        new = depth*sum(float((w*f).sum()) for w, f in zip(weights, of_new))
        whole = old + float((points.volume*beside).sum())
        return (new - old)/whole if whole > 0.0 else 0.0

    return (change(points.plastic, [s[..., PLASTIC] for s in states]),
            change(equivalent(points.strain)**2, [equivalent(s[..., STRAIN])**2 for s in states],
                   bulk*points.dilatation**2))


def kept_block(session, body: Body) -> list[Block]:
    """*INITIAL CONDITIONS, TYPE=MEMORY: what bodies remember whose mesh stays. `session`: of the
    open run."""
    try:
        table = session.field("STATE OF MEMORY")
    except UsageError:
        return []
    stays = ~np.isin(table[:, 0], body.elements)
    rows = [[int(row[0]), int(row[1]), *row[2:]] for row in table[stays].tolist()]
    return [Block("INITIAL CONDITIONS", {"TYPE": "MEMORY"}, rows)] if rows else []


def traction_block(parts: DeckParts, body: Body, mesh: NewMesh, last: Snapshot,
                   origin: SkinOrigin) -> list[Block]:
    """*INITIAL CONDITIONS, TYPE=TRACTION: what the new slave nodes bear, along the old skin, and
    those of bodies whose mesh stays."""
    if last.tractions is None:
        return []
    names = [pair_names(row) for b in parts.blocks if b.keyword == "CONTACT PAIR" for row in b.data]
    at = {int(label): k for k, label in enumerate(body.labels)}
    node_label, _ = new_labels(parts, body, mesh)
    t = last.tractions
    rows = []
    for pair, name in enumerate(names):
        old = np.zeros((len(body.labels), 6))
        own = np.flatnonzero((t.pair == pair) & np.isin(t.node, body.labels))
        for k in own[::-1]:
            if np.abs(t.traction[k]).max() > 0.0 or not old[at[int(t.node[k])]].any():
                old[at[int(t.node[k])]] = np.r_[t.traction[k], t.slip[k]]
        new = origin.value(old)
        rows += [[*name, int(node_label[origin.node[k]]), *map(float, new[k])]
                 for k in np.flatnonzero(origin.within(np.abs(old[:, :3]).max(axis=1) > 0.0))]
        held = np.column_stack([t.traction, t.slip])
        rows += [[*name, int(t.node[k]), *map(float, held[k])]
                 for k in np.flatnonzero((t.pair == pair) & ~np.isin(t.node, body.labels))
                 if held[k].any()]
    return [Block("INITIAL CONDITIONS", {"TYPE": "TRACTION"}, rows)] if rows else []


def settling(last: Snapshot, parts: DeckParts) -> float:
    """Over which time a new mesh comes to balance and is pressed out of the tools [time]."""
    clock = last.clock
    return max(SETTLES*clock.increment, LEAST*period_of(parts, clock.step))


def start_block(body: Body, last: Snapshot, parts: DeckParts, release: float,
                seating: float = 0.0, fades: list[list] | None = None) -> Block:
    """*START: the clock, and what has moved; what is out of balance fades over `release`, and
    nodes inside tools are pressed out over `seating` [time]. `fades`: rows of what the step lets
    go of."""
    clock = last.clock
    rest = REST*(period_of(parts, clock.step) or max(clock.time, clock.increment))
    rows = [[int(r[0]), int(r[1]), *map(float, r[2:])] for r in last.moved(body)]
    lasts = {key: value for key, value in (("RELEASE", release), ("SEATING", seating))
             if value > 0.0}
    return Block("START", {"STEP": clock.step, "BEGUN": clock.begun, "TIME": clock.time,
                           "REST": rest, "INCREMENT": clock.increment, **lasts},
                 rows + (fades or []))


def fading_rows(parts: DeckParts, body: Body, mesh: NewMesh, fades: NDArray) -> list[list]:
    """Rows of *START of forces on the nodes of a new mesh (node, ndim) that fade over the step."""
    node, _ = new_labels(parts, body, mesh)
    return [[int(node[n]), int(k) + 1, 0.0, 0.0, float(fades[n, k])]
            for n, k in zip(*np.nonzero(fades))]
