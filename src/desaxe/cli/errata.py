"""`desaxe errata`: what the papers print, and what of it is right."""

import argparse
import json
from typing import Any

from .parser import add_command
from .words import UsageError

_ERRATA = """\
examples:
  desaxe errata                       every equation, listing line and claim that was looked at
  desaxe errata --document A          of one paper
  desaxe errata --verdict sign        those with a wrong sign
  desaxe errata --markdown            everything as a page in Markdown"""


def add_errata(commands: Any) -> None:
    """Add `desaxe errata`."""
    parser = add_command(
        commands, "errata", "what the papers print, and what of it is right", _ERRATA, _errata
    )
    parser.add_argument("--document", metavar="LETTER", type=str.upper, help="the paper: A, B or C")
    parser.add_argument(
        "--verdict", metavar="WORD", help="correct, typo, sign, wrong claim, not reproducible"
    )
    form = parser.add_mutually_exclusive_group()
    form.add_argument("--json", action="store_true", help="print JSON")
    form.add_argument("--markdown", action="store_true", help="print all entries as a page in Markdown")


def _errata(options: argparse.Namespace) -> int:
    from ..errata.ledger import entries, markdown, table

    if options.markdown:
        if options.document is not None or options.verdict is not None:
            raise UsageError("--markdown prints all entries: leave --document and --verdict out")
        print(markdown())
        return 0
    found = entries(document=options.document, verdict=options.verdict)
    print(json.dumps([entry._asdict() for entry in found], indent=2) if options.json else table(found))
    return 0
