"""Sweeps: one scene with other numbers, each run in a process of its own."""
from __future__ import annotations

import itertools
import os
import tempfile
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from .deck import Deck
from .errors import InternalError, LopinError, UsageError, error_of
from .folder import Folder
from .result import Result
from .run import as_deck, run

if TYPE_CHECKING:
    from .model import Model


@dataclass
class Case:
    """One run of a sweep.

    A run that stopped early has both a result, up to its last good increment, and an error.
    """

    values: dict                        #: what was varied
    result: Result | None = None
    error: LopinError | None = None
    holder: object = field(default=None, repr=False)   #: keeps a folder of our own alive

    @property
    def ok(self) -> bool:
        """Whether the run ended well."""
        return self.error is None


def sweep(scene: Model | Deck | str | Path | Callable[..., Model | Deck],
          over: Mapping[str, Iterable] | Sequence[Mapping], *, workers: int | None = None,
          output: str | Path | None = None, client=None, **options) -> list[Case]:
    """Run a scene with every combination of values, several at a time.

    In a script, call it below ``if __name__ == "__main__":``: workers are started by the method
    "spawn", which reads the script again.

    Parameters
    ----------
    scene : a function of the values that returns a model or a deck, called in this process; or a
        model, a deck or its file, where a name is a place in the deck: "*FRICTION:0:0" is the first
        field of the first data line of the first such card, "*PLASTIC#2:1:0" of the second card's
        second line, "*STEP:INC" a parameter
    over : values by name, every combination of which is run; or a list of such choices
    workers : processes at a time; the number of processors unless given; 0: in this process
    output : folder for the runs, 000, 001...; a temporary one that lives as long as a case unless
        given
    client : anything with ``submit``, such as a dask ``Client`` whose workers see the same disk
    options : as of `lopin.run`; `threads` is 1 unless given

    Returns
    -------
    Cases in the order of `over`, the last name fastest. A run that fails does not end the others:
    its case has the error.

    Raises
    ------
    UsageError : `over` is empty, or a name is no place in the deck.

    >>> cases = sweep(lambda mu: None, over={"mu": []})
    Traceback (most recent call last):
    lopin.errors.UsageError: a sweep needs values to go over
    """
    choices = _choices(over)
    decks = [_deck_of(scene, values) for values in choices]
    holder = tempfile.TemporaryDirectory(prefix="lopin-") if output is None else None
    top = Path(holder.name if holder else output).absolute()
    folders = [top/f"{k:03d}" for k in range(len(choices))]
    options = {"threads": 1} | options
    jobs = [(deck.text(), deck.name, str(deck.folder.absolute()), str(folder), options)
            for deck, folder in zip(decks, folders)]
    if client is not None:
        told = _gather([client.submit(_solve, *job) for job in jobs])
    elif workers == 0:
        told = [_solve(*job) for job in jobs]
    else:
        from concurrent.futures import ProcessPoolExecutor
        from multiprocessing import get_context

        count = min(workers or os.cpu_count() or 1, len(jobs))
        with ProcessPoolExecutor(count, mp_context=get_context("spawn")) as pool:
            told = _gather([pool.submit(_solve, *job) for job in jobs])
    return [_case(values, deck, folder, failure, holder) for values, deck, folder, failure
            in zip(choices, decks, folders, told)]


def _choices(over) -> list[dict]:
    if isinstance(over, Mapping):
        lists = [list(values) for values in over.values()]
        found = [dict(zip(over, values)) for values in itertools.product(*lists)] if lists else []
    else:
        found = [dict(values) for values in over]
    if not found:
        raise UsageError("a sweep needs values to go over")
    return found


def _deck_of(scene, values: dict) -> Deck:
    if callable(scene):
        return as_deck(scene(**values))
    deck = as_deck(scene)
    copy = Deck.parse(deck.text(), name=deck.name, folder=deck.folder)
    for name, value in values.items():
        put(copy, name, value)
    return copy


def put(deck: Deck, name: str, value) -> None:
    """Set one number or word of a deck.

    >>> deck = Deck.parse("*ELASTIC\\n1., 0.3\\n*STEP, INC=5")
    >>> put(deck, "*ELASTIC:0:1", 0.25), put(deck, "*STEP:INC", 9)
    (None, None)
    >>> print(deck.text(), end="")
    *ELASTIC
    1., 0.25
    *STEP, INC=9
    """
    card, *place = name.split(":")
    keyword, _, number = card.partition("#")
    blocks = deck.all(keyword)
    try:
        block = blocks[int(number or 1) - 1 if int(number or 1) > 0 else len(blocks)]
        if len(place) == 1:
            block.parameters[place[0].upper()] = value
        else:
            row, column = map(int, place)
            block.data[row][column] = value
    except (IndexError, ValueError):
        raise UsageError(f"'{name}' is no place in the deck",
                         help="write *KEYWORD:line:field, *KEYWORD#2:line:field of the second such "
                              "card, or *KEYWORD:PARAMETER; lines and fields count from 0"
                         ) from None


def _solve(text: str, name: str, source: str, folder: str, options: dict) -> dict | None:
    """One run, in a worker; what went wrong, or nothing. Results stay in the folder."""
    try:
        run(Deck.parse(text, name=name, folder=source), folder, **options)
    except LopinError as problem:
        return {"code": problem.code, "message": problem.message, "said": problem.diagnostics}
    return None


def _gather(futures: list) -> list[dict | None]:
    """What each run told; a worker that died is told, too."""
    from concurrent.futures import BrokenExecutor

    told = []
    try:
        for future in futures:
            try:
                told.append(future.result())
            except BrokenExecutor as problem:
                told.append({"code": InternalError.code, "said": [],
                             "message": f"the process of this run ended: {problem}"})
    except BaseException:
        for future in futures:
            future.cancel()
        raise
    return told


def _case(values, deck, folder, failure, holder) -> Case:
    error = result = None
    if failure is not None:
        error = error_of(failure["code"], failure["said"], failure["message"])
    if (folder/f"{deck.name}.json").is_file():
        result = Result(Folder(folder, deck.name), deck)
    return Case(values, result, error, holder)
