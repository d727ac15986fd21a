"""Ductile damage: uniform states with closed forms, the mean over a width beside numpy, meshes."""
from math import exp, sqrt

import lopin
import numpy as np
import pytest

from flow_scenes import grid

A, NU = 3.9, 0.3
#: Criterion: f of (largest principal, mean) over von Mises' stress, and its data line.
CRITERIA = {
    "COCKCROFT-LATHAM": (lambda s, m: max(0.0, s), ""),
    "OYANE": (lambda s, m: max(0.0, 1.0 + A*m), f"{A}\n"),
    "RICE-TRACEY": (lambda s, m: exp(1.5*m), ""),
    "LEMAITRE": (lambda s, m: (m > -1.0/3.0 + 1e-7)*(2.0/3.0*(1.0 + NU)
                                                     + 3.0*(1.0 - 2.0*NU)*m**2), "")}
#: Way of straining: largest principal and mean stress over von Mises'.
UNIAXIAL = {1.0: (1.0, 1.0/3.0), -1.0: (0.0, -1.0/3.0)}
PLANE = {1.0: (2.0/sqrt(3.0), 1.0/sqrt(3.0)), -1.0: (0.0, -1.0/sqrt(3.0))}
WORDS = {"C3D8": UNIAXIAL, "C3D8R": UNIAXIAL, "C3D8I": UNIAXIAL, "C3D20R": UNIAXIAL,
         "CAX4": UNIAXIAL, "CAX4R": UNIAXIAL, "CAX8R": UNIAXIAL, "CAX8": UNIAXIAL,
         "CPE4": PLANE, "CPE4R": PLANE, "CPE8": PLANE, "CPE4I": PLANE}


def metal(*cards):
    """A metal that hardens, with cards of damage."""
    return f"*MATERIAL, NAME=METAL\n*ELASTIC\n1.E7, {NU}\n*PLASTIC\n100., 0.\n200., 1.\n" \
        + "".join(cards)


def damage(word, width=None):
    """The card of a criterion."""
    return f"*DAMAGE, CRITERION={word}" + (f", WIDTH={width}" if width else "") \
        + f"\n{CRITERIA[word][1]}"


def bar(word, sign, cards, scale=1.0):
    """One element pulled or pushed by a fifth of its length along the second axis."""
    if word.startswith("C3D"):
        corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0),
                   (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
        edges = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4),
                 (0, 4), (1, 5), (2, 6), (3, 7)]
        quadratic = word.startswith("C3D20")
    else:
        corners = [(0, 0), (1, 0), (1, 1), (0, 1)]
        edges = [(0, 1), (1, 2), (2, 3), (3, 0)]
        quadratic = "8" in word
    x = np.array(corners, float)*scale
    if quadratic:
        x = np.vstack([x, [(x[i] + x[j])/2 for i, j in edges]])
    lines = ["*NODE", *(", ".join(map(repr, (k + 1, *map(float, p)))) for k, p in enumerate(x)),
             f"*ELEMENT, TYPE={word}, ELSET=ALL",
             "1, " + ", ".join(map(str, range(1, min(len(x), 15) + 1)))
             + "".join(f",\n{k}" for k in range(16, len(x) + 1))]
    for name, axis, at in (("LEFT", 0, 0), ("LOW", 1, 0), ("TOP", 1, 1), ("BACK", 2, 0)):
        if axis < x.shape[1]:
            lines += [f"*NSET, NSET={name}",
                      ",".join(str(k + 1) for k in np.flatnonzero(x[:, axis] == at*scale))]
    hold = "LEFT, 1\nLOW, 2\n" + ("BACK, 3\n" if x.shape[1] == 3 else "")
    return "\n".join(lines) + "\n" + metal(*cards) + "*SOLID SECTION, ELSET=ALL, MATERIAL=METAL\n" \
        f"*BOUNDARY\n{hold}*STEP, NLGEOM, INC=100\n*STATIC\n.1, 1., 1.E-6, .1\n*BOUNDARY\n" \
        f"TOP, 2, 2, {0.2*sign*scale!r}\n*OUTPUT, FIELD\n*ELEMENT OUTPUT\nS, PEEQ, DAMAGE\n" \
        "*EL PRINT, ELSET=ALL\nDAMAGE, PEEQ\n*END STEP\n"


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("word", WORDS)
def test_uniform_states_have_closed_forms(word, sign):
    result = lopin.run(lopin.Deck.parse(bar(word, sign, map(damage, CRITERIA)), "bar"))
    strain = np.ravel(result["PEEQ"])
    assert strain == pytest.approx(strain[0], rel=1e-6) and strain[0] > 0.15
    for name, (f, _) in CRITERIA.items():
        due = f(*WORDS[word][sign])*strain[0]
        assert np.ravel(result[f"DAMAGE_{name}"]) == pytest.approx(due, rel=2e-4, abs=1e-8), name
        assert result.history[f"damage.{name}"][-1] == pytest.approx(due, rel=2e-4, abs=1e-8)


def notched(n, cards, scale=1.0):
    """A quarter of a plane strip with a notch, pulled: damage is uneven."""
    nodes, elements, label = grid(n, 2*n, 4.0, 8.0)
    for (i, j), k in label.items():
        x, y = nodes[k]
        nodes[k] = (scale*x*(1.0 - 0.3*max(0.0, 1.0 - y/3.0)**2), scale*y)
    lines = ["*NODE", *(f"{k}, {x!r}, {y!r}" for k, (x, y) in nodes.items()),
             "*ELEMENT, TYPE=CPE4, ELSET=ALL",
             *(f"{k + 1}, " + ", ".join(map(str, e)) for k, e in enumerate(elements))]
    for name, of in (("LEFT", [label[0, j] for j in range(2*n + 1)]),
                     ("LOW", [label[i, 0] for i in range(n + 1)]),
                     ("TOP", [label[i, 2*n] for i in range(n + 1)])):
        lines += [f"*NSET, NSET={name}", *(f"{k}," for k in of)]
    return "\n".join(lines) + "\n" + metal(*cards) + \
        "*SOLID SECTION, ELSET=ALL, MATERIAL=METAL\n*BOUNDARY\nLEFT, 1\nLOW, 2\n" \
        "*STEP, NLGEOM, INC=100\n*STATIC\n.1, 1., 1.E-6, .1\n*BOUNDARY\n" \
        f"TOP, 2, 2, {0.3*scale!r}\n*OUTPUT, FIELD\n*ELEMENT OUTPUT\nS, PEEQ, DAMAGE\n*END STEP\n"


def test_means_are_those_of_numpy():
    width = 0.7
    deck = lopin.Deck.parse(notched(6, [damage("OYANE", width), damage("RICE-TRACEY")]), "notch")
    with lopin.open(deck) as job:
        for _ in job:
            points = job.points
    of, mean = points.damage[:, 1:3], points.damage_mean[:, 1:3]
    far = np.linalg.norm(points.place[:, None] - points.place[None], axis=2)/width
    weight = np.where(far < 1.0, (1.0 - far**2)**2, 0.0)*points.volume
    assert mean[:, 0] == pytest.approx(weight @ of[:, 0]/weight.sum(axis=1), rel=1e-12)
    assert mean[:, 1] == pytest.approx(of[:, 1], rel=1e-15)
    assert mean[:, 0].max() < 0.95*of[:, 0].max()


def test_a_mean_stays_in_its_body():
    """Two bars a hundredth apart, of which one is pulled."""
    nodes = [(1 + 5*j + i, x, 0.5*j) for j in range(5)
             for i, x in enumerate((0.0, 1.0, 1.01, 2.01))]
    cells = [(j, i) for j in range(4) for i in (0, 2)]
    lines = ["*NODE", *(f"{n}, {x}, {y}" for n, x, y in nodes), "*ELEMENT, TYPE=CPE4, ELSET=ALL",
             *(f"{1 + k}, {1 + 5*j + i}, {2 + 5*j + i}, {7 + 5*j + i}, {6 + 5*j + i}"
               for k, (j, i) in enumerate(cells)),
             "*NSET, NSET=LOW", *(f"{i}," for i in (1, 2, 3, 4)), "*NSET, NSET=TOP", "21, 22"]
    text = "\n".join(lines) + "\n" + metal(damage("RICE-TRACEY", 1.0)) + \
        "*SOLID SECTION, ELSET=ALL, MATERIAL=METAL\n*BOUNDARY\nLOW, 2\n1, 1\n3, 1\n" \
        "*STEP, NLGEOM\n*STATIC\n.1, 1., 1.E-6, .1\n*BOUNDARY\nTOP, 2, 2, .2\n*END STEP\n"
    with lopin.open(lopin.Deck.parse(text, "bars")) as job:
        for _ in job:
            points = job.points
    pulled = np.isin(points.element, [1 + k for k, (_, i) in enumerate(cells) if i == 0])
    assert points.damage[pulled, 2].min() > 0.1
    assert points.damage_mean[:, 2] == pytest.approx(points.damage[:, 2], rel=1e-6, abs=1e-9)


@pytest.mark.parametrize("nu", [0.0, 0.45])
def test_rigid_metal_has_the_ratio_of_its_deck(nu):
    """Lemaitre's criterion reads it; the moduli that a rigid metal is solved with are others."""
    text = bar("CPE4", 1.0, [damage("LEMAITRE")]).replace(f"1.E7, {NU}", f"1.E7, {nu}").replace(
        "*PLASTIC\n100., 0.\n200., 1.\n", "*VISCOPLASTIC, LAW=NORTON-HOFF, RIGID\n100., .2\n")
    result = lopin.run(lopin.Deck.parse(text, "rigid"))
    due = 2.0/3.0*(1.0 + nu) + (1.0 - 2.0*nu)
    found = np.ravel(result["DAMAGE_LEMAITRE"])/np.ravel(result["PEEQ"])
    assert found == pytest.approx(due, rel=5e-3)


def test_units_do_not_matter_and_a_resumed_run_gives_the_same_bits(executable, tmp_path):
    found = []
    for scale in (1.0, 1e-3):
        deck = lopin.Deck.parse(notched(4, [damage("OYANE", 0.7*scale)], scale), "notch")
        found.append(lopin.run(deck).history["damage.OYANE"])
    assert found[1] == pytest.approx(found[0], rel=1e-9)
    assert len(found[0]) == 10   # of the length asked for: no increment was cut
    deck = lopin.Deck.parse(notched(4, [damage("OYANE", 0.7)]), "notch")
    with lopin.open(deck) as job:
        for frame in zip(range(4), job):
            state = job.state
    with lopin.open(deck, state=state) as job:
        for frame in job:
            last = frame
    assert job.result.history["damage.OYANE"][-1] == found[0][-1]


def test_means_do_not_depend_on_the_mesh():
    runs = [lopin.run(lopin.Deck.parse(notched(n, [damage("OYANE", 0.8)]), "notch"))
            for n in (15, 24)]
    mean = [r.history["damage.OYANE"][-1] for r in runs]
    local = [np.max(r["DAMAGE_OYANE"]) for r in runs]
    assert mean[1] == pytest.approx(mean[0], rel=0.05) and local[1] > 1.2*local[0]


@pytest.mark.parametrize("card, code", [
    ("*DAMAGE\n", "E0106"), ("*DAMAGE, CRITERION=JOHNSON\n", "E0106"),
    ("*DAMAGE, CRITERION=OYANE\n", "E0103"), ("*DAMAGE, CRITERION=OYANE\n-1.\n", "E0203"),
    ("*DAMAGE, CRITERION=LEMAITRE\n1.\n", "E0103"),
    ("*DAMAGE, CRITERION=LEMAITRE, WIDTH=0.\n", "E0203"),
    ("*DAMAGE, CRITERION=LEMAITRE, CRITICAL=-1.\n", "E0203"),
    ("*DAMAGE, CRITERION=LEMAITRE\n*DAMAGE, CRITERION=LEMAITRE\n", "E0205")])
def test_what_is_wrong_is_refused(card, code):
    with pytest.raises(lopin.LopinError) as caught:
        lopin.check(lopin.Deck.parse(bar("CAX4", 1.0, [card]), "bar"))
    assert code in str(caught.value) or caught.value.id == code


def test_an_elastic_material_has_no_damage():
    text = bar("CAX4", 1.0, [damage("LEMAITRE")]).replace("*PLASTIC\n100., 0.\n200., 1.\n", "")
    with pytest.raises(lopin.LopinError, match="plastic strain"):
        lopin.check(lopin.Deck.parse(text, "bar"))
