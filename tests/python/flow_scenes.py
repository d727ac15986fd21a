"""Discs, rings and blocks of metal under a plate, as decks."""
from __future__ import annotations

import math

from lopin import Deck

NORTON = "*VISCOPLASTIC, LAW=NORTON-HOFF{rigid}\n{k!r}, {m!r}"


def grid(nx, nz, width, height, quadratic=False, inner=0.0):
    """Nodes by label, elements, and labels by place in a rectangle of quads."""
    step = 2 if quadratic else 1
    label, nodes, elements = {}, {}, []

    def node(i, j):
        if (i, j) not in label:
            label[i, j] = len(label) + 1
            nodes[label[i, j]] = (inner + (width - inner)*i/(step*nx), height*j/(step*nz))
        return label[i, j]

    for j in range(0, step*nz, step):
        for i in range(0, step*nx, step):
            places = [(i, j), (i + step, j), (i + step, j + step), (i, j + step)]
            if quadratic:
                places += [(i + 1, j), (i + 2, j + 1), (i + 1, j + 2), (i, j + 1)]
            elements.append([node(*place) for place in places])
    return nodes, elements, label


def upset(material, *, radius=10.0, height=5.0, inner=0.0, nx=1, nz=1, word="CAX4", friction="",
          speed=0.5, time=1e-2, increments=1, nlgeom=False, direct=True,
          output="*EL FILE\nS, E, PEEQ\n*CONTACT FILE\nCDIS, CSTR\n", name="upset"):
    """The upper half of a disc or ring on its middle plane, pressed by a plate that comes down with
    a speed."""
    nodes, elements, label = grid(nx, nz, radius, height, word.startswith("CAX8"), inner)
    lines = ["*NODE", *(f"{k}, {x!r}, {y!r}" for k, (x, y) in nodes.items()),
             f"*ELEMENT, TYPE={word}, ELSET=ALL"]
    lines += [f"{k + 1}, " + ", ".join(map(str, e)) for k, e in enumerate(elements)]
    axis = [k for (i, _), k in label.items() if i == 0 and inner == 0.0]
    lines += ["*NSET, NSET=BASE", *(f"{k}," for (_, j), k in label.items() if j == 0)]
    if axis:
        lines += ["*NSET, NSET=AXIS", *(f"{k}," for k in axis)]
    lines += ["*SURFACE, NAME=TOP", *(f"{(nz - 1)*nx + i + 1}, S3" for i in range(nx)),
              "*NODE, NSET=PREF", f"90001, 0., {height!r}", "*SURFACE, NAME=PLATE, TYPE=SEGMENTS",
              f"START, {4*radius!r}, {height!r}", f"LINE, {-radius!r}, {height!r}",
              "*RIGID BODY, ANALYTICAL SURFACE=PLATE, REF NODE=PREF",
              "*SURFACE INTERACTION, NAME=FILM", friction,
              "*CONTACT PAIR, INTERACTION=FILM", "TOP, PLATE", "*MATERIAL, NAME=METAL", material,
              "*SOLID SECTION, ELSET=ALL, MATERIAL=METAL", "*BOUNDARY", "BASE, 2", "PREF, 1",
              "PREF, 6"]
    if axis:
        lines += ["AXIS, 1"]
    lines += ["*STEP, INC=1000" + (", NLGEOM" if nlgeom else ""), "*STATIC"
              + (", DIRECT" if direct else ""),
              f"{time/increments!r}, {time!r}", "*BOUNDARY", f"PREF, 2, 2, {-speed*time!r}",
              "*NODE FILE\nU, RF\n" + output
              + "*END STEP"]
    return Deck.parse("\n".join(line for line in lines if line) + "\n", name=name)


def norton(k=100.0, m=0.2, rigid=True, young=1e11):
    """The cards of a fluid of Norton and Hoff, rigid or with a stiff elastic part."""
    elastic = "" if rigid else f"*ELASTIC\n{young!r}, 0.3\n"
    return elastic + NORTON.format(rigid=", RIGID" if rigid else "", k=k, m=m)


def orders(result, corrections=False):
    """Orders of convergence of the increments: of their last three residuals above ten times what
    rounding leaves, or corrections (that by the tangent of the step before differs from Newton's by
    a share of the square of the last)."""
    found, run = [], []
    column, widths, floor = (3, (9, 10), 1e-11) if corrections else (1, (9,), 1e-12)
    lines = next(result.source.folder.glob("*.cvg")).read_text(encoding="utf-8").splitlines()
    for line in [*lines, "step"]:
        fields = line.split()
        if fields and fields[0] == "step":
            kept = [size for size in run if size > floor]
            if len(kept) >= 3 and kept[-1] < kept[-2] < kept[-3] < 0.1:
                found.append(math.log(kept[-1]/kept[-2])/math.log(kept[-2]/kept[-3]))
            run = []
        elif len(fields) in widths and fields[0].isdigit():
            run.append(float(fields[column]))
    return found
