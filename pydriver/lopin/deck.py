"""Deck: keyword blocks to text and back. Whatever is not changed keeps its text, comments included.

The deck language itself (which words exist, what they mean) is known to the Fortran core alone;
this module only knows that a block is a keyword line and the data lines below it.
"""
from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from pathlib import Path

from .errors import ResourceError, UsageError
from .files import cannot_write, whole_file

Value = float | int | str | None
#: A line that begins a block.
_HEAD = re.compile(r"^[ \t]*\*(?!\*).*", re.M)
_NUMBERS = {int, float}


class Row(list):
    """One data line as a list of values: int, float, str, or None for an empty field."""

    __slots__ = ("_text", "_read")   # there are a hundred thousand of them

    def __init__(self, values: Iterable[Value], text: str | None = None):
        super().__init__(values)
        self._text, self._read = text, None if text is None else list(self)

    @classmethod
    def read(cls, text: str) -> Row:
        fields = text.strip()
        fields = fields[:-1] if fields.endswith(",") else fields
        return cls([_value(f.strip()) for f in fields.split(",")], text)

    def text(self) -> str:
        if self._text is not None and self == self._read:
            return self._text
        if _NUMBERS.issuperset(map(type, self)):   # all at once
            text = list.__repr__(self)[1:-1].replace(".0,", ".,")
            return text[:-1] if text.endswith(".0") else text
        return ", ".join([_field(v) for v in self])


class Block:
    """A keyword, its parameters, and its lines.

    Attributes
    ----------
    keyword : str
        Upper case, without the star: ``"SURFACE INTERACTION"``.
    parameters : dict
        Upper-case names to values; None for a flag.
    lines : list of Row or str
        Data lines, and comments or text lines as they are.
    """

    def __init__(self, keyword: str, parameters: dict[str, Value] | None = None,
                 data: Iterable[Iterable[Value]] = (), *, text: str | None = None):
        self.keyword = keyword.lstrip("*").upper()
        self.parameters = dict(parameters or {})
        self._lines: list[Row | str] = [Row(row) for row in data]
        self._unread: list[str] = []   # lines of a text behind these: most are written as they are
        self._text, self._read = text, (self.keyword, dict(self.parameters))

    @property
    def lines(self) -> list[Row | str]:
        if self._unread:
            words = self._read[0] == "HEADING"
            for line in self._unread:
                is_text = words or not (bare := line.strip()) or bare.startswith("**")
                self._lines.append(line if is_text else Row.read(line))
            self._unread = []
        return self._lines

    @lines.setter
    def lines(self, lines: list[Row | str]) -> None:
        self._lines, self._unread = lines, []

    @property
    def data(self) -> list[Row]:
        """The data lines; change values in place, or append rows to `lines`."""
        return [line for line in self.lines if isinstance(line, Row)]

    def head(self) -> str:
        """The keyword line."""
        if self._text is not None and (self.keyword, self.parameters) == self._read:
            return self._text
        words = ["*" + self.keyword]
        words += [k if v is None else f"{k}={_field(v)}" for k, v in self.parameters.items()]
        return ", ".join(words)

    def text(self) -> str:
        lines = [line.text() if isinstance(line, Row) else line for line in self._lines]
        return "\n".join([self.head(), *lines, *self._unread])

    def __repr__(self) -> str:
        return f"Block({self.head()!r}, {len(self.data)} lines)"


class Deck:
    """The text of a model: what the executable reads, what a run records.

    >>> deck = Deck.parse("** bar\\n*STATIC\\n0.1, 1.  \\n*END STEP")
    >>> deck["*STATIC"].data[0][1] = 2.0
    >>> print(deck.text(), end="")
    ** bar
    *STATIC
    0.1, 2.
    *END STEP
    """

    def __init__(self, blocks: Iterable[Block] = (), *, preamble: Iterable[str] = (),
                 name: str = "model", folder: Path | str = "."):
        self.blocks = list(blocks)
        self.preamble = list(preamble)   #: comments before the first keyword
        self.name = name                 #: results are called after it
        self.folder = Path(folder)       #: *INCLUDE paths are relative to it

    @classmethod
    def read(cls, path: str | Path) -> Deck:
        """Read a file; included files stay included."""
        path = Path(path)
        if not path.is_file():
            raise ResourceError(f"no file {path}")
        text = path.read_text(encoding="utf-8-sig", errors="surrogateescape")
        return cls.parse(text, name=path.stem, folder=path.parent)

    @classmethod
    def parse(cls, text: str, name: str = "model", folder: Path | str = ".") -> Deck:
        """Read text."""
        deck = cls(name=name, folder=folder)
        lines = text.replace("\r\n", "\n").split("\n")
        if lines and not lines[-1]:
            lines.pop()
        here, own = 0, deck.preamble   # what is read next, and to what it is added
        while here < len(lines):
            line = lines[here]
            here += 1
            stripped = line.strip()
            if stripped.startswith("*") and not stripped.startswith("**"):
                while stripped.endswith(",") and (more := _goes_on(lines, here)):
                    line += "\n" + "\n".join(lines[here:here + more])
                    here += more
                    stripped = line.strip()
                deck.blocks.append(_block(line))
                own = deck.blocks[-1]._unread
            else:
                own.append(line)
        return deck

    def text(self) -> str:
        """The deck, ending with a newline."""
        return "\n".join([*self.preamble, *(b.text() for b in self.blocks)]) + "\n"

    def write(self, path: str | Path) -> Path:
        """Write the deck to a file and return its path."""
        path = Path(path)
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
        except OSError as problem:
            raise cannot_write(path, problem) from problem
        with whole_file(path, lasting=False) as part:
            part.write_text(self.text(), encoding="utf-8", errors="surrogateescape")
        return path

    def add(self, keyword: str, data: Iterable[Iterable[Value]] = (), comment: str = "",
            **parameters: Value) -> Block:
        """Append a block; underscores of parameter names are blanks, True is a flag.

        False and None leave a parameter out.
        """
        given = {k.replace("_", " ").upper(): None if v is True else v
                 for k, v in parameters.items() if v is not False and v is not None}
        block = Block(keyword, given, data)
        if comment:
            target = self.blocks[-1].lines if self.blocks else self.preamble
            target += [f"** {line}" for line in comment.split("\n")]
        self.blocks.append(block)
        return block

    def all(self, keyword: str) -> list[Block]:
        """All blocks of a keyword."""
        wanted = keyword.lstrip("*").upper()
        return [b for b in self.blocks if b.keyword == wanted]

    def __getitem__(self, keyword: str) -> Block:
        found = self.all(keyword)
        if not found:
            known = ", ".join(dict.fromkeys("*" + b.keyword for b in self.blocks))
            raise UsageError(f"the deck has no {keyword}; it has {known}")
        return found[0]

    def __contains__(self, keyword: str) -> bool:
        return bool(self.all(keyword))

    def __repr__(self) -> str:
        return f"Deck({self.name!r}, {len(self.blocks)} blocks)"


def heads(text: str) -> Iterator[Block]:
    """The keyword lines of a text, as blocks without their lines: quick in a long deck.

    >>> [b.parameters for b in heads("*NODE\\n1, 0.\\n*LOPIN,\\n** of contact\\nQUANTITY=FORCE\\n")]
    [{}, {'QUANTITY': 'FORCE'}]
    """
    found = _HEAD.search(text)
    while found:
        after = _HEAD.search(text, found.end())
        goes_on = found[0].rstrip().endswith(",")
        end = (after.start() if after else len(text)) if goes_on else found.end()
        yield Deck.parse(text[found.start():end]).blocks[0]
        found = after


def _goes_on(lines: list[str], start: int) -> int:
    """How many of the lines from `start` on a keyword line that ends with a comma goes on in:
    comments, and one with parameters; 0: none."""
    for k in range(start, len(lines)):
        stripped = lines[k].strip()
        if stripped and not stripped.startswith("**"):
            return 0 if stripped.startswith("*") else k - start + 1
    return 0


def _block(text: str) -> Block:
    lines = [line for line in text.split("\n") if not line.lstrip().startswith("**")]
    first, *rest = [word.strip() for word in " ".join(lines).split(",")]
    parameters: dict[str, Value] = {}
    for word in filter(None, rest):
        name, equals, value = word.partition("=")
        parameters[name.strip().upper()] = value.strip() if equals else None
    keyword = " ".join(first.lstrip("*").split()).upper()
    return Block(keyword, parameters, text=text)


def _value(field: str) -> Value:
    if not field:
        return None
    if "." not in field:
        try:
            return int(field)
        except ValueError:
            pass
    try:
        return float(field)
    except ValueError:
        pass
    try:
        return float(field.upper().replace("D", "E"))
    except ValueError:
        return field


def _field(value: Value) -> str:
    if type(value) is float:   # most of a mesh
        text = repr(value)
        return text[:-1] if text.endswith(".0") else text
    if value is None:
        return ""
    if isinstance(value, str):
        return value
    if type(value) is int:
        return str(value)
    if float(value).is_integer() and not isinstance(value, float):
        return str(int(value))
    text = repr(float(value))
    return text[:-1] if text.endswith(".0") else text
