"""The ledger of errata: complete, consistent, and every verdict with a proof."""

import ast
import re
from collections import Counter
from functools import cache
from pathlib import Path

import pytest

from desaxe.errata import ledger as _errata
from desaxe.errata.ledger import VERDICTS, Entry, entries, table

ROOT = Path(__file__).resolve().parents[2]
LISTING = [entry for entry in entries("A") if entry.where == "Listing, Sec. II.D"]
PARTS = ["alpha_BC1", "alpha_BC2", "alpha_BC3", "alpha_BC4", "a_C1", "a_C2", "a_C3", "a_C4"]
LINES = ["omega", "delta", "phi", "Y", "V_B", "a_B", "omega_BC", "V_C", "alpha_BC", "a_C", *PARTS]
FIG_8 = {1: ["omega"], 2: ["V_B", "a_B", "V_Bmag", "a_Bmag", "X"], 3: ["omega_BC", "V_C", "alpha_BC", "a_C"]}


def defined_name(line):
    """The name a line of the listing defines, exactly as printed."""
    return line.printed.split("(")[0]


def used_names(line):
    """The functions a line of the listing calls, with the paper's small c read as C."""
    right = line.printed.split(":=")[1].replace("a_c", "a_C")
    return set(re.findall(r"([A-Za-z_0-9]+)\(", right)) - {"sin", "cos", "asin", "acos", "sqrt"}


def needs(name):
    """Every function of the listing that a function needs, itself left out."""
    lines = {defined_name(line).replace("a_c", "a_C"): line for line in LISTING}
    direct = used_names(lines[name])
    return direct.union(*(needs(other) for other in direct))


@cache
def functions_in(path):
    """The test functions of a file, each with the texts that may stand in its parameter list."""
    tree = ast.parse((ROOT / path).read_text("utf-8"))
    texts = {node.value for node in ast.walk(tree) if isinstance(node, ast.Constant)}
    names = {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}
    parametrised = {
        node.name
        for node in tree.body
        if isinstance(node, ast.FunctionDef)
        and any("parametrize" in ast.unparse(d) for d in node.decorator_list)
    }
    return names, parametrised, texts


def test_every_equation_once():
    equations = [entry.id for entry in entries("A") if re.fullmatch(r"A-eq\d+", entry.id)]
    assert Counter(equations) == {f"A-eq{number}": 1 for number in range(1, 26)}


def test_every_line_of_the_listing_once():
    ids = Counter(entry.id for entry in LISTING)
    assert ids == {f"A-listing-{name}": 1 for name in LINES}


def test_ids_are_unique_and_carry_their_document():
    ids = [entry.id for entry in entries()]
    assert len(ids) == len(set(ids))
    assert all(entry.id.startswith(entry.document + "-") for entry in entries())


@pytest.mark.parametrize("entry", entries(), ids=lambda entry: entry.id)
def test_entry_is_complete(entry):
    assert all(isinstance(field, str) and field.isascii() for field in entry)
    assert entry.verdict in VERDICTS
    assert bool(entry.corrected) == (entry.verdict not in ("correct", "given"))
    assert all(getattr(entry, field) for field in ("where", "printed", "evidence"))
    assert entry.corrected != entry.printed


@pytest.mark.parametrize("entry", entries(), ids=lambda entry: entry.id)
def test_proof_exists(entry):
    path, name, parameter = re.fullmatch(
        r"(tests/papers/\w+\.py)::(test_\w+)(?:\[(\w+)\])?", entry.test
    ).groups()
    names, parametrised, texts = functions_in(path)
    assert name in names
    assert (parameter is not None) == (name in parametrised)
    assert parameter is None or parameter in texts


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


def test_table_shows_everything_within_the_width():
    shown = table(entries("A"), width=80)
    assert all(len(line) <= 80 for line in shown.splitlines() if " " in line.strip())
    flat = " ".join(shown.split())
    for entry in entries("A"):
        assert all(" ".join(field.split()) in flat for field in (entry.id, entry.printed, entry.corrected))


def test_table_counts_verdicts():
    rows = [
        Entry(f"A-{n}", "A", "Eq.", "x", verdict, "", "y", "z") for n, verdict in enumerate(VERDICTS[:2] * 2)
    ]
    assert table(rows).splitlines()[-1] == "4 entries: 2 correct, 2 given"
    assert table(rows[:1]).splitlines()[-1] == "1 entry: 1 correct"
    assert table([]) == "0 entries"
    assert table(iter(rows)) == table(rows)


def test_ledgers_are_read_once():
    assert _errata._ledgers() is _errata._ledgers()


def test_listing_defines_a_name_that_is_not_called():
    defined = {defined_name(line) for line in LISTING}
    calls = {
        entry.printed.split("(")[0] for entry in entries("A") if entry.id in ("A-example-a_C", "A-case2-a_C")
    }
    assert calls == {"a_C"}
    assert "a_c" in defined
    assert "a_C" not in defined
    assert "V_C" in defined


def test_listing_is_not_in_order():
    names = [defined_name(line).replace("a_c", "a_C") for line in LISTING]
    forward = [name for n, name in enumerate(names) if used_names(LISTING[n]) & set(names[n:])]
    assert forward == ["alpha_BC", "a_C"]


def test_fig8_lists_functions_that_are_never_defined():
    defined = {defined_name(line).replace("a_c", "a_C") for line in LISTING}
    listed = {name for step in FIG_8.values() for name in step}
    assert listed - defined == {"V_Bmag", "a_Bmag", "X"}
    assert defined - listed == {"delta", "phi", "Y", *PARTS}


def test_fig8_steps_use_only_earlier_ones():
    step = {name: number for number, names in FIG_8.items() for name in names}
    defined = [name for name in step if name not in ("V_Bmag", "a_Bmag", "X")]
    assert needs("V_B") == needs("a_B") == {"omega"}
    assert all(step[other] <= step[name] for name in defined for other in needs(name) & set(step))
    assert needs("V_C") & set(FIG_8[1])
    assert not needs("V_B") & set(FIG_8[3])
