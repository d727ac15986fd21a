"""Closed forms with friction against published numbers, and against the equations they solve.

Numbers quoted: Johnson, Contact mechanics (1985), 7.2 to 7.4; Mindlin and Deresiewicz (1953);
Spence (1975), and boundary elements with the full coupling, n = 160, 320, 640, extrapolated;
Klarbring (1990); capstan tables.
"""
import doctest

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

from lopin import closed_form as cf
from lopin.closed_form import forming as closed_forming
from lopin.closed_form import friction as closed_friction
from lopin.closed_form import punch as closed_punch

STEEL = cf.contact_modulus(210e3, 0.3, 210e3, 0.3)


@pytest.mark.parametrize("module", [closed_forming, closed_friction, closed_punch])
def test_examples_in_docstrings(module):
    result = doctest.testmod(module)
    assert result.attempted >= 2
    assert result.failed == 0


def test_cattaneo_has_the_published_numbers():
    s = cf.cattaneo_line(1000.0, 150.0, 0.3, 100.0, STEEL)
    assert (s.normal.a, s.c, s.normal.p0) == pytest.approx((1.050464, 0.742790, 606.037), rel=1e-6)
    assert (s.q_centre, s.q_largest) == pytest.approx((53.2512, 128.5598), rel=1e-6)


def test_cattaneo_s_shear_sums_to_the_force_and_stays_in_the_cone():
    s = cf.cattaneo_line(1000.0, 220.0, 0.3, 100.0, STEEL)
    total = quad(s.traction, -s.normal.a, s.normal.a, points=[-s.c, s.c])[0]
    assert total == pytest.approx(220.0, rel=1e-6)
    x = np.linspace(-s.normal.a, s.normal.a, 999)
    assert np.all(s.traction(x) <= 0.3*s.normal.p0*np.sqrt(np.clip(1 - (x/s.normal.a)**2, 0, None))
                  + 1e-12)


def test_cattaneo_s_middle_moves_as_one():
    """The surface displaces by -1/(pi E*) times the integral of q ln|x - s|: constant where it
    sticks."""
    s = cf.cattaneo_line(1000.0, 150.0, 0.3, 100.0, STEEL)
    edges = np.linspace(-s.normal.a, s.normal.a, 8001)
    q = s.traction(0.5*(edges[1:] + edges[:-1]))

    def moved(x):
        y = x - edges
        primitive = y*np.log(np.abs(y) + 1e-300) - y
        return float(q @ (primitive[1:] - primitive[:-1]))

    stuck = [moved(f*s.c) for f in (0.1, 0.4, 0.8)]
    assert np.ptp(stuck) < 2e-3*abs(moved(0.97*s.normal.a) - stuck[0])


def test_mindlin_has_the_published_numbers():
    s = cf.mindlin_point(1000.0, 0.3, 10.0, 210e3, 0.3)
    assert (s.normal.a, s.stick_radius(100.0)) == pytest.approx((0.402073, 0.351243), abs=6e-7)
    assert s.displacement(100.0) == pytest.approx(1.394882e-3, rel=1e-6)
    assert s.loop_energy(100.0) == pytest.approx(0.01251884, abs=6e-9)


@pytest.mark.parametrize("amplitude", [30.0, 100.0, 250.0])
def test_mindlin_s_energy_is_the_area_of_his_loop(amplitude):
    s = cf.mindlin_point(1000.0, 0.3, 10.0, 210e3, 0.3)
    q = np.linspace(-amplitude, amplitude, 20001)
    down, up = s.cycle(q, amplitude)
    assert (down[-1], up[-1]) == pytest.approx(2*(s.displacement(amplitude),))
    assert np.trapezoid(down - up, q) == pytest.approx(s.loop_energy(amplitude), rel=1e-5)


@pytest.mark.parametrize("mu, published", [(0.2, 0.3604), (0.3, 0.6891), (0.5, 0.9411)])
def test_the_punch_sticks_as_the_coupled_solution_says(mu, published):
    assert cf.punch_stick(mu, 0.3) == pytest.approx(published, abs=1e-4)


@pytest.mark.parametrize("mu", [0.2, 0.3, 0.5])
def test_without_coupling_the_punch_is_spence_s(mu):
    assert cf.punch_stick(mu, 0.3,
                          coupled=False) == pytest.approx(cf.punch_stick_uncoupled(mu, 0.3),
                                                          abs=2e-4)


def test_the_punch_s_tractions_are_admissible():
    c = cf.punch_stick(0.3, 0.3)
    x, p, q = cf.punch_tractions(c, 0.3, 0.3)
    assert np.all(p > 0.0) and np.all(q <= 0.3*p*(1.0 + 1e-3)) and np.all(q[x > c] == pytest.approx(0.3*p[x > c]))


@pytest.mark.parametrize("mu, angle, published", [
    (0.1, 90, 1.170089), (0.2, 90, 1.369108), (0.3, 90, 1.601978), (0.3, 180, 2.566332)])
def test_capstan(mu, angle, published):
    assert cf.capstan(mu, np.radians(angle)) == pytest.approx(published, rel=1e-6)


@pytest.mark.parametrize("thickness", [0.01, 0.1])
def test_a_thick_belt_obeys_its_balances(thickness):
    """T' = f - Q, T - Q' = f/mu, and the couple of the friction Q (R + t/2) = f t/2, by integration
    over the angle."""
    mu, middle = 0.3, 1.0 + 0.5*thickness
    lever = 0.5*thickness/middle
    # Unknown f: T = f/mu + lever f', so that f'' follows; start on the growing solution by one
    # ratio of T.
    s = np.log(cf.capstan(mu, 1.0, thickness))

    def slope(_, y):
        return [y[1], ((1.0 - lever)*y[0] - y[1]/mu)/lever]

    ends = solve_ivp(slope, (0.0, 1.0), [1.0, s], method="Radau", rtol=1e-9, atol=1e-12).y
    tension = ends[0]/mu + lever*ends[1]
    assert tension[-1]/tension[0] == pytest.approx(cf.capstan(mu, 1.0, thickness), rel=1e-6)
    # To first order: friction at R, tension at R + t/2.
    assert s == pytest.approx(mu/middle, rel=0.6*thickness)


def test_stick_slip_cycle():
    assert cf.stick_slip_energy(1000.0, 30.0, 0.1) == pytest.approx(8.4, rel=1e-12)
    assert cf.stick_slip_energy(1000.0, 30.0, 0.03) == 0.0


def test_rotating_slider_against_many_small_steps():
    s = cf.rotating_slider(1000.0, 30.0, 0.2)
    assert (np.degrees(s.lag), s.energy) == (pytest.approx(81.37, abs=5e-3),
                                             pytest.approx(37.2726, abs=5e-5))
    slider, energy, n = np.zeros(2), 0.0, 20000
    for i in range(3*n):
        end = 0.2*np.array([np.cos(2*np.pi*i/n), np.sin(2*np.pi*i/n)])
        pull = 1000.0*(end - slider)
        size = np.linalg.norm(pull)
        if size > 30.0:
            move = (1.0 - 30.0/size)*(end - slider)
            slider = slider + move
            energy += 30.0*np.linalg.norm(move) if i >= 2*n else 0.0
    assert energy == pytest.approx(s.energy, rel=1e-3)


def test_the_answer_depends_on_the_path():
    down, aside = (0.1, 0.0), (0.1, 0.02)
    paths = {20.0: [down, aside], 0.0: [(0.0, 0.02), aside],
             15.0: [down, aside, (0.05, 0.02), aside]}
    for force, path in paths.items():
        assert cf.slider_path(1000.0, 1000.0, 0.3, path) == pytest.approx(force, abs=1e-12)


def test_klarbring_s_node():
    k = [[4.0, 1.6], [1.6, 1.0]]
    assert cf.unique_below(k) == pytest.approx(0.625, rel=1e-12)
    (free,) = cf.one_node(k, (1.0, 0.9), 0.3)
    assert free.displacement == pytest.approx((-0.305556, 1.388889), abs=6e-7)
    free, stick, slip = cf.one_node(k, (1.0, 0.9), 1.0)
    assert stick.reaction == (1.0, 0.9)
    assert (slip.displacement[1], slip.reaction[0]) == pytest.approx((0.166667, 0.733333), abs=6e-7)
    free, stick, slip = cf.one_node(k, (1.0, 0.65), 0.7)
    assert (slip.displacement[1], slip.reaction[0]) == pytest.approx((0.416667, 0.333333), abs=6e-7)
    for s in cf.one_node(k, (1.0, 0.65), 0.7):
        assert np.array(k) @ s.displacement + s.reaction == pytest.approx([1.0, 0.65], abs=1e-12)


@pytest.mark.parametrize("poisson, least, shear", [
    (0.0, 2.8284, None), (0.3, 1.4967, 1.8708), (0.4, 0.97980, None), (0.49, 0.28566, 7.1414),
                                                   (0.499, 0.08953, None)])
def test_one_triangle_loses_uniqueness(poisson, least, shear):
    found, at = cf.triangle_unique_below_least(poisson)
    assert found == pytest.approx(least, rel=4e-5)
    assert shear is None or at == pytest.approx(shear, abs=5e-5)
    assert found <= min(cf.triangle_unique_below(poisson, t)
                        for t in np.linspace(0.2, 60.0, 2000)) + 1e-12


def test_one_triangle_from_its_stiffness(core):
    from lopin import _bridge

    k = _bridge.probe_stiffness("CPE3", [[0, 0], [1, 0], [-6, 1]], 1000.0, 0.49)[:2, :2]
    assert (k[0, 0], abs(k[0, 1]), k[1, 1]) == pytest.approx((16778.523, 58724.832, 419463.09),
                                                             rel=1e-7)
    turned = k[::-1, ::-1]
    assert cf.unique_below(turned) == pytest.approx(0.285714, abs=6e-7)
    assert cf.triangle_unique_below(0.49, 7.0) == pytest.approx(cf.unique_below(turned), rel=1e-12)


def test_wedge():
    assert [cf.wedge_stays(np.radians(10.0), mu) for mu in (0.17, 0.176326, 0.176328,
                                                            0.2)] == [False, False, True, True]


def test_the_zoo_of_laws():
    zoo = cf.dragged_tractions(100.0, 2.0, mu=0.3, m=0.2, yield_stress=200.0, mises=150.0,
                               alpha=5.0, q=0.2)
    assert list(zoo.values()) == pytest.approx([30.0, 23.0940, 23.0940, 17.3205, 5.743492],
                                               rel=2e-6)


def test_shrink_fit_and_its_torque():
    radii, steel = (10.0, 30.0, 50.0), (210e3, 210e3)
    for kind, pressure in (("plane stress", 20.740741), ("plane strain", 22.792022)):
        outer, inner = cf.nested_rings(radii[::-1], 0.0, steel, (0.3, 0.3), kind, interference=0.01)
        assert outer.inside == pytest.approx(pressure, rel=1e-7)
        assert cf.shrink_fit_torque(outer.inside, 30.0,
                                    0.2) == pytest.approx(2*np.pi*0.2*pressure*900.0, rel=1e-7)


def test_concentric_rings():
    for kind, moved in (("plane stress", -5.83333e-4), ("plane strain", -5.33333e-4)):
        outer, inner = cf.nested_rings((1.0, 0.6, 0.2), 1e6, (1e9, 1e9), (0.2, 0.2), kind)
        assert outer.inside == pytest.approx(925925.926, rel=1e-9)
        assert float(inner.displacement(0.6)) == pytest.approx(moved, rel=1e-5)
