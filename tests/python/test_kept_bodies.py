"""Several bodies that deform: one is meshed anew while the others keep mesh and memory."""
import csv

import numpy as np
import pytest
from test_point_states import PLASTIC, deck, grid

import lopin
from lopin import mesh_make
from lopin.deck import Block

HILL = PLASTIC + "\n*POTENTIAL\n1.2, 1., .9, 1.1, 1., 1."
MOVING = "*PLASTIC, HARDENING=KINEMATIC\n200., 0.\n300., .5"
COUNTED = PLASTIC + "\n*DAMAGE, CRITERION=COCKCROFT-LATHAM"


def at(name):
    return Block("INITIAL CONDITIONS", {"TYPE": name}).head()


def gone_on(scene, word, stop):
    """The same deck, from where its run stands after some increments: mesh, motion, memory."""
    with lopin.open(scene) as job:
        for _ in range(stop):
            frame = job.advance()
        motion, memory = (job._session.field(f"STATE OF {name}") for name in
                          ("MOTION", "MEMORY" if job.points is not None else "MOTION"))
        clock = job._session.field("STATE OF CLOCK")[0]
        tractions = job.tractions.lines([("SKIN", "DIE")])
        plain = job.points is None
        rest = [np.asarray(frame["reaction"])[-1]]
        for frame in job:
            pass
        rest.append(np.asarray(frame["reaction"])[-1])
    rows = "\n".join(", ".join([str(int(r[0])), str(int(r[1])), *map(repr, r[2:])])
                     for r in motion.tolist())
    held = "" if plain else at("MEMORY") + "\n" + "\n".join(
        ", ".join([str(int(r[0])), str(int(r[1])), *map(repr, r[2:])]) for r in memory.tolist())
    start = (f"{held}\n{at('TRACTION')}\n{tractions}*START, STEP=1, TIME={float(clock[2])!r}, "
             f"REST=1e-9, INCREMENT={float(clock[3])!r}\n{rows}\n*STEP")
    return scene.text().replace("*STEP", start), rest, memory, plain


@pytest.mark.parametrize("word, law", [
    ("CAX4", PLASTIC), ("CAX4I", PLASTIC), ("CPE4I", PLASTIC), ("CPS4", PLASTIC), ("CPE3", PLASTIC),
    ("C3D8I", PLASTIC), ("C3D4", PLASTIC), ("CAX4", HILL), ("C3D8", MOVING), ("CAX4", COUNTED),
    ("CAX4", ""), ("C3D8I", "")])
def test_a_mesh_that_stays_goes_on_where_it_was(word, law, core):
    """Any element and any law: the force at rest and at the end is that of a run without a
    break."""
    x, cells = grid(word)
    text, (before, end), memory, plain = gone_on(deck(word, x, cells, 5.0, -0.8, law=law), word, 2)
    with lopin.open(lopin.Deck.parse(text, name="on")) as job:
        frame = job.advance()
        force = np.asarray(frame["reaction"])[-1]
        # What the last increment before left out of balance.
        left = 1e-5 if law in (HILL, MOVING) else 1e-7
        assert np.abs(force - before).max() < left*np.abs(before).max()
        if not plain:
            after = job._session.field("STATE OF MEMORY")
            size = np.abs(memory[:, 8:]).max(axis=0) + 1e-3
            assert (np.abs(after - memory)[:, 8:]/size).max() < left
            assert np.abs(after - memory)[:, :8].max() < 1e-9
        for frame in job:
            pass
        force = np.asarray(frame["reaction"])[-1]
        assert np.abs(force - end).max() < 1e-6*np.abs(end).max()
        result = job.result
    assert not [d for d in result.diagnostics if d["code"] == "W0530"]


def test_a_memory_of_other_elements_is_refused(core):
    x, cells = grid("CAX4")
    text, *_ = gone_on(deck("CAX4", x, cells, 5.0, -0.8), "CAX4", 1)
    for other in (text.replace("*PLASTIC\n", "*PLASTIC, HARDENING=KINEMATIC\n").replace(
            "\n600., 2.", ""), text.replace("\n3, 4, ", "\n3, 5, ")):
        assert other != text
        with pytest.raises(lopin.LopinError, match="E0210"):
            lopin.run(lopin.Deck.parse(other, name="other"))
    short = text[:text.index("*INITIAL CONDITIONS, TYPE=MEMORY")] \
        + "*INITIAL CONDITIONS, TYPE=MEMORY\n1, 1, 0., 1.\n*START" + text.split("*START")[1]
    with pytest.raises(lopin.LopinError, match="E0103"):
        lopin.run(lopin.Deck.parse(short, name="short"))


# ---- runs in parts ----


def stacked(lower="CAX4", upper="CAX4", cards="*REMESH, ELSET=TOP, PERIOD=.2, STRAIN=10.",
            law=PLASTIC, below="", travel=-4.5):
    """Two blocks of the same width, one on the other, pressed without friction."""
    def part(word, low, high, n, first):
        r, z = np.linspace(0.0, 5.0, 5).tolist(), np.linspace(low, high, n + 1).tolist()
        number = first + np.arange(len(r)*len(z)).reshape(len(r), len(z))
        nodes = "\n".join(f"{number[i, j]}, {r[i]!r}, {z[j]!r}" for i in range(len(r))
                          for j in range(len(z)))
        quads = [(number[i, j], number[i + 1, j], number[i + 1, j + 1], number[i, j + 1])
                 for i in range(len(r) - 1) for j in range(n)]
        if word[3] == "3":
            quads = [t for q in quads for t in (q[:3], (q[0], q[2], q[3]))]
        rows = "\n".join(f"{first + k}, {', '.join(map(str, q))}" for k, q in enumerate(quads))
        return nodes, rows, number

    nodes, rows, low = part(lower, 0.0, 4.0, 4, 1)
    more, cells, top = part(upper, 4.0, 9.0, 5, 101)

    def line(name, labels):
        return f"*NSET, NSET={name}\n" + "\n".join(map(str, labels))

    axis = [*low[0], *top[0]] if lower.startswith("CAX") else [*low[0], *top[0]]
    side = "CPS" if lower.startswith("CPS") else lower[:3]
    assert side == upper[:3]
    return lopin.Deck.parse(f"""*NODE
{nodes}
{more}
9999, 0., 20.
*ELEMENT, TYPE={lower}, ELSET=LOW
{rows}
*ELEMENT, TYPE={upper}, ELSET=TOP
{cells}
{line("FLOOR", low[:, 0])}
{line("AXIS", axis)}
{line("LOW.TOP", low[:, -1])}
{line("TOP.BOTTOM", top[:, 0])}
*SURFACE, NAME=SEAT
LOW,
*SURFACE, NAME=FOOT
TOP,
*SURFACE, NAME=DIE, TYPE=SEGMENTS
START, 50., 9.
LINE, -50., 9.
*RIGID BODY, ANALYTICAL SURFACE=DIE, REF NODE=9999
*SOLID SECTION, ELSET=LOW, MATERIAL=M
*SOLID SECTION, ELSET=TOP, MATERIAL=M
*MATERIAL, NAME=M
*ELASTIC
70000., .3
{law}
*SURFACE INTERACTION, NAME=I
*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD
*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE
FOOT, SEAT
*CONTACT PAIR, INTERACTION=I
FOOT, DIE
{below}{cards}
*STEP, NLGEOM
*STATIC
.05, 1., , .05
*BOUNDARY
FLOOR, 2
AXIS, 1
9999, 1
9999, 6
9999, 2, 2, {travel!r}
*END STEP
""", name="stack")


def history(folder, name):
    """Columns of the joined history by their first word."""
    with (folder/f"{name}_history.csv").open(newline="") as file:
        head, *rows = list(csv.reader(file))
    table = np.array([[float(v) for v in row] for row in rows])
    return {word.partition(" ")[0]: column for word, column in zip(head, table.T)}


BOTH = "*REMESH, ELSET=TOP, PERIOD=.3, STRAIN=10.\n*REMESH, ELSET=LOW, PERIOD=.25, STRAIN=10."


@pytest.mark.parametrize("lower, upper, cards, meshes", [
    ("CAX4", "CAX4", "*REMESH, ELSET=TOP, PERIOD=.2, STRAIN=10.", 4),
    ("CAX4I", "CAX4", "*REMESH, ELSET=TOP, PERIOD=.2, STRAIN=10.", 4),
    ("CAX4", "CAX4", "*REMESH, ELSET=LOW, PERIOD=.2, STRAIN=10.", 4),
    ("CAX4", "CAX3", BOTH, 4)])
def test_two_blocks_pressed_evenly_are_one(lower, upper, cards, meshes, core, tmp_path):
    """One on the other, either meshed anew: uniform strain stays uniform, the force is that of a
    block as high as both."""
    pytest.importorskip("scipy")
    pytest.importorskip("gmsh")
    from lopin.remesh.driver import Runner

    report = Runner(stacked(lower, upper, cards), tmp_path, say=lambda line: None).run()
    assert len(report.remeshes) >= meshes
    assert report.verdict() == ("PASS", [])
    found = history(tmp_path, "stack")
    strain = np.log(9.0/(9.0 - 4.5*found["time"]))
    plastic = strain.copy()
    for _ in range(60):   # Kirchhoff's stress on the flow curve
        plastic = strain - np.interp(plastic, [0.0, 0.5, 2.0], [200.0, 300.0, 600.0])/70000.0
    expected = 70000.0*(strain - plastic)*np.pi*25.0*np.exp(strain)
    assert np.abs(-found["DIE.rf2"]/expected - 1.0).max() < 1e-6


@pytest.mark.parametrize("kind, pair", [(", TYPE=SURFACE TO SURFACE", "FOOT, SEAT"), ("", "SEAT, FOOT")])
def test_two_blocks_that_rub_are_both_made_anew(kind, pair, core, tmp_path):
    """On a floor that holds the lower one, with friction between them and on the die: the force is
    that of one mesh, by mortar and by nodes whose master is made anew too (it lost 6.6 % at a new
    mesh while its nodes were put on the chords between the slaves)."""
    pytest.importorskip("scipy")
    pytest.importorskip("gmsh")
    from lopin.remesh.driver import Runner

    def scene(cards, kind, pair):
        text = stacked(cards=cards, travel=-1.6, law="*VISCOPLASTIC, LAW=NORTON-HOFF\n300., .15").text()
        old = "*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE\nFOOT, SEAT"
        assert old in text
        text = text.replace(old, f"*FRICTION\n.2,\n*CONTACT PAIR, INTERACTION=I{kind}\n{pair}")
        return lopin.Deck.parse(text.replace("FLOOR, 2", "FLOOR, 1, 2"), name="stack")

    cards = "\n".join(f"{card}, SIZE=1., SMALLEST=.5" for card in BOTH.splitlines())
    report = Runner(scene(cards, kind, pair), tmp_path, say=lambda line: None).run()
    assert {r.reason.partition(":")[0] for r in report.remeshes} == {"TOP", "LOW"}
    assert max(j["of_largest"] for j in report.jumps()) < 0.01
    assert max(abs(r.moved["volume_change"]) for r in report.remeshes) < 1e-13
    found, one = history(tmp_path, "stack"), lopin.run(scene("", ", TYPE=SURFACE TO SURFACE", "FOOT, SEAT")).history
    expected = np.interp(found["time"], one["time"], one["DIE.rf2"])
    late = found["time"] > 0.1
    assert found["DIE.rf2"][late] == pytest.approx(expected[late], rel=0.04)


def on_anvil(card=""):
    """A quarter of a billet of C3D4 on a wider anvil of C3D8, pressed by a rigid ram; exact friction on both sides."""
    billet = mesh_make.simplices(mesh_make.block((5.0, 5.0, 5.0), (3, 3, 3)))
    anvil = mesh_make.block((8.0, 4.0, 8.0), (4, 2, 4), origin=(0.0, -4.0, 0.0))
    nodes, cards = [], []
    for name, first, word, mesh, side in (("B", 1, "C3D4", billet, "SKIN"), ("A", 1001, "C3D8", anvil, "SEAT")):
        x, cells = mesh.points, mesh.blocks[0][1]
        nodes += [f"{first + i}, {', '.join(map(repr, p))}" for i, p in enumerate(x.tolist())]
        cards += [f"*ELEMENT, TYPE={word}, ELSET={name}",
                  *(f"{first + i}, {', '.join(map(str, c))}" for i, c in enumerate((cells + first).tolist()))]
        for axis, held in ((0, 0.0), (2, 0.0), (1, -4.0)):
            cards += [f"*NSET, NSET={name}{axis + 1}", *(f"{first + n}," for n in np.flatnonzero(x[:, axis] == held))]
        cards += [f"*SURFACE, NAME={side}"]
        for e, f in mesh.boundary().tolist():
            corner = x[mesh.face_nodes(e, f)]
            if name == "B" and not (corner[:, [0, 2]] == 0.0).all(axis=0).any() or (corner[:, 1] == 0.0).all() and name == "A":
                cards += [f"{first + e}, S{f}"]
    text = "\n".join(["*NODE", *nodes, "9999, 0., 20., 0.", *(c for c in cards if c != "*NSET, NSET=B2")])
    return lopin.Deck.parse(text + f"""
*SURFACE, NAME=RAM, TYPE=CYLINDER
0., 0., 0., 1., 0., 0.
0., 0., 1.
START, 50., 5.
LINE, -50., 5.
*RIGID BODY, ANALYTICAL SURFACE=RAM, REF NODE=9999
*SOLID SECTION, ELSET=A, MATERIAL=STEEL
*SOLID SECTION, ELSET=B, MATERIAL=M
*MATERIAL, NAME=STEEL
*ELASTIC
210000., .3
*MATERIAL, NAME=M
*ELASTIC
70000., .3
{PLASTIC}
*SURFACE INTERACTION, NAME=I
*SURFACE BEHAVIOR, DIRECT
*FRICTION
.1,
*CONTACT PAIR, INTERACTION=I
SKIN, SEAT
SKIN, RAM
{card}*STEP, NLGEOM
*STATIC
.2, 1., , .2
*BOUNDARY
A1, 1
A2, 1, 3
A3, 3
B1, 1
B3, 3
9999, 1
9999, 3, 6
9999, 2, 2, -1.
*END STEP
""", name="anvil")


def test_a_billet_on_an_elastic_anvil_in_space_keeps_its_friction_over_new_meshes(core, tmp_path):
    """The force of one mesh of the same cells; the increment at rest settles in a few iterations."""
    pytest.importorskip("mmgpy")
    from lopin.remesh.driver import Runner

    card = "*REMESH, ELSET=B, SIZE=1.7, SMALLEST=1.2, PERIOD=.5, STRAIN=10.\n"
    report = Runner(on_anvil(card), tmp_path, say=lambda line: None).run()
    assert len(report.remeshes) == 1 and report.verdict()[0] != "FAIL"
    found, alone = history(tmp_path, "anvil"), lopin.run(on_anvil()).history
    assert found["iterations"][np.argmax(found["part"] == 2)] < 15
    assert found["RAM.rf2"][-1] == pytest.approx(alone["RAM.rf2"][-1], rel=0.03)
