"""Reads the .vtu files of Lopin: XML with raw binary arrays at its end.

meshio reads them, too, except where its renumbering of offsets meets one of ours (small files).
"""
from __future__ import annotations

import re
import zlib
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from .files import reading
from .mesh.cells import CELLS
from .mesh.with_wedges import meshio_module

_DTYPES = {"Float32": "<f4", "Float64": "<f8", "Int8": "i1", "UInt8": "u1", "Int32": "<i4",
           "Int64": "<i8"}
#: meshio's names of VTK's cell numbers.
_NAMES = {1: "vertex", 3: "line", 5: "triangle", 9: "quad", 10: "tetra", 12: "hexahedron",
          13: "wedge", 21: "line3", 22: "triangle6", 23: "quad8", 24: "tetra10",
          25: "hexahedron20", 26: "wedge15"}
#: Over all bytes before it; files of earlier versions have none.
_CHECKSUM = re.compile(rb"<!-- CRC-32 ([0-9a-f]{8}) -->")


def read_vtu(path: str | Path):
    """The `meshio.Mesh` of a file of Lopin.

    Raises
    ------
    DamagedResultError : the file is missing, cut off, or not what Lopin wrote.
    """
    meshio = meshio_module()
    with reading(path):
        raw = Path(path).read_bytes()
        start = re.search(rb'<AppendedData encoding="raw">\s*_', raw)
        if not start:
            raise ValueError("its binary part is missing")
        mark = _CHECKSUM.search(raw, max(start.end(), len(raw) - 100))
        if mark and zlib.crc32(raw[:mark.start()]) != int(mark[1], 16):
            raise ValueError("its checksum is not that of what was written")
        piece = ElementTree.fromstring(raw[:start.start()] + b"</VTKFile>").find(".//Piece")
        n_point, n_cell = int(piece.get("NumberOfPoints")), int(piece.get("NumberOfCells"))

        def array(tag, n: int = -1) -> np.ndarray:
            first = start.end() + int(tag.get("offset"))
            size = int.from_bytes(raw[first:first + 8], "little")
            if not start.end() <= first <= first + 8 + size <= len(raw):
                raise ValueError(f"it ends within '{tag.get('Name')}'")
            values = np.frombuffer(raw[first + 8:first + 8 + size], _DTYPES[tag.get("type")])
            width = int(tag.get("NumberOfComponents", 1))
            values = values.reshape(-1, width) if width > 1 else values
            if n >= 0 and len(values) != n:
                raise ValueError(f"'{tag.get('Name')}' has {len(values)} entries, not {n}")
            return values

        def group(name: str, n: int = -1) -> dict[str, np.ndarray]:
            tags = piece.find(name)
            return {str(tag.get("Name")): array(tag, n) for tag in (() if tags is None else tags)}

        cells = group("Cells")
        if len(cells["types"]) != n_cell or len(cells["offsets"]) != n_cell:
            raise ValueError(f"it does not have {n_cell} cells")
        nodes = cells["connectivity"]
        if len(nodes) and not 0 <= nodes.min() <= nodes.max() < n_point:
            raise ValueError("a cell has nodes that do not exist")
        blocks, order = _blocks(nodes, cells["offsets"], cells["types"])
        cell_data = {name: [values[k] for k in order]
                     for name, values in group("CellData", n_cell).items()}
        return meshio.Mesh(array(piece.find("Points")[0], n_point), blocks,
                           group("PointData", n_point), cell_data)


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
