"""Springback after bending and unbending (Yoshida), isotropic and combined hardening, against the
moment of fibres that are integrated one by one."""
import numpy as np
import pytest

import lopin
from lopin.closed_form.sheet import StraightStrip, bent_fibres

YOUNG, POISSON, LENGTH = 210e3, 0.3, 2.0
#: Cards of a flow curve; flow stress and slope at plastic strains; pairs of a backstress.
METALS = {
    "isotropic": (["*PLASTIC, HARDENING=VOCE", "400., 250., 20., 100."],
                  lambda e: (400.0 - 150.0*np.exp(-20.0*e) + 100.0*e,
                             3000.0*np.exp(-20.0*e) + 100.0), ()),
    "combined": (["*PLASTIC, HARDENING=COMBINED, DATA TYPE=PARAMETERS, NUMBER BACKSTRESSES=2",
                  "200., 20000., 150., 900., 4.", "*CYCLIC HARDENING, PARAMETERS",
                  "200., 80., 5."],
                 lambda e: (200.0 + 80.0*(1.0 - np.exp(-5.0*e)), 400.0*np.exp(-5.0*e)),
                 ((20000.0, 150.0), (900.0, 4.0))),
}
PATHS = {"unbent": (1/20, 0.0), "bent twice": (1/20, 0.0, 1/20), "reversed": (1/30, -1/30)}


def strip(card: list[str], path, layers: int) -> str:
    """Two columns of a strip 1 thick; a face turns to each curvature, then lets go."""
    n = layers + 1
    lines = ["*NODE, NSET=ALL"]
    lines += [f"{1 + i*n + j}, {LENGTH*i/2!r}, {j/layers - 0.5!r}"
              for i in range(3) for j in range(n)]
    lines.append("*ELEMENT, TYPE=CPE4I, ELSET=STRIP")
    lines += [f"{1 + i*layers + j}, {1 + i*n + j}, {1 + (i + 1)*n + j}, {2 + (i + 1)*n + j}, "
              f"{2 + i*n + j}" for i in range(2) for j in range(layers)]
    lines += ["*NSET, NSET=LEFT", *(str(1 + j) for j in range(n)), "*SURFACE, NAME=END",
              *(f"{1 + layers + j}, S2" for j in range(layers))]
    held = ["LEFT, 1", f"{1 + layers//2}, 2", "9001, 2"]
    steps = []
    for curvature in path:
        steps += ["*STEP, NLGEOM, INC=500", "*STATIC", "0.02, 1., 1E-6, 0.05", "*BOUNDARY",
                  f"9001, 6, 6, {LENGTH*curvature!r}", "*END STEP"]
    return "\n".join([
        *lines, "*NODE", f"9001, {LENGTH}, 0.", "*SURFACE, NAME=GRIP, TYPE=SEGMENTS",
        f"START, {LENGTH}, -3.", f"LINE, {LENGTH}, 3.",
        "*RIGID BODY, ANALYTICAL SURFACE=GRIP, REF NODE=9001", "*SURFACE INTERACTION, NAME=SLIDE",
        "*SURFACE BEHAVIOR, DIRECT, NO SEPARATION", "*CONTACT PAIR, INTERACTION=SLIDE", "END, GRIP",
        "*MATERIAL, NAME=STEEL", "*ELASTIC", f"{YOUNG}, {POISSON}", *card,
        "*SOLID SECTION, ELSET=STRIP, MATERIAL=STEEL", "*BOUNDARY", *held, *steps,
        "*STEP, NLGEOM", "*STATIC", "0.1, 1.", "*BOUNDARY, OP=NEW", *held, "*END STEP", ""])


@pytest.mark.parametrize("metal, way, layers, tolerance", [
    (metal, way, layers, 1e-2) for m, metal in enumerate(METALS) for w, way in enumerate(PATHS)
    for layers in (8, 1) if layers == 8 or (m + w) % 2 == 0])
def test_moments_and_the_curvature_left(solve, sheet, metal, way, layers, tolerance):
    """Moments by the largest; the curvature that is left by that which the release takes back."""
    card, flow, back = METALS[metal]
    path = PATHS[way]
    exact = bent_fibres(YOUNG, POISSON, 1.0, path, flow, back)
    result = solve(lopin.Deck.parse(strip(card, path, layers), "strip"))
    time, turn = result.history["time"], result.history["GRIP.rf6"]
    moments = [turn[time <= 1.0 + k + 1e-9][-1] for k in range(len(path))]
    left = result.history["GRIP.u6"][-1]/LENGTH
    scene = f"Yoshida: {metal}, {way}, {layers} layer" + "s"*(layers > 1)
    largest = max(map(abs, exact.moments))
    for k, (found, wanted) in enumerate(zip(moments, exact.moments)):
        assert found == pytest.approx(wanted, abs=tolerance*largest), k
    back_by = path[-1] - exact.curvature
    sheet.compare(scene, "curvature that the release takes back", path[-1] - left, back_by,
                  tolerance, "fibres integrated one by one")


def test_fibres_agree_with_hill():
    """Without hardening, monotonic, the moment and the radius of Hill (1950)."""
    sheet = lopin.closed_form.bent_sheet(YOUNG, POISSON, 300.0, 1.0, 20.0)
    fibres = bent_fibres(YOUNG, POISSON, 1.0, [1/20], lambda e: (300.0 + 0.0*e, 0.0*e))
    assert fibres.moments[0] == pytest.approx(sheet.moment, rel=1e-3)
    assert 1.0/fibres.curvature == pytest.approx(sheet.radius, rel=1e-3)
    assert fibres.flowed == 0.0


def straight(share: float) -> list[str]:
    """200 MPa and a tangent of 10 GPa in tension; `share` of the hardening is isotropic."""
    hard = 1e4/(1.0 - 1e4/YOUNG)
    if share == 1.0:
        return ["*PLASTIC, HARDENING=LINEAR", f"200., {hard!r}"]
    if share == 0.0:
        return ["*PLASTIC, HARDENING=KINEMATIC", "200., 0.", f"{200.0 + hard!r}, 1."]
    return ["*PLASTIC, HARDENING=COMBINED, DATA TYPE=PARAMETERS, NUMBER BACKSTRESSES=1",
            f"200., {(1.0 - share)*hard!r}, 0.", "*CYCLIC HARDENING", "200., 0.",
            f"{200.0 + share*hard!r}, 1."]


@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("word, poisson, tolerance", [("CPS4I", 0.3, 3e-3),
                                                      ("CPE4I", 0.4999, 6e-3)])
def test_straight_hardening_beside_its_closed_form(solve, sheet, share, word, poisson, tolerance):
    """Bent, bent back the other way, let go: plane stress, and plane strain without compression."""
    across = 1.0 if word == "CPS4I" else 1.0/(1.0 - poisson**2)
    yielding = 200.0*(1.0 if word == "CPS4I" else 2.0/3.0**0.5)
    tangent = 1e4*(1.0 if word == "CPS4I" else 4.0/3.0)
    exact = StraightStrip(YOUNG*across, yielding, tangent, 1.0, share)
    bent = 0.01
    text = strip(straight(share), (bent, -bent), 8).replace("CPE4I", word).replace(
        f"{YOUNG}, {POISSON}", f"{YOUNG}, {poisson}")
    result = solve(lopin.Deck.parse(text, "strip"))
    time, turn = result.history["time"], result.history["GRIP.rf6"]
    found = [turn[time <= k + 1.0 + 1e-9][-1] for k in range(2)]
    wanted = [exact.moment(bent), exact.back(bent, 2.0*bent)]
    scene = f"Yoshida, straight hardening, isotropic share {share}: {word}"
    for k, what in enumerate(("moment, bent", "moment, bent the other way")):
        sheet.compare(scene, what, found[k], wanted[k], tolerance, "closed form")
    back = -bent - wanted[1]*12.0/(YOUNG*across)     # elastic: no fibre flows again
    sheet.compare(scene, "curvature after release", result.history["GRIP.u6"][-1]/LENGTH, back,
                  2.0*tolerance, "closed form")
