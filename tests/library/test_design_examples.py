"""The examples in the docstrings of the design questions, run as they stand."""

import doctest
from importlib import import_module

import pytest

NAMES = ["events", "optimize", "synthesize", "tolerance", "harmonics", "counterweight", "flywheel"]


@pytest.mark.parametrize("module", [*(f"_design.{name}" for name in NAMES), "_feasibility"])
def test_examples(module):
    found = doctest.testmod(import_module(f"desaxe.{module}"))
    assert found.attempted >= 2
    assert not found.failed
