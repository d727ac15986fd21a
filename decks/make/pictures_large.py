"""Pictures of the decks with far sliding, large rotation and large strain."""
from __future__ import annotations

import numpy as np
from drawing import (
    DOTS,
    EXACT,
    INK,
    MAP,
    coloured,
    curve,
    deformed,
    figure,
    plt,
    save,
    skin,
    solved,
    tools,
)


def rotating_rings() -> None:
    """Pressure while the shaft turns, with straight and with curved facets."""
    fig, (left, ax) = figure(8.6, 3.6, 2)
    curved = solved("rotating_rings")
    straight = solved("rotating_rings", **{"SMOOTH=YES\nSHAFT": "SMOOTH=NO\nSHAFT"})
    drawn = deformed(left, curved, curved["Mises"], scale=1.0, grid=0.2)
    left.set(xlabel="x [mm]", ylabel="y [mm]")
    coloured(fig, drawn, left, "Mises stress [MPa]")
    for result, label, colour in ((straight, "48 straight facets", EXACT),
                                  (curved, "SMOOTH=YES", DOTS)):
        turned = np.maximum(result.history["time"] - 1.0, 0.0)*90.0
        ax.plot(turned, result.history["SHAFT.OUTER-HUB.INNER.max_pressure"], color=colour,
                label=label)
    ax.axhline(22.792, color=INK, lw=0.8, ls="--", label="Lamé")
    ax.set(xlabel="angle of the shaft [degrees]", ylabel="largest pressure [MPa]", ylim=(0.0, None))
    ax.legend(frameon=False)
    save(fig, "rotating_rings")


def ironing() -> None:
    """The die in the slab, and the forces beside those by node to segment."""
    result = solved("ironing")
    fig, (left, ax) = figure(8.6, 3.4, 2)
    drawn = deformed(left, result, result["Mises"], scale=1.0, limits=(0.0, 400.0), grid=0.2)
    left.set(xlabel="x [mm]", ylabel="y [mm]")
    coloured(fig, drawn, left, "Mises stress [MPa]")
    time = result.history["time"]
    head = "DIE.OUTER-SLAB.TOP.force"
    ax.plot(time, result.history[head + "2"], "-", color=DOTS, label="down")
    ax.plot(time, -result.history[head + "1"], "-", color="#1f6f8b", label="along")
    ax.axvline(1.0, color=INK, lw=0.6, ls=":")
    ax.set(xlabel="time: pressed until 1, drawn until 2", ylabel="force [N/mm]", ylim=(0.0, None))
    ax.legend(frameon=False)
    save(fig, "ironing")


def crushed_ring() -> None:
    """The ring between its plates, four times."""
    result = solved("crushed_ring")
    last = len(result.times) - 1
    fig, axes = figure(8.6, 3.4, 4)
    for ax, k in zip(axes, (last//4, last//2, 3*last//4, last)):
        drawn = deformed(ax, result, result.at(k)["Mises"], scale=1.0, index=k, limits=(0.0, 2.0),
                         grid=0.2)
        tools(ax, result, scale=1.0, index=k)
        ax.set(xlim=(0.0, 33.0), ylim=(-22.0, 20.0), xlabel="x [mm]")
        ax.set_title(f"{35.0*result.times[k]:.0f} mm", fontsize=9)
    axes[0].set_ylabel("y [mm]")
    coloured(fig, drawn, list(axes), "Mises stress [MPa]")
    save(fig, "crushed_ring")


def folded_strip() -> None:
    """The strip in space, open, when its legs meet, and pressed."""
    result = solved("folded_strip")
    last = len(result.times) - 1
    fig = plt.figure(figsize=(8.6, 3.4), layout="constrained")
    axes = [fig.add_subplot(1, 3, k, projection="3d") for k in (1, 2, 3)]
    for ax, k in zip(axes, (0, last//2, last)):
        drawn = skin(ax, result, result.at(k)["Mises"], index=k, limits=(0.0, 2.0))
        ax.view_init(elev=-62.0, azim=-78.0, roll=12.0)
        ax.set(xlim=(-7.0, 21.0), ylim=(-9.0, 7.0), zlim=(0.0, 6.0), box_aspect=(28.0, 16.0, 6.0))
        ax.set_axis_off()
        ax.set_title(f"{8.5*result.times[k]:.1f} mm", fontsize=9)
    coloured(fig, drawn, axes, "Mises stress [MPa]")
    save(fig, "folded_strip")


def beam_over_corner() -> None:
    """The beam as it stands on the corner, and the force of the end."""
    result = solved("beam_over_corner", **{"FREQUENCY=20": "FREQUENCY=1"})
    fig, ax = figure(6.4, 3.0)
    shown = [len(result.times)//3, 2*len(result.times)//3, len(result.times) - 1]
    for k in shown:
        drawn = deformed(ax, result, result.at(k)["Mises"], scale=1.0, index=k,
                         limits=(0.0, 1500.0), mesh=False)
    ax.set(xlabel="x [mm]", ylabel="y [mm]")
    coloured(fig, drawn, ax, "Mises stress [MPa]")
    save(fig, "beam_over_corner")


def sliding_ball() -> None:
    """Pressure on the block where the ball was put down and where it has come to."""
    result = solved("sliding_ball")
    fig, axes = figure(8.6, 2.6, 2)
    shown = [k for k in range(len(result.times)) if "CPRESS" in result.contact(0).at(k).fields]
    for ax, k in zip(axes, (shown[0], shown[-1])):
        contact = result.contact(0).at(k)
        drawn = ax.tricontourf(contact.x[:, 0], contact.x[:, 1], contact.pressure, levels=12,
                               cmap=MAP)
        ax.plot(contact.x[:, 0], contact.x[:, 1], ".", ms=2, color="w", alpha=0.6)
        ax.set(xlabel="x [mm]", aspect="equal")
        ax.set_title(f"time {result.times[k]:.1f}", fontsize=9)
    axes[0].set_ylabel("y [mm]")
    coloured(fig, drawn, list(axes), "contact pressure [MPa]")
    save(fig, "sliding_ball")


FIELDS = {"*END STEP": "*NODE FILE\nU, RF\n*EL FILE\nS\n*END STEP"}


def elastica() -> None:
    """The beam as the force grows, and where the closed form has its tip at the end."""
    result = solved("elastica", **FIELDS)
    fig, ax = figure()
    last = len(result.times) - 1
    for k in sorted({0, last//8, last//4, last//2, last}):
        drawn = deformed(ax, result, result.at(k)["Mises"], scale=1.0, index=k, mesh=False,
                         limits=(0.0, float(result.at(last)["Mises"].max())))
    ax.plot(100.0 - 38.7628, 71.3792, "+", color=INK, ms=12, label="tip of the elastica")
    ax.set(xlabel="x [mm]", ylabel="y [mm]")
    ax.legend(frameon=False, loc="upper left")
    coloured(fig, drawn, ax, "Mises stress [MPa]")
    save(fig, "elastica")


def rubber_cube() -> None:
    """Force of the plate against the height that is left."""
    result = solved("rubber_cube", **FIELDS)
    fig, ax = figure()
    height = np.linspace(1.0, 0.5, 101)
    force = []
    for left in height:
        low, high = 1.0, 2.0      # the side stretch, by bisection: volume keeps the sides apart
        for _ in range(60):
            t = 0.5*(low + high)
            j = left*t*t
            side = j**(-2.0/3.0)*(t*t - left*left)/3.0 + 100.0*j*(j - 1.0)
            low, high = (low, t) if side > 0.0 else (t, high)
        force.append((j**(-2.0/3.0)*2.0*(t*t - left*left)/3.0 - 100.0*j*(j - 1.0))/left)
    top = np.asarray(result.to_meshio(-1).points)[:, 2] > 0.5
    pressed = [-np.asarray(result.at(k)["RF"])[top, 2].sum() for k in range(len(result.times))]
    curve(ax, height, np.array(force), 1.0 - 0.5*result.times, pressed, closed="homogeneous",
          xlabel="height [mm]", ylabel="force [N]")
    save(fig, "rubber_cube")


def rubber_tube() -> None:
    """Pressure against the growth of the bore."""
    result = solved("rubber_tube", **FIELDS)
    fig, ax = figure()
    growth = np.linspace(0.0, 0.7, 141)
    radius = np.linspace(1.0, 1.5, 2001)
    pressure = []
    for u in growth:
        square = 1.0 + ((1.0 + u)**2 - 1.0)/radius**2
        pressure.append(np.trapezoid((square - 1.0/square)/(square*radius), radius))
    bore = np.flatnonzero(np.abs(np.asarray(result.to_meshio(-1).points)[:, 0] - 1.0) < 1e-9)[0]
    found = [np.asarray(result.at(k)["U"])[bore, 0] for k in range(len(result.times))]
    curve(ax, growth, np.array(pressure), found, 0.3*result.times, closed="incompressible",
          xlabel="the inner radius grows by [mm]", ylabel="pressure [MPa]")
    save(fig, "rubber_tube")
