"""What was found of a number, and by which runs."""
from __future__ import annotations

import json
import math
from dataclasses import dataclass, field

from ..deck import Deck
from ..result import Result
from .quantity import Quantity


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
    foretold: float = math.nan   #: exact value less this one, by the dual problem; nan: none
    uniform: bool = True         #: every cell of the mesh before was halved
    unsure: float = 0.0          #: what `foretold` may be off by
    given_up: bool = False       #: meshes after it are not made from it


@dataclass
class Reached:
    """What was found.

    Attributes
    ----------
    quantity, target : what was asked, and how well
    value : on the last mesh
    mesh, increments, enforcement, sliding : estimates of the parts of the relative error; the last
        is what contact on the present shape would change, where that at the start is solved
    follows : contact follows the present shape on all meshes; `left_out` is what that at the start
        would have been off by
    ripple : of a force that goes to and fro where it ends, half the swing; falls with the mesh
    against : what mesh and increments take from each other, since their errors differ in sign
    order : of the fall of the error with the size of cells; nan where two meshes were enough
    by_dual : `mesh` is what the dual problem says
    no_dual : why there is no dual problem; empty: there is
    written : CPU time of runs beside those of the levels [s]
    levels : the runs, in their order
    result : of the last mesh
    uneven : part of `enforcement` that facets which do not match make of the pressure (W0333)
    warnings : of the last run
    filled_in : displacements given node by node, straight between the nodes of the deck
    rounded : how far the middle of an edge was moved onto a smooth boundary, beside the edge, at
        most; 0: boundaries are those of the deck
    reason : why the error asked for was not met; empty: it was
    """

    quantity: Quantity
    target: float
    value: float = math.nan
    mesh: float = math.nan
    increments: float = 0.0
    enforcement: float = 0.0
    sliding: float = 0.0
    follows: bool = False
    left_out: float = 0.0
    ripple: float = 0.0
    against: float = 0.0
    uneven: float = 0.0
    warnings: list[str] = field(default_factory=list)
    order: float = math.nan
    by_dual: bool = False
    no_dual: str = ""
    written: float = 0.0
    levels: list[Level] = field(default_factory=list)
    result: Result | None = field(default=None, repr=False)
    deck: Deck | None = field(default=None, repr=False)
    filled_in: int = 0
    rounded: float = 0.0
    reason: str = ""

    @property
    def error(self) -> float:
        """Estimate of the relative error; nan: there is none."""
        return self.mesh + self.besides + self.ripple - self.against

    @property
    def besides(self) -> float:
        """What is left of it on the finest mesh."""
        return self.increments + self.enforcement + self.sliding

    @property
    def in_space(self) -> bool:
        """Whether the scene is one of three dimensions."""
        return self.result is not None and self.result["displacement"].shape[1] == 3

    @property
    def met(self) -> bool:
        """Whether the error asked for was met."""
        return not self.reason and self.error <= self.target

    @property
    def cost(self) -> float:
        """CPU time of all runs beside that of the last."""
        every = sum(v.seconds for v in self.levels) + self.written
        return every/max(self.levels[-1].seconds, 1e-9)

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
        order = " (dual problem)" if self.by_dual else "" if math.isnan(self.order) else \
            f" (falls as size^{self.order:.2g})"
        known = "error unknown" if math.isnan(self.error) else \
            f"+- {abs(self.value)*self.error:.2g} ({100.0*self.error:.2g} %)"
        mesh = "not known" if math.isnan(self.mesh) else f"{100.0*self.mesh:.2g} %{order}"
        lines.append(f"{self.quantity}: {self.value:.7g} {known}, {100.0*self.target:g} % asked: "
                     f"mesh {mesh}, increments {100.0*self.increments:.2g} %, contact "
                     f"{100.0*self.enforcement:.2g} %, small sliding {100.0*self.sliding:.2g} %"
                     + (f", a force that goes to and fro {100.0*self.ripple:.2g} %"
                        if self.ripple else "")
                     + (f", less {100.0*self.against:.2g} % since mesh and increments err in "
                        "opposite directions" if self.against else ""))
        if self.follows:
            lines.append("contact follows the present shape (path finite) on all meshes: that at "
                         f"the start differs by {100.0*self.left_out:.2g} %")
        lines.append(f"cost: {self.cost:.2g} times the last run")
        lines += [f"warning: {line}" for line in self.warnings]
        if self.filled_in:
            lines.append("displacements are given node by node: between the nodes of the deck they "
                         "are taken as straight, whose error is not in the estimate")
        if self.rounded:
            lines.append("boundaries of straight edges that turn alike from node to node are taken "
                         "as arcs: middles of edges were moved by up to "
                         f"{100.0*self.rounded:.2g} % of the edge")
        if self.reason:
            lines.append(f"not met: {self.reason}")
        return "\n".join(lines)

    def json(self) -> str:
        """All of it but the result."""
        kept = {k: getattr(self, k) for k in (
            "target", "value", "error", "mesh", "increments", "enforcement", "sliding", "ripple",
            "follows", "left_out", "against", "order", "met", "filled_in", "rounded", "reason",
            "cost", "uneven", "warnings", "by_dual", "no_dual")}
        kept["quantity"] = str(self.quantity)
        kept["runs"] = [vars(v) for v in self.levels]
        return json.dumps(kept, default=str).replace("NaN", "null")
