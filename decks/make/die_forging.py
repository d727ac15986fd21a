"""Decks of forging between dies of STL files: `python decks/make/die_forging.py name > deck.inp`.

Writes the dies beside the deck, into decks/. Each function takes the folder of the dies and
returns the text of a whole deck; its first comment says what to expect.
"""
from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from deck_text import lean, text
from die_shapes import Cross, Die, Rod, irregular, mirrored, moved, on_grid, volume
from tools import FOLDER, binary

from lopin import mesh_make
from lopin.mesh import Mesh, together

OVER = 1.12     #: volume of a piece beside that of the cavity
FILLED = 1.15   #: the same, of pieces that are to fill their dies
SPEED = 50.0    #: of a die [mm/s]


def sector(length: float, cells: tuple[int, int], whole: bool, tets: bool) -> Mesh:
    """A quarter of a cylinder of radius 1 about z; sides X, Y, END, ROUND, LOW."""
    mesh = mesh_make.cylinder(1.0, length, cells, part="quarter")
    mesh = mesh.mapped(lambda x: np.column_stack([-x[:, 1], x[:, 0], x[:, 2]]))
    if whole:
        mesh = mesh.mapped(lambda x: x - [0.0, 0.0, 0.5*length])
    names = {"X": "BACK", "Y": "LEFT", "END": "TOP", "ROUND": "ARC", "LOW": "BOTTOM"}
    mesh = mesh.replaced(surfaces={k: mesh.surfaces[v] for k, v in names.items()},
                         point_sets={k: mesh.point_sets[v] for k, v in names.items()})
    return mesh_make.simplices(mesh) if tets else mesh


def upset_bar(die: Cross, radius: float, cells: tuple[int, int], whole: bool,
              tets: bool, over: float = OVER) -> tuple[Mesh, float]:
    """A round bar on end, and half its height."""
    half = over*volume(die)/(0.25*np.pi*radius**2)
    mesh = sector((1.0 + whole)*half, (cells[0], (1 + whole)*cells[1]), whole, tets)
    mesh = mesh.mapped(lambda x: x*[radius, radius, 1.0])
    skin = ("END", "ROUND", "LOW") if whole else ("END", "ROUND")
    held = ("X", "Y") if whole else ("X", "Y", "LOW")
    return skinned(mesh, skin, held), half


def of_volume(mesh: Mesh, wanted: float, across: tuple[int, int]) -> Mesh:
    """The tetrahedra made wider in two directions: what chords of a coarse mesh lack is there."""
    corner = mesh.points[mesh.blocks[0][1]]
    now = np.linalg.det(corner[:, 1:] - corner[:, :1]).sum()/6.0
    wider = np.ones(3)
    wider[list(across)] = np.sqrt(wanted/now)
    return mesh.mapped(lambda x: x*wider)


def rolled_bar(die: Rod, cells: tuple[int, int], tets: bool, ends: float = 0.0,
               more: tuple[float, float] = (1.0, 1.0), over: float = OVER) -> Mesh:
    """A bar along x whose sections are those of the cavity, rounded off along it; y, z >= 0.

    Its ends are round over a length `ends`: flat ones hit the land by their rims. `more`: how much
    larger than elsewhere the sections at the big and at the small end are meant.
    """
    x = np.linspace(-0.95*die.big[0], die.centres + 0.95*die.small[0], 121)
    y = (np.arange(400) + 0.5)/400*die.box[3]
    plan = np.meshgrid(x, y, indexing="ij")
    area = np.where(die.outline(*plan) < 0.0, die.height(*plan), 0.0).sum(axis=1)*die.box[3]/400
    radius = np.sqrt(4.0*np.maximum(area, 20.0)/np.pi)
    radius = np.convolve(np.pad(radius, 10, "edge"), np.full(21, 1.0/21.0), "valid")
    radius *= np.sqrt(np.interp(x, [0.0, 0.3*die.centres, 0.7*die.centres, die.centres],
                                [more[0], 1.0, 1.0, more[1]]))
    if ends > 0.0:
        inward = np.minimum(1.0, np.minimum(x - x[0], x[-1] - x)/ends)
        radius *= np.maximum(0.3, np.sqrt(inward*(2.0 - inward)))
    radius *= np.sqrt(over*volume(die)/np.trapezoid(0.25*np.pi*radius**2, x))
    mesh = sector(x[-1] - x[0], cells, False, tets)

    def along(p):
        at = x[0] + p[:, 2]
        r = np.interp(at, x, radius)
        return np.column_stack([at, r*p[:, 0], r*p[:, 1]])
    mesh = mesh.mapped(along)
    mesh = of_volume(mesh, over*volume(die), (1, 2)) if over > OVER else mesh
    return skinned(mesh, ("END", "ROUND", "LOW"), ("X", "Y"))


def skinned(mesh: Mesh, skin: tuple[str, ...], held: tuple[str, ...]) -> Mesh:
    """The mesh as part BILLET with the surface SKIN and the sets that symmetry holds."""
    mesh = mesh.replaced(surfaces={"SKIN": np.concatenate([mesh.surfaces[s] for s in skin])})
    return together(BILLET=lean(mesh, "SKIN", " ".join(held)))


def triangles(die: Die, size: float, deviation: float, seed: int | None = None) -> np.ndarray:
    """Of the upper die: a grid of a size, or irregular by a deviation."""
    return on_grid(die, size) if size else irregular(die, deviation, seed=seed)


def write_dies(folder: Path, name: str, facets: np.ndarray, up: float, whole: bool) -> list[str]:
    """One or two dies, open by `up` each; their names."""
    upper = moved(facets, up)
    (folder/f"{name}_upper.stl").write_bytes(binary(upper))
    if whole:
        (folder/f"{name}_lower.stl").write_bytes(binary(mirrored(upper)))
    return ["UPPER", "LOWER"][:1 + whole]


def forged(mesh: Mesh, comment: str, name: str, dies: list[str], held: list[str], way: float, *,
           method: str = "DIRECT", friction: str = "0.15", far: float = 60.0,
           card: str = "") -> str:
    """A piece of hot steel between dies that come together at SPEED; `card`: how it is meshed anew.

    `friction`: a coefficient, or a law and its number as "TRESCA 0.3".
    """
    *law, number = friction.split()
    tools = ""
    for k, die in enumerate(dies):
        tools += f"""*NODE, NSET={die}_REF
{900001 + k}, 0., 0., {far*(1 - 2*k):g}
*SURFACE, NAME={die}, TYPE=STL, OPEN, INPUT={name}_{die.lower()}.stl
*RIGID BODY, ANALYTICAL SURFACE={die}, REF NODE={die}_REF
"""
    pairs = "".join(f"*CONTACT PAIR, INTERACTION=GRAPHITE\nBILLET.SKIN, {die}\n" for die in dies)
    fixed = "".join(f"{die}_REF, 1, 2\n{die}_REF, 4, 6\n" for die in dies)
    moves = "".join(f"{die}_REF, 3, 3, {SPEED*(2*k - 1):g}\n" for k, die in enumerate(dies))
    return text(mesh, comment, f"""*MATERIAL, NAME=HOT
*ELASTIC
100000., 0.3
*VISCOPLASTIC, LAW=NORTON-HOFF
41., 0.145
*SOLID SECTION, ELSET=BILLET, MATERIAL=HOT
{tools}*SURFACE INTERACTION, NAME=GRAPHITE
*SURFACE BEHAVIOR, {method}
*FRICTION{"".join(f", LAW={word}" for word in law)}
{number},
{pairs}*BOUNDARY
{"".join(line + chr(10) for line in held)}{fixed}{card}*STEP, NAME=FORGE, NLGEOM, INC=1000
*STATIC
{way/SPEED/50.0:g}, {way/SPEED:g}
*BOUNDARY, TYPE=VELOCITY
{moves}*OUTPUT, FIELD, FREQUENCY=10
*NODE OUTPUT
U
*ELEMENT OUTPUT
S, PEEQ
*END STEP
""", "3d")


def cross(folder: Path = FOLDER, cells: tuple[int, int] = (3, 8), way: float = 15.0, *,
          size: float = 0.0, deviation: float = 0.1, tets: bool = False, whole: bool = False,
          method: str = "DIRECT", mu: float = 0.15, seed: int | None = None) -> str:
    """A bar upset into a cardan cross; `whole`: a quarter between both dies, else an eighth."""
    die, radius = Cross(), 13.0
    mesh, half = upset_bar(die, radius, cells, whole, tets)
    angle, r = np.meshgrid(np.linspace(0.0, 0.5*np.pi, 41), np.linspace(0.0, radius, 41))
    lowest = die.height(r*np.cos(angle), r*np.sin(angle)).min()
    facets = triangles(die, size, deviation, seed)
    dies = write_dies(folder, "cross", facets, half - lowest + deviation, whole)
    held = ["BILLET.X, 1", "BILLET.Y, 2"] + ([] if whole else ["BILLET.LOW, 3"])
    return forged(mesh, f"""
A bar on end is forged into a cardan cross between dies of STL files: an eighth, default settings.

    ___|UPPER|___    Bar of {2.0*radius:g} mm across and {2.0*half:.1f} mm high; trunnions of 16 mm,
   /   | bar |   \\   64 mm from end to end, draft 7 degrees, radii 2.5 and 3 mm, flash of 2 mm.
       |     |       Norton-Hoff: K = 41 MPa s^m, m = 0.145 (C45 at 1100 C), mu = {mu:g}, 50 mm/s a
  {way:g} mm of 20    die. {len(facets)} triangles of all shapes, as a CAD program exports them:
                     their edges are off the die by no more than {deviation:g} mm.

The bar is coarse, and its mesh is not made anew: the run ends before it folds (W0531, at 16 mm).
Face S4 of an element beside the land is too coarse for the edge of the cavity (W0337). Bars of
other meshes, dies of other triangles: docs/forming.md, section 8.

expect: certificate.verdict = PASS
expect: history.UPPER.rf3 = -29.3e3 +- 2 %
expect: history.BILLET.SKIN-UPPER.max_penetration < 1e-9
""", "cross", dies, held, way, method=method, friction=f"{mu:g}")


def rod(folder: Path = FOLDER, cells: tuple[int, int] = (4, 40), way: float = 3.5, *,
        size: float = 0.0, deviation: float = 0.05, tets: bool = False,
        method: str = "DIRECT", mu: float = 0.15, seed: int | None = None) -> str:
    """A rolled bar pressed into a connecting rod: a quarter of its upper half."""
    die = Rod()
    mesh = rolled_bar(die, cells, tets)
    x, y, z = mesh.points.T
    up = float((z - die.height(x, y)).max())
    dies = write_dies(folder, "rod", triangles(die, size, deviation, seed), up + deviation, False)
    return forged(mesh, "A rolled bar between dies of a connecting rod.", "rod", dies,
                  ["BILLET.X, 2", "BILLET.Y, 3"], way, method=method, friction=f"{mu:g}")


def full_cross(folder: Path, fine: float = 1.0, cells: tuple[int, int] = (4, 10),
               way: float | None = None, *, deviation: float = 0.1, method: str = "DIRECT",
               friction: str = "0.15", over: float = FILLED, seed: int | None = None) -> str:
    """The cross to the full die, its mesh made anew; cells on the dies of `fine` mm."""
    die, radius = Cross(), 13.0
    mesh, half = upset_bar(die, radius, cells, False, True, over)
    mesh = of_volume(mesh, over*volume(die), (0, 1))
    angle, r = np.meshgrid(np.linspace(0.0, 0.5*np.pi, 41), np.linspace(0.0, radius, 41))
    up = half - float(die.height(r*np.cos(angle), r*np.sin(angle)).min()) + deviation
    dies = write_dies(folder, "cross", triangles(die, 0.0, deviation, seed), up, False)
    return forged(mesh, f"""
A bar on end is forged into a cardan cross, to the full die: an eighth, its mesh made anew.

Bar of {2.0*radius:g} mm across; the flash is {2.0*die.gap:g} mm thick at a stroke of {up:.2f} mm. Cells on the dies
down to {fine:g} mm. Shapes: decks/make/die_shapes.py; what it gives: docs/forming.md, section 9.
""", "cross", dies, ["BILLET.X, 1", "BILLET.Y, 2", "BILLET.LOW, 3"],
                  way or up, method=method, friction=friction,
                  card=f"*REMESH, ELSET=BILLET, SIZE={3.5*fine:g}, SMALLEST={fine:g}, "
                       f"HAUSDORFF={0.08*fine:g}, STRAIN=0.8\n")


def full_rod(folder: Path, fine: float = 1.8, cells: tuple[int, int] = (4, 40),
             ends: float = 10.0, way: float | None = None, *, deviation: float = 0.1,
             method: str = "DIRECT", friction: str = "0.15", over: float = OVER,
             more: tuple[float, float] = (1.0, 1.0), seed: int | None = None) -> str:
    """The connecting rod to the full die, its mesh made anew; cells on the dies of `fine` mm."""
    die = Rod()
    mesh = rolled_bar(die, cells, True, ends, more, over)
    x, y, z = mesh.points.T
    up = float((z - die.height(x, y)).max()) + deviation
    dies = write_dies(folder, "rod", triangles(die, 0.0, deviation, seed), up, False)
    return forged(mesh, f"""
A rolled bar is forged into a connecting rod, to the full die: a quarter, its mesh made anew.

Stroke of a die {up:.2f} mm, to a flash of {2.0*die.gap:g} mm. Cells on the dies down to {fine:g} mm.
Shapes: decks/make/die_shapes.py; what it gives: docs/forming.md, section 9.
""", "rod", dies, ["BILLET.X, 2", "BILLET.Y, 3"], way or up, method=method, friction=friction,
                  card=f"*REMESH, ELSET=BILLET, SIZE={3.5*fine:g}, SMALLEST={fine:g}, "
                       f"HAUSDORFF={0.08*fine:g}, STRAIN=0.8\n")


SCENES = {f.__name__: f for f in (cross, rod)}
#: Runs of minutes, by `python decks/make/die_forging.py full_cross FOLDER` (and fine=1.4,
#: friction="TRESCA 0.3", method=PENALTY, deviation=0.05), then `lopin run`; what die_filling.py
#: wants to know: die, name of its file, speed, signs of the copies by symmetry.
FULL = {"full_cross": (Cross(), "cross", SPEED,
                       [(a, b, c) for a in (1, -1) for b in (1, -1) for c in (1, -1)]),
        "full_rod": (Rod(), "rod", SPEED, [(1, b, c) for b in (1, -1) for c in (1, -1)])}


if __name__ == "__main__":
    if sys.argv[1] in FULL:
        where = Path(sys.argv[2])
        where.mkdir(parents=True, exist_ok=True)
        given = dict(word.split("=") for word in sys.argv[3:])
        given |= {k: float(given[k]) for k in ("fine", "deviation") if k in given}
        (where/f"{sys.argv[1]}.inp").write_text(globals()[sys.argv[1]](where, **given))
    else:
        for scene in sys.argv[1:]:
            print(SCENES[scene](), end="")
