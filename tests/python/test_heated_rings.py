"""Round bodies whose facets match, warmed: their nodes stay opposite each other, and no body turns."""
import lopin
import numpy as np
import pytest


def rings(facets: int, type_: str) -> lopin.Deck:
    """A quarter of a ring 5 to 7 in one of 7 to 10, the inner one warmed by 100 K, no friction."""
    lines = ["*NODE"]
    elements, sets, first = [], {"LEFT": [], "BOTTOM": []}, 0
    for a, b, name in ((5.0, 7.0, "A"), (7.0, 10.0, "B")):
        number = np.arange(first + 1, first + 1 + 4*(facets + 1)).reshape(4, facets + 1)
        for i, r in enumerate(np.linspace(a, b, 4)):
            for j, t in enumerate(np.linspace(0.0, np.pi/2, facets + 1)):
                lines.append(f"{number[i, j]}, {float(r*np.cos(t))!r}, {float(r*np.sin(t))!r}")
        sets["BOTTOM"] += number[:, 0].tolist()
        sets["LEFT"] += number[:, -1].tolist()
        elements.append(f"*ELEMENT, TYPE=CPS4, ELSET={name}")
        for i in range(3):
            for j in range(facets):
                e = 100*(name == "B")*facets + 1 + i*facets + j
                elements.append(f"{e}, " + ", ".join(map(str, (
                    number[i, j], number[i + 1, j], number[i + 1, j + 1], number[i, j + 1]))))
        sets[f"{name}IN"], sets[f"{name}OUT"] = number[0].tolist(), number[-1].tolist()
        first = number[-1, -1]
    for name, nodes in sets.items():
        lines += [f"*NSET, NSET={name}", *(f"{n}," for n in nodes)]
    lines += [*elements, "*SURFACE, NAME=OUTER", *(f"{1 + 2*facets + j}, S2" for j in range(facets)),
              "*SURFACE, NAME=INNER", *(f"{100*facets + 1 + j}, S4" for j in range(facets)),
              "*MATERIAL, NAME=WARM", "*ELASTIC", "1000., .3", "*EXPANSION", "1e-5,", "*MATERIAL, NAME=COLD",
              "*ELASTIC", "1000., .3", "*SOLID SECTION, ELSET=A, MATERIAL=WARM", "1.,",
              "*SOLID SECTION, ELSET=B, MATERIAL=COLD", "1.,", "*SURFACE INTERACTION, NAME=I",
              "*SURFACE BEHAVIOR, DIRECT", f"*CONTACT PAIR, INTERACTION=I{type_}", "INNER, OUTER", "*NSET, NSET=ALL",
              f"1, {first}, 1", "*BOUNDARY", "LEFT, 1", "BOTTOM, 2", "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "ALL, 0.",
              "*STEP", "*STATIC", "*TEMPERATURE", "ALL, 100.", "*END STEP", ""]
    text = "\n".join(lines).replace("*NSET, NSET=ALL\n", "*NSET, NSET=ALL, GENERATE\n")
    return lopin.Deck.parse(text, "rings")


@pytest.mark.parametrize("type_", ["", ", TYPE=SURFACE TO SURFACE"])
@pytest.mark.parametrize("facets", [4, 6, 9])
def test_warmed_rings_move_alike_all_round(solve, facets, type_):
    """At the nodes their outer side moved by .0054 at one end and .0030 at the other, six facets, and PASS."""
    result = solve(rings(facets, type_))
    u = np.linalg.norm(result["U"][-(facets + 1):, :2], axis=1)
    assert u == pytest.approx(u.mean(), rel=0.02)
    assert ("N0347" in {d["code"] for d in result.diagnostics}) == (not type_)
