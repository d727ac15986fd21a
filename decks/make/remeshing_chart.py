"""Error against cost of a closed die on meshes that are made anew, beside one mesh.

    python decks/make/remeshing_chart.py          # map 14 of the atlas, and what is beside it
    python decks/make/remeshing_chart.py draw     # the picture of the table that is there

takes map 14 (docs/atlas), runs the same disc on one mesh of several sizes, and a quarter of it in
space (lopin.atlas.remeshed_space); the table is docs/charts/remeshing.csv.
"""
import csv
import sys
from pathlib import Path

import matplotlib

from lopin import atlas
from lopin.atlas import remeshed_space
from lopin.atlas.remeshed import FINE, SIZES, TRIGGERS, RemeshMap, judged

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
    return found + rows_in_space()


def rows_in_space() -> list[list]:
    """The same of the quarter disc."""
    right, found = remeshed_space.fine(), []
    for size, trigger in remeshed_space.CELLS:
        one = remeshed_space.in_space(size, trigger, right)
        found.append(["quarter disc in space" + "; one mesh"*(trigger is None), size, trigger or "",
                      one.error, one.strain, one.seconds, one.meshes, one.said])
    return found


def main() -> None:
    path = DOCS/"charts"/"remeshing.csv"
    if sys.argv[1:] != ["draw"]:
        with path.open("w", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(["mesh", "size [mm]", "trigger", "error of force", "error of strain",
                             "seconds", "meshes", "verdict"])
            writer.writerows([f"{v:.4g}" if isinstance(v, float) else v for v in row]
                             for row in rows())
    with path.open(newline="") as file:
        draw([[row[0], *(float(v) if v else "" for v in row[1:6]), int(row[6]), row[7]]
              for row in list(csv.reader(file))[1:]])


def draw(table: list[list]) -> None:
    """Two panels: force, strain."""
    figure, axes = plt.subplots(1, 2, figsize=(9.5, 4.6), sharex=True)
    reference = next(r for r in table if r[0].endswith("the reference"))
    for axis, column, title in ((axes[0], 3, "force over the stroke"),
                                (axes[1], 4, "plastic strain, over the disc")):
        for trigger in TRIGGERS:
            own = [r for r in table if r[2] == trigger and r[0] == "made anew"]
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
        for word, style, label in (("", "^-", "strain 0.5"), ("; one mesh", "^--", "one mesh")):
            own = [r for r in table if r[0] == "quarter disc in space" + word and r[2] in ("", 0.5)]
            axis.plot([r[5] for r in own], [100*r[column] for r in own], style, color="tab:purple",
                      markerfacecolor="none", label=f"quarter disc in space, {label}")
            for r in own:
                axis.annotate(f"{r[1]:g}", (r[5], 100*r[column]), fontsize=6.5, xytext=(3, 3),
                              textcoords="offset points")
        others = [r for r in table if r[0] == "quarter disc in space" and r[2] not in ("", 0.5)]
        axis.plot([r[5] for r in others], [100*r[column] for r in others], "^", color="tab:purple",
                  alpha=0.4, label="quarter disc in space, strain 0.25, 0.7")
        axis.axvline(reference[5], color="0.6", linestyle=":", label=f"one mesh of {FINE:g} mm, "
                     "the reference")
        axis.set(xscale="log", yscale="log", xlabel="CPU [s]", ylabel="error [%]", title=title)
        axis.set_yticks([1, 2, 5, 10], ["1", "2", "5", "10"])
        axis.minorticks_off()
    figure.legend(*axes[0].get_legend_handles_labels(), fontsize=7, ncols=3, loc="lower center")
    figure.tight_layout(rect=(0.0, 0.13, 1.0, 1.0))
    figure.savefig(DOCS/"charts"/"remeshing.png", dpi=90)


if __name__ == "__main__":
    main()
