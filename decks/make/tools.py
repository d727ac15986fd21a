"""Write the STL files that decks of this folder use as tools: `python decks/make/tools.py`."""
from __future__ import annotations

import struct
from pathlib import Path

import numpy as np

FOLDER = Path(__file__).resolve().parents[1]


def binary(facets: np.ndarray) -> bytes:
    """Triangles (n, corner, coordinate) as a binary STL file."""
    facets = np.asarray(facets, dtype="<f4")
    normal = np.cross(facets[:, 1] - facets[:, 0], facets[:, 2] - facets[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-30)[:, None]
    record = np.zeros(len(facets), dtype=[("x", "<f4", (4, 3)), ("spare", "<u2")])
    record["x"][:, 0] = normal
    record["x"][:, 1:] = facets
    head = b"written by decks/make/tools.py".ljust(80)
    return head + struct.pack("<I", len(facets)) + record.tobytes()


def words(facets: np.ndarray, name: str) -> str:
    """Triangles as an STL file in words."""
    lines = [f"solid {name}"]
    for a, b, c in np.asarray(facets, dtype=float):
        n = np.cross(b - a, c - a)
        lines.append("facet normal " + " ".join(f"{v:g}" for v in n/np.linalg.norm(n)))
        lines += ["outer loop"]
        lines += ["vertex " + " ".join(f"{v:.9g}" for v in x) for x in (a, b, c)]
        lines += ["endloop", "endfacet"]
    return "\n".join([*lines, f"endsolid {name}", ""])


def box(low, high) -> np.ndarray:
    """The twelve triangles of a box, normals outward."""
    low, high = np.asarray(low, float), np.asarray(high, float)
    facets = []
    for axis in range(3):
        for side in (0, 1):
            x = np.zeros((4, 3))
            x[:, axis] = side
            x[:, (axis + 1) % 3] = [0, 1, 1, 0]
            x[:, (axis + 2) % 3] = [0, 0, 1, 1] if side else [1, 1, 0, 0]
            facets += [x[[0, 1, 2]], x[[0, 2, 3]]]
    return low + np.array(facets)*(high - low)


def ball(radius: float, angles: np.ndarray, sectors: int) -> np.ndarray:
    """A closed ball that stands on the origin; angles of the rings from its lowest point, < pi."""
    turn = 2.0*np.pi*np.arange(sectors)/sectors
    out, up = np.sin(angles)[:, None], 1.0 - np.cos(angles)[:, None]
    ring = radius*np.stack([out*np.cos(turn), out*np.sin(turn), up + 0.0*turn], axis=2)
    south, north = np.zeros(3), np.array([0.0, 0.0, 2.0*radius])
    facets = []
    for i in range(sectors):
        j = (i + 1) % sectors
        facets.append([south, ring[0, j], ring[0, i]])
        facets.append([north, ring[-1, i], ring[-1, j]])
        for a, b in zip(ring[:-1], ring[1:], strict=True):
            facets += [[a[i], a[j], b[j]], [a[i], b[j], b[i]]]
    return np.array(facets)


def ball_near_the_pole() -> np.ndarray:
    """R = 50; rings 0.15 apart where it touches, growing beyond."""
    arc = [0.15]
    while arc[-1] < 0.94*50.0*np.pi:
        arc.append(arc[-1] + max(0.15, 0.25*(arc[-1] - 1.5)))
    angles = np.array(arc[:-1])/50.0
    return ball(50.0, angles[angles < 0.97*np.pi], 48)


def main() -> None:
    """Write all of them."""
    (FOLDER/"ball_of_facets.stl").write_bytes(binary(ball_near_the_pole()))
    (FOLDER/"die_plate.stl").write_text(words(box([-25.0, -25.0, 15.0], [25.0, 25.0, 20.0]), "die"),
                                        encoding="ascii")
    bad = FOLDER/"bad"/"stl"
    bad.mkdir(exist_ok=True)
    table = box([-10.0, -10.0, -5.0], [11.0, 11.0, 0.0])
    flipped = table.copy()
    flipped[5] = flipped[5][[0, 2, 1]]
    (bad/"hole.stl").write_text(words(table[:-1], "table"), encoding="ascii")
    (bad/"flipped.stl").write_text(words(flipped, "table"), encoding="ascii")
    (bad/"inside_out.stl").write_text(words(table[:, [0, 2, 1]], "table"), encoding="ascii")
    (bad/"good.stl").write_text(words(table, "table"), encoding="ascii")
    (bad/"cut_off.stl").write_bytes(binary(table)[:500])
    (bad/"no_stl.stl").write_text("ply\nformat ascii 1.0\n", encoding="ascii")


if __name__ == "__main__":
    main()
