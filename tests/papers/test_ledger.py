"""The ledgers of errata: complete, tied to their proofs, frozen, filtered."""

import re
from collections import Counter

import pytest
from mpmath import mp

from tests.effort import cases
from tests.papers import mutate
from tests.papers import paper_c as C
from tests.papers.digits import DIGITS
from tests.papers.entry_checks import harm_complaints, raw_entries
from tests.papers.errata import ledger as _errata
from tests.papers.errata.ledger import VERDICTS, documents, entries, harm, sheets
from tests.papers.frozen import frozen, row_of
from tests.papers.proofs import FOLDER, all_proofs
from tests.papers.test_paper_a_listing import LISTING

TWICE = {2: "ab", 5: "ab", 37: "ab", 42: "ab", 46: "ab"}  # equations of paper B with two labels
LABELS = [f"{number}{letter}" for number in range(1, 54) for letter in TWICE.get(number, [""])]
LISTING_A = [name.replace("a_c", "a_C") for name in LISTING]


def ids(pattern, document=None):
    """Counts of the parts of ids that match a pattern."""
    return Counter(result.group(1) for e in entries(document) if (result := re.fullmatch(pattern, e.id)))


# --- complete -------------------------------------------------------------------------------------


def test_every_equation_and_line_once():
    assert ids(r"A-eq(\w+)") == {f"{number}": 1 for number in range(1, 26)}
    assert ids(r"B-eq(\w+)") == dict.fromkeys(LABELS, 1)
    assert len(LABELS) == 58
    assert ids(r"A-listing-(?!name|order)(\w+)") == dict.fromkeys(LISTING_A, 1)
    assert ids(r"C-(link\d-(?:x|y|moment))") == {
        f"link{n}-{p}": 1 for n in (2, 3, 4) for p in ("x", "y", "moment")
    }
    assert ids(r"C-matrix-row(\d)") == ids(r"C-listing-A-row(\d)") == {f"{n}": 1 for n in range(1, 9)}
    assigned = {"r": "lengths", "l": "lengths"}
    assert {assigned.get(name, name) for name in C.scalars()} <= set(ids(r"C-listing-(\w+)"))
    assert set(C.VALUES) <= set(ids(r"C-value-(\w+)"))


def test_equations_stand_where_they_say():
    for entry in entries():
        if number := re.fullmatch(r"[AB]-eq(\w+)", entry.id):
            assert re.match(rf"Eq\. {number.group(1)}\b", entry.where)


def test_entries_are_complete():
    for entry in entries():
        assert all(isinstance(field, str) and field.isascii() for field in entry), entry.id
        assert not re.search(r"[{}]", "".join(entry)), f"{entry.id}: a mark that is none"
        assert entry.verdict in VERDICTS, entry.id
        assert entry.id.startswith(entry.document + "-")
        assert all(getattr(entry, field) for field in ("where", "printed", "evidence")), entry.id
        assert entry.corrected != entry.printed == raw_entries()[entry.id]["printed"], entry.id


# --- tied -----------------------------------------------------------------------------------------


def test_every_entry_has_a_proof_and_every_proof_its_entry():
    assert list(Counter(all_proofs().keys() ^ raw_entries().keys())) == []
    assert len(raw_entries()) == len(entries())


def test_proofs_know_nothing_of_the_ledger():
    """No proof can take what the ledger says that a paper prints for the paper."""
    for path in FOLDER.glob("test_paper_*.py"):
        assert "errata" not in path.read_text("utf-8"), path.name


def test_entries_are_as_frozen():
    """`python -m tests.papers.frozen` freezes a change that is meant."""
    assert {key: row_of(row) for key, row in raw_entries().items()} == frozen()


def test_proof_of_each_line_of_the_harm():
    all_proofs()
    for letter in documents():
        assert 1 < len(harm(letter)) <= 12
        for row in sheets()[letter]["harm"]:
            used = row["entries"] + row["write"]
            assert all(key in raw_entries() for key in used)
            with mp.workdps(DIGITS):
                assert harm_complaints(row) == []


@pytest.mark.sampled
def test_changes_are_noticed():
    """Changes of some entries are noticed, nearly all of them by the proofs alone; words only by hashes."""
    seed, entries_tried = 34, cases(25, len(entries()))
    by_proofs = ["sign", "number", "verdict", "corrected", "evidence", "test"]
    counts, missed = mutate.survivors(seed, 12 * entries_tried, False, False, by_proofs, entries_tried)
    assert all(seen >= 0.97 * made > 0 for made, seen in counts.values()), missed
    counts, missed = mutate.survivors(
        seed + 1, 4 * entries_tried, True, True, list(mutate.KINDS), entries_tried
    )
    assert missed == []
    assert min(made for made, _ in counts.values()) > 0


# --- read -----------------------------------------------------------------------------------------


def test_filters():
    assert [entry.id for entry in entries()[:2]] == ["A-eq1", "A-eq2"]
    assert [entry.id for entry in entries("A", "sign")] == ["A-eq19", "A-listing-V_C", "A-listing-a_C"]
    assert {entry.document for entry in entries("A")} == {"A"}
    assert sum(len(entries(verdict=verdict)) for verdict in VERDICTS) == len(entries())


def test_unknown_document_or_verdict():
    with pytest.raises(ValueError, match=r"document 'Z'.*'A'"):
        entries("Z")
    with pytest.raises(ValueError, match=r"verdict 'fine'.*'wrong claim'"):
        entries(verdict="fine")


def test_entry_is_frozen():
    with pytest.raises(AttributeError):
        entries()[0].verdict = "typo"


def test_ledgers_are_read_once():
    assert _errata._ledgers() is _errata._ledgers()
