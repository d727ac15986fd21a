"""Bulk forming at default increments: billets, rings, strips, discs, a wire; see forming_scenes.

Flow curves are read as Kirchhoff stress = Y + H eps_p, stress by the volume at the start. Numbers
for mu = 0.1 are CalculiX 2.20 on a mesh twice refined; those of rings by Tresca are an upper bound
with straight walls.
"""
import functools
import sys
from pathlib import Path

import numpy as np
import pytest

import forming_scenes as scenes
import lopin
from lopin.closed_form import (disc_pressure, ring_bore, strip_pressure, strip_pressure_rough,
                               upset, wire_drawing)
from lopin.mesh_make import block


def moved(result, mesh, name, component=0):
    """Displacement of a named point at every increment, and the times; 0 at the start."""
    at = mesh.point_sets[name][0]
    return (np.r_[0.0, result.times],
            np.r_[0.0, [result.at(k)["displacement"][at, component]
                        for k in range(len(result.times))]])


def force(result, share):
    """Force of the plate at a share of its way."""
    return np.interp(share, result.history["time"], np.abs(result.history["PLATE.rf2"]))


@pytest.mark.parametrize("cells, quadratic", [((12, 18), False), ((4, 6), True)])
def test_a_billet_without_friction_stays_a_cylinder(cells, quadratic, sheet):
    mesh = scenes.billet(*cells, quadratic=quadratic)
    result = lopin.run(scenes.squeezed(mesh, scenes.E1, None, 0.6))
    exact = [upset(0.6*t, 200e3, 0.3, 700.0, 300.0, 10.0) for t in result.times]
    found = np.abs(result.history["PLATE.rf2"])[-len(exact):]
    assert found == pytest.approx([at.force for at in exact], rel=1e-6)
    assert 10.0 + moved(result, mesh, "MIDDLE")[1][1:] == pytest.approx([at.radius for at in exact],
                                                                        rel=1e-6)
    sheet.compare("E1 upsetting", f"{cells}, no friction: force at 60 %", found[-1],
                  exact[-1].force, 1e-6)


@pytest.mark.parametrize("cells", [(12, 18), (24, 36)])
def test_a_billet_with_friction_rolls_its_side_onto_the_plate(cells, sheet):
    mesh = scenes.billet(*cells)
    result = lopin.run(scenes.squeezed(mesh, scenes.E1, scenes.coulomb(0.1), 0.6,
                                       sizes=(0.01, 1e-6, 0.05)))
    for share, kilonewton in ((0.2, 306.0), (0.3, 368.0), (0.4, 456.0)):
        sheet.compare("E1 upsetting", f"{cells}, mu 0.1: force at {100*share:.0f} %",
                      force(result, share/0.6)/1e3,
                      kilonewton, 0.02, source="CalculiX 2.20, 48 x 72")
    assert force(result, 1.0)/1e3 == pytest.approx(800.0, abs=35.0)
    assert 10.0 + moved(result, mesh, "MIDDLE")[1][-1] == pytest.approx(16.35, abs=0.1)
    h = result.history
    assert h["volume"] == pytest.approx(np.pi*100.0*15.0, rel=5e-3)
    spent = h["energy.strain"] + h["energy.plastic"] + h["energy.friction"]
    assert spent[-1] == pytest.approx(h["energy.external"][-1], rel=0.01)
    side = result.contact(0).last
    assert np.count_nonzero((side.x[:, 1] < 14.999) & (side.pressure > 0.0)) >= 1
    assert -side.gap.min() < 1e-3*10.0/cells[0]


@pytest.mark.parametrize("cells, quadratic", [((12, 18), False), ((6, 9), True)])
def test_a_mortar_slave_with_a_sharp_corner_rolls_onto_a_meshed_plate(cells, quadratic):
    sys.path.insert(0, str(Path(__file__).resolve().parents[1]/"benchmarks"))
    from forming_decks import deck

    def run(contact):
        text = deck(scenes.billet(*cells, quadratic=quadratic), scenes.E1, 0.1, 0.6,
                    ("TOP", "RIGHT"), (0.0, 24.0), contact, quadratic, increments=20)
        return lopin.run(lopin.Deck.parse(text, "billet", "."))

    mortar, nodes = run("SURFACE TO SURFACE"), run("NODE TO SURFACE")
    # The side does not look at the plate: its rim is not within it at the start.
    assert not [said for said in mortar.diagnostics if said["code"] == "W0311"]
    assert mortar.times[-1] == pytest.approx(1.0)
    pushed = [np.interp(0.6, r.history["time"], np.abs(r.history["BODY.SKIN-PLATE.FACE.force2"]))
              for r in (mortar, nodes)]
    assert pushed[0] == pytest.approx(pushed[1], rel=0.01)
    rim = mortar.contact(0).last
    assert np.count_nonzero((rim.x[:, 1] < 14.999) & (rim.pressure > 0.0)) >= 1


def ring_bores(friction, reductions, quadratic=False, law=scenes.RIGID_PLASTIC,
               sizes=(0.01, 1e-6, 0.02), cells=(16, 10), full=False):
    """Changes of the bore at mid-height and at the plate [mm], and forces."""
    mesh = scenes.ring(*cells, quadratic=quadratic)
    result = lopin.run(scenes.squeezed(mesh, law, friction, 0.5, surfaces=("TOP", "RIGHT", "LEFT"),
                                       axis=False, sizes=sizes, reduced=quadratic,
                                       full=full))
    shares = 2.0*np.asarray(reductions)
    return (np.interp(shares, *moved(result, mesh, "BORE_MIDDLE")),
            np.interp(shares, *moved(result, mesh, "BORE_PLATE")),
            np.array([force(result, s) for s in shares]))


@pytest.mark.parametrize("m, reductions", [(0.0, (0.1, 0.3, 0.5)), (0.05, (0.1, 0.3, 0.5)),
                                           (0.1, (0.1, 0.3, 0.5)),
                                           (0.15, (0.1, 0.3)), (0.2, (0.1, 0.3))])
def test_a_ring_tells_the_shear_factor(m, reductions, sheet):
    bores, _, _ = ring_bores(scenes.tresca(m), reductions)
    for r, bore in zip(reductions, 100.0*bores/7.5):
        bound = 100.0*ring_bore(m, r)
        sheet.compare("E5 ring", f"m {m}: change of the bore [%] at {100*r:.0f} %", bore, bound,
                      2.0, source="upper bound", absolute=True)


def test_a_ring_tells_coulomb_s_coefficient(sheet):
    bores, _, forces = ring_bores(scenes.coulomb(0.1), (1/6, 0.25, 1/3, 0.5), quadratic=True,
                                  law=scenes.E5B, sizes=(0.01, 1e-6, 0.01))
    assert bores == pytest.approx([0.1222, 0.1468, 0.0812, -0.606], abs=0.05)
    assert forces/1e3 == pytest.approx([150.1, 173.4, 204.1, 307.7], rel=0.015)
    sheet.compare("E5 ring", "mu 0.1: force at 33 %", forces[2]/1e3, 204.1, 0.015,
                  source="CalculiX 2.20, 32 x 20")


@pytest.mark.parametrize("mu, middle, plate, kilonewton", [
    (0.05, (0.461, 0.707, 0.948, 1.295), (0.407, 0.612, 0.805, 1.016), (142.5, 164.1, 192.2, 284.7)),
    (0.2, (-0.266, -0.438, -0.699, -1.702), (-0.115, -0.246, -0.420, -0.876),
     (163.7, 192.7, 232.8, 391.0))])
def test_a_ring_of_plainly_integrated_quads_is_that_of_calculix(mu, middle, plate, kilonewton,
                                                                 sheet):
    # CalculiX's CAX4 locks; docs/ring-compression.md compares the elements.
    bores, edges, forces = ring_bores(scenes.coulomb(mu), (1/6, 0.25, 1/3, 0.5), law=scenes.E5B,
                                      cells=(32, 20), full=True)
    assert edges == pytest.approx(plate, abs=0.05)
    assert forces/1e3 == pytest.approx(kilonewton, rel=0.015)
    for r, found, said in zip((16.7, 25.0, 33.3, 50.0), bores, middle):
        sheet.compare("E5 ring", f"mu {mu}, plain CAX4: change of the bore [mm] at {r} %", found, said,
                      0.05, source="CalculiX 2.20, CAX4 32 x 20", absolute=True)


REDUCTIONS = (0.1, 0.2, 0.3, 0.4, 0.5)


@pytest.mark.parametrize("law", [lopin.Orowan(0.577, 0.1), lopin.Cristescu(0.1),
                                 lopin.NortonHoffFriction(0.1*200/3**0.5, 0.005)],
                         ids=lambda law: law.law)
def test_laws_of_a_flowing_ring_agree(law):
    other, *_ = ring_bores(law, REDUCTIONS)
    assert 100.0*other/7.5 == pytest.approx(100.0*by_tresca()/7.5, abs=0.3)


@functools.cache
def by_tresca():
    """Bores of the same ring by Tresca's law."""
    return ring_bores(scenes.tresca(0.1), REDUCTIONS)[0]


def squeezed_a_little(size, cells, m, full=False, kind="plane strain"):
    """Force and largest half width of a rigid-plastic body pressed by 1 %; half height 1."""
    mesh = block(size, cells)
    result = lopin.run(scenes.squeezed(mesh, scenes.RIGID_PLASTIC, scenes.tresca(m), 0.01,
                                       kind=kind, full=full, sizes=(0.1, 1e-6, 0.2)))
    half = size[0] + result["displacement"][mesh.point_sets["TOP"], 0].max()
    return abs(result.history["PLATE.rf2"][-1]), half


@pytest.mark.parametrize("width", [1, 2, 4, 8])
@pytest.mark.parametrize("m", [0.2, 1.0])
def test_a_strip_stays_below_its_upper_bound(m, width, sheet):
    push, half = squeezed_a_little((float(width), 1.0), (max(8, 8*width), 8), m)
    found, ratio = push/half/(400.0/3**0.5), half/0.99
    assert 1.0 < found <= strip_pressure(m, ratio)
    if m < 1.0:
        sheet.compare("E2 strip", f"w/h {width}, m {m}: p/2k", found, strip_pressure(m, ratio),
                      0.03, source="upper bound")
    elif width >= 4:
        assert found >= strip_pressure_rough(ratio)


def test_mean_dilatation_frees_a_strip_that_full_integration_locks():
    push, half = squeezed_a_little((8.0, 1.0), (32, 4), 1.0)
    locked, _ = squeezed_a_little((8.0, 1.0), (32, 4), 1.0, full=True)
    assert push/half/(400.0/3**0.5) <= strip_pressure(1.0, half/0.99)
    assert locked > 1.02*push


@pytest.mark.parametrize("ratio", [0.5, 1.0, 2.0, 5.0])
@pytest.mark.parametrize("m", [0.2, 1.0])
def test_a_disc_stays_below_its_upper_bound(m, ratio, sheet):
    push, _ = squeezed_a_little((2.0*ratio, 1.0), (max(8, int(16*ratio)), 8), m,
                                kind="axisymmetric")
    radius = 2.0*ratio/0.99**0.5
    found, bound = push/(np.pi*radius**2)/200.0, disc_pressure(m, radius/1.98)
    assert 1.0 < found <= bound
    if m < 1.0:
        sheet.compare("E3 disc", f"R/h {ratio}, m {m}: p/Y", found, bound, 0.03,
                      source="upper bound")


def test_a_wire_draws_between_its_bounds(sheet):
    law = (200e3, 0.3, ((200.0, 0.0),))
    result = lopin.run(scenes.wire(10.0, 9.0, 8.0, law, None, 8.0, (4, 51),
                                   sizes=(0.01, 1e-6, 0.02)))
    stress = np.abs(result.history["DIE.rf2"])/(np.pi*4.5**2)/200.0
    steady = stress[len(stress)//2:].mean()
    bounds = wire_drawing(10.0, 9.0, 8.0)
    assert bounds.ideal < steady <= bounds.bound
    sheet.compare("E13 wire", "mean stress over Y, no friction", steady,
                  0.5*(bounds.ideal + bounds.bound), 0.2, source="half-way between bounds")
