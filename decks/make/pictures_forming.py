"""Pictures of the decks of forming: bulk and sheets."""
from __future__ import annotations

import numpy as np
from drawing import (
    DOTS,
    EXACT,
    INK,
    ROOT,
    TOOL,
    Poly3DCollection,
    coloured,
    deformed,
    figure,
    plt,
    save,
    skin,
    solved,
    to_rgba,
    tools,
)

from lopin.closed_form import ring_bore
from lopin.closed_form import wire_drawing as wire_drawing_bounds


def upsetting() -> None:
    """The billet before its last third and at the end, and the force beside CalculiX."""
    result = solved("upsetting")
    fig, (left, ax) = figure(8.6, 3.6, 2)
    drawn = deformed(left, result, result["PEEQ"], scale=1.0)
    tools(left, result, scale=1.0)
    left.set(xlabel="r [mm]", ylabel="z [mm]", xlim=(0.0, 20.0), ylim=(0.0, 9.0))
    coloured(fig, drawn, left, "plastic strain [-]")
    share = -result.history["PLATE.u2"]/0.15
    ax.plot(share, -result.history["PLATE.rf2"]/1e3, color=DOTS, label="Lopin, 12 x 18")
    ax.plot([20.0, 30.0, 40.0, 60.0], [306.0, 368.0, 456.0, 815.3], "o", ms=5, color=EXACT,
            label="CalculiX 2.20, 48 x 72")
    ax.set(xlabel="reduction of height [%]", ylabel="force [kN]", xlim=(0.0, 61.0),
           ylim=(0.0, None))
    ax.legend(frameon=False)
    save(fig, "upsetting")


def ring_compression() -> None:
    """The ring at half its height, and its bore beside the upper bound."""
    result = solved("ring_compression")
    fig, (left, ax) = figure(8.6, 3.6, 2)
    drawn = deformed(left, result, result["PEEQ"], scale=1.0)
    tools(left, result, scale=1.0)
    left.set(xlabel="r [mm]", ylabel="z [mm]", xlim=(6.0, 22.0), ylim=(0.0, 4.0))
    coloured(fig, drawn, left, "plastic strain [-]")
    bore = [result.at(k)["displacement"][0, 0]/0.075 for k in range(len(result.times))]
    percent = np.arange(0.0, 51.0, 5.0)
    ax.plot(percent, [100.0*ring_bore(0.1, p/100.0) if p else 0.0 for p in percent],
            color=EXACT, lw=2.5, label="upper bound, straight walls")
    reduced = np.interp(result.times, result.history["time"], -result.history["PLATE.u2"]/0.05)
    ax.plot(reduced, bore, "o", ms=3, color=DOTS, label="Lopin, mid-height, m = 0.1")
    ax.set(xlabel="reduction of height [%]", ylabel="change of the bore [%]", xlim=(0.0, 51.0))
    ax.legend(frameon=False)
    save(fig, "ring_compression")


def wire_drawing() -> None:
    """The wire in its die, and the drawing stress between its bounds."""
    result = solved("wire_drawing")
    fig, (left, ax) = figure(8.6, 3.6, 2)
    drawn = deformed(left, result, result["PEEQ"], scale=1.0)
    tools(left, result, scale=1.0)
    left.set(xlabel="r [mm]", ylabel="z [mm]", xlim=(0.0, 8.0), ylim=(-9.0, 13.0))
    coloured(fig, drawn, left, "plastic strain [-]")
    bounds = wire_drawing_bounds(10.0, 9.0, 8.0)
    stress = -result.history["DIE.rf2"]/(np.pi*4.5**2*200.0)
    ax.axhspan(bounds.ideal, bounds.bound, color=EXACT, alpha=0.25, lw=0,
               label="homogeneous to upper bound (Avitzur)")
    drawn_by = np.interp(result.history["time"], [0.0, 1.0, 2.0, 3.0], [0.0, 4.0, 6.0, 8.0])
    ax.plot(drawn_by, stress, color=DOTS, label="Lopin")
    ax.set(xlabel="drawn [mm]", ylabel="drawing stress over yield stress [-]", ylim=(0.0, 0.4))
    ax.legend(frameon=False, loc="lower right")
    save(fig, "wire_drawing")


def forged(fig, axes, result, frames, limit: float) -> None:
    """The billet between its dies at some increments, by plastic strain up to `limit`."""
    for ax, k in zip(axes, frames):
        drawn = deformed(ax, result, result.at(k)["PEEQ"], scale=1.0, index=k,
                         limits=(0.0, limit), grid=0.15)
        tools(ax, result, scale=1.0, index=k)
        ax.set(xlim=(0.0, 30.0), ylim=(0.0, 18.0), xlabel="r [mm]")
        ax.set_title(f"{50.0*result.times[k]:.1f} mm", fontsize=9)
    axes[0].set_ylabel("z [mm]")
    coloured(fig, drawn, list(axes), "plastic strain")


def closed_die() -> None:
    """The billet between its dies three times, and the force of the press."""
    result = solved("closed_die")
    last = len(result.times) - 1
    fig, axes = figure(9.6, 2.6, 4)
    forged(fig, axes[:3], result, (0, 3*last//4, last), 1.5)
    axes[3].plot(-result.history["DIE.u2"], -result.history["DIE.rf2"]/1e3, color=DOTS)
    axes[3].set(xlabel="stroke [mm]", ylabel="force [kN]", ylim=(0.0, None))
    save(fig, "closed_die")


def full_flash() -> None:
    """Three of the meshes on the way into the flash, and the force beside that of one mesh."""
    result, one = solved("full_flash"), solved("closed_die")
    fig, axes = figure(9.6, 2.6, 4)
    stroke = 50.0*np.asarray(result.times)
    frames = [int(np.argmin(abs(stroke - at))) for at in (3.5, 4.9, 5.3)]
    forged(fig, axes[:3], result, frames, 2.0)
    for run, style, colour, label in ((result, "-", DOTS, "made anew"),
                                      (one, "--", EXACT, "one mesh")):
        axes[3].plot(-run.history["DIE.u2"], -run.history["DIE.rf2"]/1e3, style, color=colour,
                     label=label)
    axes[3].set(xlabel="stroke [mm]", ylabel="force [kN]", ylim=(0.0, None), xlim=(3.5, 5.4))
    axes[3].legend(frameon=False)
    save(fig, "full_flash")


def elastic_anvil() -> None:
    """The disc and the anvil at the end: strain, stress; and the force of the ram."""
    result = solved("elastic_anvil")
    fig, (left, middle, ax) = figure(9.6, 3.4, 3)
    for at, values, label, limits in (
            (left, result["PEEQ"], "plastic strain [-]", None),
            (middle, result["Mises"], "von Mises stress [MPa]", (0.0, 1300.0))):
        drawn = deformed(at, result, values, scale=1.0, grid=0.15, limits=limits)
        tools(at, result, scale=1.0)
        at.set(xlim=(0.0, 22.0), ylim=(-12.0, 8.0), xlabel="r [mm]")
        coloured(fig, drawn, at, label)
    left.set_ylabel("z [mm]")
    ax.plot(-result.history["RAM.u2"], -result.history["RAM.rf2"]/1e3, color=DOTS)
    ax.set(xlabel="stroke [mm]", ylabel="force [kN]", ylim=(0.0, None))
    save(fig, "elastic_anvil")


def blanking() -> None:
    """The metal between the edges, how near it is to fracture, and the force of the punch."""
    cut_sheet("blanking", "r", "force [kN]", 1e3, 16.0)


def shearing() -> None:
    """The same of the strip."""
    cut_sheet("shearing", "x", "force of one edge [N/mm]", 1.0, 510.0)


def cut_sheet(name: str, across: str, force: str, unit: float, slab: float) -> None:
    """Strain, damage and force of a sheet that is cut; `slab`: estimate of the force."""
    result = solved(name)
    fig, (left, middle, ax) = figure(9.6, 3.2, 3)
    for at, values, label in ((left, result["PEEQ"], "plastic strain [-]"),
                              (middle, result["DAMAGE_OYANE_MEAN"], "damage, Oyane, mean [-]")):
        drawn = deformed(at, result, values, scale=1.0, grid=0.15)
        tools(at, result, scale=1.0)
        at.set(xlim=(4.4, 5.6), ylim=(-0.3, 1.2), xlabel=f"{across} [mm]")
        coloured(fig, drawn, at, label)
    left.set_ylabel("z [mm]")
    ax.plot(-result.history["PUNCH.u2"], -result.history["PUNCH.rf2"]/unit, color=DOTS,
            label="Lopin")
    ax.axhline(slab, color=EXACT, label="slab")
    ax.set(xlabel="stroke [mm]", ylabel=force, ylim=(0.0, None))
    ax.legend(frameon=False)
    save(fig, name)


def upset_tetra() -> None:
    """The quarter billet half way and at the end."""
    result = solved("upset_tetra")
    last = len(result.times) - 1
    fig = plt.figure(figsize=(8.6, 3.4), layout="constrained")
    axes = []
    for k in (last//2, last):
        ax = fig.add_subplot(1, 2, len(axes) + 1, projection="3d", proj_type="ortho")
        drawn = skin(ax, result, result.at(k)["PEEQ"], index=k, limits=(0.0, 0.8))
        ax.set(xlim=(0.0, 14.0), ylim=(-14.0, 0.0), zlim=(0.0, 14.0), xlabel="x [mm]",
               zlabel="z [mm]")
        ax.set_box_aspect((1.0, 1.0, 1.0))
        ax.view_init(elev=25.0, azim=40.0)
        axes.append(ax)
    coloured(fig, drawn, axes, "plastic strain")
    save(fig, "upset_tetra")


def cross() -> None:
    """The octant under its die three times, turned about, and the force of the press."""
    result = solved("cross")
    stroke = 50.0*np.asarray(result.times)
    die = stl_triangles(ROOT/"decks"/"cross_upper.stl")
    fig = plt.figure(figsize=(9.6, 3.0), layout="constrained")
    axes = []
    for number, at in enumerate((0.0, 8.0, 15.0)):
        k = int(np.argmin(abs(stroke - at)))
        ax = fig.add_subplot(1, 4, number + 1, projection="3d", proj_type="ortho")
        drawn = skin(ax, result, result.at(k)["PEEQ"], index=k, limits=(0.0, 1.2))
        ax.add_collection3d(Poly3DCollection(
            die - [0.0, 0.0, stroke[k]], facecolors=to_rgba(TOOL, 0.08),
            edgecolors=to_rgba(TOOL, 0.25), linewidths=0.15))
        ax.set(xlim=(0.0, 44.0), ylim=(0.0, 44.0), zlim=(0.0, 36.0), zticks=(0, 20))
        ax.set_box_aspect((44.0, 44.0, 36.0))
        ax.view_init(elev=20.0, azim=55.0)
        ax.set_title(f"{stroke[k]:.0f} mm", fontsize=9, y=0.95)
        axes.append(ax)
    coloured(fig, drawn, axes, "plastic strain", orientation="horizontal")
    ax = fig.add_subplot(1, 4, 4)
    ax.plot(-result.history["UPPER.u3"], -result.history["UPPER.rf3"]/1e3, color=DOTS)
    ax.set(xlabel="stroke [mm]", ylabel="force on an eighth [kN]", ylim=(0.0, None))
    save(fig, "cross")


def stl_triangles(path) -> np.ndarray:
    """The triangles (n, corner, coordinate) of a binary STL file."""
    record = np.dtype([("x", "<f4", (4, 3)), ("spare", "<u2")])
    return np.frombuffer(path.read_bytes()[84:], record)["x"][:, 1:].astype(float)


def cup() -> None:
    """The cup at a third of the stroke, at its end and after release; the force of the punch."""
    result = solved("cup")
    stroke = -result.history["PUNCH.u2"]
    last = len(result.times) - 1
    end = max(k for k, t in enumerate(result.times) if t <= 2.0 + 1e-9)
    fig, axes = figure(9.6, 3.9, 4)
    third = min(range(end + 1), key=lambda k: abs(result.times[k] - 4.0/3.0))
    for ax, k, title in zip(axes, (third, end, last), ("20 mm", "60 mm", "released")):
        drawn = deformed(ax, result, result.at(k)["PEEQ"], scale=1.0, index=k, limits=(0.0, 0.8),
                         grid=0.1)
        if k != last:
            tools(ax, result, scale=1.0, index=k, width=0.5)
        ax.set(xlim=(25.0, 105.0), ylim=(-66.0, 25.0), xlabel="r [mm]")
        ax.set_title(title, fontsize=9)
    axes[0].set_ylabel("z [mm]")
    coloured(fig, drawn, list(axes[:3]), "plastic strain", orientation="horizontal")
    drawing = result.history["time"] <= 2.0 + 1e-9
    axes[3].plot(stroke[drawing], -result.history["PUNCH.rf2"][drawing]/1e3, color=DOTS)
    axes[3].set(xlabel="stroke [mm]", ylabel="force [kN]", ylim=(0.0, None))
    save(fig, "cup")


def square_cup() -> None:
    """The quarter half way and at the end, and the blank seen from above."""
    result = solved("square_cup")
    last = len(result.times) - 1
    half = int(np.argmin(np.abs(np.asarray(result.times) - 1.5)))
    fig = plt.figure(figsize=(9.6, 3.6), layout="constrained")
    axes = []
    for k in (half, last):
        ax = fig.add_subplot(1, 3, len(axes) + 1, projection="3d", proj_type="ortho")
        drawn = skin(ax, result, result.at(k)["PEEQ"], index=k, limits=(0.0, 0.3))
        ax.set(xlim=(0.0, 75.0), ylim=(0.0, 75.0), zlim=(-16.0, 1.0), xlabel="x [mm]",
               zticks=(-15, 0))
        ax.set_box_aspect((75.0, 75.0, 17.0))
        ax.view_init(elev=35.0, azim=-120.0)
        ax.set_title(f"{15.0*(result.times[k] - 1.0):.1f} mm", fontsize=9, y=0.9)
        axes.append(ax)
    coloured(fig, drawn, axes, "plastic strain", orientation="horizontal")
    ax = fig.add_subplot(1, 3, 3)
    edge = blank_edge(result)
    ax.plot(*edge[0].T, ":", color=EXACT, label="blank")
    ax.plot(*edge[1].T, "-", color=DOTS, label="drawn 15 mm")
    ax.plot((68.8, 72.74), (0.0, 72.74), "+", color=INK, ms=9, label="recalled")
    ax.set(xlabel="x [mm]", ylabel="y [mm]", xlim=(0.0, 80.0), ylim=(0.0, 80.0), aspect="equal")
    ax.legend(frameon=False, loc="center")
    save(fig, "square_cup")


def trimmed_cup() -> None:
    """How far the trimmed cup springs back, the stress that stays, and its rim before and after."""
    result = solved("trimmed_cup")
    before, after = (result.at(k)["displacement"] for k in (0, len(result.times) - 1))
    fig = plt.figure(figsize=(9.6, 3.6), layout="constrained")
    for k, (values, label) in enumerate((
            (np.linalg.norm(after - before, axis=1), "springback [mm]"),
            (result["Mises"], "von Mises stress that stays [MPa]"))):
        ax = fig.add_subplot(1, 3, k + 1, projection="3d", proj_type="ortho")
        drawn = skin(ax, result, values, index=len(result.times) - 1)
        ax.set(xlim=(0.0, 62.0), ylim=(0.0, 62.0), zlim=(-16.0, 1.0), xlabel="x [mm]",
               zticks=(-15, 0))
        ax.set_box_aspect((62.0, 62.0, 17.0))
        ax.view_init(elev=35.0, azim=-120.0)
        coloured(fig, drawn, ax, label, orientation="horizontal")
    ax = fig.add_subplot(1, 3, 3)
    x = result.to_meshio(0).points
    low = np.abs(x[:, 2]) < 1e-9
    rim = low & (x[:, :2].max(axis=1) > x[low, :2].max() - 1e-9)
    rim = np.flatnonzero(rim)[np.argsort(np.arctan2(x[rim, 1], x[rim, 0]))]
    turn = np.degrees(np.arctan2(*(x[rim] + after[rim])[:, 1::-1].T))
    for u, style, colour, label in ((before, ":", EXACT, "drawn"), (after, "-", DOTS, "trimmed, let go")):
        ax.plot(turn, (x[rim] + u[rim])[:, 2], style, color=colour, label=label)
    ax.set(xlabel="along the rim, from x [degrees]", ylabel="height of the rim [mm]", xlim=(0.0, 90.0))
    ax.legend(frameon=False)
    save(fig, "trimmed_cup")


def blank_edge(result) -> tuple[np.ndarray, np.ndarray]:
    """The lower edge of the blank at first and at last."""
    piece = result.to_meshio(-1)
    x, u = piece.points, np.asarray(piece.point_data["U"])
    low = np.abs(x[:, 2]) < 1e-9
    side = np.flatnonzero(low & (np.abs(x[:, 0] - 75.0) < 1e-9))
    back = np.flatnonzero(low & (np.abs(x[:, 1] - 75.0) < 1e-9) & (x[:, 0] < 74.9))
    around = np.concatenate([side[np.argsort(x[side, 1])], back[np.argsort(-x[back, 0])]])
    return x[around, :2], (x + u)[around, :2]


def wrapped_strip() -> None:
    """The strip on the former and let go; the moment at its end."""
    result = solved("wrapped_strip")
    last = len(result.times) - 1
    end = max(k for k, t in enumerate(result.times) if t <= 1.0 + 1e-9)
    fig, axes = figure(9.0, 3.4, 3)
    for ax, k, title in zip(axes, (end, last), ("on the former", "let go")):
        drawn = deformed(ax, result, result.at(k)["PEEQ"], scale=1.0, index=k, limits=(0.0, 0.03),
                         grid=0.1)
        tools(ax, result, scale=1.0, index=k)
        ax.set(xlim=(-2.0, 24.0), ylim=(-22.0, 3.0), xlabel="x [mm]")
        ax.set_title(title, fontsize=9)
    axes[0].set_ylabel("y [mm]")
    coloured(fig, drawn, list(axes[:2]), "plastic strain", orientation="horizontal")
    axes[2].plot(np.degrees(-result.history["END.u6"]), -result.history["END.rf6"], color=DOTS)
    axes[2].axhline(88.0126, color=EXACT, lw=2.5, label="Hill 1950, at 90°")
    axes[2].set(xlabel="turn of the end [°]", ylabel="moment [N]", ylim=(0.0, None))
    axes[2].legend(frameon=False)
    save(fig, "wrapped_strip")


def v_bending() -> None:
    """The strip at the end of the stroke and after release; the force of the punch."""
    result = solved("v_bending")
    last = len(result.times) - 1
    end = max(k for k, t in enumerate(result.times) if t <= 1.0 + 1e-9)
    fig, axes = figure(9.0, 3.4, 3)
    for ax, k, title in zip(axes, (end, last), ("14 mm", "released")):
        drawn = deformed(ax, result, result.at(k)["PEEQ"], scale=1.0, index=k, limits=(0.0, 0.2),
                         grid=0.1)
        tools(ax, result, scale=1.0, index=k)
        ax.set(xlim=(0.0, 44.0), ylim=(-16.0, 18.0), xlabel="x [mm]")
        ax.set_title(title, fontsize=9)
    axes[0].set_ylabel("y [mm]")
    coloured(fig, drawn, list(axes[:2]), "plastic strain", orientation="horizontal")
    bending = result.history["time"] <= 1.0 + 1e-9
    axes[2].plot(-result.history["PUNCH.u2"][bending], -2.0*result.history["PUNCH.rf2"][bending],
                 color=DOTS)
    axes[2].axhline(35.66, color=EXACT, lw=2.5, label="1.33 strength t²/W")
    axes[2].set(xlabel="stroke [mm]", ylabel="force [N/mm]", ylim=(0.0, None))
    axes[2].legend(frameon=False)
    save(fig, "v_bending")
