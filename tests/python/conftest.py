"""Paths and helpers shared by the Python tests."""
import os
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def root() -> Path:
    """Top of the source tree."""
    return ROOT


@pytest.fixture(scope="session")
def executable() -> Path:
    """The executable under test; tests that need it are skipped where there is none."""
    path = Path(os.environ.get("LOPIN_EXECUTABLE", ROOT / "build" / "lopin"))
    if not path.is_file():
        pytest.skip(f"no executable at {path}")
    return path


@pytest.fixture(scope="session")
def core():
    """The compiled part of the package; tests that need it are skipped where there is none."""
    return pytest.importorskip("lopin._core")
