"""What the papers print, and whether it is right: the ledgers in `errata/`, one TOML file a paper.

Each entry holds one equation, line of code, number or claim of a paper, the verdict on it, the corrected form
and the test that proves the verdict. A ledger begins with the paper's `title` and `notes` on its conventions.
"""

import re
import textwrap
import tomllib
from collections.abc import Iterable
from functools import cache
from importlib.resources import files
from typing import Any, NamedTuple

VERDICTS = (
    "correct",
    "given",
    "typo",
    "sign",
    "sign and exponent",
    "sign and missing factor",
    "wrong claim",
    "not reproducible",
)
FINE = ("correct", "given")  # verdicts that need no correction


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
    return "\n\n".join([*blocks, textwrap.fill(_summary(rows), width=max(width, 20))])


def markdown() -> str:
    """All ledgers as a Markdown page: for each paper what is not right, entry by entry, and what is right."""
    papers = [_paper(letter, sheet) for letter, sheet in _sheets().items()]
    return "\n\n".join([_HOW_TO_READ, _counts(), *papers])


@cache
def _sheets() -> dict[str, dict[str, Any]]:
    """What the ledgers' files hold, by document letter, in alphabetical order."""
    folder = files("desaxe").joinpath("errata")
    paths = sorted((item for item in folder.iterdir() if item.name.endswith(".toml")), key=lambda s: s.name)
    sheets = [tomllib.loads(path.read_text("utf-8")) for path in paths]
    return {sheet["entry"][0]["document"]: sheet for sheet in sheets}


@cache
def _ledgers() -> dict[str, tuple[Entry, ...]]:
    """The ledgers by document letter, in alphabetical order."""
    return {letter: tuple(Entry(**row) for row in sheet["entry"]) for letter, sheet in _sheets().items()}


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


# ---- Markdown ------------------------------------------------------------------------------------

_HOW_TO_READ = """\
# What the papers print, and whether it is right

Every numbered equation, every line of code, every number of a table and every claim that can be tested, of
the papers this package follows. Each entry names the place, what is printed there (in ASCII), what it should
be, and why. The verdicts:

- **sign**: a wrong sign
- **sign and exponent**, **sign and missing factor**: wrong signs, and wrong exponents or a factor left out
- **typo**: a misprint that the paper itself does not follow
- **wrong claim**: a formula, number or statement that does not hold
- **not reproducible**: a number that the printed formulas and data do not give; the nearest reading is told
- **given**: a datum, convention or statement of the paper that nothing at hand can confirm or contradict
- **correct**: it holds

A sign is judged by the paper's own conventions, which are told first. Every verdict is proved by a test of
this repository (`desaxe errata` lists the entries too, and `src/desaxe/errata/` names the test of each):
formulas are evaluated as printed, in 40 digits, and compared with the closed loop of the mechanism,
differentiated in time, and forces with the equations of the free bodies."""


def _counts() -> str:
    """A table of how many entries of each verdict the papers have."""
    rows = [("paper", *VERDICTS, "all"), ("---", *["---:"] * (len(VERDICTS) + 1))]
    for letter, ledger in _ledgers().items():
        counts = [sum(entry.verdict == verdict for entry in ledger) for verdict in VERDICTS]
        rows.append((f"[{letter}](#paper-{letter.lower()})", *map(str, counts), str(len(ledger))))
    return "\n".join(map(_row, rows))


def _paper(letter: str, sheet: dict[str, Any]) -> str:
    """One paper: its title, its conventions, what is not right entry by entry, what is right as a table."""
    ledger = _ledgers()[letter]
    wrong = [_item(entry) for entry in ledger if entry.verdict not in FINE]
    right = [
        _row((entry.id, _plain(entry.where), _code(entry.printed), _plain(entry.evidence)))
        for entry in ledger
        if entry.verdict in FINE
    ]
    head = [f"## Paper {letter}", _plain(sheet["title"]), *map(_plain, sheet["notes"])]
    table = "\n".join([_row(("id", "where", "printed", "why")), _row(["---"] * 4), *right])
    return "\n\n".join([*head, "### Not right", *wrong, "### Right", table])


def _item(entry: Entry) -> str:
    """An entry that is not right: verdict, place, what is printed, what it should be, and why."""
    is_formula = re.search(r"[*^]|:=|^\S+ = ", entry.corrected) and not entry.corrected.endswith(".")
    instead = _code(entry.corrected) if is_formula else _plain(entry.corrected)
    return "\n".join(
        [
            f"**{entry.id}** ({_plain(entry.where)}): **{entry.verdict}**",
            "",
            f"- printed: {_code(entry.printed)}",
            f"- instead: {instead}",
            f"- because: {_plain(entry.evidence)}",
        ]
    )


def _row(cells: Iterable[str]) -> str:
    """A row of a table; a bar inside a cell is escaped, in code too."""
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def _code(text: str) -> str:
    """Text as printed, in a code span."""
    return f"`{text}`"


def _plain(text: str) -> str:
    """Text whose signs Markdown would take for its own, escaped; an underscore within a word is none."""
    return re.sub(r"([\\`*<>\[\]~#]|(?<!\w)_|_(?!\w))", r"\\\1", text)
