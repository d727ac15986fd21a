"""Closed forms against published numbers, and against the equations they solve."""
import doctest
import math

import numpy as np
import pytest

from lopin import closed_form as cf
from lopin.closed_form import hertz as closed_hertz
from lopin.closed_form import signorini as closed_signorini
from lopin.closed_form import solids as closed_solids


@pytest.mark.parametrize("module", [closed_hertz, closed_signorini, closed_solids])
def test_examples_in_docstrings(module):
    result = doctest.testmod(module)
    assert result.attempted > 3
    assert result.failed == 0


def test_roller_on_block_has_the_published_width_and_pressure():
    h = cf.hertz_line(35e3, 50.0, cf.contact_modulus(210e3, 0.3, 70e3, 0.3))
    assert h.a == pytest.approx(6.21463, rel=1e-6)
    assert h.p0 == pytest.approx(3585.36, rel=1e-5)
    approach = cf.hertz_line_approach(35e3, h.a, 70e3, 0.3, depth=200.0)
    assert approach == pytest.approx(1.14424, rel=1e-5)


def test_flat_on_cylinder():
    h = cf.hertz_line(1000.0, 100.0, cf.contact_modulus(210e3, 0.3))
    assert (h.a, h.p0) == pytest.approx((0.742790, 857.0655), rel=1e-6)


def test_two_equal_spheres_crushed():
    half = cf.relative_radius(50.0, 50.0)
    h = cf.hertz_point_approach(4.0, half, cf.contact_modulus(2e4, 0.3, 2e4, 0.3))
    assert (h.a, h.p0) == pytest.approx((10.0, 2798.3287), rel=1e-7)


@pytest.mark.parametrize("contact, dimension", [
    (cf.hertz_line(1000.0, 20.0, 5e4), 1), (cf.hertz_point(1000.0, 20.0, 5e4), 2)])
def test_hertz_pressure_integrates_to_the_force(contact, dimension):
    nodes, weights = np.polynomial.legendre.leggauss(200)
    r = 0.5*contact.a*(nodes + 1.0)
    measure = 2.0 if dimension == 1 else 2.0*np.pi*r
    total = (weights*0.5*contact.a*measure*contact.pressure(r)).sum()
    assert total == pytest.approx(contact.force, rel=1e-5)


def test_yield_starts_under_the_surface():
    assert cf.first_yield_line(0.3)[0] == pytest.approx(1.79367, rel=1e-5)
    assert cf.first_yield_point(0.3) == pytest.approx((1.6128, 0.48086), rel=2e-4)
    depth = np.linspace(0.01, 2.0, 20001)
    s = cf.HertzLine(0.0, 1.0, 1.0).axis_stress(depth, 0.3)
    shear = 0.5*np.abs(s[:, 0] - s[:, 1])
    assert (shear.max(), depth[shear.argmax()]) == pytest.approx((0.30028, 0.78615), rel=1e-3)


def test_punches():
    pressure = cf.flat_punch_axisymmetric_pressure(1000.0, 10.0, 0.0)
    assert pressure == pytest.approx(1.591549, rel=1e-6)
    assert cf.flat_punch_2d(1000.0, 10.0, [-11.0, 10.0]).tolist() == [0.0, 0.0]
    cone = cf.cone_punch(0.05, 10.0, cf.contact_modulus(210e3, 0.3))
    assert (cone.a, cone.force) == pytest.approx((0.180523, 2082.95), rel=1e-5)
    assert cf.boussinesq_point(1000.0, 10.0, 210e3, 0.3) == pytest.approx(1.379343e-4, rel=1e-6)


@pytest.mark.parametrize("slope, reaction, penetration", [
    (210e3, 7181.818182, 0.0341991342), (2100e3, 7821.782178, 3.72465818e-3)])
def test_bar_with_gap(slope, reaction, penetration):
    bar = cf.bar_with_gap(210e3, 100.0, 1000.0, 0.1, 10e3, slope)
    assert (bar.reaction, bar.penetration) == pytest.approx((reaction, penetration), rel=1e-8)


def test_bar_that_does_not_reach_the_wall():
    bar = cf.bar_with_gap(210e3, 100.0, 1000.0, 0.1, 2000.0)
    assert bar.reaction == 0.0
    assert bar.displacement[0] == pytest.approx(0.095238, rel=1e-5)
    assert cf.bar_with_gap(210e3, 100.0, 1000.0, 0.1, 2100.0).reaction == 0.0


def test_augmentation_count():
    k = 21000.0
    for slope, count in ((10*k, 10), (k, 34)):
        beta = cf.penalty_error(slope, 1.0/k)
        assert math.ceil(math.log(1e-10)/math.log(beta)) == count
        assert cf.penalty_slope(beta, 1.0/k) == pytest.approx(slope)


def test_two_springs():
    s = cf.two_springs(1000.0, 500.0, 0.2, 800.0)
    assert (*s.displacement, s.reaction) == pytest.approx((0.6, 0.4, 200.0))
    assert cf.two_springs(1000.0, 500.0, 0.2, 100.0).reaction == 0.0


@pytest.mark.parametrize("poisson, value", [
    (0.3, 1.906667e-3), (0.49, 1.9966e-3), (0.499, 1.999666e-3), (0.4999, 1.99996666e-3)])
def test_thick_tube(poisson, value):
    tube = cf.thick_tube(1.0, 2.0, 1.0, 1000.0, poisson)
    assert tube.displacement(1.0) == pytest.approx(value, rel=1e-6)
    assert tube.stress([1.0, 2.0])[:, 0] == pytest.approx([-1.0, 0.0], abs=1e-15)


def test_concentric_rings_and_shrink_fit():
    outer, inner = cf.nested_rings((1.0, 0.6, 0.2), 1e6, (1e9, 1e9), (0.2, 0.2), "plane stress")
    assert outer.inside == pytest.approx(925925.926)
    assert inner.displacement(0.6) == pytest.approx(-5.83333e-4, rel=1e-5)
    for kind, pressure in (("plane stress", 20.740741), ("plane strain", 22.792022)):
        outer, _ = cf.nested_rings((50.0, 30.0, 10.0), 0.0, (210e3,)*2, (0.3,)*2, kind, 0.01)
        assert outer.inside == pytest.approx(pressure, rel=1e-7)


def test_lifted_beam_carries_its_weight():
    beam = cf.lifted_beam(1e6, 1.0, 50.0)
    assert beam.deflection(beam.free_length) == pytest.approx(beam.lift)


@pytest.mark.parametrize("field", [cf.signorini_singular, cf.signorini_smooth])
def test_signorini_fields_are_in_equilibrium_and_obey_hooke(field):
    young, poisson, step = 1000.0, 0.3, 1e-4
    points = np.random.default_rng(1).uniform(0.05, 0.95, (40, 2))
    east, north = np.array([step, 0.0]), np.array([0.0, step])

    def difference(direction, name):
        up, down = field(points + direction), field(points - direction)
        return (getattr(up, name) - getattr(down, name))/(2.0*step)

    dx, dy = difference(east, "stress"), difference(north, "stress")
    scale = np.abs(dx).max()
    assert np.abs(dx[:, 0] + dy[:, 2]).max() < 1e-4*scale
    assert np.abs(dx[:, 2] + dy[:, 1]).max() < 1e-4*scale
    ux, uy = difference(east, "u"), difference(north, "u")
    strain = np.stack([ux[:, 0], uy[:, 1]], axis=1)
    lame = young*poisson/((1.0 + poisson)*(1.0 - 2.0*poisson))
    shear = young/(2.0*(1.0 + poisson))
    stress = field(points).stress
    assert lame*strain.sum(axis=1, keepdims=True) + 2.0*shear*strain == pytest.approx(
        stress[:, :2], rel=1e-4, abs=1e-4)
    assert shear*(ux[:, 1] + uy[:, 0]) == pytest.approx(stress[:, 2], rel=1e-4, abs=1e-4)


def test_signorini_contact_conditions():
    x = np.linspace(0.0, 1.0, 401)
    floor = np.stack([x, np.zeros_like(x)], axis=1)
    singular = cf.signorini_singular(floor)
    pressure, gap = -singular.stress[:, 1], singular.u[:, 1]
    assert pressure == pytest.approx(10.0*np.sqrt(np.maximum(0.5 - x, 0.0)), abs=1e-12)
    assert gap.min() > -1e-15 and np.abs(pressure*gap).max() < 1e-15
    assert np.trapezoid(pressure, x) == pytest.approx(2.357022604, rel=1e-3)
    smooth = cf.signorini_smooth(floor)
    assert np.abs(smooth.u[:, 1]).max() < 1e-16
    assert np.trapezoid(-smooth.stress[:, 1], x) == pytest.approx(9.8333333, rel=1e-5)
