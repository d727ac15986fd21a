"""A fold closes, bears and slips while its mesh is made anew."""
import shutil

import numpy as np
import pytest
from test_point_states import NORTON, PLASTIC
from test_remeshing import block, history, run, same

import lopin
from lopin import mesh_make
from lopin.remesh.fold import close_fold, deepest_inside, drawn_apart, opposite

FLAT = 0.35


def oval(word="CPE4", card="PERIOD=.3, STRAIN=10., SIZE=.8, SMALLEST=.3", law=NORTON, mu=0.1,
         right=0.0, travel=3.0, pair="INNER, INNER", more="", increments=20):
    """Half of a flat ring crushed between plates until its inside meets itself; `right`: how far
    it stands from the axis, as a hollow seal."""
    mesh = mesh_make.ring(4.0, 5.0, (3, 20), angles=(-90.0, 90.0))
    x = mesh.points*[1.0, FLAT] + [right, 0.0]
    cells, sides = (mesh.blocks[0][1] + 1).tolist(), [f"{e + 1}, S{f}" for e, f in
                                                     mesh.surfaces["INNER"].tolist()]
    if word[3] == "3":
        cells = [t for q in cells for t in (q[:3], [q[0], *q[2:]])]
        sides = [f"{2*e + 2}, S3" for e, _ in mesh.surfaces["INNER"].tolist()]
    nodes = "\n".join(f"{k}, {p[0]!r}, {p[1]!r}" for k, p in enumerate(x.tolist(), 1))
    elements = "\n".join(f"{k}, {', '.join(map(str, c))}" for k, c in enumerate(cells, 1))
    cut = "\n".join(f"{k + 1}," for k in np.flatnonzero(np.abs(x[:, 0] - right) < 1e-9))
    cards = f"*REMESH, ELSET=B, {card}\n" if card else ""
    return lopin.Deck.parse(f"""*NODE
{nodes}
9998, 0., -9.
9999, 0., 9.
*ELEMENT, TYPE={word}, ELSET=B
{elements}
*NSET, NSET=CUT
{cut}
*SURFACE, NAME=SKIN
B,
*SURFACE, NAME=INNER
{chr(10).join(sides)}
*SURFACE, NAME=FLOOR, TYPE=SEGMENTS
START, -90., {-5.0*FLAT}
LINE, 90., {-5.0*FLAT}
*RIGID BODY, ANALYTICAL SURFACE=FLOOR, REF NODE=9998
*SURFACE, NAME=PRESS, TYPE=SEGMENTS
START, 90., {5.0*FLAT}
LINE, -90., {5.0*FLAT}
*RIGID BODY, ANALYTICAL SURFACE=PRESS, REF NODE=9999
*SOLID SECTION, ELSET=B, MATERIAL=M
*MATERIAL, NAME=M
*ELASTIC
70000., .3
{law}
*SURFACE INTERACTION, NAME=I
*SURFACE BEHAVIOR, DIRECT
*FRICTION
{mu},
*CONTACT PAIR, INTERACTION=I
SKIN, FLOOR
SKIN, PRESS
*CONTACT PAIR, INTERACTION=I
{pair}
{more}{cards}*STEP, NLGEOM, INC=500
*STATIC
{1.0/increments!r}, 1., 1e-6, {1.0/increments!r}
*BOUNDARY
CUT, 1
9998, 1, 2
9998, 6
9999, 1
9999, 6
9999, 2, 2, {-travel!r}
*OUTPUT, FIELD, FREQUENCY=1000
*NODE OUTPUT
U
*END STEP
""", name="oval")


@pytest.mark.parametrize("word, right, law, period", [("CPE4", 0.0, NORTON, 0.3),
                                                      ("CAX4", 5.0, NORTON, 0.2)])
def test_a_fold_closes_over_new_meshes(word, right, law, period, core, tmp_path):
    """The force once it is closed is that of one mesh (it doubles within 2 % of the way there); no
    node enters the other side; volume."""
    scene = oval(word, f"PERIOD={period}, STRAIN=10., SIZE=.8, SMALLEST=.3", right=right, law=law)
    report = run(scene, tmp_path/"whole")
    folded = [r for r in report.remeshes if r.moved.get("folded", 0) > 10]
    assert len(report.remeshes) >= 4 and folded
    assert max(abs(r.moved["volume_change"]) for r in report.remeshes) < 1e-13
    assert max(r.moved["fold_depth"] for r in folded) < 0.1
    assert "nodes of a fold meet" in folded[-1].line()
    found = history(tmp_path/"whole", "oval")
    assert found["INNER-INNER.closed"][-1] > 10
    assert found["INNER-INNER.max_penetration"].max() < 1e-9
    one = lopin.run(oval(word, card="", right=right, law=law)).history
    late = found["time"] > 0.97
    expected = np.interp(found["time"][late], one["time"], one["PRESS.rf2"])
    assert found["PRESS.rf2"][late] == pytest.approx(expected, rel=0.08)
    if word != "CPE4":
        return
    # What is behind the last remesh, made again: by --resume, to the same bits.
    shutil.copytree(tmp_path/"whole", tmp_path/"again")
    for path in (tmp_path/"again").glob(f"{report.parts[-1]}*"):
        path.unlink()
    run(scene, tmp_path/"again", resume=True)
    same(tmp_path/"whole", tmp_path/"again")


def test_the_sides_of_a_fold_are_put_on_each_other_and_drawn_apart_for_a_mesher():
    """A slot along x, its lower side pressed: it lies on the upper one, whose nodes stay."""
    low = [[x, 0.3*x*0.01] for x in (0.0, 1.0, 2.0, 3.0)]
    high = [[x, 0.004] for x in (2.5, 1.5, 0.5)]
    x = np.array(low + high)
    edges = np.array([[3, 2], [2, 1], [1, 0], [6, 5], [5, 4]])
    pressed, size = np.arange(7) < 4, np.ones(7)
    free = [np.empty((0, 2))]*7
    fold = close_fold(x, edges, pressed, size, free)
    assert fold.x[1:3, 1] == pytest.approx([0.004, 0.004], abs=1e-15)
    assert (fold.x[4:] == x[4:]).all() and fold.met[[1, 2, 4, 5, 6]].all()
    assert fold.seated.tolist() == [False, True, True, False, False, False, False]
    assert fold.farthest == pytest.approx(0.002)
    held = [np.array([[0.0, 1.0]])]*7
    assert (close_fold(x, edges, pressed, size, held).x == x).all()
    # A chord of the lower side passes a node of the upper one.
    assert deepest_inside(fold.x, edges, size) == pytest.approx(0.0025, rel=1e-3)
    assert deepest_inside(x + [[0.0, 0.1*(k == 1)] for k in range(7)], edges, size) > 0.09
    # A wall is no fold: the other face is behind, far.
    assert opposite(np.array([[0.0, 0.5], [1.0, 0.5], [0.4, 0.0], [0.6, 0.0]]),
                    np.array([[1, 0], [2, 3]]), 2, 1.0)[0] == -1
    normals = np.array([[0.0, 1.0]]*4 + [[0.0, -1.0]]*3)
    apart = drawn_apart(fold.x, edges, normals, size, free)
    assert (apart[4:6, 1] - apart[1:3, 1]).min() > 0.09


@pytest.mark.parametrize("level", [0.0, 1e-15, -1e-15, -1e-4])
def test_a_surface_may_begin_with_its_fold_closed(level, core):
    """Two arms lie on each other at the start, or a little inside: the side opposite is no wall,
    however near; pressed evenly they bear as one block does."""
    nodes, cells = [], []
    for i in range(5):
        for j, y in enumerate((0.0, 0.5, 1.0, 1.0 + level, 1.5, 2.0)):
            nodes.append(f"{6*i + j + 1}, {float(i)}, {y!r}")
    for i in range(4):
        cells += [[6*i + j, 6*i + j + 6, 6*i + j + 7, 6*i + j + 1] for j in (1, 2, 4, 5)]
    text = f"""*NODE
{chr(10).join(nodes)}
9999, 0., 9.
*ELEMENT, TYPE=CPE4, ELSET=B
{chr(10).join(f"{k}, {', '.join(map(str, c))}" for k, c in enumerate(cells, 1))}
*NSET, NSET=LOW
{chr(10).join(f"{6*i + 1}," for i in range(5))}
*NSET, NSET=TOP
{chr(10).join(f"{6*i + 6}," for i in range(5))}
*NSET, NSET=SIDE
1, 2, 3, 4, 5, 6
*SURFACE, NAME=SKIN
B,
*SOLID SECTION, ELSET=B, MATERIAL=M
*MATERIAL, NAME=M
*ELASTIC
1000., 0.
*SURFACE INTERACTION, NAME=I
*SURFACE BEHAVIOR, DIRECT
*CONTACT PAIR, INTERACTION=I
SKIN, SKIN
*STEP, NLGEOM
*STATIC
.5, 1.
*BOUNDARY
SIDE, 1
LOW, 2
TOP, 2, 2, -.1
*NODE PRINT, NSET=TOP, TOTALS=ONLY
RF
*END STEP
"""
    result = lopin.run(lopin.Deck.parse(text, name="closed"))
    assert result.summary["certificate"]["verdict"] == "PASS"
    u = result["U"][:, 1]
    assert u[2::6] == pytest.approx(-0.05, abs=2e-4)
    assert u[2::6] == pytest.approx(u[3::6] + level, abs=1e-9)


@pytest.mark.parametrize("change, why", [
    (("*ELASTIC", "*DAMAGE, CRITERION=OYANE, CRITICAL=1.\n3.9\n*ELASTIC"), "separates"),
    (("INNER, INNER\n", "INNER,\n"), "")])
def test_what_a_fold_cannot_take_is_refused_by_name(change, why, core, tmp_path):
    text = oval(travel=0.1, card="PERIOD=.5, STRAIN=10.").text()
    assert change[0] in text
    scene = lopin.Deck.parse(text.replace(*change), name="oval")
    if why:
        with pytest.raises(lopin.LopinError, match=f"E0621.*{why}"):
            run(scene, tmp_path)
    else:   # one name is both
        assert len(run(scene, tmp_path).remeshes) == 1


def test_a_fold_in_space_is_refused(core, tmp_path):
    pytest.importorskip("mmgpy")
    text = block("C3D4").text().replace("SKIN, DIE\n", "SKIN, DIE\nSKIN, SKIN\n")
    with pytest.raises(lopin.LopinError, match="E0621.*in space"):
        run(lopin.Deck.parse(text, name="block"), tmp_path)
