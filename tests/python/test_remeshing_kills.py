"""A run in parts that is killed in every phase of a remesh goes on to the same bits."""
import json
import subprocess
import sys

import pytest

pytest.importorskip("scipy")
try:
    import gmsh  # noqa: F401
except (ImportError, OSError):
    pytest.skip("gmsh is not here", allow_module_level=True)

from test_remeshing import block, run, same

#: Runs the command once for each phase, in a copy of a process that has loaded all there is to
#: load, which ends itself by SIGKILL in a call of a procedure, by its number.
KILLED = """
import importlib, json, os, signal, sys
import gmsh, scipy.sparse, scipy.spatial
from lopin.__main__ import main

def end_in(module, path, number):
    *outer, name = path.split(".")
    holder = importlib.import_module(module)
    for part in outer:
        holder = getattr(holder, part)
    inner, calls = getattr(holder, name), []

    def dies(*given, **named):
        calls.append(1)
        if len(calls) == number:
            os.kill(os.getpid(), signal.SIGKILL)
        return inner(*given, **named)

    setattr(holder, name, dies)

phases = json.loads(sys.argv[1])
del sys.argv[1]
for phase in phases:
    importlib.import_module(phase[0])
for phase in phases:
    child = os.fork()
    if child == 0:
        end_in(*phase)
        os._exit(main())
    status = os.waitpid(child, 0)[1]
    if os.waitstatus_to_exitcode(status) != -signal.SIGKILL:
        sys.exit(f"{phase} has not been reached: status {status}")
"""
BOTH = [("lopin.remesh.driver", "Snapshot.of", 3),             # running, part 1
        ("lopin.remesh.remake", "transfer", 1),                # a mesh is made, nothing written
        ("lopin.remesh.report", "Report.add", 1),              # before the report knows it
        ("pathlib", "Path.replace", 1),                        # its file half way
        ("pathlib", "Path.replace", 2),                        # the next deck half way
        ("lopin.remesh.driver", "worst_corner", 2),            # part 2 written, not begun
        ("lopin.remesh.driver", "Job.advance", 3),             # running, part 2
        ("lopin.remesh.report", "Report.finish", 1)]           # all parts run, not joined
# In the mesher: nothing is written on its way.
PLANE = [("lopin.remesh.planar", "fill", 1)]
SPACE = [("lopin.remesh.spatial", "remesh_tetrahedra", 1)]


@pytest.mark.parametrize("word", ["CAX4", "C3D4"])
def test_a_run_killed_in_every_phase_goes_on_to_the_same_bits(word, core, tmp_path):
    """One run, killed once in each phase in turn and resumed by the next."""
    if word == "C3D4":
        pytest.importorskip("mmgpy")
    card = "PERIOD=.5, STRAIN=10., SIZE=.8" if word == "CAX4" else "PERIOD=.5, STRAIN=10."
    scene = block(word, mu=0.2 if word == "CAX4" else 0.0, travel=-1.6, card=card, increments=8)
    scene.write(tmp_path/"block.inp")
    run(scene, tmp_path/"whole")
    # What does not depend on the space is killed in the plane.
    phases = [BOTH[0], *PLANE, *BOTH[1:]] if word == "CAX4" else [BOTH[0], *SPACE, BOTH[-2]]
    rest = ["run", str(tmp_path/"block.inp"), "--resume", "-o", str(tmp_path/"killed")]
    done = subprocess.run([sys.executable, "-c", KILLED, json.dumps(phases), *rest],
                          capture_output=True)
    assert done.returncode == 0, done.stderr.decode()[-500:]
    subprocess.run([sys.executable, "-m", "lopin", *rest], check=True, capture_output=True)
    same(tmp_path/"whole", tmp_path/"killed")
