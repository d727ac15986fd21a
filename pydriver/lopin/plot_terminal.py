"""Contact pressure as a picture of characters, for a terminal without windows."""
from __future__ import annotations

import sys

import numpy as np


def pressure(contact, *, width: int = 64, height: int = 16, axis: int | None = None) -> str:
    """Largest pressure of the slave points in each column, against a coordinate.

    Parameters
    ----------
    contact : Contact, such as ``result.contact("TOP").last``
    width, height : of the picture, in characters
    axis : which coordinate; the longest side of the surface unless given
    """
    place = contact.place
    if axis is None:
        axis = int(np.argmax(np.ptp(place, axis=0)))
    x, p = place[:, axis], contact.pressure
    most = float(p.max(initial=0.0))
    title = f"{contact.pair}: pressure against {'xyz'[axis]}, largest {most:.6g}"
    if not most > 0.0:
        return f"{contact.pair}: nothing is pressed"
    closed = x[p > 1e-6*most]
    margin = 0.1*np.ptp(closed) or 0.5*np.ptp(x)
    low, high = max(x.min(), closed.min() - margin), min(x.max(), closed.max() + margin)
    column = np.clip(((x - low)/((high - low) or 1.0)*(width - 1)).round().astype(int), -1, width)
    full, point = ("\u2502", "\u25cf") if _is_unicode() else ("|", "*")
    rows = [[" "]*width for _ in range(height)]
    for k in range(width):
        here = p[(column == k) & (x >= low) & (x <= high)]
        if len(here) == 0:
            continue
        top = round(float(here.max())/most*(height - 1))
        rows[height - 1 - top][k] = point
    lines = [title]
    for k, row in enumerate(rows):
        scale = most*(height - 1 - k)/(height - 1)
        lines.append(f"{scale:10.4g} {full}{''.join(row).rstrip()}")
    lines.append(f"{'':11}{'-'*(width + 1)}")
    lines.append(f"{'':11}{low:<{width//2}.5g}{high:>{width - width//2}.5g}")
    return "\n".join(lines)


def _is_unicode() -> bool:
    return "utf" in (getattr(sys.stdout, "encoding", None) or "").lower()
