"""Blocks of any element word pressed and sheared on blocks of the same word whose facets do not
match, surface to surface: the stress is uniform in both, and so must be the pressure.

As tool_patches, but the tool is a mesh: the lower block is held at its bottom, which slides, and
shear on the sides of both blocks balances the moment of the drag. On the finite path what slides off
is no longer covered: there the pressure is that before sliding, and the drag acts on what is covered
at the end, along the face as it stands then.
"""
import numpy as np
from tool_patches import (METHODS, PRESSURE, SHEAR, YOUNG, Lines, family, is_quadratic, is_solid, numbers,
                          turned)

from lopin.deck import Deck
from lopin.mesh_make import block, extruded, simplices

#: How far the lower block slides; both lag behind by their shear.
WAY = 0.01
#: Facets of slave and master along x; across it 2 over 3, or as many.
RATIOS = {"1:1": (3, 3), "3:4": (3, 4), "4:7": (4, 7), "10:15": (10, 15)}
TURNS = {2: 0.6, 3: (0.4, -1.1, 0.7)}


def block_of(word, cells, wide):
    """A block of 2 by (2 by) 1 of a word with so many cells along x."""
    cell = family(word)
    if cell in ("triangle", "quad"):
        mesh = block((2.0, 1.0), (cells, 2))
        mesh = simplices(mesh) if cell == "triangle" else mesh
    else:
        mesh = block((2.0, 2.0), (cells, wide))
        mesh = extruded(simplices(mesh) if cell == "wedge" else mesh, 1.0, 1)
        mesh = simplices(mesh) if cell == "tetra" else mesh
    return mesh.quadratic() if is_quadratic(word) else mesh


def cases(methods):
    return [(f"{'DPLA'[METHODS.index(m)]}{k}", m, k) for m in methods for k in (0, 1)]


def patch_deck(word, path, ratio, methods=METHODS) -> Deck:
    """Straight (0) and turned (1) blocks for each method."""
    lines = Lines()
    n, m = RATIOS[ratio]
    wide = (2, 2) if ratio == "1:1" else (1, 2)
    upper, lower = block_of(word, n, wide[0]), block_of(word, m, wide[1])
    d = upper.ndim
    drop = np.zeros(d)
    drop[-1] = 1.0
    lines.add("*HEADING", f"Blocks of {word} on each other, {ratio}",
              *([f"*LOPIN, PATH={path}"] if path else []),
              "*MATERIAL, NAME=M", "*ELASTIC", f"{YOUNG!r}, 0.")
    held, pressed, shears, slide, moved = [], [], [], [], []
    for name, method, k in cases(methods):
        q = turned(TURNS[d]) if k else np.eye(d)
        lines.mesh(upper.mapped(lambda x, q=q: x @ q.T), word, name + "U")
        lines.mesh(lower.mapped(lambda x, q=q: (x - drop) @ q.T), word, name + "L")
        turn = np.eye(3)
        turn[:d, :d] = q
        for b in "UL":
            lines.add(f"*SOLID SECTION, ELSET={name}{b}E, MATERIAL=M", *(["1.,"] if d == 2 else []),
                      f"*TRANSFORM, NSET={name}{b}N, TYPE=R", numbers([*turn[:, 0], *turn[:, 1]]))
        lines.add(f"*SURFACE INTERACTION, NAME={name}I", f"*SURFACE BEHAVIOR, {method}",
                  "*FRICTION", "0.,",
                  f"*CONTACT PAIR, INTERACTION={name}I, TYPE=SURFACE TO SURFACE",
                  f"{name}USBOTTOM, {name}LSTOP")
        held += [f"{name}UTOP, 1, {d - 1}", f"{name}LBOTTOM, 1, {d}"]
        pressed.append(f"{name}USTOP, P, {PRESSURE!r}")
        up = numbers([*q[:, -1], 0.0][:3])
        shears += [f"{name}{b}S{side}, TRVEC, {sign*SHEAR!r}, {up}" for b in "UL"
                   for side, sign in (("RIGHT", -1.0), ("LEFT", 1.0))]
        slide += [f"*CHANGE FRICTION, INTERACTION={name}I", f"*FRICTION, TAUMAX={SHEAR!r}", "0.3,"]
        moved.append(f"{name}LBOTTOM, 1, 1, {WAY!r}")
    lines.add("*BOUNDARY", *held, "*STEP, INC=100", "*STATIC, DIRECT", "1., 1.",
              "*DSLOAD", *pressed, "*CONTACT FILE", "CDIS, CSTR", "*END STEP",
              "*STEP, INC=100", "*STATIC, DIRECT", "1., 1.", *slide, "*BOUNDARY", *moved,
              "*DSLOAD", *shears, "*CONTACT FILE", "CDIS, CSTR", "*END STEP")
    return Deck.parse("\n".join(lines.text) + "\n", name=f"mesh_patch_{word.lower()}")


def covered(result, word, ratio, methods=METHODS):
    """Area at the end that both blocks of each case share, in the axes of the case.

    The outlines stay straight but for 1e-6 of a facet: sums of the changes of both spans.
    """
    n, m = RATIOS[ratio]
    wide = (2, 2) if ratio == "1:1" else (1, 2)
    upper, lower = block_of(word, n, wide[0]).points, block_of(word, m, wide[1]).points
    d = upper.shape[1]
    start = np.vstack([upper, lower - np.eye(d)[-1]])
    slave = np.arange(len(start)) < len(upper)
    areas, from_ = [], 0
    for _, _, k in cases(methods):
        q = turned(TURNS[d]) if k else np.eye(d)
        now = start + result["U"][from_:from_ + len(start)] @ q
        from_ += len(start)

        def edge(side, axis, value, at):
            """The place along an axis of an edge of the face, at stations along the other."""
            nodes = (np.abs(start[:, -1]) < 1e-9) & side & (np.abs(start[:, axis] - value) < 1e-9)
            across = now[nodes, 1 - axis] if d == 3 else np.zeros(1)
            order = np.argsort(across)
            return np.interp(at, across[order], now[nodes, axis][order])

        def span(axis, at):
            return (np.minimum(*(edge(s, axis, 2.0, at) for s in (slave, ~slave)))
                    - np.maximum(*(edge(s, axis, 0.0, at) for s in (slave, ~slave))))

        along = span(0, np.linspace(0.0, 2.0, 4001) if d == 3 else np.zeros(1)).mean()
        across = span(1, np.linspace(2.0 - along, along, 4001)).mean() - 2.0 if d == 3 else 0.0
        areas.append(along*2.0**(d - 2) + along*across)
    return areas


def errors(result, word, path, ratio, methods=METHODS):
    """Worst error of any pressure, of the normal and of the tangential force; relative."""
    d = 3 if is_solid(word) else 2
    area = 2.0 if d == 2 else 4.0
    left = covered(result, word, ratio, methods) if path else []
    pressure, normal, drag = [], [], []
    for i, (name, _, k) in enumerate(cases(methods)):
        q = turned(TURNS[d]) if k else np.eye(d)
        contact = result.contact(i)
        own = (contact.at(0) if path else contact.last).pressure
        pressure.append(np.abs(own/PRESSURE - 1.0).max())
        force = q.T @ np.array([result.history[f"{name}USBOTTOM-{name}LSTOP.force{j + 1}"][-1]
                                for j in range(d)])
        normal.append(abs(abs(force[-1])/(PRESSURE*area) - 1.0))
        if path:   # what is left covered tilts, and the pressures with it: each shear by itself
            out = contact.last["NORMAL"]
            shear = contact.last.force - np.sum(contact.last.force*out, 1)[:, None]*out
            drag.append(abs(np.linalg.norm(shear, axis=1).sum()/(SHEAR*left[i]) - 1.0))
            continue
        wanted = np.array([SHEAR*area, 0.0][:d - 1])
        drag.append(np.linalg.norm(np.abs(force[:-1]) - wanted)/(SHEAR*area))
    return np.array([pressure, normal, drag])
