"""Work that is lost where a body leaps to another equilibrium is told; what the trapezoidal rule of
few increments misses is not."""
import numpy as np
import pytest

import lopin
from forming_scenes import E1, billet, coulomb, squeezed
from test_driven_wheel import wheel


def hairpin(kind: str, increments: int, cells: int = 40) -> lopin.Deck:
    """A strip bent to a U whose legs are pressed on each other, one layer of second order."""
    leg, gap, thick = 3.0, 0.2, 0.1
    radius = gap/2 + thick/2
    total = 2*leg + np.pi*radius

    def place(s, t):
        h = (t - 0.5)*thick
        s *= total
        if s < leg:
            return s, -radius + h
        if s < leg + np.pi*radius:
            a = -np.pi/2 + (s - leg)/radius
            return leg + (radius - h)*np.cos(a), (radius - h)*np.sin(a)
        return leg - (s - leg - np.pi*radius), radius - h

    quads = kind == "CPE8"
    label = {}
    for i in range(2*cells + 1):
        for j in range(3):
            if quads and i % 2 == 1 and j == 1:
                continue
            label[i, j] = len(label) + 1
    elements, skin = [], []
    for c in range(cells):
        i = 2*c
        a, b, d, e = (i, 0), (i + 2, 0), (i + 2, 2), (i, 2)
        ab, bd, de, ea = (i + 1, 0), (i + 2, 1), (i + 1, 2), (i, 1)
        rings = [[a, b, d, e, ab, bd, de, ea]] if quads else [
            [a, b, d, ab, bd, (i + 1, 1)], [a, d, e, (i + 1, 1), de, ea]]
        elements += [[label[n] for n in ring] for ring in rings]
        skin.append((len(elements), "S3" if quads else "S2"))
    first = [label[0, j] for j in range(3)]
    last = [label[2*cells, j] for j in range(3)]
    text = ["*NODE", *(f"{n}, {x!r}, {y!r}" for (i, j), n in label.items()
                       for x, y in [map(float, place(i/(2*cells), j/2))]),
            f"*ELEMENT, TYPE={kind}, ELSET=E",
            *(", ".join(map(str, [k + 1, *e])) for k, e in enumerate(elements)),
            "*SURFACE, NAME=SKIN", *(f"{e}, {face}" for e, face in skin),
            "*SOLID SECTION, ELSET=E, MATERIAL=M\n1.,", "*MATERIAL, NAME=M\n*ELASTIC\n1000., 0.3",
            "*SURFACE INTERACTION, NAME=I\n*CONTACT PAIR, INTERACTION=I\nSKIN, SKIN",
            "*BOUNDARY", *(f"{n}, 1, 2" for n in first), "*STEP, NLGEOM, INC=300\n*STATIC",
            f"{1/increments!r}, 1.\n*BOUNDARY", *(f"{n}, 2, 2, -0.25" for n in last), "*END STEP"]
    return lopin.Deck.parse("\n".join(text), "hairpin")


def said(result):
    return [d["message"] for d in result.diagnostics if d["code"] == "W0530"]


@pytest.mark.parametrize("kind, strain", [("CPE6", 0.01182), ("CPE8", 0.01148)])
@pytest.mark.parametrize("increments", [1, 4, 8, 12, 25, 50])
def test_a_hairpin_is_right_or_its_lost_work_is_told(solve, kind, strain, increments):
    result = solve(hairpin(kind, increments))
    right = result.history["energy.strain"][-1] == pytest.approx(strain, rel=0.02)
    assert right or said(result)
    if said(result):
        # One line, that names an increment of the step.
        assert len(said(result)) == 1
        number = int(said(result)[0].rsplit("increment ", 1)[1])
        assert 1 <= number <= len(result.history["time"])


@pytest.mark.parametrize("increments", [8, 16, 40])
@pytest.mark.parametrize("mu", [0.0, 0.1], ids=["smooth", "friction"])
def test_few_increments_of_upsetting_are_no_lost_work(solve, increments, mu):
    part = 1.0/increments
    assert not said(solve(squeezed(billet(4, 6), E1, coulomb(mu), 0.3, sizes=(part, part, part))))


@pytest.mark.parametrize("more", [{}, {"static": "0.2, 1."}, {"mu": 0.05, "nx": 40}])
def test_a_wheel_that_rolls_from_node_to_node_loses_nothing(solve, more):
    assert not said(solve(wheel(**more)))
