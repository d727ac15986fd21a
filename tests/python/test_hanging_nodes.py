"""A mid-side node on the straight edge of an element of first order is named once."""
import pytest

from test_references import EXECUTABLE, run

pytestmark = pytest.mark.skipif(not EXECUTABLE, reason="LOPIN_EXECUTABLE names no executable")

MIXED = """*NODE, NSET=ALL
1, 0, 0
2, 1, 0
3, 2, 0
4, 0, 1
5, 1, 1
6, 2, 1
7, 0.5, 0
8, 1, 0.5
9, 0.5, 1
10, 0, 0.5
*ELEMENT, TYPE=CPE8, ELSET=E
1, 1, 2, 5, 4, 7, 8, 9, 10
*ELEMENT, TYPE=CPE4, ELSET=E
2, 2, 3, 6, 5
*MATERIAL, NAME=M
*ELASTIC
1000., 0.3
*SOLID SECTION, ELSET=E, MATERIAL=M
1.,
{more}*BOUNDARY
1, 1, 2
2, 2
*STEP
*STATIC
*CLOAD
6, 2, -1.
*END STEP
"""
HELD = "".join(f"*EQUATION\n3\n8, {k}, 2., 2, {k}, -1., 5, {k}, -1.\n" for k in (1, 2))


@pytest.mark.parametrize("more, count", [("", 1), (HELD, 0)])
def test_a_hanging_node_is_named(tmp_path, more, count):
    done, _, _ = run(tmp_path, MIXED.format(more=more))
    assert done.returncode == 0, done.stderr
    assert done.stderr.count("W0309") == count
    assert ("node 8 in the middle of an edge of element 1 hangs on the edge of element 2"
            in done.stderr) == bool(count)
