"""The mesh of a deck, for `Model.read`: nodes, elements, sets, surfaces of element faces."""
from __future__ import annotations

import os
import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .deck import Block, Deck
from .errors import ModelError, UsageError
from .mesh.mesh import Mesh

#: Words that stand for another.
_SAME = {"CSS8": "C3D8I/3"}
_KINDS = {"CPE": "plane strain", "CPS": "plane stress", "CAX": "axisymmetric", "C3D": "3d"}
#: Files that may stand in one another.
DEEPEST = 32
#: Cells by the number of their nodes, in the plane and in space.
PLANE = {3: "triangle", 6: "triangle6", 4: "quad", 8: "quad8"}
SOLID = {4: "tetra", 10: "tetra10", 6: "wedge", 15: "wedge15", 8: "hexahedron",
          20: "hexahedron20"}

#: Degrees of freedom that words of *BOUNDARY hold.
HELD_BY_WORD = {"ENCASTRE": (1, 2, 3, 4, 5, 6), "PINNED": (1, 2, 3), "XSYMM": (1, 5, 6),
                "YSYMM": (2, 4, 6), "ZSYMM": (3, 4, 5), "XASYMM": (2, 3, 4), "YASYMM": (1, 3, 5),
                "ZASYMM": (1, 2, 6)}


def plain(value):
    """A label or word without its quotes."""
    return value.strip().strip('"') if isinstance(value, str) else value


def expanded(deck: Deck) -> list[Block]:
    """The blocks of a deck, those of its includes in their place."""
    return [block for block, _, _ in located(deck)]


def located(deck: Deck, path: Path | None = None, top: Path | None = None, depth: int = 0
            ) -> Iterator[tuple[Block, str, int]]:
    """Blocks, those of includes in their place, each with its file and line."""
    path, top = path or deck.folder/f"{deck.name}.inp", top or deck.folder
    line = 1 + len(deck.preamble)
    for block in deck.blocks:
        if block.keyword == "INCLUDE":
            inner = included(block, deck.folder, top)
            if inner is None or depth == DEEPEST:
                raise ModelError(f"cannot read the included file "
                                 f"'{plain(block.parameters.get('INPUT', ''))}'", id="E0105",
                                 file=str(path), line=line, column=1)
            yield from located(Deck.read(inner), inner, top, depth + 1)
        else:
            yield block, str(path), line
        line += 1 + block.head().count("\n") + len(block.lines)


def included(block: Block, folder: Path, top: Path) -> Path | None:
    """The file that an *INCLUDE names, as the reader of decks finds it: beside the file that names
    it, else beside the deck."""
    name = str(plain(block.parameters.get("INPUT") or ""))
    return next((path for path in (folder/name, top/name) if name and path.is_file()), None)


def named_from(deck: Deck, folder: Path) -> Deck:
    """A deck whose files, named from `folder`, are named from its own folder."""
    blocks = []
    for block in deck.blocks:
        name = block.parameters.get("INPUT")
        if name and not Path(str(plain(name))).is_absolute():
            here = os.path.relpath(Path(folder).resolve()/str(plain(name)),
                                   Path(deck.folder).resolve())
            lines = block.lines
            block = Block(block.keyword, block.parameters | {
                "INPUT": f'"{here}"' if " " in here else here})
            block.lines = lines
        blocks.append(block)
    return Deck(blocks, preamble=deck.preamble, name=deck.name, folder=deck.folder)


class MeshCards:
    """What the cards of the mesh said, by the deck's labels."""

    KEYWORDS = ("NODE", "ELEMENT", "NSET", "ELSET")

    def __init__(self, blocks: list[Block]):
        self.nodes: dict[int, list[float]] = {}
        self.elements: dict[int, tuple[str, list[int]]] = {}
        self.nsets: dict[str, list[int]] = {}
        self.elsets: dict[str, list[int]] = {}
        self.index: dict[int, int] = {}              # of mesh points, by label
        self.surfaces: dict[str, list] = {}
        self.references: list[str | int] = []
        for block in blocks:
            given = {name: plain(value) for name, value in block.parameters.items()}
            if block.keyword in ("NODE", "ELEMENT", "NSET", "ELSET"):
                getattr(self, "_" + block.keyword.lower())(block, given)
            elif block.keyword == "SURFACE" and given.get("TYPE", "ELEMENT").upper() == "ELEMENT":
                self.surfaces.setdefault(given["NAME"].upper(), []).extend(block.data)
            elif block.keyword == "RIGID BODY":
                self.references.append(given["REF NODE"])

    def _node(self, block: Block, given: dict) -> None:
        self._refuse(block, given, "NSET")
        for label, *x in block.data:
            self.nodes[label] = [float(v or 0.0) for v in [*x, 0.0, 0.0, 0.0][:3]]
        if "NSET" in given:
            self.nsets.setdefault(given["NSET"].upper(), []).extend(r[0] for r in block.data)

    def _element(self, block: Block, given: dict) -> None:
        self._refuse(block, given, "TYPE", "ELSET")
        labels, numbers = [], []
        for row in block.data:
            numbers += [v for v in row if v is not None]
            if not row.text().rstrip().endswith(","):    # such a line goes on in the next
                labels.append(numbers[0])
                self.elements[numbers[0]] = (given["TYPE"].upper(), numbers[1:])
                numbers = []
        if "ELSET" in given:
            self.elsets.setdefault(given["ELSET"].upper(), []).extend(labels)

    def _nset(self, block: Block, given: dict) -> None:
        self._refuse(block, given, "NSET", "GENERATE", "UNSORTED")
        self._members(self.nsets, given["NSET"], block, "GENERATE" in given)

    def _elset(self, block: Block, given: dict) -> None:
        self._refuse(block, given, "ELSET", "GENERATE", "UNSORTED")
        self._members(self.elsets, given["ELSET"], block, "GENERATE" in given)

    @staticmethod
    def _refuse(block: Block, given: dict, *known: str) -> None:
        for name in given:
            if name not in known:
                raise UsageError(f"Model has no word for {name} of *{block.keyword}")

    @staticmethod
    def _members(sets: dict, name, block: Block, generate: bool) -> None:
        found = sets.setdefault(str(name).upper(), [])
        for row in block.data:
            if generate:
                found.extend(range(row[0], row[1] + 1, row[2] if len(row) > 2 else 1))
                continue
            for field in row:
                if field is not None:
                    found.extend(sets[field.upper()] if isinstance(field, str) else [field])

    def labels(self, field) -> list[int]:
        """Node labels of a label or a set."""
        if isinstance(field, int):
            return [field]
        if str(field).upper() not in self.nsets:
            raise ModelError(f"no node set '{field}'")
        return list(dict.fromkeys(self.nsets[str(field).upper()]))

    def single(self, field) -> int:
        """The label of a node that a parameter names, or the one member of a set."""
        text = str(field)
        return int(text) if text.isdigit() else self.labels(text)[0]

    def name_of(self, label: int) -> str:
        """The first set that holds this node alone, or nothing."""
        return next((name for name, members in self.nsets.items() if set(members) == {label}), "")

    def build(self) -> tuple[str, str, Mesh]:
        """Kind of scene, letters of its elements, and the mesh; points in the order of the deck."""
        used = {n for _, nodes in self.elements.values() for n in nodes}
        free = {self.single(ref) for ref in self.references} - used
        labels = [n for n in self.nodes if n not in free]
        self.index = {label: k for k, label in enumerate(labels)}
        kind, letters, blocks, at = self._blocks()
        ndim = 3 if kind == "3d" else 2
        points = np.array([self.nodes[n][:ndim] for n in labels])
        sets = {name: self._indices(members, self.index, name) for name, members in
                self.nsets.items() if not set(members) <= free}
        elsets = {name: self._indices(members, at, name) for name, members in self.elsets.items()}
        surfaces = {name: self._faces(rows, at) for name, rows in self.surfaces.items()}
        self.element_index = at
        return kind, letters, Mesh(points, blocks, sets, elsets, surfaces)

    def _blocks(self):
        """Elements in order of labels, in blocks of one cell each."""
        kinds, letters, blocks, at = set(), set(), [], {}
        for k, label in enumerate(sorted(self.elements)):
            word, nodes = self.elements[label]
            match = re.fullmatch(r"(CPE|CPS|CAX|C3D)(\d+)([\w/]*)", _SAME.get(word, word))
            if not match:
                raise UsageError(f"Model has no element '{word}'")
            cell = (SOLID if match[1] == "C3D" else PLANE)[int(match[2])]
            kinds.add(_KINDS[match[1]])
            letters.add((cell, match[3]))
            if not blocks or blocks[-1][0] != cell:
                blocks.append((cell, []))
            blocks[-1][1].append([self.index[n] for n in nodes])
            at[label] = k
        found = {x for _, x in letters if x}
        if len(kinds) != 1 or len(found) > 1 or len(letters) > len({c for c, _ in letters}):
            raise UsageError("a Model has elements of one kind, not "
                             + ", ".join(sorted({w for w, _ in self.elements.values()})))
        return (kinds.pop(), found.pop() if found else "",
                [(cell, np.array(rows)) for cell, rows in blocks], at)

    @staticmethod
    def _indices(members: list[int], index: dict[int, int], name: str) -> NDArray:
        if not all(m in index for m in members):
            raise UsageError(f"set '{name}' holds a reference node, or what does not exist")
        return np.array([index[m] for m in dict.fromkeys(members)], int)

    def _faces(self, rows: list, at: dict[int, int]) -> NDArray:
        found = []
        for row in rows:
            if len(row) < 2 or not re.fullmatch(r"S\d", str(row[1]).upper()):
                raise UsageError("Model reads surfaces with their faces S1 to S6")
            members = [row[0]] if isinstance(row[0], int) else self.elsets[row[0].upper()]
            found += [(at[m], int(row[1][1:])) for m in members]
        return np.array(found, int).reshape(-1, 2)
