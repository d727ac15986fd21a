"""The walk of docs/architecture.md: every procedure that it names exists where it says, each of a
numbered list calls the next, and a forming increment crosses at most twelve."""
import re
import sys

import pytest

from conftest import ROOT

sys.path.insert(0, str(ROOT/"tests"))
from measure_sources import BEGIN, END, statements  # noqa: E402

PAGE = (ROOT/"docs"/"architecture.md").read_text(encoding="utf-8")
WALK = PAGE.split("## The walk of a deck")[1].split("\n## ")[0]
NAMED = re.compile(r"`(\w+)`\s*(?:\(|,\s+)`([\w/]+\.f90)`")
ITEM = re.compile(r"^\d+\. `(\w+)`\s+\(`([\w/]+\.f90)`\)", re.MULTILINE)


def procedures(path) -> dict:
    """Code of each procedure of a file, without what it contains."""
    found, stack = {}, []
    for _, code, _ in statements((ROOT/"fortran"/path).read_text(encoding="utf-8")):
        begun = None if END.match(code) else BEGIN.match(code)
        if begun:
            stack.append(begun[2].lower())
            found.setdefault(stack[-1], "")
        elif END.match(code) and stack:
            stack.pop()
        elif stack:
            found[stack[-1]] += code.lower() + "\n"
    return found


def shared_parts(path) -> str:
    """Code of the parts that procedures of a file give to `share_out`."""
    text = (ROOT/"fortran"/path).read_text(encoding="utf-8")
    code = procedures(path)
    return "".join(code[part] for part in re.findall(r"procedure :: do_part => (\w+)", text))


def lists() -> list:
    """The numbered lists: (name, file) of their items."""
    chains = []
    for match in ITEM.finditer(WALK):
        if match[0].startswith("1. "):
            chains.append([])
        chains[-1].append((match[1], match[2]))
    return chains


def test_the_walk_has_its_lists():
    assert [len(chain) for chain in lists()] == [6, 11, 12, 12]
    assert len(re.findall(r"^\d+\. ", WALK, re.MULTILINE)) == sum(map(len, lists()))


@pytest.mark.parametrize("chain", lists(), ids=lambda chain: chain[-1][0])
def test_each_procedure_calls_the_next(chain):
    for (name, path), (called, home) in zip(chain, chain[1:]):
        assert called in procedures(home), f"{home} has no {called}"
        code = procedures(path).get(name)
        assert code is not None, f"{path} has no {name}"
        if "call share_out(" in code:
            code += shared_parts(path)
        assert re.search(rf"\b{called}\b", code), f"{name} does not call {called}"


def test_every_procedure_that_is_named_exists():
    named = set(NAMED.findall(WALK))
    assert len(named) > 50
    missing = [f"{path}: {name}" for name, path in named if name not in procedures(path)]
    assert not missing, missing
    here = re.findall(r"`([\w/]+\.f90)`", WALK)
    assert all((ROOT/"fortran"/path).is_file() for path in here)


def test_other_names_of_the_walk_are_procedures_of_its_files():
    """Names without a file stand beside one that has it."""
    homes = {path for _, path in NAMED.findall(WALK)} | set(re.findall(r"`([\w/]+\.f90)`", WALK))
    known = {name for path in homes for name in procedures(path)}
    known |= {"state_type", "open_session"}
    words = {w for w in re.findall(r"`(\w+)`", WALK) if w not in ("pass", "NLGEOM")}
    assert words <= known, words - known


def test_a_forming_increment_crosses_twelve_procedures():
    forming = next(c for c in lists() if c[-1][0] == "return_to_disc")
    assert forming[0][0] == "advance" and len(forming) <= 12
    assert len({path for _, path in lists()[0][3:]}) == 1, "the loop stands in one file"
