"""Run a deck or a model: in this process, or by the executable."""
from __future__ import annotations

import json
import os
import subprocess
import tempfile
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

from . import _bridge
from .deck import Deck
from .errors import Interrupted, LopinError, NotConvergedError, ResourceError, UsageError, error_of
from .folder import Folder
from .memory import Memory
from .model_read_mesh import named_from
from .result import Result

if TYPE_CHECKING:
    from .model import Model


def run(scene: Deck | Model | str | Path, output: str | Path | None = None, *,
        executable: bool = False, threads: int | None = None,
        **options: str | int | bool) -> Result:
    """Solve a deck, a model or the file of a deck.

    Parameters
    ----------
    scene : Deck, Model, or path of a deck
    output : folder for the deck and the result files; in memory only when None
    executable : run the program ``lopin`` instead of the library in this process
    threads : threads of the assembly and of BLAS
    options : options of the command line, such as ``solver="umfpack"`` or ``deterministic=True``;
        ``resume=True`` goes on from the checkpoint that a broken run left in `output`, and the
        result, read from the files there, is that of the whole run

    Raises
    ------
    DeckError, ModelError, NotConvergedError, SingularError, ...
        As the exit codes of the executable; a run that stopped early keeps its `result`.
    """
    deck = as_deck(scene)
    options["threads"] = threads
    if options.get("resume") and output is None:
        raise UsageError("resume asks for the output folder of the run that was broken off")
    if asks_to_remesh(deck):
        return run_in_parts(deck, output, options)
    if executable:
        return _run_executable(deck, output, _option_words(options))
    if output is not None:
        deck.write(Path(output)/f"{deck.name}.inp")
    session = _bridge.Session(deck.text(), full_name(deck), str(deck.folder), str(output or ""),
                              options)
    if session.code == Interrupted.code:   # Ctrl-C; a loop that catches our errors must end too
        raise KeyboardInterrupt(str(error_of(session.code, session.diagnostics)))
    if session.code not in (0, NotConvergedError.code):
        raise error_of(session.code, session.diagnostics)
    source = Memory(session)
    if options.get("resume"):   # in memory is only what this process did
        source = Folder(output, deck.name)
        source.diagnostics = session.diagnostics
    return to_result(session, Result(source, deck))


def asks_to_remesh(deck: Deck) -> bool:
    """Whether a deck, or what it includes, has *REMESH."""
    if "REMESH" in deck:
        return True
    if "INCLUDE" not in deck:
        return False
    from .model_read_mesh import expanded

    try:
        return any(block.keyword == "REMESH" for block in expanded(deck))
    except (LopinError, KeyError, OSError, RecursionError):
        return False   # the reader of decks says it better


def run_in_parts(deck: Deck, output: str | Path | None, options: dict) -> Result:
    """A run whose mesh is made anew on the way; its files are its result."""
    driver = import_module("lopin.remesh.driver")   # it uses this module
    if output is None:
        raise UsageError("a run with *REMESH keeps its parts as files: it needs an output folder",
                         help="lopin.run(deck, 'out/name')")
    given = {name: value for name, value in options.items() if value is not None}
    report = driver.Runner(deck, output, say=lambda line: None, **given).run()
    if given.get("strict"):
        report.refuse_warnings()
    result = Result(Folder(output, deck.name), deck)
    result.summary["remeshes"] = [vars(r) for r in report.remeshes]
    return result


def to_result(session: _bridge.Session, result: Result) -> Result:
    """The result of a run that has ended, or the exception that holds what there is of it."""
    if session.code in (0, NotConvergedError.code):
        if session.code:
            raise _unfinished(session.code, session.diagnostics, result)
        return result
    raise error_of(session.code, session.diagnostics)


def check(scene: Deck | Model | str | Path) -> list[dict]:
    """Parse and check without solving; returns warnings and notes, raises on errors."""
    deck = as_deck(scene)
    return _bridge.check_deck(deck.text(), full_name(deck), str(deck.folder))


def as_deck(scene: Deck | Model | str | Path) -> Deck:
    """The deck of whatever describes a scene."""
    if isinstance(scene, Deck):
        return scene
    return scene.to_deck() if hasattr(scene, "to_deck") else Deck.read(scene)


def full_name(deck: Deck) -> str:
    """The path that messages show."""
    return str(deck.folder/f"{deck.name}.inp")


def find_executable() -> Path:
    """The program: LOPIN_EXECUTABLE, the one in this package, or the one of the build tree."""
    here = Path(__file__).parent
    places = [os.environ.get("LOPIN_EXECUTABLE"), here/"bin"/"lopin", here.parent.parent/"lopin"]
    for place in map(Path, filter(None, places)):
        if place.is_file() and os.access(place, os.X_OK) and not _is_script(place):
            return place.absolute()
    raise ResourceError("the executable 'lopin' was not found",
                        help="run './bootstrap build' in the source folder, or 'pip install .'")


def _is_script(path: Path) -> bool:
    """Whether a file is a script, such as the `lopin` that would only forward here again."""
    with path.open("rb") as file:
        return file.read(2) == b"#!"


def _option_words(options: dict) -> list[str]:
    """Options as the command line has them.

    >>> _option_words({"threads": 2, "deterministic": True, "solver": None})
    ['--threads', '2', '--deterministic']
    """
    words = []
    for name, value in options.items():
        if value is not None and value is not False:
            words.append("--" + name.replace("_", "-"))
            words += [] if value is True else [str(value)]
    return words


def _run_executable(deck: Deck, output: str | Path | None, words: list[str]) -> Result:
    holder = tempfile.TemporaryDirectory(prefix="lopin-") if output is None else None
    folder = Path(holder.name if holder else output)
    path, is_copy = _deck_file(deck, folder)
    command = [find_executable(), "run", path, "-o", folder, "--overwrite", "--json", "--quiet"]
    try:
        done = subprocess.run([*command, *words], capture_output=True, text=True, check=False)
    finally:
        if is_copy:
            path.unlink()
    said = _said(done.stdout)
    if done.returncode not in (0, NotConvergedError.code):
        raise error_of(done.returncode, said, done.stderr.strip())
    result = Result(Folder(folder, path.stem), deck)
    result.source.holder = holder   # a folder made for this run lives as long as its result
    if done.returncode:
        raise _unfinished(done.returncode, said, result)
    return result


def _deck_file(deck: Deck, folder: Path) -> tuple[Path, bool]:
    """The file to run, and whether it is a copy to remove. A deck that is in no file is written
    into the folder of the results, its files named from there: never over one of the user's."""
    original = deck.folder/f"{deck.name}.inp"
    if original.is_file() and Deck.read(original).text() == deck.text():
        return original, False
    path = folder/original.name
    if original.is_file() and path.resolve() == original.resolve():
        return deck.write(folder/f"{deck.name}-run.inp"), True
    if _reads_beside(deck):
        copy = Deck(deck.blocks, preamble=deck.preamble, name=deck.name, folder=folder)
        deck = named_from(copy, deck.folder)
    return deck.write(path), False


def _reads_beside(deck: Deck) -> bool:
    """Whether the deck names files by their way from its own folder.

    >>> _reads_beside(Deck.parse("*INCLUDE, INPUT=bar.mesh"))
    True
    >>> _reads_beside(Deck.parse("*INCLUDE, INPUT=/srv/bar.mesh"))
    False
    """
    named = (block.parameters.get("INPUT") for block in deck.blocks)
    return any(not Path(str(name).strip("\"'")).is_absolute() for name in named if name)


def _said(output: str) -> list[dict]:
    try:
        return json.loads(output).get("diagnostics", [])
    except ValueError:
        return []


def _unfinished(code: int, said: list[dict], result: Result) -> NotConvergedError:
    error = error_of(code, said)
    error.result = result
    return error
