"""docs/results.md names every word of a summary, and docs link to what exists."""
import json
import re
import subprocess

import pytest


def words(value):
    """Keys of a JSON object, at any depth."""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield key
            yield from words(inner)
    elif isinstance(value, list):
        for inner in value:
            yield from words(inner)


@pytest.mark.parametrize("name", ["bar_gap", "cattaneo", "bad/too_few_increments"])
def test_every_word_of_a_summary_is_explained(name, executable, root, tmp_path):
    subprocess.run([executable, "run", root/"decks"/f"{name}.inp", "-o", tmp_path],
                   capture_output=True)
    summary = json.loads(next(tmp_path.glob("*.json")).read_text())
    page = (root/"docs"/"results.md").read_text(encoding="utf-8")
    named = set(re.findall(r"`([a-z_]+)(?:\[\])?`", page))
    assert set(words(summary)) - named == set()


def anchor(heading):
    """The name under which a heading can be linked to."""
    return re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")


def test_no_link_within_the_pages_is_broken(root):
    pages = [*root.glob("*.md"), *root.glob("docs/*.md"), root/"decks"/"README.md"]
    broken = []
    for page in pages:
        text = re.sub(r"^```.*?^```$", "", page.read_text(encoding="utf-8"), flags=re.M | re.S)
        for target in re.findall(r"\]\(([^)\s]+)\)", text):
            if re.match(r"[a-z]+:", target):
                continue
            name, _, place = target.partition("#")
            goal = (page.parent/name).resolve() if name else page
            if not goal.exists():
                broken.append(f"{page.name}: {target}")
            elif place and goal.suffix == ".md":
                headings = re.findall(r"^#+ (.*)$", goal.read_text(encoding="utf-8"), re.M)
                if place not in map(anchor, headings):
                    broken.append(f"{page.name}: {target}")
    assert broken == []
