"""A run in parts that is killed in every phase of a remesh goes on to the same bits."""
import signal
import subprocess
import sys

import pytest

pytest.importorskip("scipy")
try:
    import gmsh  # noqa: F401
except (ImportError, OSError):
    pytest.skip("gmsh is not here", allow_module_level=True)

from test_remeshing import block, run, same

#: Runs the command, and ends itself by SIGKILL in a call of a procedure, by its number.
KILLED = """
import importlib, os, signal, sys

module, name, number = sys.argv[1], sys.argv[2].split("."), int(sys.argv[3])
del sys.argv[1:4]
holder = importlib.import_module(module)
for part in name[:-1]:
    holder = getattr(holder, part)
inner, calls = getattr(holder, name[-1]), []

def dies(*given, **named):
    calls.append(1)
    if len(calls) == number:
        os.kill(os.getpid(), signal.SIGKILL)
    return inner(*given, **named)

setattr(holder, name[-1], dies)
from lopin.__main__ import main
sys.exit(main())
"""
BOTH = [("lopin.remesh.driver", "Snapshot.of", 3),             # running, part 1
        ("lopin.remesh.remake", "cell_fields", 1),             # the remesh begins
        ("lopin.remesh.remake", "transfer", 1),
        ("lopin.remesh.remake", "traction_block", 1),
        ("lopin.remesh.report", "Report.add", 1),              # before the report knows it
        ("pathlib", "Path.replace", 1),                        # its file half way
        ("pathlib", "Path.replace", 2),                        # the next deck half way
        ("lopin.remesh.driver", "worst_corner", 2),            # part 2 written, not begun
        ("lopin.remesh.driver", "Job.advance", 1),             # the increment at rest
        ("lopin.remesh.driver", "Job.advance", 4),             # running, part 2
        ("lopin.remesh.report", "Report.finish", 1)]           # all parts run, not joined
PLANE = [("lopin.remesh.planar", "sizes_of", 1), ("lopin.remesh.planar", "seat_outline", 1),
         ("lopin.remesh.planar", "fill", 1), ("lopin.remesh.planar", "named_nodes", 1)]
SPACE = [("lopin.remesh.spatial", "_sizes", 1), ("lopin.remesh.spatial", "_seat", 1),
         ("lopin.remesh.spatial", "remesh_tetrahedra", 1),
         ("lopin.remesh.spatial", "narrowest_slot", 1)]


def killed_and_resumed(folder, path, module, name, number):
    """The command with --resume, first killed, then left alone."""
    rest = ["run", str(path), "--resume", "-o", str(folder)]
    done = subprocess.run([sys.executable, "-c", KILLED, module, name, str(number), *rest],
                          capture_output=True)
    assert done.returncode == -signal.SIGKILL, (name, done.stderr.decode()[-500:])
    return rest


@pytest.mark.parametrize("word", ["CAX4", "C3D4"])
def test_a_run_killed_in_every_phase_goes_on_to_the_same_bits(word, core, tmp_path):
    """One run, killed once in each phase in turn and resumed by the next."""
    if word == "C3D4":
        pytest.importorskip("mmgpy")
    card = "PERIOD=.45, STRAIN=10., SIZE=.6" if word == "CAX4" else "PERIOD=.45, STRAIN=10."
    scene = block(word, mu=0.2 if word == "CAX4" else 0.0, travel=-2.0, card=card)
    scene.write(tmp_path/"block.inp")
    run(scene, tmp_path/"whole")
    phases = [BOTH[0], BOTH[1], *(PLANE if word == "CAX4" else SPACE), *BOTH[2:]]
    for module, name, number in phases:
        rest = killed_and_resumed(tmp_path/"killed", tmp_path/"block.inp", module, name, number)
    subprocess.run([sys.executable, "-m", "lopin", *rest], check=True, capture_output=True)
    same(tmp_path/"whole", tmp_path/"killed")
