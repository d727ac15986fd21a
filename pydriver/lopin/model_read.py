"""Read a deck as a `Model`: every card becomes a call of the model's methods, or is refused."""
from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from . import laws, profile
from ._bridge import keywords
from .deck import Block, Deck
from .errors import UsageError
from .materials import Orientation
from .model_parts import Tool
from .model_read_cards import Card, contact_method, friction_law, material
from .model_read_mesh import HELD_BY_WORD, MeshCards, expanded
from .model_read_step import StepCards

if TYPE_CHECKING:
    from .model import Model


def read_model(scene: Deck | str | Path, kind: type[Model]) -> Model:
    """The model of a deck; see `Model.read`."""
    deck = scene if isinstance(scene, Deck) else Deck.read(scene)
    return _Reader(deck, kind).model


class _Reader:
    """Cards in the order of the deck; what refers to later cards is done at the end."""

    def __init__(self, deck: Deck, model: type[Model]):
        blocks = expanded(deck)
        self.mesh_cards = MeshCards(blocks)
        kind, letters, mesh = self.mesh_cards.build()
        self.model = model(deck.name, mesh, kind=kind, letters=letters)
        self.folder = deck.folder
        self.tools: dict[int, Tool] = {}            # by the label of the reference node
        self.profiles: dict[str, profile.Profile | profile.Stl] = {}
        self.material_cards: dict[str, list[Card]] = {}
        self.interactions: dict[str, list[Card]] = {}
        self.controls: dict[str, bool] = {}
        self.pairs: list[tuple[str, list, dict]] = []
        self.of_pair: dict[tuple[str, str], dict] = {}
        self.of_all: dict = {}
        self.supports: list[Card] = []
        self.sections: list[tuple[str, str, float, str, str]] = []
        self.axes: dict[str, Orientation] = {}
        self.within: list[Card] = []                # cards of the material or interaction at hand
        first = next((k for k, b in enumerate(blocks) if b.keyword == "STEP"), len(blocks))
        for block in blocks[:first]:
            self._model_card(Card(block))
        self._finish()
        StepCards(self, blocks[first:])

    def _model_card(self, card: Card) -> None:
        name = "_" + card.keyword.lower().replace(" ", "_")
        if card.keyword in MeshCards.KEYWORDS or card.keyword == "HEADING":
            return
        if card.keyword in ("ELASTIC", "HYPERELASTIC", "PLASTIC", "RATE DEPENDENT", "VISCOPLASTIC",
                            "EXPANSION", "DENSITY", "CYCLIC HARDENING", "POTENTIAL",
                            "SURFACE BEHAVIOR", "FRICTION"):
            self.within.append(card)
        elif hasattr(self, name):
            getattr(self, name)(card)
            card.done()
        elif any(row["reported"] for row in keywords() if row["name"] == card.keyword):
            self.model.settings.append(card.block)
        else:
            raise UsageError(f"Model has no method for *{card.keyword}",
                             help="run the deck itself: lopin.run('name.inp')")

    # ---- cards of the model part ----

    def _material(self, card: Card) -> None:
        self.within = self.material_cards[card.take("NAME").upper()] = []

    def _surface_interaction(self, card: Card) -> None:
        self.within = self.interactions[card.take("NAME").upper()] = []

    def _section_controls(self, card: Card) -> None:
        self.controls[card.take("NAME")] = card.take("FORMULATION", "AUTO").upper() == "FULL"

    def _solid_section(self, card: Card) -> None:
        thickness = card.numbers() or [1.0]
        self.sections.append((card.take("ELSET").upper(), card.take("MATERIAL").upper(),
                              thickness[0], card.take("CONTROLS", ""),
                              str(card.take("ORIENTATION", "")).upper()))

    def _orientation(self, card: Card) -> None:
        card.take("SYSTEM"), card.take("DEFINITION")
        values = [float(v) for v in card.rows[0]]
        if any(values[6:]):
            raise UsageError("Model has orientations about the origin")
        turn = card.rows[1] if len(card.rows) > 1 else [3]
        axis, angle = turn[0], turn[1] if len(turn) > 1 else 0.0
        self.axes[card.take("NAME").upper()] = Orientation(values[:3], values[3:6], float(angle),
                                                           int(axis))

    def _surface(self, card: Card) -> None:
        """Tools and surfaces of points; those of elements are read with the mesh."""
        name, kind = card.take("NAME").upper(), card.take("TYPE", "ELEMENT").upper()
        if kind == "ELEMENT":
            return
        if kind == "NODE":
            if len(card.rows) != 1:
                raise UsageError(f"Model has surfaces of one point set, not of {len(card.rows)}")
            self.model.surface_of_points(name, self._set_of(card.rows[0][0]), *card.rows[0][1:])
        elif kind == "STL":
            path = str(card.take("INPUT")).strip('"')
            self.profiles[name] = profile.stl(self.folder/path, card.number("SCALE") or 1.0,
                                              is_open=bool(card.take("OPEN")),
                                              repair=bool(card.take("REPAIR")))
        else:
            frame = [tuple(map(float, r)) for r in card.rows if not isinstance(r[0], str)]
            rows = [(r[0].upper(), *map(float, r[1:])) for r in card.rows if isinstance(r[0], str)]
            self.profiles[name] = profile.Profile(tuple(rows), kind, tuple(frame),
                                                  card.number("FILLET RADIUS") or 0.0)

    def _rigid_body(self, card: Card) -> None:
        label = self.mesh_cards.single(card.take("REF NODE"))
        surface = str(card.take("ANALYTICAL SURFACE", "")).upper()
        body = {what: str(card.take(key, "")).upper()
                for what, key in (("points", "NSET"), ("elements", "ELSET"))}
        all_free = self.model.tool_directions()
        at = self.mesh_cards.nodes[label][:self.model.mesh.ndim]
        node_name = self.mesh_cards.name_of(label)
        if surface:
            tool = self.model.rigid_tool(surface, self.profiles[surface], at, all_free,
                                         node_name=node_name)
        else:
            tool = self.model.rigid_body(node_name or f"BODY{label}", at, all_free, **body,
                                         node_name=node_name)
        self.tools[label] = tool

    def _contact_pair(self, card: Card) -> None:
        adjust = card.take("ADJUST")
        kind = str(card.take("TYPE", "")).upper()
        tied = bool(card.take("TIED"))
        options = {"adjust": adjust.lower() if str(adjust).upper() in ("YES", "NO") else adjust,
                   "small_sliding": bool(card.take("SMALL SLIDING")), "tied": tied,
                   "surface_to_surface": kind != "NODE TO SURFACE" if kind else None,
                   "smooth": str(card.take("SMOOTH", "NO")).upper() == "YES",
                   "extension": card.number("EXTENSION ZONE")}
        self.pairs.append((card.take("INTERACTION").upper(), card.rows, options))

    def _contact_controls(self, card: Card) -> None:
        slave, master = card.take("SLAVE"), card.take("MASTER")
        found = self.of_pair.setdefault((slave.upper(), master.upper()), {}) if slave \
            else self.of_all
        for word, key in (("penetration", "RELATIVE PENETRATION TOLERANCE"),
                          ("depth", "ABSOLUTE PENETRATION TOLERANCE")):
            if key in card.left:
                found[word] = card.number(key)
        if "MAX AUGMENTATIONS" in card.left:
            found["max_augmentations"] = int(card.take("MAX AUGMENTATIONS"))
        initial = str(card.take("INITIAL", "")).lower()
        found["initial"] = "" if initial == "automatic" else initial

    def _clearance(self, card: Card) -> None:
        pair = card.take("SLAVE").upper(), card.take("MASTER").upper()
        self.of_pair.setdefault(pair, {})["clearance"] = card.number("VALUE")

    def _tie(self, card: Card) -> None:
        card.take("NAME"), card.take("ADJUST")
        mortar = str(card.take("TYPE", "SURFACE TO SURFACE")).upper() == "SURFACE TO SURFACE"
        tolerance = card.number("POSITION TOLERANCE")
        for slave, master in card.rows:
            self.model.tie(slave.upper(), master.upper(), tolerance=tolerance,
                           surface_to_surface=mortar)

    def _amplitude(self, card: Card) -> None:
        flat = [float(v) for row in card.rows for v in row if v is not None]
        card.take("DEFINITION")
        self.model.amplitude(card.take("NAME").upper(), list(zip(flat[::2], flat[1::2])),
                             total_time=str(card.take("TIME", "")).upper() == "TOTAL TIME",
                             absolute=str(card.take("VALUE", "")).upper() == "ABSOLUTE")

    def _boundary(self, card: Card) -> None:
        self.supports.append(Card(Block("BOUNDARY", card.left, card.rows)))
        card.left = {}

    def _equation(self, card: Card) -> None:
        rows = iter(card.rows)
        for row in rows:
            n, flat = int(row[0]), []
            while len(flat) < 3*n:
                flat += [v for v in next(rows) if v is not None]
            self.model.equation(*((self.target(flat[k]), int(flat[k + 1]), float(flat[k + 2]))
                                  for k in range(0, 3*n, 3)))

    def _transform(self, card: Card) -> None:
        axes = [float(v) for v in card.rows[0]]
        self.model.transform(card.take("NSET").upper(), axes[:3], axes[3:6],
                             cylindrical=str(card.take("TYPE", "R")).upper() == "C")

    def _initial_conditions(self, card: Card) -> None:
        kind = card.take("TYPE").upper()
        for row in card.rows:
            if kind == "TEMPERATURE":
                self.model.initial_temperature(self.target(row[0]), float(row[1]))
            elif kind == "STRESS":
                self.model.initial_stress(row[0].upper(), *map(float, row[1:]))
            else:
                self.model.initial.append((kind, [row]))

    def _lopin(self, card: Card) -> None:
        names = {name: name.lower().replace(" ", "_") for name in list(card.left)}
        self.model.options(**{word: card.take(name) for name, word in names.items()})

    # ---- what refers to other cards ----

    def _finish(self) -> None:
        made = {name: material(name, cards) for name, cards in self.material_cards.items()}
        for elements, name, thickness, controls, axes in self.sections:
            self.model.section(elements, made[name], thickness, orientation=self.axes.get(axes),
                               full_integration=self.controls.get(controls, False))
        for name, rows, options in self.pairs:
            for slave, master in rows:
                self._contact(slave.upper(), master.upper(), name, dict(options))
        for card in self.supports:
            for points, values in self.boundary_rows(card):
                self.model.fixed += self.model.loads(points, values)
            card.done()

    def _contact(self, slave: str, master: str, name: str, options: dict) -> None:
        more = self.of_all | self.of_pair.get((slave, master), {})
        method, no_separation, law = self._interaction(name, {
            k: more.pop(k) for k in ("penetration", "depth", "max_augmentations") if k in more})
        pair = self.model.contact(slave, self._master(master), method, friction=law,
                                  no_separation=no_separation, **options, **more)
        self.of_pair[(slave, master)] = {"pair": pair, "interaction": name}

    def _master(self, name: str) -> str | Tool:
        return next((t for t in self.tools.values() if t.name == name and t.profile), name)

    def _interaction(self, name: str, controls: dict):
        """Method, no separation, friction."""
        method, no_separation, law = laws.Lagrange(), False, None
        for block in self.interactions[name]:
            card = Card(Block(block.keyword, block.left, block.rows))
            if card.keyword == "FRICTION":
                law = friction_law(card)
            else:
                no_separation = bool(card.take("NO SEPARATION"))
                method = contact_method(card, controls)
            card.done()
        return method, no_separation, law

    # ---- for steps, too ----

    def target(self, field):
        """What the model calls the points of a data line: a set, a tool, an index."""
        labels = self.mesh_cards.labels(field)
        if len(labels) == 1 and labels[0] in self.tools:
            return self.tools[labels[0]]
        return self._set_of(field) if isinstance(field, str) else self.mesh_cards.index[field]

    def _set_of(self, field) -> str:
        self.model.known(str(field).upper(), "point")
        return str(field).upper()

    def boundary_rows(self, card: Card):
        """Points and values by direction, of each data line."""
        for row in card.rows:
            points = self.target(row[0])
            known = self.model.tool_directions()
            if not isinstance(points, Tool):
                known = tuple(range(1, self.model.mesh.ndim + 1))
            if isinstance(row[1], str):
                yield points, {d: 0.0 for d in HELD_BY_WORD[row[1].upper()] if d in known}
                continue
            last = row[2] if len(row) > 2 and row[2] is not None else row[1]
            value = float(row[3]) if len(row) > 3 and row[3] is not None else 0.0
            yield points, {d: value for d in range(row[1], last + 1) if d in known}
