"""Write a `Model` as a deck."""
from __future__ import annotations

from collections.abc import Iterable
from itertools import groupby
from typing import TYPE_CHECKING

from .deck import Deck, Row
from .errors import ModelError
from .model_parts import Pair, Tool
from .step import Load, Request, Step

if TYPE_CHECKING:
    from .model import Model

#: TYPE by `surface_to_surface`; not told: tied pairs are surface to surface, the plan of the run
#: chooses for others.
_FORMULATIONS = {True: "SURFACE TO SURFACE", False: "NODE TO SURFACE", None: None}


def write_model(model: Model) -> Deck:
    """The deck of a model; numbers are written so that they read back to the same bits."""
    if not model.sections:
        raise ModelError("no section: give a material to the elements by model.section(...)")
    deck = Deck(name=model.name)
    deck.add("HEADING").lines.append(f"{model.name} ({model.kind})"
                                     + (f", units: {model.units}" if model.units else ""))
    deck.blocks += model.settings
    _write_mesh(deck, model)
    _write_sections(deck, model)
    for tool in model.tools:
        _write_tool(deck, tool)
    for name, (points, area) in model.node_surfaces.items():
        deck.add("SURFACE", [[points] + ([] if area is None else [area])], name=name, type="NODE")
    for pair in model.contacts:
        _write_contact(deck, pair)
    for name, slave, master, options in model.ties:
        deck.add("TIE", [[slave, master]], name=name, **options)
    _write_relations(deck, model)
    _write_supports(deck, model)
    for step in model.steps:
        _write_step(deck, step)
    return deck


def mesh_deck(model: Model) -> Deck:
    """The mesh alone, to be included by other decks."""
    deck = Deck(name=model.name)
    _write_mesh(deck, model)
    return deck


def _write_mesh(deck: Deck, model: Model) -> None:
    mesh = model.mesh
    deck.add("NODE", ([i, *map(float, x)] for i, x in enumerate(mesh.points, start=1)))
    first = 1
    for name, cells in mesh.blocks:
        block = deck.add("ELEMENT", type=model.element_word(name))
        for i, nodes in enumerate(cells + 1, start=first):
            # A line that ends with a comma is continued.
            *full, last = _chunks([i, *nodes.tolist()], 16)
            block.lines += [_line(row, "," if full else "") for row in full] + [_line(last, "")]
        first += len(cells)
    for word, sets in (("NSET", mesh.point_sets), ("ELSET", mesh.element_sets)):
        for name, members in sets.items():
            deck.add(word, _chunks((members + 1).tolist(), 16), **{word: name})
    for name, rows in mesh.surfaces.items():
        deck.add("SURFACE", ([int(e) + 1, f"S{f}"] for e, f in rows), name=name, type="ELEMENT")


def _write_sections(deck: Deck, model: Model) -> None:
    names: dict = {}
    axes: dict = {}
    for elements, material, thickness, full, orientation in model.sections:
        if material not in names:
            names[material] = getattr(material, "name", "") or f"M{len(names) + 1}"
            deck.add("MATERIAL", name=names[material])
            material.add_to(deck)
        if full and "*SECTION CONTROLS" not in deck:
            deck.add("SECTION CONTROLS", name="FULL", formulation="FULL")
        if orientation is not None and orientation not in axes:
            axes[orientation] = f"O{len(axes) + 1}"
            orientation.add_to(deck, axes[orientation])
        plane = model.kind.startswith("plane")
        deck.add("SOLID SECTION", [[thickness]] if plane else [], elset=elements,
                 material=names[material], controls="FULL" if full else None,
                 orientation=axes.get(orientation))


def _write_tool(deck: Deck, tool: Tool) -> None:
    deck.add("NODE", [[tool.number, *tool.reference]], nset=tool.node)
    if tool.profile is None:
        deck.add("RIGID BODY", **dict(tool.body), ref_node=tool.node)
        return
    deck.add("SURFACE", [*tool.profile.frame, *tool.profile.rows], name=tool.name,
             type=tool.profile.kind, **tool.profile.options())
    deck.add("RIGID BODY", analytical_surface=tool.name, ref_node=tool.node)


def _write_contact(deck: Deck, contact: Pair) -> None:
    options, pair = contact.options, {"slave": contact.slave, "master": contact.master}
    deck.add("SURFACE INTERACTION", name=contact.interaction)
    contact.method.add_to(deck, no_separation=options["no_separation"])
    if contact.friction is not None:
        contact.friction.add_to(deck)
    adjust = options["adjust"]
    deck.add("CONTACT PAIR", [[contact.slave, contact.master]], interaction=contact.interaction,
             type=_FORMULATIONS[options["surface_to_surface"]],
             adjust=adjust.upper() if adjust in ("yes", "no") else adjust,
             small_sliding=options["small_sliding"], tied=options["tied"],
             smooth="YES" if options["smooth"] else None, extension_zone=options["extension"])
    controls = contact.method.controls()
    if options["initial"]:
        controls["initial"] = options["initial"].upper()
    if controls:
        deck.add("CONTACT CONTROLS", **pair, **controls)
    if options["clearance"] is not None:
        deck.add("CLEARANCE", **pair, value=options["clearance"])


def _write_relations(deck: Deck, model: Model) -> None:
    """Amplitudes, equations, local axes, the state before the first step, choices."""
    for name, (points, options) in model.amplitudes.items():
        deck.add("AMPLITUDE", _chunks([v for point in points for v in point], 8), name=name,
                 **options)
    for terms in model.equations:
        values = [value for term in terms for value in term]
        deck.add("EQUATION", [[len(terms)], *_chunks(values, 12)])
    for points, kind, axes in model.transforms:
        deck.add("TRANSFORM", [axes], nset=points, type=kind)
    for kind, rows in model.initial:
        deck.add("INITIAL CONDITIONS", rows, type=kind)
    if model.choices:
        deck.add("LOPIN", **{k: v.upper() if isinstance(v, str) else v
                             for k, v in model.choices.items()})


def _write_supports(deck: Deck, model: Model) -> None:
    """Supports of the mesh, and of tools in the directions that nothing drives."""
    _write_boundary(deck, [*model.fixed, *held(model)], ())


def held(model: Model) -> list[Load]:
    """Directions of tools that nothing drives and nobody freed."""
    rows = []
    for tool in model.tools:
        driven = {load.dof for step in model.steps for load in step.moves + step.forces
                  if load.target == tool.node} | set(tool.free)
        said = {load.dof for load in model.fixed if load.target == tool.node}
        rows += [Load(tool.node, dof, 0.0) for dof in model.tool_directions()
                 if dof not in driven | said]
    return rows


def _write_boundary(deck: Deck, loads: list[Load], op: dict) -> None:
    """One card for each run of loads that share their amplitude and type."""
    for (amplitude, velocity), rows in groupby(dict.fromkeys(loads), lambda x: x[3:]):
        deck.add("BOUNDARY", [[r.target, r.dof, r.dof] + ([r.value] if r.value or velocity
                                                          or deck.all("STEP") else [])
                              for r in rows],
                 **dict(op), amplitude=amplitude or None, type="VELOCITY" if velocity else None)


def _write_step(deck: Deck, step: Step) -> None:
    deck.add("STEP", name=step.name or None, nlgeom=step.nlgeom, inc=step.most,
             amplitude="STEP" if step.at_once else None)
    deck.add("STATIC", [[step.first, step.time, step.smallest, step.largest]], direct=step.fixed)
    for pair, law in step.frictions:
        deck.add("CHANGE FRICTION", interaction=pair.interaction)
        law.add_to(deck)
    for word, pairs in (("remove", step.removed), ("add", step.added)):
        if pairs:
            deck.add("MODEL CHANGE", [[p.slave, p.master] for p in pairs], type="CONTACT PAIR",
                     **{word: True})
    _write_loads(deck, step)
    if step.checkpoints is not None:
        deck.add("RESTART", write=True, frequency=step.checkpoints)
    usual = [Request("NODE FILE", ("U", "RF"), {}), Request("EL FILE", ("S",), {}),
             Request("CONTACT FILE", ("CDIS", "CSTR"), {})]
    for request in [*step.prints, *(usual if step.outputs is None else step.outputs)]:
        deck.add(request.keyword, [request.words], **request.parameters)
    deck.add("END STEP")


def _write_loads(deck: Deck, step: Step) -> None:
    """What is prescribed and what acts; an empty card where only the old is forgotten."""
    new = {word: ({"op": "NEW"} if word in step.replaced else {}) for word in
           ("supports", "forces", "pressures", "body forces", "temperatures")}
    moves = step.moves
    if new["supports"]:
        driven = {(load.target, load.dof) for load in moves}
        moves = [load for load in held(step.model) if load[:2] not in driven] + moves
    _write_boundary(deck, moves, new["supports"])
    forces = [(load.amplitude, list(load[:3])) for load in step.forces]
    _write_cards(deck, "CLOAD", forces, new["forces"])
    for keyword, loads, op in (("DSLOAD", step.pressures, new["pressures"]),
                               ("DLOAD", step.body, new["body forces"])):
        _write_cards(deck, keyword, [(a, [t, w, *d]) for t, w, d, a in loads], op)
    _write_cards(deck, "TEMPERATURE", [(a, [t, v]) for t, v, a in step.temperatures],
                 new["temperatures"])
    if new["supports"] and not moves:
        deck.add("BOUNDARY", **new["supports"])


def _write_cards(deck: Deck, keyword: str, rows: list[tuple[str, list]], op: dict) -> None:
    for amplitude, group in groupby(rows, lambda row: row[0]):
        deck.add(keyword, [data for _, data in group], **op, amplitude=amplitude or None)
    if op and not rows:
        deck.add(keyword, **op)


def _chunks(values: list, size: int) -> Iterable[list]:
    return [values[k:k + size] for k in range(0, len(values), size)]


def _line(values: list, end: str) -> Row:
    return Row(values, ", ".join(map(str, values)) + end)
