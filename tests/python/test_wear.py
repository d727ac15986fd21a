"""Wear: pressure by slip, beside closed forms and beside the friction work of a run."""
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from test_point_states import deck, grid

import lopin
from lopin import mesh_make
from lopin.__main__ import main, python_command
from lopin.wear import wear

DECKS = Path(__file__).resolve().parents[2]/"decks"


class Passing:
    """The block at one output."""

    pair, pressure = "BLOCK-FLOOR", np.full(40, 5.0)

    def __init__(self, place, path):
        self.place, self.path = place, path

    def __getitem__(self, name):
        assert name == "SLIP_PATH"
        return np.full(40, self.path)


class Sliding:
    """A block of length 4 under pressure 5 that slides by 6 over a floor at rest."""

    def __init__(self, outputs=61):
        self.times = np.linspace(0.0, 1.0, outputs)
        self.history = {"time": self.times, "FLOOR.u1": np.zeros(outputs)}
        self.x = np.stack([np.arange(0.05, 4.0, 0.1), np.zeros(40)], axis=1)

    def contact(self, pair):
        frames = [Passing(self.x + [6.0*time, 0.0], 6.0*time) for time in self.times]
        return SimpleNamespace(at=lambda k: frames[k])


def test_a_block_that_slides_over_a_floor():
    found = wear(Sliding())
    # Each point of the block slides by 6 under 5; the floor is passed by a block of length 4 where
    # the whole of it passes, by the part of it that has passed elsewhere.
    assert found.on_metal == pytest.approx(5.0*6.0)
    x = found.tool[:, 0]
    exact = 5.0*np.clip(np.minimum(x, 10.0 - x), 0.0, 4.0)
    assert found.on_tool == pytest.approx(exact, abs=5.0*0.3)
    assert found.on_tool.max() == pytest.approx(5.0*4.0, rel=0.06)
    assert found.lines().splitlines()[0] == "side,x,y,pressure_by_slip"
    assert "61 outputs" in found.line()


def test_coulomb_friction_dissipates_the_wear_by_mu(core):
    text = (DECKS/"upsetting.inp").read_text()
    text = text[:text.index("*STEP, NAME=TO_30")].replace(
        "*CONTACT FILE\n", "*CONTACT FILE, FREQUENCY=1\n")
    deck = lopin.Deck.parse(text, name="wear", folder=DECKS)
    with lopin.open(deck) as job:
        for _ in job:
            pass
    result = job.result
    found = wear(result)
    last = result.contact(0).last
    mu = float(deck["FRICTION"].data[0][0])
    work = last["FRICTION_WORK"].ravel()
    assert work.sum() == pytest.approx(result.history["energy.friction"][-1], rel=1e-9)
    slides = work > 0.05*work.max()
    assert slides.sum() >= 5
    # The area of a point grows on the way; the work is by the one of each increment.
    assert mu*(found.on_metal*last["WEIGHT"].ravel())[slides].sum() == pytest.approx(
        work[slides].sum(), rel=0.15)
    assert found.on_tool.max() <= 1.2*found.on_metal.max()


def test_the_command_writes_a_table(core, tmp_path, capsys):
    text = (DECKS/"upsetting.inp").read_text()
    deck = lopin.Deck.parse(text[:text.index("*STEP, NAME=TO_30")].replace(
        "*CONTACT FILE", "*CONTACT FILE, FREQUENCY=1"), name="wear", folder=DECKS)
    memory = wear(lopin.run(deck, output=tmp_path, executable=True))
    assert python_command(["wear", str(tmp_path)]) == 0
    rows = (tmp_path/"wear.csv").read_text().splitlines()
    assert len(rows) == 1 + len(memory.on_metal) + len(memory.on_tool)
    assert memory.line() in capsys.readouterr().out


def test_wear_needs_outputs_and_a_tool_that_does_not_turn():
    with pytest.raises(lopin.UsageError, match="outputs"):
        wear(Sliding(1))
    turning = Sliding()
    turning.history["FLOOR.u6"] = np.linspace(0.0, 1.0, 61)
    with pytest.raises(lopin.UsageError, match="turns"):
        wear(turning)


def test_a_run_with_new_meshes_has_neither_wear_nor_strains_of_its_blank(core, tmp_path, capsys):
    scene = deck("CAX4", *grid("CAX4"), 5.0, -0.5, mu=0.0, increments=8)
    text = scene.text().replace("*STEP", "*REMESH, ELSET=B, PERIOD=.5, STRAIN=9.\n*STEP").replace(
        "*END STEP", "*OUTPUT, FIELD, VARIABLE=PRESELECT\n*END STEP")
    lopin.Deck.parse(text).write(tmp_path/"disc.inp")
    assert main(["run", str(tmp_path/"disc.inp"), "-o", str(tmp_path/"out")]) == 0
    capsys.readouterr()
    for word, what in (("wear", "slave points"), ("flc", "strains count")):
        assert main([word, str(tmp_path/"out")]) == 2
        said = capsys.readouterr().err
        assert "meshes (*REMESH)" in said and what in said


def test_a_tool_is_worn_where_metal_has_lain_over_it(core):
    """A disc upset without friction: its rim passes the tool late. A place at r bears r/2 times the
    integral of p dh/h since the rim, at 5 sqrt(5/h), has come there."""
    mesh = mesh_make.block((5.0, 5.0), (8, 4))
    scene = deck("CAX4", mesh.points, mesh.blocks[0][1].tolist(), 5.0, -2.0, mu=0.0, increments=20)
    with lopin.open(lopin.Deck.parse(scene.text().replace("FLOOR, 1, 2", "FLOOR, 2"))) as job:
        for _ in job:
            pass
    found = wear(job.result)
    history = job.result.history
    height = 5.0 - 2.0*history["time"]
    pressure = -history["DIE.rf2"]*height/(np.pi*125.0)
    exact = []
    for r in found.tool[:, 0]:
        h = np.linspace(3.0, max(3.0, min(5.0, 125.0/r**2)), 200)
        rate = np.interp(-h, -height, pressure)/h
        exact.append(0.25*r*np.sum(np.diff(h)*(rate[:-1] + rate[1:])))
    worst = found.on_tool.argmax()
    assert found.tool[worst, 0] == pytest.approx(5.0, abs=0.6)
    assert found.on_tool[worst] == pytest.approx(max(exact), rel=0.05)
    assert np.abs(found.on_tool - exact).max() < 0.1*max(exact)
