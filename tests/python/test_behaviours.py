"""*CHANGE SURFACE BEHAVIOR; plane elements beside axisymmetric ones; surfaces in two cards; stresses
of single points; what *NODE PRINT prints in axes of nodes; areas of nodes under a law of pressure."""
import json
import subprocess

import numpy as np
import pytest

import lopin


def run(tmp_path, text):
    (tmp_path/"job.inp").write_text(text)
    return lopin.run(tmp_path/"job.inp", output=tmp_path/"out")


def codes(tmp_path):
    summary = json.loads((tmp_path/"out"/"job.json").read_text())
    return [item["code"] for item in summary["diagnostics"]]


def blocks(kind="C3D8", steps="", behaviour="*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n1000.",
           pair="TYPE=SURFACE TO SURFACE", slave="*SURFACE, NAME=DOWN\n2, S1", more=""):
    """Two cubes, one on the other; the upper one is held sideways."""
    nodes = [(x, y, z) for z in (0., 1., 1., 2.) for x, y in ((0., 0.), (1., 0.), (1., 1.), (0., 1.))]
    text = "*NODE, NSET=ALL\n" + "".join(f"{i + 1}, {x}, {y}, {z}\n"
                                         for i, (x, y, z) in enumerate(nodes))
    return text + f"""*ELEMENT, TYPE={kind}, ELSET=LOW
1, 1, 2, 3, 4, 5, 6, 7, 8
*ELEMENT, TYPE={kind}, ELSET=UP
2, 9, 10, 11, 12, 13, 14, 15, 16
*NSET, NSET=FOOT
1, 2, 3, 4
*NSET, NSET=UPPER, GENERATE
9, 16
*NSET, NSET=HEAD
13, 14, 15, 16
*NSET, NSET=SEAM
9, 10, 11, 12
*MATERIAL, NAME=M
*ELASTIC
1.e5, 0.
*SOLID SECTION, ELSET=LOW, MATERIAL=M
*SOLID SECTION, ELSET=UP, MATERIAL=M
*SURFACE, NAME=TOP
1, S2
{slave}
*SURFACE INTERACTION, NAME=I
{behaviour}
{more}*CONTACT PAIR, INTERACTION=I, {pair}
DOWN, TOP
*BOUNDARY
FOOT, 1, 3
{steps}"""


def step(load, change="", nlgeom=", NLGEOM"):
    return (f"*STEP{nlgeom}\n*STATIC\n1., 1.\n{change}*CLOAD\n{load}\n*NODE FILE\nU\n"
            "*CONTACT FILE\nCDIS, CSTR\n*END STEP\n")


HELD = "UPPER, 1, 2\n"
CHANGE = "*CHANGE SURFACE BEHAVIOR, INTERACTION=I\n*SURFACE BEHAVIOR, "


def lift(result, index):
    """Mean depth of the seam's nodes."""
    frame = result.at(index)
    seam = np.isin(frame["LABEL"], [9, 10, 11, 12])
    return frame["U"][seam, 2].mean()


@pytest.mark.parametrize("change, depth", [
    ("PRESSURE-OVERCLOSURE=LINEAR\n4000.\n", 0.01/4), ("DIRECT\n", 0.0),
    ("PRESSURE-OVERCLOSURE=TABULAR\n0., 0.\n10., 0.005\n20., 0.02\n", 0.005)])
@pytest.mark.parametrize("pair", ["TYPE=SURFACE TO SURFACE", "TYPE=NODE TO SURFACE"])
@pytest.mark.parametrize("nlgeom", ["", ", NLGEOM"])
def test_a_slope_changes_between_steps(tmp_path, change, depth, pair, nlgeom):
    """10 on an area of 1: 0.01 deep with a slope of 1000, then by the new law."""
    result = run(tmp_path, blocks(steps=HELD + step("HEAD, 3, -2.5", "", nlgeom) + step(
        "HEAD, 3, -2.5", CHANGE + change, nlgeom), pair=pair))
    strain = 10.0/1e5
    assert lift(result, 0) == pytest.approx(-0.01 - strain, rel=3e-3)
    assert lift(result, -1) == pytest.approx(-depth - strain, rel=5e-3, abs=2e-6)
    assert "W0314" not in codes(tmp_path)


def test_glue_becomes_contact(tmp_path):
    """Tied while it is pulled; then a slope, which lets go."""
    tied = blocks(steps=HELD + step("HEAD, 3, 2.5") + step("HEAD, 3, -2.5", CHANGE
                  + "PRESSURE-OVERCLOSURE=LINEAR\n1000.\n"),
                  behaviour="*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TIED")
    result = run(tmp_path, tied)
    assert lift(result, 0) == pytest.approx(10.0/1e5, rel=2e-3)
    assert lift(result, -1) == pytest.approx(-0.01 - 10.0/1e5, rel=3e-3)


def test_shear_goes_on_through_a_change(tmp_path):
    """Friction of 0.5 bears 1 of the shear before the change, and after it."""
    steps = "".join(step("HEAD, 3, -2.5\nHEAD, 1, 0.25", change) for change in (
        "", CHANGE + "PRESSURE-OVERCLOSURE=LINEAR\n4000.\n"))
    text = blocks(steps="UPPER, 2\n" + steps, more="*FRICTION\n0.5, 500.\n")
    result = run(tmp_path, text)
    moved = [result.at(k)["U"][np.isin(result.at(k)["LABEL"], [9, 10, 11, 12]), 0].mean()
             for k in (0, -1)]
    assert moved[1] == pytest.approx(moved[0], rel=2e-2)
    assert moved[0] == pytest.approx(1.0/500.0, rel=5e-2)


@pytest.mark.parametrize("text, code", [
    ("*CHANGE SURFACE BEHAVIOR, INTERACTION=I\n", "E0306"),
    ("*CHANGE SURFACE BEHAVIOR, INTERACTION=J\n*SURFACE BEHAVIOR, DIRECT\n", "E0201"),
    (CHANGE + "PRESSURE-OVERCLOSURE=TIED\n", "E0108")])
def test_what_is_wrong_with_a_change_is_said(executable, tmp_path, text, code):
    (tmp_path/"job.inp").write_text(blocks(steps=HELD + step("HEAD, 3, -2.5")
                                           + step("HEAD, 3, -2.5", text)))
    done = subprocess.run([executable, "check", tmp_path/"job.inp"], capture_output=True, text=True)
    assert f"error[{code}]" in done.stderr, done.stderr


# --- plane elements beside axisymmetric ones

RIM = """*NODE, NSET=ALL
1, 1., 0.
2, 2., 0.
3, 2., 1.
4, 1., 1.
{plate}
*ELEMENT, TYPE=CAX4, ELSET=RING
1, 1, 2, 3, 4
*MATERIAL, NAME=M
*ELASTIC
1000., 0.
*SOLID SECTION, ELSET=RING, MATERIAL=M
"""


def test_spokes_hold_a_ring(tmp_path):
    """Plane spokes of total thickness t beyond r = 2, pulled by q: the ring bears t q in all."""
    t, q = 3.0, 5.0
    text = RIM.format(plate="5, 3., 0.\n6, 3., 1.") + (
        f"*ELEMENT, TYPE=CPS4, ELSET=SPOKE\n2, 2, 5, 6, 3\n*SOLID SECTION, ELSET=SPOKE, MATERIAL=M\n{t},\n"
        "*BOUNDARY\nALL, 2\n*STEP\n*STATIC\n1., 1.\n*DLOAD\n2, P2, -5.\n"
        "*NODE FILE\nU\n*EL FILE\nS\n*END STEP\n")
    mixed = run(tmp_path, text)
    assert "N0206" in codes(tmp_path)
    # the same ring under the same force, spread over its rim
    own = RIM.format(plate="") + (
        "*BOUNDARY\nALL, 2\n*STEP\n*STATIC\n1., 1.\n*DLOAD\n"
        f"1, P2, {-t*q/(2.0*np.pi*2.0)!r}\n*NODE FILE\nU\n*END STEP\n")
    alone = run(tmp_path, own)
    u = mixed["U"][:, 0]
    assert u[1] == pytest.approx(alone["U"][1, 0], rel=1e-9)
    assert u[4] - u[1] == pytest.approx(q/1000.0, rel=1e-9)


def test_a_plane_part_presses_on_a_ring(tmp_path):
    """A slab of thickness 3 on a ring: the force that it passes on is 3 q, by contact."""
    text = RIM.format(plate="5, 2., 0.\n6, 3., 0.\n7, 3., 1.\n8, 2., 1.") + (
        "*ELEMENT, TYPE=CPS4, ELSET=SLAB\n2, 5, 6, 7, 8\n*SOLID SECTION, ELSET=SLAB, MATERIAL=M\n3.,\n"
        "*SURFACE, NAME=IN\n2, S4\n*SURFACE, NAME=RIM\n1, S2\n*SURFACE INTERACTION, NAME=I\n"
        "*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE\nIN, RIM\n"
        "*BOUNDARY\nALL, 2\n*STEP\n*STATIC\n1., 1.\n*DLOAD\n2, P2, 5.\n"
        "*NODE FILE\nU\n*CONTACT FILE\nCSTR\n*END STEP\n")
    mixed = run(tmp_path, text)
    own = RIM.format(plate="") + (
        "*BOUNDARY\nALL, 2\n*STEP\n*STATIC\n1., 1.\n*DLOAD\n"
        f"1, P2, {3.0*5.0/(2.0*np.pi*2.0)!r}\n*NODE FILE\nU\n*END STEP\n")
    alone = run(tmp_path, own)
    assert mixed["U"][1, 0] == pytest.approx(alone["U"][1, 0], rel=1e-6)
    pressure = mixed.contact(0).last.field("pressure") if hasattr(mixed.contact(0).last, "field") \
        else mixed.contact(0).last.pressure
    assert np.max(pressure) == pytest.approx(5.0, rel=1e-6)


def test_a_free_plane_part_of_a_ring_scene_is_found(tmp_path):
    text = RIM.format(plate="5, 2., 0.\n6, 3., 0.\n7, 3., 1.\n8, 2., 1.") + (
        "*ELEMENT, TYPE=CPS4, ELSET=SLAB\n2, 5, 6, 7, 8\n*SOLID SECTION, ELSET=SLAB, MATERIAL=M\n3.,\n"
        "*NSET, NSET=FOOT\n1, 2, 5, 6\n*BOUNDARY\nFOOT, 2\n*STEP\n*STATIC\n1., 1.\n*CLOAD\n6, 1, 5.\n"
        "*END STEP\n")
    with pytest.raises(lopin.LopinError) as caught:
        run(tmp_path, text)
    assert caught.value.code == 4


# --- the rest

def test_two_cards_make_one_surface(tmp_path):
    """The second card repeats the first: the same as one card, with a warning."""
    one = run(tmp_path, blocks(steps=HELD + step("HEAD, 3, -2.5", nlgeom="")))
    u = lift(one, -1)
    two = run(tmp_path, blocks(steps=HELD + step("HEAD, 3, -2.5", nlgeom=""),
                               slave="*SURFACE, NAME=DOWN\n2, S1\n*SURFACE, NAME=DOWN\nUP, S1"))
    assert lift(two, -1) == u and codes(tmp_path).count("W0205") == 1


def test_a_tool_in_two_cards_is_refused(executable, tmp_path):
    tool = "*SURFACE, NAME=PLANE, TYPE=CYLINDER\n0., 0., 0., 1., 0., 0.\n0., 1., 0.\nSTART, 1., 0.\nLINE, -1., 0.\n"
    (tmp_path/"job.inp").write_text(blocks(steps=HELD + step("HEAD, 3, -2.5")).replace(
        "*SURFACE, NAME=TOP", 2*tool + "*SURFACE, NAME=TOP"))
    done = subprocess.run([executable, "check", tmp_path/"job.inp"], capture_output=True, text=True)
    assert "error[E0205]" in done.stderr and "defined twice" in done.stderr


def test_a_stress_of_the_start_may_be_of_one_point(tmp_path):
    """Eight lines of eight numbers are one line of seven."""
    text = blocks(steps=step("HEAD, 3, 0.", nlgeom="")).split("*SURFACE, NAME=TOP")[0] \
        + "{}*BOUNDARY\nALL, 1, 3\n*STEP\n*STATIC\n1., 1.\n*EL PRINT, ELSET=LOW\nS\n*END STEP\n"
    values = "-1., -2., -3., 0.5, 0.25, 0.125\n"
    card = "*INITIAL CONDITIONS, TYPE=STRESS\n"
    run(tmp_path, text.format(card + f"1, {values}"))
    whole = (tmp_path/"out"/"job.dat").read_text()
    run(tmp_path, text.format(card + "".join(f"1, {k}, {values}" for k in range(1, 9))))
    assert (tmp_path/"out"/"job.dat").read_text() == whole and "-2.000000E+00" in whole
    run(tmp_path, text.format(card + f"1, 3, {values}"))
    rows = [line.split() for line in (tmp_path/"out"/"job.dat").read_text().splitlines()
            if len(line.split()) == 8]
    assert [row[1] for row in rows if float(row[2]) == -1.0] == ["3"]
    with pytest.raises(lopin.LopinError, match="no point 9"):
        run(tmp_path, text.format(card + f"1, 9, {values}"))


def test_node_print_is_in_the_axes_of_nodes(tmp_path):
    """As Abaqus and CalculiX print: u along the node's own axes, marked L; GLOBAL=YES turns back."""
    turned = "*TRANSFORM, NSET=HEAD, TYPE=R\n0., 1., 0., -1., 0., 0.\n"
    for word, column, end in (("", 1, " L"), (", GLOBAL=YES", 2, "")):
        text = blocks(steps="").split("*SURFACE, NAME=TOP")[0] + turned + (
            "*BOUNDARY\nSEAM, 1, 3\nFOOT, 1, 3\n*STEP\n*STATIC\n1., 1.\n*BOUNDARY\nHEAD, 1, 1, 0.01\n"
            f"*NODE PRINT, NSET=HEAD{word}\nU\n*END STEP\n")
        run(tmp_path, text)
        lines = [line for line in (tmp_path/"out"/"job.dat").read_text().splitlines()
                 if line.split()[:1] == ["13"]]
        assert float(lines[0].split()[column]) == pytest.approx(0.01) and lines[0].endswith(
            end or lines[0][-1])


def test_a_slope_on_nodes_is_by_their_area(tmp_path):
    """Nodes of a surface in the place of its faces: the same depth, whatever the unit of length."""
    nodes = "*SURFACE, NAME=DOWN, TYPE=NODE\nSEAM"
    faces = run(tmp_path, blocks(steps=HELD + step("HEAD, 3, -2.5", nlgeom=""),
                                 pair="TYPE=NODE TO SURFACE"))
    expected = lift(faces, -1)
    result = run(tmp_path, blocks(steps=HELD + step("HEAD, 3, -2.5", nlgeom=""), slave=nodes,
                                  pair="TYPE=NODE TO SURFACE"))
    assert lift(result, -1) == pytest.approx(expected, rel=1e-9)
    assert codes(tmp_path).count("N0318") == 1


def test_nodes_without_faces_are_said_to_press_by_force(tmp_path):
    """Two nodes of a diagonal have no face between them: 1000 [force/length] each, as in Abaqus."""
    result = run(tmp_path, blocks(steps=HELD + step("HEAD, 3, -2.5", nlgeom=""),
                                  slave="*SURFACE, NAME=DOWN, TYPE=NODE\n9, 11".replace(", 11", "\n11"),
                                  pair="TYPE=NODE TO SURFACE"))
    frame = result.at(-1)
    held = np.isin(frame["LABEL"], [9, 11])
    # and 3e-4 by which the two points sink into the lower cube
    assert frame["U"][held, 2] == pytest.approx(-10.0/2/1000.0, rel=1e-1)
    assert codes(tmp_path).count("N0318") == 1
