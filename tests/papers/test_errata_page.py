"""docs/ERRATA.md: generated from the ledgers, fresh, and complete."""

import re
from functools import cache
from pathlib import Path

from tests.papers.errata.equations import FINE
from tests.papers.errata.ledger import VERDICTS, documents, entries, harm, sheets
from tests.papers.errata.page import _plain, markdown

PAGE = Path(__file__).resolve().parents[2] / "docs/ERRATA.md"
whole_page = cache(markdown)


def test_page_is_fresh():
    fresh = PAGE.read_text("utf-8") == markdown() + "\n"
    assert fresh, "docs/ERRATA.md is stale: run `python -m tests.papers.errata`"


def test_every_entry_is_on_the_page():
    """In the list or in the table; a bar in a table is escaped."""
    page = whole_page()
    for entry in entries():
        wrong = entry.verdict not in FINE
        printed = entry.printed if wrong else entry.printed.replace("|", "\\|")
        assert f"`{printed}`" in page, entry.id
        mark = f"**{entry.id}** (" if wrong else f"| {entry.id} |"
        assert page.count(mark) == 1, entry.id
        block = page[page.index(mark) :].split("\n\n**")[0]
        if wrong:
            assert f"): **{entry.verdict}**\n" in block, entry.id
            assert all(f"- {word}: " in block for word in ("printed", "instead", "because")), entry.id


def test_no_backtick_breaks_a_code_span():
    assert not [entry.id for entry in entries() if "`" in entry.printed + entry.corrected]


def test_counts():
    page = markdown()
    for letter in documents():
        ledger = entries(letter)
        counts = [sum(entry.verdict == verdict for entry in ledger) for verdict in VERDICTS]
        line = " | ".join(map(str, [*counts, len(ledger)]))
        assert f"| [{letter}](#paper-{letter.lower()}) | {line} |" in page
        assert f"\n## Paper {letter}\n" in page


def test_tables_have_as_many_cells_as_heads():
    for line in markdown().splitlines():
        if line.startswith("|"):
            cells = len(re.findall(r"(?<!\\)\|", line)) - 1
            assert cells == (len(VERDICTS) + 2 if line.count("|") == len(VERDICTS) + 3 else 4)


def test_every_ledger_names_its_paper():
    for letter, sheet in sheets().items():
        assert sheet.get("title", "").isascii(), letter
        assert sheet.get("title"), f"ledger {letter} begins with title = '...' and notes = [...]"
        assert sheet.get("notes"), f"ledger {letter} begins with title = '...' and notes = [...]"
        assert all(note.isascii() for note in sheet["notes"])
        assert set(sheet) == {"title", "notes", "harm", "entry"}


def test_plain_text_is_escaped():
    assert _plain("a*b_c <d> [e] _f_ ~g") == r"a\*b_c &lt;d\> \[e\] \_f\_ &#126;g"


def test_first_page_has_every_numbered_equation_once():
    """Each is on a line of its own with the right form in LaTeX, or is counted among the right ones."""
    first = markdown().split("## The numbered equations that are wrong")[1].split("| paper |")[0]
    shown = re.findall(r"^- \*\*Eq\. (\w+)\*\* \((.+?)\): \$`(.+)`\$$", first, re.MULTILINE)
    assert [(number, verdict) for number, verdict, _ in shown] == [
        (entry.id.partition("-eq")[2], entry.verdict)
        for entry in entries(wrong=True)
        if re.fullmatch(r"[AB]-eq\w+", entry.id) and entry.id != "B-eq50"  # that correction is no equation
    ]
    assert len(shown) == 17
    right = [numbers.split(", ") for numbers in re.findall(r"^Right \(\d+\): (.+)\.$", first, re.MULTILINE)]
    assert list(map(len, right)) == [24, 41]
    assert [int(count) for count in re.findall(r"^Right \((\d+)\)", first, re.MULTILINE)] == [24, 41]


def test_the_harm_comes_first():
    """At most a dozen lines a paper, before anything else, changes in bold and proofs named."""
    before = whole_page().split("## How to read it")[0]
    for letter in documents():
        part = before.split(f"## What to know of paper {letter}\n")[1].split("\n## ")[0]
        lines = [line for line in part.splitlines() if line.startswith("- ")]
        assert len(lines) == len(harm(letter)) <= 12
        for line, row in zip(lines, harm(letter), strict=True):
            assert line.endswith(f"({', '.join(row.entries)})")
    assert "`a_C(theta) = a_C1(theta) + a_C2(theta) `**`+`**` a_C3(theta) `**`+`**` a_C4(theta)`" in before
    assert "`Fpx = `**`-`**`50;`" in before
