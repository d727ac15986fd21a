"""Tools that let go: pairs removed, tools withdrawn, loads taken off. An elastic release without
friction ends in one shape; work that is done on the way is said."""
import numpy as np
import pytest

import lopin

HELD = ["LEFT, 1", "BOTTOM, 2", "9001, 1", "9001, 6"]
STEEL = ["*PLASTIC", "300., 0.", "800., 1."]
HOT = ["*VISCOPLASTIC, LAW=NORTON-HOFF", "50., 0.15"]
WAYS = {
    "removed": ["*MODEL CHANGE, TYPE=CONTACT PAIR, REMOVE", "TOP, PLATE"],
    "withdrawn": ["*BOUNDARY", "9001, 2, 2, -0.5"],
    "unloaded": ["*BOUNDARY, OP=NEW", *HELD],
}


def billet(flow, way, friction="", stroke=2.0, period=1.0):
    """A billet of radius and half height 5 pressed by a plate, which lets go."""
    n = 5
    lines = ["*NODE, NSET=ALL"]
    lines += [f"{1 + i*n + j}, {5.0*i/4}, {5.0*j/4}" for i in range(n) for j in range(n)]
    lines.append("*ELEMENT, TYPE=CAX4, ELSET=BILLET")
    lines += [f"{1 + 4*i + j}, {1 + i*n + j}, {1 + (i + 1)*n + j}, {2 + (i + 1)*n + j}, "
              f"{2 + i*n + j}" for i in range(4) for j in range(4)]
    return "\n".join([
        *lines, "*NSET, NSET=LEFT", *(str(1 + j) for j in range(n)), "*NSET, NSET=BOTTOM",
        *(str(1 + i*n) for i in range(n)), "*SURFACE, NAME=TOP", *(f"{4 + 4*i}, S3"
                                                                  for i in range(4)),
        "*MATERIAL, NAME=METAL", "*ELASTIC", "200000., 0.3", *flow,
        "*SOLID SECTION, ELSET=BILLET, MATERIAL=METAL", "*NODE", "9001, 0., 5.",
        "*SURFACE, NAME=PLATE, TYPE=SEGMENTS", "START, 20., 5.", "LINE, -1., 5.",
        "*RIGID BODY, ANALYTICAL SURFACE=PLATE, REF NODE=9001", "*SURFACE INTERACTION, NAME=DRY",
        "*SURFACE BEHAVIOR, DIRECT", *friction, "*CONTACT PAIR, INTERACTION=DRY", "TOP, PLATE",
        "*BOUNDARY", *HELD, "*STEP, NLGEOM, INC=500", "*STATIC", f"{0.02*period}, {period}",
        "*BOUNDARY", f"9001, 2, 2, {-stroke}", "*NODE FILE", "U", "*END STEP",
        "*STEP, NLGEOM, INC=500", "*STATIC", "0.1, 1.", *WAYS[way], "*NODE FILE", "U",
        "*END STEP", ""])


def released(solve, deck):
    """Displacements of the nodes as formed and at the end, plastic work at both, codes."""
    result = solve(lopin.Deck.parse(deck, "billet"))
    work = result.history["energy.plastic"]
    before = np.flatnonzero(result.history["step"] == 1)[-1]
    at = int(np.argmin(abs(np.asarray(result.times) - result.history["time"][before])))
    ends = [result.to_meshio(k).point_data["U"][:25, :2] for k in (at, len(result.times) - 1)]
    return *ends, work[before], work[-1], [d["code"] for d in result.diagnostics]


@pytest.mark.parametrize("friction", [(), ("*FRICTION", "0.1,")])
def test_three_ways_end_in_one_shape(solve, friction):
    """To 0.1 % of what springs back; nothing flows, so that only friction on the way is said."""
    shapes = {}
    for way in WAYS:
        formed, shape, before, after, codes = released(solve, billet(STEEL, way, friction))
        assert after == pytest.approx(before, rel=1e-9)
        assert "W0518" not in codes and ("N0518" not in codes or friction and way != "removed")
        shapes[way] = shape
    back = abs(shapes["removed"] - formed).max()
    for shape in shapes.values():
        assert abs(shape - shapes["removed"]).max() < 1e-3*back


@pytest.mark.parametrize("way", ["removed", "unloaded"])
def test_hot_metal_does_not_flow_on_under_a_tool_that_lets_go(solve, way):
    """Under a force that fades over the step a billet pressed in 0.05 s flowed twice as far."""
    shapes = []
    for each in (way, "withdrawn"):
        formed, shape, before, after, _ = released(solve, billet(HOT, each, period=0.05))
        assert after < 1.002*before
        shapes.append(shape - formed)
    assert abs(shapes[0] - shapes[1]).max() < 0.02


def test_work_of_a_release_is_said(solve):
    """A load that is taken off slowly presses the hot billet on."""
    deck = billet(HOT, "unloaded", period=0.05).replace(
        "*BOUNDARY\n9001, 2, 2, -2.0", "*CLOAD\n9001, 2, -20000.").replace(
        "*BOUNDARY, OP=NEW\n" + "\n".join(HELD), "*CLOAD\n9001, 2, 0.")
    _, _, before, after, codes = released(solve, deck)
    assert after > 1.01*before
    assert "W0518" in codes


def test_a_tool_does_no_work_where_it_has_left_the_body(solve):
    """Withdrawn far in one increment: the work that comes out is the elastic energy that does."""
    deck = billet(STEEL, "withdrawn").replace("0.1, 1.\n*BOUNDARY\n9001, 2, 2, -0.5",
                                              "1., 1.\n*BOUNDARY\n9001, 2, 2, 5.")
    result = solve(lopin.Deck.parse(deck, "billet"))
    energy = {k: result.history[f"energy.{k}"] for k in ("strain", "external")}
    last = np.asarray(result.history["step"]) == 1
    out, free = (energy[k][last][-1] - energy[k][-1] for k in ("external", "strain"))
    assert free > 10.0
    assert out == pytest.approx(free, rel=0.05)
    assert not [d for d in result.diagnostics if d["severity"] == "warning"]


@pytest.mark.parametrize("mu", [0.0, 0.1])
def test_a_release_is_told_where_another_tool_presses_on(core, mu):
    """A flange wiped over a die lies on it yet when the punch has gone, which rubs on its way."""
    from lopin.atlas.forming_scenes import flanged

    result = lopin.run(flanged("CPE8R", 1.0, mu)[0].deck())
    assert abs(result.history["BOTTOM-DIE.force2"][-1]) > 1e-3 or mu == 0.0
    assert ("W0518" in {d["code"] for d in result.diagnostics}) == (mu > 0.0)


def test_flow_that_no_increment_avoids_does_not_size_the_first(executable, tmp_path, monkeypatch):
    """What lets go at once flows at once. Increments that were to fit its flow were cut 99 times."""
    monkeypatch.setenv("LOPIN_EXECUTABLE", str(executable))
    soft = billet(["*VISCOPLASTIC, LAW=NORTON-HOFF", "150., 0.15"], "removed", period=0.05)
    deck = soft.replace("200000., 0.3", "20000., 0.3").replace("0.1, 1.\n", "")
    lopin.run(lopin.Deck.parse(deck, "billet"), tmp_path, executable=True)
    rows = [line.split() for line in next(tmp_path.glob("*.sta")).read_text().splitlines()[2:]]
    release = [row for row in rows if row[0] == "2"]
    assert int(release[0][2]) <= 9
    assert float(release[-1][4]) == pytest.approx(1.05)


def test_a_tool_that_friction_held_is_let_go_of_by_parts(executable, tmp_path, monkeypatch):
    """A leaning plate: friction lets it go where the forces that held it fade, not in one jump."""
    monkeypatch.setenv("LOPIN_EXECUTABLE", str(executable))
    backs = {}
    for way in ("removed", "unloaded"):
        deck = billet(HOT, way, ("*FRICTION", "0.1,"), period=0.05).replace("0.1, 1.\n", "")
        deck = deck.replace("START, 20., 5.\nLINE, -1., 5.", "START, 20., 13.\nLINE, -1., 4.6")
        formed, shape, *_ = released(lambda scene, way=way: lopin.run(
            scene, tmp_path/way, executable=True), deck)
        backs[way] = shape - formed
    assert abs(backs["unloaded"] - backs["removed"]).max() < 0.005*abs(backs["removed"]).max()
    assert "by parts of what is let go of" in next((tmp_path/"unloaded").glob("*.cvg")).read_text()
