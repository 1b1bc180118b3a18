"""The number of random cases of a test: few by default, many in a thorough run.

A test that asks is marked `sampled`, so that the thorough run repeats it; one that only the thorough run
can afford is marked `thorough`.
"""

import os

VARIABLE = "DESAXE_THOROUGH"


def cases(few: int, many: int) -> int:
    """The number of cases to draw."""
    return many if os.environ.get(VARIABLE) else few
