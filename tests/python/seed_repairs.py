"""The 29 lines of the lecture that cannot be coded as they stand: quotation, what is wrong, both
forms, Lopin's answer.

Each entry is one small scene. `printed` is the answer of the line as the lecture has it, `repaired`
that of the reading which Lopin follows, `lopin` what Lopin's own kernels give. `python
tests/python/seed_repairs.py` writes the page of the manual.
"""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from lopin import _bridge

N = np.array([0.0, 1.0])                  #: outward normal of the obstacle, which is the half-plane y < 0
FLOOR = [0.0, 0.0, 0.0, 1.0]              #: the same for Lopin: origin and normal
FRICTION = dict(mu=0.3, m=0.2, alpha=5.0, q=0.2)
MU_P, SHEAR = 30.0, 0.2*200.0/np.sqrt(3.0)   #: at p = 100, yield stress 200


@dataclass(frozen=True)
class Repair:
    """One line of the lecture."""

    id: str
    quote: str                 #: the line, in the lecture's words
    fault: str                 #: what is wrong with it, and the reading taken
    scene: str
    printed: Callable
    repaired: Callable
    lopin: Callable


def gap(x) -> float:
    """Lopin's gap above the floor."""
    return float(_bridge.probe_tool_gap("plane", FLOOR, [x])[0][0])


def force(free, method="lagrange", alpha=1.0) -> np.ndarray:
    """Lopin's contact forces of unit springs whose gaps would be `free`."""
    return _bridge.probe_contact(np.eye(len(free)), free, method, alpha)[0]


def traction(law, trial, p, regularization="LINEAR", **more) -> float:
    """Lopin's traction of friction."""
    data = FRICTION | dict(yield_stress=200.0) | more
    return float(_bridge.probe_friction(law, trial, p, regularization=regularization, **data)[0, 0])


BLOCK = """*NODE
1, 0., 0.
2, 2., 0.
3, 2., 2.
4, 0., 2.
9, 0., 0.
*ELEMENT, TYPE=CPS4, ELSET=BODY
1, 1, 2, 3, 4
*MATERIAL, NAME=M
*ELASTIC
1000., 0.
*SOLID SECTION, ELSET=BODY, MATERIAL=M
2.,
*SURFACE, NAME=FACE
BODY, S1
*SURFACE, NAME=TABLE, TYPE=SEGMENTS
START, -9., 0.
LINE, 9., 0.
*RIGID BODY, ANALYTICAL SURFACE=TABLE, REF NODE=9
*SURFACE INTERACTION, NAME=TOUCH
*SURFACE BEHAVIOR, DIRECT
*FRICTION
MU,
*CONTACT PAIR, INTERACTION=TOUCH
FACE, TABLE
*BOUNDARY
9, 1, 2
9, 6
1, 1
4, 1
*STEP
*STATIC
1., 1.
*CLOAD
3, 2, -4.
4, 2, -4.
*NODE FILE
U
*CONTACT FILE
CDIS, CSTR
*END STEP
"""


@cache
def pressed():
    """Lopin's answer to a block 2 x 2 x 2 pressed on a table by a force 8."""
    import lopin

    return lopin.run(lopin.Deck.parse(BLOCK.replace("*FRICTION\nMU,\n", ""), "pressed"))


def pressure() -> float:
    """Of the block on its table."""
    return float(np.mean(pressed().contact(0).last.pressure))


def accepts(mu: float) -> float:
    """1 if Lopin reads a deck with this coefficient without an error."""
    from lopin.errors import LopinError

    try:
        _bridge.check_deck(BLOCK.replace("MU,", f"{mu},"), "mu", ".")
    except LopinError:
        return 0.0
    return 1.0


def tangential(u) -> np.ndarray:
    """How far the foot of a point on the floor moves when the point moves by u, from Lopin's
    projections."""
    x = np.array([[0.4, 0.5], [0.4 + u[0], 0.5 + u[1]]])
    g, n = _bridge.probe_tool_gap("plane", FLOOR, x)
    foot = x - g[:, None]*n
    return foot[1] - foot[0]


def along_a_path() -> float:
    """Springs 1000 across and along, mu 0.3: pressed, moved along, half released and pressed again
    (C7, path D)."""
    t = 0.0
    for p, slip in ((100.0, 0.0), (100.0, 0.02), (50.0, 0.0), (100.0, 0.0)):
        t = traction("COULOMB", abs(t + 1000.0*slip), p)
    return t


def uzawa(free, alpha, gated: bool) -> np.ndarray:
    """Multipliers after many sweeps of the update, with unit springs."""
    free = np.asarray(free)
    m = np.zeros(len(free))
    for _ in range(400):
        active = m - alpha*free > 0.0 if gated else np.ones(len(m), bool)
        g = np.where(active, (free + m)/(1.0 + alpha), free)
        m = np.maximum(0.0, m - alpha*g) if gated else m - alpha*g
    return m


GROOVE = [[0, 0.0, 9.0, 0, 0], [1, 0.0, 0.0, 0, 0], [1, 8.0, 0.0, 0, 0], [1, 8.0, 9.0, 0, 0]]


def groove_walls(x) -> np.ndarray:
    """Distances of a point from the left wall, the bottom and the right wall of the groove, which is
    8 wide; positive beyond them, as the lecture counts where it searches (H8)."""
    return np.array([-x[0], -x[1], x[0] - 8.0])


#: Normals of a floor and of a wall that leans by 45 degrees, as columns; what pushes against both.
WALLS, PUSH, STIFF = np.array([[0.0, -1.0], [1.0, 1.0]])/[1.0, np.sqrt(2.0)], np.array([0.1, -0.4]), 9.0


def penalised(product) -> np.ndarray:
    """Where unit springs along x and y end under the push, with STIFF*product in their energy."""
    return np.linalg.solve(np.eye(2) + STIFF*product, PUSH)


def penalised_by_lopin() -> np.ndarray:
    """The same from Lopin's forces of two walls that both carry."""
    forces = _bridge.probe_contact(WALLS.T @ WALLS, WALLS.T @ PUSH, "penalty", STIFF)[0]
    return PUSH + WALLS @ forces


@cache
def strained(strain: float = 0.01) -> float:
    """What Lopin stores and dissipates in a unit cube of E = 1000, yield stress 4, drawn by a strain."""
    import lopin

    deck = BAR.replace("DRAWN", f"{strain}")
    history = lopin.run(lopin.Deck.parse(deck, "drawn")).history
    return float(history["energy.strain"][-1] + history["energy.plastic"][-1])


@cache
def drawn_by(load: float = 5.0) -> float:
    """Lopin's stretch of the unit cube of E = 1000 under a load, elastic."""
    import lopin

    deck = BAR.replace("*PLASTIC\n4., 0.\n", "").replace("2, 1, 1, DRAWN\n3, 1, 1, DRAWN\n", "")
    deck = deck.replace("*NODE FILE", f"*CLOAD\n2, 1, {load/2}\n3, 1, {load/2}\n*NODE FILE")
    return float(lopin.run(lopin.Deck.parse(deck, "pulled")).at(-1)["U"][1, 0])


BAR = """*NODE
1, 0., 0.
2, 1., 0.
3, 1., 1.
4, 0., 1.
*ELEMENT, TYPE=CPS4, ELSET=BODY
1, 1, 2, 3, 4
*MATERIAL, NAME=M
*ELASTIC
1000., 0.
*PLASTIC
4., 0.
*SOLID SECTION, ELSET=BODY, MATERIAL=M
1.,
*BOUNDARY
1, 1, 2
4, 1
*STEP
*STATIC
0.05, 1., 0.05, 0.05
*BOUNDARY
2, 1, 1, DRAWN
3, 1, 1, DRAWN
*NODE FILE
U
*END STEP
"""


def rebuilt() -> float:
    """Height of a point put together again from Lopin's projection on a line of two nodes."""
    line, x = np.array([[1.0, 0.0], [-1.0, 0.0]]), np.array([0.2, 0.3])
    xi, g, n = _bridge.probe_project("line", line, x)
    values = _bridge.probe_shape("line", xi)[0]
    back = values @ line + g*n
    return float(back @ n)


def set_on_surface(depth: float) -> float:
    """Gap of a point that was moved by Lopin's own gap and normal."""
    x = np.array([[0.3, -depth]])
    g, n = _bridge.probe_tool_gap("plane", FLOOR, x)
    return gap(x[0] - g[0]*n[0])


REPAIRS = [
    Repair("C1", "h = (\\vec{u}_1 - \\vec{u}_2) \\cdot \\vec{n}^c",
           "no initial gap and no present positions: it is the change of the gap, not the gap; "
           "g = (x_s - x_m).n",
           "a point 0.3 above the floor comes down by 0.1",
           lambda: float(np.array([0.0, -0.1]) @ N), lambda: 0.3 - 0.1, lambda: gap([0.0, 0.2])),
    Repair("C2", "\\vec{R} = \\underline{\\sigma} \\cdot \\vec{n}^c",
           "R_n = n.sigma.n is negative in compression, against its own R_n >= 0; p = -n.sigma.n",
           "a block of section 4 pressed by a force 8",
           lambda: -8.0/4.0, lambda: 8.0/4.0, pressure),
    Repair("D2", "1 \\text{ (sec)} \\leq \\mu \\leq 0",
           "the bounds are reversed: no coefficient satisfies them; mu >= 0",
           "which of -0.1, 0.1, 0.3, 1 are accepted",
           lambda: [float(1.0 <= mu <= 0.0) for mu in (-0.1, 0.1, 0.3, 1.0)],
           lambda: [float(mu >= 0.0) for mu in (-0.1, 0.1, 0.3, 1.0)],
           lambda: [accepts(mu) for mu in (-0.1, 0.1, 0.3, 1.0)]),
    Repair("D3", "h = (\\vec{u}_2 - \\vec{u}_1) \\cdot \\vec{n}^c = 0",
           "the order of u1 and u2 is the reverse of that in C: opening would be penetration",
           "a point of the floor rises by 0.2",
           lambda: float((0.0*N - 0.2*N) @ N), lambda: float((0.2*N - 0.0*N) @ N),
           lambda: gap([0.0, 0.2])),
    Repair("D4", "**Impénétrabilité** : condition de contact cinématique $$h > 0$$",
           "a point that touches has h = 0: with h > 0 strictly, and h > 0 giving R_n = 0, nothing is "
           "ever carried; h >= 0",
           "a unit spring pressed 0.5 beyond the floor: the reaction",
           lambda: 0.0, lambda: 0.5, lambda: float(force([-0.5])[0])),
    Repair("E1", "si $$\\vec{u}_t = 0$$ adhérence",
           "stick means no slip now, not no displacement since the beginning: the slip velocity, or its "
           "increment, decides",
           "a block that slid 0.3 before, held by a trial traction 12 where mu p = 30",
           lambda: 12.0 if 0.3 == 0.0 else MU_P, lambda: min(12.0, MU_P),
           lambda: traction("COULOMB", 12.0, 100.0)),
    Repair("E2",
           "\\vec{R}_t = -m \\frac{\\sigma_y(\\varepsilon^P)}{\\sqrt{3}} \\frac{\\vec{u}_t}{\\|\\vec{u}_t\\|}",
           "no gate by contact (it drags at p = 0) and no stick (it slides under any trial): "
           "|R_t| <= m sigma_y/sqrt 3 where p > 0",
           "traction in the open; traction under a trial 12",
           lambda: [SHEAR, SHEAR], lambda: [0.0, min(12.0, SHEAR)],
           lambda: [traction("TRESCA", 1e3, 0.0), traction("TRESCA", 12.0, 100.0)]),
    Repair("E3",
           "-\\text{Min} \\left[\\mu |\\mathbf{R}_n| \\frac{\\mathbf{u}_t}{\\|\\mathbf{u}_t\\|}, m \\frac{\\sigma_y",
           "the least of two vectors depends on the axes; the radius is the least of two numbers",
           "magnitude of the traction, slip along (-0.6, 0.8)",
           lambda: float(np.linalg.norm(np.minimum(MU_P*np.array([-0.6, 0.8]),
                                                   SHEAR*np.array([-0.6, 0.8])))),
           lambda: min(MU_P, SHEAR), lambda: traction("COULOMB-OROWAN", 1e3, 100.0)),
    Repair("E4",
           "\\vec{R}_t = -m \\frac{|\\bar{\\sigma}|}{\\sqrt{3}} \\frac{\\vec{u}_t}{\\|\\vec{u}_t\\|}",
           "nothing holds the stress of a trial below the yield stress, and open surfaces rub; "
           "m min(sigma, sigma_y)/sqrt 3 where p > 0",
           "a trial stress 300 above the yield stress 200; a stress 150 in the open",
           lambda: [0.2*300.0/np.sqrt(3.0), 0.2*150.0/np.sqrt(3.0)], lambda: [SHEAR, 0.0],
           lambda: [traction("CRISTESCU", 1e3, 100.0, mises=300.0),
                    traction("CRISTESCU", 1e3, 0.0, mises=150.0)]),
    Repair("E5", "R_t = \\alpha \\dot{u}_t^p",
           "without minus sign the surfaces drive themselves, without direction a speed backwards has no "
           "power; R_t = -alpha |v|^(q-1) v, alpha in Pa (s/m)^q",
           "slip at the speed 2, alpha 5, exponent 0.2: the traction along the slip",
           lambda: 5.0*2.0**0.2, lambda: -5.0*2.0**0.2,
           # A trial of stiffness 1 returns along itself; it opposes the slip of the increment, 2.
           lambda: -traction("NORTON-HOFF", 2.0 + 5.0*2.0**0.2, 100.0)),
    Repair("E6", "f(u_t) = \\frac{2}{\\pi} \\arctan \\left(\\frac{\\|\\vec{u}_t\\|}{u_0} \\right)",
           "with the displacement of an increment the answer depends on the step; the argument is the "
           "velocity v/V0",
           "speed 1, V0 = 1, mu p = 30: steps of 0.1 and of 0.01",
           lambda: [MU_P*2.0/np.pi*np.arctan(dt/1.0) for dt in (0.1, 0.01)],
           lambda: [MU_P*2.0/np.pi*np.arctan(1.0)]*2,
           lambda: [traction("COULOMB", dt, 100.0, "ARCTAN", v0=1.0, dt=dt) for dt in (0.1, 0.01)]),
    Repair("F1", "h = 0 & \\text{sur } \\Gamma_c",
           "only the active part of the surface is at h = 0, and which part that is, is unknown",
           "two unit springs, one pressed 0.5 beyond the floor, one 0.2 above it: the reactions",
           lambda: [0.5, -0.2], lambda: [0.5, 0.0], lambda: force([-0.5, 0.2])),
    Repair("F2", "W_{\\text{solide}} = \\frac{1}{2} \\int_V [\\sigma] : \\{\\varepsilon\\} dV",
           "half of stress times strain is the energy of a linear solid only; metal that flows takes the "
           "integral of stress over strain",
           "a unit cube, E = 1000, yield stress 4, drawn by a strain of 0.01: the energy it takes",
           lambda: 0.5*4.0*0.01, lambda: 4.0*(0.01 - 0.5*0.004), strained),
    Repair("F3",
           "W_{\\text{cont}} = \\iint_{\\Gamma_c} \\vec{f}_{\\text{cont}} \\cdot \\vec{u}_n dS",
           "f_cont is an integral already: the work is integrated twice, and a force times an area is no "
           "force; the integral of p u_n",
           "pressure 2 on an area 4 that moves by 0.1",
           lambda: (2.0*4.0)*0.1*4.0, lambda: 2.0*4.0*0.1,
           lambda: 0.1*abs(float(np.sum(pressed().contact(0).last.force, axis=0)[1]))),
    Repair("F4", "\\vec{u}_t = (\\vec{u}_2 - \\vec{u}_1) - \\vec{u}_n \\cdot \\vec{n}^c",
           "a number is taken from a vector, and the sign is the reverse of C; "
           "(u1 - u2) - ((u1 - u2).n) n",
           "a point moves by (-0.3, 0.2) on a floor at rest",
           lambda: np.array([0.3, -0.2]) - np.array([0.0, -0.2]) @ N,
           lambda: np.array([-0.3, 0.0]), lambda: tangential([-0.3, 0.2])),
    Repair("F5", "\\vec{R}_t \\cdot \\vec{u}_t \\right) dS",
           "an energy with the work of friction has an answer that does not know its path; friction has no "
           "potential: increments, with the memory of the traction",
           "pressed, moved along, half released, pressed again: the traction",
           lambda: min(1000.0*0.02, MU_P), lambda: 0.3*50.0, along_a_path),
    Repair("G1",
           "W_{\\text{solide}} = \\left(\\frac{1}{2} \\underline{u}^T [\\underline{K}] \\underline{u} - "
           "\\underline{u}^T \\{\\underline{F}\\} \\right)",
           "the contact term is lost on the way to the matrices: nothing stops the body",
           "a unit spring pushed by 0.5 towards a floor that it touches: its gap",
           lambda: -0.5, lambda: 0.0, lambda: -0.5 + float(force([-0.5])[0])),
    Repair("G2", "= [\\mathbf{G}]^T \\mathbf{u}_n = 0",
           "an equality between displacements, without the distance d there was to go; G^T u <= d",
           "a unit spring pushed by 1 towards a wall 0.1 away: its displacement",
           lambda: 0.0, lambda: 0.1, lambda: 1.0 - float(force([0.1 - 1.0])[0])),
    Repair("H4", "- h \\sum_{k=1}^{\\text{Node}} \\vec{n}^k",
           "the normals of the nodes need the shape functions N^k too, and the sum must be made a unit",
           "a point 0.3 above a line of two nodes, put together again: its height",
           lambda: 0.3*float((N + N) @ N), lambda: 0.3, rebuilt),
    Repair("H5", "h = \\min(h_i)",
           "h is negative where a surface is away (H8): the least h is the facet farthest away; the "
           "closest point decides",
           "a point in a groove, 3 from one wall, 5 from the other, 4 above the bottom: the distance "
           "that it has to go",
           lambda: -float(groove_walls([3.0, 4.0]).min()),
           lambda: 3.0,
           lambda: float(_bridge.probe_tool_gap("profile", GROOVE, [[3.0, 4.0]])[0][0])),
    Repair("H8", "$h > 0$ pénétration",
           "the reverse of D, where h > 0 is open; the gap is positive when open",
           "a unit spring ends 0.2 above the floor: the reaction that would stop a penetration",
           lambda: 0.2, lambda: 0.0, lambda: float(force([0.2])[0])),
    Repair("H9",
           "\\bar{\\mathbf{u}} = -h \\sum_{k=1}^{\\text{Node}} \\mathbf{N}^k(\\xi, \\eta) \\mathbf{n}^{ck}",
           "with X_P = X_C - n h this doubles the penetration; the point moves by -g n",
           "a point 0.2 deep is to be set on the surface: its gap after that",
           lambda: -0.2 - 0.2, lambda: 0.0, lambda: set_on_surface(0.2)),
    Repair("J0", "traduire la condition de non-pénétration $\\mathbf{h} = \\mathbf{0}$",
           "an equality glues; contact is h >= 0, R_n >= 0, h R_n = 0",
           "a unit spring pulled 0.2 away from the floor: the reaction",
           lambda: -0.2, lambda: 0.0, lambda: float(force([0.2])[0])),
    Repair("J1",
           "\\left[[\\mathbf{K}] + \\alpha [\\mathbf{G}] [\\mathbf{G}]^T \\right] \\{u\\} = \\{F\\}",
           "the right-hand side lacks alpha G d, and open points must not count",
           "a unit spring pushed by 1 towards a wall 0.1 away, alpha 100: its displacement",
           lambda: 1.0/(1.0 + 100.0), lambda: (1.0 + 100.0*0.1)/(1.0 + 100.0),
           lambda: 1.0 - float(force([0.1 - 1.0], "penalty", 100.0)[0])),
    Repair("J1, energy", "\\frac{\\alpha}{2} \\vec{u}^T [\\mathbf{G}]^T [\\mathbf{G}] \\vec{u}",
           "G has a row for each displacement and a column for each contact: G^T G cannot stand between "
           "displacements, or means others; u^T G G^T u, as the matrix below it has",
           "unit springs along x and y pushed by (0.1, -0.4) against a floor and a wall that leans by 45 "
           "degrees, alpha 9: their displacements",
           lambda: penalised(WALLS.T @ WALLS), lambda: penalised(WALLS @ WALLS.T), penalised_by_lopin),
    Repair("J1, work", "= \\{F\\} \\vec{u}",
           "an energy that equals the work of the loads is Clapeyron's balance with its half left out; what "
           "is least is the energy minus the work, - F^T u",
           "a unit cube, E = 1000, under a load of 5: how far it stretches",
           lambda: 2.0*5.0/1000.0, lambda: 5.0/1000.0, drawn_by),
    Repair("J3", "[G]^T u - \\frac{1}{2\\alpha} \\lambda = 0",
           "the text has 1/(2 alpha), its own matrix 1/alpha: the text is a penalty of 2 alpha",
           "a unit spring pressed 0.5 beyond the floor, alpha 1: the multiplier",
           lambda: 0.5/(1.0 + 1.0/2.0), lambda: 0.5/(1.0 + 1.0),
           lambda: float(force([-0.5], "perturbed", 1.0)[0])),
    Repair("J4", "\\lambda^{k+1} = \\lambda^k + \\alpha [G]^T u^k",
           "multipliers may become negative, and surfaces then pull; max(0, lambda + alpha h)",
           "two unit springs, one pressed 0.5 beyond the floor, one 0.2 above it, many sweeps: the multipliers",
           lambda: uzawa([-0.5, 0.2], 1.0, False), lambda: uzawa([-0.5, 0.2], 1.0, True),
           lambda: force([-0.5, 0.2], "augmented", 1.0)),
    Repair("J4, update",
           "\\frac{\\partial W}{\\partial \\lambda} = 0 \\end{cases} \\Rightarrow \\begin{cases} [K + \\alpha GG^T] u^k",
           "that the energy is stationary in lambda says where the sweeps end, G^T u = 0, not how lambda goes "
           "on: without the update lambda stays 0, and the answer is that of the penalty",
           "a unit spring pressed 0.5 beyond the floor, alpha 1, many sweeps: the force of contact",
           lambda: 0.5/(1.0 + 1.0), lambda: uzawa([-0.5], 1.0, True),
           lambda: force([-0.5], "augmented", 1.0)),
]

HEAD = """# The lecture, repaired

Written by `tests/python/seed_repairs.py`; do not edit.

Lopin does what a French lecture on contact and friction in metal forming describes. Twenty-nine of its lines cannot be
coded as they stand: signs that contradict each other, equalities for inequalities, factors and gates that are missing. Each
stands here as it is printed, with the reading that Lopin follows, and with the answers of both in one small scene. The
table is a test (`tests/python/test_seed_repairs.py`): Lopin gives the second number and not the first.
"""


def _shown(value) -> str:
    return ", ".join(f"{v + 0.0:.6g}" for v in np.atleast_1d(np.asarray(value, float)).round(12))


def page() -> str:
    """The page of the manual."""
    text = [HEAD]
    for r in REPAIRS:
        text.append(f"## {r.id}\n\n```\n{r.quote}\n```\n\n{r.fault}.\n\n{r.scene[0].upper()}{r.scene[1:]}: as printed "
                    f"{_shown(r.printed())}; repaired, and by Lopin, **{_shown(r.repaired())}**.\n")
    return "\n".join(text)


if __name__ == "__main__":
    (Path(__file__).resolve().parents[2]/"docs"/"seed-repairs.md").write_text(page(),
                                                                              encoding="utf-8")
