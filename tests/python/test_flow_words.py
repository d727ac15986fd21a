"""The words of flow, rates and heat: what is accepted, what is refused, what is said."""
import subprocess

import pytest

ELASTIC = "*ELASTIC\n200000., 0.3\n"
CURVE = ELASTIC + "*PLASTIC\n200., 0.\n300., 0.5\n"
BASE = """*NODE, NSET=ALL
1, 0., 0.
2, 1., 0.
3, 1., 1.
4, 0., 1.
*ELEMENT, TYPE={word}, ELSET=BODY
1, 1, 2, 3, 4
*MATERIAL, NAME=METAL
{cards}*SOLID SECTION, ELSET=BODY, MATERIAL=METAL
*BOUNDARY
1, 1, 2
2, 2
4, 1
*STEP, NLGEOM
*STATIC{static}
*BOUNDARY
3, 2, 2, {move}
4, 2, 2, {move}
{heat}*END STEP
"""


@pytest.fixture
def lopin(executable, tmp_path):
    def run(cards, task="check", word="CPE4", static="\n0.5, 1.", move=-0.1, heat=""):
        (tmp_path/"deck.inp").write_text(BASE.format(cards=cards, word=word, static=static,
                                                     move=move, heat=heat), encoding="utf-8")
        return subprocess.run([executable, task, "deck.inp"], capture_output=True, text=True,
                              timeout=20, cwd=tmp_path)

    run.executable = executable
    return run


ACCEPTED = {
    "table": "*PLASTIC\n200., 0.\n300., 0.5\n",
    "table at one temperature": "*PLASTIC\n200., 0., 20.\n300., 0.5, 20.\n",
    "linear": "*PLASTIC, HARDENING=LINEAR\n200., 100.\n",
    "perfect": "*PLASTIC, HARDENING=LINEAR\n200.\n",
    "swift": "*PLASTIC, HARDENING=SWIFT\n550., 0.01, 0.2\n",
    "voce": "*PLASTIC, HARDENING=VOCE\n400., 200., 5.\n",
    "hollomon": "*PLASTIC, HARDENING=HOLLOMON\n550., 0.22, 190.\n",
    "hollomon from the elastic line": "*PLASTIC, HARDENING=HOLLOMON\n550., 0.22\n",
    "power law": "*RATE DEPENDENT, TYPE=POWER LAW\n40., 5.\n*PLASTIC\n200., 0.\n",
    "temperatures": "*PLASTIC\n200., 0., 20.\n300., 0.5, 20.\n100., 0., 500.\n",
    "kinematic": "*PLASTIC, HARDENING=KINEMATIC\n200., 0.\n300., 0.5\n",
    "combined": "*PLASTIC, HARDENING=COMBINED, DATA TYPE=PARAMETERS\n200., 20000., 150., 900., 4.\n",
    "cyclic": "*PLASTIC, HARDENING=COMBINED, DATA TYPE=PARAMETERS\n200., 20000., 150.\n"
              "*CYCLIC HARDENING\n200., 0.\n250., 1.\n",
    "hill": "*PLASTIC\n200., 0.\n*POTENTIAL, TYPE=HILL\n1., 1.1, 0.9, 1., 1., 1.\n",
    "viscous": "*VISCOPLASTIC, LAW=NORTON-HOFF\n100., 0.2\n",
    "threshold": "*VISCOPLASTIC\n100., 0.2\n*PLASTIC, HARDENING=SWIFT\n550., 0.01, 0.2\n",
}


@pytest.mark.parametrize("name", ACCEPTED)
def test_laws_that_are_accepted(lopin, name):
    run = lopin(ELASTIC + ACCEPTED[name])
    assert run.returncode == 0 and "warning" not in run.stderr, run.stderr


def test_a_rigid_solid_needs_no_elasticity(lopin):
    run = lopin("*VISCOPLASTIC, RIGID\n100., 0.2\n", "run")
    assert run.returncode == 0 and "warning" not in run.stderr, run.stderr


REFUSED = {
    "first strain": ("*PLASTIC\n200., 0.1\n", "E0203", "the first plastic strain is 0.1, not 0"),
    "falling strain": ("*PLASTIC\n200., 0.\n300., 0.5\n320., 0.4\n", "E0203",
                       "plastic strain 0.4 does not increase"),
    "temperatures": ("*PLASTIC\n200., 0., 200.\n150., 0., 20.\n", "E0203",
                     "temperature 20 does not increase"),
    "too steep": ("*PLASTIC\n200., 0.\n100., 0.0004\n", "E0203", "falls faster"),
    "falling line": ("*PLASTIC, HARDENING=LINEAR\n200., -1.\n", "E0203", "ends at no stress"),
    "exponent": ("*PLASTIC, HARDENING=SWIFT\n500., 0.01, 1.2\n", "E0203",
                 "the exponent n = 1.2 is outside (0, 1]"),
    "missing": ("*PLASTIC, HARDENING=SWIFT\n500.\n", "E0103",
                "*PLASTIC needs K, e0, n on one line"),
    "two lines": ("*PLASTIC, HARDENING=LINEAR\n200., 1.\n300., 2.\n", "E0103",
                  "*PLASTIC has one line"),
    "kinematic": ("*PLASTIC, HARDENING=KINEMATIC\n200., 0.\n", "E0103", "is a straight line"),
    "kinematic, falling": ("*PLASTIC, HARDENING=KINEMATIC\n200., 0.\n150., 1.\n", "E0203",
                           "goes from a positive yield stress"),
    "kinematic of temperature": ("*PLASTIC, HARDENING=KINEMATIC\n200., 0., 20.\n250., 1., 20.\n",
                                 "E0108", "depends on temperature"),
    "half cycle": ("*PLASTIC, HARDENING=COMBINED\n200., 0.\n250., 1.\n", "E0108", "from a test"),
    "pairs": ("*PLASTIC, HARDENING=COMBINED, DATA TYPE=PARAMETERS\n200., 1000., 10., 50.\n", "E0108",
              "depends on temperature"),
    "backstresses": ("*PLASTIC, HARDENING=COMBINED, DATA TYPE=PARAMETERS, NUMBER BACKSTRESSES=3\n"
                     "200., 1000., 10.\n", "E0203", "needs 7 numbers, here are 3"),
    "cyclic alone": ("*PLASTIC\n200., 0.\n*CYCLIC HARDENING\n200., 0.\n", "E0203",
                     "belongs to *PLASTIC, HARDENING=COMBINED"),
    "surface of nothing": ("*POTENTIAL\n1., 1., 1., 1., 1., 1.\n", "E0203",
                           "shapes the yield surface of *PLASTIC"),
    "open surface": ("*PLASTIC\n200., 0.\n*POTENTIAL\n1., 1., 0.5, 1., 1., 1.\n", "E0203",
                     "close no surface"),
    "five ratios": ("*PLASTIC\n200., 0.\n*POTENTIAL\n1., 1., 0.9, 1., 1.\n", "E0103",
                    "*POTENTIAL needs R11, R22, R33, R12, R13, R23"),
    "barlat": ("*PLASTIC\n200., 0.\n*POTENTIAL, TYPE=BARLAT\n1.\n", "E0108", "BARLAT"),
    "rigid surface": ("*VISCOPLASTIC, RIGID\n100., 0.2\n*POTENTIAL\n1., 1., 1., 1., 1., 1.\n",
                      "E0108", "a rigid solid with a yield surface of its own"),
    "m": ("*VISCOPLASTIC\n100., 0.\n", "E0203", "the exponent m = 0 is outside (0, 1]"),
    "viscosity": ("*VISCOPLASTIC\n-100., 0.2\n", "E0203", "K = -100 is not positive"),
    "rate of nothing": ("*RATE DEPENDENT\n40., 5.\n", "E0203",
                        "multiplies a flow curve, which material `METAL` has not"),
    "twice": ("*PLASTIC\n200., 0.\n*PLASTIC\n200., 0.\n", "E0205", "second *PLASTIC"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_laws_that_are_refused(lopin, name):
    cards, code, text = REFUSED[name]
    run = lopin(ELASTIC + cards)
    assert run.returncode == 1 and f"error[{code}]" in run.stderr and text in run.stderr, run.stderr


def test_a_rigid_solid_in_plane_stress_is_refused(lopin):
    run = lopin("*VISCOPLASTIC, RIGID\n100., 0.2\n", word="CPS4")
    assert run.returncode == 1 and "error[E0108]" in run.stderr and "plane stress" in run.stderr, run.stderr


ORIENTED = ELASTIC + "*PLASTIC\n200., 0.\n*POTENTIAL\n1., 1., 0.9, 1., 1., 1.\n*ORIENTATION, NAME=O{kind}\n{lines}\n"


@pytest.mark.parametrize(("kind", "lines", "code", "text"), [
    ("", "1., 0., 0., 0., 1., 0.\n1, 30.", "E0203", "has no axis across their plane"),
    ("", "1., 0., 0., 2., 0., 0.", "E0405", "give no axes"),
    (", SYSTEM=CYLINDRICAL", "1., 0., 0., 0., 1., 0.", "E0108", "CYLINDRICAL"),
    ("X", "1., 0., 0., 0., 1., 0.", "E0201", "no orientation `O`"),
])
def test_axes_that_are_refused(lopin, tmp_path, kind, lines, code, text):
    run = lopin(ORIENTED.format(kind=kind, lines=lines) + "*MATERIAL, NAME=OTHER\n" + ELASTIC)
    assert run.returncode == 0 or code in run.stderr
    (tmp_path/"deck.inp").write_text((tmp_path/"deck.inp").read_text().replace(
        "MATERIAL=METAL", "MATERIAL=METAL, ORIENTATION=O"))
    run = subprocess.run([lopin.executable, "check", "deck.inp"], capture_output=True, text=True,
                         timeout=20, cwd=tmp_path)
    assert run.returncode == 1 and f"error[{code}" in run.stderr and text in run.stderr, run.stderr


def test_a_curve_that_falls_is_warned_of(lopin):
    run = lopin(ELASTIC + "*PLASTIC\n200., 0.\n300., 0.5\n250., 1.\n")
    assert run.returncode == 0 and "warning[W0324]" in run.stderr, run.stderr


@pytest.mark.parametrize("cards", ["*VISCOPLASTIC, RIGID\n100., 0.2\n",
                                   CURVE + "*RATE DEPENDENT\n40., 5.\n"])
@pytest.mark.parametrize(("static", "warned"), [("", True), ("\n0.5", True), ("\n0.5, 1.", False)])
def test_a_rate_asks_for_times(lopin, cards, static, warned):
    run = lopin(cards, static=static)
    assert run.returncode == 0 and ("warning[W0323]" in run.stderr) == warned, run.stderr


@pytest.mark.parametrize(("move", "warned"), [(-0.5, True), (-0.2, False)])
def test_strain_beyond_the_table_is_said_once(lopin, move, warned):
    run = lopin(CURVE, "run", move=move)
    assert run.returncode == 0 and run.stderr.count("warning[W0510]") == warned, run.stderr


def test_perfect_plasticity_has_no_end(lopin):
    run = lopin(ELASTIC + "*PLASTIC\n200., 0.\n", "run", move=-0.5)
    assert run.returncode == 0 and "W0510" not in run.stderr, run.stderr


def test_heat_and_expansion_that_do_not_meet_are_said(lopin):
    heat = "*TEMPERATURE\nALL, 100.\n"
    assert "warning[W0325]" in lopin(ELASTIC, heat=heat).stderr
    assert "note[N0325]" in lopin(ELASTIC + "*EXPANSION\n1e-5\n").stderr
    both = lopin(ELASTIC + "*EXPANSION\n1e-5\n", heat=heat)
    assert both.returncode == 0 and "0325" not in both.stderr, both.stderr
    rubber = lopin("*HYPERELASTIC, NEO HOOKE\n0.5, 0.04\n*EXPANSION\n1e-5\n", heat=heat)
    assert rubber.returncode == 1 and "error[E0205]" in rubber.stderr, rubber.stderr
