"""One HTML file that shows what a run did, without network: verdict, pictures of the deformed part
with its contact and a slider over time, tool curves, energies, convergence, certificate, timings,
warnings with their deck lines."""
from __future__ import annotations

from pathlib import Path

from ..files import whole_file
from .collect import collect
from .page import page

__all__ = ["write_report"]


def write_report(folders, path: str | Path | None = None, *, decks: str | Path = ".") -> Path:
    """Write the report of a run, or of several beside each other.

    Parameters
    ----------
    folders : result folders, or a ``.json`` in one that holds several runs; the first is the run
        of the report, the others are laid beside it
    path : the HTML file; default: ``<folder>/report.html``
    decks : where decks are looked for by the names that the run gives, for the lines that warnings
        point to

    Raises
    ------
    ResourceError : a folder has no result, or a file of it cannot be read.
    """
    if isinstance(folders, (str, Path)):
        folders = [folders]
    folders = [Path(folder) for folder in folders]
    runs = [collect(folder, Path(decks)) for folder in folders]
    path = Path(path) if path else runs[0].folder/"report.html"
    with whole_file(path) as part:
        Path(part).write_text(page(runs), encoding="utf-8")
    return path
