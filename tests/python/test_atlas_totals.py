"""The published maps together: how many cells, how many with settings that nobody chose, and how
many of those are certified, told, or without an answer."""
import csv
import re
from collections import Counter
from pathlib import Path

from lopin.atlas.faces import LEVELS

ATLAS = Path(__file__).resolve().parents[2]/"docs"/"atlas"
#: Panels of exact contact with everything left to the code; of other maps, all.
DEFAULT = {1: "lagrange", 2: None, 3: None, 4: "exact, as shipped", 5: "as shipped", 8: None,
           9: "lagrange, as it comes", 10: r"(convex|hollow|STL), lagrange", 11: r".*(?<!FULL)$"}


def cells():
    for path in ATLAS.glob("map_*.csv"):
        number = int(re.match(r"map_(\d+)_", path.name)[1])
        with open(path, newline="", encoding="utf-8") as file:
            for row in csv.DictReader(file):
                yield number, row


def is_default(number, row):
    wanted = DEFAULT.get(number, ".*")
    if number == 15 and re.search("nodes|surface|Coulomb", LEVELS[int(row["y"])][0]):
        return False
    return wanted is not None and re.match(wanted, row["panel"]) is not None


def test_more_than_fifteen_thousand_cells_none_wrong_and_silent():
    kinds = Counter(row["kind"] for _, row in cells())
    assert sum(kinds.values()) >= 15_000 and kinds["F1"] == 0
    page = (ATLAS.parent/"atlas.md").read_text(encoding="utf-8")
    assert f"{sum(kinds.values()):,}".replace(",", " ") in page


def test_defaults():
    """Cells with several answers (F7) aside, 99 % are certified without a word."""
    kinds = Counter(row["kind"] for number, row in cells()
                    if is_default(number, row) and row["kind"] != "F7")
    total = sum(kinds.values())
    assert (kinds["F0"] + kinds["W"])/total > 0.999
    assert kinds["F0"]/total > 0.99
    page = (ATLAS.parent/"atlas.md").read_text(encoding="utf-8")
    assert f"{kinds['F0']} of {total}" in page
