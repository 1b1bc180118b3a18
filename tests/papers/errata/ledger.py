"""The ledgers of the papers' errata: read and filtered.

Each entry holds one equation, line of code, number or claim of a paper, the verdict on it, the corrected form
and the test that proves the verdict. A ledger begins with the paper's `title`, `notes` on its conventions,
and the `harm`: what whoever uses the paper must know.
"""

import tomllib
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

from .equations import FINE
from .marks import plain

FOLDER = Path(__file__).parent
VERDICTS = (
    "correct",
    "given",
    "typo",
    "sign",
    "sign and exponent",
    "sign and missing factor",
    "wrong claim",
    "omission",
    "not reproducible",
)


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


class Harm(NamedTuple):
    """A warning to users of a paper: a mistake and its cost, or a part that is right."""

    what: str
    cost: str
    write: tuple[Entry, ...]  # the right forms to write instead
    entries: tuple[str, ...]  # ids of the entries that prove it


def entries(
    document: str | None = None, verdict: str | None = None, wrong: bool = False
) -> tuple[Entry, ...]:
    """All entries in the order of the papers, or those of one document ("A") or one verdict ("sign").

    With `wrong` only those that need a correction: neither correct nor given.
    """
    ledgers = _ledgers()
    _require("document", document, tuple(ledgers))
    _require("verdict", verdict, VERDICTS)
    return tuple(
        entry
        for letter, ledger in ledgers.items()
        if document in (None, letter)
        for entry in ledger
        if verdict in (None, entry.verdict) and not (wrong and entry.verdict in FINE)
    )


def documents() -> tuple[str, ...]:
    """The letters of the papers."""
    return tuple(_ledgers())


def title(document: str) -> str:
    """Authors, title and year of a paper."""
    return str(sheets()[document]["title"])


def conventions(document: str) -> tuple[str, ...]:
    """The axes, signs and units of a paper, and what its text was read from."""
    return tuple(f"{note}" for note in sheets()[document]["notes"])


def harm(document: str) -> tuple[Harm, ...]:
    """Warnings to users of a paper, worst first."""
    of = {entry.id: entry for entry in _ledgers()[document]}
    return tuple(
        Harm(
            row["what"],
            plain(row["cost"]),
            tuple(of[key] for key in row["write"]),
            tuple(row["entries"]),
        )
        for row in sheets()[document]["harm"]
    )


@cache
def sheets() -> dict[str, dict[str, Any]]:
    """The content of the ledgers' files by document letter, in alphabetical order, marks included."""
    result = [tomllib.loads(path.read_text("utf-8")) for path in sorted(FOLDER.glob("*.toml"))]
    return {sheet["entry"][0]["document"]: sheet for sheet in result}


@cache
def _ledgers() -> dict[str, tuple[Entry, ...]]:
    """The ledgers by document letter, in alphabetical order."""
    return {
        letter: tuple(Entry(**{field: plain(text) for field, text in row.items()}) for row in sheet["entry"])
        for letter, sheet in sheets().items()
    }


def _require(what: str, value: str | None, allowed: tuple[str, ...]) -> None:
    """Refuse a value that is neither None nor allowed."""
    if value is not None and value not in allowed:
        raise ValueError(f"unknown {what} {value!r}: allowed are {', '.join(map(repr, allowed))}")
