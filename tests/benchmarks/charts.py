"""The charts of docs/charts.md: one number of each scene over methods, elements and meshes.

    python tests/benchmarks/charts.py [NAME...]

A table and a picture in docs/charts per scene, by `lopin chart DECK --quantity ...`. Scenes whose
table is there already are left alone, so that a batch can go on; remove a table to measure anew.
"""
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
METHODS = "lagrange,penalty,perturbed,augmented"
#: Deck and options by scene: those of the collection docs/verification.md, and of forming.
SCENES = {
    "a3_cylinder": ("nafems_cylinder", "--quantity", "DISPLACEMENT", "--set", "BLOCK.B",
                    "--component", "2", "--methods", METHODS, "--elements", "CPE4,CPE8R",
                    "--meshes", "0,1", "--ccx"),
    "a4_sphere": ("hertz_sphere", "--quantity", "FORCE", "--set", "BALL_REF", "--component", "2",
                  "--methods", METHODS, "--elements", "CAX4,CAX8R", "--meshes", "0,1", "--ccx"),
    "a7_cattaneo": ("cattaneo", "--quantity", "DISPLACEMENT", "--set", "UP.TOP", "--component",
                    "1", "--methods", METHODS, "--elements", "CPE4,CPE8R", "--meshes", "0,1",
                    "--ccx"),
    "a13_signorini": ("signorini", "--quantity", "FORCE", "--component", "2", "--exact",
                      "2.357022604", "--methods", METHODS, "--meshes", "0,1,2,3,4"),
    "b1_nodes": ("patch_test", "--quantity", "PEAK PRESSURE", "--exact", "1", "--methods",
                 METHODS, "--meshes", "0,1,2,3"),
    "b1_mortar": ("two_blocks_mortar", "--quantity", "PEAK PRESSURE", "--exact", "1",
                  "--methods", METHODS, "--meshes", "0,1,2,3"),
    "d5_rings": ("rotating_rings", "--quantity", "PEAK PRESSURE", "--exact", "22.792022",
                 "--methods", METHODS, "--meshes", "0,1"),
    "e1_upsetting": ("upsetting", "--quantity", "FORCE", "--set", "PLATE_REF", "--component", "2",
                     "--methods", METHODS, "--elements", "CAX4,CAX8R", "--meshes", "0,1",
                     "--increments", "1,0.5", "--ccx"),
    "e5_ring": ("ring_compression", "--quantity", "FORCE", "--set", "PLATE_REF", "--component",
                "2", "--methods", METHODS, "--elements", "CAX4,CAX8R", "--meshes", "0,1",
                "--ccx"),
    "closed_die_cold": ("closed_die", "--quantity", "FORCE", "--set", "DIE_REF", "--component",
                        "2", "--methods", "lagrange,penalty", "--elements", "CAX4", "--meshes",
                        "0,1", "--increments", "1,0.5", "--ccx"),
    "cup_fixed": ("cup", "--quantity", "FORCE", "--set", "PUNCH_REF", "--component", "2",
                  "--methods", "lagrange,penalty", "--meshes", "0", "--increments", "1,0.5,0.25"),
}


def cold(text):
    """The closed die, its metal elastic-plastic, to 3.75 of 4.95 mm: CalculiX has no Norton-Hoff."""
    head, _, rest = text.partition("*VISCOPLASTIC, LAW=NORTON-HOFF\n50., 0.15\n")
    return (head + "*PLASTIC\n300., 0.\n600., 1.\n900., 4.\n" + rest).replace(
        "0.001, 0.099, 1.E-6, 0.002", "0.001, 0.075, 1.E-9, 0.002")


def fixed(text):
    """The cup to 20 mm in one step, its holder 0.05 mm off: CalculiX's copy of a tool bears no load."""
    return text.partition("*STEP, NAME=HOLD")[0] + (
        "*STEP, NAME=DRAW, NLGEOM, INC=1000\n*STATIC\n0.002, 1., 1.E-9, 0.02\n*BOUNDARY\n"
        "PUNCH_REF, 2, 2, -20.\nHOLDER_REF, 2, 2, 0.05\n*END STEP\n")


#: Decks that are changed first.
CHANGED = {"closed_die_cold": cold, "cup_fixed": fixed}


def path_of(name, deck, folder):
    """The deck of a scene, changed in a folder if it has to be."""
    path = ROOT/"decks"/f"{deck}.inp"
    if name not in CHANGED:
        return path
    own = Path(folder)/f"{name}.inp"
    own.write_text(CHANGED[name](path.read_text(encoding="utf-8")), encoding="utf-8")
    return own


def main(names):
    failed = False
    for name in names or SCENES:
        deck, *options = SCENES[name]
        table = ROOT/"docs"/"charts"/f"{name}.csv"
        if table.is_file():
            continue
        print(f"== {name}", flush=True)
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([sys.executable, "-m", "lopin", "chart",
                                   str(path_of(name, deck, folder)), *options, "--name", name,
                                   "-o", str(table.parent)], check=False)
        failed |= done.returncode != 0
    return int(failed)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
