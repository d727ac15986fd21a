"""Metal whose stress depends on its rate flows on while a tool goes back."""
import sys
from pathlib import Path

import lopin

sys.path.insert(0, str(Path(__file__).resolve().parents[2]/"decks"/"make"))
import forging  # noqa: E402


def released(solve, first):
    """Plastic work while the die goes back at 8 mm/s, that of the forming, and what was said."""
    up = f"*STEP, NLGEOM, INC=500\n*STATIC\n{first:g}, 1.\n*BOUNDARY, TYPE=VELOCITY\nDIE_REF, 2, 2, 8.\n*END STEP\n"
    result = solve(lopin.Deck.parse(forging.closed_die(8, short=3.5) + up, "up"))
    work = result.history["energy.plastic"]
    formed = int((result.history["step"] == 1).sum()) - 1
    return work[-1] - work[formed], {d["code"] for d in result.diagnostics}


def test_a_die_that_is_gone_within_an_increment_is_told_or_followed(solve):
    """An increment of a twentieth of a second let go of all at once, without a word."""
    right, _ = released(solve, 1e-5)
    found, said = released(solve, 0.05)
    assert right > 0.0 and (found > 0.8*right or "W0555" in said)
