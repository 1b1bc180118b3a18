"""`desaxe errata`: the papers' printed equations and numbers, with verdicts."""

import argparse
import json
import shutil
from typing import Any

from .parser import add_command


def add_errata(commands: Any) -> None:
    """Add `desaxe errata`."""
    parser = add_command(
        commands, "errata", "the papers' printed equations and numbers, with verdicts", _errata
    )
    parser.add_argument(
        "words", metavar="WORD", nargs="*", help="an id, an equation (eq20), or words to find"
    )
    parser.add_argument(
        "--paper", "--document", dest="document", metavar="LETTER", type=str.upper, help="A, B or C"
    )
    parser.add_argument("--all", action="store_true", help="every entry")
    parser.add_argument(
        "--verdict", metavar="WORD", help="one verdict, such as correct, sign, typo, wrong claim"
    )
    parser.add_argument("--wrong", action="store_true", help="only what needs a correction")
    parser.add_argument("--latex", action="store_true", help="equations in LaTeX too")
    form = parser.add_mutually_exclusive_group()
    form.add_argument("--equations", action="store_true", help="only the wrong numbered equations")
    form.add_argument("--json", action="store_true", help="print JSON, with the test of each verdict")
    form.add_argument("--markdown", action="store_true", help="print a page in Markdown")


def _errata(options: argparse.Namespace) -> int:
    from ..errata import ledger, page, terminal
    from ..errata.search import matching

    found = matching(ledger.entries(options.document, options.verdict, options.wrong), options.words)
    if options.words and not found and not options.json:
        raise ValueError(f"no entry for {' '.join(options.words)!r}; `desaxe errata --all` lists them")
    picked = bool(options.verdict or options.wrong or options.words)
    chosen = picked or bool(options.document)
    width = shutil.get_terminal_size((100, 24)).columns
    if options.markdown:
        print(page.markdown(found if chosen else None))
    elif options.json:
        print(json.dumps([ledger.record(entry) for entry in found], indent=2))
    elif options.equations:
        print(terminal.equations(found, width, options.latex))
    elif not chosen and not options.all:
        print(terminal.first_lines(ledger.documents(), width))
    else:
        letters = [] if picked else [options.document] if options.document else ledger.documents()
        worst = [terminal.worst(letter, width) for letter in letters]
        tex = options.latex or bool(options.words)
        shown = [*worst, terminal.headings(found, width), terminal.table(found, width, tex)]
        print("\n\n".join(filter(None, shown)))
    return 0
