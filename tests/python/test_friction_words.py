"""The words of *FRICTION and its kin: what is accepted, what is said about it."""
import subprocess
from pathlib import Path

import pytest

BASE = (Path(__file__).resolve().parents[2] / "decks" / "bad" / "friction_negative.inp").read_text(encoding="utf-8")
PLASTIC = "*PLASTIC\n200., 0.\n"
HARDENING = "*PLASTIC\n200., 0.\n300., 0.5\n"


@pytest.fixture
def check(executable, tmp_path):
    def run(friction, plastic="", static="0.1, 1.", step=""):
        text = BASE.replace("*FRICTION\n-0.1\n", friction).replace("*SOLID SECTION, ELSET=UP",
                                                                   plastic
                                                                   + "*SOLID SECTION, ELSET=UP")
        text = text.replace("*STATIC\n0.1, 1.\n", f"*STATIC\n{static}\n" + step)
        (tmp_path / "deck.inp").write_text(text)
        return subprocess.run([executable, "check", "deck.inp"], capture_output=True, text=True,
                              timeout=20, cwd=tmp_path)

    return run


# Card, *PLASTIC, what must be said: nothing, or a code and a text.
CARDS = [
    ("*FRICTION\n0.3\n", "", None),
    ("*FRICTION\n0.\n", "", None),
    ("*FRICTION, LAW=COULOMB, LAGRANGE\n0.3\n", "", None),
    ("*FRICTION, REGULARIZATION=NONE\n0.3\n", "", None),
    ("*FRICTION, SLIP TOLERANCE=0.01\n0.3\n", "", None),
    ("*FRICTION, ROUGH\n", "", None),
    ("*FRICTION, TAUMAX=50.\n0.3\n", "", None),
    ("*FRICTION, EXPONENTIAL DECAY\n0.3, 0.1, 2.\n", "", None),
    ("*FRICTION, LAW=TRESCA\n0.4\n", PLASTIC, None),
    ("*FRICTION, LAW=TRESCA, TAUMAX=50.\n", "", None),
    ("*FRICTION, LAW=TRESCA, TAUMAX=50.\n0.4\n", PLASTIC, None),
    ("*FRICTION, LAW=TRESCA, EQUIVALENT=MISES\n0.4\n", "", None),
    ("*friction, law=coulomb-orowan\n0.1, 0.4\n", PLASTIC, None),
    ("*FRICTION, LAW=COULOMB-OROWAN, TAUMAX=50.\n0.1\n", "", None),
    ("*FRICTION, LAW=CRISTESCU\n0.4\n", "", None),
    ("*FRICTION, LAW=CRISTESCU\n0.4\n", HARDENING, None),
    ("*FRICTION, LAW=NORTON-HOFF\n5., 0.2\n", "", None),
    ("*FRICTION, LAW=NORTON-HOFF\n5., 0.\n", "", None),
    ("*FRICTION, LAW=NORTON-HOFF, REGULARIZATION=SQRT, V0=1.E-3\n5., 0.2\n", "", None),
    ("*FRICTION, REGULARIZATION=ARCTAN, ELASTIC SLIP=1.E-3\n0.3\n", "", None),
    ("*FRICTION, REGULARIZATION=TANH, V0=1.E-3\n0.3\n", "", None),
    ("*FRICTION, LAW=CRITESCU\n0.4\n", "", "note[N0105]: `CRITESCU` is read as CRISTESCU"),
    ("*FRICTION, LAW=OROWAN\n0.1, 0.4\n", PLASTIC, "is read as COULOMB-OROWAN"),
    ("*FRICTION\n1.2\n", "", "warning[W0321]: a friction coefficient of 1.2 is above 1"),
    ("*FRICTION\n0.3, 1.E4\n", "", "the second datum 10000 is read as CalculiX' stick slope"),
    ("*FRICTION\n0.3, 0., 0., 20.\n", "", "read as Abaqus' mu at one slip rate"),
    ("*FRICTION, LAW=AUTO\n0.1, 0.4\n", "", "is COULOMB: material `STEEL` is elastic"),
    ("*FRICTION, LAW=AUTO\n0.1, 0.4\n", PLASTIC,
     "is TRESCA: material `STEEL` is perfectly plastic"),
    ("*FRICTION, LAW=AUTO\n, 0.4\n", HARDENING,
     "is CRISTESCU: material `STEEL` is plastic with hardening"),
]


@pytest.mark.parametrize("card, plastic, said", CARDS, ids=[card.splitlines()[0] + f" {i}"
                                                            for i, (card, *_) in enumerate(CARDS)])
def test_words_that_are_accepted_and_what_is_said_of_them(check, card, plastic, said):
    run = check(card, plastic)
    assert run.returncode == 0, run.stderr
    if said is None:
        assert "[W03" not in run.stderr and "[N0306]" not in run.stderr, run.stderr
    else:
        assert said in run.stderr, run.stderr


@pytest.mark.parametrize("card", ["*FRICTION, LAW=NORTON-HOFF\n5., 0.2\n",
                                  "*FRICTION, EXPONENTIAL DECAY\n0.3, 0.1, 2.\n",
                                  "*FRICTION, REGULARIZATION=TANH, V0=1.E-3\n0.3\n"])
@pytest.mark.parametrize("static, warned", [("", True), ("0.1", True), ("0.1, 1.", False),
                                            (", 2.", False)])
def test_a_law_of_the_speed_asks_for_times(check, card, static, warned):
    run = check(card, static=static) if static else check(card, static="**")
    assert run.returncode == 0, run.stderr
    assert ("warning[W0322]" in run.stderr) == warned, run.stderr


# Each is refused with this code and text.
REFUSED = [
    ("*FRICTION, LAGRANGE, ELASTIC SLIP=1.\n0.1\n", "", "E0323", "exclude each other"),
    ("*FRICTION, ELASTIC SLIP=1., SLIP TOLERANCE=0.1\n0.1\n", "", "E0323", "exclude each other"),
    ("*FRICTION, REGULARIZATION=SQRT, ELASTIC SLIP=1., V0=1.\n0.1\n", "", "E0323",
     "exclude each other"),
    ("*FRICTION, REGULARIZATION=NONE, ELASTIC SLIP=1.\n0.1\n", "", "E0323", "exclude each other"),
    ("*FRICTION, V0=1.\n0.1\n", "", "E0323", "V0 is the speed of a regularisation"),
    ("*FRICTION, ELASTIC SLIP=0.\n0.1\n", "", "E0321", "is not positive"),
    ("*FRICTION, TAUMAX=-3.\n0.1\n", "", "E0321", "TAUMAX=-3. is not positive"),
    ("*FRICTION, LAW=NORTON-HOFF, REGULARIZATION=TANH, ELASTIC SLIP=1.\n5., 0.2\n", "", "E0323",
     "needs V0"),
    ("*FRICTION, LAW=NORTON-HOFF\n0., 0.2\n", "", "E0321", "alpha = 0"),
    ("*FRICTION, LAW=NORTON-HOFF\n5., -0.2\n", "", "E0321", "outside 0 to 1"),
    ("*FRICTION, LAW=TRESCA\n-0.2\n", PLASTIC, "E0321", "outside 0 to 1"),
    ("*FRICTION, LAW=TRESCA\n", PLASTIC, "E0103", "needs the data m"),
    ("*FRICTION, LAW=TRESCA, EXPONENTIAL DECAY\n0.2, 0.1, 3.\n", PLASTIC, "E0323",
     "needs LAW=COULOMB"),
    ("*FRICTION, EXPONENTIAL DECAY\n0.2, 0.1\n", "", "E0103", "mu static, mu kinetic, decay"),
    ("*FRICTION, EXPONENTIAL DECAY\n0.2, 0.1, -1.\n", "", "E0321", "a decay of -1 is negative"),
    ("*FRICTION\n0.2, -5.\n", "", "E0321", "a stick slope of -5 is negative"),
    ("*FRICTION\n0.1, 0.\n0.2, 1.\n", "", "E0323", "varies with slip rate"),
    ("*FRICTION, LAW=AUTO\n0.1\n", PLASTIC, "E0103", "LAW=AUTO chose TRESCA, which needs m"),
    ("*FRICTION, LAW=CRISTESCO2\n0.1\n", "", "E0106", "did you mean CRISTESCU ?"),
    ("*FRICTION, TEST DATA\n0.1\n", "", "E0108", "TEST DATA of *FRICTION"),
    ("*FRICTION, ROUGH, LAW=TRESCA\n", "", "E0323", "it takes no LAW"),
]


@pytest.mark.parametrize("card, plastic, code, said", REFUSED,
                         ids=[f"{row[0].splitlines()[0] if row[0] else ''} {i}"
                              for i, row in enumerate(REFUSED)])
def test_words_that_are_refused(check, card, plastic, code, said):
    run = check(card, plastic)
    assert run.returncode == 1, run.stderr
    assert f"error[{code}]" in run.stderr and said in run.stderr, run.stderr


def test_friction_and_pairs_may_change_in_a_step(check):
    step = "*CHANGE FRICTION, INTERACTION=GREASE\n*FRICTION, LAW=TRESCA\n0.3\n"
    assert check("*FRICTION\n0.1\n", PLASTIC, step=step).returncode == 0
    assert "E0322" in check("*FRICTION\n0.1\n", step=step).stderr
    assert "no surface interaction `OIL`" in check("", step="*CHANGE FRICTION, INTERACTION=OIL\n*FRICTION\n0.\n").stderr
    for word in ["ADD", "REMOVE"]:
        assert check("", step=f"*MODEL CHANGE, TYPE=CONTACT PAIR, {word}\nSLAVE, MASTER\n").returncode == 0
    assert "needs one of ADD and REMOVE" in check("", step="*MODEL CHANGE, TYPE=CONTACT PAIR\nSLAVE, MASTER\n").stderr
    assert "E0107" in check("", step="*FRICTION\n0.\n").stderr


def test_a_body_that_would_yield_is_named(executable, tmp_path):
    text = BASE.replace("*FRICTION\n-0.1\n", "*FRICTION, LAW=TRESCA\n0.4\n")
    text = text.replace("INTERACTION=GREASE\nSLAVE", "INTERACTION=GREASE, TIED\nSLAVE")
    for stress, warned in [(500.0, True), (1.0e4, False)]:
        plastic = f"*PLASTIC, ONLY=FRICTION\n{stress}, 0.\n"
        (tmp_path / "deck.inp").write_text(text.replace("*SOLID SECTION, ELSET=UP",
                                                        plastic + "*SOLID SECTION, ELSET=UP"))
        run = subprocess.run([executable, "run", "deck.inp", "-o", f"out{warned}"],
                             capture_output=True, text=True, timeout=20, cwd=tmp_path)
        assert run.returncode == 0, run.stderr
        assert ("warning[W0508]: material `STEEL` passes its yield stress" in run.stderr) == warned, run.stderr


@pytest.mark.parametrize("card", ["*FRICTION, LAW=CRISTESCU\n0.4\n", "*FRICTION\n0.1\n",
                                  "*FRICTION, EXPONENTIAL DECAY\n0.3, 0.1, 2.\n"])
def test_the_finite_path_reads_stress_and_speed(executable, tmp_path, card):
    text = BASE.replace("*FRICTION\n-0.1\n", card).replace("*STEP\n", "*STEP, NLGEOM\n")
    (tmp_path / "deck.inp").write_text(text)
    run = subprocess.run([executable, "run", "deck.inp", "-o", "out"], capture_output=True,
                         text=True, timeout=20, cwd=tmp_path)
    assert run.returncode == 0, run.stderr
