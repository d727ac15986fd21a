"""Paths and helpers shared by the Python tests."""
import os
from pathlib import Path

import pytest

from sheet import SHEET

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def root() -> Path:
    """Top of the source tree."""
    return ROOT


@pytest.fixture(scope="session")
def executable() -> Path:
    """The executable under test; tests that need it are skipped where there is none."""
    path = Path(os.environ.get("LOPIN_EXECUTABLE", ROOT / "build" / "lopin")).absolute()
    if not path.is_file():
        pytest.skip(f"no executable at {path}")
    return path


@pytest.fixture(scope="session")
def core():
    """The compiled part of the package; tests that need it are skipped where there is none."""
    return pytest.importorskip("lopin._core")


@pytest.fixture(scope="session")
def sheet():
    """Where tests compare what they compute with its reference."""
    return SHEET


def pytest_sessionfinish():
    """Write the sheet if asked for."""
    path = os.environ.get("LOPIN_SHEET")
    if path and SHEET.rows:
        SHEET.write(path)


@pytest.fixture
def solve(executable, tmp_path, monkeypatch):
    """Run a deck, a model or the name of a deck of the folder decks by the executable."""
    lopin = pytest.importorskip("lopin")
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
