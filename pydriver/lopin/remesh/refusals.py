"""What a new mesh cannot carry, refused before the run begins."""
from __future__ import annotations

from ..deck import Block
from ..errors import optional
from ..material_cards import beyond_points, labels_of, of_materials, sections_of, word_of
from ..model_read_mesh import plain
from .body import Body, DeckParts, held_dofs, held_in, pair_names, refused
from .plane import load_gmsh

#: Cards that belong to the nodes or elements of the first mesh, and what to do instead.
_CARDS = {"TEMPERATURE": "heat is not carried to a new mesh",
          "PRE-TENSION SECTION": "sections that are cut belong to the first mesh",
          "DLOAD": "faces and elements of the first mesh are gone: load a surface by *DSLOAD, "
          "or a tool"}
#: NLGEOM=NO, and no such word; alone it stands for YES.
_NO = ("NO", "no", "No")


def refuse_what_stays_behind(parts: DeckParts, body: Body) -> None:
    """Raise what the deck has and a new mesh would lose."""
    for block in parts.blocks:
        if block.keyword in _CARDS:
            raise refused(f"*{block.keyword}: {_CARDS[block.keyword]}")
        if block.keyword == "STEP" and str(plain(block.parameters.get("NLGEOM", "NO"))) in _NO:
            raise refused("remeshing belongs to finite strain", "write *STEP, NLGEOM")
    _refuse_loads(parts, body)
    _refuse_motion(parts, body)
    _refuse_places_of_the_start(parts, body)
    _refuse_lasting_tractions(parts, body)
    _refuse_equations(parts, body)
    _refuse_temperatures(parts, body)
    _refuse_some_elements(parts, body)
    _refuse_ties(parts, body)
    _refuse_itself(parts, body)
    _refuse_material(parts, body)


def _refuse_loads(parts: DeckParts, body: Body) -> None:
    """Loads on nodes that a new mesh does not have."""
    own = set(body.labels.tolist())
    for block in parts.blocks:
        for row in block.data if block.keyword == "CLOAD" else ():
            if own & set(_labels(parts, row[0])):
                raise refused(f"*CLOAD acts on {row[0]} of the body that is meshed anew",
                              "load a tool")


def _refuse_motion(parts: DeckParts, body: Body) -> None:
    """Displacements that count from where nodes stood at the start: a new mesh stands elsewhere."""
    own = set(body.labels.tolist())
    for block in parts.blocks:
        for row in block.data if block.keyword == "BOUNDARY" else ():
            if len(row) < 4 or not isinstance(row[3], int | float) or row[3] == 0.0:
                continue
            if own & set(_labels(parts, row[0])):
                raise refused(f"*BOUNDARY moves {row[0]} of the body that is meshed anew by "
                              f"{row[3]:g}", "move a tool against it")


def _refuse_lasting_tractions(parts: DeckParts, body: Body) -> None:
    """Tractions that keep their direction are forces of nodes in the steps after their own."""
    steps, last = 0, sum(b.keyword == "STEP" for b in parts.blocks)
    faces = {name for tag in body.tags for kind, name in tag if kind == "S"}
    elements = set(body.elements.tolist())
    for block in parts.blocks:
        steps += block.keyword == "STEP"
        lasts = block.keyword in ("DSLOAD", "DLOAD") and 0 < steps < last
        if any(str(plain(row[1])).upper().startswith("TR") and
               (str(plain(row[0])).upper() in faces or
                elements & set(labels_of(parts.cards.elsets, row[0])))
               for row in block.data if lasts and len(row) > 1):
            raise refused("loads act on nodes of the body that is meshed anew: tractions of step "
                          f"{steps} that keep their direction",
                          "give them in the last step, or as pressures (P)")


def _refuse_places_of_the_start(parts: DeckParts, body: Body) -> None:
    """A displacement of zero in a later step brings nodes that were free back to where they stood
    at the start, which a new mesh does not know; those that were held all along stand there."""
    own, held, steps = set(body.labels.tolist()), [], 0
    for block in parts.blocks:
        if block.keyword == "STEP":
            steps += 1
            held.append(_held(parts, own, steps))
        absolute = block.keyword == "BOUNDARY" and "FIXED" not in block.parameters and \
            str(plain(block.parameters.get("TYPE", "DISPLACEMENT"))).upper() == "DISPLACEMENT"
        for row in block.data if absolute and steps > 1 else ():
            wanted = {(label, dof) for label in _labels(parts, row[0]) if label in own
                      for dof in held_dofs(row) if dof <= body.ndim}
            if any(wanted - before for before in held[:-1]):
                raise refused(f"*BOUNDARY in step {steps} brings {row[0]} of the body that is "
                              "meshed anew back to where it stood at the start",
                              "*BOUNDARY, FIXED holds it where it has come to; or hold it from "
                              "the first step on")


def _held(parts: DeckParts, own: set[int], step: int) -> set[tuple[int, int]]:
    """Nodes of a body and their degrees of freedom that *BOUNDARY holds in a step."""
    return {(label, dof) for name, dofs in held_in(parts, step)
            for label in _labels(parts, int(name) if name.isdigit() else name) if label in own
            for dof in dofs}


def _labels(parts: DeckParts, name) -> list[int]:
    """Nodes that a line names by their label or their set."""
    return labels_of(parts.cards.nsets, name)


def _refuse_equations(parts: DeckParts, body: Body) -> None:
    """Equations between nodes that a new mesh does not have, and nodes that follow a tool."""
    own = set(body.labels.tolist())
    for block in parts.blocks:
        names = [str(plain(block.parameters[word])).upper() for word in ("PIN NSET", "TIE NSET",
                 "NSET") if block.keyword == "RIGID BODY" and word in block.parameters]
        for name in names:
            if own & set(parts.cards.nsets.get(name, [])):
                raise refused(f"*RIGID BODY leads nodes of {name}, of {body.elset}, which is "
                              "meshed anew", "press it by a tool in contact")
        values = [v for row in block.data for v in row if v is not None] \
            if block.keyword == "EQUATION" else []
        at = 0
        while at < len(values) and isinstance(values[at], int):
            for node in values[at + 1:at + 1 + 3*values[at]:3]:
                labels = [node] if isinstance(node, int) else \
                    parts.cards.nsets.get(str(node).upper(), [])
                if own & set(labels):
                    raise refused(f"*EQUATION acts on {node} of {body.elset}, which is meshed anew",
                                  "hold a plane by *BOUNDARY")
            at += 1 + 3*values[at]


def _refuse_temperatures(parts: DeckParts, body: Body) -> None:
    """Temperatures of the start go on where they are those of the whole body."""
    own = set(body.labels.tolist())
    for block in parts.blocks:
        if block.keyword != "INITIAL CONDITIONS" or \
                str(plain(block.parameters.get("TYPE", ""))).upper() != "TEMPERATURE":
            continue
        for row in block.data:
            labels = set(_labels(parts, row[0]))
            if own & labels and (isinstance(row[0], int) or not own <= labels):
                raise refused(f"the temperature of {row[0]} belongs to nodes of the first mesh of "
                              f"{body.elset}", "give one temperature to a set of all its nodes")


def _refuse_some_elements(parts: DeckParts, body: Body) -> None:
    """Cards that name some elements of the body: a new mesh has no such set."""
    members = set(body.elements.tolist())
    some = {name for name, labels in parts.cards.elsets.items()
            if members & set(labels) and not members <= set(labels)}
    for block in parts.blocks:
        name = str(plain(block.parameters.get("ELSET", ""))).upper()
        if name in some and block.keyword not in ("ELSET", "ELEMENT"):
            raise refused(f"*{block.keyword} is for element set {name}, some elements of "
                          f"{body.elset}, which is meshed anew", "name all of them")


def _refuse_ties(parts: DeckParts, body: Body) -> None:
    """Ties, clearances that a card gives, and pairs of small sliding keep places of the start."""
    own = {name for tag in body.tags for kind, name in tag if kind == "S"}
    for block in parts.blocks:
        if block.keyword == "CLEARANCE":
            names = {str(plain(block.parameters.get(k, ""))).upper() for k in ("SLAVE", "MASTER")}
            if names & own:
                raise refused("*CLEARANCE of {} counts from the first mesh".format(
                    ", ".join(sorted(names & own))), "put the tool where it stands")
        if block.keyword == "CONTACT PAIR" and "SMALL SLIDING" in block.parameters:
            names = {str(plain(v)).upper() for row in block.data for v in row[:2]}
            if names & own:
                raise refused("SMALL SLIDING of {} keeps the facets of the start".format(
                    ", ".join(sorted(names & own))), "leave it out")
        tied = block.keyword == "TIE" or \
            (block.keyword == "CONTACT PAIR" and "TIED" in block.parameters)
        names = {str(plain(v)).upper() for row in block.data for v in row[:2]} if tied else set()
        if names & own:
            raise refused(f"the tie of {', '.join(sorted(names & own))} belongs to the first mesh")


def _refuse_itself(parts: DeckParts, body: Body) -> None:
    """Surfaces in contact with themselves in space, or of metal that separates."""
    own = {name for tag in body.tags for kind, name in tag if kind == "S"}
    for block in parts.blocks:
        if block.keyword != "CONTACT PAIR" or not _meets_itself(block, own):
            continue
        if body.ndim == 3:
            raise refused("in space a surface in contact with itself cannot be remeshed in this "
                          "version", "leave the pair out: folds are told at each new mesh")
        if any(b.keyword == "DAMAGE" and "CRITICAL" in b.parameters for b in parts.blocks):
            raise refused("metal that separates cannot be in contact with itself in this version",
                          "leave the pair or CRITICAL out")


def refuse_missing_mesher(bodies: list[Body]) -> None:
    """What makes new meshes of bodies is there: asked before the run, not after its first part."""
    optional("scipy", "new meshes", "remesh", "E0620")
    if any(body.ndim == 2 for body in bodies):
        load_gmsh()
    if any(body.ndim == 3 for body in bodies):
        optional("mmgpy", "new meshes", "remesh", "E0620")


def refuse_shared_elements(bodies: list[Body]) -> None:
    """Each card has a body of its own."""
    seen: dict[int, str] = {}
    for body in bodies:
        for element in body.elements.tolist():
            if element in seen:
                raise refused(f"element {element} is of two *REMESH: {seen[element]} and "
                              f"{body.elset}", "one card for each body")
            seen[element] = body.elset


def refuse_critical_of_others(parts: DeckParts, bodies: list[Body]) -> None:
    """Metal separates in bodies that are meshed anew: none other has a critical damage."""
    anew = {element for body in bodies for element in body.elements.tolist()}
    for section in sections_of(parts.blocks, parts.cards, set(parts.cards.elements) - anew):
        name, elset = word_of(section, "MATERIAL"), word_of(section, "ELSET")
        for card in of_materials(parts.blocks, {name}):
            if card.keyword == "DAMAGE" and "CRITICAL" in card.parameters:
                raise refused(f"{card.head()} of material {name}: elements of {elset}, which have "
                              "it, are not meshed anew, and would not separate",
                              f"a *REMESH, ELSET={elset}, or a material without CRITICAL for it")


def _meets_itself(block: Block, own: set[str]) -> bool:
    """A line names one surface of a body, or the same twice."""
    return any(slave == master and slave in own for slave, master in map(pair_names, block.data))


def _refuse_material(parts: DeckParts, body: Body) -> None:
    """Materials whose memory a table of points does not hold."""
    section, = sections_of(parts.blocks, parts.cards, set(body.elements.tolist()))
    name = word_of(section, "MATERIAL")
    cards = of_materials(parts.blocks, {name})
    words = {b.keyword for b in cards}
    if beyond_points(cards) or "HYPERELASTIC" in words or not words & {"PLASTIC", "VISCOPLASTIC"}:
        raise refused(f"material {name} remembers what a new mesh cannot take: metals with "
                      "isotropic hardening, or that creep by Norton-Hoff, can be remeshed")
