"""Die stress: the forces of a forging, put on the mesh of an elastic die.

The tool of the forging is rigid, so that its forces depend on no deformation of the die: a second
deck with the die's mesh takes them as loads on its nodes. What a slave node gives goes to the facet
of the die that is closest, shared by its linear shape functions: forces are kept to rounding,
moments up to force times the distance between that node and the facet.
"""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .deck import Block, Deck
from .errors import ModelError, UsageError
from .mesh.cells import CELLS
from .model_read_mesh import MeshCards, expanded, plain
from .turned_axes import axes_at


@dataclass
class ToolLoads:
    """Forces on a tool at the end of a forging, where its nodes stood when it began.

    Attributes
    ----------
    tool : name of its surface
    place : of the slave nodes that press, moved back with the tool (n, ndim) [length]
    force : on the tool (n, ndim) [force]; of the whole ring where axisymmetric
    pairs : that are in it
    left_out : pairs of the same tool that bear forces and are not in it
    """

    tool: str
    place: NDArray
    force: NDArray
    pairs: tuple[str, ...] = ()
    left_out: tuple[str, ...] = ()

    @classmethod
    def of(cls, result, pair: str | int | None = None, index: int = -1) -> ToolLoads:
        """Of a result, from `lopin.run` or `lopin.open_result`, at an output.

        `pair`: the one to take; default: all pairs of the tool of the first.
        """
        master = {str(c["pair"]): str(c["master"]) for c in result.summary["contact"]}
        first = result.contact(pair or 0).pair
        tool = master[first]
        contacts = {p: result.contact(p).at(index) for p in result.pairs
                    if master.get(p) == tool}
        taken = [first] if pair is not None else list(contacts)
        left = tuple(p for p, contact in contacts.items()
                     if p not in taken and np.any(contact.force))
        place = np.concatenate([contacts[p].place for p in taken])
        force = np.concatenate([contacts[p].force for p in taken])
        ndim = force.shape[1]
        time = result.times[index]
        history = result.history
        if f"{tool}.u1" not in history:
            raise UsageError(f"{tool} is no rigid tool of this run",
                             help=f"pairs: {', '.join(result.pairs)}")
        moved = [np.interp(time, history["time"], history[f"{tool}.u{k + 1}"])
                 for k in range(ndim)]
        turned = max(np.abs(column).max(initial=0.0) for name, column in history.items()
                     if name in [f"{tool}.u{k}" for k in (4, 5, 6)])
        if turned > 1e-9:
            raise ModelError(f"{tool} has turned by {turned:.3g} rad: its die is put where it "
                             "stood at the start", help="hold the rotations of the tool")
        presses = np.abs(force).max(axis=1) > 0.0
        return cls(tool, place[presses, :ndim] - moved, -force[presses], tuple(taken), left)

    def line(self) -> str:
        """Whose forces they are, for a terminal."""
        told = f"{self.tool} ({', '.join(self.pairs)})" if len(self.pairs) > 1 else self.tool
        return told + (f", without {', '.join(self.left_out)}" if self.left_out else "")


@dataclass
class Balance:
    """What the transfer of the loads kept.

    Attributes
    ----------
    force : on the die (ndim,) [force]
    force_error : sum of the loads beside that of the slave nodes, of the sum of their lengths
    moment_error : the same of moments, of forces times the size of the pressed face
    farthest : from a slave node to the die [length]
    facet : mean length of the edges of the facets of the die [length]
    """

    force: NDArray
    force_error: float
    moment_error: float
    farthest: float
    facet: float

    def line(self) -> str:
        """For a terminal."""
        return (f"force {', '.join(f'{f:.6g}' for f in self.force)}; kept to "
                f"{self.force_error:.1e}, its moment to {self.moment_error:.1e}; nodes of the "
                f"forging up to {self.farthest:.3g} from the die (facets of {self.facet:.3g})")


def die_deck(die: Deck, surface: str, loads: ToolLoads) -> tuple[Deck, Balance]:
    """The deck of a die with the loads of a forging in its first step.

    Parameters
    ----------
    die : mesh, material and supports of the die where the forging's tool stands at its start, and
        a step
    surface : of the faces that meet the metal
    """
    blocks = expanded(die)
    cards = MeshCards(blocks)
    mesh = cards.build()[2]
    if surface.upper() not in mesh.surfaces:
        raise ModelError(f"the die has no surface '{surface}'",
                         help=f"its surfaces: {', '.join(sorted(mesh.surfaces)) or 'none'}")
    if mesh.ndim != loads.place.shape[1]:
        raise ModelError(f"the die is of {mesh.ndim} dimensions, the forging of "
                         f"{loads.place.shape[1]}")
    facets = facets_of(mesh, surface.upper())
    node, share, far = closest(loads.place, mesh.points, facets)
    total = np.zeros_like(mesh.points)
    np.add.at(total, node.ravel(), (share[:, :, None]*loads.force[:, None, :]).reshape(
        -1, mesh.ndim))
    edge = np.linalg.norm(mesh.points[facets] - mesh.points[np.roll(facets, 1, axis=1)], axis=2)
    balance = _balance(mesh.points, total, loads, far, float(edge.mean()))
    if balance.farthest > balance.facet:
        raise ModelError(f"a node of the forging lies {balance.farthest:.3g} from {surface}, more "
                         f"than a facet of it ({balance.facet:.3g})",
                         help="the die's mesh stands where its tool stands at the start of the "
                              "forging, in the same units and axes")
    label = {k: n for n, k in cards.index.items()}
    written = np.einsum("kde,ke->kd", axes_of_nodes(blocks, cards, mesh.points), total)
    rows = [[label[k], d + 1, float(written[k, d])] for k in np.unique(node) for d in
            range(mesh.ndim) if written[k, d] != 0.0]
    return _loaded(die, blocks, rows), balance


def _loaded(die: Deck, blocks: list[Block], rows: list[list]) -> Deck:
    """The deck with these loads at the end of its first step, added to those that it has there."""
    ends = [k for k, b in enumerate(blocks) if b.keyword == "END STEP"]
    if not ends:
        raise ModelError("the die's deck has no step that could take the loads",
                         help="*STEP, *STATIC, *END STEP")
    deck = Deck(preamble=die.preamble, name=f"{die.name}_loaded", folder=die.folder)
    deck.blocks = [*blocks[:ends[0]], Block("CLOAD", {}, rows), *blocks[ends[0]:]]
    return deck


def axes_of_nodes(blocks: list[Block], cards: MeshCards, x: NDArray) -> NDArray:
    """Axes in which the loads of nodes are meant (node, axis, ndim): those of *TRANSFORM."""
    axes = np.broadcast_to(np.eye(3), (len(x), 3, 3)).copy()
    for block in blocks:
        if block.keyword != "TRANSFORM":
            continue
        nodes = [cards.index[n] for n in cards.labels(plain(block.parameters["NSET"]))
                 if n in cards.index]
        axes[nodes] = axes_at(block, x[nodes])[0]
    return axes[:, :x.shape[1], :x.shape[1]]


def facets_of(mesh, surface: str) -> NDArray:
    """Corners of the facets of a surface (facet, ndim): lines, triangles; quads in two."""
    found = []
    for element, face in mesh.surfaces[surface]:
        name, nodes = mesh.element(element)
        cell = CELLS[name]
        corner = [int(nodes[k]) for k in cell.faces[face - 1] if k < cell.n_corner]
        found += [corner[:mesh.ndim]]
        if len(corner) > mesh.ndim:
            found += [[corner[0], *corner[2:]]]
    return np.array(found)


def closest(places: NDArray, x: NDArray, facets: NDArray) -> tuple[NDArray, NDArray, NDArray]:
    """Nodes of the closest facet of each place, their shares, and how far it is."""
    from .remesh.space import closest_share

    node = np.zeros((len(places), facets.shape[1]), int)
    share, best = np.zeros(node.shape), np.full(len(places), np.inf)
    for facet in facets:
        corner = x[facet]
        if len(facet) == 2:
            way = corner[1] - corner[0]
            s = np.clip((places - corner[0]) @ way/(way @ way), 0.0, 1.0)
            own = np.stack([1.0 - s, s], axis=1)
        else:
            own = closest_share(places, np.broadcast_to(corner, (len(places), 3, 3)))
        far = np.linalg.norm(own @ corner - places, axis=1)
        closer = far < best
        node[closer], share[closer], best[closer] = facet, own[closer], far[closer]
    return node, share, best


def _balance(x: NDArray, total: NDArray, loads: ToolLoads, far: NDArray, facet: float) -> Balance:
    """Sums over the die beside sums over the slave nodes."""
    def moment(place, force):
        if place.shape[1] == 2:
            return (place[:, 0]*force[:, 1] - place[:, 1]*force[:, 0]).sum()
        return np.cross(place, force).sum(axis=0)

    most = np.linalg.norm(loads.force, axis=1).sum()
    size = np.linalg.norm(np.ptp(loads.place, axis=0)) if len(loads.place) else 0.0
    if not most > 0.0 or not size > 0.0:
        raise ModelError(f"{loads.tool} bears nothing at this output")
    middle = loads.place.mean(axis=0)
    turn = moment(x - middle, total) - moment(loads.place - middle, loads.force)
    return Balance(total.sum(axis=0),
                   float(np.linalg.norm(total.sum(axis=0) - loads.force.sum(axis=0))/most),
                   float(np.linalg.norm(turn)/(most*size)), float(far.max()), facet)
