"""The only importer of the compiled part: transposes, 0-based indices, text, codes to exceptions.

Everything that knows the flat Fortran interface (module `lopin_api`) is in this file, one small
function a routine. Arrays cross as (component, item) in Fortran and (item, component) here: the
same memory.
"""
from __future__ import annotations

import importlib
import json
from collections.abc import Iterable
from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import LopinError, error_of


@cache
def core():
    """The Fortran module behind f2py."""
    try:
        extension = importlib.import_module("lopin._core")
    except ModuleNotFoundError as problem:
        raise LopinError("the compiled part of Lopin is missing (lopin._core)",
                         help="run './bootstrap build' in the source folder, or 'pip install .'"
                         ) from problem
    except ImportError as problem:
        raise LopinError(f"the compiled part of Lopin cannot be loaded: {problem}",
                         help="build it again with the Python that uses it") from problem
    return extension.lopin_api


def has_core() -> bool:
    """Whether the compiled part can be imported."""
    try:
        core()
    except LopinError:
        return False
    return True


def text_of(raw) -> str:
    """Text from what f2py returns for characters: bytes, or a 0-d or 1-d array of them."""
    if isinstance(raw, np.ndarray):
        raw = raw.tobytes()
    if isinstance(raw, bytes):
        raw = raw.decode("utf-8", "replace")
    return raw.rstrip(" \0")


class Session:
    """A run kept in memory by the Fortran side, until closed or forgotten."""

    def __init__(self, text: str, name: str, folder: str, output: str, options: Iterable[str] = ()):
        self.handle, self.code = map(int, core().run_deck(
            text.encode(), name.encode(), folder.encode(), output.encode(),
            "\n".join(options).encode()))
        self.diagnostics = diagnostics(self.handle)

    def names(self) -> list[str]:
        """Words of everything that `field` knows."""
        return text_of(core().result_names(self.handle)).split("\n")

    def field(self, name: str, index: int = 0) -> NDArray:
        """A copy of one result: (item,) or (item, component); `index` counts increments from 0."""
        n, m, is_integer, code = map(int, core().result_shape(self.handle, name, index + 1))
        if code:
            raise LopinError(f"no result '{name}' of increment {index}",
                             help=f"results: {', '.join(self.names())}")
        get = core().get_integer if is_integer else core().get_real
        values, code = get(self.handle, name, index + 1, n, m)
        if code:
            raise LopinError(f"result '{name}' of increment {index} could not be copied")
        values = np.ascontiguousarray(values.T)
        return values[:, 0] if n == 1 else values

    def close(self) -> None:
        """Forget the run; its arrays that were copied stay."""
        if self.handle > 0:
            core().close_session(self.handle)
            self.handle = 0

    def __del__(self):
        if getattr(self, "handle", 0):
            self.close()


def diagnostics(handle: int) -> list[dict]:
    """What was said about a run: errors, warnings, notes, in order."""
    text = text_of(core().diagnostics(handle))
    return json.loads(text) if text else []


def check_deck(text: str, name: str, folder: str) -> list[dict]:
    """Parse and check a deck without solving; what was said, or an exception."""
    handle, code = map(int, core().check_deck(text.encode(), name.encode(), folder.encode()))
    said = diagnostics(handle)
    core().close_session(handle)
    if code:
        raise error_of(code, said)
    return said


def keywords() -> list[dict]:
    """Rows of the deck language: name, origin, parameters, data, sentence, example."""
    count = int(core().keyword_count())
    return [json.loads(text_of(core().keyword(k))) for k in range(1, count + 1)]


# ---- probes: kernels called with plain arrays, for comparison with `reference` ----


def probe_shape(cell: str, xi: ArrayLike) -> tuple[NDArray, NDArray]:
    """Shape functions (node,) and parametric slopes (node, ndim) of the Fortran cells."""
    from .cells import CELLS

    values, slopes, code = core().probe_shape(
        cell=_cell_name(cell), xi=np.atleast_1d(np.asarray(xi, float)), nnode=CELLS[cell].n_node)
    _answered(code, f"there is no cell '{cell}'")
    return values, slopes.T.copy()


def probe_project(cell: str, x: ArrayLike, point: ArrayLike) -> tuple[NDArray, float, NDArray]:
    """Closest point on one facet: xi, signed gap, normal; x (node, ndim)."""
    xi, gap, normal, code = core().probe_project(
        cell=_cell_name(cell), x=_fortran(x), point=np.asarray(point, float))
    _answered(code, f"no projection on '{cell}'")
    return xi, float(gap), normal


def probe_tool_gap(kind: str, data: ArrayLike, points: ArrayLike) -> tuple[NDArray, NDArray]:
    """Gaps (point,) and normals (point, ndim) of a rigid tool.

    `data`: "plane": origin, normal; "sphere": centre, radius; "cylinder": start, end, radius;
    "profile": five numbers a row, 0 START, 1 LINE or 2 CIRCL, then its coordinates and zeros.
    """
    gap, normal, code = core().probe_tool_gap(
        kind=kind, data=np.ravel(np.asarray(data, float)), points=_fortran(points))
    _answered(code, f"no tool '{kind}'")
    return gap, normal.T.copy()


def probe_skyline_solve(pointers: ArrayLike, rows: ArrayLike, values: ArrayLike,
                        right: ArrayLike) -> NDArray:
    """Solve with the skyline solver; lower triangle by columns, 0-based."""
    x, code = core().probe_skyline_solve(
        pointer=np.asarray(pointers, np.int32) + 1, row=np.asarray(rows, np.int32) + 1,
        value=np.asarray(values, float), b=np.asarray(right, float))
    _answered(code, "the skyline solver met a zero pivot")
    return x


def probe_contact(compliance: ArrayLike, gap: ArrayLike) -> tuple[NDArray, int]:
    """Contact forces of a compliance and its free gaps, by the condensed active set; iterations."""
    force, iterations, code = core().probe_contact(
        compliance=np.asfortranarray(compliance, float), gap=np.asarray(gap, float))
    _answered(code, "the active set did not settle")
    return force, int(iterations)


def _cell_name(cell: str) -> str:
    """meshio's "line" is "line2" in Fortran; the other names are the same."""
    return "line2" if cell == "line" else cell


def _answered(code: int, otherwise: str) -> None:
    if code:
        raise error_of(int(code), [], otherwise)


def _fortran(x: ArrayLike) -> NDArray:
    """(item, component) as the (component, item) that Fortran reads, if possible without a copy."""
    return np.ascontiguousarray(x, float).T
