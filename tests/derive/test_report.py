"""`python -m derive --report`: what each pass leaves, for every quantity."""

from functools import cache
from pathlib import Path

import pytest

from desaxe.compiler.passes.pipeline import PASSES, optimise_in_steps
from desaxe.compiler.passes.slicing import keep_outputs
from desaxe.derive.groups import GROUPS
from desaxe.derive.quantities import QUANTITIES
from desaxe.derive.report import CONCENTRIC, GENERAL, report
from tests.derive.derived import derivation

ROOT = Path(__file__).parents[2]


@cache
def lines():
    return report(derivation()).splitlines()


def rows(name):
    """The words of the rows that start with a name, of both tables."""
    return [line.split() for line in lines() if line.startswith(f"{name} ")]


@pytest.mark.thorough
@pytest.mark.parametrize("name", QUANTITIES)
def test_every_quantity_has_a_row_in_both_tables(name):
    assert len(rows(name)) == 2


def test_every_pass_has_a_column():
    assert all(row[1 : len(PASSES) + 2] == ["sliced", *PASSES] for row in rows("quantity"))


@pytest.mark.parametrize(("table", "fixed"), [(0, GENERAL), (1, CONCENTRIC)])
def test_the_counts_are_those_of_the_pipeline(table, fixed):
    _, steps = optimise_in_steps(keep_outputs(derivation().program, ("a_C",)), fixed)
    assert rows("a_C")[table][1 : len(steps) + 1] == [str(count) for _, count in steps]


def test_each_module_has_its_seconds_and_sizes():
    for group in GROUPS:
        ((name, seconds, size, results, *operations),) = rows(group.name)
        text = (ROOT / "generated" / f"{name}.py").read_text(encoding="utf-8")
        assert float(seconds) > 0.0
        assert (int(size), int(results)) == (len(text.splitlines()), len(group.outputs))
        stable, plain = map(int, operations)
        assert plain < stable if group.two_forms else plain == stable


def test_the_whole_program_comes_first():
    words = lines()[0].replace(",", "").split()
    assert {str(len(derivation().program.lines)), str(len(derivation().names))} <= set(words)
