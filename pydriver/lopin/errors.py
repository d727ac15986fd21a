"""Exceptions: the same classes as the exit codes of the executable."""
from __future__ import annotations

import importlib
from types import ModuleType


class LopinError(Exception):
    """Something Lopin could not do, and why.

    Attributes
    ----------
    message : str
        One sentence with the offending value.
    code : int
        Exit code of the executable for the same failure.
    id : str
        Diagnostic, such as ``"E0101"``; explained by ``lopin explain E0101``.
    file, line, column
        Where in the deck; empty and 0 when nowhere.
    help : str
        What to do about it.
    diagnostics : list of dict
        Everything that was said, warnings and notes included.

    >>> error = LopinError("unknown keyword *FRICTON", id="E0101", file="a.inp", line=3, column=1)
    >>> print(error)
    E0101: unknown keyword *FRICTON (a.inp:3:1)
    """

    code = 70

    def __init__(self, message: str, *, id: str = "", file: str = "", line: int = 0,
                 column: int = 0, help: str = "", diagnostics: list[dict] | None = None):
        self.message, self.id, self.help = message, id, help
        self.file, self.line, self.column = file, line, column
        self.diagnostics = diagnostics or []
        super().__init__(message)

    def __str__(self) -> str:
        text = f"{self.id}: {self.message}" if self.id else self.message
        if self.file:
            text += f" ({self.file}:{self.line}:{self.column})"
        if self.help:
            text += f"\n  help: {self.help}"
        return text


class DeckError(LopinError):
    """The deck cannot be read: keywords, parameters, data, includes (E01..)."""

    code = 1


class ModelError(DeckError):
    """The deck reads well but describes no sound model: sets, meshes, contacts (E02.. to E04..)."""


class UsageError(LopinError):
    """A function or the command line was asked for something that does not exist."""

    code = 2


class NotConvergedError(LopinError):
    """The smallest increment failed; results up to the last good one are kept in `result`."""

    code = 3
    result = None


class SingularError(LopinError):
    """A body moves freely, or a mechanism or redundant constraints make the system singular."""

    code = 4


class ResourceError(LopinError):
    """Memory, disk or file."""

    code = 5


class DamagedResultError(ResourceError):
    """A file of a result is missing, cut off or changed; all reading of results raises this."""


class MissingPackageError(LopinError):
    """An optional package is not installed; `help` names the extra that brings it.

    >>> raise MissingPackageError("tables need pandas", help="pip install 'lopin[table]'")
    Traceback (most recent call last):
    lopin.errors.MissingPackageError: tables need pandas
      help: pip install 'lopin[table]'
    """

    code = 5


class InternalError(LopinError):
    """A defect of Lopin."""

    code = 70


class Interrupted(LopinError):
    """The user stopped the run; what was accepted so far is kept."""

    code = 130


_classes = {c.code: c for c in (DeckError, UsageError, NotConvergedError, SingularError,
                                ResourceError, InternalError, Interrupted)}


def error_of(code: int, diagnostics: list[dict], message: str = "") -> LopinError:
    """The exception of an exit code and what was said.

    Parameters
    ----------
    code : int
        Exit code of the executable, not 0.
    diagnostics : list of dict
        Keys ``severity, code, message, file, line, column, help``, as in the executable's JSON;
        the first error leads.
    message : str
        Used when no diagnostic is an error.

    >>> error_of(1, [{"severity": "error", "code": "E0201", "message": "no set TOP"}])
    ModelError('no set TOP')
    """
    errors = [d for d in diagnostics if d.get("severity") == "error"]
    first = errors[0] if errors else {"message": message or f"Lopin ended with code {code}"}
    kind = _classes.get(code, InternalError)
    id = first.get("code", "")
    if kind is DeckError and id[:3] in ("E02", "E03", "E04"):
        kind = ModelError
    text = first.get("message", "")
    if len(errors) > 1:
        text += f" (and {len(errors) - 1} more)"
    error = kind(text, id=id, file=first.get("file", ""), line=int(first.get("line", 0)),
                 column=int(first.get("column", 0)), help=first.get("help", ""),
                 diagnostics=diagnostics)
    error.code = code
    return error


#: Extras of the package that bring optional packages.
EXTRAS = {"pandas": "table", "pyvista": "3d", "matplotlib": "plot", "gmsh": "mesh",
          "mmgpy": "remesh", "scipy": "remesh"}


def optional(name: str, what: str, extra: str = "", id: str = "") -> ModuleType:
    """An optional package; `what` needs it.

    `extra` of the package that brings it together with the others that `what` needs; `id` of the
    diagnostic.

    Raises
    ------
    MissingPackageError : it is not installed; the help says which extra brings it.
    """
    try:
        return importlib.import_module(name)
    except ImportError as problem:
        package = name.partition(".")[0]
        raise MissingPackageError(f"{what} need{'' if what.endswith('s') else 's'} {package}",
                                  help=f"pip install 'lopin[{extra or EXTRAS[package]}]'",
                                  id=id) from problem
