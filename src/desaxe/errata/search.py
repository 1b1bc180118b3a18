"""Search in the ledgers: by id, equation number, or words of the text."""

import re
from collections.abc import Iterable, Sequence
from typing import TypeVar

Row = TypeVar("Row", bound=tuple[str, ...])

_EQUATION = re.compile(r"eq(?:uation|n)?s?[. ]*\(?(\d+[a-z]?)\)?", re.IGNORECASE)


def matching(rows: Iterable[Row], words: Sequence[str]) -> tuple[Row, ...]:
    """The entries that match the words; all entries without words.

    "B-eq20" is one entry; "eq20" and "Eq. 20" are that equation of every paper, "eq37" also 37a and 37b.
    Other words are looked for in all fields but the test, in any case; all of them must occur.
    """
    kept = tuple(rows)
    text = " ".join(words).strip().lower()
    named = tuple(row for row in kept if text and text in (row[0].lower(), row[0].lower().partition("-")[2]))
    if named:
        return named
    equation = _EQUATION.fullmatch(text)
    if equation:
        wanted = re.compile(rf"[a-z]-eq{equation.group(1)}[a-z]?")
        return tuple(row for row in kept if wanted.fullmatch(row[0].lower()))
    return tuple(row for row in kept if all(word.lower() in " ".join(row[:-1]).lower() for word in words))
