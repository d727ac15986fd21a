"""Write a `Model` as a deck."""
from __future__ import annotations

from collections.abc import Iterable

from .deck import Deck, Row
from .errors import ModelError
from .model import Model, Tool
from .step import Step


def write_model(model: Model) -> Deck:
    """The deck of a model; numbers are written so that they read back to the same bits."""
    if not model.sections:
        raise ModelError("no section: give a material to the elements by model.section(...)")
    deck = Deck(name=model.name)
    deck.add("HEADING").lines.append(f"{model.name} ({model.kind})"
                                     + (f", units: {model.units}" if model.units else ""))
    _write_mesh(deck, model)
    _write_sections(deck, model)
    for tool in model.tools:
        _write_tool(deck, tool)
    for k, contact in enumerate(model.contacts, start=1):
        _write_contact(deck, k, contact)
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
    for elements, material, thickness, full in model.sections:
        if material not in names:
            names[material] = f"M{len(names) + 1}"
            deck.add("MATERIAL", name=names[material])
            material.add_to(deck)
        if full and "*SECTION CONTROLS" not in deck:
            deck.add("SECTION CONTROLS", name="FULL", formulation="FULL")
        plane = model.kind.startswith("plane")
        deck.add("SOLID SECTION", [[thickness]] if plane else [], elset=elements,
                 material=names[material], controls="FULL" if full else None)


def _write_tool(deck: Deck, tool: Tool) -> None:
    deck.add("NODE", [[tool.number, *tool.reference]], nset=tool.node)
    deck.add("SURFACE", [*tool.profile.frame, *tool.profile.rows], name=tool.name,
             type=tool.profile.kind, fillet_radius=tool.profile.fillet or None)
    deck.add("RIGID BODY", analytical_surface=tool.name, ref_node=tool.node)


def _write_contact(deck: Deck, number: int, contact: dict) -> None:
    name = f"I{number}"
    pair = {"slave": contact["slave"], "master": contact["master"]}
    deck.add("SURFACE INTERACTION", name=name)
    contact["method"].add_to(deck, no_separation=contact["no_separation"])
    deck.add("CONTACT PAIR", [[pair["slave"], pair["master"]]], interaction=name,
             type="SURFACE TO SURFACE" if contact["surface_to_surface"] else "NODE TO SURFACE",
             adjust=contact["adjust"],
             small_sliding=contact["small_sliding"], tied=contact["tied"])
    controls = contact["method"].controls()
    if controls:
        deck.add("CONTACT CONTROLS", **pair, **controls)
    if contact["clearance"] is not None:
        deck.add("CLEARANCE", **pair, value=contact["clearance"])


def _write_supports(deck: Deck, model: Model) -> None:
    """Supports of the mesh, and of tools in the directions that nothing drives."""
    rows = list(dict.fromkeys(model.fixed))
    for tool in model.tools:
        driven = {dof for step in model.steps for name, dof, _ in step.moves + step.forces
                  if name == tool.node} | set(tool.free)
        rows += [(tool.node, dof) for dof in model.tool_directions()
                 if dof not in driven and (tool.node, dof) not in rows]
    if rows:
        deck.add("BOUNDARY", [[name, dof, dof] for name, dof in rows])


def _write_step(deck: Deck, step: Step) -> None:
    size = step.time/step.increments
    deck.add("STEP", nlgeom=step.nlgeom, inc=max(100, 20*step.increments))
    deck.add("STATIC", [[size, step.time, 1e-6*step.time, size]])
    if step.moves:
        deck.add("BOUNDARY", [[name, dof, dof, value] for name, dof, value in step.moves])
    if step.forces:
        deck.add("CLOAD", step.forces)
    if step.pressures:
        deck.add("DSLOAD", [[surface, "P", value] for surface, value in step.pressures])
    if step.body:
        deck.add("DLOAD", [[elements, "GRAV", value, *towards]
                           for elements, value, towards in step.body])
    deck.add("NODE FILE", [["U", "RF"]])
    deck.add("EL FILE", [["S"]])
    deck.add("CONTACT FILE", [["CDIS", "CSTR"]])
    deck.add("END STEP")


def _chunks(values: list, size: int) -> Iterable[list]:
    return [values[k:k + size] for k in range(0, len(values), size)]


def _line(values: list, end: str) -> Row:
    return Row(values, ", ".join(map(str, values)) + end)
