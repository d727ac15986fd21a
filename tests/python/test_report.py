"""`lopin report`: one page without network whose numbers are those of the summary."""
import json
import os
import re
import shutil
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path

import matplotlib.image
import numpy as np
import pytest

import lopin
from lopin.report import write_report
from lopin.report.along import along, chains, last_pressed
from lopin.report.curves import chart, ticks
from lopin.report.shape import shapes_of


class Page(HTMLParser):
    """Values by key, text, and what the page loads."""

    def __init__(self, text):
        super().__init__()
        self.values, self.loads, self.open, self.words = {}, [], [], []
        self.banner = {}
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        attrs = dict(attrs)
        if tag == "data" and "data-key" in attrs:
            self.values[attrs["data-key"]] = float(attrs["value"])
        if attrs.get("id") == "status":
            self.banner = attrs
        self.loads += [attrs[k] for k in ("src", "href", "data-src") if k in attrs]
        if tag not in ("meta", "input", "br", "data"):
            self.open.append(tag)

    def handle_endtag(self, tag):
        if tag != "data":
            assert self.open.pop() == tag

    def handle_data(self, data):
        if self.open and self.open[-1] not in ("script", "style"):
            self.words.append(data)


def flat(value, path=""):
    """Numbers of a JSON object by their path."""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from flat(inner, f"{path}.{key}" if path else key)
    elif isinstance(value, list):
        for i, inner in enumerate(value):
            yield from flat(inner, f"{path}.{i}")
    elif isinstance(value, (int, float)) and not isinstance(value, bool):
        yield path, value


@pytest.fixture(scope="module")
def pressed(executable, root, tmp_path_factory):
    """Runs of two decks: one in a plane with a tool, one that fails."""
    place = tmp_path_factory.mktemp("report")
    subprocess.run([executable, "run", root/"decks"/"hot_upsetting.inp", "-o", place/"good"],
                   check=True, capture_output=True)
    shutil.copy(root/"decks"/"bad"/"too_few_increments.inp", place)
    subprocess.run([executable, "run", "too_few_increments.inp", "-o", "bad"], cwd=place,
                   capture_output=True)
    return place


def test_numbers_are_those_of_the_summary(pressed):
    path = write_report(pressed/"good")
    text = path.read_text(encoding="utf-8")
    page = Page(text)
    summary = json.loads((pressed/"good"/"hot_upsetting.json").read_text())
    numbers = dict(flat(summary))
    shown = {key: value for key, value in page.values.items() if key in numbers}
    assert len(shown) > 40 and set(page.values) - set(numbers) <= {"nodes", "elements"}
    assert all(value == numbers[key] for key, value in shown.items())
    assert page.values["nodes"] == summary["model"]["nodes"]
    for part in ("certificate", "energy", "timing"):
        assert {key for key in numbers if key.startswith(part + ".") and numbers[key] != 0.0
                and key != "certificate.increments_warned"} <= set(page.values)
    assert page.banner["data-status"] == "finished"
    assert page.banner["data-verdict"] == summary["certificate"]["verdict"]
    assert not page.open and page.loads == []
    assert not re.search(r"https?://(?!www\.w3\.org)|@import|url\(", text)
    assert len(text) < 3_000_000


def test_the_picture_has_the_part_at_every_time(pressed):
    text = write_report(pressed/"good", pressed/"x.html").read_text(encoding="utf-8")
    data = json.loads(re.search(r'<script type="?\'?application/json\'?"?>(.*?)</script>', text)[1])
    result = lopin.open_result(pressed/"good")
    assert len(data["times"]) == min(60, len(result.times)) and data["dimensions"] == 2
    body = next(part for part in data["parts"] if part["kind"] == "body")
    import base64
    words = np.frombuffer(base64.b64decode(body["places"][-1]), "<u2").reshape(-1, 3)
    places = words/65535*data["size"] + np.array(data["low"])
    mesh = result.to_meshio(-1)
    moved = mesh.points + mesh.point_data["U"]
    corners = np.unique(np.concatenate([cell.ravel() for block in mesh.cells for cell in block.data[:, :4]]))
    assert np.abs(np.sort(places[:, 0]) - np.sort(moved[corners, 0])).max() < data["size"]/30000
    kinds = {part["kind"] for part in data["parts"]}
    assert "body" in kinds


def test_a_run_that_failed_says_why_and_where(pressed):
    text = write_report(pressed/"bad", decks=pressed).read_text(encoding="utf-8")
    page = Page(text)
    words = " ".join(page.words)
    assert page.banner["data-status"] == "not converged" and "E0503" in words
    line = (pressed/"too_few_increments.inp").read_text().splitlines()
    number = next(d["line"] for d in json.loads((pressed/"bad"/"too_few_increments.json").read_text())
                  ["diagnostics"] if d["code"] == "E0503")
    assert f"too_few_increments.inp:{number}" in words and line[number - 1] in words


def test_runs_beside_each_other(pressed):
    path = write_report([pressed/"good", pressed/"bad"], pressed/"both.html")
    page = Page(path.read_text(encoding="utf-8"))
    words = " ".join(page.words)
    assert "The runs beside each other" in words and not page.open
    for folder, name, k in (("good", "hot_upsetting", 0), ("bad", "too_few_increments", 1)):
        summary = json.loads((pressed/folder/f"{name}.json").read_text())
        assert page.values[f"{k}:timing.total"] == summary["timing"]["total"]


def test_the_command_writes_it(pressed, executable):
    environment = os.environ | {"LOPIN_EXECUTABLE": str(executable),
                                "PYTHONPATH": str(Path(lopin.__file__).parent.parent)}
    done = subprocess.run([sys.executable, "-m", "lopin", "report", pressed/"good", "--compare",
                           pressed/"bad", "-o", pressed/"cmd.html"], env=environment,
                          capture_output=True, text=True)
    assert done.returncode == 0 and done.stdout.strip() == str(pressed/"cmd.html")
    done = subprocess.run([sys.executable, "-m", "lopin", "report", pressed/"none"],
                          env=environment, capture_output=True, text=True)
    assert done.returncode == 5 and "no result" in done.stderr and "Traceback" not in done.stderr


def test_what_a_deck_says_is_text_in_the_page(executable, root, tmp_path):
    text = (root/"decks"/"bar_gap.inp").read_text()
    text = re.sub(r"\*HEADING\n[^\n]*", "*HEADING\n<script>alert('x')</script> & co", text, flags=re.I)
    (tmp_path/"job.inp").write_text(text)
    subprocess.run([executable, "run", tmp_path/"job.inp", "-o", tmp_path/"out"], check=True,
                   capture_output=True)
    page = write_report(tmp_path/"out").read_text(encoding="utf-8")
    assert "<script>alert" not in page and "&lt;script&gt;alert" in page


def test_a_solid_shows_its_skin(executable, root, tmp_path):
    """A cube of two by two by two bricks has 24 faces outside and 26 points on them."""
    n = [(x, y, z) for z in range(3) for y in range(3) for x in range(3)]
    deck = "*NODE, NSET=ALL\n" + "".join(f"{i + 1}, {x}., {y}., {z}.\n" for i, (x, y, z) in enumerate(n))
    deck += "*ELEMENT, TYPE=C3D8, ELSET=E\n"
    k = 0
    for z in range(2):
        for y in range(2):
            for x in range(2):
                k += 1
                a = 1 + x + 3*y + 9*z
                deck += f"{k}, {a}, {a + 1}, {a + 4}, {a + 3}, {a + 9}, {a + 10}, {a + 13}, {a + 12}\n"
    deck += ("*MATERIAL, NAME=M\n*ELASTIC\n1000., 0.3\n*SOLID SECTION, ELSET=E, MATERIAL=M\n*NSET, "
             "NSET=B, GENERATE\n1, 9\n*NSET, NSET=T, GENERATE\n19, 27\n*BOUNDARY\nB, 1, 3\n*STEP\n*STATIC\n"
             "*BOUNDARY\nT, 3, 3, 0.1\n*END STEP\n")
    (tmp_path/"cube.inp").write_text(deck)
    subprocess.run([executable, "run", tmp_path/"cube.inp", "-o", tmp_path/"out"], check=True,
                   capture_output=True)
    text = write_report(tmp_path/"out").read_text(encoding="utf-8")
    data = json.loads(re.search(r"application/json'>(.*?)</script>", text)[1])
    assert len(data["parts"][0]["meshes"][0]) == 24
    assert max(max(face) for face in data["parts"][0]["meshes"][0]) == 25


def test_ticks_are_round_and_within():
    assert ticks(0.0, 1.0) == pytest.approx([0.0, 0.2, 0.4, 0.6, 0.8, 1.0])
    assert ticks(-31.0, 97.0) == pytest.approx([-25.0, 0.0, 25.0, 50.0, 75.0])
    assert "nothing to draw" in chart([], "x", "y")
    assert chart([("flat", [0, 1], [2, 2])], "x", "y").count("<polyline") == 1
    assert "nan" not in chart([("gap", [0, 1, 2], [1, float("nan"), 3])], "x", "y")


def test_a_run_without_its_end_shows_what_there_is(pressed, tmp_path):
    """Killed, or going on; with files that are missing, cut off or written by an old Fortran."""
    shutil.copytree(pressed/"good", tmp_path/"cut")
    for name in ("report.html", "drawn.html"):
        (tmp_path/"cut"/name).unlink(missing_ok=True)
    summary, fields = tmp_path/"cut"/"hot_upsetting.json", sorted((tmp_path/"cut").glob("*_00*.vtu"))
    summary.write_text('{"schema": "lopin-result/1", "status": "running", "files": []}')
    text = write_report(tmp_path/"cut").read_text(encoding="utf-8")
    rows = (tmp_path/"cut"/"hot_upsetting.sta").read_text().split("\n")[2:-1]
    assert re.search(r"running, step \d+, increment", text) and "left out" not in text and not Page(text).open
    assert '"dimensions":2' in text and "--resume" in text and len(rows) > 3

    summary.unlink()
    fields[0].write_bytes(fields[0].read_bytes()[:500])
    with (tmp_path/"cut"/"hot_upsetting_history.csv").open("a") as file:
        file.write("1,2,3")
    convergence = tmp_path/"cut"/"hot_upsetting.cvg"
    convergence.write_text(re.sub(r"(?m)^( +\d+ +\S+) +\S+", r"\1   1.2791-111",
                                  convergence.read_text()))
    page = Page(write_report(tmp_path/"cut").read_text(encoding="utf-8"))
    words = " ".join(page.words)
    assert page.banner["data-status"] == "without a summary" and words.count("left out") == 3
    assert "1 outputs of fields" in words and "'size of increments'" not in words
    for path in (tmp_path/"cut").iterdir():
        path.write_bytes(path.read_bytes()[:100])
    page = Page(write_report(tmp_path/"cut", tmp_path/"x.html").read_text(encoding="utf-8"))
    assert page.banner["data-status"] == "without a summary"


def test_pressure_along_the_surface_is_that_of_the_points(pressed):
    result = lopin.open_result(pressed/"good")
    shape = shapes_of(result)
    part = next(p for p in shape.parts if p.kind == "contact")
    frame = last_pressed(shape, part)
    contact = result.contact(part.name).at(list(result.times).index(shape.times[frame]))
    (length, pressure), = along(part, frame, "contact pressure")
    order = np.argsort(contact.place[:, 0])
    assert length == pytest.approx(contact.place[order, 0] - contact.place[order[0], 0], abs=1e-9)
    assert pressure == pytest.approx(contact.pressure[order])
    assert chains([(2, 1), (0, 1), (5, 4)]) == [[0, 1, 2], [4, 5]]


@pytest.mark.skipif(not shutil.which("chromium"), reason="needs a headless browser")
def test_a_browser_draws_it(pressed):
    path = write_report(pressed/"good", pressed/"drawn.html")
    picture = pressed/"drawn.png"
    done = subprocess.run(["chromium", "--headless=new", "--no-sandbox", "--disable-gpu",
                           "--window-size=1000,3000", "--virtual-time-budget=4000", "--dump-dom",
                           f"--screenshot={picture}", path.as_uri()],
                          capture_output=True, text=True, timeout=60)
    assert int(re.search(r'data-drawn="(\d+)"', done.stdout)[1]) > 0
    assert "contact pressure</option>" in done.stdout and "NaN" not in done.stdout
    pixels = matplotlib.image.imread(picture)[:, :, :3]
    top = next(i for i in range(len(pixels)) if np.ptp(pixels[i]) > 0.5)
    assert top < 100 and np.ptp(pixels.reshape(-1, 3), axis=0).min() > 0.8
    assert len(np.unique((pixels.reshape(-1, 3)*255).astype(int)@[65536, 256, 1])) > 200
