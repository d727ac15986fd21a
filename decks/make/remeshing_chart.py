"""Error against cost of a closed die on meshes that are made anew, beside one mesh.

    python decks/make/remeshing_chart.py

takes map 14 of the atlas (docs/atlas), runs the same disc on one mesh of several sizes, and draws
docs/charts/remeshing.png with its table remeshing.csv.
"""
import csv
from pathlib import Path

import matplotlib
import numpy as np

from lopin import atlas
from lopin.atlas.remeshed import FINE, SIZES, STROKES, TRIGGERS, RemeshMap, judged, pressed

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

DOCS = Path(__file__).resolve().parents[2]/"docs"


def rows() -> list[list]:
    """Kind of mesh, size, trigger, error of force, of strain, CPU seconds, meshes, verdict."""
    chart, found = RemeshMap(), []
    for cell in atlas.read_table(DOCS/"atlas"/"map_14_remeshing.csv"):
        found.append(["made anew", SIZES[round(cell.x)], TRIGGERS[round(cell.y)], cell.error,
                      cell.strain, cell.seconds, cell.meshes, cell.said])
    for size in (*SIZES, 0.5):
        one = chart.one_mesh(size)
        found.append(["one mesh", size, "", one.error, one.strain, one.seconds, 1, one.said])
    fine = chart.fine()
    other = judged(fine, fine)
    found.append(["one mesh, the reference", FINE, "", other.error, other.strain, fine.seconds, 1,
                  fine.verdict])
    return found


def main() -> None:
    table = rows()
    with (DOCS/"charts"/"remeshing.csv").open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["mesh", "size [mm]", "trigger", "error of force", "error of strain",
                         "seconds", "meshes", "verdict"])
        writer.writerows([f"{v:.4g}" if isinstance(v, float) else v for v in row] for row in table)
    figure, axes = plt.subplots(1, 2, figsize=(9.5, 4.0), sharex=True)
    for axis, column, title in ((axes[0], 3, f"force at {STROKES[0]:g} to {STROKES[-1]:g} mm"),
                                (axes[1], 4, "plastic strain, over the disc")):
        for trigger in TRIGGERS:
            own = [r for r in table if r[2] == trigger]
            axis.plot([r[5] for r in own], [100*r[column] for r in own], "o-", label=f"made anew "
                      f"after a strain of {trigger:g}")
            for r in own:
                axis.annotate(f"{r[1]:g}", (r[5], 100*r[column]), fontsize=6.5,
                              xytext=(3, 3), textcoords="offset points")
        one = [r for r in table if r[0] == "one mesh"]
        axis.plot([r[5] for r in one], [100*r[column] for r in one], "ks--", label="one mesh")
        for r in one:
            axis.annotate(f"{r[1]:g}", (r[5], 100*r[column]), fontsize=6.5, xytext=(3, 3),
                          textcoords="offset points")
        axis.axvline(table[-1][5], color="0.6", linestyle=":", label=f"one mesh of {FINE:g} mm, "
                     "the reference")
        axis.set(xscale="log", yscale="log", xlabel="CPU [s]", ylabel="error [%]", title=title)
        axis.set_yticks([1, 2, 5, 10], ["1", "2", "5", "10"])
        axis.minorticks_off()
    axes[0].legend(fontsize=6.5)
    figure.tight_layout()
    figure.savefig(DOCS/"charts"/"remeshing.png", dpi=90)
    print(np.round([r[5] for r in table], 2))


if __name__ == "__main__":
    main()
