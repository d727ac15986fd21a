"""What a run holds where its mesh is made anew: shape, points, tractions, tools, clock."""
from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..points import Points, Tractions
from .body import Body, refused
from .part import Clock


@dataclass
class Snapshot:
    """A run between two increments.

    Attributes
    ----------
    x : present places of the nodes of the body (node, ndim) [length]
    points : what its integration points hold
    tractions : what slave nodes bear; None without contact
    clock : where the run stands
    forces : a row a degree of freedom: label, dof, force that holds the stresses in balance
    motion : a row a degree of freedom: label, dof, displacement, where the step began, load
    """

    x: NDArray
    points: Points
    tractions: Tractions | None
    clock: Clock
    forces: NDArray
    motion: NDArray

    @classmethod
    def of(cls, job, body: Body) -> Snapshot:
        """Of an open run after an accepted increment."""
        motion = job._session.field("STATE OF MOTION")
        points = job.points
        if points is None:
            raise refused("the material remembers nothing that a new mesh could go on with",
                          "remeshing is for metals that flow")
        return cls(present_places(body, motion), points, job.tractions, Clock.of(job._session),
                   job._session.field("STATE OF FORCES"), motion)

    def beside(self, body: Body) -> Snapshot:
        """The same moment, of one body alone: its shape and its points."""
        return replace(self, x=present_places(body, self.motion),
                       points=self.points.within(body.elements))

    def forces_on(self, body: Body) -> NDArray:
        """Forces of loads, supports and contacts on the nodes of a body (node, ndim)."""
        return of_nodes(body, self.forces[:, :3])

    def moved(self, body: Body) -> NDArray:
        """Rows of `motion` of nodes that are not meshed anew and have moved or bear a load."""
        stays = ~np.isin(self.motion[:, 0], body.labels)
        return self.motion[stays & (np.abs(self.motion[:, 2:]) > 0.0).any(axis=1)]

    def fading_on(self, body: Body) -> NDArray:
        """What the nodes of a body bore, where the step began, of supports and pairs that it lets
        go of (node, ndim): it fades over the step. Other loads on nodes are refused at the start.
        """
        return of_nodes(body, self.motion[:, [0, 1, 4]])


def present_places(body: Body, motion: NDArray) -> NDArray:
    """Of the nodes of a body (node, ndim) [length]."""
    return body.x + of_nodes(body, motion)


def of_nodes(body: Body, table: NDArray) -> NDArray:
    """Third column of a table of degrees of freedom, at the nodes of a body (node, ndim)."""
    found = np.zeros_like(body.x)
    at = {int(label): k for k, label in enumerate(body.labels)}
    rows = np.array([at.get(int(label), -1) for label in table[:, 0]])
    own = (rows >= 0) & (table[:, 1] <= body.ndim)
    found[rows[own], table[own, 1].astype(int) - 1] = table[own, 2]
    return found
