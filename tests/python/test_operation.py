"""Chains of operations: state carried on, metal trimmed off, forces and volumes by closed forms."""
import numpy as np
import pytest
from test_point_states import PLASTIC, deck

import lopin
from lopin import mesh_make
from lopin.errors import ModelError
from lopin.operation import beyond_plane, measures, next_operation, signed_plane
from lopin.remesh.body import boundary_facets
from lopin.remesh.clip import clip, facets_of
from lopin.same_mesh import next_on_same_mesh

pytest.importorskip("scipy")

SECOND = """*NODE, NSET=Q
8888, 0., 30.
*SURFACE, NAME=PUNCH, TYPE=SEGMENTS
START, 60., {level!r}
LINE, -60., {level!r}
*RIGID BODY, ANALYTICAL SURFACE=PUNCH, REF NODE=Q
*SURFACE INTERACTION, NAME=DRY
*SURFACE BEHAVIOR, DIRECT
*CONTACT PAIR, INTERACTION=DRY
SKIN, PUNCH
*BOUNDARY
FLOOR, 2
AXIS, 1
Q, 1
Q, 6
*STEP, NLGEOM
*STATIC
.1, 1., , .1
*BOUNDARY
Q, 2, 2, {travel!r}
*END STEP
"""
FREE = """*BOUNDARY
FLOOR, 2
AXIS, 1
*STEP, NLGEOM
*STATIC
1., 1.
*END STEP
"""


def disc(mu=0.0, travel=-1.0, cells=(10, 10)):
    """A disc of 5 x 5 pressed on a floor by the tool DIE."""
    mesh = mesh_make.block((5.0, 5.0), cells)
    scene = deck("CAX4", mesh.points, mesh.blocks[0][1].tolist(), 5.0, travel, mu=mu, increments=10)
    return scene if mu else lopin.Deck.parse(scene.text().replace("FLOOR, 1, 2", "FLOOR, 2"),
                                             name="disc")


def after(scene, cards, **options):
    """The deck of the next operation from the end of a run, and the last frame's history."""
    with lopin.open(scene) as job:
        for frame in job:
            found = next_operation(job, "B", cards, name="second", **options)
            history = frame.result.history
    return *found, history


def stress(strain):
    """Of homogeneous compression, by volume of the start: the curve of PLASTIC."""
    plastic = strain
    for _ in range(60):
        plastic = strain - np.interp(plastic, [0.0, 0.5, 2.0], [200.0, 300.0, 600.0])/70000.0
    return 70000.0*(strain - plastic)


def test_two_operations_press_as_one_does(core):
    second, carried, _ = after(disc(), SECOND.format(level=4.0, travel=-1.0))
    assert carried.gone == 0 and "DIE" not in second.text()
    found = lopin.run(second).history
    strain = np.log(5.0/(4.0 - found["time"]))
    area = np.pi*25.0*5.0/(4.0 - found["time"])
    assert -found["PUNCH.rf2"] == pytest.approx(stress(strain)*area, rel=1e-6)
    one = lopin.run(disc(travel=-2.0)).history
    assert found["PUNCH.rf2"][-1] == pytest.approx(one["DIE.rf2"][-1], rel=1e-6)


@pytest.mark.parametrize("radius", [4.0, 2.5])
def test_a_trimmed_disc_bears_by_the_area_that_is_left(core, radius):
    """Trimmed between cells at a share of its radius: volume and force by the square of it."""
    def rim(places):
        return places[:, 0] > radius/5.0*places[:, 0].max()*10.0/9.5

    whole, _, _ = after(disc(), SECOND.format(level=4.0, travel=-0.8))
    cut, carried, _ = after(disc(), SECOND.format(level=4.0, travel=-0.8), trim=rim)
    share = (radius/5.0)**2
    assert carried.volume/(carried.volume + carried.gone_volume) == pytest.approx(share, rel=1e-6)
    full, left = (lopin.run(scene).history["PUNCH.rf2"] for scene in (whole, cut))
    assert left == pytest.approx(share*full, rel=1e-6)


def test_what_the_flash_held_is_let_go_of_and_nothing_flows(core):
    """A disc that was pressed with friction, trimmed by a plane, without tools: forces vanish."""
    scene = disc(mu=0.1, travel=-1.0)
    second, carried, _ = after(scene, FREE, trim=beyond_plane((4.5, 0.0), (1.0, 0.0)))
    assert 0 < carried.gone < 100
    with lopin.open(second) as job:
        frame = job.advance()
        plastic = job.points.plastic
    floor = np.asarray(frame["reaction"])[:, 1]
    assert abs(floor.sum()) < 1e-8*np.abs(floor).max()
    before = [float(row[10]) for row in
              next(b for b in second.blocks if b.keyword == "INITIAL CONDITIONS").data]
    assert (plastic - before).max() < 0.01


def test_a_cut_that_leaves_nothing_is_refused(core):
    with pytest.raises(ModelError, match="takes all"):
        after(disc(), FREE, trim=lambda places: places[:, 0] > -1.0)


def test_blocks_of_tetrahedra_go_on_too(core):
    mesh = mesh_make.simplices(mesh_make.block((4.0, 5.0, 4.0), (3, 3, 3)))
    scene = deck("C3D4", mesh.points, mesh.blocks[0][1].tolist(), 5.0, -1.0, mu=0.0)
    scene = lopin.Deck.parse(scene.text().replace("FLOOR, 1, 2", "FLOOR, 2"), name="block")
    second, carried, history = after(scene, FREE.replace("AXIS, 1", "AXIS, 1\nBACK, 3"))
    assert carried.volume == pytest.approx(history["volume"][-1], rel=1e-9)
    free = lopin.run(second)
    assert np.abs(free["stress"]).max() < 0.01*stress(np.log(5.0/4.0))


@pytest.mark.parametrize("radius", [0.83, 0.5])
@pytest.mark.parametrize("simple", [False, True])
def test_a_disc_divided_along_its_cut_bears_by_the_area_that_is_left(core, radius, simple):
    """Between nodes too: volume by the square of the radius to rounding, force as well."""
    mesh = mesh_make.block((5.0, 5.0), (10, 10))
    if simple:
        mesh = mesh_make.simplices(mesh)
    scene = deck("CAX3" if simple else "CAX4", mesh.points, mesh.blocks[0][1].tolist(), 5.0, -1.0,
                 mu=0.0, increments=10)
    scene = lopin.Deck.parse(scene.text().replace("FLOOR, 1, 2", "FLOOR, 2"), name="disc")
    cards = SECOND.format(level=4.0, travel=-0.8)
    whole, _, history = after(scene, cards)
    rim = 5.0*np.sqrt(history["volume"][-1]/(np.pi*125.0)*5.0/4.0)
    cut, carried, _ = after(scene, cards, cut=signed_plane((radius*rim, 0.0), (1.0, 0.0)))
    assert carried.volume + carried.gone_volume == pytest.approx(history["volume"][-1], rel=1e-9)
    assert carried.volume/history["volume"][-1] == pytest.approx(radius**2, rel=1e-6)
    full, left = (lopin.run(scene).history for scene in (whole, cut))
    assert left["PUNCH.rf2"] == pytest.approx(radius**2*full["PUNCH.rf2"], rel=1e-5)


def test_tetrahedra_are_divided_along_a_plane_askew(core):
    """A block of tetrahedra: volumes by Cavalieri, and what is left takes its load."""
    mesh = mesh_make.simplices(mesh_make.block((4.0, 5.0, 4.0), (3, 3, 3)))
    scene = deck("C3D4", mesh.points, mesh.blocks[0][1].tolist(), 5.0, -1.0, mu=0.0)
    scene = lopin.Deck.parse(scene.text().replace("FLOOR, 1, 2", "FLOOR, 2"), name="block")
    cards = FREE.replace("AXIS, 1", "AXIS, 1\nBACK, 3")
    plane = signed_plane((3.1, 0.0, 0.0), (1.0, 0.0, 0.3))
    second, carried, history = after(scene, cards, cut=plane)
    with lopin.open(scene) as job:
        wide = max(np.asarray(frame["displacement"])[:, 0].max() for frame in job)
    width = 4.0 + wide
    share = (3.1 - 0.15*width)/width        # at the middle of its depth, as wide as the block
    assert carried.volume/history["volume"][-1] == pytest.approx(share, rel=1e-6)
    with lopin.open(second) as job:
        job.advance()


def test_divided_cells_keep_volume_skin_and_names():
    mesh = mesh_make.simplices(mesh_make.block((1.0, 1.0, 1.0), (4, 4, 4)))
    x, cells = mesh.points, np.asarray(mesh.blocks[0][1])

    def ball(places):
        return np.linalg.norm(places - 0.1, axis=1) - 0.731

    facets, _ = boundary_facets([cells], 3)
    tags = [frozenset({("N", f"{d}{side}") for d in range(3) for side in (0.0, 1.0)
                       if (x[f][:, d] == side).all()}) for f in facets]
    parts = clip(x, [cells], ball)
    size = measures(parts.x, parts.cells[0], False)
    assert size.sum() == pytest.approx(1.0, abs=1e-14) and size.min() > 0.0
    corners = parts.x[parts.cells[0]]
    assert (np.linalg.det(corners[:, 1:] - corners[:, :1]) > 0.0).all()
    on = parts.ends[:, 0] != parts.ends[:, 1]
    assert np.abs(ball(parts.x[on])).max() < 1e-12
    skin, names = facets_of(parts, facets, tags, 3)
    assert len(skin) > len(facets)
    for facet, name in zip(skin, names):
        (_, label), = name
        assert parts.x[facet][:, int(label[0])] == pytest.approx(float(label[1:]), abs=1e-15)
    own, neighbour = np.unique(np.sort(np.vstack([parts.cells[0][:, list(f)] for f in
                               ((0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3))]), axis=1), axis=0,
                               return_counts=True)
    assert neighbour.max() == 2 and (neighbour == 1).sum() == len(skin)


def test_a_cut_and_a_trim_are_refused_together(core):
    plane = signed_plane((4.5, 0.0), (1.0, 0.0))
    with pytest.raises(ModelError, match="both"):
        after(disc(), FREE, trim=beyond_plane((4.5, 0.0), (1.0, 0.0)), cut=plane)


LAWS = {"rate": "*RATE DEPENDENT\n40., 5.", "controls": "", "axes": "", "heat": ""}
HEAT = "*PLASTIC\n200., 0., 20.\n600., 2., 20.\n100., 0., 500.\n300., 2., 500."


def materials_deck(case, travel, period=1.0):
    """A disc of a material with a card more, without friction."""
    text = disc(travel=travel).text()
    section = next(line for line in text.splitlines() if line.startswith("*SOLID SECTION"))
    text = text.replace(PLASTIC, f"{PLASTIC}\n{LAWS[case]}".rstrip())
    beside = {"controls": ("CONTROLS", "*SECTION CONTROLS, NAME=Plain, FORMULATION=FULL\n"),
              "axes": ("ORIENTATION", "*ORIENTATION, NAME=Plain\n0., 1., 0., -1., 0., 0.\n")}
    if case in beside:
        word, cards = beside[case]
        text = text.replace(section, f"{section}, {word}=PLAIN").replace("*MATERIAL",
                                                                         cards + "*MATERIAL")
    if case == "heat":
        text = text.replace(PLASTIC, HEAT).replace(
            "*STEP", "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nALL, 400.\n*STEP")
    steps = f"{0.1*period!r}, {period!r}, , {0.1*period!r}"
    return lopin.Deck.parse(text.replace("0.1, 1.0, , 0.1", steps), name="disc")


@pytest.mark.parametrize("case", LAWS)
def test_all_of_the_material_goes_along(core, case):
    """Pressed by 1 and by 1 again as by 2 at once, whatever cards the material and section have."""
    second, _, _ = after(materials_deck(case, -1.0), SECOND.format(level=4.0, travel=-1.0))
    one = lopin.run(materials_deck(case, -2.0, period=2.0)).history["DIE.rf2"][-1]
    found = lopin.run(second).history["PUNCH.rf2"][-1]
    assert found == pytest.approx(one, rel=2e-3 if case == "rate" else 1e-6)


def test_temperatures_go_along_a_cut(core):
    """A temperature that grows with the radius of the start is met at the new nodes, too."""
    text = materials_deck("heat", -1.0).text()
    warm = "\n".join(f"{n + 1}, {100.0 + 40.0*x!r}" for n, (x, _) in
                     enumerate(mesh_make.block((5.0, 5.0), (10, 10)).points.tolist()))
    scene = lopin.Deck.parse(text.replace("ALL, 400.", warm), name="disc")
    rim = 3.3*np.sqrt(5.0/4.0)
    second, _, _ = after(scene, FREE, cut=signed_plane((rim, 0.0), (1.0, 0.0)))
    table = next(b for b in second.blocks if b.keyword == "INITIAL CONDITIONS")
    given = dict(table.data)
    wide = max(row[1] for row in second["NODE"].data)
    for label, r, _ in second["NODE"].data:
        assert given[label] == pytest.approx(100.0 + 40.0*5.0*r/(5.0*np.sqrt(5.0/4.0)), abs=0.5)
    assert wide == pytest.approx(rim, rel=1e-9)
    heated = lopin.Deck.parse(text.replace("*STATIC", "*TEMPERATURE\nALL, 300.\n*STATIC"), name="h")
    with pytest.raises(ModelError, match="TEMPERATURE: heat"):
        after(heated, FREE)


def test_what_cannot_go_along_is_told_by_its_card(core):
    text = disc(travel=-0.1).text().replace(PLASTIC,
                                            f"{PLASTIC}\n*POTENTIAL\n1., 1., 1.2, 1., 1., 1.")
    with pytest.raises(ModelError, match="POTENTIAL: Hill"):
        after(lopin.Deck.parse(text, name="hill"), FREE)
    with lopin.open(disc(travel=-0.1)) as job:
        for _ in job:
            pass
        for call in (next_operation, next_on_same_mesh):
            with pytest.raises(lopin.UsageError, match="(?s)has ended.*inside the loop"):
                call(job, "B", FREE, name="late")


@pytest.mark.parametrize("point, normal", [((1.0, 0.0), (0.0, 0.0)), ((1.0, np.nan), (1.0, 0.0)),
                                           ((1.0, 0.0), (np.inf, 0.0)), ((1.0, 0.0), (np.nan, 1.0)),
                                           ((1.0, 0.0), (1.0, 0.0, 0.0)), (1.0, 2.0),
                                           ((1.0,), (1.0,))])
@pytest.mark.parametrize("plane", [beyond_plane, signed_plane])
def test_what_is_no_plane_is_refused(plane, point, normal):
    with pytest.raises(lopin.UsageError, match="no plane goes through"):
        plane(point, normal)
    with pytest.raises(lopin.UsageError, match="2 coordinates, the body 3"):
        plane((1.0, 0.0), (1.0, 0.0))(np.zeros((4, 3)))


@pytest.mark.parametrize("options, message", [
    ({"cut": lambda x: np.full(len(x), np.nan)}, "what is no number"),
    ({"cut": lambda x: x[:, 0] > 2.0}, "(?s)what is no number.*is a trim"),
    ({"cut": lambda x: np.array(["a"]*len(x))}, "what is no number"),
    ({"cut": lambda x: x}, "cut gives a table of shape"),
    ({"cut": lambda x: 1.0}, "cut gives a table of shape"),
    ({"cut": lambda x: np.ones(len(x) + 1)}, "cut gives a table of shape"),
    ({"cut": 3.0}, "cut is a function of places"),
    ({"trim": lambda x: x[:, 0] - 2.0}, "(?s)True or False.*are a cut"),
    ({"trim": lambda x: np.full(len(x), np.nan)}, "True or False"),
    ({"trim": lambda x: np.array(["a"]*len(x))}, "True or False"),
    ({"trim": lambda x: x > 2.0}, "trim gives a table of shape"),
    ({"trim": lambda x: True}, "trim gives a table of shape"),
    ({"trim": "LEFT"}, "trim is a function of places"),
    ({"trim": signed_plane((4.0, 0.0), (1.0, 0.0))}, "cut=... divides")])
def test_what_is_no_cut_is_refused_by_what_it_gives(core, options, message):
    """Each names the kind that was meant; a job goes on after it."""
    with lopin.open(disc(cells=(2, 2))) as job:
        job.advance()
        with pytest.raises(lopin.UsageError, match=message):
            next_operation(job, "B", FREE, name="second", **options)
        if "trim" in options:
            with pytest.raises(lopin.UsageError, match=message):
                next_on_same_mesh(job, "B", FREE, name="second", **options)
        assert next_operation(job, "B", FREE, name="second",
                              trim=lambda x: (x[:, 0] > 2.5).astype(int))[1].gone == 2
