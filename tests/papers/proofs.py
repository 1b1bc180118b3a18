"""Proofs of the ledgers' verdicts: every entry has a test that recomputes what the entry says.

`@proves("B-eq17", "sign")` makes a test the proof of an entry. The test takes nothing from the ledger: it
asserts the verdict and returns the numbers that the entry shows, by name. Then the entry is held against it
(`entry_checks`): its verdict, the numbers and formulas of its texts, and what it says that the paper prints.
"""

import functools
import importlib
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import pytest
from mpmath import mp

from tests.papers.digits import DIGITS

FOLDER = Path(__file__).parent


class Proof(NamedTuple):
    """The proof of one entry of the ledgers."""

    entry: str
    verdict: str
    node: str  # of pytest
    test: Callable[[], Mapping[str, Any] | None]
    says: str = ""  # numbers that the paper prints, or its line of code, from the paper itself
    instead: str = ""  # the line of code that the proof runs in its place
    cites: str = (
        ""  # equations, tables, sections, years and entries that the entry's text refers to, in order
    )

    @property
    def name(self) -> str:
        """The test's name, without an entry's."""
        return self.node.partition("[")[0]

    def found(self) -> dict[str, Any]:
        """Numbers that the test returns, at the digits of all proofs; run once."""
        return results(self.test)


PROOFS: dict[str, Proof] = {}


@functools.cache
def results(test: Callable[[], Mapping[str, Any] | None]) -> dict[str, Any]:
    """The numbers that a test returns."""
    with mp.workdps(DIGITS):
        return dict(test() or {})


def proves(entry: str, verdict: str, *, says: str = "", instead: str = "", cites: str = "") -> Callable:
    """Make a test the proof of an entry; it may be that of several."""

    def decorate(test: Callable) -> Callable:
        proof = Proof(entry, verdict, _node(test), getattr(test, "proof", test), says, instead, cites)
        _register(proof)
        if hasattr(test, "proof"):
            test.entries.append(entry)
            return test

        @functools.wraps(test)
        def check() -> None:
            for name in check.entries:
                _hold(name)

        check.proof, check.entries = test, [entry]
        return check

    return decorate


def proves_each(cases: Mapping[str, Any], verdict: str | Mapping[str, str], **texts: Any) -> Callable:
    """Make a test of one argument the proof of several entries, each with its case and perhaps its texts."""

    def decorate(test: Callable) -> Callable:
        for entry, case in cases.items():
            own = {
                name: text if isinstance(text, str) else text.get(entry, "") for name, text in texts.items()
            }
            one = verdict if isinstance(verdict, str) else verdict[entry]
            run = functools.partial(test, case)
            _register(Proof(entry, one, f"{_node(test)}[{entry}]", run, **own))

        @pytest.mark.parametrize("entry", list(cases))
        def check(entry: str) -> None:
            _hold(entry)

        check.__name__, check.__doc__, check.__module__ = test.__name__, test.__doc__, test.__module__
        return check

    return decorate


def all_proofs() -> dict[str, Proof]:
    """The proofs of every entry."""
    for path in sorted(FOLDER.glob("test_paper_*.py")):
        importlib.import_module(f"tests.papers.{path.stem}")
    return PROOFS


def _node(test: Callable) -> str:
    """The name by which pytest runs a test."""
    code = getattr(test, "proof", test).__code__
    return f"tests/papers/{Path(code.co_filename).name}::{test.__name__}"


def _register(proof: Proof) -> None:
    """Keep a proof; an entry has one only."""
    other = PROOFS.get(proof.entry)
    assert other is None or other.node == proof.node, (
        f"{proof.entry} has two proofs: {other.node}, {proof.node}"
    )
    PROOFS[proof.entry] = proof


def _hold(name: str) -> None:
    """Hold an entry of the ledger against its proof, and an equation against every design."""
    from tests.papers.entry_checks import complaints, raw_entries  # the proofs know nothing of the ledger
    from tests.papers.formulas import everywhere

    assert complaints(raw_entries()[name], PROOFS[name]) == []
    assert list(everywhere(raw_entries()[name], PROOFS[name].verdict)) == []
