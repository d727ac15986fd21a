"""What must not change an answer: units, axes, numbers, sides, threads, far things, requests."""
import json
import os

import numpy as np
import pytest

from scenes import METHODS, SCENES, answer, cycled, difference, history, oblique, renumbered, run

ALL = sorted(SCENES)
SLOPES = {"deformable": 2e5, "sphere": 1e5, "floating": 1e5, "corner": 1e5}


@pytest.fixture(scope="module")
def solve(executable, tmp_path_factory):
    """Run a scene; the same deck with the same options is run once."""
    known = {}

    def do(scene, *options, **more):
        key = (scene.deck(), options)
        if key not in known:
            known[key] = answer(executable, scene, tmp_path_factory.mktemp("run"), *options, **more)
        return known[key]

    return do


def limit(sheet, quantity, value, tolerance, case="F18 Invariance"):
    sheet.compare(case, quantity, value, 0.0, tolerance, "invariance", absolute=True)


@pytest.mark.parametrize("name", ALL)
def test_the_perturbed_lagrangian_is_the_penalty(solve, sheet, name):
    """F3: the same springs, written as multipliers with a compliance."""
    first, second = (solve(SCENES[name]().but(method=m, slope=SLOPES[name])) for m in METHODS[1:3])
    assert first.counts["0.closed"] == second.counts["0.closed"] > 2
    limit(sheet, f"{name}: perturbed Lagrangian less penalty", difference(first, second), 1e-12)


UNITS = {"m": (1e-3, 1e6), "soft": (1.0, 1e-9), "stiff": (1.0, 1e9)}


@pytest.mark.parametrize("unit", UNITS)
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", ALL)
def test_units_change_neither_numbers_nor_iterations(solve, sheet, name, method, unit):
    scene = SCENES[name]().but(method=method)
    length, modulus = UNITS[unit]
    first, second = solve(scene), solve(scene.but(length=length, modulus=modulus))
    assert first.counts == second.counts
    limit(sheet, f"{name}, {method.lower()}: other units ({unit})", difference(first, second),
          1e-10)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", ["deformable", "corner"])
def test_a_turned_scene_has_the_same_invariants(solve, sheet, name, method):
    scene = SCENES[name]().but(method=method)
    first, second = solve(scene), solve(scene.but(turn=oblique(scene.ndim)))
    assert first.counts == second.counts
    limit(sheet, f"{name}, {method.lower()}: turned by 37 degrees", difference(first, second),
          1e-10)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", ALL)
def test_numbers_of_nodes_and_elements_do_not_count(solve, sheet, name, method):
    scene = SCENES[name]().but(method=method)
    first = solve(scene)
    for seed in (1, 2):
        second = solve(renumbered(scene, seed))
        assert first.counts["0.closed"] == second.counts["0.closed"]
        limit(sheet, f"{name}, {method.lower()}: renumbered ({seed})", difference(first, second),
              1e-12)


@pytest.mark.parametrize("name", ALL)
def test_an_element_may_begin_with_any_node(solve, sheet, name):
    first, second = solve(SCENES[name]()), solve(cycled(SCENES[name]()))
    assert first.counts == second.counts
    limit(sheet, f"{name}: nodes of elements cycled", difference(first, second), 1e-12)


def test_sides_swapped_on_other_meshes_differ_by_the_mesh(solve, sheet):
    """Two springs have the same bits; here the nodes do not match, and the difference is
    reported."""
    scene = SCENES["deformable"]()
    first, second = solve(scene), solve(scene.but(pairs=[("FACE", "CROWN")]))
    sheet.compare("F20 Sides swapped", "strain energy, slave and master swapped",
                  second.values["energy.strain"],
                  first.values["energy.strain"], 2e-2, "the other side as slave")
    forces = [abs(one.job["contact"][0]["force"][1]) for one in (first, second)]
    sheet.compare("F20 Sides swapped", "force across, slave and master swapped", forces[1],
                  forces[0], 1e-10, "the other side as slave")


def files_of(folder):
    """Bytes of all results; of job.json what is not a time, a size of memory, a place."""
    out = {}
    for path in sorted(folder.iterdir()):
        data = path.read_bytes()
        if path.name == "job.json":
            job = json.loads(data)
            for key in ("timing", "peak_memory_mib", "threads", "deck"):
                job.pop(key)
            for item in job["diagnostics"]:
                item.pop("file", None)
            data = json.dumps(job).encode()
        out[path.name] = data
    return out


@pytest.mark.parametrize("name", ALL)
@pytest.mark.parametrize("solver", [(), ("--solver", "cholmod")], ids=["default", "cholmod"])
def test_threads_do_not_change_a_bit(solve, name, solver):
    scene = SCENES[name]()
    first, second = (files_of(solve(scene, *solver, "--threads", str(n)).folder) for n in (1, 2))
    assert first == second and len(first) > 5


@pytest.mark.parametrize("name", ALL)
def test_solvers_agree(solve, sheet, name):
    first = solve(SCENES[name]())
    for solver in ("cholmod", "skyline", "dense"):
        limit(sheet, f"{name}: solver {solver}",
              difference(first, solve(SCENES[name](), "--solver", solver)), 1e-11)
    whole = SCENES[name]().but(extra_model="*LOPIN, PATH=NEWTON")
    for solver in ("cholmod", "umfpack"):
        limit(sheet, f"{name}: whole system, solver {solver}",
              difference(first, solve(whole, "--solver", solver)), 1e-10)


def with_far_block(scene):
    """Another pair of blocks in contact, far away and not connected."""
    from scenes import add_block
    new = scene.but()
    ndim = scene.ndim
    cells = (2, 2, 2)[:ndim]

    def at(base):
        return lambda *x: np.array([1000.0,
                                    *(0.0,)*(ndim - 1)]) + np.array(x) + np.array([0.0]*(ndim - 1)
                                                                                  + [base])
    low, first = add_block(new, "FAR_LOW", cells, at(0.0), first=20001)
    high, second = add_block(new, "FAR_HIGH", cells, at(1.0), first=20101)
    new.materials = {**scene.materials, "FAR_LOW": (20000.0, 0.3), "FAR_HIGH": (20000.0, 0.3)}
    new.nsets = {**scene.nsets, "FAR_BASE": low[..., 0].ravel().tolist(),
                 "FAR_LID": high[..., -1].ravel().tolist()}
    top, bottom = (2, 1) if ndim == 3 else (3, 1)
    new.surfaces = {**scene.surfaces,
                    "FAR_MASTER": [(k, top) for index, k in first.items() if index[-1] == 1],
                    "FAR_SLAVE": [(k, bottom) for index, k in second.items() if index[-1] == 0]}
    new.pairs = [*scene.pairs, ("FAR_SLAVE", "FAR_MASTER")]
    new.fixed = [*scene.fixed, f"FAR_BASE, 1, {ndim}", f"FAR_LID, 1, {ndim}"]
    return new


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", ALL)
def test_a_far_contact_changes_nothing(solve, sheet, name, method):
    scene = SCENES[name]().but(method=method)
    first, second = solve(scene), solve(with_far_block(scene))
    only = [k for k in first.values if k.startswith("0.") or k in ("energy.strain", "reaction")]
    limit(sheet, f"{name}, {method.lower()}: with a far contact", difference(first, second, only),
          1e-12)


@pytest.mark.parametrize("name", ALL)
def test_increments_do_not_change_the_end(solve, sheet, name):
    first, second = solve(SCENES[name]()), solve(SCENES[name]().but(increments=4))
    # Where a tool that floats stands is found by passes, to their tolerance.
    tolerance = 1e-8 if name == "floating" else 1e-12
    limit(sheet, f"{name}: four increments", difference(first, second,
                                                        without=("energy.external",)), tolerance)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", ["sphere", "corner"])
def test_a_way_there_and_back_leaves_nothing(executable, tmp_path, name, method):
    """Elastic without friction: the middle of the way back is the middle of the way, the end is the
    start."""
    text = SCENES[name]().but(increments=4, method=method).deck()
    text = text.replace("*STEP, INC", "*AMPLITUDE, NAME=A\n0., 0., 0.5, 1., 1., 0.\n*STEP, INC")
    text = text.replace("1.\n*BOUNDARY", "1.\n*BOUNDARY, AMPLITUDE=A")
    energy = history(run(executable, text, tmp_path)[1])["energy.strain"]
    assert energy[2] == pytest.approx(energy[0], rel=1e-10 if "AUGMENTED" in method
                                      else 1e-12) and 0.0 < energy[0] < energy[1]
    assert abs(energy[3]) < 1e-16*energy[1]


@pytest.mark.parametrize("name", ALL)
def test_friction_of_nothing_is_no_friction(solve, name):
    first = solve(SCENES[name]())
    second = solve(SCENES[name]().but(extra_interaction="*FRICTION\n0."))
    assert (first.folder/"job_history.csv").read_bytes() == (second.folder/"job_history.csv").read_bytes()


@pytest.mark.parametrize("output", ["", "*NODE FILE\nU\n", "*EL FILE\nS, E\n",
                                    "*EL PRINT, ELSET=NONE, TOTALS=YES\nS\n",
                                    "*NODE FILE, FREQUENCY=3\nU\n"])
@pytest.mark.parametrize("name", ALL)
def test_requests_of_output_do_not_change_the_run(solve, name, output):
    scene = SCENES[name]().but(increments=4)
    if "ELSET" in output:
        output = output.replace("NONE", next(iter(scene.materials)))
    first, second = solve(scene), solve(scene.but(output=output))
    assert (first.folder/"job_history.csv").read_bytes() == (second.folder/"job_history.csv").read_bytes()


@pytest.mark.parametrize("name", ALL)
def test_a_linear_scene_is_factorised_once(solve, name):
    """G3: one factorisation and one back-solve a linear increment, whatever the method."""
    for method in METHODS:
        for n in (1, 4):
            step, = solve(SCENES[name]().but(method=method, increments=n)).job["steps"]
            assert (step["factorisations"], step["increments"]) == (1, n)
            # The place of a tool that floats takes some passes, each of one back-solve.
            assert step["back_solves"] == n if name != "floating" else step["back_solves"] <= 20*n


def test_a_tool_adds_no_equation(solve):
    """G3: a tool that moves as prescribed adds none, a floating one the dofs left free to it."""
    free = 13*9*2 - 13*2 - 8
    assert solve(SCENES["sphere"]()).job["equations"] == free
    assert solve(SCENES["floating"]()).job["equations"] <= free + 1


@pytest.mark.parametrize("method", METHODS[1:])
@pytest.mark.parametrize("name", ALL)
def test_no_slope_is_silently_wrong(executable, solve, tmp_path, name, method):
    """F1: with a pressure that is 5 % off, the certificate warns or fails, or the run ends with an
    error."""
    scene = SCENES[name]()
    right = solve(scene)
    young = min(e for e, _ in scene.materials.values())
    good = 0
    every = 1 if name == "corner" else 2
    for exponent in range(-2, 19, every):
        deck = scene.but(method=method, slope=young*10.0**exponent).deck()
        process, folder = run(executable, deck, tmp_path/str(exponent), accept=(0, 3, 4))
        if process.returncode:
            assert "error[E05" in process.stderr or "error[E09" in process.stderr, process.stderr
            continue
        certificate = json.loads((folder/"job.json").read_text(encoding="utf-8"))["certificate"]
        pair, = json.loads((folder/"job.json").read_text(encoding="utf-8"))["contact"]
        off = abs(pair["max_pressure"]/right.values["0.pressure"] - 1.0)
        off = max(off, abs(history(folder)["energy.strain"][-1]/right.values["energy.strain"]
                           - 1.0))
        good += off < 1e-4
        assert off < 0.05 or certificate["verdict"] == "WARN", (exponent, off, certificate)
    assert good >= 4//every


def test_blas_threads_of_the_environment_do_not_matter(executable, tmp_path):
    """A run calls the BLAS on one thread, whatever OPENBLAS_NUM_THREADS says."""
    text = SCENES["corner"]().deck()
    folders = [run(executable, text, tmp_path/str(n),
                   environment={**os.environ, "OPENBLAS_NUM_THREADS": str(n),
                                "OMP_NUM_THREADS": str(n)})[1]
               for n in (1, 2)]
    assert files_of(folders[0]) == files_of(folders[1])
    assert len(history(folders[0])) > 10
