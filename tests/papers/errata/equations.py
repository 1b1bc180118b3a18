"""The numbered equations of the papers: which are wrong, in one line each, and which are right."""

import re
from collections.abc import Callable, Iterable, Iterator
from typing import Protocol, TypeVar

from .formula import latex

FINE = ("correct", "given")  # verdicts that need no correction

_NUMBERED = re.compile(r"[A-Z]-eq(\w+)")
_FORMULA = re.compile(r"[A-Z]-eq\w+|A-listing-\w+|C-link\d-\w+")


class Judged(Protocol):
    """The attributes of an entry that this module reads."""

    @property
    def id(self) -> str:
        """Identifier of the entry, such as "B-eq20"."""

    @property
    def document(self) -> str:
        """The paper's letter."""

    @property
    def printed(self) -> str:
        """The form that the paper prints."""

    @property
    def verdict(self) -> str:
        """The verdict on the printed form."""

    @property
    def corrected(self) -> str:
        """The right form, or nothing."""


Row = TypeVar("Row", bound=Judged)


def number(entry: Judged) -> str:
    """The number of a numbered equation, such as "20" or "42b"; nothing for any other entry."""
    result = _NUMBERED.fullmatch(entry.id)
    return result.group(1) if result else ""


def forms(entry: Judged) -> tuple[str, str]:
    """An equation as printed and corrected, in LaTeX; empty where the entry or the correction is none."""
    if not _FORMULA.fullmatch(entry.id):
        return "", ""
    return _written(entry.printed), _written(entry.corrected)


def overview(rows: Iterable[Row], line: Callable[[Row], str]) -> Iterator[str]:
    """For each paper the numbered equations that are wrong, a `line` each, and which are right."""
    papers: dict[str, list[Row]] = {}
    for row in rows:
        papers.setdefault(row.document, []).append(row)
    for letter, ledger in papers.items():
        equations = [row for row in ledger if number(row)]
        wrong = [row for row in equations if row.verdict not in FINE]
        right = [number(row) for row in equations if row.verdict in FINE]
        if not equations:
            yield f"Paper {letter} numbers no equation."
            continue
        yield f"Paper {letter}: of {len(equations)} numbered equations {len(wrong)} wrong."
        yield from (line(row) for row in wrong)
        yield f"Right ({len(right)}): {', '.join(right)}."


def _written(text: str) -> str:
    """A formula in LaTeX, or nothing where the text is none."""
    try:
        return latex(text) if text else ""
    except ValueError:
        return ""
