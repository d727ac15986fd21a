"""The drawn cup to any depth: `python tests/benchmarks/cup.py [stroke [holder [elements layers]]]`.

Prints the radius of the rim, its thickening, the thickest and thinnest of the sheet, and the force
of the punch, beside the rim of a ring that flows by its hoop stress alone: t/t0 = sqrt(R0/r),
whatever the metal hardens.
"""
from __future__ import annotations

import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]/"decks"/"make"))
from sheets import cup  # noqa: E402

import lopin  # noqa: E402

RADIUS, THICK = 100.0, 0.82   #: of the blank [mm]


class Row(NamedTuple):
    """The cup at an increment; strains of thickness are t/t0 - 1."""

    stroke: float     #: of the punch [mm]
    rim: float        #: radius of the rim [mm]
    thicker: float    #: strain of thickness of the rim
    hoop: float       #: that of a ring under hoop stress alone
    thickest: float   #: largest of the sheet
    thinnest: float   #: least
    force: float      #: of the punch [kN]


def drawn(stroke: float = 60.0, holder: float = 1e5, elements: int = 60, layers: int = 3,
          kind: str = "CAX4") -> list[Row]:
    """Run it; what it reached if it stops, as it must once the rim leaves the holder."""
    text = cup(elements, layers, kind, stroke=stroke, holder=holder, opened=False)
    try:
        result = lopin.run(lopin.Deck.parse(text, "cup"))
    except lopin.NotConvergedError as stopped:
        result = stopped.result
    return [row(result, k, elements, layers) for k in range(len(result.times))]


def row(result, k: int, elements: int, layers: int) -> Row:
    """One increment; nodes run through the thickness first."""
    grid = (elements + 1, layers + 1, 2)
    mesh = result.to_meshio(k)
    sheet = (mesh.points + np.asarray(mesh.point_data["U"]))[:grid[0]*grid[1], :2].reshape(grid)
    strain = np.linalg.norm(sheet[:, -1] - sheet[:, 0], axis=1)/THICK - 1.0
    rim = sheet[-1, :, 0].mean()
    history, time = result.history, result.times[k]
    stroke, force = (-np.interp(time, history["time"], history[f"PUNCH.{word}"])
                     for word in ("u2", "rf2"))
    return Row(stroke, rim, strain[-1], (RADIUS/rim)**0.5 - 1.0, strain.max(), strain.min(),
               1e-3*force)


def main(words: list[str]) -> None:
    """Rows every 5 mm, and the last."""
    values = [cast(word) for cast, word in zip((float, float, int, int, str), words)]
    rows = drawn(*values)
    print("stroke    rim  thicker  hoop alone  thickest  thinnest  force [kN]")
    due = 0.0
    for found in rows:
        if found.stroke >= due - 0.2 or found is rows[-1]:
            due = found.stroke + 5.0
            print("{:6.2f} {:6.2f} {:8.4f} {:11.4f} {:9.4f} {:9.4f} {:11.1f}".format(*found))


if __name__ == "__main__":
    main(sys.argv[1:])
