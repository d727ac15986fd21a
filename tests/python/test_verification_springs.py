"""Bars and springs solved by hand: every method, its limits, and unloading."""
import re

import numpy as np
import pytest

K, GAP, FORCE = 21000.0, 0.1, 10000.0
DIRECT = "*SURFACE BEHAVIOR, DIRECT"


@pytest.fixture
def bar(root):
    """The deck of the bar with another method, slope, force."""
    from lopin import Deck
    text = (root/"decks"/"bar_gap.inp").read_text(encoding="utf-8")

    def make(method="DIRECT", ratio=None, force=FORCE, augmentations=None, name="bar"):
        behavior = f"*SURFACE BEHAVIOR, {method}"
        if ratio is not None:
            behavior += f"\n{ratio*K/100.0!r}"          # the wall touches an area of 100
        controls = ""
        if augmentations is not None:
            controls = f"*CONTACT CONTROLS, MAX AUGMENTATIONS={augmentations}, " \
                "RELATIVE PENETRATION TOLERANCE=0\n"
        new = text.replace(DIRECT, behavior).replace("*BOUNDARY", controls + "*BOUNDARY", 1)
        new = new.replace("TIP, 1, 5000.", f"TIP, 1, {force/2.0!r}")
        return Deck.parse(new, name=name)

    return make


def tip(history, k=K):
    """Tip displacement from the strain energy k u^2/2."""
    return np.sqrt(2.0*history["energy.strain"]/k)


def test_the_bar_stops_at_the_wall(bar, solve, sheet):
    h = solve(bar()).history
    sheet.compare("A1 bar and gap", "Lagrange: tip", tip(h)[0], GAP, 1e-10)
    sheet.compare("A1 bar and gap", "Lagrange: reaction", -h["FACE.rf1"][0], 7900.0, 1e-10)
    sheet.compare("A1 bar and gap", "Lagrange: penetration", h["END-FACE.max_penetration"][0], 0.0,
                  1e-10*GAP, absolute=True)
    assert h["FACE.rf1"][1] == 0.0 and tip(h)[1] == 0.0 and h["END-FACE.closed"][1] == 0


@pytest.mark.parametrize("method", ["PENALTY", "PERTURBED LAGRANGE"])
@pytest.mark.parametrize("ratio", [10.0, 100.0])
def test_soft_methods_penetrate_by_their_formula(bar, solve, sheet, method, ratio):
    h = solve(bar(method, ratio)).history
    depth = (FORCE - K*GAP)/(K + ratio*K)
    case, start = "A1 bar and gap", f"{method.lower()}, {ratio:g} k: "
    sheet.compare(case, start + "reaction", -h["FACE.rf1"][0], ratio*K*depth, 1e-10)
    sheet.compare(case, start + "penetration", h["END-FACE.max_penetration"][0], depth, 1e-10)
    sheet.compare(case, start + "tip", tip(h)[0], GAP + depth, 1e-10)
    assert h["FACE.rf1"][1] == 0.0


@pytest.mark.parametrize(("ratio", "passes"), [(10.0, 10), (1.0, 34)])
def test_augmentations_contract_by_k_over_k_plus_alpha(bar, solve, sheet, ratio, passes):
    result = solve(bar("AUGMENTED LAGRANGE", ratio, augmentations=100))
    h = result.history
    case, start = "A1 bar and gap", f"augmented, {ratio:g} k: "
    sheet.compare(case, start + "reaction", -h["FACE.rf1"][0], 7900.0, 1e-10)
    # The forces have converged to 1e-10 F: the tip has to 1e-10 F/k.
    sheet.compare(case, start + "tip", tip(h)[0], GAP, 1e-10*FORCE/K, absolute=True)
    sheet.compare(case, start + "augmentations", h["augmentations"][0], passes, 1.0,
                  "ln(1e-10)/ln(k/(k + a)), +-1", absolute=True)
    assert h["FACE.rf1"][1] == 0.0


@pytest.mark.parametrize("method", ["DIRECT", "PENALTY", "PERTURBED LAGRANGE",
                                    "AUGMENTED LAGRANGE"])
def test_too_small_a_force_does_not_reach_the_wall(bar, solve, sheet, method):
    ratio = None if method == "DIRECT" else 10.0
    h = solve(bar(method, ratio, force=2000.0)).history
    sheet.compare("A1 bar and gap", f"{method.lower()}: tip under 2000 N", tip(h)[0], 2000.0/K,
                  1e-10)
    assert h["FACE.rf1"][0] == 0.0 and h["END-FACE.closed"][0] == 0


@pytest.mark.parametrize("method", ["DIRECT", "PENALTY", "PERTURBED LAGRANGE",
                                    "AUGMENTED LAGRANGE"])
def test_grazing_has_no_force_and_no_cycle(bar, solve, sheet, method):
    ratio = None if method == "DIRECT" else 10.0
    h = solve(bar(method, ratio, force=K*GAP)).history
    sheet.compare("A1 bar and gap", f"{method.lower()}: reaction under F = k gap, over F",
                  h["FACE.rf1"][0]/(K*GAP), 0.0, 1e-10, absolute=True)
    sheet.compare("A1 bar and gap", f"{method.lower()}: tip under F = k gap", tip(h)[0], GAP, 1e-10)
    assert h["iterations"][0] <= 2


@pytest.fixture
def two_springs(root):
    """The deck of the two springs with another method and slave."""
    from lopin import Deck
    text = (root/"decks"/"two_springs.inp").read_text(encoding="utf-8")

    def make(method, slave):
        master = {"LEFT_END": "RIGHT_END", "RIGHT_END": "LEFT_END"}[slave]
        return Deck.parse(text.replace(DIRECT, f"*SURFACE BEHAVIOR, {method}").replace(
            "\nLEFT_END, RIGHT_END", f"\n{slave}, {master}"), name="springs")

    return make


@pytest.mark.parametrize(("method", "alpha"), [
    ("DIRECT", None), ("PENALTY", 1e4), ("PERTURBED LAGRANGE", 1e4), ("AUGMENTED LAGRANGE", 1e4)])
def test_two_springs_push_each_other(two_springs, solve, sheet, method, alpha):
    words = method if alpha is None else f"{method}\n{alpha!r}"
    first, second = (solve(two_springs(words, slave)).history
                     for slave in ("LEFT_END", "RIGHT_END"))
    # 1000 u1 = 800 - R, 500 u2 = R, R = alpha (u1 - u2 - 0.2)
    soft = alpha is not None and "AUGMENTED" not in method
    compliance = 1.0/1000.0 + 1.0/500.0 + (1.0/alpha if soft else 0.0)
    reaction = (800.0/1000.0 - 0.2)/compliance
    size = np.linalg.norm
    for slave, h in (("left", first), ("right", second)):
        pair = next(k for k in h if k.endswith(".force1")).rpartition(".")[0]
        sheet.compare("A2 two springs", f"{method.lower()}, {slave} slave: force",
                      size(h[f"{pair}.force1"][0]), reaction, 1e-10)
        u1, u2 = (800.0 - reaction)/1000.0, reaction/500.0
        sheet.compare("A2 two springs", f"{method.lower()}, {slave} slave: strain energy",
                      h["energy.strain"][0], 500.0*u1**2 + 250.0*u2**2, 1e-10)
        # The force is the one on the slave: it pushes the left spring back, the right one forth.
        assert np.sign(h[f"{pair}.force1"][0]) == (-1.0 if slave == "left" else 1.0)
    values = [[h[k][0] for k in h if re.search(r"energy|max_pressure|max_penetration|area", k)]
              for h in (first, second)]
    assert values[0] == values[1], "master and slave change the bits"
