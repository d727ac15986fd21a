"""Figures of the work-precision chart: panels, legend, files."""
from __future__ import annotations

from pathlib import Path

from ..errors import optional
from ..files import whole_file
from . import draw
from .run import Run

STYLE = {"font.size": 9, "axes.titlesize": 10, "axes.labelsize": 9, "svg.hashsalt": "lopin",
         "axes.titlelocation": "left", "axes.titleweight": "bold", "figure.dpi": 150}


def full(rows: dict[str, list[Run]], title: str, path: Path) -> None:
    """Four panels: stiffness, augmentations, cost; and meshes where there are any."""
    with _pyplot() as plt:
        fig, axes = plt.subplots(2, 2, figsize=(10.0, 8.2), layout="constrained")
        sweep = rows["sweep"]
        _panel(axes[0, 0], "a  accuracy and stiffness", draw.over_stiffness, sweep)
        _panel(axes[0, 1], "b  accuracy and augmentations", draw.over_augmentations, sweep)
        _panel(axes[1, 0], "c  accuracy and cost", draw.over_cost, sweep)
        if rows["meshes"]:
            _panel(axes[1, 1], "d  total error and time, over meshes", draw.over_time,
                   rows["meshes"])
        else:
            axes[1, 1].axis("off")
        _finish(fig, title, path)


def compact(rows: dict[str, list[Run]], title: str, path: Path) -> None:
    """Two panels for a first look: accuracy and cost, accuracy and stiffness."""
    with _pyplot() as plt:
        fig, axes = plt.subplots(1, 2, figsize=(10.0, 4.7), layout="constrained")
        _panel(axes[0], "how exactly contact is enforced, and what it costs", draw.over_cost,
               rows["sweep"])
        _panel(axes[1], "how exactly contact is enforced, and how stiff", draw.over_stiffness,
               rows["sweep"])
        _finish(fig, title, path)


def _panel(ax, title: str, function, rows: list[Run]) -> None:
    function(ax, rows)
    ax.set_title(title)


def _finish(fig, title: str, path: Path) -> None:
    from matplotlib.lines import Line2D

    def mark(method: str) -> Line2D:
        return Line2D([], [], color=draw.COLOR[method], marker=draw.MARKER[method], ls="",
                      ms=draw.SIZE[method] + 1)

    handles = {method.capitalize(): mark(method) for method in draw.COLOR}
    handles["condensed: one factorisation"] = Line2D([], [], color=draw.GREY, ls="-")
    handles["newton: one per change of contact"] = Line2D([], [], color=draw.GREY, ls="--")
    handles["large: default stiffness"] = Line2D([], [], color=draw.GREY, marker="o", ls="", ms=9)
    handles["white: the certificate warned"] = Line2D([], [], color=draw.GREY, marker="o", ls="",
                                                      mfc="white", ms=6)
    fig.legend(list(handles.values()), list(handles), loc="outside lower center", ncols=4,
               frameon=False, fontsize=8.5, handletextpad=0.4, columnspacing=1.4)
    fig.suptitle(title, x=0.01, ha="left", fontsize=11)
    for suffix in (".svg", ".png"):
        with whole_file(path.with_suffix(suffix)) as part:
            fig.savefig(part, metadata={"Date": None} if suffix == ".svg" else None)


class _pyplot:
    """matplotlib.pyplot without a screen, in the style of the chart; closes its figures."""

    def __enter__(self):
        matplotlib = optional("matplotlib", "pictures")
        matplotlib.use("Agg")
        import matplotlib.pyplot as plt

        self.plt, self.style = plt, plt.rc_context(STYLE)
        self.style.__enter__()
        return plt

    def __exit__(self, *problem) -> None:
        self.plt.close("all")
        self.style.__exit__(*problem)
