"""A sharp tool driven deep in one step: no point near its corner is lost to the side it does not
face."""
import json
import subprocess
from pathlib import Path

import pytest

from lopin.run import find_executable

DECKS = Path(__file__).parents[2]/"decks"


def punch(folder: Path, depth: float) -> dict:
    text = (DECKS/"flat_punch.inp").read_text()
    text = text.replace("*CLOAD\nPUNCH_REF, 2, -1000.", f"*BOUNDARY\nPUNCH_REF, 2, 2, -{depth}")
    text = text.replace("INPUT=flat_punch.mesh", f"INPUT={DECKS/'flat_punch.mesh'}")
    (folder/"punch.inp").write_text(text)
    done = subprocess.run([find_executable(), "run", "punch.inp", "-o", ".", "--overwrite",
                           "--quiet"],
                          cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return json.loads((folder/"punch.json").read_text())["contact"][0]


@pytest.mark.parametrize("factor", [10.0, 100.0, 1000.0])
def test_the_force_is_linear_in_the_depth(tmp_path, factor):
    """Far boundary values are fixed, so the force is affine: three depths lie on one line."""
    at = {depth: punch(tmp_path, depth) for depth in (5e-4, 1e-3, 5e-4*factor)}
    assert len({c["closed"] for c in at.values()}) == 1
    slope = (at[1e-3]["force"][1] - at[5e-4]["force"][1])/5e-4
    expected = at[5e-4]["force"][1] + slope*(5e-4*factor - 5e-4)
    assert at[5e-4*factor]["force"][1] == pytest.approx(expected, rel=1e-8)
