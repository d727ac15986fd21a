"""Drawbeads as a restraining line force: cards of a narrow band that holds a sheet back.

A bead bends a sheet to and fro over radii that a mesh of a whole part does not have. What it does
to the part is a force per length of its line, against the way that the sheet runs in. Here it is a
rigid band of a given width along that line, in contact with the sheet, whose shear is bounded by
force/width whatever the pressure (LAW=TRESCA with TAUMAX). Contact is integrated over the faces of
the sheet (SURFACE TO SURFACE), so that the force does not depend on where its nodes are.
"""
from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .errors import ModelError


def drawbead(name: str, line, *, force: float, width: float, faces, sheet: str, node: int,
             element: int, method: str = "DIRECT") -> str:
    """Cards of a drawbead, to stand behind the surface of the sheet and before the first step.

    Parameters
    ----------
    name : of the bead: element set and surface; its interaction is NAME_LINE
    line : one place (x, y) in the plane; places (n, 3) of a line in space, with corners if bent
    force : restraining force per length of the line (in the plane per thickness)
    width : of the band, some cells of the sheet
    faces : direction from the bead to the sheet
    sheet : surface of the sheet
    node : label of the reference node, which the deck holds or loads; those behind it are taken
    element : first label of its elements

    It presses where the deck presses it: by the reference node held at the level of the sheet, or
    by a force. The bound is reached at a pressure of a tenth of it (force/width/10).

    >>> print(drawbead("B", (10., 1.), force=80., width=4., faces=(0., -1.), sheet="TOP",
    ...                node=900, element=90), end="")
    *NODE
    900, 10.0, 1.0
    901, 12.0, 1.0
    902, 8.0, 1.0
    *ELEMENT, TYPE=R2D2, ELSET=B
    90, 901, 902
    *RIGID BODY, ELSET=B, REF NODE=900
    *SURFACE, NAME=B
    B,
    *SURFACE INTERACTION, NAME=B_LINE
    *SURFACE BEHAVIOR, DIRECT
    *FRICTION, LAW=TRESCA, TAUMAX=20.0
    *CONTACT PAIR, INTERACTION=B_LINE, TYPE=SURFACE TO SURFACE
    TOP, B
    """
    if not (force > 0.0 and width > 0.0):
        raise ModelError(f"a drawbead has a force and a width above 0, not {force!r} and {width!r}")
    toward = np.asarray(faces, float)
    toward = toward/np.linalg.norm(toward)
    places = np.atleast_2d(np.asarray(line, float))
    if places.shape[1] != len(toward) or (len(toward) == 3) != (len(places) > 1):
        raise ModelError("the line of a drawbead is a place (x, y), or places (n, 3) from 2 on",
                         help="`faces` has as many components")
    if len(toward) == 2:
        side = 0.5*width*np.array([-toward[1], toward[0]])
        corners, cells, word = [places[0] + side, places[0] - side], [(0, 1)], "R2D2"
    else:
        side, word = 0.5*width*_sideways(places, toward), "R3D4"
        corners = [p for pair in zip(places - side, places + side) for p in pair]
        cells = [(2*k, 2*k + 2, 2*k + 3, 2*k + 1) for k in range(len(places) - 1)]

    def row(label, values):
        return f"{label}, " + ", ".join(repr(round(float(v), 12)) for v in values)

    return "\n".join([
        "*NODE", row(node, places[0]), *(row(node + 1 + k, p) for k, p in enumerate(corners)),
        f"*ELEMENT, TYPE={word}, ELSET={name}",
        *(f"{element + k}, " + ", ".join(str(node + 1 + c) for c in cell)
          for k, cell in enumerate(cells)),
        f"*RIGID BODY, ELSET={name}, REF NODE={node}", f"*SURFACE, NAME={name}", f"{name},",
        f"*SURFACE INTERACTION, NAME={name}_LINE", f"*SURFACE BEHAVIOR, {method}",
        f"*FRICTION, LAW=TRESCA, TAUMAX={force/width!r}",
        f"*CONTACT PAIR, INTERACTION={name}_LINE, TYPE=SURFACE TO SURFACE", f"{sheet}, {name}", ""])


def _sideways(places: NDArray, toward: NDArray) -> NDArray:
    """Across a line, so that bands of bent lines keep their width (n, 3)."""
    across = np.cross(toward, np.diff(places, axis=0))
    length = np.linalg.norm(across, axis=1)
    if not (length > 0.0).all():
        raise ModelError("the line of a drawbead runs along its faces, or stands still")
    across /= length[:, None]
    before, behind = np.vstack([across[:1], across]), np.vstack([across, across[-1:]])
    return (before + behind)/(1.0 + (before*behind).sum(axis=1))[:, None]
