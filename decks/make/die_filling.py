"""How far a forging between STL dies has filled them: figures and a picture of stages.

    python decks/make/die_filling.py SCENE FOLDER [PART ...]

reads what a run with *REMESH of a scene of `die_forging.py` (FULL) has left in FOLDER: the shape
that parts begin with, and the end of the last one. Prints the gap between die and metal inside the
land, where the flash ends, the volume, meshes, increments and seconds by phase, and draws
docs/pictures/SCENE.png from the stages named by PART (0: the start, -1: the end).

    python decks/make/die_filling.py SCENE walls

prints how far the triangles themselves are off the curved wall, by their deviation.
"""
import csv
import json
import sys
from pathlib import Path

import matplotlib
import meshio
import numpy as np
from die_forging import FULL, triangles
from die_shapes import Cross

import lopin
from lopin.remesh.body import DeckParts, boundary_facets
from lopin.remesh.space import closest_on_facets, narrowest_slot, volume_inside

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.colors import LightSource  # noqa: E402
from mpl_toolkits.mplot3d.art3d import Poly3DCollection  # noqa: E402


def parts(folder: Path, name: str) -> list[str]:
    """Names of the parts of a run, in order."""
    return sorted(p.stem for p in folder.glob(f"{name}.p[0-9][0-9][0-9].inp"))


def start_of(folder: Path, part: str):
    """Nodes and tetrahedra that a part begins with."""
    cards = DeckParts.of(lopin.Deck.read(folder/f"{part}.inp")).cards
    rows = {label: k for k, label in enumerate(cards.nodes)}
    cells = np.array([[rows[n] for n in nodes] for _, nodes in cards.elements.values()])
    return np.array([x[:3] for x in cards.nodes.values()], float), cells


def end_of(folder: Path, part: str):
    """Nodes and tetrahedra where a part ended."""
    mesh = meshio.read(sorted(folder.glob(f"{part}_[0-9]*.vtu"))[-1])
    cells = next(c.data for c in mesh.cells if c.type == "tetra")
    return mesh.points + mesh.point_data["U"], cells


def skin_of(x, cells):
    """Facets of the skin that lie on no plane of symmetry."""
    facets, _ = boundary_facets([cells], 3)
    held = (np.abs(x[facets]) < 1e-9).all(axis=1).any(axis=1)
    return facets[~held]


def time_of(folder: Path, part: str) -> float:
    """Total time at which a part begins."""
    deck = lopin.Deck.read(folder/f"{part}.inp")
    return float(deck["START"].parameters["TIME"]) if "START" in deck else 0.0


def history(folder: Path, names: list[str]):
    """Time and the force of the upper die, over all parts; increments and iterations."""
    rows, work = [], np.zeros(2, int)
    for name in names:
        with (folder/f"{name}_history.csv").open(newline="") as file:
            head, *lines = list(csv.reader(file))
        at = [word.partition(" ")[0] for word in head]
        columns = [at.index(k) for k in ("time", "UPPER.rf3")]
        rows += [[float(line[k]) for k in columns] for line in lines]
        work += [len(lines), sum(int(float(line[at.index("iterations")])) for line in lines)]
    return np.array(rows), work


def clearance(die, stl: Path, down: float, x, facets, samples: int = 400):
    """Distance from places of the die inside its land to the metal, and their places in plan.

    The die stands `down` below where its file has it.
    """
    mesh = meshio.read(stl)
    corner = mesh.points[mesh.cells_dict["triangle"]] - [0.0, 0.0, down]
    share = np.random.default_rng(1).dirichlet(np.ones(3), (len(corner), 3)).transpose(0, 1, 2)
    places = np.einsum("tsk,tkd->tsd", share, corner).reshape(-1, 3)
    low = -1e9 if not isinstance(die, Cross) else 0.0
    plan = (die.outline(*places[:, :2].T) < 0.0) & (places[:, 1] > 0.0) & (places[:, 0] > low)
    places = places[plan]
    facet, own = closest_on_facets(places, x, facets, among=24)
    foot = np.einsum("nk,nkd->nd", own, x[facets[facet]])
    return np.linalg.norm(places - foot, axis=1), places


def gap_of_nodes(die, above: float, x, facets):
    """Distance from the nodes of the skin inside the land to the curved wall of the die, and their
    places. The parting plane of the die lies `above` that of the metal.

    A die is full where these are small; between nodes the chord of a cell of h is off an arc of
    radius R by h^2/8R besides.
    """
    own = x[np.unique(facets)]
    own = own[die.outline(*own[:, :2].T) < 0.0]
    return off_the_wall(die, above, own), own


def off_the_wall(die, above: float, places):
    """Distance from places inside the land to the curved wall of a die."""
    step = 1e-4
    at = die.height(*places[:, :2].T)
    slope = np.hypot(*((die.height(*(places[:, :2] + d).T) - at)/step
                       for d in np.eye(2)*step))
    return np.abs(at + above - places[:, 2])/np.hypot(1.0, slope)


def tell_walls(scene: str) -> None:
    """How far triangles are off the wall that they stand for, inside the land of a quarter."""
    die = FULL[scene][0]
    for deviation in (0.1, 0.05, 0.02):
        corner = triangles(die, 0.0, deviation).reshape(-1, 3, 3)
        share = np.random.default_rng(1).dirichlet(np.ones(3), (len(corner), 10))
        places = np.einsum("tsk,tkd->tsd", share, corner).reshape(-1, 3)
        quarter = (places[:, 1] > 0.0) & ((places[:, 0] > 0.0) | (not isinstance(die, Cross)))
        places = places[quarter & (die.outline(*places[:, :2].T) < 0.0)]
        off = off_the_wall(die, 0.0, places)
        print(f"deviation {deviation:g}, {len(corner)} triangles: most {off.max():.3f} mm, "
              f"99 % below {np.quantile(off, 0.99):.3f}, above 0.05: {100*(off > 0.05).mean():.2f} %")


def flash_of(die, x):
    """How far beyond the outline of the cavity the metal of the parting plane reaches: least, most."""
    rim = x[np.abs(x[:, 2]) < 1e-9]
    angle = np.arctan2(rim[:, 1], rim[:, 0])
    beyond = die.outline(rim[:, 0], rim[:, 1])
    bins = np.linspace(0.0, 0.5*np.pi if isinstance(die, Cross) else np.pi, 25)
    most = [beyond[(angle >= a) & (angle <= b)].max(initial=-9.0) for a, b in zip(bins, bins[1:])]
    return min(most), max(most)


def phases(folder: Path, names: list[str]) -> dict[str, float]:
    """Seconds by phase, all parts, remeshes with their transfer, and the most memory [MiB]."""
    total: dict[str, float] = {}
    for name in names:
        summary = json.loads((folder/f"{name}.json").read_text())
        for phase, seconds in summary["timing"].items():
            total[phase] = total.get(phase, 0.0) + seconds
        total["memory"] = max(total.get("memory", 0.0), summary["peak_memory_mib"])
    return {k: round(v, 1) for k, v in total.items()}


def draw(scene: str, stages: list, mirrors: list) -> None:
    """The stages side by side, lit from above, the sector repeated by symmetry."""
    figure = plt.figure(figsize=(4.2*len(stages), 3.8))
    light = LightSource(315, 40)
    for k, (x, facets, title) in enumerate(stages):
        axis = figure.add_subplot(1, len(stages), k + 1, projection="3d")
        shown = np.concatenate([(x*m)[facets][:, ::int(np.prod(m))] for m in mirrors])
        axis.add_collection3d(Poly3DCollection(shown, facecolors="lightsteelblue", shade=True,
                                               edgecolors=(0.2, 0.2, 0.2, 0.35), linewidths=0.15,
                                               lightsource=light))
        low, high = shown.reshape(-1, 3).min(axis=0), shown.reshape(-1, 3).max(axis=0)
        axis.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
        axis.set_title(title, fontsize=9)
        long = (high - low)[0] > 2.0*(high - low)[1]
        axis.set_box_aspect(high - low, zoom=0.95 if long else 1.25)
        axis.view_init(38, -60)
        axis.set_axis_off()
    figure.subplots_adjust(0, 0, 1, 0.94, 0, 0)
    figure.savefig(Path(__file__).resolve().parents[2]/"docs"/"pictures"/f"{scene}.png", dpi=90)


def figures(scene: str, folder: Path) -> dict:
    """What is told of a run: the last part with results is its end. Lengths in mm, forces in N."""
    die, name, speed, _ = FULL[scene]
    names = parts(folder, scene)
    while not list(folder.glob(f"{names[-1]}_[0-9]*.vtu")):
        names.pop()
    table, work = history(folder, names)
    x, cells = end_of(folder, names[-1])
    facets = skin_of(x, cells)
    first, tets = start_of(folder, names[0])
    before, after = (volume_inside(p, boundary_facets([c], 3)[0])
                     for p, c in ((first, tets), (x, cells)))
    gap, places = clearance(die, folder.parent/f"{name}_upper.stl", speed*table[-1, 0], x, facets)
    worst = int(np.argmax(gap))
    remeshes = json.loads((folder/f"{scene}.parts.json").read_text())["remeshes"]
    return {"meshes": len(names), "cells": len(cells), "increments": int(work[0]),
            "iterations": int(work[1]), "stroke": speed*float(table[-1, 0]),
            "force": -float(table[-1, 1]), "volumes": (float(before), float(after)),
            "gap": float(gap[worst]), "gap_at": places[worst].round(1).tolist(),
            "gap_mean": float(gap.mean()), "gap_above": float((gap > 0.05).mean()),
            "flash": tuple(map(float, flash_of(die, x))),
            "slot": float(narrowest_slot(x, facets, 2.0)[0]),
            "phases": phases(folder, names), "jumps": [r["force_change"] or 0.0 for r in remeshes],
            "remeshing": sum(r["seconds"] for r in remeshes)}


def stages_of(scene: str, folder: Path, chosen: list[int], stroke: float) -> list:
    """Shapes that parts begin with, or the end (-1), and what stands above each."""
    names, speed = parts(folder, scene), FULL[scene][2]
    stages = []
    for part in chosen:
        shape = end_of(folder, names[-1]) if part < 0 else start_of(folder, names[part])
        down = stroke if part < 0 else speed*time_of(folder, names[part])
        stages.append((shape[0], skin_of(*shape), f"stroke of a die {down:.1f} mm"))
    return stages


def main(scene: str, folder: Path, chosen: list[int]) -> None:
    """Tell the figures, and draw."""
    found = figures(scene, folder)
    before, after = found["volumes"]
    print("{meshes} meshes, the last of {cells} cells; {increments} increments, {iterations} "
          "iterations; stroke {stroke:.3f}".format(**found), f"force {found['force']/1e3:.1f} kN")
    print(f"volume {before:.1f} to {after:.1f}: {100*(after/before - 1):+.3f} %")
    print("gap inside the outline: most {gap:.3f} at {gap_at}, mean {gap_mean:.3f}, above 0.05: "
          "{gap_above:.1%}".format(**found))
    print("flash beyond the outline: %.2f to %.2f mm" % found["flash"])
    print(f"skins that face each other across air: {found['slot']:.2f} mm apart at least")
    print(found["phases"])
    print("remeshes", round(found["remeshing"], 1), "s; force at rest",
          [round(jump, 4) for jump in found["jumps"]])
    if chosen:
        draw(scene, stages_of(scene, folder, chosen, found["stroke"]), FULL[scene][3])


if __name__ == "__main__":
    if sys.argv[2:] == ["walls"]:
        tell_walls(sys.argv[1])
    else:
        main(sys.argv[1], Path(sys.argv[2]), [int(word) for word in sys.argv[3:]])
