"""Deck of a square cup whose flange is trimmed and that springs back:

    python decks/make/trimmed_cup.py > decks/trimmed_cup.inp

draws the cup of `square_cup.py` first (12 s), takes its state along and lets tools and scrap go.
"""
import sys

from square_cup import square_cup

import lopin
from lopin.same_mesh import next_on_same_mesh

COMMENT = """** The flange of square_cup is trimmed, and the cup springs back: {line}.
**
** The deck goes on where the drawing of 15 mm has ended: nodes at their places of the flat blank, displacements in
** *START, what the points of the C3D8I remember in *INITIAL CONDITIONS, TYPE=MEMORY, internal modes included. The
** elements beyond x = 60 or y = 60 mm are gone, and so are the tools; what they held fades over the step. The
** middle of the bottom stays at its height. Written by decks/make/trimmed_cup.py (lopin.same_mesh).
**
** Let go of at once the cup ends in the same place within 2e-5 mm; the whole flange springs back as it does in a
** step of square_cup that takes the contact pairs away, within 1e-9 mm (tests/python/test_same_mesh.py: blocks).
** What supports bear adds up to nothing, as no tool is left.
**
** expect: certificate.verdict = PASS
** expect: certificate.energy < 0.001
** expect: node.{side}.u3 = {u_side:.4g} +- 0.5 %
** expect: node.{corner}.u3 = {u_corner:.4g} +- 0.5 %
"""
CARDS = """*NSET, NSET=MIDDLE
{middle}
*NSET, NSET=RIM
{side}, {corner}
*BOUNDARY
BLANK.LEFT, 1
BLANK.FRONT, 2
*STEP, NAME=SPRINGBACK, NLGEOM
*STATIC
0.1, 1., , 0.2
*BOUNDARY, FIXED
MIDDLE, 3
*OUTPUT, FIELD, FREQUENCY=1
*NODE OUTPUT
U
*ELEMENT OUTPUT
S, PEEQ
*NODE PRINT, NSET=RIM
U
*END STEP
"""
#: Where the flange ends, before springback [mm].
EDGE = 60.0


def beyond(places):
    """What is trimmed off."""
    return places[:, :2].max(axis=1) > EDGE


def trimmed_cup() -> str:
    """The deck; its comment says where the rim ends."""
    with lopin.open(lopin.Deck.parse(square_cup(), name="square_cup")) as job:
        for _ in job:
            if job._session.field("STATE OF CLOCK")[0][0] == 2.0 and \
                    job._session.field("STATE OF CLOCK")[0][4]:
                break
        names = rim_of(job)
        deck, carried = next_on_same_mesh(job, "BLANK", CARDS.format(**names), name="trimmed_cup",
                                          trim=beyond, release=1.0)
    result = lopin.run(deck)
    labels = [row[0] for row in deck["NODE"].data]
    end = {f"u_{k}": result["displacement"][labels.index(names[k])][2] for k in ("side", "corner")}
    share = carried.gone_volume/(carried.volume + carried.gone_volume)
    line = f"{carried.gone} of {carried.gone + carried.elements} elements, {100.0*share:.0f} %"
    return COMMENT.format(line=line, **names, **end) + deck.text()


def rim_of(job) -> dict[str, int]:
    """Nodes of the lower face: of the middle of the bottom, of the rim on an axis and in the corner."""
    from lopin.remesh.body import DeckParts

    cards = DeckParts.of(job.deck).cards
    motion = job._session.field("STATE OF MOTION")
    place = {n: list(x) for n, x in cards.nodes.items()}
    for label, dof, moved in motion[:, :3]:
        if dof <= 3:
            place[int(label)][int(dof) - 1] += moved
    low = [n for _, nodes in cards.elements.values() for n in nodes[:4]
           if not cards.nodes[n][2] and max(place[n][:2]) < EDGE + 3.0]
    stay = {n for _, nodes in cards.elements.values()
            if max(sum(place[n][k] for n in nodes)/len(nodes) for k in (0, 1)) <= EDGE
            for n in nodes}
    low = sorted(set(low) & stay)
    return {"middle": min(low, key=lambda n: sum(place[n][:2])),
            "side": max((n for n in low if not cards.nodes[n][1]), key=lambda n: place[n][0]),
            "corner": max(low, key=lambda n: min(place[n][:2]))}


if __name__ == "__main__":
    sys.stdout.write(trimmed_cup())
