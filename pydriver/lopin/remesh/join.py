"""The files of a run in parts as those of one run."""
from __future__ import annotations

import csv
import json
import re
from pathlib import Path

from ..files import reading, whole_file

#: Columns that each part counts from its own beginning.
_GROWING = ("energy.external", "energy.friction", "energy.friction_mean", "energy.plastic",
            "energy.artificial")
_VERDICTS = ("PASS", "WARN", "FAIL")


def join_collections(folder: Path, name: str, parts: list[str]) -> None:
    """One .pvd of all parts: ParaView goes through them by time."""
    rows, head, tail = [], "", ""
    for part in parts:
        path = folder/f"{part}.pvd"
        if not path.is_file():
            continue
        text = path.read_text()
        rows += re.findall(r"^.*<DataSet .*$", text, re.M)
        head = text[:text.index("<Collection")] + "<Collection>\n"
        tail = text[text.index("</Collection>"):]
    if rows:
        with whole_file(folder/f"{name}.pvd") as file:
            file.write_text(head + "\n".join(rows) + "\n" + tail)


def has_whole_results(folder: Path, part: str) -> bool:
    """Whether the files that the summary of a part names are there, with the frames of its
    collection, and its history has a row, with all its columns, for each increment."""
    path, summary = folder/f"{part}_history.csv", folder/f"{part}.json"
    if not (path.is_file() and summary.is_file()):
        return False
    with reading(summary):
        told = json.loads(summary.read_text())
        increments = sum(step["increments"] for step in told["steps"])
        files = [folder/name for name in told["files"]]
    if not all(file.is_file() for file in files):
        return False
    frames = [name for file in files if file.suffix == ".pvd"
              for name in re.findall('file="([^"]*)"', file.read_text())]
    if not all((folder/name).is_file() for name in frames):
        return False
    with reading(path):
        text = path.read_text()
    rows = text.splitlines()
    return text.endswith("\n") and len(rows) == increments + 1 \
        and len({row.count(",") for row in rows}) == 1


def join_histories(folder: Path, name: str, parts: list[str]) -> None:
    """One history of all parts, with a column for the part; works go on from part to part."""
    head, rows, before = ["part [-]"], [], {}
    for number, part in enumerate(parts, 1):
        path = folder/f"{part}_history.csv"
        if not path.is_file():
            continue
        with reading(path), path.open(newline="") as file:
            first, *body = list(csv.reader(file))
        head += [word for word in first if word not in head]
        grows = [word for word in first if word.partition(" ")[0] in _GROWING]
        own = [dict(zip(first, row)) for row in body]
        for row in own:
            row[head[0]] = str(number)
            row |= {word: repr(float(row[word]) + float(before.get(word, 0.0))) for word in grows}
        rows += own
        before = rows[-1] if rows else {}
    if rows:
        with whole_file(folder/f"{name}_history.csv") as part, part.open("w", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows(
                [head, *([row.get(word, "nan") for word in head] for row in rows)])


def summaries(folder: Path, parts: list[str]) -> dict[int, dict]:
    """What the parts say of themselves, by their number from 1; those that have run."""
    found = {}
    for number, part in enumerate(parts, 1):
        path = folder/f"{part}.json"
        if path.is_file():
            with reading(path):
                found[number] = json.loads(path.read_text())
    return found


def worse(*verdicts: str) -> str:
    """The worst of some verdicts; PASS without any.

    >>> worse("PASS", "FAIL", "none"), worse()
    ('FAIL', 'PASS')
    """
    return max((v for v in verdicts if v in _VERDICTS), key=_VERDICTS.index, default="PASS")


def worst_certificate(found: dict[int, dict]) -> dict:
    """The certificate of the part that fared worst, the first of them, with its number; empty
    without any."""
    certificates = {n: d["certificate"] for n, d in found.items() if d.get("certificate")}
    worst = worse(*(c.get("verdict", "PASS") for c in certificates.values()))
    own = [n for n, c in certificates.items() if c.get("verdict", "PASS") == worst]
    return {"part": own[0], **certificates[own[0]]} if own else {}


def said_of(found: dict[int, dict]) -> list[dict]:
    """What the solver said in any part, each once."""
    return list({json.dumps(said, sort_keys=True): said for each in found.values()
                 for said in each.get("diagnostics", [])}.values())


def join_summaries(folder: Path, name: str, parts: list[str], verdict: str) -> None:
    """One summary: that of the last part, with the sums of all, and the certificate of the part
    that fared worst. `verdict`: of the remeshes."""
    by_part = summaries(folder, parts)
    found = list(by_part.values())
    if not found:
        return
    whole = dict(found[-1])
    whole["deck"] = re.sub(r"\.p\d+\.inp$", ".inp", whole["deck"])
    whole["parts"] = len(found)
    whole["steps"] = [_sum([d["steps"][k] for d in found if k < len(d.get("steps", []))])
                      for k in range(len(whole.get("steps", [])))]
    whole["timing"] = _sum([d.get("timing", {}) for d in found])
    whole["peak_memory_mib"] = max(d.get("peak_memory_mib", 0.0) for d in found)
    if "certificate" in whole:
        worst = worst_certificate(by_part)
        whole["certificate"] = {k: v for k, v in worst.items() if k != "part"} | {
            "verdict": worse(verdict, worst.get("verdict", "PASS"))}
    whole["diagnostics"] = said_of(by_part)
    whole["files"] = [f"{name}.pvd", f"{name}_history.csv", f"{name}.parts.json"]
    with whole_file(folder/f"{name}.json") as file:
        file.write_text(json.dumps(whole, indent=1) + "\n")


def _sum(tables: list[dict]) -> dict:
    """Numbers of tables added up, tables within them too."""
    total: dict = {}
    for table in tables:
        for key, value in table.items():
            if isinstance(value, dict):
                total[key] = _sum([total.get(key, {}), value])
            elif isinstance(value, (int, float)):
                total[key] = total.get(key, 0) + value
            else:
                total[key] = value
    return total
