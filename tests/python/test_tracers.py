"""Tracers beside closed forms, over meshes that are made anew."""
import re
from types import SimpleNamespace

import numpy as np
import pytest

pytest.importorskip("scipy")

from test_point_states import NORTON  # noqa: E402
from test_remeshing import block, run  # noqa: E402

import lopin  # noqa: E402
from lopin.__main__ import main  # noqa: E402
from lopin.tracers import outputs, simplices, tracks, within  # noqa: E402
from lopin.vtu import read_vtu  # noqa: E402


@pytest.mark.parametrize("word", ["CAX4", "CPE3", "C3D4"])
def test_tracers_of_a_block_pressed_evenly_go_where_the_block_goes(word, core, tmp_path, capsys):
    if word == "C3D4":
        pytest.importorskip("mmgpy")
    report = run(block(word, law=NORTON, card="PERIOD=.4, STRAIN=10.", increments=10), tmp_path)
    assert len(report.remeshes) >= 2
    first, last = (read_vtu(outputs(tmp_path, "block")[k][1]) for k in (0, -1))
    d = 3 if word == "C3D4" else 2
    before = np.asarray(first.points)[np.unique(simplices(first, d)), :d]
    end = (np.asarray(last.points) + last.point_data["U"])[np.unique(simplices(last, d)), :d]
    low, size = before.min(axis=0), np.ptp(before, axis=0)
    starts = low + size*np.random.default_rng(1).uniform(0.05, 0.95, (40, d))
    starts = np.vstack([starts, low])
    found = tracks(tmp_path, "block", starts)
    exact = end.min(axis=0) + (starts - low)/size*np.ptp(end, axis=0)
    assert np.abs(found.places[-1] - exact).max() < 1e-5*size.max()
    assert found.outside < 1e-3 and (np.diff(found.times) >= 0.0).all()
    assert found.places[-1][:, 1].max() < 0.8*starts[:, 1].max()
    (tmp_path/"starts.csv").write_text("\n".join(",".join(map(repr, map(float, s)))
                                                 for s in starts))
    assert main(["tracers", str(tmp_path), "--starts", str(tmp_path/"starts.csv")]) == 0
    assert "41 tracers" in capsys.readouterr().out
    rows = (tmp_path/"tracers.csv").read_text().splitlines()
    assert rows[0] == "time,tracer," + ",".join("xyz"[:d])
    assert [float(v) for v in rows[-1].split(",")[2:]] == found.places[-1][-1].tolist()


def test_the_simplex_of_a_place_and_how_far_outside_one_is():
    x = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    cells = np.array([[0, 1, 2], [0, 2, 3]])
    owner, share, outside = within(x, cells, np.array([[0.75, 0.25], [0.25, 0.75]]))
    assert owner.tolist() == [0, 1] and outside == 0.0
    assert np.einsum("pk,pkd->pd", share, x[cells[owner]]) == pytest.approx(
        np.array([[0.75, 0.25], [0.25, 0.75]]))
    assert within(x, cells, np.array([[1.2, 0.5]]))[2] == pytest.approx(0.2)


@pytest.mark.parametrize("starts, message", [
    ("1., 1.\n2., nan\n", "tracer 2 has a coordinate that is no finite number: 2, nan"),
    ("inf, 1.\n", "tracer 1 has a coordinate"), ("", "two or three coordinates"),
    ("1.\n", "two or three coordinates"), ("1., 1., 0.\n", "(?s)3 coordinates, the run has 2.*r, z"),
    ("1., one\n", "cannot be read"), ("1., 1.\n1., 1., 1.\n", "cannot be read")])
def test_places_that_no_tracer_can_have_are_told(core, tmp_path, capsys, starts, message):
    scene = block("CAX4", law=NORTON, card="PERIOD=.4", increments=2).text()
    lopin.run(lopin.Deck.parse("\n".join(line for line in scene.splitlines()
                                         if not line.startswith("*REMESH")), name="block"), tmp_path)
    (tmp_path/"starts.csv").write_text(starts)
    assert main(["tracers", str(tmp_path), "--starts", str(tmp_path/"starts.csv")]) == 2
    said = capsys.readouterr().err
    assert re.search(message, said), said


def test_tracers_with_too_few_coordinates_are_told():
    mesh = SimpleNamespace(cells=[SimpleNamespace(type="tetra", data=np.arange(4)[None])])
    with pytest.raises(lopin.UsageError, match="(?s)have 2 coordinates, the run has 3.*xyz in every"):
        simplices(mesh, 2)
