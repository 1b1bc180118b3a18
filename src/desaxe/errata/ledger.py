"""The ledgers of the papers' errata: read, filtered, and written as text and Markdown.

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

from .equations import FINE, forms, number, overview

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


def table(entries: Iterable[Entry], width: int = 100, tex: bool = False) -> str:
    """The entries as text for a terminal, wrapped to `width` columns; the last line counts verdicts.

    With `tex` equations are written in LaTeX too, under the printed and the corrected form.
    """
    rows = tuple(entries)
    indent = max((len(row.verdict) for row in rows), default=0) + 2
    blocks = [_block(row, indent, width, tex) for row in rows]
    return "\n\n".join([*blocks, textwrap.fill(_summary(rows), width=max(width, 20))])


def headings(entries: Iterable[Entry], width: int = 100) -> str:
    """Title, axes and conventions of the papers that the entries are of, as text for a terminal."""
    return "\n\n".join(
        "\n".join(_hanging(text, width, 3) for text in lines)
        for letter in dict.fromkeys(entry.document for entry in entries)
        for lines in [[f"{letter}: {title(letter)}", *conventions(letter)]]
    )


def title(document: str) -> str:
    """Authors, title and year of a paper."""
    return str(_sheets()[document]["title"])


def conventions(document: str) -> tuple[str, ...]:
    """The axes, signs and units of a paper, and what its text was read from."""
    return tuple(f"{note}" for note in _sheets()[document]["notes"])


def equations(entries: Iterable[Entry], width: int = 100, tex: bool = False) -> str:
    """The numbered equations that are wrong with their right forms, and the numbers of the others."""

    def line(entry: Entry) -> str:
        right = forms(entry)[1] if tex else ""
        return f"  {f'Eq. {number(entry)}':8} {entry.verdict}: {right or entry.corrected}"

    return "\n".join(_hanging(text, width, 11) for text in overview(entries, line))


def record(entry: Entry) -> dict[str, Any]:
    """An entry with its paper's title and conventions, its equation in LaTeX and the test of its verdict."""
    printed, corrected = forms(entry)
    paper = {"paper": title(entry.document), "conventions": list(conventions(entry.document))}
    return {**entry._asdict(), "latex_printed": printed, "latex_corrected": corrected, **paper}


def markdown(entries: Iterable[Entry] | None = None) -> str:
    """The ledgers as a Markdown page: the wrong equations first, then each paper, entry by entry.

    With `entries` only these are on it.
    """
    rows = (
        tuple(row for ledger in _ledgers().values() for row in ledger) if entries is None else tuple(entries)
    )
    first = [_HOW_TO_READ, _first_page(rows), _counts()] if entries is None else [_SELECTION]
    papers = [_paper(letter, [row for row in rows if row.document == letter]) for letter in _sheets()]
    return "\n\n".join([*first, *filter(None, papers)])


@cache
def _sheets() -> dict[str, dict[str, Any]]:
    """The content of the ledgers' files by document letter, in alphabetical order."""
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


def _block(entry: Entry, indent: int, width: int, tex: bool) -> str:
    """One entry as text: verdict in the margin; id, place, printed form, correction, evidence."""
    printed, corrected = forms(entry) if tex else ("", "")
    lines = [(entry.verdict, f"{entry.id}  ({entry.where})"), ("", f"printed: {entry.printed}")]
    lines += [("", f"  LaTeX: {printed}")] if printed else []
    lines += [("", f"instead: {entry.corrected}")] if entry.corrected else []
    lines += [("", f"  LaTeX: {corrected}")] if corrected else []
    lines.append(("", f"because: {entry.evidence}"))
    return "\n".join(_wrapped(margin, text, indent, width) for margin, text in lines)


def _hanging(text: str, width: int, indent: int) -> str:
    """Text wrapped to a width, all lines but the first indented."""
    return textwrap.fill(
        text,
        width=max(width, 2 * indent + 20),
        subsequent_indent=" " * indent,
        break_long_words=False,
        break_on_hyphens=False,
    )


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
    """The number of entries of each verdict, as a line of text."""
    counts = ((sum(row.verdict == verdict for row in rows), verdict) for verdict in VERDICTS)
    parts = ", ".join(f"{count} {verdict}" for count, verdict in counts if count)
    noun = "entry" if len(rows) == 1 else "entries"
    return f"{len(rows)} {noun}" + (f": {parts}" if parts else "")


# ---- Markdown ------------------------------------------------------------------------------------

_HOW_TO_READ = """\
# What the papers print, and whether it is right

Every numbered equation, every line of code, every number of a table and every claim that can be tested, of
the papers this package follows. Each entry names the place, what is printed there (in ASCII, equations
in LaTeX too), what it should be, and why. First the numbered equations that are wrong. The verdicts:

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


_SELECTION = "# Some entries of what the papers print, and whether it is right"


def _counts() -> str:
    """A table of the number of entries by paper and verdict."""
    rows = [("paper", *VERDICTS, "all"), ("---", *["---:"] * (len(VERDICTS) + 1))]
    for letter, ledger in _ledgers().items():
        counts = [sum(entry.verdict == verdict for entry in ledger) for verdict in VERDICTS]
        rows.append((f"[{letter}](#paper-{letter.lower()})", *map(str, counts), str(len(ledger))))
    return "\n".join(map(_row, rows))


def _first_page(rows: tuple[Entry, ...]) -> str:
    """The numbered equations that are wrong, a line each with the right form, and which are right."""

    def line(entry: Entry) -> str:
        right = forms(entry)[1]
        shown = _math(right) if right else _code(entry.corrected)
        return f"- **Eq. {number(entry)}** ({entry.verdict}): {shown}"

    lines = list(overview(rows, line))
    spaced = [text if text.startswith("- ") else f"\n{text}\n" for text in lines]
    return re.sub(
        r"\n{3,}", "\n\n", "\n".join(["## The numbered equations that are wrong", *spaced])
    ).rstrip()


def _paper(letter: str, ledger: list[Entry]) -> str:
    """One paper as Markdown: title, conventions, the wrong entries in full, the right ones as a table."""
    if not ledger:
        return ""
    wrong = [_item(entry) for entry in ledger if entry.verdict not in FINE]
    right = [
        _row((entry.id, _plain(entry.where), _both(entry), _plain(entry.evidence)))
        for entry in ledger
        if entry.verdict in FINE
    ]
    head = [f"## Paper {letter}", _plain(title(letter)), *map(_plain, conventions(letter))]
    table = "\n".join([_row(("id", "where", "printed", "why")), _row(["---"] * 4), *right])
    below = ["### Not right", *wrong] if wrong else []
    return "\n\n".join([*head, *below, *(["### Right or given", table] if right else [])])


def _item(entry: Entry) -> str:
    """A wrong entry as Markdown: verdict, place, printed form, correction, evidence."""
    is_formula = re.search(r"[*^]|:=|^\S+ = ", entry.corrected) and not entry.corrected.endswith(".")
    instead = _code(entry.corrected) if is_formula else _plain(entry.corrected)
    corrected = forms(entry)[1]
    return "\n".join(
        [
            f"**{entry.id}** ({_plain(entry.where)}): **{entry.verdict}**",
            "",
            f"- printed: {_both(entry)}",
            f"- instead: {instead}" + (f" {_math(corrected)}" if corrected else ""),
            f"- because: {_plain(entry.evidence)}",
        ]
    )


def _both(entry: Entry) -> str:
    """The printed text in a code span, and in LaTeX where it is an equation."""
    printed = forms(entry)[0]
    return _code(entry.printed) + (f" {_math(printed)}" if printed else "")


def _math(text: str) -> str:
    """LaTeX within a line."""
    return f"$`{text}`$"


def _row(cells: Iterable[str]) -> str:
    """A row of a table; a bar inside a cell is escaped, in code too."""
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def _code(text: str) -> str:
    """Text as printed, in a code span."""
    return f"`{text}`"


def _plain(text: str) -> str:
    """Escape Markdown's special characters in a text; an underscore within a word needs none."""
    escaped = re.sub(r"([\\`*>\[\]#]|(?<!\w)_|_(?!\w))", r"\\\1", text)
    return escaped.replace("<", "&lt;").replace("~", "&#126;")
