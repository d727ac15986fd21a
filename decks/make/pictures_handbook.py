"""Pictures of docs/handbook.md: errors of all decks, and two of their results."""
from __future__ import annotations

from pathlib import Path

import numpy as np
from drawing import DOTS, EXACT, INK, coloured, deformed, figure, save, tools

import lopin
from lopin.refine import refined

FOLDER = Path(__file__).resolve().parents[1]/"handbook"
LEAST = 1e-4   #: percent; what is smaller is drawn there


def errors(rows: list[dict]) -> None:
    """Estimate and true error of every deck beside the error asked for."""
    rows = [row for row in rows if row["true"]]
    rows.sort(key=lambda row: float(row["true"]))
    at = np.arange(len(rows))
    true = np.maximum(100.0*np.array([float(row["true"]) for row in rows]), LEAST)
    said = np.maximum(100.0*np.array([float(row["estimate"] or "nan") for row in rows]), LEAST)
    fig, ax = figure(7.0, 4.6)
    ax.hlines(at, np.fmin(true, said), np.fmax(true, said), color=EXACT, lw=1)
    ax.plot(said, at, "o", mfc="white", mec=INK, ms=5, label="estimate of the run")
    ax.plot(true, at, "o", color=DOTS, ms=5, label="true error")
    ax.axvline(1.0, color=INK, lw=0.8, ls="--")
    ax.set(xscale="log", xlabel="error [%]; dashed: asked; left end: 0.0001 % and less", yticks=at,
           yticklabels=[row["deck"] for row in rows])
    ax.legend(frameon=False, loc="upper left")
    save(fig, "handbook_errors")


def results() -> None:
    """Plastic strain under Prandtl's punch, and a wedge that raises a block."""
    fig, axes = figure(7.4, 3.4, 2)
    deck = refined(refined(lopin.Deck.read(FOLDER/"prandtl.inp")).deck).deck
    punch = lopin.run(plain(deck, "S, PEEQ"), executable=True)
    strain = 100.0*np.asarray(punch["PEEQ"]).ravel()
    drawn = deformed(axes[0], punch, strain, scale=1.0, limits=(0.0, 3.0), mesh=False)
    tools(axes[0], punch, scale=1.0)
    coloured(fig, drawn, axes[0], "plastic strain [%]")
    axes[0].set(title="prandtl", xlim=(0.0, 4.0), ylim=(-2.2, 0.6))
    wedge = lopin.run(plain(lopin.Deck.read(FOLDER/"wedge.inp"), "S"), executable=True)
    drawn = deformed(axes[1], wedge, np.asarray(wedge["S"])[:, 1], scale=1.0, limits=(-12.0, 0.0))
    tools(axes[1], wedge, scale=1.0)
    coloured(fig, drawn, axes[1], "stress upwards [MPa]")
    axes[1].set(title="wedge", xlim=(10.0, 115.0), ylim=(-5.0, 70.0))
    save(fig, "handbook_results")


def plain(deck, fields: str):
    """The deck without its question and with fields in every step."""
    from lopin.deck import Block
    blocks = []
    for block in deck.blocks:
        if block.keyword == "END STEP":
            blocks.append(Block("EL FILE", data=[[w.strip() for w in fields.split(",")]]))
        if block.keyword != "LOPIN":
            blocks.append(block)
    return lopin.Deck(blocks, preamble=deck.preamble, name=deck.name, folder=deck.folder)


def main(rows: list[dict]) -> None:
    """Both pictures."""
    errors(rows)
    results()
