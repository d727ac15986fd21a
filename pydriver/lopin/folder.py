"""Results in a folder: what the executable wrote, read only where a field is asked for."""
from __future__ import annotations

import csv
import json
import re
from functools import lru_cache
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from .errors import DamagedResultError, ResourceError
from .files import reading
from .vtu import read_vtu

#: VTK keeps xx yy zz xy yz xz, Lopin xx yy zz xy xz yz.
_FROM_VTK = [0, 1, 2, 3, 5, 4]


def result_folder(path: str | Path) -> Path:
    """The folder itself, or that of the run of this deck or name in `out/`."""
    path = Path(path)
    of_run = Path("out")/path.name.removesuffix(".inp")
    return of_run if not path.is_dir() and path.suffix in ("", ".inp") and of_run.is_dir() else path


class Folder:
    """A run on disk: finished, or what is left of one.

    Parameters
    ----------
    whole : False: files that are missing or damaged are left out and told in `troubles`; a folder
        without any is refused
    """

    def __init__(self, folder: str | Path, name: str | None = None, *, whole: bool = True):
        self.folder = Path(folder)
        self.troubles: list[str] = []
        self.summary, self.diagnostics, self._frames = {}, [], []
        found = sorted(self.folder.glob(f"{name or '*'}.json"))
        if not found and not whole:
            found = sorted(self.folder.glob(f"{name or '*'}.sta"))
        if not found:
            runs = sorted(str(path.parent) for path in Path("out").glob("*/*.json"))
            raise ResourceError(f"no result '{name or '*'}.json' in {self.folder}",
                                help=f"results here: {', '.join(runs[:9])}" if runs else
                                "give the folder of a run: lopin run deck.inp writes out/deck")
        self.name = found[0].stem
        for read in (self._read_summary, self._read_frames):
            try:
                read()
            except ResourceError as problem:
                if whole:
                    raise
                self.troubles.append(problem.message)
        # As it was read from the file in this state.
        self._history: tuple[tuple[int, ...], dict[str, NDArray]] = ((), {})

    def _read_summary(self) -> None:
        path = self.folder/f"{self.name}.json"
        with reading(path):
            summary = json.loads(path.read_text(encoding="utf-8"))
            diagnostics = summary.get("diagnostics", [])
            if not all(isinstance(d["message"], str) for d in diagnostics) \
                    or not isinstance(summary.get("model", {}), dict):
                raise ValueError("it is not the summary of a run")
        self.summary, self.diagnostics = summary, diagnostics

    def _read_frames(self) -> None:
        self._frames = self._read_collection()

    def _read_collection(self) -> list[tuple[float, dict[str, Path]]]:
        """(time, files by part) of each output."""
        path = self.folder/f"{self.name}.pvd"
        if not path.is_file():
            return []
        frames: dict[float, dict[str, Path]] = {}
        with reading(path):
            for entry in ElementTree.parse(path).iter("DataSet"):
                file = self.folder/entry.get("file")
                kind = re.sub(r"^p\d+_", "", file.name[len(self.name) + 1:]).partition("_")[0]
                part = entry.get("name") or file.stem
                if kind in ("contact", "tool"):
                    part = f"{kind} {part}"
                frames.setdefault(float(entry.get("timestep")), {})[part] = file
            return sorted(frames.items(), key=lambda frame: frame[0])

    @property
    def times(self) -> NDArray:
        """Total times of the outputs."""
        return np.array([time for time, _ in self._frames])

    def pairs(self) -> list[str]:
        """Names of the contact pairs, SLAVE-MASTER."""
        parts = self._frames[-1][1] if self._frames else {}
        return [p.removeprefix("contact ") for p in parts if p.startswith("contact ")]

    def names(self) -> list[str]:
        """Words of the fields at the points of the mesh."""
        return sorted(self._piece(len(self._frames) - 1, "solid").point_data) if self._frames \
            else []

    def field(self, name: str, index: int) -> NDArray:
        """A field at the points of the mesh."""
        with reading(self._file(index, "solid")):
            return self._plain(self._piece(index, "solid").point_data[name])

    def contact(self, pair: str, index: int) -> dict[str, NDArray]:
        """All fields of the slave points of a pair, and their coordinates "X"."""
        piece = self._piece(index, f"contact {pair}")
        fields = {"X": piece.points, **piece.point_data}
        return {word: self._plain(values) for word, values in fields.items()}

    def _plain(self, values: NDArray) -> NDArray:
        """Lopin's order of stresses; no third component in a plane; (n,) for scalars."""
        width = values.shape[1] if values.ndim == 2 else 0
        if width == 6:
            return values[:, _FROM_VTK]
        if width == 3 and self.summary.get("model", {}).get("dimensions") == 2:
            return values[:, :2]
        return values[:, 0] if width == 1 else values

    def history(self) -> dict[str, NDArray]:
        """Columns of the history file by name, without their units."""
        path = self.folder/f"{self.name}_history.csv"
        if not path.is_file():
            return {}
        with reading(path):
            now = path.stat()
            state = (now.st_ino, now.st_size, now.st_mtime_ns)
            if self._history[0] == state:
                return dict(self._history[1])
            with path.open(newline="", encoding="utf-8") as file:
                rows = [r for r in csv.reader(file) if r and not r[0].startswith("#")]
            head = [word.rpartition("[")[0].strip() for word in rows[0]]
            if any(len(row) != len(head) for row in rows) or len(set(head)) < len(head):
                raise ValueError("its lines do not have one length")
            values = np.array([[float(v) for v in r] for r in rows[1:]]).reshape(-1, len(head))
            self._history = state, dict(zip(head, values.T))
            return dict(self._history[1])

    def mesh(self, index: int):
        """The `meshio.Mesh` of one output, fields included."""
        return self._piece(index, "solid")

    @lru_cache(maxsize=8)
    def _piece(self, index: int, part: str):
        return read_vtu(self._file(index, part))

    def _file(self, index: int, part: str) -> Path:
        """The file of one part of one output."""
        files = self._frames[index][1]
        if part not in files:
            raise DamagedResultError(f"no part '{part}' among {', '.join(files)} in "
                                     f"'{self.folder/self.name}.pvd'")
        return files[part]
