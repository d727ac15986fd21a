"""What is told of meshes that are too coarse, beside what is wrong: the tables of docs/theory.md.

    python tests/benchmarks/unresolved_contact.py            docs/charts/told.csv, and the tables
    python tests/benchmarks/unresolved_contact.py --picture  docs/pictures/told.png from that file

A ball (in the plane a cylinder) of 20 mm pressed into a block of 4 mm by given ways, on 1 to 32
facets (W0563); two blocks pressed together by a given way at the nodes of a coarser slave (W0340);
blocks of coarse facets on a crowned one, surface to surface (W0349); cantilevers (W0565). Errors of
the force, or of work, are beside the finest mesh of the row, or exact; both figures in per cent.
"""
from __future__ import annotations

import csv
import os
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")
sys.path[:0] = [str(ROOT/"tests"/"python")]

import test_mesh_work as beams  # noqa: E402
import test_unresolved_contact as scenes  # noqa: E402

import lopin  # noqa: E402

TABLE, PICTURE = ROOT/"docs"/"charts"/"told.csv", ROOT/"docs"/"pictures"/"told.png"
TITLES = {"W0563": "contact hardly wider than a facet", "W0340": "a coarse slave at its nodes",
          "W0349": "a curve within slave facets", "W0565": "work that the mesh adds"}


def measured(deck: lopin.Deck, right: float, code: str) -> tuple[float, float] | None:
    """Error of the force, and what is told [%]; None: the run is refused."""
    try:
        result = lopin.run(deck)
    except lopin.NotConvergedError:
        return None
    return 100.0*(scenes.force(result)/right - 1.0), 100.0*scenes.told(result, code)


def balls() -> Iterator[tuple[str, str, int, tuple[float, float] | None]]:
    for word in scenes.WORDS:
        for depth in (0.02, 0.05):
            finest = {1: 24, 2: 12}[word[2]] if word[0] == "3d" else 64
            right = scenes.force(lopin.run(scenes.pressed_by_a_ball(word, finest, depth)))
            for n in (1, 2, 4, 8, 16, 32):
                if n < finest:
                    yield "W0563", f"{word[0]}, {word[1]}, order {word[2]}, {depth} mm", n, measured(
                        scenes.pressed_by_a_ball(word, n, depth), right, "W0563")


def blocks() -> Iterator[tuple[str, str, int, tuple[float, float] | None]]:
    """24 facets on the side of the master, in space 12; the slave's are twice as long, and on."""
    metal = lopin.Material(lopin.Elastic(2e5, 0.3), lopin.Plastic([(300.0, 0.0), (1300.0, 1.0)]))
    for kind in ("plane strain", "axisymmetric", "3d"):
        master = 12 if kind == "3d" else 24
        for crown in (0.0, 0.02):
            for name, law, nlgeom in (("elastic", None, False), ("elastic, NLGEOM", None, True),
                                      ("metal, NLGEOM", metal, True)):
                decks = [scenes.two_blocks(kind, n, master, False, crown=crown, law=law,
                                           nlgeom=nlgeom, increments=5)
                         for n in (master, master//2, master//3, master//4)]
                right = scenes.force(lopin.run(decks[0]))
                for n, deck in zip((2, 3, 4), decks[1:]):
                    yield ("W0340", f"{kind}, {name}, {'R = 50' if crown else 'flat'}", n,
                           measured(deck, right, "W0340"))


def crowns() -> Iterator[tuple[str, str, int, tuple[float, float] | None]]:
    """24 facets on the side of the crowned master, in space 12."""
    for kind in ("plane strain", "axisymmetric", "3d"):
        master = 12 if kind == "3d" else 24
        for crown in (0.05, 0.2):
            right = scenes.force(lopin.run(scenes.two_blocks(kind, master, master, True,
                                                             crown=crown)))
            for n in (1, 2, 3, 4, 6, 8):
                yield "W0349", f"{kind}, R = {1.0/crown:g}", n, measured(
                    scenes.two_blocks(kind, n, master, True, crown=crown), right, "W0349")


def cantilevers() -> Iterator[tuple[str, str, int, tuple[float, float] | None]]:
    """Too much of the work, beside all of it."""
    for word in beams.LOCKED + beams.RIGHT:
        for layers in (1, 2, 4):
            result = lopin.run(beams.cantilever(word, layers))
            yield "W0565", word, layers, (100.0*(1.0 - beams.exact()/beams.work(result)),
                                          100.0*beams.told(result))


def measure() -> None:
    """All scenes into the CSV, and as tables of Markdown."""
    with TABLE.open("w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(["code", "scene", "n", "error_percent", "told_percent"])
        last, line = "", ""
        for family in (balls, blocks, crowns, cantilevers):
            for code, scene, n, found in family():
                rows.writerow([code, scene, n, *(("", "") if found is None else
                                                 (f"{found[0]:.2f}", f"{found[1]:.2g}"))])
                if scene != last:
                    print(line, flush=True)
                    last, line = scene, f"| {code} | {scene} |"
                line += " refused |" if found is None else (
                    f" {found[0]:+.1f}/{f'{found[1]:.0f}' if found[1] else '–'} |")
        print(line)


def draw() -> None:
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot as plt
    rows = [r for r in csv.DictReader(TABLE.open(encoding="utf-8")) if r["error_percent"]]
    figure, axes = plt.subplots(1, 4, figsize=(13.0, 3.6), sharex=True, sharey=True,
                                layout="constrained")
    for axis, (code, title) in zip(axes, TITLES.items()):
        own = [(max(abs(float(r["error_percent"])), 0.1), float(r["told_percent"]))
               for r in rows if r["code"] == code]
        axis.loglog(*zip(*[p for p in own if p[1]]), "o", ms=4, color="#1f5f8b")
        silent = [e for e, t in own if not t]
        if silent:
            axis.loglog(silent, [2.0]*len(silent), "o", ms=4, mfc="none", color="#b04030")
        axis.loglog([0.1, 1000.0], [0.1, 1000.0], lw=0.8, color="0.6")
        axis.axvline(10.0, lw=0.6, ls=":", color="0.6")
        axis.set(title=f"{code}: {title}", xlabel="wrong [%]", xlim=(0.08, 2000.0),
                 ylim=(1.5, 300.0))
        axis.title.set_fontsize(9)
    axes[0].set_ylabel("told [%]; open: nothing")
    figure.savefig(PICTURE, dpi=110)


if __name__ == "__main__":
    draw() if "--picture" in sys.argv else measure()
