"""The package as a whole: decks, models, laws, references, command line."""
import doctest
import importlib
import pkgutil
import subprocess
import sys

import numpy as np
import pytest

import lopin
from lopin import _bridge, mesh_make, profile, reference
from lopin.charts import run as chart_run
from lopin.__main__ import main
from lopin.mesh.cells import CELLS
from lopin.errors import error_of
from lopin.run import find_executable

MODULES = [m.name.removeprefix("lopin.") for m in pkgutil.walk_packages(lopin.__path__, "lopin.")
           if "_core" not in m.name and not m.name.endswith("__main__")]

DECK = """** A bar, by hand.
*HEADING
Bar, 1.5, with a comma
*NODE, NSET=ALL
 1, 0., 0.
2,1.0D0,,
** a comment inside
*ELEMENT ,
 TYPE = CPE4, ELSET="My Set"
1, 1, 2, 3, 4
*STEP, NLGEOM
*STATIC
0.1, 1.
*END STEP
"""


def press(method="lagrange", **section):
    """A block under a flat punch."""
    model = lopin.Model("press", mesh_make.block((2.0, 1.0), (4, 2)), kind="plane strain")
    model.section("ALL", lopin.Elastic(210e3, 0.3), **section)
    die = model.rigid_tool("die", profile.plane(1.0, 5.0), ref=(0.0, 1.0))
    model.contact("TOP", die, method)
    model.fix("BOTTOM", "y")
    model.fix("LEFT", "x")
    model.step(increments=2).move(die, y=-0.01)
    return model


@pytest.mark.parametrize("name", MODULES)
def test_examples_in_docstrings(name):
    assert doctest.testmod(importlib.import_module(f"lopin.{name}")).failed == 0


def test_public_names_exist():
    for name in lopin.__all__:
        assert getattr(lopin, name) is not None


def test_a_deck_that_is_not_changed_keeps_its_text():
    assert lopin.Deck.parse(DECK).text() == DECK


def test_a_changed_deck_keeps_everything_else():
    deck = lopin.Deck.parse(DECK)
    deck["*STATIC"].data[0][1] = 2.0
    deck["*STEP"].parameters["INC"] = 50
    changed = DECK.replace("0.1, 1.\n", "0.1, 2.\n").replace("NLGEOM", "NLGEOM, INC=50")
    assert deck.text() == changed


def test_values_of_a_deck():
    deck = lopin.Deck.parse(DECK)
    assert deck["*NODE"].data[1] == [2, 1.0, None]
    assert deck["*ELEMENT"].parameters == {"TYPE": "CPE4", "ELSET": '"My Set"'}
    assert deck["*HEADING"].data == []
    assert "*BOUNDARY" not in deck
    with pytest.raises(lopin.UsageError, match="no \\*BOUNDARY; it has \\*HEADING"):
        deck["*BOUNDARY"]


def test_deck_files(tmp_path):
    path = lopin.Deck.parse(DECK).write(tmp_path/"sub"/"bar.inp")
    again = lopin.Deck.read(path)
    assert (again.text(), again.name, again.folder) == (DECK, "bar", tmp_path/"sub")
    with pytest.raises(lopin.ResourceError):
        lopin.Deck.read(tmp_path/"none.inp")


def test_numbers_read_back_to_the_same_bits():
    values = [1/3, 1e-300, -2.5e17, 123456789.125, 0.1]
    row = lopin.Deck.parse("*X\n" + lopin.deck.Row(values).text())["X"].data[0]
    assert [float(v) for v in row] == values


def test_a_model_writes_a_whole_deck():
    deck = press().to_deck()
    assert [b.keyword for b in deck.blocks if b.keyword not in ("NSET", "SURFACE")] == [
        "HEADING", "NODE", "ELEMENT", "ELSET", "MATERIAL", "ELASTIC", "SOLID SECTION", "NODE",
        "RIGID BODY", "SURFACE INTERACTION", "SURFACE BEHAVIOR", "CONTACT PAIR", "BOUNDARY", "STEP",
        "STATIC", "BOUNDARY", "NODE FILE", "EL FILE", "CONTACT FILE", "END STEP"]
    assert lopin.Deck.parse(deck.text()).text() == deck.text()
    supports, moves = deck.all("BOUNDARY")
    assert ["DIE_REF", 1, 1] in supports.data and ["DIE_REF", 6, 6] in supports.data
    assert moves.data == [["DIE_REF", 2, 2, -0.01]]


@pytest.mark.parametrize("method, words", [
    ("lagrange", "DIRECT"), ("penalty", "PENALTY"), ("perturbed", "PERTURBED LAGRANGE"),
    (lopin.Augmented(slope=1e5, max_augmentations=9), "AUGMENTED LAGRANGE")])
def test_methods_have_their_words(method, words):
    deck = press(method).to_deck()
    assert list(deck["*SURFACE BEHAVIOR"].parameters) == [words]
    if not isinstance(method, str):
        assert deck["*SURFACE BEHAVIOR"].data == [[1e5]]
        assert deck["*CONTACT CONTROLS"].parameters["MAX AUGMENTATIONS"] == 9


@pytest.mark.parametrize("cell", [c for c in CELLS if CELLS[c].ndim == 3])
def test_long_elements_are_continued(cell):
    mesh = lopin.Mesh(CELLS[cell].xi.copy(), [(cell, np.arange(CELLS[cell].n_node)[None])],
                      element_sets={"ALL": np.array([0])})
    model = lopin.Model("one", mesh, kind="3d")
    model.section("ALL", lopin.Elastic(1.0, 0.0))
    lines = model.to_deck()["*ELEMENT"].text().split("\n")[1:]
    assert all(line.endswith(",") for line in lines[:-1]) and not lines[-1].endswith(",")
    numbers = [int(n) for n in ",".join(lines).replace(" ", "").split(",") if n]
    assert numbers == [1, *range(1, CELLS[cell].n_node + 1)]


def test_models_refuse_what_does_not_exist():
    model = press()
    with pytest.raises(lopin.ModelError, match="no surface set 'TOPP'"):
        model.contact("TOPP", "BOTTOM")
    with pytest.raises(lopin.UsageError, match="no contact method 'penalti'.*lagrange, penalty"):
        model.contact("TOP", "BOTTOM", "penalti")
    with pytest.raises(lopin.UsageError, match="no direction 'z'"):
        model.fix("BOTTOM", "z")
    with pytest.raises(lopin.ModelError, match="several points"):
        model.step().force("TOP", y=1.0)
    with pytest.raises(lopin.UsageError, match="Poisson"):
        lopin.Elastic(1.0, 0.5)
    with pytest.raises(lopin.ModelError, match="no section"):
        lopin.Model("empty", mesh_make.block((1.0, 1.0), (1, 1))).to_deck()


def test_tools_face_the_side_they_should():
    assert reference.profile_gap(profile.plane(1.0, 5.0), (0.3, 0.4)) == pytest.approx(0.6)
    floor = profile.plane(1.0, 5.0, side="above")
    assert reference.profile_gap(floor, (0.3, 1.4)) == pytest.approx(0.4)
    ball = profile.arc((0.0, 50.0), 50.0, 180.0, 360.0)
    outside = reference.sphere_gap((0.0, 50.0), 50.0, [[3.0, -1.0]])
    assert reference.profile_gap(ball, (3.0, -1.0)) == pytest.approx(outside[0], abs=1e-6)
    bore = profile.arc((0.0, 0.0), 2.0, 10.0, 170.0, solid=False)
    assert reference.profile_gap(bore, (0.0, 1.5)) == pytest.approx(0.5, abs=1e-6)


def test_errors_have_the_class_of_their_exit_code():
    said = [{"severity": "warning", "message": "w"},
            {"severity": "error", "code": "E0101", "message": "unknown keyword *FRICTON",
             "file": "a.inp", "line": 3, "column": 1, "help": "did you mean *FRICTION ?"}]
    error = error_of(1, said)
    assert type(error) is lopin.DeckError
    assert (error.id, error.code) == ("E0101", 1)
    assert (error.file, error.line, error.column) == ("a.inp", 3, 1)
    assert "did you mean" in str(error)
    free = [{"severity": "error", "code": "E0310", "message": "m"}]
    assert type(error_of(1, free)) is lopin.ModelError
    for code, kind in ((2, lopin.UsageError), (3, lopin.NotConvergedError),
                       (4, lopin.SingularError), (5, lopin.ResourceError),
                       (70, lopin.InternalError), (130, lopin.Interrupted),
                       (99, lopin.InternalError)):
        assert type(error_of(code, [])) is kind and error_of(code, []).code == code


# ---- reference kernels ------------------------------------------------------------------


@pytest.mark.parametrize("kind, modes", [("plane strain", 3), ("plane stress", 3),
                                         ("axisymmetric", 1), ("3d", 6)])
@pytest.mark.parametrize("bbar", [False, True])
def test_stiffness_has_the_rigid_modes_only(kind, modes, bbar):
    name = "hexahedron" if kind == "3d" else "quad"
    x = CELLS[name].xi + 2.0
    x[0] += 0.2
    k = reference.brick_stiffness(x, 1000.0, 0.3, kind, bbar=bbar)
    values = np.linalg.eigvalsh(k)
    assert k == pytest.approx(k.T)
    assert (values < 1e-9*values[-1]).sum() == modes
    assert values[0] > -1e-9*values[-1]


def test_stiffness_of_a_stretched_brick():
    x = CELLS["hexahedron"].xi.copy()
    k = reference.brick_stiffness(x, 1000.0, 0.0)
    u = np.zeros((8, 3))
    u[:, 0] = 0.5*x[:, 0]
    assert (k @ u.ravel()).reshape(8, 3)[x[:, 0] > 0, 0].sum() == pytest.approx(500.0*4.0)


def test_skyline_factor():
    rng = np.random.default_rng(2)
    band = np.triu(np.tril(rng.normal(size=(12, 12)), 3), -3)
    a = band @ band.T + np.eye(12)
    low, d, first = reference.skyline_ldlt(a)
    assert low @ np.diag(d) @ low.T == pytest.approx(a)
    assert all((low[i, :first[i]] == 0.0).all() for i in range(12))


def test_contact_active_set_agrees_with_least_squares():
    pytest.importorskip("scipy")
    rng = np.random.default_rng(3)
    for _ in range(20):
        a = rng.normal(size=(9, 9))
        s, gap = a @ a.T + 0.1*np.eye(9), rng.normal(size=9)
        force, _ = reference.contact_active_set(s, gap)
        assert force == pytest.approx(reference.contact_oracle(s, gap), abs=1e-9)
        opening = gap + s @ force
        assert force.min() >= 0.0 and opening.min() > -1e-9 and np.abs(force*opening).max() < 1e-9


def test_contact_of_the_cycling_matrix():
    pytest.importorskip("scipy")
    s = np.array([[9.0, -13.0, -16.0], [-13.0, 22.0, 28.0], [-16.0, 28.0, 36.0]])
    force, _ = reference.contact_active_set(s, [-9.0, 9.0, 2.0])
    assert force == pytest.approx([4.29411765, 0.0, 1.85294118])


def test_closest_points_agree():
    rng = np.random.default_rng(4)
    triangle = rng.normal(size=(3, 3))
    for point in 2.0*rng.normal(size=(30, 3)):
        xi, position = reference.closest_on_triangle(triangle, point)
        _, other = reference.closest_on_facet("triangle", triangle, point)
        assert np.linalg.norm(point - position) <= np.linalg.norm(point - other) + 1e-12
        assert np.linalg.norm(other - position) < 1e-2
        assert reference.shape_functions("triangle", xi)[0] @ triangle == pytest.approx(position)
    a, b = np.array([0.0, 0.0]), np.array([2.0, 0.0])
    assert reference.closest_on_segment(a, b, [0.5, 3.0])[0] == pytest.approx(-0.5)
    assert reference.facet_normal("line", [a, b], [0.0]) == pytest.approx([0.0, -1.0])
    gap = reference.cylinder_gap([0, 0, 0], [0, 0, 1], 1.0, [[3.0, 4.0, 9.0]])
    assert gap == pytest.approx(4.0)


# ---- command line, pictures -------------------------------------------------------------


def test_convert_writes_a_mesh_for_decks(tmp_path, capsys):
    mesh_make.block((1.0, 1.0), (2, 2)).to_meshio().write(tmp_path/"a.vtu")
    files = [str(tmp_path/"a.vtu"), str(tmp_path/"a.inp")]
    assert main(["convert", *files, "--kind", "axisymmetric"]) == 0
    deck = lopin.Deck.read(tmp_path/"a.inp")
    assert deck["*ELEMENT"].parameters["TYPE"] == "CAX4" and len(deck["*ELEMENT"].data) == 4
    assert "*INCLUDE, INPUT=a.inp" in capsys.readouterr().out


def test_unknown_results_and_examples_have_an_exit_code(tmp_path, capsys):
    assert main(["plot", str(tmp_path)]) == 5
    assert main(["convert", str(tmp_path/"none.msh"), "a.inp"]) == 5
    assert "error:" in capsys.readouterr().err


def test_other_methods_for_a_deck():
    deck = chart_run.with_method(press().to_deck(), "penalty", 2e5)
    assert deck["*SURFACE BEHAVIOR"].text() == "*SURFACE BEHAVIOR, PENALTY\n200000."


def test_pictures():
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    from lopin import plot
    from lopin.result import Contact

    x = np.linspace(0.0, 2.0, 11)[:, None]
    exact = lopin.closed_form.hertz_point(1.0, 1.0, 1.0)
    contact = Contact("TOP-BALL", {"X": x, "CPRESS": exact.pressure(x[:, 0]),
                                   "CSTATUS": (exact.pressure(x[:, 0]) > 0.0).astype(int)})
    assert len(plot.pressure(contact, exact.pressure).lines) == 3
    ring = mesh_make.ring(1.0, 2.0, (2, 6), quadratic=True)
    ax = plot.mesh(ring, 0.1*ring.points, field=ring.points[:, 0])
    assert len(ax.collections[0].get_paths()) == 12


def test_the_compiled_part_is_missed_with_a_sentence(monkeypatch):
    monkeypatch.setitem(sys.modules, "lopin._core", None)
    _bridge.core.cache_clear()
    try:
        with pytest.raises(lopin.LopinError, match="compiled part.*missing"):
            lopin.run(press())
    finally:
        _bridge.core.cache_clear()


def test_the_executable_accepts_the_decks_of_models(executable, tmp_path):
    path = press().to_deck().write(tmp_path/"press.inp")
    done = subprocess.run([executable, "check", path], capture_output=True, text=True, cwd=tmp_path,
                          timeout=60)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_forwarding_script_is_not_taken_for_the_executable(tmp_path, monkeypatch):
    script = tmp_path/"lopin"
    script.write_text("#!/bin/sh\n")
    script.chmod(0o755)
    monkeypatch.setenv("LOPIN_EXECUTABLE", str(script))
    try:
        assert find_executable() != script
    except lopin.ResourceError:
        pass


def test_errors_of_the_executable_arrive_in_python(executable, monkeypatch):
    monkeypatch.setenv("LOPIN_EXECUTABLE", str(executable))
    deck = press().to_deck()
    deck["*ELASTIC"].keyword = "ELASTC"
    with pytest.raises(lopin.DeckError, match="unknown keyword") as caught:
        lopin.run(deck, executable=True)
    assert caught.value.id == "E0101"
    assert caught.value.line > 0 and caught.value.column == 1


def test_files_named_from_the_root_leave_nothing_beside_the_reader(executable, monkeypatch,
                                                                   tmp_path):
    """Two runs from one folder do not take each other's deck away."""
    monkeypatch.setenv("LOPIN_EXECUTABLE", str(executable))
    here = tmp_path/"here"
    here.mkdir()
    monkeypatch.chdir(here)
    deck = press().to_deck()
    (tmp_path/"more.inp").write_text("** nothing\n")
    text = f"*INCLUDE, INPUT={tmp_path/'more.inp'}\n" + deck.text()
    result = lopin.run(lopin.Deck.parse(text, name="press"), tmp_path/"out", executable=True)
    assert not list(here.iterdir())
    assert (tmp_path/"out"/"press.inp").is_file() and len(result.times) == 2


@pytest.mark.parametrize("method", ["lagrange", "penalty", "perturbed", "augmented"])
def test_a_model_run_by_the_executable_gives_the_exact_pressure(executable, monkeypatch, method):
    monkeypatch.setenv("LOPIN_EXECUTABLE", str(executable))
    result = lopin.run(press(method), executable=True)
    contact = result.contact("TOP").last
    exact = 210e3/(1.0 - 0.3**2)*0.01
    tolerance = 0.02 if method in ("penalty", "perturbed") else 1e-5
    assert contact.pressure == pytest.approx(exact, rel=tolerance)
    assert contact.x.shape == contact.force.shape == (5, 2)
    assert result["displacement"].shape == (15 + 1, 2)
    assert result.history["DIE.rf2"][-1] == pytest.approx(-2.0*exact, rel=tolerance)
    assert result.times == pytest.approx([0.5, 1.0])
    assert result.pairs == ["TOP-DIE"]
    with pytest.raises(lopin.UsageError, match="no result 'displacment'; known: "):
        result["displacment"]
