"""Write decks/README.md from the decks themselves: `python decks/make/readme.py [name ...]`.

An entry is the first comment of a deck, its expectations with what a run gave, and its picture.
"""
from __future__ import annotations

import os
import sys
import tempfile
from pathlib import Path

from expectations import expectations, measured, run

ROOT = Path(__file__).resolve().parents[2]
GROUPS = {
    "By hand": ("bar_gap", "two_springs", "no_separation"),
    "Laws of metals by hand": ("rolled_strip", "bauschinger", "bending_unbending",
                               "hot_upsetting"),
    "Hertz and other closed forms": ("hertz_sphere", "hertz_sphere_3d", "ball_on_ball",
                                     "cylinder_on_plane", "nafems_cylinder", "flat_punch",
                                     "shrink_fit", "signorini", "ball_of_facets"),
    "Beams and strips": ("strip_bending", "glued_beam", "beam_on_roller", "lifted_beam"),
    "Friction": ("cattaneo", "rough_punch", "nafems_punch", "capstan", "orowan_shoe",
                 "viscous_shoe", "arctan_shoe"),
    "Far sliding and large strain": ("rotating_rings", "ironing", "crushed_ring",
                                     "folded_strip", "beam_over_corner", "sliding_ball",
                                     "elastica", "rubber_cube", "rubber_tube"),
    "Bulk forming": ("upsetting", "ring_compression", "wire_drawing", "closed_die", "full_flash",
                     "elastic_anvil",
                     "upset_tetra", "cross"),
    "Sheets": ("cup", "square_cup", "trimmed_cup",
               "v_bending", "wrapped_strip", "drawbead", "blanking",
               "shearing"),
    "Meshes that do not match": ("patch_test", "two_blocks_mortar"),
}
HEAD = """# Decks

Written by `decks/make/readme.py` from the decks, which are also tests: the number after *expect* is
checked at every build (`tests/python/test_decks.py`). Run one by

```sh
build/lopin run decks/hertz_sphere.inp      # results in out/hertz_sphere/
```

A deck that becomes an example: put it here, describe it in its first comment, end that with lines
such as

```
** expect: certificate.verdict = PASS
** expect: contact.0.max_pressure = 279.83 +- 0.5 %
** expect: history.BALL.rf2 at 1 = -588.4 +- 0.2 %
```

(paths into the JSON file, columns of the history, `node.13.u2` of a `*NODE PRINT`), then run
`python decks/make/readme.py`. Meshes that decks include are written by `decks/make/meshes.py`,
pictures by `decks/make/pictures.py`. [bad/](bad) holds a deck for each message of refusal.
"""


def entry(deck: Path, executable: Path, folder: Path) -> str:
    """The entry of one deck."""
    comment = []
    for line in deck.read_text(encoding="utf-8").splitlines():
        if not line.startswith("**"):
            break
        comment.append(line[2:].removeprefix(" ").rstrip())
    told = [line for line in comment if not line.startswith("expect:")]
    done = run(deck, executable, folder)
    if done.returncode != 0:
        raise SystemExit(f"{deck.name} failed:\n{done.stdout}{done.stderr}")
    rows = "\n".join(f"| {line.text} | {_short(measured(folder/deck.stem, deck.stem, line))} |"
                     for line in expectations(deck))
    title, text = told[0], "\n".join(told[1:]).strip("\n")
    picture = ROOT/"docs"/"pictures"/f"{deck.stem}.png"
    shown = f"![{title}](../docs/pictures/{deck.stem}.png)\n\n" if picture.is_file() else ""
    return (f"## {deck.stem}\n\n**{title}** ([{deck.name}]({deck.name}))\n\n{shown}"
            f"```\n{text}\n```\n\n| expect | measured |\n| --- | --- |\n{rows}\n")


def _short(found) -> str:
    if not isinstance(found, float):
        return str(found)
    return "0" if abs(found) < 1e-12 else f"{found:.6g}"


def kept(name: str) -> str:
    """The entry that the catalogue has now, or nothing."""
    old = (ROOT/"decks"/"README.md").read_text(encoding="utf-8").split(f"\n## {name}\n")
    return f"## {name}\n" + old[1].split("\n## ")[0].rstrip("\n") + "\n" if len(old) > 1 else ""


def main(names: list[str]) -> None:
    """Write the catalogue; if decks are named, only theirs and missing entries are made anew."""
    executable = Path(os.environ.get("LOPIN_EXECUTABLE", ROOT/"build"/"lopin"))
    grouped = [name for names in GROUPS.values() for name in names]
    rest = sorted(p.stem for p in (ROOT/"decks").glob("*.inp") if p.stem not in grouped)
    groups = GROUPS | ({"More": tuple(rest)} if rest else {})
    text = [HEAD]
    text.append("\n".join(f"- {group}: " + ", ".join(f"[{n}](#{n})" for n in names)
                          for group, names in groups.items()) + "\n")
    with tempfile.TemporaryDirectory() as folder:
        for name in [name for group in groups.values() for name in group]:
            old = kept(name) if names and name not in names else ""
            text.append(old or entry(ROOT/"decks"/f"{name}.inp", executable, Path(folder)))
    (ROOT/"decks"/"README.md").write_text("\n".join(text), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
