"""Forming decks whose tools are taken away in three ways: writes the table of docs/release.md.

    python tests/benchmarks/release.py [DECK ...] [--print] [--keep FOLDER]

Each deck of the collection that forms metal with a tool is formed as it says, with its friction and
without, and let go of: pairs removed (*MODEL CHANGE), tools withdrawn by their motion, or their
supports and loads taken off; the first and the last also all at once, in one increment
unless it has to be cut. Beside the
way "removed, in a ramp" stands the largest difference of what springs back, over its largest value,
the mean motion along the press taken off where nothing holds it. A release that neither flows nor
rubs must be the same to 0.1 %; where it does, N0518 or W0518 must be said. A body that a tool still
presses at the end is "held", by so much of the largest force: it is not compared. A folder to keep runs in lets
the script go on where it was broken off.
"""
from __future__ import annotations

import argparse
import os
import pickle
import re
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from page_tables import put_table

ROOT = Path(__file__).resolve().parents[2]
os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")
os.environ.setdefault("LOPIN_EXECUTABLE", str(ROOT/"build"/"lopin"))

import lopin  # noqa: E402
from lopin.deck import Deck  # noqa: E402

PAGE, BEGIN, END = ROOT/"docs"/"release.md", "<!-- ways -->", "<!-- end of ways -->"
#: Work of a release beside the energy that comes free, below which it counts as elastic.
ELASTIC, ALIKE = 1e-3, 1e-3
#: Forces beside the largest of the run from which on a tool still holds the body.
PRESSED = 1e-6


@dataclass
class Scene:
    """What of a deck is let go of, and how: dofs by *BOUNDARY, motions by tool."""

    steps: int                      #: that form; later ones of the deck are left out
    away: list[str]                 #: motions that withdraw the tools
    free: list[str]                 #: supports that hold a tool in the press: taken off
    held: list[str]                 #: of the body, where no tool holds it any more
    axis: int                       #: along the press


SCENES = {
    "upsetting": Scene(4, ["PLATE_REF, 2, 2, -8."], ["PLATE_REF, 2"], [], 1),
    "ring_compression": Scene(3, ["PLATE_REF, 2, 2, -2."], ["PLATE_REF, 2"], [], 1),
    "hot_upsetting": Scene(2, ["PLATE_REF, 2, 2, -1.5"], ["PLATE_REF, 2"], [], 1),
    "upset_tetra": Scene(1, ["DIE_REF, 3, 3, -5.5"], ["DIE_REF, 3"], [], 2),
    "closed_die": Scene(1, ["DIE_REF, 2, 2, 3."], ["DIE_REF, 2"], [], 1),
    "cross": Scene(1, ["UPPER_REF, 3, 3, 3."], ["UPPER_REF, 3"], [], 2),
    "wire_drawing": Scene(3, ["DIE_REF, 2, 2, 3."], ["TOP, 2"], [], 1),
    "v_bending": Scene(1, ["PUNCH_REF, 2, 2, 3."], ["PUNCH_REF, 2"], [], 1),
    "cup": Scene(2, ["PUNCH_REF, 2, 2, 30.", "HOLDER_REF, 2, 2, 30.", "DIE_REF, 2, 2, -70."],
                 ["PUNCH_REF, 2", "HOLDER_REF, 2"], ["1, 2, 2, -60."], 1),
    "square_cup": Scene(2, ["PUNCH_REF, 3, 3, 20.", "HOLDER_REF, 3, 3, 20.",
                            "DIE_REF, 3, 3, -20."],
                        ["PUNCH_REF, 3", "HOLDER_REF, 3"], ["BLANK.CENTRE, 3, 3, -15."], 2),
}
WAYS = ("removed", "removed at once", "withdrawn", "unloaded", "unloaded at once")
_OUTPUT = ("NODE FILE", "EL FILE", "CONTACT FILE", "NODE PRINT", "OUTPUT", "NODE OUTPUT",
           "ELEMENT OUTPUT", "CONTACT OUTPUT")


def cards(text: str) -> list[list[str]]:
    """Keyword lines with what follows them; comments left out."""
    found: list[list[str]] = []
    for line in text.splitlines():
        if line.startswith("**"):
            continue
        if line.startswith("*"):
            found.append([line])
        elif found:
            found[-1].append(line)
    return found


def word(card: list[str]) -> str:
    """The keyword of a card."""
    return card[0].split(",")[0].lstrip("*").strip().upper()


def formed(name: str, friction: bool) -> tuple[list[str], list[str], list[str]]:
    """Lines of the deck up to its last forming step, supports of the model, pairs."""
    scene, lines, steps = SCENES[name], [], 0
    supports: list[str] = []
    pairs: list[str] = []
    for card in cards((ROOT/"decks"/f"{name}.inp").read_text()):
        key = word(card)
        if key == "STEP":
            steps += 1
            if steps > scene.steps:
                break
        if key in _OUTPUT or key == "FRICTION" and not friction:
            continue
        if key == "END STEP":
            lines += ["*NODE FILE, FREQUENCY=1000", "U"]
        if steps == 0 and key == "BOUNDARY":
            supports += card[1:]
        if key == "CONTACT PAIR":
            pairs += card[1:]
        lines += card
    return lines, supports, pairs


def let_go(name: str, way: str, supports: list[str], pairs: list[str]) -> list[str]:
    """The step of a release."""
    scene = SCENES[name]
    at_once = way.endswith("at once")
    static = ["*STATIC", "1., 1."] if at_once else ["*STATIC", "0.05, 1., 1E-7, 0.1"]
    lines = ["*STEP, NAME=LET_GO, NLGEOM, INC=1000", *static]
    tools = [s for s in supports if "_REF" in s]
    body = [s for s in supports if "_REF" not in s] + scene.held
    if way.startswith("removed"):
        hold = [re.sub(r"(,[^,]*).*", r"\1", free) for free in scene.free if "_REF" in free]
        lines += ["*MODEL CHANGE, TYPE=CONTACT PAIR, REMOVE", *pairs, "*BOUNDARY, OP=NEW", *body,
                  *tools, *hold, *(["TOP, 2, 2, 8."] if name == "wire_drawing" else [])]
        lines += ["*CLOAD, OP=NEW"]*("*CLOAD" in scene_text(name))
    elif way == "withdrawn":
        moved = {m.split(",")[0] + m.split(",")[1] for m in scene.away}
        kept = [s for s in tools if not (s.split(",")[0] + s.split(",")[1] in moved
                                         or name in ("cup", "square_cup")
                                         and s.startswith("DIE_REF"))]
        if name == "cup":
            kept += ["DIE_REF, 1", "DIE_REF, 6"]
        if name == "square_cup":
            kept += ["DIE_REF, 1, 2", "DIE_REF, 4, 6"]
        lines += ["*BOUNDARY, OP=NEW", *body, *kept, *scene.away,
                  *(["TOP, 2, 2, 8."] if name == "wire_drawing" else [])]
        lines += ["*CLOAD, OP=NEW"]*("*CLOAD" in scene_text(name))
    else:
        lines += ["*BOUNDARY, OP=NEW", *body, *tools]
        lines += ["*CLOAD, OP=NEW"]*("*CLOAD" in scene_text(name))
    return [*lines, "*NODE FILE, FREQUENCY=1000", "U", "*END STEP"]


def scene_text(name: str) -> str:
    """The text of a deck."""
    return (ROOT/"decks"/f"{name}.inp").read_text()


def deck(name: str, way: str, friction: bool) -> Deck:
    """A deck that forms and lets go in one way."""
    lines, supports, pairs = formed(name, friction)
    if name == "square_cup":   # the node in the middle of the blank, which the punch pressed
        first = next(k for k, line in enumerate(lines) if line.startswith("*NSET"))
        lines[first:first] = ["*NSET, NSET=BLANK.CENTRE", "1"]
    lines += let_go(name, way, supports, pairs)
    return Deck.parse("\n".join(lines) + "\n", f"{name}_{way.replace(' ', '_')}", ROOT/"decks")


@dataclass
class Released:
    """What a release did."""

    back: np.ndarray | None = None    #: displacements (node, axis) [length]
    energy: float = np.nan            #: elastic, before
    flowed: float = np.nan            #: plastic work of the release
    rubbed: float = np.nan            #: work of friction of the release
    said: str = ""
    pressed: float = 0.0              #: force that a pair still has, over the largest of the run

    @property
    def elastic(self) -> bool:
        """No work beside the energy."""
        return max(self.flowed, self.rubbed) < ELASTIC*self.energy


def kept(name: str, way: str, friction: bool, folder: Path | None) -> Released:
    """A release, from the folder if it is there."""
    if folder is None:
        return released(name, way, friction)
    folder.mkdir(parents=True, exist_ok=True)
    path = folder/f"{name}_{way.replace(' ', '_')}_{'rubs' if friction else 'slips'}.pickle"
    if not path.is_file():
        path.write_bytes(pickle.dumps(vars(released(name, way, friction))))
    return Released(**pickle.loads(path.read_bytes()))


def released(name: str, way: str, friction: bool) -> Released:
    """Run a deck and see what springs back."""
    try:
        result = lopin.run(deck(name, way, friction), executable=True)
    except lopin.LopinError as problem:
        result = getattr(problem, "result", None)
        if problem.id != "E0504" or result is None:
            return Released(said=problem.id or str(problem)[:60])
    history, times = result.history, np.asarray(result.times)
    steps = np.asarray(history["step"])
    before = int(np.flatnonzero(steps == SCENES[name].steps)[-1])
    if times[-1] < history["time"][before] + 1.0 - 1e-9:
        return Released(said="E0504")
    at = int(np.argmin(abs(times - history["time"][before])))
    moved = [result.to_meshio(k).point_data["U"] for k in (at, len(times) - 1)]
    tools = {t for line in (ROOT/"decks"/f"{name}.inp").read_text().splitlines()
             for t in re.findall(r"REF NODE=(\w+)", line)}
    nodes = len(moved[0]) - len(tools)
    back = (moved[1] - moved[0])[:nodes]
    codes = [d["code"] for d in result.diagnostics if d["code"][1:] in ("0518",)]
    work = {k: history[f"energy.{k}"][-1] - history[f"energy.{k}"][before]
            for k in ("plastic", "friction")}
    forces = np.array([abs(np.asarray(values)) for key, values in history.items()
                       if re.search(r"-.*\.force\d$", key)])
    pressed = float(forces[:, -1].max()/forces.max()) if forces.size else 0.0
    return Released(back, float(history["energy.strain"][before]), float(work["plastic"]),
                    float(work["friction"]), " ".join(dict.fromkeys(codes)), pressed)


def apart(one: Released, other: Released, axis: int, floats: bool) -> float:
    """Largest difference over the largest value of the other, the mean along an axis taken off."""
    a, b = one.back.copy(), other.back.copy()
    if floats:
        a[:, axis] -= a[:, axis].mean()
        b[:, axis] -= b[:, axis].mean()
    return float(abs(a - b).max()/abs(b).max())


def measure(name: str, friction: bool, folder: Path | None) -> tuple[list[str], bool]:
    """Rows of the table, and whether all is as it should be."""
    scene = SCENES[name]
    floats = name in ("v_bending", "wire_drawing", "cup", "square_cup")
    found = {}
    # Nothing but drawing on takes a wire out of its die: otherwise it stays in it.
    for way in WAYS[:2] if name == "wire_drawing" else WAYS:
        found[way] = kept(name, way, friction, folder)
        print(name, friction, way, found[way].said, found[way].energy, found[way].flowed,
              found[way].rubbed, file=sys.stderr, flush=True)
    rows, fine, first = [], True, found["removed"]
    for way, one in found.items():
        cells = [name, "yes" if friction else "no", way]
        if one.back is None or first.back is None:
            rows.append(f"| {' | '.join(cells)} | | | | | stops: {one.said} |")
            fine = False
            continue
        gap = apart(one, first, scene.axis, floats)
        pressed = one.pressed > PRESSED
        alike = pressed or not (one.elastic and first.elastic) or gap < ALIKE
        told = one.elastic or "0518" in one.said
        fine &= alike and told
        rows.append("| " + " | ".join([
            *cells, f"{one.energy:.4g}", _figure(one.flowed, one.energy),
            _figure(one.rubbed, one.energy), "" if one is first else f"{100*gap:.2g} %",
            one.said + f" held, {one.pressed:.2g}"*pressed
            + ("" if alike and told else " **not told**")]) + " |")
    return rows, fine


def _figure(work: float, energy: float) -> str:
    """A work, or 0 where it is none."""
    return f"{work:.3g}" if abs(work) > 1e-6*energy else "0"


def main() -> None:
    """Measure and write."""
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("decks", nargs="*", default=list(SCENES))
    parser.add_argument("--print", action="store_true", help="leave the page alone")
    parser.add_argument("--keep", type=Path, help="a folder for what each run gave")
    options = parser.parse_args()
    rows, fine = [], True
    for name in options.decks:
        for friction in (False, True):
            if friction and "*FRICTION" not in scene_text(name):
                continue
            more, good = measure(name, friction, options.keep)
            rows += more
            fine &= good
    head = ["| deck | friction | way | elastic energy [N mm] | flows | rubs | beside removed "
            "| said |",
            "| --- | --- | --- | --- | --- | --- | --- | --- |"]
    table = "\n".join(head + rows)
    if options.print:
        print(table)
    else:
        put_table(PAGE, BEGIN, END, table)
    sys.exit(0 if fine else 1)


if __name__ == "__main__":
    main()
