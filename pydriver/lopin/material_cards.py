"""The cards of a deck that belong to a body: its sections, all that they name, its temperatures.

Which cards stand below *MATERIAL is a column of the deck language's own table: no list is kept
here, so that a card that is new there goes along.
"""
from __future__ import annotations

from functools import cache

from ._bridge import keywords
from .deck import Block
from .errors import ModelError
from .model_read_mesh import MeshCards, plain


@cache
def _row_of(keyword: str) -> tuple[tuple[str, ...], str]:
    """What a card stands below, and whether it is read or ignored."""
    row = next((r for r in keywords() if r["name"] == keyword), {"after": "", "status": ""})
    return tuple(row["after"].split(",")), row["status"]


def before_steps(blocks: list[Block]) -> list[Block]:
    """The model part of a deck."""
    first = next((k for k, b in enumerate(blocks) if b.keyword == "STEP"), len(blocks))
    return blocks[:first]


def word_of(block: Block, name: str) -> str:
    """A parameter as a name: upper case, without quotes; empty without it."""
    return str(plain(block.parameters.get(name) or "")).upper()


def of_materials(blocks: list[Block], names: set[str]) -> list[Block]:
    """*MATERIAL of these names and all cards below them.

    A property belongs to the last *MATERIAL above it, whatever stands between; a card that is
    ignored goes along where it stands among them.
    """
    found, owner, among = [], "", False
    for block in before_steps(blocks):
        after, status = _row_of(block.keyword)
        if block.keyword == "MATERIAL":
            owner = word_of(block, "NAME")
        among = block.keyword == "MATERIAL" or "MATERIAL" in after or \
            (among and status == "ignored")
        if among and owner in names:
            found.append(block)
    return found


def sections_of(blocks: list[Block], named: MeshCards, members: set[int]) -> list[Block]:
    """*SOLID SECTION of any of these elements."""
    return [b for b in before_steps(blocks) if b.keyword == "SOLID SECTION" and
            members & set(named.elsets.get(word_of(b, "ELSET"), []))]


def of_body(blocks: list[Block], named: MeshCards, members: set[int]) -> list[Block]:
    """Materials and sections of these elements, and every card that the sections name: axes,
    section controls."""
    sections = sections_of(blocks, named, members)
    asked = {(word, word_of(b, word)) for b in sections for word in b.parameters
             if word not in ("ELSET", "MATERIAL")}
    beside = [b for b in before_steps(blocks) if "NAME" in b.parameters and
              (b.keyword.rpartition(" ")[2], word_of(b, "NAME")) in asked]
    return [*of_materials(blocks, {word_of(b, "MATERIAL") for b in sections}), *beside, *sections]


def beyond_points(cards: list[Block]) -> str:
    """What of a material the table of points does not hold: Hill's surface or backstress, by the
    card that brings it."""
    return next((b.head() for b in cards if b.keyword in ("POTENTIAL", "CYCLIC HARDENING") or
                 word_of(b, "HARDENING") in ("KINEMATIC", "COMBINED")), "")


def temperatures_of(blocks: list[Block], named: MeshCards, nodes: set[int]) -> dict[int, float]:
    """Temperatures of these nodes at the start, by label; empty where the deck gives none.

    What a step has heated is refused: its temperatures go with its time.
    """
    found: dict[int, float] = {}
    for block in blocks:
        starts = block.keyword == "INITIAL CONDITIONS" and word_of(block, "TYPE") == "TEMPERATURE"
        for row in block.data if starts or block.keyword == "TEMPERATURE" else ():
            own = nodes & set(labels_of(named.nsets, row[0]))
            if own and not starts:
                raise ModelError("*TEMPERATURE: heat of a step does not go to the next operation",
                                 help="run at the temperature of *INITIAL CONDITIONS, "
                                      "TYPE=TEMPERATURE")
            found.update(dict.fromkeys(own, float(row[1])))
    return found


def labels_of(sets: dict[str, list[int]], what) -> list[int]:
    """Nodes or elements that a line names by their label or their set."""
    return [what] if isinstance(what, int) else sets.get(str(plain(what)).upper(), [])
