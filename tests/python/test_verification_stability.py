"""Where methods lose digits, and where they keep them: a chain of twenty unit springs and a
wall."""
import numpy as np
import pytest

from lopin import mesh_make, profile
from lopin.laws import Elastic, Lagrange, Penalty, Perturbed
from lopin.model import Model

N, FORCE, GAP = 20, 2.0, 1.0/3.0
EXACT = FORCE - GAP/N


def chain(method, unit=1.0, length=1.0):
    """Springs of stiffness `unit`; the far end is pulled by two of its forces towards a wall."""
    mesh = mesh_make.block((N*length, length), (N, 1))
    model = Model("chain", mesh, kind="plane stress")
    model.section("ALL", Elastic(unit, 0.0), length)
    end = (N + GAP)*length
    wall = model.rigid_tool("WALL", profile.line((end, -2.0*length), (end, 3.0*length)))
    model.contact("RIGHT", wall, method)
    model.fix("LEFT", "x")
    model.fix("TOP", "y")
    model.fix("BOTTOM", "y")
    model.step().force("RIGHT", each=True, x=0.5*FORCE*unit*length**2)
    return model


def test_penalty_gains_then_loses_a_digit_per_decade(solve, sheet):
    alpha = 10.0**np.arange(1, 17)
    error = np.array([abs(-solve(chain(Penalty(a))).history["WALL.rf1"][0]/EXACT - 1.0)
                      for a in alpha])
    for a, e in zip(alpha, error):
        print(f"penalty {a:.0e} error {e:.2e}")
    rising, falling = alpha >= 1e10, alpha <= 1e6

    def slope(part):
        return np.polyfit(np.log10(alpha[part]), np.log10(error[part]), 1)[0]

    case = "F1 digits of the penalty method"
    sheet.compare(case, "slope of the model error", slope(falling), -1.0, 0.02,
                  "k/alpha", absolute=True)
    sheet.compare(case, "slope of the round-off", slope(rising), 1.0, 0.3,
                  "epsilon alpha/k", absolute=True)
    sheet.compare(case, "log10 of the best alpha/k", np.log10(alpha[error.argmin()]), 8.0, 1.0,
                  "expected near 1e8", absolute=True)
    sheet.compare(case, "least error", error.min(), 0.0, 1e-7, "expected ~1e-8", absolute=True)


def test_perturbed_lagrange_keeps_the_digits(solve, sheet):
    case = "F3 perturbed Lagrangian"
    lagrange = -solve(chain(Lagrange())).history["WALL.rf1"][0]
    sheet.compare(case, "Lagrange: reaction", lagrange, EXACT, 1e-13)
    for alpha in (1e-2, 1.0, 1e4, 1e8):
        force = -solve(chain(Perturbed(alpha)), refused=True).history["WALL.rf1"][0]
        sheet.compare(case, f"perturbed, {alpha:.0e}: reaction", force,
                      EXACT*alpha/(1.0/N + alpha), 1e-12)
    stiff = -solve(chain(Perturbed(1e12))).history["WALL.rf1"][0]
    sheet.compare(case, "perturbed, 1e12: against Lagrange", stiff, lagrange, 1e-11)
    lost = abs(-solve(chain(Penalty(1e12))).history["WALL.rf1"][0]/lagrange - 1.0)
    sheet.compare(case, "penalty, 1e12: log10 of the error", np.log10(lost), -5.0, 1.0,
                  "expected 1e-6 to 1e-4", absolute=True)


@pytest.mark.parametrize("unit", [1e-9, 1e9])
@pytest.mark.parametrize("length", [1e-3, 1e3])
@pytest.mark.parametrize("slope", [None, 10.0])
def test_units_change_nothing(solve, sheet, unit, length, slope):
    def run(unit, length):
        method = Lagrange() if slope is None else Penalty(slope*unit/length)
        h = solve(chain(method, unit, length)).history
        return h["WALL.rf1"][0]/(unit*length**2), h["iterations"][0]

    (force, passes), (scaled, other) = run(1.0, 1.0), run(unit, length)
    name = "Lagrange" if slope is None else "penalty"
    sheet.compare("F18 units", f"{name}, E x {unit:.0e}, length x {length:.0e}: force", scaled,
                  force, 1e-10, "the same scene in other units")
    assert passes == other


@pytest.mark.parametrize("slope", [1e2, 1e6, 1e10, 1e12, 1e14, 1e16])
def test_the_certificate_knows_the_error_of_a_penalty(solve, sheet, slope):
    """Model error of a soft penalty or rounding of a stiff one: the larger of both is reported.

    It is that of the pressures at the nodes; in the reaction those of rounding may cancel."""
    result = solve(chain(Penalty(slope)), refused=True)
    force = -result.contact(0).last.force[:, 0]
    error = abs(force/(EXACT/len(force)) - 1.0).max()
    sheet.compare("F1 digits of the penalty method",
                  f"penalty {slope:.0e}: log2 of the reported over the true error",
                  np.log2(result.summary["certificate"]["pressure_error"]/error), 0.0, 1.0,
                  "an estimate, to a factor of two", absolute=True)
    assert (result.summary["certificate"]["verdict"] == "PASS") == (error < 0.02)
