"""Decks of sheets: `python decks/make/sheets.py cup > decks/cup.inp`."""
from __future__ import annotations

import sys
from math import pi, sqrt

CUP = """\
** A cup drawn from a disc 200 mm wide: punch, die, and a blank holder pressed on by 100 kN.
**
**            | punch  |  holder            The blank is 0.82 mm thick, sigma = 513 eps^0.223 MPa
**            |  50 mm |___________         from 91.3 MPa on; mu = 0.25 at the punch, 0.1 at die and
**             \\______/  blank              holder. The punch goes 60 mm down, then all tools let go:
**    =============================         what they pressed with fades over the last step.
**                     |___________
**                     | die 51.25 mm
**
** The ideal force, without friction and bending, is 48 kN to 53 kN; the punch needs between that and
** twice as much. The holder is held by its force alone.
**
"""
CUP_EXPECT = """\
** expect: certificate.verdict = PASS
** expect: history.PUNCH.rf2 at 2 = -9.06e4 +- 5 %
** expect: history.TOP-HOLDER.force2 at 2 = -1e5 +- 0.1 %
** expect: history.PUNCH.u2 at 2 = -60 +- 1e-9
"""
BEND = """\
** A strip of 2 mm bent in a V-die 50 mm wide by a punch with a nose of 5 mm: plane strain, a half.
**
**            | punch |            The metal flows from 300 MPa on and hardens by 500 MPa; mu = 0.1.
**             \\_____/             The punch goes 14 mm down and back: the leg, at 34 degrees, springs
**    =========================    back by 2.1.
**    ____/               \\____
**    die |               | die
**
** Workshop practice: F = 1.33 strength t^2/W per width, strength 335 MPa by Considere, 35.7 N/mm.
**
"""
BEND_EXPECT = """\
** expect: certificate.verdict = PASS
** expect: history.PUNCH.rf2 at 1 = -14.78 +- 2 %
** expect: history.PUNCH.rf2 at 2 = 0 +- 1e-6
"""
WRAP = """\
** A strip of 1 mm wrapped round a former by a moment at its end, by a right angle, and let go.
**
**      strip, held here        The moment turns the rigid end by 90 degrees: the strip, 10 pi mm
**     =================o       long, comes to a radius of 20 mm and lies on the former of 19.5 mm.
**     _____                    The metal flows from 300 MPa on and hardens by 300 MPa; mu = {mu:g} on
**   former \\                   the former. Then the end is free.
**           |
**
** Pure bending in plane strain (Hill 1950, V.2), with bilinear fibres: modulus E/(1 - nu^2), flow
** at 2/sqrt(3) of 300 MPa, beyond that 4/3 of 300 MPa beside the modulus. M = {moment:.4f} N mm/mm
** at 1/20 per mm; let go, the end turns back by M L/(E I), to {left:.5f} rad.
**
"""
WRAP_EXPECT = """\
** expect: certificate.verdict = PASS
** expect: history.END.rf6 at 1 = {moment:.4f} +- 1 %
** expect: history.END.u6 at 2 = {left:.5f} +- 1 %
"""


def sheet(kind: str, ticks: list[float], thickness: float, layers: int) -> list[str]:
    """Nodes, elements, the nodes on the axis, and both faces of a flat sheet."""
    def label(i: int, j: int) -> int:
        return 1 + i*(layers + 1) + j

    lines = ["*NODE, NSET=ALL"]
    lines += [f"{label(i, j)}, {x:.9g}, {thickness*j/layers:.9g}" for i, x in enumerate(ticks)
              for j in range(layers + 1)]
    lines.append(f"*ELEMENT, TYPE={kind}, ELSET=SHEET")
    faces: dict[str, list[int]] = {"BOTTOM, S1": [], "TOP, S3": []}
    element = 0
    for i in range(len(ticks) - 1):
        for j in range(layers):
            element += 1
            corners = (label(i, j), label(i + 1, j), label(i + 1, j + 1), label(i, j + 1))
            lines.append(", ".join(map(str, (element, *corners))))
            if j == 0:
                faces["BOTTOM, S1"].append(element)
            if j == layers - 1:
                faces["TOP, S3"].append(element)
    lines += ["*NSET, NSET=MIDDLE", ", ".join(str(label(0, j)) for j in range(layers + 1))]
    for name, elements in faces.items():
        surface, face = name.split(", ")
        lines += [f"*SURFACE, NAME={surface}", *(f"{k}, {face}" for k in elements)]
    return lines


def material(flow: list[tuple[float, float]], young: float) -> list[str]:
    """Steel by a table of flow stress and plastic strain."""
    return ["*MATERIAL, NAME=STEEL", "*ELASTIC", f"{young:g}, 0.3", "*PLASTIC",
            *(f"{stress:.6g}, {strain:.6g}" for stress, strain in flow),
            "*SOLID SECTION, ELSET=SHEET, MATERIAL=STEEL"]


def tool(name: str, reference: int, at: tuple[float, float], profile: list[str]) -> list[str]:
    """A rigid profile with its reference node; the outward side is on the left of the way."""
    return [f"*NODE, NSET={name}_REF", f"{reference}, {at[0]:g}, {at[1]:g}",
            f"*SURFACE, NAME={name}, TYPE=SEGMENTS", *profile,
            f"*RIGID BODY, ANALYTICAL SURFACE={name}, REF NODE={name}_REF"]


def interaction(name: str, mu: float, *pairs: str) -> list[str]:
    """Exact contact with friction, and the pairs that have it."""
    return [f"*SURFACE INTERACTION, NAME={name}", "*SURFACE BEHAVIOR, DIRECT", "*FRICTION",
            f"{mu:g}", f"*CONTACT PAIR, INTERACTION={name}", *pairs]


def cup(elements: int = 60, layers: int = 3, kind: str = "CAX4", *, stroke: float = 60.0,
        holder: float = 1e5, opened: bool = True) -> str:
    """Drawing of a cylindrical cup (Abaqus, example of a deep drawn cup); `opened`: and let go."""
    strength, exponent, first, young, t = 513.0, 0.223, 91.3, 211e3, 0.82
    start = (first/strength)**(1.0/exponent)
    strains = [0.0] + [1e-3*2500.0**(k/29) for k in range(30)]
    lines = ["*HEADING", "Cup, N mm"]
    lines += sheet(kind, [100.0*i/elements for i in range(elements + 1)], t, layers)
    lines += material([(strength*(start + e)**exponent, e) for e in strains], young)
    lines += tool("PUNCH", 90001, (0.0, t), [
        f"START, 50., {t + 90:g}", f"LINE, 50., {t + 13:g}", f"CIRCL, 37., {t}, 37., {t + 13:g}",
        f"LINE, -10., {t}"])
    lines += tool("DIE", 90002, (56.25, 0.0), [
        "START, 51.25, -90.", "LINE, 51.25, -5.", "CIRCL, 56.25, 0., 56.25, -5.",
        "LINE, 130., 0."])
    lines += tool("HOLDER", 90003, (56.25, t), [
        f"START, 130., {t}", f"LINE, 57.25, {t}", f"CIRCL, 56.25, {t + 1:g}, 57.25, {t + 1:g}",
        f"LINE, 56.25, {t + 20:g}"])
    lines += interaction("AT_PUNCH", 0.25, "TOP, PUNCH")
    lines += interaction("AT_DIE", 0.1, "BOTTOM, DIE", "TOP, HOLDER")
    held = ["MIDDLE, 1", "PUNCH_REF, 1", "PUNCH_REF, 6", "DIE_REF, 1, 2", "DIE_REF, 6",
            "HOLDER_REF, 1", "HOLDER_REF, 6"]
    drawn = [
        *lines, "*BOUNDARY", *held, "*STEP, NAME=HOLD, NLGEOM", "*STATIC", "*BOUNDARY",
        "PUNCH_REF, 2, 2, 0.", "*CLOAD", f"HOLDER_REF, 2, {-holder:g}", "*NODE FILE", "U",
        "*EL FILE", "S, PEEQ", "*CONTACT FILE", "CDIS, CSTR", "*END STEP",
        "*STEP, NAME=DRAW, NLGEOM, INC=2000", "*STATIC", "0.002, 1., 1E-7, 0.01", "*BOUNDARY",
        f"PUNCH_REF, 2, 2, {-stroke:g}", "*END STEP"]
    if not opened:
        return "\n".join([*drawn, ""])
    return CUP + CUP_EXPECT + "\n".join([
        *drawn, "*STEP, NAME=OPEN, NLGEOM, INC=500", "*STATIC", "0.1, 1.",
        "*MODEL CHANGE, TYPE=CONTACT PAIR, REMOVE", "TOP, PUNCH", "TOP, HOLDER", "BOTTOM, DIE",
        "*BOUNDARY, OP=NEW", *held[:-2], "PUNCH_REF, 2", "HOLDER_REF, 1, 2", "HOLDER_REF, 6",
        "1, 2, 2, -60.", "*END STEP", ""])


def v_bending(elements: int = 46, layers: int = 4, kind: str = "CPE4I", stroke: float = 14.0,
              mu: float = 0.1, near: int = 20) -> str:
    """Air bending in a V-die and springback; `near` of the elements lie in the inner 12 mm."""
    ticks = [12.0*i/near for i in range(near + 1)]
    rest = elements - near
    ticks += [12.0 + 28.0*(i + 1)/rest for i in range(rest)]
    lines = ["*HEADING", "Bending in a V, N mm", *sheet(kind, ticks, 2.0, layers),
             *material([(300.0, 0.0), (1300.0, 2.0)], 210e3)]
    lines += tool("PUNCH", 90001, (0.0, 2.0), [
        "START, 5., 40.", "LINE, 5., 7.", "CIRCL, 0., 2., 0., 7.", "CIRCL, -4., 4., 0., 7."])
    lines += tool("DIE", 90002, (25.0, 0.0), [
        "START, 21., -40.", "LINE, 21., -4.", "CIRCL, 25., 0., 25., -4.", "LINE, 60., 0."])
    lines += interaction("OILED", mu, "TOP, PUNCH", "BOTTOM, DIE")
    held = ["MIDDLE, 1", "PUNCH_REF, 1", "PUNCH_REF, 6", "DIE_REF, 1, 2", "DIE_REF, 6"]
    far = 1 + (elements - 8)*(layers + 1) + layers//2
    return BEND + BEND_EXPECT + "\n".join([
        *lines, "*NSET, NSET=LEG", f"{far}, {far + 6*(layers + 1)}", "*BOUNDARY", *held,
        "*STEP, NAME=BEND, NLGEOM, INC=500", "*STATIC", "0.02, 1., 1E-6, 0.05", "*BOUNDARY",
        f"PUNCH_REF, 2, 2, {-stroke:g}", "*NODE PRINT, NSET=LEG", "U", "*NODE FILE", "U",
        "*EL FILE", "S, PEEQ", "*END STEP",
        "*STEP, NAME=RELEASE, NLGEOM, INC=500", "*STATIC", "0.05, 1., 1E-6, 0.2",
        "*BOUNDARY, OP=NEW", *held, f"PUNCH_REF, 2, 2, {1.5 - stroke:g}", "*END STEP", ""])


def wrapped_moment(radius: float, young: float = 210e3, poisson: float = 0.3, flow: float = 300.0,
                   hardening: float = 300.0) -> float:
    """Moment per width that holds a sheet of thickness 1 at a radius: bilinear fibres."""
    modulus, first = young/(1.0 - poisson**2), 2.0*flow/sqrt(3.0)
    beyond = 1.0/(1.0/modulus + 0.75/hardening)
    core = first*radius/modulus
    if core >= 0.5:
        return modulus/(12.0*radius)
    return (2.0*modulus*core**3/(3.0*radius) + first*(1.0 - beyond/modulus)*(0.25 - core**2)
            + 2.0*beyond*(0.125 - core**3)/(3.0*radius))


def wrapped_strip(cells: int = 60, layers: int = 4, kind: str = "CPE4I", mu: float = 0.1,
                  method: str = "DIRECT") -> str:
    """Bending round a former by a moment, and springback."""
    radius, angle = 20.0, pi/2
    length, inner = radius*angle, radius - 0.5
    lines = ["*HEADING", "Wrapped strip, N mm"]
    lines += sheet(kind, [length*i/cells for i in range(cells + 1)], 1.0, layers)
    lines += ["*NSET, NSET=END", *(str(1 + cells*(layers + 1) + j) for j in range(layers + 1)),
              "*NODE, NSET=GRIP", f"90001, {length!r}, 0.5", "*RIGID BODY, NSET=END, REF NODE=90001"]
    lines += material([(300.0, 0.0), (600.0, 1.0)], 210e3)
    lines += tool("FORMER", 90002, (0.0, -inner), [
        "START, -5., 0.", "LINE, 0., 0.", f"CIRCL, {inner}, {-inner}, 0., {-inner}",
        f"LINE, {inner}, {-inner - 10.0}"])
    lines += ["*SURFACE INTERACTION, NAME=I", f"*SURFACE BEHAVIOR, {method}"]
    lines += ["*FRICTION", f"{mu:g}"] if mu > 0.0 else []
    lines += ["*CONTACT PAIR, INTERACTION=I", "BOTTOM, FORMER"]
    held = ["MIDDLE, 1", f"{1 + layers//2}, 2", "FORMER_REF, 1, 2", "FORMER_REF, 6"]
    moment = wrapped_moment(radius)
    told = {"mu": mu, "moment": -moment,
            "left": -angle + moment*length*12.0*(1.0 - 0.3**2)/210e3}
    return WRAP.format(**told | {"moment": moment}) + WRAP_EXPECT.format(**told) + "\n".join([
        *lines, "*BOUNDARY", *held, "*STEP, NAME=WRAP, NLGEOM, INC=300", "*STATIC", "*BOUNDARY",
        f"GRIP, 6, 6, {-angle!r}", "*NODE PRINT, NSET=GRIP, TOTALS=NO", "U, RF", "*NODE FILE",
        "U", "*EL FILE", "S, PEEQ", "*CONTACT FILE", "CDIS, CSTR", "*END STEP",
        "*STEP, NAME=RELEASE, NLGEOM, INC=300", "*STATIC", "*BOUNDARY, OP=NEW", *held,
        "*END STEP", ""])


SCENES = {f.__name__: f for f in (cup, v_bending, wrapped_strip)}


def main(names: list[str]) -> None:
    """Print the decks of these names."""
    for name in names:
        print(SCENES[name](), end="")


if __name__ == "__main__":
    main(sys.argv[1:])
