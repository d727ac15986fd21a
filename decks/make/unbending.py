"""The deck of a strip bent to and fro and let go: `python decks/make/unbending.py > deck.inp`."""
from __future__ import annotations

from lopin.closed_form import StraightStrip

YOUNG, YIELD, TANGENT, BENT, LENGTH, LAYERS = 2e5, 200.0, 1e4, 0.01, 2.0, 8


def unbending() -> str:
    """Bent to a curvature, to the opposite one, let go; kinematic hardening along a line."""
    strip = StraightStrip(YOUNG, YIELD, TANGENT, 1.0)
    first, second = strip.moment(BENT), strip.back(BENT, 2.0*BENT)
    left = -BENT - 12.0*second/YOUNG
    n, hard = LAYERS + 1, TANGENT/(1.0 - TANGENT/YOUNG)
    lines = f"""\
** A strip bent, bent the other way and let go: springback with Bauschinger's effect (Yoshida's test).
**
**    |=====/   -> 1/100,  -> -1/100,  -> no moment      2 mm of a strip 1 mm thick, plane stress
**
** E = 200 GPa, 200 MPa, then a tangent of 10 GPa, kinematic: fibres are bilinear and flow again after
** twice the yield stress, so that moments are closed forms (lopin.closed_form.StraightStrip): {first:.4f} N at
** 1/100, and at -1/100, by Masing's rule, as much the other way; let go, it keeps {left:.7f}/mm. A straight
** face turns with the end and leaves it free to thin.
**
** expect: certificate.verdict = PASS
** expect: history.GRIP.rf6 at 1 = {first:.4f} +- 0.3 %
** expect: history.GRIP.rf6 at 2 = {second:.4f} +- 0.3 %
** expect: history.GRIP.u6 at 3 = {left*LENGTH:.7f} +- 0.6 %
*HEADING
bending and unbending, N mm
*NODE, NSET=ALL
""".splitlines()
    lines += [f"{1 + i*n + j}, {LENGTH*i/2!r}, {j/LAYERS - 0.5!r}"
              for i in range(3) for j in range(n)]
    lines.append("*ELEMENT, TYPE=CPS4I, ELSET=STRIP")
    lines += [f"{1 + i*LAYERS + j}, {1 + i*n + j}, {1 + (i + 1)*n + j}, {2 + (i + 1)*n + j}, "
              f"{2 + i*n + j}" for i in range(2) for j in range(LAYERS)]
    held = ["LEFT, 1", f"{1 + LAYERS//2}, 2", "GRIP_REF, 2"]
    lines += ["*NSET, NSET=LEFT", ", ".join(str(1 + j) for j in range(n)),
              "*SURFACE, NAME=END", *(f"{1 + LAYERS + j}, S2" for j in range(LAYERS)),
              "*NODE, NSET=GRIP_REF", f"9001, {LENGTH}, 0.",
              "*SURFACE, NAME=GRIP, TYPE=SEGMENTS", f"START, {LENGTH}, -3.", f"LINE, {LENGTH}, 3.",
              "*RIGID BODY, ANALYTICAL SURFACE=GRIP, REF NODE=GRIP_REF",
              "*SURFACE INTERACTION, NAME=SLIDE", "*SURFACE BEHAVIOR, DIRECT, NO SEPARATION",
              "*CONTACT PAIR, INTERACTION=SLIDE", "END, GRIP", "*MATERIAL, NAME=STEEL", "*ELASTIC",
              f"{YOUNG:g}, 0.3", "*PLASTIC, HARDENING=KINEMATIC", f"{YIELD:g}, 0.",
              f"{YIELD + hard!r}, 1.", "*SOLID SECTION, ELSET=STRIP, MATERIAL=STEEL",
              "*BOUNDARY", *held]
    for name, curvature in (("BEND", BENT), ("UNBEND", -BENT)):
        lines += [f"*STEP, NAME={name}, NLGEOM, INC=500", "*STATIC", "0.05, 1., 1E-6, 0.1",
                  "*BOUNDARY", f"GRIP_REF, 6, 6, {LENGTH*curvature!r}", *PRINTED, "*END STEP"]
    lines += ["*STEP, NAME=LET_GO, NLGEOM", "*STATIC", "0.1, 1.", "*BOUNDARY, OP=NEW", *held,
              *PRINTED, "*END STEP", ""]
    return "\n".join(lines)


PRINTED = ["*NODE FILE", "U", "*EL FILE", "S, PEEQ"]

if __name__ == "__main__":
    print(unbending(), end="")
