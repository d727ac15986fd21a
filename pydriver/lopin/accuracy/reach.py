"""Runs on finer meshes and in smaller increments until a number is known as well as it was asked.

The error of a mesh is taken from the differences between runs on meshes of cells of half the
size: two meshes give a bound that holds where the error falls at least in proportion to the size,
three give the order of its fall. The error of the increments is that between a run and one in
increments of half the size, on the first mesh; it grows on finer ones. Nothing is refined where
the answer does not depend on it.
"""
from __future__ import annotations

import math
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from ..deck import Block, Deck
from ..errors import LopinError, NotConvergedError, UsageError
from ..files import whole_file
from ..model_read_mesh import expanded, named_from
from ..refine import refuse
from ..result import Result
from ..run import as_deck, check, run
from .dual import HOPS, LOST, SMALL, Estimate, Question
from .ends import closed_at_an_end
from .increments import Settled, depends_on_path, left_by_increments, on_path, with_smaller
from .mesh_error import END, INSIDE, error_of_mesh, halved
from .meshes import Meshes
from .quantity import Quantity, at, place_of
from .reached import Level, Reached
from .refusals import contact_alone, no_limit, out_of_reach, out_of_time, slides

#: Solid elements of a mesh that is not made any more, in the plane and in space.
MOST = {2: 400_000, 3: 60_000}
#: Shares of the error asked for that increments may take.
OF_INCREMENTS = 0.4
#: On a finer mesh increments leave more: what they do, with each halving of the cells, as a power
#: of two (the ring of docs/accuracy.md: 1.4 times), and the share from which they are made smaller.
GROWS, MOST_OF_INCREMENTS = 0.5, 0.6
#: Halvings of the increments that cost less than a finer mesh.
SHORTER = 2
#: Part of the change from mesh to mesh that a mesh may have gone beyond the limit.
TOO_FAR = 0.5
#: Share of the error asked for that the shape of the start may take.
OF_SLIDING = 0.8
#: Share of their room below which the order of increments need not be known.
PLAIN = 0.25
#: Halvings of the increments that are tried.
HALVINGS = 7
#: Runs for a dual problem: of a size that is guessed, of one that is known, of a smaller one.
TRIES, SMALLER = 3, 0.01
#: What the dual problem foretells where there is none.
UNKNOWN = math.nan, math.nan
#: Share of the room that the parts of the error may take on the next mesh, and by how much their
#: sum falls at least: so much that it is seen whether the dual problem foretells it.
OF_ROOM, AT_LEAST = 0.4, 2.5


def reach(scene, quantity: Quantity | None = None, target: float | None = None,
          output: str | Path | None = None, *, say: Callable[[str], None] = lambda line: None,
          most_elements: int | None = None, most_seconds: float = math.inf,
          **options) -> Reached:
    """Know a number as well as asked.

    Parameters
    ----------
    scene : deck, model or path; its *LOPIN, QUANTITY=, TARGET ERROR= where they are not given
    quantity, target : what is asked, and the relative error
    output : folder of all runs: mesh0, mesh1...
    say : told a line for each run
    most_elements : solid elements of the finest mesh; a number for each kind of scene unless given
    most_seconds : CPU time of a run that is not begun, by that of the last two meshes
    options : as of `lopin.run`

    Raises
    ------
    NotConvergedError : it cannot be had; the message says what would meet it, `reached` of the
        exception is what was found.
    """
    deck = as_deck(scene)
    check(deck)   # names the place of what it cannot read
    given = Quantity.of(deck)
    if quantity is None and given is None:
        raise UsageError("nothing is asked for: *LOPIN, QUANTITY=FORCE, TARGET ERROR=0.01")
    with at(*place_of(deck)):
        quantity = (quantity or given[0]).checked(deck).of_nodes(deck)
    refuse(deck)
    search = _Search(without_question(deck), quantity, target or (given[1] if given else 0.01),
                     output, say, (most_elements, most_seconds), options)
    found = search.run()
    if output is not None:
        with whole_file(Path(output)/f"{deck.name}.accuracy.json") as part:
            part.write_text(found.json() + "\n", encoding="utf-8")
    if found.reason:
        problem = NotConvergedError(found.reason, id="E0622")
        problem.reached, problem.result = found, found.result
        raise problem
    return found


def without_question(deck: Deck) -> Deck:
    """The deck of each run: it asks for nothing."""
    blocks = []
    for block in expanded(deck):
        if block.keyword == "LOPIN":
            block = Block("LOPIN", {k: v for k, v in block.parameters.items()
                                    if k not in ("QUANTITY", "SET", "COMPONENT")})
        blocks.append(block)
    return Deck(blocks, preamble=deck.preamble, name=deck.name, folder=deck.folder)


class _Search:
    """The runs of one question."""

    def __init__(self, deck, quantity, target, output, say, most=(None, math.inf), options=None):
        self.deck, self.output, self.say, self.options = deck, output, say, options or {}
        self.found = Reached(quantity, target, no_dual="the answer depends on the way to it"
                             if depends_on_path(deck) else "")
        self.most, self.most_seconds = most
        self.factor = 1.0     #: of the increments
        self.meshes = Meshes(deck)
        self.estimate: Estimate | None = None   #: of the last run, by the dual problem
        self.settled: Settled | None = None   #: what increments leave on the first mesh
        self.small = SMALL    #: change of the parameter of the dual problem beside its size
        self.moved = 0.0      #: largest displacement of the last run; 0: not known
        self.whole = None     #: result and value of the last mesh that was not refined in part
        self.files = -1       #: mesh of the last run that wrote its files

    def run(self) -> Reached:
        """All runs that are needed."""
        found, deck, number = self.found, self.deck, 0
        last = self.whole = self._solve(deck, number, 0)
        if found.value == 0.0:
            found.reason = f"the {found.quantity} is 0: it has no relative error; ask for that " \
                "of one tool by SET, or for another direction"
        if found.enforcement > found.target and not found.reason:
            found.reason = contact_alone(found)
        if self._slide(deck, *last):
            last = self.whole = self._solve(self.meshes.deck, number, 0)
        deck = self.meshes.deck
        if depends_on_path(deck) and not found.reason:
            last = self.whole = self._settle_increments(deck, last)
        while not found.reason:
            if self._must_be_shorter():
                last = self.whole = self._solve(deck, number, self.meshes.n_element)
            if not self._refine():
                break
            if found.levels[-1].given_up:
                last = self.whole
            deck, number = self.meshes.deck, number + 1
            found.filled_in, found.rounded = self.meshes.filled_in, self.meshes.rounded
            last = self._solve(deck, number, self.meshes.n_element, last)
            if found.levels[-1].uniform:
                self.whole = last
            self._estimate(_quadratic(deck))
            if not found.reason and self._increments_alone():
                last = self._shorten(deck, number)
            if found.reason or found.error <= found.target:
                break
        self._write()
        return found

    def _slide(self, deck: Deck, result: Result, value: float) -> bool:
        """One path for all meshes, where the plan would choose by the way that nodes slide beside
        their facets: contact on the shape at the start. What the present shape changes on the
        first mesh is a part of the error; where that is too much, contact follows it on all
        meshes, but for pressures, whose area may be meant either way. Whether it does."""
        found = self.found
        paths = [on_path(deck, name) for name in ("CONDENSED", "FINITE")]
        if depends_on_path(deck) or result.summary.get("path") != "condensed" or None in paths \
                or not result.pairs or found.reason:
            return False
        begin = time.process_time()
        try:
            other = run(paths[1], **self.options)
        except LopinError:
            return False   # the deck's own path is what was asked for
        apart = found.quantity.difference(other, result, (found.quantity.value(other, deck), value))
        found.written += time.process_time() - begin
        found.sliding = apart/max(abs(value), 1e-300)
        found.follows = found.sliding > OF_SLIDING*found.target
        if found.follows and "PRESSURE" in found.quantity.kind:
            found.follows, found.reason = False, slides(found)
        self.meshes = Meshes(paths[found.follows])
        if found.follows:
            found.left_out, found.sliding = found.sliding, 0.0
            found.levels[-1].given_up = True
        return found.follows

    def _refine(self) -> bool:
        """A finer mesh: where the dual problem has the parts of the error, if it can be believed;
        else everywhere. Whether there is one."""
        found, meshes = self.found, self.meshes
        dims = 3 if found.in_space else 2
        limit = self.most or MOST[dims]
        if self.estimate is not None and (found.levels[-1].mesh == 0 or found.by_dual):
            room = found.target - found.besides
            most = np.abs(self.estimate.parts).sum()
            goal = min(OF_ROOM*room*abs(found.value), most/AT_LEAST)
            if room > 0.0 and meshes.spend(self.estimate.labels, self.estimate.parts, goal):
                if meshes.n_element > limit:
                    found.reason = out_of_reach(found, meshes.n_element, limit, dims)
                return not found.reason
        if not found.levels[-1].uniform:
            # What was refined in part did not do what was foretold: whole meshes from the last.
            meshes.begin_again()
            for level in reversed(found.levels):
                if level.uniform:
                    break
                level.given_up = True
        size = meshes.size()
        if size > limit:
            found.reason = out_of_reach(found, size, limit, dims)
            return False
        meshes_run = [v for v in found.levels if v.increments == self.factor][-2:]
        ahead = meshes_run[-1].seconds*max(2.0**dims, meshes_run[-1].seconds/max(
            meshes_run[0].seconds, 1e-9))
        if ahead > self.most_seconds:
            found.reason = out_of_time(found, size, ahead, self.most_seconds)
            return False
        meshes.halve()
        return True

    def _solve(self, deck: Deck, number: int, elements: int, before=None):
        """One run; with the one on the coarser mesh, how far they are apart."""
        found = self.found
        smaller = deck if self.factor == 1.0 else with_smaller(deck, self.first, self.factor)
        begin = time.process_time()
        result, (foretold, unsure) = self._run(smaller, number)
        seconds = time.process_time() - begin
        value = found.quantity.value(result, deck)
        apart = math.nan if before is None else found.quantity.moved(
            result, before[0], (value, before[1]))
        found.levels.append(Level(number, self.factor, elements or result.summary["model"][
            "elements"], result.summary["equations"], value, apart,
            math.nan if before is None else found.quantity.change(apart, value, before[1]),
            seconds, result.verdict, foretold, number == 0 or self.meshes.uniform, unsure))
        found.value, found.result, found.deck = value, result, deck
        found.warnings = list(result.warnings)
        found.uneven = found.quantity.uneven(result)
        found.enforcement = found.uneven + max(0.0, float(
            (result.summary.get("certificate") or {}).get("pressure_error") or 0.0))
        if self.factor == 1.0 and number == 0:
            self.first = result
        self.say(f"mesh {number}: {result.summary['equations']} equations, {found.quantity} "
                 f"{value:.7g}" + ("" if math.isnan(apart) else f", {apart:.2g} from the last"))
        return result, value

    def _run(self, deck: Deck, number: int) -> tuple[Result, tuple[float, float]]:
        """A run, with that of the dual problem where there is one: what that foretells, and what
        it may be off by."""
        found, self.estimate = self.found, None
        for _ in range(TRIES) if not found.no_dual else ():
            try:
                question = Question.of(deck, found.quantity, self.moved, self.small)
                if isinstance(question, str):
                    found.no_dual = question
                    break
                result = run(question.added(deck), **self.options)
                estimate = question.estimate(result, deck)
            except LopinError as problem:   # of the further steps, or the run without them says it
                found.no_dual = problem.message
                break
            guessed = self.moved == 0.0
            self.moved = float(np.abs(result["displacement"]).max())
            if estimate == LOST and guessed:
                continue   # the size of displacements is known now
            if estimate == HOPS and self.small == SMALL:
                self.small *= SMALLER   # slender bodies press by far smaller ways
                continue
            if isinstance(estimate, str):
                found.no_dual = estimate
                return question.split(result), UNKNOWN
            self.estimate = estimate
            return question.split(result), (estimate.change, estimate.unsure)
        self.files = number
        return run(self._placed(deck, number), self._folder(number), **self.options), UNKNOWN

    def _folder(self, number: int) -> Path | None:
        return None if self.output is None else Path(self.output)/f"mesh{number}"

    def _placed(self, deck: Deck, number: int) -> Deck:
        """The deck as it is written into its folder."""
        folder = self._folder(number)
        if folder is None:
            return deck
        return named_from(Deck(deck.blocks, preamble=deck.preamble, name=deck.name,
                               folder=folder), deck.folder)

    def _write(self) -> None:
        """Files of the last run, if it was made in memory for the dual problem."""
        found, number = self.found, self.found.levels[-1].mesh
        if self.output is None or self.files == number:
            return
        begin = time.process_time()
        found.result = run(self._placed(found.deck, number), self._folder(number), **self.options)
        found.written += time.process_time() - begin

    def _settle_increments(self, deck: Deck, last):
        """Increments whose error leaves room for that of the mesh: the longest of those tried."""
        found, runs, changes = self.found, [(1.0, last)], []
        room = OF_INCREMENTS*found.target*max(abs(last[1]), 1e-300)
        for _ in range(HALVINGS):
            before, self.factor = last, 0.5*self.factor
            last = self._solve(deck, 0, 0)
            apart = found.quantity.difference(last[0], before[0], (last[1], before[1]))
            changes.append(math.copysign(apart, found.levels[-1].value - found.levels[-2].value))
            runs.append((self.factor, last))
            left = left_by_increments(changes)
            enough = next((k for k, v in enumerate(left) if v <= room), None)
            if enough is not None and (len(changes) > 1 or left[0] <= PLAIN*room):
                break
        else:
            found.increments = left[-1]/max(abs(last[1]), 1e-300)
            found.reason = f"increments of 1/{1.0/self.factor:g} still change it by " \
                f"{100.0*found.increments:.2g} %"
            return last
        self.factor, last = runs[enough]
        self.settled = Settled.of([f for f, _ in runs], changes, enough,
                                  found.quantity.kind != "PRESSURE")
        found.increments = left[enough]/max(abs(last[1]), 1e-300)
        return last

    def _left(self, number: int) -> float:
        """What increments leave on a mesh, beside the number: more than on the first one."""
        grown = 2.0**(GROWS*number)
        return grown*self.settled.at(self.factor)/max(abs(self.found.value), 1e-300)

    def _must_be_shorter(self) -> bool:
        """Smaller increments for the next mesh, if there those settled leave too much."""
        before, number = self.factor, self.found.levels[-1].mesh + 1
        while self.settled and self._left(number) > MOST_OF_INCREMENTS*self.found.target:
            self.factor *= 0.5
        return self.factor < before

    def _increments_alone(self) -> bool:
        """Whether smaller increments on the same mesh would do: cheaper than a finer mesh."""
        found = self.found
        return bool(self.settled and found.target < found.error and found.error - found.increments
                    + found.against + 0.5**SHORTER*found.increments <= found.target)

    def _shorten(self, deck: Deck, number: int):
        """Such a run; what the mesh leaves is what it did with the increments before."""
        found, before = self.found, self.found.levels[-1]
        while found.error > found.target:
            self.factor *= 0.5
            found.against, found.increments = 0.0, self._left(number)
        before.given_up = True
        last = self.whole = self._solve(deck, number, before.elements)
        found.levels[-1].difference, found.levels[-1].change = before.difference, before.change
        self._estimate(_quadratic(deck))
        return last

    def _estimate(self, quadratic: bool) -> None:
        """The error of the mesh from the differences between meshes."""
        found = self.found
        scale = max(abs(found.value), 1e-300)
        levels = [v for v in found.levels if not v.given_up]
        pressure = "PRESSURE" in found.quantity.kind
        rough = pressure and any(line.startswith("W0409") for line in found.warnings)
        error, found.order, found.by_dual = error_of_mesh(levels, quadratic, found.in_space,
                                                          pressure, rough, self._peak(levels))
        found.mesh = error/scale if math.isfinite(error) else math.nan
        if found.result is not None and depends_on_path(found.deck):
            found.ripple = found.quantity.ripple(found.result, found.deck)/scale
        if self.settled is not None:
            found.increments = self._left(levels[-1].mesh)
            found.against = self._against(levels)
        found.reason = found.reason or no_limit(found, levels)

    def _peak(self, levels) -> str:
        """Where a largest pressure is: looked at where it counts, for the first change."""
        found = self.found
        if found.quantity.kind != "PEAK PRESSURE" or found.result is None:
            return ""
        at_end = len(halved(levels)) == 1 and closed_at_an_end(self.deck, found.result)
        return END if at_end else INSIDE

    def _against(self, levels) -> float:
        """What mesh and increments take from each other where one leaves too much and the other too
        little, each by the least that it may be: the mesh as far back as it may have gone too far.
        """
        found, own = self.found, self.settled
        changes = [v.change for v in halved(levels)]
        if not changes or own.sign*changes[-1] >= 0.0 or not math.isfinite(found.mesh) or \
                len(changes) > 1 and changes[-1]*changes[-2] < 0.0:
            return 0.0
        share = own.least/max(own.most, 1e-300)*found.increments*2.0**(-GROWS*levels[-1].mesh)
        return found.mesh + found.increments - max(found.mesh - share,
                                                   TOO_FAR*found.mesh + found.increments)


def _quadratic(deck: Deck) -> bool:
    """Whether all solid elements are of second order."""
    from ..refine.children import cell_of

    cells = {cell_of(str(b.parameters["TYPE"])) for b in deck.all("ELEMENT")} - {None}
    return all(name[-1].isdigit() for name in cells)
