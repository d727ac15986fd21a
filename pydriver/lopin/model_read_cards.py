"""Cards of a deck as values, materials and laws, for `Model.read`."""
from __future__ import annotations

from dataclasses import replace

from . import flow_curves, friction, laws, materials
from .deck import Block
from .errors import UsageError
from .model_read_mesh import plain

_METHODS = {"PENALTY": laws.Penalty, "AUGMENTED LAGRANGE": laws.Augmented,
            "PERTURBED LAGRANGE": laws.Perturbed}
_HARDENING = {"ISOTROPIC": None, "SWIFT": flow_curves.Swift, "VOCE": flow_curves.Voce,
              "HOLLOMON": flow_curves.Hollomon, "LINEAR": flow_curves.LinearHardening,
              "KINEMATIC": flow_curves.Kinematic}


class Card:
    """A block whose parameters are taken one by one, so that what is left over is noticed."""

    def __init__(self, block: Block):
        self.block = block
        self.keyword, self.rows = block.keyword, [list(row) for row in block.data]
        self.left = {name: plain(value) for name, value in block.parameters.items()}

    def take(self, name: str, default=None):
        """A parameter; True for a flag."""
        if name not in self.left:
            return default
        value = self.left.pop(name)
        return True if value is None else value

    def number(self, name: str) -> float | None:
        """A parameter that is a number, or None."""
        value = self.take(name)
        return None if value is None else float(value)

    def numbers(self) -> list[float]:
        """The first data line as numbers, without empty fields at its end."""
        row = list(self.rows[0]) if self.rows else []
        while row and row[-1] is None:
            row.pop()
        return [0.0 if v is None else float(v) for v in row]

    def done(self) -> None:
        """Refuse what nobody took."""
        if self.left:
            raise UsageError(f"Model has no word for {', '.join(self.left)} of *{self.keyword}",
                             help="run the deck itself: lopin.run('name.inp')")


def material(name: str, cards: list[Card]) -> materials.Material:
    found, more = [], {}
    for card in cards:
        numbers = card.numbers()
        if card.keyword == "ELASTIC":
            card.take("TYPE")
            strain = str(card.take("STRAIN", "LOGARITHMIC")).lower()
            found.append(materials.Elastic(*(numbers + [0.0])[:2], strain=strain))
        elif card.keyword == "HYPERELASTIC":
            card.take("NEO HOOKE")
            found.append(materials.NeoHooke(*numbers[:2]))
        elif card.keyword == "PLASTIC":
            found.append(_hardening(card))
        elif card.keyword == "CYCLIC HARDENING":
            found[-1] = _growing(found[-1], card)
        elif card.keyword == "POTENTIAL":
            card.take("TYPE")
            found.append(materials.Hill48(numbers, str(card.take("DEFINITION", "RATIOS")).upper()))
        elif card.keyword == "RATE DEPENDENT":
            card.take("TYPE")
            found.append(materials.CowperSymonds(*numbers[:2]))
        elif card.keyword == "VISCOPLASTIC":
            card.take("LAW")
            found.append(materials.NortonHoff(*numbers[:2], rigid=bool(card.take("RIGID"))))
        else:
            card.take("TYPE")
            more[card.keyword.lower()] = numbers[0]
        card.done()
    return materials.Material(*found, name=name, **more)


def _hardening(card: Card) -> flow_curves.Hardening:
    kind = str(card.take("HARDENING", "ISOTROPIC")).upper()
    only = card.take("ONLY") is not None
    if kind == "COMBINED":
        card.take("DATA TYPE"), card.take("NUMBER BACKSTRESSES")
        y, *rest = card.numbers()
        return flow_curves.Chaboche(y, list(zip(rest[::2], rest[1::2])), only_friction=only)
    if kind not in _HARDENING:
        raise UsageError(f"Model has no hardening '{kind}'")
    if _HARDENING[kind] is None or kind == "KINEMATIC":
        return (_HARDENING[kind] or flow_curves.Plastic)(_table(card), only_friction=only)
    return _HARDENING[kind](*card.numbers(), only_friction=only)


def _table(card: Card) -> list | dict:
    """Rows of a flow curve, by temperature where they have one."""
    rows = [[0.0 if v is None else float(v) for v in (*row, 0.0)[:max(2, len(row))]]
            for row in card.rows]
    if all(len(row) < 3 for row in rows):
        return [row[:2] for row in rows]
    by_temperature: dict[float, list] = {}
    for stress, strain, temperature in rows:
        by_temperature.setdefault(temperature, []).append((stress, strain))
    return by_temperature


def _growing(law: flow_curves.Hardening, card: Card) -> flow_curves.Hardening:
    """Combined hardening with the growth of *CYCLIC HARDENING."""
    growth = tuple(card.numbers()[1:3]) if card.take("PARAMETERS") else _table(card)
    first = card.numbers()[0]
    if not isinstance(law, flow_curves.Chaboche) or first != law.y:
        raise UsageError("Model has *CYCLIC HARDENING below *PLASTIC, HARDENING=COMBINED of the "
                         "same yield stress")
    return replace(law, growth=growth)


def contact_method(card: Card, controls: dict) -> laws.Lagrange:
    card.take("DIRECT")
    numbers = card.numbers()
    law = str(card.take("PRESSURE-OVERCLOSURE", "HARD")).upper()
    for word, kind in _METHODS.items():
        if word in card.left:
            card.take(word)
            return kind(*numbers[:1], **(controls if kind is laws.Augmented else {}))
    if law == "LINEAR":
        return laws.Penalty(*numbers[:1])
    if law == "EXPONENTIAL":
        return laws.Exponential(*numbers[:2])
    if law == "TABULAR":
        return laws.Tabular(tuple(map(tuple, card.rows)))
    if law != "HARD":
        raise UsageError(f"Model has no pressure-overclosure '{law}'")
    return laws.Lagrange()


def friction_law(card: Card) -> friction.Friction:
    """The law of a *FRICTION card."""
    options = {"regularization": str(card.take("REGULARIZATION", "LINEAR")).lower(),
               "elastic_slip": card.number("ELASTIC SLIP"), "v0": card.number("V0"),
               "slip_tolerance": card.number("SLIP TOLERANCE"), "tau_max": card.number("TAUMAX"),
               "exact_stick": bool(card.take("LAGRANGE"))}
    numbers = card.numbers()
    law = str(card.take("LAW", "COULOMB")).upper()
    if card.take("ROUGH"):
        return friction.Rough(**options)
    if card.take("EXPONENTIAL DECAY"):
        return friction.StaticKinetic(*numbers, **options)
    if str(card.take("EQUIVALENT", "")).upper() == "MISES":
        law = "CRISTESCU"
    if law == "COULOMB" and len(numbers) > 2:
        if len(card.rows) > 1:
            raise UsageError("Model has no friction that varies with speed or pressure")
        numbers = numbers[:1]
    if law == "AUTO" and card.rows:
        numbers = [None if v is None else float(v) for v in card.rows[0]]
    return friction.law_of(law, numbers or ([0.0] if law == "COULOMB" else []), **options)
