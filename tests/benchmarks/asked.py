"""TARGET ERROR asked of the scenes of the charts: estimates beside true errors, and the cost.

    python tests/benchmarks/asked.py TABLE.csv [NAME...]

A row per scene and error asked for, cheap scenes first; rows that the table holds already are not
made again. The true error is that beside the limit of the scene: of the same deck, by runs whose
mesh and increments are so much finer, and the order of their fall, that their own error
is at most a tenth of what is compared. Pressures are compared node by node with a run on cells of
an eighth of the size; true is left open where no such run was made.
"""
import csv
import math
import sys
import time
from pathlib import Path

import lopin
from lopin.accuracy import Quantity, reach
from lopin.accuracy.reach import without_question
from lopin.deck import Deck
from lopin.errors import LopinError, NotConvergedError
from lopin.refine import refined

DECKS = Path(__file__).resolve().parents[2]/"decks"
#: Deck, what is asked, its limit where one is known, halvings of the mesh that pressures are
#: compared with, CPU time of a run that is not begun, by the error asked for [s].
SCENES = {
    "A4 Hertz, sphere": ("hertz_sphere", Quantity("FORCE", "", 2), -588.2297, 0, {}),
    "A13 Signorini": ("signorini", Quantity("FORCE", "", 2), 2.35275, 0, {}),
    "A3 NAFEMS cylinder": ("nafems_cylinder", Quantity("DISPLACEMENT", "BLOCK.B", 2), -1.27419, 0,
                           {}),
    "A4 Hertz, sphere, pressure": ("hertz_sphere", Quantity("PRESSURE"), None, 3, {}),
    "A3 NAFEMS cylinder, pressure": ("nafems_cylinder", Quantity("PRESSURE"), None, 3, {}),
    "Hertz in 3D": ("hertz_sphere_3d", Quantity("FORCE", "", 3), -147.076, 0, {}),
    "E1 upsetting": ("upsetting", Quantity("FORCE", "", 2), -788850.0, 0, {}),
    "E5 ring": ("ring_compression", Quantity("FORCE", "", 2), -240620.0, 0, {}),
    "A7 Cattaneo": ("cattaneo", Quantity("PRESSURE"), None, 3, {}),
    "E9 cup": ("cup", Quantity("PEAK FORCE", "PUNCH_REF", 2), None, 0, {0.01: 60.0, 0.002: 60.0}),
}
#: Runs that pressures are compared with.
FINEST = {}
TARGETS = (0.05, 0.01, 0.002)
COLUMNS = ("scene", "quantity", "asked", "value", "estimate", "mesh", "increments", "order", "cost",
           "seconds", "equations", "elements", "finest_mesh", "share", "verdict", "refused", "dual",
           "last_seconds", "true", "effectivity")


def row_of(name, target):
    deck, quantity, limit, finest, seconds = SCENES[name]
    begun = time.process_time()
    try:
        found, refused = reach(Deck.read(DECKS/f"{deck}.inp"), quantity, target,
                               most_seconds=seconds.get(target, math.inf)), ""
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
                "share": last.increments, "verdict": last.verdict, "dual": int(found.by_dual),
                "last_seconds": f"{last.seconds:.3g}"}
        true = true_error(name, found)
        if true is not None:
            row |= {"true": f"{true:.3g}", "effectivity": f"{found.error/max(true, 1e-300):.3g}"}
    return row


def true_error(name, found):
    """Relative error beside the limit, or beside the pressures of a finer mesh; None: not known."""
    deck, quantity, limit, finest, _ = SCENES[name]
    if limit is not None:
        return abs(found.value/limit - 1.0)
    if found.levels[-1].mesh + 2 > finest:
        return None
    if name not in FINEST:
        fine = without_question(Deck.read(DECKS/f"{deck}.inp"))
        for _ in range(finest):
            fine = refined(fine).deck
        FINEST[name] = lopin.run(fine)
    value = quantity.value(FINEST[name], found.deck)
    return quantity.difference(FINEST[name], found.result, (value, found.value))/value


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
