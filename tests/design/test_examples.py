"""The examples in the docstrings of the design questions, run as they stand."""

import doctest
from importlib import import_module

import pytest

MODULES = [
    "feasibility.feasibility",
    "events.events",
    "optimisation.optimize",
    "synthesis.synthesize",
    "tolerance.tolerance",
    "turn.harmonics",
    "turn.counterweight",
    "drive.drive",
]


@pytest.mark.parametrize("module", MODULES)
def test_examples(module):
    result = doctest.testmod(import_module(f"desaxe.design.{module}"))
    assert result.attempted >= 2
    assert not result.failed
