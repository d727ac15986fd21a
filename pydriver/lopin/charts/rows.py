"""Rows of the tables of charts and maps: dataclasses as text and back."""
from __future__ import annotations

from dataclasses import fields
from typing import Self

import numpy as np

_READ = {"float": lambda text: float(text or "nan"), "int": int, "str": str}


class TableRow:
    """A dataclass of numbers and words whose fields are the columns of a table."""

    #: Digits of a number.
    DIGITS = 6

    @classmethod
    def columns(cls) -> list[str]:
        """Names of the columns."""
        return [f.name for f in fields(cls)]

    def values(self) -> list[str]:
        """The row as text; nothing where nothing is known."""
        raw = [getattr(self, name) for name in self.columns()]
        return ["" if isinstance(v, float) and not np.isfinite(v) else
                f"{v:.{self.DIGITS}g}" if isinstance(v, float) else str(v) for v in raw]

    @classmethod
    def read(cls, texts: dict[str, str]) -> Self:
        """The row of texts that `values` gave, or of some of them."""
        kinds = {f.name: str(f.type) for f in fields(cls)}
        return cls(**{name: _READ[kinds[name]](text) for name, text in texts.items()})
