"""What a new mesh cannot carry, refused before the run begins."""
from __future__ import annotations

from ..deck import Block
from ..model_read_mesh import plain
from .body import Body, DeckParts, refused

#: Cards that belong to the nodes or elements of the first mesh, and what to do instead.
_CARDS = {"TEMPERATURE": "heat is not carried to a new mesh",
          "PRE-TENSION SECTION": "sections that are cut belong to the first mesh",
          "DLOAD": "faces and elements of the first mesh are gone: load a surface by *DSLOAD, "
          "or a tool"}
_MATERIAL = ("ELASTIC", "PLASTIC", "VISCOPLASTIC", "RATE DEPENDENT", "CYCLIC HARDENING",
             "POTENTIAL", "HYPERELASTIC", "EXPANSION", "DENSITY")


def refuse_what_stays_behind(parts: DeckParts, body: Body) -> None:
    """Raise what the deck has and a new mesh would lose."""
    for block in parts.blocks:
        if block.keyword in _CARDS:
            raise refused(f"*{block.keyword}: {_CARDS[block.keyword]}")
        if block.keyword == "STEP" and "NLGEOM" not in block.parameters:
            raise refused("remeshing belongs to finite strain", "write *STEP, NLGEOM")
    _refuse_loads(parts, body)
    _refuse_motion(parts, body)
    _refuse_ties(parts, body)
    _refuse_itself(parts)
    _refuse_material(parts, body)


def _refuse_loads(parts: DeckParts, body: Body) -> None:
    """Loads on nodes that a new mesh does not have."""
    own = set(body.labels.tolist())
    for block in parts.blocks:
        for row in block.data if block.keyword == "CLOAD" else ():
            labels = [row[0]] if isinstance(row[0], int) else \
                parts.cards.nsets.get(str(row[0]).upper(), [])
            if own & set(labels):
                raise refused(f"*CLOAD acts on {row[0]} of the body that is meshed anew",
                              "load a tool")


def _refuse_motion(parts: DeckParts, body: Body) -> None:
    """Displacements that count from where nodes stood at the start: a new mesh stands elsewhere."""
    own = set(body.labels.tolist())
    for block in parts.blocks:
        for row in block.data if block.keyword == "BOUNDARY" else ():
            if len(row) < 4 or not isinstance(row[3], int | float) or row[3] == 0.0:
                continue
            labels = [row[0]] if isinstance(row[0], int) else \
                parts.cards.nsets.get(str(row[0]).upper(), [])
            if own & set(labels):
                raise refused(f"*BOUNDARY moves {row[0]} of the body that is meshed anew by "
                              f"{row[3]:g}", "move a tool against it")


def _refuse_ties(parts: DeckParts, body: Body) -> None:
    """Ties keep places of the start."""
    own = {name for tag in body.tags for kind, name in tag if kind == "S"}
    for block in parts.blocks:
        tied = block.keyword == "TIE" or \
            (block.keyword == "CONTACT PAIR" and "TIED" in block.parameters)
        names = {str(plain(v)).upper() for row in block.data for v in row[:2]} if tied else set()
        if names & own:
            raise refused(f"the tie of {', '.join(sorted(names & own))} belongs to the first mesh")


def _refuse_itself(parts: DeckParts) -> None:
    """Surfaces in contact with themselves."""
    for block in parts.blocks:
        if block.keyword == "CONTACT PAIR" and _meets_itself(block):
            raise refused("a surface in contact with itself cannot be remeshed in this version")


def refuse_shared_elements(bodies: list[Body]) -> None:
    """Each card has a body of its own."""
    seen: dict[int, str] = {}
    for body in bodies:
        for element in body.elements.tolist():
            if element in seen:
                raise refused(f"element {element} is of two *REMESH: {seen[element]} and "
                              f"{body.elset}", "one card for each body")
            seen[element] = body.elset


def _meets_itself(block: Block) -> bool:
    return any(len([v for v in row if v is not None]) == 1 or
               str(row[0]).upper() == str(row[1]).upper() for row in block.data)


def _refuse_material(parts: DeckParts, body: Body) -> None:
    """Materials whose memory a table of points does not hold."""
    members, section = set(body.elements.tolist()), None
    for block in parts.blocks:
        if block.keyword == "SOLID SECTION" and \
                members & set(parts.cards.elsets.get(plain(block.parameters["ELSET"]).upper(), [])):
            section = str(plain(block.parameters["MATERIAL"])).upper()
    cards, inside = [], False
    for block in parts.blocks:
        if block.keyword == "MATERIAL":
            inside = str(plain(block.parameters["NAME"])).upper() == section
        elif block.keyword in _MATERIAL and inside:
            cards.append(block)
        elif block.keyword not in _MATERIAL:
            inside = False
    words = {b.keyword for b in cards}
    moves = any(str(b.parameters.get("HARDENING", "")).upper() in ("KINEMATIC", "COMBINED")
                for b in cards)
    if words & {"POTENTIAL", "CYCLIC HARDENING", "HYPERELASTIC"} or moves or not \
            words & {"PLASTIC", "VISCOPLASTIC"}:
        raise refused(f"material {section} remembers what a new mesh cannot take: metals with "
                      "isotropic hardening, or that creep by Norton-Hoff, can be remeshed")
