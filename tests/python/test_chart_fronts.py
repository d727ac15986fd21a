"""docs/charts.md says of every chart whether the default is on the front, and if not, why."""
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT/"tests"/"benchmarks"))
from fronts import CHARTS, SCENES, Run, row_of  # noqa: E402

PAGE = (ROOT/"docs"/"charts.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("label", SCENES)
def test_the_page_says_of_each_chart_what_its_table_says(label):
    if not (CHARTS/f"{SCENES[label][0]}.csv").is_file():
        assert f"| [{label}](" not in PAGE
        return
    row = row_of(label)
    line = next(v for v in PAGE.splitlines() if v.startswith(f"| [{label}](charts/")
                and v.split("|")[1].strip().endswith(".csv)"))
    assert line.startswith(row)
    on, every = row.split("|")[2].split(" of ")
    why = line[len(row):].strip(" |")
    assert bool(why) == (int(on) < int(every))


def test_what_beats_a_run():
    run = Run("default", True, 1.0, 0.01)
    assert Run("a", False, 0.8, 0.009).beats(run)
    assert not Run("b", False, 0.95, 0.001).beats(run)     # times that are alike
    assert not Run("c", False, 0.5, 0.00995).beats(run)    # errors that are alike
    assert not run.beats(run) and not Run("d", False, 0.5, 1e-12).beats(
        Run("exact", True, 1.0, 1e-11))
