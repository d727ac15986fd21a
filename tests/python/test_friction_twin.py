"""The laws of friction against a second writing of them, which shares nothing with the first but
the formulas.

The twin returns to the disc by bisection on the slip, in vectors of the tangent plane; slopes come
from differences.
"""
import numpy as np
import pytest

from lopin import _bridge
from lopin.closed_form.friction import dragged_tractions
from lopin.friction import law_words

LAWS = list(law_words())
CURVES = {"ARCTAN": lambda x: 2.0/np.pi*np.arctan(x), "TANH": np.tanh,
          "SQRT": lambda x: x/np.sqrt(1.0 + x*x)}
SCENES = {
    "plain": dict(mu=0.3, m=0.2, alpha=5.0, q=0.2),
    "capped": dict(mu=0.3, m=0.2, alpha=5.0, q=0.2, tau_max=8.0),
    "decaying": dict(mu=0.1, mu_static=0.6, decay=0.4, m=0.9, alpha=25.0, q=0.8),
    "steep": dict(mu=1.4, m=1.0, alpha=30.0, q=0.02),
}
AT = dict(yield_stress=200.0, mises=150.0, dt=0.3, speed=0.7)
STIFFNESS = 60.0
RISE = 10.0    # with the pressure, of bounds that are stresses


@pytest.fixture
def probe(core):
    """Kernels as Python sees them."""
    return _bridge.probe_friction


def bound(law, p, mu=0.0, mu_static=0.0, decay=0.0, m=0.0, alpha=0.0, q=0.0, tau_max=np.inf):
    """tau(v) that the slip of a speed v meets, without any regularisation."""
    if p <= 0.0:
        return lambda v: 0.0
    if decay:
        mu = mu + (mu_static - mu)*np.exp(-decay*AT["speed"])
    if law in ("TRESCA", "CRISTESCU", "NORTON-HOFF"):
        tau_max = min(tau_max, RISE*p)

    def formula(v):
        return dragged_tractions(p, v, mu=mu, m=m, yield_stress=AT["yield_stress"],
                                 mises=max(AT["mises"], 1e-3*p), alpha=alpha, q=q).get(law)

    if formula(1.0) is None:    # no second writing in closed_form: the radius of the kernel itself
        own = _bridge.probe_friction(law, 1e12, p, mu=mu, m=m, alpha=alpha, q=q, **AT)[0, 0]
        return lambda v: min(tau_max, own)
    return lambda v: min(tau_max, formula(v))


def returned(law, trial, p, data):
    """The magnitude left when the slip has taken what it can: q - c s = tau(s/dt), by bisection."""
    tau = bound(law, p, **data)
    q = np.linalg.norm(trial)
    if law != "NORTON-HOFF" and q <= tau(0.0):
        return q
    low, high = 0.0, q/STIFFNESS
    for _ in range(200):
        middle = 0.5*(low + high)
        if q - STIFFNESS*middle > tau(middle/AT["dt"]):
            low = middle
        else:
            high = middle
    return tau(high/AT["dt"]) if law != "NORTON-HOFF" else min(tau(high/AT["dt"]), q)


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("law", LAWS)
def test_the_return_is_the_one_of_the_twin(probe, law, scene):
    rng = np.random.default_rng(3)
    trials = rng.normal(size=(60, 2))*10.0**rng.uniform(-1.0, 2.5, size=(60, 1))
    pressures = np.concatenate([[0.0, -3.0], 10.0**rng.uniform(-2.0, 5.5, 58)])
    mine = probe(law, np.linalg.norm(trials, axis=1), pressures, stiffness=STIFFNESS, **AT,
                 **SCENES[scene])[0]
    twin = [returned(law, trial, p, SCENES[scene]) for trial, p in zip(trials, pressures)]
    # Where 1/q is 50 the slip is a 50th power of the traction: bisection on the slip ends at its
    # rounding.
    assert mine == pytest.approx(np.array(twin), rel=1e-10, abs=1e-10)


@pytest.mark.parametrize("curve", CURVES)
@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("law", LAWS)
def test_a_regularised_law_is_the_bound_times_the_curve(probe, law, scene, curve):
    rng = np.random.default_rng(4)
    slips = 10.0**rng.uniform(-4.0, 1.0, 50)
    pressures = 10.0**rng.uniform(-2.0, 5.0, 50)
    v0 = 0.05
    data = SCENES[scene]
    mine = probe(law, slips, pressures, regularization=curve, v0=v0, **AT, **data)
    for slip, p, traction in zip(slips, pressures, mine[0]):
        v = slip/AT["dt"]
        speed = np.hypot(v, v0) if law == "NORTON-HOFF" else v
        assert traction == pytest.approx(bound(law, p, **data)(speed)*CURVES[curve](v/v0),
                                         rel=1e-12)


@pytest.mark.parametrize("curve", ["LINEAR", *CURVES])
@pytest.mark.parametrize("law", LAWS)
def test_slopes_are_differences_of_fourth_order(probe, law, curve):
    rng = np.random.default_rng(5)
    argument = 10.0**rng.uniform(-3.0, 2.0, 40)
    pressures = 10.0**rng.uniform(-2.0, 3.0, 40)

    def at(x, p):
        return probe(law, x, p, regularization=curve, stiffness=STIFFNESS, v0=0.05, **AT,
                     **SCENES["plain"])

    exact = at(argument, pressures)
    for row, (dx, dp) in enumerate([(1e-3*argument, 0.0), (0.0, 1e-3*pressures)], start=1):
        values = [at(argument + k*dx, pressures + k*dp)[0] for k in (-2, -1, 1, 2)]
        slope = (values[0] - 8.0*values[1] + 8.0*values[2] - values[3])/(12.0*(dx + dp))
        # Two of the forty points may straddle a kink of the law.
        error = np.abs(slope - exact[row])/(np.abs(exact[row]) + exact[0]/(dx + dp)*1e-3 + 1e-6)
        assert np.sort(error)[:-2].max() < 1e-8


def test_the_direction_does_not_matter(probe):
    """Isotropy: a turned trial is returned to the turned traction, whatever the tangent basis."""
    angles = np.linspace(0.0, 2.0*np.pi, 17)
    trial = 50.0*np.array([np.cos(angles), np.sin(angles)])
    magnitude = probe("COULOMB", np.linalg.norm(trial, axis=0), 100.0, mu=0.3)[0]
    assert magnitude == pytest.approx(30.0, rel=1e-14)


def test_a_law_that_does_not_exist_is_refused(probe):
    from lopin import UsageError

    for law, curve in [("COULOM", "LINEAR"), ("COULOMB", "ARCTG"), ("AUTO", "LINEAR")]:
        with pytest.raises(UsageError):
            probe(law, 1.0, 1.0, regularization=curve, mu=0.1)
