"""Pictures of the decks of laws of metals: one element beside its closed form."""
from __future__ import annotations

import numpy as np
from drawing import DOTS, EXACT, curve, figure, save, solved

from lopin.closed_form import StraightStrip


def rolled_strip() -> None:
    """Width beside length of strips at three angles."""
    fig, ax = figure()
    for angle, r in ((0.0, 1.8), (45.0, 1.2), (90.0, 2.1)):
        result = solved("rolled_strip", **{"3, 45.": f"3, {angle}"})
        u = 100.0*np.array([[0.02*t, result.at(k)["U"][3, 1]/2.0]
                            for k, t in enumerate(result.times)])
        elastic = 100.0*np.array([result.at(k)["RF"][1, 0]
                                  for k in range(len(result.times))])/210e3
        ax.plot(u[:, 0], -r/(1.0 + r)*(u[:, 0] - elastic) - 0.3*elastic, color=EXACT, lw=2.5)
        ax.plot(u[::3, 0], u[::3, 1], "o", ms=4, color=DOTS)
        ax.annotate(f"{angle:.0f} degrees, r = {r}", u[-1], xytext=(6, -3),
                    textcoords="offset points")
    ax.set(xlabel="strain along the strip [%]", xlim=(0.0, 2.55),
           ylabel="strain across [%]; grey: r/(1 + r) of the plastic strain")
    save(fig, "rolled_strip")


def bauschinger() -> None:
    """Force through the loop, and the integrated equation at its ends."""
    result = solved("bauschinger")
    ends = np.array([0.0, 0.02, -0.01, 0.03])
    at = np.interp(result.times, range(4), ends)
    force = [np.asarray(result.at(k)["RF"])[[1, 2, 5, 6], 0].sum()
             for k in range(len(result.times))]
    fig, ax = figure()
    ax.plot(100.0*np.r_[0.0, at], np.r_[0.0, force], "-", lw=1.2, color=DOTS, label="Lopin")
    ax.plot(100.0*ends[1:], 4.0*np.array([85.1141791, -89.1390205, 92.6406401]), "o", ms=6,
            color=EXACT, label="integrated equation")
    ax.set(xlabel="elongation [%]", ylabel="force [N]")
    ax.legend(frameon=False)
    save(fig, "bauschinger")


def bending_unbending() -> None:
    """Moment over curvature, to and fro, beside the closed form."""
    h = solved("bending_unbending").history
    strip, bent = StraightStrip(2e5, 200.0, 1e4, 1.0), 0.01
    to, by = np.linspace(0.0, bent, 100), np.linspace(0.0, 2.0*bent, 200)
    fig, ax = figure()
    ax.plot(100.0*to, [strip.moment(k) for k in to], color=EXACT, lw=2.5, label="closed form")
    ax.plot(100.0*(bent - by), [strip.back(bent, b) for b in by], color=EXACT, lw=2.5)
    ax.plot(100.0*h["GRIP.u6"]/2.0, h["GRIP.rf6"], "o", ms=4, color=DOTS, label="Lopin")
    ax.set(xlabel="curvature [1/dm]", ylabel="moment [N mm/mm]")
    ax.legend(frameon=False)
    save(fig, "bending_unbending")


def hot_upsetting() -> None:
    """Force of the plate beside the curve of each temperature."""
    h = solved("hot_upsetting").history
    height = 5.0 + h["PLATE.u2"]
    hot = np.interp(h["time"], [0.0, 1.0, 2.0], [900.0, 900.0, 750.0])
    share = (hot - 700.0)/200.0
    strain = np.log(5.0/height)
    stress = (1.0 - share)*(120.0 + 60.0*strain) + share*(60.0 + 20.0*strain)
    fig, ax = figure()
    curve(ax, 5.0 - height, stress*500.0e-3*np.pi/height, 5.0 - height, -h["PLATE.rf2"]/1e3,
          closed="stress of the curve at the temperature, by V/h", xlabel="way of the plate [mm]",
          ylabel="force [kN]")
    save(fig, "hot_upsetting")
