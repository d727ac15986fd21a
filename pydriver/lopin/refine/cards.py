"""Cards that name nodes and elements by their labels, on a finer mesh."""
from __future__ import annotations

import numpy as np

from ..deck import Block, Row
from ..errors import ModelError
from ..model_read_mesh import MeshCards

#: Cards that a finer mesh would have to be told anew, and what to do.
_LOST = {"EQUATION": "equations tie single nodes", "MPC": "couplings tie single nodes",
         "SPRING": "springs hold single nodes", "GAP": "gaps hold single nodes",
         "REMESH": "the mesh is made anew on the way already",
         "START": "a run that goes on has its own mesh"}
_BY_ELEMENT = ("STATE", "STRESS", "PLASTIC STRAIN", "HARDENING", "TRACTION")


def refuse_what_is_lost(blocks: list[Block], cards: MeshCards) -> None:
    """Raise what a finer mesh cannot carry."""
    for block in blocks:
        if block.keyword in _LOST:
            raise ModelError(f"*{block.keyword}: {_LOST[block.keyword]}: the deck cannot be "
                             "refined")
        if block.keyword == "INITIAL CONDITIONS" and \
                str(block.parameters.get("TYPE", "")).upper() in _BY_ELEMENT:
            raise ModelError("*INITIAL CONDITIONS of elements and points: the deck cannot be "
                             "refined")
        for row in block.data if block.keyword == "CLOAD" else ():
            if not isinstance(row[0], int) and len(set(cards.nsets.get(str(row[0]).upper(), []))
                                                   ) > 1:
                raise ModelError(f"*CLOAD on every node of {row[0]}: its sum grows with the nodes "
                                 "of a finer mesh", help="load a surface by *DSLOAD or *DLOAD, or "
                                 "one node")


def spread_rows(block: Block, cards: MeshCards, cut) -> Block:
    """*BOUNDARY and initial temperatures node by node: new nodes between take the mean of the old
    ones, by their distances."""
    if block.keyword not in ("BOUNDARY", "TEMPERATURE") and not (
            block.keyword == "INITIAL CONDITIONS" and "TEMPERATURE" in
            str(block.parameters.get("TYPE", "")).upper()):
        return block
    own = {n for _, _, _, nodes, _ in cut.groups for n in nodes.ravel().tolist()}
    given: dict[tuple, dict[int, float]] = {}
    for row in block.data:
        if isinstance(row[0], int) and row[0] in own:
            of_dof = block.keyword == "BOUNDARY"
            key = (row[1], row[2] if len(row) > 2 else None) if of_dof else ()
            value = row[3 if of_dof else 1] if len(row) > (3 if of_dof else 1) else 0.0
            given.setdefault(key, {})[row[0]] = float(value or 0.0)
    if not given:
        return block
    new = Block(block.keyword, block.parameters)
    new.lines = list(block.lines)
    for key, values in given.items():
        if len(values) < 2:
            continue
        for k in cut.supports.within(values):
            ends, weight = cut.ends[k], cut.weight[k]
            if any(n and int(n) not in values for n in ends):
                ends, weight = cut.supports.half[int(k)], (0.5, 0.5)
            value = float(np.sum([w*values[int(n)] for n, w in zip(ends, weight) if n]))
            new.lines.append(Row([int(cut.labels[k]), *key, value]))
    return new
