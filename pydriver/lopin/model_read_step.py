"""The steps of a deck, for `Model.read`."""
from __future__ import annotations

import re
from typing import TYPE_CHECKING

import numpy as np

from .deck import Block
from .errors import UsageError
from .model_read_cards import Card, friction_law

if TYPE_CHECKING:
    from .model_read import _Reader

_OP = {"BOUNDARY": "supports", "CLOAD": "forces", "DSLOAD": "pressures", "DLOAD": "body forces",
       "TEMPERATURE": "temperatures"}
_FILES = {"NODE FILE": 0, "EL FILE": 1, "ELEMENT FILE": 1, "CONTACT FILE": 2, "NODE OUTPUT": 0,
          "ELEMENT OUTPUT": 1, "CONTACT OUTPUT": 2}
_PRINTS = {"NODE PRINT": "points", "EL PRINT": "elements", "CONTACT PRINT": "pair",
           "NODE OUTPUT": "points", "ELEMENT OUTPUT": "elements", "CONTACT OUTPUT": "pair"}


class StepCards:
    """Cards from the first *STEP on, each a call of a method of `Step`."""

    def __init__(self, reader: _Reader, blocks: list[Block]):
        self.reader, self.model = reader, reader.model
        self.step = self.head = None
        self.changed = ""                       # interaction of the *CHANGE FRICTION above
        self.parent = ("FIELD", 1)
        for block in blocks:
            card = Card(block)
            name = "_" + card.keyword.lower().replace(" ", "_")
            if card.keyword in _OP:
                self._load(card)
            elif card.keyword in _FILES or card.keyword in _PRINTS:
                self._request(card)
            elif hasattr(self, name):
                getattr(self, name)(card)
            else:
                raise UsageError(f"Model has no method for *{card.keyword} in a step",
                                 help="run the deck itself: lopin.run('name.inp')")
            card.done()

    def _step(self, card) -> None:
        nlgeom = card.take("NLGEOM")
        self.head = {"nlgeom": nlgeom is True or str(nlgeom).upper() == "YES",
                     "name": str(card.take("NAME", "")).upper(), "most": int(card.take("INC", 100)),
                     "at_once": str(card.take("AMPLITUDE", "RAMP")).upper() == "STEP"}

    def _end_step(self, card) -> None:
        self.step = None

    def _static(self, card) -> None:
        given = card.numbers()
        first, period, smallest, largest = [*given, 0.0, 0.0, 0.0, 0.0][:4]
        period = period or 1.0
        fixed = bool(card.take("DIRECT"))
        first = first or 1.0
        self.step = self.model.step(time=period, first=first, smallest=smallest or None,
                                    largest=largest or (first if fixed else period), fixed=fixed,
                                    **self.head)
        self.step.output((), (), ())

    def _amplitude(self, card) -> None:
        self.reader._amplitude(card)

    def _load(self, card) -> None:
        if str(card.take("OP", "MOD")).upper() == "NEW":
            self.step.replace(_OP[card.keyword])
        amplitude = str(card.take("AMPLITUDE", "")).upper()
        getattr(self, "_rows_of_" + card.keyword.lower())(card, amplitude)

    def _rows_of_boundary(self, card, amplitude: str) -> None:
        velocity = str(card.take("TYPE", "DISPLACEMENT")).upper() == "VELOCITY"
        for points, values in self.reader.boundary_rows(card):
            for load in self.model.loads(points, values):
                self.step.moves.append(load._replace(
                    amplitude=self.model.known_amplitude(amplitude), velocity=velocity))

    def _rows_of_cload(self, card, amplitude: str) -> None:
        for field, dof, value in card.rows:
            for load in self.model.loads(self.reader.target(field), {dof: float(value)}):
                self.step.forces.append(load._replace(
                    amplitude=self.model.known_amplitude(amplitude)))

    def _rows_of_dsload(self, card, amplitude: str) -> None:
        for surface, word, value, *towards in card.rows:
            if word.upper() == "P":
                self.step.pressure(surface.upper(), value, amplitude=amplitude)
            else:
                self.step.traction(surface.upper(), value, towards, amplitude=amplitude)

    def _rows_of_dload(self, card, amplitude: str) -> None:
        for field, word, value, *towards in card.rows:
            word = word.upper()
            if re.fullmatch(r"P\d", word):
                self.step.pressure(self._face(field, int(word[1])), value, amplitude=amplitude)
            elif word == "GRAV":
                self.step.gravity(self._elements(field), value, towards, amplitude=amplitude)
            else:
                self.step.body_force(self._elements(field), amplitude=amplitude,
                                     **{self._direction(word[1]): value})

    def _rows_of_temperature(self, card, amplitude: str) -> None:
        for field, value in card.rows:
            self.step.temperature(self.reader.target(field), float(value), amplitude=amplitude)

    def _direction(self, letter: str) -> str:
        return {"X": "r", "Y": "z"}[letter] if self.model.kind == "axisymmetric" \
            else letter.lower()

    def _elements(self, field) -> str:
        """Name of an element set; one element gets a set."""
        if isinstance(field, str):
            return field.upper()
        name, mesh = f"ELEMENT{field}", self.model.mesh
        members = np.array([self.reader.mesh_cards.element_index[field]])
        self.model.mesh = mesh.replaced(element_sets=mesh.element_sets | {name: members})
        return name

    def _face(self, field, face: int) -> str:
        """Name of a surface made of one face of each element."""
        elements = self._elements(field)
        name, mesh = f"{elements}_S{face}", self.model.mesh
        rows = np.array([(e, face) for e in mesh.element_sets[elements]])
        self.model.mesh = mesh.replaced(surfaces=mesh.surfaces | {name: rows})
        return name

    def _change_friction(self, card) -> None:
        self.changed = card.take("INTERACTION").upper()

    def _friction(self, card) -> None:
        law = friction_law(card)
        for known in self.reader.of_pair.values():
            if known["interaction"] == self.changed:
                self.step.change_friction(known["pair"], law)

    def _model_change(self, card) -> None:
        if card.take("TYPE").upper() != "CONTACT PAIR":
            raise UsageError("Model adds and removes contact pairs only")
        card.take("ADD")
        change = self.step.remove_contact if card.take("REMOVE") else self.step.add_contact
        change(*((s.upper(), m.upper()) for s, m in card.rows))

    def _restart(self, card) -> None:
        card.take("WRITE")
        self.step.checkpoint(int(card.take("FREQUENCY", 1)))

    def _output(self, card) -> None:
        kind = "HISTORY" if card.take("HISTORY") else "FIELD"
        card.take("FIELD"), card.take("OP")
        self.parent = (kind, int(card.take("FREQUENCY", 1)))

    def _request(self, card) -> None:
        words = [str(w).upper() for row in card.rows for w in row if w is not None]
        under = card.keyword.endswith("OUTPUT")
        every = self.parent[1] if under else int(card.take("FREQUENCY", 1))
        if card.keyword in _FILES and not (under and self.parent[0] == "HISTORY"):
            for name in ("NSET", "ELSET"):      # the files hold all
                card.take(name)
            kinds = [(), (), ()]
            kinds[_FILES[card.keyword]] = words
            self.step.output(*kinds, every=every)
            return
        kind, totals = _PRINTS[card.keyword], str(card.take("TOTALS", "NO")).lower()
        if kind == "pair":
            what = self.model.known_pair((card.take("SLAVE").upper(), card.take("MASTER").upper()))
        elif kind == "points":
            what = self.reader.target(card.take("NSET"))
        else:
            what = card.take("ELSET").upper()
        self.step.table(what, *words, of=kind, every=every, totals=totals)
