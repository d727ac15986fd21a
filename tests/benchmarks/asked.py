"""TARGET ERROR asked of the scenes of the charts: estimates beside true errors, and the cost.

    python tests/benchmarks/asked.py TABLE.csv [NAME...]

A row per scene and error asked for; rows that the table holds already are not made again. The true
error is that beside the scene's closed form, or beside a run on meshes finer than the one that
0.2 % took; it is left open where such a run is out of reach.
"""
import csv
import sys
import time
from pathlib import Path

from lopin.accuracy import Quantity, reach
from lopin.deck import Deck
from lopin.errors import LopinError, NotConvergedError

DECKS = Path(__file__).resolve().parents[2]/"decks"
#: Deck, what is asked, its exact value where one is known.
SCENES = {
    "A3 NAFEMS cylinder": ("nafems_cylinder", Quantity("DISPLACEMENT", "BLOCK.B", 2), None),
    "A3 NAFEMS cylinder, pressure": ("nafems_cylinder", Quantity("PRESSURE"), None),
    "A4 Hertz, sphere": ("hertz_sphere", Quantity("FORCE", "", 2), None),
    "A4 Hertz, sphere, pressure": ("hertz_sphere", Quantity("PRESSURE"), None),
    "A7 Cattaneo": ("cattaneo", Quantity("PRESSURE"), None),
    "A13 Signorini": ("signorini", Quantity("FORCE", "", 2), 2.357022604),
    "E1 upsetting": ("upsetting", Quantity("FORCE", "", 2), None),
    "E5 ring": ("ring_compression", Quantity("FORCE", "", 2), None),
    "E9 cup": ("cup", Quantity("PEAK FORCE", "PUNCH_REF", 2), None),
    "Hertz in 3D": ("hertz_sphere_3d", Quantity("FORCE", "", 3), None),
}
TARGETS = (0.05, 0.01, 0.002)
COLUMNS = ("scene", "quantity", "asked", "value", "estimate", "mesh", "increments", "order", "cost",
           "seconds", "equations", "elements", "finest_mesh", "share", "verdict", "refused")


def row_of(name, target):
    deck, quantity, _ = SCENES[name]
    begun = time.process_time()
    try:
        found, refused = reach(Deck.read(DECKS/f"{deck}.inp"), quantity, target), ""
    except NotConvergedError as problem:
        found, refused = getattr(problem, "reached", None), str(problem).split("\n")[0]
    except LopinError as problem:
        found, refused = None, str(problem).split("\n")[0]
    row = {"scene": name, "quantity": str(quantity), "asked": target, "refused": refused,
           "seconds": f"{time.process_time() - begun:.2f}"}
    if found is not None and found.levels:
        last = found.levels[-1]
        row |= {"value": repr(found.value), "estimate": f"{found.error:.4g}",
                "mesh": f"{found.mesh:.3g}", "increments": f"{found.increments:.3g}",
                "order": f"{found.order:.3g}", "cost": f"{found.cost:.3g}",
                "equations": last.equations, "elements": last.elements, "finest_mesh": last.mesh,
                "share": last.increments, "verdict": last.verdict}
    return row


def main(path, names):
    path, rows = Path(path), []
    if path.is_file():
        with path.open(newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
    done = {(r["scene"], float(r["asked"])) for r in rows}
    for name in names or SCENES:
        for target in TARGETS:
            if (name, target) in done:
                continue
            rows.append(row_of(name, target))
            print({k: v for k, v in rows[-1].items() if k != "quantity"}, flush=True)
            with path.open("w", newline="", encoding="utf-8") as file:
                writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
                writer.writeheader()
                writer.writerows(rows)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])
