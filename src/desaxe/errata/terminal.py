"""The ledgers as text for a terminal."""

import textwrap
from collections.abc import Iterable

from .equations import forms, number, overview
from .ledger import VERDICTS, Entry, Harm, conventions, entries, harm, title
from .marks import changes

_MORE = """\
{ } marks a change. "desaxe errata B-eq17" tells all about an entry, "eq20" about that equation of every
paper, "--equations" lists the wrong ones, "--paper B" has all entries of a paper, "--all" those of all."""


def first_lines(documents: Iterable[str], width: int = 100) -> str:
    """Warnings to users of the papers, and how to see more."""
    papers = "\n\n".join(worst(letter, width) for letter in documents)
    return papers + "\n\n" + _filled(" ".join(_MORE.split()), width, 0)


def worst(document: str, width: int = 100) -> str:
    """Warnings to users of a paper."""
    wrong, all_ = len(entries(document, wrong=True)), len(entries(document))
    head = _filled(f"{document}: {title(document)}, {wrong} of {all_} entries wrong or open", width, 3)
    return "\n".join([head, *(line for row in harm(document) for line in _lines(row, width))])


def _lines(row: Harm, width: int) -> list[str]:
    """One line of the harm, and the forms to write instead."""
    instead = [form for entry in row.write for form in _forms(entry)]
    head = row.what + (f": {row.cost}" if row.cost else "")
    text = [_filled("- " + head, width, 2)]
    return text + ([_filled("  > " + "  ".join(instead), width, 4)] if instead else [])


def _forms(entry: Entry) -> list[str]:
    """The form to write for an entry, with its changes in braces."""
    if not entry.corrected:
        return [entry.printed]
    return [changes(entry.printed, entry.corrected, lambda text: f"{{{text}}}")]


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
        "\n".join(_filled(text, width, 3) for text in lines)
        for letter in dict.fromkeys(entry.document for entry in entries)
        for lines in [[f"{letter}: {title(letter)}", *conventions(letter)]]
    )


def equations(entries: Iterable[Entry], width: int = 100, tex: bool = False) -> str:
    """The numbered equations that are wrong with their right forms, and the numbers of the others."""

    def line(entry: Entry) -> str:
        right = forms(entry)[1] if tex else ""
        return f"  {f'Eq. {number(entry)}':8} {entry.verdict}: {right or entry.corrected}"

    return "\n".join(_filled(text, width, 11) for text in overview(entries, line))


def _block(entry: Entry, indent: int, width: int, tex: bool) -> str:
    """One entry as text: verdict in the margin; id, place, printed form, correction, evidence."""
    printed, corrected = forms(entry) if tex else ("", "")
    lines = [(entry.verdict, f"{entry.id}  ({entry.where})"), ("", f"printed: {entry.printed}")]
    lines += [("", f"  LaTeX: {printed}")] if printed else []
    lines += [("", f"instead: {entry.corrected}")] if entry.corrected else []
    lines += [("", f"  LaTeX: {corrected}")] if corrected else []
    lines.append(("", f"because: {entry.evidence}"))
    return "\n".join(
        _filled(margin.ljust(indent) + text, width, indent + 9 * (not margin)) for margin, text in lines
    )


def _filled(text: str, width: int, indent: int) -> str:
    """Text wrapped to a width, all lines but the first indented."""
    return textwrap.fill(
        text,
        width=max(width, indent + 20),
        subsequent_indent=" " * indent,
        break_long_words=False,
        break_on_hyphens=False,
    )


def _summary(rows: tuple[Entry, ...]) -> str:
    """The number of entries of each verdict, as a line of text."""
    counts = ((sum(row.verdict == verdict for row in rows), verdict) for verdict in VERDICTS)
    parts = ", ".join(f"{count} {verdict}" for count, verdict in counts if count)
    noun = "entry" if len(rows) == 1 else "entries"
    return f"{len(rows)} {noun}" + (f": {parts}" if parts else "")
