"""lopin info of a folder, lopin plot --terminal, words that a command does not take, loads that are
known and not there."""
import json
import subprocess

from lopin.__main__ import main


def test_a_run_in_a_few_lines(executable, tmp_path, root, capsys):
    subprocess.run([executable, "run", root/"decks"/"hertz_sphere.inp", "-o", tmp_path/"out"],
                   check=True, capture_output=True)
    assert main(["info", str(tmp_path/"out")]) == 0
    said = capsys.readouterr().out
    assert "hertz_sphere: finished" in said and "certificate: PASS" in said
    assert "largest pressure 279" in said and "lopin report" in said


def test_a_plot_of_characters(executable, tmp_path, root, capsys):
    subprocess.run([executable, "run", root/"decks"/"hertz_sphere.inp", "-o", tmp_path/"out"],
                   check=True, capture_output=True)
    assert main(["plot", str(tmp_path/"out"), "--terminal"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert "largest 279" in lines[0] and len(lines) == 19
    columns = [max(line.find("●"), line.find("*")) for line in lines[1:17]]
    seen = [c for c in columns if c > 0]
    assert len(seen) > 6 and max(len(line) for line in lines) < 90


def test_selftest_takes_no_word(executable):
    done = subprocess.run([executable, "selftest", "x"], capture_output=True, text=True)
    assert done.returncode == 2 and "one word too many" in done.stderr


def test_one_schema(executable, tmp_path, root):
    done = subprocess.run([executable, "run", root/"decks"/"bar_gap.inp", "-o", tmp_path/"out",
                           "--json"], capture_output=True, text=True, check=True)
    said, file = json.loads(done.stdout), json.loads((tmp_path/"out"/"bar_gap.json").read_text())
    assert said["schema"] == file["schema"] and said["status"] == file["status"] == "finished"


def test_centrifugal_loads_are_refused_by_name(executable, tmp_path, root):
    text = (root/"decks"/"bar_gap.inp").read_text()
    (tmp_path/"job.inp").write_text(text.replace("*CLOAD", "*DLOAD\nBAR, CENTRIF, 100., 0., 0., 0., 0., 0., 1.\n*CLOAD", 1))
    done = subprocess.run([executable, "check", tmp_path/"job.inp"], capture_output=True, text=True)
    assert done.returncode == 1 and done.stderr.count("error[") == 1 and "E0108" in done.stderr
