"""A slender strip laid down on a floor: the compliance of a beam, on which whole sets of wrong points never settle."""
import pytest

from lopin import Deck

YOUNG, HIGH, LONG, FREE, GAP = 210e3, 1.0, 100.0, 60.0, 0.5
LOAD = 72.0*YOUNG*HIGH**3/12.0*GAP/FREE**4


def strip(elements, behavior, friction, path):
    """Half of a strip clamped at its end; GAP = q l^4/(72 EI) leaves a length l that is free."""
    x = [LONG*i/elements for i in range(elements + 1)]
    lines = [f"*LOPIN, PATH={path}", "*NODE"]
    lines += [f"{3*i + j + 1}, {a}, {HIGH*j/2.0}" for i, a in enumerate(x) for j in range(3)]
    lines += ["*ELEMENT, TYPE=CPS4I, ELSET=STRIP"]
    lines += [f"{2*i + j + 1}, {3*i + j + 1}, {3*i + j + 4}, {3*i + j + 5}, {3*i + j + 2}"
              for i in range(elements) for j in range(2)]
    lines += ["*ELSET, ELSET=LOW, GENERATE", f"1, {2*elements - 1}, 2", "*ELSET, ELSET=TOP, GENERATE",
              f"2, {2*elements}, 2", "*SURFACE, NAME=LOW", "LOW, S1", "*SURFACE, NAME=TOP", "TOP, S3"]
    lines += ["*MATERIAL, NAME=STEEL", "*ELASTIC", f"{YOUNG}, 0", "*SOLID SECTION, ELSET=STRIP, MATERIAL=STEEL"]
    lines += ["*NODE, NSET=FLOOR_REF", "900001, 0, -5", "*SURFACE, NAME=FLOOR, TYPE=SEGMENTS",
              f"START, -10., {-GAP}", f"LINE, 200., {-GAP}",
              "*RIGID BODY, ANALYTICAL SURFACE=FLOOR, REF NODE=FLOOR_REF", "*SURFACE INTERACTION, NAME=TOUCH",
              f"*SURFACE BEHAVIOR, {behavior}", *(["*FRICTION", f"{friction}"] if friction else []),
              "*CONTACT PAIR, INTERACTION=TOUCH", "LOW, FLOOR"]
    lines += ["*BOUNDARY", "1, 1, 2", "2, 1, 2", "3, 1, 2", *[f"{3*elements + j}, 1" for j in (1, 2, 3)],
              "FLOOR_REF, 1, 2", "FLOOR_REF, 6", "*STEP", "*STATIC", "1., 1.", "*DSLOAD",
              f"TOP, P, {LOAD:.12g}", "*END STEP"]
    return "\n".join(lines) + "\n"


CASES = {"40 points": (40, "DIRECT", 0.0, "AUTO"), "160 points": (160, "DIRECT", 0.0, "AUTO"),
         "penalty": (80, "PENALTY", 0.0, "AUTO"), "augmented": (40, "AUGMENTED LAGRANGE", 0.0, "AUTO"),
         "the whole system": (80, "DIRECT", 0.0, "NEWTON"), "finite": (40, "DIRECT", 0.0, "FINITE"),
         "friction": (40, "DIRECT", 0.2, "AUTO"), "friction, 80 points": (80, "DIRECT", 0.2, "AUTO")}


@pytest.mark.parametrize("name", CASES)
def test_a_strip_lies_down_on_a_floor(solve, name):
    case = solve(Deck.parse(strip(*CASES[name]), name="strip"))
    # The floor bears what lies on it, and a third of what hangs.
    assert abs(case.history["FLOOR.rf2"][-1]) == pytest.approx(LOAD*(LONG - FREE + FREE/3.0), rel=2e-3)
