"""What `Model` can say beyond the decks of the collection: laws, relations, loads, refusals."""
import lopin
import numpy as np
import pytest

from lopin import Elastic, Material, Plastic, UsageError, mesh_make, profile  # noqa: E402
from lopin import flow_curves, friction, laws, materials  # noqa: E402

METAL = Plastic([(200.0, 0.0), (300.0, 0.5)])
STEEL = Elastic(2e5, 0.3)
CURVES = [Plastic(200.0), Plastic({20.0: [(200.0, 0.0), (300.0, 0.5)], 500.0: [(100.0, 0.0)]}),
          lopin.Swift(550.0, 0.01, 0.2), lopin.Voce(300.0, 200.0, 10.0, 5.0),
          lopin.Hollomon(550.0, 0.22), lopin.Hollomon(550.0, 0.22, 190.0),
          lopin.LinearHardening(200.0, 100.0), lopin.Kinematic([(200.0, 0.0), (300.0, 0.5)]),
          lopin.Chaboche(200.0, [(2e4, 150.0), (900.0, 4.0)], (80.0, 5.0)),
          lopin.Chaboche(200.0, [(2e4, 150.0)], [(200.0, 0.0), (250.0, 1.0)]),
          Plastic(200.0, only_friction=True)]
MATERIALS = [STEEL, Elastic(2e5, 0.3, 7.8e-9, strain="green"), lopin.NeoHooke(0.5, 0.04),
             *(Material(STEEL, curve) for curve in CURVES),
             Material(STEEL, METAL, lopin.CowperSymonds(40.0, 5.0)),
             Material(STEEL, METAL, lopin.Hill48([1.0, 1.1, 0.9, 1.0, 1.0, 1.0])),
             Material(STEEL, METAL, lopin.Hill48.lankford(1.8, 1.3, 2.1)),
             Material(STEEL, METAL, lopin.NortonHoff(100.0, 0.2), density=7.8e-9, expansion=1e-5),
             Material(lopin.NortonHoff(100.0, 0.2, rigid=True), name="HOT")]
FRICTIONS = [lopin.Coulomb(0.1, tau_max=50.0), lopin.Coulomb(0.1, 1e5),
             lopin.Coulomb(0.1, regularization="tanh", elastic_slip=1e-3),
             lopin.Coulomb(0.1, regularization="sqrt", v0=2.0),
             lopin.StaticKinetic(0.2, 0.1, 3.0), lopin.Tresca(0.5), lopin.Tresca(tau_max=30.0),
             lopin.Cristescu(0.5), lopin.Orowan(0.1, 0.5), lopin.NortonHoffFriction(10.0, 0.3),
             lopin.AutoFriction(0.1, 0.2), lopin.Rough(),
             lopin.Coulomb(0.1, slip_tolerance=0.01), lopin.Coulomb(0.1, exact_stick=True)]
METHODS = ["lagrange", laws.Penalty(1e5), laws.Perturbed(1e5),
           laws.Augmented(1e5, max_augmentations=9, penetration=1e-4),
           laws.Exponential(0.01, 5.0), laws.Tabular(((0.0, 0.0), (10.0, 0.01)))]


def scene(material=STEEL, nlgeom=True, kind="plane strain", **contact):
    """A block under a flat punch."""
    model = lopin.Model("scene", mesh_make.block((2.0, 1.0), (4, 2)), kind=kind)
    model.section("ALL", material)
    die = model.rigid_tool("DIE", profile.plane(1.0, 5.0), ref=(0.0, 1.0))
    model.contact("TOP", die, **contact)
    model.fix("BOTTOM", 2)
    model.fix("LEFT", 1)
    model.step(2, nlgeom=nlgeom).move(die, **{"z" if kind == "axisymmetric" else "y": -0.01})
    return model


def read_back(model):
    """The deck, which the core accepts and which reads back to the same model."""
    lopin.check(model)
    deck = model.to_deck()
    again = lopin.Model.read(deck).to_deck()
    assert lopin.Model.read(again).to_deck().text() == again.text()
    return deck, lopin.Model.read(deck)


@pytest.mark.parametrize("material", MATERIALS, ids=lambda m: str(m)[:60])
def test_materials(core, material):
    _, again = read_back(scene(material))
    read = again.sections[0][1]
    if isinstance(material, Material):
        assert read.laws == material.laws and repr(read.laws) == repr(material.laws)
    assert isinstance(hash(material), int)


@pytest.mark.parametrize("law", FRICTIONS, ids=lambda law: str(law)[:60])
def test_friction(core, law):
    model = scene(Material(STEEL, METAL), friction=law)
    assert read_back(model)[1].contacts[0].friction == law


@pytest.mark.parametrize("method", METHODS, ids=str)
def test_methods(core, method):
    assert read_back(scene(method=method))[1].contacts[0].method == laws.method_of(method)


def test_orientations_of_a_sheet(core):
    model = scene()
    model.sections.clear()
    axes = lopin.Orientation(angle=45.0)
    model.section("ALL", Material(STEEL, METAL, lopin.Hill48.lankford(1.8, 1.3, 2.1)),
                  orientation=axes)
    assert read_back(model)[1].sections[0][4] == axes


def two_blocks():
    """Two blocks on each other, tied, warmed, with a force in a local direction."""
    from lopin.mesh import together

    low = mesh_make.block((2.0, 1.0), (4, 2))
    up = mesh_make.block((2.0, 1.0), (3, 2), origin=(0.0, 1.0))
    model = lopin.Model("two", together(UP=up, LOW=low))
    model.section("UP", Material(STEEL, expansion=1e-5))
    model.section("LOW", Material(STEEL, expansion=1e-5))
    model.tie("UP.BOTTOM", "LOW.TOP", tolerance=1e-6)
    model.fix("LOW.BOTTOM", "y")
    model.fix("LOW.LEFT", "x")
    return model


def test_a_tied_block_that_is_warmed_grows_freely(core):
    model = two_blocks()
    for body in ("UP", "LOW"):
        model.initial_temperature(f"{body}.TOP", 20.0)
    every = np.arange(model.mesh.n_point)
    model.initial.clear()
    model.initial_temperature(every, 20.0)
    model.step(nlgeom=False).temperature(every, np.full(len(every), 120.0)).checkpoint(1)
    read_back(model)
    result = model.run()
    top = model.mesh.point_sets["UP.TOP"]
    # Plane strain: the strain across the plane is held, (1 + nu) alpha dT in it.
    assert result["U"][top, 1] == pytest.approx(2.0*1.3*1e-5*100.0, rel=1e-9)


def test_equations_transforms_and_amplitudes(core):
    model = two_blocks()
    first, *_, corner = (int(k) for k in model.mesh.point_sets["UP.TOP"])
    model.equation((corner, "y", 1.0), (first, "y", -1.0))
    model.transform("UP.RIGHT", (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    model.initial_stress("UP", 0.0, 0.0)
    way = model.amplitude("WAY", [(0.0, 0.0), (0.5, 1.0), (1.0, 0.5)])
    step = model.step(4, fixed=True).move(first, y=-0.01, amplitude=way)
    step.body_force("LOW", x=1e-3).traction("UP.RIGHT", 1.0, (1.0, 0.0)).output(("U", "RF"))
    step.table("UP.TOP", "RF", totals="only").table("UP", "S", of="elements")
    read_back(model)
    result = model.run()
    path = [result.at(k)["U"][corner, 1] for k in range(4)]
    assert path == pytest.approx([-0.005, -0.01, -0.0075, -0.005], rel=1e-9)


def test_steps_replace_what_was_said_before(core):
    model = scene(nlgeom=False)
    die = model.tools[0]
    model.steps[0].pressure("RIGHT", 5.0)
    model.step().replace("supports", "pressures").fix("BOTTOM", "y").fix("LEFT", "x").move(
        die, y=0.0)
    deck, _ = read_back(model)
    assert "*DSLOAD, OP=NEW" in deck.text() and "*BOUNDARY, OP=NEW" in deck.text()
    result = model.run()
    assert abs(result["U"]).max() < 1e-12 < abs(result.at(0)["U"]).max()


def test_pairs_come_and_go(core):
    model = scene(nlgeom=False, friction=0.1)
    pair = model.contacts[0]
    model.step().change_friction(pair, lopin.Coulomb(0.3))
    model.step().remove_contact(pair)
    model.step().add_contact(("TOP", model.tools[0]))
    read_back(model)
    closed = model.run().history["TOP-DIE.closed"]
    assert (closed[[0, -1]] > 0).all() and closed[3] == 0
    with pytest.raises(lopin.ModelError, match="no contact pair TOP-BOTTOM"):
        model.steps[0].remove_contact(("TOP", "BOTTOM"))


@pytest.mark.parametrize("make, words", [
    (lambda: Plastic([(200.0, 0.1)]), "increase from 0"),
    (lambda: Plastic([(200.0, 0.0), (0.0, 0.1)]), "yield stress must be positive"),
    (lambda: lopin.Swift(500.0, 0.0, 0.2), "e0 of Swift"),
    (lambda: lopin.Voce(-1.0, 200.0, 3.0), "saturation"),
    (lambda: lopin.Kinematic([(200.0, 0.0)]), "two lines"),
    (lambda: lopin.Chaboche(200.0, []), "pairs of c and gamma"),
    (lambda: lopin.Hill48([1.0, 1.0]), "six ratios or three"),
    (lambda: flow_curves.Hardening().data(), "Plastic, Swift"),
    (lambda: lopin.NortonHoff(1.0, 1.5), "[0, 1]"),
    (lambda: lopin.CowperSymonds(0.0, 5.0), "must be positive"),
    (lambda: Material(), "at least one law"),
    (lambda: Material(METAL, Plastic(3.0)), "one of each kind"),
    (lambda: Material(3.0), "not a law"),
    (lambda: materials.Elastic(1.0, 0.3, strain="biot"), "logarithmic"),
    (lambda: lopin.Coulomb(-0.1), "mu must not be negative"),
    (lambda: lopin.Coulomb(0.1, regularization="steep"), "no regularization 'steep'"),
    (lambda: lopin.Coulomb(0.1, v0=0.0), "v0 must be positive"),
    (lambda: lopin.Tresca(), "needs m or tau_max"),
    (lambda: lopin.Orowan(0.1, 2.0), "m must lie in [0, 1]"),
    (lambda: friction.friction_of("much"), "a coefficient or a law"),
    (lambda: laws.Tabular(((0.0, 0.0),)), "two lines or more"),
    (lambda: scene().step(0), "increments >= 1"),
    (lambda: scene().step(largest=-1.0), "largest must be positive"),
    (lambda: scene().steps[0].replace("walls"), "nothing to replace"),
    (lambda: scene().options(colour="red"), "no option 'colour'"),
    (lambda: scene().amplitude("A", [(0.0, 1.0)]), "two points or more"),
    (lambda: scene(extension=0.5), "[0, 0.2]"),
    (lambda: scene().rigid_body("B"), "of points or of elements"),
])
def test_values_out_of_range_are_refused(make, words):
    with pytest.raises(UsageError) as caught:
        make()
    assert words in str(caught.value)


@pytest.mark.parametrize("use, words", [
    (lambda m: m.steps[0].move("TOPP", y=1.0), "no point set 'TOPP'"),
    (lambda m: m.steps[0].move(99, y=1.0), "indices 0 to 14"),
    (lambda m: m.steps[0].move("TOP", y=[1.0, 2.0]), "5 points need as many values"),
    (lambda m: m.steps[0].move("TOP", y=1.0, amplitude="UP"), "no amplitude 'UP'"),
    (lambda m: m.steps[0].pressure("UNDER", 1.0), "no surface set 'UNDER'"),
    (lambda m: m.steps[0].gravity("BODY", 1.0, (0.0, -1.0)), "no element set 'BODY'"),
])
def test_names_that_do_not_exist_are_refused(use, words):
    with pytest.raises(lopin.ModelError) as caught:
        use(scene())
    assert words in str(caught.value)


@pytest.mark.parametrize("card, words", [
    ("*EL FILE, POSITION=CENTROIDAL\nS", "no word for POSITION of \\*EL FILE"),
    ("*CONTROLS\n1.", "no method for \\*CONTROLS"),
])
def test_what_a_model_has_no_word_for_is_refused(card, words):
    text = scene().to_deck().text().replace("*END STEP", f"{card}\n*END STEP")
    with pytest.raises(UsageError, match=words):
        lopin.Model.read(lopin.Deck.parse(text))
