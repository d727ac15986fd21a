"""Units of results: names of quantities, and what a heading says they are measured in."""
from __future__ import annotations

import re
from dataclasses import dataclass

_STRESS = {("N", "mm"): "MPa", ("N", "m"): "Pa", ("kN", "mm"): "GPa", ("kN", "m"): "kPa",
           ("MN", "m"): "MPa"}
_COLUMNS = ((r"(^|\.)time$", "time"), (r"\.u[1-3]$", "length"), (r"\.u[4-6]$", "rad"),
            (r"\.rf[1-3]$", "force"), (r"\.rf[4-6]$", "force*length"), (r"\.force\d$", "force"),
            (r"\.area$", "length^2"), (r"\.max_pressure$", "stress"),
            (r"\.max_penetration$", "length"), (r"^energy\.", "force*length"),
            (r"^volume$", "length^3"))
_FIELDS = {"U": "length", "RF": "force", "S": "stress", "Mises": "stress", "CPRESS": "stress",
           "COPEN": "length", "FORCE": "force", "R_n": "force", "R_t": "force", "u_n": "length",
           "u_t": "length", "SLIP_PATH": "length", "FRICTION_WORK": "force*length", "X": "length",
           "E": "-", "PEEQ": "-", "NORMAL": "-"}


@dataclass(frozen=True)
class Units:
    """What a scene is measured in; words that nobody said are empty.

    >>> Units("N", "mm", "s").of("stress"), Units("N", "mm", "s").of("force*length")
    ('MPa', 'N mm')
    >>> Units().of("stress")
    'stress'
    """

    force: str = ""
    length: str = ""
    time: str = ""

    def of(self, quantity: str) -> str:
        """Unit of a quantity such as "stress" or "length^2"; its own name where it is not known."""
        if quantity == "stress" and self.force and self.length:
            return _STRESS.get((self.force, self.length), f"{self.force}/{self.length}^2")
        words = {"force": self.force, "length": self.length, "time": self.time}
        parts = [(words.get(name.partition("^")[0], ""), name) for name in quantity.split("*")]
        if not all(unit for unit, _ in parts):
            return quantity
        return " ".join(unit + name[len(name.partition("^")[0]):] for unit, name in parts)

    def label(self, name: str, quantity: str) -> str:
        """Text of an axis.

        >>> Units("N", "mm").label("x", "length"), Units().label("closed", "-")
        ('x [mm]', 'closed [-]')
        """
        return f"{name} [{self.of(quantity)}]"


def units_of(heading: str) -> Units:
    """The units that a heading names: force, length and, if it is there, time.

    >>> units_of("Rigid sphere on a half-space, N mm s")
    Units(force='N', length='mm', time='s')
    >>> units_of("A title")
    Units(force='', length='', time='')
    """
    found = re.search(r"\b(mN|N|kN|MN|lbf)[ ,]+(um|mm|cm|m|in)\b(?:[ ,]+(ms|s|min|h)\b)?", heading)
    return Units(*(word or "" for word in found.groups())) if found else Units()


def quantity_of(name: str) -> str:
    """The quantity of a field or of a column of the history; "-" where it has no unit.

    >>> quantity_of("DIE.rf2"), quantity_of("Mises"), quantity_of("iterations")
    ('force', 'stress', '-')
    """
    if name in _FIELDS:
        return _FIELDS[name]
    return next((q for pattern, q in _COLUMNS if re.search(pattern, name)), "-")
