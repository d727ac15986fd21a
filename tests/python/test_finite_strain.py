"""Blocks at finite strain against closed forms: homogeneous, so one mesh is as good as another."""
import numpy as np
import pytest
from scipy.optimize import brentq

from lopin import Elastic, Model, NeoHooke, UsageError, mesh_make

WIDTH, HEIGHT = 2.0, 1.0
HENCKY = Elastic(1000.0, 0.3)
RUBBER = NeoHooke(0.5, 0.02)


def pressed(kind, material, stretch, unit=1.0, steps=1, **section):
    """The last fields of a block pressed between smooth plates to a share of its height."""
    mesh = mesh_make.block((WIDTH*unit, HEIGHT*unit), (4, 3))
    model = Model("pressed", mesh, kind=kind)
    model.section("ALL", material, **section)
    model.fix("BOTTOM", "z" if kind == "axisymmetric" else "y")
    model.fix("LEFT", "r" if kind == "axisymmetric" else "x")
    for k in range(steps):
        way = (stretch - 1.0)*HEIGHT*unit*(k + 1)/steps
        move = {"z" if kind == "axisymmetric" else "y": way}
        model.step(increments=2, nlgeom=k == 0).move("TOP", **move)
    return mesh, model.run().at(-1)


def neo_hooke(stretches):
    """Principal Kirchhoff stresses."""
    squares, volume = np.square(stretches), np.prod(stretches)
    return (2.0*RUBBER.c10*volume**(-2.0/3.0)*(squares - squares.mean())
            + 2.0/RUBBER.d1*volume*(volume - 1.0))


def hencky(stretches):
    shear = 0.5*HENCKY.young/(1.0 + HENCKY.poisson)
    lame = 2.0*shear*HENCKY.poisson/(1.0 - 2.0*HENCKY.poisson)
    return lame*np.log(stretches).sum() + 2.0*shear*np.log(stretches)


def free_stretch(kind, law, stretch):
    """(side, pressed, third) stretches without stress on the sides."""
    def third(side):
        if kind == "plane strain":
            return 1.0
        if kind == "axisymmetric":
            return side
        area = side*stretch
        return brentq(lambda t: law([side, stretch, t])[2], 0.5*min(1.0, 1.0/area),
                      2.0*max(1.0, 1.0/area), xtol=1e-14)

    side = brentq(lambda s: law([s, stretch, third(s)])[0], 0.4, 3.0, xtol=1e-14)
    return np.array([side, stretch, third(side)])


@pytest.mark.parametrize("stretch", [0.5, 1.6])
@pytest.mark.parametrize("material, law", [(HENCKY, hencky), (RUBBER, neo_hooke)],
                         ids=["Hencky", "neo-Hooke"])
@pytest.mark.parametrize("kind", ["plane strain", "plane stress", "axisymmetric"])
def test_a_block_widens_and_resists_by_its_law(kind, material, law, stretch):
    mesh, fields = pressed(kind, material, stretch)
    stretches = free_stretch(kind, law, stretch)
    stress = law(stretches)/np.prod(stretches)
    assert fields["U"][:, 0] == pytest.approx((stretches[0] - 1.0)*mesh.points[:, 0], abs=1e-8)
    assert fields["S"][:, 1] == pytest.approx(stress[1], rel=1e-7)
    assert fields["S"][:, 0] == pytest.approx(0.0, abs=1e-7*abs(stress[1]))


def test_units_do_not_matter():
    _, one = pressed("plane strain", HENCKY, 0.7)
    _, two = pressed("plane strain", Elastic(1e9, 0.3), 0.7, unit=1e-3)
    assert two["U"] == pytest.approx(1e-3*one["U"], abs=1e-11)


def test_two_steps_give_what_one_gives_and_nlgeom_stays_on():
    _, one = pressed("plane strain", HENCKY, 0.6)
    _, two = pressed("plane strain", HENCKY, 0.6, steps=2)
    assert two["U"] == pytest.approx(one["U"], abs=1e-9)


def test_full_integration_is_the_same_where_strain_is_uniform():
    _, one = pressed("axisymmetric", RUBBER, 0.6)
    _, two = pressed("axisymmetric", RUBBER, 0.6, full_integration=True)
    assert two["U"] == pytest.approx(one["U"], abs=1e-9)


def test_rubber_needs_positive_constants():
    with pytest.raises(UsageError):
        NeoHooke(0.5, 0.0)
