"""Forces are judged beside those that elements, loads and supports bear, and beside what rounding
leaves of positions: the same digits in any unit, far from the origin, and where forces fade.

A block lies on the ground under a tool, is pressed by a force and sheared by the tool. Lengths,
stresses, the place of the scene, the path and the shape of the tool change; the answer does not.
"""
import csv
import json
import math
import os
import re
import subprocess
from dataclasses import dataclass, field

import pytest

EXECUTABLE = os.environ["LOPIN_EXECUTABLE"]


@dataclass
class Scene:
    """A block 6 by 3 of plane strain, ground at the bottom, tool on the top."""

    length: float = 1.0         #: one unit in the unit of the deck
    stress: float = 1.0
    origin: tuple = (0.0, 0.0)
    nlgeom: bool = False
    round: bool = False         #: a roller in place of a plane
    behavior: str = ""
    element: str = "CPE4"
    mu: float = 0.3
    cells: tuple = (8, 4)
    extra: str = ""             #: cards behind the first step
    shear: float = 0.004
    force: float = 3.0
    materials: str = field(default="")

    def text(self):
        n, m = self.cells
        x0, y0 = self.origin
        size = self.length

        def place(x, y):
            return f"{(x + x0)*size!r}, {(y + y0)*size!r}"
        label = lambda i, j: 1 + i + (n + 1)*j
        nodes = [f"{label(i, j)}, {place(6.0*i/n, 3.0*j/m)}"
                 for j in range(m + 1) for i in range(n + 1)]
        cells = [f"{1 + i + n*j}, {label(i, j)}, {label(i + 1, j)}, {label(i + 1, j + 1)}, "
                 f"{label(i, j + 1)}" for j in range(m) for i in range(n)]
        top = [f"{1 + i + n*(m - 1)}, S3" for i in range(n)]
        tool = (f"START, {place(5.5, 3.5)}\nCIRCL, {place(0.5, 3.5)}, {place(3.0, 9.5)}"
                if self.round else f"START, {place(12, 3)}\nLINE, {place(-6, 3)}")
        step = "*STEP, INC=1000" + (", NLGEOM" if self.nlgeom else "")
        force = -self.force*self.stress*self.length
        return "\n".join([
            "*NODE, NSET=ALL", *nodes, f"*ELEMENT, TYPE={self.element}, ELSET=B", *cells,
            "*NSET, NSET=BOTTOM", ",".join(map(str, range(1, n + 2))),
            "*SURFACE, NAME=TOP", *top, "*NODE, NSET=P", f"9999, {place(3, 4)}",
            "*MATERIAL, NAME=M", "*ELASTIC", f"{1000*self.stress!r}, 0.3", self.materials,
            "*SOLID SECTION, ELSET=B, MATERIAL=M", "1.",
            "*SURFACE, NAME=TOOL, TYPE=SEGMENTS", tool,
            "*RIGID BODY, ANALYTICAL SURFACE=TOOL, REF NODE=9999",
            "*SURFACE INTERACTION, NAME=I", self.behavior, "*FRICTION", f"{self.mu}",
            "*CONTACT PAIR, INTERACTION=I", "TOP, TOOL",
            "*BOUNDARY", "BOTTOM, 1, 2", "P, 6", "P, 1",
            step, "*STATIC", "*CLOAD", f"P, 2, {force!r}", "*END STEP",
            step, "*STATIC", "*BOUNDARY", f"P, 1, 1, {self.shear*self.length!r}", "*END STEP",
            self.extra, ""]).replace("\n\n", "\n")


def run(folder, text):
    (folder/"job.inp").write_text(text)
    done = subprocess.run([EXECUTABLE, "run", "job.inp", "-o", "out", "--overwrite"], cwd=folder,
                          capture_output=True, text=True, timeout=120)
    summary = json.loads((folder/"out/job.json").read_text()) if (folder/"out/job.json").exists() \
        else {}
    rows = []
    if (folder/"out/job_history.csv").exists():
        rows = [{k.split(" [")[0]: float(v) for k, v in row.items()}
                for row in csv.DictReader((folder/"out/job_history.csv").open())]
    return done, summary, rows


def warnings(done):
    return set(re.findall(r"warning\[(W\d+)\]", done.stderr))


def forces(row):
    return [row["TOOL.rf1"], -row["TOP-TOOL.force2"]]


@pytest.mark.parametrize("nlgeom", [False, True])
@pytest.mark.parametrize("round_", [False, True])
def test_answers_do_not_depend_on_units(tmp_path, nlgeom, round_):
    make = lambda **how: Scene(nlgeom=nlgeom, round=round_, **how)
    done, summary, rows = run(tmp_path, make().text())
    assert done.returncode == 0, done.stderr
    # A round tool touches by one node of its coarse facets.
    expected = warnings(done)
    assert expected == ({"W0563", "W0565"} if round_ else set())
    shear, press = forces(rows[-1])
    assert press == pytest.approx(3.0, rel=1e-6) and 0.1 < abs(shear) <= 0.9 + 1e-6
    for length, stress in ((1e-6, 1.0), (1e4, 1.0), (1e6, 1.0), (1.0, 1e-6), (1.0, 1e6), (1e6, 1e6)):
        done, other, found = run(tmp_path, make(length=length, stress=stress).text())
        assert done.returncode == 0, (length, stress, done.stderr)
        assert other["certificate"]["verdict"] == "PASS"
        assert warnings(done) == expected, (length, stress, done.stderr)
        assert len(found) == len(rows)
        for a, b in zip(forces(rows[-1]), forces(found[-1])):
            assert b/(length*stress) == pytest.approx(a, rel=1e-8), (length, stress)


@pytest.mark.parametrize("nlgeom", [False, True])
def test_answers_do_not_depend_on_the_place(tmp_path, nlgeom):
    _, _, rows = run(tmp_path, Scene(nlgeom=nlgeom, round=True).text())
    for origin in ((1e3, 0.0), (-1e5, 2e5), (1e6, 1e6)):
        done, summary, found = run(tmp_path, Scene(nlgeom=nlgeom, round=True, origin=origin).text())
        assert done.returncode == 0, (origin, done.stderr)
        assert summary["certificate"]["verdict"] == "PASS", summary["certificate"]
        # Places are known to 1e-16 of the distance, gaps are 1e-3.
        away = 1e-9 + 1e-11*math.hypot(*origin)
        assert forces(found[-1]) == pytest.approx(forces(rows[-1]), rel=max(1e-8, away))


@pytest.mark.parametrize("behavior", ["", "*SURFACE BEHAVIOR, AUGMENTED LAGRANGE"])
@pytest.mark.parametrize("nlgeom", [False, True])
def test_friction_lowered_while_a_block_is_held(tmp_path, nlgeom, behavior):
    step = "*STEP, INC=100" + (", NLGEOM" if nlgeom else "")
    extra = "\n".join([step, "*STATIC", "*CHANGE FRICTION, INTERACTION=I", "*FRICTION", "0.1",
                       "*END STEP", step, "*STATIC", "*BOUNDARY", "P, 1, 1, -0.1", "*END STEP"])
    scene = Scene(nlgeom=nlgeom, behavior=behavior, shear=0.1, extra=extra)
    done, summary, rows = run(tmp_path, scene.text())
    assert done.returncode == 0, done.stderr
    at = {row["step"]: row["TOOL.rf1"] for row in rows}
    assert abs(at[2.0]) == pytest.approx(0.9, rel=1e-3)
    assert abs(at[3.0]) == pytest.approx(0.3, rel=1e-3)
    assert at[4.0] == pytest.approx(-at[3.0], rel=1e-3)
    assert summary["certificate"]["dissipation"] == 0


@pytest.mark.parametrize("slope", [1e6, 1e8, 1e10, 1e12])
def test_slopes_of_augmentation_do_not_matter(tmp_path, slope):
    _, _, exact = run(tmp_path, Scene(nlgeom=True, round=True).text())
    behavior = ("*SURFACE BEHAVIOR, AUGMENTED LAGRANGE, PRESSURE-OVERCLOSURE=LINEAR\n"
                f"{slope!r},")
    done, _, rows = run(tmp_path, Scene(nlgeom=True, round=True, behavior=behavior).text())
    assert done.returncode == 0, done.stderr
    assert forces(rows[-1]) == pytest.approx(forces(exact[-1]), rel=1e-5)


@pytest.mark.parametrize("nlgeom", [False, True])
def test_a_scene_that_is_unloaded_to_nothing_passes(tmp_path, nlgeom):
    step = "*STEP, INC=100" + (", NLGEOM" if nlgeom else "")
    extra = "\n".join([step, "*STATIC", "0.25, 1.", "*CLOAD, OP=NEW", "P, 2, -1e-12", "*END STEP"])
    done, summary, rows = run(tmp_path, Scene(nlgeom=nlgeom, mu=0.0, extra=extra).text())
    assert done.returncode == 0, done.stderr
    assert summary["certificate"]["verdict"] == "PASS"
    assert abs(rows[-1]["TOP-TOOL.force2"]) < 1e-9


@pytest.mark.parametrize("nlgeom", [False, True])
@pytest.mark.parametrize("slope", [2.0, 20.0])
def test_a_soft_slope_of_the_deck_is_obeyed_and_warned_of(tmp_path, nlgeom, slope):
    behavior = f"*SURFACE BEHAVIOR, PENALTY\n{slope!r},"
    done, summary, rows = run(tmp_path, Scene(nlgeom=nlgeom, behavior=behavior, mu=0.0).text())
    assert done.returncode == 0, done.stderr
    assert rows[-1]["TOP-TOOL.max_penetration"] == pytest.approx(0.5/slope, rel=0.1)
    if slope < 5:
        assert summary["certificate"]["verdict"] == "WARN"
        assert "penetration beside the body" in summary["certificate"]["reason"]


@pytest.mark.parametrize("nlgeom", [False, True])
def test_the_verdict_of_a_run_is_that_of_its_worst_increment(tmp_path, nlgeom):
    behavior = "*SURFACE BEHAVIOR, PENALTY\n2.,"
    step = "*STEP, INC=100" + (", NLGEOM" if nlgeom else "")
    extra = "\n".join([step, "*STATIC", "*BOUNDARY", "P, 2, 2, 1.", "*CLOAD, OP=NEW",
                       "*END STEP"])
    scene = Scene(nlgeom=nlgeom, behavior=behavior, mu=0.0, extra=extra)
    done, summary, rows = run(tmp_path, scene.text())
    assert done.returncode == 0, done.stderr
    assert rows[-1]["certificate"] == 0 and summary["certificate"]["verdict"] == "WARN"
    warned = [row for row in rows if row["certificate"] > 0]
    assert summary["certificate"]["increments_warned"] == len(warned)
    # The one furthest beyond its limits, which need not be the last.
    assert summary["certificate"]["step"] in {row["step"] for row in warned}
    assert "certificate: WARN" in done.stdout
    assert re.search(r"^\d+ warnings? \(lopin explain CODE\): W", done.stdout, re.M)


def heated(nlgeom, held, increment):
    """A cube of plane strain, heated by 400 and cooled; held in its plane or free."""
    support = "*BOUNDARY\nL, 1\nB, 2\n" + ("R, 1\n" if held else "")
    step = "*STEP, INC=1000" + (", NLGEOM" if nlgeom else "")
    return (f"*NODE, NSET=ALL\n1, 0., 0.\n2, 1., 0.\n3, 1., 1.\n4, 0., 1.\n*ELEMENT, TYPE=CPE4, "
            "ELSET=B\n1, 1, 2, 3, 4\n*NSET, NSET=L\n1, 4\n*NSET, NSET=R\n2, 3\n*NSET, NSET=B\n1, 2\n"
            "*MATERIAL, NAME=M\n*ELASTIC\n2e5, 0.3\n*PLASTIC\n200., 0.\n400., 1.\n*EXPANSION\n"
            f"{'1.2e-5' if held else '2e-6'},\n*SOLID SECTION, ELSET=B, MATERIAL=M\n1.,\n"
            "*AMPLITUDE, NAME=UD\n0., 0., 0.5, 1., "
            f"1., 0.\n{support}{step}\n*STATIC, DIRECT\n{increment}, 1.\n*TEMPERATURE, "
            "AMPLITUDE=UD\nALL, 400.\n*END STEP\n")


@pytest.mark.parametrize("nlgeom", [False, True])
@pytest.mark.parametrize("held", [False, True])
@pytest.mark.parametrize("increment", [0.01, 0.05, 0.25])
def test_heat_does_work(tmp_path, nlgeom, held, increment):
    done, summary, rows = run(tmp_path, heated(nlgeom, held, increment))
    assert done.returncode == 0, done.stderr
    assert "W0530" not in done.stderr
    energy = summary["energy"]
    assert energy["lost"] == pytest.approx(energy["external"] + energy["thermal"] - energy["strain"]
                                           - energy["plastic"], abs=1e-9)
    most = max(abs(row["energy.thermal"]) for row in rows)
    assert most > 0
    if increment < 0.02:
        assert abs(energy["lost"]) < 0.01*most
