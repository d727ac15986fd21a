"""Hertz's sphere, solved in this process and drawn beside the closed form.

A rigid sphere, R = 50 mm, pressed 0.02 mm into a block, E = 20000 MPa, nu = 0.3, 40 times as large
as the contact. Run it by: python hertz_sphere.py
"""
from lopin import Elastic, Model, closed_form, mesh_make, plot, profile

mesh = mesh_make.block((40.0, 40.0), (80, 80), origin=(0.0, -40.0), grading=(70.0, 1/70.0))
model = Model("hertz_sphere", mesh, kind="axisymmetric", units="N mm")
model.section("ALL", Elastic(20e3, 0.3))
ball = model.rigid_tool("ball", profile.arc((0.0, 50.0), 50.0), ref=(0.0, 50.0))
model.contact("TOP", ball)
model.fix("LEFT", "r")
model.fix("BOTTOM", "z")
model.step().move(ball, z=-0.02)
result = model.run()

force = -result.history["BALL.rf2"][-1]
exact = closed_form.hertz_sphere_plane(force, 50.0, 20e3, 0.3)
contact = result.contact("TOP").last
print(f"force {force:.2f} N, pressure {contact.pressure.max():.2f} MPa, Hertz {exact.p0:.2f} MPa")
ax = plot.pressure(contact, exact.pressure)
ax.set(xlim=(0.0, 2.0*exact.a), title="Rigid sphere on an elastic block")
ax.figure.savefig("hertz_sphere.png", dpi=150)
