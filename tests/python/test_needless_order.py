"""Elements of second order for nothing (N0368): told where linear ones have the answer, by a bound
that holds, and nowhere else."""
import re

import numpy as np
import pytest
from test_advice import pressed

import lopin
from lopin.deck import Deck
from lopin.mesh_make import block
from lopin.model_read_mesh import MeshCards, expanded
from lopin.refine import of_second_order


def dished(by, cells=(20, 14), **changes):
    """A block whose top is pressed by 0.1 and by a parabola more, so that stresses vary."""
    flat = pressed(False, cells=cells, **changes)
    cards = MeshCards(expanded(flat))
    rows = [f"{n}, 2, 2, {-0.1 - by*(cards.nodes[n][0]/20.0)**2}" for n in cards.nsets["BTOP"]]
    text = flat.text().replace("BTOP, 2, 2, -0.1", "\n".join(rows))
    return Deck.parse(text, name="dished")


def told(result):
    """Shares of stresses and forces that are named; empty: it is not said."""
    lines = [d["message"] for d in result.diagnostics if d["code"] == "N0368"]
    return [float(v)/100.0 for v in re.findall(r"([0-9.eE+-]+) % of", lines[0])] if lines else []


def stored(result):
    return result.summary["energy"]["strain"]


@pytest.mark.parametrize("by", [0.0, 0.005, 0.03])
def test_linear_elements_err_by_no_more_than_is_said(by, solve):
    """Energies under given displacements: an error of stresses, squared."""
    deck = dished(by)
    fine = solve(of_second_order(deck).deck)
    stresses, forces = told(fine)
    apart = abs(stored(solve(deck))/stored(fine) - 1.0)
    assert 1e-4 <= stresses <= 0.01 and np.isclose(forces, stresses**2, rtol=0.1)
    assert apart <= max(1.1*forces, 1e-9)


@pytest.mark.parametrize("deck, due", [
    (dished(0.03), True), (dished(0.3), False), (dished(0.03, nlgeom=", NLGEOM"), False),
    (dished(0.03, plastic=True), False), (dished(0.03, cells=(8, 6)), False)],
    ids=["even", "uneven", "finite", "flows", "small"])
def test_where_it_is_due(deck, due, solve):
    assert bool(told(solve(of_second_order(deck).deck))) == due
    assert not told(solve(deck))


def test_a_step_that_calls_for_them_counts(solve):
    """The last step is even again."""
    deck = of_second_order(dished(0.3)).deck
    rows = [f"{n}, 2, 2, -0.1" for n in MeshCards(expanded(deck)).nsets["BTOP"]]
    text = deck.text() + "*STEP\n*STATIC\n*BOUNDARY\n" + "\n".join(rows) + "\n*END STEP\n"
    result = solve(Deck.parse(text, name="again"))
    assert len(result.history["time"]) == 2
    assert not told(result)


def test_curved_cells_call_for_them(solve):
    deck = of_second_order(dished(0.0)).deck
    cards = MeshCards(expanded(deck))
    middle = next(n for n, x in cards.nodes.items() if n > 500 and 5.0 < x[0] < 15.0
                  and 5.0 < x[1] < 9.0)
    for block in deck.blocks:
        for row in block.data if block.keyword == "NODE" else ():
            if row[0] == middle:
                row[1] += 0.05
    assert not told(solve(deck))


def test_it_outlives_a_checkpoint(tmp_path):
    """`lopin.run` and the executable say the same."""
    deck = of_second_order(dished(0.03)).deck
    assert told(lopin.run(deck, tmp_path, executable=True)) == told(lopin.run(deck))


def test_the_body_where_it_is_worst_counts(solve):
    """Beside a block that stores all but 1e-5 of the energy, a leaf spring: by linear elements it is 8 times as stiff."""
    deck = of_second_order(dished(0.03)).deck
    leaf = block((50.0, 0.5), (20, 1), origin=(100.0, 0.0), quadratic=True)
    rows = ["*NODE", *(f"{90001 + i}, {x!r}, {y!r}" for i, (x, y) in enumerate(leaf.points.tolist())),
            "*ELEMENT, TYPE=CPE8, ELSET=LEAF",
            *(f"{90001 + i}, " + ", ".join(str(90001 + n) for n in row)
              for i, row in enumerate(leaf.blocks[0][1].tolist())),
            "*MATERIAL, NAME=SPRING", "*ELASTIC", "1., 0.3", "*SOLID SECTION, ELSET=LEAF, MATERIAL=SPRING", "1.,",
            "*BOUNDARY", *(f"{90001 + n}, 1, 2" for n in leaf.point_sets["LEFT"].tolist()), "*STEP"]
    tip = [f"{90001 + n}, 2, 2, -1." for n in leaf.point_sets["RIGHT"].tolist()]
    text = deck.text().replace("*STEP", "\n".join(rows), 1)
    at = text.rindex("*END STEP")
    both = Deck.parse(text[:at] + "*BOUNDARY\n" + "\n".join(tip) + "\n" + text[at:], name="both")
    assert told(solve(deck)) and not told(solve(both))
