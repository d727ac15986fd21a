"""What a user sees while a run goes on and at its end: on a terminal, in a log, in a program."""
import json
import os
import re
import subprocess

import pytest

pty = pytest.importorskip("pty")
fcntl = pytest.importorskip("fcntl")
termios = pytest.importorskip("termios")
struct = pytest.importorskip("struct")

CLEAR = "\r\x1b[K"


def on_terminal(command, columns=100, term="xterm", until=None):
    """Exit code and output of a command on a terminal; Ctrl-C once `until` is seen."""
    pid, terminal = pty.fork()
    if pid == 0:
        os.environ["TERM"] = term
        os.execv(command[0], [str(word) for word in command])
    fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
    out = b""
    while True:
        try:
            part = os.read(terminal, 4096)
        except OSError:                        # the other end is closed
            break
        if not part:
            break
        out += part
        if until and until in out:
            os.write(terminal, b"\x03")
            until = None
    code = os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])
    os.close(terminal)
    return code, out.decode().replace("\r\n", "\n")


def in_a_pipe(executable, *words):
    return subprocess.run([executable, *words], capture_output=True, text=True, check=False)


def many_increments(root, place):
    """A deck of 250 increments: under way for a second, however fast or busy the machine."""
    text = (root/"decks"/"beam_over_corner.inp").read_text()
    assert "0.05, 1., 1.E-5, 0.05" in text
    deck = place/"beam_over_corner.inp"
    deck.write_text(text.replace("0.05, 1., 1.E-5, 0.05", "0.004, 1., 1.E-5, 0.004")
                    .replace("INC=200", "INC=1000"))
    return deck


def test_a_terminal_has_one_line_that_is_rewritten(executable, root, tmp_path):
    deck = many_increments(root, tmp_path)
    code, out = on_terminal([str(executable), "run", deck, "-o", tmp_path])
    assert code == 0
    lines = [text for text in out.split(CLEAR) if text.startswith("step ")]
    assert len(lines) >= 2
    assert all(re.match(r"step \d/\d \[[#.]{20}\] +\d+%, (\d+:\d\d left, )?increment \d+ ", line)
               for line in lines)
    assert all("\n" not in line and len(line) < 100 for line in lines)
    assert "contact" in lines[-1]
    assert any("iteration" in line for line in lines)
    # The line has gone when the end is told.
    assert " [##" not in out.rsplit(CLEAR, 1)[-1]


def test_a_narrow_terminal_and_one_that_cannot_go_back(executable, root, tmp_path):
    deck = root/"decks"/"hot_upsetting.inp"
    code, out = on_terminal([str(executable), deck, "-o", tmp_path], columns=40)
    lines = [text for text in out.split(CLEAR) if text.startswith("step ")]
    assert code == 0 and lines and max(map(len, lines)) < 40
    code, out = on_terminal([str(executable), deck, "-o", tmp_path], term="dumb")
    assert code == 0 and "\x1b" not in out and "step 1/" not in out


def test_the_end_says_what_came_of_it(executable, root, tmp_path):
    done = in_a_pipe(executable, "run", root/"decks"/"bar_gap.inp", "-o", tmp_path)
    lines = done.stdout.splitlines()
    assert done.returncode == 0 and lines[0].startswith("path condensed, ")
    summary = json.loads((tmp_path/"bar_gap.json").read_text())
    assert lines[-5] == f"certificate: {summary['certificate']['verdict']}"
    cost = re.fullmatch(r"(\d+\.\d) s, (\d+) MiB; (\d+) increments, (\d+) iterations?", lines[-4])
    assert float(cost[1]) == pytest.approx(summary["timing"]["total"], abs=0.1)
    assert int(cost[2]) == pytest.approx(summary["peak_memory_mib"], abs=0.6)
    assert int(cost[3]) == sum(step["increments"] for step in summary["steps"])
    assert int(cost[4]) == sum(step["iterations"] for step in summary["steps"])
    assert lines[-3:] == [f"results in {tmp_path}/", f"to see them: lopin report {tmp_path} "
                          f"(Python package), paraview {tmp_path}/bar_gap.pvd", "Job finished"]
    assert done.stderr == ""                   # too short for a line of a log


def test_warnings_are_counted_by_kind(executable, root, tmp_path):
    done = in_a_pipe(executable, "run", root/"decks"/"bar_gap.inp", "-o", tmp_path/"none")
    assert "(lopin explain CODE)" not in done.stdout
    done = in_a_pipe(executable, "run", root/"decks"/"patch_test.inp", "-o", tmp_path)
    said = re.search(r"(\d+) warnings? \(lopin explain CODE\): (.*)", done.stdout)
    codes = [item["code"] for item in
             json.loads((tmp_path/"patch_test.json").read_text())["diagnostics"]
             if item["severity"] == "warning"]
    assert codes and int(said[1]) == len(codes)
    kinds = [f"{code} ({codes.count(code)})" if codes.count(code) > 1 else code
             for code in dict.fromkeys(codes)]
    assert said[2] == ", ".join(kinds)


def test_programs_get_an_object_a_line(executable, root, tmp_path):
    done = in_a_pipe(executable, "run", root/"decks"/"hot_upsetting.inp", "-o", tmp_path,
                     "--progress", "json")
    news = [json.loads(line) for line in done.stdout.splitlines()]
    assert news[0]["event"] == "plan" and news[-1] == {"event": "end", "status": "ok",
                                                       "exit_code": 0}
    increments = [item for item in news if item["event"] == "increment"]
    rows = (tmp_path/"hot_upsetting.sta").read_text().splitlines()[2:]
    assert len(increments) == len(rows)
    for item, row in zip(increments, rows):
        step, number, attempt, iterations, total, *_, closed, _ = row.split()
        assert [item["step"], item["increment"], item["attempt"], item["iterations"],
                item["closed"]] == [int(n) for n in (step, number, attempt, iterations, closed)]
        assert item["total_time"] == pytest.approx(float(total), rel=1e-6)
    assert increments[-1]["done"] == 1 and increments[-1]["left"] == 0
    assert {item["verdict"] for item in increments} <= {"PASS", "WARN"}


def test_a_log_gets_plain_lines_and_quiet_nothing(executable, root, tmp_path):
    deck = root/"decks"/"hot_upsetting.inp"
    done = in_a_pipe(executable, "run", deck, "-o", tmp_path, "--progress", "plain")
    lines = done.stderr.splitlines()
    rows = (tmp_path/"hot_upsetting.sta").read_text().splitlines()[2:]
    assert len(lines) == len(rows) and "\x1b" not in done.stderr
    assert all(re.match(r"0:\d\d  step \d/\d, +\d+%, ", line) for line in lines)
    done = in_a_pipe(executable, "run", deck, "-o", tmp_path, "--quiet")
    assert done.stdout == "" and done.stderr == "" and done.returncode == 0


def test_ctrl_c_is_answered_and_the_run_goes_on(executable, root, tmp_path):
    deck = many_increments(root, tmp_path)
    code, out = on_terminal([str(executable), "run", deck, "-o", tmp_path], until=b"iteration")
    assert code == 130 and "error[E0605]" in out and "--resume" in out
    assert re.search(r"results up to step 1, increment \d+ in ", out)
    done = in_a_pipe(executable, "run", deck, "-o", tmp_path, "--resume")
    assert done.returncode == 0 and "Job finished" in done.stdout


@pytest.mark.parametrize("word, answer", [
    ("rnu", "did you mean run?"), ("chek", "did you mean check?"), ("reprot", "did you mean report?"),
    ("exlpain", "did you mean explain?"), ("foo", "there is no deck of that name")])
def test_a_command_that_is_misspelt(executable, tmp_path, word, answer):
    done = subprocess.run([executable, word, "x.inp"], capture_output=True, text=True, cwd=tmp_path)
    assert done.returncode == 2 and answer in done.stderr and word in done.stderr
    assert done.stderr.count("error[") == 1


def test_nobody_reads_to_the_end(executable, root, tmp_path):
    """A pipe that is closed early: no message, and a run goes on to its end."""
    done = subprocess.run(f"{executable} doc --all | head -1", shell=True, capture_output=True,
                          text=True)
    assert done.stderr == "" and done.stdout == "# Keywords\n"
    deck = root/"decks"/"bar_gap.inp"
    done = subprocess.run(f"{executable} run {deck} -o {tmp_path} 2>&1 | true", shell=True,
                          capture_output=True, text=True)
    assert done.stderr == ""
    for _ in range(100):
        summary = tmp_path/"bar_gap.json"
        if summary.exists() and json.loads(summary.read_text())["status"] == "finished":
            break
        subprocess.run(["sleep", "0.05"])
    else:
        pytest.fail("the run did not end")
