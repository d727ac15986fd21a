"""Draw the picture of every deck, or of those named: `python decks/make/pictures.py [name ...]`.

Pictures go to docs/pictures. Needs the executable and matplotlib.
"""
from __future__ import annotations

import sys

import numpy as np

from drawing import (DOTS, EXACT, INK, MAP, PICTURES, SIGNED, coloured, curve, deformed, figure,
                     plt, save, skin, solved, tools)
from lopin.closed_form import (contact_modulus, flat_punch_axisymmetric_pressure, hertz_line,
                               hertz_point, hertz_point_approach, lifted_beam as lifted_beam_exact,
                               nested_rings, ring_bore, wire_drawing as wire_drawing_bounds)


def bar_gap() -> None:
    """Force on the wall against the force applied, for two methods."""
    fig, ax = figure()
    ramp = {"*STATIC\n1., 1.\n*CLOAD\nTIP, 1, 5000.": "*STATIC\n0.1, 1.\n*CLOAD\nTIP, 1, 5000."}
    load = np.linspace(0.0, 10.0, 201)
    for k, (word, slope) in enumerate((("DIRECT", None), ("PENALTY\n2100.", 210e3))):
        method = {"BEHAVIOR, DIRECT": f"BEHAVIOR, {word}"} if slope else {}
        result = solved("bar_gap", **ramp, **method)
        time, wall = result.history["time"], -result.history["FACE.rf1"]
        first = time <= 1.0
        share = 1.0 if slope is None else slope/(slope + 21e3)
        ax.plot(load, np.maximum(0.0, load - 2.1)*share, color=EXACT, lw=1.2 if slope else 2.5,
                label=("exact", "exact, with a penalty of 10 k")[k])
        ax.plot(10*time[first], wall[first]/1e3, "o", ms=5, color=(DOTS, "#1f6f8b")[k],
                label=("Lopin, Lagrange multipliers", "Lopin, penalty")[k])
    ax.set(xlabel="force on the bar [kN]", ylabel="force on the wall [kN]")
    ax.text(2.1, 0.25, "gap closes at 2.1 kN  ", ha="right")
    ax.legend(frameon=False)
    save(fig, "bar_gap")


def two_springs() -> None:
    """Contact force against load."""
    result = solved("two_springs", **{"1., 1.\n*CLOAD": "0.1, 1.\n*CLOAD"})
    fig, ax = figure()
    load = np.linspace(0.0, 800.0, 201)
    # Closed, 1.5 N/um carry the load; the gap of 0.2 mm closes at 200 N.
    exact = np.maximum(0.0, (load - 200.0)/1500.0*500.0)
    curve(ax, load, exact, 800*result.history["time"],
          np.abs(result.history["LEFT_END-RIGHT_END.force1"]), closed="(F - 200)/3",
          xlabel="load F [N]", ylabel="contact force [N]")
    save(fig, "two_springs")


def cylinder_on_plane() -> None:
    """Pressure of the line contact."""
    exact = hertz_line(1000.0, 100.0, contact_modulus(210e3, 0.3))
    contact = solved("cylinder_on_plane").contact(0).last
    fig, ax = figure()
    x = np.linspace(0.0, 1.0, 500)
    curve(ax, x, exact.pressure(x), contact.x[:, 0], contact.pressure, closed="Hertz 1882",
          xlabel="x [mm]", ylabel="contact pressure [MPa]")
    ax.set(xlim=(0.0, 1.0), ylim=(0.0, None))
    save(fig, "cylinder_on_plane")


def flat_punch() -> None:
    """Pressure, singular at the edge."""
    contact = solved("flat_punch").contact(0).last
    fig, ax = figure()
    r = np.linspace(0.0, 9.99999, 4000)
    curve(ax, r, flat_punch_axisymmetric_pressure(1000.0, 10.0, r), contact.r, contact.pressure,
          closed="exact, infinite at the edge", xlabel="radius [mm]",
          ylabel="contact pressure [MPa]")
    ax.set(xlim=(0.0, 11.0), ylim=(0.0, 12.0))
    save(fig, "flat_punch")


def hertz_sphere() -> None:
    """Pressure under the sphere."""
    ball = hertz_point_approach(0.02, 50.0, contact_modulus(20e3, 0.3))
    result = solved("hertz_sphere")
    contact = result.contact(0).last
    fig, ax = figure()
    r = np.linspace(0.0, 1.3, 500)
    curve(ax, r, ball.pressure(r), contact.r, contact.pressure, closed="Hertz 1882",
          dots="Lopin, nodes of the block", xlabel="radius [mm]", ylabel="contact pressure [MPa]")
    force = -result.history["BALL.rf2"][-1]
    ax.text(0.03, 40.0, f"force {force:.1f} N (Hertz {ball.force:.1f})\n"
            f"largest pressure {contact.pressure.max():.1f} MPa (Hertz {ball.p0:.1f})", color=INK)
    ax.set(xlim=(0.0, 1.3), ylim=(0.0, 300.0))
    save(fig, "hertz_sphere")


def hertz_sphere_3d() -> None:
    """Pressure over the distance from the axis, beside a map of the surface."""
    ball = hertz_point_approach(0.02, 50.0, contact_modulus(20e3, 0.3))
    contact = solved("hertz_sphere_3d").contact(0).last
    fig, (left, right) = figure(8.0, 3.6, 2)
    drawn = left.tripcolor(contact.x[:, 0], contact.x[:, 1], contact.pressure, cmap=MAP,
                           shading="gouraud")
    angle = np.linspace(0.0, np.pi/2, 100)
    left.plot(ball.a*np.cos(angle), ball.a*np.sin(angle), "w--", lw=1.2)
    left.plot(contact.x[:, 0], contact.x[:, 1], ".", ms=2, color="k", alpha=0.5)
    left.set(xlabel="x [mm]", ylabel="y [mm]", aspect="equal")
    left.set_title("white: circle of Hertz", fontsize=9)
    coloured(fig, drawn, left, "contact pressure [MPa]")
    r = np.linspace(0.0, 1.5, 500)
    curve(right, r, ball.pressure(r), np.hypot(*contact.x[:, :2].T), contact.pressure,
          closed="Hertz 1882", xlabel="distance from the axis [mm]",
          ylabel="contact pressure [MPa]")
    save(fig, "hertz_sphere_3d")


def lifted_beam() -> None:
    """The lower face of the beam against beam theory."""
    result = solved("lifted_beam")
    contact = result.contact(0).last
    fig, ax = figure()
    x = np.linspace(0.0, 200.0, 400)
    exact = lifted_beam_exact(1e6, 1.0, 50.0)
    ax.axhline(0.0, color="#3b4a5a", lw=2.2)
    lower = contact.x[:, 0] % 5.0 < 1e-6
    curve(ax, x, exact.deflection(x - 100.0), contact.x[lower, 0], contact["U"][lower, 1],
          closed="beam theory", xlabel="x [mm]", ylabel="height of the lower face [mm]")
    ax.annotate("50 N", (200.0, 4.17), (200.0, 3.2), ha="center",
                arrowprops={"arrowstyle": "->", "color": INK})
    ax.annotate("leaves the floor at 100 mm", (100.0, 0.0), (60.0, 1.0),
                arrowprops={"arrowstyle": "->", "color": INK})
    save(fig, "lifted_beam")


def nafems_cylinder() -> None:
    """Mises stress of both bodies near the contact, and the pressure."""
    result = solved("nafems_cylinder")
    fig, (left, right) = figure(8.0, 3.8, 2)
    drawn = deformed(left, result, result["Mises"], scale=1.0, limits=(0.0, 2200.0))
    left.set(xlim=(0.0, 16.0), ylim=(-16.0, 12.0), xlabel="x [mm]", ylabel="y [mm]")
    coloured(fig, drawn, left, "Mises stress [MPa]")
    exact = hertz_line(35e3, 50.0, contact_modulus(210e3, 0.3, 70e3, 0.3))
    contact = result.contact(0).last
    x = np.linspace(0.0, 8.0, 500)
    curve(right, x, exact.pressure(x), contact.x[:, 0], contact.pressure, closed="Hertz 1882",
          xlabel="x [mm]", ylabel="contact pressure [MPa]")
    right.set(xlim=(0.0, 8.0), ylim=(0.0, None))
    save(fig, "nafems_cylinder")


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


def ball_of_facets() -> None:
    """Pressure under a ball of triangles beside that of the round one."""
    ball = hertz_point_approach(0.02, 50.0, contact_modulus(20e3, 0.3))
    contact = solved("ball_of_facets").contact(0).last
    fig, ax = figure()
    r = np.linspace(0.0, 1.5, 500)
    curve(ax, r, ball.pressure(r), np.hypot(*contact.x[:, :2].T), contact.pressure,
          closed="Hertz 1882", xlabel="distance from the axis [mm]",
          ylabel="contact pressure [MPa]")
    ax.set(xlim=(0.0, 1.6))
    save(fig, "ball_of_facets")


def rough_punch() -> None:
    """Pressure and shear under the rough punch, beside boundary elements with the full coupling."""
    from lopin.closed_punch import punch_stick, punch_tractions
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


def patch_test() -> None:
    """Vertical stress; exact would be one colour."""
    result = solved("patch_test")
    fig, ax = figure(6.4, 4.2)
    drawn = deformed(ax, result, -result["S"][:, 1], scale=200.0, limits=(0.8, 1.2), grid=0.8,
                     colours=SIGNED)
    ax.set(xlabel="x", ylabel="y (deformation x 200)")
    ax.set_title("exact: 1 everywhere", fontsize=9)
    coloured(fig, drawn, ax, "- vertical stress")
    save(fig, "patch_test")


def two_blocks_mortar() -> None:
    """Pressure along the interface, by mortar and node to segment."""
    fig, (left, ax) = figure(8.4, 3.6, columns=2)
    words = "TYPE=SURFACE TO SURFACE"
    mortar = solved("two_blocks_mortar")
    nodes = solved("two_blocks_mortar", **{words: "TYPE=NODE TO SURFACE"})
    drawn = deformed(left, mortar, -mortar["S"][:, 1], scale=200.0, limits=(0.8, 1.2), grid=0.8,
                     colours=SIGNED)
    left.set(xlabel="x", ylabel="y (deformation x 200)")
    coloured(fig, drawn, left, "- vertical stress, mortar")
    for result, label, colour in ((nodes, "node to segment", EXACT), (mortar, "mortar", DOTS)):
        contact = result.contact(0).last
        order = np.argsort(contact.x[:, 0])
        ax.plot(contact.x[order, 0], contact.pressure[order], "o-", ms=4.5, lw=1.0, color=colour,
                label=label)
    ax.set(xlabel="x", ylabel="contact pressure, exact: 1", ylim=(0.9, 1.06))
    ax.legend(frameon=False)
    save(fig, "two_blocks_mortar")


def signorini() -> None:
    """Pressure against the closed form."""
    contact = solved("signorini").contact(0).last
    fig, ax = figure()
    x = np.linspace(0.0, 1.0, 2000)
    free = contact.x[:, 0] > 1e-9   # the corner is held by its support
    curve(ax, x, 10.0*np.sqrt(np.maximum(0.0, 0.5 - x)), contact.x[free, 0], contact.pressure[free],
          closed="10 sqrt(1/2 - x), exact", xlabel="x", ylabel="contact pressure")
    save(fig, "signorini")


def strip_bending() -> None:
    """The bent strip with punch and die."""
    result = solved("strip_bending")
    index = int(np.argmin(np.abs(result.times - 1.0)))
    stress = result.at(index)["S"][:, 0]
    fig, ax = figure(8.0, 3.0)
    # The very points of contact are singular.
    drawn = deformed(ax, result, stress, scale=6.0, index=index, limits=(-270.0, 270.0), grid=0.2,
                     colours=SIGNED)
    tools(ax, result, scale=6.0, index=index)
    ax.set(xlim=(-1.0, 62.0), ylim=(-8.0, 8.0), xlabel="x [mm]", ylabel="y [mm], motion x 6")
    ax.text(4.0, 3.2, "punch"), ax.text(46.0, -3.0, "die")
    coloured(fig, drawn, ax, "stress along the strip [MPa]")
    save(fig, "strip_bending")


def glued_beam() -> None:
    """The beam with the deflections of theory."""
    result = solved("glued_beam")
    fig, ax = figure(8.0, 3.2)
    drawn = deformed(ax, result, result["S"][:, 0], scale=3.0, limits=(-600.0, 600.0),
                     colours=SIGNED)
    x = np.linspace(0.0, 100.0, 200)
    ei = 210e3*1000.0/12.0
    deflection = 100.0*x**2*(300.0 - x)/(6.0*ei)
    ax.plot(x, -3.0*deflection, "k--", lw=1.2, label="one beam of 10 mm")
    ax.plot(x, -12.0*deflection, ":", color=EXACT, lw=2, label="two loose beams of 5 mm")
    ax.legend(frameon=False, loc="lower left")
    ax.set(xlabel="x [mm]", ylabel="y [mm], deflection x 3")
    coloured(fig, drawn, ax, "stress along the beam [MPa]")
    save(fig, "glued_beam")


def shrink_fit() -> None:
    """Radial and hoop stress through both rings."""
    result = solved("shrink_fit")
    points, stress = result.to_meshio().points, result["S"]
    outer, inner = nested_rings((30.0, 20.0, 10.0), 0.0, (210e3,)*2, (0.3,)*2, "plane stress", 0.01)
    fig, ax = figure()
    for tube, first, last, body in ((inner, 10.0, 20.0, "shaft"), (outer, 20.0, 30.0, "sleeve")):
        r = np.linspace(first, last, 200)
        exact = tube.stress(r)
        new = body == "shaft"
        ax.plot(r, exact[:, 0], color=EXACT, lw=2.5, label="Lamé" if new else None)
        ax.plot(r, exact[:, 1], color=EXACT, lw=2.5)
    row = np.abs(points[:, 1] - 2.0) < 1e-9
    ax.plot(points[row, 0], stress[row, 0], "o", ms=4.5, color=DOTS, label="Lopin, radial")
    ax.plot(points[row, 0], stress[row, 2], "s", ms=4, color="#1f6f8b", label="Lopin, hoop")
    ax.text(15.0, 25.0, "shaft", ha="center"), ax.text(25.0, 25.0, "sleeve", ha="center")
    ax.axvline(20.0, color=INK, lw=0.6, ls=":")
    ax.set(xlabel="radius [mm]", ylabel="stress [MPa]", xticks=range(10, 31, 5))
    ax.legend(frameon=False, loc="lower right")
    save(fig, "shrink_fit")


def no_separation() -> None:
    """The block pushed and pulled."""
    result = solved("no_separation")
    fig, axes = figure(8.0, 3.4, 2)
    said = ("pushed down: the plate carries", "pulled up: the plate holds it by")
    for ax, index, word in zip(axes, (0, len(result.times) - 1), said):
        stress = result.at(index)["S"][:, 1]
        drawn = deformed(ax, result, stress, scale=100.0, index=index, limits=(-250.0, 250.0),
                         grid=0.8, colours=SIGNED)
        tools(ax, result, scale=100.0, index=index)
        ax.plot([0, 10, 10, 0, 0], [0, 0, 10, 10, 0], "k--", lw=0.8)
        force = result.history["PLATE.rf2"][index]
        ax.set_title(f"{word} {abs(force):.0f} N", fontsize=9)
        ax.set(xlim=(-2.0, 13.0), ylim=(-1.0, 12.0), xlabel="x [mm]")
    axes[0].set_ylabel("y [mm], displacement x 100")
    coloured(fig, drawn, list(axes), "vertical stress [MPa]")
    save(fig, "no_separation")


def ball_on_ball() -> None:
    """Pressure over the distance from the axis, beside the vertical stress in the block."""
    result = solved("ball_on_ball")
    contact = result.contact(0).last
    exact = hertz_point(879.12, 100.0/3.0, contact_modulus(20e3, 0.3))
    fig, (left, right) = figure(8.0, 3.6, 2)
    piece = result.to_meshio()
    x, stress = piece.points, result["S"][:, 2]
    face = [c for c in piece.cells[0].data[:, [0, 1, 5, 4]] if np.abs(x[c, 1]).max() < 1e-9]
    triangles = np.array([t for c in face for t in (c[[0, 1, 2]], c[[0, 2, 3]])])
    drawn = left.tripcolor(x[:, 0], x[:, 2], triangles, stress, shading="gouraud", cmap=MAP,
                           vmin=-400.0, vmax=0.0)
    left.triplot(x[:, 0], x[:, 2], triangles, lw=0.0)
    for c in face:
        left.plot(*x[c[[0, 1, 2, 3, 0]]][:, [0, 2]].T, color="k", lw=0.3, alpha=0.4)
    r = np.linspace(0.0, 6.0, 200)
    left.plot(r, -100.0 + np.sqrt(100.0**2 - r**2), color="#3b4a5a", lw=2.2)
    left.set(xlabel="x [mm]", ylabel="z [mm]", aspect="equal", xlim=(0.0, 6.0), ylim=(-0.5, 6.0))
    coloured(fig, drawn, left, "vertical stress in y = 0 [MPa]")
    r = np.linspace(0.0, 1.5, 500)
    curve(right, r, exact.pressure(r), np.hypot(*contact.x[:, :2].T), contact.pressure,
          closed="Hertz 1882", xlabel="distance from the axis [mm]",
          ylabel="contact pressure [MPa]")
    save(fig, "ball_on_ball")


def beam_on_roller() -> None:
    """Deflection of the axis against beam theory, with and without the roller."""
    result = solved("beam_on_roller")
    points = result.to_meshio().points
    axis = (np.abs(points[:, 1]) < 1e-9) & (np.abs(points[:, 2] - 2.0) < 1e-9)
    fig, ax = figure()
    x, ei, shear = np.linspace(0.0, 100.0, 300), 210e3*256.0/12.0, 5.0/6.0*105e3*16.0

    def under(force: float, at: float) -> np.ndarray:
        """Deflection of a cantilever under a force at one place."""
        low = np.minimum(x, at)
        return force*(low**2*(3.0*np.maximum(x, at) - low)/(6.0*ei) + low/shear)

    ax.plot(x, -under(20.0, 100.0), ":", color=EXACT, lw=2, label="beam theory, no roller")
    curve(ax, x, under(14.3834, 80.0) - under(20.0, 100.0), points[axis, 0],
          result.at(0)["U"][axis, 2], closed="beam theory on the roller", xlabel="x [mm]",
          ylabel="deflection of the axis [mm]")
    ax.plot(80.0, -0.5, "^", ms=11, color="#3b4a5a", mew=0, zorder=0)
    force = result.history["ROLLER.rf3"][0]
    ax.text(81.0, -0.42, f"roller, {force:.2f} N")
    save(fig, "beam_on_roller")


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


def closed_die() -> None:
    """The billet between its dies three times, and the force of the press."""
    result = solved("closed_die")
    last = len(result.times) - 1
    fig, axes = figure(9.6, 2.6, 4)
    for ax, k in zip(axes, (0, 3*last//4, last)):
        drawn = deformed(ax, result, result.at(k)["PEEQ"], scale=1.0, index=k, limits=(0.0, 1.5),
                         grid=0.15)
        tools(ax, result, scale=1.0, index=k)
        ax.set(xlim=(0.0, 30.0), ylim=(0.0, 18.0), xlabel="r [mm]")
        ax.set_title(f"{5.0*result.times[k]/result.times[-1]:.1f} mm", fontsize=9)
    axes[0].set_ylabel("z [mm]")
    coloured(fig, drawn, list(axes[:3]), "plastic strain")
    axes[3].plot(-result.history["DIE.u2"], -result.history["DIE.rf2"]/1e3, color=DOTS)
    axes[3].set(xlabel="stroke [mm]", ylabel="force [kN]", ylim=(0.0, None))
    save(fig, "closed_die")


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
    ax.plot(percent, [100.0*ring_bore(0.1, p/100.0, steps=400) if p else 0.0 for p in percent],
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


def blank_edge(result) -> tuple[np.ndarray, np.ndarray]:
    """The lower edge of the blank at first and at last."""
    piece = result.to_meshio(-1)
    x, u = piece.points, np.asarray(piece.point_data["U"])
    low = np.abs(x[:, 2]) < 1e-9
    side = np.flatnonzero(low & (np.abs(x[:, 0] - 75.0) < 1e-9))
    back = np.flatnonzero(low & (np.abs(x[:, 1] - 75.0) < 1e-9) & (x[:, 0] < 74.9))
    around = np.concatenate([side[np.argsort(x[side, 1])], back[np.argsort(-x[back, 0])]])
    return x[around, :2], (x + u)[around, :2]


DRAWN = {f.__name__: f for f in (
    bar_gap, two_springs, cylinder_on_plane, flat_punch, hertz_sphere, hertz_sphere_3d, lifted_beam,
    nafems_cylinder, cattaneo, capstan, ball_of_facets, rough_punch, nafems_punch, patch_test,
    two_blocks_mortar, signorini, strip_bending, glued_beam, shrink_fit, no_separation,
    ball_on_ball, beam_on_roller, crushed_ring, ironing, rotating_rings,
    folded_strip, beam_over_corner, upsetting, ring_compression, wire_drawing, sliding_ball,
    closed_die, upset_tetra, cup, square_cup, v_bending)}


def main(names: list[str]) -> None:
    """Draw the pictures of these decks, or all."""
    for name in names or DRAWN:
        DRAWN[name]()
        print(f"{name}.png: {(PICTURES/f'{name}.png').stat().st_size//1000} kB")


if __name__ == "__main__":
    main(sys.argv[1:])
