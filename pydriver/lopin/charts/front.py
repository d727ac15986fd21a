"""The picture of `cases`: error against CPU time, the Pareto front, what is dominated, failures."""
from __future__ import annotations

from pathlib import Path

from ..files import whole_file
from .cases import Case, front
from .draw import COLOR, GREY, MARKER, logarithmic
from .figures import _pyplot

_OTHERS = ("#CC79A7", "#E69F00", "#56B4E9", "#F0E442")
_LEAST = 1e-9


def draw(rows: list[Case], title: str, path: Path) -> None:
    """PNG and SVG."""
    answered, best = [r for r in rows if r.answered], front(rows)
    with _pyplot() as plt:
        fig, ax = plt.subplots(figsize=(7.6, 5.4), layout="constrained")
        ax.plot([r.seconds for r in best], [max(r.error, _LEAST) for r in best], color=GREY, lw=4.0,
                alpha=0.35, solid_capstyle="round", label="front")
        for key, group in _lines(answered).items():
            color, marker = _style(key, rows)
            group = sorted(group, key=lambda r: (r.mesh, -r.increments))
            xs, ys = [r.seconds for r in group], [max(r.error, _LEAST) for r in group]
            ax.plot(xs, ys, "-", color=color, lw=0.9, alpha=0.5)
            for k, (row, x, y) in enumerate(zip(group, xs, ys)):
                alive = row in best
                ax.plot(x, y, marker, color=color if alive else GREY, alpha=1.0 if alive else 0.55,
                        mec=color, ms=9 if marker == "*" else 7,
                        mfc="white" if _doubted(row) else color if alive else "#d0d0d0",
                        label=" ".join(w for w in key if w) or "as the deck has it"
                        if k == 0 else None)
                ax.annotate(_short(row), (x, y), xytext=(5, 4), textcoords="offset points",
                            fontsize=6.5, color=GREY)
        for row in rows:
            if row.failure:
                ax.plot(row.seconds, 1.0, "^", mfc="white", mec=_style(_key(row), rows)[0], ms=8)
        logarithmic(ax, "CPU time of the run [s]", "relative error")
        ax.legend(fontsize=7.5, frameon=False)
        ax.set_title(title + "\ngrey: another run is cheaper and better; white: warned; open "
                     "triangles: no answer", fontsize=8.5)
        for suffix in (".svg", ".png"):
            with whole_file(path.with_suffix(suffix)) as part:
                fig.savefig(part, metadata={"Date": None} if suffix == ".svg" else None)


def _key(row: Case) -> tuple[str, str, str]:
    return ("" if row.program == "lopin" else row.program, row.method, row.element)


def _lines(rows: list[Case]) -> dict[tuple, list[Case]]:
    found: dict[tuple, list[Case]] = {}
    for row in rows:
        found.setdefault(_key(row), []).append(row)
    return found


def _style(key: tuple[str, str, str], rows: list[Case]) -> tuple[str, str]:
    """Colour by method and by other programs; marker by method, or by element."""
    program, method, element = key
    if program:
        programs = sorted({r.program for r in rows} - {"lopin"})
        return _OTHERS[programs.index(program) % len(_OTHERS)], "X"
    elements = sorted({r.element for r in rows if r.program == "lopin"})
    if len(elements) > 1:
        colors = ["#000000", "#D55E00", "#0072B2", "#009E73"]
        return colors[elements.index(element) % 4], MARKER.get(method, "o")
    return COLOR.get(method, "#000000"), MARKER.get(method, "o")


def _doubted(row: Case) -> bool:
    return row.program == "lopin" and (row.verdict != "PASS" or bool(row.warned))


def _short(row: Case) -> str:
    share = "" if row.increments == 1.0 else f", inc x{row.increments:g}"
    return f"h/{2**row.mesh}{share}"
