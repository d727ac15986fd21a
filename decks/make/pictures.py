"""Draw pictures of decks with their closed forms: `python decks/make/pictures.py`.

Needs the executable and matplotlib; pictures go to docs/pictures.
"""
from __future__ import annotations

from pathlib import Path

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt

import lopin
from lopin.closed_form import contact_modulus, hertz_point_approach

ROOT = Path(__file__).resolve().parents[2]
INK, EXACT, DOTS = "#222222", "#888888", "#c1440e"


def hertz_sphere() -> None:
    """Pressure under the sphere, and the penetrations of the four methods."""
    ball = hertz_point_approach(0.02, 50.0, contact_modulus(20e3, 0.3))
    result = lopin.run(ROOT/"decks"/"hertz_sphere.inp", executable=True)
    contact = result.contact(0).last
    order = np.argsort(contact.r)
    fig, ax = plt.subplots(figsize=(6.4, 4.0), layout="constrained")
    r = np.linspace(0.0, 1.3, 500)
    ax.plot(r, ball.pressure(r), color=EXACT, lw=2.5, label="Hertz 1882")
    ax.plot(contact.r[order], contact.pressure.ravel()[order], "o", ms=4.5, color=DOTS,
            label="Lopin, nodes of the block")
    force = -result.history["BALL.rf2"][-1]
    ax.text(0.03, 40.0, f"force {force:.1f} N (Hertz {ball.force:.1f})\n"
            f"largest pressure {contact.pressure.max():.1f} MPa (Hertz {ball.p0:.1f})", color=INK)
    ax.set(xlabel="radius [mm]", ylabel="contact pressure [MPa]", xlim=(0.0, 1.3), ylim=(0.0, 300.0))
    for side in ("top", "right"):
        ax.spines[side].set_visible(False)
    ax.legend(frameon=False)
    fig.savefig(ROOT/"docs"/"pictures"/"hertz_sphere.png", dpi=130)


if __name__ == "__main__":
    hertz_sphere()
