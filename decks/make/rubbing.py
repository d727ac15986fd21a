"""Write the decks of a shoe on a moving plate: `python decks/make/rubbing.py`.

The scenes are models: no keyword is written here.
"""
from __future__ import annotations

from math import atan, pi, sqrt
from pathlib import Path

from lopin import Elastic, Material, Model, Plastic, mesh_make, profile
from lopin.friction import Coulomb, Friction, NortonHoffFriction, Orowan

FOLDER = Path(__file__).resolve().parents[1]
WIDTH, HEIGHT = 10.0, 1.0


def shoe(name: str, friction: Friction, *laws) -> tuple[Model, object]:
    """A block with its top held sideways, on a plate; the tool."""
    mesh = mesh_make.block((WIDTH, HEIGHT), (20, 4))
    model = Model(name, mesh, kind="plane strain", units="N mm s")
    model.section("ALL", Material(Elastic(2.1e5, 0.3), *laws, name="SHOE"))
    plate = model.rigid_tool("PLATE", profile.plane(0.0, 40.0, side="above"), ref=(5.0, 0.0))
    model.contact("BOTTOM", plate, friction=friction)
    model.fix("TOP", "x")
    return model, plate


def write(model: Model, comment: str) -> None:
    """The deck, below its comment."""
    head = "\n".join(f"** {line}".rstrip() for line in comment.strip().splitlines())
    text = model.to_deck().text()
    (FOLDER/f"{model.name}.inp").write_text(f"{head}\n{text}", encoding="utf-8")


def orowan() -> None:
    """Coulomb's law below a pressure, the shear limit above it."""
    mu, m, yield_stress = 0.2, 0.1, 400.0
    limit = m*yield_stress/sqrt(3.0)
    model, plate = shoe("orowan_shoe", Orowan(mu, m), Plastic(yield_stress, only_friction=True))
    for name, pressure, way in (("LIGHT", 50.0, 0.1), ("HEAVY", 400.0, 0.2)):
        step = model.step(10, name=name).pressure("TOP", pressure).move(plate, x=way)
        step.output(("U",), ("S",), ("CDIS", "CSTR"))
    write(model, f"""
A shoe on a moving plate, friction of Coulomb and Orowan: mu p, but never above m k.

            p              mu = {mu}, m = {m}; the shoe's metal yields at {yield_stress:g} MPa, k = 230.94 MPa,
    |  |  |  |  |  |       which friction alone reads here (ONLY=FRICTION).
    ================       p = 50 MPa: mu p = 10 MPa, a drag of 100 N.
  ------------------- ->   p = 400 MPa: mu p = 80 MPa is above m k = {limit:.4f} MPa: {limit*WIDTH:.3f} N.

expect: certificate.verdict = PASS
expect: history.PLATE.rf1 at 1 = 100 +- 1e-6
expect: history.PLATE.rf1 at 2 = {limit*WIDTH:.6f} +- 1e-5
""")


def norton_hoff() -> None:
    """A lubricant whose shear grows with the speed."""
    alpha, q = 5.0, 0.3
    model, plate = shoe("viscous_shoe", NortonHoffFriction(alpha, q))
    for name, speed in (("SLOW", 1.0), ("FAST", 10.0)):
        step = model.step(10, name=name, at_once=True).pressure("TOP", 100.0)
        step.move(plate, x=speed, velocity=True)
        step.output(("U",), ("S",), ("CDIS", "CSTR"))
    write(model, f"""
A shoe on a moving plate, viscous friction of Norton and Hoff: the shear is alpha v^q.

            p              alpha = {alpha:g} MPa (s/mm)^q, q = {q}; p = 100 MPa does not matter.
    |  |  |  |  |  |       v = 1 mm/s: 5 MPa on 10 mm2, a drag of 50 N once the shoe is sheared.
    ================       v = 10 mm/s: 5 10^0.3 MPa, {alpha*10.0**q*WIDTH:.3f} N.
  ------------------- ->

expect: certificate.verdict = PASS
expect: history.PLATE.rf1 at 1 = 50 +- 1e-4
expect: history.PLATE.rf1 at 2 = {alpha*10.0**q*WIDTH:.6f} +- 1e-4
""")


def arctan() -> None:
    """Coulomb's law without stick, smooth in the speed."""
    mu, v0 = 0.2, 1.0
    model, plate = shoe("arctan_shoe", Coulomb(mu, regularization="arctan", v0=v0))
    for name, speed in (("SLOW", 1.0), ("FAST", 10.0)):
        step = model.step(10, name=name, at_once=True).pressure("TOP", 100.0)
        step.move(plate, x=speed, velocity=True)
        step.output(("U",), ("S",), ("CDIS", "CSTR"))
    fast = 2.0/pi*atan(10.0)
    write(model, f"""
A shoe on a moving plate, Coulomb friction regularised by an arctangent: 2/pi atan(v/v0) mu p.

            p              mu = {mu}, p = 100 MPa on 10 mm2, V0 = {v0:g} mm/s: nothing sticks, and the whole
    |  |  |  |  |  |       200 N of Coulomb's law are never reached.
    ================       v = v0: half of them, 100 N.
  ------------------- ->   v = 10 v0: {fast:.6f} of them, {200.0*fast:.4f} N.

expect: certificate.verdict = PASS
expect: history.PLATE.rf1 at 1 = 100 +- 1e-4
expect: history.PLATE.rf1 at 2 = {200.0*fast:.6f} +- 1e-4
""")


if __name__ == "__main__":
    orowan()
    norton_hoff()
    arctan()
