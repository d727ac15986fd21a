"""Decks of decks/handbook, each asked for 1 %: what the command does, and the true error.

    python tests/benchmarks/handbook.py [NAME...]       run, docs/charts/handbook.csv
    python tests/benchmarks/handbook.py --page          tables of docs/handbook.md from that file
    python tests/benchmarks/handbook.py --pictures      docs/pictures/handbook*.png

A deck is run by the command of the Python package, as its user would; one that is still at work
after three minutes is stopped. Rows of decks that are not named stay as they are.
"""
from __future__ import annotations

import csv
import json
import os
import re
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
TABLE, PAGE = ROOT/"docs"/"charts"/"handbook.csv", ROOT/"docs"/"handbook.md"
sys.path.insert(0, str(ROOT/"decks"/"make"))
import handbook  # noqa: E402

COLUMNS = ("deck", "quantity", "exact", "value", "estimate", "true", "meshes", "increments",
           "equations", "verdict", "order", "cost", "seconds", "warnings", "refused")
LONGEST = 180.0


def said(name: str, word: str) -> str:
    """What the head of a deck says: `** word: ...`."""
    text = (handbook.FOLDER/f"{name}.inp").read_text(encoding="utf-8")
    return re.search(rf"^\*\* {word}: (.*)$", text, re.MULTILINE)[1]


def row_of(name: str) -> dict:
    """Run one deck by the command."""
    exact = float(said(name, "exact"))
    row = {"deck": name, "exact": repr(exact)}
    with tempfile.TemporaryDirectory() as folder:
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        command = [sys.executable, "-m", "lopin", "run", str(handbook.FOLDER/f"{name}.inp"), "-o",
                   folder]
        try:
            done = subprocess.run(command, capture_output=True, text=True, check=False,
                                  timeout=LONGEST, env=os.environ | {"OPENBLAS_NUM_THREADS": "1"})
            words = done.stderr if done.returncode else ""
        except subprocess.TimeoutExpired:
            words = f"stopped after {LONGEST:g} s"
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        used = sum(getattr(after, k) - getattr(before, k) for k in ("ru_utime", "ru_stime"))
        row["seconds"] = f"{used:.2f}"
        first = [line for line in words.splitlines() if line.strip()][:1]
        row["refused"] = re.sub(r" \([^()]*mesh\d[^()]*\)", "", first[0]) if first else ""
        found = Path(folder)/f"{name}.accuracy.json"
        summaries = sorted(Path(folder).glob(f"mesh*/{name}.json"))
        if summaries:
            last = json.loads(summaries[-1].read_text(encoding="utf-8"))
            row["warnings"] = " ".join(sorted({d["code"] for d in last.get("diagnostics", ())
                                               if d["severity"] == "warning"}))
        if found.is_file():
            row |= of_answer(json.loads(found.read_text(encoding="utf-8")), exact)
    return row


def of_answer(answer: dict, exact: float) -> dict:
    """The columns that the command's own file fills."""
    runs = answer["runs"]
    value = answer["value"]
    row = {"quantity": answer["quantity"], "value": repr(value), "cost": f"{answer['cost']:.3g}",
           "meshes": runs[-1]["mesh"] + 1, "increments": runs[-1]["increments"],
           "equations": runs[-1]["equations"], "verdict": runs[-1]["verdict"]}
    for word in ("order", "error"):
        if isinstance(answer[word], float):
            row[{"error": "estimate"}.get(word, word)] = f"{answer[word]:.4g}"
    return row | {"true": f"{abs(value/exact - 1.0):.4g}"}


def table() -> list[dict]:
    """Rows of the file."""
    if not TABLE.is_file():
        return []
    with TABLE.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def percent(word: str) -> str:
    """A share in percent, two digits; what is rounding is not told apart."""
    if not word:
        return ""
    return "< 0.0001" if float(word) < 1e-6 else f"{100.0*float(word):.2g}"


def lines_of_page() -> list[str]:
    """Both tables of the page."""
    rows = {row["deck"]: row for row in table()}
    out = ["| deck | problem | asked | closed form | Lopin | estimate % | true % |",
           "| --- | --- | --- | --- | --- | --- | --- |"]
    for name in handbook.PROBLEMS:
        text = (handbook.FOLDER/f"{name}.inp").read_text(encoding="utf-8")
        title, row = text.splitlines()[0].removeprefix("** ").rstrip("."), rows[name]
        asked = re.search(r"QUANTITY=([A-Z ]+)", text)[1].lower()
        value = f"{float(row['value']):.6g}" if row["value"] else ""
        if row["refused"]:
            value += f" refused ({row['refused'].split(':')[1].strip()})" if ":" in row["refused"] \
                else f" {row['refused']}"
        out.append(f"| [{name}](../decks/handbook/{name}.inp) | {title}. {said(name, 'source')} | "
                   f"{asked} | {float(row['exact']):.6g} | {value.strip()} | "
                   f"{percent(row['estimate'])} | {percent(row['true'])} |")
    out += ["", "| deck | meshes | increments | equations | order | cost | CPU s | said |",
            "| --- | --- | --- | --- | --- | --- | --- | --- |"]
    for name in handbook.PROBLEMS:
        row = rows[name]
        order = f"{float(row['order']):.2g}" if row["order"] else ""
        notes = ", ".join(w for w in [row["verdict"], *row["warnings"].split(),
                                      row["refused"].removeprefix("error: ")] if w)
        increments = f"x {float(row['increments']):g}" if row["increments"] else ""
        out.append(f"| {name} | {row['meshes']} | {increments} | {row['equations']} | {order} | "
                   f"{row['cost']} | {float(row['seconds']):.1f} | {notes} |")
    return out


def write_page() -> None:
    """The tables between the marks of the page."""
    begin, end = "<!-- table: tests/benchmarks/handbook.py -->", "<!-- end of table -->"
    page = PAGE.read_text(encoding="utf-8")
    head, _, rest = page.partition(begin)
    middle = "\n".join(lines_of_page())
    PAGE.write_text(f"{head}{begin}\n{middle}\n{end}{rest.partition(end)[2]}", encoding="utf-8")


def main(words: list[str]) -> None:
    """Do what the command line says."""
    if words == ["--page"]:
        write_page()
        return
    if words == ["--pictures"]:
        import pictures_handbook
        pictures_handbook.main(table())
        return
    rows = {row["deck"]: row for row in table()}
    for name in words or handbook.PROBLEMS:
        rows[name] = row_of(name)
        print({k: v for k, v in rows[name].items() if v}, flush=True)
        with TABLE.open("w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, COLUMNS, lineterminator="\n", restval="")
            writer.writeheader()
            writer.writerows(rows[n] for n in handbook.PROBLEMS if n in rows)


if __name__ == "__main__":
    main(sys.argv[1:])
