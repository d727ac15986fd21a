"""The only importer of the compiled part: transposes, 0-based indices, text, codes to exceptions.

Everything that knows the flat Fortran interface (module `lopin_api`) is in this file, one small
function a routine. Arrays cross as (component, item) in Fortran and (item, component) here: the
same memory.
"""
from __future__ import annotations

import importlib
import json
import signal
import threading
from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import InternalError, LopinError, UsageError, error_of


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

    def __init__(self, text: str, name: str, folder: str, output: str,
                 options: dict[str, str | int | bool] | None = None):
        options = _answering(options or {})
        self.handle, self.code = map(int, core().run_deck(
            *map(_bytes, (text, name, folder, output, _lines(options)))))
        self.diagnostics = diagnostics(self.handle)

    @classmethod
    def opened(cls, text: str, name: str, folder: str, output: str,
               options: dict[str, str | int | bool], state: bytes) -> Session:
        """A run before its first increment, or after the one whose `state` is given."""
        self = cls.__new__(cls)
        words = _lines({**_answering(options), "stepwise": True})
        self.handle, self.code = map(int, core().open_run(
            *map(_bytes, (text, name, folder, output, words)), np.frombuffer(state, np.int8)))
        self.diagnostics = diagnostics(self.handle)
        return self

    def advance(self) -> tuple[bool, int]:
        """Go to the next accepted increment: whether there was one, and the exit code so far."""
        more, code = map(int, core().advance(self.handle))
        if not more:
            self.code, self.diagnostics = code, diagnostics(self.handle)
        return bool(more), code

    def end(self) -> None:
        """End the run where it stands; files are whole afterwards."""
        core().end_run(self.handle)
        self.diagnostics = diagnostics(self.handle)

    def forget_workspace(self) -> int:
        """Make all but the state again, between two increments; the exit code."""
        return int(core().forget_workspace(self.handle))

    def tool_feet(self, pair: int, points: ArrayLike) -> NDArray | None:
        """Closest points of the tool of a pair (from 0) where it stands now: a row a point of gap,
        overhang beyond an open end, the point, its normal; None if the pair has no tool."""
        foot, code = core().tool_feet(self.handle, pair + 1, _fortran(points))
        return None if code else np.ascontiguousarray(foot.T)

    def state(self) -> bytes:
        """What an open run holds between two increments; empty before the first."""
        n = int(core().state_length(self.handle))
        return np.asarray(core().get_state(self.handle, n), np.int8).tobytes() if n else b""

    def names(self) -> list[str]:
        """Words of everything that `field` knows."""
        return _text(self.handle, "names").split("\n")

    def summary(self) -> dict:
        """What the run did, as in the file ``job.json``."""
        return json.loads(_text(self.handle, "summary") or "{}")

    def field(self, name: str, index: int = 0) -> NDArray:
        """A copy of one result: (item,) or (item, component); `index` counts increments from 0."""
        word = _bytes(name)
        n, m, is_integer, code = map(int, core().result_shape(self.handle, word, index + 1))
        if code:
            raise UsageError(f"no result '{name}' of increment {index}",
                             help=f"results: {', '.join(self.names())}")
        get = core().get_integer if is_integer else core().get_real
        values, code = get(self.handle, word, index + 1, n, m)
        if code:
            raise InternalError(f"result '{name}' of increment {index} could not be copied")
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


def _answering(options: dict) -> dict:
    """With an answer to Ctrl-C, where nobody else gives one."""
    alone = threading.current_thread() is threading.main_thread() and \
        signal.getsignal(signal.SIGINT) is signal.default_int_handler
    return {**options, "interruptible": True} if alone else dict(options)


def diagnostics(handle: int) -> list[dict]:
    """What was said about a run: errors, warnings, notes; ``text`` is what a terminal shows."""
    return json.loads(_text(handle, "diagnostics") or "[]")


def check_deck(text: str, name: str, folder: str,
               options: dict[str, str | int | bool] | None = None) -> list[dict]:
    """Parse and check a deck without solving; what was said, or an exception."""
    handle, code = map(int, core().check_deck(
        *map(_bytes, (text, name, folder, _lines(options or {})))))
    said = diagnostics(handle)
    core().close_session(handle)
    if code:
        raise error_of(code, said)
    return said


def keywords() -> list[dict]:
    """Rows of the deck language: name, status, parameters, data, sentence, example."""
    return json.loads(_keywords())


@cache
def _keywords() -> str:
    """The table never changes, and is long."""
    return _text(0, "keywords")


def echo(values: ArrayLike) -> NDArray:
    """Numbers sent to Fortran and back, for tests of the way between."""
    return core().echo(np.asarray(values, float))


def _text(handle: int, what: str) -> str:
    """A text of any length: its length first, then its letters."""
    length = int(core().text_length(handle, what))
    return text_of(core().copy_text(handle, what, length)) if length else ""


def _bytes(text: str) -> bytes:
    return text.encode("utf-8", "surrogateescape")


def _lines(options: dict[str, str | int | bool]) -> str:
    """Options as Fortran reads them.

    >>> _lines({"threads": 2, "deterministic": True, "solver": None})
    'threads=2\\ndeterministic'
    """
    return "\n".join(name if value is True else f"{name}={value}"
                     for name, value in options.items() if value is not None and value is not False)


# ---- probes: kernels called with plain arrays, for comparison with `reference` ----


def probe_shape(cell: str, xi: ArrayLike) -> tuple[NDArray, NDArray]:
    """Shape functions (node,) and parametric slopes (node, ndim) of the Fortran cells."""
    from .mesh.cells import CELLS

    values, slopes, code = core().probe_shape(
        cell=_cell_name(cell), xi=np.atleast_1d(np.asarray(xi, float)), nnode=CELLS[cell].n_node)
    _answered(code, f"there is no cell '{cell}'")
    return values, np.ascontiguousarray(slopes.T)


def probe_project(cell: str, x: ArrayLike, point: ArrayLike) -> tuple[NDArray, float, NDArray]:
    """Closest point on one facet: xi, signed gap, normal; x (node, ndim)."""
    foot, code = core().probe_project(
        cell=_cell_name(cell), x=_fortran(x), point=np.asarray(point, float))
    _answered(code, f"no projection on '{cell}'")
    n = len(foot)//2
    return foot[:n - 1], float(foot[n - 1]), foot[n:]


def probe_tool_gap(kind: str, data: ArrayLike, points: ArrayLike) -> tuple[NDArray, NDArray]:
    """Gaps (point,) and normals (point, ndim) of a rigid tool.

    `data`: "plane": origin, normal; "sphere": centre, radius; "cylinder": start, end, radius;
    "profile": five numbers a row, 0 START, 1 LINE or 2 CIRCL, then its coordinates and zeros.
    """
    foot, code = core().probe_tool_gap(
        kind=kind, data=np.ravel(np.asarray(data, float)), points=_fortran(points))
    _answered(code, f"no tool '{kind}'")
    return foot[0].copy(), foot[1:].T.copy()


def probe_skyline_solve(pointers: ArrayLike, rows: ArrayLike, values: ArrayLike,
                        right: ArrayLike) -> NDArray:
    """Solve with the skyline solver; lower triangle by columns, 0-based."""
    x, code = core().probe_skyline_solve(
        pointer=np.asarray(pointers, np.int32) + 1, row=np.asarray(rows, np.int32) + 1,
        value=np.asarray(values, float), b=np.asarray(right, float))
    _answered(code, "the skyline solver met a zero pivot")
    return x


def probe_contact(compliance: ArrayLike, gap: ArrayLike, method: str = "lagrange",
                  alpha: ArrayLike = 1.0) -> tuple[NDArray, int]:
    """Contact forces of a compliance and its free gaps, by the condensed active set; iterations.

    `method`: lagrange, penalty, perturbed or augmented, the last three with stiffness `alpha`.
    """
    gap = np.asarray(gap, float)
    force, iterations, code = core().probe_contact(
        compliance=np.asfortranarray(compliance, float), gap=gap, method=method,
        alpha=np.broadcast_to(np.asarray(alpha, float), gap.shape))
    _answered(code, f"no contact forces by method '{method}'")
    return force, int(iterations)


def probe_hooke(young: float, poisson: float, kind: str = "3d") -> NDArray:
    """Moduli of an isotropic material, 4 x 4 in the plane, 6 x 6 of a solid."""
    moduli, code = core().probe_hooke(kind, young, poisson, 6 if kind == "3d" else 4)
    _answered(code, f"no moduli of kind '{kind}'")
    return moduli


def probe_stiffness(word: str, x: ArrayLike, young: float, poisson: float, *,
                    thickness: float = 1.0, full: bool = False) -> NDArray:
    """Stiffness of an element of the deck language; x (node, ndim). `full`: no mean dilatation."""
    stiffness, code = core().probe_stiffness(word=word, formulation="FULL" if full else "",
                                             x=_fortran(x), elastic=[young, poisson, thickness])
    _answered(code, f"no stiffness of an element '{word}' of this shape")
    return stiffness


def probe_friction(law: str, argument: ArrayLike, pressure: ArrayLike, *,
                   regularization: str = "LINEAR", stiffness: float = 1.0,
                   yield_stress: float = 0.0, mises: float = 0.0, dt: float = 1.0,
                   speed: float = 0.0, **data: float) -> NDArray:
    """Traction, its slope in the argument and in the pressure, (3, point), of a law of friction.

    `argument`: the trial traction, or the slip of a regularised law. `data`: mu, mu_static, decay,
    m, alpha, q, tau_max, elastic_slip, v0.
    """
    names = ("mu", "mu_static", "decay", "m", "alpha", "q", "tau_max", "elastic_slip", "v0")
    numbers = {name: 0.0 for name in names} | {"tau_max": np.finfo(float).max} | data
    argument, pressure = np.broadcast_arrays(np.atleast_1d(np.asarray(argument, float)),
                                             np.asarray(pressure, float))
    answer, code = core().probe_friction(
        law=law, regularization=regularization, point=np.asfortranarray([argument, pressure]),
        data=[*(numbers[name] for name in names), yield_stress, mises, dt, speed, stiffness])
    _answered(code, f"no law of friction '{law}' with regularisation '{regularization}'")
    return answer


def probe_friction_increment(compliance: ArrayLike, gap: ArrayLike, mu: float, force: ArrayLike,
                             gaps: ArrayLike, *, stiffness: float = 0.0, warm: bool = True,
                             line_search: bool = True, predict: bool = True, ladder: bool = True,
                             scaling: float = 0.0) -> tuple[NDArray, NDArray, dict]:
    """One increment with Coulomb friction of points in the plane, from `force` and `gaps` before.

    Rows: the pressing ones of all points, then the sliding ones. `stiffness`: springs instead of
    exact contact. `scaling`: c_t times the mean nodal compliance, 0 for the rule of the code. In
    the dict: iterations, cure, sticking, slipping, wedging (a point or 0), sign (of the
    determinant), critical (coefficient of friction), code (0 solved, 3 states do not settle).
    """
    after, info, code = core().probe_friction_increment(
        compliance=np.asfortranarray(compliance, float), law=[mu, stiffness, scaling],
        switches=[int(v) for v in (warm, line_search, predict, ladder)],
        before=np.asfortranarray(np.array([gap, force, gaps], float).T))
    if code not in (0, 3):
        _answered(code, "no friction of such sizes")
    names = ("iterations", "cure", "sticking", "slipping", "wedging", "sign")
    said = dict(zip(names, map(int, info))) | {"critical": float(info[-1]), "code": int(code)}
    return after[:, 0], after[:, 1], said


def _cell_name(cell: str) -> str:
    """meshio's "line" is "line2" in Fortran; the other names are the same."""
    return "line2" if cell == "line" else cell


def _answered(code: int, otherwise: str) -> None:
    if code:
        raise error_of(int(code), [], otherwise)


def _fortran(x: ArrayLike) -> NDArray:
    """(item, component) as the (component, item) that Fortran reads, if possible without a copy."""
    return np.ascontiguousarray(x, float).T
