"""What a new mesh has inside tools is pressed out over a time; a part that finds no rest is let go
of what it leaves out of balance over increments."""
import numpy as np
import pytest
from test_remeshing import block, run

import lopin
from lopin.errors import NotConvergedError
from lopin.remesh import driver

METHODS = ("DIRECT", "PENALTY", "PERTURBED LAGRANGE", "AUGMENTED LAGRANGE")
INSIDE = 0.02   #: how far the top of the square is inside the tool [length]


def square(method: str, seating: float) -> lopin.Deck:
    """A square whose top is inside a tool that stands still, from the time .1 on."""
    return lopin.Deck.parse(f"""*NODE
1, 0., 0.
2, 1., 0.
3, 1., {1.0 + INSIDE}
4, 0., {1.0 + INSIDE}
9, 0., 1.
*ELEMENT, TYPE=CPE4, ELSET=B
1, 1, 2, 3, 4
*MATERIAL, NAME=M
*ELASTIC
1000., 0.3
*VISCOPLASTIC, LAW=NORTON-HOFF
10., .2
*SOLID SECTION, ELSET=B, MATERIAL=M
*SURFACE, NAME=TOP
1, S3
*SURFACE, NAME=T, TYPE=SEGMENTS
START, 2., 1.
LINE, -1., 1.
*RIGID BODY, ANALYTICAL SURFACE=T, REF NODE=9
*SURFACE INTERACTION, NAME=I
*SURFACE BEHAVIOR, {method}
*CONTACT PAIR, INTERACTION=I, TYPE=NODE TO SURFACE
TOP, T
*BOUNDARY
1, 1, 2
2, 2
9, 1, 2
9, 6
*START, STEP=1, TIME=0.1, REST=1e-8, INCREMENT=0.05, SEATING={seating}
*STEP, NLGEOM
*STATIC
0.05, 1., 1e-6, .05
*END STEP
""", name="square")


@pytest.mark.parametrize("method", METHODS)
def test_what_is_inside_a_tool_is_pressed_out_evenly(method, core):
    """Nothing at rest, half of it after half of the time, all of it from then on."""
    with lopin.open(square(method, 0.4)) as job:
        moved = [frame["U"][2, 1] for frame in job]
        force, time = (job.result.history[name] for name in ("T.rf2", "time"))
    moved = dict(zip(np.round(time, 3).tolist(), moved))
    slack = 2e-6 if method == "DIRECT" else 2e-4   # a millionth of a facet off the tool at rest
    assert moved[0.1] == pytest.approx(0.0, abs=1e-12) and force[0] == 0.0
    assert moved[0.3] == pytest.approx(-0.5*INSIDE, abs=slack)
    assert moved[0.5] == pytest.approx(-INSIDE, abs=slack)
    assert moved[1.0] == pytest.approx(-INSIDE, abs=slack)
    assert np.abs(force).max() < 13.0


def test_without_a_time_it_is_pressed_out_at_rest(core):
    """The metal has no time to flow then: the force is twice as large."""
    result = lopin.run(square("DIRECT", 0.0))
    assert np.abs(result.history["T.rf2"]).max() == pytest.approx(22.2, rel=0.01)


def test_a_part_that_finds_no_rest_settles_over_increments(core, tmp_path, monkeypatch):
    """Its deck is written anew, once; who resumes finds that one."""
    advance, tried = driver.Job.advance, []

    def stuck(job):
        start = job.deck["START"].parameters if "START" in job.deck else {}
        if job.deck.name.endswith("p002") and "RELEASE" not in start:
            tried.append(job.deck.name)
            raise NotConvergedError("no rest", id="E0510")
        return advance(job)

    monkeypatch.setattr(driver.Job, "advance", stuck)
    report = run(block("CPE4", mu=0.2, travel=-1.0), tmp_path)
    assert len(tried) == 1 and len(report.parts) == len(set(report.parts)) == 5
    deck = next(tmp_path.rglob("*.p002.inp")).read_text()
    assert "RELEASE=" in deck and "SEATING=" in deck
    assert "RELEASE=" not in next(tmp_path.rglob("*.p003.inp")).read_text()
