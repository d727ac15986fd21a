"""The commands that Python answers: plot, chart, convert, example."""
from __future__ import annotations

import shutil
import time
from pathlib import Path

import numpy as np

from .deck import Deck, Row
from .errors import LopinError, ResourceError, UsageError
from .laws import METHODS
from .result import CLOSED


def plot(options) -> int:
    """Pressure of one pair at the end of a run, as a picture."""
    from . import open_result
    from . import plot as pictures

    contact = open_result(options.folder).contact(options.pair or 0).last
    ax = pictures.pressure(contact)
    ax.set_title(contact.pair)
    path = options.output or options.folder/"pressure.png"
    ax.figure.savefig(path, dpi=150)
    print(path)
    return 0


def chart(options) -> int:
    """Error and time of the four methods over penalties; the reference is the exact method."""
    from . import plot as pictures
    from .run import run

    deck = Deck.read(options.deck)
    if "*SURFACE BEHAVIOR" not in deck:
        raise UsageError(f"{options.deck} has no *SURFACE BEHAVIOR to vary")
    rows = []
    exact = _forces(run(with_method(deck, "lagrange", None)))
    slope = _slope_in_use(run(with_method(deck, "penalty", None)))
    for method in METHODS:
        for factor in (None,) if method == "lagrange" else (1e-2, 1e-1, 1e0, 1e1, 1e2):
            begin = time.perf_counter()
            try:
                force = _forces(run(with_method(deck, method, slope*factor if factor else None)))
                error = np.abs(force - exact).max()/np.abs(exact).max()
            except LopinError:
                error = np.nan
            rows.append((method, factor, error, time.perf_counter() - begin))
            spent = rows[-1][3]
            print(f"{method:10s} {factor or 'exact':>8} error {error:9.2e} time {spent:.3f} s")
    ax = pictures.new_axes()
    for method in METHODS:
        mine = [(t, max(e, 1e-16)) for m, _, e, t in rows if m == method]
        ax.loglog(*zip(*mine), "o-", label=method)
    ax.set(xlabel="time [s]", ylabel="relative error of the contact forces")
    ax.legend()
    ax.figure.savefig(options.output, dpi=150)
    print(options.output)
    return 0


def with_method(deck: Deck, method: str, slope: float | None) -> Deck:
    """The deck with another contact method in every interaction."""
    new = Deck.parse(deck.text(), deck.name, deck.folder)
    for block in new.all("SURFACE BEHAVIOR"):
        block.parameters = {METHODS[method].word: None}
        block.lines = [line for line in block.lines if isinstance(line, str)]
        if slope is not None:
            block.lines.append(Row([float(slope)]))
    return new


def _forces(result) -> np.ndarray:
    return np.concatenate([result.contact(k).last.force.ravel() for k in range(len(result.pairs))])


def _slope_in_use(result) -> float:
    """Pressure over penetration of a penalty run."""
    contacts = [result.contact(k).last for k in range(len(result.pairs))]
    pressure = np.concatenate([c.pressure[c.status == CLOSED] for c in contacts])
    gap = np.concatenate([c.gap[c.status == CLOSED] for c in contacts])
    if not (gap < 0.0).any():
        raise UsageError("nothing touches in this deck: there is no accuracy to compare")
    return float(np.median(pressure[gap < 0.0]/-gap[gap < 0.0]))


def convert(options) -> int:
    """A mesh file to the mesh part of a deck, or to any format that meshio writes."""
    from .mesh_read import read_mesh
    from .model import Model
    from .model_deck import mesh_deck

    mesh = read_mesh(options.source)
    if options.target.suffix.lower() == ".inp":
        kind = options.kind or ("3d" if mesh.ndim == 3 else "plane strain")
        mesh_deck(Model(options.source.stem, mesh, kind)).write(options.target)
        print(f"{options.target}: {mesh}")
        print(f"element sets: {', '.join(mesh.element_sets)}")
        print(f"surfaces: {', '.join(mesh.surfaces) or 'none'}")
        print(f"next: *INCLUDE, INPUT={options.target.name} in a deck with material and step")
    else:
        mesh.to_meshio().write(options.target)
        print(f"{options.target}: {mesh}")
    return 0


def example(options) -> int:
    """Copy a deck of the collection, or list the names."""
    collection = decks_folder()
    names = sorted(p.stem for p in collection.glob("*.inp"))
    if options.name is None:
        print("\n".join(names))
        return 0
    if options.name not in names:
        raise UsageError(f"no example '{options.name}'; examples: {', '.join(names)}")
    options.folder.mkdir(parents=True, exist_ok=True)
    for path in sorted(collection.glob(f"{options.name}.*")):
        print(shutil.copy(path, options.folder))
    return 0


def decks_folder() -> Path:
    """The collection of decks: in the package when installed, else in the source tree."""
    here = Path(__file__).resolve().parent
    for place in (here/"decks", here.parent.parent/"decks"):
        if place.is_dir():
            return place
    raise ResourceError("the collection of decks was not found")
