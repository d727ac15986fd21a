"""Dies of facets pressed into coarse slabs: a polygon for a circle, at phases of its facets."""
import math

from lopin.deck import Deck
from lopin.mesh_make import block, extruded, simplices

RADIUS, DOWN, DEEP, HALF = 20.0, 0.15, 10.0, 10.0


def corners(facet, phase, axis=False):
    """A polygon about (0, RADIUS), its corners on the circle, from right to left."""
    angle = facet/RADIUS
    turned = [(i + phase)*angle for i in range(8, -9, -1)]
    points = [(RADIUS*math.sin(a), RADIUS - RADIUS*math.cos(a)) for a in turned]
    if not axis:
        return points
    kept = [p for p in points if p[0] > 1e-9]
    last, beyond = kept[-1], points[len(kept)]
    share = last[0]/(last[0] - beyond[0])
    return kept + [(0.0, last[1] + share*(beyond[1] - last[1]))]


def stl(points, width):
    """Triangles of the polygon along y, the material above."""
    text = ["solid die"]
    for (x, z), (u, w) in zip(points, points[1:]):
        a, b, c, d = (x, -1.0, z), (u, -1.0, w), (u, width, w), (x, width, z)
        for tri in ((a, b, c), (a, c, d)):
            text += ["facet normal 0 0 0", "outer loop",
                     *("vertex " + " ".join(repr(v) for v in p) for p in tri), "endloop", "endfacet"]
    return "\n".join([*text, "endsolid die"]) + "\n"


#: The words of first order whose corners those of second order have.
CORNERS = {"CPE8": "CPE4", "CPE8R": "CPE4", "CPE6": "CPE3", "CAX8": "CAX4", "C3D20": "C3D8", "C3D20R": "C3D8",
           "C3D10": "C3D4", "C3D15": "C3D6"}


def slab(kind, size):
    if kind in CORNERS:
        return slab(CORNERS[kind], size).quadratic()
    n = round(2*HALF/size)
    down = max(4, round(DEEP/size))
    if kind == "CAX4":
        return block((HALF, DEEP), (n//2, down), origin=(0.0, -DEEP))
    if kind in ("CPE4", "CPE3"):
        mesh = block((2*HALF, DEEP), (n, down), origin=(-HALF, -DEEP))
    else:
        mesh = block((2*HALF, size, DEEP), (n, 1, down), origin=(-HALF, 0.0, -DEEP))
    if kind == "C3D6":
        return extruded(simplices(block((2*HALF, size), (n, 1), origin=(-HALF, 0.0))), DEEP, down).moved(0.0, 0.0, -DEEP)
    return simplices(mesh) if kind in ("CPE3", "C3D4") else mesh


def pressed(kind, facet, phase, size=2.0, path="", tool="SEGMENTS", mu=0.0, slide=None, steps=12,
            folder=None, down=DOWN, points=None, smooth=""):
    """`facet` 0: round, `points`: a profile given; `smooth`: `, SMOOTH=NO`; `tool`: SEGMENTS, CYLINDER or STL; `slide`: the way of a second step in so many increments."""
    mesh = slab(kind, size)
    points = points or (corners(facet, phase, kind.startswith("CAX")) if facet else None)
    d = 3 if kind.startswith("C3") else 2
    text = ["*HEADING", "A die of facets", *([f"*LOPIN, PATH={path}"] if path else []),
            "*NODE, NSET=N", *(f"{i + 1}, " + ", ".join(map(repr, x)) for i, x in
                               enumerate(mesh.points.tolist())), f"*ELEMENT, TYPE={kind}, ELSET=E"]
    for _, rows in mesh.blocks:
        text += [f"{i + 1}, " + ", ".join(str(n + 1) for n in r) for i, r in enumerate(rows.tolist())]
    text += ["*SURFACE, NAME=TOP", *(f"{e + 1}, S{f}" for e, f in mesh.surfaces["TOP"].tolist()),
             "*NSET, NSET=LOW", *(f"{n + 1}," for n in mesh.point_sets["BOTTOM"].tolist()),
             "*NSET, NSET=P", "9001", "*NODE", "9001, 0., " + ("0., " if d == 3 else "") + f"{RADIUS!r}"]
    if points is None:
        x, y = RADIUS*math.sin(1.0), RADIUS - RADIUS*math.cos(1.0)
        profile = [f"START, {x!r}, {y!r}", f"CIRCL, 0., 0., 0., {RADIUS!r}"]
        if not kind.startswith("CAX"):
            profile += [f"CIRCL, {-x!r}, {y!r}, 0., {RADIUS!r}"]
    else:
        profile = [f"START, {points[0][0]!r}, {points[0][1]!r}",
                   *(f"LINE, {p[0]!r}, {p[1]!r}" for p in points[1:])]
    if tool == "STL":
        (folder/"die.stl").write_text(stl(points, size + 1.0))
        text += [f"*SURFACE, NAME=TOOL, TYPE=STL, OPEN{smooth}, INPUT={folder/'die.stl'}"]
    elif d == 3:
        text += ["*SURFACE, NAME=TOOL, TYPE=CYLINDER", "0., 0., 0., 1., 0., 0.", "0., -1., 0.", *profile]
    else:
        text += ["*SURFACE, NAME=TOOL, TYPE=SEGMENTS", *profile]
    held = ["P, 1", "P, 6"] if d == 2 else ["P, 1, 2", "P, 4, 6"]
    if kind.startswith("CAX"):
        held = ["P, 1", "P, 6"]
        text += ["*NSET, NSET=MID", *(f"{n + 1}," for n in mesh.point_sets["LEFT"].tolist())]
        held += ["MID, 1"]
    if d == 3:
        held += ["N, 2"]
    text += ["*RIGID BODY, ANALYTICAL SURFACE=TOOL, REF NODE=9001", "*MATERIAL, NAME=M", "*ELASTIC",
             "1000., 0.3", "*SOLID SECTION, ELSET=E, MATERIAL=M", "1.,", "*SURFACE INTERACTION, NAME=I",
             *(["*FRICTION", f"{mu!r},"] if mu else []),
             "*CONTACT PAIR, INTERACTION=I", "TOP, TOOL", "*BOUNDARY", f"LOW, 1, {d}", *held,
             "*STEP, INC=100", "*STATIC", "0.5, 1.", "*BOUNDARY", f"P, {d}, {d}, {-down!r}",
             "*END STEP"]
    if slide is not None:
        text += ["*STEP, INC=500", "*STATIC, DIRECT", f"{1/steps!r}, 1.", "*BOUNDARY",
                 f"P, 1, 1, {slide!r}", "*END STEP"]
    return Deck.parse("\n".join(text) + "\n", name="die")
