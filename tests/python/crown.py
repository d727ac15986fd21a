"""A crowned block pressed on a rigid floor, clamped far away: the deck of the tests of charts."""
from lopin import Model, mesh_make, profile
from lopin.laws import Elastic


def crown(folder):
    """The deck in a folder."""
    mesh = mesh_make.crowned_block((2.0, 1.0), (8, 4), 20.0)
    model = Model("crown", mesh, kind="plane strain")
    model.section("ALL", Elastic(210e3, 0.3))
    floor = model.rigid_tool("FLOOR", profile.plane(0.0, 5.0, side="above"))
    model.contact("BOTTOM", floor)
    model.fix("TOP", "x", "y")
    model.step().move(floor, y=0.01)
    return str(model.to_deck().write(folder/"crown.inp"))
