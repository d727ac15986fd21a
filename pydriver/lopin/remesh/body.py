"""The body that is meshed anew: its mesh and its names in the deck, and its present shape."""
from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..deck import Block, Deck
from ..errors import ModelError, UsageError
from ..mesh.cells import CELLS
from ..model_read_mesh import HELD_BY_WORD, MeshCards, expanded, plain
from ..turned_axes import axes_at, is_cylindrical

if TYPE_CHECKING:
    from .part import NewMesh

#: Words of elements that can be made anew, and the cells that they are made of.
WORDS = {"CPE4": "quad", "CAX4": "quad", "CPE4R": "quad", "CAX4R": "quad", "CPE3": "triangle",
         "CAX3": "triangle", "C3D4": "tetra"}
#: The word of the simplices that are left over between quads.
SIMPLEX = {"CPE4": "CPE3", "CAX4": "CAX3", "CPE4R": "CPE3", "CAX4R": "CAX3"}
#: What to take for words that no new mesh is made of.
_INSTEAD = {"C3D": "in space take C3D4", "CAX": "take CAX4 or CAX3", "CPE": "take CPE4 or CPE3",
            "CPS": "take CPE4 or CPE3, of plane strain: no new mesh is made in plane stress"}
#: Words of elements between two nodes, or of one node and the ground.
SPRINGS = ("SPRING1", "SPRING2", "SPRINGA", "GAPUNI")
#: Cosine of an axis with one of the global ones that it is along.
ALONG = 1.0 - 1e-9
#: Cards that put displacements, loads or couplings on nodes.
_ON_NODES = ("BOUNDARY", "CLOAD", "TEMPERATURE")


def refused(what: str, help: str = "") -> ModelError:
    """The error of everything that a new mesh cannot carry."""
    return ModelError(what, id="E0621", help=help)


def pair_names(row) -> list[str]:
    """Slave and master of a line of *CONTACT PAIR; one name is both.

    >>> pair_names(["Inner", None])
    ['INNER', 'INNER']
    """
    names = [str(plain(v)).upper() for v in row[:2] if v]
    return [names[0], names[-1]]


def held_dofs(row) -> tuple[int, ...]:
    """Degrees of freedom that a line of *BOUNDARY holds; of a word its translations.

    >>> held_dofs(["Axis", "xsymm"]), held_dofs(["Floor", 1, 2]), held_dofs(["Floor", 2])
    ((1,), (1, 2), (2,))
    """
    if isinstance(row[1], str):
        return tuple(d for d in HELD_BY_WORD.get(row[1].upper(), (1, 2, 3)) if d <= 3)
    last = row[2] if len(row) > 2 and row[2] is not None else row[1]
    return tuple(range(int(row[1]), int(last) + 1))


def held_in(parts: DeckParts, step: int) -> list[tuple[str, tuple[int, ...]]]:
    """Sets of nodes that *BOUNDARY holds in a step (from 1), and which of their degrees of freedom.
    The first card of a step with OP=NEW takes away what was held before it."""
    found: list[tuple[str, tuple[int, ...]]] = []
    at = renewed = 0
    for block in parts.blocks:
        at += block.keyword == "STEP"
        if at > step:
            break
        if block.keyword != "BOUNDARY":
            continue
        if str(plain(block.parameters.get("OP", ""))).upper() == "NEW" and renewed < at:
            found.clear()
            renewed = at
        found += [(str(row[0]).upper(), held_dofs(row)) for row in block.data if len(row) > 1]
    return found


def period_of(parts: DeckParts, step: int) -> float:
    """Period of a step of the deck [time]."""
    steps = [k for k, b in enumerate(parts.blocks) if b.keyword == "STEP"]
    for block in parts.blocks[steps[step - 1]:]:
        if block.keyword == "STATIC":
            row = block.data[0] if block.data else []
            return float(row[1]) if len(row) > 1 and row[1] is not None else 1.0
        if block.keyword == "END STEP":
            break
    return 1.0


@dataclass
class Body:
    """One body of a deck, as its cards have it.

    Attributes
    ----------
    elset : name of its element set
    word : of its elements, such as CAX4
    labels : of its nodes, in the order of the rows of `x` (node,)
    x : coordinates in the deck (node, ndim) [length]
    elements : labels (element,)
    cells : node rows, a list of (n, k) arrays with k = 3 or 4 (4 in space)
    element_rows : element numbers of each array of `cells`
    tags : names that hold each facet of the skin: ("N", node set), ("S", surface)
    named : nodes of sets that the facets do not account for: name to rows
    """

    elset: str
    word: str
    labels: NDArray
    x: NDArray
    elements: NDArray
    cells: list[NDArray]
    facets: NDArray
    tags: list[frozenset]
    named: dict[str, NDArray] = field(default_factory=dict)
    others: dict[str, list[int]] = field(default_factory=dict)   #: labels of sets outside the body
    held: frozenset = frozenset()       #: tags whose nodes *BOUNDARY holds

    @property
    def ndim(self) -> int:
        return self.x.shape[1]

    @property
    def axisymmetric(self) -> bool:
        return self.word.startswith("CAX")


def refuse_no_mesh(x: NDArray, cells: list[NDArray]) -> None:
    """A mesher may fail without a word: places that are no numbers, or no cells."""
    if not sum(len(c) for c in cells):
        raise refused("the mesher gives no cells", "another SIZE, or a smaller SMALLEST")
    if not np.isfinite(x).all():
        raise refused("the mesher gives places that are no numbers", "another SIZE")


@dataclass
class DeckParts:
    """A deck taken apart: blocks with includes in their place, and what its cards say of meshes."""

    blocks: list[Block]
    cards: MeshCards

    @classmethod
    def of(cls, deck: Deck) -> DeckParts:
        """Of a deck; parts and instances have no flat lists of nodes."""
        blocks = expanded(deck)
        for block in blocks:
            if block.keyword in ("PART", "INSTANCE", "ASSEMBLY"):
                raise refused(f"*REMESH reads flat decks, without *{block.keyword}",
                              "write the deck without parts and assemblies")
        try:
            return cls(blocks, MeshCards(blocks))
        except UsageError as problem:
            raise refused(f"*REMESH cannot read the mesh: {problem.message}") from problem


def named_rows(mesh: Body | NewMesh) -> dict[str, NDArray]:
    """Rows of the nodes of each set of a body, or of the new mesh of one."""
    rows = {name: [np.asarray(own, int)] for name, own in mesh.named.items()}
    for facet, tag in zip(mesh.facets, mesh.tags):
        for kind, name in tag:
            if kind == "N":
                rows.setdefault(name, []).append(facet)
    return {name: np.unique(np.concatenate(own)) for name, own in rows.items()}


def local_axes(parts: DeckParts, mesh: Body | NewMesh) -> NDArray:
    """Axes in which the degrees of freedom of nodes are meant (node, axis, ndim): those of
    *TRANSFORM; NaN where they turn from node to node."""
    axes = np.broadcast_to(np.eye(3), (len(mesh.x), 3, 3)).copy()
    names = named_rows(mesh)
    for block in parts.blocks:
        nodes = names.get(str(plain(block.parameters.get("NSET", ""))).upper()) \
            if block.keyword == "TRANSFORM" else None
        if nodes is None:
            continue
        axes[nodes] = np.nan if is_cylindrical(block) else axes_at(block, mesh.x[nodes])[0]
    return axes[:, :mesh.x.shape[1], :mesh.x.shape[1]]


def supports(parts: DeckParts, mesh: Body | NewMesh, step: int) -> NDArray:
    """Translations of the nodes that *BOUNDARY holds in a step (node, ndim), in global axes."""
    return _supports(parts, mesh, step)[0]


def inclined(parts: DeckParts, mesh: Body | NewMesh, step: int) -> bool:
    """Whether supports hold nodes along axes of *TRANSFORM that are not the global ones."""
    return _supports(parts, mesh, step)[1]


def _supports(parts: DeckParts, mesh: Body | NewMesh, step: int) -> tuple[NDArray, bool]:
    held = _held_along_own_axes(parts, mesh, step)
    along = np.abs(local_axes(parts, mesh)) > ALONG
    whole = held.all(axis=1, keepdims=True)
    return ((held[:, :, None] & along).any(axis=1) | whole,
            bool((held & ~along.any(axis=2) & ~whole).any()))


def _held_along_own_axes(parts: DeckParts, mesh: Body | NewMesh, step: int) -> NDArray:
    """Translations that *BOUNDARY holds in a step, as it numbers them (node, ndim)."""
    held, names = np.zeros(mesh.x.shape, bool), named_rows(mesh)
    for name, dofs in held_in(parts, step):
        for dof in dofs if name in names else ():
            if dof <= held.shape[1]:
                held[names[name], dof - 1] = True
    return held


def read_body(parts: DeckParts, elset: str) -> Body:
    """The body of an element set."""
    cards = parts.cards
    if elset not in cards.elsets:
        raise ModelError(f"*REMESH, ELSET={elset}: there is no such element set", id="E0201",
                         help=f"element sets: {', '.join(cards.elsets)}")
    members = list(dict.fromkeys(cards.elsets[elset]))
    words = {cards.elements[m][0] for m in members}
    word = next((w for w in WORDS if w in words), "")
    if not word or words - {word, SIMPLEX.get(word, word)}:
        raise refused(f"*REMESH makes meshes of one of {', '.join(WORDS)}, not of "
                      f"{', '.join(sorted(words))}",
                      next((told for begin, told in _INSTEAD.items()
                            if any(w.startswith(begin) for w in words)), ""))
    ndim = 3 if WORDS[word] == "tetra" else 2
    used = list(dict.fromkeys(n for m in members for n in cards.elements[m][1]))
    _refuse_shared(parts, set(members), set(used), elset)
    index = {label: k for k, label in enumerate(used)}
    x = np.array([cards.nodes[n][:ndim] for n in used])
    sizes = sorted({len(cards.elements[m][1]) for m in members}, reverse=True)
    groups = [[m for m in members if len(cards.elements[m][1]) == k] for k in sizes]
    cells = [np.array([[index[n] for n in cards.elements[m][1]] for m in g]) for g in groups]
    elements = np.array([m for g in groups for m in g])
    facets, owner = boundary_facets(cells, ndim)
    body = Body(elset, word, np.array(used), x, elements, cells, facets, [])
    body.tags = _tags(parts, body, owner)
    body.held = frozenset(("N", str(row[0]).upper()) for b in parts.blocks
                          if b.keyword == "BOUNDARY" for row in b.data if isinstance(row[0], str))
    return body


def _refuse_shared(parts: DeckParts, members: set[int], nodes: set[int], elset: str) -> None:
    """A body shares no node with others, and is of one section."""
    for label, (word, own) in parts.cards.elements.items():
        if label in members or not nodes & set(own):
            continue
        if word in SPRINGS:
            raise refused(f"{word} {label} holds node {min(nodes & set(own))} of {elset}, which a "
                          "new mesh does not have",
                          "put it on a tool, or on a body that is not meshed anew")
        raise refused(f"elements outside {elset} share nodes with it",
                      "name all elements of the body by ELSET")
    within = [b for b in parts.blocks if b.keyword == "SOLID SECTION" and
              members & set(parts.cards.elsets.get(plain(b.parameters["ELSET"]).upper(), []))]
    if len(within) != 1:
        raise refused(f"{elset} has {len(within)} sections: one material is meshed anew")


def faces_of_cell(ndim: int, corners: int) -> tuple[tuple[int, ...], ...]:
    """Corners of each face of the cell with so many corners."""
    return CELLS[{(2, 3): "triangle", (2, 4): "quad", (3, 4): "tetra"}[ndim, corners]].faces


def boundary_facets(cells: list[NDArray], ndim: int) -> tuple[NDArray, NDArray]:
    """Facets with one cell only, outward, and (cell number, face from 1) of each."""
    rows, owner, start = [], [], 0
    for group in cells:
        for k, face in enumerate(faces_of_cell(ndim, group.shape[1])):
            rows.append(group[:, list(face)])
            owner.append(np.stack([np.arange(len(group)) + start,
                                   np.full(len(group), k + 1)], axis=1))
        start += len(group)
    rows, owner = np.vstack(rows), np.vstack(owner)
    _, first, count = np.unique(np.sort(rows, axis=1), axis=0, return_index=True,
                                return_counts=True)
    alone = np.sort(first[count == 1])
    return rows[alone], owner[alone]


def _tags(parts: DeckParts, body: Body, owner: NDArray) -> list[frozenset]:
    """Names of each facet; what they leave of node sets goes to `body.named`."""
    cards = parts.cards
    tags: list[set] = [set() for _ in body.facets]
    at = {label: k for k, label in enumerate(body.labels)}
    for name, members in cards.nsets.items():
        own = np.array([at[m] for m in dict.fromkeys(members) if m in at], int)
        body.others[name] = [m for m in dict.fromkeys(members) if m not in at]
        if len(own) == 0:
            continue
        if len(own) == len(body.labels):
            body.named[name] = own
            continue
        inside = np.zeros(len(body.labels), bool)
        inside[own] = True
        whole = inside[body.facets].all(axis=1)
        for k in np.flatnonzero(whole):
            tags[k].add(("N", name))
        left = np.setdiff1d(own, body.facets[whole])
        if len(left):
            body.named[name] = left
    number = {tuple(o): k for k, o in enumerate(owner.tolist())}
    element = {label: k for k, label in enumerate(body.elements.tolist())}
    for name, rows in cards.surfaces.items():
        for k in _faces_of(cards, rows, element, owner, number):
            tags[k].add(("S", name))
    return [frozenset(t) for t in tags]


def _faces_of(cards: MeshCards, rows: list, element: dict, owner: NDArray, number: dict):
    """Facets of the body that a surface of elements holds."""
    for row in rows:
        members = [row[0]] if isinstance(row[0], int) else cards.elsets[str(row[0]).upper()]
        own = [element[m] for m in members if m in element]
        if not own:
            continue
        face = str(row[1]).upper() if len(row) > 1 and row[1] is not None else ""
        if not face:
            yield from np.flatnonzero(np.isin(owner[:, 0], own))
        elif re.fullmatch(r"S\d", face):
            yield from (number[m, int(face[1:])] for m in own if (m, int(face[1:])) in number)
        else:
            raise refused(f"*REMESH reads faces S1 to S4 of surfaces, not {face}")


def direct_labels(parts: DeckParts, body: Body) -> None:
    """Cards that put something on a node of the body by its label are rewritten to sets.

    Lines of one card with the same rest become one set; so a plane held node by node is one name.
    """
    own = set(body.labels.tolist())
    for block in parts.blocks:
        if block.keyword not in _ON_NODES:
            continue
        groups: dict[tuple, list[int]] = {}
        for row in block.data:
            if row and isinstance(row[0], int) and row[0] in own:
                groups.setdefault(tuple(row[1:]), []).append(row[0])
        if not groups:
            continue
        if block.keyword not in ("BOUNDARY", "CLOAD"):
            raise refused(f"*{block.keyword} acts on node {next(iter(groups.values()))[0]} of "
                          f"{body.elset}, which a new mesh does not have")
        block.lines = [line for line in block.lines if isinstance(line, str) or
                       not (line and line[0] in own)]
        for rest, labels in groups.items():
            name = f"NODES_{len(parts.cards.nsets) + 1}"
            parts.cards.nsets[name] = labels
            block.lines.append(_row([name, *rest]))


def _row(values: list):
    from ..deck import Row

    return Row(values)
