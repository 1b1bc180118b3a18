"""The number of random cases of a test: few by default, many in a thorough run.

A test that asks is marked `sampled`, so that the thorough run repeats it; one that only the thorough run
can afford is marked `thorough`.
"""

import os
from collections.abc import Iterable
from typing import Any

import pytest

VARIABLE = "DESAXE_THOROUGH"


def cases(few: int, many: int, every: int = 0) -> int:
    """The number of cases to draw; `every` of them by DESAXE_THOROUGH=all, which takes hours."""
    asked = os.environ.get(VARIABLE)
    return max(many, every) if asked == "all" else many if asked else few


def first(count: int, values: Iterable[Any]) -> list[Any]:
    """The parameters of a test, of which all but the first `count` are for the thorough run alone."""
    rows = [value if type(value) is tuple else (value,) for value in values]
    return [
        pytest.param(*row, marks=pytest.mark.thorough if k >= count else ()) for k, row in enumerate(rows)
    ]
