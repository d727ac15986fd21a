"""A run in parts: increments until a mesh is worn, a new mesh, and on.

Each part is a deck of its own, written before it runs: whoever resumes or repeats the run reads it
and needs no mesher. What ends a part depends on its deck and on the accepted state alone, so that a
run that was killed goes on to the same bits.
"""
from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from ..deck import Block, Deck
from ..errors import DamagedResultError, NotConvergedError, ResourceError
from ..job import Job
from ..material_cards import of_body
from ..model_read_mesh import named_from, plain
from ..run import check
from .body import Body, DeckParts, read_body
from .card import RemeshCard
from .join import has_whole_results
from .part import Clock, at_nodes
from .plane import worst_corner
from .refusals import (
    refuse_critical_of_others,
    refuse_missing_mesher,
    refuse_shared_elements,
    refuse_what_stays_behind,
)
from .remake import remake
from .report import Remesh, Report, too_many_warnings
from .scrap import pieces
from .separate import counted, criticals, cuts_of, separate, torn
from .state import Snapshot
from .tools import Tools
from .triggers import reason_to_remesh

#: Most increments of a step that says none.
MOST_INCREMENTS = 100


def part_name(name: str, number: int) -> str:
    """Name of the deck of a part.

    >>> part_name("disc", 2)
    'disc.p002'
    """
    return f"{name}.p{number:03d}"


@dataclass
class Made:
    """Where the mesh of a body began.

    Attributes
    ----------
    plastic : accumulated plastic strain of each element
    began : the moment
    quality : worst corner
    """

    plastic: dict[int, float]
    began: Clock
    quality: float


class Runner:
    """One run with remeshing.

    Parameters
    ----------
    deck : with *REMESH
    output : folder of all parts
    say : told what happens, a line at a time
    resume : go on with the parts that the folder holds
    replay : run the parts that the folder holds again, without making meshes
    strict : a warning of the deck ends the run before it begins; those of the run are for
        `Report.refuse_warnings`
    options : of `lopin.open`
    """

    def __init__(self, deck: Deck, output: str | Path, *, say: Callable[[str], None] = print,
                 resume: bool = False, replay: bool = False, strict: bool = False, **options):
        self.deck, self.output, self.say, self.options = deck, Path(output), say, options
        self.resume, self.replay = resume, replay
        said = [f"warning[{d['code']}]: {d['message']}" for d in check(deck)
                if d["severity"] == "warning"]
        if strict and said:
            raise too_many_warnings(said)
        parts = DeckParts.of(deck)
        cards = [RemeshCard.of(b) for b in parts.blocks if b.keyword == "REMESH"]
        bodies = [read_body(parts, card.elset) for card in cards]
        refuse_shared_elements(bodies)
        refuse_critical_of_others(parts, bodies)
        self.cards, self.critical = {}, {}
        for card, body in zip(cards, bodies):
            refuse_what_stays_behind(parts, body)
            own = of_body(parts.blocks, parts.cards, set(body.elements.tolist()))
            self.critical[card.elset] = criticals(own)
            self.cards[card.elset] = replace(card.filled(body), cuts=cuts_of(own))
        self.most = max(card.most for card in cards)
        if self.most and not (resume or replay):
            refuse_missing_mesher(bodies)
        self.made: dict[str, Made] = {}
        self.report = Report(deck.name, self.output)

    def run(self) -> Report:
        """All parts; the report says what each remesh did."""
        number, deck = 1, self._first_deck()
        if self.resume or self.replay:
            self._same(deck)
        else:
            self.report.cards = self._cards()
            for path in self._decks():
                path.unlink()
        try:
            while deck is not None:
                self.say(f"part {number}: {self.output/deck.name}.inp")
                deck = self._part(deck, number)
                number += 1
        finally:
            self.report.finish()
        return self.report

    def _decks(self) -> list[Path]:
        """Decks of parts in the folder."""
        return sorted(self.output.glob(f"{self.deck.name}.p[0-9][0-9][0-9].inp"))

    def _path(self, number: int) -> Path:
        return self.output/f"{part_name(self.deck.name, number)}.inp"

    def _first_deck(self) -> Deck:
        """The deck without *REMESH, with its includes in their place."""
        blocks = [at_nodes(counted(b)) for b in DeckParts.of(self.deck).blocks
                  if b.keyword != "REMESH"]
        deck = Deck(blocks, preamble=self.deck.preamble, name=part_name(self.deck.name, 1),
                    folder=self.output)
        return named_from(deck, self.deck.folder)

    def _same(self, deck: Deck) -> None:
        """The parts in the folder are of this deck."""
        path = self._path(1)
        if path.is_file() and path.read_text(errors="surrogateescape") != deck.text():
            raise _of_another(self.output)
        self.report.read()
        if self.resume and self._path(2).is_file() and not self.report.path.is_file():
            raise _of_another(self.output, f": what was done is not known without "
                              f"'{self.report.path.name}'")
        if self._path(2).is_file() and not self.report.path.is_file():
            self.say(f"WARN: there is no '{self.report.path}': "
                     "decks of parts are taken as they are")
        if self.report.cards and self.report.cards != self._cards():
            raise _of_another(self.output, ": its *REMESH differs")
        self.report.cards = self._cards()

    def _cards(self) -> str:
        """The cards that say when and how meshes are made anew."""
        return "\n".join(b.text() for b in DeckParts.of(self.deck).blocks if b.keyword == "REMESH")

    def _known(self, number: int) -> Deck | None:
        """The deck of a part that an earlier run has written."""
        path = self._path(number)
        if not (self.resume or self.replay) or not path.is_file():
            return None
        deck = Deck.read(path)
        known = self.report.sums.get(path.stem)
        if not deck.blocks or deck.blocks[-1].keyword != "END STEP" or "START" not in deck:
            raise DamagedResultError(f"the deck of a part '{path}' is damaged: it has no end",
                                     help="delete it, and what follows is made again")
        if known is None and self.resume and number > 1:
            raise DamagedResultError(
                f"the list of parts '{self.report.path}' has no sum of '{path.name}'",
                help="an earlier version wrote it, or it was edited: delete the part, and what "
                     "follows is made again, or --replay it as it is")
        if known is not None and known != sum_of(path.read_text(errors="surrogateescape")):
            raise DamagedResultError(
                f"the deck of a part '{path}' is not as it was written",
                help="delete it, and what follows is made again, or run it as a deck of its own")
        return deck

    def _has_run(self, number: int) -> bool:
        """Whether the results of a part are whole in the folder; else it runs again."""
        return self._path(number).is_file() and \
            has_whole_results(self.output, part_name(self.deck.name, number))

    def _part(self, deck: Deck, number: int) -> Deck | None:
        """Run a part; the deck of the next one, or None at the end."""
        following = self._known(number + 1)
        self.report.add_part(deck.name)
        if following is not None and not self.replay and self._has_run(number):
            return following   # its results are in the folder
        if not self._path(number).is_file():
            deck.write(self._path(number))
        parts = DeckParts.of(deck)
        bodies = self._bodies(deck, parts)
        state, last = b"", None
        options = {**self.options, "resume": self.resume} if self.resume else self.options
        try:
            with Job(deck, self.output, **options) as job:
                tools = Tools.of(job._session, parts, bodies[0].ndim)
                resumed = Clock.of(job._session).number > 0
                while resumed or job.advance() is not None:
                    resumed = False
                    last, state = Snapshot.of(job, bodies[0]), job.state
                    if following is not None:
                        if _reached(last.clock, Clock.of_start(following)):
                            break
                        continue
                    if number <= self.most and not last.clock.at_end:
                        found = self._next(deck, parts, bodies, number, last, tools)
                        if found is not None:
                            break
                else:
                    return None
        except NotConvergedError as error:
            if error.id == "E0503":
                raise self._more_increments(error, last) from None
            if (last is None or last.clock.number <= 1) and not self.replay and may_fade(deck):
                return self._part(self._faded(deck, number), number)
            if last is None or last.clock.number <= 1 or number > self.most \
                    or last.clock.at_end or self.replay:
                raise
            worn = min(bodies, key=lambda body: worst_corner(last.beside(body).x, body.cells))
            # The run has ended with its failure; its last state is opened again for the tools.
            with Job(deck, state=state, **self.options) as job:
                found = self._remake(deck, number, last.beside(worn),
                                     Tools.of(job._session, parts, worn.ndim), worn.elset,
                                     "the next increment did not converge")
        if following is not None:
            self._path(number).with_suffix(".rst").unlink(missing_ok=True)
            return following
        return self._keep(number + 1, count_on(found[0], last.clock), found[1])

    def _more_increments(self, error: NotConvergedError, last: Snapshot | None) -> Exception:
        """The error of a step that has used up its increments, those of all parts."""
        if last is None:
            return error
        step = self._steps()[last.clock.step - 1]
        return NotConvergedError(
            f"step {last.clock.step} reached time {last.clock.time:.6g} in the "
            f"{increments_of(step)} increments that INC= allows, in all parts of the run",
            id=error.id, help=error.help)

    def _steps(self) -> list[Block]:
        return [b for b in DeckParts.of(self.deck).blocks if b.keyword == "STEP"]

    def _faded(self, deck: Deck, number: int) -> Deck:
        """The deck of a part whose increment at rest does not converge, written anew: what its
        mesh leaves out of balance is let go of over the increments that follow."""
        start = deck["START"]
        start.parameters["RELEASE"] = start.parameters["SEATING"]
        lasts = float(start.parameters["RELEASE"])
        self.say(f"part {number} does not come to rest at once: what its mesh leaves out of "
                 f"balance fades over {lasts:.3g} of time")
        self.report.sums[deck.name] = sum_of(deck.text())
        self.report.write()
        deck.write(self._path(number))
        return deck

    def _bodies(self, deck: Deck, parts: DeckParts) -> list[Body]:
        """The bodies that are meshed anew, as the deck of a part has them; what their meshes began
        with is kept in mind until they are made anew."""
        bodies = [read_body(parts, elset) for elset in self.cards]
        plastic, began = plastic_at_start(deck), Clock.of_start(deck)
        for body in bodies:
            if body.elset not in self.made or int(body.elements[0]) in plastic:
                self.made[body.elset] = Made(plastic, began, worst_corner(body.x, body.cells))
        return bodies

    def _next(self, deck: Deck, parts: DeckParts, bodies: list[Body], number: int, last: Snapshot,
              tools: Tools):
        """The deck of the next part and what was done, where metal separates or a mesh is worn."""
        name = part_name(self.deck.name, number + 1)
        for body in bodies:
            now, critical = last.beside(body), self.critical[body.elset]
            gone, why = torn(body, now, critical)
            apart = bool(critical) and \
                sum(1 for _ in pieces(body, np.zeros(len(body.elements), bool))) > 1
            if gone.any() or apart:
                found = separate(deck, now, tools.session, gone, body.elset, why, number, name,
                                 self.output)
                if found is not None:
                    return found
        for body in bodies:
            now, made = last.beside(body), self.made[body.elset]
            why = reason_to_remesh(body, self.cards[body.elset], made.plastic, made.began, now,
                                   tools, made.quality, seating_of(deck))
            if why:
                return self._remake(deck, number, now, tools, body.elset, why)
        return None

    def _remake(self, deck: Deck, number: int, last: Snapshot, tools: Tools, elset: str,
                why: str):
        """The deck of the next part, and what the remesh did."""
        if len(self.cards) > 1:
            why = f"{elset}: {why}"
        return remake(deck, last, tools, self.cards[elset], why, number,
                      part_name(self.deck.name, number + 1), self.output)

    def _keep(self, number: int, deck: Deck, done: Remesh) -> Deck:
        """Write the deck of a part before it is used, once the files of the last one are whole."""
        self.report.sums[deck.name] = sum_of(deck.text())
        self.report.add(done)
        deck.write(self._path(number))
        for later in self._decks():   # of a run before: made anew from this part on
            if later > self._path(number):
                later.unlink()
        self._path(number - 1).with_suffix(".rst").unlink(missing_ok=True)
        self.say(done.line())
        return deck


def increments_of(step: Block) -> int:
    """Most increments of a step.

    >>> increments_of(Block("STEP", {"INC": "40"})), increments_of(Block("STEP"))
    (40, 100)
    """
    return int(plain(step.parameters.get("INC", MOST_INCREMENTS)))


def count_on(deck: Deck, clock: Clock) -> Deck:
    """The deck of a part with the increments that are left of the step under way, and the one at
    rest, with which it begins."""
    at = [k for k, b in enumerate(deck.blocks) if b.keyword == "STEP"][clock.step - 1]
    step = deck.blocks[at]
    left = max(0, increments_of(step) - clock.number) + 1
    deck.blocks[at] = Block(step.keyword, {**step.parameters, "INC": str(left)})
    deck.blocks[at].lines = step.lines
    return deck


def sum_of(text: str) -> str:
    """A sum of a deck, which tells whether it has been changed."""
    return hashlib.sha256(text.encode(errors="surrogateescape")).hexdigest()


def _of_another(folder: Path, why: str = "") -> ResourceError:
    return ResourceError(f"the parts in '{folder}' are of another deck{why}", id="E0604",
                         help="restore what has changed, or run the deck without --resume")


def plastic_at_start(deck: Deck) -> dict[int, float]:
    """Largest accumulated plastic strain of each element where a part began."""
    found: dict[int, float] = {}
    for block in deck.all("INITIAL CONDITIONS"):
        if str(block.parameters.get("TYPE", "")).upper() == "STATE":
            for row in block.data:
                found[row[0]] = max(found.get(row[0], 0.0), float(row[10] or 0.0))
    return found


def may_fade(deck: Deck) -> bool:
    """Whether a part's mesh settles over a time, and what it leaves out of balance does not yet."""
    return seating_of(deck) > 0.0 and "RELEASE" not in deck["START"].parameters


def seating_of(deck: Deck) -> float:
    """Time over which the mesh of a part is pressed out of the tools [time]."""
    return float(deck["START"].parameters.get("SEATING", 0.0)) if "START" in deck else 0.0


def _reached(now: Clock, end: Clock) -> bool:
    """Whether a part stands where the next one goes on: to the bit, as both were written."""
    return now.step == end.step and np.float64(now.time) == np.float64(end.time)
