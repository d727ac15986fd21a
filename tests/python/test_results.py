"""Results as tables, views, pictures and text; sweeps; what optional packages are missing."""
import pickle
import sys
import types
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import lopin
import numpy as np
import pytest

from lopin import mesh_make, plot, profile  # noqa: E402


def punch(young=1000.0, friction=None):
    """A block under a flat punch."""
    model = lopin.Model("punch", mesh_make.block((2.0, 1.0), (4, 2)), units="N mm s")
    model.section("ALL", lopin.Elastic(young, 0.3))
    die = model.rigid_tool("DIE", profile.plane(1.0, 5.0), ref=(0.0, 1.0))
    model.contact("TOP", die, friction=friction)
    model.fix("BOTTOM", "y")
    model.fix("LEFT", "x")
    model.step(2).move(die, y=-0.1)
    return model


@pytest.fixture(scope="module")
def result(core):
    return punch().run()


def hidden(monkeypatch, name):
    """As if a package were not installed."""
    monkeypatch.setitem(sys.modules, name, None)


@pytest.mark.parametrize("package, extra, use", [
    ("pandas", "table", lambda r: r.to_dataframe()), ("pyvista", "3d", lambda r: r.to_pyvista()),
    ("matplotlib.pyplot", "plot", lambda r: plot.history(r, ["DIE.rf2"]))])
def test_a_missing_package_is_named_with_its_extra(result, monkeypatch, package, extra, use):
    hidden(monkeypatch, package)
    with pytest.raises(lopin.MissingPackageError, match=rf"lopin\[{extra}\]"):
        use(result)


def fake_pandas(monkeypatch):
    """A package that keeps what it is given."""
    module = types.ModuleType("pandas")
    module.DataFrame = lambda data, index=None: types.SimpleNamespace(data=data, index=index)
    module.Index = lambda values, name: (name, list(values))
    monkeypatch.setitem(sys.modules, "pandas", module)


def test_tables_have_a_column_for_each_component(result, monkeypatch):
    fake_pandas(monkeypatch)
    history = result.to_dataframe()
    assert history.data["DIE.rf2"][-1] == result.history["DIE.rf2"][-1]
    points = result.to_dataframe("points")
    assert np.array_equal(points.data["U2"], result["U"][:, 1])
    assert points.index == ("label", result["LABEL"].tolist())
    pair = result.to_dataframe("TOP-DIE", index=0)
    assert np.array_equal(pair.data["CPRESS"], result.contact("TOP").at(0).pressure)
    with pytest.raises(lopin.UsageError, match="no contact pair 'SIDE'"):
        result.to_dataframe("SIDE")


def test_tables_of_pandas(result):
    pandas = pytest.importorskip("pandas")
    table = result.to_dataframe("points", 0)
    assert isinstance(table, pandas.DataFrame) and len(table) == len(result["U"])


def test_views_show_the_deformed_mesh(result):
    pytest.importorskip("pyvista")
    began, now = result.to_pyvista(scale=0.0), result.to_pyvista()
    assert now.n_cells == 8
    assert now.points[:, 1].max() == pytest.approx(began.points[:, 1].max() - 0.1)


def test_notebooks_show_a_table(result):
    text = result._repr_html_()
    assert text.startswith("<table>") and "TOP-DIE" in text and "time [s]" in text
    assert "PASS" in text and "MPa" in text
    assert "<b>" not in lopin.Result(result.source, lopin.Deck(name="<b>"))._repr_html_()


def test_slave_points_are_where_they_are_now(result, tmp_path, core):
    contact = result.contact("TOP").last
    assert contact.place[:, 1] == pytest.approx(0.9) and contact.x[:, 1] == pytest.approx(1.0)
    punch().run(tmp_path)
    kept = lopin.open_result(tmp_path).contact("TOP").last
    places = [c.place[np.argsort(c.x[:, 0])] for c in (contact, kept)]
    assert places[0] == pytest.approx(places[1], abs=1e-7)


def test_pictures_are_deformed_and_say_units(result):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    contact = result.contact("TOP").last
    ax = plot.pressure(contact)
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("x [mm]", "contact pressure [MPa]")
    xs = np.concatenate([line.get_xdata() for line in ax.lines])
    assert xs.max() == pytest.approx(contact.place[:, 0].max()) and xs.max() > 2.0
    ax = plot.deformed(result, "Mises")
    tops = [path.vertices[:, 1].max() for path in ax.collections[0].get_paths()]
    assert max(tops) == pytest.approx(0.9) and ax.get_ylabel() == "y [mm]"
    assert plot.history(result, ["DIE.rf2"]).get_legend().get_texts()[0].get_text() == \
        "DIE.rf2 [N]"
    with pytest.raises(lopin.UsageError, match="no column 'DIE.rf9'"):
        plot.history(result, ["DIE.rf9"])


def test_the_package_says_that_it_has_types():
    from importlib.resources import files

    assert files("lopin").joinpath("py.typed").is_file()


# ---- sweeps ----


def test_two_processes_sweep_over_a_function(core, tmp_path):
    cases = lopin.sweep(punch, over={"young": [500.0, 1000.0], "friction": [None, 0.3]},
                        workers=2, output=tmp_path)
    assert [list(c.values.values()) for c in cases] == [
        [500.0, None], [500.0, 0.3], [1000.0, None], [1000.0, 0.3]]
    assert all(c.ok for c in cases)
    force = [c.result.history["DIE.rf2"][-1] for c in cases]
    assert force[2] == pytest.approx(2.0*force[0]) and abs(force[1]) > abs(force[0])
    alone = punch(500.0, 0.3).run()
    assert alone.history["DIE.rf2"][-1] == pytest.approx(force[1], rel=1e-12)
    assert (tmp_path/"003"/"punch.json").is_file()


def test_a_sweep_over_places_of_a_deck_keeps_going_when_one_fails(core):
    deck = punch().to_deck()
    cases = lopin.sweep(deck, over={"*ELASTIC:0:1": [0.3, 0.7, 0.4]}, workers=0)
    assert [c.ok for c in cases] == [True, False, True]
    assert isinstance(cases[1].error, lopin.DeckError) and cases[1].result is None
    assert len(cases[2].result["U"]) == 16
    assert deck["*ELASTIC"].data[0][1] == 0.3   # the deck itself stays
    with pytest.raises(lopin.UsageError, match="no place in the deck"):
        lopin.sweep(deck, over={"*ELASTIC:7:1": [0.3]}, workers=0)


def test_a_client_takes_the_runs(core):
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as client:
        [case] = lopin.sweep(punch, over=[{"young": 700.0}], client=client)
    assert case.ok and case.result.verdict == "PASS"


def test_scenes_can_be_sent_to_other_processes():
    model = punch()
    again = pickle.loads(pickle.dumps(model))
    assert again.to_deck().text() == model.to_deck().text()
    assert pickle.loads(pickle.dumps(model.to_deck())).text() == model.to_deck().text()
