"""Sheets of solid elements: words with I bend without locking at one element through the
thickness."""
import numpy as np
import pytest

from lopin import Elastic, Model, mesh_make

YOUNG, POISSON, LENGTH = 1000.0, 0.3, 100.0
KINDS = ["plane strain", "plane stress", "3d"]


def cantilever(kind, load, elements, *, nlgeom=True, letters="I", layers=1):
    """Mean (x, y) displacement of the free end / length; load P L^2/(E I), thickness 1."""
    size, cells = (LENGTH, 1.0), (elements, layers)
    if kind == "3d":
        size, cells = size + (1.0,), cells + (1,)
    mesh = mesh_make.block(size, cells)
    model = Model("cantilever", mesh, kind=kind, letters=letters)
    model.section("ALL", Elastic(YOUNG, POISSON))
    model.fix("LEFT", *("xyz" if kind == "3d" else "xy"))
    modulus = YOUNG/(1.0 - POISSON**2) if kind == "plane strain" else YOUNG
    tip = np.isclose(mesh.points[:, 0], LENGTH)
    step = model.step(increments=10 if nlgeom else 1, nlgeom=nlgeom)
    step.force("RIGHT", each=True, y=load*modulus/12.0/LENGTH**2/tip.sum())
    return model.run().at(-1)["U"][tip].mean(axis=0)[:2]/LENGTH


@pytest.mark.parametrize("kind", KINDS)
def test_a_slender_cantilever_bends_as_a_beam(kind):
    assert cantilever(kind, 1e-3, 20, nlgeom=False)[1] == pytest.approx(1e-3/3.0, rel=0.01)


@pytest.mark.parametrize("load, down, along", [(1.0, 0.30172, 0.05643), (5.0, 0.71379, 0.38763)])
@pytest.mark.parametrize("kind", KINDS)
def test_a_slender_cantilever_bends_as_the_elastica(kind, load, down, along):
    # Mattiasson 1981, table 1
    assert cantilever(kind, load, 20) == pytest.approx([-along, down], rel=0.015)


def test_mean_dilatation_alone_locks_in_shear():
    assert cantilever("plane strain", 1e-3, 20, nlgeom=False, letters="")[1] < 0.2e-3


def test_a_thin_disc_under_pressure_is_a_plate():
    radius, pressure = 100.0, 1e-4
    mesh = mesh_make.block((radius, 1.0), (20, 1))
    model = Model("disc", mesh, kind="axisymmetric", letters="I")
    model.section("ALL", Elastic(YOUNG, POISSON))
    model.fix("RIGHT", "r", "z")
    model.fix("LEFT", "r")
    model.step().pressure("TOP", pressure)
    middle = model.run().at(-1)["U"][np.isclose(mesh.points[:, 0], 0.0), 1].mean()
    stiffness = YOUNG/12.0/(1.0 - POISSON**2)
    assert middle == pytest.approx(-pressure*radius**4/64.0/stiffness, rel=0.01)
