"""Every deck of the collection can be built by `Model`, and gives the same bits.

`Model.read` turns each card into a call of a method of the model; what has no method is refused.
"""
from pathlib import Path

import lopin
import numpy as np
import pytest

from lopin.model_read_mesh import expanded  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]
#: A model has no method for these.
NO_METHOD = ("*REMESH", "*START", "*DAMAGE", "TYPE=R2D2")
DECKS = sorted((p for p in (ROOT/"decks").glob("*.inp")
                if not any(word in p.read_text() for word in NO_METHOD)), key=lambda p: p.stem)
#: Longer than a second: all their steps are run, but moved by little and in few increments.
LONG = {"rough_punch", "lifted_beam", "sliding_ball", "ring_compression", "folded_strip",
        "crushed_ring", "closed_die", "ironing", "upset_tetra", "wire_drawing", "rotating_rings",
        "capstan", "v_bending", "cup", "square_cup", "upsetting", "cattaneo", "wrapped_strip", "cross",
        "bending_unbending", "drawbead", "ball_on_ball", "ball_of_facets", "beam_over_corner",
        "nafems_punch", "hertz_sphere_3d"}


def flat(deck):
    """The deck with its includes in it."""
    return lopin.Deck(expanded(deck), name=deck.name, folder=deck.folder)


def shortened(deck, part=0.002):
    """All steps, each with a small part of its motion, in one increment if that converges."""
    deck, inside = flat(deck), False
    for block in deck.blocks:
        inside = inside or block.keyword == "STEP"
        if block.keyword == "STATIC":
            period = (block.data[0] + [None, None])[1] if block.data else 1.0
            block.lines = [lopin.deck.Row([period, period])]
            block.parameters.pop("DIRECT", None)
        elif block.keyword == "AMPLITUDE":
            flat_rows = [v for row in block.data for v in row if v is not None]
            block.lines = [lopin.deck.Row([*flat_rows[:2], flat_rows[-2], flat_rows[-1]*part])]
        elif block.keyword == "CLOAD" and "AMPLITUDE" not in block.parameters:
            for row in block.data:
                row[2] *= part
        elif block.keyword == "BOUNDARY" and inside and "AMPLITUDE" not in block.parameters:
            for row in block.data:
                row[3:] = [v*part for v in row[3:]]
    return deck


def run(scene):
    """The result, also of a run that stops early."""
    try:
        return lopin.run(scene, deterministic=True)
    except lopin.NotConvergedError as stopped:
        return stopped.result


def rows_of(result):
    """Rows of the points of the mesh, then those of reference points."""
    session = result.source.session
    meshed = np.unique(np.concatenate([session.field(n).ravel() for n in session.names()
                                       if n.startswith("MESH.") and n != "MESH.points"])) - 1
    return np.concatenate([meshed, np.setdiff1d(np.arange(len(result["U"])), meshed)])


@pytest.mark.parametrize("path", DECKS, ids=lambda p: p.stem)
def test_a_model_of_each_deck_gives_the_same_bits(core, path):
    deck = lopin.Deck.read(path)
    built = lopin.Model.read(deck).to_deck()
    if path.stem in LONG:
        deck, built = shortened(deck), shortened(built)
    one, other = run(deck), run(built)
    assert len(one.times) and np.array_equal(one.times, other.times)
    assert one.names == other.names and one.pairs == other.pairs
    rows, others = rows_of(one), rows_of(other)
    for k in range(len(one.times)):
        for name in set(one.names) - {"LABEL"}:
            assert np.array_equal(one.at(k)[name][rows], other.at(k)[name][others],
                                  equal_nan=True), f"{name} of increment {k}"
        for pair in one.pairs:
            fields = one.contact(pair).at(k).fields
            for name, values in fields.items():
                assert np.array_equal(values, other.contact(pair).at(k)[name], equal_nan=True)
    assert {d.keyword for d in lopin.Model.read(built).to_deck().blocks} == \
        {d.keyword for d in built.blocks}


@pytest.mark.parametrize("path", DECKS, ids=lambda p: p.stem)
def test_a_model_reads_what_it_writes(path):
    built = lopin.Model.read(path).to_deck()
    assert lopin.Model.read(built).to_deck().text() == built.text()
