"""Runs on finer meshes and in smaller increments until a number is known as well as it was asked.

The error of a mesh is taken from the differences between runs on meshes of cells of half the size:
two meshes give a bound that holds where the error falls at least in proportion to the size, three
give the order of its fall. The error of the increments is that between a run and one in increments
of half the size, on the first mesh. Nothing is refined where the answer does not depend on it.
"""
from __future__ import annotations

import json
import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path


from ..deck import Block, Deck
from ..errors import NotConvergedError, UsageError
from ..files import whole_file
from ..model_read_mesh import expanded, named_from
from ..refine import refined, size_of_refined
from ..result import Result
from ..run import as_deck, check, run
from .increments import depends_on_path, with_smaller
from .quantity import Quantity

#: Solid elements of a mesh that is not made any more, in the plane and in space.
MOST = {2: 400_000, 3: 60_000}
#: Orders of the error's fall that are believed: of linear elements, of quadratic ones.
LEAST_ORDER, MOST_ORDER = 0.5, {False: 2.0, True: 3.0}
#: Shares of the error asked for that increments may take.
OF_INCREMENTS = 0.4


@dataclass
class Level:
    """One run."""

    mesh: int                 #: halvings of the cells
    increments: float         #: length beside those of the deck itself
    elements: int
    equations: int
    value: float
    difference: float         #: from the run before, on the coarser mesh; nan: none
    change: float             #: the same with its sign; of a norm, without
    seconds: float
    verdict: str


@dataclass
class Reached:
    """What was found.

    Attributes
    ----------
    quantity, target : what was asked, and how well
    value : on the last mesh
    mesh, increments, enforcement : estimates of the parts of the relative error
    order : of the fall of the error with the size of cells; nan where two meshes were enough
    levels : the runs, in their order
    result : of the last mesh
    uneven : part of `enforcement` that facets which do not match make of the pressure (W0333)
    warnings : of the last run
    filled_in : displacements given node by node, straight between the nodes of the deck
    reason : why the error asked for was not met; empty: it was
    """

    quantity: Quantity
    target: float
    value: float = math.nan
    mesh: float = math.nan
    increments: float = 0.0
    enforcement: float = 0.0
    uneven: float = 0.0
    warnings: list[str] = field(default_factory=list)
    order: float = math.nan
    levels: list[Level] = field(default_factory=list)
    result: Result | None = field(default=None, repr=False)
    deck: Deck | None = field(default=None, repr=False)
    filled_in: int = 0
    reason: str = ""

    @property
    def error(self) -> float:
        """Estimate of the relative error; nan: there is none."""
        return self.mesh + self.increments + self.enforcement

    @property
    def met(self) -> bool:
        """Whether the error asked for was met."""
        return not self.reason and self.error <= self.target

    @property
    def cost(self) -> float:
        """CPU time of all runs beside that of the last."""
        return sum(v.seconds for v in self.levels)/max(self.levels[-1].seconds, 1e-9)

    def text(self) -> str:
        """A table of the runs, and the answer."""
        lines = [f"{'mesh':>5} {'elements':>9} {'equations':>10} {'increments':>11} {'value':>14} "
                 f"{'change %':>9} {'s':>8}"]
        for v in self.levels:
            change = "" if math.isnan(v.difference) else f"{100.0*v.difference/abs(v.value):.3g}" \
                if v.value else "nan"
            lines.append(f"{v.mesh:>5} {v.elements:>9} {v.equations:>10} "
                         f"{'x ' + format(v.increments, 'g'):>11} {v.value:>14.7g} {change:>9} "
                         f"{v.seconds:>8.2f}")
        order = "" if math.isnan(self.order) else f" (falls as size^{self.order:.2g})"
        known = "error unknown" if math.isnan(self.error) else \
            f"+- {abs(self.value)*self.error:.2g} ({100.0*self.error:.2g} %)"
        mesh = "not known" if math.isnan(self.mesh) else f"{100.0*self.mesh:.2g} %{order}"
        lines.append(f"{self.quantity}: {self.value:.7g} {known}, {100.0*self.target:g} % asked: "
                     f"mesh {mesh}, increments {100.0*self.increments:.2g} %, contact "
                     f"{100.0*self.enforcement:.2g} %")
        lines.append(f"cost: {self.cost:.2g} times the last run")
        lines += [f"warning: {line}" for line in self.warnings]
        if self.filled_in:
            lines.append("displacements are given node by node: between the nodes of the deck they "
                         "are taken as straight, whose error is not in the estimate")
        if self.reason:
            lines.append(f"not met: {self.reason}")
        return "\n".join(lines)

    def json(self) -> str:
        """All of it but the result."""
        kept = {k: getattr(self, k) for k in ("target", "value", "error", "mesh", "increments",
                                              "enforcement", "order", "met", "filled_in",
                                              "reason", "cost", "uneven", "warnings")}
        kept["quantity"] = str(self.quantity)
        kept["runs"] = [vars(v) for v in self.levels]
        return json.dumps(kept, default=str).replace("NaN", "null")


def reach(scene, quantity: Quantity | None = None, target: float | None = None,
          output: str | Path | None = None, *, say: Callable[[str], None] = lambda line: None,
          most_elements: int | None = None, **options) -> Reached:
    """Know a number as well as asked.

    Parameters
    ----------
    scene : deck, model or path; its *LOPIN, QUANTITY=, TARGET ERROR= where they are not given
    quantity, target : what is asked, and the relative error
    output : folder of all runs: mesh0, mesh1...
    say : told a line for each run
    most_elements : solid elements of the finest mesh; a number for each kind of scene unless given
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
    quantity = quantity or given[0]
    search = _Search(without_question(deck), quantity, target or (given[1] if given else 0.01),
                     output, say, most_elements, options)
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

    def __init__(self, deck, quantity, target, output, say, most, options):
        self.deck, self.output, self.say, self.options = deck, output, say, options
        self.found = Reached(quantity, target)
        self.most = most
        self.factor = 1.0     #: of the increments

    def run(self) -> Reached:
        """All runs that are needed."""
        found, deck, number = self.found, self.deck, 0
        last = self._solve(deck, number, 0)
        if found.value == 0.0:
            found.reason = f"the {found.quantity} is 0: it has no relative error; ask for that " \
                "of one tool by SET, or for another direction"
        if found.enforcement > found.target and not found.reason:
            found.reason = self._contact_alone()
        if depends_on_path(deck) and not found.reason:
            last = self._settle_increments(deck, last)
        while not found.reason:
            size = size_of_refined(deck)
            dims = 3 if found.result["displacement"].shape[1] == 3 else 2
            limit = self.most or MOST[dims]
            if size > limit:
                found.reason = self._out_of_reach(size, limit, dims)
                break
            finer = refined(deck)
            deck, number = finer.deck, number + 1
            found.filled_in = max(found.filled_in, finer.filled_in)
            last = self._solve(deck, number, finer.n_element, last)
            self._estimate(_quadratic(deck))
            if found.reason or found.error <= found.target:
                break
        return found

    def _solve(self, deck: Deck, number: int, elements: int, before=None):
        """One run; with the one on the coarser mesh, how far they are apart."""
        found = self.found
        smaller = deck if self.factor == 1.0 else with_smaller(deck, self.first, self.factor)
        begin = time.process_time()
        folder = None if self.output is None else Path(self.output)/f"mesh{number}"
        if folder is not None:
            smaller = named_from(Deck(smaller.blocks, preamble=smaller.preamble,
                                      name=smaller.name, folder=folder), deck.folder)
        result = run(smaller, folder, **self.options)
        seconds = time.process_time() - begin
        value = found.quantity.value(result, deck)
        apart = math.nan if before is None else found.quantity.difference(
            result, before[0], (value, before[1]))
        found.levels.append(Level(number, self.factor, elements or result.summary["model"][
            "elements"], result.summary["equations"], value, apart,
            math.nan if before is None else found.quantity.change(apart, value, before[1]),
            seconds, result.verdict))
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

    def _settle_increments(self, deck: Deck, last):
        """Increments whose error leaves room for that of the mesh."""
        found = self.found
        for _ in range(6):
            before, self.factor = last, 0.5*self.factor
            last = self._solve(deck, 0, 0)
            apart = found.quantity.difference(last[0], before[0], (last[1], before[1]))
            # Of first order in their length: what is left is as much as was gained.
            found.increments = apart/max(abs(last[1]), 1e-300)
            if found.increments <= OF_INCREMENTS*found.target:
                break
        else:
            found.reason = f"increments of 1/{1.0/self.factor:g} still change it by " \
                f"{100.0*found.increments:.2g} %"
        return last

    def _estimate(self, quadratic: bool) -> None:
        """The error of the mesh from the differences between meshes."""
        found = self.found
        known = [v for v in found.levels if not math.isnan(v.difference)]
        apart, changes = [v.difference for v in known], [v.change for v in known]
        scale = max(abs(found.value), 1e-300)
        order = 1.0
        if len(apart) > 1 and changes[-1]*changes[-2] < 0.0:
            # Changes to and fro have no order: the answer may be off by as much as they are.
            found.order, apart = math.nan, [*apart[:-1], max(apart[-2:])]
        elif len(apart) > 1:
            ratio = apart[-2]/max(apart[-1], 1e-300)
            order = min(max(math.log2(max(ratio, 1e-3)), LEAST_ORDER), MOST_ORDER[quadratic])
            found.order = math.log2(max(ratio, 1e-3))
        found.mesh = apart[-1]/(2.0**order - 1.0)/scale
        grows = [b >= a for a, b in zip(apart, apart[1:])]
        if len(grows) >= 2 and all(grows[-2:]) and found.mesh > found.target:
            found.reason = f"the {found.quantity} changes more with each finer mesh " \
                f"({', '.join(f'{100.0*v/scale:.2g} %' for v in apart)}): it has no limit, as at " \
                "a sharp edge; ask for a force, a displacement or PRESSURE"

    def _contact_alone(self) -> str:
        """What no finer mesh makes better."""
        found = self.found
        if found.uneven > 0.5*found.enforcement:
            return f"facets that do not match make the pressure uneven by about " \
                f"{100.0*found.uneven:.2g} % (W0333), whatever the mesh: TYPE=SURFACE TO SURFACE"
        return f"the stiffness of contact alone leaves {100.0*found.enforcement:.2g} %, whatever " \
            "the mesh: *SURFACE BEHAVIOR, DIRECT; a slope that is a law of the surface itself is " \
            "PRESSURE-OVERCLOSURE=TABULAR, whose points are no error"

    def _out_of_reach(self, elements: int, limit: int, dims: int) -> str:
        """What would meet it."""
        found = self.found
        if math.isnan(found.mesh):
            return f"a finer mesh has {elements} elements, above {limit}"
        order = 1.0 if math.isnan(found.order) else \
            min(max(found.order, LEAST_ORDER), MOST_ORDER[False])
        room = found.target - found.increments - found.enforcement
        if room <= 0.0:
            return f"increments and contact alone leave {100.0*(found.error - found.mesh):.2g} %"
        halvings = math.ceil(math.log2(found.mesh/room)/order)
        needed = found.levels[-1].elements*2**(dims*halvings)
        return f"{100.0*found.error:.2g} % of {100.0*found.target:g} % is met with " \
            f"{found.levels[-1].elements} elements; about {needed} would meet it, above {limit}: " \
            "refine the deck's mesh where the pressure changes, or take quadratic elements"


def _quadratic(deck: Deck) -> bool:
    """Whether all solid elements are of second order."""
    from ..refine.subdivide import cell_of

    cells = {cell_of(str(b.parameters["TYPE"])) for b in deck.all("ELEMENT")} - {None}
    return all(name[-1].isdigit() for name in cells)
