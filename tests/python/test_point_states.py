"""The state of integration points goes out of an open run and into the start of another one.

The deformed mesh as its own new mesh is the identity: forces within 1e-8, nothing moves, nothing
flows, with friction too.
"""
import numpy as np
import pytest

import lopin

PLASTIC = "*PLASTIC\n200., 0.\n300., .5\n600., 2."
NORTON = "*VISCOPLASTIC, LAW=NORTON-HOFF\n300., .15"
WORDS = ["CAX4", "CAX3", "CPE4", "CPE3", "C3D8", "C3D4"]


def grid(word):
    """Nodes and elements of a block of 5 x 5 (x 4)."""
    n = 4 if word[0] == "C" and "3D" not in word else 3
    axes = [np.linspace(0.0, 5.0, n + 1)]*2 + ([np.linspace(0.0, 4.0, 3)] if "3D" in word else [])
    x = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, len(axes))
    number = np.arange(len(x)).reshape([len(a) for a in axes])
    cells = []
    if len(axes) == 2:
        for i in range(n):
            for j in range(n):
                q = [number[i, j], number[i + 1, j], number[i + 1, j + 1], number[i, j + 1]]
                cells += [q] if "4" in word else [q[:3], [q[0], q[2], q[3]]]
        return x, cells
    for i in range(n):
        for j in range(n):
            for k in range(2):
                low = [number[i, j, k], number[i + 1, j, k], number[i + 1, j + 1, k],
                       number[i, j + 1, k]]
                q = [*low, *(a + 1 for a in low)]
                cells += [q] if "8" in word else [
                    [q[a] for a in t] for t in ((0, 1, 3, 4), (1, 2, 3, 6), (1, 3, 4, 6),
                                                (1, 4, 5, 6), (3, 4, 6, 7))]
    return x, cells


def deck(word, x, cells, level, travel, start="", end="", *, law=PLASTIC, mu=0.1, time=1.0,
         increments=4, young=70000.0):
    """A block on a floor that holds it, pressed by a plane tool at `level`."""
    d = x.shape[1]

    def label(rows):
        return "\n".join(str(i + 1) for i in rows)

    nodes = "".join(f"{i + 1}, {', '.join(map(repr, p))}\n" for i, p in enumerate(x.tolist()))
    conn = "".join(f"{i + 1}, {', '.join(str(a + 1) for a in c)}\n" for i, c in enumerate(cells))
    floor = np.flatnonzero(np.abs(x[:, 1]) < 1e-9)
    axis = np.flatnonzero(np.abs(x[:, 0]) < 1e-9)
    back = np.flatnonzero(np.abs(x[:, -1]) < 1e-9)
    tool = f"*SURFACE, NAME=DIE, TYPE=SEGMENTS\nSTART, 50., {level!r}\nLINE, -50., {level!r}" \
        if d == 2 else "*SURFACE, NAME=DIE, TYPE=CYLINDER\n0., 0., 0., 1., 0., 0.\n0., 0., 1.\n" \
        f"START, 50., {level!r}\nLINE, -50., {level!r}"
    return lopin.Deck.parse(f"""*NODE, NSET=ALL
{nodes}*ELEMENT, TYPE={word}, ELSET=B
{conn}*NSET, NSET=FLOOR
{label(floor)}
*NSET, NSET=AXIS
{label(axis)}
*NSET, NSET=BACK
{label(back)}
*NODE, NSET=R
9999, 0., 20.
*SURFACE, NAME=SKIN
B,
{tool}
*RIGID BODY, ANALYTICAL SURFACE=DIE, REF NODE=9999
*SOLID SECTION, ELSET=B, MATERIAL=M
*MATERIAL, NAME=M
*ELASTIC
{young!r}, .3
{law}
{start}*SURFACE INTERACTION, NAME=I
*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD
*FRICTION
{mu}
*CONTACT PAIR, INTERACTION=I
SKIN, DIE
{end}*STEP, NLGEOM
*STATIC
{time/increments!r}, {time!r}, , {time/increments!r}
*BOUNDARY
FLOOR, 1, 2
AXIS, 1
{"BACK, 3" if d == 3 else "** plane"}
9999, 1, {6 if d == 2 else 1}
{"9999, 3, 6" if d == 3 else "** plane"}
9999, 2, 2, {travel!r}
*END STEP
""".replace("9999, 1, 6", "9999, 1\n9999, 6"), name=word.lower())


def last_state(scene):
    """The last frame of a run, with what its points and slave nodes hold."""
    with lopin.open(scene) as job:
        for frame in job:
            found = frame, job.points, job.tractions
    return found


def on_itself(word, **options):
    """Force of the tool before and after, and what one increment at rest moved and made flow."""
    x, cells = grid(word)
    frame, points, tractions = last_state(deck(word, x, cells, 5.0, -1.0, **options))
    moved = x + np.asarray(frame["displacement"])[:len(x), :x.shape[1]]
    moved[np.abs(x) < 1e-12] = 0.0
    start = "*INITIAL CONDITIONS, TYPE=STATE\n" + points.lines()
    end = "*INITIAL CONDITIONS, TYPE=TRACTION\n" + tractions.lines([("SKIN", "DIE")])
    rest, after, _ = last_state(deck(word, moved, cells, 4.0, 0.0, start, end,
                                     **{**options, "time": 1e-9, "increments": 1}))
    force = [np.asarray(f["reaction"])[-1] for f in (frame, rest)]
    return force, np.abs(rest["displacement"]).max(), np.max(after.plastic - points.plastic), rest


@pytest.mark.parametrize("word", WORDS)
def test_a_mesh_handed_to_itself_is_the_identity(word, core):
    (before, after), moved, flowed, _ = on_itself(word)
    assert np.abs(before).max() > 100.0
    assert np.abs(after - before).max() < 1e-8*np.abs(before).max()
    assert moved < 1e-9 and abs(flowed) < 1e-9


@pytest.mark.parametrize("mu", ["0.2, 300.", "0.2, 3000."])
def test_friction_with_a_stick_slope_goes_on_where_it_was(mu, core):
    """Slip of the elastic part is carried with the traction, not begun anew."""
    (before, after), moved, _, _ = on_itself("CAX4", mu=mu)
    assert np.abs(after - before).max() < 1e-4*np.abs(before).max() and moved < 1e-5


def test_energies_balance_from_a_start_that_holds_some(core):
    """What is stored at the start is no work that got lost: a stress that is held, and a state."""
    text = """*NODE
1, 0., 0.
2, 1., 0.
3, 1., 1.
4, 0., 1.
*ELEMENT, TYPE=CPE4, ELSET=B
1, 1, 2, 3, 4
*SOLID SECTION, ELSET=B, MATERIAL=M
*MATERIAL, NAME=M
*ELASTIC
1000., .3
*INITIAL CONDITIONS, TYPE=STRESS
B, -10., -12., -10.
*STEP{0}
*STATIC
.1, 1.
*BOUNDARY
1, 1, 2
2, 1, 2
3, 2
4, 1, 2
3, 1, 1, -.01
*END STEP
"""
    for nlgeom in ("", ", NLGEOM"):
        result = lopin.run(lopin.Deck.parse(text.format(nlgeom), name="s"))
        assert not [d for d in result.diagnostics if d["code"] == "W0530"]
    x, cells = grid("CAX4")
    frame, points, _ = last_state(deck("CAX4", x, cells, 5.0, -1.0, mu=0.0))
    moved = x + np.asarray(frame["displacement"])[:len(x), :2]
    start = "*INITIAL CONDITIONS, TYPE=STATE\n" + points.lines()
    result = lopin.run(deck("CAX4", moved, cells, 4.0, 0.0, start, mu=0.0))
    assert not [d for d in result.diagnostics if d["code"] == "W0530"]


def test_the_identity_holds_for_soft_and_for_viscous_metal(core):
    """Where the volume changes by a tenth, and where stress depends on the rate (no time passes)."""
    for options in ({"young": 2000.0}, {"law": NORTON}):
        (before, after), moved, _, _ = on_itself("CAX4", **options)
        bound = 1e-8 if "young" in options else 1e-3
        assert np.abs(after - before).max() < bound*np.abs(before).max()


def test_points_know_their_place_and_volume(core):
    x, cells = grid("CAX4")
    frame, points, _ = last_state(deck("CAX4", x, cells, 5.0, -1.0))
    assert points.volume.sum() == pytest.approx(np.pi*25.0*5.0, rel=5e-3)
    assert points.place[:, 1].max() < 4.0 and points.place[:, 2].max() == 0.0
    assert np.abs(points.strain[:, :3].sum(1)).max() < 1e-14
    assert points.plastic.max() > 0.2 and (points.work > 0.0).any()


def test_hardening_of_an_operation_before_is_where_the_curve_goes_on(core):
    """A block without friction yields at the flow stress of its plastic strain."""
    x, cells = grid("CPE4")
    law = "*PLASTIC\n200., 0.\n400., 1."
    stress = []
    for start in ("", "*INITIAL CONDITIONS, TYPE=HARDENING\nB, 0.5\n"):
        scene = deck("CPE4", x, cells, 5.0, -0.04, start, law=law, mu=0.0, increments=8)
        text = scene.text().replace("FLOOR, 1, 2", "FLOOR, 2")
        frame, points, _ = last_state(lopin.Deck.parse(text, name="h"))
        # Flow stress is Kirchhoff's: Cauchy's times the change of volume.
        stress.append(np.asarray(frame["Mises"])[:len(x)].mean()*np.exp(points.ratio.mean()))
        plastic = points.plastic.mean() - (0.5 if start else 0.0)
        assert stress[-1] == pytest.approx(200.0*(1.0 + plastic) + (100.0 if start else 0.0),
                                           rel=1e-6)
    assert stress[1] > stress[0] + 90.0


def test_modes_that_begin_anew_are_told(core):
    x, cells = grid("CAX4I")
    start = "*INITIAL CONDITIONS, TYPE=STATE\nB, 0, 0., 0., 0., 0., 0., 0., 0.\n"
    said = lopin.run(deck("CAX4I", x, cells, 5.0, -0.01, start)).diagnostics
    assert any(d["code"] == "W0210" for d in said)
    said = lopin.run(deck("CAX4", x, cells, 5.0, -0.01, start)).diagnostics
    assert not any(d["code"] == "W0210" for d in said)


@pytest.mark.parametrize("line, change, code", [
    ("1, 9, 0., 0., 0., 0., 0., 0., 0.", {}, "E0210"),
    ("1, 1, 0., 0., 0., 0., 0., 0., 0.", {"law": "*PLASTIC, HARDENING=KINEMATIC\n200., 0.\n300., 1."}, "E0210"),
    ("1, 1, 0., 0., 0.", {}, "E0103"),
    ("1, 1, 0., 0., 0., 0., 0., 0., 0., 0., -.1", {}, "E0106"),
    ("1, one, 0., 0., 0., 0., 0., 0., 0.", {}, "E010"),
    ("77, 1, 0., 0., 0., 0., 0., 0., 0.", {}, "E0"),
])
def test_states_that_do_not_fit_are_refused(line, change, code, core):
    x, cells = grid("CAX4")
    start = f"*INITIAL CONDITIONS, TYPE=STATE\n{line}\n"
    with pytest.raises(lopin.LopinError) as caught:
        last_state(deck("CAX4", x, cells, 5.0, -0.1, start, **{"law": PLASTIC, **change}))
    assert code in str(caught.value)


def test_a_state_belongs_to_finite_strain(core):
    x, cells = grid("CAX4")
    start = "*INITIAL CONDITIONS, TYPE=STATE\n1, 1, 0., 0., 0., 0., 0., 0., 0.\n"
    scene = deck("CAX4", x, cells, 5.0, -0.1, start)
    with pytest.raises(lopin.LopinError, match="E0210"):
        last_state(lopin.Deck.parse(scene.text().replace("*STEP, NLGEOM", "*STEP"), name="s"))
