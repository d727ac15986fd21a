"""The charts of docs/charts.md: one number of each scene over methods, elements and meshes.

    python tests/benchmarks/charts.py [NAME...]

A table and a picture in docs/charts per scene, by `lopin chart DECK --quantity ...`. Scenes whose
table is there already are left alone, so that a batch can go on; remove a table to measure anew.
"""
import subprocess
import sys
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
}


def main(names):
    failed = False
    for name in names or SCENES:
        deck, *options = SCENES[name]
        table = ROOT/"docs"/"charts"/f"{name}.csv"
        if table.is_file():
            continue
        print(f"== {name}", flush=True)
        done = subprocess.run([sys.executable, "-m", "lopin", "chart",
                               str(ROOT/"decks"/f"{deck}.inp"), *options, "--name", name,
                               "-o", str(table.parent)], check=False)
        failed |= done.returncode != 0
    return int(failed)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
