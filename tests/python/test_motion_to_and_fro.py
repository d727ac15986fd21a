"""Slow motion that hops to and fro between two places comes to no rest, and ends at once."""
import re

import pytest
from sliding_scenes import deck

import lopin
from lopin.mesh import make as mesh_make
from lopin.mesh import together


@pytest.mark.parametrize("words", [", TYPE=NODE TO SURFACE", ""])
@pytest.mark.parametrize("fine", [0.25, 0.2])
def test_a_node_between_two_facets_is_refused_soon(executable, tmp_path, monkeypatch, words, fine):
    """One node of a coarse block presses the middle of a pillar: the facets beside it push it to
    either side in turn. Each of 20 motions took 100 to 600 linear systems."""
    monkeypatch.setenv("LOPIN_EXECUTABLE", str(executable))
    n = round(1.0/fine)*2
    mesh = together(A=mesh_make.block((20.0, 10.0), (2, 2), origin=(0.0, 10.0)),
                    P=mesh_make.block((2.0, 10.0), (n, 20), origin=(9.0, 0.0)))
    cards = f"""*MATERIAL, NAME=M
*ELASTIC
1000., 0.3
*SOLID SECTION, ELSET=A.ALL, MATERIAL=M
1.,
*SOLID SECTION, ELSET=P.ALL, MATERIAL=M
1.,
*SURFACE INTERACTION, NAME=I
*CONTACT PAIR, INTERACTION=I{words}
A.BOTTOM, P.TOP
*BOUNDARY
P.BOTTOM, 1, 2
A.TOP, 1, 1
*STEP, NLGEOM
*STATIC
1., 1., 0.004
*BOUNDARY
A.TOP, 2, 2, -0.1
*END STEP
"""
    try:
        lopin.run(deck(mesh, cards, tmp_path), tmp_path/"run", executable=True)
    except lopin.NotConvergedError:
        pass
    text = next((tmp_path/"run").glob("*.cvg")).read_text()
    assert "slow motion from" in text
    for motion in text.split("slow motion from")[1:]:
        systems = [int(s) for s in re.findall(r"slow motion: systems +(\d+)", motion)]
        assert max(systems, default=0) < 80
