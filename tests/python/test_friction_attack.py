"""Random friction in the plane against all states of its points, one by one: nothing wrong may
pass."""
import itertools

import numpy as np
import pytest

FRICTION = (0.0, 0.1, 0.3, 0.6, 1.0, 2.0, 3.0)


def answers(compliance, free, mu, start):
    """Every Coulomb solution: open, stick, slip forth and slip back are tried at each point."""
    n = len(free)//2
    found = []
    for states in itertools.product(range(4), repeat=n):
        a, b = np.zeros((2*n, 2*n)), np.zeros(2*n)
        for k, state in enumerate(states):
            a[k, k] = a[n + k, n + k] = 1.0
            if state == 0:
                continue
            a[k], b[k] = compliance[k], -free[k]
            if state == 1:
                a[n + k], b[n + k] = compliance[n + k], start[k] - free[n + k]
            else:
                a[n + k, k] = mu*(5 - 2*state)
        try:
            force = np.linalg.solve(a, b)
        except np.linalg.LinAlgError:
            continue
        if misfit(compliance, force, free, mu, start) < 1e-9:
            found.append(force)
    return found


def misfit(compliance, force, free, mu, start):
    """Natural residual of a state, point by point, beside the largest force; rounding of gaps does
    not count."""
    n = len(free)//2
    gap = free + compliance @ force
    stiff = 1.0/compliance.diagonal()
    most = max(np.abs(force).max(), 1e-6*np.abs(stiff*free).max())
    noise = 1e-14*(np.abs(free) + np.abs(compliance) @ np.abs(force))*stiff
    normal, shear = np.split(force, 2)
    bound = mu*np.maximum(normal, 0.0)
    trial = shear - stiff[n:]*(gap[n:] - start)
    off = np.concatenate([normal - np.maximum(0.0, normal - stiff[:n]*gap[:n]),
                          shear - np.clip(trial, -bound, bound)])
    return ((np.abs(off) - noise)/most).max()


def compliance_of(rng, kind, n):
    """Of bodies like blocks, of strips, and of nothing that exists."""
    if kind == "block":
        a = rng.normal(size=(2*n, 2*n))
        return np.linalg.inv(a.T @ a + np.eye(2*n)*10.0**rng.uniform(-2.0, 1.0))
    if kind == "strip":
        x = np.arange(1.0, n + 1.0)
        rope = np.minimum.outer(x, x)
        bent = np.minimum.outer(x, x)**2*(3.0*np.maximum.outer(x, x) - rope)/6.0 + 0.01*np.eye(n)
        s = np.block([[bent, 0.05*rope], [0.05*rope, rope]])
        return s + max(0.0, 1e-3 - np.linalg.eigvalsh(s)[0])*np.eye(2*n)
    q, _ = np.linalg.qr(rng.normal(size=(2*n, 2*n)))
    return q*10.0**rng.uniform(-6.0, 0.0, 2*n) @ q.T


@pytest.mark.parametrize("kind, lost", [("block", 0.02), ("strip", 0.0), ("wild", 0.06)])
def test_nothing_wrong_passes(core, kind, lost):
    """Histories of five increments in units of all sizes: what is accepted is an answer, and few
    are given up."""
    from lopin import _bridge

    rng = np.random.default_rng(11)
    refused = increments = 0
    for _ in range(40):
        n, mu = int(rng.integers(1, 5)), float(rng.choice(FRICTION))
        s = compliance_of(rng, kind, n)
        s = 0.5*(s + s.T)*10.0**rng.uniform(-12.0, 6.0)
        unit = 10.0**rng.uniform(-6.0, 3.0)*np.sqrt(s.diagonal()/s.diagonal().max())
        force, gaps = np.zeros(2*n), np.zeros(2*n)
        for _ in range(5):
            free = unit*(rng.normal(size=2*n) - np.repeat([0.5, 0.0], n))
            start = gaps[n:]
            force, gaps, said = _bridge.probe_friction_increment(s, free, mu, force, gaps)
            increments += 1
            if said["code"]:
                refused += 1
                break
            assert misfit(s, force, free, mu, start) < 1e-8
            listed = answers(s, free, mu, start)
            assert not listed or min(np.abs(force - other).max()
                                     for other in listed) <= 1e-6*np.abs(force).max()
    assert refused <= lost*increments
