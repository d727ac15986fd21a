"""Map 4 of the atlas: semismooth Newton with Coulomb friction, by its scaling and its safeguards.

A rigid parabola is pressed on a block (plane strain) and then dragged by four increments, from
partial slip to full sliding. Plain Newton has no prediction and no ladder of cures; *as shipped*
has both and a line search, as every run of the code.
"""
from __future__ import annotations

import json
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .._bridge import probe_friction_increment, probe_stiffness
from ..charts.run import WRONG
from ..files import whole_file
from ..mesh import make as mesh_make
from .cells import Outcome
from .scenes import PLAIN, Frame

CELLS, RADIUS, DEPTH, POISSON = 24, 20.0, 0.005, 0.3
#: Drag at the ends of the increments, in mu times the depth.
DRAG = (0.0, 0.3, 0.6, 0.9, 1.5)
#: Stiffness of the penalty beside one over the mean nodal compliance.
STIFF = 100.0


@cache
def compliance(nu: float = POISSON) -> tuple[NDArray, NDArray]:
    """S of the points of a block below the parabola, pressing rows first, and their places."""
    mesh = mesh_make.block((2.0, 1.0), (CELLS, CELLS//2), origin=(-1.0, -1.0))
    n = mesh.n_point
    stiffness = np.zeros((2*n, 2*n))
    for nodes in mesh.blocks[0][1]:
        dofs = (2*nodes[:, None] + np.arange(2)).ravel()
        stiffness[np.ix_(dofs, dofs)] += probe_stiffness("CPE4", mesh.points[nodes], 1.0, nu)
    held = mesh.point_sets["BOTTOM"]
    free = np.setdiff1d(np.arange(2*n), np.concatenate([2*held, 2*held + 1]))
    top = mesh.point_sets["TOP"]
    top = top[np.argsort(mesh.points[top, 0])]
    top = top[np.abs(mesh.points[top, 0]) < 0.8]
    rows = np.zeros((2*len(top), 2*n))
    rows[np.arange(len(top)), 2*top + 1] = -1.0
    rows[len(top) + np.arange(len(top)), 2*top] = 1.0
    rows = rows[:, free]
    s = rows @ np.linalg.solve(stiffness[np.ix_(free, free)], rows.T)
    return 0.5*(s + s.T), mesh.points[top, 0]


def loads(mu: float) -> list[NDArray]:
    """Gaps without forces, an increment after the other."""
    _, x = compliance()
    pressed = x**2/(2.0*RADIUS) - DEPTH
    return [np.concatenate([pressed, np.full(len(x), -drag*mu*DEPTH)]) for drag in DRAG]


def history(mu: float, frame: Frame = PLAIN, soft: bool = False, **switches) -> dict:
    """All increments: forces at the end and what the solver said, until one fails."""
    s, x = compliance()
    n, sign = len(x), np.ones(2*len(x))
    order = np.arange(2*n)
    if frame != PLAIN:       # seen from behind, in other units
        order = np.concatenate([np.arange(n)[::-1], n + np.arange(n)[::-1]])
        sign[n:] = -1.0
    unit = frame.length/frame.stress
    s = unit*(sign[:, None]*s*sign)[np.ix_(order, order)]
    force, gaps = np.zeros(2*n), np.zeros(2*n)
    answer = {"iterations": 0, "code": 0, "wedging": 0, "cure": 1, "physical": True}
    stiffness = STIFF/np.mean(s.diagonal()) if soft else 0.0
    for free in loads(mu):
        before = gaps
        force, gaps, said = probe_friction_increment(
            s, frame.length*(sign*free)[order], mu, force, gaps, stiffness=stiffness, **switches)
        answer["iterations"] = max(answer["iterations"], said["iterations"])
        answer["cure"] = max(answer["cure"], said["cure"])
        answer["code"] = said["code"]
        answer["wedging"] |= int(said["wedging"] > 0 or said["sign"] < 0)
        if said["code"]:
            break
        answer["physical"] &= physical(force, gaps[n:] - before[n:], mu)
    back = np.argsort(order)
    answer["force"] = sign*force[back]/frame.stress
    return answer


def physical(force: NDArray, slip: NDArray, mu: float) -> bool:
    """No tension, inside the cone, and sliding costs work."""
    normal, shear = np.split(force, 2)
    most = np.abs(force).max()
    return bool(normal.min() > -1e-8*most and (np.abs(shear) - mu*normal).max() < 1e-8*most
                and (-shear*slip).sum() >= -1e-8*most*np.abs(slip).max())


@cache
def exact(mu: float, soft: bool) -> NDArray:
    """Forces at the end, by the solver as shipped; `physical` judges them, too."""
    return history(mu, soft=soft)["force"]


class FrictionMap:
    """c_t times the mean nodal compliance by mu."""

    number, name = 4, "friction"
    title = "Map 4: Newton with Coulomb friction; pressing, then dragging by four increments"
    labels = (r"$c_t\,\overline{S}_{jj}$", r"$\mu$")
    colour, across, linear = "iterations", 5, True
    panels = tuple(f"{method}, {start}{rest}" for method in ("exact", "penalty")
                   for start, rest in (("cold", ", plain"), ("cold", ", line search"),
                                       ("warm", ", plain"), ("warm", ", line search"),
                                       ("as shipped", "")))

    def grid(self, panel: str, small: bool) -> tuple[NDArray, NDArray]:
        """The values of x and y."""
        if small:
            return np.array([1e-2, 1.0, 1e2]), np.array([0.0, 0.3, 1.0])
        return 10.0**np.arange(-3.0, 3.1, 0.5), np.concatenate(
            [[0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8], np.arange(1.0, 3.1, 0.25)])

    def solve(self, panel: str, x: float, y: float, frame: Frame = PLAIN) -> Outcome:
        """What happens in a cell."""
        method, start, *rest = panel.split(", ")
        shipped = start == "as shipped"
        soft = method == "penalty"
        found = history(y, frame, soft, scaling=x, warm=start != "cold", predict=shipped,
                        ladder=shipped, line_search=shipped or rest == ["line search"])
        said = f"cure {found['cure']}" if found["cure"] > 1 else ""
        if found["code"]:
            return Outcome("F2" if found["iterations"] >= 40 else "F3",
                           iterations=found["iterations"], said=said)
        force = found["force"]
        right = exact(y, soft)
        error = float(np.linalg.norm(force - right)/np.linalg.norm(right))
        kind = "F0"
        if not np.isfinite(error):
            kind = "F4"
        elif found["wedging"]:
            kind, said = "F7", "W0520"
        elif not found["physical"]:
            kind = "F6"
        elif error > WRONG:
            kind = "F1"
        return Outcome(kind, error, found["iterations"], said)

    def write(self, panel: str, x: float, y: float, path: Path) -> Path:
        """The problem of a cell: compliance, gaps of all increments, and how it was solved."""
        s, places = compliance()
        with whole_file(path) as part:
            part.write_text(json.dumps({
                "panel": panel, "scaling": x, "mu": y, "places": places.tolist(),
                "gaps": [g.tolist() for g in loads(y)], "compliance": s.tolist()}, indent=1),
                encoding="utf-8")
        return path

    def theory(self, panel: str) -> list[tuple[str, NDArray, NDArray]]:
        """The collective rule 1/lambda_max(S_tt), over points below the parabola that press."""
        s, x = compliance()
        n, forces = len(x), exact(0.3, False)
        closed = n + np.flatnonzero(forces[:n] > 0.0)
        rule = np.mean(s.diagonal())/np.linalg.eigvalsh(s[np.ix_(closed, closed)])[-1]
        return [(r"$1/\lambda_{max}(S_{tt})$", np.full(2, rule), np.array([-1.0, 4.0]))]
