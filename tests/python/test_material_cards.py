"""What belongs to a body in a deck: all cards of its material, whatever they are and in any order."""
import pytest
from test_point_states import deck, grid

import lopin
from lopin.errors import ModelError
from lopin.material_cards import of_body, of_materials
from lopin.remesh.balance import _elastic
from lopin.remesh.body import DeckParts, read_body
from lopin.remesh.refusals import refuse_what_stays_behind

CARDS = """*MATERIAL, NAME=Steel
*DAMAGE, CRITERION=COCKCROFT-LATHAM
*CONDUCTIVITY
30.
*ELASTIC
70000., .3
*PLASTIC
200., 0.
300., .5
*RATE DEPENDENT
40., 5.
"""


def parts(more="", section=""):
    """A block of `Steel`, another material, axes and controls before the section."""
    text = deck("CAX4", *grid("CAX4"), 5.0, -0.5).text()
    section_line = next(t for t in text.splitlines(True) if t.startswith("*SOLID SECTION"))
    text = text.replace(section_line, "")
    first = text.index("*MATERIAL")
    last = text.index("*SURFACE", first)
    axes = "*ORIENTATION, NAME=Rolled\n0., 1., 0., -1., 0., 0.\n*ORIENTATION, NAME=OTHER\n" \
        "1., 0., 0., 0., 1., 0.\n*SECTION CONTROLS, NAME=Full, FORMULATION=FULL\n"
    other = "*MATERIAL, NAME=RUBBER\n*HYPERELASTIC, NEO HOOKE\n.5, .04\n"
    new = f"*SOLID SECTION, ELSET=B, MATERIAL=STEEL{section}\n"
    return DeckParts.of(lopin.Deck.parse(
        text[:first] + other + CARDS + more + axes + other.replace("RUBBER", "GUM") + new
        + text[last:], name="block"))


def test_a_material_has_all_cards_below_it(core):
    found = of_materials(parts().blocks, {"STEEL"})
    assert [b.keyword for b in found] == ["MATERIAL", "DAMAGE", "CONDUCTIVITY", "ELASTIC",
                                          "PLASTIC", "RATE DEPENDENT"]


def test_a_body_has_what_its_section_names_and_no_more(core):
    scene = parts(section=", ORIENTATION=rolled, CONTROLS=FULL")
    heads = [b.head() for b in of_body(scene.blocks, scene.cards, set(scene.cards.elements))]
    assert heads[6:] == ["*ORIENTATION, NAME=Rolled", "*SECTION CONTROLS, NAME=Full, "
                         "FORMULATION=FULL", "*SOLID SECTION, ELSET=B, MATERIAL=STEEL, "
                         "ORIENTATION=rolled, CONTROLS=FULL"]
    assert "ORIENTATION" in [b.keyword for b in _elastic(scene, read_body(scene, "B"))]


def test_the_order_of_cards_hides_nothing_from_a_remesh(core):
    scene = parts()
    refuse_what_stays_behind(scene, read_body(scene, "B"))
    scene = parts("*POTENTIAL\n1., 1., 1.2, 1., 1., 1.\n")
    with pytest.raises(ModelError, match="material STEEL remembers"):
        refuse_what_stays_behind(scene, read_body(scene, "B"))
