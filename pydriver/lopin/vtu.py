"""Reads the .vtu files of Lopin: XML with raw binary arrays at its end.

meshio reads them, too, except where its renumbering of offsets meets one of ours (small files).
"""
from __future__ import annotations

import re
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from .cells import CELLS
from .errors import ResourceError

_DTYPES = {"Float32": "<f4", "Float64": "<f8", "Int8": "i1", "UInt8": "u1", "Int32": "<i4",
           "Int64": "<i8"}
#: meshio's names of VTK's cell numbers.
_NAMES = {1: "vertex", 3: "line", 5: "triangle", 9: "quad", 10: "tetra", 12: "hexahedron",
          13: "wedge", 21: "line3", 22: "triangle6", 23: "quad8", 24: "tetra10",
          25: "hexahedron20", 26: "wedge15"}


def read_vtu(path: str | Path):
    """The `meshio.Mesh` of a file of Lopin."""
    import meshio

    raw = Path(path).read_bytes()
    start = re.search(rb'<AppendedData encoding="raw">\s*_', raw)
    if not start:
        raise ResourceError(f"{path} is not a result file of Lopin")
    head = raw[:start.start()] + b"</VTKFile>"
    root = ElementTree.fromstring(head)
    piece = root.find(".//Piece")

    def array(tag) -> np.ndarray:
        first = start.end() + int(tag.get("offset"))
        size = int.from_bytes(raw[first:first + 8], "little")
        values = np.frombuffer(raw[first + 8:first + 8 + size], _DTYPES[tag.get("type")])
        width = int(tag.get("NumberOfComponents", 1))
        return values.reshape(-1, width) if width > 1 else values

    def group(name: str) -> dict[str, np.ndarray]:
        tags = piece.find(name)
        return {tag.get("Name"): array(tag) for tag in (() if tags is None else tags)}

    cells = group("Cells")
    blocks, order = _blocks(cells["connectivity"], cells["offsets"], cells["types"])
    cell_data = {name: [values[k] for k in order] for name, values in group("CellData").items()}
    return meshio.Mesh(array(piece.find("Points")[0]), blocks, group("PointData"), cell_data)


def _blocks(connectivity, offsets, types) -> tuple[list, list]:
    """Cells by type, in the order of their first cell, and the numbers of the cells of each."""
    starts = np.concatenate([[0], offsets[:-1]])
    blocks, order = [], []
    for kind in dict.fromkeys(types.tolist()):
        numbers = np.flatnonzero(types == kind)
        name = _NAMES[kind]
        width = CELLS[name].n_node if name in CELLS else 1
        blocks.append((name, connectivity[starts[numbers][:, None] + np.arange(width)]))
        order.append(numbers)
    return blocks, order
