"""How presses and hammers move their tool: cranks by geometry, screws and hammers by energy.

A deck prescribes where a tool goes. A crank's way over time is an amplitude (`Crank.amplitude`); a
screw press and a hammer have an energy to spend, and stand when it is spent (`blow`); how fast they
go on the way follows from what is left of it (`times_of_blow`).
"""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import UsageError
from .job import Job


@dataclass(frozen=True)
class Crank:
    """A crank press.

    Attributes
    ----------
    radius : of the crank, half of the stroke [length]
    rod : length of the connecting rod, more than the radius [length]
    turns : in unit time [1/time]
    """

    radius: float
    rod: float
    turns: float

    def __post_init__(self):
        if not 0.0 < self.radius < self.rod < np.inf or not 0.0 < self.turns < np.inf:
            raise UsageError(f"no crank has radius {self.radius:g}, rod {self.rod:g} and "
                             f"{self.turns:g} turns", help="0 < radius < rod, turns > 0")

    def height(self, angle: ArrayLike) -> NDArray:
        """Of the ram above its lowest place, at an angle before it [rad].

        >>> float(Crank(50.0, 300.0, 1.0).height(np.pi))
        100.0
        """
        angle = np.asarray(angle, float)
        return self.radius*(1.0 - np.cos(angle)) \
            + self.rod - np.sqrt(self.rod**2 - (self.radius*np.sin(angle))**2)

    def angle(self, height: float) -> float:
        """Before the lowest place, at a height above it [rad]."""
        if not 0.0 <= height <= 2.0*self.radius:
            raise UsageError(f"the ram is at most {2.0*self.radius:g} above its lowest place, not "
                             f"{height:g}")
        # The law of cosines of crank, rod and the distance between their ends.
        far = self.radius + self.rod - height
        cosine = (self.radius**2 + far**2 - self.rod**2)/(2.0*self.radius*far)
        return float(np.arccos(np.clip(cosine, -1.0, 1.0)))

    def speed(self, height: float) -> float:
        """Of the ram down, at a height above its lowest place [length/time]."""
        a = self.angle(height)
        tilt = np.sqrt(self.rod**2 - (self.radius*np.sin(a))**2)
        rise = self.radius*np.sin(a)*(1.0 + self.radius*np.cos(a)/tilt)
        return float(2.0*np.pi*self.turns*rise)

    def amplitude(self, travel: float, points: int = 41, name: str = "CRANK") -> tuple[str, float]:
        """The card *AMPLITUDE of the last `travel` down to the lowest place, a share of it over
        time, and the period that the step has [time]."""
        if not 0.0 < travel <= 2.0*self.radius:
            raise UsageError(f"no crank of radius {self.radius:g} moves by a last {travel:g}",
                             help=f"above 0, at most {2.0*self.radius:g}")
        if not points >= 2:
            raise UsageError(f"an amplitude has at least 2 points, not {points}")
        angle = np.linspace(self.angle(travel), 0.0, points)
        time = (angle[0] - angle)/(2.0*np.pi*self.turns)
        share = 1.0 - self.height(angle)/travel
        lines = "".join(f"{t!r}, {s!r}\n" for t, s in zip(time.tolist(), share.tolist()))
        return f"*AMPLITUDE, NAME={name}\n{lines}", float(time[-1])


@dataclass(frozen=True)
class Blow:
    """What a tool with an energy did.

    Attributes
    ----------
    stroke : where the energy was spent [length]
    force : of the tool there [force]
    way, work : after each increment: stroke, and what the tool has done [length], [energy]; of the
        last one, what lies beyond the energy belongs to the next blow
    spent : the energy was spent before the deck ended
    """

    stroke: float
    force: float
    way: NDArray
    work: NDArray
    spent: bool


def blow(job: Job, tool: str, direction: int, energy: float) -> Blow:
    """Run an open job until a tool has done a work [energy].

    Between increments the force is linear in the way: `stroke` is where its integral is the energy.
    Increments are to follow the first rise of the force.
    A job that was stopped by one blow goes on with the next from the `stroke` of the last: what its
    last increment did beyond it counts for the next, which may need none of its own. Strokes and
    energies of blows that follow one another add up whatever the increments. After increments
    between them, they count from where the job stands.

    Parameters
    ----------
    job : open; its deck moves the tool farther than the energy reaches
    tool : name of the tool's surface or body, as in the history
    direction : 1 to 3, of the motion
    energy : of the blow, what reaches the metal
    """
    if not 0.0 < energy < np.inf:
        raise UsageError(f"a blow has an energy above 0, not {energy:g}")
    names = [f"{tool}.u{direction}", f"{tool}.rf{direction}"]
    at, surplus = _start(job, names)
    work, spent = [0.0], False
    while not spent and (surplus or job.advance() is not None):
        at, surplus = np.vstack([at, _last(job, names)]), False
        work.append(work[-1] + 0.5*at[-2:, 1].sum()*np.diff(at[-2:, 0])[0])
        spent = work[-1] >= energy
    way = np.abs(at[:, 0] - at[0, 0])
    stroke, force = float(way[-1]), float(at[-1, 1])
    if spent:
        stroke, force = _where(way[-2:], np.abs(at[-2:, 1]), energy - work[-2])
        force = float(np.copysign(force, at[-1, 1]))
        place = at[0, 0] + np.copysign(stroke, at[-1, 0] - at[0, 0])
        job.blows[names[0]] = (len(job.result.times), float(place), force)
    return Blow(stroke, force, way, np.array(work), spent)


def _start(job: Job, names: list[str]) -> tuple[NDArray, bool]:
    """Place and force where a blow begins (1, 2), and whether the job stands beyond, by the last
    increment of the blow before."""
    count = len(job.result.times)
    if count:
        here = _last(job, names)
        ended, *there = job.blows.get(names[0], (0, *here))
        return np.array([there if ended == count else here]), ended == count
    if job.has_begun:
        raise UsageError("a job that goes on from a state does not know where its tools stand",
                         help="take one increment before the blow: job.advance()")
    return np.zeros((1, 2)), False


def _last(job: Job, names: list[str]) -> list[float]:
    """Last values of the history; what is missing is said."""
    history = job.result.history
    if not set(names) <= set(history):
        tools = {n.partition(".")[0] for n in history if ".rf" in n}
        raise UsageError(f"the history has no {names[1]}",
                         help="tools: " + ", ".join(sorted(tools)))
    return [float(history[n][-1]) for n in names]


def _where(way: NDArray, force: NDArray, work: float) -> tuple[float, float]:
    """Way and force at which a force that is linear in the way has done a work."""
    rise = (force[1] - force[0])/(way[1] - way[0])
    root = np.sqrt(max(force[0]**2 + 2.0*rise*work, 0.0))
    far = 2.0*work/(force[0] + root)
    return float(way[0] + far), float(force[0] + rise*far)


def times_of_blow(way: ArrayLike, work: ArrayLike, energy: float, mass: float) -> NDArray:
    """When a hammer of a mass is where, from v^2 = 2 (energy - work)/mass [time].

    Between the points the speed is even in time (constant force), so that v^2 is linear in the way.
    Metal whose stress depends on the rate: run, find the times, give them to the deck as an
    amplitude, and again until they stay.

    Parameters
    ----------
    way, work : as `Blow` has them, from 0
    energy, mass : of the ram where it meets the metal
    """
    way, work = np.asarray(way, float), np.asarray(work, float)
    if not (0.0 < mass < np.inf and 0.0 < energy < np.inf):
        raise UsageError(f"a hammer has a mass and an energy above 0, not {mass:g} and {energy:g}")
    if way.ndim != 1 or way.shape != work.shape or not np.isfinite([way, work]).all() or \
            (np.diff(way) < 0.0).any():
        raise UsageError("way and work are rows of numbers, as many of the one as of the other, "
                         "and the way does not fall")
    speed = np.sqrt(np.maximum(2.0*(energy - work)/mass, 0.0))
    mean = 0.5*(speed[1:] + speed[:-1])
    if not (mean > 0.0).all():
        raise UsageError("the energy is spent before the way ends",
                         help="leave out what lies beyond the stroke of the blow")
    return np.r_[0.0, np.cumsum(np.diff(way)/mean)]
