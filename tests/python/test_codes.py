"""Every diagnostic code in the sources has an explanation, and the table of keywords is
complete."""

import os
import pathlib
import re
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[2]
EXECUTABLE = os.environ["LOPIN_EXECUTABLE"]


def lopin(*words):
    return subprocess.run([EXECUTABLE, *words], capture_output=True, text=True, timeout=20)


def codes_in_sources():
    codes = set()
    for path in (ROOT / "fortran").rglob("*.f90"):
        if path.name.startswith("explain"):
            continue
        code_lines = [line.split("!")[0] for line in path.read_text(encoding="utf-8").splitlines()]
        codes.update(re.findall(r"""['"]([EWN]\d{4})['"]""", "\n".join(code_lines)))
    return sorted(codes)


def test_every_code_is_explained():
    explained = {line.split()[0] for line in lopin("explain").stdout.splitlines() if line}
    assert not [code for code in codes_in_sources() if code not in explained]


def test_an_explanation_is_text_and_an_unknown_code_is_a_usage_error():
    run = lopin("explain", "e0102")
    assert run.returncode == 0 and run.stdout.startswith("E0102: unknown parameter")
    assert lopin("explain", "E9999").returncode == 2


def test_a_keyword_has_a_sheet():
    run = lopin("doc", "*friction")
    assert run.returncode == 0
    assert "*FRICTION" in run.stdout and "Example:" in run.stdout
    missing = lopin("doc", "*FRICTON")
    assert missing.returncode == 2 and "did you mean *FRICTION ?" in missing.stderr


def test_the_manual_in_docs_is_the_one_that_the_table_gives():
    manual = ROOT / "docs" / "keywords.md"
    assert lopin("doc", "--all").stdout == manual.read_text(encoding="utf-8"), (
        "write it again: lopin doc --all > docs/keywords.md"
    )


def test_the_version_is_the_one_of_the_build():
    version = re.search(r"project\(lopin VERSION (\S+)",
                        (ROOT / "CMakeLists.txt").read_text()).group(1)
    assert lopin("--version").stdout.strip() == f"lopin {version}"


def test_words_and_options_of_the_command_line():
    assert "lopin check deck.inp" in lopin("--help").stdout
    assert lopin("run").returncode == 2
    assert lopin("check", "no_such_deck.inp").returncode == 5
    assert "did you mean --threads?" in lopin("check", "--thread", "2", "a.inp").stderr
    for word in ["plot", "chart", "convert", "example"]:
        run = lopin(word, "something")
        assert run.returncode == 2
        assert "needs the Python package" in run.stderr


def test_the_selftest_passes():
    run = lopin("selftest")
    assert run.returncode == 0, run.stderr
    assert run.stdout.rstrip().endswith("selftest passed")


def test_json_of_a_bad_deck_holds_its_diagnostics():
    import json

    run = lopin("check", str(ROOT / "decks" / "bad" / "misspelt_nlgeom.inp"), "--json")
    assert run.returncode == 1
    said = json.loads(run.stdout)
    assert said["exit_code"] == 1 and said["status"] == "failed"
    assert said["diagnostics"][0]["code"] == "E0102" and said["diagnostics"][0]["line"] == 4
