"""What a run in parts takes along: springs, tools of facets, critical damage of each metal, warnings;
and surfaces that it loses."""
import json

import numpy as np
import pytest
from test_point_states import PLASTIC
from test_remeshing import block, history, run

import lopin
from lopin.errors import DeckError
from lopin.remesh.body import DeckParts, read_body
from lopin.remesh.driver import Runner
from lopin.remesh.part import next_deck
from lopin.remesh.report import Remesh, Report
from lopin.remesh.separate import CRITERIA as COLUMNS
from lopin.remesh.separate import without

STEP = "*STEP, NLGEOM"
#: The die is led by node 9998 through a spring, or stands on the ground by one.
SPRINGS = {"SPRING2": ("9998, 0., 20.", "9000, 9998, 9999", "2, 2\n50000.,", "9998, 2, 2, -3."),
           "SPRINGA": ("9998, 0., 30.", "9000, 9998, 9999", "\n50000.,", "9998, 2, 2, -3."),
           "SPRING1": ("", "9000, 9999", "2,\n30000.,", "")}


def sprung(word):
    node, element, law, moved = SPRINGS[word]
    text = block("CAX4").text()
    spring = f"*ELEMENT, TYPE={word}, ELSET=SP\n{element}\n*SPRING, ELSET=SP\n{law}\n"
    if node:
        spring = f"*NODE\n{node}\n" + spring + "*BOUNDARY\n9998, 1\n"
    text = text.replace(STEP, spring + STEP, 1)
    return text.replace("9999, 2, 2, -3.0\n", f"{moved}\n" if moved else
                        "*CLOAD\n9999, 2, -60000.\n")


@pytest.mark.parametrize("word", ["SPRING2", "SPRINGA", "SPRING1"])
def test_springs_of_a_tool_go_on_over_new_meshes(word, core, tmp_path):
    """Their elements were lost at the first new mesh (E0201)."""
    text = sprung(word)
    report = run(lopin.Deck.parse(text, name="block"), tmp_path/"parts")
    assert len(report.remeshes) >= 2
    plain = "\n".join(line for line in text.splitlines() if "*REMESH" not in line) + "\n"
    whole = lopin.run(lopin.Deck.parse(plain, name="whole"), tmp_path/"one").history["DIE.u2"]
    assert history(tmp_path/"parts", "block")["DIE.u2"][-1] == pytest.approx(whole[-1], rel=1e-6)
    assert whole[-1] < -0.2
    assert not any("W0530" in said for said in report.warnings())   # what springs hold at a start


@pytest.mark.parametrize("word, nodes", [("SPRING1", "1"), ("SPRING2", "9999, 1"), ("SPRINGA", "1, 9999")])
def test_springs_of_nodes_of_the_body_are_refused_by_name(word, nodes, core, tmp_path):
    spring = f"*ELEMENT, TYPE={word}, ELSET=SP\n9000, {nodes}\n*SPRING, ELSET=SP\n" \
        + {"SPRING1": "2,", "SPRING2": "2, 2", "SPRINGA": ""}[word] + "\n10.,\n"
    text = block("CAX4").text().replace(STEP, spring + STEP, 1)
    with pytest.raises(lopin.LopinError, match=f"{word} 9000 holds node 1 of B"):
        Runner(lopin.Deck.parse(text, name="block"), tmp_path, say=lambda line: None)


def of_facets(word, side):
    """A block, pressed by a plane tool of rigid facets."""
    text = block({"R2D2": "CPE4", "RAX2": "CAX4"}.get(word, "C3D4"), travel=-1.0,
                 card="PERIOD=.5, STRAIN=10.", increments=5).text()
    flat = word in ("R2D2", "RAX2")
    x = [(20., 5.), (0., 5.)] if flat else [(-9., 5., -9.), (-9., 5., 20.), (20., 5., 20.), (20., 5., -9.)]
    cells = {"R3D4": [(1, 2, 3, 4)], "R3D3": [(1, 2, 3), (1, 3, 4)]}.get(word, [(1, 2)])
    # Towards the block are the left of a way to -x, and the back of these facets in space.
    if flat == (side == "SNEG"):
        cells = [c[::-1] for c in cells]
    nodes = "".join(f"{9100 + k}, {', '.join(map(str, p))}\n" for k, p in enumerate(x, 1))
    rows = "".join(f"{9100 + k}, {', '.join(str(9100 + n) for n in c)}\n" for k, c in enumerate(cells))
    first, last = text.index("*SURFACE, NAME=DIE"), text.index("*SOLID SECTION")
    return text[:first] + f"*NODE\n{nodes}*ELEMENT, TYPE={word}, ELSET=TE\n{rows}*SURFACE, NAME=DIE\n" \
        f"TE, {side}\n*RIGID BODY, ELSET=TE, REF NODE=9999\n" + text[last:]


@pytest.mark.parametrize("word, side", [("R2D2", "SPOS"), ("R2D2", "SNEG"), ("R2D2", ""),
                                        ("RAX2", "SPOS"), ("R3D3", "SPOS"), ("R3D4", "SNEG")])
def test_tools_of_rigid_facets_meet_bodies_that_are_made_anew(word, side, core, tmp_path):
    """They ended runs by a KeyError. Without friction the force is that of one mesh."""
    if word[1] == "3":
        pytest.importorskip("mmgpy")
    text = of_facets(word, side)
    report = run(lopin.Deck.parse(text, name="block"), tmp_path/"parts")
    assert len(report.remeshes) >= 1 and report.verdict()[0] == "PASS"
    assert not any(r.unbalanced for r in report.remeshes)
    plain = "\n".join(line for line in text.splitlines() if "*REMESH" not in line) + "\n"
    whole = lopin.run(lopin.Deck.parse(plain, name="whole"), tmp_path/"one").history
    force = next(name for name in whole if name.endswith(".rf2"))
    found = history(tmp_path/"parts", "block")[force]
    assert found[-1] == pytest.approx(whole[force][-1], rel=1e-6) and abs(found[-1]) > 1e3


# ---- critical damage ----


def two_metals(first, second, cards="BC"):
    """Two blocks side by side under one die, each of its own metal; values of CRITICAL, or none."""
    def cells(name, x0, at):
        nodes = "".join(f"{at + 5*j + i}, {x0 + i}., {j}.\n" for j in range(4) for i in range(5))
        rows = "".join(f"{at + 4*j + i}, " + ", ".join(str(at + 5*j + i + k) for k in (0, 1, 6, 5)) + "\n"
                       for j in range(3) for i in range(4))
        low = ", ".join(str(at + i) for i in range(5))
        return f"*NODE\n{nodes}*ELEMENT, TYPE=CPE4, ELSET={name}\n{rows}*NSET, NSET={name}.LOW\n{low}\n" \
            f"*SURFACE, NAME={name}.SKIN\n{name},\n"

    def metal(name, value):
        damage = "".join(f"*DAMAGE, CRITERION={c}" + (f", CRITICAL={v}" if v else "") + "\n"
                         for c, v in value.items())
        return f"*MATERIAL, NAME={name}\n*ELASTIC\n70000., .3\n{PLASTIC}\n{damage}"

    anew = "".join(f"*REMESH, ELSET={name}, SIZE=1., SMALLEST=.4, STRAIN=9., MOST=3\n" for name in cards)
    return lopin.Deck.parse(f"""{cells("B", 0, 1)}{cells("C", 10, 101)}*NODE
9999, 0., 9.
*SURFACE, NAME=DIE, TYPE=SEGMENTS
START, 50., 3.
LINE, -50., 3.
*RIGID BODY, ANALYTICAL SURFACE=DIE, REF NODE=9999
{metal("MB", first)}{metal("MC", second)}*SOLID SECTION, ELSET=B, MATERIAL=MB
*SOLID SECTION, ELSET=C, MATERIAL=MC
*SURFACE INTERACTION, NAME=I
*SURFACE BEHAVIOR, DIRECT
*FRICTION
.3,
*CONTACT PAIR, INTERACTION=I
B.SKIN, DIE
C.SKIN, DIE
{anew}*STEP, NLGEOM, INC=400
*STATIC
.1, 1., , .1
*BOUNDARY
B.LOW, 1, 2
C.LOW, 1, 2
9999, 1
9999, 6
9999, 2, 2, -.7
*END STEP
""", name="two")


CRITERIA = ("RICE-TRACEY", "LEMAITRE", "COCKCROFT-LATHAM")


@pytest.mark.parametrize("criterion", CRITERIA)
def test_each_body_separates_by_the_damage_of_its_own_metal(criterion, core, tmp_path):
    """All bodies had the last value that the deck gave for a criterion."""
    other = CRITERIA[CRITERIA.index(criterion) - 1]
    for first, second in (({criterion: .3}, {criterion: .9}), ({criterion: .9}, {criterion: .3}),
                          ({criterion: .3}, {criterion: None}), ({criterion: None}, {criterion: .3}),
                          ({criterion: .3}, {other: .2}), ({criterion: .3, other: .1}, {}),
                          ({}, {criterion: .4})):
        runner = Runner(two_metals(first, second), tmp_path, say=lambda line: None)
        for elset, given in (("B", first), ("C", second)):
            own = {name: value for name, value in given.items() if value}
            assert runner.critical[elset] == own
            assert {c[:2] for c in runner.cards[elset].cuts} == \
                {(COLUMNS.index(name), value) for name, value in own.items()}


@pytest.mark.parametrize("first, second, cut", [(.05, 9., "B"), (9., .05, "C"), (.05, None, "B"),
                                                (None, .05, "C")])
def test_metal_beyond_its_own_critical_damage_alone_is_cut(first, second, cut, core, tmp_path):
    deck = two_metals({"RICE-TRACEY": first}, {"RICE-TRACEY": second})
    try:
        report = run(deck, tmp_path)
        decks = report.parts
    except lopin.LopinError:   # what is left is held by nothing, or too little
        decks = [p.stem for p in sorted(tmp_path.glob("two.p00?.inp"))]
    elements = [{e: len(DeckParts.of(lopin.Deck.read(tmp_path/f"{name}.inp")).cards.elsets.get(e, []))
                 for e in "BC"} for name in decks]
    cuts = [now for before, now in zip(elements, elements[1:]) if now[cut] < before[cut]]
    other = "C" if cut == "B" else "B"
    assert cuts and all(now[other] >= 12 for now in elements)


@pytest.mark.parametrize("first, second, cards", [({"RICE-TRACEY": .3}, {"RICE-TRACEY": .1}, "B"),
                                                  ({}, {"LEMAITRE": .1}, "B"), ({"LEMAITRE": .1}, {}, "C")])
def test_critical_damage_of_a_body_that_is_not_made_anew_is_refused(first, second, cards, core, tmp_path):
    with pytest.raises(lopin.LopinError, match="would not separate") as caught:
        Runner(two_metals(first, second, cards), tmp_path, say=lambda line: None)
    assert caught.value.id == "E0621" and f"*REMESH, ELSET={'C' if cards == 'B' else 'B'}" in caught.value.help


# ---- surfaces that are lost ----

NAMES = """*SURFACE, NAME=LOST
13, S3
14, S3
15, S3
16, S3
*SURFACE, NAME=KEPT
16, S3
1, S1
*NSET, NSET=TOP
22, 23, 24
*SURFACE, NAME=DOTS, TYPE=NODE
TOP,
*SURFACE, NAME=MORE, TYPE=NODE
TOP,
LOW,
*CONTACT PAIR, INTERACTION=I
LOST, DIE
*CONTACT PAIR, INTERACTION=I
KEPT, DIE
DOTS, DIE
*CONTACT PRINT, SLAVE=LOST, MASTER=DIE
CF
*NODE PRINT, NSET=TOP
U
*NODE PRINT, NSET=LOW
U
*DSLOAD
LOST, P, 1.
KEPT, P, 1.
*MODEL CHANGE, TYPE=CONTACT PAIR, REMOVE
LOST, DIE
*BOUNDARY
TOP, 1
LOW, 1
"""


def test_surfaces_and_sets_without_a_face_left_take_their_lines_along():
    """An empty *SURFACE ended the run (E0301), used or not."""
    from test_separation import state, strip

    parts, body = strip()
    deck = lopin.Deck.parse("\n".join(b.text() for b in parts.blocks) + "\n*SURFACE, NAME=DIE, TYPE=STL, "
                            "INPUT=die.stl\n" + NAMES, name="strip")
    parts = DeckParts.of(deck)
    body = read_body(parts, "B")
    gone = np.zeros(16, bool)
    gone[12:] = True
    mesh, _ = without(body, state(body).x, gone, set())
    start = lopin.Deck.parse("*INITIAL CONDITIONS, TYPE=TRACTION\nLOST, DIE, 1, 0., 0., 0.\n"
                             "KEPT, DIE, 2, 0., 0., 0.\n*STEP\n").blocks[:1]
    found = next_deck(parts, body, mesh, "strip.p002", deck.folder, start)
    text = "\n".join(b.text() for b in found.blocks)
    assert "LOST" not in text and "DOTS" not in text and "NSET=TOP" not in text
    assert "TYPE=STL" in text and text.count("KEPT") == 3 and "MODEL CHANGE" not in text
    assert [b.data for b in found.all("SURFACE") if b.parameters["NAME"] == "MORE"] == [[["LOW"]]]
    assert [b.data[0][0] for b in found.all("BOUNDARY")][-1] == "LOW"
    assert len(found.all("NODE PRINT")) == 1 and len(found.all("CONTACT PAIR")) == 1


# ---- warnings ----


@pytest.mark.parametrize("behaviour, code", [("PENALTY", "W0504"), ("HARD", "")])
def test_warnings_of_the_solver_are_told_and_strict_obeyed(behaviour, code, core, tmp_path, capsys):
    """The verdict was that on new meshes alone; --strict did nothing."""
    from lopin.remesh.command import run_remeshed

    text = block("CAX4", travel=-1.0, card="PERIOD=.4, STRAIN=10.", increments=10).text()
    if code:
        text = text.replace("PRESSURE-OVERCLOSURE=HARD", "PRESSURE-OVERCLOSURE=LINEAR\n1e5,")
    path = tmp_path/"block.inp"
    path.write_text(text)
    words = [str(path), "-o", str(tmp_path/"out"), "--overwrite", "-q"]
    assert run_remeshed(path, words) == 0
    said = capsys.readouterr().out
    assert (f"warning[{code}]: part 1" in said and "WARN: certificate of part" in said) == bool(code)
    assert f"3 parts, 2 remeshes: {'WARN' if code else 'PASS'}" in said
    run_remeshed(path, [*words, "--json"])
    told = json.loads(capsys.readouterr().out)
    assert told == json.loads((tmp_path/"out"/"block.parts.json").read_text())
    assert told["verdict"] == told["certificate"]["verdict"] == ("WARN" if code else "PASS")
    assert told["remeshing"] == "PASS" and (code in {d["code"] for d in told["diagnostics"]}) == bool(code)
    summary = json.loads((tmp_path/"out"/"block.json").read_text())["certificate"]
    assert summary["verdict"] == told["verdict"] and bool(summary["reason"]) == bool(code)
    if not code:
        assert run_remeshed(path, [*words, "--strict"]) == 0
        return
    for strict in (lambda: run_remeshed(path, [*words, "--strict"]),
                   lambda: lopin.run(path, tmp_path/"again", strict=True)):
        with pytest.raises(DeckError, match=code) as caught:
            strict()
        assert caught.value.id == "E0803" and caught.value.code == 1
    assert (tmp_path/"again"/"block_history.csv").is_file()


# ---- tools driven by force ----


@pytest.mark.parametrize("jump, verdict", [(0.0, "PASS"), (0.02, "WARN"), (0.14, "FAIL")])
@pytest.mark.parametrize("axis, scale", [(1, 1.0), (2, 1e-3), (3, 1e4)])
def test_a_tool_driven_by_force_that_gives_way_at_rest_is_judged(jump, verdict, axis, scale, tmp_path):
    """Its reaction is 0, before and after: the check said 0 %. Another tool goes its way."""
    rows = [[0.4, 1.0], [0.8, 2.0]], [[0.8*(1.0 + jump), 2.0], [1.0, 3.0]]
    for part, of in enumerate(rows, 1):
        (tmp_path/f"cut.p00{part}_history.csv").write_text(
            f"time [t],DIE.u{axis} [length],DIE.rf{axis} [force],PUNCH.u2 [length],PUNCH.rf2 [force]\n"
            + "".join(f"{0.1*k},{-scale*u!r},0.,{-scale*v!r},-50.\n" for k, (u, v) in enumerate(of)))
    done = Remesh(1, 0.1, "worn", 10, 0.3, {"volume": 1.0, "volume_change": 0.0}, 0.0, 0.0, 0.0, 1.0)
    report = Report("cut", tmp_path, ["cut.p001", "cut.p002"], [done])
    found, = report.jumps()
    assert found["change"] == 0.0 and found["way"] == pytest.approx(jump)
    assert report.verdict()[0] == verdict and len(report.verdict()[1]) == (verdict != "PASS")
    assert ("at rest DIE moves by" in report.text()) == (jump > 0.0)
    assert json.loads(report.json())["remeshes"][0]["way_change"] == pytest.approx(jump)


@pytest.mark.parametrize("inc, period, ends", [(20, .2, True), (20, .9, True), (19, .2, False), (7, .2, False),
                                               (5, .2, False)])
def test_increments_count_over_all_parts(inc, period, ends, core, tmp_path):
    """They began anew with each mesh: 25 of 10. Those at rest do not count."""
    text = block("CPE4", travel=-1.0, card=f"PERIOD={period}, STRAIN=10.").text()
    deck = lopin.Deck.parse(text.replace(STEP, f"{STEP}, INC={inc}"), name="block")
    if ends:
        assert run(deck, tmp_path).remeshes
    else:
        with pytest.raises(lopin.NotConvergedError, match=f"in the {inc} increments") as caught:
            run(deck, tmp_path)
        assert caught.value.id == "E0503"
    found = history(tmp_path, "block")
    at_rest = len(np.unique(found["part"])) - 1
    assert len(found["part"]) - at_rest == min(inc, 20)
