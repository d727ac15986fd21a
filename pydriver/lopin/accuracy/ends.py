"""Where contact reaches the end of a surface: its pressure may grow there without a limit."""
from __future__ import annotations

from collections import Counter

from ..deck import Deck
from ..mesh.cells import CELLS
from ..model_read_mesh import MeshCards, expanded
from ..refine.children import cell_of
from ..result import Result
from .quantity import driven, pressures


def closed_at_an_end(deck: Deck, result: Result) -> bool:
    """Whether an end of a slave surface that no support or symmetry holds is pressed at the end of
    the run, as beside a corner of two bodies: what it bears may grow as slowly as any power."""
    blocks = expanded(deck)
    cards = MeshCards(blocks)
    slaves = {str(row[0]).upper() for block in blocks if block.keyword == "CONTACT PAIR"
              for row in block.data}
    free = set().union(*(_ends(cards, name) for name in slaves)) - driven(blocks, cards)
    pressure, _, labels = pressures(result)
    return any(p > 0.0 and int(n) in free for p, n in zip(pressure, labels))


def _ends(cards: MeshCards, name: str) -> set[int]:
    """Nodes of the rim of a surface: corners of one facet, in space of edges of one."""
    rim: Counter[frozenset[int]] = Counter()
    for row in cards.surfaces.get(name, []):
        face = str(row[1]).upper() if len(row) > 1 else ""
        members = [row[0]] if isinstance(row[0], int) else cards.elsets.get(row[0].upper(), [])
        for label in members if face[1:].isdigit() else ():
            word, nodes = cards.elements[label]
            cell = CELLS[cell_of(word) or "quad"]
            corners = [nodes[k] for k in cell.faces[int(face[1:]) - 1]]
            if cell.ndim == 2:
                rim.update(frozenset([n]) for n in corners[:2])
                continue
            corners = corners[:len(corners)//2 if len(corners) > 4 else len(corners)]
            rim.update(map(frozenset, zip(corners, corners[1:] + corners[:1])))
    return {n for part, times in rim.items() if times == 1 for n in part}
