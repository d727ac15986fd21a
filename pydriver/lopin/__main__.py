"""``lopin`` and ``python -m lopin``: one command for the executable and for the Python side.

run, check, info, explain, doc and selftest are the executable's; report, plot, chart, atlas,
convert, export, example, die, identify, wear, flc and tracers are answered here.
"""
from __future__ import annotations

import argparse
import os
import subprocess
import sys
from pathlib import Path

from .errors import Interrupted, LopinError, ResourceError

PYTHON_COMMANDS = ("report", "plot", "chart", "atlas", "convert", "export", "example",
                   "die", "identify", "wear", "flc", "tracers")


def main(arguments: list[str] | None = None) -> int:
    """Run a command and return its exit code."""
    arguments = sys.argv[1:] if arguments is None else list(arguments)
    try:
        ours = arguments and (arguments[0] in PYTHON_COMMANDS or arguments[0] == "info"
                              and len(arguments) == 2 and Path(arguments[1]).is_dir())
        code = python_command(arguments) if ours else forward(arguments)
        sys.stdout.flush()
        return code
    except LopinError as error:
        print(f"error: {error}", file=sys.stderr)
        return error.code
    except BrokenPipeError:   # whoever read has left; nothing more is to be said, at exit either
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return ResourceError.code
    except OSError as problem:
        print(f"error: {problem}", file=sys.stderr)
        return ResourceError.code
    except KeyboardInterrupt:
        return Interrupted.code


def forward(arguments: list[str]) -> int:
    """Hand over to the executable, but a deck that asks for new meshes; where the system allows,
    this process becomes it."""
    from .accuracy import command as accuracy
    from .command_deck import deck_of, first_found
    from .remesh import command as remesh
    from .run import find_executable

    deck = deck_of(arguments)
    if deck is not None:
        runs = (accuracy.run_asked, remesh.run_remeshed)
        chosen = first_found(deck, [accuracy.asks, remesh.asks])
        if chosen is not None:
            return runs[chosen](deck, arguments)
    program = str(find_executable())
    if os.name == "posix" and sys.stdout is sys.__stdout__:
        sys.stdout.flush()
        os.execv(program, [program, *arguments])
    return subprocess.run([program, *arguments], check=False).returncode


def python_command(arguments: list[str]) -> int:
    """The commands that need Python."""
    parser = argparse.ArgumentParser(prog="lopin", description=__doc__)
    commands = parser.add_subparsers(dest="command", required=True)
    report = commands.add_parser("report", help="one HTML file that shows what a run did")
    report.add_argument("folder", type=Path)
    report.add_argument("--compare", type=Path, nargs="+", default=[], metavar="FOLDER",
                        help="runs that are laid beside it")
    report.add_argument("-o", "--output", type=Path, help="default: <folder>/report.html")
    plot = commands.add_parser("plot", help="picture of the contact pressure of a result folder")
    plot.add_argument("folder", type=Path)
    plot.add_argument("-o", "--output", type=Path,
                      help="PNG, SVG or PDF; default: <folder>/pressure.png")
    plot.add_argument("--pair", default=None, help="slave surface; default: the first pair")
    plot.add_argument("--time", default="end", metavar="TIME",
                      help="the output nearest to this time; peak: that of the largest pressure; "
                      "default: end")
    plot.add_argument("--terminal", action="store_true", help="in characters, here")
    info = commands.add_parser("info", help="a run in a few lines")
    info.add_argument("folder", type=Path)
    chart = commands.add_parser("chart", help="speed against accuracy over methods and penalties")
    chart.add_argument("deck", nargs="?", default="hertz",
                       help="a deck with *SURFACE BEHAVIOR, hertz (scenes with closed "
                       "forms), or the table of an earlier chart to draw again")
    chart.add_argument("-o", "--output", type=Path, default=Path("charts"), help="a folder")
    chart.add_argument("--repetitions", type=int, default=5, help="times are the least of so many")
    _add_chart_of_a_number(chart)
    _add_atlas(commands)
    convert = commands.add_parser("convert", help="mesh of another tool to a deck or VTU")
    convert.add_argument("source", type=Path)
    convert.add_argument("target", type=Path)
    convert.add_argument("--kind", default=None,
                         help="axisymmetric, 'plane strain', 'plane stress', 3d")
    export = commands.add_parser("export", help="the deck as another program reads it")
    export.add_argument("deck")
    target = export.add_mutually_exclusive_group(required=True)
    for name, says in (("ccx", "CalculiX"), ("abaqus", "Abaqus"), ("flat", "one file: includes in "
                                                                   "their place")):
        target.add_argument(f"--{name}", dest="target", action="store_const", const=name, help=says)
    export.add_argument("-o", "--output", type=Path, help="default: <deck>_<target>.inp here")
    die = commands.add_parser("die", help="forces of a forging on the mesh of its elastic die")
    die.add_argument("folder", type=Path, help="what the forging's run left")
    die.add_argument("deck", help="mesh, material, supports and a step of the die, where the "
                     "forging's tool stands at the start")
    die.add_argument("--surface", required=True, help="of the die's faces that meet the metal")
    die.add_argument("--pair", default=None, help="of the forging; default: all of the tool of "
                     "the first")
    die.add_argument("--time", default="end", metavar="TIME", help="the output nearest to this "
                     "time; peak: that of the largest pressure; default: end")
    die.add_argument("-o", "--output", type=Path, help="default: <deck>_loaded.inp here")
    identify = commands.add_parser("identify", help="friction from the bores of ring tests")
    identify.add_argument("deck", help="of the ring between plates, pressed as far as the tests")
    identify.add_argument("table", type=Path, help="CSV: columns height and inner (diameter)")
    identify.add_argument("--law", choices=("TRESCA", "COULOMB", "BOTH"), default="",
                          type=str.upper, help="m or mu; default: that of the deck")
    identify.add_argument("--bore", default="BORE", help="node set of the bore")
    identify.add_argument("--at", choices=("middle", "plate", "mean"), default="middle",
                          help="of the height, where diameters were measured")
    wear = commands.add_parser("wear", help="pressure by slip, on the metal and on the tool")
    wear.add_argument("folder", type=Path, help="what a run left, with field output on the way")
    wear.add_argument("--pair", default=None, help="slave surface; default: the first pair")
    wear.add_argument("-o", "--output", type=Path, help="default: <folder>/wear.csv")
    flc = commands.add_parser("flc", help="strains of a sheet beside a forming limit curve")
    flc.add_argument("folder", type=Path, help="what the run left")
    flc.add_argument("--curve", type=Path, help="a line for each point: minor, major strain (true)")
    flc.add_argument("--normal", type=float, nargs="+", help="of the flat blank; default: that of "
                     "its faces, z in plane stress")
    flc.add_argument("--axisymmetric", action="store_true", help="the kind of the run, which its "
                     "summary tells")
    flc.add_argument("-o", "--output", type=Path, help="default: <folder>/flc.csv")
    tracers = commands.add_parser("tracers", help="where points of the metal go, flow lines")
    tracers.add_argument("folder", type=Path, help="what the run left, with field output")
    tracers.add_argument("--starts", type=Path, required=True, help="a line for each tracer: its "
                         "place before the run")
    tracers.add_argument("-o", "--output", type=Path, help="default: <folder>/tracers.csv")
    example = commands.add_parser("example", help="copy a deck of the collection")
    example.add_argument("name", nargs="?", help="without it: list the names")
    example.add_argument("folder", nargs="?", type=Path, default=Path("."))
    options = parser.parse_args(arguments)
    from . import commands as module

    return getattr(module, options.command)(options)


def _add_chart_of_a_number(chart) -> None:
    """The options of a chart of one number of any deck."""
    more = chart.add_argument_group("one number of any deck", "over methods, elements, meshes and "
                                    "increments; lists are separated by commas")
    more.add_argument("--quantity", metavar="WORD", help="PRESSURE, 'PEAK PRESSURE', FORCE, 'PEAK "
                      "FORCE', DISPLACEMENT or SPRINGBACK; default: what *LOPIN of the deck asks")
    more.add_argument("--set", default="", help="node set that it is asked of")
    more.add_argument("--component", type=int, default=0, help="1 to 3; default: the length")
    more.add_argument("--exact", type=float, help="its value; default: that of a finer run")
    more.add_argument("--methods", default="", help="lagrange, penalty, perturbed, augmented")
    more.add_argument("--elements", default="", help="words such as CPE4,CPE4I,CPE8")
    more.add_argument("--meshes", default="", help="halvings of the cells: 0,1,2")
    more.add_argument("--increments", default="", help="lengths beside the deck's own: 1,0.5")
    more.add_argument("--beside", type=Path, action="append", default=[], metavar="CSV",
                      help="rows of another program, drawn in the same picture")
    more.add_argument("--ccx", action="store_true", help="run CalculiX on the same meshes, too")
    more.add_argument("--name", default="", help="of table and picture; default: the deck's")


def _add_atlas(commands) -> None:
    """The options of atlas."""
    atlas = commands.add_parser("atlas", help="maps of where the methods work, and where not")
    atlas.add_argument("deck", nargs="?", help="a deck that is mapped over two of its numbers, "
                       "--x and --y")
    atlas.add_argument("--x", metavar="PLACE=VALUES", help="FRICTION:1=0,0.1,0.2: the first field "
                       "of the first *FRICTION; STATIC:1=1e-3..1/7; STEP:INC=10,100")
    atlas.add_argument("--y", metavar="PLACE=VALUES", help="as --x")
    atlas.add_argument("--quantity", metavar="WORD", help="its value in each cell: FORCE, "
                       "'PEAK PRESSURE'..., as of lopin chart")
    atlas.add_argument("--set", default="", help="node set that it is asked of")
    atlas.add_argument("--component", type=int, default=0, help="1 to 3; default: the length")
    atlas.add_argument("--halved", action="store_true", help="each cell in half the increments, "
                       "too: a change of 5 %% without a warning is marked")
    atlas.add_argument("--map", type=int, action="append", metavar="N",
                       help="a map of this number; again for more; default: all")
    atlas.add_argument("--small", action="store_true", help="few cells, as the tests have them")
    atlas.add_argument("--cell", type=int, default=None, metavar="ROW",
                       help="write the deck of one cell of --map, by its row in the table")
    atlas.add_argument("--resume", action="store_true",
                       help="go on with the tables in the folder: their cells are not solved again")
    atlas.add_argument("--batch", type=int, default=None, metavar="N",
                       help="at most so many cells of each map")
    atlas.add_argument("--no-picture", action="store_true", help="tables only")
    atlas.add_argument("-o", "--out", "--output", dest="output", type=Path, default=Path("atlas"),
                       help="a folder")


if __name__ == "__main__":
    sys.exit(main())
