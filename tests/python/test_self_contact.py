"""Self-contact: the arms of a hairpin are pressed on one another, and not through; walls stay
walls.

One surface stands on both sides of its pair. The reference is symmetry, and the mesh itself: no
node of one arm may lie behind the other arm.
"""
import json
import re
import subprocess

import numpy as np
import pytest

import lopin
from lopin import NeoHooke, mesh_make
from lopin.model import Model

THICK, OPEN, LONG, H = 0.5, 0.5, 4.0, 0.25
PENETRATION = 1e-8
PRINTED = 1e-6    # of displacements in .dat


class Hairpin:
    """A U of two arms that lie along x, or closed on the right too; `depth` elements across (0:
    plane strain)."""

    def __init__(self, depth=0, closed=False):
        self.number, self.elements, self.depth, self.closed = {}, [], depth, closed
        self.top = round((2*THICK + OPEN)/H)
        self.low, self.high = round(THICK/H), round((THICK + OPEN)/H)
        self.left, self.right = -round(THICK/H), round(LONG/H)
        end = self.end = self.right
        if closed:
            self.right -= self.left
        for i in range(self.left, self.right):
            for j in range(self.top):
                if 0 <= i < end and self.low <= j < self.high:
                    continue
                quad = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
                for k in range(max(depth, 1)):
                    layers = [0] if depth == 0 else [k, k + 1]
                    self.elements.append([self.node(*at, layer) for layer in layers for at in quad])

    def node(self, *at):
        return self.number.setdefault(at, len(self.number) + 1)

    def set(self, name, keep):
        return f"*NSET, NSET={name}\n" + "".join(f"{n}\n" for at, n in self.number.items()
                                                 if keep(*at))

    def deck(self, both, pair, law="", inc="0.1, 1., 1e-5, 0.1", beyond=0.05):
        """`both` arms are moved, or the upper one alone; pressed on by `beyond` more than the
        opening."""
        solid = self.depth > 0
        text = "*NODE, NSET=ALL\n"
        for (i, j, k), n in self.number.items():
            text += f"{n}, {i*H}, {j*H}" + (f", {k*H}\n" if solid else "\n")
        text += f"*ELEMENT, TYPE={'C3D8' if solid else 'CPE4'}, ELSET=PIN\n"
        text += "".join(f"{k}, {', '.join(map(str, e))}\n" for k, e in enumerate(self.elements, 1))
        text += "*MATERIAL, NAME=M\n*ELASTIC\n1000., 0.3\n*SOLID SECTION, ELSET=PIN, MATERIAL=M\n1.\n"
        text += "*SURFACE, NAME=SKIN\nPIN,\n*SURFACE INTERACTION, NAME=DRY\n"
        text += f"*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD\n{law}"
        text += f"*CONTACT PAIR, INTERACTION=DRY, TYPE=NODE TO SURFACE\n{pair}\n"
        tip = range(self.end - 2, self.end + 1) if not self.closed else range(self.end//2 - 1,
                                                                              self.end//2 + 2)
        text += self.set("TIP", lambda i, j, k: j == self.top and i in tip)
        text += self.set("FOOT", lambda i, j, k: j == 0 and (i in tip or not both))
        text += f"*STEP, NLGEOM, INC=200\n*STATIC\n{inc}\n*BOUNDARY\n"
        share = 0.5 if both else 1.0
        text += f"TIP, 2, 2, {-share*(OPEN + beyond)}\nFOOT, 2, 2, {(1.0 - share)*(OPEN + beyond)}\n"
        text += "FOOT, 1, 1\n"
        if both:
            text += "TIP, 1, 1\n"
        if solid:
            text += "ALL, 3\n"
        return text + "*NODE PRINT, NSET=ALL\nU\n*END STEP\n"

    def run(self, executable, folder, **options):
        (folder/"pin.inp").write_text(self.deck(**options))
        done = subprocess.run([executable, "run", "pin.inp", "-o", ".", "--overwrite", "--quiet"],
                              cwd=folder, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        block = (folder/"pin.dat").read_text().split("displacements")[-1]
        rows = [line.split() for line in block.splitlines()[1:]]
        u = {int(r[0]): np.array(r[1:4], float) for r in rows if len(r) >= 3 and r[0].isdigit()}
        return json.loads((folder/"pin.json").read_text()), u

    def wall(self, u, level, layer):
        """Present places of the inner face of an arm, from the fold to the tip."""
        nodes = {i: n for (i, j, k), n in self.number.items() if j == level and k == layer
                 and 0 <= i <= self.end}
        return np.array([[i*H + u[n][0], level*H + u[n][1]] for i, n in sorted(nodes.items())])


def gaps(upper, lower):
    """Of the upper nodes over the polygon below, and of the lower nodes under the one above."""
    first = upper[:, 1] - np.interp(upper[:, 0], *lower.T)
    second = np.interp(lower[:, 0], *upper.T) - lower[:, 1]
    return first, second


@pytest.mark.parametrize(("depth", "pair"), [(0, "SKIN, SKIN"), (1, "SKIN,")])
def test_the_arms_of_a_hairpin_meet_from_both_sides(executable, tmp_path, depth, pair):
    pin = Hairpin(depth, closed=True)
    job, u = pin.run(executable, tmp_path, both=True, pair=pair)
    assert job["contact"][0]["closed"] > 0
    # Exact at the nodes that press; those pressed upon keep within what facets cut off.
    assert job["contact"][0]["max_penetration"] < PENETRATION
    for layer in range(depth + 1):
        first, second = gaps(pin.wall(u, pin.high, layer), pin.wall(u, pin.low, layer))
        assert min(first.min(), second.min()) > -1e-3*H
        assert max(first.min(), second.min()) < PRINTED
    # One side presses along the normals of the other: symmetry is kept but for how facets tilt.
    mirror = {n: pin.number[i, pin.top - j, k] for (i, j, k), n in pin.number.items()}
    most = max(np.abs(v).max() for v in u.values())
    odd = max(max(abs(u[n][0] - u[m][0]), abs(u[n][1] + u[m][1])) for n, m in mirror.items())
    assert odd < 0.02*most


def test_one_arm_is_bent_onto_the_other(executable, tmp_path):
    pin = Hairpin()
    job, u = pin.run(executable, tmp_path, both=False, pair="SKIN, SKIN")
    first, second = gaps(pin.wall(u, pin.high, 0), pin.wall(u, pin.low, 0))
    assert job["contact"][0]["closed"] > 0
    assert job["contact"][0]["max_penetration"] < PENETRATION
    assert min(first.min(), second.min()) > -1e-2*H
    assert abs(max(first.min(), second.min())) < PRINTED


def test_a_thin_wall_is_not_its_own_contact(executable, tmp_path):
    """Opened instead of closed, nothing touches: the faces of a wall never meet through it."""
    pin = Hairpin()
    job, _ = pin.run(executable, tmp_path, both=True, pair="SKIN, SKIN", beyond=-2*OPEN)
    assert job["contact"][0]["closed"] == 0


def crossing(words, inc):
    """A block above a strip that is held at its ends, one skin: the block goes down by 1.5, or by 4
    and out below."""
    number, elements = {}, []
    for kind, nx, ny in (("S", 20, 2), ("B", 3, 3)):
        for i in range(nx):
            for j in range(ny):
                elements.append([number.setdefault((kind, *at), len(number) + 1) for at in
                                 ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1))])
    text = "*NODE\n"
    for (kind, i, j), n in number.items():
        x, y = (0.5*i, 0.25*j) if kind == "S" else (4.1 + 0.4*i, 1.0 + 0.4*j)
        text += f"{n}, {x!r}, {y!r}\n"
    text += "*ELEMENT, TYPE=CPE4, ELSET=E\n"
    text += "".join(f"{k}, {', '.join(map(str, e))}\n" for k, e in enumerate(elements, 1))
    for name, kept in (("ENDS", [("S", i, j) for i in (0, 20) for j in range(3)]),
                       ("TOP", [("B", i, 3) for i in range(4)])):
        text += f"*NSET, NSET={name}\n" + "".join(f"{number[at]}\n" for at in kept)
    down = -4.0 if "DIRECT" in words else -1.5
    return text + f"""*MATERIAL, NAME=M
*ELASTIC
1000., 0.3
*SOLID SECTION, ELSET=E, MATERIAL=M
1.
*SURFACE, NAME=SKIN
E,
*SURFACE INTERACTION, NAME=I
*CONTACT PAIR, INTERACTION=I, TYPE=NODE TO SURFACE
SKIN, SKIN
*STEP, NLGEOM, INC=500
*STATIC{words}
{inc}
*BOUNDARY
ENDS, 1, 2
TOP, 1
TOP, 2, 2, {down}
*END STEP
"""


@pytest.mark.parametrize(("words", "inc", "code"), [("", "1., 1., 1e-5, 1.", "N0551"),
                                                    (", DIRECT", "1., 1.", "E0550")])
def test_no_part_of_a_skin_passes_through_another(executable, tmp_path, words, inc, code):
    """In one increment, without a word, before: the increment is cut and said, or refused."""
    (tmp_path/"skin.inp").write_text(crossing(words, inc))
    done = subprocess.run([executable, "run", "skin.inp", "-o", "."], cwd=tmp_path,
                          capture_output=True, text=True, check=False)
    assert code in done.stdout + done.stderr
    assert (done.returncode == 0) == (code == "N0551")
    if code == "N0551":
        assert json.loads((tmp_path/"skin.json").read_text())["contact"][0]["closed"] > 0


def test_newton_that_fails_says_where(executable, tmp_path):
    """The worst dof, its pair, and a contact that changed in the last iteration."""
    text = Hairpin().deck(both=False, pair="SKIN, SKIN", inc="1., 1.", beyond=1.3)
    (tmp_path/"pin.inp").write_text(text.replace("*STATIC\n", "*STATIC, DIRECT\n"))
    done = subprocess.run([executable, "run", "pin.inp", "-o", "."], cwd=tmp_path,
                          capture_output=True, text=True, check=False)
    assert done.returncode == 3
    said = done.stdout + done.stderr
    assert "E0510" not in said or re.search(r"most at node \d+, dof [123]", said)
    assert "E0510" in said or "E0512" in said


@pytest.mark.parametrize("heights", [(1.0, 1.0, 0.4, 1.0, 1.0, 1.0), (1.0, 0.45, 0.2, 0.45, 1.0, 1.0),
                                     (1.0, 1.0, 1.0, 1.0, 1.0, 0.3)])
def test_a_wall_that_narrows_is_a_wall(solve, heights):
    """One element through it, half as thick at the next node: its other face was taken for that of a
    closed fold and pushed out. With its surface in contact with itself it bends as without."""
    n = len(heights)
    nodes = [f"{2*i + 1 + k}, {i}., {(k - 0.5)*h!r}" for i, h in enumerate(heights) for k in (0, 1)]
    cells = [f"{i + 1}, {2*i + 1}, {2*i + 3}, {2*i + 4}, {2*i + 2}" for i in range(n - 1)]
    skin = [f"{i + 1}, S{face}" for i in range(n - 1) for face in (1, 3)]

    def tip(pair):
        text = ["*NODE", *nodes, "*ELEMENT, TYPE=CPE4, ELSET=B", *cells, "*SURFACE, NAME=SKIN",
                *skin, "*NSET, NSET=TIP", f"{2*n - 1}, {2*n}", "*MATERIAL, NAME=M", "*ELASTIC",
                "1000., .3", "*SOLID SECTION, ELSET=B, MATERIAL=M", "1.,", *pair, "*BOUNDARY",
                "1, 1, 2", "2, 1, 2", "*STEP, NLGEOM", "*STATIC", "1., 1.", "*CLOAD",
                "TIP, 2, -.01", "*NODE FILE", "U", "*END STEP"]
        result = solve(lopin.Deck.parse("\n".join(text) + "\n", name="neck"))
        return result.at(-1)["U"][2*n - 1, 1]
    assert tip(["*SURFACE INTERACTION, NAME=I", "*CONTACT PAIR, INTERACTION=I",
                "SKIN, SKIN"]) == pytest.approx(tip([]), rel=1e-9)


def bellows(word, way, contact=True):
    """Waves of a thin wall of rubber, each crushed by `way`; each side meets itself alone."""
    kind, shape, order = word
    waves = 3 if word == WAVES[0] else 2
    mesh = mesh_make.block((1.2, 12.0*waves), (2, 20*waves), origin=(15.0, 0.0))
    mesh = mesh_make.simplices(mesh) if shape == "triangles" else mesh
    mesh = (mesh.quadratic() if order == 2 else mesh).mapped(
        lambda x: x + np.outer(2.5*np.sin(np.pi*x[:, 1]/6.0), (1.0, 0.0)))
    model = Model("bellows", mesh, kind=kind)
    model.section("ALL", NeoHooke(1.0, 0.04))
    for side in ("LEFT", "RIGHT") if contact else ():
        model.contact(side, side)
    across, along = ("r", "z") if kind == "axisymmetric" else ("x", "y")
    model.fix("BOTTOM", across, along)
    way = way*waves
    model.step(round(5.0*way), nlgeom=True).move("TOP", **{across: 0.0, along: -way})
    return mesh, model.to_deck()


WAVES = [("axisymmetric", "quads", 1), ("axisymmetric", "triangles", 1),
         ("plane strain", "quads", 1), ("plane strain", "quads", 2)]


@pytest.mark.parametrize("word", WAVES, ids=lambda word: "-".join(map(str, word)))
def test_the_far_flank_of_a_hollow_wave_is_not_entered(solve, word):
    """Through the hollow of a wave its other flank seems to be entered by the whole breadth, and turns to
    the first as the waves close: that was pushed out, and no increment was solved."""
    pressed, free = (solve(bellows(word, 3.0, contact)[1]) for contact in (True, False))
    assert pressed.at(-1)["U"] == pytest.approx(free.at(-1)["U"], rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("word", WAVES[:3:2], ids=lambda word: "-".join(map(str, word)))
def test_waves_close_on_each_other(solve, word):
    """Crushed until they touch; no node lies within another element."""
    mesh, deck = bellows(word, 20.0/3.0)
    result = solve(deck)
    assert max(result.contact(pair).last.pressure.max() for pair in result.pairs) > 0.0
    x = mesh.points + result.at(-1)["U"][:, :2]
    for cell in mesh.blocks[0][1]:
        edges = np.roll(x[cell], -1, axis=0) - x[cell]
        inward = [(edge[0]*(x - corner)[:, 1] - edge[1]*(x - corner)[:, 0])/np.hypot(*edge)
                  for corner, edge in zip(x[cell], edges)]
        within = np.min(inward, axis=0)
        within[cell] = 0.0
        assert within.max() < 0.05*THICK
