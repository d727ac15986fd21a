"""Belts over more than a right angle of a drum, through finite rotations: what supports leave open."""
import re
import sys
from math import cos, exp, radians, sin
from pathlib import Path

import numpy as np
import pytest

import lopin
from lopin import mesh_make

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT/"decks"/"make"))
from meshes import Model, lean, mesh_deck  # noqa: E402

RADIUS, MODULUS, TENSION, MU = 100.0, 20000.0, 10.0, 0.3


def belt(angle: int, cell: int = 3) -> lopin.Deck:
    """The deck capstan over any angle, in increments of its own choice; cells of so many degrees."""
    def around(x):
        r, turn = np.hypot(x[:, 0], x[:, 1]), np.arctan2(x[:, 1], x[:, 0])*angle/90.0
        return np.column_stack([r*np.cos(turn), r*np.sin(turn)])

    mesh = mesh_make.ring(RADIUS, RADIUS + 1.0, (2, angle//cell), quadratic=True).mapped(around)
    mesh_text = mesh_deck(Model("mesh", lean(mesh, "INNER END", "START"), kind="plane stress")).text()
    text = (ROOT/"decks"/"capstan.inp").read_text(encoding="utf-8")
    text = text.replace("*INCLUDE, INPUT=capstan.mesh", mesh_text[mesh_text.index("*NODE"):].strip())
    ends = [radians(a) for a in np.linspace(angle + 20.0, -20.0, 5)]
    places = [f"{RADIUS*cos(a)!r}, {RADIUS*sin(a)!r}" for a in ends]
    drum = "\n".join([f"START, {places[0]}", *(f"CIRCL, {p}, 0., 0." for p in places[1:])])
    text = re.sub(r"START, -50[^\n]*\nCIRCL[^\n]*", drum, text)
    whole = radians(angle)
    stretch = TENSION*((exp(MU*whole) - 1.0)/MU - whole)/MODULUS
    text = text.replace("-0.0003", repr(-1.35*stretch)).replace(", SMALL SLIDING", "")
    text = text.replace("*STATIC, DIRECT", "*STATIC")
    return lopin.Deck.parse(re.sub(r"(NAME=(TIGHTEN|PULL))", r"\1, NLGEOM", text), "belt")


@pytest.mark.parametrize("angle, cell", [(90, 3), (200, 5)])
def test_an_end_that_is_led_round_the_drum_has_no_pressure_of_its_own(solve, angle, cell):
    """Nothing determines it: it had 4.6e11 MPa beside 0.1, and the certificate said PASS."""
    result = solve(belt(angle, cell))
    assert result.verdict == "PASS"
    assert [d["code"] for d in result.diagnostics if d["code"] == "N0409"]
    pull = abs(float(result.history["START.rf2"][-1]))
    # Euler and Eytelwein on the middle of the belt.
    right = TENSION*exp(MU*radians(angle))
    assert abs(pull/right - 1.0) < 0.01
    assert result.contact(0).last.pressure.max() < 1.05*right/RADIUS


@pytest.mark.parametrize("down, refused", [(0.0, False), (1e-3, True)])
def test_a_held_node_on_a_tool_bears_nothing(solve, down, refused):
    """Held in all directions on a fixed tool: it touches without a force, or is in its way."""
    mesh = mesh_make.block((4.0, 1.0), (8, 2))
    model = lopin.Model("held", mesh, kind="plane strain")
    model.section("ALL", lopin.laws.Elastic(1000.0, 0.3))
    tool = model.rigid_tool("TOOL", lopin.profile.plane(0.0, 9.0, side="above"))
    model.contact("BOTTOM", tool)
    model.fix("LEFT", "x", "y")
    step = model.step(nlgeom=True)
    step.move(tool, y=down)
    step.move("RIGHT", x=-0.02)
    deck = model.to_deck()
    if refused:
        with pytest.raises(lopin.LopinError, match="E0506.*overconstrained"):
            solve(deck)
        return
    result = solve(deck)
    contact = result.contact(0).last
    corner = np.argmin(contact.x[:, 0])
    assert contact.pressure[corner] == 0.0 and contact.pressure.max() > 0.0
    assert result.verdict == "PASS"
    assert "N0409" in [d["code"] for d in result.diagnostics]
