"""Friction by area where contact is narrower than a facet: W0560."""
import numpy as np
import pytest

import lopin
from lopin import mesh_make
from lopin.atlas.forming_scenes import air_bend, billet
from lopin.model import Model
from lopin.model_deck import mesh_deck

TRESCA = ("*FRICTION, LAW=TRESCA", "0.3,")


def told(result):
    return [w["message"] for w in result.diagnostics if w["code"] == "W0560"]


@pytest.mark.parametrize("friction, said", [
    (TRESCA, True), (("*FRICTION, LAW=CRISTESCU", "0.3,"), True), (("*FRICTION", "0.3,"), False)])
def test_a_sheet_over_radii_is_told_unless_friction_follows_the_force(solve, friction, said):
    """One node has the area of a facet of 1 mm: with quarter facets the punch needs less."""
    text = air_bend("CPE4I", 1.0, 0.0, friction=friction)[0].deck().text()
    bent = lopin.Deck.parse(text[:text.rindex("*STEP")], "bent")   # and not let go
    assert bool(told(solve(bent))) == said


def test_a_billet_under_a_plate_is_not_told(solve):
    """What presses side by side is known but for a facet."""
    assert not told(solve(billet("CPE4", TRESCA)[0].deck()))


def test_the_side_of_a_thin_disc_beside_its_top_is_not_told(core):
    """Of the facets at the rim of the top, which touches as a whole, one belongs to the side."""
    mesh = mesh_make.block((10.0, 0.5), (4, 2))
    mesh = mesh.replaced(surfaces={"SKIN": np.vstack([mesh.surfaces["TOP"],
                                                      mesh.surfaces["RIGHT"]])})
    text = mesh_deck(Model("disc", mesh, kind="axisymmetric")).text()
    text += "\n".join([
        "*MATERIAL, NAME=M", "*ELASTIC", "200000., .3", "*PLASTIC", "300., 0.", "600., 2.",
        "*SOLID SECTION, ELSET=ALL, MATERIAL=M", "*NODE, NSET=R", "9999, 0., 1.",
        "*SURFACE, NAME=P, TYPE=SEGMENTS", "START, 30., 0.5", "LINE, -1., 0.5",
        "*RIGID BODY, ANALYTICAL SURFACE=P, REF NODE=R", "*SURFACE INTERACTION, NAME=I",
        "*FRICTION, LAW=TRESCA", "0.5,", "*CONTACT PAIR, INTERACTION=I", "SKIN, P", "*BOUNDARY",
        "LEFT, 1", "BOTTOM, 2", "R, 1", "R, 6", "*STEP, NLGEOM, INC=500", "*STATIC", ".05, 1.",
        "*BOUNDARY", "R, 2, 2, -0.15", "*END STEP", ""])
    assert not told(lopin.run(lopin.Deck.parse(text, "disc")))
