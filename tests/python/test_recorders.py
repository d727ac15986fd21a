"""What the recorders write, read back by the programs that users have."""
import json
import os
import signal
import subprocess
import time
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest

WORDS = ["CPE3", "CPE4", "CPE6", "CPE8", "CPS4", "CAX4", "CAX8",
         "C3D4", "C3D6", "C3D8", "C3D10", "C3D15", "C3D20"]
FRD_CODES = {"CPE3": 7, "CPE6": 8, "CPE4": 9, "CPS4": 9, "CAX4": 9, "CPE8": 10, "CAX8": 10,
             "C3D4": 3, "C3D10": 6, "C3D6": 2, "C3D15": 5, "C3D8": 1, "C3D20": 4}


@pytest.fixture(scope="session")
def writer(root):
    """The Fortran test program, which writes a job of any element word."""
    executable = Path(os.environ.get("LOPIN_EXECUTABLE", root / "build" / "lopin"))
    path = executable.parent / "tests" / "test_recorders"
    if not path.is_file():
        pytest.skip(f"no program at {path}")
    return path


@pytest.fixture(scope="session")
def jobs(writer, tmp_path_factory):
    """Folder of the job of each element word."""
    top = tmp_path_factory.mktemp("jobs")
    for word in WORDS:
        subprocess.run([writer, "write", top / word, word], check=True)
    return {word: top / word for word in WORDS}


@pytest.mark.parametrize("word",
                         [w for w in WORDS if w != "C3D15"])  # meshio 5.3 has no 15-node wedge
def test_meshio_reads_the_solid(jobs, word):
    meshio = pytest.importorskip("meshio")
    mesh = meshio.read(jobs[word] / "job_0002.vtu")
    dim = 3 if word.startswith("C3D") else 2
    n = int("".join(c for c in word[3:] if c.isdigit()))
    assert [len(block.data) for block in mesh.cells] == [2] and mesh.cells[0].data.shape == (2, n)
    assert np.array_equal(mesh.cells[0].data[1], mesh.cells[0].data[0] + n)
    u = mesh.point_data["U"]
    assert u.shape == (2 * n + 1, 3)
    assert np.allclose(u[:-1, :dim], 2e-3 * mesh.points[:-1, :dim], atol=1e-6)
    # nodal stress of node k is k*(1 2 3 4 5 6) in xx yy zz xy xz yz; VTK's order is xx yy zz xy yz
    # xz
    assert np.allclose(mesh.point_data["S"][2], [3, 6, 9, 12, 18, 15])
    s = mesh.point_data["S"][2]
    mises = np.sqrt(0.5 * ((s[0] - s[1])**2 + (s[1] - s[2])**2 + (s[2] - s[0])**2)
                    + 3 * (s[3:]**2).sum())
    assert mesh.point_data["Mises"].ravel()[2] == pytest.approx(mises, rel=1e-6)
    assert list(mesh.point_data["LABEL"].ravel()[:2]) == [10, 20]


@pytest.mark.parametrize("word", ["CAX8", "CPE3", "C3D8", "C3D20", "C3D10", "C3D15"])
def test_pyvista_reads_times_and_parts(jobs, word):
    pyvista = pytest.importorskip("pyvista")
    reader = pyvista.PVDReader(str(jobs[word] / "job.pvd"))
    assert reader.time_values == [0.5, 1.0]
    reader.set_active_time_value(1.0)
    parts = reader.read()
    assert len(parts) == 4
    solid, faces, dots, tool = parts
    assert solid.field_data["TimeValue"][0] == 1.0
    sizes = solid.compute_cell_sizes()
    key = "Volume" if word.startswith("C3D") else "Area"
    assert np.all(sizes[key] > 0)
    assert faces.n_cells == 2 and set(faces.cell_data.keys()) == set()
    for name in ("CPRESS", "COPEN", "CSTATUS", "R_n", "u_n", "u_t", "NORMAL", "XI", "WEIGHT", "U"):
        assert name in faces.point_data and name in dots.point_data
    assert list(dots["CPRESS"]) == [10, 20, 0]
    assert np.isnan(dots["COPEN"][2]) and dots["CSTATUS"][2] == -1
    assert dots["NORMAL"].shape == (3, 3) and dots["u_t"].shape == (3, 3)
    # the ball of radius 2 about (0, 5) has moved by -0.25 with its reference node
    d = 2 if word.startswith("C3D") else 1
    centre = np.zeros(3)
    centre[d] = 4.75
    assert np.allclose(np.linalg.norm(tool.points - centre, axis=1), 2.0, atol=1e-12)


def blocks(path):
    """Titles and rows of a .dat file."""
    found = []
    for line in path.read_text().splitlines():
        if not line.strip():
            continue
        if any(c.isalpha() and c != "E" for c in line):
            found.append((line, []))
        else:
            found[-1][1].append(line)
    return found


def test_dat_has_the_layout_of_calculix(jobs):
    text = (jobs["C3D8"] / "job.dat").read_text()
    start = ("\n displacements (vx,vy,vz) for set SOME and time  0.5000000E+00\n\n"
             "        10  2.000000E-03 -1.000000E-03 -1.000000E-03\n"
             "        20  4.000000E-03 -1.000000E-03 -1.000000E-03\n")
    assert text.startswith(start)
    assert ("\n total force (fx,fy,fz) for set LOW and time  0.1000000E+01\n\n"
            "        0.000000E+00  0.000000E+00  3.600000E+01\n") in text
    assert ("\n stresses (elem, integ.pnt.,sxx,syy,szz,sxy,sxz,syz) for set BOTH and time  0.5000000E+00\n\n"
            "         3   1  9.010000E+02") in text
    # the printed shears are those of the strain tensor
    assert ("         3   1  1.000000E-03  2.000000E-03  3.000000E-03"
            "  2.000000E-03  3.000000E-03  4.000000E-03\n") in text
    assert "\n volume (element, volume) for set BOTH and time  0.5000000E+00\n\n         3  8.000000E+00\n" in text
    assert "\n total volume for set BOTH and time  0.5000000E+00\n\n        1.600000E+01\n" in text
    assert ("\n relative contact displacement (slave node,normal,tang1,tang2) for all contact elements "
            "and time 0.5000000E+00\n\n        90 -1.000000E-02  5.000000E-01  0.000000E+00\n") in text
    assert "\n total number of contact elements for time  0.5000000E+00\n\n                4\n" in text
    assert ("\n\n statistics for slave set TOP, master set DIE and time  0.5000000E+00\n\n"
            "   total surface force (fx,fy,fz) and moment about the origin (mx,my,mz)\n\n") in text


def test_the_axisymmetric_volume_is_the_full_circumference(jobs):
    rows = dict(blocks(jobs["CAX4"] / "job.dat"))
    volume = next(rows[title] for title in rows if title.startswith(" total volume"))
    # a square of side 2 centred at r = 3, twice: Pappus
    assert float(volume[0]) == pytest.approx(2 * 2 * np.pi * 3 * 4, rel=1e-6)


@pytest.mark.parametrize("word", WORDS)
def test_energy_is_half_stress_times_strain(jobs, word):
    rows = dict(blocks(jobs[word] / "job.dat"))
    total = next(rows[t] for t in rows if t.startswith(" total internal energy"))
    assert float(total[0]) > 0


@pytest.mark.parametrize("word", WORDS)
def test_frd_is_well_formed(jobs, word):
    lines = (jobs[word] / "job.frd").read_text().splitlines()
    n = int("".join(c for c in word[3:] if c.isdigit()))
    first = next(i for i, line in enumerate(lines) if line.startswith("    2C"))
    assert int(lines[first][6:36]) == 2 * n
    for line in lines[first + 1:first + 1 + 2 * n]:
        assert line.startswith(" -1") and len(line) == 13 + 36
    elements = next(i for i, line in enumerate(lines) if line.startswith("    3C"))
    assert lines[elements + 1] == f" -1         7{FRD_CODES[word]:5d}    0    1"
    per_line = -(-n // 10)
    nodes = [int(line[3 + 10 * k:13 + 10 * k])
             for line in lines[elements + 2:elements + 2 + per_line]
             for k in range((len(line) - 3) // 10)]
    order = list(range(1, n + 1))
    if word == "C3D20":
        order = order[:12] + order[16:20] + order[12:16]
    if word == "C3D15":
        order = order[:9] + order[12:15] + order[9:12]
    assert nodes == [10 * k for k in order]
    names = [line[5:13].strip() for line in lines if line.startswith(" -4")]
    assert names == ["DISP", "STRESS", "TOSTRAIN", "FORC", "CONTACT"] * 2
    heads = [line for line in lines if line.startswith("  100CL")]
    assert float(heads[0][12:24]) == 0.5 and int(heads[0][24:36]) == 2 * n
    assert lines[-1] == " 9999"
    stress = next(i for i, line in enumerate(lines) if line.startswith(" -4  STRESS"))
    third = lines[stress + 9]
    assert [float(third[13 + 12 * k:25 + 12 * k]) for k in range(6)] == [3, 6, 9, 12, 18, 15]


def test_sta_history_and_json(jobs):
    folder = jobs["CAX4"]
    sta = (folder / "job.sta").read_text().splitlines()
    assert sta[0] == "SUMMARY OF JOB INFORMATION"
    assert sta[1].startswith("  STEP      INC     ATT  ITRS     TOT TIME     STEP TIME      INC TIME")
    assert sta[2].startswith("     1          1     1     3  0.500000E+00  0.500000E+00  0.500000E+00")
    assert sta[2].split()[-2:] == ["2", "1"]
    header, *rows = (folder / "job_history.csv").read_text().splitlines()
    names = header.split(",")
    assert "BALL.u2 [length]" in names and "TOP-DIE.max_pressure [stress]" in names
    table = np.array([[float(v) for v in row.split(",")] for row in rows])
    assert table.shape == (2, len(names))
    assert table[1, names.index("BALL.u2 [length]")] == -0.25
    assert table[1, names.index("DOTS-SKIN OF/BALL.force2 [force]")] == 60.0
    result = json.loads((folder / "job.json").read_text(), parse_constant=pytest.fail)
    assert result["peak_memory_mib"] is None
    assert result["schema"] == "lopin-result/1" and result["status"] == "finished"
    assert result["forces"] == "full circumference"
    assert result["heading"] == 'Two elements, "quoted" \\ slashed'
    assert result["contact"][1]["max_pressure"] == 20.0 and result["contact"][1]["area"] == 4.0
    assert result["certificate"]["verdict"] == "PASS" and result["timing"]["total"] == 0.5
    said = result["diagnostics"][0]
    assert (said["code"], said["severity"], said["file"], said["line"], said["column"]) == \
        ("W0311", "warning", "deck.inp", 12, 3)
    assert {"job.pvd", "job.dat", "job.frd", "job.sta", "job.json"} <= set(result["files"])


def test_a_killed_run_leaves_whole_files(writer, tmp_path):
    run = subprocess.Popen([writer, "loop", tmp_path])
    deadline = time.monotonic() + 20
    while not (tmp_path / "job_0040.vtu").exists() and time.monotonic() < deadline:
        time.sleep(0.002)
    run.send_signal(signal.SIGKILL)
    run.wait()
    listed = [d.get("file") for d in ET.parse(tmp_path / "job.pvd").iter("DataSet")]
    assert len(listed) >= 39 * 4
    for path in sorted(tmp_path.glob("*.vtu")):
        assert path.read_bytes().endswith(b"</VTKFile>\n"), path.name
    assert all((tmp_path / name).exists() for name in listed)
    for name in ("job.dat", "job.frd", "job.sta", "job_history.csv"):
        assert (tmp_path / name).read_bytes().endswith(b"\n"), name
    assert json.loads((tmp_path / "job.json").read_text())["status"] == "running"
