"""Increments that fail: cut with the reason, restored to the bit, stopped clearly at the smallest
one."""
import json
import subprocess

import pytest

from test_friction_laws import block

FORCE = 200.0        # along, at the end of the step; friction holds 0.3 times 80 N


def pulled(increment: float, words: str = "", method: str = "DIRECT") -> str:
    """The block pressed by a force and drawn by one that grows beyond what friction holds."""
    text = block("COULOMB", method=method)
    head = text[:text.index("*STEP")].replace("99, 6\n", "99, 6\n99, 1, 2\n")
    return f"""*LOPIN, PATH=FINITE
{head}*STEP
*STATIC, DIRECT
1., 1.
*BOUNDARY
TOP, 1
*CLOAD
TOP, 2, -16.
*NODE FILE
U
*END STEP
*STEP, INC=200
*STATIC{words}
{increment!r}, 1.
*BOUNDARY, OP=NEW
99, 1, 2
99, 6
*CLOAD
TOP, 1, {FORCE/5.0!r}
TOP, 2, -16.
*NODE FILE
U
*CONTACT FILE
CSTR
*END STEP
"""


@pytest.fixture
def run(executable, tmp_path):
    def start(name, text):
        (tmp_path/f"{name}.inp").write_text(text)
        done = subprocess.run([executable, "run", f"{name}.inp", "-o", name], capture_output=True,
                              text=True, timeout=60, cwd=tmp_path)
        folder = tmp_path/name
        rows = (folder/f"{name}_history.csv").read_text().splitlines()
        return done, json.loads((folder/f"{name}.json").read_text()), (folder/f"{name}.cvg").read_text(), rows, folder

    return start


@pytest.mark.parametrize("method", ["DIRECT", "PENALTY", "AUGMENTED LAGRANGE"])
def test_cut_to_the_smallest_and_stopped_with_the_last_good_state(run, method):
    done, job, log, rows, folder = run("slide", pulled(1.0, method=method))
    assert done.returncode == 3 and job["status"] == "not converged", done.stderr
    assert "E05" in done.stderr and ": cut to " in log, log[-2000:]
    assert any(f"because {reason}" in log for reason in ("the tangent is singular",
                                                         "Newton has not", "body"))
    time = float(rows[-1].split(",")[rows[0].split(",").index("time [time]")]) - 1.0
    assert 0.0 <= time*FORCE <= 0.3*80.0*(1.0 + 1e-9)
    assert time*FORCE == pytest.approx(0.3*80.0,
                                       rel=1e-3), "friction holds all but what the smallest increment adds"
    assert (folder/"slide.pvd").read_text().rstrip().endswith("</VTKFile>")
    assert (folder/"slide.frd").read_text().rstrip().endswith("9999")


def test_direct_refuses_to_cut(run):
    done, job, log, rows, _ = run("direct", pulled(0.05, ", DIRECT"))
    assert done.returncode == 3 and ": cut to " not in log
    assert len(rows) == 1 + 1 + 2, "0.05 and 0.10 of the step are held"


def test_an_increment_tried_again_has_the_same_bits(run):
    """A first increment that fails and is cut to half is that half, to the bit, and so is all that
    follows."""
    first = run("first", pulled(0.2))
    second = run("second", pulled(0.1))
    assert "attempt 1: cut to 0.1" in first[2] and "step 2, increment 1, attempt 1: cut" not in second[2]
    drop = [k for k, word in enumerate(first[3][0].split(",")) if "wall" in word
            or "seconds" in word or word == "attempt"]
    def plain(rows):
        return [[v for k, v in enumerate(row.split(",")) if k not in drop] for row in rows]
    assert len(first[3]) > 4 and plain(first[3]) == plain(second[3])


def test_a_body_that_moves_without_force_is_no_trouble(run):
    """All forces are rounding: judged beside what the stiffness makes of the motion, and
    accepted."""
    text = """*NODE
1, 0., 0.
2, 1., 0.
3, 1.3, 1.
4, 0., 1.1
*ELEMENT, TYPE=CPE4, ELSET=E
1, 1, 2, 3, 4
*MATERIAL, NAME=M
*ELASTIC
210000., 0.3
*SOLID SECTION, ELSET=E, MATERIAL=M
1.,
*STEP, NLGEOM
*STATIC
0.1, 1.
*BOUNDARY
4, 1, 1, 33.3
4, 2, 2, -2.
3, 2, 2, -2.
*END STEP
"""
    done, job, _, _, _ = run("moved", text)
    assert done.returncode == 0 and job["status"] == "finished", done.stderr
