"""A run, increment by increment: look, decide, stop, take its state and go on elsewhere."""
from __future__ import annotations

from pathlib import Path

from . import _bridge
from .deck import Deck
from .errors import Interrupted, UsageError, error_of
from .memory import Memory
from .points import Points, Tractions
from .model import Model
from .result import Frame, Result
from .run import as_deck, full_name, to_result


class Job:
    """An open run. Iterate over it for its increments; leaving the `with` block ends it.

    The first Ctrl-C gives the increment in hand up within one iteration and raises
    KeyboardInterrupt; the run stays at its last accepted increment, and may go on.

    Attributes
    ----------
    deck : Deck
        What runs.
    has_begun : bool
        Whether it was opened from a state: its tools have moved before its first increment.
    blows : dict
        Where `lopin.press.blow` has ended: number of increments, place and force of each tool.

    Example
    -------
    ::

        with lopin.open(model) as job:
            for frame in job:
                if frame["Mises"].max() > 400.0:
                    break
        job.result["displacement"]
    """

    def __init__(self, scene: Deck | Model | str | Path, output: str | Path | None = None, *,
                 state: bytes = b"", **options: str | int | bool):
        self.deck = as_deck(scene)
        if output is not None:
            self.deck.write(Path(output)/f"{self.deck.name}.inp")
        self._session = _bridge.Session.opened(self.deck.text(), full_name(self.deck),
                                               str(self.deck.folder), str(output or ""), options,
                                               state)
        self._open = self._session.code == 0
        self._count = 0
        self.has_begun = bool(state)
        self.blows: dict[str, tuple[int, float, float]] = {}
        if self._session.code:
            raise error_of(self._session.code, self._session.diagnostics)

    @property
    def is_open(self) -> bool:
        """Whether further increments may follow."""
        return self._open

    @property
    def state(self) -> bytes:
        """All that lives from increment to increment, for ``lopin.open(deck, state=...)`` of the
        same deck and version; empty before the first increment and after the end."""
        return self._session.state() if self._open else b""

    @property
    def points(self) -> Points | None:
        """What the integration points hold after the last accepted increment, as numbers that mean
        the same on any mesh; None if no material remembers anything, or after the end.

        Points.lines() writes them as the data lines of ``*INITIAL CONDITIONS, TYPE=STATE``.
        """
        return Points.of(self._session) if self._open else None

    @property
    def tractions(self) -> Tractions | None:
        """What slave nodes bear after the last accepted increment; None without contact on the
        present shape, or after the end."""
        return Tractions.of(self._session) if self._open else None

    def forget_workspace(self) -> None:
        """Throw away all but the state (matrices, factors, surfaces, trees) and make it again.

        The run goes on to the same bits: a check for developers, or a way to free memory.
        """
        code = self._session.forget_workspace() if self._open else 0
        if code:
            raise error_of(code, self._session.diagnostics)

    @property
    def result(self) -> Result:
        """What was accepted so far; its `summary` is there once the run has ended."""
        return Result(Memory(self._session), self.deck)

    def advance(self) -> Frame | None:
        """The next accepted increment, or None at the end of the run.

        Raises
        ------
        NotConvergedError, SingularError, ResourceError, ...
            As `run`; what was accepted stays in `result`.
        KeyboardInterrupt
            At the first Ctrl-C; the job stays open.
        """
        if not self._open:
            raise UsageError("the job has ended", help="open another one; Job.is_open tells")
        more, code = self._session.advance()
        if more:
            self._count += 1
            return Frame(self.result, self._count - 1)
        if code == Interrupted.code:
            raise KeyboardInterrupt(str(error_of(code, self._session.diagnostics)))
        self._open = False
        to_result(self._session, self.result)
        return None

    def close(self) -> Result:
        """End the run where it stands: files are whole, `result` is complete."""
        if self._open:
            self._open = False
            self._session.end()
        return self.result

    def __iter__(self):
        while self._open:
            frame = self.advance()
            if frame is None:
                return
            yield frame

    def __enter__(self) -> Job:
        return self

    def __exit__(self, *_):
        self.close()


def open_job(scene: Deck | Model | str | Path, output: str | Path | None = None, *,
             state: bytes = b"", threads: int | None = None,
             **options: str | int | bool) -> Job:
    """Open a run of a deck, a model or the file of a deck, before its first increment.

    Parameters
    ----------
    scene, output, threads, options : as of `run`
    state : `Job.state` of an earlier run of the same deck, to go on after its last increment;
        results and files then begin with the next one
    """
    return Job(scene, output, state=state, threads=threads, **options)
