"""Paths and helpers shared by the Python tests."""
import importlib
import os
from pathlib import Path

import pytest

from sheet import SHEET, Row

ROOT = Path(__file__).resolve().parents[2]
# What is tested: a missing executable fails its tests, it skips none.
os.environ.setdefault("LOPIN_EXECUTABLE", str(ROOT/"build"/"lopin"))
#: Files of the fast loop: a second and a half each at most, and together something of every area.
FAST = set("""
    area_growth bad_decks closed_form codes cut_back damaged_results deep_tools feature_steps
    feature_tools finite_strain floors flow_words free_block friction_twin friction_words
    import_graph increments mesh model_words narrow_masters narrow_tools node_areas passage
    plastic_members press_fits recorders seed_repairs sliding_scenes smooth_rings sources tree
    turning_bodies velocity verification_incline verification_springs verification_stability
    walk
""".split())
#: Files of ten seconds and more come first: at the end no process waits for another's last file.
LONG = """
    decks atlas accuracy checkpoint springback remeshing faults wrapped_strip refine
    remeshing_facets model_decks verification_tools invariance narrow_masters tutorials
    remeshing_harm force_transfer verification_meshes verification_mindlin separation
    remeshing_kills first_touch forming verification_sliding bending_unbending estimates chart
    stepping live
""".split()


def pytest_collection_modifyitems(items):
    """Mark the tests of the fast loop, and put the longest files first."""
    rank = {stem: k for k, stem in enumerate(LONG)}
    items.sort(key=lambda item: rank.get(item.path.stem.removeprefix("test_"), len(LONG)))
    for item in items:
        if item.path.stem.removeprefix("test_") in FAST:
            item.add_marker("fast")


@pytest.fixture(scope="session")
def root() -> Path:
    """Top of the source tree."""
    return ROOT


@pytest.fixture(scope="session")
def executable() -> Path:
    """The executable under test."""
    path = Path(os.environ["LOPIN_EXECUTABLE"]).absolute()
    assert path.is_file(), f"no executable at {path}"
    return path


@pytest.fixture(scope="session")
def core():
    """The compiled part of the package."""
    return importlib.import_module("lopin._core")


@pytest.fixture(scope="session")
def sheet():
    """Where tests compare what they compute with its reference."""
    return SHEET


def pytest_sessionfinish(session):
    """Write the sheet if asked for; a worker of pytest-xdist hands its rows to the main process."""
    path = os.environ.get("LOPIN_SHEET")
    if path and hasattr(session.config, "workeroutput"):
        session.config.workeroutput["sheet"] = [
            {key: getattr(value, "item", lambda v=value: v)() for key, value in vars(row).items()}
            for row in SHEET.rows]
    elif path and SHEET.rows:
        SHEET.write(path)


@pytest.hookimpl(optionalhook=True)
def pytest_testnodedown(node):
    """Take the rows of a worker."""
    SHEET.rows += [Row(**row) for row in getattr(node, "workeroutput", {}).get("sheet", ())]


@pytest.fixture
def solve(executable, tmp_path, monkeypatch):
    """Run a deck, a model or the name of a deck of the folder decks by the executable."""
    import lopin

    monkeypatch.setenv("LOPIN_EXECUTABLE", str(executable))
    count = iter(range(10000))

    def run(scene, refused=False, **options):
        """`refused`: the result is wanted although the certificate fails."""
        if isinstance(scene, str):
            scene = lopin.Deck.read(ROOT/"decks"/f"{scene}.inp")
        folder = tmp_path/f"run{next(count)}"
        try:
            return lopin.run(scene, folder, executable=True, **options)
        except lopin.NotConvergedError as problem:
            if refused and "E0504" in str(problem):
                return problem.result
            raise

    return run


@pytest.fixture
def go(executable, tmp_path):
    """Run a scene of `feature_scene`, each in a folder of its own."""
    from feature_scene import run

    count = iter(range(1000))
    return lambda scene: run(executable, tmp_path/f"run{next(count)}", scene)
