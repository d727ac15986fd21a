"""The commands that Python answers."""
from __future__ import annotations

import os
import re
import shutil
import sys
from difflib import get_close_matches
from pathlib import Path

from .deck import Deck
from .errors import ResourceError, UsageError
from .files import whole_file
from .folder import result_folder


def report(options) -> int:
    """What a run did, as one HTML file."""
    from .report import write_report

    folders = [result_folder(folder) for folder in (options.folder, *options.compare)]
    print(write_report(folders, options.output))
    return 0


def plot(options) -> int:
    """Pressure of one pair at a time of a run, as a picture."""
    from . import open_result
    from . import plot as pictures

    folder = result_folder(options.folder)
    result = open_result(folder)
    pair = result.contact(options.pair or 0)
    contact = pair.at(_index_of(options.time, result, pair))
    if options.terminal:
        from .plot_terminal import pressure

        print(pressure(contact))
        return 0
    ax = pictures.pressure(contact)
    ax.set_title(f"{contact.pair}, time {result.times[contact.frame.index]:.6g}")
    path = options.output or folder/"pressure.png"
    with whole_file(path) as part:
        ax.figure.savefig(part, dpi=150)
    print(path)
    return 0


def _index_of(time: str, result, pair) -> int:
    """The output nearest to a time; `end`; `peak`: the one with the largest pressure."""
    if time == "end":
        return -1
    if time == "peak":
        most = [max(pair.at(i).pressure, default=0.0) for i in range(len(result.times))]
        return most.index(max(most))
    try:
        wanted = float(time)
    except ValueError:
        wanted = float("nan")
    if not abs(wanted) < float("inf"):
        raise UsageError(f"--time {time} is no time", help="a number, end or peak")
    return min(range(len(result.times)), key=lambda i: abs(result.times[i] - wanted))


def info(options) -> int:
    """What a run in a folder did, in a few lines."""
    from .folder import Folder

    options.folder = result_folder(options.folder)
    run = Folder(options.folder, whole=False)
    summary = run.summary
    model, certificate = summary.get("model", {}), summary.get("certificate") or {}
    print(f"{run.name}: {summary.get('status', 'no summary')}")
    if summary.get("heading"):
        print(summary["heading"])
    if model:
        print(f"{model['kind']}, {model['nodes']} nodes, {model['elements']} elements")
    if summary.get("plan"):
        print(summary["plan"])
    if certificate:
        print(f"certificate: {certificate.get('verdict', 'none')}")
    for pair in summary.get("contact", []):
        print(f"pair ({pair.get('slave')}, {pair.get('master')}): "
              f"largest pressure {pair.get('max_pressure', 0.0):.6g}")
    print(f"{len(run.times)} outputs, to time {max(run.times, default=0.0):g}")
    counted: dict[str, int] = {}
    for said in run.diagnostics:
        counted[said["code"]] = counted.get(said["code"], 0) + 1
    if counted:
        print("said: " + ", ".join(f"{code} ({n})" if n > 1 else code
                                   for code, n in counted.items()))
    for trouble in run.troubles:
        print(trouble)
    print(f"to see it: lopin report {options.folder}")
    return 0


def chart(options) -> int:
    """Error against cost of the four methods: table, pictures, and the figures in words."""
    # One thread, so that times compare; read when the compiled part is loaded.
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
        os.environ.setdefault(name, "1")
    from .charts import chart as charts
    from .charts import figures as chart_figures
    from .charts import theory as chart_theory

    name, table = options.name or Path(options.deck).stem, options.deck.endswith(".csv")
    if _asks_for_a_number(options, table):
        from .charts.command import chart_of_a_number

        return chart_of_a_number(options, name, table)
    if options.deck != "hertz" and _is_forming(options.deck, table):
        return _chart_of_forming(options, name, table)
    if table:
        if not charts.is_table(Path(options.deck)):
            raise UsageError(f"{options.deck} is no table of lopin chart",
                             help="rows of another program: lopin chart DECK --quantity FORCE "
                                  f"--beside {options.deck}")
        scenes = charts.read_table(Path(options.deck))
    elif options.deck == "hertz":
        scenes = charts.hertz(options.repetitions)
    else:
        scenes = charts.of_deck(Deck.read(options.deck), options.repetitions)
    options.output.mkdir(parents=True, exist_ok=True)
    facts = [line for scene, rows in scenes.items() for line in chart_theory.facts(scene, rows)]
    every = [row for rows in scenes.values() for row in rows["sweep"] + rows["meshes"]]
    if not table:
        charts.write_table(every, options.output/f"{name}.csv")
    for scene, rows in scenes.items():
        path = options.output/(f"{name}_{scene}" if len(scenes) > 1 else f"{name}_full")
        chart_figures.full(rows, charts.title(scene, rows), path)
    first, rows = next(iter(scenes.items()))
    chart_figures.compact(rows, charts.title(first, rows), options.output/name)
    print("\n".join(facts))
    print(options.output/f"{name}.png")
    return 1 if any(row.silent for row in every) else 0


def _asks_for_a_number(options, table: bool) -> bool:
    """Whether a chart is one of a number: named, asked for by the deck, or drawn again."""
    if options.deck == "hertz":
        return False
    if table:
        from .charts.cases import is_table

        return is_table(Path(options.deck))
    from .accuracy import Quantity

    return bool(options.quantity or options.meshes or options.elements or options.increments
                or Quantity.of(Deck.read(options.deck)))


def _is_forming(deck: str, table: bool) -> bool:
    """Whether a deck, or a table, is one of forming."""
    from .charts import forming

    return forming.is_table(Path(deck)) if table else forming.forms(Deck.read(deck))


def _chart_of_forming(options, name: str, table: bool) -> int:
    """Error against cost of a forming deck, or a table of one drawn again."""
    from .charts import forming

    options.output.mkdir(parents=True, exist_ok=True)
    rows = forming.read_table(Path(options.deck)) if table else \
        forming.measure(Deck.read(options.deck))
    if not table:
        forming.write_table(rows, options.output/f"{name}.csv")
    forming.draw(rows, options.output/name)
    print("\n".join(forming.facts(rows)))
    print(options.output/f"{name}.png")
    return 1 if any(row.silent for row in rows) else 0


def atlas(options) -> int:
    """Maps of where the methods work: tables, pictures, and the figures in words."""
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
        os.environ.setdefault(name, "1")
    if options.batch is not None and options.batch < 0:
        raise UsageError(f"--batch {options.batch}: a number of cells, not below 0")
    if options.deck:
        return _atlas_of_deck(options)
    from . import atlas as maps

    charts = [maps.map_of(number) for number in options.map or maps.possible()]
    if options.cell is not None:
        print(*(maps.again(c, options.cell, options.output, options.small) for c in charts))
        return 0
    options.output.mkdir(parents=True, exist_ok=True)
    silent = 0
    for chart in charts:
        stem = options.output/f"map_{chart.number}_{chart.name}"
        if not options.resume:
            stem.with_suffix(".csv").unlink(missing_ok=True)
        cells = maps.measure(chart, options.small, stem.with_suffix(".csv"), options.batch)
        maps.keep_failing(chart, cells, options.output, options.small)
        if not options.no_picture:
            from .atlas.draw import draw

            draw(chart, cells, stem.with_suffix(".svg"))
        print("\n".join(maps.summary(chart, cells)))
        silent += sum(cell.kind == "F1" for cell in cells)
    return 1 if silent else 0


def _atlas_of_deck(options) -> int:
    """A map of a user's deck over two of its numbers."""
    from .accuracy import Quantity
    from .atlas.deck_map import Axis, DeckMap, draw, facts

    if options.map:
        raise UsageError("--map chooses a map of the atlas: not beside a deck, whose map --x and "
                         "--y make")
    if not options.x:
        raise UsageError("over which numbers? --x 'FRICTION:1=0,0.1,0.2' --y 'STATIC:1=0.01..1/5'")
    deck = Deck.read(options.deck)
    asked = Quantity.of(deck)
    quantity = Quantity(" ".join(options.quantity.upper().split()), options.set.upper(),
                        options.component) if options.quantity else asked[0] if asked else None
    if options.halved and quantity is None:
        raise UsageError("--halved compares a number: --quantity FORCE")
    chart = DeckMap(deck, Axis.of(options.x), Axis.of(options.y) if options.y else None, quantity,
                    options.halved)
    options.output.mkdir(parents=True, exist_ok=True)
    if options.cell is not None:
        cells = chart.places()
        if not 0 <= options.cell < len(cells):
            raise UsageError(f"--cell {options.cell}: the map has cells 0 to {len(cells) - 1}")
        cell = cells[options.cell]
        print(chart.deck_of(cell.x, cell.y).write(
            options.output/f"{deck.name}_{options.cell}.inp"))
        return 0
    table = options.output/f"{deck.name}.csv"
    if not options.resume:
        table.unlink(missing_ok=True)
    cells = chart.measure(table, options.batch, lambda line: print(line, file=sys.stderr,
                                                                   flush=True))
    if not options.no_picture:
        draw(chart, cells, options.output/deck.name)
    print("\n".join(facts(cells)))
    return 1 if any(c.kind == "silent" for c in cells) else 0


def convert(options) -> int:
    """A mesh file to the mesh part of a deck, or to any format that meshio writes."""
    from .mesh.read import read_mesh
    from .model import Model
    from .model_deck import mesh_deck

    mesh = read_mesh(options.source)
    if options.target.suffix.lower() == ".inp":
        kind = options.kind or ("3d" if mesh.ndim == 3 else "plane strain")
        deck = mesh_deck(Model(options.source.stem, mesh, kind))
        deck.write(options.target)
        print(f"{options.target}: {mesh}")
        words = sorted(set(re.findall(r"(?im)^\*ELEMENT.*TYPE=(\w+)", deck.text())))
        others = " (--kind axisymmetric, --kind 'plane stress')"
        print(f"elements: {', '.join(words)}, {kind}"
              + (others if mesh.ndim == 2 and not options.kind else ""))
        print(f"element sets: {', '.join(mesh.element_sets)}")
        print(f"surfaces: {', '.join(mesh.surfaces) or 'none'}")
        print(f"next: *INCLUDE, INPUT={options.target.name} in a deck with material and step")
    else:
        mesh.to_meshio().write(options.target)
        print(f"{options.target}: {mesh}")
    return 0


def export(options) -> int:
    """A deck for CalculiX or Abaqus, or all of it in one file."""
    from .export import export as exported

    deck = exported(Deck.read(options.deck), options.target)
    path = options.output or Path(f"{Path(options.deck).stem}_{options.target}.inp")
    if path.exists() and path.samefile(options.deck):
        raise UsageError(f"{path} is the deck itself: give another name with -o")
    print(deck.write(path))
    for note in deck.preamble[1:] if options.target != "flat" else []:
        print(note.removeprefix("** "))
    return 0


def die(options) -> int:
    """The deck of a die with the forces of a forging; a line says what the transfer kept."""
    from . import open_result
    from .die_stress import ToolLoads, die_deck

    result = open_result(result_folder(options.folder))
    pair = result.contact(options.pair or 0)
    loads = ToolLoads.of(result, options.pair, _index_of(options.time, result, pair))
    deck, balance = die_deck(Deck.read(options.deck), options.surface, loads)
    path = options.output or Path(f"{Path(options.deck).stem}_loaded.inp")
    if path.exists() and path.samefile(options.deck):
        raise UsageError(f"{path} is the deck itself: give another name with -o")
    print(deck.write(path))
    print(f"{loads.line()}: {balance.line()}")
    return 0


def identify(options) -> int:
    """Coefficients of friction with which a ring's deck gives the measured bores."""
    from .identify import Table, identify

    deck, table = Deck.read(options.deck), Table.read(options.table)
    laws = ("TRESCA", "COULOMB") if options.law == "BOTH" else (options.law,)
    found = [identify(deck, table, law, options.bore, options.at) for law in laws]
    for fit in found:
        print(f"{fit.law}: {fit.line()}")
    return 0


def _tell_table(found, path: Path) -> int:
    """Write a table, and say where it is and what it tells."""
    with whole_file(path) as part:
        part.write_text(found.lines())
    print(path)
    print(found.line())
    return 0


def wear(options) -> int:
    """Pressure by slip of a pair, as a table."""
    from . import open_result
    from .wear import wear

    folder = result_folder(options.folder)
    found = wear(open_result(folder), options.pair or 0)
    return _tell_table(found, options.output or folder/"wear.csv")


def flc(options) -> int:
    """Strains of a sheet at the end of a run beside a forming limit curve, as a table."""
    from . import open_result
    from .forming_limit import read_curve, strains_of

    folder = result_folder(options.folder)
    result = open_result(folder)
    curve = read_curve(options.curve.read_text()) if options.curve else None
    found = strains_of(result, curve, normal=options.normal, axisymmetric=options.axisymmetric)
    return _tell_table(found, options.output or folder/"flc.csv")


def tracers(options) -> int:
    """Places of material points over the outputs of a run, as a table."""
    from .tracers import read_starts, tracks

    folder = result_folder(options.folder)
    found = tracks(folder, joined_name(folder), read_starts(options.starts.read_text()))
    return _tell_table(found, options.output or folder/"tracers.csv")


def joined_name(folder: Path) -> str:
    """Of the .pvd of a folder: that of all parts where a run has parts."""
    names = [p.stem for p in sorted(folder.glob("*.pvd")) if not re.search(r"\.p\d{3}$", p.stem)]
    if len(names) != 1:
        raise UsageError(f"'{folder}' has {len(names)} runs with output for ParaView",
                         help="name the folder of one run, with field output")
    return names[0]


def example(options) -> int:
    """Copy a deck of the collection, or list the names."""
    collection = decks_folder()
    names = sorted(p.stem for p in collection.glob("*.inp"))
    if options.name is None:
        print("\n".join(names))
        return 0
    if options.name not in names:
        near = [n for n in names if options.name.lower() in n] or \
            get_close_matches(options.name, names)
        raise UsageError(f"no example '{options.name}'",
                         help=f"did you mean {', '.join(near)}?" if near else
                         f"examples: {', '.join(names)}")
    try:
        options.folder.mkdir(parents=True, exist_ok=True)
    except OSError as problem:
        raise ResourceError(f"cannot make the folder '{options.folder}': {problem.strerror}") \
            from problem
    for path in sorted(collection.glob(f"{options.name}.*")):
        print(shutil.copy(path, options.folder))
    deck = os.path.normpath(options.folder/f"{options.name}.inp")
    print(f"next: lopin check {deck}, lopin run {deck}")
    return 0


def decks_folder() -> Path:
    """The collection of decks: in the package when installed, else in the source tree."""
    here = Path(__file__).resolve().parent
    for place in (here/"decks", here.parent.parent/"decks"):
        if place.is_dir():
            return place
    raise ResourceError("the collection of decks was not found")
