"""Pictures of the decks with friction at small sliding."""
from __future__ import annotations

import numpy as np
from drawing import DOTS, EXACT, curve, figure, save, solved


def cattaneo() -> None:
    """Shear over the contact, stick inside and slip outside, beside the closed form."""
    result = solved("cattaneo")
    c = result.contact().last
    x = c.x[:, 0]
    shear = np.abs(np.asarray(c["R_t"])[:, 0])/np.asarray(c["WEIGHT"]).ravel()
    a, edge, p0 = 1.050464, 0.742790, 606.037
    at = np.linspace(-a, a, 401)
    exact = 0.3*p0*(np.sqrt(1.0 - (at/a)**2)
                    - np.where(np.abs(at) < edge,
                               edge/a*np.sqrt(np.maximum(0.0, 1.0 - (at/edge)**2)), 0.0))
    fig, ax = figure()
    near = np.abs(x) < 1.2*a
    curve(ax, at, exact, x[near], shear[near], closed="Cattaneo, Mindlin", xlabel="x [mm]",
          ylabel="shear [MPa]")
    save(fig, "cattaneo")


def rough_punch() -> None:
    """Pressure and shear under the rough punch, beside boundary elements with the full coupling."""
    from lopin.closed_form.punch import punch_stick, punch_tractions
    c = solved("rough_punch").contact().last
    x, w = c.x[:, 0], np.asarray(c["WEIGHT"]).ravel()
    touch = (x < 10.0) & (x > 1e-9)
    shear = np.abs(np.asarray(c["R_t"])[touch, 0])/w[touch]
    at, pressure, traction = punch_tractions(punch_stick(0.3, 0.3), 0.3, 0.3)
    fig, (left, right) = figure(8.4, 3.6, columns=2)
    curve(left, 10.0*at, 100.0*pressure, x[touch], c.pressure.ravel()[touch],
          closed="boundary elements", xlabel="x [mm]", ylabel="pressure [MPa]")
    curve(right, 10.0*at, 100.0*np.abs(traction), x[touch], shear, closed="boundary elements",
          xlabel="x [mm]", ylabel="shear [MPa]")
    left.set(ylim=(0.0, 150.0))
    right.set(ylim=(0.0, 45.0))
    save(fig, "rough_punch")


def nafems_punch() -> None:
    """Pressure and shear over the radius."""
    c = solved("nafems_punch").contact().last
    order = np.argsort(c.x[:, 0])
    w = np.asarray(c["WEIGHT"]).ravel()[order]
    fig, ax = figure()
    ax.plot(c.x[order, 0], c.pressure.ravel()[order], "o-", ms=4, lw=1.0, color=DOTS,
            label="pressure")
    ax.plot(c.x[order, 0], np.linalg.norm(np.asarray(c["R_t"])[order], axis=1)/w, "o-", ms=4,
            lw=1.0, color=EXACT, label="shear, mu = 0.1")
    ax.set(xlabel="radius [mm]", ylabel="[MPa]", xlim=(0.0, 48.0), ylim=(0.0, None))
    ax.legend(frameon=False)
    save(fig, "nafems_punch")


def capstan() -> None:
    """Pressure of the belt around the drum beside Euler's law."""
    contact = solved("capstan").contact(0).last
    angle = np.arctan2(contact.x[:, 1], contact.x[:, 0])
    pressed = contact.pressure > 0.0
    angle, pressure = angle[pressed], contact.pressure[pressed]
    order = np.argsort(angle)
    angle, pressure = angle[order], pressure[order]
    if pressure[len(pressure)//4] > pressure[3*len(pressure)//4]:
        angle = angle.max() - angle
    angle = angle - angle.min()
    fig, ax = figure()
    at = np.linspace(0.0, np.pi/2, 200)
    curve(ax, np.degrees(at), 10.0*np.exp(0.3*at)/100.0, np.degrees(angle), pressure,
          closed="Euler: T/(R b)",
          xlabel="angle around the drum [degrees]", ylabel="contact pressure [MPa]")
    ax.set(ylim=(0.0, 0.25))
    save(fig, "capstan")


def drawbead() -> None:
    """The force of the pull, with what friction and the bead give."""
    h = solved("drawbead").history
    pull = h["step"] == 2
    fig, ax = figure()
    part = h["time"][pull] - 1.0
    for label, held, exact in (("die and bead: mu N + f", h["DIE.rf1"] + h["BEAD.rf1"],
                                100.0 + 50.0*part), ("bead: f", h["BEAD.rf1"], 100.0 + 0.0*part)):
        ax.plot(6.0*part, exact, lw=1.0, color=EXACT)
        ax.plot(6.0*part, -held[pull], "o", ms=3, color=DOTS)
        ax.annotate(label, (3.0, exact[-1]), xytext=(0, 4 if exact[-1] > 100.0 else -14), textcoords="offset points")
    ax.set(xlabel="way [mm], while N grows to 500 N/mm", ylabel="held back [N/mm]",
           xlim=(0.0, 6.2), ylim=(0.0, 170.0))
    save(fig, "drawbead")


def _drag(name: str, levels: dict[str, float]) -> None:
    """The drag of the plate through time, beside what the law says."""
    h = solved(name).history
    fig, ax = figure()
    for label, level in levels.items():
        ax.axhline(level, lw=1.0, color=EXACT)
        ax.annotate(label, (0.02, level), xytext=(0, 3), textcoords="offset points")
    ax.plot(h["time"], h["PLATE.rf1"], "o", ms=4, color=DOTS)
    ax.set(xlabel="time [s]", ylabel="drag [N]", xlim=(0.0, 2.02), ylim=(0.0, None))
    save(fig, name)


def orowan_shoe() -> None:
    """Coulomb's drag, then the limit of shear."""
    _drag("orowan_shoe", {"mu p A at 50 MPa": 100.0, "m k A": 230.940108})


def viscous_shoe() -> None:
    """Drags at two speeds."""
    _drag("viscous_shoe", {"1 mm/s": 50.0, "10 mm/s": 50.0*10.0**0.3})


def arctan_shoe() -> None:
    """Drags at two speeds, and Coulomb's."""
    _drag("arctan_shoe", {"v0": 100.0, "10 v0": 400.0/np.pi*np.arctan(10.0), "mu p A": 200.0})
