"""Files of the Python side: whole or not at all; a failure is a ResourceError with its reason."""
from __future__ import annotations

import csv
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from .errors import DamagedResultError, ResourceError


@contextmanager
def whole_file(path: str | Path, lasting: bool = True) -> Iterator[Path]:
    """A path beside `path` to write to; what is there afterwards takes the place of `path`.

    `lasting`: on the disk before that, which takes milliseconds.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     with whole_file(f"{folder}/a.txt") as part:
    ...         _ = part.write_text("all of it")
    ...     print([p.name for p in Path(folder).iterdir()])
    ['a.txt']
    """
    path = Path(path)
    part = path.with_name(f"{path.stem}.part{path.suffix}")
    try:
        try:
            part.unlink(missing_ok=True)   # a link of somebody else is not followed
            yield part
            if lasting:
                with part.open("rb") as file:
                    os.fsync(file.fileno())
            part.replace(path)
        finally:
            part.unlink(missing_ok=True)
    except OSError as problem:
        raise cannot_write(path, problem) from problem


def cannot_write(path: str | Path, problem: OSError) -> ResourceError:
    """The failure of a file as an exception of ours."""
    return ResourceError(f"cannot write '{path}': {problem.strerror or problem}", id="E0602",
                         help="see that the folder is writable and that the disk is not full")


@contextmanager
def reading(path: str | Path) -> Iterator[None]:
    """Whatever fails while a result file is read becomes a `DamagedResultError`.

    >>> try:
    ...     with reading("a.json"):
    ...         int("x")
    ... except DamagedResultError as problem:
    ...     print(problem.message[:36])
    the result file 'a.json' is damaged:
    """
    try:
        yield
    except DamagedResultError:
        raise
    except OSError as problem:
        raise DamagedResultError(f"cannot read the result file '{path}': "
                                 f"{problem.strerror or problem}", help=_AGAIN) from problem
    except (ValueError, LookupError, TypeError, AttributeError, ArithmeticError, MemoryError,
            SyntaxError, RecursionError, csv.Error) as problem:
        raise DamagedResultError(f"the result file '{path}' is damaged: {problem}",
                                 help=_AGAIN) from problem


_AGAIN = "run the deck again, or give the folder of another run"
