"""Surface to surface in space where bodies move far: patches, Newton, ties that turn, sliding."""

import numpy as np
import pytest

import lopin
from blocks_2d import YOUNG, Pair
from test_verification_mortar_3d import blocks

TURN = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])


def stresses(folder, name):
    """All printed stresses."""
    rows = []
    for table in (folder/f"{name}.dat").read_text(encoding="utf-8").split(" stresses (")[1:]:
        for line in table.splitlines()[2:]:
            if not line.strip():
                break
            rows.append([float(v) for v in line.split()[2:8]])
    return np.array(rows)


def history(folder, name):
    """Residuals of each increment, by iteration."""
    increments = []
    for line in (folder/f"{name}.cvg").read_text(encoding="utf-8").splitlines():
        fields = line.split()
        if line.startswith("step"):
            increments.append([])
        elif increments and len(fields) == 9 and fields[0].isdigit():
            increments[-1].append(max(float(fields[1]), float(fields[2])))
    return [np.array(v) for v in increments]


def far(model, **changes):
    text = model.to_deck().text().replace("*STEP,", "*STEP, NLGEOM,", 1)
    for old, new in changes.values():
        assert old in text
        text = text.replace(old, new)
    return text


@pytest.mark.parametrize("slave", ["upper", "lower"])
@pytest.mark.parametrize(("kind", "quadratic"), [("hex", False), ("hex", True), ("tet", False),
                                                 ("turned", False)])
def test_uniform_pressure(solve, sheet, tmp_path, kind, quadratic, slave):
    """B2 with NLGEOM: a tenth of the modulus squeezes the blocks by 10 %; nothing but sigma_zz."""
    lower, upper = ((2, 2, 1), (3, 3, 1)) if quadratic else ((3, 3, 2), (4, 4, 2))
    text = far(blocks(lower, upper, kind, slave, quadratic=quadratic),
               p=("UP.TOP, P, 1.", "UP.TOP, P, 1.e5"))
    path = tmp_path/"patch.inp"
    path.write_text(text, encoding="utf-8")
    result = solve(lopin.Deck.read(path))
    stress = stresses(result.source.folder, "patch")
    off = np.delete(stress, 2, axis=1)
    name = f"{kind}{' quadratic' if quadratic else ''}, {slave} slave"
    case = "B2 patch test with NLGEOM, mortar in space"
    most = np.abs(stress[:, 2]).max()
    sheet.compare(case, f"{name}: other stresses over sigma_zz", np.abs(off).max()/most, 0.0, 1e-10,
                  "zero", absolute=True)
    sheet.compare(case, f"{name}: spread of sigma_zz", np.ptp(stress[:, 2])/most, 0.0, 1e-6,
                  "uniform; printed to seven digits", absolute=True)
    seen = history(result.source.folder, "patch")[-1]
    seen = seen[seen > 1e-13]
    order = np.log(seen[3]/seen[2])/np.log(seen[2]/seen[1])
    sheet.compare("F16 order of Newton's iteration, mortar in space", name, order, 1.8, 0.0,
                  "quadratic: 2", at_least=True)


@pytest.mark.parametrize("slave", ["upper", "lower"])
@pytest.mark.parametrize("quadratic", [False, True])
def test_a_tie_turns_with_the_bodies(solve, sheet, tmp_path, quadratic, slave):
    """The base is turned by 90 degrees, its nodes on chords; in the end nothing is strained."""
    model = blocks((3, 3, 2), (2, 2, 2), "hex", slave, quadratic=quadratic, tied=True)
    text = far(model, time=("1., 1., 1e-06, 1.", "0.1, 1., 1e-06, 1."))
    base = []
    reading = False
    for line in text.splitlines():
        if line.startswith("*"):
            reading = line.startswith("*NODE") and "FILE" not in line
        elif reading:
            node, *x = line.split(",")
            x = np.array([float(v) for v in x])
            if abs(x[2]) < 1e-9:
                base += [f"{node}, {k}, {k}, {u:.17g}" for k, u in enumerate(TURN @ x - x, start=1)]
    text = text[:text.index("*BOUNDARY")] + text[text.index("*STEP"):]
    held = "\n".join(["*BOUNDARY", *base, ""])
    text = text[:text.index("*DSLOAD")] + held + text[text.index("*EL PRINT"):]
    path = tmp_path/"turn.inp"
    path.write_text(text, encoding="utf-8")
    result = solve(lopin.Deck.read(path))
    stress = stresses(result.source.folder, "turn")
    last = stress[-len(stress)//len(history(result.source.folder, "turn")):]
    sheet.compare("Ties by mortar turn by 90 degrees",
                  f"{'hex20' if quadratic else 'hex8'}, {slave} slave: stress over the modulus",
                  np.abs(last).max()/1e6, 0.0, 1e-10, "no stress", absolute=True)
    assert np.abs(stress).max() > 1e4


def dragged(folder, method, slave="upper"):
    """The upper block pressed on the lower, and drawn along over its facets."""
    model = blocks((3, 3, 1), (4, 4, 1), "hex", slave)
    text = far(model, law=("*SURFACE BEHAVIOR, DIRECT\n",
                          f"*SURFACE BEHAVIOR, {method}\n*FRICTION\n0.2\n"),
               time=("1., 1., 1e-06, 1.", "0.25, 1., 1e-06, 1."),
               held=("UP.PIN, 1, 1\nUP.PIN, 2, 2\nUP.GUIDE, 2, 2\n", "LOW.BOTTOM, 1, 2\n"),
               load=("*DSLOAD\nUP.TOP, P, 1.\n", "*BOUNDARY\nUP.TOP, 1, 1, 1.7\n"
                     "UP.TOP, 2, 2, 0.6\nUP.TOP, 3, 3, -0.1\n"))
    return lopin.run(lopin.Deck.parse(text, "drag", folder))


@pytest.mark.parametrize("method", ["DIRECT", "PENALTY\n1.e7"])
def test_a_block_dragged_over_joints(core, sheet, tmp_path, method):
    """Full slip by Coulomb's law over joints of a mesh that does not match."""
    result = dragged(tmp_path, method)
    worst = 0.0
    for k in range(len(result.times)):
        pressed = result.contact(0).at(k)
        slides = pressed.status == 2
        normal, force = pressed["normal"], pressed.force
        push = np.abs((force*normal).sum(1))[slides]
        along = np.linalg.norm(force - (force*normal).sum(1)[:, None]*normal, axis=1)[slides]
        worst = max(worst, np.abs(along/push - 0.2).max())
    assert slides.sum() > 12
    sheet.compare("D6 sliding over joints, mortar in space",
                  f"{method.split()[0].lower()}: worst |t| over p - mu", worst, 0.0,
                  1e-10, "Coulomb", absolute=True)


def test_swapping_the_sides_of_a_dragged_block(core, sheet, tmp_path):
    """The same force whichever side is the slave."""
    total = []
    for slave in ("upper", "lower"):
        result = dragged(tmp_path, "DIRECT", slave)
        total.append(np.abs(np.asarray(result.contact(0).at(-1).force).sum(0)))
    sheet.compare("Sides swapped under NLGEOM, mortar in space", "dragged block: force by axis",
                  np.abs(total[1]/total[0] - 1.0).max(), 0.0, 0.01, "the same", absolute=True)


@pytest.mark.parametrize("kind", ["CPE4", "CPE8", "CPE6"])
@pytest.mark.parametrize("slave", ["lower", "upper"])
def test_a_tie_turns_in_the_plane(core, sheet, tmp_path, kind, slave):
    """As in space: the base turns by 90 degrees."""
    pair = Pair(kind, 5, 4, 2, uneven=0.3)
    held = []
    for i, x in enumerate(pair.low.nodes):
        if abs(x[1] - pair.low.x[:, 1].min()) < 1e-9:
            u = np.array([-x[1], x[0]]) - x
            held += [f"{pair.low.first + 1 + i}, {k}, {k}, {u[k - 1]:.17g}" for k in (1, 2)]
    pair.loads += ["*BOUNDARY", *held]
    text = pair.deck(slave=slave, tie=True, words="").replace("*STEP\n", "*STEP, NLGEOM\n")
    text = text.replace("1., 1.\n", "0.1, 1.\n")
    result = lopin.run(lopin.Deck.parse(text, "turn", tmp_path))
    sheet.compare("Ties by mortar turn by 90 degrees", f"{kind}, {slave} slave: stress",
                  np.abs(pair.stresses(result)).max()/YOUNG, 0.0, 1e-10, "no stress", absolute=True)
    assert np.linalg.norm(result["U"], axis=1).max() > 5.0
