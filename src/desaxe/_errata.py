"""What the papers print, and whether it is right: the ledgers in `errata/`, one TOML file a paper.

Each entry holds one equation, line of code, number or claim of a paper, the verdict on it, the corrected form
and the test that proves the verdict.
"""

import textwrap
import tomllib
from collections.abc import Iterable
from functools import cache
from importlib.resources import files
from typing import NamedTuple

VERDICTS = ("correct", "typo", "sign", "wrong claim", "not reproducible")


class Entry(NamedTuple):
    """One line of a ledger."""

    id: str  # such as "A-eq19"
    document: str  # the paper's letter
    where: str  # equation, section or figure
    printed: str  # what the paper says, in ASCII mathematics
    verdict: str  # one of VERDICTS
    corrected: str  # what it should say; empty if it is correct
    evidence: str
    test: str  # pytest node of the proof


def entries(document: str | None = None, verdict: str | None = None) -> tuple[Entry, ...]:
    """All entries in the order of the papers, or those of one document ("A") or one verdict ("sign")."""
    ledgers = _ledgers()
    _require("document", document, tuple(ledgers))
    _require("verdict", verdict, VERDICTS)
    return tuple(
        entry
        for letter, ledger in ledgers.items()
        if document in (None, letter)
        for entry in ledger
        if verdict in (None, entry.verdict)
    )


def table(entries: Iterable[Entry], width: int = 100) -> str:
    """The entries as text for a terminal, wrapped to `width` columns; the last line counts verdicts."""
    rows = tuple(entries)
    indent = max((len(row.verdict) for row in rows), default=0) + 2
    blocks = [_block(row, indent, width) for row in rows]
    return "\n\n".join([*blocks, _summary(rows)])


@cache
def _ledgers() -> dict[str, tuple[Entry, ...]]:
    """The ledgers by document letter, in alphabetical order."""
    folder = files("desaxe").joinpath("errata")
    sheets = sorted((item for item in folder.iterdir() if item.name.endswith(".toml")), key=lambda s: s.name)
    found = (Entry(**row) for sheet in sheets for row in tomllib.loads(sheet.read_text("utf-8"))["entry"])
    ledgers: dict[str, list[Entry]] = {}
    for entry in found:
        ledgers.setdefault(entry.document, []).append(entry)
    return {letter: tuple(ledger) for letter, ledger in ledgers.items()}


def _require(what: str, value: str | None, allowed: tuple[str, ...]) -> None:
    """Refuse a value that is neither None nor allowed."""
    if value is not None and value not in allowed:
        raise ValueError(f"unknown {what} {value!r}: allowed are {', '.join(map(repr, allowed))}")


def _block(entry: Entry, indent: int, width: int) -> str:
    """One entry: verdict in the margin; id and place, what is printed, the correction, the evidence."""
    lines = [(entry.verdict, f"{entry.id}  ({entry.where})"), ("", f"printed: {entry.printed}")]
    if entry.corrected:
        lines.append(("", f"instead: {entry.corrected}"))
    lines.append(("", f"because: {entry.evidence}"))
    return "\n".join(_wrapped(margin, text, indent, width) for margin, text in lines)


def _wrapped(margin: str, text: str, indent: int, width: int) -> str:
    """Text beside a margin of fixed width; continuation lines hang under the text."""
    return textwrap.fill(
        text,
        width=max(width, indent + 20),
        initial_indent=margin.ljust(indent),
        subsequent_indent=" " * (indent + 9 if not margin else indent),
        break_long_words=False,
        break_on_hyphens=False,
    )


def _summary(rows: tuple[Entry, ...]) -> str:
    """How many entries there are of each verdict."""
    counts = ((sum(row.verdict == verdict for row in rows), verdict) for verdict in VERDICTS)
    parts = ", ".join(f"{count} {verdict}" for count, verdict in counts if count)
    noun = "entry" if len(rows) == 1 else "entries"
    return f"{len(rows)} {noun}" + (f": {parts}" if parts else "")
