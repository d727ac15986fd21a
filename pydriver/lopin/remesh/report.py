"""What the remeshes of a run did, and the files that join its parts."""
from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field
from pathlib import Path

import numpy as np

from ..errors import DeckError
from ..files import reading, whole_file
from .histories import Ways, columns, of_tools, work_of_tools
from .join import (
    join_collections,
    join_histories,
    join_summaries,
    said_of,
    summaries,
    worse,
    worst_certificate,
)

#: Share of the volume that may be taken out as elements separate.
MOST_TAKEN_OUT = 0.02
#: Share of a cell that sides of a closed fold may be inside each other: chords of a round one.
INSIDE = 0.1
#: Elastic energy below this share of the plastic work is none to speak of.
NO_ENERGY = 1e-5
#: Moves of a tool at rest below this share of its way are not spoken of.
TOLD = 1e-4
TINY = np.finfo(float).tiny


@dataclass
class Remesh:
    """One remesh: why, and what it kept.

    Attributes
    ----------
    part : that it ended, from 1
    time : total [time]
    reason : in words
    elements : of the new mesh
    worst_corner : of it
    moved : volume before, relative change, largest moves [length], nodes put on tools; slot: the
        least width of a fold, and where, if there is one; folded, fold_depth: nodes that lie on
        the other side of a closed fold, and how far one is inside it, by the size there
    plastic_change, energy_change : relative changes of the integrals of plastic strain and of the
        elastic energy of the deviator
    excess : largest share by which a strain was taken back to the yield surface
    seconds : of the remesh
    separated : share of the body's volume that elements beyond a critical damage had
    scrap : of each piece that came loose: elements, volume, corners of the box around it
    pieces : bodies that are left
    unbalanced : why stresses were not put in balance with the forces on the body, in words; nothing
        where they were
    """

    part: int
    time: float
    reason: str
    elements: int
    worst_corner: float
    moved: dict[str, float]
    plastic_change: float
    energy_change: float
    excess: float
    seconds: float
    separated: float = 0.0
    scrap: list[dict] = field(default_factory=list)
    pieces: int = 1
    unbalanced: str = ""

    @property
    def cut(self) -> bool:
        """Metal was taken out; the rest of the mesh is as it was."""
        return self.separated > 0.0 or bool(self.scrap)

    def line(self) -> str:
        """For a terminal."""
        if self.cut:
            return (f"separation at time {self.time:g}: {self.reason}; "
                    f"{100*self.separated:.2g} % of the volume{self._scrap()}; {self.elements} "
                    f"elements left in {self.pieces} {'piece' if self.pieces == 1 else 'pieces'}")
        return (f"remesh at time {self.time:g}: {self.reason}; {self.elements} elements, worst "
                f"corner {self.worst_corner:.2f}, volume {self.moved['volume_change']:+.1e}, "
                f"plastic strain {100*self.plastic_change:+.2f} %, elastic energy "
                f"{100*self.energy_change:+.2f} %" + (", " + self.fold() if self.fold() else "")
                + self._closed()
                + (f", stresses not put in balance: {self.unbalanced}" if self.unbalanced else ""))

    def _scrap(self) -> str:
        """The pieces that came loose, in words."""
        return "".join("; scrap of {:.4g} in {} elements from ({}) to ({})".format(
            p["volume"], p["elements"], ", ".join(f"{v:.4g}" for v in p["from"]),
            ", ".join(f"{v:.4g}" for v in p["to"])) for p in self.scrap)

    def _closed(self) -> str:
        """Where a fold bears, in words: how many nodes of it met, and how far one is inside."""
        if "folded" not in self.moved:
            return ""
        return (f", {self.moved['folded']} nodes of a fold meet, "
                f"{100*self.moved['fold_depth']:.2g} % of a cell inside at most")

    def fold(self) -> str:
        """Where two sides of the skin come together, in words; nothing where they do not."""
        if "slot" not in self.moved:
            return ""
        place = ", ".join(f"{v:.4g}" for v in self.moved["slot_at"])
        return f"the skin folds: {self.moved['slot']:.2g} between its sides at ({place})"


@dataclass
class Report:
    """Parts and remeshes of a run, and its joined files.

    Attributes
    ----------
    name : of the deck
    folder : of all results
    parts : names of the decks of the parts
    remeshes : one fewer
    cards : text of *REMESH of the deck
    sums : of the decks of parts as they were written, by name
    """

    name: str
    folder: Path
    parts: list[str] = field(default_factory=list)
    remeshes: list[Remesh] = field(default_factory=list)
    cards: str = ""
    sums: dict[str, str] = field(default_factory=dict)

    def add_part(self, name: str) -> None:
        """A part runs; again, where its deck was written anew."""
        if name not in self.parts:
            self.parts.append(name)

    def add(self, remesh: Remesh) -> None:
        """A remesh was done: kept at once, for a run that is killed."""
        self.remeshes = [r for r in self.remeshes if r.part < remesh.part] + [remesh]
        self.write()

    @property
    def path(self) -> Path:
        """Of the list of parts and remeshes."""
        return self.folder/f"{self.name}.parts.json"

    def write(self) -> None:
        """The list of parts and remeshes."""
        with whole_file(self.path) as part:
            part.write_text(self.json() + "\n")

    def read(self) -> None:
        """The remeshes of a run that goes on."""
        if self.path.is_file():
            with reading(self.path):
                told = json.loads(self.path.read_text())
                found, self.cards = told["remeshes"], told.get("cards", "")
                self.sums = told.get("sums", {})
                self.remeshes = [Remesh(**{k: r[k] for k in Remesh.__dataclass_fields__ if k in r})
                                 for r in found]

    def finish(self) -> None:
        """Write the files that join the parts."""
        join_collections(self.folder, self.name, self.parts)
        join_histories(self.folder, self.name, self.parts)
        join_summaries(self.folder, self.name, self.parts, self.verdict()[0])
        self.write()

    def told(self) -> tuple[dict, list[dict]]:
        """Worst certificate of the parts, and what the solver said of any, from their summaries."""
        found = summaries(self.folder, self.parts)
        return worst_certificate(found), said_of(found)

    def warnings(self) -> list[str]:
        """Warnings of the solver, the first of each kind, and how many parts have it."""
        first: dict[str, tuple[str, set[int]]] = {}
        for number, part in summaries(self.folder, self.parts).items():
            for said in part.get("diagnostics", []):
                if said["severity"] == "warning":
                    text = f"warning[{said['code']}]: part {number}: {said['message']}"
                    text += f"\n  help: {said['help']}" if said.get("help") else ""
                    first.setdefault(said["code"], (text, set()))[1].add(number)
        return [text if len(of) == 1 else f"{text}\n  in {len(of)} of {len(self.parts)} parts"
                for text, of in first.values()]

    def refuse_warnings(self) -> None:
        """Warnings of the solver and of new meshes end a run that asked for none."""
        said = [*self.warnings(), *self.verdict()[1]]
        if said:
            raise too_many_warnings(said)

    def overall(self) -> str:
        """The worse of the verdict on new meshes and of the certificate of the parts."""
        return worse(self.verdict()[0], self.told()[0].get("verdict", "PASS"))

    def json(self) -> str:
        """All of it."""
        certificate, said = self.told()
        jumps = {j["part"]: j for j in self.jumps()}
        told = [asdict(r) | {"force_change": jumps.get(r.part, {}).get("change"),
                             "force_change_of_largest": jumps.get(r.part, {}).get("of_largest"),
                             "way_change": jumps.get(r.part, {}).get("way")}
                for r in self.remeshes]
        return json.dumps({"schema": "lopin-parts/1", "deck": self.name, "parts": self.parts,
                           "remeshes": told, "cards": self.cards, "sums": self.sums,
                           "balance": self.balance(), "certificate": certificate,
                           "diagnostics": said, "remeshing": self.verdict()[0],
                           "verdict": self.overall()}, indent=1)

    def balance(self) -> dict[str, float]:
        """Volume and energy of a run that separates: where they went; nothing without a cut.

        `lost`: share of the volume at the start that is in none of the others; `let_go`: work of
        the tools that neither flow, friction nor elastic strain hold at the end, which metal that
        separated took along or gave back as it was let go of.
        """
        found = columns(self.folder/f"{self.name}_history.csv")
        if not found or not any(r.cut for r in self.remeshes):
            return {}
        left, scrap = found["volume"][-1], sum(p["volume"] for r in self.remeshes for p in r.scrap)
        out = sum(r.separated*r.moved["volume"] for r in self.remeshes)
        start = found["volume"][0]
        done = {"plastic": found["energy.plastic"][-1], "elastic": found["energy.strain"][-1],
                "friction": found.get("energy.friction", np.zeros(1))[-1]}
        work = work_of_tools(found)
        return {"volume": start, "left": left, "scrap": scrap, "taken_out": out,
                "lost": 1.0 - (left + scrap + out)/start, "work": work, **done,
                "let_go": work - sum(done.values())}

    def taken_out(self) -> float:
        """Share of the volume that elements beyond a critical damage had."""
        return float(1.0 - np.prod([1.0 - r.separated for r in self.remeshes]))

    def jumps(self) -> list[dict]:
        """Change of the forces of the tools in the increments at rest: part that ended, change by
        the force then, and by the largest force up to then. Once the load has fallen the second
        says what the run's load curve has lost; where the load rises the two are the same."""
        last, largest, found, ways = None, TINY, [], Ways()
        for number, name in enumerate(self.parts, 1):
            history = columns(self.folder/f"{name}_history.csv")
            forces = of_tools(history, "rf")
            moved = ways.at_rest(history)
            if not len(forces):
                last = None
                continue
            if last is not None:
                change = float(np.linalg.norm(forces[0] - last))
                found.append({"part": number - 1,
                              "change": change/max(float(np.linalg.norm(last)), TINY),
                              "of_largest": change/largest, **moved})
            last = forces[-1]
            largest = max(largest, float(np.linalg.norm(forces, axis=1).max()))
        return found

    def shares_of_energy(self) -> dict[int, float]:
        """Elastic energy where each part ended, by the largest up to then: a change of what an
        unloaded body has left is beside that, and of metal that has none beside its work."""
        largest, work, found = 0.0, 0.0, {}
        for number, name in enumerate(self.parts, 1):
            history = columns(self.folder/f"{name}_history.csv")
            strain = history.get("energy.strain", np.zeros(0))
            if len(strain):
                work += float(history.get("energy.plastic", np.zeros(1))[-1])
                largest = max(largest, float(np.abs(strain).max()))
                found[number] = abs(float(strain[-1]))/max(largest, NO_ENERGY*abs(work), TINY)
        return found

    def verdict(self) -> tuple[str, list[str]]:
        """PASS, WARN or FAIL, and why: what remeshes have changed."""
        said, worst, energy = [], 0, self.shares_of_energy()
        for r, jump in ((r, j) for r in self.remeshes for j in self.jumps()
                        if j["part"] == r.part):
            for what, value, warn, fail in (
                    ("volume", abs(r.moved["volume_change"]), np.inf, 1e-6),
                    ("integral of plastic strain", abs(r.plastic_change), 2e-3, np.inf),
                    ("elastic energy", abs(r.energy_change)*energy.get(r.part, 1.0), 2e-2,
                     np.inf),
                    ("sides of a fold, by a cell inside", r.moved.get("fold_depth", 0.0), INSIDE,
                     np.inf),
                    ("force of the tools at rest", jump["of_largest"], 1e-2, 5e-2),
                    (f"place of {jump.get('tool')}, by its way,", jump.get("way", 0.0), 1e-2,
                     5e-2)):
                if r.cut:
                    break   # what is taken out takes its force along
                level = 2 if value > fail else 1 if value > warn else 0
                worst = max(worst, level)
                if level:
                    said.append(f"{('', 'WARN', 'FAIL')[level]}: remesh at time {r.time:g} "
                                f"changes the {what} by {100*value:.2g} %"
                                + (in_words(jump) if what.startswith("force") else ""))
        gone = self.taken_out()
        if gone > MOST_TAKEN_OUT:
            worst = 2
            said.append(f"FAIL: {100*gone:.2g} % of the volume was taken out as elements "
                        "separated: finer cells, and a smaller WIDTH, where it is cut")
        folds = [r for r in self.remeshes if r.fold()]
        if folds:
            worst = max(worst, 1)
            said.append(f"WARN: remesh at time {folds[0].time:g}: {folds[0].fold()}; the sides of "
                        "a fold do not meet as bodies in contact do")
        return ("PASS", "WARN", "FAIL")[worst], said

    def text(self) -> str:
        """For a terminal."""
        verdict, said = self.verdict()
        certificate = self.told()[0]
        cut = {r.part for r in self.remeshes if r.cut}
        jumps = [j for j in self.jumps() if j["part"] not in cut]
        lines = [*self.warnings(), *said]
        if certificate.get("verdict", "PASS") != "PASS":
            lines.append("{verdict}: certificate of part {part}, step {step}, increment "
                         "{increment}: {reason}".format(**certificate))
        verdict = self.overall()
        lines += [f"{len(self.parts)} parts, {len(self.remeshes)} remeshes: {verdict}"]
        if cut:
            lines[-1] = (f"{len(self.parts)} parts, {len(self.remeshes) - len(cut)} remeshes, "
                         f"{len(cut)} separations of {100*self.taken_out():.2g} % of the volume: "
                         f"{verdict}")
        if jumps:
            worst = max(jumps, key=lambda j: j["of_largest"])
            lines[-1] += (f"; force of the tools at rest changes by {100*worst['of_largest']:.2g} "
                          f"% at most{in_words(worst)}")
            small = max(jumps, key=lambda j: j["change"])
            if small is not worst and small["change"] > 1.5*worst["change"]:
                lines[-1] += (f"; where the force is small by {100*small['of_largest']:.2g} %"
                              + in_words(small))
            way = max(jumps, key=lambda j: j.get("way", 0.0))
            if way.get("way", 0.0) > TOLD:
                lines[-1] += f"; at rest {way['tool']} moves by {100*way['way']:.2g} % of its way"
        told = self.balance()
        if told:
            lines.append("volume {volume:.5g}: {left:.5g} left, {scrap:.5g} scrap, {taken_out:.3g} "
                         "taken out".format(**told) + f" ({100*told['lost']:+.2g} % lost)")
            lines.append("work of the tools {work:.5g}: {plastic:.5g} plastic, {friction:.4g} "
                         "friction, {elastic:.4g} elastic, {let_go:.4g} let go of".format(**told))
        lines.append(f"results in {self.folder}/; {self.name}.pvd and {self.name}_history.csv "
                     "hold all parts")
        return "\n".join(lines)


def too_many_warnings(said: list[str]) -> DeckError:
    """The error of a run with --strict."""
    return DeckError(f"{len(said)} {'warning' if len(said) == 1 else 'warnings'} with --strict: "
                     f"{said[0].splitlines()[0]}", id="E0803")


def in_words(jump: dict) -> str:
    """A change of force beside the largest one, and beside the one there was where they differ.

    >>> in_words({"change": 0.2, "of_largest": 0.01})
    ' of the largest so far (20 % of what it was then)'
    """
    if jump["change"] <= 1.05*jump["of_largest"]:
        return ""
    return f" of the largest so far ({100*jump['change']:.2g} % of what it was then)"
