"""The work-precision chart, on small meshes: its errors, costs, table and pictures."""
import csv

import numpy as np
import pytest
from crown import crown

from lopin.charts import chart
from lopin.charts import run as chart_run
from lopin.charts import theory as chart_theory
from lopin.__main__ import main
from lopin.charts.run import Setting
from lopin.charts.scenes import SCENES

pytestmark = pytest.mark.usefixtures("core")


@pytest.fixture(scope="module")
def small():
    """A short sweep of the sphere."""
    settings = chart.sweep(range(-1, 8, 2), starts=(10.0,))
    return chart.measure(SCENES["sphere"](6.5), settings, repetitions=1)


def test_penalty_errors_fall_as_one_over_r(small):
    r, error = chart_theory.stiffness_curve(small, "perturbed", "condensed")
    assert np.all(error < chart_theory.bound(r))
    stiff = r >= 10.0
    assert chart_theory.slope(r[stiff], error[stiff]) == pytest.approx(-1.0, abs=0.05)


def test_each_augmentation_leaves_what_theory_allows(small):
    rate = chart_theory.contraction(small, 10.0)
    assert 0.3*chart_theory.bound(10.0) < rate < 1.1*chart_theory.bound(10.0)


def test_both_paths_agree_and_condensation_factorises_once(small):
    exact = {row.path: row for row in small if row.method == "lagrange"}
    assert exact["newton"].error_enforcement < 1e-11
    assert {row.factorisations for row in small if row.path == "condensed"} == {1}
    assert exact["newton"].factorisations > 2


def test_nothing_is_wrong_and_silent(small):
    assert max(row.error_enforcement for row in small) > chart_run.WRONG
    assert not [row for row in small if row.silent]


@pytest.mark.parametrize("name", SCENES)
def test_scenes_converge_to_hertz(name):
    settings = [Setting("lagrange")]
    error = [np.median([chart.measure(SCENES[name](n + shift), settings, 1)[0].error_total
                        for shift in chart.SHIFTS]) for n in (4, 16)]
    assert error[1] < 0.4*error[0]
    assert error[1] < 0.02


def test_a_chart_of_a_deck(tmp_path, capsys):
    pytest.importorskip("matplotlib")
    deck = crown(tmp_path)
    assert main(["chart", deck, "-o", str(tmp_path), "--repetitions", "1"]) == 0
    assert "0 wrong by more than 5 % and silent" in capsys.readouterr().out
    with (tmp_path/"crown.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert {row["method"] for row in rows} == {"lagrange", "penalty", "perturbed", "augmented"}
    assert {row["path"] for row in rows} == {"condensed", "newton"}
    assert (tmp_path/"crown.png").stat().st_size > 10000
    assert (tmp_path/"crown_full.svg").is_file()


def test_a_chart_of_a_forming_deck(tmp_path, capsys):
    """Error against cost of a billet that flows; its table is drawn again."""
    pytest.importorskip("matplotlib")
    from upset_billet import billet

    deck = billet(1, mu=0.1, share=0.2, cells=(2, 3), direct=False).to_deck().write(
        tmp_path/"upset.inp")
    assert main(["chart", str(deck), "-o", str(tmp_path)]) == 0
    assert "20 runs, 0 without an answer, 0 wrong by more than 5 %" in capsys.readouterr().out
    with (tmp_path/"upset.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    by_share = sorted((float(r["share"]), float(r["error_force"])) for r in rows if r["share"]
                      and r["error_force"])
    assert by_share[0][1] < 0.3*by_share[-1][1]
    assert {r["method"] for r in rows} == {"lagrange", "penalty", "perturbed", "augmented"}
    (tmp_path/"upset.png").unlink()
    assert main(["chart", str(tmp_path/"upset.csv"), "-o", str(tmp_path)]) == 0
    assert (tmp_path/"upset.png").stat().st_size > 10000
