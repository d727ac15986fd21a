"""Why an error asked for cannot be met, and what would meet it."""
from __future__ import annotations

import math

from ..model_read_mesh import MeshCards, expanded
from ..refine.children import cell_of
from .mesh_error import FALLS, LEAST_ORDER, MOST_ORDER, halved

#: Share of a number on the mesh before that is left of one whose limit is 0.
VANISHES = 0.6


def contact_alone(found) -> str:
    """What no finer mesh makes better."""
    if found.uneven > 0.5*found.enforcement:
        return f"facets that do not match make the pressure uneven by about " \
            f"{100.0*found.uneven:.2g} % (W0333), whatever the mesh: TYPE=SURFACE TO SURFACE"
    return f"the stiffness of contact alone leaves {100.0*found.enforcement:.2g} %, whatever " \
        "the mesh: *SURFACE BEHAVIOR, DIRECT; a slope that is a law of the surface itself is " \
        "PRESSURE-OVERCLOSURE=TABULAR, whose points are no error"


def no_limit(found, levels) -> str:
    """Why no finer mesh makes the number better known; empty: it does."""
    known = halved(levels)
    scale = max(abs(found.value), 1e-300)
    apart = [v.difference for v in known]
    values = [abs(v.value) for v in levels[-3:]]
    peak = found.quantity.kind == "PEAK PRESSURE"
    grows = [b >= (FALLS if peak else 1.0)*a for a, b in zip(apart, apart[1:])]
    if found.mesh <= found.target:
        return ""
    if len(grows) >= 2 and all(grows[-2:]):
        return f"the {found.quantity} changes {'hardly less' if peak else 'more'} with each " \
            "finer mesh " \
            f"({', '.join(f'{100.0*v/scale:.2g} %' for v in apart)}): it has no limit, as at " \
            + (point_loads(found) or
               "a sharp edge; ask for a force, a displacement or PRESSURE")
    if len(known) >= 2 and all(b < VANISHES*a for a, b in zip(values, values[1:])):
        return f"the {found.quantity} falls with each finer mesh " \
            f"({', '.join(f'{v:.4g}' for v in values)}): it has no limit but 0, as the share of " \
            "single nodes of a support; ask for the whole of it"
    return ""


def point_loads(found) -> str:
    """Forces on single nodes of solids, under which displacements have no limit; empty: none."""
    if found.deck is None or found.quantity.kind != "DISPLACEMENT":
        return ""
    blocks = expanded(found.deck)
    cards = MeshCards(blocks)
    solid = {n for word, nodes in cards.elements.values() if cell_of(word) for n in nodes}
    loaded = {n: None for b in blocks if b.keyword == "CLOAD" for row in b.data
              for n in cards.labels(row[0]) if n in solid}
    if not loaded:
        return ""
    names = ", ".join(map(str, [*loaded][:4])) + (", ..." if len(loaded) > 4 else "")
    return f"the forces of *CLOAD on single nodes ({names}), points on every mesh: load the " \
        "surface by *DSLOAD or *DLOAD"


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
