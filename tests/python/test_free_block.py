"""A block of metal that nothing but a pusher moves, without friction: it has no momentum."""
import subprocess

import pytest

from flow_scenes import grid

NX, NZ = 8, 4


def pushed(along, across, increments, direct):
    """A block on a plane, pressed by a dead load; a wall to its left moves by the amplitudes.

    The wall ends where it ends: extended by a tenth of a facet it would push for 0.01 more, in any
    number of increments that see it."""
    nodes, elements, label = grid(NX, NZ, 10.0, 5.0)
    lines = ["*NODE", *(f"{k}, {x!r}, {y!r}" for k, (x, y) in nodes.items()),
             "*ELEMENT, TYPE=CPE4, ELSET=ALL"]
    lines += [f"{k + 1}, " + ", ".join(map(str, e)) for k, e in enumerate(elements)]
    lines += ["*NSET, NSET=BASE", *(f"{label[i, 0]}," for i in range(NX + 1)),
              "*NSET, NSET=FAR", f"{label[NX, 0]},",
              "*SURFACE, NAME=SIDE", *(f"{j*NX + 1}, S4" for j in range(NZ)),
              "*NODE, NSET=WALL_REF", "9001, -1., 2.",
              "*SURFACE, NAME=WALL, TYPE=SEGMENTS", "START, 0., 12.", "LINE, 0., -7.",
              "*RIGID BODY, ANALYTICAL SURFACE=WALL, REF NODE=WALL_REF",
              "*SURFACE INTERACTION, NAME=DRY", "*SURFACE BEHAVIOR, DIRECT",
              "*CONTACT PAIR, INTERACTION=DRY, TYPE=NODE TO SURFACE, EXTENSION ZONE=0.001",
              "SIDE, WALL",
              "*MATERIAL, NAME=METAL", "*ELASTIC", "200000., 0.3", "*PLASTIC", "300., 0.",
              "500., 1.", "*SOLID SECTION, ELSET=ALL, MATERIAL=METAL",
              "*AMPLITUDE, NAME=ALONG", *(f"{t!r}, {x!r}" for t, x in along),
              "*AMPLITUDE, NAME=ACROSS", *(f"{t!r}, {x!r}" for t, x in across),
              "*AMPLITUDE, NAME=STEADY", "0., 1., 10., 1.",
              "*BOUNDARY", "BASE, 2", "WALL_REF, 6",
              "*STEP, INC=1000, NLGEOM", "*STATIC" + (", DIRECT" if direct else ""),
              f"{1/increments!r}, 1.",
              "*BOUNDARY, AMPLITUDE=ALONG", "WALL_REF, 1, 1, 1.",
              "*BOUNDARY, AMPLITUDE=ACROSS", "WALL_REF, 2, 2, 1.",
              "*DLOAD, AMPLITUDE=STEADY", *(f"{(NZ - 1)*NX + i + 1}, P3, 50." for i in range(NX)),
              "*NODE PRINT, NSET=FAR", "U", "*END STEP"]
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize("direct", [True, False])
@pytest.mark.parametrize("along, across, end", [
    ([(0.0, 0.0), (0.5, 1.0), (1.0, 1.8)], [(0.0, 0.0), (1.0, 0.0)], 1.8),
    ([(0.0, 0.0), (0.6, 1.2), (1.0, 2.0)], [(0.0, 0.0), (0.6, 12.0), (1.0, 20.0)], 1.2)],
    ids=["the wall slows down", "the wall goes clear of the block"])
def test_a_block_goes_no_farther_than_it_is_pushed(executable, tmp_path, along, across, end, direct):
    (tmp_path/"block.inp").write_text(pushed(along, across, 20, direct))
    done = subprocess.run([executable, "run", "block.inp", "-o", "out"], capture_output=True,
                          text=True, timeout=60, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    rows = [line.split() for line in (tmp_path/"out"/"block.dat").read_text().splitlines()]
    last = [float(row[1]) for row in rows if len(row) == 4 and row[0].isdigit()][-1]
    # The dead load spreads the block by 1e-3 of its own.
    assert last == pytest.approx(end, abs=2e-3)
