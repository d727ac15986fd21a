"""Why an error asked for cannot be met, and what would meet it."""
from __future__ import annotations

import math

from .mesh_error import LEAST_ORDER, MOST_ORDER


def contact_alone(found) -> str:
    """What no finer mesh makes better."""
    if found.uneven > 0.5*found.enforcement:
        return f"facets that do not match make the pressure uneven by about " \
            f"{100.0*found.uneven:.2g} % (W0333), whatever the mesh: TYPE=SURFACE TO SURFACE"
    return f"the stiffness of contact alone leaves {100.0*found.enforcement:.2g} %, whatever " \
        "the mesh: *SURFACE BEHAVIOR, DIRECT; a slope that is a law of the surface itself is " \
        "PRESSURE-OVERCLOSURE=TABULAR, whose points are no error"


def slides(found) -> str:
    """What the path leaves out, of a pressure: it may be that of the areas of the start or of the
    present ones, which only the user knows."""
    return f"contact on the shape at the start, as path condensed has it, differs by " \
        f"{100.0*found.sliding:.2g} % from that on the present one: *LOPIN, PATH=FINITE follows " \
        "that on all meshes, PATH=CONDENSED asks for the shape at the start alone"


def out_of_time(found, size: int, ahead: float, limit: float) -> str:
    """What would meet it."""
    known = "its error is not known yet" if math.isnan(found.mesh) else \
        f"{100.0*found.error:.2g} % of {100.0*found.target:g} % is met"
    return f"{known} with {found.levels[-1].elements} elements; the next mesh has {size} and " \
        f"would take about {ahead:.2g} s, above {limit:g}"


def out_of_reach(found, elements: int, limit: int, dims: int) -> str:
    """What would meet it."""
    if math.isnan(found.mesh):
        return f"a finer mesh has {elements} elements, above {limit}"
    order = 1.0 if math.isnan(found.order) else \
        min(max(found.order, LEAST_ORDER), MOST_ORDER[False])
    room = found.target - found.besides
    if room <= 0.0:
        return f"increments, contact and small sliding alone leave {100.0*found.besides:.2g} %"
    halvings = math.ceil(math.log2(found.mesh/room)/order)
    needed = found.levels[-1].elements*2**(dims*halvings)
    return f"{100.0*found.error:.2g} % of {100.0*found.target:g} % is met with " \
        f"{found.levels[-1].elements} elements; about {needed} would meet it, above {limit}: " \
        "refine the deck's mesh where the pressure changes, or take quadratic elements"
