"""Penalties that Lopin chooses where bodies are confined or layered: right to the error promised."""
import math
import re

import pytest
from pytest import approx

pytest.importorskip("lopin")

E = 1000.0
PROMISED = 0.01


def mesh(lines, name, element, first, origin, size, n):
    """A block of nx by ny elements: its nodes, faces and section; the number behind its last."""
    (nx, ny), (x0, y0), (w, h) = n, origin, size
    node = {(i, j): first + i + (nx + 1)*j for j in range(ny + 1) for i in range(nx + 1)}
    lines.append(f"*NODE, NSET={name}")
    lines += [f"{k}, {x0 + w*i/nx!r}, {y0 + h*j/ny!r}" for (i, j), k in node.items()]
    lines.append(f"*ELEMENT, TYPE={element}, ELSET={name}")
    label = {}
    for j in range(ny):
        for i in range(nx):
            label[i, j] = first + i + nx*j
            lines.append(", ".join(map(str, [label[i, j], node[i, j], node[i + 1, j],
                                             node[i + 1, j + 1], node[i, j + 1]])))
    for side, face, chosen in (("Y0", "S1", lambda i, j: j == 0), ("X1", "S2", lambda i, j: i == nx - 1),
                               ("Y1", "S3", lambda i, j: j == ny - 1), ("X0", "S4", lambda i, j: i == 0)):
        lines.append(f"*SURFACE, NAME={name}{side}")
        lines += [f"{k}, {face}" for ij, k in label.items() if chosen(*ij)]
    return max(node.values()) + 1


def tool(lines, name, ref, start, end):
    lines += [f"*NODE, NSET=REF{name}", f"{ref}, {start[0]}, {start[1]}",
              f"*SURFACE, NAME=TOOL{name}, TYPE=SEGMENTS", f"START, {start[0]}, {start[1]}",
              f"LINE, {end[0]}, {end[1]}",
              f"*RIGID BODY, ANALYTICAL SURFACE=TOOL{name}, REF NODE={ref}"]


def die(behavior, nu, n, nlgeom, element="CPE4", unit=1.0, press=0.02):
    """A block in a closed die, its punch pressed down by a share of the height."""
    young, side = E/unit**2, unit
    lines = ["*MATERIAL, NAME=M", "*ELASTIC", f"{young!r}, {nu}"]
    mesh(lines, "B", element, 1, (0.0, 0.0), (side, side), n)
    lines += ["*SOLID SECTION, ELSET=B, MATERIAL=M", "1.", "*SURFACE INTERACTION, NAME=I", behavior]
    far, near = 9.0*side, (0.0 if element == "CAX4" else -9.0*side)
    walls = {"Y0": ((near, 0.0), (far, 0.0)), "Y1": ((far, side), (near, side)),
             "X0": ((0.0, far), (0.0, -far)), "X1": ((side, -far), (side, far))}
    for k, (name, ends) in enumerate(walls.items()):
        if element == "CAX4" and name == "X0":
            continue
        tool(lines, name, 900001 + k, *ends)
        lines += ["*CONTACT PAIR, INTERACTION=I", f"B{name}, TOOL{name}", "*BOUNDARY",
                  f"REF{name}, 1, {1 if name == 'Y1' else 2}", f"REF{name}, 6"]
    lines += [f"*STEP{', NLGEOM' if nlgeom else ''}", "*STATIC", "0.5, 1.", "*BOUNDARY",
              f"REFY1, 2, 2, {-press*side!r}"]
    return "\n".join(lines + ["*END STEP", ""])


def stack(behavior, count, nlgeom, thin=0.1):
    """Hard and soft layers pressed together between two smooth plates."""
    lines = ["*MATERIAL, NAME=M0", "*ELASTIC", "100000., 0.", "*MATERIAL, NAME=M1", "*ELASTIC",
             "1000., 0.", "*SURFACE INTERACTION, NAME=I", behavior]
    first = 1
    for k in range(count):
        first = mesh(lines, f"L{k}", "CPE4", first, (0.0, thin*k), (1.0, thin), (2, 1)) + 10
        lines += [f"*SOLID SECTION, ELSET=L{k}, MATERIAL=M{k % 2}", "1."]
        if k > 0:
            lines += ["*CONTACT PAIR, INTERACTION=I", f"L{k}Y0, L{k - 1}Y1"]
        lines += [f"*NSET, NSET=LEFT{k}", f"{first - 10 - 6}, {first - 10 - 3}", "*BOUNDARY", f"LEFT{k}, 1"]
    lines += ["*NSET, NSET=TOP", f"{first - 13}, {first - 12}, {first - 11}", "*NSET, NSET=BASE",
              "1, 2, 3", "*BOUNDARY", "BASE, 2", f"*STEP{', NLGEOM' if nlgeom else ''}", "*STATIC",
              "1., 1.", "*BOUNDARY", f"TOP, 2, 2, {-0.01*thin*count!r}"]
    return "\n".join(lines + ["*END STEP", ""])


def forces(r):
    """The largest component of the force of each pair."""
    assert r.code == 0, r.output
    return [max(map(abs, pair["force"])) for pair in r.summary["contact"]]


@pytest.mark.parametrize("nlgeom", [False, True])
@pytest.mark.parametrize("behavior", ["*SURFACE BEHAVIOR, PENALTY",
                                      "*SURFACE BEHAVIOR, PERTURBED LAGRANGE"])
@pytest.mark.parametrize("element, nu, n, unit", [
    ("CPE4", 0.3, (3, 3), 1.0), ("CPE4", 0.49, (1, 1), 1.0), ("CPE4", 0.4999, (2, 3), 1e-3),
    ("CAX4", 0.45, (2, 2), 1e3)])
def test_a_closed_die(go, nlgeom, behavior, element, nu, n, unit):
    r = go(die(behavior, nu, n, nlgeom, element, unit))
    exact = go(die("*SURFACE BEHAVIOR, DIRECT", nu, n, nlgeom, element, unit))
    assert forces(r) == approx(forces(exact), rel=PROMISED)
    assert r.summary["certificate"]["pressure_error"] <= PROMISED
    assert r.summary["certificate"]["verdict"] == "PASS"


def test_one_element_by_hand(go):
    """Hencky's uniaxial strain: M e/(1 - 0.02), e = -ln(1 - 0.02), sides of the present length."""
    nu = 0.49
    modulus = E*(1 - nu)/((1 + nu)*(1 - 2*nu))
    r = go(die("*SURFACE BEHAVIOR, PENALTY", nu, (1, 1), True))
    assert forces(r)[1] == approx(-modulus*math.log(0.98)/0.98, rel=PROMISED)
    assert "N0329" in r.ids()


@pytest.mark.parametrize("nlgeom", [False, True])
@pytest.mark.parametrize("count", [2, 6])
def test_layers(go, nlgeom, count):
    r = go(stack("*SURFACE BEHAVIOR, PENALTY", count, nlgeom))
    exact = go(stack("*SURFACE BEHAVIOR, DIRECT", count, nlgeom))
    # The slope is chosen for what is promised, which two layers have to rounding.
    assert forces(r) == approx(forces(exact), rel=PROMISED + 1e-9)
    assert r.summary["certificate"]["pressure_error"] <= PROMISED


@pytest.mark.parametrize("nlgeom", [False, True])
@pytest.mark.parametrize("behavior", ["PENALTY", "PERTURBED LAGRANGE"])
@pytest.mark.parametrize("thin", [0.1, 0.01, 0.003])
def test_what_springs_give_way_under_loads_is_told(go, behavior, nlgeom, thin):
    """Thin layers pressed by a force: pressures are right, and the way of the top is not."""
    def lowered(method):
        text = stack(f"*SURFACE BEHAVIOR, {method}", 2, nlgeom, thin)
        left, middle, right = re.search(r"NSET=TOP\n(\d+), (\d+), (\d+)", text).groups()
        text = text.replace(f"*BOUNDARY\nTOP, 2, 2, {-0.01*thin*2!r}",
                            f"*CLOAD\n{left}, 2, -.5\n{middle}, 2, -1.\n{right}, 2, -.5")
        r = go(text)
        told = re.findall(r"W0568.*took up ([\d.e+-]+) %", r.output)
        return -r.field("U")[:, 1].min(), [float(share) for share in told[:1]]

    (soft, told), (right, none) = lowered(behavior), lowered("DIRECT")
    off = 100.0*(soft/right - 1.0)
    assert not none and bool(told) == (off > 5.0)
    assert not told or told[0] == approx(off, rel=0.05)
    assert behavior == "PERTURBED LAGRANGE" or thin == 0.1 or told


@pytest.mark.parametrize("nlgeom", [False, True])
def test_a_slope_of_the_deck_is_obeyed_and_judged(go, nlgeom):
    """And what penetration takes from a confined body is seen, though each facet alone is stiff."""
    nu = 0.49
    r = go(die("*SURFACE BEHAVIOR, PENALTY\n100000.", nu, (1, 1), nlgeom))
    exact = go(die("*SURFACE BEHAVIOR, DIRECT", nu, (1, 1), nlgeom))
    force, right = (forces(x)[1] for x in (r, exact))
    assert force < 0.7*right
    assert r.summary["certificate"]["pressure_error"] == approx(1.0 - force/right, abs=0.1)
    assert "W0504" in r.ids() and "N0329" not in r.ids()
    assert "law of the surface" in r.output


def test_a_press_without_shear_blurs_nothing(go):
    behavior = "*SURFACE BEHAVIOR, PENALTY\n*FRICTION\n0.2"
    r = go(stack(behavior, 2, False))
    assert r.code == 0, r.output
    assert "W0514" not in r.ids()


@pytest.mark.parametrize("nlgeom", [False, True])
def test_augmentations_end_in_rounding(go, nlgeom):
    """A thermal press fit: large forces within the rings, small ones between them."""
    def fit(behavior):
        lines = ["*MATERIAL, NAME=M", "*ELASTIC", "210000., 0.3", "*EXPANSION", "1.2E-5",
                 "*MATERIAL, NAME=SOFT", "*ELASTIC", "70000., 0.33",
                 "*EXPANSION", "1.2E-5", "*SURFACE INTERACTION, NAME=I", behavior]
        second = mesh(lines, "A", "CAX4", 1, (10.0, 0.0), (10.0, 8.0), (6, 16))
        mesh(lines, "B", "CAX4", second, (20.0, 0.0), (10.0, 8.0), (6, 16))
        for name, first, material in (("A", 1, "M"), ("B", second, "SOFT")):
            lines += [f"*SOLID SECTION, ELSET={name}, MATERIAL={material}",
                      f"*NSET, NSET=LOW{name}, GENERATE", f"{first}, {first + 6}", "*BOUNDARY",
                      f"LOW{name}, 2"]
        lines += ["*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE", "AX1, BX0",
                  "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "A, 0.", "B, 0.",
                  f"*STEP{', NLGEOM' if nlgeom else ''}", "*STATIC", "0.5, 1.", "*TEMPERATURE",
                  "A, 41.6666666667"]
        return "\n".join(lines + ["*END STEP", ""])

    exact = forces(go(fit("*SURFACE BEHAVIOR, DIRECT")))
    r = go(fit("*SURFACE BEHAVIOR, AUGMENTED LAGRANGE"))
    assert forces(r) == approx(exact, rel=1e-5)
    assert r.summary["certificate"]["verdict"] == "PASS"


@pytest.mark.parametrize("slope", [5e4, 2e5])
def test_the_estimate_of_a_bar_is_its_error(slope):
    """A bar of stiffness E/L on a tool of slope k gives way by E/(L k) of its force: NLGEOM."""
    deck = "\n".join([
        "*NODE", "1, 0., 0.", "2, 1., 0.", "3, 1., 1.", "4, 0., 1.", "9, 0.5, 1.",
        "*ELEMENT, TYPE=CPE4, ELSET=B", "1, 1, 2, 3, 4", "*NSET, NSET=BASE", "1, 2",
        "*MATERIAL, NAME=M", "*ELASTIC", "1000., 0.", "*SOLID SECTION, ELSET=B, MATERIAL=M", "1.",
        "*SURFACE, NAME=TOP", "B, S3", "*SURFACE, NAME=TOOL, TYPE=SEGMENTS", "START, 3., 1.",
        "LINE, -3., 1.", "*RIGID BODY, ANALYTICAL SURFACE=TOOL, REF NODE=9",
        "*SURFACE INTERACTION, NAME=I", "*SURFACE BEHAVIOR, PENALTY", f"{slope},",
        "*CONTACT PAIR, INTERACTION=I", "TOP, TOOL", "*BOUNDARY", "BASE, 2", "1, 1", "4, 1", "9, 1",
        "9, 6", "*STEP, NLGEOM", "*STATIC", "1., 1.", "*BOUNDARY", "9, 2, 2, -0.001", "*END STEP"])
    import lopin

    result = lopin.run(lopin.Deck.parse(deck + "\n", "bar"))
    estimate = result.summary["certificate"]["pressure_error"]
    assert estimate == pytest.approx(1000.0/slope, rel=0.05)
