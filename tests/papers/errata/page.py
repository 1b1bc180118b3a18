"""The ledgers as a Markdown page: the harm, the wrong equations, then each paper entry by entry."""

import re
from collections.abc import Iterable

from .equations import FINE, forms, number, overview
from .ledger import VERDICTS, Entry, Harm, conventions, documents, entries, harm, title
from .marks import changes


def markdown() -> str:
    """The ledgers as a Markdown page: the harm, the wrong equations, then each paper entry by entry."""
    first = [_TITLE, *map(_worst, documents()), _HOW_TO_READ, _equations(entries()), _counts()]
    return "\n\n".join([*first, *map(_paper, documents())])


_TITLE = """\
# What the papers print, and whether it is right

What whoever uses one of the papers must know comes first, each with what it costs and what to write instead,
the change in bold; then how to read the rest, the numbered equations that are wrong, and every entry."""

_HOW_TO_READ = """\
## How to read it

Every numbered equation, every line of code, every number of a table and every claim that can be tested, of
the papers this package follows. Each entry names the place, what is printed there (in ASCII, equations
in LaTeX too), what it should be, and why. In a quotation ... is what was left out and [ ] what was added.
The verdicts:

- **sign**: a wrong sign
- **sign and exponent**, **sign and missing factor**: wrong signs, and wrong exponents or a factor left out
- **typo**: a misprint that the paper itself does not follow
- **wrong claim**: a formula, number or statement that does not hold. A claim about what the paper's formulas
  do is judged by them as printed; where it holds with the corrected ones, the entry says so
- **omission**: something needed is left out; the usual or the nearest reading is told
- **not reproducible**: a number that the printed formulas and data do not give; the nearest reading is told
- **given**: a datum, convention or statement of the paper that nothing at hand can confirm or contradict
- **correct**: it holds

A sign is judged by the paper's own conventions, which are told first. Every verdict, number and formula is
proved by a test of this repository (`tests/papers/errata/` names the test of each): formulas are evaluated as
printed, in 50 digits, and compared with the closed loop of the mechanism, differentiated in time, and forces
with the equations of the free bodies."""


def _worst(letter: str) -> str:
    """Warnings to users of a paper, as a list."""
    return "\n".join(
        [f"## What to know of paper {letter}", "", _plain(title(letter)), "", *map(_harm, harm(letter))]
    )


def _harm(row: Harm) -> str:
    """One line of the harm: what, what it costs, what to write instead, where it is proved."""
    cost = f": {_plain(row.cost)}" if row.cost else ""
    instead = ", ".join(_instead(entry) for entry in row.write)
    links = ", ".join(row.entries)
    return f"- **{_plain(row.what)}**{cost}" + (f". Write {instead}" if instead else "") + f" ({links})"


def _instead(entry: Entry) -> str:
    """The form to write for an entry, its changes in bold."""
    if not entry.corrected:
        return _code(entry.printed)
    marked = _code(changes(entry.printed, entry.corrected, lambda text: f"`**`{text}`**`"))
    return marked.replace("``", "")


def _counts() -> str:
    """A table of the number of entries by paper and verdict."""
    rows = [("paper", *VERDICTS, "all"), ("---", *["---:"] * (len(VERDICTS) + 1))]
    for letter in documents():
        ledger = entries(letter)
        counts = [sum(entry.verdict == verdict for entry in ledger) for verdict in VERDICTS]
        rows.append((f"[{letter}](#paper-{letter.lower()})", *map(str, counts), str(len(ledger))))
    return "\n".join(map(_row, rows))


def _equations(rows: tuple[Entry, ...]) -> str:
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


def _paper(letter: str) -> str:
    """One paper as Markdown: title, conventions, the wrong entries in full, the right ones as a table."""
    ledger = entries(letter)
    wrong = [_item(entry) for entry in ledger if entry.verdict not in FINE]
    right = [
        _row((entry.id, _plain(entry.where), _both(entry), _plain(entry.evidence)))
        for entry in ledger
        if entry.verdict in FINE
    ]
    head = [f"## Paper {letter}", _plain(title(letter)), *map(_plain, conventions(letter))]
    table = "\n".join([_row(("id", "where", "printed", "why")), _row(["---"] * 4), *right])
    return "\n\n".join([*head, "### Not right", *wrong, "### Right or given", table])


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
