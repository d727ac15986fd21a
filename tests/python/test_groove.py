"""A bar with friction in a groove of 90 degrees: its lower edge sticks to both faces, six rows on three displacements."""
import numpy as np
import pytest

from lopin import Deck

WEIGHT, SIDE, LONG, MU = 100.0, 20.0, 40.0, 0.2
ROOT = np.sqrt(0.5)
# Columns: along the bar, across, up.
TURNS = {"along x": np.eye(3), "along y": np.roll(np.eye(3), 1, axis=0),
         "turned": np.linalg.qr(np.array([[1.0, 0.3, -0.2], [0.4, 1.0, 0.5], [-0.1, 0.2, 1.0]]))[0]}
assert all(np.linalg.det(turn) > 0.0 for turn in TURNS.values())


def bar(n=3, turn=np.eye(3), order=(0, 1), mu=MU):
    """The bar rests under its weight, then is drawn along the groove."""
    label = lambda i, j, k: 1 + i + 3*(j + (n + 1)*k)                       # noqa: E731
    lines = ["*NODE"]
    for k in range(n + 1):
        for j in range(n + 1):
            for i in range(3):
                y, z = SIDE*j/n, SIDE*k/n
                x = turn @ [LONG*i/2.0, (y - z)*ROOT, (y + z)*ROOT]
                lines.append(f"{label(i, j, k)}, " + ", ".join(f"{v:.12g}" for v in x))
    lines += ["*ELEMENT, TYPE=C3D8, ELSET=BAR"]
    first, second, number = [], [], 0
    for k in range(n):
        for j in range(n):
            for i in range(2):
                number += 1
                first += [number] if k == 0 else []
                second += [number] if j == 0 else []
                nodes = [label(i + a, j + b, k + c) for c in (0, 1) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
                lines.append(", ".join(map(str, [number, *nodes])))
    end = [label(2, j, k) for k in range(n + 1) for j in range(n + 1)]
    for name, cells, face in (("ONE", first, "S1"), ("TWO", second, "S3")):
        lines += [f"*ELSET, ELSET={name}", *map(str, cells), f"*SURFACE, NAME={name}", f"{name}, {face}"]
    lines += ["*NSET, NSET=END", *map(str, end), "*MATERIAL, NAME=STEEL", "*ELASTIC", "210000., 0.3", "*DENSITY", "1.",
              "*SOLID SECTION, ELSET=BAR, MATERIAL=STEEL"]
    axis, across, up = turn.T
    for k, (name, side, way) in enumerate((("PLANE_ONE", 1.0, ("-5.", "40.")), ("PLANE_TWO", -1.0, ("40.", "-5.")))):
        low = ", ".join(f"{v:.12g}" for v in [0.0, 0.0, 0.0, *(side*across + up)])
        lines += [f"*NODE, NSET={name}_REF", f"{9001 + k}, 0, 0, 0", f"*SURFACE, NAME={name}, TYPE=CYLINDER", low,
                  ", ".join(f"{v:.12g}" for v in axis), f"START, {way[0]}, 0.", f"LINE, {way[1]}, 0.",
                  f"*RIGID BODY, ANALYTICAL SURFACE={name}, REF NODE={name}_REF"]
    lines += ["*SURFACE INTERACTION, NAME=TOUCH", "*SURFACE BEHAVIOR, DIRECT", "*FRICTION", f"{mu}"]
    lines += [("*CONTACT PAIR, INTERACTION=TOUCH\nONE, PLANE_ONE", "*CONTACT PAIR, INTERACTION=TOUCH\nTWO, PLANE_TWO")[i]
              for i in order]
    if not np.allclose(turn, np.eye(3)):
        lines += ["*TRANSFORM, NSET=END", ", ".join(f"{v:.12g}" for v in [*axis, *across])]
    lines += ["*BOUNDARY", "PLANE_ONE_REF, 1, 6", "PLANE_TWO_REF, 1, 6"]
    down = ", ".join(f"{v:.12g}" for v in -up)
    lines += ["*STEP", "*STATIC", "0.5, 1.", "*BOUNDARY", "END, 1", "*DLOAD",
              f"BAR, GRAV, {WEIGHT/(SIDE*SIDE*LONG):.12g}, {down}", "*END STEP"]
    lines += ["*STEP", "*STATIC", "0.1, 1.", "*BOUNDARY", "END, 1, 1, 0.05", "*END STEP"]
    return Deck.parse("\n".join(lines) + "\n", name="groove")


def force(result, tool):
    return np.array([result.history[f"{tool}.rf{k}"][-1] for k in (1, 2, 3)])


@pytest.mark.parametrize("turn", TURNS)
@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
def test_each_side_bears_its_share_and_the_pull_is_that_of_the_groove(solve, turn, order):
    axes = TURNS[turn]
    result = solve(bar(turn=axes, order=order))
    one, two = (axes.T @ force(result, f"PLANE_{name}") for name in ("ONE", "TWO"))
    # Signs of the two faces differ across the groove; each bears half the weight, and mu of its normal force.
    assert np.abs(one) == pytest.approx([MU*WEIGHT*ROOT, WEIGHT/2.0, WEIGHT/2.0], rel=1e-6)
    assert np.abs(two) == pytest.approx([MU*WEIGHT*ROOT, WEIGHT/2.0, WEIGHT/2.0], rel=1e-6)
    assert one[1] == pytest.approx(-two[1], rel=1e-6)
    told = [d for d in result.diagnostics if d["code"] == "W0403"]
    assert told and "not unique" in told[0]["message"], told


def test_without_friction_nothing_is_shared(solve):
    result = solve(bar(mu=0.0))
    assert "W0403" not in {d["code"] for d in result.diagnostics}
    assert np.abs(force(result, "PLANE_ONE"))[1:] == pytest.approx([WEIGHT/2.0, WEIGHT/2.0], rel=1e-9)
