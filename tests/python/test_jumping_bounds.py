"""Laws of friction whose bound does not fade with the pressure: at first touch, and read from the last iteration."""
import re
import sys
from pathlib import Path

import pytest

from lopin import Deck, NotConvergedError, mesh_make
from lopin.atlas.forming_scenes import air_bend
from pressed_block import block, step

sys.path.insert(0, str(Path(__file__).resolve().parents[2]/"decks"/"make"))
import sheets  # noqa: E402


def billet(law, m, share=0.6, cells=(6, 9)):
    """Half a billet upset by a share of its height, default increments."""
    mesh = mesh_make.block((10.0, 15.0), cells)
    nodes = [f"{i + 1}, " + ", ".join(map(repr, x)) for i, x in enumerate(mesh.points.tolist())]
    (_, rows), = mesh.blocks
    elements = [f"{i + 1}, " + ", ".join(str(n + 1) for n in r) for i, r in enumerate(rows.tolist())]
    skin = [f"{e + 1}, S{f}" for name in ("TOP", "RIGHT") for e, f in mesh.surfaces[name].tolist()]
    sets = {k: [f"{n + 1}," for n in mesh.point_sets[k].tolist()] for k in ("LEFT", "BOTTOM")}
    return Deck.parse("\n".join([
        "*HEADING", "billet", "*NODE", *nodes, "9001, 0., 15.", "*ELEMENT, TYPE=CAX4, ELSET=B", *elements,
        "*SURFACE, NAME=SKIN", *skin, *[r for k, v in sets.items() for r in (f"*NSET, NSET={k}", *v)],
        "*MATERIAL, NAME=STEEL", "*ELASTIC", "2e5, 0.3", "*PLASTIC", "700., 0.", "1300., 2.",
        "*SOLID SECTION, ELSET=B, MATERIAL=STEEL", "*SURFACE, NAME=DIE, TYPE=SEGMENTS", "START, 60., 15.",
        "LINE, -5., 15.", "*RIGID BODY, ANALYTICAL SURFACE=DIE, REF NODE=9001", "*SURFACE INTERACTION, NAME=I",
        f"*FRICTION, LAW={law}", f"{m!r}", "*CONTACT PAIR, INTERACTION=I", "SKIN, DIE", "*BOUNDARY", "LEFT, 1",
        "BOTTOM, 2", "9001, 1", "9001, 6", "*STEP, NLGEOM, INC=300", "*STATIC", "*BOUNDARY",
        f"9001, 2, 2, {-15.0*share!r}", "*END STEP", ""]), "billet")


@pytest.mark.parametrize("law", ["TRESCA", "CRISTESCU"])
@pytest.mark.parametrize("m", [0.1, 0.4])
def test_billets_are_upset_in_default_increments(solve, law, m):
    """CRISTESCU reads the stress that holds its shear: at 0.4 the two chased each other in a cycle of three."""
    result = solve(billet(law, m))
    assert result.history["time"][-1] == pytest.approx(1.0)
    assert len(result.history["time"]) < 80


def test_the_first_increment_is_cut_before_newton_has_tried_in_vain(solve):
    result = solve(billet("TRESCA", 0.1))
    assert result.history["iterations"][0] < 20


@pytest.mark.parametrize("pressure, shear, lost", [(10.0, 2.0, 0.0), (0.25, 2.0, 0.0), (0.1, 1.0, 0.5)])
def test_a_bound_of_stress_rises_as_ten_times_the_pressure(solve, pressure, shear, lost):
    """TAUMAX of 2 on a face of 10 x 1: whole from a pressure of 0.2 on; what is left out is told."""
    deck = block(step(f"*BOUNDARY\n9001, 1, 1, 1.\n9001, 2, 2, {-pressure/100.0!r}"),
                 held="ALL, 1\nBOTTOM, 2")
    text = re.sub(r"\*FRICTION\n[^\n]*", "*FRICTION, LAW=TRESCA, TAUMAX=2.", deck.text())
    result = solve(Deck.parse(text, "sheared"))
    assert abs(result.history["TOOL.rf1"][-1]) == pytest.approx(10.0*shear, rel=2e-3)
    assert result.summary["certificate"]["ramp"] == pytest.approx(lost, abs=0.01)
    assert any(d["code"] == "W0327" for d in result.diagnostics) == (lost > 0.0)


def test_auto_takes_the_coefficient_where_the_pressure_is_low(solve):
    """LAW=AUTO with mu and m: never above mu p, as sheets need."""
    deck = block(step("*BOUNDARY\n9001, 1, 1, 1.\n9001, 2, 2, -0.001"), held="ALL, 1\nBOTTOM, 2",
                 material="*ELASTIC\n1000., 0.\n*PLASTIC, ONLY=FRICTION\n173.2, 0.")
    text = re.sub(r"\*FRICTION\n[^\n]*", "*FRICTION, LAW=AUTO\n0.2, 0.4", deck.text())
    result = solve(Deck.parse(text, "sheared"))
    assert abs(result.history["TOOL.rf1"][-1]) == pytest.approx(0.2, rel=2e-3)
    assert result.summary["certificate"]["ramp"] == 0.0


def test_a_sheet_that_jams_is_told_of_coefficients(solve):
    """Under a holder Tresca allows more shear than there is pressure; the increment may not be cut."""
    deck = re.sub(r"(\*FRICTION)\n[^\n]*", r"\1, LAW=TRESCA\n0.1", sheets.cup(24, 2))
    deck = re.sub(r"(\*STATIC)\n0\.002, [^\n]*", r"\1\n0.02, 1., 0.01", deck)
    with pytest.raises(NotConvergedError) as problem:
        solve(Deck.parse(deck, "cup"))
    assert "LAW=COULOMB-OROWAN" in str(problem.value)
    assert "PENALTY on *SURFACE BEHAVIOR" in str(problem.value)


def test_a_sheet_that_jams_goes_on_under_a_bound_that_rises_less_steeply(solve):
    """The same cup in default increments stopped at 2 % of its stroke; the slope and what is left out are said."""
    deck = re.sub(r"(\*FRICTION)\n[^\n]*", r"\1, LAW=TRESCA\n0.1", sheets.cup(24, 2, opened=False))
    result = solve(Deck.parse(deck, "cup"))
    assert result.history["time"][-1] == pytest.approx(2.0)
    assert len(result.history["time"]) < 250
    said, = [d["message"] for d in result.diagnostics if d["code"] == "W0326"]
    slope = float(re.search(r"rises at most as ([\d.]+) p", said)[1])
    assert 0.6 < slope <= 5.0 and 100.0*result.summary["certificate"]["ramp"] < 100.0


def test_points_that_jam_are_eased_by_themselves(solve):
    """A sheet bent over radii of dies: Newton goes on in the increment, and no attempt is made for the whole pair."""
    text = air_bend("CPE4I", 1.0, 0.0, friction=("*FRICTION, LAW=TRESCA", "0.3,"))[0].deck().text()
    result = solve(Deck.parse(text[:text.rindex("*STEP")], "bent"))
    assert result.history["time"][-1] == pytest.approx(1.0)
    log = next(result.source.folder.glob("*.cvg")).read_text()
    assert "points that jam: 1, whose bounds" in log
    assert "with bounds of friction that rise less steeply" not in log
    assert {"W0326", "W0327"} <= {d["code"] for d in result.diagnostics}
