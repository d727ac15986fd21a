"""Decks of bulk forming that CalculiX and Lopin both read: a billet and a ring under a stiff meshed
plate.

    python tests/benchmarks/forming_decks.py FOLDER [--contact "SURFACE TO SURFACE"]

Writes upset_12x18.inp, upset_24x36.inp (linear) and ring_16x10.inp (quadratic), friction 0.1; rings
of friction 0.05 and 0.2, linear 32 x 20 and quadratic 16 x 10, for docs/ring-compression.md.
Increments of 1/150. The plate, ten times as stiff as steel, is moved as a whole; pressure is 1e7
times the penetration [N, mm].
"""
from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT/"tests"/"python")]

import forming_scenes as scenes  # noqa: E402

from lopin.mesh import Mesh, together  # noqa: E402
from lopin.mesh_make import block  # noqa: E402
from lopin.model import Model  # noqa: E402
from lopin.model_deck import mesh_deck  # noqa: E402


def deck(body: Mesh, law, mu: float, reduction: float, surfaces: tuple[str, ...],
         span: tuple[float, float], contact: str, quadratic: bool, increments: int = 150) -> str:
    """The text of a deck; `span`: radii of the plate."""
    height = float(body.points[:, 1].max())
    body = body.replaced(surfaces={"SKIN": np.vstack([body.surfaces[s] for s in surfaces])})
    plate = block((span[1] - span[0], 2.0), (12, 1), origin=(span[0], height), quadratic=quadratic)
    plate = plate.replaced(surfaces={"FACE": plate.surfaces["BOTTOM"]},
                           point_sets={"NODES": np.arange(plate.n_point)})
    text = mesh_deck(Model("forming", together(BODY=body, PLATE=plate), kind="axisymmetric")).text()
    text = text.replace("TYPE=CAX8\n", "TYPE=CAX8R\n")
    axis = "BODY.LEFT, 1, 1\n" if span[0] < 1.0 else ""
    rows = "".join(f"{s!r}, {e!r}\n" for s, e in law[2])
    return (f"{text}*MATERIAL, NAME=METAL\n*ELASTIC\n{law[0]!r}, {law[1]!r}\n*PLASTIC\n{rows}"
            "*MATERIAL, NAME=TOOL\n*ELASTIC\n2e6, 0.3\n*SOLID SECTION, ELSET=BODY.ALL, MATERIAL=METAL\n"
            "*SOLID SECTION, ELSET=PLATE.ALL, MATERIAL=TOOL\n*SURFACE INTERACTION, NAME=I\n"
            "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n1e7,\n"
            f"*FRICTION\n{mu!r}, 1e6\n*CONTACT PAIR, INTERACTION=I, TYPE={contact}\nBODY.SKIN, PLATE.FACE\n"
            f"*BOUNDARY\nBODY.BOTTOM, 2, 2\nPLATE.NODES, 1, 1\n{axis}"
            f"*STEP, NLGEOM, INC=5000\n*STATIC\n{1.0/increments!r}, 1., 1e-6, {1.0/increments!r}\n"
            f"*BOUNDARY\nPLATE.NODES, 2, 2, {-reduction*height!r}\n"
            "*NODE PRINT, NSET=PLATE.NODES, TOTALS=ONLY, FREQUENCY=1\nRF\n*NODE FILE, FREQUENCY=150\nU\n*END STEP\n")


def decks(contact: str) -> dict[str, str]:
    """Texts by name."""
    found = {}
    for nr, nz in ((12, 18), (24, 36)):
        found[f"upset_{nr}x{nz}"] = deck(scenes.billet(nr, nz), scenes.E1, 0.1, 0.6,
                                         ("TOP", "RIGHT"), (0.0, 24.0), contact, False)
    for name, cells, mu in (("ring", (16, 10), 0.1), ("ring_mu005", (16, 10), 0.05),
                            ("ring_mu02", (16, 10), 0.2), ("ring_mu005", (32, 20), 0.05),
                            ("ring_mu02", (32, 20), 0.2)):
        quadratic = cells == (16, 10)
        body = scenes.ring(*cells, quadratic=quadratic)
        found[f"{name}_{cells[0]}x{cells[1]}"] = deck(body, scenes.E5B, mu, 0.5,
                                                      ("TOP", "RIGHT", "LEFT"), (2.0, 26.0),
                                                      contact, quadratic)
    return found


def main() -> None:
    """Write them."""
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--contact", default="SURFACE TO SURFACE")
    arguments = parser.parse_args()
    arguments.folder.mkdir(parents=True, exist_ok=True)
    for name, text in decks(arguments.contact).items():
        (arguments.folder/f"{name}.inp").write_text(text)


if __name__ == "__main__":
    main()
