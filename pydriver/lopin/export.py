"""Decks of Lopin for other programs: CalculiX, Abaqus, or one file without includes.

What another program does not have is written in its own way where the meaning stays (a rigid
profile becomes a strip of elements that move as one, hard contact a stiff slope), and refused where
it does not. What was changed is said in comments at the top of the deck.
"""
from __future__ import annotations

import math
from collections.abc import Callable

from .deck import Block, Deck, Row
from .errors import UsageError
from .export_profile import (beside_axis, number_of, profile_points, smallest_radius,
                             strip_behind)
from .model_read_mesh import MeshCards, expanded

#: Cards that only Lopin has, and words that only it has on others.
_OWN_CARDS = ("LOPIN",)
_CONTACT_RESULTS = {"ccx": {"CDIS": "CDIS", "CSTR": "CSTR"},
                    "abaqus": {"CDIS": "CDISP", "CSTR": "CSTRESS"}}
#: CalculiX: pressure per penetration that stands for hard contact, beside the modulus over a facet;
#: slope of sticking beside it.
_STIFF, _STICK = 100.0, 1.0/3.0
#: CalculiX: stress far from a contact at nodes, beside the modulus.
_TENSION = 1e-6



def export(deck: Deck, target: str) -> Deck:
    """The deck that another program reads.

    Parameters
    ----------
    target : "ccx", "abaqus", or "flat" (the same deck with its includes in their place)

    Raises
    ------
    UsageError : a card has no counterpart there.
    """
    if target not in ("ccx", "abaqus", "flat"):
        raise UsageError(f"decks are written for ccx, abaqus or flat, not for {target}")
    blocks = [_copy(block) for block in expanded(deck)]
    if target == "flat":
        return Deck(blocks, preamble=deck.preamble, name=deck.name)
    return _Writer(deck, blocks, target).deck()


def tools_of(deck: Deck) -> tuple[Deck, dict[str, str]]:
    """The deck for CalculiX, and the node sets of its rigid tools by reference node or its set."""
    writer = _Writer(deck, [_copy(block) for block in expanded(deck)], "ccx")
    return writer.deck(), {str(k).upper(): v for k, v in writer.moved.items()}


class _Writer:
    """Cards in the order of the deck, each by the method of its name if there is one."""

    def __init__(self, deck: Deck, blocks: list[Block], target: str):
        self.name, self.blocks, self.target = deck.name, blocks, target
        self.mesh = MeshCards(blocks)
        self.notes: list[str] = []
        self.tools: dict[str, str] = {}        # profile: set of its nodes (CalculiX)
        self.moved: dict[str, str] = {}        # reference node or its set: set of the tool's nodes
        self.out: list[Block] = []
        self.modulus = max([number_of(b.data[0][0]) for b in blocks
                            if b.keyword == "ELASTIC" and b.data] or [1.0])
        self.axisymmetric = any(str(w).startswith("CAX") for w, _ in self.mesh.elements.values())
        self.solid = any(str(w).startswith("C3D") for w, _ in self.mesh.elements.values())
        self.slope = _STIFF*self.modulus/self._facet()
        self.steps = 0
        self.period = 1.0                      #: of the step [time]
        self.went: dict[tuple[str, int], float] = {}   # displacement of tools by axis so far

    def deck(self) -> Deck:
        """The deck, with what was changed at its top."""
        if self.target == "ccx":
            self._find_tools()
        for block in self.blocks:
            own = "_" + block.keyword.lower().replace(" ", "_")
            method: Callable | None = getattr(self, f"{own}_{self.target}", None) \
                or getattr(self, own, None)
            if block.keyword in _OWN_CARDS:
                self._note(f"*{block.keyword} is left out: only Lopin has it")
            elif method is None:
                self.out.append(block)
            else:
                method(block)
        for block in self.out:
            _plain_names(block)
            if self.target == "ccx":
                _short_numbers(block)
        says = [f"** written by Lopin for {'CalculiX' if self.target == 'ccx' else 'Abaqus'}"]
        return Deck(self.out, preamble=says + ["** " + note for note in self.notes],
                    name=self.name)

    def _note(self, text: str) -> None:
        if text not in self.notes:
            self.notes.append(text)

    def _refuse(self, what: str, instead: str) -> UsageError:
        program = "CalculiX" if self.target == "ccx" else "Abaqus"
        return UsageError(f"{program} has nothing for {what}: {instead}")

    def _facet(self) -> float:
        """A usual length of an edge [length]."""
        lengths = []
        for _, nodes in list(self.mesh.elements.values())[:2000]:
            a, b = (self.mesh.nodes[n] for n in nodes[:2])
            lengths.append(math.dist(a, b))
        return sorted(lengths)[len(lengths)//2] if lengths else 1.0

    def _smallest_edge(self) -> float:
        """Of all elements [length]."""
        return min((math.dist(self.mesh.nodes[a], self.mesh.nodes[b])
                    for _, nodes in self.mesh.elements.values()
                    for a, b in zip(nodes[:3], nodes[1:4]) if len(nodes) > 2), default=math.inf)

    # --- rigid profiles, which CalculiX does not have

    def _find_tools(self) -> None:
        """Meshes of rigid profiles, and what their reference nodes become."""
        label = max(self.mesh.nodes)
        element = max(self.mesh.elements)
        surfaces = {_word(b, "NAME"): b for b in self.blocks if b.keyword == "SURFACE"
                    and _word(b, "TYPE", "ELEMENT") not in ("ELEMENT", "NODE")}
        for block in (b for b in self.blocks if b.keyword == "RIGID BODY"):
            name = _word(block, "ANALYTICAL SURFACE")
            if not name:
                raise self._refuse("a rigid body of nodes in this version",
                                   "write its nodes as *BOUNDARY or *EQUATION")
            if name not in surfaces or _word(surfaces[name], "TYPE") != "SEGMENTS" or self.solid:
                raise self._refuse(f"the rigid tool {name} in space",
                                   "mesh it, and press with the mesh")
            points = profile_points(surfaces[name], self._smallest_edge())
            if self.axisymmetric:
                points = beside_axis(points)
            reference = _word(block, "REF NODE")
            strip = strip_behind(points, 0.5*min(self._extent(points),
                                                 smallest_radius(surfaces[name])))
            self.tools[name] = f"NT_{name}"
            for key in self._names_of(reference):
                self.moved[key] = f"NT_{name}"
            self._add_strip(name, strip, label, element)
            label += len(strip[0])
            element += len(strip[1])

    def _thickness(self) -> float:
        """Of a strip as wide as the thickest body [length]."""
        return max([number_of(b.data[0][0]) for b in self.blocks
                    if b.keyword == "SOLID SECTION" and b.data] or [1.0]) or 1.0

    def _extent(self, points: list) -> float:
        xs, ys = zip(*points)
        return max(max(xs) - min(xs), max(ys) - min(ys))*0.1

    def _names_of(self, reference: str) -> list[str]:
        """A reference node by number, and the sets of it alone."""
        sets = self.mesh.nsets
        members = sets.get(reference, None) or [int(reference)]
        return [str(members[0]), *(k for k, v in sets.items() if v == members[:1])]

    def _add_strip(self, name: str, strip: tuple, label: int, element: int) -> None:
        nodes, cells = strip
        word = "CAX4" if self.axisymmetric else "CPE4"
        self.out += [
            Block("NODE", {"NSET": f"NT_{name}"},
                  [(label + k + 1, *p) for k, p in enumerate(nodes)]),
            Block("ELEMENT", {"TYPE": word, "ELSET": f"ET_{name}"},
                  [(element + k + 1, *(label + n + 1 for n in cell))
                   for k, cell in enumerate(cells)]),
            Block("MATERIAL", {"NAME": f"MT_{name}"}),
            Block("ELASTIC", {}, [(10.0*self.modulus, 0.3)]),
            Block("SOLID SECTION", {"ELSET": f"ET_{name}", "MATERIAL": f"MT_{name}"},
                  [(self._thickness(),)]),
            Block("SURFACE", {"NAME": name, "TYPE": "ELEMENT"}, [(f"ET_{name}", "S1")])]
        self._note(f"the rigid profile {name} is a strip of {len(cells)} elements, all of whose "
                   f"nodes move as its reference node did (no rotation)")

    def _surface_ccx(self, block: Block) -> None:
        if _word(block, "NAME") not in self.tools:
            block.parameters.pop("TYPE", None) if _word(block, "TYPE") == "ELEMENT" else None
            self.out.append(block)

    def _rigid_body_ccx(self, block: Block) -> None:
        """Its nodes are driven by *BOUNDARY."""

    def _static_ccx(self, block: Block) -> None:
        row = block.data[0] if block.data else ()
        self.period = number_of(row[1]) if len(row) > 1 and row[1] is not None else 1.0
        self.out.append(block)

    def _boundary_ccx(self, block: Block) -> None:
        rows = []
        speed = _word(block, "TYPE") == "VELOCITY"
        if speed:
            if any(str(row[0]).upper() not in self.moved for row in block.data):
                raise self._refuse("a node that goes at a velocity", "prescribe its displacement")
            block.parameters.pop("TYPE")
        for row in block.data:
            tool = self.moved.get(str(row[0]).upper())
            if tool is None:
                rows.append(row)
                continue
            first = int(row[1])
            last = int(row[2]) if len(row) > 2 and row[2] is not None else first
            value = number_of(row[3]) if len(row) > 3 else 0.0
            if last > 2:
                if value:
                    raise self._refuse("a rigid tool that turns", "let it move only")
                last = 2
            for axis in range(first, last + 1):
                where = self.went.get((tool, axis), 0.0) + value*self.period if speed else value
                self.went[tool, axis] = where
            if first <= last:
                rows.append(Row([tool, first, last, where]))
            if self.axisymmetric and self.steps == 0 and first > 2:
                rows.append(Row([tool, 1, 1, 0.0]))
        if rows:
            block.lines = rows
            self.out.append(block)

    def _cload_ccx(self, block: Block) -> None:
        if any(str(row[0]).upper() in self.moved for row in block.data):
            raise self._refuse("a rigid tool that a force moves", "prescribe its displacement")
        self.out.append(block)

    def _dsload_ccx(self, block: Block) -> None:
        if any(str(row[1]).upper() != "P" for row in block.data):
            raise self._refuse("a traction on a surface", "write it as forces of nodes")
        self.out.append(block)

    def _node_print_ccx(self, block: Block) -> None:
        tool = self.moved.get(_word(block, "NSET"))
        if tool:
            block.parameters["NSET"] = tool
            block.parameters.setdefault("TOTALS", "ONLY")
        self.out.append(block)

    # --- contact

    def _surface_interaction_ccx(self, block: Block) -> None:
        self.out.append(block)
        at = next(k for k, b in enumerate(self.blocks) if b is block)
        after = self.blocks[at + 1] if at + 1 < len(self.blocks) else None
        if after is None or after.keyword != "SURFACE BEHAVIOR":
            self._surface_behavior_ccx(Block("SURFACE BEHAVIOR"))

    def _surface_behavior_ccx(self, block: Block) -> None:
        law = _word(block, "PRESSURE-OVERCLOSURE")
        if law in ("EXPONENTIAL", "TABULAR"):
            self.out.append(block)
            return
        given = number_of(block.data[0][0]) if block.data and block.data[0] else 0.0
        slope = given or self.slope
        if not given:
            self._note(f"contact that lets nothing through is a slope of {slope:.6g}, "
                       f"{_STIFF:g} moduli over a facet")
        elif law != "LINEAR":
            self._note("the slope of the deck is kept; multipliers are left out")
        # At nodes CalculiX needs a tension far away, too: a small one.
        row = (slope, _TENSION*self.modulus) if self.axisymmetric and self.tools else (slope,)
        self.out.append(Block("SURFACE BEHAVIOR",
                              {"PRESSURE-OVERCLOSURE": "TIED" if law == "TIED" else "LINEAR"},
                              [row]))
        self.slope = slope

    def _surface_behavior_abaqus(self, block: Block) -> None:
        if "PERTURBED LAGRANGE" in block.parameters:
            block = Block("SURFACE BEHAVIOR", {"PENALTY": None}, block.data)
            self._note("PERTURBED LAGRANGE is PENALTY, which has the same answer")
        elif "DIRECT" in block.parameters and not block.data:
            block = Block("SURFACE BEHAVIOR", {"PRESSURE-OVERCLOSURE": "HARD", "DIRECT": None})
        self.out.append(block)

    def _friction(self, block: Block) -> None:
        law = _word(block, "LAW", "COULOMB")
        if law != "COULOMB" or "REGULARIZATION" in block.parameters:
            raise self._refuse(f"*FRICTION, LAW={law}", "COULOMB with TAUMAX comes nearest")
        mu = number_of(block.data[0][0]) if block.data and block.data[0] else 0.0
        if self.target == "ccx":
            if "TAUMAX" in block.parameters:
                raise self._refuse("TAUMAX of *FRICTION", "leave it out if mu p stays below it")
            stick = number_of(block.data[0][1]) if block.data and len(block.data[0]) > 1 else 0.0
            self.out.append(Block("FRICTION", {}, [(mu, stick or _STICK*self.slope)]))
            self._note("friction sticks by a slope, a third of that of the contact")
        else:
            given = {k: v for k, v in block.parameters.items()
                     if k in ("TAUMAX", "ROUGH", "SLIP TOLERANCE", "ELASTIC SLIP", "LAGRANGE")}
            self.out.append(Block("FRICTION", given, [] if "ROUGH" in given else [(mu,)]))

    def _contact_pair_ccx(self, block: Block) -> None:
        # CalculiX does not find faces that shrink to a point on the axis.
        block.parameters["TYPE"] = "NODE TO SURFACE" if self.axisymmetric and self.tools \
            else "SURFACE TO SURFACE"
        nodes = {_word(b, "NAME") for b in self.blocks
                 if b.keyword == "SURFACE" and _word(b, "TYPE") == "NODE"}
        if any(str(row[0]).upper() in nodes for row in block.data):
            block.parameters["TYPE"] = "NODE TO SURFACE"
        for word in ("SMOOTH", "EXTENSION ZONE", "TIED"):
            block.parameters.pop(word, None)
        self.out.append(block)

    def _contact_controls(self, block: Block) -> None:
        self._note("*CONTACT CONTROLS is left out")

    def _clearance(self, block: Block) -> None:
        for ours, theirs in (("SECONDARY", "SLAVE"), ("MAIN", "MASTER")):
            if ours in block.parameters:
                block.parameters[theirs] = block.parameters.pop(ours)
        self.out.append(block)

    def _contact_file(self, block: Block) -> None:
        words = _CONTACT_RESULTS[self.target]
        block.lines = [Row([words.get(str(v).upper(), v) for v in row]) for row in block.data]
        self.out.append(block)

    _contact_print = _contact_file

    # --- mesh and materials

    def _element(self, block: Block) -> None:
        word = _word(block, "TYPE")
        plain = word.partition("/")[0]
        if plain == "CSS8":
            plain = "C3D8I"
        if self.target == "ccx":
            plain = plain.replace("RH", "R") if plain.endswith("RH") else plain.removesuffix("H")
            if plain.startswith(("R2D", "RAX", "R3D")):
                raise self._refuse(f"rigid elements {plain}", "mesh the tool with solids")
        if plain != word:
            self._note(f"{word} is written as {plain}")
            block.parameters["TYPE"] = plain
        self.out.append(block)

    def _plastic(self, block: Block) -> None:
        law = _word(block, "HARDENING", "ISOTROPIC")
        if "LAW" in block.parameters or law not in ("ISOTROPIC", "KINEMATIC"):
            raise self._refuse("a flow curve that is a formula",
                               "write *PLASTIC as a table of stresses and strains")
        self.out.append(block)

    def _viscoplastic(self, block: Block) -> None:
        raise self._refuse("*VISCOPLASTIC of Lopin", "write *PLASTIC with *RATE DEPENDENT")

    def _section_controls_ccx(self, block: Block) -> None:
        self._note("*SECTION CONTROLS is left out: CalculiX integrates C3D8 fully")

    def _solid_section_ccx(self, block: Block) -> None:
        block.parameters.pop("CONTROLS", None)
        self.out.append(block)

    def _step(self, block: Block) -> None:
        self.steps += 1
        for word in ("NAME",) if self.target == "ccx" else ():
            block.parameters.pop(word, None)
        self.out.append(block)


def _copy(block: Block) -> Block:
    new = Block(block.keyword, block.parameters, text=block.head())
    new.lines = [line if isinstance(line, str) else Row(line, line.text()) for line in block.lines]
    return new


def _word(block: Block, name: str, default: str = "") -> str:
    value = block.parameters.get(name)
    return default if value is None else str(value).strip('"').upper()


def _short_numbers(block: Block) -> None:
    """Numbers of at most twenty characters, all that CalculiX reads of each."""
    for row in block.data:
        for k, value in enumerate(row):
            if isinstance(value, float) and len(repr(value)) > 20:
                row[k] = float(f"{value:.12e}")


def _plain_names(block: Block) -> None:
    """Dots of names part an instance from its set elsewhere."""
    if block.keyword in ("HEADING", "NODE"):
        return
    for key, value in block.parameters.items():
        if isinstance(value, str) and "." in value and not _isnumber_of(value) and key != "INPUT":
            block.parameters[key] = value.replace(".", "_")
    lines = []
    for line in block.lines:
        if isinstance(line, Row) and any(isinstance(v, str) and "." in v for v in line):
            line = Row([v.replace(".", "_") if isinstance(v, str) else v for v in line])
        lines.append(line)
    block.lines = lines


def _isnumber_of(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
