"""The square cup of NUMISHEET'93 with any mesh: `python tests/benchmarks/square_cup.py [cells
[stroke [layers [friction [kind [r0,r45,r90]]]]]]`.

Prints how far the edge has moved in, the sheet at its thinnest and the force, for a few strokes.
Needs decks/make on the path; results go to out/ of the present folder.
"""
from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]/"decks"/"make"))
from square_cup import THICK, square_cup  # noqa: E402

import lopin  # noqa: E402

RECALLED = {15.0: (6.2, 3.2),
            40.0: (28.0, 15.4)}   #: middle of a side, diagonal [mm]; means of experiments


def rows(result) -> list[tuple[float, ...]]:
    """Stroke, draw-in of side and diagonal, least thickness, force of the whole punch."""
    found = []
    for k, time in enumerate(result.times):
        piece = result.to_meshio(k)
        x, u = piece.points, np.asarray(piece.point_data["U"])
        low = np.flatnonzero(np.abs(x[:, 2]) < 1e-9)
        blank = low[(x[low, 0] > -1e-9) & (x[low, 1] >
                                           -1e-9) & (np.max(x[low, :2], axis=1) < 75.001)]
        side = blank[np.argmin(np.abs(x[blank, 0] - 75.0) + np.abs(x[blank, 1]))]
        tip = blank[np.argmin(np.abs(x[blank, :2] - 75.0).sum(axis=1))]
        above = {tuple(np.round(x[i, :2], 6)): i
                 for i in np.flatnonzero(np.abs(x[:, 2] - THICK) < 1e-9)}
        thick = min(np.linalg.norm((x + u)[above[key]] - (x + u)[i])
                    for i in blank if (key := tuple(np.round(x[i, :2], 6))) in above)
        history = result.history
        found.append((-np.interp(time, history["time"], history["PUNCH.u3"]), -u[side, 0],
                      np.hypot(*u[tip, :2]), thick,
                      -4e-3*np.interp(time, history["time"], history["PUNCH.rf3"])))
    return found


def three_values(word: str) -> tuple[float, float, float]:
    """Values of Lankford at 0, 45 and 90 degrees; 1.79,1.51,2.27 are recalled of the conference."""
    first, second, third = (float(piece) for piece in word.split(","))
    return first, second, third


def main(words: list[str]) -> None:
    """One mesh."""
    casts = dict(cells=int, stroke=float, layers=int, mu=float, kind=str, lankford=three_values)
    given = {name: cast(word) for (name, cast), word in zip(casts.items(), words)}
    deck = lopin.Deck.parse(square_cup(**given),
                            "_".join(["square_cup", *words]).translate(str.maketrans(".,", "p_")))
    print("stroke  side  diagonal  thinnest  force [kN]")
    for row in rows(lopin.run(deck, executable=True)):
        print("{:6.2f} {:5.2f} {:8.2f} {:9.3f} {:9.1f}".format(*row))
    recalled = RECALLED.get(given.get("stroke", 15.0))
    if recalled:
        print("recalled of the conference: side {}, diagonal {}".format(*recalled))


if __name__ == "__main__":
    main(sys.argv[1:])
