"""A finite path for nothing (N0369): told where linear bodies have the answer, by a bound that
holds, and nowhere else."""
import re
from pathlib import Path

import pytest
from test_needless_order import dished, stored

from lopin.deck import Deck
from lopin.model_read_mesh import expanded

DECKS = Path(__file__).resolve().parents[2]/"decks"
FINITE = ", NLGEOM"


def told(result):
    """The share that is named; empty: it is not said."""
    lines = [d["message"] for d in result.diagnostics if d["code"] == "N0369"]
    return [float(re.search(r"by about ([0-9.eE+-]+) %", line)[1])/100.0 for line in lines]


def pressed_by(share, nlgeom=FINITE, **changes):
    """The block whose top is dished, by a share of its 0.1."""
    text = dished(0.03, nlgeom=nlgeom, **changes).text()
    return Deck.parse(re.sub(r"^(\w+, 2, 2), (-[\d.e-]+)$", lambda row:
                             f"{row[1]}, {share*float(row[2])!r}", text, flags=re.MULTILINE),
                      name="pressed")


def of_collection(name, nlgeom):
    text = "\n".join(b.text() for b in expanded(Deck.read(DECKS/f"{name}.inp"))) + "\n"
    return Deck.parse(text.replace(", NLGEOM", "").replace("*STEP", f"*STEP{nlgeom}"), name=name)


@pytest.mark.parametrize("share", [0.5, 0.05])
def test_linear_bodies_differ_by_no_more_than_is_said(share, solve):
    finite = solve(pressed_by(share))
    apart = abs(stored(solve(pressed_by(share, ""))) / stored(finite) - 1.0)
    assert apart <= told(finite)[0] <= 0.01


@pytest.mark.parametrize("name", ["hertz_sphere", "nafems_cylinder"])
def test_scenes_of_the_collection(name, solve):
    """Loads that follow their faces are not looked at."""
    finite, linear = solve(of_collection(name, FINITE)), solve(of_collection(name, ""))
    apart = abs(stored(linear)/stored(finite) - 1.0)
    assert bool(told(finite)) == (name == "hertz_sphere")
    assert not told(linear) and (not told(finite) or apart <= told(finite)[0])


@pytest.mark.parametrize("deck, due", [
    (pressed_by(0.2), True), (pressed_by(0.2, ""), False), (pressed_by(10.0), False),
    (pressed_by(0.2, plastic=True), False), (pressed_by(0.2, friction=True), False),
    (pressed_by(0.2, cells=(8, 6)), False)],
    ids=["small", "linear", "large", "flows", "rubs", "few"])
def test_where_it_is_due(deck, due, solve):
    assert bool(told(solve(deck))) == due


@pytest.mark.parametrize("down, due", [(0.5, False), (0.005, True)])
def test_a_slender_beam_between_walls_stretches(down, due, solve):
    """By half of its height across: strains below 1e-3, turns of 1e-2, and 9 % more energy."""
    deck = Deck.parse(held_beam(down), name="beam")
    assert bool(told(solve(deck))) == due


def test_a_step_that_calls_for_it_counts(solve):
    """The last step is all but flat again."""
    deck = pressed_by(10.0)
    rows = re.findall(r"^(\w+, 2, 2), (-[\d.e-]+)$", deck.text(), flags=re.MULTILINE)
    text = deck.text() + f"*STEP{FINITE}\n*STATIC\n*BOUNDARY\n" + "\n".join(
        f"{place}, {0.01*float(value)!r}" for place, value in rows) + "\n*END STEP\n"
    assert not told(solve(Deck.parse(text, name="again")))


def held_beam(down):
    """A beam of 100 by 1, both ends clamped, whose middle is moved across."""
    lines = ["*NODE"]
    lines += [f"{1000*j + i + 1}, {2.0*i}, {0.5*j}" for j in range(3) for i in range(51)]
    lines.append("*ELEMENT, TYPE=CPE4I, ELSET=BEAM")
    lines += [f"{1000*j + i + 1}, {1000*j + i + 1}, {1000*j + i + 2}, {1000*(j + 1) + i + 2}, "
              f"{1000*(j + 1) + i + 1}" for j in range(2) for i in range(50)]
    ends = [f"{1000*j + i}, 1, 2" for j in range(3) for i in (1, 51)]
    return "\n".join([*lines, "*MATERIAL, NAME=M", "*ELASTIC", "1000., 0.3",
                      "*SOLID SECTION, ELSET=BEAM, MATERIAL=M", "*BOUNDARY", *ends,
                      "*STEP, NLGEOM", "*STATIC", "*BOUNDARY", f"2026, 2, 2, -{down}",
                      "*END STEP"]) + "\n"
