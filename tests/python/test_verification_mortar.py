"""Patch tests of surface-to-surface contact by dual mortar, beside node to segment where it fails."""
import numpy as np
import pytest

import lopin
from blocks_2d import NU, Pair

CASE = "B1 patch test, mortar"
def in_process(deck):
    return lopin.run(deck)


PRESSED = (0.0, -1.0, -NU, 0.0)


@pytest.mark.parametrize("slave", ["lower", "upper"])
@pytest.mark.parametrize("kind", ["CPE4", "CPE3", "CPE8", "CPE6"])
@pytest.mark.parametrize("variant", ["plain", "turned by 27 degrees", "ratio of moduli 1000", "ratio of moduli 1/1000",
                                     "shorter upper block", "thickness 0.37"])
def test_uniform_pressure(core, solve, sheet, tmp_path, kind, variant, slave):
    pair = Pair(kind, 7, 10, 3, uneven=0.3, **({"left": 2.1, "right": 7.7} if variant.startswith("short") else {}))
    if variant.startswith("turned"):
        # Printed stresses have seven digits: enough where all but one vanish.
        pair.turned(27.0)
        solve = in_process
    if variant.startswith("ratio"):
        pair.young = (1e3, 1e6) if variant.endswith(" 1000") else (1e6, 1e3)
    if variant.startswith("thick"):
        pair.thickness = 0.37
    result = pair.pressed().solve(solve, tmp_path, slave=slave)
    case = CASE if kind == "CPE4" else "B5 patch test with other elements, mortar"
    sheet.compare(case, f"{kind}, 7/10 uneven, {slave} slave, {variant}: worst stress error",
                  pair.stress_error(result, PRESSED), 0.0, 1e-10, "exact", absolute=True)
    assert result.summary["certificate"]["verdict"] == "PASS"
    pressed = result.contact(0).last
    closed = pressed.status > 0
    assert np.abs(pressed.pressure[closed] - 1.0).max() < 1e-9
