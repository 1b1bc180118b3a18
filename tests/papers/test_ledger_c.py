"""The ledger of paper C: every equation, line, row, number and caption of the report has its entry."""

import ast
import re
from pathlib import Path

import pytest

from desaxe.errata.ledger import entries
from tests.papers import paper_c as C

LEDGER = {entry.id.removeprefix("C-"): entry for entry in entries("C")}
PROOFS = [Path(__file__).with_name(f"test_paper_c_{part}.py") for part in ("equations", "listing", "claims")]
SUPPORTING = {  # they prove what proofs use
    "test_accelerations_are_those_of_the_package",
    "test_reach_is_the_loop_s",
    "test_alpha3_of_the_package",
    "test_right_arms_need_no_compromise",
}
SHARED = {"r": "lengths", "l": "lengths"}


def numbered(pattern):
    """The numbers at the ends of the ids of this form."""
    return sorted(int(found.group(1)) for key in LEDGER if (found := re.fullmatch(pattern, key)))


def flat(text):
    """Text without its spaces and line ends."""
    return "".join(text.split())


def test_every_link_equation():
    keys = {f"link{link}-{part}" for link in (2, 3, 4) for part in ("x", "y", "moment")}
    assert keys == {key for key in LEDGER if re.fullmatch(r"link\d-(x|y|moment)", key)}
    functions = {name.replace("_", "-") for name in vars(C) if re.fullmatch(r"link\d_\w+", name)}
    assert functions == keys


def test_every_row_of_the_system():
    assert numbered(r"matrix-row(\d)") == numbered(r"listing-A-row(\d)") == list(range(1, 9))
    printed = [entry.printed.rstrip(";") for key, entry in LEDGER.items() if key.startswith("listing-A-row")]
    assert [row.split() for row in printed] == C.rows(C.bracket("A"))
    assert LEDGER["unknowns"].printed.strip("[]").split() == list(C.UNKNOWNS)


@pytest.mark.parametrize("name", C.scalars())
def test_every_assignment_of_the_listing(name):
    entry = LEDGER["listing-" + SHARED.get(name, name)]
    line = re.search(rf"^{name} ?=.*;$", C.LISTING, re.MULTILINE).group()
    assert flat(line) in flat(entry.printed)


def test_every_other_line_of_the_listing():
    rest = re.sub(r"^(%%.*|\w+ ?= ?[^\[\n]+;)$", "", C.LISTING, flags=re.MULTILINE)
    rest = rest.replace(C.bracket("A"), "").replace("A = [];", "")
    quoted = "".join(flat(LEDGER["listing-" + key].printed) for key in ("syms", "B", "pinv"))
    assert sorted(quoted.replace(";", "")) == sorted(flat(rest).replace(";", ""))


@pytest.mark.parametrize("label", C.VALUES)
def test_every_value(label):
    assert LEDGER[f"value-{label}"].printed == f"{label} = {C.VALUES[label]}"


@pytest.mark.parametrize("degrees", C.STATIC_TORQUES)
def test_every_static_torque(degrees):
    entry = LEDGER[f"static-{degrees}"]
    assert entry.printed.endswith(f" {C.STATIC_TORQUES[degrees]} N mm")
    assert entry.test.endswith(f"[deg{degrees}]")


def test_every_figure():
    """Each figure has one entry that quotes both of its captions."""
    where = {"figure-1": [1, 2, 3, 4], "figure-9": [9], "figure-names": [5, 6, 7, 8, 10, 11]}
    assert set(where) == {key for key in LEDGER if key.startswith("figure-")}
    assert sorted(number for numbers in where.values() for number in numbers) == list(C.FIGURES)
    for key, numbers in where.items():
        words = {word for n in numbers for caption in C.FIGURES[n] for word in re.findall(r"\w+", caption)}
        assert words <= set(re.findall(r"\w+", LEDGER[key].printed)), key


def test_every_proof_has_its_entry():
    """No proof without a verdict: each test of the report is named, but for those that support others."""
    trees = [ast.parse(path.read_text("utf-8")) for path in PROOFS]
    tests = {node.name for tree in trees for node in tree.body if isinstance(node, ast.FunctionDef)}
    named = {re.search(r"::(\w+)", entry.test).group(1) for entry in LEDGER.values()}
    assert {name for name in tests if name.startswith("test_")} - named == SUPPORTING
