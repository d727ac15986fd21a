"""Nothing that grows with the mesh lives on the stack; a full one is told."""
import json
import os
import resource
import subprocess

import pytest

from lopin import mesh_make
from lopin.model import Model
from lopin.model_deck import mesh_deck

#: Bytes of the stack; what a mesh of the tests has in each of its points alone takes more.
SMALL = 512*1024
#: Element word and cells along each edge of a block.
BLOCKS = [("C3D8", 12), ("C3D8I", 9), ("CPE4", 50), ("CAX4I", 50), ("CPE8", 40), ("CAX8R", 50)]


def block(word, cells, law, step):
    """A block of 10 mm, pressed by a plane on its top."""
    space = word.startswith("C3D")
    d = 3 if space else 2
    mesh = mesh_make.block((10.0,)*d, (cells,)*d, quadratic=not space and "8" in word)
    kind = "3d" if space else "axisymmetric" if word.startswith("CAX") else "plane strain"
    text = mesh_deck(Model("block", mesh, kind=kind)).text()
    text = text.replace(text[text.index("TYPE="):].split(",")[0].split()[0], f"TYPE={word}")
    tool = "*SURFACE, NAME=DIE, TYPE=" + (
        "CYLINDER\n0., 0., 0., 1., 0., 0.\n0., -1., 0.\n" if space else "SEGMENTS\n")
    return text + (
        f"{tool}START, 99., 10.\nLINE, -99., 10.\n*NODE, NSET=R\n900000, {'0., ' if space else ''}0., 20.\n"
        f"*RIGID BODY, ANALYTICAL SURFACE=DIE, REF NODE=900000\n*MATERIAL, NAME=M\n{law}"
        "*SOLID SECTION, ELSET=ALL, MATERIAL=M\n*SURFACE INTERACTION, NAME=I\n*FRICTION\n.1,\n"
        f"*CONTACT PAIR, INTERACTION=I\nTOP, DIE\n*BOUNDARY\nLEFT, 1\nBOTTOM, {d}\nR, 1\nR, 6\n"
        + "FRONT, 2\nR, 2\nR, 4, 5\n"*space + f"*STEP{step}\n*STATIC\n1., 1.\n*BOUNDARY\nR, {d}, {d}, -.01\n"
        "*NODE FILE\nU\n*EL FILE\nS, PEEQ\n*CONTACT FILE\nCSTRESS\n*END STEP\n")


def run(executable, path, stack):
    """The executable with a stack of so many bytes."""
    return subprocess.run(
        [str(executable), "run", str(path), "--overwrite", "--quiet", "-o", str(path.with_suffix(""))],
        capture_output=True, text=True, timeout=60, env=os.environ | {"OPENBLAS_NUM_THREADS": "1"},
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_STACK, (stack, stack)))


LINEAR = ("*ELASTIC\n200000., .3\n", "")
METAL = ("*ELASTIC\n200000., .3\n*PLASTIC\n300., 0.\n900., 1.\n", ", NLGEOM")


# What is linear needs less: one word of the plane and one of space.
@pytest.mark.parametrize("word, cells, law, step", [
    *((*block, *METAL) for block in BLOCKS),
    *((*block, *LINEAR) for block in (BLOCKS[0], BLOCKS[-1]))])
def test_a_mesh_does_not_live_on_the_stack(executable, tmp_path, word, cells, law, step):
    path = tmp_path/"block.inp"
    path.write_text(block(word, cells, law, step))
    done = run(executable, path, SMALL)
    assert done.returncode == 0, done.stderr[-400:]
    assert json.loads((tmp_path/"block"/"block.json").read_text())["steps"][0]["increments"]


def test_a_full_stack_is_told(executable, tmp_path):
    """An end by the system, 139, said nothing before."""
    path = tmp_path/"block.inp"
    path.write_text(block("C3D8I", 2, "*ELASTIC\n200000., .3\n", ", NLGEOM"))
    for kilobytes in (64, 80, 96, 128, 176):
        done = run(executable, path, 1024*kilobytes)
        if done.returncode == 0:
            break
        assert done.returncode == 70 and "E0900" in done.stderr and "ulimit -s" in done.stderr
        found = json.loads((tmp_path/"block"/"block.json").read_text()) \
            if (tmp_path/"block"/"block.json").exists() else {"exit_code": 70}
        assert found["exit_code"] == 70
    assert kilobytes > 64
