"""Slave surfaces of nodes under friction whose shear stress has a limit: areas are found between the
nodes, or their lack is said."""
import pytest

from test_references import Scene, run


def scene(nlgeom, law, nodes):
    """The top of the block as nodes, pressed hard and dragged until all of it slips."""
    text = Scene(nlgeom=nlgeom, force=60.0, shear=0.2).text()
    text = text.replace("*SURFACE, NAME=TOP\n", f"*SURFACE, NAME=TOP, TYPE=NODE\n{nodes}\n*SURFACE, "
                        "NAME=UNUSED\n")
    return text.replace("*FRICTION\n0.3", law)


LAWS = {"taumax": ("*FRICTION, TAUMAX=0.5\n10.", 3.0),
        "tresca": ("*FRICTION, LAW=TRESCA, TAUMAX=0.5", 3.0)}
TOP = "\n".join(str(i) for i in range(37, 46))


@pytest.mark.parametrize("nlgeom", [False, True])
@pytest.mark.parametrize("law", LAWS)
def test_the_limit_acts_on_the_area_between_the_nodes(tmp_path, nlgeom, law):
    done, summary, rows = run(tmp_path, scene(nlgeom, LAWS[law][0], TOP))
    assert done.returncode == 0, done.stderr
    assert "N0318" in done.stderr and "W0307" not in done.stderr
    assert abs(rows[-1]["TOOL.rf1"]) == pytest.approx(LAWS[law][1], rel=2e-2)


def test_nodes_on_no_face_are_said(tmp_path):
    done, _, _ = run(tmp_path, scene(False, LAWS["taumax"][0], "37\n39\n41\n43\n45"))
    assert "W0307" in done.stderr and "N0318" not in done.stderr


def test_areas_of_the_deck_and_plain_friction_stay(tmp_path):
    given = TOP.replace("\n", ", 0.75\n") + ", 0.75"
    done, _, _ = run(tmp_path, scene(False, LAWS["taumax"][0], given))
    assert "N0318" not in done.stderr
    done, _, _ = run(tmp_path, scene(False, "*FRICTION\n0.3", TOP))
    assert "N0318" not in done.stderr
