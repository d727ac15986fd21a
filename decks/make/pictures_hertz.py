"""Pictures of the decks with closed forms: by hand, Hertz, beams and strips, patch tests."""
from __future__ import annotations

import numpy as np
from drawing import (
    DOTS,
    EXACT,
    INK,
    MAP,
    SIGNED,
    coloured,
    curve,
    deformed,
    figure,
    save,
    solved,
    tools,
)

from lopin.closed_form import (
    contact_modulus,
    flat_punch_axisymmetric_pressure,
    hertz_line,
    hertz_point,
    hertz_point_approach,
    nested_rings,
)
from lopin.closed_form import lifted_beam as lifted_beam_exact


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


def signorini() -> None:
    """Pressure against the closed form."""
    contact = solved("signorini").contact(0).last
    fig, ax = figure()
    x = np.linspace(0.0, 1.0, 2000)
    free = contact.x[:, 0] > 1e-9   # the corner is held by its support
    curve(ax, x, 10.0*np.sqrt(np.maximum(0.0, 0.5 - x)), contact.x[free, 0], contact.pressure[free],
          closed="10 sqrt(1/2 - x), exact", xlabel="x", ylabel="contact pressure")
    save(fig, "signorini")


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
