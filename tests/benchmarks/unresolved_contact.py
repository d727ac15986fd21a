"""What is told of contact on few facets, beside what is wrong: the tables of docs/theory.md.

    python tests/benchmarks/unresolved_contact.py

A ball (in the plane a cylinder) of 20 mm pressed into a block of 4 mm by given ways, on 1 to 64
facets; two blocks pressed together by a given way at the nodes of a coarser slave. Errors of the
force are beside the finest mesh of the row; both figures in per cent.
"""
from __future__ import annotations

import os
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")
sys.path[:0] = [str(ROOT/"tests"/"python")]

import test_unresolved_contact as scenes  # noqa: E402

import lopin  # noqa: E402


def cell(deck: lopin.Deck, right: float, code: str) -> str:
    """Error / what is told; a run that is refused says so."""
    try:
        result = lopin.run(deck)
    except lopin.NotConvergedError as error:
        return str(error)[:5]
    told = scenes.told(result, code)
    return f"{100.0*(scenes.force(result)/right - 1.0):+.1f} / {f'{100*told:.0f}' if told else '–'}"


def balls() -> None:
    """Rows of scenes, columns of facets on the side of the block."""
    facets = (1, 2, 4, 8, 16, 32)
    print("| block | way [mm] | " + " | ".join(map(str, facets)) + " |")
    print("| --- "*(2 + len(facets)) + "|")
    for word in scenes.WORDS:
        for depth in (0.02, 0.05):
            finest = {1: 24, 2: 12}[word[2]] if word[0] == "3d" else 64
            right = scenes.force(lopin.run(scenes.pressed_by_a_ball(word, finest, depth)))
            row = [cell(scenes.pressed_by_a_ball(word, n, depth), right, "W0563")
                   for n in facets if n < finest]
            print(f"| {word[0]}, {word[1]}, order {word[2]} | {depth} | "
                  + " | ".join(row + [""]*(len(facets) - len(row))) + " |", flush=True)


def blocks() -> None:
    """Rows of scenes, columns of facets on the side of the slave; 24 (space: 12) on the master."""
    print("| blocks | master | slave half as fine | a third | a quarter |")
    print("| --- | --- | --- | --- | --- |")
    metal = lopin.Material(lopin.Elastic(2e5, 0.3), lopin.Plastic([(300.0, 0.0), (1300.0, 1.0)]))
    for kind in ("plane strain", "axisymmetric", "3d"):
        master = 12 if kind == "3d" else 24
        for crown in (0.0, 0.02):
            for name, law, nlgeom in (("elastic", None, False), ("elastic, NLGEOM", None, True),
                                      ("metal, NLGEOM", metal, True)):
                def deck(slave, crown=crown, law=law, nlgeom=nlgeom, kind=kind, master=master):
                    return scenes.two_blocks(kind, slave, master, False, crown=crown, law=law,
                                             nlgeom=nlgeom)
                right = scenes.force(lopin.run(deck(master)))
                row = [cell(deck(master//k), right, "W0340") for k in (2, 3, 4)]
                print(f"| {kind}, {name} | {'R = 50' if crown else 'flat'} | " + " | ".join(row)
                      + " |", flush=True)


if __name__ == "__main__":
    balls()
    print()
    blocks()
